"""python-fcl (FCL with libccd): signed distance and points, in double precision; no normal. Its tolerance of 1e-6 cannot
be set from Python. `collide` gives depths of MPR, which are not the least: the signed distance is asked instead.
Careful: FCL's own solver where the bodies are apart."""

import time

import fcl
import numpy as np

from ..adapter import Adapter, Answer, Tolerance, triangles

LIBCCD, INDEPENDENT = 0, 1


class Engine(Adapter):
    package = "python-fcl"
    options = {"default": "libccd", "careful": "the independent solver apart, libccd in overlap"}
    tolerance = Tolerance(1e-6, 1e-6)
    answers = ("distance", "depth", "points")
    code = """import fcl, numpy as np; c = lambda v, f: fcl.Convex(np.array(v), len(f), np.array([x for t in f for x in (3, *t)]))
a, b = (fcl.CollisionObject(c(v, f), fcl.Transform(np.array(r), np.array(t))) for v, f, r, t in (({a}, {fa}, {ra}, {ta}), ({b}, {fb}, {rb}, {tb})))
print(fcl.distance(a, b, fcl.DistanceRequest(True, True, {careful}), fcl.DistanceResult()))"""
    default_code = "0"
    careful_code = "1"

    def body(self, points, faces):
        triangles(faces)  # refuses a flat body
        return fcl.Convex(np.array(points, float), len(faces), np.array([x for f in faces for x in (len(f), *f)]))

    def ask(self, a, pose_a, b, pose_b):
        objects = [
            fcl.CollisionObject(g, fcl.Transform(np.array(p.matrix), np.array(p.position, float)))
            for g, p in ((a, pose_a), (b, pose_b))
        ]
        solvers = [INDEPENDENT, LIBCCD] if self.careful else [LIBCCD]
        ns = 0
        for solver in solvers:
            request, result = fcl.DistanceRequest(True, True, solver), fcl.DistanceResult()
            start = time.perf_counter_ns()
            distance = fcl.distance(*objects, request, result)
            ns += time.perf_counter_ns() - start
            if distance > 0:
                break
        return Answer(distance, *result.nearest_points, None, ns)
