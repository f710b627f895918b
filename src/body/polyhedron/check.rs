//! A check of all invariants of a body, for tests and fuzzing.

use crate::body::polyhedron::fans::LARGE;
use crate::body::polyhedron::{FaceId, HalfEdgeId, VertexId};
use alloc::format;
use alloc::string::String;

use super::ConvexPolyhedron;
use super::topology::Topology;
use crate::base::tolerance::NEAR_PLANE;

/// Returns an error with the text if the condition is false.
fn ensure(holds: bool, text: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(text()) }
}

impl Topology {
    /// Returns the first broken invariant of half-edges, fans, rims or rings.
    pub(crate) fn check(&self) -> Result<(), String> {
        let (vertices, half_edges, faces) = (self.vertex_count(), self.half_edge_count(), self.face_count());
        for h in HalfEdgeId::all(half_edges) {
            let e = self.half_edge(h);
            let in_range = e.to.index() < vertices
                && e.twin.index() < half_edges
                && e.next.index() < half_edges
                && e.face.index() < faces;
            ensure(in_range, || format!("{h} names a number out of range"))?;
            let twin = self.half_edge(e.twin);
            ensure(twin.twin == h && e.twin != h, || {
                format!("{h} is not the twin of its twin")
            })?;
            let from = self.from(h);
            ensure(self.fan(from).iter().any(|g| g == h), || {
                format!("{h} is not in the fan of {from}")
            })?;
            let next = self.half_edge(e.next);
            ensure(self.from(e.next) == e.to && next.face == e.face, || {
                format!("{h} is not followed along its face")
            })?;
        }
        VertexId::all(vertices).try_for_each(|v| self.check_fan(v))?;
        FaceId::all(faces).try_for_each(|f| self.check_rim(f))
    }

    /// Half-edges of a fan rotate to the left: the face on the left of each is on the right of the
    /// next.
    fn check_fan(&self, v: VertexId) -> Result<(), String> {
        let fan = self.fan(v);
        ensure(
            fan.start <= fan.end && fan.end as usize <= self.half_edge_count(),
            || format!("the fan of {v} is out of range"),
        )?;
        for h in fan.iter() {
            let right_face = self.half_edge(self.half_edge(fan.after(h)).twin).face;
            ensure(self.half_edge(h).face == right_face, || {
                format!("the fan of {v} is not in order at {h}")
            })?;
        }
        Ok(())
    }

    /// The boundary of a face is one loop. The boundary of a large face, and of no other, is stored
    /// as a ring.
    fn check_rim(&self, f: FaceId) -> Result<(), String> {
        let count = self.rim(f).take(self.half_edge_count() + 1).count();
        ensure(count <= self.half_edge_count(), || {
            format!("the rim of {f} does not close")
        })?;
        ensure(self.rim(f).all(|h| self.half_edge(h).face == f), || {
            format!("the rim of {f} leaves the face")
        })?;
        match self.ring(f) {
            None => ensure(count <= LARGE, || format!("the large face {f} has no ring")),
            Some(ring) => ensure(count > LARGE && self.rim(f).eq(ring.iter().copied()), || {
                format!("the ring of {f} is not its rim")
            }),
        }
    }
}

impl ConvexPolyhedron {
    /// Returns the first broken invariant of the body: of the links between vertices, edges and
    /// faces, or of the supporting planes, below which all vertices lie.
    ///
    /// A body that was built keeps all invariants, so this is a tool for tests and fuzzing. Its
    /// time grows with the number of edges, and with faces times vertices for the planes of bodies
    /// with fewer than 256 faces. For larger bodies only the vertices of adjacent faces are
    /// checked.
    ///
    /// # Errors
    /// Returns a text that names the broken invariant.
    pub fn check(&self) -> Result<(), String> {
        let t = &self.topology;
        t.check()?;
        ensure(t.vertex_count() == self.points.len(), || {
            "vertices and points differ in number".into()
        })?;
        ensure(t.face_count() == self.planes.len(), || {
            "faces and planes differ in number".into()
        })?;
        ensure(self.points.iter().all(|p| p.norm() <= self.radius), || {
            "a vertex is farther out than the radius".into()
        })?;
        FaceId::all(t.face_count()).try_for_each(|f| self.check_plane(f))
    }

    /// No vertex lies above the plane of the face by more than the rounding of this test.
    fn check_plane(&self, f: FaceId) -> Result<(), String> {
        let (t, plane) = (&self.topology, &self.planes[f.index()]);
        let below = |v: VertexId| {
            let height = plane.normal.dot(&self.points[v.index()]) - plane.offset;
            let rounding = NEAR_PLANE * self.radius;
            ensure(height <= rounding, || format!("{v} is above {f}"))
        };
        if t.face_count() < 256 {
            return VertexId::all(t.vertex_count()).try_for_each(below);
        }
        let across = |h: HalfEdgeId| t.half_edge(t.half_edge(t.half_edge(h).twin).next).to;
        t.rim(f).try_for_each(|h| below(across(h)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::solids;
    use nalgebra::Vector3;

    #[test]
    fn broken_bodies_are_found() {
        let sound = || solids::icosahedron(1.0).unwrap();
        assert_eq!(sound().check(), Ok(()));
        let mut lowered = sound();
        lowered.planes[3].offset -= 1e-9;
        assert!(lowered.check().unwrap_err().contains("above f3"));
        let mut far = sound();
        far.points[5] *= 2.0;
        assert!(far.check().is_err());
        let mut another = sound();
        another.topology = solids::octahedron(1.0).unwrap().topology;
        assert!(another.check().unwrap_err().contains("differ in number"));
        let prism = solids::prism(60, 1.0, 1.0);
        assert_eq!(prism.map(|p| p.check()), Ok(Ok(())));
        let point = ConvexPolyhedron::point(Vector3::new(1.0, 2.0, 3.0).into());
        assert_eq!(point.map(|p| p.check()), Ok(Ok(())));
    }

    #[test]
    fn the_origin_is_the_point_there() {
        let built = ConvexPolyhedron::point(Vector3::zeros().into()).unwrap();
        assert_eq!(format!("{built:?}"), format!("{:?}", ConvexPolyhedron::origin()));
    }
}
