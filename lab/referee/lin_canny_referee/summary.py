"""`python -m lin_canny_referee.summary [--svg FILE] CSV...` prints tables of engines by families, and draws them.

Each engine has the row of its options with the fewest cases that are wrong or without an answer.
"""

from __future__ import annotations

import argparse
import csv
import math
import statistics

from .cases import belongs

FAILURES = ("wrong", "no_answer", "nan", "crashed", "timeout")
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 760, 420, 70, 50, 34, 220
LINE = 18
TIMES, ERRORS = (2, 7), (-17, 1)
"""Powers of ten: nanoseconds, and errors relative to L."""


class Row:
    """What an engine did in one suite, with one set of options."""

    def __init__(self, rows: list[dict[str, str]]) -> None:
        self.engine, self.version, self.options = (rows[0][k] for k in ("engine", "version", "options"))
        self.failures = {r["family"]: sum(int(r[k]) for k in FAILURES) for r in rows}
        self.wrong = sum(int(r["wrong"]) for r in rows)
        self.total = sum(self.failures.values())
        self.cases = sum(int(r["cases"]) for r in rows)
        errors = [float(r["worst_error"]) for r in rows]
        self.worst = max((e for e in errors if e == e), default=math.nan)
        times = [float(r["median_ns"]) for r in rows]
        self.nanoseconds = statistics.median([t for t in times if t == t] or [math.nan])


def best(rows: list[dict[str, str]], suite: str) -> list[Row]:
    """Returns the best row of each engine in a suite, the best engine first."""
    groups: dict[tuple[str, str], list[dict[str, str]]] = {}
    for r in rows:
        if belongs(r["family"], suite):
            groups.setdefault((r["engine"], r["options"]), []).append(r)
    found: dict[str, Row] = {}
    for row in map(Row, groups.values()):
        if row.engine not in found or (row.total, row.wrong) < (found[row.engine].total, found[row.engine].wrong):
            found[row.engine] = row
    return sorted(found.values(), key=lambda r: (r.total, r.wrong, r.worst))


def table(rows: list[Row]) -> str:
    families = list(rows[0].failures)
    head = ["engine", "options", *families, "all", "wrong", "worst error / L", "µs"]
    lines = ["| " + " | ".join(head) + " |", "|---|---|" + "---:|" * (len(head) - 2)]
    for r in rows:
        counts = [str(r.failures[f]) for f in families] + [str(r.total), str(r.wrong)]
        worst = "-" if math.isnan(r.worst) else f"{r.worst:.0e}"
        cells = [f"{r.engine} {r.version}", r.options, *counts, worst, f"{r.nanoseconds / 1e3:.1f}"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def picture(rows: list[Row]) -> str:
    """Draws the worst error of each engine over its time of a query, both to powers of ten."""

    def x(ns: float) -> float:
        return LEFT + (math.log10(ns) - TIMES[0]) / (TIMES[1] - TIMES[0]) * (WIDTH - LEFT - RIGHT)

    def y(error: float) -> float:
        power = math.log10(max(error, 1e-17))
        return HEIGHT - BOTTOM - (power - ERRORS[0]) / (ERRORS[1] - ERRORS[0]) * (HEIGHT - BOTTOM - TOP)

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="{LEFT}" y="20" font-size="15">Worst error of a distance or depth, relative to the size of the pair</text>',
    ]
    for power in range(TIMES[0], TIMES[1] + 1):
        label = {2: "0.1 µs", 3: "1 µs", 4: "10 µs", 5: "0.1 ms", 6: "1 ms", 7: "10 ms"}[power]
        at = x(10.0**power)
        out.append(f'<path d="M{at:.0f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(f'<text x="{at:.0f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{label}</text>')
    for power in range(-15, 1, 3):
        at = y(10.0**power)
        label = "1" if power == 0 else f"1e{power}"
        out.append(f'<path d="M{LEFT} {at:.0f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 8}" y="{at + 4:.0f}" text-anchor="end">{label}</text>')
    middle = (LEFT + WIDTH - RIGHT) / 2
    out.append(f'<text x="{middle:.0f}" y="{HEIGHT - 10}" text-anchor="middle">median time of a query</text>')
    # Names stand in a column beside the dots, in the order of the errors, a line from each to its dot.
    drawn = sorted((r for r in rows if not math.isnan(r.worst)), key=lambda r: (y(r.worst), -r.nanoseconds))
    lowest = TOP - LINE
    for r in drawn:
        lowest = at = max(lowest + LINE, y(r.worst))
        colour = "#0a7d32" if r.engine.startswith("lin_canny") else "#b33"
        px, py = x(r.nanoseconds), y(r.worst)
        out.append(f'<path d="M{px:.1f} {py:.1f}L{WIDTH - RIGHT + 6} {at:.1f}" stroke="{colour}" opacity="0.35"/>')
        out.append(f'<circle cx="{px:.1f}" cy="{py:.1f}" r="6" fill="{colour}"/>')
        failed = f"{r.total if r.total else 'none'} of {r.cases:,} failed"
        out.append(f'<text x="{WIDTH - RIGHT + 10}" y="{at + 4:.0f}" fill="{colour}">{r.engine}: {failed}</text>')
    return "\n".join([*out, "</svg>", ""])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", metavar="CSV", help="files that `--csv` of the referee wrote")
    parser.add_argument("--svg", metavar="FILE", help="draw the suite `core`")
    o = parser.parse_args()
    rows = [r for file in o.files for r in csv.DictReader(open(file))]
    for suite in ("core", "extreme"):
        if found := best(rows, suite):
            print(f"{suite}: cases that are wrong or without an answer, of {found[0].cases}\n\n{table(found)}\n")
            if o.svg and suite == "core":
                with open(o.svg, "w") as out:
                    out.write(picture(found))


if __name__ == "__main__":
    main()
