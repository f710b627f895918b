"""A slice of the signed distance of a mesh as a picture: blue inside, red outside, the surface in black.

    pip install matplotlib
    python slice.py part.stl --z 0.2 --out slice.png

Without a file, the mesh is a ring with a hollow inside, which has negative distances only in its wall.
"""

import argparse

import numpy as np

import lin_canny as lc


def tube(radius, inward=False, ring=1.0, count=48):
    """Return vertices and triangles of a torus about z."""
    i, j = (x.ravel() for x in np.meshgrid(np.arange(2 * count), np.arange(count), indexing="ij"))
    u, v = np.pi * i / count, 2 * np.pi * j / count
    r = ring + radius * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), radius * np.sin(v)], 1)
    at = lambda x, y: (i + x) % (2 * count) * count + (j + y) % count  # noqa: E731
    triangles = np.concatenate([np.stack([at(0, 0), at(1, 0), at(1, 1)], 1), np.stack([at(0, 0), at(1, 1), at(0, 1)], 1)])
    return vertices, triangles[:, ::-1] if inward else triangles


def hollow_ring():
    (outer, a), (inner, b) = tube(0.4), tube(0.25, inward=True)
    return lc.Geometry.mesh(np.concatenate([outer, inner]), np.concatenate([a, b + len(outer)]))


def slice_of(geometry, z, count, threads):
    """Return the coordinates along x and y, and the signed distances in the plane at height z."""
    centre, radius = geometry.bounding_ball
    x, y = (np.linspace(c - 1.1 * radius, c + 1.1 * radius, count) for c in centre[:2])
    points = np.stack(np.broadcast_arrays(x[None, :], y[:, None], z), axis=-1).reshape(-1, 3)
    distance, lower, upper = lc.signed_distance(geometry, points, bounds=True, threads=threads)
    print(f"{len(points)} points, {np.mean(distance <= 0):.1%} inside, bounds at most {(upper - lower).max():.1e} wide")
    return x, y, distance.reshape(count, count)


def draw(x, y, distance, out):
    try:
        import matplotlib
    except ImportError:
        print("no picture: matplotlib is not installed")
        return
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.colors import TwoSlopeNorm

    figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
    low, high = min(distance.min(), -1e-9), max(distance.max(), 1e-9)
    levels = np.concatenate([np.linspace(low, 0, 13)[:-1], np.linspace(0, high, 25)])
    drawn = axes.contourf(x, y, distance, levels=levels, cmap="RdBu_r", norm=TwoSlopeNorm(0, low, high))
    axes.contour(x, y, distance, levels=[0], colors="black")
    axes.set(xlabel="x", ylabel="y", aspect="equal")
    figure.colorbar(drawn, label="signed distance, negative inside")
    figure.savefig(out, dpi=150)
    print(f"picture in {out}")


def main():
    options = argparse.ArgumentParser(description="Draws a slice of the signed distance of a mesh.")
    options.add_argument("mesh", nargs="?", help="STL, OBJ, COLLADA, PLY, glTF or MSH file")
    options.add_argument("--z", type=float, default=0.0, help="height of the slice")
    options.add_argument("--count", type=int, default=300, help="points along each side")
    options.add_argument("--threads", type=int, default=1)
    options.add_argument("--out", default="slice.png")
    given = options.parse_args()
    geometry = lc.load_mesh(given.mesh).geometry("mesh") if given.mesh else hollow_ring()
    print(geometry)
    x, y, distance = slice_of(geometry, given.z, given.count, given.threads)
    draw(x, y, distance, given.out)


if __name__ == "__main__":
    main()
