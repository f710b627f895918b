"""Signed distances of points and a closed mesh: this package, trimesh, Open3D, libigl and embree, with wrong signs.

    pip install trimesh scipy rtree embreex libigl open3d
    python bench/points.py --csv points.csv             # about half an hour
    python bench/points.py --quick --csv points.csv     # fewer points
    python bench/points.py --quick --damage both        # of a mesh with holes and inverted triangles

A torus of 1,000, 100,000 and 1,000,000 triangles has its vertices on a lattice of 2^-16, and points
are on one of 2^-24. So integers of 64 bits give the exact winding number. Scenes: `near`, a hundredth
of the size from the surface at most; `far`, in twice the box; `path`, steps of a thousandth of the
size; `hard`, on the lattice within one step of vertices, edges and faces. Points on the surface have
no sign and are left out of the count.

Columns: scene, shape, number of triangles, engine, nanoseconds of CPU time of all threads per point
(least of the rounds, after the engine's own preparation), points, and wrong signs. A distance of
zero off the surface is a wrong sign. libigl makes its tree in every call, which is counted. `embree` and `ours contains` find the sign alone. Open3D takes
32-bit numbers, to which the points and the mesh are rounded.

`--damage` takes triangles that share no vertex away (`lost`), inverts them (`turned`), or does one or the other
(`both`); `patch` takes away connected triangles. The true sign is that of the whole torus. `ours` repairs the mesh first.

Each engine works in a separate process, which ends after `--limit` seconds for each mesh; slow
engines get fewer points, the first of the scene. The script prints what it leaves out, and why.
"""

import argparse
import csv
import multiprocessing
import sys
import time

import numpy as np

clock = time.process_time
COARSE, FINE = 2.0**-16, 2.0**-24
SCENES = ("near", "far", "path", "hard")
TRIED = 32
"""Points of the first calls; each next one has four times as many, until the time of a pass is used up."""


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


def damaged(kind, triangles, share, rng):
    """Return the triangles with a share of them lost or inverted."""
    count = max(1, int(share * len(triangles)))
    if kind == "patch":
        # Rows of a torus: neighbours have numbers near each other.
        first = rng.integers(len(triangles) // 2 - count)
        return np.delete(triangles, slice(first, first + count), axis=0)
    used, chosen = set(), []
    for t in rng.permutation(len(triangles)):
        corners = set(triangles[t].tolist())
        if len(chosen) < count and not used & corners:
            used |= corners
            chosen.append(t)
    is_turned = {"lost": 0.0, "turned": 1.0, "both": 0.5}[kind] > rng.random(len(chosen))
    found, chosen = triangles.copy(), np.array(chosen)
    turned = chosen[is_turned]
    found[turned] = found[turned][:, ::-1]
    return np.delete(found, chosen[~is_turned], axis=0)


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


class Columns:
    """The boxes of triangles in y and z, by the cells of a grid."""

    def __init__(self, low, high):
        self.origin = low.min(axis=0)
        self.side = int((high.max(axis=0) - self.origin).max()) // max(1, int(np.sqrt(len(low)) / 2)) + 1
        first, last = self.cell(low), self.cell(high)
        self.count = last.max(axis=0) + 1
        keys, items = [], []
        for i in range(int((last - first)[:, 0].max()) + 1):
            for j in range(int((last - first)[:, 1].max()) + 1):
                held = np.flatnonzero(np.all(first + [i, j] <= last, axis=1))
                keys.append((first[held, 0] + i) * self.count[1] + first[held, 1] + j)
                items.append(held)
        keys, items = np.concatenate(keys), np.concatenate(items)
        order = np.argsort(keys, kind="stable")
        self.items = items[order]
        self.start = np.searchsorted(keys[order], np.arange(self.count.prod() + 1))

    def cell(self, p):
        return (p - self.origin) // self.side

    def at(self, p):
        """Return the triangles whose boxes may hold a point, in ascending order."""
        cell = self.cell(p)
        if np.any(cell < 0) or np.any(cell >= self.count):
            return self.items[:0]
        key = cell[0] * self.count[1] + cell[1]
        return np.sort(self.items[self.start[key] : self.start[key + 1]])


def truth(vertices, triangles):
    """Return a function of points: -1 inside, 1 outside, 0 on the surface, by exact crossings of rays along x."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    most = 256 * int(np.abs(vertices).max())
    low = 256 * np.minimum(np.minimum(a, b), c)[:, 1:]
    high = 256 * np.maximum(np.maximum(a, b), c)[:, 1:]
    columns = Columns(low, high)

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

    def signs_of(points):
        limit = 3 * int(np.abs(normals).max()) * (int(np.abs(points).max()) + most)
        assert limit < 2**63, "a product does not fit 64 bits"
        signs = np.empty(len(points), np.int64)
        for index, p in enumerate(points):
            at = columns.at(p[1:])
            at = at[np.all((low[at] <= p[1:]) & (p[1:] <= high[at]), axis=1)]
            height = np.einsum("ij,ij->i", normals[at], p - 256 * a[at])
            if is_on(p, at[height == 0]):
                signs[index] = 0
                continue
            way = np.sign(normals[at, 0])
            crossed = (np.sign(height) == -way) & np.all(turns(p, at) == way, axis=0)
            signs[index] = 1 if (way * crossed).sum() == 0 else -1
        return signs

    return signs_of


def ours(vertices, triangles):
    import lin_canny as lc

    geometry = lc.Geometry.repaired_mesh(vertices, triangles)
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


def sides(vertices, triangles):
    import lin_canny as lc

    geometry = lc.Geometry.repaired_mesh(vertices, triangles)
    return lambda points: np.where(lc.contains(geometry, points), -1.0, 1.0)


ENGINES = {
    "ours-batch": ours,
    "ours contains": sides,
    "trimesh": of_trimesh,
    "embree": of_embree,
    "open3d": of_open3d,
    "libigl pseudonormal": of_libigl("PSEUDONORMAL"),
    "libigl fast winding": of_libigl("FAST_WINDING_NUMBER"),
    "libigl winding": of_libigl("WINDING_NUMBER"),
}


def work(pipe, name, vertices, triangles, scenes, rounds, budget):
    """Answer all scenes by one engine; send scene, nanoseconds per point, points and signs of each."""
    try:
        call = ENGINES[name](vertices, triangles)
        for scene, points in scenes.items():
            call(points[:TRIED])  # an engine may prepare in its first call
            count, pass_time = TRIED, 0.0
            while count < len(points) and 4 * pass_time <= budget / rounds:
                start = clock()
                call(points[:count])
                pass_time = clock() - start
                if 4 * pass_time <= budget / rounds:
                    count = min(4 * count, len(points))
            points, best = points[:count], np.inf
            for _ in range(rounds):
                start = clock()
                found = call(points)
                best = min(best, clock() - start)
            pipe.send((scene, 1e9 * best / count, np.sign(found)))
    except Exception as error:  # an engine that fails is left out
        pipe.send(f"{type(error).__name__}: {error}")
    pipe.send(None)


def answers(name, mesh, scenes, options, limit):
    """Return the rows of an engine: scene, nanoseconds and signs; say why rows are missing."""
    here, there = multiprocessing.Pipe(duplex=False)
    budget = options.limit / (3 * len(scenes))
    process = multiprocessing.Process(target=work, args=(there, name, *mesh, scenes, options.rounds, budget))
    process.start()
    there.close()
    end, rows, why = time.monotonic() + limit, [], f"not done after {limit:.0f} s"
    while here.poll(max(0.0, end - time.monotonic())):
        try:
            told = here.recv()
        except EOFError:
            why = "its process ended"
            break
        if told is None:
            break
        if isinstance(told, str):
            why = told
        else:
            rows.append(told)
    process.kill()
    process.join()
    left = [scene for scene in scenes if scene not in [row[0] for row in rows]]
    if left:
        print(f"{name}, {len(mesh[1])} triangles: {', '.join(left)} left out: {why}", file=sys.stderr)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="4,000 points, 2 rounds, 24 s an engine and mesh, 330 s in all")
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000, 100_000, 1_000_000], help="numbers of triangles")
    parser.add_argument("--points", type=int, help="points per scene")
    parser.add_argument("--rounds", type=int, help="passes of every engine")
    parser.add_argument("--limit", type=float, help="seconds of an engine on one mesh")
    parser.add_argument("--total", type=float, help="seconds in all, after which engines are left out")
    parser.add_argument("--engines", nargs="+", choices=list(ENGINES), default=list(ENGINES))
    parser.add_argument("--damage", choices=["lost", "turned", "both", "patch"], help="faults of the mesh")
    parser.add_argument("--share", type=float, default=0.01, help="share of triangles with a fault")
    parser.add_argument("--csv", help="output file (default: the standard output)")
    options = parser.parse_args()
    defaults = (4000, 2, 24.0, 330.0) if options.quick else (20_000, 3, 100.0, 3600.0)
    for name, value in zip(("points", "rounds", "limit", "total"), defaults):
        if getattr(options, name) is None:
            setattr(options, name, value)
    multiprocessing.set_start_method("spawn")
    end = time.monotonic() + options.total
    file = open(options.csv, "w") if options.csv else sys.stdout
    out = csv.writer(file, lineterminator="\n")
    out.writerow(["scene", "shape", "n", "engine", "ns", "points", "wrong"])
    for size in options.sizes:
        if time.monotonic() > end:
            print(f"{size} triangles are left out: not done after {options.total:g} s", file=sys.stderr)
            continue
        steps, triangles = torus(size)
        rng = np.random.default_rng(7)
        asked = {scene: points_of(scene, rng, steps, triangles, options.points) for scene in SCENES}
        signs_of = truth(steps, triangles)
        signs = {scene: signs_of(points) for scene, points in asked.items()}
        scenes = {scene: points * FINE for scene, points in asked.items()}
        shape = "torus"
        if options.damage:
            triangles = damaged(options.damage, triangles, options.share, rng)
            shape = f"torus {100 * options.share:g} % {options.damage}"
        mesh = (steps * COARSE, triangles)
        for name in options.engines:
            limit = min(options.limit, max(0.0, end - time.monotonic()))
            for scene, ns, found in answers(name, mesh, scenes, options, limit):
                true = signs[scene][: len(found)]
                wrong = int((found != true)[true != 0].sum())
                out.writerow([scene, shape, len(triangles), name, f"{ns:.1f}", len(found), wrong])
                file.flush()


if __name__ == "__main__":
    main()
