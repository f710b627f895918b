"""Computes the signed distance of a case again, in rational arithmetic, apart from the program that made the case.

`python -m lin_canny_referee.confirm WORST.jsonl` prints each case of a file of worst cases with this distance beside
what the engine answered. It tries every direction that can separate two solid bodies or attain their depth (face
normals, and products of an edge of each), and every pair of features: slow, for bodies of some 20 vertices at most.
"""

from __future__ import annotations

import json
import math
import sys
from fractions import Fraction
from itertools import chain

from .cases import rotation

Vector = list[int]


def sub(a: Vector, b: Vector) -> Vector:
    return [x - y for x, y in zip(a, b)]


def dot(a: Vector, b: Vector) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def placed(body: dict) -> list[list[Fraction]]:
    """Returns the points of a body at its pose, exactly."""
    r, t = rotation(body["quaternion"]), [Fraction(x) for x in body["position"]]
    points = [[Fraction(x) for x in p] for p in body["points"]]
    return [[sum(r[i][k] * p[k] for k in range(3)) + t[i] for i in range(3)] for p in points]


class Solid:
    def __init__(self, points: list[Vector], faces: list[list[int]]) -> None:
        self.points, self.faces = points, faces
        self.corners = [[points[i] for i in f] for f in faces]
        self.normals = [cross(sub(c[1], c[0]), sub(c[2], c[0])) for c in self.corners]
        pairs = {tuple(sorted(p)) for f in faces for p in zip(f, f[1:] + f[:1])}
        self.edges = [(points[i], points[j]) for i, j in pairs]

    def span(self, n: Vector) -> tuple[int, int]:
        heights = [dot(n, p) for p in self.points]
        return min(heights), max(heights)


def to_features(points: list[Vector], body: Solid):
    """Yields squared distances of points from the vertices, edges and faces of a body that they are beside."""
    for p in points:
        for v in body.points:
            yield Fraction(dot(sub(p, v), sub(p, v)))
        for a, b in body.edges:
            u, w = sub(b, a), sub(p, a)
            along, length, off = dot(u, w), dot(u, u), cross(u, w)
            if 0 < along < length:
                yield Fraction(dot(off, off), length)
        for c, n in zip(body.corners, body.normals):
            if all(dot(cross(n, sub(b, a)), sub(p, a)) >= 0 for a, b in zip(c, c[1:] + c[:1])):
                height = dot(n, sub(p, c[0]))
                yield Fraction(height * height, dot(n, n))


def between_edges(a: Solid, b: Solid):
    for p, q in a.edges:
        for r, s in b.edges:
            u, v, w = sub(q, p), sub(s, r), sub(r, p)
            n = cross(u, v)
            length = dot(n, n)
            if length and 0 <= dot(cross(w, v), n) <= length and 0 <= dot(cross(w, u), n) <= length:
                yield Fraction(dot(w, n) ** 2, length)


def root(x: Fraction) -> float:
    """Returns the square root, to 30 digits before it is rounded."""
    if x == 0:
        return 0.0
    shift = max(0, 240 - (x.numerator.bit_length() - x.denominator.bit_length())) // 2 * 2
    return float(Fraction(math.isqrt((x.numerator << shift) // x.denominator), 1 << (shift // 2)))


def signed_distance(body_a: dict, body_b: dict) -> float:
    """Returns the signed distance of two solid bodies with faces."""
    if not body_a["faces"] or not body_b["faces"]:
        raise ValueError("a body is flat")
    pa, pb = placed(body_a), placed(body_b)
    unit = math.lcm(*(x.denominator for p in chain(pa, pb) for x in p))
    a = Solid([[int(x * unit) for x in p] for p in pa], body_a["faces"])
    b = Solid([[int(x * unit) for x in p] for p in pb], body_b["faces"])
    crosses = (cross(sub(q, p), sub(s, r)) for p, q in a.edges for r, s in b.edges)
    least = None
    for n in chain(a.normals, b.normals, crosses):
        if any(n):
            (a0, a1), (b0, b1) = a.span(n), b.span(n)
            gap = max(b0 - a1, a0 - b1)
            if gap > 0:
                found = min(chain(to_features(a.points, b), to_features(b.points, a), between_edges(a, b)))
                return root(found / unit**2)
            square = Fraction(gap * gap, dot(n, n))
            least = square if least is None else min(least, square)
    return -root(least / unit**2) or 0.0


def main() -> None:
    with open(sys.argv[1]) as lines:
        for text in lines:
            j = json.loads(text)
            try:
                again = repr(signed_distance(j["a"], j["b"]))
            except ValueError as why:
                again = str(why)
            print(
                f"{j['engine']} {j['version']} {j['options']}: {j['family']} ({j['level']}), case {j['case']}: "
                f"answered {j['answer']} {j['distance']}, true {j['true_distance']!r}, computed again {again}"
            )


if __name__ == "__main__":
    main()
