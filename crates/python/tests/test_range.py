import math
import os
import signal
import threading
import time

import numpy as np
import pytest

import lin_canny as lc
from test_robot import checker, clearance_by_hand, robot  # noqa: F401 (fixtures)

TOUCH = math.pi / 2 - math.asin(0.2 / 1.5)  # the side of the bar meets the post here


def test_the_four_verdicts(checker):
    both = checker.prove_pair("bar", "post")
    assert (both.verdict, both.a, both.b, both.share) == ("both", "bar", "post", 0)
    assert both.range.tolist() == [[0, 1], [-3, 3]] and sorted(both.coordinates) == ["lift", "turn"]
    free, touching = both.witnesses
    assert clearance_by_hand(free[1]) > 0 >= clearance_by_hand(touching[1])
    assert both.ids == tuple(checker.ids[1:]) and "bar" in repr(both) and "both" in repr(both)

    never = checker.prove_pair("bar", "post", [0, -3], [1, 1.2])
    assert never.verdict == "never" and never.lower > 0 and never.witnesses[1] is None
    q = np.random.default_rng(3).uniform([0, -3], [1, 1.2], (2000, 2))
    least = min(clearance_by_hand(turn) for turn in q[:, 1])
    assert never.lower <= least and clearance_by_hand(never.at[1]) == pytest.approx(never.upper, abs=1e-9)
    always = checker.prove_pair(checker.ids[1], checker.ids[2], [0, TOUCH + 0.05], [1, 1.7])
    assert always.verdict == "always" and always.witnesses[0] is None

    narrow = ([0, -3], [1, TOUCH - 0.01])
    part = checker.prove_pair("bar", "post", *narrow, cells=1)
    assert part.verdict == "open" and 0 < part.share <= 1 and part.cells == 1
    end = checker.resume_range(part)
    whole = checker.prove_pair("bar", "post", *narrow)
    assert (end.verdict, end.lower, end.cells) == (whole.verdict, whole.lower, whole.cells)
    assert end.verdict == "never"


def test_a_clearance_to_a_width(checker):
    for options, most in (({"width": 1e-3}, 1e-3), ({"relative": 0.01}, 0.01 * clearance_by_hand(1.2))):
        answer = checker.prove_pair("bar", "post", [0, -1], [1, 1.2], **options)
        assert answer.verdict == "never" and answer.upper - answer.lower <= most * (1 + 1e-9)
        assert answer.lower <= clearance_by_hand(1.2) <= answer.upper + 1e-12


def test_all_pairs_of_a_range(checker):
    calls = []
    found = checker.prove_range([0, -1], [1, 1], progress=lambda *done: calls.append(done))
    pairs = [("base", "post"), ("bar", "post")]
    assert [(one.a, one.b, one.verdict) for one in found if one.coordinates] == [("bar", "post", "never")]
    assert {(one.a, one.b) for one in found} == set(pairs) and calls[-1][0] <= calls[-1][1]
    assert {one.verdict for one in checker.prove_range()} == {"never", "both"}


def test_an_audit_of_all_pairs(checker):
    found = {(one.a, one.b): one for one in checker.audit(relative=0.1)}
    # Neither joint moves the base against the post.
    assert list(found) == [("base", "bar"), ("bar", "post")]
    both = found["bar", "post"]
    assert (both.verdict, both.lower, both.share, both.is_flush) == ("both", 0, 0, False)
    assert both.coordinates == ["lift", "turn"] and clearance_by_hand(both.contact[1]) <= 0
    assert repr(both) == '<LinkAudit "bar" - "post": both>'
    [answer] = both.answers
    alone = checker.prove_pair("bar", "post", relative=0.1)
    assert answer.verdict == alone.verdict and answer.range.tolist() == checker.limits.tolist()
    assert found["base", "bar"].cells == sum(one.cells for one in found["base", "bar"].answers)

    checker.move_obstacle("post", ((9, 0, 0), (0, 0, 0, 1)))
    calls = []
    far = checker.audit(relative=0.1, progress=lambda *done: calls.append(done))[-1]
    assert (far.a, far.b, far.verdict, far.contact) == ("bar", "post", "never", None) and calls
    least = 9 - 0.1 - math.hypot(2, 0.1)
    assert least * 0.9 - 1e-9 <= far.lower <= least <= far.upper and len(far.at) == 2


def test_an_audit_that_is_resumed_or_ends_in_time(checker):
    part = checker.audit(cells=1)
    assert part[-1].verdict == "open" and 0 < part[-1].share <= 1
    whole, end = checker.audit(cells=500), checker.audit(cells=499, resume=part)
    told = [[(one.a, one.b, one.verdict, one.lower, one.cells) for one in all] for all in (whole, end)]
    assert told[0] == told[1]
    began = time.monotonic()
    late = checker.audit(cells=10**12, width=1e-300, seconds=0.1)
    assert time.monotonic() - began < 20 and late
    with pytest.raises(lc.PlanError, match="seconds is -1"):
        checker.audit(seconds=-1)
    with pytest.raises(lc.PlanError, match="width and relative"):
        checker.audit(width=1, relative=0.5)
    checker.move_obstacle("post", ((9, 0, 0), (0, 0, 0, 1)))
    with pytest.raises(lc.PlanError, match="does not belong to this checker"):
        checker.audit(resume=part)

    def stop(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        checker.audit(width=1e-300, cells=10**12, progress=stop)


def test_what_cannot_be_proven(checker):
    for low, high, why in (
        ([0, -4], None, "low: turn is -4, outside its limits -3 and 3"),
        (None, [0, math.nan], "high: turn is NaN"),
        ([0, 0, 0], None, r"low: shape is \(3,\) \(expected \(2,\)"),
        ([0.5, 0], [0.2, 1], "range of lift is empty: 0.5 to 0.2"),
    ):
        with pytest.raises(lc.PlanError, match=why):
            checker.prove_range(low, high)
    for options, why in (
        ({"width": 0}, "width is 0"),
        ({"relative": 1}, "relative is 1"),
        ({"width": 1, "relative": 0.5}, "width and relative"),
    ):
        with pytest.raises(lc.PlanError, match=why):
            checker.prove_range(**options)
    with pytest.raises(lc.PlanError, match='"pos" does not exist.*nearest: "post"'):
        checker.prove_pair("bar", "pos")
    with pytest.raises(lc.PlanError, match="not a pair"):
        checker.prove_pair("post", "post")
    with pytest.raises(lc.PlanError, match='"post": the name is taken'):
        checker.add_obstacle("post", lc.Geometry.ball(0.1), ((5, 0, 0), (0, 0, 0, 1)))


def test_ctrl_c_ends_a_proof(checker):
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        checker.prove_pair("bar", "post", [0, -3], [1, TOUCH - 1e-9], width=1e-300, cells=10**12)
    timer.join()
