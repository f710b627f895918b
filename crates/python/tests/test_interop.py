import numpy as np
import pytest

import lin_canny as lc

BOX = lc.Geometry.box(1, 1, 1)
BALL = lc.Geometry.ball(0.5)


def test_trimesh_there_and_back():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    pytest.importorskip("scipy", reason="scipy, which trimesh needs here, is not installed")
    torus = trimesh.creation.torus(1.0, 0.3)
    mesh = lc.Geometry.from_trimesh(torus)
    assert mesh.is_solid and not mesh.is_convex
    back = mesh.to_trimesh()
    assert back.is_watertight and back.volume == pytest.approx(torus.volume, rel=1e-12)
    # A ball in the hole touches nothing of the mesh, and is inside its hull.
    small = lc.Geometry.ball(0.1)
    inside = lc.PairTracker().closest(mesh, small)
    assert inside.distance == pytest.approx(0.6, abs=0.01)
    assert lc.PairTracker().distance(lc.Geometry.hull(torus.vertices), small) < 0
    pose = trimesh.transformations.rotation_matrix(0.3, [1, 0, 0], [0, 0, 1])
    assert lc.PairTracker().distance(mesh, mesh, None, pose) == 0


def test_scipy_rotations():
    transform = pytest.importorskip("scipy.spatial.transform", reason="scipy is not installed")
    turns, at = transform.Rotation.random(50, rng=1), np.random.default_rng(1).normal(size=(50, 3)) * 3
    m = np.tile(np.eye(4), (50, 1, 1))
    m[:, :3, :3], m[:, :3, 3] = turns.as_matrix(), at
    expected = lc.distances(BOX, BALL, m)["distance"]
    assert np.allclose(lc.distances(BOX, BALL, (at, turns))["distance"], expected, atol=1e-13)
    single = [lc.PairTracker().distance(BOX, BALL, None, (p, r)) for p, r in zip(at, turns)]
    assert np.allclose(single, expected, atol=1e-13)
    if hasattr(transform, "RigidTransform"):
        rigid = transform.RigidTransform.from_components(at, turns)
        assert np.allclose(lc.distances(BOX, BALL, rigid)["distance"], expected, atol=1e-13)
        found = lc.PairTracker().distance(BOX, BALL, None, rigid[7])
        assert found == pytest.approx(expected[7], abs=1e-13)


def test_poses_of_pinocchio():
    pin = pytest.importorskip("pinocchio", reason="pinocchio (package pin) is not installed")
    pin.seed(1)
    for _ in range(50):
        pose = pin.SE3.Random()
        by_pin = lc.PairTracker().closest(BOX, BALL, pose, pin.SE3.Identity())
        by_matrix = lc.PairTracker().closest(BOX, BALL, pose.homogeneous, None)
        assert by_pin.distance == by_matrix.distance
        seven = pin.SE3ToXYZQUAT(pose)
        assert lc.PairTracker().distance(BOX, BALL, seven) == pytest.approx(by_pin.distance, abs=1e-13)


def test_coal_agrees_where_it_is_installed():
    coal = pytest.importorskip("coal", reason="coal is not installed")
    at = np.random.default_rng(2).normal(size=(200, 3)) * 3
    box, ball = coal.Box(2, 2, 2), coal.Sphere(0.5)
    request, here = coal.DistanceRequest(), coal.Transform3s.Identity()
    for p in at:
        result = coal.DistanceResult()
        there = coal.Transform3s(np.eye(3), p)
        coal.distance(box, here, ball, there, request, result)
        assert lc.PairTracker().distance(BOX, BALL, None, (p, (0, 0, 0, 1))) == pytest.approx(
            result.min_distance, abs=1e-5
        )
