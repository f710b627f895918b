"""Views for notebooks and browsers, recordings, and plots."""

import base64
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lin_canny as lc

ONE = (0, 0, 0, 1)
BOX = lc.Geometry.box(1, 1, 1)
BALL = lc.Geometry.ball(0.5)
HERE = Path(__file__).parent
ARM = HERE.parents[1] / "robot" / "examples"

needs_arm = pytest.mark.skipif(not ARM.is_dir(), reason="robot/examples of the repository is not at hand")


def arm():
    return lc.Checker(lc.Robot.load(ARM / "gripper.urdf", ARM / "gripper.srdf"), cell=ARM / "cell.json")


def data_of(page):
    """Return what the script of a page draws."""
    (text,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


def points_of(data, body, what):
    """Return the vertices of the triangles or edges of a body, in its frame."""
    solid = data["solids"][data["bodies"][body]["solid"]]
    unit = (solid["radius"] or 1) * data["radius"]
    return np.frombuffer(base64.b64decode(solid[what]), "<f4").reshape(-1, 3) * unit


def in_the_world(data, point):
    return np.array(point) * data["radius"] + data["center"]


def ends_of(data, frame):
    return in_the_world(data, frame["pairs"][0]["answer"]["points"])


def all_kinds():
    yield BOX
    yield BALL
    yield lc.Geometry.capsule(half_length=1, radius=0.2)
    yield lc.Geometry.cylinder(half_height=1, radius=0.2)
    yield lc.Geometry.cone(half_height=1, radius=0.2)
    yield lc.Geometry.ellipsoid(1, 2, 3)
    yield BOX.rounded(0.1)
    yield lc.Geometry.pieces([BOX, (BALL, ((2, 0, 0), ONE))])
    yield lc.Geometry.mesh(BOX.vertices, BOX.triangles)
    yield lc.Geometry.half_space([0, 0, 1])
    yield lc.Geometry.surface([[[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1]]]])
    yield lc.Cloud(np.eye(3), radius=0.1)


@pytest.mark.parametrize("geometry", list(all_kinds()), ids=repr)
def test_a_view_of_every_kind(geometry):
    page = geometry.show().html()
    # Nothing is loaded from elsewhere.
    assert not re.search(r"(src|href)=|https?:|import |fetch\(", page)
    data = data_of(page)
    (frame,) = data["frames"]
    triangles = points_of(data, 0, "triangles")
    assert len(triangles) % 3 == 0 and len(triangles) > 0 and np.isfinite(triangles).all()
    assert len(points_of(data, 0, "edges")) % 2 == 0
    if geometry.kind != "half-space":
        middle, radius = geometry.bounding_ball
        assert np.linalg.norm(triangles - middle, axis=1).max() <= radius * (1 + 1e-6)
        assert np.allclose(in_the_world(data, frame["poses"][0][1][:3]), 0, atol=1e-9)


def test_points_and_segments_are_drawn_by_edges():
    for geometry in (lc.Geometry.segment([0, 0, 0], [1, 0, 0]), lc.Geometry.point([1, 2, 3])):
        data = data_of(geometry.show().html())
        assert len(points_of(data, 0, "triangles")) == 0 and len(points_of(data, 0, "edges")) == 2


def test_a_view_of_a_pair():
    pose = ((3, 0, 0), ONE)
    view = lc.PairTracker().show(BOX, BALL, None, pose)
    data = data_of(view.html())
    (frame,) = data["frames"]
    assert repr(view) == "<View: 2 bodies>" and frame["note"].startswith("Closest separated: 1.500000 in [")
    assert np.allclose(ends_of(data, frame), [[1, 0, 0], [2.5, 0, 0]], atol=1e-9)
    assert np.allclose(in_the_world(data, frame["poses"][1][1][:3]), [3, 0, 0])
    same = lc.show(BOX, (BALL, pose), closest=lc.PairTracker().closest(BOX, BALL, None, pose))
    assert same.html() == view.html()
    # Points of bodies that are not the first two, and of one body.
    far = (BOX, ((0, 9, 0), ONE))
    closest = lc.PairTracker().closest(BOX, BALL, None, pose)
    (frame,) = data_of(lc.show(far, (BALL, pose), BOX, closest=closest).html())["frames"]
    assert frame["pairs"][0]["bodies"] == [2, 1] and not frame["paths"]
    data = data_of(lc.show(far, closest=closest).html())
    (frame,) = data["frames"]
    assert not frame["pairs"] and np.allclose(in_the_world(data, frame["paths"][0]), [[1, 0, 0], [2.5, 0, 0]])


def test_a_notebook_shows_pages_of_moderate_size(tmp_path):
    assert BOX._repr_html_().startswith("<iframe srcdoc=") and lc.show(BOX)._repr_html_() == BOX._repr_html_()
    fine = lc.Geometry.from_heights(np.zeros((230, 230)), spacing=(1, 1))
    assert len(fine.triangles) > 100_000 and fine._repr_html_() is None
    fine.show().save(tmp_path / "fine.html")
    assert (tmp_path / "fine.html").stat().st_size > 3_000_000


def test_a_page_opens_in_a_browser(monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    path = Path(BOX.show().open())
    assert opened == [path.as_uri()] and data_of(path.read_text())["bodies"]
    path.unlink()


def test_a_browser_draws_a_page(tmp_path):
    image = pytest.importorskip("matplotlib.image", reason="matplotlib is not installed")
    names = ("chromium", "chromium-browser", "google-chrome")
    browser = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    if browser is None:
        pytest.skip("no Chromium")
    lc.PairTracker().show(BOX, BALL, None, ((3, 0, 0), ONE)).save(tmp_path / "pair.html")
    command = [browser, "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    command += ["--window-size=600,400", "--virtual-time-budget=3000", f"--screenshot={tmp_path / 'pair.png'}"]
    command += [f"--user-data-dir={tmp_path / 'profile'}", (tmp_path / "pair.html").as_uri()]
    subprocess.run(command, capture_output=True, check=False, timeout=120)
    r, g, b = image.imread(tmp_path / "pair.png")[..., :3].transpose(2, 0, 1)
    blue, orange, pink = (b > r + 0.2), (r > b + 0.15) & (g > 0.3), (r > 0.85) & (g < 0.47) & (b > 0.55)
    assert blue.sum() > 3000 and orange.sum() > 500 and 50 < pink.sum() < 5000


def test_names_cannot_end_the_script():
    page = lc._show.View(
        [lc._show._Shown("</script><b>", BOX, (0, 0, 0))], [lc._show._Frame(np.eye(4)[None], "<")]
    )
    assert "</script><b>" not in page.html() and data_of(page.html())["bodies"][0]["name"] == "</script><b>"


def test_refused_views():
    with pytest.raises(lc.LinCannyError, match=r"body 1 is a int \(expected a Geometry, or a tuple"):
        lc.show(BOX, 3)
    with pytest.raises(lc.LinCannyError, match="there is no body to show"):
        lc.show()


@needs_arm
def test_a_view_of_a_checker():
    checker = arm()
    data = data_of(checker.show().html())
    (frame,) = data["frames"]
    assert [body["name"] for body in data["bodies"]] == checker.bodies and frame["note"].startswith("NearPair")
    q = np.clip(0.0, *checker.limits.T)
    near = checker.clearance(q)
    assert np.allclose(ends_of(data, frame), [near.point_a, near.point_b], atol=1e-9)
    for (k, pose), id in zip(frame["poses"], checker.ids):
        assert np.allclose(in_the_world(data, pose[:3]), checker.pose(id, q)[:3, 3])
    lit = [id for id, body in zip(checker.ids, data["bodies"]) if body["color"] == list(lc._show._LIT)]
    assert set(lit) == set(near.ids)
    motion = checker.show(np.linspace(q, checker.limits.mean(axis=1), 5))
    assert repr(motion).endswith("5 frames>") and len(data_of(motion.html())["frames"]) == 5
    assert checker._repr_html_().startswith("<iframe")
    with pytest.raises(lc.PlanError):
        checker.show([0.0])
    with pytest.raises(lc.LinCannyError, match="there is no configuration to show"):
        checker.show(np.zeros((0, checker.dof)))


@needs_arm
def test_geometries_of_a_checker():
    checker = arm()
    for name, id in zip(checker.bodies, checker.ids):
        assert isinstance(checker.geometry(id), lc.Geometry), name
    with pytest.raises(lc.PlanError, match="obstacle"):
        checker.geometry(lc.BodyId("obstacle", 999))


def lines_of(path):
    return [json.loads(line) for line in Path(path).read_text().splitlines()]


def test_recordings_of_bodies(tmp_path):
    path = tmp_path / "pair.jsonl"
    tracker = lc.PairTracker()
    mesh = lc.Geometry.mesh(BOX.vertices, BOX.triangles)
    with lc.Recorder(path, "a pair") as recorder:
        a, b, c = recorder.body("box", BOX), recorder.body("ball", BALL, ((9, 0, 0), ONE)), recorder.body("mesh", mesh)
        assert (a, b, c) == (0, 1, 2)
        for x in (3.0, 2.0):
            pose = ((x, 0, 0), ONE)
            recorder.pose(b, pose)
            recorder.closest(a, b, tracker.closest(BOX, BALL, None, pose))
            recorder.path([[0, 0, 0], [x, 0, 0]])
            recorder.vertices(c, mesh.vertices * x)
            recorder.note(f"x = {x}")
            recorder.end_frame()
        recorder.remove(c)
        recorder.end_frame()
        assert repr(recorder) == f"<Recorder {path}>"
    assert repr(recorder).endswith(", closed>")
    lines = lines_of(path)
    assert lines[0]["title"] == "a pair" and sum("geometry" in line for line in lines) == 3
    frames = [line["frame"] for line in lines if "frame" in line]
    assert [frame.get("note", "") for frame in frames] == ["x = 3.0", "x = 2.0", ""]
    assert frames[1]["pairs"][0]["outcome"]["distance"] == 0.5 and frames[2]["removed"] == [2]
    recorder.close()
    with pytest.raises(lc.LinCannyError, match="is closed"):
        recorder.end_frame()


def test_recordings_of_scenes(tmp_path):
    scene = lc.Scene()
    scene.set_queries(0, 0, distance=np.inf)
    scene.insert(BOX, fixed=True)
    ball = scene.insert(BALL, ((5, 0, 0), ONE))
    with lc.Recorder(tmp_path / "scene.jsonl") as recorder:
        for x in (4, 3, 2):
            scene.set_pose(ball, ((x, 0, 0), ONE))
            scene.step()
            recorder.scene(scene)
    frames = [line["frame"] for line in lines_of(tmp_path / "scene.jsonl") if "frame" in line]
    assert [frame["poses"][0][1][0] for frame in frames[1:]] == [3, 2] and len(frames[0]["boxes"]) == 2


def test_refused_recordings(tmp_path):
    with pytest.raises(lc.FileError, match="no/such"):
        lc.Recorder(tmp_path / "no/such/file.jsonl")
    with lc.Recorder(tmp_path / "x.jsonl") as recorder:
        recorder.body("box", BOX)
        with pytest.raises(lc.LinCannyError, match="body 7 does not exist: 1 bodies were recorded"):
            recorder.pose(7, None)
        with pytest.raises(lc.LinCannyError, match="body 0 is not a mesh"):
            recorder.vertices(0, [[0, 0, 0]])
        with pytest.raises(lc.PoseError):
            recorder.pose(0, np.zeros((4, 4)))


@needs_arm
def test_recordings_of_checkers(tmp_path):
    checker, path = arm(), tmp_path / "arm.jsonl"
    q = np.linspace(np.clip(0.0, *checker.limits.T), checker.limits.mean(axis=1), 4)
    checker.record(path, q)
    lines = lines_of(path)
    frames = [line["frame"] for line in lines if "frame" in line]
    assert [line["body"]["name"] for line in lines if "body" in line] == checker.bodies and len(frames) == 4
    for row, frame in zip(q, frames):
        assert frame["pairs"][0]["outcome"]["distance"] == pytest.approx(checker.clearance(row).distance, abs=1e-12)
    with pytest.raises(lc.PlanError, match=r"times: shape is \(1,\) \(expected \(4,\), one for each"):
        checker.record(path, q, times=[0])
    with pytest.raises(lc.PlanError, match="there are none to record"):
        checker.record(path, np.zeros((0, checker.dof)))
    with pytest.raises(lc.FileError):
        checker.record(tmp_path / "no/such/file.jsonl", q)
    with pytest.raises(lc.PlanError, match="configuration 1: "):
        checker.record(path, [q[0], q[0] + np.nan])


@needs_arm
def test_recordings_among_moving_obstacles(tmp_path):
    checker = arm()
    poses = [((5, 0, 0), ONE), ((6, 0, 0), ONE)]
    checker.add_moving_obstacle("cart", BOX, [0, 2], np.array([[*p, *r] for p, r in poses]))
    q = np.tile(np.clip(0.0, *checker.limits.T), (3, 1))
    checker.record(tmp_path / "cart.jsonl", q, times=[0, 1, 2])
    frames = [line["frame"] for line in lines_of(tmp_path / "cart.jsonl") if "frame" in line]
    cart = checker.bodies.index("cart")
    moved = [dict(frame.get("poses", []))[cart][0] for frame in frames[1:]]
    assert moved == [5.5, 6] and checker.time == 2
    assert frames[1]["note"].startswith("time 1: ")


@needs_arm
def test_a_plot_of_clearance():
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("Agg")
    checker = arm()
    motion = lc.Trajectory.load(ARM / "carry.csv", checker)
    axes = lc.plot_clearance(checker, motion, samples=101)
    bars = [line for line in axes.lines if line.get_linewidth() == 2]
    curves = [line for line in axes.lines if line.get_linewidth() != 2]
    assert len(bars) == len(motion) - 1 and len(curves) >= 2
    # The proven bound is below every sample of its segment.
    for bar in bars:
        (start, end), (lower, _) = bar.get_data()
        for curve in curves:
            times, distance = curve.get_data()
            assert np.nanmin(distance[(start <= times) & (times <= end)], initial=np.inf) >= lower - 1e-12
    names = {f"{a} - {b}" for a in checker.bodies for b in checker.bodies}
    assert {curve.get_label() for curve in curves} <= names
    again = lc.plot_clearance(checker, motion.positions, samples=11, axes=axes)
    assert again is axes
    # Columns in another order, and an obstacle that moves: the bars are below the lines.
    order = [*range(1, checker.dof), 0]
    names = [checker.coordinates[k] for k in order]
    motion = lc.Trajectory(motion.times, motion.positions[:, order], names=names)
    ends = [[1, -2, 0.3, 0, 0, 0, 1], [1, 2, 0.3, 0, 0, 0, 1]]
    checker.add_moving_obstacle("cart", lc.Geometry.box(0.1, 0.1, 0.1), [-1, 99], ends)
    for time in (None, 50):
        if time is not None:
            checker.time = time
        axes = lc.plot_clearance(checker, motion, samples=101)
        bars = [line.get_data() for line in axes.lines if line.get_linewidth() == 2]
        for curve in (line for line in axes.lines if line.get_linewidth() != 2):
            times, distance = curve.get_data()
            for (start, end), (lower, _) in bars:
                assert np.nanmin(distance[(start <= times) & (times <= end)], initial=np.inf) >= lower - 1e-12
        assert checker.time == time
    with pytest.raises(lc.LinCannyError, match=r"motion: shape is \(7,\) \(expected a Trajectory, or \(K, dof\)"):
        lc.plot_clearance(checker, motion.positions[0])
    matplotlib.pyplot.close("all")


@needs_arm
def test_the_notebook_runs(tmp_path):
    pytest.importorskip("nbconvert", reason="nbconvert is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    notebook = HERE.parent / "examples" / "tour.ipynb"
    command = [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", str(notebook)]
    command += ["--output-dir", str(tmp_path), "--output", "tour.ipynb", "--ExecutePreprocessor.timeout=300"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    cells = json.loads((tmp_path / "tour.ipynb").read_text())["cells"]
    shown = [output["data"] for cell in cells for output in cell.get("outputs", []) if "data" in output]
    assert sum("text/html" in data for data in shown) >= 3 and any("image/png" in data for data in shown)
    # The notebook of the repository has no outputs.
    assert all(not cell.get("outputs") for cell in json.loads(notebook.read_text())["cells"])


def test_the_version():
    assert re.fullmatch(r"\d+\.\d+\.\d+", lc.__version__)
    metadata = pytest.importorskip("importlib.metadata")
    assert metadata.version("lin-canny") == lc.__version__
