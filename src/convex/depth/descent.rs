//! Descent over the facets of the Minkowski difference P = A - B, to a facet that contains the foot
//! of the origin. This facet is a local minimum of the height, and a proposal for the depth.
//!
//! ```text
//!      F'    ridge    F           o   origin, at height r beneath the plane of F
//!    .-------.________________    x   foot of the origin on the plane of F
//!   /        :    x               If x lies in F, the descent ends.
//!  /         :    |               If x lies beyond a ridge of F, then x is outside P, beyond the
//!                 o               facet F' across the ridge: F' is lower than F.
//! ```
//!
//! A facet is a face of one body with a vertex of the other, or an edge of each. A ridge is an edge
//! with a vertex. The normals between its two facets are an arc. The arc starts at the face, or at
//! the crossing of the two arcs of the edges, and follows the arc of the edge. The facet across the
//! ridge is where the arc leaves the normals of the vertex, or otherwise at the end of the arc.
//!
//! Sources: the dual walk of Lin and Canny 1991; overlaid Gauss maps as in Gregorius 2013, "The
//! separating axis test between convex polyhedra", GDC. Departure: one walk from the last facet
//! instead of a test of all facets. Heights decrease, so the walk ends. Rounding may end the walk
//! elsewhere, because nothing is proven here.
//!
//! # The deepest points
//!
//! The features of the deepest facet give the deepest points of the overlap ([`foot`]). If two
//! faces are flush, many pairs of points are equally deep, and the vertex of the facet may lie
//! outside the opposite face. Then another feature pair contains the witness points ([`flush`]).

use nalgebra::{Point3, Vector3};

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::{Vec3, sqrt};
use crate::base::pose::Operand;
use crate::base::tolerance::{AGREE_DEPTH, FOOT, NEARLY_PARALLEL, PARALLEL};
use crate::body::polyhedron::fans::LARGE;
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, FeaturePair, HalfEdgeId, VertexId};
use crate::convex::depth::search::Best;
use crate::pair::difference::DifferenceFacet;
use crate::pair::face::{Face, FaceLocation};
use crate::pair::posed::{AFirst, BFirst, OrderedPair, PosedPair};
use crate::pair::star::EdgeSpan;
use crate::pair::star::falls_into_both_faces;

/// Largest number of facets of a descent. After small motions descents are short; otherwise the
/// polytope is a better start.
const DESCENTS: usize = 12;

/// A fan with more edges ends a descent.
const FAN: usize = 64;

/// A facet that contains the foot of the origin, up to rounding.
pub(super) struct LowFacet {
    pub(super) facet: DifferenceFacet,
    /// Outward unit normal and proven support value of the difference along the normal, if the test
    /// of the facet gave a proof.
    pub(super) support: Option<(Vec3<f64>, f64)>,
}

/// The end of a descent.
pub(super) enum Descent {
    /// At a facet that contains the foot of the origin.
    Facet(LowFacet),
    /// At a facet with the origin outside: the bodies seem to be separated.
    Outside(DifferenceFacet),
    /// Without a facet: too many facets, large fans, parallel edges, or no facets at all.
    Lost,
}

/// Result of the test of a facet.
enum Look {
    /// The foot of the origin lies in this facet.
    Holds(LowFacet),
    /// The origin lies outside this facet.
    Outside(DifferenceFacet),
    /// The next facet, which is not higher.
    Lower(DifferenceFacet),
}

/// Walks from the facet of the features `from`, or from a facet at the vertices of `from`. The
/// bodies must have one stored unit. Counts the facets visited.
pub(super) fn descend(posed: &PosedPair, from: FeaturePair, visited: &mut u32) -> Descent {
    let Some(mut at) = first_facet(posed, from) else {
        return Descent::Lost;
    };
    for _ in 0..DESCENTS {
        *visited += 1;
        let look = match at {
            DifferenceFacet::Edges(e, g) => EdgeFacet::new(posed, e, g).and_then(|f| f.look()),
            DifferenceFacet::VertexFace(v, f) => look_at_face(&AFirst(posed), v, f),
            DifferenceFacet::FaceVertex(f, v) => look_at_face(&BFirst(posed), v, f),
        };
        match look {
            Some(Look::Lower(next)) => at = next,
            Some(Look::Holds(facet)) => return Descent::Facet(facet),
            Some(Look::Outside(facet)) => return Descent::Outside(facet),
            None => return Descent::Lost,
        }
    }
    Descent::Lost
}

/// Returns `from` if it is a facet; otherwise the lowest of the faces at its vertices, with the
/// opposite vertex.
fn first_facet(posed: &PosedPair, from: FeaturePair) -> Option<DifferenceFacet> {
    if let Some(facet) = DifferenceFacet::of(from) {
        return Some(facet);
    }
    let (v, w) = from.vertices_of(posed.a, posed.b);
    let (p, q) = (posed.a.points[v.index()], posed.b.points[w.index()]);
    let lowest = |body: &ConvexPolyhedron, at: VertexId, x: Vector3<f64>| {
        let faces = body
            .topology
            .fan(at)
            .iter()
            .take(FAN)
            .map(|h| body.topology.half_edge(h).face);
        let height = |f: FaceId| body.planes[f.index()].offset - body.planes[f.index()].normal.dot(&x);
        faces.map(|f| (height(f), f)).min_by(|x, y| x.0.total_cmp(&y.0))
    };
    let of_a =
        lowest(posed.a, v, posed.point_in_a(&q)).map(|(h, f)| (h, DifferenceFacet::vertex_face(Operand::B, w, f)));
    let of_b =
        lowest(posed.b, w, posed.point_in_b(&p)).map(|(h, f)| (h, DifferenceFacet::vertex_face(Operand::A, v, f)));
    let facets = of_a.into_iter().chain(of_b);
    facets.min_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, facet)| facet)
}

/// Tests the facet of a face of the second body and the opposite vertex of the first body, at or
/// near `vertex`.
#[inline]
fn look_at_face<S: OrderedPair>(pair: &S, vertex: VertexId, face: FaceId) -> Option<Look> {
    let (body, other) = (pair.first(), pair.second());
    let plane = &other.planes[face.index()];
    let n = pair.direction_in_first(&plane.normal);
    let vertex = body.support_certified(&-n, vertex).vertex;
    let facet = DifferenceFacet::vertex_face(S::FIRST, vertex, face);
    let x = pair.point_in_second(&body.points[vertex.index()]);
    let height = plane.offset - plane.normal.dot(&x);
    if height < 0.0 {
        return Some(Look::Outside(facet));
    }
    let foot = x + plane.normal * height;
    let normal = &plane.normal;
    let (location, _) = Face {
        body: other,
        face,
        normal,
    }
    .locate(&foot, pair.size());
    let FaceLocation::Outside(edge) = location else {
        // A degenerate face has no normal.
        let support = (plane.normal.norm_squared() > 0.5).then(|| (pair.normal(&plane.normal).into(), height));
        return Some(Look::Holds(LowFacet { facet, support }));
    };
    let e = other.topology.half_edge(edge.half_edge());
    let across = if e.face == face {
        other.topology.half_edge(e.twin).face
    } else {
        e.face
    };
    let end = pair.direction_in_first(&other.planes[across.index()].normal);
    let met = leaving_edge(body, vertex, &-n, &-end)?;
    Some(Look::Lower(match met {
        Some(met) => DifferenceFacet::edges(S::FIRST, met, edge),
        None => DifferenceFacet::vertex_face(S::FIRST, vertex, across),
    }))
}

/// Returns the edge at which an arc of directions, from `start` to `end`, leaves the directions
/// along which `vertex` is the support vertex; `Some(None)` if the arc does not leave them, and
/// `None` if the vertex has too many edges.
fn leaving_edge(
    body: &ConvexPolyhedron,
    vertex: VertexId,
    start: &Vector3<f64>,
    end: &Vector3<f64>,
) -> Option<Option<EdgeId>> {
    let t = &body.topology;
    if t.fan(vertex).len() > FAN {
        return None;
    }
    let p = body.points[vertex.index()];
    let (mut first, mut met) = (1.0, None);
    t.each_leaving(vertex, |half_edge, to| {
        let e = body.points[to.index()] - p;
        let rise = end.dot(&e);
        if rise > 0.0 {
            // Rounding aside, nothing rises along `start`.
            let at = -start.dot(&e).at_most(0.0) / (rise - start.dot(&e).at_most(0.0));
            if at < first {
                (first, met) = (at, Some(half_edge));
            }
        }
    });
    Some(met.map(|h| t.edge(h)))
}

/// The facet spanned by an edge of A and an edge of B.
pub(super) struct EdgeFacet<'a, 'b> {
    posed: &'a PosedPair<'b>,
    names: (EdgeId, EdgeId),
    edges: (EdgeSpan<'a>, EdgeSpan<'a>),
    /// The edges as vectors: of A in A's frame, of B in A's frame, and of A in B's frame.
    u: PackedVec3,
    w: PackedVec3,
    u_in_b: PackedVec3,
    /// From the tail of the edge of A to the tail of the edge of B.
    between: PackedVec3,
    /// Outward normal of the facet. Its length is the sine of the angle of the edges times both
    /// lengths.
    normal: PackedVec3,
    /// Weights of the normal over the two faces of each edge. None is negative if the facet exists.
    weights: [[f64; 2]; 2],
}

impl<'a, 'b> EdgeFacet<'a, 'b> {
    /// Returns the facet of an edge of A and an edge of B; `None` if the edges are parallel.
    #[inline]
    pub(super) fn new(posed: &'a PosedPair<'b>, e: EdgeId, g: EdgeId) -> Option<Self> {
        let (ea, eb) = (EdgeSpan::new(posed.a, e), EdgeSpan::new(posed.b, g));
        let (p, q) = (PackedVec3::new(&ea.p), PackedVec3::new(&eb.p));
        let (u, w_in_b) = (PackedVec3::new(&ea.q) - p, PackedVec3::new(&eb.q) - q);
        let w = posed.rotation.times(w_in_b);
        let between = posed.rotation.times(q) + posed.translation - p;
        let normal = u.cross(w);
        if !(normal.norm_squared() > PARALLEL * u.norm_squared() * w.norm_squared()) {
            return None;
        }
        let u_in_b = posed.rotation.transposed_times(u);
        let along = ea.weights(w, 1.0);
        let sign = if along[0] + along[1] < 0.0 { -1.0 } else { 1.0 };
        Some(Self {
            posed,
            names: (e, g),
            u,
            w,
            u_in_b,
            between,
            normal: normal * sign,
            weights: [ea.weights(w, sign), eb.weights(u_in_b, sign)],
            edges: (ea, eb),
        })
    }

    #[inline]
    fn look(&self) -> Option<Look> {
        if let Some(other) = self.face_beyond() {
            return Some(Look::Lower(other));
        }
        let facet = DifferenceFacet::edges(Operand::A, self.names.0, self.names.1);
        if self.normal.dot(self.between) > 0.0 {
            return Some(Look::Outside(facet));
        }
        // The feet of the common perpendicular: at `s` on the edge of A, at `t` on the edge of B.
        let plain = self.u.cross(self.w);
        let per_square = 1.0 / plain.norm_squared();
        let s = self.between.cross(self.w).dot(plain) * per_square;
        let t = self.between.cross(self.u).dot(plain) * per_square;
        let off = |s: f64, edge: PackedVec3| {
            let off = s - s.clamped(0.0, 1.0);
            off * off * edge.norm_squared()
        };
        let (off_a, off_b) = (off(s, self.u), off(t, self.w));
        let close = FOOT * self.posed.size();
        if off_a.larger(off_b) <= close * close {
            let support = self.support();
            Some(Look::Holds(LowFacet { facet, support }))
        } else if off_a >= off_b {
            self.past_end_of_a(s > 0.5).map(Look::Lower)
        } else {
            self.past_end_of_b(t > 0.5).map(Look::Lower)
        }
    }

    /// Returns the normal and the support along the normal, if signs prove both edges extreme.
    #[inline]
    pub(super) fn support(&self) -> Option<(Vec3<f64>, f64)> {
        let (uu, ww, nn) = (self.u.norm_squared(), self.w.norm_squared(), self.normal.norm_squared());
        let is_proven = falls_into_both_faces(self.weights[0], ww) && falls_into_both_faces(self.weights[1], uu);
        (is_proven && nn >= NEARLY_PARALLEL * uu * ww).then(|| {
            let n = self.normal * (1.0 / sqrt(nn));
            (n.vector().into(), -n.dot(self.between))
        })
    }

    /// Returns a facet of a face beyond which the normal lies, if the two edges span no facet.
    #[inline]
    fn face_beyond(&self) -> Option<DifferenceFacet> {
        let [[left_a, right_a], [left_b, right_b]] = self.weights;
        // A negative weight of one face puts the normal beyond the other face.
        let (t, u) = (&self.posed.a.topology, &self.posed.b.topology);
        let (e, g) = (
            t.half_edge(self.names.0.half_edge()),
            u.half_edge(self.names.1.half_edge()),
        );
        if left_a.smaller(right_a) < 0.0 {
            let face = if left_a < 0.0 { t.half_edge(e.twin).face } else { e.face };
            Some(DifferenceFacet::vertex_face(Operand::B, g.to, face))
        } else if left_b.smaller(right_b) < 0.0 {
            let face = if left_b < 0.0 { u.half_edge(g.twin).face } else { g.face };
            Some(DifferenceFacet::vertex_face(Operand::A, e.to, face))
        } else {
            None
        }
    }

    /// Returns the facet across the ridge of the edge of B with an end of the edge of A.
    fn past_end_of_a(&self, head: bool) -> Option<DifferenceFacet> {
        let (ea, eb) = &self.edges;
        let (vertex, outward) = if head { (ea.head, 1.0) } else { (ea.tail, -1.0) };
        // The end of the arc of B's edge along which the vertex is higher than the other end.
        let is_left = -self.u_in_b.dot(PackedVec3::new(&eb.left.normal)) * outward > 0.0;
        let end = -self.posed.vector_in_a(&if is_left { eb.left } else { eb.right }.normal);
        let met = leaving_edge(self.posed.a, vertex, &self.unit_normal(), &end)?;
        Some(match met {
            Some(met) => DifferenceFacet::edges(Operand::A, met, self.names.1),
            None => {
                let face = face_of(self.posed.b, self.names.1, is_left);
                DifferenceFacet::vertex_face(Operand::A, vertex, face)
            }
        })
    }

    /// Returns the facet across the ridge of the edge of A with an end of the edge of B.
    fn past_end_of_b(&self, head: bool) -> Option<DifferenceFacet> {
        let (ea, eb) = &self.edges;
        let (vertex, outward) = if head { (eb.head, 1.0) } else { (eb.tail, -1.0) };
        let is_left = -self.w.dot(PackedVec3::new(&ea.left.normal)) * outward > 0.0;
        let end = -self
            .posed
            .direction_in_b(&if is_left { ea.left } else { ea.right }.normal);
        let start = -self.posed.direction_in_b(&self.unit_normal());
        let met = leaving_edge(self.posed.b, vertex, &start, &end)?;
        Some(match met {
            Some(met) => DifferenceFacet::edges(Operand::A, self.names.0, met),
            None => {
                let face = face_of(self.posed.a, self.names.0, is_left);
                DifferenceFacet::vertex_face(Operand::B, vertex, face)
            }
        })
    }

    fn unit_normal(&self) -> Vector3<f64> {
        let n = self.normal;
        (n * (1.0 / sqrt(n.norm_squared()))).vector()
    }
}

/// Returns the face left or right of an edge.
fn face_of(body: &ConvexPolyhedron, edge: EdgeId, left: bool) -> FaceId {
    let e = body.topology.half_edge(edge.half_edge());
    if left {
        e.face
    } else {
        body.topology.half_edge(e.twin).face
    }
}

/// Largest number of edges of a face whose edges are tested one by one for the features of a depth.
/// Each edge of one face is tested with each edge of the other.
const SMALL: usize = 8;

/// A point of A and a point of B, in their stored frames.
pub(super) type WitnessPoints = [Point3<f64>; 2];

/// Returns a point of A and a point of B that differ by the height of the best facet along its
/// normal, A's ahead; `None` if the features of the facet contain no such points.
pub(super) fn foot(posed: &PosedPair, facet: DifferenceFacet, best: &Best<f64>) -> Option<WitnessPoints> {
    let (ahead, close) = (Vector3::from(best.normal) * best.height, AGREE_DEPTH * posed.size());
    let (p, q) = match facet {
        DifferenceFacet::FaceVertex(f, v) => {
            let q = posed.b.points[v.index()];
            let p = posed.point_in_a(&q) + ahead;
            (is_on(posed.a, f, &p, close).then_some(p)?, q)
        }
        DifferenceFacet::VertexFace(v, f) if posed.same_scale() => {
            let p = posed.a.points[v.index()];
            let q = posed.point_in_b(&(p - ahead));
            (p, is_on(posed.b, f, &q, close).then_some(q)?)
        }
        DifferenceFacet::Edges(e, g) => crossing(posed, e, g, &ahead, close)?,
        DifferenceFacet::VertexFace(..) => return None,
    };
    Some([p.into(), q.into()])
}

/// Returns witness points on two flush faces, one of which belongs to the facet, and the features
/// that contain them.
///
/// The features are a vertex of one face over the other face or, if both faces are small, two
/// crossing edges.
#[cold]
pub(super) fn flush(
    posed: &PosedPair,
    facet: DifferenceFacet,
    best: &Best<f64>,
) -> Option<(DifferenceFacet, WitnessPoints)> {
    let n = Vector3::from(best.normal);
    let (f, g) = match facet {
        DifferenceFacet::FaceVertex(f, v) => (f, face_towards(posed.b, v, &-posed.direction_in_b(&n))?),
        DifferenceFacet::VertexFace(v, g) => (face_towards(posed.a, v, &n)?, g),
        DifferenceFacet::Edges(..) => return None,
    };
    let with_witnesses = |facet| Some((facet, foot(posed, facet, best)?));
    let t = [&posed.a.topology, &posed.b.topology];
    let of_b = || sample_rim(posed.b, g).map(|h| DifferenceFacet::FaceVertex(f, t[1].from(h)));
    let of_a = || sample_rim(posed.a, f).map(|h| DifferenceFacet::VertexFace(t[0].from(h), g));
    if let Some(found) = of_b().chain(of_a()).find_map(with_witnesses) {
        return Some(found);
    }
    let is_small = |t: &Topology, face: FaceId| t.rim(face).nth(SMALL).is_none();
    if !(is_small(t[0], f) && is_small(t[1], g)) {
        return None;
    }
    let pairs = t[0].rim(f).flat_map(|h| t[1].rim(g).map(move |k| (h, k)));
    let edges = |(h, k)| DifferenceFacet::Edges(t[0].edge(h), t[1].edge(k));
    pairs.map(edges).find_map(with_witnesses)
}

/// Returns the face at a vertex whose normal is closest to `outward`; `None` if the body has no
/// faces.
fn face_towards(body: &ConvexPolyhedron, v: VertexId, outward: &Vector3<f64>) -> Option<FaceId> {
    let t = &body.topology;
    let mut best = (0.0, None);
    for h in t.fan(v).iter().take(LARGE) {
        let f = t.half_edge(h).face;
        let along = body.planes[f.index()].normal.dot(outward);
        if along > best.0 {
            best = (along, Some(f));
        }
    }
    best.1
}

/// Returns the half-edges of a face; of a large face, an evenly spaced sample.
pub(super) fn sample_rim(body: &ConvexPolyhedron, f: FaceId) -> impl Iterator<Item = HalfEdgeId> + '_ {
    let t = &body.topology;
    let ring = t.ring(f);
    let sampled = ring
        .into_iter()
        .flat_map(|r| r.iter().copied().step_by(r.len().div_ceil(LARGE)));
    let whole = if ring.is_none() { LARGE } else { 0 };
    t.rim(f).take(whole).chain(sampled)
}

/// Returns whether a point lies on a face, or at most `close` off the face.
fn is_on(body: &ConvexPolyhedron, f: FaceId, x: &Vector3<f64>, close: f64) -> bool {
    let (t, plane) = (&body.topology, &body.planes[f.index()]);
    let inside = |h: HalfEdgeId| {
        let (from, to) = (body.points[t.from(h).index()], body.points[t.half_edge(h).to.index()]);
        let u = to - from;
        plane.normal.cross(&u).dot(&(x - from)) >= -close * u.abs().sum()
    };
    // NaN is outside.
    if !((plane.normal.dot(x) - plane.offset).abs() <= close) {
        return false;
    }
    match t.ring(f) {
        None => t.rim(f).take(LARGE).all(inside),
        Some(ring) => {
            let face = Face {
                body,
                face: f,
                normal: &plane.normal,
            };
            !matches!(face.locate_large(ring, x, close / FOOT), FaceLocation::Outside(_))
        }
    }
}

/// Returns the points of two edges that differ by `ahead`.
fn crossing(
    posed: &PosedPair,
    e: EdgeId,
    g: EdgeId,
    ahead: &Vector3<f64>,
    close: f64,
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let ends = |body: &ConvexPolyhedron, e: EdgeId| {
        let (t, h) = (&body.topology, e.half_edge());
        (body.points[t.from(h).index()], body.points[t.half_edge(h).to.index()])
    };
    let ((p0, p1), (q0, q1)) = (ends(posed.a, e), ends(posed.b, g));
    let (u, v) = (p1 - p0, posed.vector_in_a(&(q1 - q0)));
    let gap = p0 - posed.point_in_a(&q0) - ahead;
    let c = u.cross(&v);
    let squared = c.norm_squared();
    // gap + s u - t v = 0, multiplied by v and by u.
    let s = (-gap.cross(&v).dot(&c) / squared).clamped(0.0, 1.0);
    let t = (-gap.cross(&u).dot(&c) / squared).clamped(0.0, 1.0);
    // For parallel edges s and t do not exist: NaN, or a residual.
    let rest = gap + u * s - v * t;
    (rest.norm_squared() <= close * close).then(|| (p0 + u * s, q0 + (q1 - q0) * t))
}
