"""The worst cases of an engine, each with the engine's own code that reproduces it."""

from __future__ import annotations

import json
import math
from typing import Any

from . import adapter, cases
from .judge import Given


Shapes = dict[int, cases.Shape]


def entry(engine: type[adapter.Adapter], name: str, options: str, case: cases.Case, asked: Shapes, kept: Shapes,
          given: Given | None, error: float) -> dict[str, Any]:
    """Returns what is known of a case: lengths as the engine was asked, which differ from the file in A's frame.

    The code has the bodies that the engine was asked; the entry has those that it kept, of which the truth is.
    """
    k, pose_a, pose_b = cases.posed(case, options.endswith("-relative"))
    a, b = asked[case.a], asked[case.b]

    def put(x: Any) -> str:
        return json.dumps(x)

    def faces(shape: cases.Shape) -> str:
        return put(adapter.triangles(shape.faces) if shape.faces else [])

    words = dict(
        a=put(cases.scaled(a.points, k)), b=put(cases.scaled(b.points, k)), fa=faces(a), fb=faces(b),
        ta=put(pose_a.position), qa=put(pose_a.quaternion), ra=put(pose_a.matrix),
        tb=put(pose_b.position), qb=put(pose_b.quaternion), rb=put(pose_b.matrix),
        careful=engine.careful_code if options.startswith("careful") else engine.default_code,
    )
    distance = given.distance if given else None
    a, b = kept[case.a], kept[case.b]
    return {
        "engine": name, "version": adapter.version(engine), "options": options,
        "family": case.family, "level": case.level, "case": case.number,
        "error": error if math.isfinite(error) else None,
        "answer": given.status if given else "none",
        "distance": None if distance is None else math.ldexp(distance, -k),
        "remark": given.remark if given else "",
        "true_state": case.state, "true_distance": math.ldexp(case.distance, -k), "size": math.ldexp(case.size, -k),
        "a": {"name": a.name, "points": cases.scaled(a.points, k), "faces": a.faces,
              "quaternion": pose_a.quaternion, "position": pose_a.position},
        "b": {"name": b.name, "points": cases.scaled(b.points, k), "faces": b.faces,
              "quaternion": pose_b.quaternion, "position": pose_b.position},
        "code": engine.code.format(**words),
    }
