"""Times and errors of two hulls at many poses: this package, the loop in Rust, coal, python-fcl.

    maturin develop --release --features bench
    python bench/pairs.py --rounds 9

Thread CPU time in nanoseconds per query, the least of the rounds, all competitors in turn in every
round. Poses of coal and fcl are converted beforehand and not timed. Errors are against the proven
interval of this package: how far an answer is outside of it.
"""

import argparse
import time
from collections import defaultdict

import numpy as np

import lin_canny as lc

try:
    import coal
except ImportError:
    coal = None
try:
    import fcl
except ImportError:
    fcl = None

clock = time.thread_time
BATCH, SINGLE, SLOW = 100_000, 10_000, 2_000


def sphere_points(rng, count):
    p = rng.normal(size=(count, 3))
    return p / np.linalg.norm(p, axis=1)[:, None]


def matrices(q, at):
    """Return poses, shape (N, 4, 4), of unit quaternions xyzw and positions."""
    x, y, z, w = q.T
    m = np.zeros((len(q), 4, 4))
    m[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], 1)
    m[:, 1, :3] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1)
    m[:, 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1)
    m[:, :3, 3], m[:, 3, 3] = at, 1
    return m


def tumbling(count):
    """Return poses half a degree apart, of bodies that are apart."""
    k = np.arange(count)
    half, axis = np.radians(0.25) * k, np.array([0.3, 0.5, 0.8]) / np.linalg.norm([0.3, 0.5, 0.8])
    q = np.concatenate([np.sin(half)[:, None] * axis, np.cos(half)[:, None]], 1)
    angle = np.radians(0.5) * 0.37 * k
    distance = 2.1 + 0.45 * (1 + np.sin(angle * 0.21))
    around = np.stack([np.cos(angle), np.sin(angle), 0.3 * np.sin(2 * angle)], 1)
    return q, distance[:, None] * around


def random_poses(rng, count, low, high):
    q = rng.normal(size=(count, 4))
    q /= np.linalg.norm(q, axis=1)[:, None]
    return q, sphere_points(rng, count) * rng.uniform(low, high, count)[:, None]


def coal_runs(points, m):
    """Return calls of coal by name, each a function of the output array."""
    bodies = []
    for cloud in points:
        vertices = coal.StdVec_Vec3s()
        for p in cloud:
            vertices.append(p)
        bodies.append(coal.Convex.convexHull(vertices, True, "Qt"))
    here = coal.Transform3s.Identity()
    there = [coal.Transform3s(pose[:3, :3].copy(), pose[:3, 3].copy()) for pose in m]
    runs = {}
    for name, tolerance in (("coal, default", None), ("coal, tolerances 1e-12", 1e-12)):
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess
        if tolerance is not None:
            request.gjk_tolerance = request.epa_tolerance = tolerance
        query = coal.ComputeDistance(*bodies)

        def run(out, query=query, request=request, result=result, keep=bodies):  # `query` does not keep them
            for k, pose in enumerate(there):
                result.clear()
                out[k] = query(here, pose, request, result)
                request.updateGuess(result)

        runs[name] = run
    return runs


def fcl_runs(hulls, m):
    def convex(hull):
        faces = np.concatenate([np.full((len(hull.triangles), 1), 3), hull.triangles], 1)
        return fcl.Convex(hull.vertices, len(hull.triangles), faces.flatten())

    a, b = (fcl.CollisionObject(convex(hull)) for hull in hulls)
    request = fcl.DistanceRequest(enable_signed_distance=True)
    there = [fcl.Transform(pose[:3, :3], pose[:3, 3]) for pose in m[:SLOW]]

    def run(out):
        for k, pose in enumerate(there):
            b.setTransform(pose)
            out[k] = fcl.distance(a, b, request, fcl.DistanceResult())

    return {"python-fcl, default": run}


def timed(call):
    start = clock()
    call()
    return clock() - start


def single_runs(a, b, m, seven):
    tracker = lc.PairTracker()

    def run(call, poses):
        def loop():
            for pose in poses:
                call(a, b, None, pose)

        return loop

    tuples = [(tuple(v[:3].tolist()), tuple(v[3:].tolist())) for v in seven]
    return {
        "one distance, 4x4": run(tracker.distance, list(m)),
        "one distance, tuples": run(tracker.distance, tuples),
        "one closest, 4x4": run(tracker.closest, list(m)),
        "empty loop": run(lambda a, b, c, d: None, list(m)),
    }


def measure(name, q, at, hulls, points, rounds):
    a, b = hulls
    m, seven = matrices(q, at), np.concatenate([at, q], 1)
    first = m[:SINGLE]
    proven = lc.distances(a, b, first)
    others = {}
    if coal:
        others |= coal_runs(points, first)
    if fcl:
        others |= fcl_runs(hulls, first)
    singles = single_runs(a, b, first, seven[:SINGLE])
    least, answers = defaultdict(lambda: float("inf")), {}

    def note(what, seconds, count):
        least[what] = min(least[what], seconds / count * 1e9)

    for _ in range(rounds):
        note("Rust loop", lc._native._rust_loop(a, b, m)[0], BATCH)
        note("Rust loop, first poses", lc._native._rust_loop(a, b, first)[0], SINGLE)
        note("batch (N, 4, 4)", timed(lambda: lc.distances(a, b, m)), BATCH)
        note("batch (N, 7)", timed(lambda: lc.distances(a, b, seven)), BATCH)
        for what, run in singles.items():
            note(what, timed(run), SINGLE)
        for what, run in others.items():
            count = SLOW if "fcl" in what else SINGLE
            answers[what] = np.zeros(count)
            note(what, timed(lambda: run(answers[what])), count)
    report(name, least, answers, proven)


def report(name, least, answers, proven):
    print(f"\n{name}: {np.mean(proven['distance'] <= 0):.0%} of the pairs overlap\n")
    print("| | ns | over the Rust loop | largest error | sign wrong |\n|---|---:|---:|---:|---:|")
    rust, first = least.pop("Rust loop"), least.pop("Rust loop, first poses")
    width = (proven["upper"] - proven["lower"]).max()
    print(f"| Rust loop | {rust:.0f} | | {width:.0e} (proven) | 0 |")
    for what, ns in least.items():
        error = "| |"
        if what in answers:
            d = answers[what]
            p = proven[: len(d)]
            outside = np.maximum(np.maximum(p["lower"] - d, d - p["upper"]), 0).max()
            wrong = np.sum((d > 0) != (p["distance"] > 0))
            error = f"| {outside:.0e} | {wrong} of {len(d)} |"
        over = f"{ns / rust:.2f} times" if what.startswith("batch") else f"{ns - first:+.0f}"
        print(f"| {what} | {ns:.0f} | {over} {error}")


def sizes(rng, points):
    """Print the errors of coal by the size of the bodies."""
    if not coal:
        return
    q, at = random_poses(rng, 3000, 1.5, 2.3)
    print("\n| radius | coal, default: error over size, sign wrong | coal, tolerances 1e-12 |\n|---:|---|---|")
    for size in (1.0, 1e-2, 1e-3, 1e-4):
        scaled, m = [p * size for p in points], matrices(q, at * size)
        proven = lc.distances(*map(lc.Geometry.hull, scaled), m)["distance"]
        cells = []
        for run in coal_runs(scaled, m).values():
            out = np.zeros(len(m))
            run(out)
            error = np.abs(out - proven).max() / size
            cells.append(f"{error:.0e}, {np.sum((out > 0) != (proven > 0))} of {len(m)}")
        print(f"| {size:g} | {' | '.join(cells)} |", flush=True)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--rounds", type=int, default=9)
    rounds = options.parse_args().rounds
    rng = np.random.default_rng(1)
    points = [sphere_points(rng, 128) for _ in range(2)]
    hulls = [lc.Geometry.hull(p) for p in points]
    measure("half a degree a frame, apart", *tumbling(BATCH), hulls, points, rounds)
    measure("random, apart", *random_poses(rng, BATCH, 2.05, 3), hulls, points, rounds)
    measure("random, half overlap", *random_poses(rng, BATCH, 1.5, 2.3), hulls, points, max(rounds // 3, 2))
    sizes(rng, points)


if __name__ == "__main__":
    main()
