"""Towers of ten prisms in MuJoCo, for the example `towers` of lin-canny-rapier.

    pip install mujoco
    python bench/towers.py mujoco.csv
    cargo run --release -p lin-canny-rapier --example towers -- --with mujoco.csv

Hulls as meshes, default contact parameters, friction 0.5, gravity along -y, as long as 1,000 steps of
1/240 s, in steps of 2 ms, its default.
"""

import argparse

import mujoco
import numpy as np

SIZES, SIDES, PRISMS, SECONDS, STEP = (1.0, 0.1, 0.02), (4, 6, 12, 32), 10, 1000 / 240, 0.002


def model(size, sides):
    """Return the model of a tower of prisms that are half as high as wide."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    ring = 0.5 * size * np.stack([np.cos(angle), np.sin(angle)], 1)
    points = [(x, y, z) for y in (-0.25 * size, 0.25 * size) for x, z in ring]
    vertices = " ".join(f"{c:.9g}" for p in points for c in p)
    body = '<body pos="0 {y:.9g} 0"><freejoint/><geom type="mesh" mesh="prism" density="1" friction="0.5"/></body>'
    bodies = "".join(body.format(y=0.25 * size + 0.5 * size * k) for k in range(PRISMS))
    ground = f'<geom type="box" size="{9 * size} {0.5 * size} {9 * size}" pos="0 {-0.5 * size} 0" friction="0.5"/>'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 -9.81 0" timestep="{STEP}"/>'
        f'<asset><mesh name="prism" vertex="{vertices}" inertia="convex"/></asset>'
        f"<worldbody>{ground}{bodies}</worldbody></mujoco>"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", help="the CSV file to write")
    path = parser.parse_args().out
    with open(path, "w") as out:
        print("engine,size,sides,prism,x,y,z,qx,qy,qz,qw", file=out)
        for size in SIZES:
            for sides in SIDES:
                tower = model(size, sides)
                data = mujoco.MjData(tower)
                for _ in range(round(SECONDS / STEP)):
                    mujoco.mj_step(tower, data)
                for k in range(PRISMS):
                    x, y, z, qw, qx, qy, qz = data.qpos[7 * k : 7 * k + 7]
                    print(f"MuJoCo,{size},{sides},{k},{x},{y},{z},{qx},{qy},{qz},{qw}", file=out)


if __name__ == "__main__":
    main()
