"""Clearance of an arm at random configurations: a histogram, and which pairs are in the way.

    pip install matplotlib
    cd crates/robot/examples
    python ../../python/examples/study.py gripper.urdf --srdf gripper.srdf --cell cell.json --threads 2
"""

import argparse
from collections import Counter

import numpy as np

import lin_canny as lc


def arguments():
    options = argparse.ArgumentParser(description="Clearance of an arm at random configurations.")
    options.add_argument("urdf")
    options.add_argument("--srdf")
    options.add_argument("--cell")
    options.add_argument("--count", type=int, default=10_000)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--threads", type=int, default=1)
    options.add_argument("--out", default="clearance.png")
    return options.parse_args()


def configurations(robot, count, seed):
    """Return configurations uniform within the limits, shape (count, dof)."""
    low, high = robot.limits.T
    return np.random.default_rng(seed).uniform(low, high, (count, robot.dof))


def report(distance, pairs, out):
    """Print the share in contact and the commonest pairs, and draw the histogram."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    print(f"{len(distance)} configurations, {np.mean(distance <= 0):.1%} in contact")
    for (a, b), count in Counter(pairs).most_common(5):
        print(f"  nearest {count:6} times: {a} - {b}")
    figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
    axes.hist(distance, bins=80)
    axes.axvline(0, color="black", linewidth=1)
    axes.set(xlabel="clearance in the unit of the file, negative: depth", ylabel="configurations")
    figure.savefig(out, dpi=150)
    print(f"histogram in {out}")


def main():
    given = arguments()
    robot = lc.Robot.load(given.urdf, given.srdf)
    checker = lc.Checker(robot, cell=given.cell)
    q = configurations(robot, given.count, given.seed)
    found = checker.clearances(q, threads=given.threads)
    names = checker.bodies
    pairs = [(names[a], names[b]) for a, b in zip(found["a"], found["b"])]
    report(found["distance"], pairs, given.out)


if __name__ == "__main__":
    main()
