//! The last rung of the depth: every facet of the difference looked at, for small bodies thinner than rounding.
//!
//! Each facet of A - B is a face of A beside a vertex of B, a vertex of A beside a face of B, or two edges (Cameron and Culley
//! 1986, "Determining the minimum translational distance between two convex polyhedra"). With the origin inside, the depth is
//! the least of their heights, and any direction that is no facet's is no lower. Of the list, what may be the least stays: two edges
//! whose faces leave no normal in common go by their signs, and a facet that is too high by its height in double-double. The
//! rest is decided in exact arithmetic. No surface is needed, so nothing can fold.

use alloc::vec::Vec;

use crate::exact;
use crate::num::double_double::DoubleDouble;
use crate::num::scalar::{Scalar, Vec3, cross, dot, neg, root};
use crate::num::sign::side;
use crate::pair::difference::corner;
use crate::pair::edge::Edge;
use crate::pair::outcome::Outcome;
use crate::pair::posed::Placed;
use crate::pair::transform::Frame;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::pose::Which;
use crate::tolerance::{CERTIFICATE, EXACT_FILTER, NORMAL_ERROR};

use crate::depth::facet::{edge, normal_of};
use crate::depth::search::highest;

/// Pairs of edges that are looked at: 2048 edges beside 2048.
const PAIRS: usize = 1 << 22;

/// Pairs that are measured.
const MEASURED: usize = 1 << 16;

/// Looks at a vertex in double-double: some hundred milliseconds.
const LOOKS: usize = 1 << 22;

/// Settles the depth of bodies whose interiors meet; whether it could.
pub(super) fn settle(placed: &Placed, frame: &Frame<DoubleDouble>, outcome: &mut Outcome) -> bool {
    let Some(mut pairs) = facets(placed, frame) else {
        return false;
    };
    thin_out(placed, &Frame::<f64>::of(placed), &mut pairs);
    if pairs.len() * (placed.a.points.len() + placed.b.points.len()) > LOOKS {
        return false;
    }
    thin_out(placed, frame, &mut pairs);
    outcome.work.exacts += 1;
    exact::deepest(placed, &pairs, outcome)
}

/// Leaves those that may be the lowest as far as an arithmetic can tell.
fn thin_out<T: Scalar>(placed: &Placed, frame: &Frame<T>, pairs: &mut Vec<FeaturePair>) {
    let measured: Vec<(f64, f64)> = pairs.iter().map(|&pair| measure(placed, frame, pair)).collect();
    let least = measured.iter().fold(f64::INFINITY, |least, (_, most)| least.min(*most));
    let mut lowest = measured.iter().map(|(lower, _)| lower);
    // Written so that NaN stays.
    pairs.retain(|_| !lowest.next().is_some_and(|lower| *lower > least));
}

/// All pairs of features that may span a facet; none where they are too many, or where a face stands for several that are not listed.
fn facets(placed: &Placed, frame: &Frame<DoubleDouble>) -> Option<Vec<FeaturePair>> {
    let (a, b) = (placed.a, placed.b);
    let of_a = a.faces().map(|f| FeaturePair::vertex_face(Which::B, 0, f.0));
    let of_b = b.faces().map(|f| FeaturePair::vertex_face(Which::A, 0, f.0));
    let mut pairs: Vec<FeaturePair> = of_a.chain(of_b).collect();
    let on_b: Vec<_> = b.edges().map(|g| (g, Edge::new(b, g.0))).collect();
    let too_many = pairs.len() > MEASURED || a.edges().count() * on_b.len() > PAIRS;
    if too_many || ![a, b].into_iter().all(has_flat_faces) {
        return None;
    }
    let mut doubtful = 0;
    for e in a.edges() {
        let on_a = Edge::new(a, e.0);
        let along_a = placed.vector_in_b(&(on_a.q - on_a.p));
        for (g, on_b) in &on_b {
            let along_b = placed.vector_in_a(&(on_b.q - on_b.p));
            if !(on_a.may_leave(&along_b) && on_b.may_leave(&along_a)) {
                continue;
            }
            doubtful += 1;
            if doubtful > MEASURED {
                return None;
            }
            if may_share(placed, frame, e.0, g.0) {
                pairs.push(FeaturePair::edges(Which::A, e.0, g.0));
            }
        }
    }
    Some(pairs)
}

/// Whether the corners of each face are in one plane, exactly.
fn has_flat_faces(body: &ConvexPolyhedron) -> bool {
    body.faces().all(|f| {
        let corner = |h: u32| body.points[body.topology.from(h) as usize];
        let start = body.topology.rim_start(f.0);
        let next = |h: u32| body.topology.half_edge(h).next;
        let [p, q] = [start, next(start)].map(corner);
        // Three corners in line say nothing of the others.
        body.topology
            .rim(f.0)
            .all(|h| side(&p, &q, &corner(h), &corner(next(h))) == 0.0)
    })
}

/// Whether two edges may share a normal, in double-double: across both, the faces beside each must fall off.
fn may_share(placed: &Placed, frame: &Frame<DoubleDouble>, e: u32, g: u32) -> bool {
    let n = cross(&edge(placed.a, e), &frame.vector(&edge(placed.b, g)));
    let noise = 2.0 * CERTIFICATE * DoubleDouble::UNIT;
    // Whether a face beside an edge certainly falls off along `n`, and whether one rises: by its corner after the edge.
    let slopes = |body: &ConvexPolyhedron, h: u32, n: &Vec3<DoubleDouble>| {
        let t = &body.topology;
        let from = body.points[t.from(h) as usize];
        let beside = [h, t.half_edge(h).twin].map(|h| {
            let corner = body.points[t.half_edge(t.half_edge(h).next).to as usize];
            let u = [0, 1, 2].map(|k| DoubleDouble::sum(corner[k], -from[k]));
            (dot(n, &u).value(), noise * (corner - from).abs().sum())
        });
        let falls = beside.iter().any(|(x, noise)| *x < -noise);
        (falls, beside.iter().any(|(x, noise)| x > noise))
    };
    let (falls_a, rises_a) = slopes(placed.a, e, &n);
    let (falls_b, rises_b) = slopes(placed.b, g, &frame.direction(&n));
    // Along n, A falls off and B, which is taken off, rises; or the other way round.
    !(rises_a || falls_b) || !(falls_a || rises_b)
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

/// Between what the height of the difference along the normal of a facet is: it errs by its own rounding, and by L times the angle
/// that the normal may be off.
fn measure<T: Scalar>(placed: &Placed, frame: &Frame<T>, pair: FeaturePair) -> (f64, f64) {
    let (a, b) = pair.vertices_of(placed.a, placed.b);
    let on = corner(placed, frame, a, b);
    let Some(n) = normal_of(placed, frame, pair, &on) else {
        return (f64::NEG_INFINITY, f64::INFINITY);
    };
    let rounding = 2.0 * CERTIFICATE * T::UNIT;
    let off = match (pair.a, pair.b) {
        (Feature::Edge(e), Feature::Edge(g)) => {
            let across = cross(&edge(placed.a, e.0), &frame.vector(&edge(placed.b, g.0)));
            rounding / root(dot(&across, &across)).value()
        }
        _ => 2.0 * NORMAL_ERROR,
    };
    let error = rounding * placed.reach::<T>().whole() + off * placed.size();
    let along = |n| dot(&n, &highest(placed, frame, &n, &on).w).value();
    let mut height = along(n);
    // Of two edges this near to the origin it is not known which way the facet looks.
    if dot(&n, &on.w).value().abs() <= error {
        height = height.min(along(neg(&n)));
    }
    let error = error + f64::EPSILON * height.abs();
    ((height - error).next_down(), (height + error).next_up())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::{Memory, deepen};
    use crate::pair::outcome::{Class, Layer, Level};
    use crate::polyhedron::solids;
    use crate::pose::RelativePose;
    use crate::solve::solve;
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
        let frame = Frame::<DoubleDouble>::new(&sphere, &sphere, &pose).expect("in range");
        assert!(facets(&placed, &frame).is_none());
    }
}
