#!/usr/bin/env python3
"""Checks a receipt: python3 verify.py [--all] RECEIPT [SCENE]

A receipt is a proof in a file that bodies stay apart, meet, or have a distance. Its format is in
crates/verify/docs/format.md, the lemmas are in proof.md there. This program shares no code with the checker in Rust.
It uses integers and fractions only: no floating point but to print numbers, and no search.

With SCENE, another receipt, the evidence is evaluated on the bodies and motions of SCENE. With --all, the answer names every
pair.

Exit codes: 0 the receipt holds, 1 it does not (the first line that fails is printed), 3 it cannot be read.
"""
import hashlib
import json
import re
import sys
from bisect import bisect
from decimal import Decimal
from fractions import Fraction as Q
from math import comb, isqrt, lcm

P = 128  # bits after the point
ONE = 1 << P
DEGREES = 4, 5  # of the polynomials: those of the checker in Rust, in its order
FACTORIAL = [1]
for _k in range(1, 12):
    FACTORIAL.append(FACTORIAL[-1] * _k)


def set_degree(degree):
    """Sets the degree of the polynomials, and the least common multiple of its binomials."""
    global D, W
    D, W = degree, lcm(*(comb(degree, j) for j in range(degree + 1)))


class Bad(Exception):
    """A line is not of the format."""


class Fails(Exception):
    """A line claims what is not proven."""


def need(truth, why):
    if not truth:
        raise Bad(why)


def prove(truth, why):
    if not truth:
        raise Fails(why)


# The grammar: a part of JSON, without blanks and escapes, and one written form for each number.

NUMBER = re.compile(r"(-?)0x([01])(?:\.([0-9a-f]{0,12}[1-9a-f]))?p(-?[1-9][0-9]{0,3}|0)\Z")
CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\\\u2028\u2029\u200e\u200f\u202a-\u202e\u2066-\u2069]")
HASH = re.compile(r"[0-9a-f]{64}\Z")


def parse(text):
    def unique(pairs):
        need(len(dict(pairs)) == len(pairs) <= 16, "a field is there twice, or too many fields")
        return dict(pairs)

    need(not CONTROL.search(text), "an escape or a control character")
    try:
        line = json.loads(text, object_pairs_hook=unique)
        same = json.dumps(line, separators=(",", ":"), ensure_ascii=False) == text
    except (ValueError, RecursionError) as why:
        raise Bad(f"not JSON: {why}") from None
    need(isinstance(line, dict) and line and same, "not one object without blanks")
    check_values(line, 1)
    return line


def check_values(value, depth):
    if isinstance(value, (dict, list)):
        need(depth <= 8, "nested too deep")
        for x in value.values() if isinstance(value, dict) else value:
            check_values(x, depth + 1)
    else:
        need(isinstance(value, str) or type(value) is int and 0 <= value < 10**9, "not a value of the format")


def kind(line):
    return next(iter(line))


def only(line, *known):
    need(isinstance(line, dict), "an object is expected")
    unknown = [key for key in line if key not in known]
    need(not unknown, f"unknown field {unknown}")


def get(line, key):
    need(key in line, f"field {key} is missing")
    return line[key]


def array(value, count=None):
    need(isinstance(value, list) and count in (None, len(value)), f"a list is expected, of {count} entries")
    return value


def text(value):
    need(isinstance(value, str), "a text is expected")
    return value


def whole(value):
    need(type(value) is int, "a whole number is expected")
    return value


def number(value):
    """A hex float in its written form, exactly."""
    parts = NUMBER.match(text(value))
    need(parts, f"not a number in its written form: {value[:40]}")
    sign, lead, rest, exponent = parts.groups()
    size = int(exponent)
    zero = lead == "0" and rest is None
    form = -1022 <= size <= 1023 if lead == "1" else size == (0 if zero else -1022)
    need(form and not (zero and sign), f"not a number in its written form: {value[:40]}")
    rest = rest or ""
    exact = Q(int(lead + rest, 16)) * Q(2) ** (size - 4 * len(rest))
    return -exact if sign else exact


def numbers(values, count):
    return [number(x) for x in array(values, count)]


def hash_text(value):
    need(HASH.match(text(value)), "not a SHA-256")
    return value


# Vectors of anything that can be added and multiplied.


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def minus(u, v):
    return [x - y for x, y in zip(u, v)]


def at_most(x, y, square):
    """x <= y sqrt(square), without a root."""
    if (x > 0) != (y < 0):
        return x * x <= y * y * square if x > 0 else x * x >= y * y * square
    return x <= 0


def root_above(q):
    """A number no less than the square root of a fraction, and little more."""
    return Q(isqrt((q.numerator << 2 * P) // q.denominator) + 1, ONE)


def shown(q):
    """A number as the checker in Rust prints it: the nearest double, without an exponent."""
    digits = format(Decimal(repr(float(q))), "f")
    return digits[:-2] if digits.endswith(".0") else digits


# Functions of time over an interval (lemmas 0 and 1).


class Taylor:
    """A function of x on [0, 1] within r of the sum of c[k] x^k; units of 2^-P."""

    __slots__ = ("c", "r")

    def __init__(self, c, r=0):
        self.c, self.r = c, r

    def __add__(self, o):
        a, b = (self.c, o.c) if len(self.c) >= len(o.c) else (o.c, self.c)
        return Taylor([x + y for x, y in zip(a, b)] + a[len(b) :], self.r + o.r)

    def __neg__(self):
        return Taylor([-x for x in self.c], self.r)

    def __sub__(self, o):
        return self + -o

    def __mul__(self, o):
        p = [0] * (len(self.c) + len(o.c) - 1)
        for i, x in enumerate(self.c):
            if x:
                for j, y in enumerate(o.c):
                    p[i + j] += x * y
        rest = sum(map(abs, p[D + 1 :])) + self.r * o.r
        rest += self.most() * o.r + o.most() * self.r
        kept = [z >> P for z in p[: D + 1]]
        return Taylor(kept, (rest >> P) + 1 + len(kept))

    def over(self, n):
        return Taylor([x // n for x in self.c], self.r // n + 1 + len(self.c))

    def most(self):
        return sum(map(abs, self.c))

    def net(self):
        """Bernstein coefficients of the polynomial, times W."""
        c = self.c + [0] * (D + 1 - len(self.c))
        return [sum(comb(k, j) * (W // comb(D, j)) * c[j] for j in range(k + 1)) for k in range(D + 1)]

    def sign(self):
        """The sign of a constant, 0 if not known."""
        return (self.c[0] > self.r) - (self.c[0] < -self.r)


def fixed(q):
    scaled = q.numerator << P
    return Taylor([scaled // q.denominator], 0 if scaled % q.denominator == 0 else 1)


def fixed_all(v):
    return [fixed(x) for x in v]


def polynomial(coefficients):
    """Encloses the sum of coefficients[k] x^k."""
    parts = fixed_all(coefficients)
    rest = sum(p.r for p in parts) + sum(abs(p.c[0]) for p in parts[D + 1 :])
    return Taylor([p.c[0] for p in parts[: D + 1]], rest)


def moved(p, span):
    """The coefficients in x of the polynomial p at t = start + length x."""
    start, length = span[0], span[1] - span[0]
    powers = [Q(1)]
    while len(powers) < len(p):
        powers.append(powers[-1] * start)
    each = range(len(p))
    return [sum(comb(j, k) * p[j] * powers[j - k] for j in each[k:]) * length**k for k in each]


def turn(square, angle):
    """sin(|a| v) / |a| and (1 - cos(|a| v)) / |a|^2 at v = sum of angle[k] x^k, with square = |a|^2 (lemma 1)."""
    start, way = angle[0], sum(map(abs, angle[1:]), Q(0))
    prove(square * start * start < 2**40 and square * way * way < 2**10, "turns too far")
    halvings = 0
    while square * start * start > Q(4) ** halvings / 4:
        halvings += 1
    n, y = fixed(square), fixed(start / 2**halvings)
    z, one = n * y * y, Taylor([ONE])
    s, u = one, one
    for j in range(17, 0, -1):
        s = one - (z * s).over(2 * j * (2 * j + 1))
        u = one - (z * u).over((2 * j + 1) * (2 * j + 2))
    s.r, u.r = s.r + 1, u.r + 1  # the first term left out is below 2^-170
    s, u = y * s, (y * y * u).over(2)
    for _ in range(halvings):
        c = one - n * u
        s, u = s * c, s * s
        s, u = s + s, u + u
    if way == 0:
        return s, u
    derivatives = [u, s, one - n * u]
    while len(derivatives) < D + 2:
        derivatives.append(-(n * derivatives[-2]))
    w, rho = polynomial([Q(0)] + angle[1:]), root_above(square) * way

    def series(first, rest):
        total = derivatives[first + D].over(FACTORIAL[D])
        for k in range(D - 1, -1, -1):
            total = total * w + derivatives[first + k].over(FACTORIAL[k])
        return Taylor(total.c, total.r + fixed(rest / FACTORIAL[D + 1]).c[0] + 1)

    return series(1, way * rho**D), series(0, way * way * rho ** (D - 1))


def least(net):
    """No value of a polynomial is less: the least Bernstein coefficient of its eighths."""
    nets = [net]
    for _ in range(3):
        halves = []
        for net in nets:
            net, first = list(net), [net[0]]
            for k in range(1, len(net)):
                for j in range(len(net) - k):
                    net[j] = (net[j] + net[j + 1]) >> 1
                first.append(net[0])
            halves += [first, net]
        nets = halves
    return min(map(min, nets))


# Steps from a body to the world; lengths are in units of a power of two.


def matrix(q):
    """The rotation of a quaternion x, y, z, w of about unit length, as fractions."""
    x, y, z, w = q
    n = x * x + y * y + z * z + w * w
    need(abs(n - 1) < Q(1, 1000), "not a unit quaternion")
    return [
        [1 - 2 * (y * y + z * z) / n, 2 * (x * y - z * w) / n, 2 * (x * z + y * w) / n],
        [2 * (x * y + z * w) / n, 1 - 2 * (x * x + z * z) / n, 2 * (y * z - x * w) / n],
        [2 * (x * z - y * w) / n, 2 * (y * z + x * w) / n, 1 - 2 * (x * x + y * y) / n],
    ]


def pose_of(values):
    all_ = numbers(values, 7)
    return matrix(all_[3:]), all_[:3]


IDENTITY = [[Q(int(i == j)) for j in range(3)] for i in range(3)], [Q(0)] * 3


def inverse(pose):
    rows, shift = pose
    back = [list(column) for column in zip(*rows)]
    return back, [-dot(row, shift) for row in back]


def rows_times(n, rows):
    return [dot(n, column) for column in zip(*rows)]


class Place:
    """A constant pose."""

    def __init__(self, pose, unit):
        rows, shift = pose
        self.rows, self.shift = [fixed_all(row) for row in rows], fixed_all([x * unit for x in shift])

    def plane(self, m, o, span):  # of m . (R x + p) + o the new m and o
        return rows_times(m, self.rows), o + dot(m, self.shift)

    def point(self, x, span):
        return [dot(row, x) + s for row, s in zip(self.rows, self.shift)]


class Shift:
    """A shift that is a polynomial in time, one list of coefficients for each axis."""

    def __init__(self, ways):
        self.ways = ways

    def way(self, span):
        return [polynomial(moved(w, span)) for w in self.ways]

    def plane(self, m, o, span):
        return m, o + dot(m, self.way(span))

    def point(self, x, span):
        return [a + b for a, b in zip(x, self.way(span))]


class Turn:
    """exp([axis] angle), the angle a polynomial in time."""

    def __init__(self, axis, angle):
        self.axis, self.square, self.angle, self.known = fixed_all(axis), dot(axis, axis), angle, {}

    def parts(self, span):
        if (D, span) not in self.known:
            self.known[D, span] = turn(self.square, moved(self.angle, span))
        return self.known[D, span]

    def plane(self, m, o, span):
        once = cross(m, self.axis)
        twice = cross(once, self.axis)
        s, u = self.parts(span)
        return [m[k] + s * once[k] + u * twice[k] for k in range(3)], o

    def point(self, x, span):
        once = cross(self.axis, x)
        twice = cross(self.axis, once)
        s, u = self.parts(span)
        return [x[k] + s * once[k] + u * twice[k] for k in range(3)]


def product(x, y):
    """A number no less than the product of two numbers that are not negative, in units of 2^-P."""
    return (x * y >> P) + 1


def above(q):
    """A fraction in units of 2^-P, rounded up."""
    return -((-q.numerator << P) // q.denominator)


def length(v):
    """No length of a vector of constants is larger."""
    return root_of(dot(v, v))


def root_of(square):
    """No root of a constant is larger."""
    return isqrt(max(square.c[0] + square.r, 0) << P) + 1


# What a receipt states.


class Body:
    def __init__(self, line, scene):
        self.half = half_space(line["half"]) if "half" in line else None
        flat = ("half",) if self.half else ("points", "parts", "faces", "ellipsoids", "radius", "radii", "larger", "repaired")
        only(line, "body", "name", "at", "link", "steady", *flat)
        count = len(scene.bodies)
        need(count < 4096 and whole(line["body"]) == count, f"body {count} is expected")
        self.at = pose_of(line["at"]) if "at" in line else None
        self.link = self.steady = None
        self.pivot, self.moves = [Q(0)] * 3, False
        if "link" in line:
            need("steady" not in line, "a body moves in one way")
            self.link = whole(line["link"])
            need(self.link <= len(scene.joints), "unknown link")
            self.moves = scene.carries(self.link)
            self.at = self.at or IDENTITY
        elif "steady" in line:
            only(line["steady"], "pivot", "linear", "angular", "push")
            self.steady = {k: numbers(get(line["steady"], k), 3) for k in ("pivot", "linear", "angular", "push")}
            self.pivot, self.moves = self.steady["pivot"], True
        need(self.at, "a body moves in one way: at, link, link and at, or at and steady")
        points = [["0x0p0"] * 3] if self.half else array(get(line, "points"))
        need(0 < len(points) <= 1 << 18, "number of points")
        self.points, self.solid = [numbers(p, 3) for p in points], "faces" in line
        need(not (self.solid and "parts" in line), "a body has parts or faces, not both")
        self.parts = self.lists(line["faces" if self.solid else "parts"]) if self.solid or "parts" in line else []
        self.ellipsoids = self.read_ellipsoids(line["ellipsoids"]) if "ellipsoids" in line else []
        need(not (self.ellipsoids and self.solid), "a body has faces or ellipsoids, not both")
        need(not ("radius" in line and "radii" in line), "a body has a radius or radii, not both")
        self.radii = [number(r) for r in array(line["radii"])] if "radii" in line else []
        need("radii" not in line or 0 < len(self.radii) == len(self.parts), "a radius for each part is expected")
        self.radius = max(self.radii) if self.radii else number(line["radius"]) if "radius" in line else Q(0)
        need(min([self.radius, *self.radii]) >= 0, "a negative radius")
        self.larger = number(line["larger"]) if "larger" in line else None
        need(self.larger is None or self.larger >= 0, "larger is negative")
        self.repaired = text(line["repaired"]) if "repaired" in line else None
        self.name = text(get(line, "name"))

    def lists(self, value):
        """The points of each part; those of a solid are triangles."""
        need(0 < len(array(value)) <= 1 << 18, "a body has 1 to 262144 parts")
        for part in value:
            sane = len(array(part)) == 3 or len(part) > 0 and not self.solid
            need(sane and all(whole(k) < len(self.points) for k in part), "a part, or a face that is no triangle")
        return value

    def read_ellipsoids(self, value):
        """The number of the centre and the semi-axes of each ellipsoid."""
        need(0 < len(array(value)) <= 1 << 18, "a body has 1 to 262144 ellipsoids")
        all_ = [(whole(k), [numbers(v, 3) for v in array(axes)]) for k, axes in (array(x, 2) for x in value)]
        sane = all(k < len(self.points) and len(axes) <= 3 and any(map(any, axes)) for k, axes in all_)
        need(sane, "an ellipsoid about an unknown point, without extent, or with more than three axes")
        return all_

    def of_parts(self, ends):
        """The points of some parts; None stands for all points."""
        some = self.parts[ends[0] : ends[1]]
        return sorted({k for part in some for k in part}) if len(some) < len(self.parts) else None

    def radius_of(self, ends):
        """The greatest radius of some parts."""
        return max(self.radii[ends[0] : ends[1]], default=self.radius)

    def ellipsoids_of(self, some):
        """The ellipsoids about some of the points, or all."""
        chosen = None if some is None else set(some)
        return [x for x in self.fixed_ellipsoids if chosen is None or x.centre in chosen]

    def lengths(self):
        ends = [x for _, axes in self.ellipsoids for v in axes for x in v] + ([self.half[1]] if self.half else [])
        return [x for p in self.points for x in p] + self.at[1] + ends

    def scaled(self, unit):
        """Points, ball and own steps in units of a power of two."""
        all_ = [fixed_all([x * unit for x in p]) for p in self.points]
        self.fixed = [[x.c[0] for x in p] for p in all_]
        self.inexact = max(x.r for p in all_ for x in p)
        self.most = [max(abs(p[k]) for p in self.fixed) + 1 for k in range(3)]
        squares = (sum((x - c) ** 2 for x, c in zip(p, self.pivot)) for p in self.points)
        self.fixed_ellipsoids = [Ellipsoid(k, axes, unit) for k, axes in self.ellipsoids]
        wider = max((x.radius for x in self.fixed_ellipsoids), default=Q(0))
        self.reach = root_above(max(squares) * unit * unit) + wider
        ends = [(min(p[k] for p in self.points), max(p[k] for p in self.points)) for k in range(3)]
        middle = [(low + high) / 2 for low, high in ends]
        squares = (sum((x - c) ** 2 for x, c in zip(p, middle)) for p in self.points)
        self.middle = fixed_all([x * unit for x in middle])
        self.round = root_above(max(squares) * unit * unit) + wider
        self.own = [Place(self.at, unit)]
        if self.steady:
            rows, shift = self.at
            lever = [dot(row, self.pivot) for row in rows]
            linear, push = self.steady["linear"], self.steady["push"]
            ways = [[(s + x) * unit, v * unit, g * unit / 2] for s, x, v, g in zip(shift, lever, linear, push)]
            spin = Turn(self.steady["angular"], [Q(0), Q(1)])
            self.own = [Shift(ways), spin, Place((rows, [-x for x in lever]), unit)]


class Ellipsoid:
    """An ellipsoid in units of a power of two (lemma 13)."""

    def __init__(self, centre, axes, unit):
        size = max(abs(x) for v in axes for x in v)
        self.centre, self.axes = centre, [fixed_all([x / size for x in v]) for v in axes]
        self.size = above(size * unit)
        # Of a ball about the centre that contains the ellipsoid.
        self.radius = root_above(max(sum(abs(dot(u, v)) for v in axes) for u in axes) * unit * unit)

    def square(self, m):
        """The square of the half height along m, over that of the size."""
        ways = (dot(m, axis) for axis in self.axes)
        return sum((way * way for way in ways), Taylor([0]))

    def half_height(self, m):
        """No half height along constants m is larger, in units of 2^-2P."""
        return self.size * root_of(self.square(m))

    def half_heights(self, m):
        """Bernstein coefficients no less than those of the half height along m, in units of 2^-2P / W."""
        square = self.square(m)
        net = [c + W * square.r for c in square.net()]
        s = isqrt((max(0, *net) // W + 1) << P) + 1
        squared = W * ((s * s >> P) + 1)
        return [self.size * (((c + squared) << P) // (2 * s) + 1) for c in net]


def half_space(value):
    """The normal and the end of a half-space."""
    normal, end = array(value, 2)
    normal, end = numbers(normal, 3), number(end)
    need(any(normal), "a half-space without a normal")
    return normal, end


class Joint:
    def __init__(self, line, scene):
        count = len(scene.joints) + 1
        self.kind = text(get(line, "kind"))
        need(self.kind in ("fixed", "turn", "slide"), "unknown kind of a joint")
        driven = ("axis", "drive") if self.kind != "fixed" else ()
        only(line, "joint", "parent", "kind", "origin", *driven)
        self.parent = whole(get(line, "parent"))
        need(count <= 1024 and whole(line["joint"]) == count and self.parent < count, f"joint {count} is expected")
        self.origin = pose_of(get(line, "origin"))
        self.moves, self.motion = scene.carries(self.parent), []
        if driven:
            coordinate, factor, offset = array(get(line, "drive"), 3)
            self.axis, self.moves = numbers(get(line, "axis"), 3), True
            need(whole(coordinate) < 1024, "coordinate")
            self.drive = coordinate, number(factor), number(offset)

    def set(self, rows, unit):
        """Sets the motion along Bezier control points."""
        if self.kind == "fixed":
            return
        coordinate, factor, offset = self.drive
        d, value = [row[coordinate] for row in rows], []
        for k in range(len(rows)):
            value.append(d[0] * comb(len(rows) - 1, k) * factor)
            d = [y - x for x, y in zip(d, d[1:])]
        value[0] += offset
        turns = self.kind == "turn"
        self.motion = [Turn(self.axis, value) if turns else Shift([[v * x * unit for v in value] for x in self.axis])]


ORDER = ["file", "base", "joint", "body", "ignored"]


class Scene:
    def __init__(self):
        self.files, self.base, self.joints, self.bodies = [], None, [], []
        self.ignored, self.at, self.coordinates = {}, 0, 0

    def carries(self, link):
        return link > 0 and self.joints[link - 1].moves

    def is_steady(self):
        return any(body.steady for body in self.bodies)

    def line(self, line):
        """Reads a line; false if it is none of a scene."""
        if kind(line) not in ORDER:
            return False
        order = ORDER.index(kind(line))
        need(order >= self.at, "a line of the scene out of order")
        self.at = order
        if order == 0:
            only(line, "file", "sha256")
            self.files.append((text(line["file"]), hash_text(get(line, "sha256"))))
        elif order == 1:
            only(line, "base")
            need(self.base is None, "a second base")
            self.base = pose_of(line["base"])
        elif order == 2:
            joint = Joint(line, self)
            self.joints.append(joint)
            if joint.kind != "fixed":
                self.coordinates = max(self.coordinates, joint.drive[0] + 1)
        elif order == 3:
            self.bodies.append(Body(line, self))
        else:
            only(line, "ignored", "why")
            need(text(get(line, "why")), "an ignored pair without a reason")
            for pair in self.star(line["ignored"]):
                need(pair not in self.ignored, "a pair is ignored twice")
                self.ignored[pair] = line["why"]
        return True

    def scaled(self):
        lengths = [x for b in self.bodies for x in b.lengths()] + [x for j in self.joints for x in j.origin[1]]
        most = max(map(abs, lengths + (self.base[1] if self.base else [])))
        bits = most.numerator.bit_length() - most.denominator.bit_length() + 1 if most else -1022
        self.unit = Q(2) ** -max(bits, -1022)
        self.base_step = [Place(self.base, self.unit)] if self.base else []
        for joint in self.joints:
            joint.place = Place(joint.origin, self.unit)
        for body in self.bodies:
            body.scaled(self.unit)

    def body_number(self, value):
        need(whole(value) < len(self.bodies), f"unknown body {value}")
        return value

    def pair(self, value):
        a, b = (self.body_number(x) for x in array(value, 2))
        need(a < b, "a pair has the lesser number first")
        return a, b

    def star(self, value):
        a, others = array(value, 2)
        a = self.body_number(a)
        pairs = [(min(a, b), max(a, b)) for b in map(self.body_number, array(others))]
        need(pairs and len(set(pairs)) == len(pairs), "a list of pairs: empty, or a pair twice")
        need(all(x != y for x, y in pairs), "a body with itself")
        return pairs

    def names(self, pair):
        return f"{self.bodies[pair[0]].name} against {self.bodies[pair[1]].name}"

    def all_parts(self, pair):
        return [(0, len(self.bodies[k].parts)) for k in pair]

    def radii(self, pair, parts):
        """The sum of the greatest radii of some parts."""
        return sum(self.bodies[k].radius_of(ends) for k, ends in zip(pair, parts))

    def moving(self, pair):
        return self.bodies[pair[0]].moves or self.bodies[pair[1]].moves

    def chain(self, link):
        """The joints between the base and a link, the base first."""
        chain = []
        while link > 0:
            chain.insert(0, self.joints[link - 1])
            link = chain[0].parent
        return chain

    def steps(self, body):
        """The steps from the world to a body."""
        if body.link is None:
            return body.own
        chain = [step for joint in self.chain(body.link) for step in [joint.place] + joint.motion]
        return self.base_step + chain + body.own

    def point(self, body, x, span):
        for step in reversed(self.steps(body)):
            x = step.point(x, span)
        return x

    def heights(self, body, some, n, span):
        """Least and greatest Bernstein coefficients of the heights of vertices along n; units of 2^-2P / W."""
        points = body.fixed if some is None else [body.fixed[k] for k in some]
        m, o = n, Taylor([0])
        for step in self.steps(body):
            m, o = step.plane(m, o, span)
        off = sum(a.r * b for a, b in zip(m, body.most)) + (o.r << P)
        off = W * (off + body.inexact * sum(part.most() + part.r for part in m))
        low, high = [], []
        for (x, y, z), b in zip(zip(*(part.net() for part in m)), o.net()):
            all_ = [x * p[0] + y * p[1] + z * p[2] for p in points]
            low.append(min(all_) + (b << P) - off)
            high.append(max(all_) + (b << P) + off)
        for ellipsoid in body.ellipsoids_of(some):
            centre = body.fixed[ellipsoid.centre]
            nets, halves = zip(*(part.net() for part in m)), ellipsoid.half_heights(m)
            for k, (n_, b, half) in enumerate(zip(nets, o.net(), halves)):
                at = dot(n_, centre) + (b << P)
                low[k], high[k] = min(low[k], at - half - off), max(high[k], at + half + off)
        return low, high

    def placed(self, number_):
        """The pose of a body at rest, exactly."""
        body = self.bodies[number_]
        need(not body.moves, "the claim is about bodies at rest")
        poses = [body.at]
        if body.link is not None:
            chain = self.chain(body.link)
            need(len(chain) <= 16, "more than 16 joints between a body at rest and the base")
            poses = ([self.base] if self.base else []) + [joint.origin for joint in chain] + poses
        rows, shift = poses[-1]
        for outer, step in reversed(poses[:-1]):
            shift = [dot(row, shift) + s for row, s in zip(outer, step)]
            rows = [rows_times(row, rows) for row in outer]
        return Placed(rows, shift, body.points)


class Placed:
    """The vertices of a body at rest, in the world."""

    def __init__(self, rows, shift, points):
        self.rows, self.shift, self.points = rows, shift, points

    def point(self, x):
        return [dot(row, x) + s for row, s in zip(self.rows, self.shift)]

    def vertex(self, k):
        return self.point(self.points[k])

    def heights(self, n, some=None):
        """Least and greatest height along n of some vertices, or of all."""
        m = rows_times(n, self.rows)
        all_ = [dot(m, p) for p in (self.points if some is None else [self.points[k] for k in some])]
        return min(all_) + dot(n, self.shift), max(all_) + dot(n, self.shift)


# Claims. Each is one lemma.


def no_half_space(scene, pair):
    need(not any(scene.bodies[k].half for k in pair), "a half-space has planes, cells and near points as evidence alone")


def floor_of(scene, pair, in_base):
    """Which of a pair is a half-space, the normal from A to B, its height along the normal (lemma 14), and the body
    if it moves, in whose frame both are then; or None."""
    sides = [side for side, k in enumerate(pair) if scene.bodies[k].half]
    if not sides:
        return None
    prove(len(sides) == 1, f"{scene.names(pair)}: two half-spaces")
    body = scene.bodies[pair[sides[0]]]
    moving, (normal, height) = body if body.moves and not in_base else None, body.half
    if not moving:
        placed = scene.placed(pair[sides[0]])
        rows, shift = placed.rows, placed.shift
        if in_base and scene.base:
            back, off = inverse(scene.base)
            shift = [dot(row, shift) + s for row, s in zip(back, off)]
            rows = [rows_times(row, rows) for row in back]
        normal = [dot(row, normal) for row in rows]
        height += dot(normal, shift)
    return (0, normal, height, moving) if sides[0] == 0 else (1, [-x for x in normal], -height, moving)


def floor_direction(scene, floor, span):
    """The normal in the world, and the origin of a half-space that moves."""
    _, normal, _, moving = floor
    if not moving:
        return fixed_all(normal), None
    foot = scene.point(moving, fixed_all([Q(0)] * 3), span)
    return minus(scene.point(moving, fixed_all(normal), span), foot), foot


def floor_heights(scene, floor, n, span):
    """Bernstein coefficients of the height along the normal, rounded away from the half-space, in units of 2^-2P / W."""
    height = floor_height(floor, scene.unit) * W
    feet = scene.heights(floor[3], None, n, span)[1 - floor[0]] if floor[3] else [0] * (D + 1)
    return [height + foot for foot in feet]


def floor_height(floor, unit):
    """The height of a half-space, rounded away from it, in units of 2^-2P."""
    side, _, height, _ = floor
    return above(height * unit) << P if side == 0 else -(above(-height * unit) << P)


def by_plane(scene, pair, span, kept, normal, spin, some=(None, None), floor=None):
    """Lemma 3, for some vertices of both bodies or for all."""
    n = floor_direction(scene, floor, span)[0] if floor else fixed_all(normal)
    if spin and span[0] != span[1]:
        n = Turn(spin, [Q(0), span[1] - span[0]]).point(n, (Q(0), Q(1)))

    def heights(side):
        if floor and floor[0] == side:
            return [floor_heights(scene, floor, n, span)] * 2
        return scene.heights(scene.bodies[pair[side]], some[side], n, span)

    (_, high), (low, _) = heights(0), heights(1)
    gap = min(y - x for x, y in zip(high, low))
    kept *= scene.unit
    return gap > 0 and Q(gap, W << 2 * P) ** 2 > kept * kept * dot(normal, normal)


def by_balls(scene, pair, span, kept):
    """Lemma 2."""
    a, b = (scene.bodies[k] for k in pair)
    reach = a.reach + b.reach + kept * scene.unit
    ends = [scene.point(body, fixed_all([x * scene.unit for x in body.pivot]), span) for body in (a, b)]
    way = minus(ends[1], ends[0])
    square = dot(way, way)
    return Q(least(square.net()) - W * square.r, W << P) > reach * reach


def hops(scene, link, body, middle):
    """The steps from a body to a link at a configuration, each with its joint and signed axis or None (lemma 9)."""
    body = scene.bodies[body]
    down, up = scene.chain(body.link or 0), scene.chain(link)
    while down and up and down[0] is up[0]:
        down, up = down[1:], up[1:]

    def motion(joint, sign):
        if joint.kind == "fixed":
            return []
        coordinate, factor, offset = joint.drive
        axis, value = [x * sign for x in joint.axis], middle[coordinate] * factor + offset
        if joint.kind == "turn":
            return [(Turn(axis, [value]), (joint, fixed_all(axis)))]
        axis = [x * scene.unit for x in axis]
        return [(Shift([[x * value] for x in axis]), (joint, fixed_all(axis)))]

    steps = [(step, None) for step in reversed(body.own)]
    if body.link is None and scene.base:
        steps.append((Place(inverse(scene.base), scene.unit), None))
    for joint in reversed(down):
        steps += [*motion(joint, 1), (joint.place, None)]
    for joint in up:
        steps += [(Place(inverse(joint.origin), scene.unit), None), *motion(joint, -1)]
    return steps


def remainder(body, steps, half, normal):
    """|n| R of lemma 9, in units of 2^-P."""
    x, reach, moved_, rest = body.middle, above(body.round), 0, 0
    for step, joint in steps:
        if joint:
            joint, axis = joint
            size, turns = length(axis), joint.kind == "turn"
            width = above(half[joint.drive[0]] * abs(joint.drive[1]))
            speed = length(cross(axis, x)) + product(size, reach + moved_) if turns else size
            way = product(speed, width)
            if turns:
                rest += product(product(size, width), moved_ + (way >> 1) + 1)
            moved_ += way
        x = step.point(x, INSTANT)
    return product(rest, length(fixed_all(normal)))


INSTANT = Q(0), Q(0)


def over_cell(scene, link, body, some, cell, normal):
    """The least and greatest heights of vertices, some or all, over a cell, in units of 2^-2P (lemma 9)."""
    half = [(high - low) / 2 for low, high in cell]
    steps = hops(scene, link, body, [(high + low) / 2 for low, high in cell])
    body = scene.bodies[body]
    rest = remainder(body, steps, half, normal)
    zero = Taylor([0])
    rows, slopes = [(fixed_all(normal), zero)], {}
    owners = []
    for step, joint in reversed(steps):
        rows = [step.plane(m, o, INSTANT) for m, o in rows]
        if joint:
            joint, axis = joint
            m, o = (cross(rows[0][0], axis), zero) if joint.kind == "turn" else ([zero] * 3, dot(rows[0][0], axis))
            factor = fixed(joint.drive[1])
            rows.append(([x * factor for x in m], o * factor))
            owners.append(joint.drive[0])
    for coordinate, (m, o) in zip(owners, rows[1:]):
        n, p = slopes.get(coordinate, ([zero] * 3, zero))
        slopes[coordinate] = [x + y for x, y in zip(m, n)], o + p

    def off(m, o):
        return (o.r << P) + sum(x.r * y + body.inexact * (x.most() + x.r) for x, y in zip(m, body.most))

    def height(p, m, o):
        return sum(x.c[0] * y for x, y in zip(m, p)) + (o.c[0] << P)

    slack = off(*rows[0]) + (rest << P)
    bends = [(m, o, off(m, o), above(half[c])) for c, (m, o) in slopes.items()]
    low = high = None
    points = [(p, None) for p in (body.fixed if some is None else [body.fixed[k] for k in some])]
    for p, ellipsoid in points + [(body.fixed[x.centre], x) for x in body.ellipsoids_of(some)]:
        # A point of an ellipsoid departs from the centre by half its height.
        wider = ellipsoid.half_height if ellipsoid else lambda m: 0
        bent = (h * ((abs(height(p, m, o)) + e + wider(m) >> P) + 1) for m, o, e, h in bends)
        loss = slack + wider(rows[0][0]) + sum(bent)
        at = height(p, *rows[0])
        low = at - loss if low is None else min(low, at - loss)
        high = at + loss if high is None else max(high, at + loss)
    return low, high


def in_cell(scene, pair, some, cell, link, normal, kept, floor):
    """Lemma 9."""

    def heights(side):
        if floor and floor[0] == side:
            return [floor_height(floor, scene.unit)] * 2
        return over_cell(scene, link, pair[side], some[side], cell, normal)

    (_, high), (low, _) = heights(0), heights(1)
    gap, kept = Q(low - high, ONE * ONE), kept * scene.unit
    return gap > 0 and gap * gap > kept * kept * dot(normal, normal)


def at_part(axis, at):
    return axis, whole(at)


def cut_cells(waiting, cuts, where, name):
    """Cuts the last cell, a list of ranges: the lower part is at hand next, the upper one waits."""
    for cut in array(cuts):
        axis, at = array(cut, 2)
        prove(waiting, f"{name}: a cut outside its cell")
        axis, at = where(whole(axis), at)
        cell = waiting[-1]
        prove(axis < len(cell) and cell[axis][0] < at < cell[axis][1], f"{name}: a cut outside its cell")
        both = ((at, cell[axis][1]), (cell[axis][0], at))
        waiting[-1:] = [[*cell[:axis], ends, *cell[axis + 1 :]] for ends in both]
        need(len(waiting) <= 4096, "more than 4096 cells wait")


class Cells:
    """The cells of a range: lemma 10."""

    def __init__(self, head):
        self.range = [tuple(numbers(x, 2)) for x in array(get(head, "range"))]
        self.margin = number(get(head, "margin"))
        sane = self.margin >= 0 and len(self.range) <= 1024 and all(low <= high for low, high in self.range)
        need(sane, "the margin is negative, or a range ends before its start, or more than 1024")
        self.now, self.waiting, self.done = None, [], set()

    def next(self, scene, pair, line):
        """The cell that a line proves, and what it keeps."""
        name = scene.names(pair)
        if self.now != pair:
            self.end_pair(scene)
            used = pair not in scene.ignored and scene.moving(pair)
            prove(used, f"{name}: a proof of a pair that is ignored or rests")
            prove(pair not in self.done, f"{name}: cells after the last cell")
            self.done.add(pair)
            # The ranges of the coordinates, then the parts of both bodies.
            self.now, self.waiting = pair, [[*self.range, *scene.all_parts(pair)]]
        cut_cells(self.waiting, line.get("cut", []), self.where, name)
        keep = number(line["keep"]) if "keep" in line else self.margin
        prove(keep >= self.margin, f"{name}: keeps {shown(keep)}, less than the margin")
        prove(self.waiting, f"{name}: cells after the last cell")
        return self.waiting.pop(), keep

    def where(self, axis, at):
        """A whole number is where the parts of a body are cut, a number where a range is."""
        count = len(self.range)
        if isinstance(at, int):
            return count + axis, whole(at)
        at = number(at)
        return axis if axis < count else count + 2, at

    def end_pair(self, scene):
        pair, waiting, self.now, self.waiting = self.now, self.waiting, None, []
        prove(not waiting, f"{scene.names(pair) if pair else ''}: {len(waiting)} cells without a proof")


class Moment:
    """Two bodies at a time; they rest if there is none."""

    def __init__(self, scene, line):
        self.scene, self.pair = scene, scene.pair(line[kind(line)])
        self.time = number(line["at"]) if "at" in line else None
        need((self.time is not None) == scene.moving(self.pair), "a pair that moves has a time, one that rests has none")
        self.span = (self.time or Q(0),) * 2
        need(scene.coordinates == 0 or 0 <= self.span[0] <= 1, "a time outside of a leg: it lasts from 0 to 1")

    def has(self, side, k):
        found = whole(k) < len(self.scene.bodies[self.pair[side]].points)
        prove(found, f"{self.scene.names(self.pair)}: no such vertex, {k}")
        return k

    def pair_of(self, value):
        """Reads a vertex of each body."""
        pair = [whole(k) for k in array(value, 2)]
        return [self.has(side, k) for side, k in enumerate(pair)]

    def in_part(self, *points):
        """The sum of the radii around points of both bodies.

        Refuses points that no single part has: their hull may be outside of the body. If several parts have them,
        the greatest radius counts.
        """
        total = Q(0)
        for k, on in zip(self.pair, points):
            body = self.scene.bodies[k]
            found = [body.radius_of((j, j + 1)) for j, part in enumerate(body.parts) if set(on) <= set(part)]
            prove(found or not body.parts, f"{self.scene.names(self.pair)}: points of several parts")
            total += max(found, default=body.radius)
        return total

    def placed(self):
        return [self.scene.placed(k) for k in self.pair]

    def names(self):
        return self.scene.names(self.pair)

    def text(self):
        when = f" at t = {shown(self.time)}" if self.time is not None else ""
        return " and ".join(self.scene.bodies[k].name for k in self.pair) + when

    def means(self, line):
        """Two points by weights of vertices, in the frames of the bodies, and the sum of the radii around them."""
        found, on = [], []
        for body, entries in zip(self.pair, array(get(line, "on"), 2)):
            is_half = self.scene.bodies[body].half
            need(not (is_half and array(entries)), "points of a half-space")
            on.append([(whole(k), number(w)) for k, w in (array(x, 2) for x in array(entries))] if not is_half else [(0, Q(1))])
            truth = any(w > 0 for _, w in on[-1]) and all(w >= 0 for _, w in on[-1])
            need(truth, "weights: one is negative, or none is positive")
        for side, pairs in enumerate(on):
            for k, _ in pairs:
                self.has(side, k)
        radii = self.in_part(*([k for k, _ in pairs] for pairs in on))
        for side, pairs in enumerate(on):
            total = sum(w for _, w in pairs)
            points = self.scene.bodies[self.pair[side]].points
            mean = [sum(w * points[k][i] for k, w in pairs) / total for i in range(3)]
            found.append(mean)
        return found, radii


def meet(scene, line):
    """Lemma 4: zero lies in the tetrahedron of four differences."""
    only(line, "meet", "at", "points")
    moment = Moment(scene, line)
    no_half_space(scene, moment.pair)
    pairs = [moment.pair_of(entry) for entry in array(get(line, "points"), 4)]
    moment.in_part(*zip(*pairs))
    if moment.time is None:
        a, b = moment.placed()
        d = [minus(a.vertex(i), b.vertex(j)) for i, j in pairs]
    else:

        def vertex(side, k):
            body = scene.bodies[moment.pair[side]]
            return scene.point(body, [Taylor([x], body.inexact) for x in body.fixed[k]], moment.span)

        d = [minus(vertex(0, i), vertex(1, j)) for i, j in pairs]

    def volume(i, j, k):
        x = dot(d[i], cross(d[j], d[k]))
        return x.sign() if isinstance(x, Taylor) else (x > 0) - (x < 0)

    signs = [volume(1, 2, 3), -volume(0, 2, 3), volume(0, 1, 3), -volume(0, 1, 2)]
    known = any(signs) if moment.time is None else all(signs)
    prove(known and (min(signs) > -1 or max(signs) < 1), f"{moment.text()} share a point: this is not seen")
    return f"{moment.text()} share a point"


def near_floor(scene, moment, floor, mean, reach):
    """A point of the body of a pair that is no half-space is at most `reach` above the half-space."""
    side, normal, height, _ = floor
    if moment.time is None:
        along = dot(normal, moment.placed()[1 - side].point(mean))
    else:
        body = scene.bodies[moment.pair[1 - side]]
        point = scene.point(body, fixed_all([c * scene.unit for c in mean]), moment.span)
        direction, foot = floor_direction(scene, floor, moment.span)
        height_of = dot(minus(point, foot) if foot else point, direction)
        along = Q(height_of.c[0] + (height_of.r if side == 0 else -height_of.r), ONE) / scene.unit
    return at_most(along - height if side == 0 else height - along, reach, dot(normal, normal))


def near(scene, line):
    """Lemma 5."""
    only(line, "near", "at", "within", "on")
    moment = Moment(scene, line)
    within = number(get(line, "within"))
    need(within >= 0, "within is negative")
    means, radii = moment.means(line)
    reach, floor = within + radii, floor_of(scene, moment.pair, False)
    if floor:
        truth = near_floor(scene, moment, floor, means[1 - floor[0]], reach)
    elif moment.time is None:
        way = minus(*(placed.point(x) for placed, x in zip(moment.placed(), means)))
        truth = dot(way, way) <= reach * reach
    else:
        bodies = (scene.bodies[k] for k in moment.pair)
        fixed_means = (fixed_all([c * scene.unit for c in x]) for x in means)
        way = minus(*(scene.point(body, x, moment.span) for body, x in zip(bodies, fixed_means)))
        square = dot(way, way)
        truth = Q(square.c[0] + square.r, ONE) <= (reach * scene.unit) ** 2
    said = f"{moment.text()} are at most {shown(within)} apart"
    prove(truth, f"{said}: this is not seen")
    return said


def nearest(moment, placed, line):
    """The way between the closest points of the flats through the named vertices, which lie within them, and the radii."""
    ends, edges, sides, on = [], [], [], []
    for side, names in enumerate(array(get(line, "on"), 2)):
        on.append([moment.has(side, k) for k in array(names)[:4]])
        corners = [placed[side].vertex(k) for k in on[-1]]
        need(corners, "a feature without vertex")
        for c in corners[1:]:
            sides.append(side)
            edges.append(minus(c, corners[0]) if side else minus(corners[0], c))
        ends.append(corners[0])
    radii = moment.in_part(*on)
    way = minus(ends[1], ends[0])
    need(len(edges) < 3, "features of more than four vertices")
    right = [-dot(e, way) for e in edges]
    square = [[dot(e, f) for f in edges] for e in edges]
    parts = []
    if len(edges) == 1:
        parts = [(right[0], square[0][0])]
    elif edges:
        d = square[0][0] * square[1][1] - square[0][1] ** 2
        first = right[0] * square[1][1] - right[1] * square[0][1]
        parts = [(first, d), (right[1] * square[0][0] - right[0] * square[0][1], d)]
    prove(all(d > 0 for _, d in parts), f"{moment.names()}: a feature without extent")
    parts = [x / d for x, d in parts]
    for side in (0, 1):
        own = [x for x, s in zip(parts, sides) if s == side]
        prove(all(x >= 0 for x in own) and sum(own) <= 1, f"{moment.names()}: a closest point outside its feature")
    return [w + sum(t * e[k] for t, e in zip(parts, edges)) for k, w in enumerate(way)], radii


def below(moment, placed, some, n, lower, of=""):
    """Some points of A, or all, are below some of B along n, by `lower` and more than 0."""
    gap = placed[1].heights(n, some[1])[0] - placed[0].heights(n, some[0])[1]
    prove(gap > 0, f"{moment.names()}: no gap along the normal{of}")
    prove(at_most(-gap, -lower, dot(n, n)), f"{moment.names()}: the lower bound is not proven{of}")


def groups(moment, placed, entries, lower):
    """Lemma 7: planes between groups of parts, which together are all pairs of parts."""
    bodies = [moment.scene.bodies[k] for k in moment.pair]
    waiting = [moment.scene.all_parts(moment.pair)]
    for cuts, normal in (array(entry, 2) for entry in array(entries)):
        cut_cells(waiting, cuts, at_part, moment.names())
        prove(waiting, f"{moment.names()}: a group after the last one")
        parts = [list(ends) for ends in waiting.pop()]
        some = [body.of_parts(ends) for body, ends in zip(bodies, parts)]
        below(moment, placed, some, numbers(normal, 3), lower + moment.scene.radii(moment.pair, parts), f" of parts {parts}")
    prove(not waiting, f"{moment.names()}: {len(waiting)} groups without a plane")
    return len(entries) == 1


def distance(scene, line):
    """Lemma 6."""
    only(line, "distance", "lower", "upper", "normal", "cells", "on")
    moment = Moment(scene, line)
    no_half_space(scene, moment.pair)
    need(not any(scene.bodies[k].ellipsoids for k in moment.pair), "a distance of a body with ellipsoids")
    placed = moment.placed()
    bounds = number(get(line, "lower")), number(get(line, "upper"))
    lower, upper = bounds
    need(not ("normal" in line and "cells" in line), "a distance has a normal or cells, not both")
    if "normal" in line or "cells" in line:
        (a, b), radii = moment.means(line)
        way = minus(placed[1].point(b), placed[0].point(a))
    else:
        way, radii = nearest(moment, placed, line)
    if "cells" in line:
        hulls_apart = groups(moment, placed, line["cells"], lower)
    else:
        hulls_apart = True
        lower += scene.radii(moment.pair, scene.all_parts(moment.pair))
        below(moment, placed, (None, None), numbers(line["normal"], 3) if "normal" in line else way, lower)
    upper += radii
    prove(upper >= 0 and dot(way, way) <= upper * upper, f"{moment.names()}: the upper bound is not proven")
    apart = "{} are at least {} and at most {} apart".format(moment.text(), *map(shown, bounds))
    if hulls_apart or not any(scene.bodies[k].solid for k in moment.pair):
        return apart
    return f"the surfaces of {apart}; not looked at: whether one is inside the other"


LINES = {"meet": meet, "near": near, "distance": distance}
EVIDENCE = ["plane", "balls", "outside", "cell", *LINES]


# The rules: what a claim requires of a scene, of its legs and of the kinds of lines. With another scene they are checked
# for each of the two files alone, and for the claim of the receipt about the other scene.


def of_scene(check, scene):
    need(scene.bodies and (scene.joints or not scene.base), "no body, or a base without joints")
    if check.cells:
        need(len(check.cells.range) >= scene.coordinates, "a range of each coordinate is expected")
        need(not scene.is_steady(), "a body that is steady, in a claim about configurations")


def of_leg(check, scene, before, leg):
    need(not check.cells, "a leg in a claim about configurations")
    need(0 < scene.coordinates <= len(leg[0]), "a leg without a coordinate for each joint, or without joints")
    if check.claim == "apart":
        inside, whole_ = 0 <= check.begin and check.until <= 1, (check.begin, check.until) == (0, 1)
        need(inside and (whole_ or not before), "the interval is not within a leg, or not all of each of several")
    need(not before or before[-1] == leg[0], "a leg does not start where the one before ends")
    # Its time would start again with the leg, and the body would jump back.
    need(not before or not scene.is_steady(), "several legs, and a body that is steady")


def of_line(check, scene, legs, kind_):
    need(check.claim != "scene", "evidence in a scene")
    alone = (kind_ == "cell") == (check.claim == "range")
    need(alone, "a claim about a range has cells alone, and no other claim has cells")
    need(legs > 0 or scene.coordinates == 0 or check.cells, "evidence before the first leg")
    need(kind_ in ("cell", *LINES) or check.claim == "apart", "this claim is of single lines")


# The file.


def read(raw):
    """The parsed lines, and whether the hash is that of the lines before the tail."""
    need(raw.endswith(b"\n"), "the file is empty, or its last line has no end")
    lines, raw_lines = [], raw.split(b"\n")[:-1]
    for k, bytes_ in enumerate(raw_lines):
        try:
            need(len(bytes_) <= 1 << 24, "longer than 16 MiB")
            lines.append(parse(bytes_.decode()))
        except (Bad, UnicodeDecodeError) as why:
            raise Bad(f"line {k + 1}: {why}") from None
    head, tail = lines[0], lines[-1]
    need(kind(head) == "receipt" and head["receipt"] == 1, "not a receipt of version 1")
    need(kind(tail) == "end", "the tail is missing")
    only(tail, "end", "sha256")
    need(whole(tail["end"]) == len(lines) - 1, "the tail counts other lines")
    stated = hash_text(get(tail, "sha256"))
    counted = b"".join(x + b"\n" for x in raw_lines[:-1])
    return lines[:-1], hashlib.sha256(counted).hexdigest() == stated


class Check:
    def __init__(self, lines):
        head = lines[0]
        self.lines, self.claim = lines, text(get(head, "claim"))
        fields = {"apart": ("from", "until", "margin"), "range": ("range", "margin"), "lines": (), "scene": ()}
        need(self.claim in fields, "unknown claim")
        only(head, "receipt", "claim", *fields[self.claim])
        self.cells = Cells(head) if self.claim == "range" else None
        if self.claim == "apart":
            self.begin, self.until, self.margin = (number(get(head, k)) for k in ("from", "until", "margin"))
            need(self.margin >= 0 and self.begin <= self.until, "margin or interval")
        self.scene, self.first, self.legs, self.stale = Scene(), len(lines), [], False
        for k, line in enumerate(lines[1:], 1):
            if not with_line(k + 1, self.scene.line, line):
                self.first = k
                break
        with_line(self.first + 1, of_scene, self, self.scene)
        for k, line in self.evidence():
            with_line(k, self.after, line)

    def evidence(self):
        return enumerate(self.lines[self.first :], self.first + 1)

    def after(self, line):
        """Checks a line after the scene by the rules, and keeps the leg that it states."""
        if kind(line) == "leg":
            leg = read_leg(line)
            of_leg(self, self.scene, self.legs[-1] if self.legs else None, leg)
            self.legs.append(leg)
        else:
            need(kind(line) in EVIDENCE, "unknown kind of a line, or a line out of order")
            of_line(self, self.scene, len(self.legs), kind(line))

    def replace(self, other):
        """Takes scene and legs of another receipt, if the claim can be about it; the pairs ignored stay."""
        names = [[b.name for b in scene.bodies] for scene in (self.scene, other.scene)]
        same = next((k for k, (x, y) in enumerate(zip(*names)) if x != y), min(map(len, names)))
        prove(names[0] == names[1], f"another scene: body {same} is not the same")
        try:
            of_scene(self, other.scene)
            for before, leg in zip([None, *other.legs], other.legs):
                of_leg(self, other.scene, before, leg)
        except Bad as why:
            raise Fails(f"another scene: {why}") from None
        other.scene.ignored = self.scene.ignored
        self.scene, self.legs, self.stale = other.scene, other.legs, True

    def run(self, hashed):
        """Returns the text; raises `Fails` at the first failure."""
        set_degree(DEGREES[-1])
        self.scene.scaled()
        self.said, self.failure, self.more = [], None, 0
        self.count, self.number, self.waiting = 0, 0, {}
        self.hulls_apart, self.cut = set(), set()  # pairs with a solid
        self.kept = {}  # what each pair keeps by all its evidence
        for k, line in self.evidence():
            self.number += kind(line) != "leg"
            self.note(k, self.number if kind(line) != "leg" else None, lambda: self.line(line))
        last = len(self.lines) + 1
        self.note(last, None, self.end_leg)
        self.note(last, None, lambda: prove(hashed, "the hash is not that of the lines"))
        self.note(last, None, lambda: prove(len(self.legs) == self.count, f"another scene: {len(self.legs)} legs, not {self.count}"))
        if self.claim == "apart":
            begin, until = shown(self.begin), shown(self.until)
            legs = f" of each of {self.count} legs" if self.count > 1 else ""
            self.tell(f"from t = {begin} until t = {until}{legs}")
        elif self.cells:
            self.margin = self.cells.margin
            each = (f"[{shown(low)}, {shown(high)}]" for low, high in self.cells.range)
            self.tell(f"at every configuration of {' x '.join(each)}")
        if not self.failure:
            self.note(1, None, lambda: prove(self.said, "nothing is claimed"))
        if self.failure:
            raise Fails(self.failure + (f"; {self.more} further failures)" if self.more else ")"))
        return self.said

    def note(self, line, number_, work):
        """Keeps the first failure and counts the others."""
        try:
            work()
        except (Bad, Fails) as why:
            if isinstance(why, Bad) and not self.stale:
                raise Bad(f"line {line}: {why}") from None
            self.more += self.failure is not None
            self.failure = self.failure or (f"certificate {number_}, " if number_ else "") + f"{why} (line {line}"

    def line(self, line):
        if kind(line) == "leg":
            return self.start_leg()
        of_line(self, self.scene, self.count, kind(line))
        if self.cells:
            return self.cell(line)
        if kind(line) in LINES:
            return self.said.append(LINES[kind(line)](self.scene, line) + self.of_leg())
        self.outside(line) if kind(line) == "outside" else self.apart(line)

    def cell(self, line):
        """A plane over a cell of a range."""
        only(line, "cell", "cut", "link", "normal", "keep")
        scene, pair = self.scene, self.scene.pair(line["cell"])
        cell, keep = self.cells.next(scene, pair, line)
        cell, parts = cell[:-2], cell[-2:]
        some = [scene.bodies[k].of_parts(ends) for k, ends in zip(pair, parts)]
        floor = floor_of(scene, pair, True)
        if floor:
            only(line, "cell", "cut", "keep")
            link, normal = 0, floor[1]
        else:
            link, normal = whole(get(line, "link")), numbers(get(line, "normal"), 3)
        need(link <= len(scene.joints), f"unknown link {link}")
        self.keeps(pair, keep)
        if any(scene.bodies[k].solid for k in pair):
            (self.hulls_apart if some == [None, None] else self.cut).add(pair)
        kept = keep + scene.radii(pair, parts)
        truth = in_cell(scene, pair, some, cell, link, normal, kept, floor)
        middle = ", ".join(shown((low + high) / 2) for low, high in cell)
        prove(truth, f"{scene.names(pair)}, about [{middle}]")

    def of_leg(self):
        return f" of leg {self.count}" if self.count > 1 else ""

    def must_prove(self, pair):
        used = pair not in self.scene.ignored and self.scene.moving(pair)
        prove(used, f"{self.scene.names(pair)}: a proof of a pair that is ignored or rests")

    def cell_at_hand(self, pair, span, cuts):
        """Cuts the cell of parts at hand and returns its parts (lemma 11)."""
        name = self.scene.names(pair)
        self.must_prove(pair)
        waiting, starts = self.waiting.setdefault(pair, ([self.scene.all_parts(pair)], [self.begin]))
        cut_cells(waiting, cuts, at_part, name)
        prove(waiting, f"{name}: a proof after the last one")
        # A cut is for the time that is left, in both parts.
        starts += starts[-1:] * (len(waiting) - len(starts))
        start, parts = starts[-1], waiting[-1]
        why = f"{name}: a proof from t = {shown(span[0])}, after one until t = {shown(start)}"
        prove(span[0] == start <= span[1] <= self.until, why)
        return parts

    def apart(self, line):
        """Lemmas 8 and 11, and lemma 2 or 3 for each pair."""
        plane = kind(line) == "plane"
        only(line, kind(line), "from", "until", "keep", *(("normal", "spin", "cut") if plane else ()))
        usual = {"from": self.begin, "until": self.until, "keep": self.margin}
        start, until, keep = (number(line[k]) if k in line else x for k, x in usual.items())
        pairs = [self.scene.pair(line["plane"])] if plane else self.scene.star(line["balls"])
        if plane:
            floor = floor_of(self.scene, pairs[0], False)
            if floor:
                only(line, "plane", "from", "until", "keep", "cut")
            normal = floor[1] if floor else numbers(get(line, "normal"), 3)
            spin = numbers(line["spin"], 3) if "spin" in line else None
        for pair in pairs if not plane else []:
            no_half_space(self.scene, pair)
        cuts = array(line.get("cut", []))
        prove(keep >= self.margin, f"{self.scene.names(pairs[0])}: keeps {shown(keep)}, less than the margin")
        failed, span = None, (start, until)
        for pair in pairs:
            parts = self.cell_at_hand(pair, span, cuts)
            some = [self.scene.bodies[k].of_parts(ends) for k, ends in zip(pair, parts)]
            kept = keep + self.scene.radii(pair, parts)
            more = (by_plane, normal, spin, some, floor) if plane else (by_balls,)
            self.keeps(pair, keep)
            holds = any(self.holds(degree, pair, span, kept, *more) for degree in DEGREES)
            failed = failed if holds else failed or pair
            if any(self.scene.bodies[k].solid for k in pair):
                (self.hulls_apart if not plane or some == [None, None] else self.cut).add(pair)
            waiting, starts = self.waiting[pair]
            if until == self.until:
                waiting.pop()
                starts.pop()
            else:
                starts[-1] = until
        prove(failed is None, f"{self.scene.names(failed or pairs[0])}, at t = {shown(start)}{self.of_leg()}")

    def keeps(self, pair, keep):
        """Notes what a pair keeps by a line."""
        self.kept[pair] = min(keep, self.kept.get(pair, keep))

    def outside(self, line):
        """The hulls of two bodies are apart at a time: neither body is inside the other."""
        only(line, "outside", "at", "normal")
        pair, time = self.scene.pair(line["outside"]), number(get(line, "at"))
        normal = numbers(get(line, "normal"), 3)
        no_half_space(self.scene, pair)
        self.must_prove(pair)
        kept = self.scene.radii(pair, self.scene.all_parts(pair))
        holds = (self.holds(degree, pair, (time, time), kept, by_plane, normal, None) for degree in DEGREES)
        truth = self.begin <= time <= self.until and any(holds)
        prove(truth, f"{self.scene.names(pair)}: the hulls are not apart")
        self.hulls_apart.add(pair)

    def holds(self, degree, pair, span, kept, lemma, *more):
        set_degree(degree)
        try:
            return lemma(self.scene, pair, span, kept, *more)
        except Fails:
            return False

    def start_leg(self):
        before, self.count = self.count, self.count + 1
        prove(before < len(self.legs), "another scene: a leg is missing")
        for joint in self.scene.joints:
            joint.set(self.legs[before], self.scene.unit)
        if before:
            self.end_leg()

    def end_leg(self):
        proven, self.waiting = self.waiting, {}
        if self.cells:
            self.cells.end_pair(self.scene)
            proven = self.cells.done
        elif self.claim == "apart":
            for pair, (waiting, starts) in sorted(proven.items()):
                until = shown(starts[-1]) if waiting else ""
                prove(not waiting, f"{self.scene.names(pair)} is proven until t = {until} only")
        else:
            return
        moving = [b.moves for b in self.scene.bodies]
        every, movers = range(len(moving)), [k for k, moves in enumerate(moving) if moves]
        for a in every:
            for b in every[a + 1 :] if moving[a] else movers[bisect(movers, a) :]:
                done = (a, b) in proven or (a, b) in self.scene.ignored
                prove(done, f"no proof of {self.scene.names((a, b))}")

    def tell(self, when):
        """Says what a claim of all pairs proves, and what it leaves out."""
        count, bodies = len(self.scene.bodies), self.scene.bodies
        pairs = [(a, b) for a in range(count) for b in range(a + 1, count) if (a, b) not in self.scene.ignored]
        moving = [pair for pair in pairs if self.scene.moving(pair)]
        if not moving:
            return
        stay = "pair of bodies stays" if len(moving) == 1 else "pairs of bodies stay"
        more = [(pair, keep) for pair, keep in sorted(self.kept.items()) if float(keep) > float(self.margin)]
        self.said += [
            f"{len(moving)} {stay} more than {shown(self.margin)} apart {when}",
            "these are all pairs with a body that moves, but for those listed below; moving: "
            + ", ".join(b.name for b in bodies if b.moves)
            + "; at rest: "
            + ", ".join(b.name for b in bodies if not b.moves),
            *self.grouped((pair, f"more than {shown(keep)} apart") for pair, keep in more),
        ]

    def grouped(self, pairs):
        """The lines of statements about pairs; one line for all pairs with one statement, or for each."""
        groups = {}
        for pair, text_ in pairs:
            groups.setdefault(text_, []).append(self.scene.names(pair))
        for text_, names in groups.items():
            if self.all or len(names) == 1:
                yield from (f"{name}: {text_}" for name in names)
            else:
                yield f"{len(names)} pairs: {text_}, such as {names[0]}"

    def text(self):
        scene = self.scene
        yield f"holds: {self.number} certificates"
        yield from (f"proven: {x}" for x in self.said)
        if self.claim in ("apart", "range"):
            inside = "whether one is inside the other; their surfaces stay apart"
            unseen = [*self.grouped(sorted(scene.ignored.items()))]
            unseen += self.grouped((pair, inside) for pair in sorted(self.cut - self.hulls_apart))
            yield from (f"not looked at: {x}" for x in unseen)
            for body in scene.bodies:
                if body.larger is not None:
                    larger = f"how much larger {body.name} is than the body it stands for"
                    yield f"not looked at: {larger}; by at most {shown(body.larger)}, it says"
                if body.repaired is not None:
                    yield f"not looked at: the mesh of {body.name} before its repair; changed, it says: {body.repaired}"
            count = len(scene.bodies)
            pairs = ((a, b) for a in range(count) for b in range(a + 1, count))
            resting = sum(not scene.moving(x) and x not in scene.ignored for x in pairs)
            if resting:
                pairs = "pair" if resting == 1 else "pairs"
                yield f"not looked at: {resting} {pairs} of bodies that both rest"
        yield from (f"not compared: file {name} with SHA-256 {sha}" for name, sha in scene.files)


def with_line(k, work, *values):
    try:
        return work(*values)
    except Bad as why:
        raise Bad(f"line {k}: {why}") from None


def read_leg(line):
    only(line, "leg")
    rows = [[number(x) for x in array(row)] for row in array(line["leg"])]
    same = 1 <= len(rows) <= 17 and len(rows[0]) <= 1024 and all(len(row) == len(rows[0]) for row in rows)
    need(same, "a leg has 1 to 17 rows of equal length, at most 1024")
    return rows


def verify(receipt, other=None, all_=False):
    """Checks the bytes of a receipt; returns the lines of the answer. Raises `Fails` or `Bad`."""
    lines, hashed = read(receipt)
    check = Check(lines)
    check.all = all_
    if other is not None:
        try:
            other_lines, other_hashed = read(other)
            need(other_hashed, "the hash is not that of the lines")
            found = Check(other_lines)
        except Bad as why:
            raise Bad(f"other scene: {why}") from None
        check.replace(found)
    check.run(hashed)
    return list(check.text())


def main(names):
    all_, names = "--all" in names, [name for name in names if name != "--all"]
    if not 1 <= len(names) <= 2:
        print("usage: verify.py [--all] RECEIPT [SCENE]", file=sys.stderr)
        return 3
    try:
        contents = []
        for name in names:
            with open(name, "rb") as file:
                contents.append(file.read())
        print("\n".join(verify(*contents, all_=all_)))
        return 0
    except Fails as why:
        print(f"{'stale' if len(names) > 1 else 'does not hold'}: {why}")
        return 1
    except (Bad, OSError) as why:
        print(f"cannot be read: {why}")
        return 3


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
