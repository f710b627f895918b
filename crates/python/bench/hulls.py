"""Times of the convex hull of points: this package and qhull (scipy).

    pip install scipy
    python bench/hulls.py --rounds 3

Thread CPU time in milliseconds, the least of the rounds, both engines in turn in every round. Our
constructor builds the body that queries take, with its edges and neighbours; qhull returns facets.
"""

import argparse
import time

import numpy as np
from scipy.spatial import ConvexHull

import lin_canny as lc

clock = time.thread_time


def clouds(rng, count):
    """Yield names and points of radius about one."""
    sphere = rng.normal(size=(count, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    yield "sphere", sphere
    yield "ball", sphere * rng.random((count, 1)) ** (1 / 3)
    yield "cube", rng.uniform(-1, 1, (count, 3))
    yield "flat", sphere * [1, 1, 1e-3]


def least(rounds, calls):
    """Return the least milliseconds of each call."""
    times = [np.inf] * len(calls)
    for _ in range(rounds):
        for k, call in enumerate(calls):
            begin = clock()
            call()
            times[k] = min(times[k], 1e3 * (clock() - begin))
    return times


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3, help="passes of both engines")
    parser.add_argument("--upto", type=int, default=1_000_000, help="no more points than these")
    options = parser.parse_args()
    print(f"{'points':8}{'n':>9}{'ours ms':>10}{'qhull ms':>10}{'/qhull':>8}{'vertices':>10}{'qhull':>10}")
    rng = np.random.default_rng(7)
    for count in [n for n in (1_000, 10_000, 100_000, 1_000_000) if n <= options.upto]:
        for name, points in clouds(rng, count):
            ours, theirs = least(options.rounds, [lambda: lc.Geometry.hull(points), lambda: ConvexHull(points)])
            kept = len(lc.Geometry.hull(points).vertices), len(ConvexHull(points).vertices)
            print(f"{name:8}{count:9}{ours:10.2f}{theirs:10.2f}{ours / theirs:8.2f}{kept[0]:10}{kept[1]:10}", flush=True)


if __name__ == "__main__":
    main()
