import pickle

import numpy as np
import pytest

import lin_canny as lc

OBJ = """# Two tetrahedra.
vn 0 0 1
o first
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
usemtl red
o second
v 3 0 0
v 4 0 0
v 3 1 0
v 3 0 1
f 5 7 6
f 5 6 8
f 6 7 8
f 7 5 8
"""


@pytest.fixture
def path(tmp_path):
    (tmp_path / "two.obj").write_text(OBJ)
    return tmp_path / "two.obj"


def test_a_file_is_points_triangles_and_what_was_skipped(path):
    file = lc.load_mesh(path)
    assert (file.points.shape, file.points.dtype) == ((8, 3), np.float64)
    assert (file.triangles.shape, file.triangles.dtype) == ((8, 3), np.int64)
    assert [name for name, _, _ in file.objects] == ["first", "second"]
    for first, (_, points, triangles) in enumerate(file.objects):
        assert np.array_equal(points, file.points[4 * first :][:4])
        assert np.array_equal(triangles + 4 * first, file.triangles[4 * first :][:4])
    assert file.skipped == [(2, "vn"), (12, "usemtl")]
    assert "2 objects, 8 points, 8 triangles" in repr(file)
    again = pickle.loads(pickle.dumps(file))
    assert np.array_equal(again.points, file.points) and again.skipped == file.skipped


def test_a_file_is_a_geometry_in_one_line(path):
    ball = lc.Geometry.ball(0.25)
    at = ((2, 0, 0), (0, 0, 0, 1))
    expected = {"hull": "overlapping", "mesh": "separated", "pieces": "separated"}
    for kind, state in expected.items():
        found = lc.PairTracker().closest(lc.load_mesh(path).geometry(kind), ball, None, at)
        assert found.state == state, kind
    assert lc.load_mesh(path).geometry("mesh").is_solid
    with pytest.raises(lc.LinCannyError, match=r'kind is "box" \(expected "hull", "mesh", "solid" or "pieces"\)'):
        lc.load_mesh(path).geometry("box")


def test_errors_name_file_and_line(path):
    path.write_text(OBJ.replace("f 2 3 4", "f 2 3 9"))
    with pytest.raises(lc.FileError, match=r"two.obj, line 10: vertex of a face does not exist: 9"):
        lc.load_mesh(path)
    with pytest.raises(lc.FileError, match=r"no.stl: cannot be read"):
        lc.load_mesh(path.with_name("no.stl"))
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(lc.GeometryError, match=r"two.obj: "):
        lc.load_mesh(path).geometry()
