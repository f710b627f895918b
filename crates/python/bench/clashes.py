"""Clashes of a made assembly: `lin_canny.clash` and the collision manager of trimesh, which calls FCL.

    pip install trimesh python-fcl
    python bench/clashes.py     # a minute

The parts are blocks with a slot whose sides are grids of triangles, so that all answers have closed forms: they stand on a grid with
small gaps, some longer than the gap, some flush with their neighbour, and some with a small block inside. Columns: parts, triangles, pairs of parts that
share a volume, pairs that are flush; then for each program the seconds of preparation and of the search, the pairs that it reports,
those that it misses, and those that it reports though they share no volume.
"""

import argparse
import time

import numpy as np
import trimesh

import lin_canny as lc


def block(n, slot):
    """Return vertices and triangles of a cube of side 1 around the origin, of n^3 cells, with a slot along y in its top or without."""
    filled = np.zeros((n + 2,) * 3, bool)
    filled[1:-1, 1:-1, 1:-1] = True
    if slot:
        filled[n // 4 + 1 : n - n // 4 + 1, :, n - n // 4 + 1 :] = False
    faces = []
    for axis in range(3):
        for side in (1, -1):
            cells = np.argwhere(filled & ~np.roll(filled, -side, axis)) - 1
            cells[:, axis] += side > 0
            u, v = np.roll(np.eye(3, dtype=int), -axis, 0)[1:]
            a, b, c, d = cells, cells + u, cells + u + v, cells + v
            squares = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
            faces.append(squares if side > 0 else squares[:, ::-1])
    corners = np.concatenate(faces).reshape(-1, 3)
    points, indices = np.unique(corners, axis=0, return_inverse=True)
    return points / n - 0.5, indices.reshape(-1, 3)


def assembly(side, n, seed):
    """Return the parts, by name the vertices, the triangles and the box, and the pairs that overlap and that are flush."""
    rng = np.random.default_rng(seed)
    pitch, parts, overlaps, flush = 1.0625, {}, set(), set()
    special = rng.permutation(side**3)
    longer, level, filled = (set(special[k : k + side**3 // 5].tolist()) for k in (0, side**3 // 5, 2 * side**3 // 5))
    for k in range(side**3):
        at = np.array([k // side**2, k // side % side, k % side])
        # A box that is longer reaches into the next one along x, or just touches it.
        reach = 0.125 if k in longer else 0.0625 if k in level else 0.0
        vertices, faces = block(n, True)
        vertices = vertices + [[reach, 0, 0]] * (vertices[:, :1] == 0.5)
        parts[f"part{k}"] = vertices + at * pitch, faces
        if at[0] + 1 < side and reach:
            (overlaps if k in longer else flush).add((f"part{k}", f"part{k + side**2}"))
        if k in filled:
            vertices, faces = block(4, True)
            parts[f"core{k}"] = vertices / 4 - [0, 0, 0.25] + at * pitch, faces
            overlaps.add((f"part{k}", f"core{k}"))
    return parts, {frozenset(pair) for pair in overlaps}, {frozenset(pair) for pair in flush}


def row(name, ready, search, found, overlaps):
    print(f"{name:9} {ready:11.2f} {search:8.2f} {len(found):9} {len(overlaps - found):7} {len(found - overlaps):7}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=10, help="parts along each axis")
    parser.add_argument("--cells", type=int, default=12, help="cells along each side of a part")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--volume", action="store_true", help="compute volumes as well")
    args = parser.parse_args()
    parts, overlaps, flush = assembly(args.side, args.cells, args.seed)
    triangles = sum(len(faces) for _, faces in parts.values())
    print(f"{len(parts)} parts, {triangles} triangles, {len(overlaps)} overlaps, {len(flush)} flush pairs")
    print("            prepared   search  reported  missed   wrong")

    start = time.perf_counter()
    bodies = {name: lc.Geometry.mesh(*part) for name, part in parts.items()}
    ready = time.perf_counter()
    found = lc.clash(bodies, within=0.07, volume=args.volume)
    end = time.perf_counter()
    row("lin_canny", ready - start, end - ready, {frozenset((r.a, r.b)) for r in found.broken}, overlaps)
    touching = {frozenset((r.a, r.b)) for r in found.rows if r.kind == "touching"}
    print(f"          {found.measured} pairs measured, {len(found.rows)} rows, touching {touching == flush}")

    start = time.perf_counter()
    manager = trimesh.collision.CollisionManager()
    for name, (vertices, faces) in parts.items():
        manager.add_object(name, trimesh.Trimesh(vertices, faces, process=False))
    ready = time.perf_counter()
    _, names = manager.in_collision_internal(return_names=True)
    end = time.perf_counter()
    row("trimesh", ready - start, end - ready, {frozenset(pair) for pair in names}, overlaps)


if __name__ == "__main__":
    main()
