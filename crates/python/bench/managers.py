"""Times of `lin_canny.trimesh.CollisionManager` and of trimesh's own manager, which uses python-fcl.

    pip install trimesh python-fcl scipy
    python bench/managers.py --csv managers.csv

Both managers get the same meshes, matrices and calls, in turn in every round. Every frame moves all
objects by `set_transform` and makes one query. Times are microseconds of thread CPU time per frame,
moves included, the least of the rounds. The conversion of the meshes by `add_object` has rows of its
own (`add`).

Scenes: `hulls`, convex hulls of 32 points; `balls`, icospheres of 1,280 triangles; `tori`, meshes of
2,048 triangles, which are not convex. In `near` scenes the objects are about one size apart and a few
pairs overlap; in `far` scenes none does. Columns: scene, objects, call, microseconds of ours and of
FCL, their ratio, and in how many of the frames the answers differ: another bool or another set of
names, or a distance of separated objects that differs by more than 1e-5. The distances of objects
that overlap are not compared: FCL returns the depth of the first overlap that it finds.
"""

import argparse
import csv
import sys
import time

import numpy as np
import trimesh

from lin_canny.trimesh import CollisionManager

try:
    import fcl  # noqa: F401
except ImportError:
    sys.exit("python-fcl is not installed: there is nothing to compare with")

clock = time.thread_time
THEIRS = trimesh.collision.CollisionManager


def meshes(kind, count):
    """Return meshes of radius about one."""
    rng = np.random.default_rng(2)
    if kind == "hulls":
        return [trimesh.convex.convex_hull(rng.normal(size=(32, 3)) * 0.5) for _ in range(count)]
    if kind == "balls":
        return [trimesh.creation.icosphere(subdivisions=3) for _ in range(count)]
    return [trimesh.creation.torus(0.7, 0.3, 32, 32) for _ in range(count)]


def frames(count, objects, spread):
    """Return matrices, shape (count, objects, 4, 4): objects that turn and drift a little per frame."""
    rng = np.random.default_rng(3)
    side = int(np.ceil(objects ** (1 / 3)))
    grid = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3)[:objects]
    axes = rng.normal(size=(objects, 3))
    drift = rng.normal(size=(objects, 3)) * 0.004
    start = rng.random(objects) * 6
    out = np.tile(np.eye(4), (count, objects, 1, 1))
    for k in range(count):
        for j in range(objects):
            matrix = trimesh.transformations.rotation_matrix(start[j] + np.radians(0.5) * k, axes[j])
            matrix[:3, 3] = grid[j] * spread + drift[j] * k
            # What trimesh passes to FCL is in single precision.
            out[k, j] = matrix.astype(np.float32)
    return out


def added(manager, bodies, poses):
    """Return a manager of the bodies, and the microseconds of a body."""
    begin = clock()
    for k, (mesh, pose) in enumerate(zip(bodies, poses, strict=True)):
        manager.add_object(str(k), mesh, pose)
    return manager, 1e6 * (clock() - begin) / len(bodies)


def timed(manager, matrices, query):
    """Return microseconds per frame, and the answers."""
    answers = []
    begin = clock()
    for poses in matrices:
        for k, pose in enumerate(poses):
            manager.set_transform(str(k), pose)
        answers.append(query(manager))
    return 1e6 * (clock() - begin) / len(matrices), answers


def differ(a, b):
    """Return whether two answers differ."""
    if isinstance(a, float) or isinstance(b, float):
        return (a > 0) != (b > 0) or (a > 0 and abs(a - b) > 1e-5)
    return a != b


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3, help="passes of both managers")
    parser.add_argument("--frames", type=int, default=40, help="frames of a scene")
    parser.add_argument("--csv", help="write the rows to this file")
    options = parser.parse_args()
    probe = trimesh.creation.icosphere(subdivisions=2)
    calls = {
        "in_collision_internal": lambda m: m.in_collision_internal(),
        "in_collision_internal(return_names=True)": lambda m: m.in_collision_internal(return_names=True),
        "min_distance_internal": lambda m: float(m.min_distance_internal()),
        "in_collision_single": lambda m: m.in_collision_single(probe),
        "min_distance_single": lambda m: float(m.min_distance_single(probe)),
    }
    table = [("scene", "objects", "call", "ours_us", "fcl_us", "ratio", "differ")]
    for kind, count in (("hulls", 8), ("hulls", 64), ("balls", 8), ("tori", 8), ("tori", 27)):
        bodies = meshes(kind, count)
        for name, spread in (("near", 1.7), ("far", 3.0)):
            scene, matrices = f"{kind} {name}", frames(options.frames, count, spread)
            add = [np.inf, np.inf]
            for _ in range(options.rounds):
                for k, (make, fresh) in enumerate([(CollisionManager, bodies), (THEIRS, bodies)]):
                    copies = [mesh.copy() for mesh in fresh]  # nothing of a mesh is cached
                    add[k] = min(add[k], added(make(), copies, matrices[0])[1])
            rows = [("add_object", *add, 0)]
            for call, query in calls.items():
                least, answers = [np.inf, np.inf], [None, None]
                for _ in range(options.rounds):
                    for k, make in enumerate([CollisionManager, THEIRS]):
                        manager, _ = added(make(), bodies, matrices[0])
                        query(manager)
                        took, answers[k] = timed(manager, matrices, query)
                        least[k] = min(least[k], took)
                rows.append((call, *least, sum(map(differ, *answers))))
            for call, ours, theirs, wrong in rows:
                row = (scene, count, call, f"{ours:.1f}", f"{theirs:.1f}", f"{ours / theirs:.3f}", wrong)
                table.append(row)
                print(f"{row[0]:12}{row[1]:4} {row[2]:42}{row[3]:>10}{row[4]:>11}{row[5]:>8}{row[6]:>4}", flush=True)
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file).writerows(table)


if __name__ == "__main__":
    main()
