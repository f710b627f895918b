//! Tests of the certificate: it must detect a walk with an error of any kind below. The result of
//! the walk is changed after the walk ends; the outcome must still be correct, from any solver.
#![cfg(test)]
extern crate std;

use alloc::{format, vec, vec::Vec};
use std::cell::Cell;

use crate::base::num::each::Each;
use crate::rng::Rng;
use nalgebra::{Isometry3, Unit, Vector3};

use crate::base::num::packed::PackedVec3;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair, VertexId, solids};
use crate::convex::solve::solve;
use crate::convex::walk::seed;
use crate::pair::draft::Draft;
use crate::pair::outcome::{Accuracy, ContactState, Solver, Work};
use crate::pair::posed::PosedPair;
use crate::pair::star::EdgeSpan;
use crate::pair::star::falls_into_both_faces;

/// Kinds of errors of a walk.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// The walk ends on random vertices and reports their distance.
    RandomVertices(u64),
    /// The walk ends on random vertices and reports their distance, with an unrelated direction.
    WrongNormal(u64),
    /// The distance is off by this factor.
    ScaledDistance(f64),
    /// The supporting planes are off by this distance, in units of L.
    ShiftedPlanes(f64),
    /// The walk reports an end and nothing else.
    NothingComputed,
    /// The numbers are NaN.
    NotANumber,
    /// The walk never ends.
    NoEnd,
}

std::thread_local! {
    static FAULT: Cell<Option<Fault>> = const { Cell::new(None) };
}

/// Falsifies the result of a walk by the error set for this thread; with no error set, returns the
/// truth.
pub(super) fn falsify(posed: &PosedPair, draft: &mut Draft, ended: bool) -> bool {
    let Some(fault) = FAULT.get() else { return ended };
    let vertices = |draft: &mut Draft, seed: u64| {
        let of = |body: &ConvexPolyhedron, seed: u64| VertexId((seed % body.points.len() as u64) as u32);
        let (a, b) = (of(posed.a, seed), of(posed.b, seed / 7));
        draft.features = FeaturePair::vertices(Operand::A, a, b);
        let (p, q) = (posed.a.points[a.index()], posed.b.points[b.index()]);
        let between = posed.point_in_a(&q) - p;
        draft.distance = between.norm();
        draft.normal = Unit::new_normalize(between);
        (draft.point_on_a, draft.point_on_b) = (p.into(), q.into());
        draft.lower = f64::NEG_INFINITY;
    };
    match fault {
        Fault::RandomVertices(seed) => vertices(draft, seed),
        Fault::WrongNormal(seed) => {
            vertices(draft, seed);
            draft.normal = Unit::new_normalize(Vector3::new(seed as f64, 1.0, -(seed as f64) / 2.0));
        }
        Fault::ScaledDistance(by) => draft.distance *= by,
        Fault::ShiftedPlanes(by) => draft.lower += by * posed.size(),
        Fault::NothingComputed => *draft = Draft::starting_at(draft.features),
        Fault::NotANumber => {
            draft.distance = f64::NAN;
            draft.lower = f64::NAN;
        }
        Fault::NoEnd => return false,
    }
    match fault {
        Fault::ScaledDistance(_) | Fault::ShiftedPlanes(_) => ended,
        _ => true,
    }
}

fn ask(posed: &PosedPair, fault: Option<Fault>, start: Option<FeaturePair>) -> Draft {
    FAULT.set(fault);
    let mut draft = Draft::starting_at(start.unwrap_or_else(|| seed::cold(posed, &mut Work::default())));
    solve(Accuracy::Certified, posed, start.is_some(), &mut draft, |_| false);
    FAULT.set(None);
    draft
}

fn faults() -> Vec<Fault> {
    let mut all = vec![Fault::NothingComputed, Fault::NotANumber, Fault::NoEnd];
    for by in [
        0.0,
        0.5,
        0.999_999,
        1.0 - 1e-11,
        1.0 + 1e-11,
        1.000_001,
        2.0,
        -1.0,
        f64::INFINITY,
    ] {
        all.push(Fault::ScaledDistance(by));
    }
    all.extend([-1.0, -1e-3, -1e-9, 1e-12, 1e-9, 1e-3, 1.0, f64::INFINITY].each(Fault::ShiftedPlanes));
    all.extend((1..20).flat_map(|seed| [Fault::RandomVertices(seed * 31), Fault::WrongNormal(seed * 17)]));
    all
}

fn bodies() -> Vec<ConvexPolyhedron> {
    vec![
        solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).unwrap(),
        solids::icosahedron(1.0).unwrap(),
        solids::random_hull(40, Vector3::new(1.0, 0.8, 1e-4), 3).unwrap(),
        solids::cone(64, 0.25, 1.0).unwrap(),
    ]
}

#[test]
fn a_walk_that_errs_is_found_out() {
    let bodies = bodies();
    let (mut right, mut by_walk, mut found_out) = (0, 0, 0);
    for (i, a) in bodies.iter().enumerate() {
        for b in &bodies {
            for k in 0..6 {
                let turn = Vector3::new(0.3, -0.2, 0.5) * f64::from(k);
                let pose = Isometry3::new(Vector3::new(2.6, 0.4 * f64::from(k), 0.7 * i as f64), turn);
                let pose = RelativePose::from_isometry(&pose).unwrap();
                let Ok(posed) = PosedPair::new(a, b, &pose) else {
                    panic!("in range")
                };
                let truth = ask(&posed, None, None);
                assert_eq!((truth.state, truth.solver), (ContactState::Separated, Solver::Walk));
                for fault in faults() {
                    for start in [None, Some(FeaturePair::FIRST)] {
                        let x = ask(&posed, Some(fault), start);
                        let what = format!("{fault:?}: {x:?} for {truth:?}");
                        assert_eq!(x.state, ContactState::Separated, "{what}");
                        assert!(x.lower <= truth.upper && truth.lower <= x.upper, "{what}");
                        assert!((x.distance - truth.distance).abs() <= 1e-14 * posed.size(), "{what}");
                        assert!(x.upper - x.lower <= 1e-13 * posed.size(), "{what}");
                        right += 1;
                        by_walk += usize::from(x.solver == Solver::Walk);
                        found_out += usize::from(x.solver > Solver::Restart);
                    }
                }
            }
        }
    }
    // Errors below the limit of the certificate may pass, and so may random vertices that happen to
    // be closest.
    assert!(
        found_out * 10 > right * 8 && by_walk * 5 < right,
        "{found_out} and {by_walk} of {right}"
    );
}

#[test]
fn a_bound_by_two_planes_holds_for_any_planes_and_weights() {
    let mut rng = Rng::new(1);
    let mut random = || rng.range(-1.0, 1.0);
    let mut finite = 0;
    for body in bodies() {
        for _ in 0..20_000 {
            let n = Vector3::new(random(), random(), random());
            let mut plane = || &body.planes[((random() + 1.0) * 0.5 * body.planes.len() as f64) as usize];
            let (left, right) = (plane(), plane());
            let weights = [random() + 0.5, random() + 0.5];
            let bound = body.edge_bound(PackedVec3::new(&n), left, right, weights, n.norm_squared());
            let high = body.points.iter().fold(f64::NEG_INFINITY, |m, p| m.max(n.dot(p)));
            assert!(!(bound < high - 1e-15 * body.radius), "{bound} {high}");
            finite += usize::from(bound.is_finite());
            let v = VertexId(((random() + 1.0) * 0.5 * body.points.len() as f64) as u32);
            let fan = body.fan_minimum(v, &n);
            if body.proves_lowest(&fan, &n) {
                let low = body.points.iter().fold(f64::INFINITY, |m, p| m.min(n.dot(p)));
                assert_eq!(low, n.dot(&body.points[v.index()]));
            }
        }
    }
    assert!(finite > 20_000, "{finite}");
}

#[test]
fn an_edge_that_signs_prove_extreme_is_so() {
    let mut rng = Rng::new(7);
    let mut random = || rng.range(-1.0, 1.0);
    let (mut proven, mut doubtful) = (0, 0);
    for body in bodies() {
        for e in body.edges() {
            let edge = EdgeSpan::new(&body, e);
            let u = PackedVec3::new(&edge.q) - PackedVec3::new(&edge.p);
            for k in 0..300 {
                // Random directions, and directions closer and closer to the normal of a face.
                let face = if random() < 0.0 { edge.left } else { edge.right };
                let off = Vector3::new(random(), random(), random()) * 0.125f64.powi(k % 20);
                let w = PackedVec3::new(&(face.normal.cross(&u.vector()) * f64::from((k % 20).min(1)) + off));
                let n = u.cross(w);
                if !falls_into_both_faces(edge.weights(w, 1.0), w.norm_squared()) {
                    doubtful += 1;
                    continue;
                }
                proven += 1;
                let n = n.vector();
                let high = body
                    .points
                    .iter()
                    .fold(f64::NEG_INFINITY, |m, p| m.max(n.dot(&(p - edge.p))));
                let most = 16.0 * UNIT * body.radius * (u.norm_squared() * w.norm_squared()).sqrt();
                assert!(high <= most, "{e} {k}: {high} beyond {most}");
            }
        }
    }
    assert!(proven > 10_000 && doubtful > 10_000, "{proven} and {doubtful}");
}
