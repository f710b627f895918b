"""Clouds, voxels, half-spaces and height fields against brute force over their elements."""

import pickle

import numpy as np
import pytest

import lin_canny as lc

HERE = (0, 0, 0, 1)


def rotations(rng, count):
    q = rng.normal(size=(count, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


def poses(rng, count, reach):
    """Return poses, shape (count, 7), with positions up to `reach` along each axis."""
    return np.hstack([rng.uniform(-reach, reach, (count, 3)), rotations(rng, count)])


def points_of(name, rng):
    """Return 60 points: random, on a lattice, repeated, or on a plane."""
    if name == "lattice":
        return np.stack(np.meshgrid(*[np.arange(-1.5, 2)] * 3), -1).reshape(-1, 3)[:60] * 0.5
    points = rng.uniform(-1, 1, (60, 3))
    if name == "repeated":
        points[30:] = points[:30]
    if name == "plane":
        points[:, 2] = 0.25
    return points


def elements(rng):
    """Return the elements of clouds of 60 points: how a cloud is made, and the geometry at a point."""
    radii = rng.uniform(0, 0.1, 60)
    radii[::7] = 0
    egg = lc.Geometry.ellipsoid(0.05, 0.1, 0.08)
    return {
        "ball": ({"radius": 0.05}, lambda k: lc.Geometry.ball(0.05)),
        "point": ({"radius": 0.0}, lambda k: lc.Geometry.point([0, 0, 0])),
        "balls": ({"radius": radii}, lambda k: lc.Geometry.ball(r) if (r := radii[k]) else lc.Geometry.point([0, 0, 0])),
        "box": ({"box": (0.05, 0.1, 0.02)}, lambda k: lc.Geometry.box(0.05, 0.1, 0.02)),
        "shape": ({"shape": egg}, lambda k: egg),
    }


def bodies():
    cube = lc.Geometry.box(0.3, 0.2, 0.4)
    other = lc.Cloud([[0, 0, 0], [0.3, 0.1, 0]], radius=0.1)
    return {
        "hull": lc.Geometry.hull(np.random.default_rng(3).normal(size=(20, 3)) * 0.2),
        "capsule": lc.Geometry.capsule(half_length=0.3, radius=0.1),
        "cone": lc.Geometry.cone(half_height=0.3, radius=0.2),
        "mesh": lc.Geometry.mesh(cube.vertices, cube.triangles),
        "pieces": lc.Geometry.pieces([cube, (lc.Geometry.ball(0.3), ((0.4, 0, 0), HERE))]),
        "cloud": other,
    }


@pytest.mark.parametrize("layout", ["random", "lattice", "repeated", "plane"])
@pytest.mark.parametrize("element", list(elements(np.random.default_rng(0))))
@pytest.mark.parametrize("body", list(bodies()))
def test_a_cloud_is_the_union_of_its_elements(layout, element, body):
    rng = np.random.default_rng(7)
    points, other = points_of(layout, rng), bodies()[body]
    options, geometry = elements(rng)[element]
    cloud, warm, swapped = lc.Cloud(points, **options), lc.PairTracker(), lc.PairTracker()
    single, overlaps = lc.PairTracker(), 0
    for pose in poses(rng, 8, 1.6):
        at = [(tuple(p), HERE) for p in points]
        each = np.array([single.distance(geometry(k), other, at[k], pose) for k in range(60)])
        truth = each.min()
        for found in (warm.closest(cloud, other, None, pose), lc.PairTracker().closest(cloud, other, None, pose)):
            if truth > 1e-9:
                assert found.state == "separated" and found.lower - 1e-9 <= truth <= found.upper + 1e-9
                assert found.distance == pytest.approx(truth, abs=1e-7)
                assert each[found.parts[0]] == pytest.approx(truth, abs=1e-7)
                gap = np.linalg.norm(found.point_b - found.point_a)
                assert gap == pytest.approx(found.distance, abs=1e-9)
            elif truth < -1e-9:
                assert found.state == "overlapping" and found.distance <= 0
        other_way = swapped.closest(other, cloud, pose)
        assert other_way.distance == pytest.approx(found.distance, abs=1e-9)
        if abs(truth) > 1e-9:
            assert warm.intersects(cloud, other, None, pose) == (truth <= 0)
            overlaps += truth <= 0
        for d in (max(truth, 0) + 1e-6, truth - 1e-6):
            if d >= 0 and truth > 1e-9:
                assert warm.within(cloud, other, d, None, pose) == (truth <= d)
    assert overlaps < 8


def test_the_answer_at_many_poses_is_the_loop_bit_for_bit():
    rng = np.random.default_rng(11)
    cloud = lc.Cloud(rng.uniform(-1, 1, (300, 3)).astype(np.float32), radius=0.02)
    for other in (bodies()["hull"], bodies()["mesh"], lc.Geometry.half_space([0, 0, 1])):
        at = poses(rng, 1500, 1.5)
        found = lc.distances(cloud, other, at)
        assert np.array_equal(found, lc.distances(cloud, other, at, threads=3))
        for block in (at[:1024], at[1024:]):  # each block begins with a new tracker
            tracker = lc.PairTracker()
            loop = [tracker.closest(cloud, other, None, pose) for pose in block]
            rows, found = found[: len(block)], found[len(block) :]
            for name in ("distance", "lower", "upper"):
                assert [getattr(c, name) for c in loop] == rows[name].tolist()


def test_contacts_depths_casts_and_rays_of_a_cloud():
    grid = np.stack(np.meshgrid(np.arange(-2, 3), np.arange(-2, 3), [0]), -1).reshape(-1, 3) * 0.1
    cloud, die = lc.Cloud(grid, radius=0.05), lc.Geometry.box(0.1, 0.1, 0.1)
    tracker = lc.PairTracker()
    found = tracker.contacts(cloud, die, None, ((0, 0, 0.14), HERE))
    assert len(found) and found["separation"].min() == pytest.approx(-0.01, abs=1e-9)
    depth = tracker.penetration(cloud, die, None, ((0, 0, 0.14), HERE))
    assert depth.lower <= 0.01 + 1e-9 and 0.01 - 1e-9 <= depth.upper
    lifted = ((*(depth.shift * (1 + 1e-9) + [0, 0, 0.14]),), HERE)
    assert tracker.closest(cloud, die, None, lifted).distance >= -1e-9
    falling = {"velocity_b": ((0, 0, -1), (0, 0, 0)), "duration": 2, "tolerance": 1e-9}
    hit = tracker.cast(cloud, die, None, ((0, 0, 1.15), HERE), **falling)
    assert hit.state == "hit" and hit.safe <= 1.0 <= hit.hit + 1e-12 and hit.hit - hit.safe < 1e-6
    assert tracker.cast(cloud, die, None, ((5, 0, 1.15), HERE), **falling).state == "miss"
    ray = lc.RayCaster().cast(cloud, [0.1, 0.2, 3], [0, 0, -2])
    assert ray.state == "hit" and ray.safe <= 2.95 <= ray.hit + 1e-12
    assert np.allclose(grid[ray.part], [0.1, 0.2, 0]) and ray.normal[2] == pytest.approx(1)
    assert lc.RayCaster().cast(cloud, [0.1, 0.2, 0.01], [0, 0, 1]).state == "inside"
    assert lc.RayCaster().cast(cloud, [0.1, 0.2, 3], [0, 0, -1], 2.9).state == "miss"


def test_voxels_are_boxes_of_cells():
    rng = np.random.default_rng(5)
    mask = rng.random((4, 5, 3)) < 0.3
    cells, size, origin = np.argwhere(mask), np.array([0.2, 0.1, 0.3]), np.array([-1, 0.5, 0.25])
    voxels = lc.Cloud.from_mask(mask, size=size, origin=origin)
    by_cells = lc.Cloud.from_cells(cells, size=size, origin=origin)
    boxes = lc.Cloud(origin + size * (cells + 0.5), box=size / 2)
    ball, trackers = lc.Geometry.ball(0.1), [lc.PairTracker() for _ in range(3)]
    for pose in poses(rng, 200, 2):
        found = [t.distance(c, ball, None, pose) for t, c in zip(trackers, (voxels, by_cells, boxes), strict=True)]
        assert found[0] == found[1] and found[0] == pytest.approx(found[2], abs=1e-12)
    assert len(voxels) == mask.sum() and {tuple(c) for c in voxels.cells} == {tuple(c) for c in cells}
    assert np.allclose(voxels.points, origin + size * (voxels.cells + 0.5), atol=1e-15)
    assert boxes.cells is None
    unit = lc.Cloud.from_cells([[1, 2, 3]], size=1.0)
    assert unit.points.tolist() == [[1.5, 2.5, 3.5]]


def test_points_stay_as_given():
    points = np.random.default_rng(1).normal(size=(100, 3))
    single = points.astype(np.float32)
    assert np.array_equal(lc.Cloud(points, radius=0).points, points)
    assert np.array_equal(lc.Cloud(single, radius=0).points, single)
    assert np.array_equal(lc.Cloud(points[::-1, ::-1], radius=0).points, points[::-1, ::-1])
    assert lc.Cloud(single, radius=0).memory_usage < lc.Cloud(points, radius=0).memory_usage
    cloud = lc.Cloud(points, radius=0.5)
    assert isinstance(cloud, lc.Geometry) and len(cloud) == 100 and repr(cloud) == "<Cloud: 100 points>"
    assert cloud.kind == "cloud" and not cloud.is_convex and cloud.is_solid
    centre, radius = cloud.bounding_ball
    assert np.all(np.linalg.norm(points - centre, axis=1) + 0.5 <= radius * (1 + 1e-12))


def test_pickled_clouds_give_the_same_bits():
    points = np.random.default_rng(2).normal(size=(50, 3))
    kinds = [
        lc.Cloud(points, radius=0.1),
        lc.Cloud(points, radius=np.linspace(0, 1, 50)),
        lc.Cloud(points.astype(np.float32), box=(1, 2, 3)),
        lc.Cloud.from_cells([[0, 1, 2], [5, 4, 3]], size=0.5),
        lc.Geometry.half_space([1, 2, 3], 0.5),
        lc.Geometry.from_heights(np.zeros((3, 4)), spacing=(1, 1), base=-1),
    ]
    for before in kinds:
        after = pickle.loads(pickle.dumps(before))
        assert type(after) is type(before) and repr(after) == repr(before)
        found = [lc.PairTracker().distance(g, lc.Geometry.ball(0.5), None, ((9, 8, 7), HERE)) for g in (before, after)]
        assert found[0] == found[1]


def test_a_half_space_measures_the_lowest_point_of_every_kind():
    floor, rng = lc.Geometry.half_space([0, 0, 2], 0.5), np.random.default_rng(9)
    every = bodies() | {"egg": lc.Geometry.ellipsoid(0.1, 0.2, 0.3), "ball": lc.Geometry.ball(0.2)}
    tracker = lc.PairTracker()
    for body in every.values():
        for pose in poses(rng, 20, 1):
            # A large box below the plane gives the same distance, where the depth of the kind is known.
            slab = lc.Geometry.box(50, 50, 0.5)
            found = tracker.closest(floor, body, None, pose)
            assert found.normal @ [0, 0, 1] == pytest.approx(1)
            assert found.point_b[2] - 0.25 == pytest.approx(found.distance, abs=1e-9)
            if found.distance > 1e-6:
                by_slab = tracker.distance(slab, body, ((0, 0, -0.25), HERE), pose)
                assert found.distance == pytest.approx(by_slab, abs=1e-7)
            assert tracker.intersects(floor, body, None, pose) == (found.distance <= 0)
    assert repr(floor) == "<Geometry half-space: normal (0, 0, 1), offset 0.25>"
    assert floor.is_convex and floor.is_solid and floor.kind == "half-space"


def test_a_height_field_is_the_mesh_of_its_squares():
    rows, columns = 5, 7
    heights = np.random.default_rng(4).uniform(0, 0.5, (rows, columns))
    x, y = np.meshgrid(np.arange(columns) * 0.5, np.arange(rows) * 0.25)
    vertices = np.stack([x, y, heights], -1).reshape(-1, 3)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    triangles = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 2).reshape(-1, 3)
    mesh = lc.Geometry.mesh(vertices, triangles)
    field = lc.Geometry.from_heights(heights, spacing=(0.5, 0.25))
    solid = lc.Geometry.from_heights(heights, spacing=(0.5, 0.25), base=-1)
    assert np.array_equal(field.triangles, triangles) and np.array_equal(field.vertices, vertices)
    assert not field.is_solid and solid.is_solid
    ball, rng = lc.Geometry.ball(0.1), np.random.default_rng(6)
    for pose in poses(rng, 100, 3):
        assert lc.PairTracker().distance(field, ball, None, pose) == lc.PairTracker().distance(mesh, ball, None, pose)
    assert lc.PairTracker().intersects(solid, ball, None, ((1.5, 0.5, -0.5), HERE))
    assert not lc.PairTracker().intersects(field, ball, None, ((1.5, 0.5, -0.5), HERE))


def test_clouds_and_half_spaces_in_a_scene():
    scene, rng = lc.Scene(), np.random.default_rng(8)
    points = rng.uniform(-1, 1, (200, 3))
    cloud, floor, ball = lc.Cloud(points, radius=0.05), lc.Geometry.half_space([0, 0, 1], -1.5), lc.Geometry.ball(0.1)
    scene.insert(cloud, group=0, fixed=True)
    scene.insert(floor, group=0, fixed=True)
    moving = scene.insert(ball, group=1)
    scene.set_queries(0, 1, distance=10.0)
    for at in rng.uniform(-3, 3, (20, 3)):
        scene.set_pose(moving, (tuple(at), HERE))
        scene.step()
        by_hand = [np.linalg.norm(points - at, axis=1).min() - 0.15, at[2] + 1.5 - 0.1]
        # Depths are not enabled.
        by_hand = sorted(max(d, 0) for d in by_hand)
        assert sorted(scene.pairs()["distance"]) == pytest.approx(by_hand, abs=1e-9)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lc.Cloud([[0, 0, 0], [0, np.nan, 0]], radius=1), "point 1 is not finite"),
        (lambda: lc.Cloud(np.zeros((0, 3)), radius=1), "number of points is out of range: 0"),
        (lambda: lc.Cloud([[0, 0, 0]], radius=-1), "radius of point 0 is out of range: -1"),
        (lambda: lc.Cloud(np.zeros((3, 3)), radius=[1, 2, np.inf]), "radius of point 2"),
        (lambda: lc.Cloud(np.zeros((3, 3)), radius=[1, 2]), r"number of .* is 2 \(expected 3\)"),
        (lambda: lc.Cloud(np.zeros((3, 3)), radius=[[1, 2, 3]]), r"radius: shape is \(1, 3\) \(expected \(N,\)\)"),
        (lambda: lc.Cloud([[0, 0, 0]], box=(1, 0, 1)), "out of range"),
        (lambda: lc.Cloud([[0, 0, 0]], box=(1, 1)), r"box: shape is \(2,\)"),
        (lambda: lc.Cloud([[0, 0, 0]]), "exactly one of radius, box and shape"),
        (lambda: lc.Cloud([[0, 0, 0]], radius=1, box=(1, 1, 1)), "exactly one"),
        (lambda: lc.Cloud([[0, 0, 0]], shape=lc.Cloud([[0, 0, 0]], radius=1)), "the shape is a cloud"),
        (lambda: lc.Cloud([[0, 0]], radius=1), r"points: shape is \(1, 2\) \(expected \(N, 3\)\)"),
        (lambda: lc.Cloud([["a", "b", "c"]], radius=1), "points: dtype"),
        (lambda: lc.Cloud.from_cells([[0, 0, 70000]], size=1), "cell 0 is out of range: 70000"),
        (lambda: lc.Cloud.from_cells([[0, 0, 1.5]], size=1), "cells: dtype"),
        (lambda: lc.Cloud.from_cells([[0, 0, 1]], size=0), "out of range"),
        (lambda: lc.Cloud.from_mask(np.ones((2, 2, 2)), size=1), "occupied: dtype is float64"),
        (lambda: lc.Cloud.from_mask(np.ones((2, 2), bool), size=1), r"occupied: shape is \(2, 2\)"),
        (lambda: lc.Cloud.from_mask(np.zeros((2, 2, 2), bool), size=1), "number of points is out of range: 0"),
        (lambda: lc.Geometry.half_space([0, 0, 0]), "no direction"),
        (lambda: lc.Geometry.half_space([0, 0, 1], np.nan), "offset NaN"),
        (lambda: lc.Geometry.half_space([0, 0, 1]).rounded(0.1), "half-space cannot be rounded"),
        (lambda: lc.Geometry.from_heights([[0, 0], [0, np.nan]], spacing=(1, 1)), "height 3"),
        (lambda: lc.Geometry.from_heights([[0, 0], [0, -1]], spacing=(1, 1), base=-0.5), "height 3"),
        (lambda: lc.Geometry.from_heights([0, 0], spacing=(1, 1)), r"heights: shape is \(2,\)"),
        (lambda: lc.Geometry.from_heights([[0, 0], [0, 0]], spacing=(1, 0)), "spacing"),
        (lambda: lc.Cloud([[0, 0, 0]], radius=1).triangles, "cloud has no triangles"),
    ],
)
def test_refused_geometries(call, words):
    with pytest.raises(lc.GeometryError, match=words):
        call()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(([0, 0, 0], [0, 0, 0]), "direction"), (([0, 0, 0], [0, 0, 1], -1.0), "length -1 is negative or NaN")],
)
def test_refused_rays(arguments, words):
    with pytest.raises(lc.MotionError, match=words):
        lc.RayCaster().cast(lc.Geometry.ball(1), *arguments)
