"""Promise: a fault in an adapter turns its engine red, and crashes, hangs and limits are counted as what they are."""

import csv
import importlib.util
import json
import shutil
import subprocess
import sys

import pytest

from lin_canny_referee import adapter, cases, summary
from lin_canny_referee.__main__ import COLUMNS, main
from lin_canny_referee.confirm import signed_distance

PACKAGES = {"bullet": "pybullet", "drake": "pydrake", "rapier": "rapier3d"}
FAULTS = {
    # What a careless adapter does: before it asks, after it is answered, the column that shows it, what the engine
    # must answer for that.
    "sign": ("", "answer._replace(distance=-answer.distance)", "wrong", "distance"),
    "unit": ("", "answer._replace(distance=1000 * answer.distance)", "wrong", "distance"),
    "swapped points": ("", "answer._replace(point_a=answer.point_b, point_b=answer.point_a)", "points", "points"),
    "turned normal": ("", "answer._replace(normal=[-x for x in answer.normal])", "normal", "normal"),
    "quaternion w first": (
        "pose_a, pose_b = (Pose(p.quaternion[3:] + p.quaternion[:3], p.position) for p in (pose_a, pose_b))",
        "answer", "wrong", None,
    ),
    "frame of the other body": ("pose_a, pose_b = pose_b, pose_a", "answer", "wrong", None),
}
PROGRAM = shutil.which("cases")
GRADED = ("parry", "lin_canny_walk", "lin_canny_exact")
"""What the program `grade` answers."""


def is_installed(engine):
    if engine in GRADED:
        return shutil.which("grade") is not None
    return importlib.util.find_spec(PACKAGES.get(engine, engine)) is not None


def engines():
    def why(engine):
        if not is_installed(engine):
            return f"{engine} is not installed"
        return "the program `cases` is not on the path" if engine == "bullet" and not PROGRAM else ""

    return [pytest.param(e, marks=pytest.mark.skipif(bool(why(e)), reason=why(e))) for e in adapter.names()]


def rows(path):
    return list(csv.DictReader(open(path)))


def write(path, engine, before="", after="answer"):
    """Writes an adapter that changes what the adapter of an engine does."""
    path.write_text(
        f"""
from lin_canny_referee.adapter import load
from lin_canny_referee.cases import Pose

Healthy = load("{engine}")

def changed(a, pose_a, b, pose_b):
    {before}
    return a, pose_a, b, pose_b

def answered(answer):
    return {after} if answer.distance is not None or not Healthy.answers else answer

class Engine(Healthy):
    def ask(self, *case):
        return answered(super().ask(*changed(*case)))

    if hasattr(Healthy, "batch"):
        def batch(self, cases):
            return [answered(x) for x in super().batch([changed(*case) for case in cases])]
"""
    )


def write_program(path, engine, after):
    """Writes an adapter that changes what a program answers."""
    numbers = {
        "answer._replace(distance=-answer.distance)": "w[2] = '-' + w[2]",
        "answer._replace(distance=1000 * answer.distance)": "w[2] = w[2] + '000' if 'e' not in w[2] else str(1000 * float(w[2]))",
        "answer._replace(point_a=answer.point_b, point_b=answer.point_a)": "w[3:9] = w[6:9] + w[3:6]",
        "answer._replace(normal=[-x for x in answer.normal])": "w[9:12] = [str(-float(x)) for x in w[9:12]]",
    }
    code = f"""import os, subprocess, sys
*command, file, part, start = sys.argv[1:]
subprocess.run([*command, file, part + ".right", start], check=True)
with open(part, "a") as out:
    for line in open(part + ".right"):
        w = line.split()
        if not line.startswith("#") and w[2] != "-":
            {numbers.get(after, "pass")}
            w[2] = w[2].replace("--", "")
        print(*w, file=out)
os.remove(part + ".right")
"""
    path.write_text(
        f"""
import sys
from lin_canny_referee.adapter import load

class Engine(load("{engine}")):
    program = [sys.executable, "-c", {code!r}, *load("{engine}").program]
"""
    )


def judged(capsys, file, *options):
    program = ["--cases", PROGRAM] if PROGRAM else []
    code = main(["--engine", str(file), "--suite", "core", "--options", "default", "--limit", "0", *program, *options])
    lines = capsys.readouterr().out.splitlines()
    head = next(x.split() for x in lines if x.startswith("family"))
    table = {x.split()[0]: dict(zip(head, x.split())) for x in lines if x.split()[1:2] and x.split()[1].isdigit()}
    return code, table


@pytest.mark.parametrize("engine", engines())
def test_planted_faults_turn_an_engine_red(engine, tmp_path, capsys):
    _, healthy = judged(capsys, engine, "--only", "20")

    def count(table, column):
        return int(table["all"][column].replace(".", "0"))

    assert healthy["round"]["wrong"] == healthy["round"]["points"] == healthy["round"]["normal"] == "."
    answers = adapter.load(engine).answers
    for fault, (before, after, column, needs) in FAULTS.items():
        if needs is not None and needs not in answers:
            continue
        file = tmp_path / "faulty.py"
        if adapter.load(engine).program is None:
            write(file, engine, before, after)
        elif after == "answer":
            continue
        else:
            write_program(file, engine, after)
        code, table = judged(capsys, file, "--only", "20")
        # In most cases a fault shows little: they are near contact, or have no answer.
        assert count(table, column) >= count(healthy, column) + 10 and (code == 1 or column != "wrong"), fault


@pytest.mark.skipif(not is_installed("lin_canny"), reason="lin_canny is not installed")
def test_crashes_hangs_and_no_answers_are_counted_apart(tmp_path, capsys):
    file = tmp_path / "odd.py"
    odd = """import os, time
    Engine.last = str(round(pose_b.position[0], 9))[-1]
    if Engine.last == "1": os._exit(3)
    if Engine.last == "2": time.sleep(60)
    if Engine.last == "3": raise ValueError("no")"""
    write(file, "lin_canny", odd, "answer._replace(distance=float('nan')) if Engine.last == '4' else answer")
    out, worst = tmp_path / "odd.csv", tmp_path / "odd.jsonl"
    code, table = judged(capsys, file, "--only", "5", "--seconds", "1", "--csv", str(out), "--worst", str(worst))
    assert code == 1
    found = rows(out)
    assert list(found[0]) == COLUMNS
    for column in ("crashed", "timeout", "no_answer", "nan"):
        assert sum(int(r[column]) for r in found) > 0, column
    assert sum(int(r["wrong"]) for r in found) == 0
    remarks = [json.loads(x)["remark"] for x in worst.read_text().splitlines()]
    assert any("no" in r for r in remarks)


@pytest.mark.skipif(not is_installed("lin_canny"), reason="lin_canny is not installed")
def test_lin_canny_is_right_in_every_case_that_is_kept(tmp_path):
    out = tmp_path / "ours.csv"
    assert main(["--engine", "lin_canny", "--limit", "0", "--csv", str(out)]) == 0
    assert sum(int(r["cases"]) for r in rows(out)) == 3200


@pytest.mark.parametrize("engine", engines())
def test_code_of_worst_cases_gives_the_answer_again(engine, tmp_path):
    # Every answer of an engine without a tolerance is among the worst.
    file, worst = tmp_path / "strict.py", tmp_path / "worst.jsonl"
    file.write_text(f"from lin_canny_referee.adapter import *\nclass Engine(load('{engine}')):\n    tolerance = Tolerance(0, -1)\n")
    main(["--engine", str(file), "--suite", "core", "--options", "default", "--only", "2", "--worst", str(worst),
          *(["--cases", PROGRAM] if PROGRAM else [])])
    entries = [json.loads(x) for x in worst.read_text().splitlines()]
    if engine in GRADED:
        pytest.skip("its code is Rust")
    if engine == "distance3d":
        pytest.skip("its EPA reads rows of a simplex that its GJK did not set: a depth may differ from run to run")
    for entry in [e for e in entries if e["distance"] is not None][:2]:
        assert len(entry["code"].splitlines()) == 3
        run = subprocess.run([sys.executable, "-W", "ignore", "-c", entry["code"]], capture_output=True, text=True)
        said = float(run.stdout.split()[-1]) if run.stdout else pytest.fail(run.stderr)
        margin = 0.002 if engine == "bullet" else 0.0
        assert said + margin == pytest.approx(entry["distance"], abs=1e-6 * entry["size"])


def test_the_kept_answers_are_those_of_rational_numbers():
    for name in ("standard.jsonl", "standard-single.jsonl"):
        shapes, all_cases = cases.read(cases.DATA / name)
        seen = 0
        for case in all_cases[::25]:
            a, b = shapes[case.a], shapes[case.b]
            if not a.faces or not b.faces or len(a.points) > 12 or len(b.points) > 12:
                continue
            bodies = [dict(points=s.points, faces=s.faces, quaternion=q, position=t)
                      for s, q, t in ((a, case.qa, case.ta), (b, case.qb, case.tb))]
            assert signed_distance(*bodies) == case.distance, case.number
            seen += 1
        assert seen > 15
        assert (cases.DATA / name).stat().st_size < 2_500_000


def test_unknown_engines_and_options_are_named():
    for words, message in [
        (["--engine", "none"], "no engine 'none': bullet, coal"),
        (["--engine", "./none.py"], "no file ./none.py"),
    ]:
        with pytest.raises(SystemExit, match=message):
            main(words)


def test_the_summary_takes_the_best_options_of_each_engine(tmp_path, capsys, monkeypatch):
    file, svg = tmp_path / "two.csv", tmp_path / "two.svg"
    rows_of = [
        ["good", "1", "default", "round", 9, 2, 0, 0, 0, 0, 1e-9, 1e-3, 900],
        ["good", "1", "careful", "round", 9, 0, 0, 0, 0, 0, 1e-12, 1e-9, 9000],
        ["none", "2", "default", "round", 9, 0, 9, 0, 0, 0, "nan", "nan", "nan"],
        ["good", "1", "careful", "flat", 9, 0, 9, 0, 0, 0, "nan", "nan", "nan"],
    ]
    with open(file, "w", newline="") as out:
        csv.writer(out).writerows([COLUMNS, *rows_of])
    monkeypatch.setattr(sys, "argv", ["summary", "--svg", str(svg), str(file)])
    summary.main()
    lines = capsys.readouterr().out.splitlines()
    assert "| good 1 | careful | 0 | 0 | 0 | 1e-09 | 9.0 |" in lines
    assert "| none 2 | default | 9 | 9 | 0 | - | nan |" in lines
    assert "| good 1 | careful | 9 | 9 | 0 | - | nan |" in lines, "extreme, in a table of its own"
    assert "good: none of 9 failed" in svg.read_text()
