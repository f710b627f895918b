import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lin_canny as lc

BOX = lc.Geometry.box(1, 1, 1)
ONE = (0, 0, 0, 1)
unit = st.floats(-1, 1)


def matrix(q, p, dtype=float):
    """Return the pose of a unit quaternion xyzw and a position."""
    x, y, z, w = q
    m = np.eye(4, dtype=dtype)
    m[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    m[:3, 3] = p
    return m


def quaternion(turn):
    q = np.array([*turn, 1.5])
    return q / np.linalg.norm(q)


@given(st.tuples(unit, unit, unit), st.tuples(unit, unit, unit))
@settings(max_examples=200, deadline=None)
def test_all_forms_of_a_pose_agree(turn, at):
    q, p = quaternion(turn), np.array(at) * 5
    tracker, m = lc.PairTracker(), matrix(q, p)
    forms = [
        m, np.asfortranarray(m), m.tolist(), np.repeat(m, 2, 0)[::2], (p, q), (tuple(p), tuple(q)), [*p, *q],
        np.array([*p, *q]), (list(p), list(q)),
    ]  # fmt: skip
    found = [tracker.closest(BOX, BOX, None, form) for form in forms]
    for c in found:
        assert c.lower <= c.distance <= c.upper
        assert abs(c.distance - found[0].distance) < 1e-13
        assert np.linalg.norm(c.point_b - c.point_a) == pytest.approx(abs(c.distance), abs=1e-12)
        # Points of nearly parallel edges may lie anywhere where the distance is the same to rounding.
        assert np.allclose(c.point_b - c.point_a, c.distance * c.normal, atol=1e-6)
    single = tracker.distance(BOX, BOX, None, matrix(q, p, np.float32))
    assert single == pytest.approx(found[0].distance, abs=2e-5)


@given(st.tuples(unit, unit, unit), st.tuples(unit, unit, unit), st.floats(-2, 2))
@settings(max_examples=200, deadline=None)
def test_a_common_motion_changes_nothing(turn, at, shift):
    q, p = quaternion(turn), np.array(at) * 5
    world = matrix(quaternion((shift, 0.3, -0.2)), (shift, 1, 2))
    tracker = lc.PairTracker()
    here = tracker.closest(BOX, BOX, None, (p, q))
    there = tracker.closest(BOX, BOX, world, world @ matrix(q, p))
    assert here.distance == pytest.approx(there.distance, abs=1e-12)
    if here.distance > 0.1:  # nearly parallel faces have many closest points, at one distance
        assert np.allclose(world[:3, :3] @ here.normal, there.normal, atol=1e-6)
    assert tracker.intersects(BOX, BOX, None, (p, q)) == (here.state != "separated")
    assert tracker.within(BOX, BOX, max(here.upper, 0), None, (p, q))
    assert here.lower <= 0 or not tracker.within(BOX, BOX, math.nextafter(here.lower, 0), None, (p, q))


def test_quaternions_are_xyzw():
    bar, ball = lc.Geometry.box(2, 0.1, 0.1), lc.Geometry.ball(0.1)
    s = math.sqrt(0.5)
    about_z = ((0, 0, 0), (0, 0, s, s))
    assert lc.PairTracker().distance(bar, ball, about_z, ((0, 1.5, 0), ONE)) < 0
    assert lc.PairTracker().distance(bar, ball, ((0, 0, 0), (s, 0, 0, s)), ((0, 1.5, 0), ONE)) > 1


def test_closest_by_hand():
    c = lc.PairTracker().closest(BOX, BOX, ((10, 0, 0), ONE), ((13, 0.5, 0), ONE))
    assert (c.distance, c.state, c.parts) == (1, "separated", (0, 0))
    assert c.lower <= 1 <= c.upper and c.upper - c.lower < 1e-12
    assert c.point_a[0] == 11 and c.point_b[0] == 12 and np.array_equal(c.normal, [1, 0, 0])
    assert repr(c).startswith("<Closest separated: 1.000000 in [")
    again = pickle.loads(pickle.dumps(c))
    assert repr(again) == repr(c) and np.array_equal(again.point_b, c.point_b)
    deep = lc.PairTracker().closest(BOX, BOX, None, ((1.5, 0, 0), ONE))
    assert deep.distance == pytest.approx(-0.5) and deep.state == "overlapping"
    assert lc.PairTracker().closest(BOX, BOX, None, ((2, 0, 0), ONE)).state == "touching"


def test_tracker_is_pickled_without_its_memory():
    tracker = lc.PairTracker()
    before = tracker.distance(BOX, BOX, None, ((3, 0, 0), ONE))
    assert pickle.loads(pickle.dumps(tracker)).distance(BOX, BOX, None, ((3, 0, 0), ONE)) == before


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        (np.eye(3), r"pose is \(3, 3\) \(expected \(4, 4\), or \(7,\) with position"),
        (np.eye(4) * 2, "last row"),
        (np.diag([1, 1, -1, 1.0]), "reflection"),
        (np.diag([1.1, 1, 1, 1]), r"R\^T R - 1 is 2.1e-1"),
        (((0, 0, 0), (0, 0, 0, 2)), "squared norm is 4"),
        (((0, 0), ONE), r"position has 2 numbers \(expected 3\)"),
        (((0, 0, 0), ONE, 1), "3 items"),
        (np.zeros(3), r"pose is \(3,\)"),
        (3, "type int"),
        ("x", "pose"),
        (np.full((4, 4), math.nan), "last row"),
    ],
)
def test_refused_poses(pose, words):
    with pytest.raises(lc.PoseError, match=words):
        lc.PairTracker().distance(BOX, BOX, None, pose)


def test_an_infinite_translation_names_the_body():
    m = np.eye(4)
    m[0, 3] = math.inf
    with pytest.raises(lc.PoseError, match="translation of B"):
        lc.PairTracker().distance(BOX, BOX, None, m)


def test_contacts_of_a_box_on_a_floor():
    floor, box = lc.Geometry.box(5, 5, 1), lc.Geometry.box(0.5, 0.5, 0.5)
    at = ((1, 0, 1.49), ONE)
    for ground in (floor, lc.Geometry.mesh(floor.vertices, floor.triangles)):
        found = lc.PairTracker().contacts(ground, box, None, at, prediction=0.02)
        assert len(found) == 4 and set(found["group"]) == {0}
        assert np.allclose(found["separation"], -0.01) and np.allclose(found["normal"], [0, 0, 1])
        assert sorted(map(tuple, found["point_b"][:, :2].round(9))) == [
            (0.5, -0.5), (0.5, 0.5), (1.5, -0.5), (1.5, 0.5),
        ]  # fmt: skip
    apart = lc.PairTracker().contacts(floor, box, None, ((0, 0, 2), ONE), prediction=0.02)
    assert len(apart) == 0 and apart.dtype.names[3] == "separation"
    with pytest.raises(lc.LinCannyError, match="max_points is 9"):
        lc.PairTracker().contacts(floor, box, max_points=9)


def test_penetration_of_solids():
    cube = lc.Geometry.mesh(BOX.vertices, BOX.triangles)
    found = lc.PairTracker().penetration(cube, lc.Geometry.ball(0.5), None, ((0, 0, 1.25), ONE))
    assert found.lower <= 0.25 <= found.upper < 0.2501
    assert np.allclose(found.shift, [0, 0, 0.25], atol=1e-3)
    sheet = lc.Geometry.mesh(np.eye(3), [[0, 1, 2]])
    assert lc.PairTracker().penetration(sheet, BOX) is None


def test_overlap_of_solids():
    cube = lc.Geometry.mesh(BOX.vertices, BOX.triangles)
    half = np.abs(BOX.vertices).max(axis=0)
    shift = np.array([0.5, 0.25, 0.0]) * half
    found = lc.PairTracker().overlap(cube, BOX, ((1, 2, 3), ONE), (np.array([1, 2, 3]) + shift, ONE))
    volume = np.prod(2 * half - shift)
    assert found.lower <= volume <= found.upper <= found.lower + 1e-12 * volume
    assert np.allclose(found.centroid, [1, 2, 3] + shift / 2) and not found.covers_itself
    assert 0 < found.centroid_error < 1e-14
    (loop,) = found.loops
    assert loop.shape[1] == 3 and np.abs(loop - [1, 2, 3]).max() < 1.5 * half.max()
    poses = [[x, 0, 0, *ONE] for x in (0, half[0], 5 * half[0])]
    rows = lc.overlap_batch(cube, BOX, poses, threads=2)
    for row, share in zip(rows, (1, 0.5, 0)):
        assert row["lower"] <= share * np.prod(2 * half) <= row["upper"]
    assert np.isnan(rows["centroid"][2]).all() and rows["covers_itself"].tolist() == [False] * 3
    for body, words in (
        (lc.Geometry.ball(1), "the volume of B is unknown: it is a rounded polyhedron"),
        (lc.Geometry.mesh(np.eye(3), [[0, 1, 2]]), "the volume of B is unknown: its mesh is open"),
    ):
        with pytest.raises(lc.PairError, match=words):
            lc.PairTracker().overlap(cube, body)
        with pytest.raises(lc.PairError, match=words):
            lc.overlap_batch(cube, body, poses)


def test_penetration_to_a_tolerance():
    cube = lc.Geometry.mesh(BOX.vertices, BOX.triangles)
    at = ((0, 0, 1.25), ONE)
    found = lc.PairTracker().penetration(cube, lc.Geometry.ball(0.5), None, at, tolerance=1e-3)
    assert found.lower <= 0.25 <= found.upper <= found.lower + 1e-3
    assert lc.PairTracker().penetration(lc.Geometry.mesh(np.eye(3), [[0, 1, 2]]), BOX, tolerance=0) is None
    # A bar inside of a U.
    cubes = [(BOX, ((x, 0, z), ONE)) for x, z in ((-2, 0), (0, 0), (2, 0), (-2, 2), (2, 2))]
    u, bar = lc.Geometry.pieces(cubes), lc.Geometry.pieces([(BOX, ((0, 0, 0.5), (0.3, 0.1, 0.2, math.sqrt(0.86))))])
    wide = lc.PairTracker().penetration(u, bar)
    assert wide.upper - wide.lower > 0.1
    narrow = lc.PairTracker().penetration(u, bar, tolerance=0.1, budget=20_000)
    assert wide.lower <= narrow.lower <= narrow.upper <= wide.upper and narrow.upper - narrow.lower <= 0.1
    assert lc.PairTracker().distance(u, bar, None, (1.001 * narrow.shift, ONE)) > 0
    words = "the depth is from .* wider than the tolerance 0.0001 at the end of the budget"
    with pytest.raises(lc.UndecidedError, match=words):
        lc.PairTracker().penetration(u, bar, tolerance=1e-4, budget=10)
    with pytest.raises(lc.LinCannyError, match=r"tolerance is -1 \(expected at least 0\)"):
        lc.PairTracker().penetration(cube, BOX, tolerance=-1)


def test_surfaces_have_no_contacts():
    net = [[[x, y, 0] for y in (0, 1)] for x in (0, 1)]
    with pytest.raises(lc.PairError, match="Bézier surface"):
        lc.PairTracker().contacts(lc.Geometry.surface([net]), BOX)


def test_cast_by_hand():
    thrown = {"velocity_b": ((-2, 0, 0), (0, 0, 0)), "duration": 10.0, "tolerance": 1e-9}
    found = lc.PairTracker().cast(BOX, BOX, None, ((5, 0.5, 0), ONE), **thrown)
    assert found.state == "hit" and found.safe < 1.5 < found.hit and found.hit - found.safe < 2e-9
    assert found.point_a[0] == pytest.approx(1) and found.point_b[0] == pytest.approx(1)
    assert np.allclose(found.normal, [1, 0, 0])
    past = lc.PairTracker().cast(BOX, BOX, None, ((5, 3, 0), ONE), **thrown)
    assert (past.state, past.safe, past.hit, past.point_a) == ("miss", None, None, None)
    near = lc.PairTracker().cast(BOX, BOX, None, ((5, 3, 0), ONE), distance=1.5, **thrown)
    # Edges come within 1.5 when dx^2 + 1 = 2.25.
    assert near.state == "hit" and near.hit == pytest.approx((3 - math.sqrt(1.25)) / 2, abs=1e-8)
    assert lc.PairTracker().cast(BOX, BOX, **thrown).state == "start"
    with pytest.raises(lc.MotionError, match="tolerance"):
        lc.PairTracker().cast(BOX, BOX, duration=1, tolerance=-1)
    with pytest.raises(lc.MotionError, match="velocity"):
        lc.PairTracker().cast(BOX, BOX, velocity_a=((1, 0), (0, 0, 0)), duration=1, tolerance=1)


def test_an_answer_of_more_than_two_values_is_no_condition():
    """Every other object of Python is true, also one that says no."""
    far = (9, 0, 0), ONE
    cast = lc.PairTracker().cast(BOX, BOX, pose_b=far, duration=1.0, tolerance=1e-6)
    ray = lc.RayCaster().cast(BOX, (9, 0, 0), (1, 0, 0))
    assert cast.state == ray.state == "miss"
    for answer in (cast, ray):
        with pytest.raises(TypeError, match="neither true nor false"):
            bool(answer)
    assert lc.PairTracker().intersects(BOX, BOX, pose_b=far) is False
