"""Plots with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._native import Checker, LinCannyError, Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["plot_clearance"]

# Change of a distance below which a pair counts as rigid, and is not drawn.
_RIGID = 1e-6


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
    segment. Pairs whose distance does not change are not drawn. Needs matplotlib; obstacles that
    move need a time, and are a PlanError.

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
    import numpy as np

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
    near = checker.nearest_batch(motion.at(times), pairs)
    for a, b in sorted({(a, b) for a, b in zip(near["a"].ravel(), near["b"].ravel()) if a >= 0}):
        # NaN where other pairs are closer.
        each = np.where((near["a"] == a) & (near["b"] == b), near["distance"], np.nan)
        distance = np.nanmin(each, axis=1, initial=np.inf, where=~np.isnan(each))
        distance[np.isinf(distance)] = np.nan
        if np.nanmax(distance) - np.nanmin(distance) > _RIGID:
            axes.plot(times, distance, label=f"{checker.bodies[a]} - {checker.bodies[b]}")
    for k, curve in enumerate(motion.curves(checker)):
        lower = checker.clearance_along_curve(curve)[0]
        label = "proven of all pairs" if k == 0 else None
        axes.plot(motion.times[k : k + 2], [lower, lower], color="black", linewidth=2, label=label)
    axes.set(xlabel="time", ylabel="distance", ylim=(0, None))
    return axes
