//! The face through which a ray enters a polyhedron, by a walk from face to face.
//!
//! 1. A ray crosses the plane of a face inward. If the crossing is beyond the plane of a neighbour,
//!    the ray does not enter the body there.
//! 2. If the ray crosses the plane of this neighbour inward too, it does so later, and the walk
//!    goes on there. So the walk advances along the ray and visits no face twice.
//! 3. If the ray crosses the plane of this neighbour outward, it leaves the half-space of the
//!    neighbour before it enters that of the face, and it misses the body.
//!
//! Floating point decides the walk. A hit is proven by two facts: all vertices are below the plane
//! of the face, so the body has no point before the crossing, and the ray passes through a triangle
//! of three vertices of the face. A miss is proven by one plane or by two. If rounding hides a
//! fact, there is no answer, and the caller's cast decides.
//!
//! Sources: the part of a line in an intersection of half-spaces, Cyrus and Beck 1978; a walk over
//! the faces instead of a scan, as in Lin and Canny 1991.

use nalgebra::{Isometry3, Unit, Vector3};

use crate::base::num::extremes::Extremes;
use crate::base::pose::rigid;
use crate::body::polyhedron::fans::LARGE;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, Feature, VertexId};
use crate::nonconvex::query::ray::MeshRay;
use crate::pair::transform::StoredFrame;
use crate::pair_tracker::geometry::GeometryRef;
use crate::ray::mesh::in_body;
use crate::ray::{Ray, RayCast, RayHit};

/// The heights of both ends of a segment of a ray above the plane of a face.
#[derive(Clone, Copy)]
struct Heights {
    face: FaceId,
    from: f64,
    to: f64,
}

impl Heights {
    fn at(&self, part: f64) -> f64 {
        self.from + (self.to - self.from) * part
    }

    /// Returns whether the segment crosses the plane inward or would do so further on.
    fn descends(&self) -> bool {
        self.to < self.from
    }

    /// Returns the part of the segment before the crossing with the plane.
    fn part(&self) -> f64 {
        self.from / (self.from - self.to)
    }
}

/// Where a walk ends.
enum End {
    /// The ray enters the half-space of this face last.
    Entry(Heights),
    Miss,
}

/// A segment of a ray in stored coordinates of a polyhedron.
struct Walk<'a> {
    hull: &'a ConvexPolyhedron,
    ray: MeshRay,
    /// Largest error of the height of a point of the segment above a plane.
    doubt: f64,
}

/// Returns what a ray meets, or `None` if the walk cannot prove it.
///
/// Distances from `span[0]` to `span[1]` contain all points of the ray that may lie in the body.
pub(super) fn entered(
    hull: &ConvexPolyhedron,
    pose: &Isometry3<f64>,
    ray: &Ray,
    span: [f64; 2],
    length: f64,
    width: f64,
) -> Option<RayCast> {
    if hull.face_count() < 4 {
        return None;
    }
    let frame = StoredFrame::of(hull);
    let on_hull = in_body(GeometryRef::from(hull), &frame, pose, ray, span, length, width)?;
    let walk = Walk {
        hull,
        doubt: 2.0 * on_hull.error,
        ray: on_hull,
    };
    match walk.end()? {
        End::Miss => Some(RayCast::Miss),
        End::Entry(face) => walk.hit(&face, pose),
    }
}

impl Walk<'_> {
    fn heights(&self, face: FaceId) -> Heights {
        let plane = &self.hull.planes[face.index()];
        let [from, to] = self.ray.ends.each_ref().map(|p| plane.normal.dot(p) - plane.offset);
        Heights { face, from, to }
    }

    /// Returns whether the whole segment is above the plane.
    fn is_above(&self, h: &Heights) -> bool {
        h.from.smaller(h.to) > self.doubt
    }

    /// Walks to the face that the ray crosses inward last.
    fn end(&self) -> Option<End> {
        let topology = &self.hull.topology;
        let mut face = self.start()?;
        loop {
            if self.is_above(&face) {
                return Some(End::Miss);
            }
            // The rim of a large face takes longer than a cast.
            if topology.ring(face.face).is_some() {
                return None;
            }
            let part = face.part();
            let mut best: Option<Heights> = None;
            for h in topology.rim(face.face) {
                let next = self.heights(topology.half_edge(topology.half_edge(h).twin).face);
                if !(next.at(part) > 0.0) {
                    continue;
                }
                if !next.descends() {
                    return self.are_apart(&face, &next).then_some(End::Miss);
                }
                if next.part() > best.map_or(part, |b| b.part()) {
                    best = Some(next);
                }
            }
            match best {
                Some(next) => face = next,
                None => return Some(End::Entry(face)),
            }
        }
    }

    /// Returns a face that the ray crosses inward, near the start of the segment.
    fn start(&self) -> Option<Heights> {
        let hull = self.hull;
        let [from, to] = &self.ray.ends;
        let at = |direction: &Vector3<f64>| self.first_of(hull.extreme_vertex(direction));
        at(&(from - hull.vertex_mean)).or_else(|| at(&(from - to)))
    }

    /// Returns the face of a vertex that the ray crosses inward last.
    fn first_of(&self, v: VertexId) -> Option<Heights> {
        let topology = &self.hull.topology;
        let fan = topology.fan(v);
        if fan.len() > LARGE {
            return None;
        }
        let faces = fan.iter().map(|h| self.heights(topology.half_edge(h).face));
        faces
            .filter(Heights::descends)
            .reduce(|best, h| if h.part() > best.part() { h } else { best })
    }

    /// Returns whether every point of the segment is above one of two planes, of which the segment
    /// crosses the first inward and the second outward.
    fn are_apart(&self, entry: &Heights, exit: &Heights) -> bool {
        if self.is_above(exit) {
            return true;
        }
        let middle = 0.5 * (entry.part() + exit.part());
        entry.at(middle).smaller(exit.at(middle)) > self.doubt
    }

    /// Returns the hit of a face.
    fn hit(&self, entry: &Heights, pose: &Isometry3<f64>) -> Option<RayCast> {
        let (hull, ray) = (self.hull, &self.ray);
        let [from, until] = ray.span;
        let (part, side) = (entry.part(), 0.5 * ray.width);
        // The plane is crossed within a quarter of the bracket. Written so that NaN gives `None`.
        let drop = (entry.from - entry.to) * 0.5 * side;
        if !(drop > self.doubt * (until - from)) {
            return None;
        }
        let at = from + part * (until - from);
        let (safe, hit) = (at - side, at + side);
        if safe > ray.length {
            return Some(RayCast::Miss);
        }
        if !(safe > 0.0 && hit <= until) {
            return None;
        }
        let point = |v: VertexId| hull.points[v.index()];
        let mut rim = hull.face_vertices(entry.face);
        let (a, mut b) = (rim.next()?, rim.next()?);
        rim.any(|c| {
            let corners = [a, core::mem::replace(&mut b, c), c].map(point);
            ray.passes(&corners, [safe, hit])
        })
        .then_some(())?;
        let [start, end] = &ray.ends;
        let place = start + (end - start) * ((safe - from) / (until - from));
        let normal = hull.planes[entry.face.index()].normal;
        let foot = place - normal * normal.dot(&(place - point(a)));
        // At a grazing ray the foot may be on another face.
        let is_on_face = hull.topology.rim(entry.face).all(|h| {
            let next = hull.topology.half_edge(hull.topology.half_edge(h).twin).face;
            let plane = &hull.planes[next.index()];
            plane.normal.dot(&foot) <= plane.offset
        });
        is_on_face.then(|| {
            let pose = rigid(pose);
            RayCast::Hit(RayHit {
                safe,
                hit,
                point: pose * hull.to_user(&foot),
                normal: Unit::new_unchecked(pose.rotation * normal),
                feature: Some(Feature::Face(entry.face)),
                subshape: 0,
            })
        })
    }
}
