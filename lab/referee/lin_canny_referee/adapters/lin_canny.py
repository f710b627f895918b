"""lin-canny: signed distance with bounds, points and normal, in double precision. No options: each case is cold."""

import time

import lin_canny as lc

from ..adapter import Adapter, Answer, Tolerance

STATES = {"separated": "sep", "touching": "touch", "overlapping": "pen"}


class Engine(Adapter):
    package = "lin-canny"
    tolerance = Tolerance(0.0, 1e-12)
    options = {"default": "a new tracker for each case"}
    code = """import lin_canny as lc
a, b = lc.Geometry.hull({a}), lc.Geometry.hull({b})
print(lc.PairTracker().closest(a, b, ({ta}, {qa}), ({tb}, {qb})).distance)"""

    def body(self, points, faces):
        if faces:
            return lc.Geometry.hull(points)
        flat = {1: lambda: lc.Geometry.point(points[0]), 2: lambda: lc.Geometry.segment(*points)}
        return flat.get(len(points), lambda: lc.Geometry.polygon(points))()

    def ask(self, a, pose_a, b, pose_b):
        pa, pb = (pose_a.position, pose_a.quaternion), (pose_b.position, pose_b.quaternion)
        start = time.perf_counter_ns()
        r = lc.PairTracker().closest(a, b, pa, pb)
        ns = time.perf_counter_ns() - start
        return Answer(r.distance, r.point_a, r.point_b, r.normal, ns, STATES[r.state])
