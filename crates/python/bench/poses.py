"""What each form of a pose costs in a single call, over the loop in Rust.

    maturin develop --release --features bench
    python bench/poses.py

Nanoseconds of thread CPU time, the least of the rounds, all forms in turn in every round.
"""

from collections import defaultdict

import numpy as np
from pairs import matrices, sphere_points, timed, tumbling

import lin_canny as lc

COUNT, ROUNDS = 5_000, 15


def forms(m, seven):
    """Return the poses in every form, by name."""
    found = {
        "4x4 array": list(m),
        "array of seven": list(seven),
        "tuple of tuples": [(tuple(v[:3].tolist()), tuple(v[3:].tolist())) for v in seven],
        "tuple of arrays": [(v[:3].copy(), v[3:].copy()) for v in seven],
        "tuple of lists": [(v[:3].tolist(), v[3:].tolist()) for v in seven],
        "4x4 array of float32": [pose.astype(np.float32) for pose in m],
        "nested list 4x4": m.tolist(),
    }
    try:
        import pinocchio as pin

        found["`pinocchio.SE3`"] = [pin.SE3(pose) for pose in m]
    except ImportError:
        pass
    try:
        from scipy.spatial.transform import Rotation

        found["(array, scipy `Rotation`)"] = [(v[:3].copy(), Rotation.from_quat(v[3:])) for v in seven]
    except ImportError:
        pass
    return found


def main():
    rng = np.random.default_rng(1)
    a, b = (lc.Geometry.hull(sphere_points(rng, 128)) for _ in range(2))
    q, at = tumbling(COUNT)
    m, least = matrices(q, at), defaultdict(lambda: float("inf"))
    every, call = forms(m, np.concatenate([at, q], 1)), lc.PairTracker().distance

    def loop(poses):
        for pose in poses:
            call(a, b, None, pose)

    for _ in range(ROUNDS):
        least["Rust"] = min(least["Rust"], lc._native._rust_loop(a, b, m)[0])
        for name, poses in every.items():
            least[name] = min(least[name], timed(lambda: loop(poses)))
    for name in every:
        print(f"| {name} | {(least[name] - least['Rust']) / COUNT * 1e9:+.0f} |")


if __name__ == "__main__":
    main()
