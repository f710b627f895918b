"""Sides of points of public meshes that are damaged and repaired, against the meshes before the damage.

    pip download --no-deps example-robot-data robosuite gymnasium-robotics dm_control
    python bench/damaged.py *.whl

Of each package the closed meshes of 20 to 200,000 triangles are taken, up to `--meshes`
in all. Triangles that share no vertex are lost or inverted, .1 to 5 % of them (`damaged` of points.py). A point is
1e-6 to 1e-1 of the size off a random triangle. The script prints the packages with their files, and each wrong side.
"""

import argparse
import hashlib
import pathlib
import tempfile
import time
import zipfile

import numpy as np

import lin_canny as lc
from points import damaged

KINDS = ("lost", "turned", "both")


def clean(path):
    """Return vertices and triangles of a closed mesh; None for other meshes."""
    try:
        geometry = lc.load_mesh(path).geometry("mesh")
    except (OSError, ValueError):
        return None
    triangles = np.asarray(geometry.triangles)
    if not geometry.is_solid or not 20 <= len(triangles) <= 200_000:
        return None
    return np.asarray(geometry.vertices), triangles


def points_off(vertices, triangles, count, rng):
    """Return points above and below random triangles, shape (count, 3)."""
    corners = vertices[triangles[rng.integers(len(triangles), size=count)]]
    weights = rng.dirichlet((1, 1, 1), size=count)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    size = np.ptp(vertices, axis=0).max()
    heights = size * 10 ** rng.uniform(-6, -1, size=(count, 1)) * rng.choice((-1, 1), size=(count, 1))
    return np.einsum("ij,ijk->ik", weights, corners) + normals * heights


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("packages", nargs="+", type=pathlib.Path, help="wheels or folders")
    parser.add_argument("--meshes", type=int, default=200)
    parser.add_argument("--points", type=int, default=1000, help="points per mesh and kind of damage")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    seen, used, wrong, asked, start = set(), 0, 0, 0, time.monotonic()
    each = -(-options.meshes // len(options.packages))
    for package in options.packages:
        with tempfile.TemporaryDirectory() as folder:
            if package.suffix == ".whl":
                zipfile.ZipFile(package).extractall(folder)
            root = pathlib.Path(folder if package.suffix == ".whl" else package)
            files = sorted(f for f in root.rglob("*") if f.suffix.lower() in (".stl", ".obj", ".dae", ".ply", ".msh"))
            taken = 0
            for file in files:
                if taken == each or used == options.meshes:
                    break
                digest = hashlib.sha256(file.read_bytes()).digest()
                mesh = None if digest in seen else clean(file)
                seen.add(digest)
                if mesh is None:
                    continue
                taken, used = taken + 1, used + 1
                whole = lc.Geometry.mesh(*mesh)
                for kind in KINDS:
                    points = points_off(*mesh, options.points, rng)
                    triangles = damaged(kind, mesh[1], 10 ** rng.uniform(-3, np.log10(0.05)), rng)
                    solid = lc.Geometry.repaired_mesh(mesh[0], triangles)
                    assert solid.is_solid
                    differ = np.flatnonzero(lc.contains(whole, points) != lc.contains(solid, points))
                    asked, wrong = asked + len(points), wrong + len(differ)
                    if len(differ):
                        away = np.abs(lc.signed_distance(whole, points[differ])).max() / np.ptp(mesh[0], axis=0).max()
                        name = file.relative_to(root)
                        print(f"{name}, {kind}: {len(differ)} wrong, up to {away:.1e} L off: {solid.repair_report}")
            print(f"{package.name}: {taken} meshes of {len(files)} files", flush=True)
    print(f"{used} meshes, {asked} points, {wrong} wrong sides, {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
