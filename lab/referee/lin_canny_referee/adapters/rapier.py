"""rapier's Python package (parry, single precision): contact manifolds within a prediction distance; the deepest point
gives distance, points and normal. Default: its own hull, a prediction of 1,000. Careful: the given faces, and a
prediction of 4 times the size of the pair."""

import math
import time

import numpy as np
import rapier3d

from ..adapter import Adapter, Answer, Tolerance, triangles

SIMPLEX = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


class Engine(Adapter):
    package = "rapier3d"
    precision = "single"
    options = {"default": "its own hulls, prediction 1000", "careful": "the given faces, prediction 4 L"}
    tolerance = Tolerance(0.0, 1e-6)
    code = """import rapier3d as r; w = r.PhysicsWorld(); add = lambda v, f, t, q: w.add_collider({careful}.build(), w.add_body(r.RigidBodyBuilder(r.RigidBodyType.DYNAMIC).position((tuple(t), tuple(q)))))
h = add({a}, {fa}, {ta}, {qa}), add({b}, {fb}, {tb}, {qb}); w.collision_pipeline.step(1e3, w.islands, w.broad_phase, w.narrow_phase, w.rigid_bodies, w.colliders)
print(min((k.dist for m in w.narrow_phase.contact_pair(*h).manifolds for k in m.points), default="no contact"))"""
    default_code = "r.Collider.convex_hull(v)"
    careful_code = "r.Collider.convex_mesh(v, f)"

    def body(self, points, faces):
        list_of_triangles = triangles(faces)
        kind = rapier3d.SharedShape
        shape = kind.convex_mesh(points, list_of_triangles) if self.careful else kind.convex_hull(points)
        if shape is None:
            raise ValueError("refused")
        return shape, max(math.hypot(*p) for p in points)

    def ask(self, a, pose_a, b, pose_b):
        apart = math.dist(pose_a.position, pose_b.position)
        prediction = 4 * (a[1] + b[1] + apart) if self.careful else 1e3
        world, handles = rapier3d.PhysicsWorld(), []
        for (shape, _), p in ((a, pose_a), (b, pose_b)):
            builder = rapier3d.RigidBodyBuilder(rapier3d.RigidBodyType.DYNAMIC)
            body = world.add_body(builder.position((tuple(p.position), tuple(p.quaternion))))
            collider = rapier3d.Collider.convex_hull(SIMPLEX).build()
            collider.shape = shape
            handles.append(world.add_collider(collider, body))
        parts = (world.islands, world.broad_phase, world.narrow_phase, world.rigid_bodies, world.colliders)
        start = time.perf_counter_ns()
        world.collision_pipeline.step(prediction, *parts)
        ns = time.perf_counter_ns() - start
        pair = world.narrow_phase.contact_pair(*handles)
        found = [(k.dist, k, m) for m in (pair.manifolds if pair else []) for k in m.points]
        if not found:
            return Answer(None, None, None, None, ns, "sep")
        distance, contact, manifold = min(found, key=lambda x: x[0])
        is_first = pair.collider1 == handles[0]
        locals_ = (contact.local_p1, contact.local_p2) if is_first else (contact.local_p2, contact.local_p1)
        n = np.array([manifold.data.normal.x, manifold.data.normal.y, manifold.data.normal.z])
        pa, pb = (np.array(p.matrix) @ (x.x, x.y, x.z) + p.position for p, x in zip((pose_a, pose_b), locals_))
        return Answer(distance, pa, pb, n if is_first else -n, ns)
