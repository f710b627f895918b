import math
import pickle

import numpy as np
import pytest

import lin_canny as lc

XYZ = "0 0 0\n1 0.5 -2\nnan 0 0\n3 1 1\n"
PLY = """ply
format binary_little_endian 1.0
element vertex 3
property float x
property float y
property float z
property float radius
property uchar red
end_header
"""
VERTICES = np.array(
    [((0, 0, 0), 0.5, 1), ((1, 0.1, 0), 0.25, 2), ((math.nan, 0, 0), 1, 3)],
    [("at", "<f4", 3), ("radius", "<f4"), ("red", "u1")],
).tobytes()


def test_points_without_a_return_are_dropped_and_counted(tmp_path):
    (tmp_path / "scan.xyz").write_text(XYZ)
    file = lc.read_points(tmp_path / "scan.xyz")
    assert file.format == "xyz" and file.dropped == 1 and len(file) == 3 and file.radii is None
    assert file.points.tolist() == [[0, 0, 0], [1, 0.5, -2], [3, 1, 1]] and file.points.dtype == np.float64
    assert "3 points, 1 dropped" in repr(file)
    with pytest.raises(lc.FileError, match=r"scan.xyz"):
        lc.read_points(tmp_path / "scan.xyz", invalid="refuse")


def test_radii_and_single_precision_of_a_file(tmp_path):
    (tmp_path / "scan.ply").write_bytes(PLY.encode() + VERTICES)
    file = lc.read_points(tmp_path / "scan.ply")
    assert file.points.dtype == np.float32 and file.dropped == 1 and file.radii.tolist() == [0.5, 0.25]
    assert np.array_equal(file.points, np.array([[0, 0, 0], [1, 0.1, 0]], np.float32)) and file.skipped
    cloud = lc.Cloud(file.points, radius=file.radii)
    ball = lc.Geometry.ball(0.5)
    assert lc.PairTracker().distance(cloud, ball, None, ((0, 0, 3), (0, 0, 0, 1))) == pytest.approx(2)
    other = pickle.loads(pickle.dumps(file))
    assert np.array_equal(other.points, file.points) and other.dropped == 1


def test_an_array_of_numpy(tmp_path):
    points = np.random.default_rng(1).normal(size=(4, 5, 3))
    points[2, 3] = np.inf
    np.save(tmp_path / "scan.npy", points)
    file = lc.read_points(str(tmp_path / "scan.npy"))
    assert (file.format, file.dropped) == ("npy", 1)
    assert np.array_equal(file.points, np.delete(points.reshape(-1, 3), 13, axis=0))


@pytest.mark.parametrize(
    ("name", "text", "error", "words"),
    [
        ("a.xyz", "0 0\n", lc.FileError, "a.xyz, line 1"),
        ("a.xyz", "nan nan nan\n", lc.FileError, "a.xyz"),
        ("a.ply", PLY, lc.FileError, "a.ply"),
        ("missing.xyz", None, lc.FileError, "missing.xyz"),
    ],
)
def test_refused_files(tmp_path, name, text, error, words):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(error, match=words):
        lc.read_points(tmp_path / name)


def test_a_wrong_policy_is_named(tmp_path):
    with pytest.raises(lc.LinCannyError, match='"keep"'):
        lc.read_points(tmp_path / "x.xyz", invalid="keep")
