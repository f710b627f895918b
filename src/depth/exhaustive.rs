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
use crate::pair::difference::difference_point;
use crate::pair::edge::Edge;
use crate::pair::outcome::Outcome;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::pose::Operand;
use crate::tolerance::{CERTIFICATE, EXACT_FILTER, NORMAL_ERROR};

use crate::depth::facet::{edge, normal_of};
use crate::pair::difference::support;
use crate::tuning::depth::{LOOKS, MEASURED, PAIRS};

/// Settles the depth of bodies whose interiors meet; whether it could.
pub(super) fn resolve_exactly(posed: &PosedPair, frame: &Transform<DoubleDouble>, outcome: &mut Outcome) -> bool {
    let Some(mut pairs) = facets(posed, frame) else {
        return false;
    };
    thin_out(posed, &Transform::<f64>::of(posed), &mut pairs);
    if pairs.len() * (posed.a.points.len() + posed.b.points.len()) > LOOKS {
        return false;
    }
    thin_out(posed, frame, &mut pairs);
    outcome.work.exacts += 1;
    exact::deepest(posed, &pairs, outcome)
}

/// Leaves those that may be the lowest as far as an arithmetic can tell.
fn thin_out<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, pairs: &mut Vec<FeaturePair>) {
    let measured: Vec<(f64, f64)> = pairs.iter().map(|&pair| measure(posed, frame, pair)).collect();
    let least = measured.iter().fold(f64::INFINITY, |least, (_, most)| least.min(*most));
    let mut lowest = measured.iter().map(|(lower, _)| lower);
    // Written so that NaN stays.
    pairs.retain(|_| !lowest.next().is_some_and(|lower| *lower > least));
}

/// All pairs of features that may span a facet; none where they are too many, or where a face stands for several that are not listed.
fn facets(posed: &PosedPair, frame: &Transform<DoubleDouble>) -> Option<Vec<FeaturePair>> {
    let (a, b) = (posed.a, posed.b);
    let of_a = a.faces().map(|f| FeaturePair::vertex_face(Operand::B, 0, f.0));
    let of_b = b.faces().map(|f| FeaturePair::vertex_face(Operand::A, 0, f.0));
    let mut pairs: Vec<FeaturePair> = of_a.chain(of_b).collect();
    let on_b: Vec<_> = b.edges().map(|g| (g, Edge::new(b, g.0))).collect();
    let too_many = pairs.len() > MEASURED || a.edges().count() * on_b.len() > PAIRS;
    if too_many || ![a, b].into_iter().all(has_flat_faces) {
        return None;
    }
    let mut doubtful = 0;
    for e in a.edges() {
        let on_a = Edge::new(a, e.0);
        let along_a = posed.vector_in_b(&(on_a.q - on_a.p));
        for (g, on_b) in &on_b {
            let along_b = posed.vector_in_a(&(on_b.q - on_b.p));
            if !(on_a.may_leave(&along_b) && on_b.may_leave(&along_a)) {
                continue;
            }
            doubtful += 1;
            if doubtful > MEASURED {
                return None;
            }
            if may_share(posed, frame, e.0, g.0) {
                pairs.push(FeaturePair::edges(Operand::A, e.0, g.0));
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
fn may_share(posed: &PosedPair, frame: &Transform<DoubleDouble>, e: u32, g: u32) -> bool {
    let n = cross(&edge(posed.a, e), &frame.vector(&edge(posed.b, g)));
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
    let (falls_a, rises_a) = slopes(posed.a, e, &n);
    let (falls_b, rises_b) = slopes(posed.b, g, &frame.direction(&n));
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
fn measure<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, pair: FeaturePair) -> (f64, f64) {
    let (a, b) = pair.vertices_of(posed.a, posed.b);
    let on = difference_point(posed, frame, a, b);
    let Some(n) = normal_of(posed, frame, pair, &on) else {
        return (f64::NEG_INFINITY, f64::INFINITY);
    };
    let rounding = 2.0 * CERTIFICATE * T::UNIT;
    let off = match (pair.a, pair.b) {
        (Feature::Edge(e), Feature::Edge(g)) => {
            let across = cross(&edge(posed.a, e.0), &frame.vector(&edge(posed.b, g.0)));
            rounding / root(dot(&across, &across)).value()
        }
        _ => 2.0 * NORMAL_ERROR,
    };
    let error = rounding * posed.reach::<T>().whole() + off * posed.size();
    let along = |n| dot(&n, &support(posed, frame, &n, &on).w).value();
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
    use crate::depth::{Memory, penetration_depth};
    use crate::pair::outcome::{Accuracy, Class, Solver};
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
                    let Ok(posed) = PosedPair::new(a, b, &pose) else {
                        panic!("in range")
                    };
                    let mut outcome = Outcome::open(FeaturePair::vertices(Operand::A, 0, 0));
                    solve(Accuracy::Certified, &posed, false, &mut outcome);
                    if outcome.class != Class::Overlapping {
                        continue;
                    }
                    penetration_depth(&posed, &mut Memory::default(), &mut outcome);
                    let mut all = outcome;
                    let frame = Transform::<DoubleDouble>::new(a, b, &pose).expect("in range");
                    assert!(resolve_exactly(&posed, &frame, &mut all), "{all:?}");
                    assert!(
                        outcome.lower <= all.upper && all.lower <= outcome.upper,
                        "{outcome:?} {all:?}"
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
        assert!(facets(&posed, &frame).is_none());
    }
}
