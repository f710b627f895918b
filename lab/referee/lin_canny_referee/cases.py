"""Reads files of cases (`tests/CASES.md` of lin-canny describes them), and puts one body into the other's frame."""

from __future__ import annotations

import json
import math
import subprocess
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

DATA = Path(__file__).parent / "data"
EXTREME = ("far", "tiny", "huge", "ratios", "flat")
"""Families of the suite `extreme`; the suite `core` has all others."""


class Pose:
    """A rotation, then a translation. `quaternion` is x, y, z, w and unit up to rounding; `matrix` is the rotation."""

    def __init__(self, quaternion: list[float], position: list[float]) -> None:
        length = math.sqrt(math.fsum(x * x for x in quaternion))
        self.quaternion = [x / length for x in quaternion]
        self.position = list(position)
        x, y, z, w = self.quaternion
        self.matrix = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]


@dataclass(frozen=True)
class Shape:
    """A body: the hull of its points, with exactly planar faces, or none if it is flat."""

    name: str
    points: list[list[float]]
    faces: list[list[int]]


@dataclass(frozen=True)
class Case:
    """Two bodies at two poses, as the file states them, and what is true."""

    number: int
    family: str
    level: str
    a: int
    b: int
    qa: list[float]
    ta: list[float]
    qb: list[float]
    tb: list[float]
    state: str
    distance: float
    size: float


def read(path: str | Path) -> tuple[dict[int, Shape], list[Case]]:
    """Returns the shapes and the cases of a file."""
    shapes: dict[int, Shape] = {}
    cases: list[Case] = []
    with open(path) as lines:
        for line in lines:
            j = json.loads(line)
            if j["t"] == "shape":
                v = j["v"]
                shapes[j["id"]] = Shape(j["name"], [v[k : k + 3] for k in range(0, len(v), 3)], j["f"])
            elif j["t"] == "case":
                poses = [j[k] for k in ("qa", "ta", "qb", "tb")]
                cases.append(Case(j["id"], j["fam"], j["lvl"], j["a"], j["b"], *poses, j["cls"], j["s"], j["L"]))
    return shapes, cases


def rotation(q: list[float]) -> list[list[Fraction]]:
    """Returns the rotation of a quaternion of any length, exactly."""
    x, y, z, w = map(Fraction, q)
    n = x * x + y * y + z * z + w * w
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return [[c / n for c in row] for row in rows]


def relative(case: Case) -> tuple[list[float], list[float]]:
    """Returns the pose of B in the frame of A, rounded once."""
    ax, ay, az, aw = map(Fraction, case.qa)
    bx, by, bz, bw = map(Fraction, case.qb)
    ax, ay, az = -ax, -ay, -az
    q = [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
    r = rotation(case.qa)
    d = [Fraction(b) - Fraction(a) for a, b in zip(case.ta, case.tb)]
    return [float(x) for x in q], [float(sum(r[i][k] * d[i] for i in range(3))) for k in range(3)]


def exponent(case: Case) -> int:
    """Returns k so that the pair scaled by 2^-k has a size between 1/2 and 1."""
    return math.frexp(case.size)[1]


def posed(case: Case, in_frame_of_a: bool) -> tuple[int, Pose, Pose]:
    """Returns the poses that an engine is asked, and the power of two by which lengths are divided."""
    if not in_frame_of_a:
        return 0, Pose(case.qa, case.ta), Pose(case.qb, case.tb)
    k = exponent(case)
    q, t = relative(case)
    return k, Pose([0, 0, 0, 1], [0, 0, 0]), Pose(q, [math.ldexp(x, -k) for x in t])


def scaled(points: list[list[float]], k: int) -> list[list[float]]:
    """Divides points by 2^k."""
    return [[math.ldexp(x, -k) for x in p] for p in points] if k else points


def make(program: str, out: Path, options: list[str]) -> None:
    """Runs the program `cases` of lin-canny, and writes its output to a file."""
    try:
        with open(out, "w") as file:
            subprocess.run([program, *options], stdout=file, check=True)
    except FileNotFoundError:
        raise SystemExit(
            f"no program {program!r}: build it by `cargo build --release -p cases` in a checkout of lin-canny, "
            "and name it by --cases"
        ) from None


def belongs(family: str, suite: str) -> bool:
    """Returns whether a suite has a family."""
    return suite == "standard" or (family in EXTREME) == (suite == "extreme")
