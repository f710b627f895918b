"""Meshes that bend: other vertices of the same triangles, and a mesh against itself."""

import pickle

import numpy as np
import pytest

import lin_canny as lc


def strip(n=10):
    """A strip of n squares along x."""
    vertices = [[k // 2, k % 2, 0.0] for k in range(2 * n + 2)]
    triangles = [t for k in range(0, 2 * n, 2) for t in ([k, k + 2, k + 3], [k, k + 3, k + 1])]
    return np.array(vertices), np.array(triangles)


def folded(vertices, gap):
    """The right half over the left."""
    x = vertices[:, 0]
    over = x > 5
    return np.stack([np.where(over, 10 - x, x), vertices[:, 1], np.where(over, gap, 0.0)], axis=1)


def test_a_bent_mesh_is_as_one_that_is_built_anew():
    vertices, triangles = strip()
    mesh = lc.Geometry.mesh(vertices, triangles)
    assert np.array_equal(mesh.vertices, vertices) and np.array_equal(mesh.triangles, triangles)
    ball = lc.Geometry.ball(0.3)
    tracker = lc.PairTracker()
    for frame in range(20):
        bent = vertices + np.sin(vertices[:, :1] + 0.1 * frame) * [0, 0, 0.5]
        mesh = mesh.with_vertices(bent)
        assert np.array_equal(mesh.vertices, bent) and mesh.kind == "mesh"
        pose_b = ((4.0, 0.5, 2.0), (0, 0, 0, 1))
        found = tracker.closest(mesh, ball, None, pose_b)
        anew = lc.PairTracker().closest(lc.Geometry.mesh(bent, triangles), ball, None, pose_b)
        assert found.distance == pytest.approx(anew.distance, abs=1e-12)
    assert np.array_equal(pickle.loads(pickle.dumps(mesh)).vertices, mesh.vertices)
    again = mesh.rebuilt()
    assert np.array_equal(again.vertices, mesh.vertices)
    assert np.array_equal(again.triangles, triangles)


def test_a_mesh_against_itself():
    vertices, triangles = strip()
    mesh = lc.Geometry.mesh(vertices, triangles)
    tracker = lc.PairTracker()
    flat = tracker.self_closest(mesh)
    assert flat.distance == pytest.approx(0.5**0.5, abs=1e-12)
    for gap in (0.5, 0.25, 0.125):
        mesh = mesh.with_vertices(folded(vertices, gap))
        found = tracker.self_closest(mesh)
        assert found.state == "separated" and found.distance <= gap
        assert tracker.self_within(mesh, gap) and not tracker.self_within(mesh, 0)
        pairs = [pair.parts for pair in tracker.self_pairs(mesh, 0.13)]
        shared = [set(triangles[p]) & set(triangles[q]) for p, q in pairs]
        assert not any(shared)
    assert pairs and all((p < 10) != (q < 10) for p, q in pairs)
    mesh = mesh.with_vertices(folded(vertices, 0.0))
    assert tracker.self_within(mesh, 0) and tracker.self_closest(mesh).state == "touching"
    triangle = lc.Geometry.mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert tracker.self_closest(triangle) is None and tracker.self_pairs(triangle, 1) == []


def test_what_is_refused():
    vertices, triangles = strip()
    mesh = lc.Geometry.mesh(vertices, triangles)
    bad = vertices.copy()
    bad[7, 1] = np.nan
    with pytest.raises(lc.GeometryError, match="7"):
        mesh.with_vertices(bad)
    with pytest.raises(lc.GeometryError, match="22"):
        mesh.with_vertices(vertices[:-1])
    with pytest.raises(lc.GeometryError, match="mesh"):
        lc.Geometry.ball(1).with_vertices(vertices)
    with pytest.raises(lc.GeometryError, match="mesh"):
        lc.PairTracker().self_closest(lc.Geometry.ball(1))
