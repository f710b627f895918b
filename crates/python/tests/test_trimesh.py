"""The twin of trimesh.collision; `.ci/trimesh` runs trimesh's own tests against it."""

import inspect
import math

import numpy as np
import pytest

import lin_canny as lc

trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
pytest.importorskip("scipy", reason="scipy, which trimesh needs here, is not installed")

from lin_canny.trimesh import CollisionManager, ContactData, scene_to_collision  # noqa: E402

CUBE = trimesh.creation.box((1, 1, 1))
BALL = trimesh.creation.icosphere(radius=0.2)
TORUS = trimesh.creation.torus(3.0, 1.0)


def at(x, y=0.0, z=0.0):
    return trimesh.transformations.translation_matrix((x, y, z))


def manager(**objects):
    made = CollisionManager()
    for name, (mesh, transform) in objects.items():
        made.add_object(name, mesh, transform)
    return made


def test_signatures_are_those_of_trimesh():
    theirs = trimesh.collision.CollisionManager
    for name, function in inspect.getmembers(theirs, inspect.isfunction):
        if name.startswith("_") and name != "__init__":
            continue
        expected = inspect.signature(function).parameters.values()
        found = inspect.signature(getattr(CollisionManager, name)).parameters.values()
        assert [(p.name, p.default) for p in found] == [(p.name, p.default) for p in expected], name
    for name in ("names", "normal", "point", "depth", "index"):
        assert name == "names" or hasattr(ContactData, name)


def test_objects_are_added_moved_and_removed():
    m = manager(a=(CUBE, None), b=(CUBE, at(5)))
    assert m.in_collision_internal() is False and m.min_distance_internal() == 4.0
    m.set_transform("b", at(1.5))
    assert m.min_distance_internal(return_names=True) == (0.5, ("a", "b"))
    m.set_transform("b", at(0.9))
    assert m.in_collision_internal(return_names=True) == (True, {("a", "b")})
    m.add_object("c", CUBE, at(9))
    assert m.min_distance_internal(name="c", return_names=True) == (pytest.approx(7.1), ("b", "c"))
    assert m.min_distance_internal(name="a", return_names=True) == (pytest.approx(-0.1), ("a", "b"))
    m.remove_object("b")
    assert m.in_collision_internal(return_names=True, return_data=True) == (False, set(), [])
    assert m.min_distance_internal(return_names=True) == (8.0, ("a", "c"))
    with pytest.raises(ValueError, match="b not in collision manager!"):
        m.remove_object("b")
    with pytest.raises(ValueError, match="b not in collision manager!"):
        m.set_transform("b", at(0))
    with pytest.raises(ValueError, match="b not in collision manager!"):
        m.min_distance_internal(name="b")


def test_an_object_of_the_same_name_is_replaced():
    m = manager(a=(CUBE, None))
    m.add_object("a", CUBE, at(5))
    assert m.in_collision_single(CUBE) is False and m.min_distance_single(CUBE) == 4.0


def test_contacts_of_convex_meshes():
    m = manager(a=(CUBE, None), far=(CUBE, at(50)))
    hit, names, (contact,) = m.in_collision_single(CUBE, at(0.75), return_names=True, return_data=True)
    assert hit is True and names == {"a"} and contact.names == {"a", "__external"}
    assert contact.depth == pytest.approx(0.25) and contact.point[0] == pytest.approx(0.375)
    assert np.allclose(contact.normal, [1, 0, 0])
    # The points of the contact lie on the triangles.
    for name, point in (("a", contact.point + [0.125, 0, 0]), ("__external", contact.point - [0.875, 0, 0])):
        triangle = CUBE.triangles[[contact.index(name)]]
        assert np.allclose(trimesh.triangles.closest_point(triangle, [point]), point)
    with pytest.raises(KeyError):
        contact.index("far")
    # Within a manager the normal points from the first name to the second, whatever the order of
    # insertion.
    m = manager(z=(CUBE, None), b=(CUBE, at(0.75)))
    _, names, (contact,) = m.in_collision_internal(return_names=True, return_data=True)
    assert names == {("b", "z")} and np.allclose(contact.normal, [-1, 0, 0])


def test_contacts_of_meshes():
    m = manager(torus=(TORUS, None))
    hit, contacts = m.in_collision_single(CUBE, at(4.3), return_data=True)
    assert hit and contacts
    for contact in contacts:
        assert contact.names == {"torus", "__external"} and 0 <= contact.depth < 0.5
        assert np.linalg.norm(contact.normal) == pytest.approx(1) and contact.normal[0] > 0.5
        triangle = TORUS.triangles[contact.index("torus")]
        assert np.abs(triangle - contact.point).max() < 1


def test_a_watertight_mesh_is_a_solid():
    m = manager(torus=(TORUS, None))
    hit, contacts = m.in_collision_single(BALL, at(3), return_data=True)
    assert hit is True and len(contacts) == 1 and contacts[0].depth > 0.5
    assert m.min_distance_single(BALL, at(3)) == 0.0
    # The hole of the torus is free, and an open mesh has no inside.
    assert m.in_collision_single(BALL) is False and 1.7 < m.min_distance_single(BALL) < 1.9
    half = TORUS.copy()
    half.update_faces(half.triangles_center[:, 2] > 0)
    assert manager(half=(half, None)).in_collision_single(BALL, at(3)) is False


def test_distances_between_managers():
    m = manager(a=(CUBE, None), b=(CUBE, at(5)))
    n = manager(a=(CUBE, at(-4)), torus=(TORUS, at(0, 20)))
    distance, names, data = m.min_distance_other(n, return_names=True, return_data=True)
    assert (distance, names, data.distance, data.names) == (3.0, ("a", "a"), 3.0, {"a"})
    n.remove_object("a")
    distance, names, data = m.min_distance_other(n, return_names=True, return_data=True)
    assert names == ("a", "torus") and distance == pytest.approx(15.5)
    assert np.linalg.norm(data.point("a") - data.point("torus")) == pytest.approx(distance)
    assert np.allclose(data.point("torus"), [0, 16, 0], atol=0.5)
    assert CUBE.face_normals[data.index("a")] @ [0, 1, 0] == pytest.approx(1)
    # The other way round the names are exchanged, and the points are not.
    back = n.min_distance_other(m, return_names=True, return_data=True)
    assert back[1] == ("torus", "a") and np.allclose(back[2].point("a"), data.point("a"), atol=1e-9)
    n.set_transform("torus", at(0, 4.2))
    assert m.in_collision_other(n, return_names=True) == (True, {("a", "torus")})
    assert n.in_collision_other(m, return_names=True) == (True, {("torus", "a")})


def test_transforms_keep_precision_and_may_scale():
    far = 1e6
    m = manager(a=(CUBE, at(far + 0.3)))
    assert m.min_distance_single(CUBE, at(far + 2)) == pytest.approx(0.7, abs=1e-9)
    twice, mirror = np.diag([2.0, 2, 2, 1]), np.diag([-1.0, 1, 1, 1])
    m = manager(a=(CUBE, twice))
    assert m.min_distance_single(CUBE, at(3)) == pytest.approx(1.5)
    m.set_transform("a", np.eye(4))
    assert m.min_distance_single(CUBE, at(3)) == pytest.approx(2)
    wedge = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    for mesh in (wedge, trimesh.util.concatenate([wedge, wedge.copy().apply_translation((9, 9, 9))])):
        m = manager(a=(mesh, mirror))
        assert m.in_collision_single(BALL, at(-0.2, 0.2, 0.2)) is True
        assert m.in_collision_single(BALL, at(0.4, 0.2, 0.2)) is False


def test_a_mesh_that_changes_is_converted_again():
    mesh = CUBE.copy()
    m = CollisionManager()
    m.add_object("a", CUBE)
    assert m.min_distance_single(mesh, at(3)) == 2.0
    mesh.apply_scale(2)
    assert m.min_distance_single(mesh, at(3)) == 1.5


def test_managers_without_pairs():
    m = CollisionManager()
    assert m.in_collision_internal(True, True) == (False, set(), []) and m.in_collision_single(CUBE) is False
    assert m.min_distance_internal(None, True, True) == (math.inf, (None, None), None)
    assert m.min_distance_single(CUBE, return_name=True) == (math.inf, None)
    assert m.min_distance_other(CollisionManager()) == math.inf


def test_a_scene():
    scene = trimesh.Scene()
    scene.add_geometry(CUBE, node_name="a", geom_name="cube")
    scene.add_geometry(CUBE, node_name="b", geom_name="cube", transform=at(3))
    m, objects = scene_to_collision(scene)
    assert set(objects) == {"a", "b"} and isinstance(objects["a"], lc.Geometry)
    assert m.min_distance_internal(return_names=True) == (2.0, ("a", "b"))


def test_refused_objects():
    m = manager(a=(CUBE, None))
    with pytest.raises(lc.GeometryError, match="a Scene has no `vertices` and `faces` .* pass its `to_mesh"):
        m.add_object("b", trimesh.Scene([CUBE]))
    with pytest.raises(lc.PoseError, match=r"transform: shape is \(3, 3\) \(expected \(4, 4\)\)"):
        m.add_object("b", CUBE, np.eye(3))
    for bad in (np.full((4, 4), np.nan), np.diag([1.0, 1, 1, 2])):
        with pytest.raises(lc.PoseError):
            m.add_object("b", CUBE, bad)
        with pytest.raises(lc.PoseError):
            m.set_transform("a", bad)
    # Nothing has changed.
    assert m.min_distance_internal() == math.inf and m.min_distance_single(CUBE, at(3)) == 2.0


def test_fcl_agrees_on_convex_meshes():
    pytest.importorskip("fcl", reason="python-fcl is not installed")
    rng = np.random.default_rng(5)
    ours, theirs = CollisionManager(), trimesh.collision.CollisionManager()
    meshes = [trimesh.convex.convex_hull(rng.normal(size=(20, 3))) for _ in range(12)]
    for turn in range(20):
        for k, mesh in enumerate(meshes):
            pose = trimesh.transformations.random_rotation_matrix(rng.random(3))
            pose[:3, 3] = rng.normal(size=3) * 4
            pose = pose.astype(np.float32).astype(np.float64)  # what trimesh passes to fcl
            if turn == 0:
                ours.add_object(str(k), mesh, pose)
                theirs.add_object(str(k), mesh, pose)
            else:
                ours.set_transform(str(k), pose)
                theirs.set_transform(str(k), pose)
        assert ours.in_collision_internal(return_names=True) == theirs.in_collision_internal(return_names=True)
        probe = meshes[turn % 12]
        assert ours.in_collision_single(probe, None, True) == theirs.in_collision_single(probe, None, True)
        found, expected = ours.min_distance_single(probe), theirs.min_distance_single(probe)
        if expected > 0:
            assert found == pytest.approx(expected, abs=1e-4)
        else:  # fcl stops at the first overlap, which need not be the deepest
            assert found <= expected + 1e-4
