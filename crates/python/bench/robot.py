"""Clearances of an arm at 10,000 configurations: this package, the loop in Rust, pinocchio with coal.

    maturin develop --release --features bench
    python bench/robot.py --rounds 5

Thread CPU time in microseconds per configuration, the least of the rounds, all in turn in every
round. The arm is `crates/robot/examples/gripper.urdf` without its cell. Pinocchio measures the same pairs
of links by `computeDistances`; the least is the clearance.
"""

import argparse
import time
from pathlib import Path

import numpy as np

import lin_canny as lc

try:
    import pinocchio as pin
except ImportError:
    pin = None

clock = time.thread_time
ARM = Path(__file__).parents[2] / "robot" / "examples"
COUNT, SLOW = 10_000, 2_000


def timed(call):
    start = clock()
    answer = call()
    return (clock() - start) * 1e6, answer


def with_pinocchio(robot, q):
    """Return a call that gives the clearances of the first configurations, and the number of pairs."""
    urdf = str(ARM / "gripper.urdf")
    model = pin.buildModelFromUrdf(urdf)
    shapes = pin.buildGeomFromUrdf(model, urdf, pin.GeometryType.COLLISION, package_dirs=[str(ARM)])
    for body in shapes.geometryObjects:  # hulls of meshes, as the other side has them
        if hasattr(body.geometry, "buildConvexRepresentation"):
            body.geometry.buildConvexRepresentation(False)
            body.geometry = body.geometry.convex
    shapes.addAllCollisionPairs()
    pin.removeCollisionPairs(model, shapes, str(ARM / "gripper.srdf"))
    for pair in list(shapes.collisionPairs):  # links that a joint connects
        a, b = (shapes.geometryObjects[k].parentJoint for k in (pair.first, pair.second))
        if a in (model.parents[b], b) or b == model.parents[a]:
            shapes.removeCollisionPair(pair)
    data, queries = model.createData(), shapes.createData()
    # The right finger mimics the left one.
    columns = [robot.coordinates.index("left" if name == "right" else name) for name in model.names[1:]]
    configurations = q[:SLOW][:, columns]

    def run():
        out = np.empty(SLOW)
        for k, each in enumerate(configurations):
            pin.computeDistances(model, data, shapes, queries, each)
            out[k] = min(result.min_distance for result in queries.distanceResults)
        return out

    return run, len(shapes.collisionPairs)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--rounds", type=int, default=5)
    rounds = options.parse_args().rounds
    robot = lc.Robot.load(ARM / "gripper.urdf", ARM / "gripper.srdf")
    checker = lc.Checker(robot, exclude_adjacent=True)
    q = np.random.default_rng(0).uniform(*robot.limits.T, (COUNT, robot.dof))
    runs = {
        "Rust loop": (lambda: None, COUNT),
        "`clearances`": (lambda: checker.clearances(q), COUNT),
        "`are_free`": (lambda: checker.are_free(q), COUNT),
        "`clearance`, one by one": (lambda: [checker.clearance(each) for each in q], COUNT),
    }
    if pin:
        call, pairs = with_pinocchio(robot, q)
        runs[f"pinocchio with coal, {pairs} pairs"] = (call, SLOW)
    least = dict.fromkeys(runs, float("inf"))
    answers = {}
    for _ in range(rounds):
        for name, (call, count) in runs.items():
            micros, answers[name] = timed(call)
            if name == "Rust loop":
                micros = checker._rust_loop(q)[0] * 1e6
            least[name] = min(least[name], micros / count)
    found = answers["`clearances`"]["distance"]
    for name, micros in least.items():
        note = f"{micros / least['Rust loop']:.2f}"
        if "pinocchio" in name:
            off = np.abs(answers[name] - found[:SLOW])
            note += f" | differs by at most {off.max():.0e}, median {np.median(off):.0e}"
        print(f"| {name} | {micros:.1f} | {note} |")


if __name__ == "__main__":
    main()
