//! The last rung of the depth: every facet of the difference looked at, for small bodies thinner than rounding.
//!
//! Each facet of A - B is a face of A beside a vertex of B, a vertex of A beside a face of B, or two edges (Cameron and Culley
//! 1986, "Determining the minimum translational distance between two convex polyhedra"). With the origin inside, the depth is
//! the least of their heights, and any direction that is no facet's is no lower. Of the list, what may be the least stays: two edges
//! whose faces leave no normal in common go by their signs, and a facet that is too high by its height in double-double. The
//! rest is decided in exact arithmetic. No surface is needed, so nothing can fold.

use alloc::vec::Vec;

use crate::closest::edge_edge::Edge;
use crate::closest::exact;
use crate::closest::fallback::corner;
use crate::closest::outcome::Outcome;
use crate::closest::placed::{Frame, Placed};
use crate::double_double::DoubleDouble;
use crate::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::pose::Which;
use crate::scalar::{Scalar, cross, dot, neg, root};
use crate::tolerance::{CERTIFICATE, EXACT_FILTER, NORMAL_ERROR};

use super::facet::{edge, normal_of};
use super::search::highest;

/// Pairs of edges that are looked at: 2048 edges beside 2048.
const PAIRS: usize = 1 << 22;

/// Pairs that are measured.
const MEASURED: usize = 1 << 14;

/// Settles the depth of bodies whose interiors meet; whether it could.
pub(super) fn settle(placed: &Placed, frame: &Frame<DoubleDouble>, outcome: &mut Outcome) -> bool {
    let Some(pairs) = facets(placed) else { return false };
    let mut measured = Vec::new();
    let mut least = f64::INFINITY;
    for pair in pairs {
        let (height, error) = measure(placed, frame, pair);
        least = least.min((height + error).next_up());
        measured.push(((height - error).next_down(), pair));
    }
    // Written so that NaN stays.
    measured.retain(|(height, _)| !(*height > least));
    let deepest: Vec<FeaturePair> = measured.into_iter().map(|(_, pair)| pair).collect();
    outcome.work.exacts += 1;
    exact::deepest(placed, &deepest, outcome)
}

/// All pairs of features that may span a facet; none where they are too many.
fn facets(placed: &Placed) -> Option<Vec<FeaturePair>> {
    let faces = |body: &ConvexPolyhedron| body.faces();
    let of_a = faces(placed.a).map(|f| FeaturePair::vertex_face(Which::B, 0, f.0));
    let of_b = faces(placed.b).map(|f| FeaturePair::vertex_face(Which::A, 0, f.0));
    let mut pairs: Vec<FeaturePair> = of_a.chain(of_b).collect();
    let on_b: Vec<Edge> = placed.b.edges().map(|g| Edge::new(placed.b, g.0)).collect();
    if pairs.len() > MEASURED || placed.a.edges().count() * on_b.len() > PAIRS {
        return None;
    }
    for e in placed.a.edges() {
        let a = Edge::new(placed.a, e.0);
        let along_a = placed.vector_in_b(&(a.q - a.p));
        for (g, b) in placed.b.edges().zip(&on_b) {
            let along_b = placed.vector_in_a(&(b.q - b.p));
            let share = a.may_leave(&along_b) && b.may_leave(&along_a);
            if share {
                pairs.push(FeaturePair::edges(Which::A, e.0, g.0));
            }
        }
        if pairs.len() > MEASURED {
            return None;
        }
    }
    Some(pairs)
}

impl Edge<'_> {
    /// Whether some normal of the edge, between those of its faces, may be across `v`: not where `v` certainly rises along both
    /// or falls along both.
    fn may_leave(&self, v: &nalgebra::Vector3<f64>) -> bool {
        let noise = EXACT_FILTER * v.abs().sum();
        let (left, right) = (v.dot(&self.left.normal), v.dot(&self.right.normal));
        // Written so that NaN may.
        !(left.min(right) > noise || left.max(right) < -noise)
    }
}

/// The height of the difference along the normal of a facet, and its error: that of the height itself, and L times the angle
/// by which the normal may be off.
fn measure(placed: &Placed, frame: &Frame<DoubleDouble>, pair: FeaturePair) -> (f64, f64) {
    let (a, b) = pair.vertices_of(placed.a, placed.b);
    let on = corner(placed, frame, a, b);
    let Some(n) = normal_of(placed, frame, pair, &on) else {
        return (0.0, f64::INFINITY);
    };
    let rounding = 2.0 * CERTIFICATE * DoubleDouble::UNIT;
    let off = match (pair.a, pair.b) {
        (crate::polyhedron::Feature::Edge(e), crate::polyhedron::Feature::Edge(g)) => {
            let across = cross(&edge(placed.a, e.0), &frame.vector(&edge(placed.b, g.0)));
            rounding / root(dot(&across, &across)).value()
        }
        _ => 2.0 * NORMAL_ERROR,
    };
    let reach = placed.reach::<DoubleDouble>().whole();
    let error = rounding * reach + off * placed.size();
    let along = |n| dot(&n, &highest(placed, frame, &n, &on).w).value();
    let mut height = along(n);
    // Of two edges this near to the origin it is not known which way the facet looks.
    if dot(&n, &on.w).value().abs() <= error {
        height = height.min(along(neg(&n)));
    }
    (height, error + f64::EPSILON * height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closest::outcome::{Class, Layer, Level};
    use crate::closest::solve;
    use crate::penetration::{Memory, deepen};
    use crate::polyhedron::solids;
    use crate::pose::RelativePose;
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

    /// The surface and the list of all facets have nothing in common but the bodies.
    #[test]
    fn every_facet_looked_at_gives_the_depth_of_the_surface() {
        let (mut closed, mut exact) = (0, 0);
        for (i, a) in bodies().iter().enumerate() {
            for b in &bodies() {
                for k in 0..8 {
                    let turn = Vector3::new(0.5, -0.3, 0.9) * f64::from(k);
                    let shift = Vector3::new(0.1 * f64::from(k), 0.05 * i as f64, -0.2);
                    let pose = Isometry3::new(shift, turn);
                    let pose = RelativePose::from_isometry(&pose).expect("a pose");
                    let Ok(placed) = Placed::new(a, b, &pose) else {
                        panic!("in range")
                    };
                    let mut outcome = Outcome::open(FeaturePair::vertices(Which::A, 0, 0));
                    solve(Level::Certified, &placed, false, &mut outcome);
                    if outcome.class != Class::Overlapping {
                        continue;
                    }
                    deepen(&placed, &mut Memory::default(), &mut outcome);
                    let mut all = outcome;
                    let frame = Frame::<DoubleDouble>::new(a, b, &pose).expect("in range");
                    assert!(settle(&placed, &frame, &mut all), "{all:?}");
                    assert!(
                        outcome.lower <= all.upper && all.lower <= outcome.upper,
                        "{outcome:?} {all:?}"
                    );
                    assert!(all.upper - all.lower <= 1e-15 * placed.size(), "{all:?}");
                    let between = placed.point_in_a(&all.point_on_b.coords) - all.point_on_a.coords;
                    let along = all.normal.into_inner() * all.distance;
                    assert!((between - along).norm() <= 1e-14 * placed.size(), "{all:?}");
                    closed += 1;
                    exact += usize::from(all.layer == Layer::Exact);
                }
            }
        }
        assert!(closed > 100 && exact == closed, "{closed} {exact}");
    }

    #[test]
    fn too_many_edges_are_left_alone() {
        let sphere = solids::random_hull(1500, Vector3::new(1.0, 1.0, 1.0), 1).expect("a hull");
        let pose = RelativePose::from_isometry(&Isometry3::identity()).expect("a pose");
        let Ok(placed) = Placed::new(&sphere, &sphere, &pose) else {
            panic!("in range")
        };
        assert!(facets(&placed).is_none());
    }
}
