"""Pictures for notebooks and browsers: one HTML page that holds everything and needs no network."""

from __future__ import annotations

import base64
import html
import json
import math
import os
import pathlib
from typing import TYPE_CHECKING, Any, NamedTuple

from ._native import Checker, Closest, Geometry, LinCannyError, Scene

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

__all__ = ["View", "show"]

# Triangles beyond which a notebook shows the text of an object alone; `show` draws any number.
_MOST_TRIANGLES = 100_000
_COLORS = [(0.36, 0.54, 0.78), (0.93, 0.62, 0.30), (0.45, 0.69, 0.46), (0.72, 0.53, 0.76), (0.80, 0.74, 0.40)]
_OF_KIND = {"robot": (0.36, 0.54, 0.78), "attached": (0.93, 0.62, 0.30), "obstacle": (0.72, 0.72, 0.70)}
_LIT = (0.95, 0.45, 0.40)


class _Shown(NamedTuple):
    name: str
    geometry: Geometry
    color: tuple[float, float, float]


class _Frame(NamedTuple):
    """A pose for each body, shape (N, 4, 4), a text, and the closest points, shape (2, 3), or None."""

    poses: NDArray[np.float64]
    text: str
    closest: Any


class View:
    """A picture of bodies that turns by dragging, made by `show`.

    A notebook displays it. In a script, call `open` or `save`. Drag to rotate, drag with the right
    button or Shift to shift, use the wheel to zoom. If there are several frames, the page plays
    them.
    """

    def __init__(self, bodies: list[_Shown], frames: list[_Frame]) -> None:
        self._bodies = bodies
        self._frames = frames

    def html(self) -> str:
        """Return the page: HTML that holds all data, for any browser with WebGL 2."""
        page = (pathlib.Path(__file__).parent / "_page.html").read_text(encoding="utf-8")
        title = html.escape(", ".join(body.name for body in self._bodies)[:80])
        # No text can end the script that holds the data.
        data = json.dumps(self._data()).replace("<", "\\u003c")
        return page.replace("@TITLE@", title).replace("@DATA@", data)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page to a file."""
        pathlib.Path(path).write_text(self.html(), encoding="utf-8")

    def open(self) -> str:
        """Open the page in a browser, and return the path of the temporary file that holds it."""
        import tempfile
        import webbrowser

        with tempfile.NamedTemporaryFile("w", suffix=".html", delete=False, encoding="utf-8") as file:
            file.write(self.html())
        webbrowser.open(pathlib.Path(file.name).as_uri())
        return file.name

    def _repr_html_(self) -> str:
        page = html.escape(self.html(), quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 420px; border: 1px solid #ccc"></iframe>'

    def __repr__(self) -> str:
        frames = f", {len(self._frames)} frames" if len(self._frames) > 1 else ""
        return f"<View: {len(self._bodies)} bodies{frames}>"

    def _data(self) -> dict[str, Any]:
        import numpy as np

        center, radius = self._ball()
        bodies = []
        for name, geometry, color in self._bodies:
            triangles, edges = geometry._render_mesh()
            parts = {"triangles": triangles, "edges": edges}
            encoded = {key: base64.b64encode(part.astype("<f4").tobytes()).decode() for key, part in parts.items()}
            bodies.append({"name": name, "color": color, **encoded})
        frames = []
        for frame in self._frames:
            turns = frame.poses[:, :3, :3].reshape(-1, 9)
            numbers = np.hstack([turns, frame.poses[:, :3, 3] - center])
            closest = None if frame.closest is None else (np.asarray(frame.closest) - center).ravel().tolist()
            frames.append({"poses": numbers.tolist(), "text": frame.text, "closest": closest})
        return {"center": center.tolist(), "radius": radius, "bodies": bodies, "frames": frames}

    def _ball(self) -> tuple[NDArray[np.float64], float]:
        """Return a ball around all bodies at the first frame, without half-spaces."""
        import numpy as np

        low, high = np.full(3, math.inf), np.full(3, -math.inf)
        for body, pose in zip(self._bodies, self._frames[0].poses):
            if body.geometry.kind == "half-space":
                continue
            at, radius = body.geometry.bounding_ball
            middle = pose[:3, :3] @ at + pose[:3, 3]
            low, high = np.minimum(low, middle - radius), np.maximum(high, middle + radius)
        if not np.all(np.isfinite(low)):
            return np.zeros(3), 5.0
        return (low + high) / 2, float(np.linalg.norm(high - low)) / 2 or 1.0


def _matrix(pose: Any) -> NDArray[np.float64]:
    """Return any form of a pose as an array of shape (4, 4)."""
    scene = Scene()
    return scene.pose(scene.insert(Geometry.point([0, 0, 0]), pose))


def show(*bodies: Any, closest: Closest | None = None) -> View:
    """Return a View of geometries: a page for a notebook or a browser, without network.

    Parameters
    ----------
    bodies : Geometry, or tuple of a Geometry and its pose
        At the identity without a pose.
    closest : Closest, optional
        Closest points to show, of `PairTracker.closest` at the same poses.
    """
    import numpy as np

    shown, poses = [], []
    for k, body in enumerate(bodies):
        geometry, pose = body if isinstance(body, tuple) and len(body) == 2 else (body, None)
        if not isinstance(geometry, Geometry):
            kind = type(geometry).__name__
            raise LinCannyError(f"body {k} is a {kind} (expected a Geometry, or a tuple of a Geometry and its pose)")
        shown.append(_Shown(repr(geometry).strip("<>"), geometry, _COLORS[k % len(_COLORS)]))
        poses.append(_matrix(pose))
    if not shown:
        raise LinCannyError("there is no body to show")
    text, ends = "", None
    if closest is not None:
        text, ends = repr(closest).strip("<>"), (closest.point_a, closest.point_b)
    return View(shown, [_Frame(np.array(poses), text, ends)])


def pair(a: Geometry, b: Geometry, pose_a: Any, pose_b: Any, closest: Closest) -> View:
    """Return the view of `PairTracker.show`."""
    return show((a, pose_a), (b, pose_b), closest=closest)


def checker(checker: Checker, q: ArrayLike | None = None) -> View:
    """Return the view of `Checker.show`."""
    import numpy as np

    if q is None:
        q = np.clip(0.0, *checker.limits.T)
    rows = np.atleast_2d(np.asarray(q, dtype=np.float64))
    if len(rows) == 0:
        raise LinCannyError("there is no configuration to show")
    ids = checker.ids
    near = [checker.clearance(row) for row in rows]
    lit = near[0].ids if len(rows) == 1 and near[0] is not None else ()
    bodies = [
        _Shown(name, checker.geometry(id), _LIT if id in lit else _OF_KIND[id.kind])
        for name, id in zip(checker.bodies, ids)
    ]
    frames = []
    for row, found in zip(rows, near):
        poses = np.array([checker.pose(id, row) for id in ids]).reshape(-1, 4, 4)
        if found is None:
            frames.append(_Frame(poses, "", None))
        else:
            frames.append(_Frame(poses, repr(found).strip("<>"), (found.point_a, found.point_b)))
    return View(bodies, frames)


def _small(view: View) -> str | None:
    count = sum(len(body.geometry._render_mesh()[0]) for body in view._bodies)
    return view._repr_html_() if count <= _MOST_TRIANGLES else None


def geometry_html(geometry: Geometry) -> str | None:
    """Return the page of a geometry for a notebook."""
    return _small(show(geometry))


def checker_html(given: Checker) -> str | None:
    """Return the page of a checker for a notebook; None if its poses need a time."""
    try:
        return _small(checker(given))
    except LinCannyError:
        return None
