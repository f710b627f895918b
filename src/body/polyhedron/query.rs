//! Queries on one body: extreme vertex, containment, closest point.

use nalgebra::{Point3, Vector3};

use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::sqrt;
use crate::base::num::sign::{projection, turn};
use crate::base::tolerance::{FAR_POINT, FOOT, NEAR_PLANE};
use crate::body::polyhedron::build::cloud::flush_below;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, HalfEdgeId, VertexId};

impl ConvexPolyhedron {
    /// Returns a support vertex along a direction of any length.
    ///
    /// It is proven up to the rounding of `direction . vertex`. Of equal vertices the one with the
    /// lowest id is returned. For a direction that is zero or not finite the result is vertex 0.
    /// The call examines only a few vertices.
    #[doc(alias = "support")]
    #[must_use]
    pub fn extreme_vertex(&self, direction: &Vector3<f64>) -> VertexId {
        let size = direction.amax();
        if !(size > 0.0 && size.is_finite()) {
            return VertexId(0);
        }
        let direction = direction / size;
        self.support_certified(&direction, self.lookup.cell(&direction)).vertex
    }

    /// Returns whether the closed body, surface included, contains a point.
    ///
    /// The answer is exact for the stored body; coordinates of the point below 2^-200 of the body's
    /// radius count as zero, as for the vertices. The answer is `false` for a point that is not
    /// finite. Faces are tested one by one until one excludes the point, so the time is linear in
    /// the number of faces.
    #[must_use]
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.side_of(point) <= 0
    }

    /// Returns the side of a point, as exactly as [`contains`](Self::contains): 1 outside, 0 on the
    /// surface, -1 inside.
    ///
    /// All points of a body without volume are on its surface.
    pub(crate) fn side_of(&self, point: &Point3<f64>) -> i32 {
        let flush = self.flush();
        // Within the box of a shifted body the shift is exact (Sterbenz), as for the vertices. A
        // point that is not shifted exactly is at least half the shift away, and so outside the
        // body.
        let p = ((point.coords - self.origin) / self.unit()).map(|x| if x.abs() < flush { 0.0 } else { x });
        if !(0..3).all(|k| self.low[k] <= p[k] && p[k] <= self.high[k]) {
            return 1; // also where a coordinate is not a number
        }
        let on_flat = |is_on: bool| if is_on { 0 } else { 1 };
        match self.topology.face_count() {
            0 => 0,
            1 => on_flat(projection(&self.points[0], &self.points[1], &p).is_none()),
            2 => on_flat(self.polygon_contains(&p)),
            _ => {
                // Stored planes decide the clear cases, exact signs the others.
                let clear = NEAR_PLANE * (self.radius + p.norm());
                let mut side = -1;
                for (plane, f) in self.planes.iter().zip(self.faces()) {
                    let height = plane.normal.dot(&p) - plane.offset;
                    if height < -clear {
                        continue;
                    }
                    let exact = if height > clear { 1.0 } else { self.face_side(f, &p) };
                    if exact > 0.0 {
                        return 1;
                    }
                    if exact == 0.0 {
                        side = 0;
                    }
                }
                side
            }
        }
    }

    /// Returns the bound in stored units below which coordinates count as zero.
    pub(crate) fn flush(&self) -> f64 {
        flush_below(sqrt(((self.high - self.low) * 0.5).norm_squared()))
    }

    /// Returns whether an exactly flat polygon contains a point.
    fn polygon_contains(&self, p: &Vector3<f64>) -> bool {
        let at = |h: HalfEdgeId| &self.points[self.topology.from(h).index()];
        let first = FaceId(0);
        let start = self.topology.rim_half_edge(first);
        let second = self.topology.half_edge(start).next;
        let third = self.topology.half_edge(second).next;
        let corners = [at(start), at(second), at(third)];
        let Some(axis) = projection(corners[0], corners[1], corners[2]) else {
            return false;
        };
        let forward = turn(axis, corners[0], corners[1], corners[2]) > 0.0;
        self.face_side(first, p) == 0.0
            && self.topology.rim(first).all(|h| {
                let t = turn(axis, at(h), at(self.topology.half_edge(h).next), p);
                if forward { t >= 0.0 } else { t <= 0.0 }
            })
    }

    /// Returns the point of the closed body closest to a point: the point itself if the body
    /// contains it. `None` for a point that is not finite.
    ///
    /// The call examines every face and edge, so the time is linear in the size of the body.
    #[must_use]
    pub fn closest_point(&self, point: &Point3<f64>) -> Option<Point3<f64>> {
        if !point.iter().all(|x| x.is_finite()) {
            return None;
        }
        if self.contains(point) {
            return Some(*point);
        }
        let p = self.nearby(point);
        let mut best = (f64::INFINITY, self.points[0]);
        let mut propose = |candidate: Vector3<f64>| {
            let distance = (p - candidate).norm_squared();
            if distance < best.0 {
                best = (distance, candidate);
            }
        };
        self.points.iter().for_each(|v| propose(*v));
        for e in self.edges() {
            let (a, b) = (
                self.points[self.topology.from(e.half_edge()).index()],
                self.points[self.topology.half_edge(e.half_edge()).to.index()],
            );
            propose(on_segment(&a, &b, &p));
        }
        for f in self.faces() {
            if let Some(foot) = self.foot_on_face(f, &p) {
                propose(foot);
            }
        }
        Some(self.to_user(&best.1))
    }

    /// Returns the point in stored coordinates. A point beyond 2^60 radii is moved inward along its
    /// ray; the closest point stays the same.
    fn nearby(&self, point: &Point3<f64>) -> Vector3<f64> {
        let far = FAR_POINT * self.radius.at_least(f64::MIN_POSITIVE);
        // Halves keep the difference finite.
        let half = point.coords * 0.5 - self.origin * 0.5;
        let size = half.amax() / self.unit();
        if size < far {
            return (point.coords - self.origin) / self.unit();
        }
        half / half.amax() * far
    }

    /// Returns the foot of the perpendicular from `p` to a face, if the foot is inside the face
    /// boundary by more than rounding. If the foot is nearer to an edge, the edge gives an equally
    /// good point; and if a face is almost a line, rounding decides its sides. If `p` is behind the
    /// face, the foot is a point of the body too, and it is the closest point if rounding misjudges
    /// the side.
    fn foot_on_face(&self, f: FaceId, p: &Vector3<f64>) -> Option<Vector3<f64>> {
        let n = self.planes[f.index()].normal;
        let a = self.points[self.topology.from(self.topology.rim_half_edge(f)).index()];
        let height = n.dot(&(p - a));
        let inside = self.topology.rim(f).all(|h| {
            let e = self.topology.half_edge(h);
            let from = self.points[self.topology.from(h).index()];
            let (edge, to) = (self.points[e.to.index()] - from, p - from);
            over_side(&n, &edge, &to) > FOOT * sqrt(edge.norm_squared() * to.norm_squared())
        });
        inside.then(|| p - n * height)
    }
}

/// Returns how far a point is inside a side of a face with normal `n`, times the length of the
/// edge; `to` leads from the edge to the point.
#[inline(always)]
pub(crate) fn over_side(n: &Vector3<f64>, edge: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    edge.cross(to).dot(n)
}

fn on_segment(a: &Vector3<f64>, b: &Vector3<f64>, p: &Vector3<f64>) -> Vector3<f64> {
    let (edge, to) = (b - a, p - a);
    let scale = edge.amax();
    if scale == 0.0 {
        return *a;
    }
    let unit = edge / scale;
    let direction = unit / sqrt(unit.norm_squared());
    let t = direction.dot(&to) / direction.dot(&edge);
    if t <= 0.0 {
        *a
    } else if t >= 1.0 {
        *b
    } else {
        a + edge * t
    }
}
