import os
import pickle
import signal
import threading

import numpy as np
import pytest

import lin_canny as lc

BOX = lc.Geometry.box(1, 1, 1)
MESH = lc.Geometry.mesh(BOX.vertices, BOX.triangles)


def box_distance(points):
    """Return the signed distances of points and the box."""
    over = np.abs(points) - 1
    return np.linalg.norm(np.maximum(over, 0), axis=1) + np.minimum(over.max(axis=1), 0)


def random_points(count):
    return np.random.default_rng(3).uniform(-2, 2, size=(count, 3))


@pytest.mark.parametrize("geometry", [BOX, MESH])
def test_distances_are_those_of_the_closed_form(geometry):
    points = random_points(3000)
    distance, lower, upper = lc.signed_distance(geometry, points, bounds=True)
    assert np.array_equal(distance, lc.signed_distance(geometry, points, threads=2))
    truth = box_distance(points)
    assert np.all(lower <= truth + 1e-15) and np.all(truth <= upper + 1e-15)
    assert np.array_equal(lc.contains(geometry, points), truth <= 0)
    closest, signed, subshapes = lc.closest_points(geometry, points)
    assert np.allclose(np.linalg.norm(closest - points, axis=1), np.abs(truth), atol=1e-12)
    assert np.array_equal(signed, distance) and subshapes.dtype == np.int64


def test_a_step_of_the_last_place_beside_a_face():
    one = [[0.1, 0.2, np.nextafter(1, 2)], [0.1, 0.2, 1], [0.1, 0.2, np.nextafter(1, 0)]]
    assert lc.contains(MESH, one).tolist() == [False, True, True]


def test_points_of_other_shapes_are_refused():
    with pytest.raises(lc.LinCannyError, match=r"points: shape is \(3,\)"):
        lc.signed_distance(MESH, [1, 2, 3])
    points = random_points(1500)
    points[1234, 1] = np.nan
    with pytest.raises(lc.LinCannyError, match="point 1234 is not finite"):
        lc.contains(MESH, points)
    assert lc.signed_distance(MESH, np.empty((0, 3))).shape == (0,)


def bent(rows):
    """Return a mesh of a bumpy height field with a base: closed, not convex."""
    x, y = np.meshgrid(np.arange(rows), np.arange(rows), indexing="ij")
    return lc.Geometry.from_heights(0.3 * np.sin(x) + 0.2 * np.cos(1.7 * y), spacing=(0.5, 0.5), base=-1)


def distances_to_triangles(mesh, p):
    """Return the distance of a point to each triangle, by trimesh."""
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    corners = mesh.vertices[mesh.triangles]
    closest = trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1)))
    return np.linalg.norm(closest - p, axis=1)


def test_near_features_are_those_of_all_triangles():
    mesh = bent(9)
    for p in np.random.default_rng(4).uniform(-1, 5, size=(30, 3)):
        truth = distances_to_triangles(mesh, p)
        near = lc.nearest_features(mesh, p, 7)
        assert len(near) == 7 and np.all(np.diff(near["upper"]) >= 0)
        assert np.allclose(near["distance"], np.sort(truth)[:7], atol=1e-9)
        assert np.allclose(truth[near["part"]], near["distance"], atol=1e-9)
        assert np.allclose(np.linalg.norm(near["point"] - p, axis=1), near["distance"], atol=1e-9)
        assert np.all(near["lower"] <= truth[near["part"]] + 1e-9)
        d = float(np.sort(truth)[12]) + 1e-9
        held = lc.within(mesh, p, d)
        assert len(held) >= 13 and np.array_equal(np.sort(held["part"]), np.flatnonzero(truth <= d))
        assert held[:7].tobytes() == near.tobytes()
    assert len(lc.nearest_features(mesh, p, 10**9)) == len(mesh.triangles)
    assert len(lc.nearest_features(mesh, p, 0)) == len(lc.within(mesh, p, -1)) == 0


def test_near_features_of_other_kinds():
    at = np.arange(30.0).reshape(10, 3)
    cloud = lc.Cloud(at, radius=0.25)
    near = lc.nearest_features(cloud, at[4] + [0.5, 0, 0], 3)
    assert near["part"].tolist() == [4, 5, 3] and near["distance"][0] == pytest.approx(0.25)
    # Inside an element the distance is negative.
    assert lc.within(cloud, at[2], 0)["distance"].tolist() == [-0.25]
    faces = lc.nearest_features(BOX, [0, 0, 3], 2)
    assert faces["distance"][0] == 2 and faces["normal"][0].tolist() == [0, 0, 1] and len(faces) == 2
    assert len(lc.within(BOX, [0, 0, 0], 1)) == 6
    assert lc.nearest_features(lc.Geometry.ball(1), [0, 0, 3], 5)["distance"].tolist() == [2]
    for call in (lambda p: lc.nearest_features(BOX, p, 1), lambda p: lc.within(BOX, p, 1)):
        with pytest.raises(lc.LinCannyError, match="not finite"):
            call([0, np.nan, 0])
        with pytest.raises(lc.LinCannyError, match=r"point: shape is \(1, 3\)"):
            call([[0, 0, 0]])
    with pytest.raises(lc.LinCannyError, match="d is NaN"):
        lc.within(BOX, [0, 0, 0], np.nan)


@pytest.mark.parametrize("geometry", [MESH, bent(5), lc.Geometry.capsule(half_length=1, radius=0.3)])
def test_a_grid_bounds_its_error(geometry):
    interpolate = pytest.importorskip("scipy.interpolate", reason="scipy is not installed")
    values, errors, axes = lc.signed_distance_grid(geometry, 12)
    assert values.shape == tuple(map(len, axes)) and errors.shape == tuple(n - 1 for n in values.shape)
    assert max(errors.shape) == 12 and isinstance(axes, tuple)
    low, high = [axis[0] for axis in axes], [axis[-1] for axis in axes]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    assert np.array_equal(values.ravel(), lc.signed_distance(geometry, nodes))
    points = np.random.default_rng(5).uniform(low, high, size=(5000, 3))
    guess = interpolate.RegularGridInterpolator(axes, values)(points)
    _, lower, upper = lc.signed_distance(geometry, points, bounds=True)
    each = zip(axes, points.T, errors.shape)
    cells = tuple(np.clip(np.searchsorted(axis, x, "right") - 1, 0, n - 1) for axis, x, n in each)
    assert np.all(guess - errors[cells] <= upper + 1e-12) and np.all(guess + errors[cells] >= lower - 1e-12)
    same = lc.signed_distance_grid(geometry, errors.shape, low=low, high=high, threads=2)
    assert np.allclose(same[0], values, atol=1e-12)
    assert same[0].tobytes() == lc.signed_distance_grid(geometry, errors.shape, low=low, high=high)[0].tobytes()


def test_progress_and_faults_of_grids():
    calls = []
    values, errors, axes = lc.signed_distance_grid(
        MESH, (2, 3, 4), low=[-2, -2, -2], high=[2, 3, 4], progress=lambda *done: calls.append(done)
    )
    assert calls[0] == (20, 60) and calls[-1] == (60, 60) and errors.shape == (2, 3, 4)
    for axis, expected in zip(axes, ([-2, 0, 2], [-2, -1 / 3, 4 / 3, 3], [-2, -0.5, 1, 2.5, 4])):
        assert np.allclose(axis, expected)
    assert np.all(errors >= 0.5 * np.linalg.norm([2, 5 / 3, 1.5]))
    floor = lc.Geometry.half_space([0, 0, 1])
    with pytest.raises(lc.LinCannyError, match="half-space has no box: low and high are missing"):
        lc.signed_distance_grid(floor, 4)
    assert lc.signed_distance_grid(floor, 4, low=[-1] * 3, high=[1] * 3)[0][0, 0].tolist() == [-1, -0.5, 0, 0.5, 1]
    for arguments, why in (
        ({"cells": 0}, "0 cells"),
        ({"cells": (1, 0, 1)}, "0 cells"),
        ({"cells": 10**9}, "2.31 nodes"),
        ({"cells": 2, "low": [5, 5, 5]}, "side of -"),
        ({"cells": 2, "low": [np.nan, 0, 0]}, "not finite"),
        ({"cells": 2, "threads": 0}, "threads is 0"),
    ):
        with pytest.raises(lc.LinCannyError, match=why):
            lc.signed_distance_grid(MESH, **arguments)


@pytest.mark.skipif(os.name != "posix", reason="needs signals of POSIX")
def test_ctrl_c_ends_a_grid():
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        lc.signed_distance_grid(bent(40), 400)


def test_a_tracked_point_has_the_answers_of_a_batch():
    for geometry in (bent(9), BOX, lc.Geometry.ball(0.5)):
        path = np.cumsum(np.random.default_rng(6).normal(0, 0.02, size=(500, 3)), axis=0)
        distance, lower, upper = lc.signed_distance(geometry, path, bounds=True)
        points, _, parts = lc.closest_points(geometry, path)
        tracker, inside = lc.PointTracker(), lc.contains(geometry, path)
        for k, p in enumerate(path):
            found = tracker.closest_point(geometry, p)
            if geometry.kind == "mesh":
                assert (found.distance, found.lower, found.upper) == (distance[k], lower[k], upper[k])
                assert found.part == parts[k] and np.array_equal(found.point, points[k])
            assert found.distance == pytest.approx(distance[k], abs=1e-12)
            assert (found.state != "separated") == inside[k]
            assert np.allclose(found.point + found.distance * found.normal, p, atol=1e-6)
        other = pickle.loads(pickle.dumps((tracker, found)))[1]
        assert repr(other) == repr(found) and other.feature == found.feature
    with pytest.raises(lc.LinCannyError, match="point 0 is not finite"):
        tracker.closest_point(BOX, [np.inf, 0, 0])


def test_nan_is_an_error_with_its_index():
    points = random_points(3000)
    points[2345, 2] = np.nan
    for call in (lc.signed_distance, lc.contains, lc.closest_points):
        for threads in (1, 2):
            with pytest.raises(lc.LinCannyError, match="points: point 2345 is not finite"):
                call(MESH, points, threads=threads)
