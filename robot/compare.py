"""Compares distances and times with coal through pinocchio, on robots that nobody here wrote.

    pip install pin coal example-robot-data
    cargo build --release -p lin-canny-robot
    python robot/compare.py --tool target/release/lin-canny-robot --rows 10000

Meshes are convex hulls on both sides, or the triangles as they are with `--geometry mesh`. Pairs are
the same on both sides: all but adjacent links and those that met at each of 1,000 configurations. Configurations are uniform
within the limits; joints without limits turn by half a turn either way. Compared is the least
distance of each row where both engines call it free, and the verdict of each row. Times are CPU
seconds for all rows, those of the tool less those of one row. With the Python package `lin-canny`
at hand the last columns are the times of free or not: `Checker.free`, and coal's collisions, which
end at the first.
"""

import argparse
import csv
import pathlib
import re
import resource
import subprocess
import tempfile
import time
import xml.etree.ElementTree as ET

import coal
import numpy as np
import pinocchio as pin

try:
    import lin_canny
except ImportError:
    lin_canny = None

ROBOTS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "talos": "talos_data/robots/talos_reduced.urdf",
}


def run(command):
    """Return the CPU seconds and the output of a program that may end with 0 or 1."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime, done.stdout


def joints(model):
    """Yield the name and index in q of each joint of one number, mimics left out."""
    for name, joint in zip(model.names[1:], model.joints[1:]):
        if joint.nv == 1:
            yield name, joint.idx_q, joint.nq


def mimics(urdf):
    """Return what each joint that mimics another follows: its name, factor and offset."""
    found = {}
    for joint in ET.parse(urdf).findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") != "fixed":
            factor, offset = (float(mimic.get(k, d)) for k, d in (("multiplier", 1), ("offset", 0)))
            found[joint.get("name")] = mimic.get("joint"), factor, offset
    return found


def configuration(model, all_joints, names, follows, row):
    """Return the configuration of pinocchio for a row of joints that do not mimic."""
    q = pin.neutral(model)
    values = {joint: x for (joint, _, _), x in zip(names, row)}
    for joint, (leader, factor, offset) in follows.items():
        values[joint] = factor * values[leader] + offset
    for joint, at, nq in all_joints:
        x = values[joint]
        if nq == 1:
            q[at] = x
        else:
            q[at : at + 2] = np.cos(x), np.sin(x)
    return q


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", required=True, type=pathlib.Path, help="the program lin-canny-robot")
    parser.add_argument("--rows", type=int, default=10_000, help="configurations of each robot")
    parser.add_argument("--geometry", choices=["hull", "mesh"], default="hull", help="what meshes become")
    parser.add_argument("--only", choices=list(ROBOTS), help="one robot")
    options = parser.parse_args()
    share = pathlib.Path(pin.__file__).parents[4] / "share/example-robot-data/robots"
    head = ("robot", "rows", "pairs", "free", "verdicts", "largest", "s", "coal s", "/coal", "free s", "coal s", "/coal")
    print("{:8}{:>7}{:>7}{:>7}{:>10}{:>10}{:>8}{:>8}{:>7}{:>8}{:>8}{:>7}".format(*head))
    for name, path in ROBOTS.items():
        if options.only in (None, name):
            compare(options, name, share / path, [share.parent.parent, share])


def compare(options, name, urdf, packages):
    tool = options.tool.resolve()
    places = [word for folder in packages for word in ("--packages", str(folder))]
    # Floating bases stay where they are: pinocchio loads the robot with a fixed base.
    folders = [str(p) for p in packages]
    model, geometry = pin.buildModelsFromUrdf(str(urdf), folders, geometry_types=[pin.GeometryType.COLLISION])
    rng = np.random.default_rng(7)
    follows = mimics(urdf)
    all_joints = list(joints(model))
    names = [joint for joint in all_joints if joint[0] not in follows]
    rows = np.empty((options.rows, len(names)))
    for k, (_, q, nq) in enumerate(names):
        low, high = (model.lowerPositionLimit[q], model.upperPositionLimit[q]) if nq == 1 else (-np.pi, np.pi)
        low, high = (low, high) if np.isfinite([low, high]).all() else (-np.pi, np.pi)
        rows[:, k] = rng.uniform(low, high, options.rows)
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        _, said = run([tool, "ignorable", urdf, *places, "--samples", "1000", "--out", work / "ignored.srdf"])
        counted = re.findall(r"^(\w+) .* overlap: (\S+) - (\S+)$", said, re.M)
        checked = {frozenset(pair) for reason, *pair in counted if reason in ("check", "Never")}
        ignored = ET.parse(work / "ignored.srdf")
        for pair in ignored.findall("disable_collisions[@reason='Never']"):
            ignored.getroot().remove(pair)
        ignored.write(work / "ignored.srdf")
        for count, file in ((1, "one.csv"), (options.rows, "all.csv")):
            with open(work / file, "w", newline="") as out:
                writer = csv.writer(out)
                writer.writerow([n for n, _, _ in names])
                writer.writerows([[repr(float(x)) for x in row] for row in rows[:count]])
        command = [tool, "clearance", urdf, *places, "--geometry", options.geometry, "--srdf", work / "ignored.srdf"]
        least = [run([*command, "--joints", work / file, "--csv", work / "out.csv"])[0] for file in ("one.csv", "all.csv")]
        if lin_canny:
            robot = lin_canny.Robot.load(urdf, work / "ignored.srdf", packages=packages, meshes=options.geometry)
            checker = lin_canny.Checker(robot)
            order = [[joint for joint, _, _ in names].index(joint) for joint in checker.coordinates]
            began = time.process_time()
            free_at = checker.free(rows[:, order])
            answered = time.process_time() - began
        with open(work / "out.csv") as read:
            ours = [(float(r["distance"]), r["a"], r["b"]) for r in csv.DictReader(read)]
    links = [model.frames[o.parentFrame].name for o in geometry.geometryObjects]
    if options.geometry == "hull":
        for item in geometry.geometryObjects:
            if isinstance(item.geometry, coal.BVHModelBase):
                item.geometry.buildConvexHull(True, "Qt")
                item.geometry = item.geometry.convex
    geometry.removeAllCollisionPairs()
    for i in range(len(links)):
        for j in range(i + 1, len(links)):
            if frozenset((links[i], links[j])) in checked:
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    data, placed = model.createData(), geometry.createData()
    theirs, hits, seconds = [], [], [0.0, 0.0]
    for row in rows:
        q = configuration(model, all_joints, names, follows, row)
        began = time.process_time()
        pin.updateGeometryPlacements(model, data, geometry, placed, q)
        hits.append(pin.computeCollisions(geometry, placed, True))
        between = time.process_time()
        pin.updateGeometryPlacements(model, data, geometry, placed, q)
        k = pin.computeDistances(geometry, placed)
        theirs.append(placed.distanceResults[k].min_distance)
        seconds = [seconds[0] + time.process_time() - between, seconds[1] + between - began]
    distance, theirs = np.array([d for d, _, _ in ours]), np.array(theirs)
    free = (distance > 0) & (theirs > 0)
    other = int(((distance > 0) != (theirs > 0)).sum())
    off = np.abs(distance - theirs)[free]
    print(
        f"{name:8}{len(rows):7}{len(geometry.collisionPairs):7}{int(free.sum()):7}{other:10}{off.max(initial=0):10.1e}"
        f"{least[1] - least[0]:8.2f}{seconds[0]:8.2f}{(least[1] - least[0]) / seconds[0]:7.2f}"
        + (f"{answered:8.2f}{seconds[1]:8.2f}{answered / seconds[1]:7.2f}" if lin_canny else ""),
        flush=True,
    )
    for k in np.flatnonzero(free_at == np.array(hits))[:3] if lin_canny else ():
        print(f"  row {k}: ours {'free' if free_at[k] else 'not free'} at {distance[k]:.3e}, coal hits at {theirs[k]:.3e}: {hits[k]}")
    for k in np.flatnonzero((distance > 0) != (theirs > 0))[:3]:
        print(f"  row {k}: ours {distance[k]:.3e} of {ours[k][1]} and {ours[k][2]}, coal {theirs[k]:.3e}")


if __name__ == "__main__":
    main()
