"""Drake: signed distance, points and normal, in double precision; FCL and libccd inside, with a fixed tolerance of 1e-6.
Drake orders a pair its own way and gives points in body frames. Its documentation allows NaN as normal at contact."""

import time

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import Convex, FramePoseVector, GeometryFrame, GeometryInstance
from pydrake.geometry import ProximityProperties, SceneGraph
from pydrake.math import RigidTransform, RotationMatrix

from ..adapter import Adapter, Answer, Tolerance


class Engine(Adapter):
    package = "drake"
    options = {"default": "no option"}
    tolerance = Tolerance(1e-6, 1e-6)
    code = """from pydrake.all import *; import numpy as np; g = SceneGraph(); s = g.RegisterSource("s"); x = lambda t, q: RigidTransform(Quaternion([q[3], *q[:3]]), t)
i = [g.RegisterAnchoredGeometry(s, GeometryInstance(x(t, q), Convex(np.array(v).T, n), n)) for n, v, t, q in (("a", {a}, {ta}, {qa}), ("b", {b}, {tb}, {qb}))]; [g.AssignRole(s, k, ProximityProperties()) for k in i]
print(g.get_query_output_port().Eval(g.CreateDefaultContext()).ComputeSignedDistancePairClosestPoints(*i).distance)"""
    last = (None, None)

    def body(self, points, faces):
        convex = Convex(np.array(points, float).T, "body")
        convex.GetConvexHull()
        return convex

    def scene(self, a, b):
        if self.last[0] != (id(a), id(b)):
            graph = SceneGraph()
            source = graph.RegisterSource("referee")
            frames = [graph.RegisterFrame(source, GeometryFrame(name)) for name in "ab"]
            ids = []
            for frame, convex, name in zip(frames, (a, b), "ab"):
                ids.append(graph.RegisterGeometry(source, frame, GeometryInstance(RigidTransform(), convex, name)))
                graph.AssignRole(source, ids[-1], ProximityProperties())
            self.last = (id(a), id(b)), (graph, source, frames, ids, graph.CreateDefaultContext())
        return self.last[1]

    def ask(self, a, pose_a, b, pose_b):
        graph, source, frames, ids, context = self.scene(a, b)
        poses = FramePoseVector()
        x, y = (
            RigidTransform(RotationMatrix(Quaternion(np.array([p.quaternion[3], *p.quaternion[:3]]))), np.array(p.position))
            for p in (pose_a, pose_b)
        )
        poses.set_value(frames[0], x)
        poses.set_value(frames[1], y)
        graph.get_source_pose_port(source).FixValue(context, poses)
        query = graph.get_query_output_port().Eval(context)
        query.ComputeSignedDistancePairClosestPoints(*ids)  # the first call also updates the poses
        start = time.perf_counter_ns()
        r = query.ComputeSignedDistancePairClosestPoints(*ids)
        ns = time.perf_counter_ns() - start
        if r.id_A == ids[0]:
            return Answer(r.distance, x @ r.p_ACa, y @ r.p_BCb, -r.nhat_BA_W, ns)
        return Answer(r.distance, x @ r.p_BCb, y @ r.p_ACa, r.nhat_BA_W, ns)
