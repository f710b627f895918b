"""Receipts of every kind hold for the checker in Python, which shares no code with the library."""

import importlib.util
from pathlib import Path

import pytest

import lin_canny as lc

URDF = """
<robot name="arm">
  <link name="base"/>
  <link name="bar"><collision><origin xyz="0.75 0 0"/><geometry><box size="1.5 0.1 0.1"/></geometry></collision></link>
  <joint name="swing" type="revolute">
    <parent link="base"/><child link="bar"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
</robot>
"""


def load_verify():
    spec = importlib.util.spec_from_file_location("verify", Path(__file__).parents[2] / "verify" / "verify.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


verify = load_verify()


def proven(text):
    return "\n".join(verify.verify(text.encode()))


@pytest.fixture
def checker(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(URDF)
    post = ("post", lc.Geometry.box(0.1, 0.1, 0.5), ((0, 1.2, 0), (0, 0, 0, 1)))
    return lc.Checker(lc.Robot.load(file), obstacles=[post])


def test_curves_and_splines(checker):
    curve = [[0.0], [0.5], [1.0]]
    assert "1 pair of bodies stays more than 0 apart" in proven(checker.receipt_curve(curve))
    assert "bar and post" in proven(checker.receipt_curve([[0.0], [1.0], [2.0]]))
    text = checker.receipt_spline([curve, [[1.0], [0.9], [0.5]]])
    assert "of each of 2 legs" in proven(text)
    with pytest.raises(lc.PlanError, match="does not start where"):
        checker.receipt_spline([curve, [[0.9], [0.5], [0.5]]])


def test_ranges(checker):
    answers = checker.prove_range([-1.0], [1.0])
    assert [answer.verdict for answer in answers] == ["never"]
    assert "at every configuration of [-1, 1]" in proven(checker.receipt_range(answers))
    with pytest.raises(lc.PlanError, match="no pair is proven"):
        checker.receipt_range(checker.prove_range())
    with pytest.raises(lc.PlanError, match="no pair is proven"):
        checker.receipt_range(checker.prove_range([-3.0], [1.0]), cells=1)


def test_pairs():
    tracker, die = lc.PairTracker(), lc.Geometry.box(0.5, 0.5, 0.5)
    apart = tracker.receipt(die, die, pose_b=((2, 0.3, 0.2), (0, 0, 0, 1)), names=("left", "right"))
    assert "left and right are at least 0.99999" in proven(apart)
    deep = proven(tracker.receipt(die, die, pose_b=((0.7, 0.3, 0.2), (0, 0, 0, 1))))
    assert "a and b share a point" in deep
    with pytest.raises(lc.PairError, match="a half-space proves no distance"):
        tracker.receipt(die, lc.Geometry.half_space([0, 0, 1], -5.0))


def test_casts():
    tracker, die = lc.PairTracker(), lc.Geometry.box(0.5, 0.5, 0.5)
    start = ((3, 0.1, 0.2), (0, 0, 0, 1))
    motion = {"pose_b": start, "velocity_b": ((-4, 0, 0), (0, 0, 1)), "tolerance": 1e-6}
    assert "a and b" in proven(tracker.cast_receipt(die, die, **motion, duration=1.0))
    miss = proven(tracker.cast_receipt(die, die, **motion, duration=0.1, names=("x", "y")))
    assert "x" in miss and "until t = 0.1" in miss
    with pytest.raises(lc.MotionError):
        tracker.cast_receipt(die, die, **motion, duration=-1.0)
    floor = lc.Geometry.half_space([0, 0, 1], -5.0)
    fall = {"velocity_b": ((0, 0, -1), (0, 0, 1)), "tolerance": 1e-6}
    above = tracker.cast_receipt(floor, die, **fall, duration=4.0, names=("floor", "die"))
    assert "1 pair of bodies stays more than 0 apart from t = 0 until t = 4" in proven(above)
    egg = lc.Geometry.ellipsoid(0.5, 0.4, 0.3)
    assert "until t = 0.1" in proven(tracker.cast_receipt(die, egg, **motion, duration=0.1))


def test_meshes():
    points = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4]]
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    tray = lc.Geometry.mesh(points, triangles)
    text = lc.PairTracker().cast_receipt(
        tray, lc.Geometry.box(0.2, 0.2, 0.2), pose_b=((0, 0, 0), (0, 0, 0, 1)), velocity_b=((0, 0, 0.3), (0, 0, 1)),
        duration=1.0, tolerance=1e-6, names=("tray", "die"),
    )  # fmt: skip
    said = proven(text)
    assert '"parts":[' in text and '"cut":[' in text
    assert "1 pair of bodies stays" in said and "inside" not in said
    text = lc.PairTracker().receipt(tray, lc.Geometry.box(0.2, 0.2, 0.2), names=("tray", "die"))
    said = proven(text)
    assert '"cells":[' in text and "tray and die are at least 0.7999" in said and "inside" not in said
