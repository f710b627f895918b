import json
import pickle

import numpy as np
import pytest

import lin_canny as lc
from test_robot import ROBOT, checker, robot  # noqa: F401 (fixtures)

BALL = lc.Geometry.ball(0.1)


def placed(x, y):
    return [x, y, 0, 0, 0, 0, 1]


@pytest.fixture
def crossing(robot):
    """Return a checker of a ball that goes through the bar at rest, in contact from time 8 to 12."""
    checker = lc.Checker(robot)
    checker.add_moving_obstacle("cart", BALL, [0, 20], [placed(1, -1), placed(1, 1)])
    return checker


def still(start, end):
    return lc.Trajectory([start, end], np.zeros((2, 2)))


def test_a_trajectory_is_proven_on_the_clock(crossing):
    assert crossing.certify_trajectory(still(0, 7.999)).is_free
    assert crossing.certify_trajectory(still(12.001, 20)).is_free
    verdict = crossing.certify_trajectory(lc.Trajectory([0, 4, 9], np.zeros((3, 2))))
    assert verdict.pair == ("bar", "cart") and verdict.segment == 1
    assert verdict.free_until_time <= 8 <= verdict.contact_time + 1e-9 and verdict.contact_time < 8.01
    curve = lc.JointCurve.bezier(np.zeros((2, 2)))
    assert curve.times is None and still(3, 4).curves()[0].times == (3, 4)
    assert crossing.certify_curve(curve.with_times(0, 7)).is_free
    assert not crossing.certify_curve(curve.with_times(7, 9)).is_free
    assert crossing.certify_curve(curve.with_times(0, 7), tube=0.001).is_free
    batch = crossing.certify_batch([curve.with_times(0, 7), curve.with_times(7, 9)], threads=2)
    assert batch["state"].tolist() == ["free", "blocked"]
    with pytest.raises(lc.PlanError, match="curve 1 starts at time 5.0 .expected 4.0"):
        crossing.certify_spline([curve.with_times(0, 4), curve.with_times(5, 6)])
    timed = curve.with_times(0, 7)
    assert pickle.loads(pickle.dumps(timed)) == timed and pickle.loads(pickle.dumps(curve)) == curve


def test_configurations_have_a_time(crossing):
    q = [[0, 0]] * 3
    assert crossing.time is None
    for call in (lambda: crossing.clearance(q[0]), lambda: crossing.are_free(q), crossing.prove_range):
        with pytest.raises(lc.PlanError, match='obstacle "cart" moves'):
            call()
    for time in (0, 5, 7.9, 8.1, 15):
        crossing.time = time
        by_hand = abs(0.1 * time - 1) - 0.2
        assert crossing.time == time and crossing.clearance(q[0]).distance == pytest.approx(by_hand, abs=1e-9)
        for one in (crossing, pickle.loads(pickle.dumps(crossing))):
            assert one.clearances(q, threads=2)["distance"] == pytest.approx(by_hand, abs=1e-9)
            assert one.are_free(q).tolist() == [by_hand > 0] * 3
    crossing.time = 0
    assert crossing.prove_pair("bar", "cart", [0, 0], [1, 1]).verdict == "never"
    crossing.time = 10
    assert crossing.prove_pair("bar", "cart", [0, -0.01], [0.01, 0.01]).verdict == "always"


def test_what_has_no_pose(crossing):
    with pytest.raises(lc.PlanError, match='obstacle "cart" has no pose at time 21.0'):
        crossing.time = 21
    with pytest.raises(lc.PlanError, match='obstacle "cart" has no pose at time'):
        crossing.certify_trajectory(still(19, 21))
    with pytest.raises(lc.PlanError, match='obstacle "cart" moves'):
        crossing.certify([0, 0], [0, 1])
    two = [placed(0, 0), placed(1, 0)]
    for times, poses, error, why in (
        ([0, 1, 2], two, lc.PlanError, r"times: shape is \(3,\) \(expected \(2,\)"),
        ([0, 0], two, lc.PlanError, 'obstacle "cart": timed pose 1: time'),
        ([0], two[:1], lc.PlanError, 'obstacle "cart": number of timed poses'),
        ([0, 1], [placed(0, 0), [0, 0, 0, 0, 0, 0, 2]], lc.PoseError, "pose 1"),
        ([0, 1], np.zeros((2, 3)), lc.PoseError, r"poses: shape is \(2, 3\)"),
    ):
        with pytest.raises(error, match=why):
            crossing.add_moving_obstacle("cart", BALL, times, poses)


def test_a_cell_with_poses_and_two_robots(robot, tmp_path, crossing):
    (tmp_path / "cart.csv").write_text("time,x,y,z,qx,qy,qz,qw\n0,1,-1,0,0,0,0,1\n20,1,1,0,0,0,0,1\n")
    body = {"name": "cart", "sphere": {"radius": 0.1}, "poses": {"file": "cart.csv"}}
    (tmp_path / "moving.json").write_text(json.dumps({"bodies": [body]}))
    far = ((9, 0, 0), (0, 0, 0, 1))
    two = lc.Checker({"": (robot, None), "b/": (robot, far)}, cell=tmp_path / "moving.json")
    rows = np.zeros((2, 4))
    assert two.coordinates == ["lift", "turn", "b/lift", "b/turn"]
    verdict = two.certify_trajectory(lc.Trajectory([0, 9], rows))
    assert verdict.pair == ("bar", "cart") and verdict.contact_time == pytest.approx(8, abs=0.01)
    two.save(tmp_path / "saved.json")
    again = lc.Checker({"": (robot, None), "b/": (robot, far)}, cell=tmp_path / "saved.json")
    for one in (two, again):
        one.reset()
    assert (
        again.certify_trajectory(lc.Trajectory([0, 9], rows)).contact_time
        == two.certify_trajectory(lc.Trajectory([0, 9], rows)).contact_time
    )
