"""Runs a program that answers cases, in a process of its own, and restarts it behind a crash or a hang."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path

START = 180.0
"""Seconds that a program may take to its first answer: imports and compilers."""


def count(part: Path) -> int:
    """Returns the number of answers in a file; header lines start with #."""
    if not part.exists():
        return 0
    with open(part) as lines:
        return sum(1 for x in lines if x.endswith("\n") and not x.startswith("#"))


def run(command: list[str], file: Path, part: Path, numbers: list[int], limit: float) -> None:
    """Appends to `part` an answer for each case: by `command FILE PART START`, or `crash` or `hang`.

    `limit` is the time in seconds within which the next answer must come.
    """
    part.unlink(missing_ok=True)
    while (done := count(part)) < len(numbers):
        log = open(f"{part}.log", "a")
        environment = {**os.environ, "PYTHONWARNINGS": "ignore"}
        process = subprocess.Popen(
            [*command, str(file), str(part), str(done)], stdout=subprocess.DEVNULL, stderr=log, env=environment
        )
        last, since, allowed, why = done, time.monotonic(), START, None
        while process.poll() is None:
            time.sleep(0.05)
            if (now := count(part)) > last:
                last, since, allowed = now, time.monotonic(), limit
            if time.monotonic() - since > allowed:
                process.kill()
                process.wait()
                why = "hang"
                break
        log.close()
        reached = count(part)
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
