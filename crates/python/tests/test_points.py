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
