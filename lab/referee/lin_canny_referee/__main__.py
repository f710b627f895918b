"""`python -m lin_canny_referee --engine NAME` judges an engine and prints a table."""

from __future__ import annotations

import argparse
import csv
import json
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from . import adapter, cases, drive, worst
from .judge import Judge, Tally, parse, witnesses_are_local

COLUMNS = (
    "engine,version,options,family,cases,wrong,no_answer,nan,crashed,timeout,median_error,worst_error,median_ns"
).split(",")
WORST = 50


def options_of(engine: type[adapter.Adapter]) -> list[str]:
    frames = ("", "-relative") if engine.program is None else ("",)
    return [kind + frame for kind in engine.options for frame in frames]


def command(o: argparse.Namespace, engine: type[adapter.Adapter], options: str) -> list[str]:
    """Returns the program that answers a file of cases."""
    if engine.program is None:
        return [sys.executable, "-m", f"{__package__}.worker", o.engine, options]
    program = shutil.which(engine.program[0])
    if program is None:
        raise SystemExit(f"the program {engine.program[0]!r} of {o.engine} is not on the path")
    return [program, *engine.program[1:], *(engine.careful_program if options == "careful" else [])]


def arguments(words: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="lin_canny_referee", description=__doc__)
    parser.add_argument("--engine", required=True, help=f"{', '.join(adapter.names())}, or the file of an adapter")
    parser.add_argument(
        "--suite", default="standard", help="core, extreme, standard (both), or a file of cases; default standard"
    )
    parser.add_argument("--seed", type=int, help="draw the suite by the program `cases`; default: the kept cases of seed 1")
    parser.add_argument("--count", type=int, default=100, help="cases of each family, about; only with --seed")
    parser.add_argument("--cases", default="cases", metavar="PROGRAM", help="the program `cases` of lin-canny")
    parser.add_argument("--options", help="default, careful, default-relative, careful-relative; by default all")
    parser.add_argument("--only", metavar="N", type=int, help="judge the first N cases of each family")
    parser.add_argument("--seconds", type=float, default=10.0, help="time limit of one case; default 10; ten times that for a batch")
    parser.add_argument("--limit", type=int, help="exit with 1 if more cases than this are wrong or without an answer")
    parser.add_argument("--csv", metavar="FILE", help="write a row for each family")
    parser.add_argument("--worst", metavar="FILE", help=f"write the {WORST} worst cases as JSON lines, with code")
    return parser.parse_args(words)


def suite_files(o: argparse.Namespace, engine: type[adapter.Adapter], folder: Path) -> tuple[Path, Path]:
    """Returns the file that the engine is asked, and the file with what is true of the points that it keeps."""
    single = ["--single"] if engine.precision == "single" else []
    if o.suite not in ("core", "extreme", "standard"):
        file = Path(o.suite)
    elif o.seed is None:
        file = cases.DATA / ("standard-single.jsonl" if single else "standard.jsonl")
    else:
        file = folder / "suite.jsonl"
        cases.make(o.cases, file, ["--suite", o.suite, "--seed", str(o.seed), "--count", str(o.count), *single])
    if not hasattr(engine, "kept"):
        return file, file
    kept, solved = folder / "kept.jsonl", folder / "solved.jsonl"
    worker = [sys.executable, "-m", f"{__package__}.worker", o.engine]
    subprocess.run([*worker, "--kept", str(file), str(kept)], stdout=subprocess.DEVNULL, check=True)
    cases.make(o.cases, solved, ["--solve", str(kept)])
    return file, solved


def chosen(o: argparse.Namespace, all_cases: list[cases.Case]) -> list[cases.Case]:
    """Returns the cases that count: all of a file, those of a suite, or the first of each family."""
    named = o.suite in ("core", "extreme", "standard")
    seen: dict[str, int] = {}
    out = []
    for case in all_cases:
        seen[case.family] = seen.get(case.family, 0) + 1
        within = o.only is None or seen[case.family] <= o.only
        if within and (not named or cases.belongs(case.family, o.suite)):
            out.append(case)
    return out


def rewrite(file: Path, wanted: set[int], out: Path) -> None:
    """Writes the lines of a file without the cases that do not count."""
    with open(file) as lines, open(out, "w") as kept:
        for text in lines:
            j = json.loads(text)
            if j["t"] != "case" or j["id"] in wanted:
                kept.write(text)


def table(name: str, engine: type[adapter.Adapter], options: str, tallies: dict[str, Tally]) -> None:
    kind = options.split("-")[0]
    frame = ", B in A's frame and scaled to size 1" if options.endswith("-relative") else ""
    print(f"\n{name} {adapter.version(engine)}, {options} ({engine.options[kind]}{frame}), {engine.precision} precision")
    t = engine.tolerance
    print(f"wrong: error above max({t.absolute:g}, {t.relative:g} L), or another contact state beyond that")
    head = ("family cases wrong state shallow deep none nan crash hang | ties points normal | median worst ns").split()
    print("".join(h.rjust(9) if i else h.ljust(10) for i, h in enumerate(h for h in head if h != "|")))
    total = Tally()
    for tally in tallies.values():
        total.add(tally)
    for family, x in [*tallies.items(), ("all", total)]:
        counts = [x.cases, x.wrong, x.state, x.shallow, x.deep, x.no_answer, x.nan, x.crashed, x.timeout]
        counts += [x.tied, x.points, x.normal]
        cells = [str(c or ".").rjust(9) for c in counts]
        cells += [f"{x.median_error:.0e}".rjust(9), f"{x.worst_error:.0e}".rjust(9), f"{x.median_ns:.0f}".rjust(9)]
        print(family.ljust(10) + "".join(cells))


def main(words: list[str] | None = None) -> int:
    o = arguments(words)
    engine = adapter.load(o.engine)
    name = Path(o.engine).stem
    all_options = o.options.split(",") if o.options else options_of(engine)
    if unknown := [x for x in all_options if x not in options_of(engine)]:
        raise SystemExit(f"{name} has no options {', '.join(unknown)}: {', '.join(options_of(engine))}")
    rows, bad, failed = [], [], 0
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        source, truth = suite_files(o, engine, folder)
        shapes, all_cases = cases.read(truth)
        asked_shapes, _ = cases.read(source)
        asked = chosen(o, all_cases)
        file = folder / "asked.jsonl"
        rewrite(source, {c.number for c in asked}, file)
        for options in all_options:
            part = folder / f"{options}.txt"
            # Answers of a batch come at once.
            seconds = o.seconds * (10 if hasattr(engine, "batch") else 1)
            drive.run(command(o, engine, options), file, part, [c.number for c in asked], seconds)
            answers = parse(part)
            judge = Judge(engine, shapes, options.endswith("-relative"), witnesses_are_local(part))
            tallies: dict[str, Tally] = {}
            for case in asked:
                given = answers.get(case.number)
                tally, error = judge.judge(case, given)
                tallies.setdefault(case.family, Tally()).add(tally)
                if tally.wrong or not math.isfinite(error):
                    bad.append((error, options, case, given))
            table(name, engine, options, tallies)
            for family, t in tallies.items():
                failed += t.wrong + t.no_answer + t.nan + t.crashed + t.timeout
                rows.append([name, adapter.version(engine), options, family, t.cases, t.wrong, t.no_answer, t.nan,
                             t.crashed, t.timeout, f"{t.median_error:.3g}", f"{t.worst_error:.3g}", f"{t.median_ns:.0f}"])
    if o.csv:
        with open(o.csv, "w", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows([COLUMNS, *rows])
    if o.worst:
        # Wrong answers first, the greatest error before all; then cases without an answer.
        bad.sort(key=lambda x: -x[0] if math.isfinite(x[0]) else math.inf)
        with open(o.worst, "w") as out:
            for error, options, case, given in bad[:WORST]:
                print(json.dumps(worst.entry(engine, name, options, case, asked_shapes, shapes, given, error)), file=out)
    return int(o.limit is not None and failed > o.limit)


if __name__ == "__main__":
    sys.exit(main())
