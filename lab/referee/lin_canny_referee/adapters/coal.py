"""coal: signed distance, points and normal, in double precision. Tolerances of GJK and EPA are 1e-6, and its headers
advise no less. Careful: hulls of the given faces instead of qhull's, a tolerance below the advised one, and 1,000
iterations. A body with more than 255 neighbours of a vertex is refused. A distance of -1.8e308 means "no depth"."""

import time

import coal
import numpy as np

from ..adapter import Adapter, Answer, Tolerance, triangles

NO_DEPTH = -1e300


class Engine(Adapter):
    package = "coal"
    options = {
        "default": "tolerances 1e-6, 128 and 64 iterations, hulls by qhull",
        "careful": "tolerances 1e-8, 1000 iterations, hulls of the given faces",
    }
    tolerance = Tolerance(1e-6, 1e-6)
    code = """import coal, numpy as np; q = coal.DistanceRequest(); q.enable_signed_distance = True{careful}
a, b = (((s := coal.StdVec_Vec3s()), [s.append(np.array(p, float)) for p in v], coal.Convex.convexHull(s, False, ""), coal.Transform3s(np.array(r, float), np.array(t, float)))[2:] for v, r, t in (({a}, {ra}, {ta}), ({b}, {rb}, {tb})))
print(coal.distance(*a, *b, q, coal.DistanceResult()))"""
    careful_code = "; q.gjk_tolerance = q.epa_tolerance = 1e-8; q.gjk_max_iterations = q.epa_max_iterations = 1000"

    def __init__(self, careful, tolerance=1e-8):
        super().__init__(careful)
        self.request = coal.DistanceRequest()
        self.request.enable_signed_distance = True
        if careful:
            self.request.gjk_tolerance = self.request.epa_tolerance = tolerance
            self.request.gjk_max_iterations = self.request.epa_max_iterations = 1000

    def body(self, points, faces):
        vertices = coal.StdVec_Vec3s()
        for p in points:
            vertices.append(np.array(p, float))
        if not self.careful:
            return coal.Convex.convexHull(vertices, False, "")
        list_of_triangles = coal.StdVec_Triangle()
        for t in triangles(faces):
            list_of_triangles.append(coal.Triangle(*t))
        return coal.Convex(vertices, list_of_triangles)

    def ask(self, a, pose_a, b, pose_b):
        xa, xb = (coal.Transform3s(np.array(p.matrix), np.array(p.position)) for p in (pose_a, pose_b))
        result = coal.DistanceResult()
        start = time.perf_counter_ns()
        coal.distance(a, xa, b, xb, self.request, result)
        ns = time.perf_counter_ns() - start
        if result.min_distance < NO_DEPTH:
            return Answer(None, None, None, None, ns, "pen")
        pa, pb = result.getNearestPoint1(), result.getNearestPoint2()
        return Answer(result.min_distance, pa, pb, result.normal, ns)
