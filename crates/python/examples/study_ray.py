"""The study of `study.py` on Ray: configurations are a dataset, a checker lives in each actor.

    pip install "ray[data]" matplotlib
    cd crates/robot/examples
    python ../../python/examples/study_ray.py gripper.urdf --srdf gripper.srdf --cell cell.json

On a cluster the files have to be at the same absolute paths on all machines. Ray takes seconds to
start: worth it from minutes of work on; on one machine `threads` of `clearances` is faster.
"""

import os

import ray
from study import arguments, configurations, report

import lin_canny as lc


class Clearances:
    """A checker that answers batches of numbers of configurations."""

    def __init__(self, checker, q):
        self.checker, self.q = checker, q

    def __call__(self, batch):
        found = self.checker.clearances(self.q[batch["id"]])
        return {"id": batch["id"], **{name: found[name] for name in found.dtype.names}}


def main():
    given = arguments()
    urdf, srdf, cell = (path and os.path.abspath(path) for path in (given.urdf, given.srdf, given.cell))
    robot = lc.Robot.load(urdf, srdf)
    checker = lc.Checker(robot, cell=cell)
    q = configurations(robot, given.count, given.seed)
    # For one machine, without a port open to the network; on a cluster `ray.init()` finds the cluster.
    # The actors hold a CPU each, and reading needs one more.
    local = {"include_dashboard": False, "_node_ip_address": "127.0.0.1", "logging_level": "ERROR"}
    ray.init(num_cpus=given.threads + 1, **local)
    found = ray.data.range(given.count).map_batches(
        Clearances,
        fn_constructor_args=(checker, q),
        batch_size=1024,
        compute=ray.data.ActorPoolStrategy(size=given.threads),
    )
    table = found.to_pandas().sort_values("id")
    ray.shutdown()
    names = checker.bodies
    report(table["distance"].to_numpy(), [(names[a], names[b]) for a, b in zip(table["a"], table["b"])], given.out)


if __name__ == "__main__":
    main()
