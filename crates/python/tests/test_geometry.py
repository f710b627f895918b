import math
import pickle

import numpy as np
import pytest

import lin_canny as lc

SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
HIGH = ((0, 0, 5), (0, 0, 0, 1))


def dome(weights=None):
    points = [[[x, y, -abs(x) - abs(y)] for y in (-1, 0, 1)] for x in (-1, 0, 1)]
    return lc.Geometry.surface([points], weights)


def every_kind():
    cube = lc.Geometry.box(1, 1, 1)
    return {
        "hull": lc.Geometry.hull(np.vstack([SQUARE, [[0, 0, 1]]])),
        "polygon": lc.Geometry.polygon(SQUARE),
        "segment": lc.Geometry.segment([0, 0, -1], [0, 0, 1]),
        "point": lc.Geometry.point([0, 0, 0]),
        "box": cube,
        "ball": lc.Geometry.ball(1),
        "capsule": lc.Geometry.capsule(half_length=1, radius=0.5),
        "cylinder": lc.Geometry.cylinder(half_height=1, radius=0.5),
        "cone": lc.Geometry.cone(half_height=1, radius=0.5),
        "ellipsoid": lc.Geometry.ellipsoid(1, 2, 1),
        "rounded": cube.rounded(0.25),
        "pieces": lc.Geometry.pieces([cube, (lc.Geometry.ball(0.5), ((0, 0, 1), (0, 0, 0, 1)))]),
        "mesh": lc.Geometry.mesh(cube.vertices, cube.triangles),
        "sheet": lc.Geometry.mesh(SQUARE, [[0, 1, 2], [0, 2, 3]]),
        "surface": dome(),
    }


# The highest point of each geometry, by hand; the dome is 2 x 2 quadratic, its middle is -1/2 - 1/2.
TOPS = {
    "hull": 1, "polygon": 0, "segment": 1, "point": 0, "box": 1, "ball": 1, "capsule": 1.5, "cylinder": 1,
    "cone": 1, "ellipsoid": 1, "rounded": 1.25, "pieces": 1.5, "mesh": 1, "sheet": 0, "surface": -1,
}  # fmt: skip


@pytest.mark.parametrize("name", TOPS)
def test_the_distance_to_a_ball_above_is_exact(name):
    found = lc.PairTracker().closest(every_kind()[name], lc.Geometry.ball(0.5), None, HIGH)
    assert found.lower <= 4.5 - TOPS[name] <= found.upper
    assert found.distance == pytest.approx(4.5 - TOPS[name], abs=1e-8)
    assert found.normal @ [0, 0, 1] == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("name", TOPS)
def test_pickled_geometry_gives_the_same_bits(name):
    before = every_kind()[name]
    after = pickle.loads(pickle.dumps(before))
    assert repr(after) == repr(before)
    ball = lc.Geometry.ball(0.5)
    distances = [lc.PairTracker().distance(g, ball, None, HIGH) for g in (before, after)]
    assert distances[0] == distances[1]


def test_reprs_and_properties():
    kinds = every_kind()
    assert repr(kinds["box"]) == "<Geometry hull: 8 vertices, 6 faces>"
    assert repr(kinds["mesh"]) == "<Geometry solid mesh: 8 vertices, 12 triangles>"
    assert repr(kinds["pieces"]) == "<Geometry compound: 2 pieces>"
    assert kinds["ellipsoid"].kind == "curved shape"
    assert kinds["box"].is_convex and not kinds["mesh"].is_convex
    assert kinds["mesh"].is_solid and not kinds["sheet"].is_solid and not kinds["surface"].is_solid
    centre, radius = kinds["box"].bounding_ball
    assert np.allclose(centre, 0) and math.sqrt(3) <= radius < 1.8


def test_triangles_face_outwards():
    cube = every_kind()["box"]
    assert cube.vertices.shape == (8, 3) and cube.triangles.shape == (12, 3)
    a, b, c = cube.vertices[cube.triangles].transpose(1, 0, 2)
    assert np.einsum("ij,ij", a, np.cross(b, c)) / 6 == pytest.approx(8)
    with pytest.raises(lc.GeometryError, match="curved shape has no triangles"):
        _ = every_kind()["cone"].vertices


def test_nurbs_and_weights():
    # A quarter of a cylinder of radius 1 about y: rational in u, straight in v.
    arc = np.array([[1, 0, 0], [1, 0, 1], [0, 0, 1]], float)
    points = np.stack([arc + [0, y, 0] for y in (-1, 1)], axis=1)
    weights = np.array([[1, 1], [math.sqrt(0.5)] * 2, [1, 1]])
    ball, at = lc.Geometry.ball(0.25), ((2, 0, 2), (0, 0, 0, 1))
    nurbs = lc.Geometry.nurbs((2, 1), [0, 0, 0, 1, 1, 1], [0, 0, 1, 1], points, weights)
    for quarter in (nurbs, lc.Geometry.surface([points], [weights])):
        distance = lc.PairTracker().distance(quarter, ball, None, at)
        assert distance == pytest.approx(math.sqrt(8) - 1.25, abs=1e-8)


class Meshed:
    """An object like a mesh of trimesh."""

    vertices = SQUARE


class Scene:
    """An object like a scene of trimesh."""

    def to_mesh(self):
        return Meshed()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lc.Geometry.hull(np.zeros((5, 4))), r"points: shape is \(5, 4\) \(expected \(N, 3\)\)"),
        (lambda: lc.Geometry.hull([0, 0, 0]), r"shape is \(3,\)"),
        (lambda: lc.Geometry.hull(Meshed()), r"points: dtype is object \(expected float64\); pass its `vertices`$"),
        (lambda: lc.Geometry.from_trimesh(Scene()), r"a Scene has no `vertices` and `faces` .*; pass its `to_mesh\(\)`$"),
        (lambda: lc.Geometry.from_trimesh([1]), r"a list has no .* \(expected a trimesh.Trimesh\)$"),
        (lambda: lc.Geometry.hull([["a", "b", "c"]]), "dtype is <U1"),
        (lambda: lc.Geometry.hull(np.ones((4, 3), complex)), "complex128"),
        (lambda: lc.Geometry.hull([[0, 0, 0], [0, math.nan, 0]]), "point 1"),
        (lambda: lc.Geometry.mesh(np.eye(3), [[0, 1, 9]]), "9"),
        (lambda: lc.Geometry.mesh(np.eye(3), [[0, 1, -1]]), "triangle 0 uses a point that does not exist: -1"),
        (lambda: lc.Geometry.mesh(np.eye(3), [[0.5, 1, 2]]), r"float64 \(expected int64\)"),
        (lambda: lc.Geometry.ball(-1), r"radius of the shape is out of range: -1\.0$"),
        (lambda: lc.Geometry.pieces([every_kind()["sheet"]]), "piece 0 is a mesh"),
        (lambda: every_kind()["mesh"].rounded(0.1), r"mesh cannot be rounded \(expected a convex geometry\); round its pieces, or query `within`"),
        (lambda: lc.Geometry.surface([np.zeros((2, 2))]), r"\(M, N, 3\)"),
        (lambda: lc.Geometry._from_bytes(b"\x09"), "."),
    ],
)
def test_refused_geometries(call, words):
    with pytest.raises(lc.GeometryError, match=words) as caught:
        call()
    assert isinstance(caught.value, ValueError)


def test_turned_triangles_are_turned_back():
    cube = lc.Geometry.box(1, 1, 1)
    triangles = np.array(cube.triangles)
    triangles[[3, 7]] = triangles[[3, 7]][:, ::-1]
    assert not lc.Geometry.mesh(cube.vertices, triangles).is_solid
    solid = lc.Geometry.repaired_mesh(cube.vertices, triangles, caps=False)
    repair = solid.repair_report
    assert solid.is_solid
    assert (repair.turned, repair.caps) == ([3, 7], [])
    assert not lc.Geometry.repaired_mesh(cube.vertices, triangles[1:], caps=False).is_solid
    assert cube.repair_report is None


def test_a_mesh_with_a_hole_has_an_inside_after_its_repair():
    cube = lc.Geometry.box(1, 1, 1)
    triangles = np.array(cube.triangles)[1:]
    points = [(0, 0, 0), (2, 0, 0), (1, 0.5, 0.25)]
    open_mesh = lc.Geometry.mesh(cube.vertices, triangles)
    assert lc.contains(open_mesh, points[:2]).tolist() == [False, False]
    with pytest.raises(lc.GeometryError, match="this mesh has no winding number"):
        lc.winding_number(open_mesh, points)
    solid = lc.Geometry.repaired_mesh(cube.vertices, triangles)
    repair = solid.repair_report
    assert solid.is_solid and len(repair.caps) == 1 and len(repair.caps[0]) == 3
    assert repr(repair) == "<MeshRepair: 1 cap (8.33 % of the area, at most 3 corners)>"
    winding = lc.winding_number(solid, points, threads=2)
    assert winding.dtype == np.int32
    assert winding.tolist() == [1, 0, np.iinfo(np.int32).min]
    soup = np.asarray(cube.vertices)[triangles].reshape(-1, 3)
    jittered = soup + np.random.default_rng(3).uniform(-1e-4, 1e-4, soup.shape)
    solid = lc.Geometry.repaired_mesh(jittered, np.arange(33).reshape(-1, 3), weld=1e-3)
    assert solid.repair_report.welded == 33 - 8 and lc.winding_number(solid, points[:2]).tolist() == [1, 0]
    with pytest.raises(lc.GeometryError, match="tolerance of the weld is out of range"):
        lc.Geometry.repaired_mesh(soup, np.arange(33).reshape(-1, 3), weld=-1.0)


def test_lengths_of_capsules_are_named():
    with pytest.raises(TypeError):
        lc.Geometry.capsule(1, 0.5)


@pytest.mark.parametrize("dtype", [np.float32, np.int16, np.uint8])
def test_points_of_any_real_dtype_and_strides(dtype):
    points = np.zeros((8, 6), dtype, order="F")
    points[:, ::2] = [[x, y, z] for x in (0, 2) for y in (0, 2) for z in (0, 2)]
    hull = lc.Geometry.hull(points[:, ::2])
    assert lc.PairTracker().distance(hull, lc.Geometry.ball(1), None, ((5, 1, 1), (0, 0, 0, 1))) == 2
