"""Plots with matplotlib."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING, Any

import numpy as np

from ._native import Checker, LinCannyError, PlanError, Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["plot_clearance"]

# Change of a distance below which a pair counts as rigid, and is not drawn.
_RIGID = 1e-6


def _nearest(
    checker: Checker, times: NDArray[np.float64], rows: NDArray[np.float64], pairs: int
) -> NDArray[Any]:
    """Return the nearest pairs of each row, with obstacles that move where they are at its time."""
    if checker.time is None:
        try:
            return checker.nearest_batch(rows, pairs)
        except PlanError:  # an obstacle moves
            pass
    timed: Checker = pickle.loads(pickle.dumps(checker))
    found = []
    for time, row in zip(times, rows):
        timed.time = time
        found.append(timed.nearest_batch(row[None], pairs))
    return np.concatenate(found)


def plot_clearance(
    checker: Checker,
    motion: Trajectory | ArrayLike,
    *,
    pairs: int = 8,
    samples: int = 1001,
    axes: Any = None,
) -> Any:
    """Draw the distances of the closest pairs along a motion, and what is proven of each segment.

    The lines are samples. The black bars are lower bounds of the distance of all pairs over a whole
    segment, of pairs whose distance does not change too: `checker.exclude` leaves them out. Such
    pairs have no line. Obstacles that move are where they are at the times of the motion. Call
    `axes.legend()` for the names. Needs matplotlib.

    Parameters
    ----------
    checker : Checker
    motion : Trajectory, or array_like of shape (K, dof)
        A path has segments from one time to the next of 0, 1, 2, ...
    pairs : int
        How many of the closest pairs each sample may add.
    samples : int
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    if axes is None:
        import matplotlib.pyplot as plt

        axes = plt.subplots(figsize=(8, 3.5), layout="constrained")[1]
    if not isinstance(motion, Trajectory):
        path = np.asarray(motion, dtype=np.float64)
        if path.ndim != 2 or len(path) < 2:
            raise LinCannyError(
                f"motion: shape is {path.shape} (expected a Trajectory, or (K, dof) with K of at least 2)"
            )
        motion = Trajectory(np.arange(len(path)), path)
    times = np.linspace(motion.times[0], motion.times[-1], samples)
    curves = motion.curves(checker)
    # The segment of each sample, and its configuration in the order of the checker.
    segments = np.clip(np.searchsorted(motion.times, times, side="right") - 1, 0, len(curves) - 1)
    rows = np.empty((samples, checker.dof))
    for k, curve in enumerate(curves):
        chosen = segments == k
        start, end = motion.times[k], motion.times[min(k + 1, len(motion.times) - 1)]
        rows[chosen] = curve.at(np.clip((times[chosen] - start) / max(end - start, 1e-300), 0, 1))
    near = _nearest(checker, times, rows, pairs)
    for a, b in sorted({(a, b) for a, b in zip(near["a"].ravel(), near["b"].ravel()) if a >= 0}):
        # NaN where other pairs are closer.
        each = np.where((near["a"] == a) & (near["b"] == b), near["distance"], np.nan)
        distance = np.nanmin(each, axis=1, initial=np.inf, where=~np.isnan(each))
        distance[np.isinf(distance)] = np.nan
        if np.nanmax(distance) - np.nanmin(distance) > _RIGID:
            axes.plot(times, distance, label=f"{checker.bodies[a]} - {checker.bodies[b]}")
    for k, curve in enumerate(curves):
        lower = checker.clearance_along_curve(curve)[0]
        label = "lower bound of all pairs" if k == 0 else None
        axes.plot(motion.times[k : k + 2], [lower, lower], color="black", linewidth=2, label=label)
    axes.set(xlabel="time", ylabel="distance")
    axes.set_ylim(min(0.0, axes.get_ylim()[0]), None)
    return axes
