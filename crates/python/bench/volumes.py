"""Volumes that two meshes share: this package and the boolean of manifold3d.

    pip install manifold3d
    python bench/volumes.py --csv volumes.csv     # minutes

Columns: pair, triangles of each mesh, milliseconds of CPU time of one thread (least of the rounds) of `overlap` with a new
tracker and of manifold3d's intersection with its volume, preparation of both apart; ratio; both volumes.
manifold3d has numbers of 32 bits, unless its build has 64.
"""

import argparse
import csv
import sys
import time

import manifold3d
import numpy as np

import lin_canny as lc

clock = time.process_time


def torus(count, bumps=0.0):
    """Return vertices and triangles of a torus, about `count` of them, with bumps that no other one has."""
    m = int(np.sqrt(count / 4))
    n = 2 * m
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    tube = 0.35 + bumps * np.sin(5 * u) * np.cos(3 * v)
    r = 1 + tube * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), tube * np.sin(v)], 1)
    a, b, c, d = ((i + x) % n * m + (j + y) % m for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def pairs(count):
    """Return the pairs: name, mesh A, mesh B."""
    plain, bumpy = torus(count), torus(count, 0.02)
    turn = 2 * np.pi / (2 * int(np.sqrt(count / 4)))
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    yield "shallow", plain, (plain[0] + [2.6, 0.1, 0.05], plain[1])
    yield "linked", plain, (bumpy[0][:, [0, 2, 1]] + [1.2, 0.1, 0.05], bumpy[1][:, ::-1])
    yield "equal", plain, plain
    yield "one step", plain, (plain[0] @ rotation.T, plain[1])
    yield "inside", plain, (plain[0] * [1, 1, 0.4] + [0, 0, 1e-3], plain[1])


def least(rounds, call):
    """Return the least CPU time in milliseconds, and the answer."""
    best = np.inf
    for _ in range(rounds):
        start = clock()
        found = call()
        best = min(best, 1e3 * (clock() - start))
    return best, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000, 10_000, 100_000], help="numbers of triangles")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--csv", help="output file (default: the standard output)")
    options = parser.parse_args()
    out = csv.writer(open(options.csv, "w") if options.csv else sys.stdout, lineterminator="\n")
    out.writerow(["pair", "n", "ours_ms", "manifold3d_ms", "ratio", "ours", "manifold3d"])
    kind = manifold3d.Mesh64 if hasattr(manifold3d, "Mesh64") else manifold3d.Mesh
    number = np.float64 if kind is not manifold3d.Mesh else np.float32
    for size in options.sizes:
        for name, *meshes in pairs(size):
            a, b = (lc.Geometry.mesh(*mesh) for mesh in meshes)
            assert a.is_solid and b.is_solid, name
            p, q = (manifold3d.Manifold(kind(v.astype(number), t.astype(np.uint64 if number is np.float64 else np.uint32))) for v, t in meshes)
            assert p.num_tri() > 0 and q.num_tri() > 0, name
            ours, found = least(options.rounds, lambda: lc.PairTracker().overlap(a, b))
            theirs, volume = least(options.rounds, lambda: (p ^ q).volume())
            middle = 0.5 * (found.lower + found.upper)
            row = [name, len(meshes[0][1]), f"{ours:.2f}", f"{theirs:.2f}", f"{ours / theirs:.2f}", f"{middle:.15g}", f"{volume:.15g}"]
            out.writerow(row)


if __name__ == "__main__":
    main()
