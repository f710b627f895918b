"""distance3d: GJK and, in overlap, EPA, in double precision by numba; no points in overlap. Default: squared distances
above 1e5 are "infinite". Careful: no such limit, tolerance 1e-14, 1,000 iterations of EPA."""

import time
import warnings

import numpy as np

warnings.filterwarnings("ignore")
from distance3d import colliders, epa, gjk  # noqa: E402

from ..adapter import Adapter, Answer, Tolerance  # noqa: E402


class Engine(Adapter):
    package = "distance3d"
    options = {"default": "distances up to 316", "careful": "any distance, tolerance 1e-14, 1000 iterations"}
    tolerance = Tolerance(1e-6, 1e-6)
    code = """from distance3d import colliders, epa, gjk; import numpy as np
a, b = (colliders.ConvexHullVertices(np.array(v, float) @ np.array(r).T + t) for v, r, t in (({a}, {ra}, {ta}), ({b}, {rb}, {tb})))
d, p, q, s = gjk.gjk(a, b{careful}); x, _, ok = epa.epa(s, a, b); print(d or (-np.linalg.norm(x) if ok else "no depth"))"""
    careful_code = ", tolerance=1e-14, max_distance_squared=1.79e308"

    def body(self, points, faces):
        return np.array(points, float)

    def ask(self, a, pose_a, b, pose_b):
        a, b = (
            colliders.ConvexHullVertices(v @ np.array(p.matrix).T + np.array(p.position))
            for v, p in ((a, pose_a), (b, pose_b))
        )
        of_gjk, of_epa = {}, {}
        if self.careful:
            of_gjk = dict(tolerance=1e-14, max_distance_squared=1.79e308)
            of_epa = dict(max_iter=1000, max_loose_edges=2048, max_faces=4096, epsilon=1e-14)
        start = time.perf_counter_ns()
        distance, pa, pb, simplex = gjk.gjk(a, b, **of_gjk)
        if distance > 1e300:
            raise ValueError("beyond the greatest distance")
        if distance > 0:
            ns = time.perf_counter_ns() - start
            return Answer(distance, pa, pb, (pb - pa) / np.linalg.norm(pb - pa), ns)
        shift, _, is_found = epa.epa(simplex, a, b, **of_epa)
        ns = time.perf_counter_ns() - start
        if not is_found:
            return Answer(None, None, None, None, ns, "pen")
        depth = np.linalg.norm(shift)
        return Answer(-depth, None, None, shift / depth if depth > 0 else None, ns, "pen" if depth == 0 else None)
