"""Compares distances and times with coal through pinocchio, on robots that nobody here wrote.

    pip install pin coal example-robot-data, and the Python package lin-canny
    cargo build --release -p lin-canny-cli
    python crates/robot/compare.py --tool target/release/lin-canny --rows 10000
    python crates/robot/compare.py --tool target/release/lin-canny --segments 1000 --places 10000

Meshes are convex hulls on both sides, or the triangles as they are with `--geometry mesh`. Pairs are
the same on both sides: all but adjacent links and those that met at each of 1,000 configurations. Configurations are uniform
within the limits; joints without limits turn by half a turn either way. Compared is the least
distance of each row where both engines call it free, and the verdict of each row. Times are CPU
seconds for all rows, those of the tool less those of one row. With the Python package `lin-canny`
at hand the last columns are the times of free or not: `Checker.free`, and coal's collisions, which
end at the first.

With `--segments` motions are judged instead: from a free configuration to another at most a radian a
joint away (or `--step`: of 32 joints that turn by a radian some always meet), certified over their
whole length. Every free one is asked at so many places by predicates, and at a hundredth of them by
coal; every blocked one has to be in contact at the time that is named.
"""

import argparse
import csv
import itertools
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

COMPARED = ("robot", "rows", "pairs", "free", "verdicts", "largest", "s", "coal s", "/coal", "free s", "coal s", "/coal")
JUDGED = ("robot", "segments", "free", "blocked", "unknown", "places", "wrong", "by coal", "wrong")


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


class Case:
    """A robot in both engines, with the same pairs."""

    def __init__(self, tool, urdf, packages, geometry, work):
        self.urdf, self.packages, self.geometry = urdf, packages, geometry
        self.places = [word for folder in packages for word in ("--packages", str(folder))]
        self.srdf = work / "ignored.srdf"
        self.follows = mimics(urdf)
        # Floating bases stay where they are: pinocchio loads the robot with a fixed base.
        folders, kinds = [str(p) for p in packages], [pin.GeometryType.COLLISION]
        self.model, self.bodies = pin.buildModelsFromUrdf(str(urdf), folders, geometry_types=kinds)
        self.joints = list(joints(self.model))
        self.names = [joint for joint in self.joints if joint[0] not in self.follows]
        self.set_pairs(self.checked(tool))
        self.data, self.placed = self.model.createData(), self.bodies.createData()

    def checked(self, tool):
        """Write the pairs to ignore as SRDF, and return the others."""
        _, said = run([tool, "find-excluded", self.urdf, *self.places, "--samples", "1000", "--out", self.srdf])
        counted = re.findall(r"^(\w+) .* overlap: (\S+) - (\S+)$", said, re.M)
        ignored = ET.parse(self.srdf)
        for pair in ignored.findall("disable_collisions[@reason='Never']"):
            ignored.getroot().remove(pair)
        ignored.write(self.srdf)
        return {frozenset(pair) for reason, *pair in counted if reason in ("check", "Never")}

    def set_pairs(self, checked):
        links = [self.model.frames[o.parentFrame].name for o in self.bodies.geometryObjects]
        for item in self.bodies.geometryObjects if self.geometry == "hull" else ():
            if isinstance(item.geometry, coal.BVHModelBase):
                item.geometry.buildConvexHull(True, "Qt")
                item.geometry = item.geometry.convex
        self.bodies.removeAllCollisionPairs()
        for i, j in itertools.combinations(range(len(links)), 2):
            if frozenset((links[i], links[j])) in checked:
                self.bodies.addCollisionPair(pin.CollisionPair(i, j))

    def limits(self):
        """Return the limits of each joint; half a turn either way without."""
        turn = np.array([-np.pi, np.pi])
        own = ([self.model.lowerPositionLimit[q], self.model.upperPositionLimit[q]] for _, q, _ in self.names)
        return np.array([at if nq == 1 and np.isfinite(at).all() else turn for at, (_, _, nq) in zip(own, self.names)])

    def configuration(self, row):
        """Return the configuration of pinocchio for a row of joints that do not mimic."""
        q = pin.neutral(self.model)
        values = {joint: x for (joint, _, _), x in zip(self.names, row)}
        for joint, (leader, factor, offset) in self.follows.items():
            values[joint] = factor * values[leader] + offset
        for joint, at, nq in self.joints:
            x = values[joint]
            if nq == 1:
                q[at] = x
            else:
                q[at : at + 2] = np.cos(x), np.sin(x)
        return q

    def checker(self):
        """Return the checker, and the columns of a row in its order."""
        robot = lin_canny.Robot.load(self.urdf, self.srdf, packages=self.packages, meshes=self.geometry)
        checker, names = lin_canny.Checker(robot), [joint for joint, _, _ in self.names]
        return checker, [names.index(joint) for joint in checker.coordinates]

    def hits(self, q):
        """Return whether coal finds a collision, and the seconds."""
        began = time.process_time()
        pin.updateGeometryPlacements(self.model, self.data, self.bodies, self.placed, q)
        found = pin.computeCollisions(self.bodies, self.placed, True)
        return found, time.process_time() - began

    def distance(self, q):
        """Return the least distance of coal, and the seconds."""
        began = time.process_time()
        pin.updateGeometryPlacements(self.model, self.data, self.bodies, self.placed, q)
        k = pin.computeDistances(self.bodies, self.placed)
        return self.placed.distanceResults[k].min_distance, time.process_time() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", required=True, type=pathlib.Path, help="the program lin-canny")
    parser.add_argument("--rows", type=int, default=10_000, help="configurations of each robot")
    parser.add_argument("--geometry", choices=["hull", "mesh"], default="hull", help="what meshes become")
    parser.add_argument("--only", choices=list(ROBOTS), help="one robot")
    parser.add_argument("--segments", type=int, default=0, help="judge so many segments of each robot")
    parser.add_argument("--step", type=float, default=1.0, help="the most that a joint moves along a segment")
    parser.add_argument("--places", type=int, default=10_000, help="places of each segment")
    options = parser.parse_args()
    share = pathlib.Path(pin.__file__).parents[4] / "share/example-robot-data/robots"
    if options.segments:
        print("{:8}{:>9}{:>7}{:>9}{:>9}{:>12}{:>8}{:>12}{:>8}".format(*JUDGED))
    else:
        print("{:8}{:>7}{:>7}{:>7}{:>10}{:>10}{:>8}{:>8}{:>7}{:>8}{:>8}{:>7}".format(*COMPARED))
    for name, path in ROBOTS.items():
        if options.only not in (None, name):
            continue
        with tempfile.TemporaryDirectory() as work:
            work, packages = pathlib.Path(work), [share.parent.parent, share]
            case = Case(options.tool.resolve(), share / path, packages, options.geometry, work)
            (judge if options.segments else compare)(options, name, case, work)


def judge(options, name, case, work):
    """Judge certified segments of a robot."""
    rng, limits = np.random.default_rng(11), case.limits()
    checker, order = case.checker()
    counts = {"free": 0, "blocked": 0, "unknown": 0}
    asked = wrong = looked = missed = 0
    while sum(counts.values()) < options.segments:
        start = rng.uniform(*limits.T)
        if not checker.free(start[None, order])[0]:
            continue
        goal = np.clip(start + options.step * rng.uniform(-1, 1, len(start)), *limits.T)
        verdict = checker.certify(start[order], goal[order])
        counts[verdict.state] += 1
        if verdict.state == "blocked":
            at = start + verdict.contact_at * (goal - start)
            wrong += int(checker.clearance(at[order]).upper > 1e-9)
        if verdict.state != "free":
            continue
        # Clipped, as the sum may round to just beyond a limit.
        rows = np.clip(start + np.linspace(0, 1, options.places)[:, None] * (goal - start), *limits.T)
        wrong += int((~checker.free(rows[:, order])).sum())
        asked += len(rows)
        for row in rows[::100]:
            missed += int(case.hits(case.configuration(row))[0])
            looked += 1
    print(
        f"{name:8}{options.segments:9}{counts['free']:7}{counts['blocked']:9}{counts['unknown']:9}"
        f"{asked:12}{wrong:8}{looked:12}{missed:8}",
        flush=True,
    )


def answers(options, case, rows, work):
    """Return our distance of each row with its pair, and the seconds."""
    for count, file in ((1, "one.csv"), (len(rows), "all.csv")):
        with open(work / file, "w", newline="") as out:
            writer = csv.writer(out)
            writer.writerow([n for n, _, _ in case.names])
            writer.writerows([[repr(float(x)) for x in row] for row in rows[:count]])
    command = [options.tool.resolve(), "clearance", case.urdf, *case.places]
    command += ["--geometry", options.geometry, "--srdf", case.srdf, "--csv", work / "out.csv", "--joints"]
    one, every = (run([*command, work / file])[0] for file in ("one.csv", "all.csv"))
    with open(work / "out.csv") as read:
        return [(float(r["distance"]), r["a"], r["b"]) for r in csv.DictReader(read)], every - one


def compare(options, name, case, work):
    """Compare distances and verdicts of a robot."""
    rows = np.random.default_rng(7).uniform(*case.limits().T, (options.rows, len(case.names)))
    ours, seconds = answers(options, case, rows, work)
    distance = np.array([d for d, _, _ in ours])
    configurations = [case.configuration(row) for row in rows]
    hits, hit_seconds = (np.array(x) for x in zip(*map(case.hits, configurations)))
    theirs, their_seconds = (np.array(x) for x in zip(*map(case.distance, configurations)))
    free, other = (distance > 0) & (theirs > 0), np.flatnonzero((distance > 0) != (theirs > 0))
    off = np.abs(distance - theirs)[free].max(initial=0)
    columns = f"{name:8}{len(rows):7}{len(case.bodies.collisionPairs):7}{int(free.sum()):7}{len(other):10}{off:10.1e}"
    columns += f"{seconds:8.2f}{their_seconds.sum():8.2f}{seconds / their_seconds.sum():7.2f}"
    differ = []
    if lin_canny:
        checker, order = case.checker()
        began = time.process_time()
        free_at = checker.free(rows[:, order])
        answered = time.process_time() - began
        columns += f"{answered:8.2f}{hit_seconds.sum():8.2f}{answered / hit_seconds.sum():7.2f}"
        differ = np.flatnonzero(free_at == hits)
    print(columns, flush=True)
    for k in differ[:3]:
        word = "free" if free_at[k] else "not free"
        print(f"  row {k}: ours {word} at {distance[k]:.3e}, coal hits at {theirs[k]:.3e}: {hits[k]}")
    for k in other[:3]:
        print(f"  row {k}: ours {distance[k]:.3e} of {ours[k][1]} and {ours[k][2]}, coal {theirs[k]:.3e}")


if __name__ == "__main__":
    main()
