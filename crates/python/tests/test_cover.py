import numpy as np
import pytest

import lin_canny as lc

BOX = lc.Geometry.box(1, 0.5, 0.25)
MESH = lc.Geometry.mesh(BOX.vertices, BOX.triangles)


def excess(centers, radii, points):
    """Return the distance of each point from the nearest ball, negative inside."""
    return (np.linalg.norm(points[:, None] - centers, axis=2) - radii).min(axis=1)


@pytest.mark.parametrize("geometry", [BOX, MESH])
def test_balls_contain_the_body_or_are_inside(geometry):
    points = np.random.default_rng(1).uniform(-1.2, 1.2, size=(5000, 3))
    inside = lc.contains(geometry, points)
    centers, radii, gap = lc.cover_outside(geometry, 12)
    assert centers.shape == (len(radii), 3) and 1 <= len(radii) <= 12
    assert np.all(excess(centers, radii, points[inside]) <= 0)
    held = excess(centers, radii, points) <= 0
    assert np.all(lc.signed_distance(geometry, points[held]) <= gap)

    centers, radii, left = lc.cover_inside(geometry, 12)
    assert np.all(-lc.signed_distance(geometry, centers) >= radii - 1e-15)
    assert np.all(excess(centers, radii, points[inside]) <= left)


def test_a_gap_is_reached():
    centers, radii, gap = lc.cover_outside(BOX, gap=0.1)
    assert gap <= 0.1 and len(radii) > 1


def test_errors_name_the_argument():
    for arguments in [{}, {"balls": 3, "gap": 0.1}]:
        with pytest.raises(lc.LinCannyError, match="balls, gap"):
            lc.cover_outside(BOX, **arguments)
    with pytest.raises(lc.LinCannyError, match="number of balls is out of range: 0"):
        lc.cover_inside(BOX, 0)
    with pytest.raises(lc.LinCannyError, match="gap of the cover is out of range"):
        lc.cover_outside(BOX, gap=float("nan"))
    with pytest.raises(lc.LinCannyError, match="no ball is inside the point or segment"):
        lc.cover_inside(lc.Geometry.segment([0, 0, 0], [1, 0, 0]), 1)


@pytest.mark.parametrize("geometry", [BOX, MESH, lc.Geometry.ball(1.0)])
@pytest.mark.parametrize("faces", [4, 6, 20])
def test_a_hull_of_few_faces_contains_the_body(geometry, faces):
    hull, normals, offsets, gap = lc.hull_outside(geometry, faces)
    assert normals.shape == (len(offsets), 3) and 4 <= len(offsets) <= faces
    points = np.random.default_rng(2).uniform(-1, 1, size=(2000, 3))
    points = np.vstack([points, BOX.vertices])
    points = points[lc.signed_distance(geometry, points) <= 0]
    assert np.all(lc.contains(hull, points))
    assert np.all(points @ normals.T <= offsets + 1e-15)
    assert np.all(lc.signed_distance(geometry, hull.vertices) <= gap + 1e-15)


def test_errors_of_hulls_name_the_number():
    with pytest.raises(lc.LinCannyError, match="number of faces is out of range: 3"):
        lc.hull_outside(BOX, 3)
