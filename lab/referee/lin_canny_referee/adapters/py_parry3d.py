"""py-parry3d (parry, single precision): whether two hulls meet, and nothing else."""

import time
import types

import numpy as np
import py_parry3d

from ..adapter import Adapter, Answer, Tolerance, triangles

py_parry3d.set_num_threads(1)


class Engine(Adapter):
    package = "py-parry3d"
    precision = "single"
    options = {"default": "no option"}
    tolerance = Tolerance(0.0, 1e-6)
    answers = ()
    code = """import numpy as np, py_parry3d as pp, types; h = lambda v, f: pp.ConvexHull_from_trimesh(types.SimpleNamespace(vertices=np.array(v, float), faces=np.array(f, np.uint32)))
w = pp.CollisionWorld([pp.CollisionGroup("a", [h({a}, {fa})]), pp.CollisionGroup("b", [h({b}, {fb})])]); x = lambda r, t: np.vstack([np.column_stack([r, t]), [0, 0, 0, 1]])[None]
print(w.check(dict(a=x({ra}, {ta}), b=x({rb}, {tb})), [("a", "b", 0.0)]))"""

    def body(self, points, faces):
        mesh = types.SimpleNamespace(vertices=np.array(points, float), faces=np.array(triangles(faces), np.uint32))
        return py_parry3d.ConvexHull_from_trimesh(mesh)

    def ask(self, a, pose_a, b, pose_b):
        world = py_parry3d.CollisionWorld([py_parry3d.CollisionGroup("a", [a]), py_parry3d.CollisionGroup("b", [b])])
        poses = {}
        for name, p in (("a", pose_a), ("b", pose_b)):
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = p.matrix, p.position
            poses[name] = matrix[None]
        start = time.perf_counter_ns()
        hit = world.check(poses, [("a", "b", 0.0)])
        ns = time.perf_counter_ns() - start
        return Answer(None, None, None, None, ns, "pen" if np.ravel(hit)[0] else "sep")
