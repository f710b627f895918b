"""The lines of the README and its chapters run as in a notebook; what they print and return is recorded in readme.txt.

LIN_CANNY_RECORD=1 records it again."""

import ast
import os
import re
from pathlib import Path

import numpy as np
import pytest

import lin_canny as lc

HERE = Path(__file__).parent
README = HERE.parent / "README.md"
PAGES = [README, *sorted((HERE.parent / "docs").glob("*.md"))]
ARM = HERE.parents[1] / "robot" / "examples"

URDF = """<robot name="two joints"><link name="rail"/>
<link name="shoulder"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="gripper"><collision><origin xyz="0.6 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="rail"/><child link="shoulder"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="2"/></joint>
<joint name="lift" type="prismatic"><parent link="shoulder"/><child link="gripper"/><axis xyz="0 0 1"/>
<limit lower="0" upper="1" effort="1" velocity="1"/></joint>
<link name="left finger"/><joint name="left" type="fixed"><parent link="gripper"/><child link="left finger"/></joint>
<link name="right finger"/><joint name="right" type="fixed"><parent link="gripper"/><child link="right finger"/></joint>
</robot>"""
CELL = """{"bodies": [{"name": "post", "cylinder": {"radius": 0.1, "length": 1}, "xyz": [0.7, 0, 0.5]},
{"name": "tray", "box": {"size": [0.2, 0.2, 0.02]}, "xyz": [0, 0.7, -0.1]}]}"""
MOTION = """{"joint_names": ["lift", "turn"], "points": [
{"positions": [0.1, 0.5], "velocities": [0, 0], "time_from_start": {"sec": 0}},
{"positions": [0.2, 2.5], "velocities": [0, 0], "time_from_start": {"sec": 5}}]}"""


def told(value):
    """Numbers to six digits: the last bits of some are numpy's."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        inner = ", ".join(told(one) for one in value)
        return f"[{inner}]" if isinstance(value, list) else f"({inner})"
    return re.sub(r"np\.\w+\(([^()]*)\)", r"\1", repr(value))


def run(block, names, out):
    """Runs lines as a notebook does: it shows the value of every expression."""
    for node in ast.parse(block).body:
        line = ast.unparse(node)
        out.append(f">>> {line}")
        if isinstance(node, ast.Expr):
            value = eval(line, names)
            out += [] if value is None else [told(value)]
        else:
            exec(line, names)


def setting(folder):
    """The names that the chapters leave to their reader: a robot of two joints beside a post and a tray."""
    (folder / "two.urdf").write_text(URDF)
    (folder / "cell.json").write_text(CELL)
    (folder / "motion.json").write_text(MOTION)
    robot = lc.Robot.load(folder / "two.urdf")
    start, goal = np.array([0.5, 0.1]), np.array([2.5, 0.2])
    rng = np.random.default_rng(0)
    return {
        "lc": lc, "np": np, "robot": robot, "checker": lc.Checker(robot, cell=folder / "cell.json"),
        "start": start, "goal": goal, "low": [0, 0], "high": [0.01, 0.01], "errors": np.full((2, 2), 0.001),
        "waypoints": np.linspace(start, goal, 6), "path": [start, [1.5, 0.3], goal],
        "times": [0, 5], "positions": [start, goal], "velocities": np.zeros((2, 2)),
        "starts": np.array([start, goal, start]), "goals": np.array([goal, start, [-0.5, 0.1]]),
        "cart": lc.Geometry.box(0.1, 0.1, 0.1), "poses": np.array([[0, y, 0, 0, 0, 0, 1] for y in (1.5, 1.2, 1.5)]),
        "pose": ([2, 0, 0], [0, 0, 0, 1]), "configurations": rng.uniform(*robot.limits.T, (2, 2)),
        "scan": rng.uniform(-0.2, 0.2, (100, 3)),
        "next_scan": rng.uniform(-0.1, 0.1, (100, 3)), "part": lc.Geometry.ball(0.03),
        "taken": [1.5, 0.1], "lifted": [1.5, 0.4],
    }  # fmt: skip


def lines_of(page):
    """The fenced blocks of a page, and the indented ones about robots that run without a notebook or a shell."""
    text = page.read_text()
    fenced = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    blocks = re.findall(r"(?:^    .*\n|^\n(?=    ))+", text, re.MULTILINE)
    blocks = [re.sub("^    ", "", block, flags=re.MULTILINE) for block in blocks]
    blocks = [block for block in blocks if re.search(r"\b(checker|robot|lc\.JointCurve)\b", block)]
    return fenced, [block for block in blocks if not re.search("show|record|cargo|pip|import", block)]


@pytest.mark.skipif(not ARM.is_dir(), reason="robot/examples of the repository is not at hand")
def test_the_lines_of_the_readme(tmp_path, monkeypatch, capsys):
    out = []
    example, [arm] = lines_of(README)
    with np.printoptions(precision=6, suppress=True, threshold=40):
        for page in PAGES:
            out.append(f"== {page.relative_to(HERE.parent).as_posix()}")
            fenced, blocks = lines_of(page)
            # A chapter continues the example of the README, or has robots that are loaded already.
            names: dict[str, object] = {}
            for block in [] if page == README else example:
                exec(compile(block, "README.md", "exec"), names)
            capsys.readouterr()
            for block in fenced:
                exec(compile(block, page.name, "exec"), names)
                out.append(capsys.readouterr().out.rstrip())
            if page == README:
                monkeypatch.chdir(ARM)
                run(arm, {"lc": lc, "np": np}, out)
                continue
            monkeypatch.chdir(tmp_path)
            names = {}
            for block in blocks:
                names |= setting(tmp_path)
                names["q"] = names["configurations"][slice(None) if "_batch(q" in block else 0]
                run(block, names, out)
    text, file = "\n".join(out) + "\n", HERE / "readme.txt"
    if os.environ.get("LIN_CANNY_RECORD"):
        file.write_text(text)
    assert text == file.read_text()
