//! Last stage of the depth: enumerates every facet of A - B, for small bodies thinner than
//! rounding.
//!
//! Each facet of A - B is a face of A with a vertex of B, a vertex of A with a face of B, or a pair
//! of edges (Cameron and Culley 1986, "Determining the minimum translational distance between two
//! convex polyhedra"). If the origin is inside, the depth is the least facet height, and no
//! direction other than a facet normal has a smaller height. The list keeps only candidates for the
//! minimum. Signs exclude a pair of edges whose faces have no common normal; its height in
//! double-double excludes a facet that is too high. Exact arithmetic decides between the others. No
//! polytope is needed, so nothing can fold.

use alloc::vec::Vec;

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, root};
use crate::base::num::sign::side;
use crate::base::tolerance::{CERTIFICATE, EXACT_FILTER, NORMAL_ERROR};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, HalfEdgeId, VertexId};
use crate::convex::exact;
use crate::pair::difference::difference_point;
use crate::pair::draft::Draft;
use crate::pair::posed::PosedPair;
use crate::pair::star::EdgeSpan;
use crate::pair::transform::Transform;

use crate::convex::depth::facet::edge;
use crate::pair::difference::DifferenceFacet;
use crate::pair::difference::support;

/// Largest number of pairs of edges that the exact enumeration of all facets tests: 2048 edges of
/// each body. Beyond, bounds are not tight.
#[cfg(feature = "exact")]
const MAX_EDGE_PAIRS: usize = 1 << 22;

/// Largest number of pairs that the exact enumeration of all facets measures. Beyond, bounds are
/// not tight.
#[cfg(feature = "exact")]
const MAX_MEASURED: usize = 1 << 16;

/// Largest number of tests of a vertex in double-double by the enumeration of all facets. Measured:
/// a few hundred milliseconds. Beyond, bounds are not tight.
#[cfg(feature = "exact")]
const MAX_EVALUATIONS: usize = 1 << 22;

/// Resolves the depth of bodies with intersecting interiors; returns whether the depth was
/// resolved.
pub(super) fn resolve_exactly(posed: &PosedPair, frame: &Transform<DoubleDouble>, draft: &mut Draft) -> bool {
    let Some(mut pairs) = candidate_facets(posed, frame) else {
        return false;
    };
    keep_lowest(posed, &Transform::<f64>::of(posed), &mut pairs);
    if pairs.len() * (posed.a.points.len() + posed.b.points.len()) > MAX_EVALUATIONS {
        return false;
    }
    keep_lowest(posed, frame, &mut pairs);
    draft.work.exacts += 1;
    exact::deepest(posed, &pairs, draft)
}

/// Keeps the pairs that may have the least height, as far as the arithmetic `T` can decide.
fn keep_lowest<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, pairs: &mut Vec<DifferenceFacet>) {
    let heights: Vec<(f64, f64)> = pairs.iter().map(|&facet| height_bounds(posed, frame, facet)).collect();
    let least = heights
        .iter()
        .fold(f64::INFINITY, |least, (_, most)| least.smaller(*most));
    let mut lowest = heights.iter().map(|(lower, _)| lower);
    // NaN keeps the pair.
    pairs.retain(|_| !lowest.next().is_some_and(|lower| *lower > least));
}

/// Returns all feature pairs that may span a facet; `None` if there are too many, or if a stored
/// face represents several unlisted faces.
fn candidate_facets(posed: &PosedPair, frame: &Transform<DoubleDouble>) -> Option<Vec<DifferenceFacet>> {
    let (a, b) = (posed.a, posed.b);
    let of_a = a.faces().map(|f| DifferenceFacet::FaceVertex(f, VertexId(0)));
    let of_b = b.faces().map(|f| DifferenceFacet::VertexFace(VertexId(0), f));
    let mut pairs: Vec<_> = of_a.chain(of_b).collect();
    let on_b: Vec<_> = b.edges().map(|g| (g, EdgeSpan::new(b, g))).collect();
    let too_many = pairs.len() > MAX_MEASURED || a.edges().count() * on_b.len() > MAX_EDGE_PAIRS;
    if too_many || ![a, b].into_iter().all(has_flat_faces) {
        return None;
    }
    let mut doubtful = 0;
    for e in a.edges() {
        let on_a = EdgeSpan::new(a, e);
        let along_a = posed.vector_in_b(&(on_a.q - on_a.p));
        for (g, on_b) in &on_b {
            let along_b = posed.vector_in_a(&(on_b.q - on_b.p));
            if !(on_a.may_be_perpendicular(&along_b) && on_b.may_be_perpendicular(&along_a)) {
                continue;
            }
            doubtful += 1;
            if doubtful > MAX_MEASURED {
                return None;
            }
            if may_share_normal(posed, frame, e, *g) {
                pairs.push(DifferenceFacet::Edges(e, *g));
            }
        }
    }
    Some(pairs)
}

/// Returns whether the vertices of each face lie exactly in a common plane.
fn has_flat_faces(body: &ConvexPolyhedron) -> bool {
    body.faces().all(|f| {
        let vertex = |h: HalfEdgeId| body.points[body.topology.from(h).index()];
        let start = body.topology.rim_half_edge(f);
        let next = |h: HalfEdgeId| body.topology.half_edge(h).next;
        let [p, q] = [start, next(start)].each(vertex);
        // Tests p and q with both ends of every edge: three collinear vertices prove nothing.
        body.topology
            .rim(f)
            .all(|h| side(&p, &q, &vertex(h), &vertex(next(h))) == 0.0)
    })
}

/// Returns whether two edges may share a normal, tested in double-double: along the common
/// perpendicular of both edges, all adjacent faces must descend.
fn may_share_normal(posed: &PosedPair, frame: &Transform<DoubleDouble>, e: EdgeId, g: EdgeId) -> bool {
    let n = cross(&edge(posed.a, e), &frame.vector(&edge(posed.b, g)));
    let noise = 2.0 * CERTIFICATE * DoubleDouble::UNIT;
    // Returns whether a face adjacent to the edge certainly descends along `n`, and whether a face
    // certainly rises, both judged by the face's vertex after the edge.
    let slopes = |body: &ConvexPolyhedron, e: EdgeId, n: &Vec3<DoubleDouble>| {
        let (t, h) = (&body.topology, e.half_edge());
        let from = body.points[t.from(h).index()];
        let adjacent = [h, t.half_edge(h).twin].each(|h| {
            let vertex = body.points[t.half_edge(t.half_edge(h).next).to.index()];
            let u = [0, 1, 2].each(|k| DoubleDouble::sum(vertex[k], -from[k]));
            (dot(n, &u).value(), noise * (vertex - from).abs().sum())
        });
        let falls = adjacent.iter().any(|(x, noise)| *x < -noise);
        (falls, adjacent.iter().any(|(x, noise)| x > noise))
    };
    let (falls_a, rises_a) = slopes(posed.a, e, &n);
    let (falls_b, rises_b) = slopes(posed.b, g, &frame.direction(&n));
    // Along n, A must descend and the subtracted B must rise, or vice versa.
    !(rises_a || falls_b) || !(falls_a || rises_b)
}

impl EdgeSpan<'_> {
    /// Returns whether some normal of the edge, between the normals of the two faces, may be
    /// perpendicular to `v`: false if `v` certainly rises along both face normals or certainly
    /// falls along both.
    fn may_be_perpendicular(&self, v: &nalgebra::Vector3<f64>) -> bool {
        let noise = EXACT_FILTER * v.abs().sum();
        let (left, right) = (v.dot(&self.left.normal), v.dot(&self.right.normal));
        // NaN returns true.
        !(left.smaller(right) > noise || left.larger(right) < -noise)
    }
}

/// Returns lower and upper bounds of the support of A - B along the facet normal, covering rounding
/// and L times the angular error of the normal.
fn height_bounds<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, facet: DifferenceFacet) -> (f64, f64) {
    let (a, b) = facet.features().vertices_of(posed.a, posed.b);
    let on = difference_point(posed, frame, a, b);
    let Some(n) = facet.normal(posed, frame, &on) else {
        return (f64::NEG_INFINITY, f64::INFINITY);
    };
    let rounding = 2.0 * CERTIFICATE * T::UNIT;
    let off = match facet {
        DifferenceFacet::Edges(e, g) => {
            let perpendicular = cross(&edge(posed.a, e), &frame.vector(&edge(posed.b, g)));
            rounding / root(dot(&perpendicular, &perpendicular)).value()
        }
        _ => 2.0 * NORMAL_ERROR,
    };
    let error = rounding * posed.error_scale::<T>().total() + off * posed.size();
    let along = |n| dot(&n, &support(posed, frame, &n, &on).w).value();
    let mut height = along(n);
    // If two edges pass this near the origin, the side the facet faces is unknown.
    if dot(&n, &on.w).value().abs() <= error {
        height = height.smaller(along(neg(&n)));
    }
    let error = error + f64::EPSILON * height.abs();
    ((height - error).next_down(), (height + error).next_up())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::pose::RelativePose;
    use crate::body::polyhedron::{FeaturePair, solids};
    use crate::convex::depth::{Memory, penetration_depth};
    use crate::convex::solve::solve;
    use crate::pair::outcome::{Accuracy, ContactState, Solver};
    use nalgebra::{Isometry3, Vector3};

    fn bodies() -> Vec<ConvexPolyhedron> {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0].into());
        [
            solids::cuboid(Vector3::new(1.0, 0.5, 0.25)),
            solids::octahedron(1.0),
            solids::icosahedron(0.7),
            solids::random_hull(20, Vector3::new(1.0, 0.6, 0.01), 5),
            ConvexPolyhedron::polygon(&square),
        ]
        .map(|b| b.expect("a body"))
        .into()
    }

    /// The polytope and the list of all facets share nothing but the bodies.
    #[test]
    fn all_facets_give_the_depth_of_the_surface() {
        let (mut closed, mut exact) = (0, 0);
        for (i, a) in bodies().iter().enumerate() {
            for b in &bodies() {
                for k in 0..8 {
                    let turn = Vector3::new(0.5, -0.3, 0.9) * f64::from(k);
                    let shift = Vector3::new(0.1 * f64::from(k), 0.05 * i as f64, -0.2);
                    let pose = Isometry3::new(shift, turn);
                    let pose = RelativePose::from_isometry(&pose).expect("a pose");
                    let Ok(posed) = PosedPair::new(a, b, &pose) else {
                        panic!("in range")
                    };
                    let mut draft = Draft::starting_at(FeaturePair::FIRST);
                    solve(Accuracy::Certified, &posed, false, &mut draft, |_| false);
                    if draft.state != ContactState::Overlapping {
                        continue;
                    }
                    penetration_depth(&posed, &mut Memory::default(), &mut draft);
                    let mut all = draft;
                    let frame = Transform::<DoubleDouble>::new(a, b, &pose).expect("in range");
                    assert!(resolve_exactly(&posed, &frame, &mut all), "{all:?}");
                    assert!(
                        draft.lower <= all.upper && all.lower <= draft.upper,
                        "{draft:?} {all:?}"
                    );
                    assert!(all.upper - all.lower <= 1e-15 * posed.size(), "{all:?}");
                    let between = posed.point_in_a(&all.point_on_b.coords) - all.point_on_a.coords;
                    let along = all.normal.into_inner() * all.distance;
                    assert!((between - along).norm() <= 1e-14 * posed.size(), "{all:?}");
                    closed += 1;
                    exact += usize::from(all.solver == Solver::Exact);
                }
            }
        }
        assert!(closed > 100 && exact == closed, "{closed} {exact}");
    }

    #[test]
    fn too_many_edges_are_left_alone() {
        let sphere = solids::random_hull(1500, Vector3::new(1.0, 1.0, 1.0), 1).expect("a hull");
        let pose = RelativePose::from_isometry(&Isometry3::identity()).expect("a pose");
        let Ok(posed) = PosedPair::new(&sphere, &sphere, &pose) else {
            panic!("in range")
        };
        let frame = Transform::<DoubleDouble>::new(&sphere, &sphere, &pose).expect("in range");
        assert!(candidate_facets(&posed, &frame).is_none());
    }
}
