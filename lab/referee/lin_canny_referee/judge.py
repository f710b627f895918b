"""Compares answers with what is true, and counts by family."""

from __future__ import annotations

import statistics
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .adapter import Adapter
from . import cases
from .cases import Case, Shape, exponent, relative

REAL = np.longdouble


class Given(NamedTuple):
    """A line of an answer file."""

    status: str
    distance: float | None
    point_a: list[float] | None
    point_b: list[float] | None
    normal: list[float] | None
    nanoseconds: int | None
    remark: str


def parse(part: Path) -> dict[int, Given]:
    """Returns the answers of a file by the numbers of their cases."""
    answers = {}
    with open(part) as lines:
        for text in lines:
            if text.startswith("#"):
                continue
            text, _, remark = text.partition("#")
            words = text.split()
            values = [None if w == "-" else float(w) for w in words[2:12]]

            def three(at: int) -> list[float] | None:
                return None if values[at] is None else values[at : at + 3]

            ns = None if words[12] == "-" else int(words[12])
            answers[int(words[0])] = Given(words[1], values[0], three(1), three(4), three(7), ns, remark.strip())
    return answers


def witnesses_are_local(part: Path) -> bool:
    """Returns whether a program gives each witness point in its body's frame: it says so in a header line."""
    with open(part) as lines:
        return any(x.split() == ["#", "witness", "local"] for x in lines if x.startswith("#"))


@dataclass
class Tally:
    """Counts of one family."""

    cases: int = 0
    wrong: int = 0
    state: int = 0
    shallow: int = 0
    deep: int = 0
    tied: int = 0
    points: int = 0
    normal: int = 0
    no_answer: int = 0
    nan: int = 0
    crashed: int = 0
    timeout: int = 0
    errors: list[float] = field(default_factory=list)
    times: list[int] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        for name, value in vars(other).items():
            setattr(self, name, getattr(self, name) + value)

    @property
    def median_error(self) -> float:
        return statistics.median(self.errors) if self.errors else float("nan")

    @property
    def worst_error(self) -> float:
        return max(self.errors, default=float("nan"))

    @property
    def median_ns(self) -> float:
        return statistics.median(self.times) if self.times else float("nan")


def rotation(q: list[float]) -> np.ndarray:
    x, y, z, w = np.array(q, REAL) / np.sqrt(np.sum(np.array(q, REAL) ** 2))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ],
        REAL,
    )


class Judge:
    """Judges the answers of one engine with one set of options."""

    def __init__(
        self, engine: type[Adapter], shapes: dict[int, Shape], in_frame_of_a: bool, is_local: bool = False
    ) -> None:
        self.engine, self.shapes, self.in_frame_of_a, self.is_local = engine, shapes, in_frame_of_a, is_local
        self.planes: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def judge(self, case: Case, given: Given | None) -> tuple[Tally, float]:
        """Returns the counts of one case, and how bad it is: the error over the size, infinite without an answer."""
        t = Tally(cases=1)
        ends = {"crash": "crashed", "hang": "timeout"}
        if given is None or given.status in ends:
            setattr(t, ends[given.status] if given else "timeout", 1)
            return t, float("inf")
        numbers = [x for x in (given.distance, *(given.point_a or []), *(given.point_b or [])) if x is not None]
        if any(x != x for x in numbers):
            t.nan = 1
            return t, float("inf")
        if given.status not in ("sep", "touch", "pen"):
            t.no_answer = 1
            return t, float("inf")
        s, size = case.distance, case.size
        # In A's frame the pair was scaled to a size of about 1, and the tolerance with it.
        scale = 2.0 ** exponent(case) if self.in_frame_of_a else 1.0
        allowed = scale * self.engine.tolerance.of(size / scale)
        if given.nanoseconds is not None:
            t.times.append(given.nanoseconds)
        meets = given.status != "sep"
        t.state = int((s > allowed and meets) or (s < -allowed and not meets))
        t.tied = int(abs(s) <= allowed and given.status != case.state)
        error = 0.0
        wanted = "depth" if s < 0 else "distance"
        if given.distance is None or wanted not in self.engine.answers:
            # An engine that gives no distance is judged by the contact state alone.
            t.no_answer = int(wanted in self.engine.answers)
        else:
            error = abs(given.distance - s)
            t.errors.append(error / size)
            if s < -allowed and given.distance < 0:
                t.shallow = int(given.distance > s + allowed)
                t.deep = int(given.distance < s - allowed)
        t.wrong = int(bool(t.state) or error > allowed)
        if not t.wrong and not t.no_answer:
            self.judge_points(case, given, allowed, t)
        if t.no_answer and not t.wrong:
            return t, float("inf")
        return t, max(error, abs(s) if t.state else 0.0) / size

    def judge_points(self, case: Case, given: Given, allowed: float, t: Tally) -> None:
        """Counts witness points off the bodies or at another distance, and normals along which less is seen."""
        if self.in_frame_of_a:
            q, d = relative(case)
            qa, ta, qb, tb = [0, 0, 0, 1], [0, 0, 0], q, [x for x in d]
        else:
            qa, ta, qb, tb = case.qa, case.ta, case.qb, case.tb
        ra, rb, ta, tb = rotation(qa), rotation(qb), np.array(ta, REAL), np.array(tb, REAL)
        # World coordinates of points and poses are rounded: a unit in the last place of the largest is allowed.
        ulp = 3e-7 if self.engine.precision == "single" else 5e-16
        slack = allowed + ulp * float(max(np.abs(ta).max(), np.abs(tb).max(), case.size))
        if given.point_a is not None and given.point_b is not None:
            a, b = np.array(given.point_a, REAL), np.array(given.point_b, REAL)
            if self.is_local:
                a, b = ra @ a + ta, rb @ b + tb
                given = given._replace(point_a=a.astype(float).tolist(), point_b=b.astype(float).tolist())
            off = max(self.outside(case.a, ra.T @ (a - ta)), self.outside(case.b, rb.T @ (b - tb)))
            if not off <= slack:  # Planes of a needle are known exactly or not at all.
                bodies = ((case.a, qa, ta, given.point_a), (case.b, qb, tb, given.point_b))
                off = max(self.outside_exactly(*body) for body in bodies)
            length = float(np.sqrt(np.sum((a - b) ** 2)))
            t.points = int(not (off <= slack and abs(length - abs(case.distance)) <= 2 * slack))
        elif "points" in self.engine.answers and (case.distance > allowed):
            t.points = 1
        # Many engines derive the normal from the points, so it is noise at small distances.
        if given.normal is not None and abs(case.distance) > max(allowed, 1e-3 * case.size):
            n = np.array(given.normal, REAL)
            length = np.sqrt(n @ n)
            if not (np.isfinite(length) and length > 0.5):
                t.normal = 1
                return
            n = n / length
            seen = np.min(self.points(case.b) @ (rb.T @ n)) - np.max(self.points(case.a) @ (ra.T @ n)) + (tb - ta) @ n
            t.normal = int(not abs(case.distance - float(seen)) <= max(slack, 1e-4 * case.size))

    def points(self, shape: int) -> np.ndarray:
        return np.array(self.shapes[shape].points, REAL)

    def outside(self, shape: int, point: np.ndarray) -> float:
        """Returns how far a point is above the highest of the planes of a body; 0 for a flat body."""
        if shape not in self.planes:
            v, normals, at = self.points(shape), [], []
            for face in self.shapes[shape].faces:
                p = v[face]
                n = sum(np.cross(p[k] - p[0], p[k + 1] - p[0]) for k in range(1, len(face) - 1))
                normals.append(n / np.sqrt(n @ n))
                at.append(p[0])
            self.planes[shape] = np.array(normals, REAL), np.array(at, REAL)
        normals, at = self.planes[shape]
        return float(np.max(np.sum(normals * (point - at), 1))) if len(normals) else 0.0

    def outside_exactly(self, shape: int, q: list[float], t: np.ndarray, point: list[float]) -> float:
        """Returns the same for a point of the world, by rational numbers."""
        if not all(np.isfinite(point)):
            return float("inf")
        r = cases.rotation(q)
        d = [Fraction(x) - Fraction(float(y)) for x, y in zip(point, t)]
        local = [sum(r[i][k] * d[i] for i in range(3)) for k in range(3)]
        highest = Fraction(0)
        for face in self.shapes[shape].faces:
            p = [[Fraction(x) for x in self.shapes[shape].points[i]] for i in face]
            u, v = ([y - x for x, y in zip(p[0], corner)] for corner in (p[1], p[2]))
            n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
            height = sum(c * (x - y) for c, x, y in zip(n, local, p[0]))
            if height > 0:
                highest = max(highest, height * height / sum(c * c for c in n))
        return float(highest) ** 0.5
