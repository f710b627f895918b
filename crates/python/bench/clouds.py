"""A moving hull over a cloud of points: this package and coal, with wrong verdicts against numpy.

    pip install coal
    python bench/clouds.py --csv clouds.csv

A hull of 32 vertices, 0.1 in radius, moves by half a degree (4 mm) per frame over points of a depth
camera: a floor, a wall and three balls. Two bodies of the same points are compared:

* `balls`: a ball of 2 mm at every point. coal has no tree of balls, so it takes the octree of the
  points with cells of 4 mm: another body, whose verdicts may differ where the hull is within 4 mm.
* `voxels`: the occupied cells of a grid of 2 cm. The octree of coal is the same body. So is the
  surface of its BVH of 12 triangles per cell, which has no inside.

Scenes: `build`, from the points; `tracked`, the signed distance at every frame; `cold`, the same
without any cached state; `collide`, the predicate at every frame. coal caches the first guess of its
solver in `tracked`, and nothing else. Columns: scene, shape, number of points or cells, engine,
microseconds of thread CPU time (least of the rounds), and the frames with a wrong verdict: the sign
of the distance, or the predicate, against all elements by numpy. Frames within 1e-9 are left out.
"""

import argparse
import csv
import sys
import time

import numpy as np

import lin_canny as lc

try:
    import coal
except ImportError:
    coal = None

clock = time.thread_time
RADIUS, SIDE = 0.002, 0.02


def depth_camera(rng, count):
    """Return points of a floor, a wall and three balls with noise of 1 mm, float32."""
    share = count // 5
    floor = np.stack([rng.uniform(-1, 1, share), rng.uniform(-1, 1, share), np.zeros(share)], 1)
    wall = np.stack([rng.uniform(-1, 1, share), np.ones(share), rng.uniform(0, 1, share)], 1)
    parts = [floor, wall]
    for k, middle in enumerate(([0.4, 0, 0.15], [-0.3, 0.3, 0.2], [0, -0.5, 0.1])):
        n = rng.normal(size=(count - 4 * share if k == 2 else share, 3))
        parts.append(np.array(middle) + 0.15 * n / np.linalg.norm(n, axis=1)[:, None])
    return (np.concatenate(parts) + rng.normal(scale=0.001, size=(count, 3))).astype(np.float32)


def frames(count):
    """Return poses, shape (count, 4, 4), half a degree apart, on a path of 4 mm per frame."""
    k = np.arange(count)
    axis = np.array([0.3, 0.5, 0.8]) / np.linalg.norm([0.3, 0.5, 0.8])
    x = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    angle, along = np.radians(0.5) * k, 0.004 / 0.55 * k
    m = np.tile(np.eye(4), (count, 1, 1))
    m[:, :3, :3] += np.sin(angle)[:, None, None] * x + (1 - np.cos(angle))[:, None, None] * (x @ x)
    height = 0.16 + 0.06 * np.sin(0.05 * k)
    m[:, :3, 3] = np.stack([0.55 * np.cos(along), 0.55 * np.sin(along), height], 1)
    return m


def below(points, hull):
    """Return how far points are above the highest face plane of a hull, and the distance to its triangles."""
    v, t = hull.vertices, hull.triangles
    a, b, c = (v[t[:, k]] for k in range(3))
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=1)[:, None]
    height = points @ n.T - np.einsum("ij,ij->i", n, a)
    gap = np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        for start, way in zip(p, q - p, strict=True):
            s = np.clip((points - start) @ way / (way @ way), 0, 1)
            gap = np.minimum(gap, np.linalg.norm(points - start - s[:, None] * way, axis=1))
    for k in range(len(t)):
        foot = points - height[:, k : k + 1] * n[k]
        sides = [np.cross(q - p, foot - p) @ n[k] >= 0 for p, q in ((a[k], b[k]), (b[k], c[k]), (c[k], a[k]))]
        gap = np.where(np.logical_and.reduce(sides), np.minimum(gap, np.abs(height[:, k])), gap)
    return height.max(axis=1), gap


def gap_of_balls(points, hull, pose):
    """Return the signed gap of balls and a hull by brute force; overlaps are only negative."""
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    local = local[np.linalg.norm(local, axis=1) < 0.15]
    if not len(local):
        return np.inf
    height, gap = below(local, hull)
    return np.where(height <= 0, -1.0, gap - RADIUS).min()


def gap_of_boxes(centres, hull, pose):
    """Return the largest separation of boxes and a hull along all axes of the separating axis theorem."""
    near = centres[np.linalg.norm(centres - pose[:3, 3], axis=1) < 0.15]
    if not len(near):
        return np.inf
    v, t = hull.vertices @ pose[:3, :3].T + pose[:3, 3], hull.triangles
    normals = np.cross(v[t[:, 1]] - v[t[:, 0]], v[t[:, 2]] - v[t[:, 0]])
    edges = np.concatenate([v[t[:, k]] - v[t[:, k - 1]] for k in range(3)])
    crossed = np.cross(edges[:, None], np.eye(3)[None]).reshape(-1, 3)
    axes = np.concatenate([np.eye(3), normals, crossed])
    axes = axes[np.linalg.norm(axes, axis=1) > 1e-12]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    low, high = (v @ axes.T).min(axis=0), (v @ axes.T).max(axis=0)
    middle, reach = near @ axes.T, SIDE / 2 * np.abs(axes).sum(axis=1)
    return np.maximum(low - (middle + reach), (middle - reach) - high).max(axis=1).min()


def mesh_of_cells(centres):
    """Return the triangles of all boxes as a BVH of coal."""
    box = lc.Geometry.box(SIDE / 2, SIDE / 2, SIDE / 2)
    model = coal.BVHModelOBBRSS()
    model.beginModel(12 * len(centres), 8 * len(centres))
    vertices = (centres[:, None] + box.vertices).reshape(-1, 3)
    triangles = (8 * np.arange(len(centres))[:, None, None] + box.triangles).reshape(-1, 3)
    model.addVertices(vertices)
    model.addTriangles(triangles)
    model.endModel()
    return model


def of_ours(cloud, hull, poses):
    """Return calls by scene, each of which answers all frames."""

    def tracked():
        tracker = lc.PairTracker()
        return [tracker.distance(cloud, hull, None, pose) for pose in poses]

    def cold():
        return [lc.PairTracker().distance(cloud, hull, None, pose) for pose in poses]

    def collide():
        tracker = lc.PairTracker()
        return [tracker.intersects(cloud, hull, None, pose) for pose in poses]

    return {"tracked": tracked, "cold": cold, "collide": collide}


def of_coal(body, convex, poses):
    here = coal.Transform3s.Identity()
    there = [coal.Transform3s(pose[:3, :3].copy(), pose[:3, 3].copy()) for pose in poses]

    def distances(is_tracked):
        request, result, out = coal.DistanceRequest(), coal.DistanceResult(), []
        request.gjk_tolerance = request.epa_tolerance = 1e-12
        if is_tracked:
            request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess
        for pose in there:
            result.clear()
            out.append(coal.distance(body, here, convex, pose, request, result))
            if is_tracked:
                request.updateGuess(result)
        return out

    def collide():
        request, result, out = coal.CollisionRequest(), coal.CollisionResult(), []
        for pose in there:
            result.clear()
            out.append(bool(coal.collide(body, here, convex, pose, request, result)))
        return out

    return {"tracked": lambda: distances(True), "cold": lambda: distances(False), "collide": collide}


def least(rounds, calls):
    """Return the least seconds and the last answer of each call, all in turn in every round."""
    best, answers = dict.fromkeys(calls, np.inf), {}
    for _ in range(rounds):
        for name, call in calls.items():
            start = clock()
            answers[name] = call()
            best[name] = min(best[name], clock() - start)
    return best, answers


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=100_000, help="number of points")
    parser.add_argument("--frames", type=int, default=400, help="number of frames")
    parser.add_argument("--rounds", type=int, default=3, help="passes of all engines")
    parser.add_argument("--csv", help="output file (default: the standard output)")
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    points, poses = depth_camera(rng, options.points), frames(options.frames)
    corners = rng.normal(size=(32, 3))
    corners *= 0.1 / np.linalg.norm(corners, axis=1)[:, None]
    hull = lc.Geometry.hull(corners)
    # Cells are numbered from the least corner of the scene; the octree has the same grid.
    cells = np.unique(np.floor(points.astype(float) / SIDE).astype(int), axis=0)
    first, doubles = cells.min(axis=0), points.astype(np.float64)
    centres = (cells + 0.5) * SIDE
    shapes = {
        "balls": {"ours": lambda: lc.Cloud(points, radius=RADIUS)},
        "voxels": {"ours": lambda: lc.Cloud.from_cells(cells - first, size=SIDE, origin=first * SIDE)},
    }
    if coal:
        shapes["balls"]["coal octree of 4 mm"] = lambda: coal.makeOctree(doubles, 2 * RADIUS)
        shapes["voxels"]["coal octree"] = lambda: coal.makeOctree(centres, SIDE)
        shapes["voxels"]["coal BVH of triangles"] = lambda: mesh_of_cells(centres)
        vertices = coal.StdVec_Vec3s()
        for corner in corners:
            vertices.append(corner)
        convex = coal.Convex.convexHull(vertices, True, "Qt")
    truth = {
        "balls": np.array([gap_of_balls(doubles, hull, pose) for pose in poses]),
        "voxels": np.array([gap_of_boxes(centres, hull, pose) for pose in poses]),
    }
    out = csv.writer(open(options.csv, "w") if options.csv else sys.stdout, lineterminator="\n")
    out.writerow(["scene", "shape", "n", "engine", "us", "wrong"])
    for shape, engines in shapes.items():
        count, sure = len(points if shape == "balls" else cells), np.abs(truth[shape]) > 1e-9
        contacts = int((truth[shape] <= 0).sum())
        print(f"{shape}: {count} elements, {contacts} of {len(poses)} frames in contact", file=sys.stderr)
        seconds, bodies = least(options.rounds, engines)
        for engine in engines:
            out.writerow(["build", shape, count, engine, f"{1e6 * seconds[engine]:.0f}", ""])
        runs = {}
        for engine, body in bodies.items():
            calls = of_ours(body, hull, poses) if engine == "ours" else of_coal(body, convex, poses)
            runs |= {(scene, engine): call for scene, call in calls.items()}
        seconds, answers = least(options.rounds, runs)
        for (scene, engine), each in sorted(seconds.items(), key=lambda item: item[0][0]):
            found = np.array(answers[scene, engine])
            is_contact = found if found.dtype == bool else found <= 0
            wrong = int((is_contact != (truth[shape] <= 0))[sure].sum())
            out.writerow([scene, shape, count, engine, f"{1e6 * each / len(poses):.2f}", wrong])


if __name__ == "__main__":
    main()
