"""Writes what MuJoCo computes for MJCF files, one JSON object per line, for the ignored test `mjcf`.

    pip install mujoco dm_control
    python poses.py FOLDER_OR_FILE... > poses.jsonl
    MUJOCO_POSES=poses.jsonl cargo test -p lin-canny-robot --test mjcf -- --ignored

With RANDOM=1000 it adds so many small random texts: limits, classes, flags, equalities, free and
ball joints, mocap bodies, excluded and explicit pairs. SEED chooses them. CONFIGURATIONS=2 suffices for pairs.
"""

import json
import os
import pathlib
import sys

try:
    import mujoco
except ImportError:
    sys.exit(print(json.dumps({"skipped": "MuJoCo: not installed"})))
import numpy as np

CONFIGURATIONS = int(os.environ.get("CONFIGURATIONS", 100))
FREE, BALL, SLIDE, HINGE = range(4)
PLANE, HFIELD, MESH = 0, 1, 7
PARTS = ["x", "y", "z", "roll", "pitch", "yaw"]


def name(model, kind, k, other):
    """Returns the name of an element; one without a name gets one that no body, joint or geom of the file has."""
    found = mujoco.mj_id2name(model, kind, k)
    if not found:
        found = f"{other}{k}"
        kinds = [mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_GEOM]
        while any(mujoco.mj_name2id(model, kind, found) >= 0 for kind in kinds):
            found += "_"
    return found


def rpy(roll, pitch, yaw):
    q = np.zeros(4)
    mujoco.mju_euler2Quat(q, np.array([roll, pitch, yaw]), "XYZ")
    return q


def has(model, kind):
    """Returns whether constraints of a kind are in force."""
    bits = mujoco.mjtDisableBit
    return not model.opt.disableflags & int(bits.mjDSBL_CONSTRAINT | getattr(bits, f"mjDSBL_{kind}"))


def followers(model):
    """Returns the joints that an equality drives: joint, leader or -1, coefficients."""
    found = []
    for k in range(model.neq if has(model, "EQUALITY") else 0):
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
    # Contacts are compared as if they were enabled.
    model.opt.disableflags &= ~int(bits.mjDSBL_CONTACT) & ~int(bits.mjDSBL_CONSTRAINT)
    model.opt.enableflags = 0
    model.pair_margin[:] = 1e3
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    if data.warning[int(mujoco.mjtWarning.mjWARN_CONTACTFULL)].number:
        raise mujoco.FatalError("too many pairs for the memory of the model")
    return sorted({tuple(sorted(map(int, c.geom))) for c in data.contact})


def poses(model, data):
    mujoco.mj_kinematics(model, data)
    return [[*data.xpos[k], *data.xquat[k][[1, 2, 3, 0]]] for k in range(model.nbody)]


def follow(model, data):
    """Sets the joints that an equality drives, and returns their numbers."""
    driven = []
    # A leader may follow a joint whose equality comes later.
    for one, other, factors in followers(model) * len(followers(model)):
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


def limits(model):
    """Returns for each hinge and slide that moves by itself whether it is limited, and its range."""
    driven = {int(joint) for joint, _, _ in followers(model)}
    found = {}
    for k in range(model.njnt):
        if model.jnt_type[k] in (SLIDE, HINGE) and k not in driven:
            limited = bool(model.jnt_limited[k]) and has(model, "LIMIT") and np.isfinite(model.jnt_range[k]).any()
            found[name(model, mujoco.mjtObj.mjOBJ_JOINT, k, "joint")] = model.jnt_range[k].tolist() if limited else None
    return found


def collides(model):
    """Returns which geoms collide."""
    found = [bool(model.geom_contype[k] or model.geom_conaffinity[k]) for k in range(model.ngeom)]
    for k in range(model.npair):
        found[model.pair_geom1[k]] = found[model.pair_geom2[k]] = True
    return found


def mocaps(model):
    """Returns the mocap bodies of which something collides."""
    roots = {int(model.body_rootid[model.geom_bodyid[k]]) for k, is_so in enumerate(collides(model)) if is_so}
    return [k for k in range(model.nbody) if model.body_mocapid[k] >= 0 and k in roots]


def chosen(rng):
    """Returns a small random text."""

    def pick(*choices):
        return str(rng.choice(choices))

    def bits():
        return pick("", "", " contype='0'", " conaffinity='0'", " contype='0' conaffinity='0'", " contype='2'")

    def joint():
        return pick("", " range='0 0'", " range='1 -1'", " range='-10 10'", " range='5 5'", " range='-20 30'") + pick(
            "", "", "", "", "", " limited='true'", " limited='false'", " limited='auto'"
        )

    on, off, slide = " active='true'", " active='false'", " type='slide'"
    classes, geoms, bodies, hinges = [""], [], ["world"], []

    def defaults():
        below = ""
        if rng.random() < 0.5:
            classes.append(f" class='c{len(classes)}'")
            below = f"<default{classes[-1]}><joint{joint()}/><equality{pick('', off)}/></default>"
        return f"<default><joint{joint()}/><geom{bits()}/>{below}</default>"

    def geom():
        geoms.append(f"g{len(geoms)}")
        return f"<geom name='{geoms[-1]}' size='.1'{bits()}/>"

    def body(depth):
        bodies.append(f"b{len(bodies)}")
        own, kind, joints = bodies[-1], rng.random(), ""
        mocap = " mocap='true'" if kind < (0.3 if depth == 0 else 0.02) else ""
        if depth == 0 and 0.3 <= kind < 0.5:
            joints = pick("<freejoint/>", f"<joint type='free'{joint()}/>")
        elif not mocap or rng.random() < 0.05:
            if rng.random() < 0.2:
                place = pick("", " pos='.1 -.2 .3'")
                joints += f"<joint name='ball{len(bodies)}' type='ball'{place}{joint()}{pick(*classes)}/>"
            for axis in ["1 0 0", "0 1 0"][: rng.integers(0, 3)]:
                hinges.append(f"j{len(hinges)}")
                joints += f"<joint name='{hinges[-1]}' axis='{axis}'{pick('', slide)}{joint()}{pick(*classes)}/>"
        below = "".join(body(depth + 1) for _ in range(rng.integers(0, 3))) if depth < 2 else ""
        shapes = "".join(geom() for _ in range(rng.integers(0, 3)))
        inertia = "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>"
        return f"<body name='{own}'{mocap}>{inertia}{joints}{shapes}{below}</body>"

    sections = "".join(defaults() for _ in range(rng.integers(0, 3)))
    if rng.random() < 0.3:
        sections += f"<compiler autolimits='{pick('true', 'false')}' angle='{pick('radian', 'degree')}'/>"
    for _ in range(rng.integers(0, 3)):
        flags = " ".join(
            f"{flag}='{pick('enable', 'disable')}'"
            for flag in ["constraint", "equality", "limit", "contact", "filterparent", "multiccd"]
            if rng.random() < 0.25
        )
        sections += f"<option><flag {flags}/></option>"
    world = geom() + "".join(body(0) for _ in range(rng.integers(1, 4)))
    rules = ""
    free = list(hinges)
    rng.shuffle(free)
    while len(free) > 1 and rng.random() < 0.5:
        ends = f"joint1='{free.pop()}'" + pick("", f" joint2='{free[0]}'")
        rules += f"<joint {ends} polycoef='0.1 0.5 0 0 0'{pick('', off, on)}{pick(*classes)}/>"
    contacts = "".join(f"<exclude body1='{pick(*bodies)}' body2='{pick(*bodies)}'/>" for _ in range(rng.integers(0, 3)))
    contacts += "".join(f"<pair geom1='{pick(*geoms)}' geom2='{pick(*geoms)}'/>" for _ in range(rng.integers(0, 3)))
    return f"<mujoco>{sections}<worldbody>{world}</worldbody><equality>{rules}</equality><contact>{contacts}</contact></mujoco>"


def main():
    texts = []
    for argument in map(pathlib.Path, sys.argv[1:]):
        files = sorted(argument.rglob("*.xml")) if argument.is_dir() else [argument]
        texts += [(str(file), None) for file in files]
    rng = np.random.default_rng(int(os.environ.get("SEED", 7)))
    texts += [(f"random {k}", chosen(rng)) for k in range(int(os.environ.get("RANDOM", 0)))]
    for file, text in texts:
        try:
            model = mujoco.MjModel.from_xml_string(text) if text else mujoco.MjModel.from_xml_path(file)
        except ValueError as error:
            print(json.dumps({"file": file, "text": text, "error": str(error).splitlines()[0]}))
            continue
        data = mujoco.MjData(model)
        random = np.random.default_rng(7)
        joints = [name(model, mujoco.mjtObj.mjOBJ_JOINT, k, "joint") for k in range(model.njnt)]
        bodies = [name(model, mujoco.mjtObj.mjOBJ_BODY, k, "body") for k in range(model.nbody)]
        configurations = [{"values": None, "poses": drawn(model, data), "qpos": data.qpos.tolist()}]
        for _ in range(CONFIGURATIONS):
            values = {}
            for k in mocaps(model):
                xyz, angles = random.uniform(-1, 1, 3), random.uniform(-3, 3, 3)
                data.mocap_pos[model.body_mocapid[k]], data.mocap_quat[model.body_mocapid[k]] = xyz, rpy(*angles)
                for part, value in zip(PARTS, [*xyz, *angles]):
                    values[f"{bodies[k]}:mocap/{part}"] = value
            for k in range(model.njnt):
                at = model.jnt_qposadr[k]
                if model.jnt_type[k] == FREE:
                    xyz, angles = random.uniform(-1, 1, 3), random.uniform(-3, 3, 3)
                    data.qpos[at : at + 3], data.qpos[at + 3 : at + 7] = xyz, rpy(*angles)
                    for part, value in zip(PARTS, [*xyz, *angles]):
                        values[f"{joints[k]}/{part}"] = value
                elif model.jnt_type[k] == BALL:
                    limited = model.jnt_limited[k] and has(model, "LIMIT")
                    most = min(max(model.jnt_range[k]), 3) if limited else 3
                    angles = random.uniform(-most, most, 3)
                    data.qpos[at : at + 4] = rpy(*angles)
                    for part, value in zip(PARTS[3:], angles):
                        values[f"{joints[k]}/{part}"] = value
                else:
                    low, high = limits(model).get(joints[k]) or (-3, 3)
                    data.qpos[at] = values[joints[k]] = random.uniform(max(low, -1e3), min(high, 1e3))
            for joint in follow(model, data):
                values.pop(joints[joint], None)
            configurations.append({"values": values, "poses": poses(model, data), "qpos": data.qpos.tolist()})
        geoms = []
        for k in range(model.ngeom):
            geom = {
                "body": int(model.geom_bodyid[k]),
                "name": mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, k),
                "type": int(model.geom_type[k]),
                "size": model.geom_size[k].tolist(),
                "pose": [*model.geom_pos[k], *model.geom_quat[k][[1, 2, 3, 0]]],
                "collides": collides(model)[k],
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
        line = {
            "file": file,
            "text": text,
            "bodies": bodies,
            "widths": [[7, 4, 1, 1][kind] for kind in model.jnt_type],
            "limits": limits(model),
            "holds": any(leader < 0 for _, leader, _ in followers(model)),
            "geoms": geoms,
            "configurations": configurations,
        }
        try:
            line["pairs"] = pairs(model, data)
        except mujoco.FatalError as error:
            line = {"file": file, "text": text, "error": str(error).splitlines()[0]}
        print(json.dumps(line))


main()
