"""Writes what MuJoCo computes for MJCF files, one JSON object per line, for the ignored test `mjcf`.

    pip install mujoco dm_control
    python poses.py FOLDER_OR_FILE... > poses.jsonl
    MUJOCO_POSES=poses.jsonl cargo test -p lin-canny-robot --test mjcf -- --ignored
"""

import json
import os
import pathlib
import sys

import mujoco
import numpy as np

CONFIGURATIONS = int(os.environ.get("CONFIGURATIONS", 100))
FREE, BALL, SLIDE, HINGE = range(4)
PLANE, HFIELD, MESH = 0, 1, 7


def name(model, kind, k, other):
    return mujoco.mj_id2name(model, kind, k) or f"{other}{k}"


def rpy(roll, pitch, yaw):
    q = np.zeros(4)
    mujoco.mju_euler2Quat(q, np.array([roll, pitch, yaw]), "XYZ")
    return q


def followers(model):
    """Returns the joints that an equality drives: joint, leader or -1, coefficients."""
    found = []
    for k in range(model.neq):
        if model.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT and model.eq_active0[k]:
            found.append((model.eq_obj1id[k], model.eq_obj2id[k], model.eq_data[k][:5]))
    return found


def pairs(model, data):
    """Returns the pairs of geoms that MuJoCo checks: those in contact if all are balls with huge margins."""
    model.geom_type[:] = mujoco.mjtGeom.mjGEOM_SPHERE
    model.geom_size[:] = 0.01
    model.geom_rbound[:] = 0.01
    model.geom_margin[:] = 1e3
    model.body_margin[:] = 1e3
    bits = mujoco.mjtDisableBit
    model.opt.disableflags |= int(bits.mjDSBL_MIDPHASE)
    model.opt.disableflags &= ~int(bits.mjDSBL_CONTACT) & ~int(bits.mjDSBL_CONSTRAINT)
    model.pair_margin[:] = 1e3
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    return sorted({tuple(sorted(map(int, c.geom))) for c in data.contact})


def poses(model, data):
    mujoco.mj_kinematics(model, data)
    return [[*data.xpos[k], *data.xquat[k][[1, 2, 3, 0]]] for k in range(model.nbody)]


def follow(model, data):
    """Sets the joints that an equality drives, and returns their numbers."""
    driven = []
    for one, other, factors in followers(model):
        move = 0.0
        if other >= 0:
            leader = model.jnt_qposadr[other]
            move = data.qpos[leader] - model.qpos0[leader]
        at = model.jnt_qposadr[one]
        data.qpos[at] = model.qpos0[at] + sum(c * move**i for i, c in enumerate(factors))
        driven.append(one)
    return driven


def drawn(model, data):
    """Returns the poses where the file draws the bodies, but for joints that an equality drives."""
    data.qpos[:] = model.qpos0
    follow(model, data)
    return poses(model, data)


def main():
    files = []
    for argument in map(pathlib.Path, sys.argv[1:]):
        files += sorted(argument.rglob("*.xml")) if argument.is_dir() else [argument]
    for file in files:
        try:
            model = mujoco.MjModel.from_xml_path(str(file))
        except ValueError as error:
            print(json.dumps({"file": str(file), "error": str(error)}))
            continue
        data = mujoco.MjData(model)
        random = np.random.default_rng(7)
        joints = [name(model, mujoco.mjtObj.mjOBJ_JOINT, k, "joint") for k in range(model.njnt)]
        bodies = [name(model, mujoco.mjtObj.mjOBJ_BODY, k, "body") for k in range(model.nbody)]
        configurations = [{"values": None, "poses": drawn(model, data)}]
        for _ in range(CONFIGURATIONS):
            values = {}
            for k in range(model.njnt):
                at = model.jnt_qposadr[k]
                if model.jnt_type[k] == FREE:
                    xyz, angles = random.uniform(-1, 1, 3), random.uniform(-3, 3, 3)
                    data.qpos[at : at + 3], data.qpos[at + 3 : at + 7] = xyz, rpy(*angles)
                    for part, value in zip(["x", "y", "z", "roll", "pitch", "yaw"], [*xyz, *angles]):
                        values[f"{joints[k]}/{part}"] = value
                elif model.jnt_type[k] != BALL:
                    low, high = model.jnt_range[k] if model.jnt_limited[k] else (-3, 3)
                    data.qpos[at] = values[joints[k]] = random.uniform(low, high)
            for joint in follow(model, data):
                values.pop(joints[joint], None)
            configurations.append({"values": values, "poses": poses(model, data)})
        geoms = []
        for k in range(model.ngeom):
            geom = {
                "body": int(model.geom_bodyid[k]),
                "name": mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, k),
                "type": int(model.geom_type[k]),
                "size": model.geom_size[k].tolist(),
                "pose": [*model.geom_pos[k], *model.geom_quat[k][[1, 2, 3, 0]]],
                "collides": bool(model.geom_contype[k] or model.geom_conaffinity[k]),
                "points": [],
            }
            which = model.geom_dataid[k]
            if model.geom_type[k] == MESH:
                first = model.mesh_vertadr[which]
                geom["points"] = model.mesh_vert[first : first + model.mesh_vertnum[which]].tolist()
            if model.geom_type[k] == HFIELD:
                first, rows, columns = model.hfield_adr[which], model.hfield_nrow[which], model.hfield_ncol[which]
                x, y, high, _ = model.hfield_size[which]
                heights = model.hfield_data[first : first + rows * columns].reshape(rows, columns)
                geom["size"] = model.hfield_size[which].tolist()
                for r in range(rows):
                    for c in range(columns):
                        at = [x * (2 * c / (columns - 1) - 1), y * (2 * r / (rows - 1) - 1), high * float(heights[r, c])]
                        geom["points"].append(at)
            geoms.append(geom)
        for k in range(model.npair):
            for geom in (model.pair_geom1[k], model.pair_geom2[k]):
                geoms[geom]["collides"] = True
        print(
            json.dumps(
                {
                    "file": str(file),
                    "bodies": bodies,
                    "geoms": geoms,
                    "configurations": configurations,
                    "pairs": pairs(model, data),
                }
            )
        )


main()
