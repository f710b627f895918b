"""Masked arrays: numpy drops their masks where it makes an array, so an argument with a mask is an error that names it."""

import numpy as np
import pytest

import lin_canny as lc

POINTS = np.ma.masked_equal([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 7]], 7)
POSE = np.ma.array(np.eye(4), mask=False)
POSE[0, 3] = np.ma.masked
BALL = lc.Geometry.ball(1)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lc.Cloud(POINTS, radius=0.1), "points: the mask covers 1 entries"),
        (lambda: lc.Cloud(list(POINTS), radius=0.1), "points: the mask covers 1 entries"),
        (lambda: lc.Cloud(POINTS.filled(0), radius=np.ma.masked_less([1.0, 1, 1, 0], 1)), "radius: the mask covers"),
        (lambda: lc.Cloud.from_mask(np.ma.array(np.ones((2, 2, 2), bool), mask=True), size=1), "occupied: the mask"),
        (lambda: lc.Geometry.hull(POINTS), "the mask covers 1 entries"),
        (lambda: lc.PairTracker().closest(BALL, BALL, POSE), "pose: the mask covers 1 entries"),
        (lambda: lc.PairTracker().closest(BALL, BALL, POSE.astype(np.float32)), "pose: the mask covers 1 entries"),
        (lambda: lc.PairTracker().closest(BALL, BALL, None, (POINTS[3], (0, 0, 0, 1))), "pose: the mask covers 1 entries"),
        (lambda: lc.closest_batch(BALL, BALL, np.ma.stack([POSE, POSE])), "the mask covers 2"),
        (
            lambda: lc.closest_batch(BALL, BALL, (POINTS[3:], np.array([[0.0, 0, 0, 1]]))),
            "poses: the mask covers 1 entries",
        ),
    ],
)
def test_a_mask_is_refused(call, words):
    with pytest.raises(lc.LinCannyError, match=words):
        call()


def test_a_mask_that_covers_nothing_is_none():
    clear = np.ma.array(POINTS.filled(0), mask=False)
    assert len(lc.Cloud(clear, radius=0.1)) == 4
    assert lc.PairTracker().closest(BALL, BALL, np.ma.array(np.eye(4), mask=False)) is not None
