import math
import os
import pickle
import signal
import threading

import numpy as np
import pytest

import lin_canny as lc
from test_robot import checker, clearance_by_hand, robot  # noqa: F401 (fixtures)

# At this angle of the joint `turn` the side of the bar meets the post.
TOUCH = math.pi / 2 - math.asin(0.2 / 1.5)


def bernstein(points, t):
    """Return a Bézier curve at times by the sum of Bernstein polynomials."""
    points, t = np.asarray(points, float), np.asarray(t, float)[:, None]
    n = len(points) - 1
    return sum(math.comb(n, k) * (1 - t) ** (n - k) * t**k * points[k] for k in range(n + 1))


def random_curves(rng, count):
    """Return control points of curves of degree 1 to 7 within the limits; some repeat."""
    for _ in range(count):
        degree = int(rng.integers(1, 8))
        points = rng.uniform([0, -1.9], [1, 1.9], size=(degree + 1, 2))
        if rng.random() < 0.3:
            points[1] = points[0]
        yield points


def test_verdicts_agree_with_many_configurations(checker):
    rng, times = np.random.default_rng(5), np.linspace(0, 1, 2001)
    states = set()
    for points in random_curves(rng, 120):
        verdict = checker.certify_curve(points)
        assert verdict.state == checker.certify_curve(lc.JointCurve.bezier(points)).state
        free = checker.are_free(bernstein(points, times))
        states.add(verdict.state)
        assert verdict.state != "undecided"
        if verdict.is_free:
            assert free.all() and checker.clearance_along_curve(points)[0] > 0
            assert checker.prove_curve(points) is not None
        else:
            assert free[times < verdict.free_until].all() and verdict.pair == ("bar", "post")
            assert not checker.is_free(lc.JointCurve.bezier(points).at(verdict.contact_at))
            assert checker.prove_curve(points) is None
            assert verdict.free_until_time is None and verdict.contact_time is None
    assert states == {"free", "blocked"}


def test_a_curve_of_degree_one_is_a_segment(checker):
    rng = np.random.default_rng(6)
    for ends in rng.uniform([0, -3], [1, 3], size=(200, 2, 2)):
        checker.reset()
        straight = checker.certify(*ends)
        checker.reset()
        curve = checker.certify_curve(ends)
        assert (curve.state, curve.free_until, curve.contact_at) == (straight.state, straight.free_until, straight.contact_at)
        # Degree 1 written as degree 7.
        high = lc.JointCurve.bezier(np.linspace(*ends, 8))
        assert checker.certify_curve(high).state == straight.state


def test_clearance_along_a_curve(checker):
    curve = lc.JointCurve.cubic([[0, -1], [1, 1]], np.zeros((2, 2)))
    lower, upper, t, pair = checker.clearance_along_curve(curve)
    least = min(clearance_by_hand(turn) for turn in curve.at(np.linspace(0, 1, 1001))[:, 1])
    assert lower <= least <= upper * 1.001 and pair == ("bar", "post")
    assert t == pytest.approx(1) and upper == pytest.approx(clearance_by_hand(1))
    with pytest.raises(lc.PlanError, match="relative"):
        checker.clearance_along_curve(curve, relative=0)


def test_a_proof_covers_all_times_of_all_pairs(checker):
    curve = lc.JointCurve.bezier([[0, 0], [1, 0.5], [0, 1.3]])
    proof = checker.prove_curve(curve)
    assert {checker.bodies[k] for k in proof["b"]} == {"post"}
    for a in set(proof["a"]):
        steps = proof[proof["a"] == a]
        assert steps["start"][0] == 0 and steps["end"][-1] == 1
        assert np.array_equal(steps["start"][1:], steps["end"][:-1])
    planes = proof[np.any(proof["normal"] != 0, axis=1)]
    assert len(planes) and np.allclose(np.linalg.norm(planes["normal"], axis=1), 1)
    # The corners of the bar are below the post along each normal, at the start of each certificate.
    corners = np.array([[x, y, z] for x in (0, 2) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
    for step in planes[planes["a"] == checker.bodies.index("bar")]:
        lift, turn = curve.at(step["start"])
        c, s = math.cos(turn), math.sin(turn)
        bar = corners @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0, 0, lift]
        n = step["normal"]
        post = n @ [0, 1.5, 0] - 0.1 * math.hypot(n[0], n[1]) - 2 * abs(n[2])
        assert (bar @ n).max() < post
    straight = checker.prove([0, 0], [1, 1])
    assert straight.dtype == proof.dtype and checker.prove([0, 0], [0, 2]) is None


def test_conversions():
    rng, t = np.random.default_rng(8), np.linspace(0, 1, 11)
    c = rng.normal(size=(5, 3))
    power = lc.JointCurve.power(c)
    assert power.degree == 4 and power.dof == 3 and power.control_points.shape == (5, 3)
    assert np.allclose(power.at(t), sum(np.outer(t**k, c[k]) for k in range(5)))
    assert np.allclose(power.velocity(t), sum(k * np.outer(t ** (k - 1), c[k]) for k in range(1, 5)))
    assert np.array_equal(power.at(0.5), power.at([0.5])[0]) and power.at(np.float64(1)).shape == (3,)
    ends, v, a = rng.normal(size=(3, 2, 3))
    quintic = lc.JointCurve.quintic(ends, v, a, 2.0)
    assert np.allclose(quintic.at([0, 1]), ends) and np.allclose(quintic.velocity([0, 1]) / 2, v)
    assert np.allclose(quintic.acceleration([0, 1]) / 4, a)
    cubic = lc.JointCurve.cubic(ends, v, 2.0)
    assert np.allclose(cubic.at([0, 1]), ends) and np.allclose(cubic.velocity([0, 1]) / 2, v)
    higher = cubic.elevated()
    assert higher.degree == 4 and np.allclose(higher.at(t), cubic.at(t))
    assert pickle.loads(pickle.dumps(power)) == power != lc.JointCurve.bezier(power.control_points)


def test_b_splines_are_those_of_scipy():
    interpolate = pytest.importorskip("scipy.interpolate", reason="scipy is not installed")
    rng = np.random.default_rng(9)
    points, knots = rng.normal(size=(8, 2)), [0, 0, 0, 0, 1, 2.5, 2.5, 4, 5, 5, 5, 5]
    for curves, knots in (
        (lc.JointCurve.b_spline(points, 3, knots), knots),
        (lc.JointCurve.b_spline(points, 3), np.arange(12)),
    ):
        times = lc.JointCurve.b_spline_times(8, 3, knots)
        spline = interpolate.BSpline(knots, points, 3)
        assert len(curves) == len(times) - 1
        for curve, before, (start, end) in zip(curves, [curves[0], *curves], zip(times, times[1:])):
            t = np.linspace(0, 1, 9)
            assert np.allclose(curve.at(t), spline(start + (end - start) * t))
            assert curve is curves[0] or np.array_equal(curve.at(0), before.at(1))


def test_splines(checker):
    path = np.array([[0, 0], [0.2, 0.4], [0.9, 0.9], [0.1, 1.2], [0, TOUCH - 0.01]])
    curves = lc.JointCurve.b_spline(path, 2, [0, 0, 0, 1, 2, 3, 3, 3])
    assert checker.certify_spline(curves).is_free
    far = np.stack([path[:-1], path[1:]], axis=1)
    assert far.shape == (4, 2, 2) and checker.certify_spline(far).is_free
    assert checker.certify_path(path).is_free
    far[3, 1, 1] = 2
    blocked = checker.certify_spline(far)
    assert (blocked.segment, blocked.pair) == (3, ("bar", "post"))
    assert blocked.contact_at == checker.certify(*far[3]).contact_at
    calls = []
    checker.certify_spline(far, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (4, 4)
    far[2, 0, 0] += 1e-9
    with pytest.raises(lc.PlanError, match="coordinate 0 of curve 2 does not start where curve 1 ends"):
        checker.certify_spline(far)
    with pytest.raises(lc.PlanError, match="no curve"):
        checker.certify_spline([])


def test_tubes(checker):
    ends = np.array([[0.5, 0], [0.5, TOUCH - 0.1]])
    assert checker.certify_curve(ends, tube=0).is_free
    assert checker.certify_curve(ends, tube=[0.01, 0.05]).is_free
    assert checker.certify_curve(ends, tube=0.03).is_free
    assert not checker.certify_curve(ends, tube=[0, 0.11]).is_free
    assert not checker.certify_spline([ends], tube=0.11).is_free
    # Nothing inside a tube that is proven meets anything.
    rng = np.random.default_rng(10)
    for points in random_curves(rng, 40):
        tube = rng.uniform(0, 0.2, size=2)
        if checker.certify_curve(points, tube=tube).is_free:
            q = bernstein(points, np.linspace(0, 1, 500)) + tube * rng.choice([-1, 1], size=(500, 2))
            assert checker.are_free(np.clip(q, *checker.limits.T)).all()
    # A tube that changes along the curve, as a curve or as its control points.
    wide = [[0, 0.3], [0, 0]]
    level = [[0.5, -0.5], [0.5, TOUCH - 0.1]]
    assert checker.certify_curve(level, tube=wide).is_free
    assert checker.certify_curve(level, tube=lc.JointCurve.bezier(wide)).is_free
    assert not checker.certify_curve(level, tube=wide[::-1]).is_free
    assert not checker.certify_curve(level, tube=0.3).is_free
    assert checker.certify_spline([level, level[::-1]], tube=[wide, wide[::-1]]).is_free
    states = checker.certify_batch([level] * 3, tube=[lc.JointCurve.bezier(x) for x in (wide, wide[::-1], wide)])
    assert list(states["state"] == "free") == [True, False, True]
    motion = lc.Trajectory([0, 1], level, tube=wide)
    assert checker.certify_trajectory(motion).is_free
    assert np.array_equal(pickle.loads(pickle.dumps(motion)).tube, wide)
    assert not checker.certify_trajectory(motion, tube=[0, 0.3]).is_free
    assert not checker.certify_trajectory(motion, tube=wide[::-1]).is_free
    assert checker.certify_trajectory(lc.Trajectory([0, 1], level)).is_free
    for call, why in (
        (lambda: checker.certify_spline([level], tube=[wide, wide]), "tube: number of curves is 2"),
        (lambda: checker.certify_curve(level, tube=[[0, -0.1], [0, 0]]), "tube: entry of turn is -0.1"),
        (lambda: checker.certify_trajectory(motion, tube=[wide[0]] * 3), "tube: number of rows is 3"),
        (lambda: checker.certify_curve(level, tube=[[0.1], [0.1]]), "tube: number of columns is 1"),
        (lambda: lc.Trajectory([0, 1], level, tube=[[0, 0], [0, -1]]), "tube: entry is -1"),
    ):
        with pytest.raises(lc.PlanError, match=why):
            call()
    for tube, why in ((-1, "lift is -1"), ([0, np.nan], "turn is NaN"), ([1], r"shape is \(1,\)")):
        with pytest.raises(lc.PlanError, match=f"tube: .*{why}"):
            checker.certify_curve(ends, tube=tube)


def test_what_is_refused(checker):
    for call, why in (
        (lambda: checker.certify_curve([[0, 0, 0], [1, 1, 1]]), "curve: configuration has 3 numbers"),
        (lambda: checker.certify_curve([0, 1]), "control points: shape is"),
        (lambda: checker.certify_curve([[0, 0], [0, np.nan]]), r"control points: entry \[1, 1\] is not finite: NaN"),
        (lambda: checker.certify_curve(np.zeros((18, 2))), "degree of a curve is out of range"),
        (lambda: checker.certify_spline([[[0, 0], [0, 0]], [[0, "x"]]]), "curve 1: control points"),
        (lambda: lc.JointCurve.cubic([[0, 0]], [[0, 0]]), "ends: number of rows is 1"),
        (lambda: lc.JointCurve.cubic(np.zeros((2, 2)), np.zeros((2, 2)), 0), "duration"),
        (lambda: lc.JointCurve.bezier([[0.0]]).at([0.5, 1.5]), "time 1 is 1.5"),
        (lambda: lc.JointCurve.b_spline([[0.0]] * 3, 2, [0, 1]), "number of knots"),
    ):
        with pytest.raises(lc.PlanError, match=why):
            call()
    # The control points are beyond the limit of 1, the curve is not.
    assert checker.certify_curve([[0.5, 0], [1.2, 0], [0.5, 0]]).is_free
    with pytest.raises(lc.PlanError, match="curve: lift exceeds its limits 0 and 1 at t = 0.*: 1"):
        checker.certify_curve([[0.5, 0], [1.8, 0], [0.5, 0]])
    with pytest.raises(lc.LinCannyError, match="one curve"):
        checker.certify_spline(lc.JointCurve.bezier([[0, 0], [1, 1]]))


def test_a_batch_is_the_loop(checker):
    rng = np.random.default_rng(11)
    curves = [lc.JointCurve.bezier(points) for points in random_curves(rng, 150)]
    for tube in (None, [0.01, 0.02]):
        found = checker.certify_batch(curves, tube=tube)
        for row, curve in zip(found, curves):
            checker.reset()
            one = checker.certify_curve(curve, tube=tube)
            assert (row["state"], row["free_until"]) == (one.state, one.free_until)
            if one.state == "blocked":
                assert row["contact_at"] == one.contact_at
                assert (checker.bodies[row["a"]], checker.bodies[row["b"]]) == one.pair
                assert np.array_equal([row["point_a"], row["point_b"]], one.points)
            else:
                assert np.isnan(row["contact_at"]) and row["a"] == row["b"] == -1
    ends = rng.uniform([0, -3], [1, 3], size=(3000, 2, 2))
    calls = []
    one = checker.certify_batch(ends, progress=lambda *done: calls.append(done))
    assert one.tobytes() == checker.certify_batch(ends, threads=3).tobytes() and calls[-1] == (3000, 3000)
    assert set(one["state"]) == {"free", "blocked"}
    ends[1234, 1, 0] = 2
    with pytest.raises(lc.PlanError, match="curve 1234: lift exceeds its limits 0 and 1 at t = "):
        checker.certify_batch(ends, threads=2)
    checker.start_contact_margin = 0.1
    assert checker.certify_batch([[[0, TOUCH - 1e-3], [0, 0]]])["state"][0] == "free"


@pytest.mark.skipif(os.name != "posix", reason="needs signals of POSIX")
@pytest.mark.parametrize("kind", ["spline", "trajectory", "batch"])
def test_ctrl_c_ends_a_call(checker, kind):
    q = np.tile([[0.2, 0.3], [0.8, 1.0]], (200_000, 1))
    calls = {
        "spline": lambda: checker.certify_spline(curves),
        "trajectory": lambda: checker.certify_trajectory(motion),
        "batch": lambda: checker.certify_batch(curves, threads=2),
    }
    curve = lc.JointCurve.bezier([[0, -0.5], [0.3, 2.2], [0.9, -0.5], [0, -0.5]])
    curves = [curve] * 400_000
    motion = lc.Trajectory(np.arange(len(q)), q, np.zeros_like(q))
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        calls[kind]()
    timer.cancel()
