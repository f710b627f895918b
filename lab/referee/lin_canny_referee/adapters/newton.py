"""newton (on warp, CPU, single precision): contacts within `gap`, many pairs in one call. Bodies are enlarged by 1e-4, so
that is its tolerance; depths by MPR are not the least. Default: the builder's gap of 0.1. Careful: a gap of 4 L."""

import math
import time

import newton
import numpy as np
import warp

from ..adapter import Adapter, Answer, Tolerance, triangles

warp.config.quiet = True


class Engine(Adapter):
    package = "newton"
    precision = "single"
    options = {"default": "gap 0.1", "careful": "gap 4 L"}
    tolerance = Tolerance(1e-4, 1e-6)
    code = """import newton, numpy as np, warp as wp; B, c = newton.ModelBuilder(), newton.ModelBuilder.ShapeConfig(density=0, margin=0.0); X = [wp.transform(wp.vec3(*t), wp.quat(*q)) for t, q in (({ta}, {qa}), ({tb}, {qb}))]{careful}
for x, v, f in zip(X, ({a}, {b}), ({fa}, {fb})): B.add_shape_convex_hull(B.add_body(xform=x, mass=1.0), mesh=newton.Mesh(np.array(v, np.float32), np.ravel(f).astype(np.int32), compute_inertia=False), cfg=c)
m = B.finalize(device="cpu"); P = newton.CollisionPipeline(m, broad_phase="explicit", shape_pairs_filtered=wp.array([[0, 1]], dtype=wp.vec2i, device="cpu"), rigid_contact_max=80); k = P.contacts(); P.collide(m.state(), k); g = lambda n: getattr(k, "rigid_contact_" + n).numpy()[: int(k.rigid_contact_count.numpy()[0])]; w = lambda s, p: np.array(wp.transform_point(X[s], wp.vec3(*p))); print(min(((w(t, q) - w(s, p)) @ n for s, t, p, q, n in zip(*map(g, ("shape0", "shape1", "point0", "point1", "normal")))), default="no contact"))"""
    careful_code = "; c.gap = 1e3"

    def body(self, points, faces):
        indices, points = np.array(triangles(faces), np.int32).ravel(), np.array(points, np.float32)
        mesh = newton.Mesh(points, indices, compute_inertia=False)
        return mesh, float(np.linalg.norm(points, axis=1).max())

    def batch(self, cases):
        builder = newton.ModelBuilder()
        for a, pose_a, b, pose_b in cases:
            size = a[1] + b[1] + math.dist(pose_a.position, pose_b.position)
            shape = newton.ModelBuilder.ShapeConfig(density=0, margin=0.0, gap=4 * size if self.careful else None)
            for (mesh, _), p in ((a, pose_a), (b, pose_b)):
                pose = warp.transform(warp.vec3(*p.position), warp.quat(*p.quaternion))
                builder.add_shape_convex_hull(builder.add_body(xform=pose, mass=1.0), mesh=mesh, cfg=shape)
        model, n = builder.finalize(device="cpu"), len(cases)
        pairs = warp.array([[2 * k, 2 * k + 1] for k in range(n)], dtype=warp.vec2i, device="cpu")
        limits = dict(shape_pairs_filtered=pairs, rigid_contact_max=16 * n + 64)
        pipeline = newton.CollisionPipeline(model, broad_phase="explicit", **limits)
        found = pipeline.contacts()
        pipeline.collide(model.state(), found)  # compiles what is missing
        start = time.perf_counter_ns()
        pipeline.collide(model.state(), found)
        ns = (time.perf_counter_ns() - start) // n
        best = [Answer(None, None, None, None, ns, "sep")] * n
        count, names = found.rigid_contact_count.numpy()[0], ("shape0", "shape1", "point0", "point1", "normal")
        for s0, s1, p0, p1, normal in zip(*(getattr(found, f"rigid_contact_{x}").numpy()[:count] for x in names)):
            k = min(s0, s1) // 2
            first, second = (cases[k][3], cases[k][1]) if s0 > s1 else (cases[k][1], cases[k][3])
            v0, v1, normal = np.array(first.matrix) @ p0, np.array(second.matrix) @ p1, normal.astype(float)
            t0, t1 = np.array(first.position), np.array(second.position)
            # From offsets first: world coordinates would lose digits far from the origin.
            answer = Answer(float((v1 - v0 + (t1 - t0)) @ normal), v0 + t0, v1 + t1, normal, ns)
            answer = answer._replace(point_a=answer[2], point_b=answer[1], normal=-normal) if s0 > s1 else answer
            if best[k].distance is None or not answer.distance >= best[k].distance:
                best[k] = answer
        return best
