import json
import subprocess
import sys

import numpy as np
import pytest

import lin_canny as lc

DIE = lc.Geometry.box(0.5, 0.5, 0.5)


def at(x, y=0.0):
    return [x, y, 0, 0, 0, 0, 1]


def test_kinds_and_bounds_have_closed_forms():
    parts = {"die": DIE, "lid": (DIE, at(0.875)), "rod": (DIE, at(1.875)), "top": (DIE, at(0, 1.25)), "same": DIE}
    found = lc.clash(parts, rules={"margin": 0.5, "exclude": [["same", "*", "a copy"]]}, volume=True)
    rows = {(row.a, row.b): row for row in found.rows}
    assert {pair: row.kind for pair, row in rows.items()} == {
        ("die", "lid"): "overlapping",
        ("die", "top"): "close",
        ("lid", "rod"): "touching",
        ("lid", "top"): "close",
    }
    lid = rows["die", "lid"]
    for low, high in (lid.depth, lid.volume):
        assert low <= 0.125 <= high and high - low < 1e-8
    assert lid.gap == (0, 0) and lid.broken and lid.rule is None and lid.point.shape == (3,)
    assert np.allclose(lid.point, [0.4375, 0, 0])
    top = rows["die", "top"]
    assert top.gap[0] <= 0.25 <= top.gap[1] and top.rule == "margin" and top.volume is None
    assert len(found.broken) == 4 and found.excluded == 3 and found.measured == 4
    assert "4 of 4" in repr(found) and "die - lid: overlapping" in repr(lid)
    assert lc.clash({"a": DIE, "b": DIE}).rows[0].kind == "equal"


def test_outputs_are_those_of_the_tool():
    found = lc.clash({"a": DIE, "b": (DIE, at(0.5))})
    row = json.loads(found.to_jsonl())
    assert (row["a"], row["kind"], row["broken"]) == ("a", "overlapping", True)
    assert found.to_csv().splitlines()[1].startswith("a,b,overlapping,")
    assert 'failures="1"' in found.to_junit()


def test_files_rules_and_repairs(tmp_path):
    faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\n"
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    (tmp_path / "solid.obj").write_text(corners + faces + "f 3 1 4\n")
    (tmp_path / "open.obj").write_text(corners.replace(" 0\n", " 2\n").replace(" 1\n", " 3\n") + faces)
    found = lc.clash(tmp_path, within=10)
    assert [(row.a, row.b) for row in found.rows] == [("open", "solid")]
    assert list(found.notes) == ["open"] and "surface without inside" in found.notes["open"]
    assert "% of its area" in found.notes["open"]
    assert "edges are open" in lc.clash([tmp_path / "open.obj"], repair=False).notes["open"]
    (tmp_path / "rules.toml").write_text('margins = [["open", "slid", 1.0]]\n')
    found = lc.clash([tmp_path / "solid.obj", tmp_path / "open.obj"], rules=tmp_path / "rules.toml")
    assert found.unused_rules == ['margins[0] ("open", "slid")']
    (tmp_path / "broken.stl").write_text("solid a\n")
    with pytest.raises(lc.FileError, match="broken.stl"):
        lc.clash(tmp_path)


def test_wrong_arguments_are_named():
    for wrong, why in [
        ({"rules": {"margn": 1}}, "margn"),
        ({"rules": {"margin": -1}}, "margin is -1"),
        ({"within": -1.0}, "within is -1"),
        ({"unit": "cm"}, 'unit is "cm"'),
    ]:
        with pytest.raises(lc.LinCannyError, match=why):
            lc.clash({"a": DIE}, **wrong)
    with pytest.raises(lc.FileError, match="missing.toml"):
        lc.clash({"a": DIE}, rules="missing.toml")
    with pytest.raises(TypeError):
        lc.clash({"a": 1})
    with pytest.raises(TypeError):
        lc.clash(1)


def test_progress_ends_at_all_and_an_exception_stops():
    calls = []
    row = {f"die{k}": (DIE, at(0.9 * k)) for k in range(100)}
    found = lc.clash(row, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (99, 99) and found.measured == 99


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT of a child process")
def test_ctrl_c_stops_it():
    code = """
import _thread, threading
import lin_canny as lc
import numpy as np
k = np.arange(400) + 0.5
up, turn = np.arccos(1 - 2 * k / 400), np.pi * (1 + 5 ** 0.5) * k
points = np.stack([np.cos(turn) * np.sin(up), np.sin(turn) * np.sin(up), np.cos(up)], axis=1)
hull = lc.Geometry.hull(points)
body = lc.Geometry.mesh(hull.vertices, hull.triangles)
threading.Timer(0.5, _thread.interrupt_main).start()
try:
    lc.clash({str(k): (body, [1e-3 * k, 0, 0, 0, 0, 0, 1]) for k in range(400)}, volume=True)
except KeyboardInterrupt:
    print("stopped")
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert told.stdout == "stopped\n", told.stderr
