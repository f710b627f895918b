"""MuJoCo: signed distance and its segment, computed in double precision on vertices in single precision, which are moved
to a frame of inertia. Meshes of tiny area are refused. Careful: ccd_tolerance 1e-14 and 1,000 iterations instead of 1e-6
and 35. A model is compiled for each pair of bodies, not timed."""

import time

import mujoco as mj
import numpy as np

from ..adapter import Adapter, Answer, Tolerance, triangles, used


class Engine(Adapter):
    package = "mujoco"
    precision = "single"
    options = {"default": "ccd_tolerance 1e-6, 35 iterations", "careful": "ccd_tolerance 1e-14, 1000 iterations"}
    tolerance = Tolerance(1e-6, 1e-6)
    code = """import mujoco as mj, numpy as np; s = mj.MjSpec(); shell = mj.mjtMeshInertia.mjMESH_INERTIA_SHELL; mesh = mj.mjtGeom.mjGEOM_MESH{careful}
for n, v, f, t, q in (("a", {a}, {fa}, {ta}, {qa}), ("b", {b}, {fb}, {tb}, {qb})): s.add_mesh(name=n, uservert=np.ravel(v), userface=np.ravel(f), inertia=shell); s.worldbody.add_body(pos=t, quat=[q[3], *q[:3]]).add_geom(type=mesh, meshname=n)
m = s.compile(); d = mj.MjData(m); mj.mj_kinematics(m, d); print(mj.mj_geomDistance(m, d, 0, 1, 1e30, np.zeros(6)))"""
    careful_code = "; s.option.ccd_tolerance = 1e-14; s.option.ccd_iterations = 1000"
    last = (None, None)

    def body(self, points, faces):
        vertices, faces = used(points, faces)
        flat = [i for t in triangles(faces) for i in t]
        body = (np.array(vertices, float).ravel(), flat)
        self.compiled(body, body)  # refuses what no model can hold
        return body

    def compiled(self, a, b):
        if self.last[0] != (id(a), id(b)):
            spec = mj.MjSpec()
            for name, (vertices, faces) in zip("ab", (a, b)):
                inertia = mj.mjtMeshInertia.mjMESH_INERTIA_SHELL
                spec.add_mesh(name=name, uservert=vertices, userface=faces, inertia=inertia)
                body = spec.worldbody.add_body(name=name, mocap=True)
                body.add_geom(type=mj.mjtGeom.mjGEOM_MESH, meshname=name)
            if self.careful:
                spec.option.ccd_tolerance, spec.option.ccd_iterations = 1e-14, 1000
            model = spec.compile()
            self.last = (id(a), id(b)), (model, mj.MjData(model))
        return self.last[1]

    def ask(self, a, pose_a, b, pose_b):
        model, data = self.compiled(a, b)
        for k, p in enumerate((pose_a, pose_b)):
            data.mocap_pos[k], data.mocap_quat[k] = p.position, [p.quaternion[3], *p.quaternion[:3]]
        mj.mj_kinematics(model, data)
        segment = np.zeros(6)
        start = time.perf_counter_ns()
        distance = mj.mj_geomDistance(model, data, 0, 1, 1e30, segment)
        ns = time.perf_counter_ns() - start
        along = segment[3:] - segment[:3]
        length = np.linalg.norm(along)
        normal = along / length * np.sign(distance) if length > 0 else None
        return Answer(distance, segment[:3], segment[3:], normal, ns)
