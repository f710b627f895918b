"""A timed trajectory: proven free or the time and the pair, the tracking error it allows, and a plot.

    pip install matplotlib
    cd crates/robot/examples
    python ../../python/examples/trajectory.py gripper.urdf carry.csv --srdf gripper.srdf --cell cell.json

The file is CSV, or a ROS JointTrajectory as JSON or YAML. `--rest` lets the arm stop at each point:
a cubic from rest to rest in place of each straight segment. `--cell-only` leaves out the pairs of the
robot with itself.
"""

import argparse

import numpy as np

import lin_canny as lc


def arguments():
    options = argparse.ArgumentParser(description="Certifies a timed trajectory of a robot.")
    options.add_argument("urdf")
    options.add_argument("trajectory")
    options.add_argument("--srdf")
    options.add_argument("--cell")
    options.add_argument("--rest", action="store_true", help="stop at each point")
    options.add_argument("--cell-only", action="store_true", help="check the robot against its cell alone")
    options.add_argument("--out", default="trajectory.png")
    return options.parse_args()


def allowed_error(checker, motion, most=0.1):
    """Return a tracking error of all joints, up to `most`, with which the motion is proven free."""
    low, high = 0.0, most
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if checker.certify_trajectory(motion, tube=middle).is_free else (low, middle)
    return low


def draw(checker, motion, verdict, out):
    """Draw the distances of the pairs that come closest, and the proven least clearance of each segment."""
    try:
        import matplotlib
    except ImportError:
        print("no picture: matplotlib is not installed")
        return
    matplotlib.use("Agg")
    axes = lc.plot_clearance(checker, motion)
    if verdict.contact_time is not None:
        axes.axvline(verdict.contact_time, color="red", label=" - ".join(verdict.pair))
    axes.set(xlabel="time in s", ylabel="distance in m")
    axes.figure.legend(loc="outside right upper", fontsize="small")
    axes.figure.savefig(out, dpi=150)
    print(f"picture in {out}")


def main():
    given = arguments()
    robot = lc.Robot.load(given.urdf, given.srdf)
    checker = lc.Checker(robot, cell=given.cell)
    if given.cell_only:
        own = [name for name, body in zip(checker.bodies, checker.ids) if body.kind == "robot"]
        checker.exclude(own, own)
    motion = lc.Trajectory.load(given.trajectory, checker)
    if given.rest:
        still = np.zeros_like(motion.positions)
        motion = lc.Trajectory(motion.times, motion.positions, still, names=motion.names)
    verdict = checker.certify_trajectory(motion)
    print(f"{motion}: {verdict}")
    if verdict.is_free:
        error = allowed_error(checker, motion)
        print(f"proven free with a tracking error of {error:.4f} rad or m of every joint")
    draw(checker, motion, verdict, given.out)


if __name__ == "__main__":
    main()
