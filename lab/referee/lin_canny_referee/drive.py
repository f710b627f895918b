"""Runs a program that answers cases, in a process of its own, and restarts it behind a crash or a hang."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path

START = 180.0
"""Seconds that a program may take to its first answer (imports and compilers), and after a restart to its first line,
which may be a header."""


def count(part: Path) -> tuple[int, int]:
    """Returns the numbers of answers and of lines in a file; header lines start with #."""
    if not part.exists():
        return 0, 0
    with open(part) as text:
        lines = [x for x in text if x.endswith("\n")]
    return sum(1 for x in lines if not x.startswith("#")), len(lines)


def run(command: list[str], file: Path, part: Path, numbers: list[int], limit: float) -> None:
    """Appends to `part` an answer for each case: by `command FILE PART START`, or `crash` or `hang`.

    `limit` is the time in seconds within which the next answer must come.
    """
    part.unlink(missing_ok=True)
    while (done := count(part)[0]) < len(numbers):
        log = open(f"{part}.log", "a")
        environment = {**os.environ, "PYTHONWARNINGS": "ignore"}
        process = subprocess.Popen(
            [*command, str(file), str(part), str(done)], stdout=subprocess.DEVNULL, stderr=log, env=environment
        )
        last, since, allowed, why = count(part)[1], time.monotonic(), START, None
        while process.poll() is None:
            time.sleep(0.05)
            answers, lines = count(part)
            if lines > last:
                last, since = lines, time.monotonic()
                allowed = limit if answers else START
            if time.monotonic() - since > allowed:
                process.kill()
                process.wait()
                why = "hang"
                break
        log.close()
        reached = count(part)[0]
        if reached < len(numbers):
            if why is None and process.returncode == 0:
                raise SystemExit(f"{command[0]} answered {reached} of {len(numbers)} cases and ended")
            if reached == 0 and why is None:
                tail = Path(f"{part}.log").read_text().strip().splitlines()[-1:]
                raise SystemExit(f"{' '.join(command)} failed before its first answer: {' '.join(tail)}")
            end_last_line(part)
            with open(part, "a") as out:
                print(numbers[reached], why or "crash", *["-"] * 11, "#", process.returncode, file=out)


def end_last_line(part: Path) -> None:
    """Drops what a crash left of a line."""
    text = part.read_text() if part.exists() else ""
    if text and not text.endswith("\n"):
        part.write_text(text[: text.rfind("\n") + 1])
