"""pybullet, built in double precision: contact distance, points and normal. Its hull rounds points to a grid, so it is
judged on the points that it keeps. Default: its margin of 0.001 around each body, subtracted from the answer. Careful:
margin 0, which its authors do not advise for deep overlap."""

import time

import numpy as np
import pybullet

from ..adapter import Adapter, Answer, Tolerance, triangles

MARGIN = 0.001


class Engine(Adapter):
    package = "pybullet"
    options = {"default": "margin 0.001 a body, subtracted", "careful": "margin 0"}
    tolerance = Tolerance(1e-6, 1e-6)
    code = """import pybullet as p; p.connect(p.DIRECT)
a, b = (p.createMultiBody(0, p.createCollisionShape(p.GEOM_MESH, vertices=v), basePosition=t, baseOrientation=q) for v, t, q in (({a}, {ta}, {qa}), ({b}, {tb}, {qb}))){careful}
print(min(x[8] for x in p.getClosestPoints(a, b, 1e17)))"""
    careful_code = "; [p.changeDynamics(x, -1, collisionMargin=0) for x in (a, b)]"

    def __init__(self, careful):
        super().__init__(careful)
        pybullet.connect(pybullet.DIRECT)

    def body(self, points, faces):
        """Two equal bodies, because a body has no distance from itself."""
        triangles(faces)  # refuses a flat body
        shapes = [pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=points) for _ in range(2)]
        bodies = [pybullet.createMultiBody(baseMass=0, baseCollisionShapeIndex=s) for s in shapes]
        if min(bodies) < 0 or min(shapes) < 0:
            raise ValueError("refused")
        if self.careful:
            for b in bodies:
                pybullet.changeDynamics(b, -1, collisionMargin=0)
        return bodies

    def kept(self, points, faces):
        bodies = self.body(points, faces)
        found = pybullet.getMeshData(bodies[0])[1]
        for b in bodies:
            pybullet.removeBody(b)
        return found

    def ask(self, a, pose_a, b, pose_b):
        a, b = a[0], b[1]
        pybullet.resetBasePositionAndOrientation(a, pose_a.position, pose_a.quaternion)
        pybullet.resetBasePositionAndOrientation(b, pose_b.position, pose_b.quaternion)
        start = time.perf_counter_ns()
        found = pybullet.getClosestPoints(a, b, 1e17)
        ns = time.perf_counter_ns() - start
        best = min(found, key=lambda contact: contact[8])  # fails if there are none
        normal, margin = -np.array(best[7]), 0 if self.careful else MARGIN
        pa, pb = np.array(best[5]) - margin * normal, np.array(best[6]) + margin * normal
        return Answer(best[8] + 2 * margin, pa, pb, normal, ns)
