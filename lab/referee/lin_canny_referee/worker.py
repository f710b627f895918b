"""Asks one engine every case of a file: `worker ENGINE OPTIONS FILE PART START`.

It speaks the protocol of answers of `tests/CASES.md`: it passes over START cases and appends a line a case to PART,
flushed, so that whoever drives it can restart it behind a crash. OPTIONS is `default` or `careful`, with `-relative`
behind it if B is put into A's frame and the pair is scaled to a size of 1. `worker ENGINE --kept FILE OUT` writes
the file with the points that the engine keeps.
"""

from __future__ import annotations

import json
import math
import sys
from typing import Any

from . import adapter, cases

BATCH = 256
BLANK = " -" * 11


def word(distance: float | None) -> str:
    if distance is None or distance != distance:
        return "none"
    return "sep" if distance > 0 else "pen" if distance < 0 else "touch"


def line(number: int, answer: adapter.Answer, k: int) -> str:
    """Returns the answer to a case whose lengths were divided by 2^k."""

    def three(x: Any, k: int) -> list[str]:
        return ["-"] * 3 if x is None else [repr(math.ldexp(float(c), k)) for c in x]

    distance = None if answer.distance is None else math.ldexp(float(answer.distance), k)
    numbers = ["-" if distance is None else repr(distance)]
    numbers += [*three(answer.point_a, k), *three(answer.point_b, k), *three(answer.normal, 0)]
    return " ".join([str(number), answer.state or word(answer.distance), *numbers, str(answer.nanoseconds)])


def refusal(number: int, why: str, error: Exception) -> str:
    text = " ".join(repr(error).split())[:160]
    return f"{number} {why}{BLANK} # {text}"


def work(engine: str, options: str, file: str, part: str, start: int) -> None:
    kind, _, frame = options.partition("-")
    asked = adapter.load(engine)(kind == "careful")
    shapes, all_cases = cases.read(file)
    made: dict[tuple[int, int], Any] = {}
    held: list[tuple] = []

    def body(number: int, k: int) -> Any:
        if (number, k) not in made:
            shape = shapes[number]
            try:
                made[number, k] = asked.body(cases.scaled(shape.points, k), shape.faces)
            except Exception as error:
                made[number, k] = error
        return made[number, k]

    with open(part, "a") as out:

        def put(text: str) -> None:
            print(text, file=out, flush=True)

        put("# witness world")  # a header line: the engine is loaded

        def flush() -> None:
            for (number, k, *_), answer in zip(held, asked.batch([h[2:] for h in held]) if held else []):
                put(line(number, answer, k))
            held.clear()

        for case in all_cases[start:]:
            k, pose_a, pose_b = cases.posed(case, frame == "relative")
            a, b = body(case.a, k), body(case.b, k)
            refused = next((x for x in (a, b) if isinstance(x, Exception)), None)
            if refused is not None:
                flush()
                put(refusal(case.number, "noshape", refused))
            elif hasattr(asked, "batch"):
                held.append((case.number, k, a, pose_a, b, pose_b))
                if len(held) == BATCH:
                    flush()
            else:
                try:
                    text = line(case.number, asked.ask(a, pose_a, b, pose_b), k)
                except Exception as error:
                    text = refusal(case.number, "none", error)
                put(text)
        flush()


def kept(engine: str, file: str, out: str) -> None:
    asked = adapter.load(engine)(False)
    # A file of its own, because engines print to the standard output while they start.
    with open(file) as lines, open(out, "w") as written:
        for text in lines:
            j = json.loads(text)
            if j["t"] == "shape":
                v = j["v"]
                points = [v[k : k + 3] for k in range(0, len(v), 3)]
                try:
                    j["v"] = [x for p in asked.kept(points, j["f"]) for x in p]
                    j["f"] = []
                except Exception:
                    pass  # The engine refuses the body; the case will say so.
            print(json.dumps(j), file=written)


def main() -> None:
    if sys.argv[2] == "--kept":
        kept(sys.argv[1], sys.argv[3], sys.argv[4])
    else:
        work(*sys.argv[1:5], int(sys.argv[5]))


if __name__ == "__main__":
    main()
