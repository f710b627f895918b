"""Pictures for notebooks and browsers: one HTML page that holds everything and needs no network."""

from __future__ import annotations

import html
import itertools
import os
import pathlib
from typing import TYPE_CHECKING, Any, NamedTuple

from ._native import Checker, Closest, Geometry, LinCannyError, PairTracker, Scene, _page

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

__all__ = ["View", "show"]

# Triangles beyond which a notebook shows the text of an object alone; `show` draws any number.
_MOST_TRIANGLES = 100_000
_OF_KIND = {"robot": (92, 138, 199), "attached": (237, 158, 77), "obstacle": (184, 184, 179)}
_LIT = (242, 115, 102)


class _Shown(NamedTuple):
    """A body; without a color it has one of a palette."""

    name: str
    geometry: Geometry
    color: tuple[int, int, int] | None = None


class _Frame(NamedTuple):
    """A pose for each body, shape (N, 4, 4), a text, two bodies whose closest points are shown, and a line."""

    poses: NDArray[np.float64]
    text: str = ""
    pair: tuple[int, int] | None = None
    line: Any = None


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
        return self._html(None) or ""

    def _html(self, most: int | None) -> str | None:
        title = ", ".join(body.name for body in self._bodies)[:80]
        frames = [(list(f.poses), f.text, f.pair, None if f.line is None else list(f.line)) for f in self._frames]
        return _page(title, self._bodies, frames, most)

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
        return _framed(self.html())

    def __repr__(self) -> str:
        frames = f", {len(self._frames)} frames" if len(self._frames) > 1 else ""
        return f"<View: {len(self._bodies)} bodies{frames}>"


def _framed(page: str) -> str:
    page = html.escape(page, quote=True)
    return f'<iframe srcdoc="{page}" style="width: 100%; height: 420px; border: 1px solid #ccc"></iframe>'


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
        shown.append(_Shown(repr(geometry).strip("<>"), geometry))
        poses.append(_matrix(pose))
    if not shown:
        raise LinCannyError("there is no body to show")
    frame = _Frame(np.array(poses))
    if closest is not None:
        ends = np.array([closest.point_a, closest.point_b])
        of = _pair_of(ends, shown, poses)
        frame = frame._replace(text=repr(closest).strip("<>"), pair=of, line=None if of else ends)
    return View(shown, [frame])


def _pair_of(ends: NDArray[np.float64], shown: list[_Shown], poses: list[Any]) -> tuple[int, int] | None:
    """Return the two bodies with these closest points, or None."""
    import numpy as np

    for a, b in itertools.combinations(range(len(shown)), 2):
        for i, j in ((a, b), (b, a)):
            found = PairTracker().closest(shown[i].geometry, shown[j].geometry, poses[i], poses[j])
            if np.allclose(ends, [found.point_a, found.point_b]):
                return i, j
    return None


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
            frames.append(_Frame(poses))
        else:
            a, b = (ids.index(id) for id in found.ids)
            frames.append(_Frame(poses, repr(found).strip("<>"), (a, b)))
    return View(bodies, frames)


def _small(view: View) -> str | None:
    page = view._html(_MOST_TRIANGLES)
    return None if page is None else _framed(page)


def geometry_html(geometry: Geometry) -> str | None:
    """Return the page of a geometry for a notebook."""
    return _small(show(geometry))


def checker_html(given: Checker) -> str | None:
    """Return the page of a checker for a notebook; None if its poses need a time."""
    try:
        return _small(checker(given))
    except LinCannyError:
        return None
