import math
import os
import pickle
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import lin_canny as lc

# A bar of 2 x 0.2 x 0.2 that turns about z through its end, on a post that slides along z.
ROBOT = """<robot name="turner">
  <link name="base"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="slider"/>
  <link name="bar">
    <collision><origin xyz="1 0 0"/><geometry><box size="2 0.2 0.2"/></geometry></collision>
  </link>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="slider"/><axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="turn" type="revolute">
    <parent link="slider"/><child link="bar"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
</robot>
"""
SRDF = '<robot name="turner"><disable_collisions link1="base" link2="bar" reason="User"/></robot>'
CELL = '{"bodies": [{"name": "post", "cylinder": {"radius": 0.1, "length": 4}, "xyz": [0, 1.5, 0]}]}'


@pytest.fixture
def robot(tmp_path):
    for name, text in (("turner.urdf", ROBOT), ("turner.srdf", SRDF), ("cell.json", CELL)):
        (tmp_path / name).write_text(text)
    return lc.Robot.load(tmp_path / "turner.urdf", tmp_path / "turner.srdf")


@pytest.fixture
def checker(robot, tmp_path):
    return lc.Checker(robot, cell=tmp_path / "cell.json")


def clearance_by_hand(turn):
    """Return the distance of the bar and the post: of a rectangle and a disc."""
    x, y = 1.5 * math.sin(turn), 1.5 * math.cos(turn)
    dx, dy = abs(x - 1) - 1, abs(y) - 0.1
    outside = math.hypot(max(dx, 0), max(dy, 0))
    return outside + min(max(dx, dy), 0) - 0.1


def test_what_a_robot_tells(robot, checker):
    assert repr(robot) == "<Robot 'turner': 3 links, 2 coordinates>".replace("'", '"')
    assert (robot.name, robot.dof, robot.coordinates) == ("turner", 2, ["lift", "turn"])
    assert robot.links == ["base", "slider", "bar"] and robot.limits.tolist() == [[0, 1], [-3, 3]]
    assert checker.bodies == ["base", "bar", "post"] and checker.coordinates == robot.coordinates
    assert repr(checker) == "<Checker: 2 bodies, 1 obstacles, 2 coordinates>"


def test_clearances_by_hand(checker):
    rng = np.random.default_rng(1)
    q = np.stack([rng.uniform(0, 1, 3000), rng.uniform(-3, 3, 3000)], 1)
    found = checker.clearances(q)
    # The base is behind the pivot: the post is nearest to the bar or to the base.
    by_hand = np.array([min(clearance_by_hand(turn), 1.5 - 0.1 - 0.05) for _, turn in q])
    assert np.allclose(found["distance"], by_hand, atol=1e-9)
    assert np.all(found["lower"] <= by_hand + 1e-12) and np.all(by_hand - 1e-12 <= found["upper"])
    assert set(found["b"]) == {2} and set(found["a"]) == {0, 1}
    assert np.array_equal(found, checker.clearances(q, threads=3))
    free = checker.are_free(q)
    assert free.dtype == bool and np.array_equal(free, by_hand > 0) and 0 < free.sum() < 3000
    assert np.array_equal(free, checker.are_free(q, threads=2))
    for k, row in enumerate(found[:2000]):
        if k % 1024 == 0:
            checker.reset()
        near = checker.clearance(q[k])
        assert (near.distance, near.lower, near.upper) == (row["distance"], row["lower"], row["upper"])
        assert (near.a, near.b) == (checker.bodies[row["a"]], checker.bodies[row["b"]])
    single = checker.clearance(q[0])
    assert single.distance == pytest.approx(by_hand[0], abs=1e-9)
    assert (single.a, single.b) == tuple(checker.bodies[k] for k in found[0][["a", "b"]])
    assert np.linalg.norm(single.point_a - single.point_b) == pytest.approx(abs(by_hand[0]), abs=1e-9)
    assert single.gradient.shape == (2,)
    assert checker.is_free(q[0]) == free[0]


def test_a_margin(checker):
    q = [0.5, 0.7]
    near = checker.clearance(q).distance
    checker.margin = near + 1e-6
    assert not checker.is_free(q) and not checker.are_free([q])[0]
    checker.margin = near - 1e-6
    assert checker.is_free(q) and checker.margin == near - 1e-6
    with pytest.raises(lc.PlanError, match="margin"):
        checker.margin = -1


def test_certified_segments(checker):
    touch = math.pi / 2 - math.asin(0.2 / 1.5)  # the side of the bar meets the post here
    free = checker.certify([0, 0], [1, touch - 1e-6])
    assert free.is_free and free.state == "free" and free.pair is None and free.free_until == 1
    assert checker.is_free([0, 0], [1, touch - 1e-6])
    blocked = checker.certify([0, 0], [0, 2])
    assert blocked.state == "blocked" and blocked.pair == ("bar", "post")
    assert blocked.free_until <= touch / 2 <= blocked.contact_at < touch / 2 + 1e-5
    assert np.allclose(*blocked.points, atol=1e-4)
    assert checker.certify_path([[0, 0], [0, 1], [0, 2]]).segment == 1
    for verdict in (free, blocked):  # an object is true, also one that says no
        with pytest.raises(TypeError, match="neither true nor false"):
            bool(verdict)
    lower, upper, t, pair = checker.clearance_along([0, 0], [1, 1])
    assert lower <= clearance_by_hand(1) <= upper * 1.001 and t == 1 and pair == ("bar", "post")


def test_receipts_hold(checker, tmp_path):
    verify = Path(__file__).parents[2] / "verify" / "verify.py"
    file = tmp_path / "receipt.jsonl"
    file.write_bytes(checker.receipt([[0, 0], [0.5, 0.5], [1, 0]]).encode())
    found = subprocess.run([sys.executable, verify, file], capture_output=True, text=True)
    assert found.returncode == 0 and "of each of 2 legs" in found.stdout, found.stdout
    with pytest.raises(lc.PlanError, match="piece 1 of the motion is not proven free"):
        checker.receipt([[0, 0], [0, 1], [0, 2]])


def test_a_planned_path_is_free(checker):
    short_post = lc.Checker(
        lc.Robot.load(checker_urdf(checker)),
        obstacles=[("stub", lc.Geometry.cylinder(half_height=0.2, radius=0.1), ((0, 1.5, 0), (0, 0, 0, 1)))],
        exclude=[("base", "bar")],
    )
    start, goal = [0.0, 0.0], [0.0, 2.5]
    assert not short_post.is_free(start, goal)
    path = short_post.plan(start, goal, seed=1)
    assert path[0].tolist() == start and path[-1].tolist() == goal and path.shape[1] == 2
    assert short_post.certify_path(path).is_free
    assert np.array_equal(path, short_post.plan(start, goal, seed=1))
    for method in ["rrt-connect", "opportunistic"]:
        path = short_post.plan(start, goal, seed=1, method=method)
        assert short_post.certify_path(path).is_free
    with pytest.raises(ValueError, match='method is "prm"'):
        short_post.plan(start, goal, method="prm")
    assert short_post.plan(start, goal, method="rrt-connect", samples=0) is None
    assert checker.plan(start, goal, seconds=0.2) is None  # the post of the cell is taller than the lift
    with pytest.raises(lc.PlanError, match='"?bar"? and "?stub"? are in contact'):
        short_post.plan([0, math.pi / 2], goal)


@pytest.mark.skipif(os.name != "posix", reason="needs signals of POSIX")
def test_ctrl_c_ends_a_search(checker):
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        checker.plan([0, 0], [0, 2.5], seconds=20, slices=10**12, samples=10**12)


def checker_urdf(checker):
    (robot,), _ = checker.__getnewargs_ex__()
    return robot.__reduce__()[1][0]


def test_robots_and_checkers_are_pickled(robot, checker):
    q = np.random.default_rng(2).uniform([0, -3], [1, 3], (50, 2))
    checker.margin = 0.125
    other = pickle.loads(pickle.dumps(checker))
    assert other.margin == 0.125 and np.array_equal(other.clearances(q), checker.clearances(q))
    assert repr(pickle.loads(pickle.dumps(robot))) == repr(robot)


def test_what_is_skipped_is_listed(tmp_path):
    mesh = '<link name="bar"><collision><geometry><mesh filename="no.stl"/></geometry></collision>'
    urdf, srdf = tmp_path / "r.urdf", tmp_path / "r.srdf"
    urdf.write_text(ROBOT.replace('<link name="bar">', mesh))
    srdf.write_text(SRDF.replace('"bar"', '"tool"'))
    with pytest.raises(lc.FileError, match=r"r.urdf:4: .*no.stl is missing"):
        lc.Robot.load(urdf)
    robot = lc.Robot.load(urdf, srdf, skip_missing_meshes=True)
    found = robot.skipped
    assert len(found) == 2 and "r.urdf:4: " in found[0] and "no.stl is missing" in found[0]
    assert "r.srdf:1: disable_collisions" in found[1] and '"tool" does not exist' in found[1]
    assert lc.Checker(robot).skipped == found == pickle.loads(pickle.dumps(robot)).skipped


def test_bodies_float_as_far_as_the_argument_says(tmp_path):
    path = tmp_path / "r.xml"
    body = '<body pos="0 0 12"><freejoint/><geom size=".1"/></body>'
    path.write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    for floating, limits in ((10.0, [[-10, 10], [-10, 10], [-10, 12]]), (20.0, [[-20, 20]] * 3)):
        robot = lc.Robot.load(path, floating=floating)
        assert robot.limits[:3].tolist() == limits
        assert np.array_equal(pickle.loads(pickle.dumps(robot)).limits, robot.limits)
    with pytest.raises(lc.LinCannyError, match="floating is out of range: -1"):
        lc.Robot.load(path, floating=-1.0)


def test_configurations_are_converted_from_and_to_qpos(tmp_path):
    path = tmp_path / "r.xml"
    geom = '<geom size=".1"/>'
    path.write_text(
        f'<mujoco><worldbody><body><joint type="ball" name="hip"/>{geom}<body><joint name="knee"/>{geom}</body></body>'
        "</worldbody></mujoco>"
    )
    robot = lc.Robot.load(path)
    assert robot.coordinates == ["hip/roll", "hip/pitch", "hip/yaw", "knee"]
    half = np.sqrt(0.5)
    q = robot.configuration_of_qpos([half, 0, 0, half, 0.25])
    assert q == pytest.approx([0, 0, np.pi / 2, 0.25])
    assert robot.qpos_of_configuration(q) == pytest.approx([half, 0, 0, half, 0.25])
    with pytest.raises(lc.LinCannyError, match="number of values of qpos"):
        robot.configuration_of_qpos([1, 0, 0, 0])
    with pytest.raises(lc.LinCannyError, match="length of a quaternion"):
        robot.configuration_of_qpos([0, 0, 0, 0, 0])


def test_an_srdf_enables_adjacent_links(robot, tmp_path):
    names = '<enable_collisions link1="base" link2="bar"/>'
    (tmp_path / "on.srdf").write_text(f'<robot name="turner">{names}</robot>')
    checked = lc.Robot.load(tmp_path / "turner.urdf", tmp_path / "on.srdf")
    q = [0.5, 0.0]
    assert lc.Checker(robot).clearance(q) is None
    for checker in (lc.Checker(checked), lc.Checker({"a/": (checked, None)})):
        assert checker.clearance(q).distance == pytest.approx(0.35)
    assert checked.clearances([q])["distance"] == pytest.approx(0.35)


def test_two_robots(robot):
    away = np.eye(4)
    away[0, 3] = 10
    both = lc.Checker({"l/": (robot, None), "r/": (robot, away)})
    assert both.coordinates == ["l/lift", "l/turn", "r/lift", "r/turn"]
    found = both.clearances([[0, 0, 0, 3.0]])
    # From a corner of the right bar to an edge of the left bar.
    corner = (10 + 2 * math.cos(3) - 0.1 * math.sin(3), 2 * math.sin(3) + 0.1 * math.cos(3))
    by_hand = math.hypot(corner[0] - 2, corner[1] - 0.1)
    assert found["distance"][0] == pytest.approx(by_hand, abs=1e-9)
    with pytest.raises(lc.LinCannyError, match="several"):
        lc.Checker({"l/": (robot, None)}, pose=away)


def test_a_robot_alone_has_no_pair_left(robot):
    found = robot.clearances(np.zeros((3, 2)))
    assert np.all(np.isinf(found["distance"])) and set(found["a"]) == {-1}


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda c: c.clearances(np.zeros((2, 3))), lc.PlanError, r"shape is \(2, 3\) \(expected \(N, 2\)\)"),
        (lambda c: c.clearances([[0, 0], [0, 4]]), lc.PlanError, "configuration 1: coordinate 1, turn, is 4, outside its"),
        (lambda c: c.clearance([[0, 0]]), lc.PlanError, r"expected \(dof,\)"),
        (lambda c: c.clearance([0, 0, 0]), lc.PlanError, r"3 numbers \(expected 2\)"),
        (lambda c: c.certify([0, 0], [0, math.nan]), lc.PlanError, "coordinate 1, turn, is NaN"),
        (lambda c: c.plan([0, 0], [2, 0]), lc.PlanError, "coordinate 0, lift, is 2, outside its limits 0 and 1"),
        (lambda c: lc.Robot.load("missing.urdf"), lc.FileError, "missing.urdf: cannot be read"),
        (lambda c: lc.Robot.load("x", meshes="soup"), lc.LinCannyError, '"soup"'),
        (lambda c: lc.Checker(c.__getnewargs_ex__()[0][0], exclude=[("bar", "moon")]), lc.PlanError, "moon"),
        (lambda c: lc.Checker({}, cell="x"), lc.LinCannyError, "needs a robot"),
    ],
)
def test_refused_calls(checker, call, error, words):
    with pytest.raises(error, match=words):
        call(checker)


def test_a_refused_file_names_line_and_element(tmp_path):
    file = tmp_path / "bad.urdf"
    file.write_text(ROBOT.replace('radius="0.05"', 'radius="-1"'))
    with pytest.raises(lc.FileError, match=r"bad.urdf:2: .*radius is out of range: -1"):
        lc.Robot.load(file)
