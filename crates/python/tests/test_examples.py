import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import lin_canny as lc

HERE = Path(__file__).parent
EXAMPLES = HERE.parent / "examples"
ARM = HERE.parents[1] / "robot" / "examples"

needs_arm = pytest.mark.skipif(not ARM.is_dir(), reason="robot/examples of the repository is not at hand")


def run(script, *arguments, folder):
    command = [sys.executable, EXAMPLES / script, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_distances_of_two_files(tmp_path):
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    trimesh.creation.box((2, 2, 2)).export(tmp_path / "cube.stl")
    trimesh.creation.icosphere(radius=1.0).export(tmp_path / "ball.stl")
    for kind in ("hull", "mesh"):
        told = run("distances.py", "cube.stl", "ball.stl", "--at", 0, 0, 3, "--kind", kind, folder=tmp_path)
        # The highest vertex of the ball is on the axis.
        assert "separated: 1 in [" in told or float(re.search("separated: ([^ ]*) in", told)[1]) == pytest.approx(1)
    told = run("distances.py", "cube.stl", "ball.stl", "--at", 0, 0, 1.75, folder=tmp_path)
    low, high = map(float, re.search(r"depth in \[(.*), (.*)\];", told).groups())
    assert low <= 0.25 + 1e-6 and 0.25 - 1e-6 <= high < 0.2501


@needs_arm
def test_study_of_an_arm(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    files = ["gripper.urdf", "--srdf", "gripper.srdf", "--cell", "cell.json", "--out", tmp_path / "x.png"]
    told = run("study.py", *files, "--count", 2000, "--threads", 2, folder=ARM)
    assert re.search(r"2000 configurations, [1-9][0-9.]*% in contact", told) and (tmp_path / "x.png").is_file()


@needs_arm
def test_a_timed_trajectory(tmp_path):
    files = ["gripper.urdf", "carry.csv", "--srdf", "gripper.srdf", "--cell", "cell.json", "--out", tmp_path / "x.png"]
    for options in ([], ["--rest"], ["--cell-only"]):
        told = run("trajectory.py", *files, *options, folder=ARM)
        assert "4 points, times 0 to 3>: free" in told
        assert float(re.search("tracking error of ([^ ]*) rad", told)[1]) > 0.01
        assert "no picture: matplotlib" in told or (tmp_path / "x.png").is_file()


def test_a_slice_of_signed_distances(tmp_path):
    told = run("slice.py", "--count", 60, "--threads", 2, folder=tmp_path)
    assert "3600 points, 9." in told
    assert "no picture: matplotlib" in told or (tmp_path / "slice.png").is_file()


def test_a_picture_is_left_out_without_matplotlib(tmp_path):
    (tmp_path / "matplotlib.py").write_text("raise ImportError('no matplotlib here')")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); sys.argv = ['slice.py', '--count', '9']; import runpy; "
    code += f"runpy.run_path({str(EXAMPLES / 'slice.py')!r}, run_name='__main__')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0 and "no picture: matplotlib is not installed" in done.stdout, done.stderr


@needs_arm
def test_the_same_study_on_ray(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    pytest.importorskip("ray.data", reason="ray[data] is not installed")
    files = ["gripper.urdf", "--srdf", "gripper.srdf", "--cell", "cell.json", "--out", tmp_path / "x.png"]
    on_ray = run("study_ray.py", *files, "--count", 3000, folder=ARM)
    here = run("study.py", *files, "--count", 3000, folder=ARM)
    # Which of two fingers is nearer may depend on the last bits, and those of depths on the order.
    share = here.splitlines()[0]
    assert share.startswith("3000 configurations") and share in on_ray


@needs_arm
def test_an_arm_of_the_repository():
    robot = lc.Robot.load(ARM / "gripper.urdf", ARM / "gripper.srdf")
    checker = lc.Checker(robot, cell=ARM / "cell.json")
    q = np.random.default_rng(0).uniform(*robot.limits.T, (3000, robot.dof))
    found, free = checker.clearances(q, threads=2), checker.are_free(q)
    assert robot.dof == 7 and np.array_equal(free, found["distance"] > 0)
    assert np.all(found["lower"] <= found["distance"]) and np.all(found["distance"] <= found["upper"])
    assert "left finger" in {checker.bodies[k] for k in found["a"]}
    # Where the robot alone is deeper than any pair with the cell, the answers agree.
    alone = robot.clearances(q)
    assert np.all(found["distance"] <= alone["upper"] + 1e-12)
