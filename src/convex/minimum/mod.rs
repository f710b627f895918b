//! GJK: finds the point of the Minkowski difference A - B closest to the origin.
//!
//! [`solve`] replaces the walk if the walk fails. [`OverlapProof`] is the proof of an overlap that
//! a tracker caches.
//!
//! Source: Gilbert, Johnson and Keerthi 1988, here in f64 and in double-double. Departures:
//! 1. The solver starts from the features on which the walk ended ([`about_witnesses`]), so one or
//!    a few support points decide most cases.
//! 2. The direction of a triangle is its normal. The direction of an edge is orthogonalised twice,
//!    and is never the rounded nearest point. So the last support point is also the certificate.
//! 3. Support points are proven (see [`support`]). The solver ends and returns bounds if the
//!    support point is in the simplex already or brings no gain.
//! 4. The origin counts as inside only if four signed volumes exceed rounding. This proves the
//!    overlap.
//!
//! # The first simplex
//!
//! The first simplex consists of vertices of the proposed features, chosen around the witness
//! points. If the proposed features are the closest ones, one more support point proves it.
//!
//! ```text
//!   v_k+1 .------. v_k        Face and vertex: of the triangles v_0 v_k v_k+1 of the face, the one
//!         |`.  x |            that holds the witness x, minus the vertex. Two edges: the half of
//!         |   `. |            the parallelogram of their differences that holds the crossing.
//!         '-----`. v_0
//! ```
//!
//! # The cached proof of an overlap
//!
//! A vertex pair gives a point of the difference at every pose. After most small motions, the
//! tetrahedron of the four cached points still contains the origin at the new pose, which four
//! signed volumes prove. Otherwise the solver starts from the points closest to the origin. This
//! proof is used only for answers without a depth, because an answer with a depth caches a whole
//! polytope.

pub(crate) mod simplex;

use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, dot, neg, root};
use crate::base::tolerance::{ON_BOUNDARY, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, HalfEdgeId, VertexId};
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::{difference_point, support};
use crate::pair::draft::Draft;
use crate::pair::draft::{is_proven, set_overlapping, walk_state};
use crate::pair::outcome::Solver;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use nalgebra::{Point3, Vector3};

/// Largest number of support points of one solve. Measured: correct answers took at most 24, or
/// about 90 if the boundaries of two nearly parallel faces of 32,768 vertices lie over each other.
const SUPPORTS: u32 = 256;

/// Result of a solve.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Minimum<T> {
    /// The origin is outside, or on the surface up to rounding. Over the whole difference,
    /// `direction . w / |direction|` is at least `lower`, before the error term.
    Outside {
        simplex: Simplex<T>,
        lower: T,
        direction: Vec3<T>,
    },
    /// The tetrahedron is proven to contain the origin.
    Inside { simplex: Simplex<T> },
}

/// Solves from a simplex of points of the difference.
pub(crate) fn solve<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, mut simplex: Simplex<T>) -> Minimum<T> {
    let scale = posed.error_scale::<T>();
    let touches = T::from(ON_BOUNDARY * T::UNIT / UNIT * scale.total());
    let (mut lower, mut direction) = (T::from(f64::NEG_INFINITY), simplex.direction());
    for _ in 0..SUPPORTS {
        let d = simplex.direction();
        let norm_squared = dot(&d, &d);
        if !(simplex.squared_distance() > touches * touches) || !(norm_squared > T::from(0.0)) {
            break;
        }
        let (hint, toward) = (simplex.points()[simplex.len() - 1], neg(&d));
        let c = support(posed, frame, &toward, &hint);
        let reach = dot(&d, &c.w);
        let height = reach / root(norm_squared);
        if height > lower {
            (lower, direction) = (height, d);
        }
        // The support point is no closer than the simplex (for example, another vertex of the same
        // face).
        let is_closest = simplex.points().iter().all(|p| dot(&d, &p.w) <= reach);
        if is_closest || simplex.contains(c.a, c.b) || !simplex.add(c, scale) {
            break;
        }
        if simplex.len() == 4 {
            return Minimum::Inside { simplex };
        }
    }
    Minimum::Outside {
        simplex,
        lower,
        direction,
    }
}

/// Returns the simplex of a single point, from one vertex of each feature.
pub(crate) fn vertex_of<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, from: FeaturePair) -> Simplex<T> {
    let (a, b) = from.vertices_of(posed.a, posed.b);
    Simplex::vertex(difference_point(posed, frame, a, b))
}

/// Returns the first simplex from the features of a draft, whose witness points must lie on them.
pub(crate) fn about_witnesses<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, draft: &Draft) -> Simplex<T> {
    let point = |a, b| difference_point(posed, frame, a, b);
    let (x, y) = (&draft.point_on_a.coords, &draft.point_on_b.coords);
    match (draft.features.a, draft.features.b) {
        (Feature::Edge(e), Feature::Vertex(b)) => Simplex::edge(ends(posed.a, e, x).each(|a| point(a, b))),
        (Feature::Vertex(a), Feature::Edge(g)) => Simplex::edge(ends(posed.b, g, y).each(|b| point(a, b))),
        (Feature::Face(f), Feature::Vertex(b)) => Simplex::triangle(triangle(posed.a, f, x).each(|a| point(a, b))),
        (Feature::Vertex(a), Feature::Face(f)) => Simplex::triangle(triangle(posed.b, f, y).each(|b| point(a, b))),
        (Feature::Edge(e), Feature::Edge(g)) => {
            let ([a, far_a], [b, far_b]) = (ends(posed.a, e, x), ends(posed.b, g, y));
            Simplex::triangle([point(a, b), point(far_a, b), point(a, far_b)])
        }
        _ => vertex_of(posed, frame, draft.features),
    }
}

/// Returns the ends of an edge, the end closer to `x` first.
fn ends(body: &ConvexPolyhedron, edge: EdgeId, x: &Vector3<f64>) -> [VertexId; 2] {
    let (t, h) = (&body.topology, edge.half_edge());
    let (tail, head) = (t.from(h), t.half_edge(h).to);
    let squared = |v: VertexId| (body.points[v.index()] - x).norm_squared();
    if squared(head) < squared(tail) {
        [head, tail]
    } else {
        [tail, head]
    }
}

/// Returns three vertices of a face around `x`: the first vertex of the face, and the ends of the
/// edge at which the ray from the first vertex through `x` leaves the face.
pub(crate) fn triangle(body: &ConvexPolyhedron, face: FaceId, x: &Vector3<f64>) -> [VertexId; 3] {
    let t = &body.topology;
    let first = t.from(t.rim_half_edge(face));
    let origin = body.points[first.index()];
    let left = body.planes[face.index()].normal.cross(&(x - origin));
    let to = |h: HalfEdgeId| t.half_edge(h).to;
    // Seen from the first vertex, the vertices go from the right of the ray to its left.
    let ends_right = |h: &HalfEdgeId| left.dot(&(body.points[to(*h).index()] - origin)) < 0.0;
    let exit = if let Some(ring) = t.ring(face) {
        let opposite = &ring[1..ring.len() - 1];
        opposite[opposite.partition_point(ends_right).min(opposite.len() - 1)]
    } else {
        let opposite = t.rim(face).skip(1).take_while(|&h| to(h) != first);
        let mut exit = t.half_edge(t.rim_half_edge(face)).next;
        for h in opposite {
            exit = h;
            if !ends_right(&h) {
                break;
            }
        }
        exit
    };
    [first, t.from(exit), to(exit)]
}

/// Returns the witness points: convex combinations of the vertices of each body, in stored frames.
pub(crate) fn witnesses<T: Scalar>(posed: &PosedPair, simplex: &Simplex<T>) -> [Point3<f64>; 2] {
    let (mut on_a, mut on_b) = ([T::from(0.0); 3], [T::from(0.0); 3]);
    for (c, &w) in simplex.points().iter().zip(simplex.weights()) {
        let (p, q) = (posed.a.points[c.a.index()], posed.b.points[c.b.index()]);
        for k in 0..3 {
            on_a[k] = on_a[k] + w * T::from(p[k]);
            on_b[k] = on_b[k] + w * T::from(q[k]);
        }
    }
    [on_a, on_b].each(|p| Point3::from(p.each(|c| c.value())))
}

/// Returns the smallest features that contain the vertices of the simplex.
pub(crate) fn features<T: Scalar>(posed: &PosedPair, simplex: &Simplex<T>) -> FeaturePair {
    let (mut a, mut b) = ([VertexId(0); 4], [VertexId(0); 4]);
    for (k, c) in simplex.points().iter().enumerate() {
        (a[k], b[k]) = (c.a, c.b);
    }
    walk_state(posed, &a[..simplex.len()], &b[..simplex.len()])
}

/// Four vertex pairs, a tetrahedron of A - B.
///
/// The default, four equal pairs, is never a valid proof. It marks that the previous query
/// overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct OverlapProof([[VertexId; 2]; 4]);

impl Default for OverlapProof {
    fn default() -> Self {
        Self([[VertexId(0); 2]; 4])
    }
}

impl OverlapProof {
    fn from_simplex(simplex: &Simplex<f64>) -> Option<Self> {
        let kept: &[_; 4] = simplex.points().try_into().ok()?;
        Some(Self(kept.each(|c| [c.a, c.b])))
    }

    /// Returns a guess: four pairs of vertices, of A and of B, whose differences may contain the
    /// origin.
    pub(crate) fn guess(points: [[VertexId; 2]; 4]) -> Self {
        Self(points)
    }

    /// Returns the vertex pairs, of A and of B.
    pub(crate) fn vertex_pairs(&self) -> [[VertexId; 2]; 4] {
        self.0
    }

    /// Proves the overlap at this pose and writes it to the draft. Returns the new proof, or `None`
    /// if the bodies are not proven to overlap.
    ///
    /// The four points may still prove it. Otherwise the solver starts from those of them closest
    /// to the origin, or, if the four points are of no use, from the features `from` of the last
    /// answer.
    #[inline]
    pub(crate) fn renewed(&self, posed: &PosedPair, from: FeaturePair, draft: &mut Draft) -> Option<Self> {
        let frame = Transform::of(posed);
        let (a, b) = (posed.a.points.len(), posed.b.points.len());
        // State from a file, or of different bodies, may name vertices that do not exist.
        let is_valid = *self != Self::default() && self.0.iter().all(|[x, y]| x.index() < a && y.index() < b);
        let mut start = None;
        if is_valid {
            let points = self.0.each(|[x, y]| difference_point(posed, &frame, x, y));
            let simplex = Simplex::tetrahedron(points, posed.error_scale::<f64>());
            if simplex.len() < 4 {
                start = Some(simplex);
            } else if write_overlap(posed, &simplex, draft) {
                draft.solver = Solver::Polytope;
                return Some(*self);
            }
        }
        // Four points around the origin whose witness points differ are no start, because no point
        // is closer.
        let start = start.unwrap_or_else(|| vertex_of(posed, &frame, from));
        solve_overlap(posed, &frame, start, draft)
    }
}

/// Solves for an overlap from a simplex; returns the proof if the bodies overlap.
#[cold]
fn solve_overlap(
    posed: &PosedPair,
    frame: &Transform<f64>,
    start: Simplex<f64>,
    draft: &mut Draft,
) -> Option<OverlapProof> {
    draft.work.fallbacks += 1;
    let Minimum::Inside { simplex } = solve(posed, frame, start) else {
        return None;
    };
    draft.solver = Solver::Gjk;
    write_overlap(posed, &simplex, draft).then(|| OverlapProof::from_simplex(&simplex))?
}

/// Writes the overlap and the witness points of a tetrahedron around the origin. The features stay
/// those of the last answer. Returns whether the overlap is proven.
fn write_overlap(posed: &PosedPair, simplex: &Simplex<f64>, draft: &mut Draft) -> bool {
    [draft.point_on_a, draft.point_on_b] = witnesses(posed, simplex);
    set_overlapping(draft);
    is_proven(posed, draft)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::solids;
    use crate::rng::Rng;

    /// Tests points of small and of large faces.
    #[test]
    fn the_triangle_holds_the_point() {
        let mut rng = Rng::new(7);
        for corners in [3, 4, 5, 9, 40, 400] {
            let body = solids::prism(corners, 1.0, 1.0).expect("a prism");
            for face in body.faces().take(200) {
                let t = &body.topology;
                let rim: alloc::vec::Vec<_> = t.rim(face).map(|h| body.points[t.from(h).index()]).collect();
                for _ in 0..20 {
                    let weights: alloc::vec::Vec<f64> = rim.iter().map(|_| rng.range(0.0, 1.0).powi(9)).collect();
                    let sum: f64 = weights.iter().sum();
                    let x = rim
                        .iter()
                        .zip(&weights)
                        .map(|(v, w)| v * (w / sum))
                        .sum::<Vector3<f64>>();
                    let [p, q, r] = triangle(&body, face, &x).map(|v| body.points[v.index()]);
                    let n = body.planes[face.index()].normal;
                    let height = |p: Vector3<f64>, q: Vector3<f64>| n.dot(&(q - p).cross(&(x - p)));
                    let least = height(p, q).min(height(q, r)).min(height(r, p));
                    assert!(least > -1e-15, "{corners} {face:?}: {least}");
                }
            }
        }
    }
}
