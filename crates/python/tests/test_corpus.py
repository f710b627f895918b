"""Class, distance and predicates of the hard cases of the repository, as the exact oracle has them."""

import json
from pathlib import Path

import numpy as np
import pytest

import lin_canny as lc

CORPUS = Path(__file__).parents[3] / "tests" / "corpus"
STATES = {"sep": "separated", "touch": "touching", "pen": "overlapping"}

pytestmark = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of the repository is not at hand")


def body(given):
    """The body of a case, and its radius; None for a recipe other than a box."""
    if isinstance(given, str):
        kind, *numbers = given.split()
        if kind != "box":
            return None
        half = [float(x) for x in numbers]
        return lc.Geometry.box(*half), float(np.linalg.norm(half))
    points = np.asarray(given, dtype=float)
    radius = float(np.linalg.norm(points, axis=1).max())
    if len(points) == 1:
        return lc.Geometry.point(points[0]), radius
    if len(points) == 2:
        return lc.Geometry.segment(points[0], points[1]), radius
    try:
        return lc.Geometry.hull(points), radius
    except lc.GeometryError:
        return lc.Geometry.polygon(points), radius


def pose(given):
    return tuple(given["t"]), tuple(given.get("q", (0, 0, 0, 1)))


def cases():
    for path in sorted(CORPUS.glob("*.json")):
        for case in json.loads(path.read_text()):
            bodies = [body(case[side]) for side in "ab"]
            if None in bodies:
                continue
            for frame in case.get("frames", [case]):
                yield case, bodies, {**case, **frame}


def test_hard_cases_of_the_repository():
    asked = 0
    for case, [(a, radius_a), (b, radius_b)], frame in cases():
        poses = pose(frame["pose_a"]), pose(frame["pose_b"])
        size = radius_a + radius_b + float(np.linalg.norm(np.subtract(poses[1][0], poses[0][0])))
        for first, second, place in [(a, b, poses), (b, a, poses[::-1])]:
            tracker = lc.PairTracker()
            found = tracker.closest(first, second, *place)
            told = f"{case['name']}: {found}"
            assert found.state == STATES[frame["class"]], told
            assert found.lower <= found.distance <= found.upper, told
            if "distance" in frame:
                assert found.lower <= frame["distance"] <= found.upper, told
                assert abs(found.distance - frame["distance"]) <= 1e-13 * size, told
            assert tracker.intersects(first, second, *place) == (frame["class"] != "sep"), told
            asked += 1
    assert asked > 300
