import json
import pickle

import numpy as np
import pytest

import lin_canny as lc
from test_curves import TOUCH
from test_robot import checker, robot  # noqa: F401 (fixtures)

TIMES = [1.0, 2.0, 4.5]
POSITIONS = np.array([[0.0, 0.0], [0.5, 1.0], [1.0, 2.0]])
VELOCITIES = np.array([[0.0, 0.0], [0.3, 0.8], [0.0, 0.0]])
ACCELERATIONS = np.array([[0.0, 0.1], [0.2, 0.0], [0.0, 0.0]])


def given(order):
    return (TIMES, POSITIONS, VELOCITIES, ACCELERATIONS)[: order + 2]


def certified(checker, motion):
    """Return the verdict of a checker without cached state, whose last bits are always the same."""
    checker.reset()
    return checker.certify_trajectory(motion)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_verdict_has_time_and_pair(checker, order):
    motion = lc.Trajectory(*given(order))
    curves = motion.curves()
    assert [c.degree for c in curves] == [1 + 2 * order] * 2 and len(motion) == 3
    verdict = certified(checker, motion)
    assert verdict.segment == 1 and verdict.pair == ("bar", "post")
    # The angle at the time of contact is that at which the bar meets the post.
    assert 2 < verdict.free_until_time <= verdict.contact_time < 4.5
    assert verdict.contact_time == pytest.approx(2 + 2.5 * verdict.contact_at)
    before, after = motion.at([verdict.free_until_time, verdict.contact_time])[:, 1]
    assert before - 1e-12 <= TOUCH <= after + 1e-12 and after - before < 1e-4
    assert f"segment 1, time {verdict.contact_time}" in str(verdict)
    assert f"segment 1, time {verdict.contact_time:.9f}" in repr(verdict)
    checker.reset()
    one = checker.certify_spline(curves)
    assert (one.segment, one.contact_at) == (1, verdict.contact_at) and one.contact_time is None
    assert np.array_equal(motion.at(TIMES), POSITIONS)
    # At 1,000 times before that, the configuration is free by exact predicates.
    assert checker.are_free(motion.at(np.linspace(1, verdict.free_until_time, 1000))).all()
    for pickled in (motion, pickle.loads(pickle.dumps(motion))):
        assert pickled.curves() == curves and pickled.times.tolist() == TIMES
    calls = []
    slow = lc.Trajectory(TIMES, POSITIONS * [1, 0.3])
    free = checker.certify_trajectory(slow, progress=lambda *done: calls.append(done))
    assert free.is_free and free.free_until_time == 4.5 and free.contact_time is None and calls[-1] == (2, 2)


def test_names_may_be_in_any_order(checker, robot):
    swapped = [rows if rows is TIMES else rows[:, ::-1] for rows in given(2)]
    motion, same = lc.Trajectory(*swapped, names=["turn", "lift"]), lc.Trajectory(*given(2))
    assert motion.names == ["turn", "lift"] and same.names is None
    assert motion.curves(checker) == motion.curves(robot) == same.curves()
    assert certified(checker, motion).contact_time == certified(checker, same).contact_time
    for names, why in (
        (["turn", "lift_"], 'joint "lift_" does not exist.*nearest: "lift"'),
        (["turn"], "number of names is 1"),
        (["turn", "turn"], '"turn" is given twice'),
    ):
        with pytest.raises(lc.PlanError, match=why):
            checker.certify_trajectory(lc.Trajectory(*swapped, names=names))
    with pytest.raises(lc.PlanError, match='trajectory: joint "turn" is missing'):
        checker.certify_trajectory(lc.Trajectory([0, 1], [[0], [1]], names=["lift"]))
    with pytest.raises(lc.PlanError, match="trajectory has 1 columns"):
        checker.certify_trajectory(lc.Trajectory([0, 1], [[0], [1]]))


def message(names, order):
    points = []
    for k, time in enumerate(TIMES):
        start = {"sec": int(time), "nanosec": int(time % 1 * 1e9)}
        point = {"positions": POSITIONS[k].tolist(), "time_from_start": start}
        for field, rows in zip(("velocities", "accelerations"), (VELOCITIES, ACCELERATIONS)[:order]):
            point[field] = rows[k].tolist()
        points.append(point)
    return {"joint_names": names, "points": points}


@pytest.mark.parametrize("order", [0, 1, 2])
def test_files_are_the_arrays(checker, robot, tmp_path, order):
    names = ["lift", "turn"]
    suffixes = ("", ".velocity", ".acceleration")[: order + 1]
    columns = ["time", *(name + suffix for suffix in suffixes for name in names)]
    rows = np.column_stack(given(order)).tolist()
    (tmp_path / "q.csv").write_text("\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]))
    (tmp_path / "q.json").write_text(json.dumps(message(names, order)))
    (tmp_path / "q.yaml").write_text(json.dumps({"joint_trajectory": message(names, order)}))
    made = lc.Trajectory(*given(order))
    for name in ("q.csv", "q.json", "q.yaml"):
        for of in (checker, robot):
            read = lc.Trajectory.load(tmp_path / name, of)
            assert read.names == names and read.curves() == made.curves()
            for got, expected in ((read.velocities, VELOCITIES), (read.accelerations, ACCELERATIONS)):
                assert got is None or np.array_equal(got, expected)
            assert (read.velocities is None, read.accelerations is None) == (order < 1, order < 2)
    assert certified(checker, read).contact_time == certified(checker, made).contact_time


def test_faults_of_files(checker, tmp_path):
    path = tmp_path / "q.csv"
    for text, why in (
        ("time,turn\n0,0\n", 'column "lift" is missing'),
        ("time,lift,turn\n0,0,0\n0,1,0\n", "q.csv:3: .*time"),
        ("time,lift,turn\n0,0,0\n1,2,0\n", "q.csv:3: .*lift"),
        ("lift,turn\n0,0\n", 'column "time" is missing'),
    ):
        path.write_text(text)
        with pytest.raises(lc.FileError, match=why):
            lc.Trajectory.load(path, checker)
    path.write_text("time,turn\n0,0\n1,1\n")
    assert lc.Trajectory.load(path, checker, rest={"lift": 0.5}).positions.tolist() == [[0.5, 0], [0.5, 1]]
    for rest, why in (({"lifts": 0}, 'rest: joint "lifts" does not exist'), ({"lift": 2}, "rest: lift is 2")):
        with pytest.raises(lc.PlanError, match=why):
            lc.Trajectory.load(path, checker, rest=rest)
    with pytest.raises(lc.FileError, match="q.txt"):
        lc.Trajectory.load(tmp_path / "q.txt", checker)


def test_faults_of_arrays(checker):
    for arguments, why in (
        (([0, 1], POSITIONS), "positions: number of rows is 3 .expected 2"),
        (([0, 1, 1], POSITIONS), "times: entry 2 is 1, not after entry 1, 1"),
        (([0, np.nan, 1], POSITIONS), "times: entry 1 is not finite"),
        (([], np.zeros((0, 2))), "no point"),
        ((TIMES, POSITIONS, VELOCITIES[:2]), r"velocities: shape is \(2, 2\) .expected \(3, 2\)"),
        ((TIMES, POSITIONS, None, ACCELERATIONS), "accelerations are given without velocities"),
        ((TIMES, POSITIONS / [np.nan, 1]), r"positions: entry \[0, 0\] is not finite"),
    ):
        with pytest.raises(lc.PlanError, match=why):
            lc.Trajectory(*arguments)
    motion = lc.Trajectory([3, 5], [[0.5, 0], [0.5, 0]], [[3, 0], [-3, 0]])
    with pytest.raises(lc.PlanError, match="points 0 to 1: lift exceeds its limits 0 and 1 at time 4: 2"):
        checker.certify_trajectory(motion)
    with pytest.raises(lc.PlanError, match="times: entry 1 is 6"):
        motion.at([3, 6])
    still = checker.certify_trajectory(lc.Trajectory([7], [[0.5, 0]]))
    assert still.is_free and still.free_until_time == 7
    assert lc.Trajectory([7], [[0.5, 0]]).at([7]).tolist() == [[0.5, 0]]
    assert checker.certify_trajectory(lc.Trajectory([7], [[0.5, 1.6]])).contact_time == 7
