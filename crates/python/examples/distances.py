"""Distance of two mesh files (STL, OBJ, COLLADA, PLY, glTF or MSH), as hulls or as the meshes they are.

    python distances.py part.stl tool.stl --at 0.1 0 0 --kind mesh
"""

import argparse

import lin_canny as lc


def main():
    options = argparse.ArgumentParser(description="Distance of two mesh files.")
    options.add_argument("files", nargs=2)
    options.add_argument("--at", nargs=3, type=float, default=(0, 0, 0), help="position of the second file")
    options.add_argument("--xyzw", nargs=4, type=float, default=(0, 0, 0, 1), help="its quaternion")
    options.add_argument("--kind", choices=("hull", "mesh"), default="mesh")
    given = options.parse_args()
    a, b = (lc.load_mesh(path).geometry(given.kind) for path in given.files)
    pose = (given.at, given.xyzw)
    tracker = lc.PairTracker()
    found = tracker.closest(a, b, None, pose)
    for path, each in zip(given.files, (a, b)):
        print(f"{path}: {each}")
    print(f"{found.state}: {found.distance:.9g} in [{found.lower:.15g}, {found.upper:.15g}]")
    print(f"points {found.point_a} and {found.point_b}, normal {found.normal}")
    if found.state == "overlapping" and (deep := tracker.penetration(a, b, None, pose)):
        print(f"depth in [{deep.lower:.9g}, {deep.upper:.9g}]; moving the second by {deep.shift} parts them")


if __name__ == "__main__":
    main()
