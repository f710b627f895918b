"""Gradients of the distance of two geometries against central differences."""

import math
import pickle

import numpy as np
import pytest

import lin_canny as lc

BOX = lc.Geometry.box(0.5, 0.7, 0.9)
STEP = 1e-5


def hull(count, seed):
    return lc.Geometry.hull(np.random.default_rng(seed).normal(size=(count, 3)) * 0.6)


def torus():
    """Return a closed mesh with a hole."""
    rows, columns = 16, 10
    u, v = np.meshgrid(np.arange(rows) * 2 * np.pi / rows, np.arange(columns) * 2 * np.pi / columns, indexing="ij")
    ring = 0.8 + 0.3 * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), 0.3 * np.sin(v)], -1).reshape(-1, 3)
    k, j = (each.ravel() for each in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    a, b = k * columns + j, (k + 1) % rows * columns + j
    c, d = (k + 1) % rows * columns + (j + 1) % columns, k * columns + (j + 1) % columns
    return lc.Geometry.mesh(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


KINDS = {
    "box": BOX,
    "hull": hull(30, 1),
    "ball": lc.Geometry.ball(0.5),
    "capsule": lc.Geometry.capsule(half_length=0.6, radius=0.3),
    "cylinder": lc.Geometry.cylinder(half_height=0.6, radius=0.4),
    "cone": lc.Geometry.cone(half_height=0.6, radius=0.4),
    "ellipsoid": lc.Geometry.ellipsoid(0.4, 0.5, 0.8),
    "rounded": hull(12, 2).rounded(0.1),
    "mesh": torus(),
    "pieces": lc.Geometry.pieces([(BOX, ((1, 0, 0), (0, 0, 0, 1))), lc.Geometry.ball(0.6)]),
    "cloud": lc.Cloud(np.random.default_rng(3).normal(size=(60, 3)) * 0.5, radius=0.05),
    "half-space": lc.Geometry.half_space([0.2, 0.1, 1], -0.4),
}


def turned(pose, twist):
    """Return a pose after a small twist in the world about the origin of the body."""
    linear, angular = twist[:3], twist[3:]
    angle = np.linalg.norm(angular)
    matrix = pose.copy()
    matrix[:3, 3] += linear
    if angle > 0:
        x, y, z = angular / angle
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        matrix[:3, :3] = (np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross) @ pose[:3, :3]
    return matrix


def random_pose(rng, spread):
    pose = np.eye(4)
    pose[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    pose[:3, :3] *= np.sign(np.linalg.det(pose[:3, :3]))
    pose[:3, 3] = rng.normal(size=3) * spread
    return pose


@pytest.mark.parametrize("name", KINDS)
def test_gradients_are_central_differences(name):
    rng = np.random.default_rng(7)
    other, compared, jumps, depths = KINDS[name], 0, 0, 0
    for first in (BOX, KINDS["capsule"]):
        for _ in range(25):
            poses = [random_pose(rng, 0.9), random_pose(rng, 0.9)]
            tracker = lc.PairTracker()
            here = tracker.closest(first, other, *poses)
            if here.lower == -math.inf:
                assert not np.any(here.gradient_a) and not np.any(here.gradient_b)
                continue
            if abs(here.distance) < 1e-3:
                continue
            for k, gradient in enumerate((here.gradient_a, here.gradient_b)):
                assert gradient.shape == (6,)
                ends = []
                for axis in range(6):
                    moved = []
                    for sign in (-1, 1):
                        at = list(poses)
                        at[k] = turned(poses[k], sign * STEP * np.eye(6)[axis])
                        moved.append(tracker.closest(first, other, *at))
                    ends.append(moved)
                name_of = ("gradient_a", "gradient_b")[k]
                spread = max(np.abs(getattr(m, name_of) - getattr(n, name_of)).max() for m, n in ends)
                if spread > 1e-3:  # a tie: the witness jumps
                    jumps += 1
                    continue
                by_hand = np.array([(n.distance - m.distance) / (2 * STEP) for m, n in ends])
                assert np.abs(gradient - by_hand).max() < 1e-6, (name, here, gradient, by_hand)
                compared += 1
                depths += here.distance < 0
    assert compared > 40 and jumps < compared / 3, (compared, jumps)
    assert depths > 0 or name in ("mesh", "pieces", "cloud")


def test_a_gradient_by_hand():
    # A box of half 0.5 turns about its origin; its face is 1 from the ball.
    box, ball = lc.Geometry.box(0.5, 0.5, 0.5), lc.Geometry.ball(0.25)
    c = lc.PairTracker().closest(box, ball, None, ((1.75, 0.3, 0), (0, 0, 0, 1)))
    assert c.distance == pytest.approx(1)
    # The contact on A is at (0.5, 0.3, 0): turned about z, the face moves towards the ball by -0.3.
    assert np.allclose(c.gradient_a, [-1, 0, 0, 0, 0, 0.3], atol=1e-12)
    assert np.allclose(c.gradient_b, [1, 0, 0, 0, 0, 0], atol=1e-12)
    again = pickle.loads(pickle.dumps(c))
    assert np.array_equal(again.gradient_a, c.gradient_a) and np.array_equal(again.gradient_b, c.gradient_b)
    # At a tie, the true rate is at most that of the gradient: both faces are parallel.
    tie = lc.PairTracker().closest(box, box, None, ((2, 0, 0), (0, 0, 0, 1)))
    rate = tie.gradient_a @ [0, 0, 0, 0, 0, 1]
    turn = np.array([0, 0, math.sin(5e-7), math.cos(5e-7)])
    moved = lc.PairTracker().distance(box, box, ((0, 0, 0), turn), ((2, 0, 0), (0, 0, 0, 1)))
    assert (moved - 1) / 1e-6 <= rate + 1e-6


def test_no_gradient_without_a_depth():
    mesh = KINDS["mesh"]
    c = lc.PairTracker().closest(mesh, BOX, None, ((0.8, 0, 0), (0, 0, 0, 1)))
    assert c.lower == -math.inf and not np.any(c.gradient_a) and not np.any(c.gradient_b)
