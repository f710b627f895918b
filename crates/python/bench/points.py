"""Signed distances of points and a closed mesh: this package, trimesh, Open3D, libigl and embree, with wrong signs.

    pip install trimesh scipy rtree embreex libigl open3d
    python bench/points.py --csv points.csv

A torus of some thousand triangles has its vertices on a lattice of 2^-16, and points are on one of
2^-24. So integers of 64 bits give the exact winding number. Scenes: `near`, a hundredth of the size
from the surface at most; `far`, in twice the box; `path`, steps of a thousandth of the size; `hard`,
on the lattice within one step of vertices, edges and faces. Points on the surface have no sign and
are left out of the count.

Columns: scene, shape, number of triangles, engine, nanoseconds of CPU time of all threads per point
(least of the rounds, after the engine's own preparation), points, and wrong signs. A distance of
zero off the surface is a wrong sign. `embree` finds the sign alone. Open3D takes 32-bit numbers, to
which the points and the mesh are rounded. Engines that are not installed are left out, and trimesh
gets the first thousand points of a scene.
"""

import argparse
import csv
import sys
import time

import numpy as np

clock = time.process_time
COARSE, FINE = 2.0**-16, 2.0**-24
SLOW = {"trimesh": 1000, "embree": 1000}


def torus(count):
    """Return vertices in steps of 2^-16 and triangles of a torus, about `count` of them."""
    m = int(np.sqrt(count / 4))
    n = 2 * m
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    r = 1 + 0.35 * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), 0.35 * np.sin(v)], 1)
    a, b, c, d = ((i + x) % n * m + (j + y) % m for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.rint(vertices / COARSE).astype(np.int64), triangles


def points_of(scene, rng, vertices, triangles, count):
    """Return points in steps of 2^-24, int64, shape (count, 3)."""
    corners = vertices[triangles[rng.integers(len(triangles), size=count)]]
    if scene == "far":
        found = rng.uniform(-2.7, 2.7, size=(count, 3))
    elif scene == "path":
        steps = rng.normal(size=(count, 3))
        steps *= 1e-3 / np.linalg.norm(steps, axis=1)[:, None]
        found = vertices[0] * COARSE + np.cumsum(steps, axis=0)
    elif scene == "near":
        x, y = rng.uniform(0, 0.5, size=(2, count, 1))
        foot = corners[:, 0] * x + corners[:, 1] * y + corners[:, 2] * (1 - x - y)
        off = rng.normal(size=(count, 3))
        found = foot * COARSE + off * (rng.uniform(0, 0.01, size=(count, 1)) / np.linalg.norm(off, axis=1)[:, None])
    else:
        # Weights in sixteenths, so the foot is on the lattice.
        x = rng.integers(0, 17, size=(count, 1))
        y = np.where(rng.random((count, 1)) < 0.5, 16 - x, rng.integers(0, 17 - x))
        foot = 16 * (corners[:, 0] * x + corners[:, 1] * y + corners[:, 2] * (16 - x - y))
        return foot + rng.integers(-1, 2, size=(count, 3))
    return np.rint(found / FINE).astype(np.int64)


def truth(vertices, triangles, points):
    """Return -1 inside, 1 outside and 0 on the surface, by exact crossings of rays along x."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    limit = 3 * int(np.abs(normals).max()) * int(np.abs(points).max() + 256 * np.abs(vertices).max())
    assert limit < 2**63, "a product does not fit 64 bits"
    low = 256 * np.minimum(np.minimum(a, b), c)[:, 1:]
    high = 256 * np.maximum(np.maximum(a, b), c)[:, 1:]

    def turns(p, at):
        out = []
        for x, y in ((a, b), (b, c), (c, a)):
            edge, off = (y - x)[at, 1:], p[1:] - 256 * x[at, 1:]
            turn = np.sign(edge[:, 0] * off[:, 1] - edge[:, 1] * off[:, 0])
            # The point is moved by (0, e, e^2) for an infinitely small e.
            moved = np.where(edge[:, 1] != 0, -np.sign(edge[:, 1]), np.sign(edge[:, 0]))
            out.append(np.where(turn != 0, turn, moved))
        return np.array(out)

    def is_on(p, at):
        for t in at:
            k = int(np.flatnonzero(normals[t])[0])
            i, j = (k + 1) % 3, (k + 2) % 3
            way = np.sign(normals[t, k])
            edges = ((a[t], b[t]), (b[t], c[t]), (c[t], a[t]))
            area = [(y - x)[i] * (p - 256 * x)[j] - (y - x)[j] * (p - 256 * x)[i] for x, y in edges]
            if all(x * way >= 0 for x in area):
                return True
        return False

    signs = np.empty(len(points), np.int64)
    for index, p in enumerate(points):
        at = np.flatnonzero((low[:, 0] <= p[1]) & (p[1] <= high[:, 0]) & (low[:, 1] <= p[2]) & (p[2] <= high[:, 1]))
        height = np.einsum("ij,ij->i", normals[at], p - 256 * a[at])
        if is_on(p, at[height == 0]):
            signs[index] = 0
            continue
        way = np.sign(normals[at, 0])
        crossed = (np.sign(height) == -way) & np.all(turns(p, at) == way, axis=0)
        signs[index] = 1 if (way * crossed).sum() == 0 else -1
    return signs


def ours(vertices, triangles):
    import lin_canny as lc

    geometry = lc.Geometry.mesh(vertices, triangles)
    return lambda points: lc.signed_distance(geometry, points)


def of_trimesh(vertices, triangles):
    import trimesh

    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    return lambda points: -trimesh.proximity.signed_distance(mesh, points)


def of_embree(vertices, triangles):
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    caster = RayMeshIntersector(trimesh.Trimesh(vertices, triangles, process=False))
    return lambda points: np.where(caster.contains_points(points), -1.0, 1.0)


def of_open3d(vertices, triangles):
    import open3d

    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(vertices.astype(np.float32), triangles.astype(np.uint32))
    return lambda points: scene.compute_signed_distance(points.astype(np.float32), nthreads=1).numpy()


def of_libigl(kind):
    def build(vertices, triangles):
        import igl

        sign = getattr(igl, f"SIGNED_DISTANCE_TYPE_{kind}", None)
        faces = triangles.astype(np.int64)
        return lambda points: np.asarray(igl.signed_distance(points, vertices, faces, sign_type=sign)[0]).ravel()

    return build


ENGINES = {
    "ours-batch": ours,
    "trimesh": of_trimesh,
    "embree": of_embree,
    "open3d": of_open3d,
    "libigl pseudonormal": of_libigl("PSEUDONORMAL"),
    "libigl fast winding": of_libigl("FAST_WINDING_NUMBER"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000, 100_000], help="numbers of triangles")
    parser.add_argument("--points", type=int, default=20_000, help="points per scene")
    parser.add_argument("--rounds", type=int, default=3, help="passes of every engine")
    parser.add_argument("--csv", help="output file (default: the standard output)")
    options = parser.parse_args()
    out = csv.writer(open(options.csv, "w") if options.csv else sys.stdout, lineterminator="\n")
    out.writerow(["scene", "shape", "n", "engine", "ns", "points", "wrong"])
    for size in options.sizes:
        steps, triangles = torus(size)
        calls = {}
        for name, build in ENGINES.items():
            try:
                calls[name] = build(steps * COARSE, triangles)
            except ImportError as error:
                print(f"{name} is left out: {error}", file=sys.stderr)
        for scene in ("near", "far", "path", "hard"):
            asked = points_of(scene, np.random.default_rng(7), steps, triangles, options.points)
            signs = truth(steps, triangles, asked)
            for name, call in calls.items():
                count = min(len(asked), SLOW.get(name, len(asked)))
                points, best = asked[:count] * FINE, np.inf
                for _ in range(options.rounds):
                    start = clock()
                    found = call(points)
                    best = min(best, clock() - start)
                sure = signs[:count] != 0
                wrong = int((np.sign(found) != signs[:count])[sure].sum())
                out.writerow([scene, "torus", len(triangles), name, f"{1e9 * best / count:.1f}", count, wrong])


if __name__ == "__main__":
    main()
