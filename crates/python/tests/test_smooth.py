import os
import pickle
import signal
import threading

import numpy as np
import pytest

import lin_canny as lc
from test_robot import checker, robot  # noqa: F401 (fixtures)

PATH = np.array([[0.0, 0.0], [0.8, 0.4], [0.8, 1.0], [0.1, 1.2]])


def peaks(motion):
    """Return the greatest velocities and accelerations of the curves, at many times."""
    spans, parts = np.diff(motion.times), np.linspace(0, 1, 201)
    curves = motion.curves()
    v = [np.abs(c.velocity(parts)).max(0) / h for c, h in zip(curves, spans)]
    a = [np.abs(c.acceleration(parts)).max(0) / h**2 for c, h in zip(curves, spans)]
    return np.max(v, 0), np.max(a, 0)


@pytest.mark.parametrize("continuous", [False, True])
def test_a_smooth_motion_is_proven_and_within_limits(checker, continuous):
    calls = []
    motion = checker.smooth(
        PATH, acceleration=[4, 8], continuous_acceleration=continuous, progress=lambda *done: calls.append(done)
    )
    assert motion.names == ["lift", "turn"] and motion.times[0] == 0 and motion.stops == []
    assert np.array_equal(motion.positions[[0, -1]], PATH[[0, -1]])
    assert not motion.velocities[[0, -1]].any() and (motion.accelerations is not None) == continuous
    velocity, acceleration = peaks(motion)
    # The velocity limits are those of the URDF.
    assert np.all(velocity <= 1) and np.all(acceleration <= [4, 8]) and velocity.max() > 0.9
    assert checker.certify_trajectory(motion).is_free
    assert calls and calls[-1][0] == calls[-1][1]
    again = pickle.loads(pickle.dumps(motion))
    assert again.stops == [] and again.curves() == motion.curves()


def test_limits_by_name_and_stops(checker):
    whole = checker.smooth(PATH, velocity=0.5, acceleration=4)
    slow = checker.smooth(PATH, velocity={"turn": 0.2}, acceleration={"lift": 4, "turn": 4})
    assert np.all(peaks(whole)[0] <= 0.5) and peaks(slow)[0][1] <= 0.2 < peaks(slow)[0][0] <= 1
    stopped = checker.smooth(PATH, acceleration=4, deviation=0)
    assert stopped.stops == [1, 2] and lc.Trajectory([0, 1], PATH[:2]).stops is None
    still = checker.smooth(PATH[:1], acceleration=4)
    assert len(still) == 1 and still.stops == []


def test_what_cannot_be_smooth(checker):
    for options, why in (
        ({"acceleration": {"lift": 4}}, 'acceleration: joint "turn" has no limit'),
        ({"acceleration": {"lift": 4, "turm": 4}}, 'acceleration: joint "turm" does not exist .nearest: "turn"'),
        ({"acceleration": [1, 2, 3]}, r"acceleration: shape is \(3,\) \(expected a number or \(2,\)"),
        ({"acceleration": 4, "velocity": {"turn": -1}}, 'velocity limit of joint "turn" is out of range: -1'),
        ({"acceleration": 4, "deviation": -1}, "deviation is out of range: -1"),
    ):
        with pytest.raises(lc.PlanError, match=why):
            checker.smooth(PATH, **options)
    with pytest.raises(lc.PlanError, match="segment from row 1 is not proven free"):
        checker.smooth([[0, 0], [0, 1], [0, 2]], acceleration=4)
    with pytest.raises(lc.PlanError, match="path"):
        checker.smooth(np.zeros((0, 2)), acceleration=4)


def test_a_robot_without_velocity_limits(tmp_path):
    (tmp_path / "mast.xml").write_text(
        '<mujoco><worldbody><body name="mast"><joint name="mast" type="hinge" axis="0 0 1" range="-1 1"/>'
        '<geom type="box" size="1 1 1"/></body></worldbody></mujoco>'
    )
    checker = lc.Checker(lc.Robot.load(tmp_path / "mast.xml"))
    with pytest.raises(lc.PlanError, match='velocity: joint "mast" has no limit'):
        checker.smooth([[0], [0.5]], acceleration=1)
    assert checker.smooth([[0], [0.01]], acceleration=1, velocity=1).times[-1] > 0.19


def test_ctrl_c_and_exceptions_end_the_call(checker):
    path = np.stack([np.arange(600_000) % 2, np.linspace(0, 1, 600_000)], 1)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        checker.smooth(path, acceleration=4)
    timer.join()

    def fails(done, total):
        raise ZeroDivisionError(f"{done} of {total}")

    with pytest.raises(ZeroDivisionError):
        checker.smooth(path, acceleration=4, progress=fails)
