//! Surfaces against compounds: piece by piece, over time, in both orders.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Decision, PairTracker, Piece, QueryOptions, RelativePose, Velocity,
};
use truth::pose::{add, scale, sub};
use truth::rational::{exact, placed, rounded};
use truth::rng::Rng;
use truth::support::Decide;
use truth::support::piece_at;
use truth::{Point, Pose};

use crate::bodies::{bumpy, place, pose};
use crate::shapes::{kinds, sampled};

/// Returns three pieces of different kinds, rotated, about the origin.
fn body(rng: &mut Rng, k: usize) -> Compound {
    let shapes = kinds();
    let piece = |i: usize| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
        let at = Vector3::from(rng.unit()) * rng.range(0.0, 0.8);
        piece_at(
            Isometry3::from_parts(at.into(), turn),
            shapes[(k + i) % shapes.len()].clone(),
        )
    };
    Compound::new((0..3).map(piece).collect()).expect("a body")
}

fn of_piece(at: &Isometry3<f64>, piece: &Piece) -> RelativePose {
    RelativePose::new(&Isometry3::identity(), &(at * piece.pose)).expect("a pose")
}

#[test]
fn the_closest_piece_is_found() {
    let mut rng = Rng::new(91);
    let (mut overlaps, mut apart, mut of) = (0, 0, [0; 3]);
    for k in 0..40 {
        let surface = BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.6)]).expect("a surface");
        let body = body(&mut rng, k);
        let mut tracker = PairTracker::new();
        for _ in 0..5 {
            let far = rng.range(0.3, 3.0);
            let at = place(&mut rng, far);
            let found = tracker.closest_with(&surface, &body, &pose(&at), &QueryOptions::default().width(1e-9));
            let (mut lower, mut upper) = (f64::INFINITY, f64::INFINITY);
            for piece in body.pieces() {
                let o = PairTracker::new().closest_with(
                    &surface,
                    &piece.shape,
                    &of_piece(&at, piece),
                    &QueryOptions::default().width(1e-9),
                );
                (lower, upper) = (o.lower.min(lower), o.upper.min(upper));
            }
            let o = &found;
            assert!(o.is_converged && o.upper - o.lower.max(0.0) <= 1e-9, "{found:?}");
            assert!(o.lower <= upper + 1e-13, "{lower} {upper} {found:?}");
            assert!(lower <= o.upper + 1e-13, "{lower} {upper} {found:?}");
            let between = (at * o.point_on_b - o.point_on_a).norm();
            let is_overlap = o.state == ContactState::Overlapping;
            assert!(
                is_overlap || (between - o.distance).abs() < 1e-12,
                "{between} {found:?}"
            );
            assert_eq!(is_overlap, upper == 0.0, "{found:?}");
            let within = tracker.decide(&surface, &body, &pose(&at), 0.5 * o.distance);
            assert!(is_overlap || within == Decision::No, "{within:?} {found:?}");
            (overlaps, apart) = (overlaps + u32::from(is_overlap), apart + u32::from(o.lower > 0.0));
            of[found.locations[1].subshape as usize] += 1;
        }
    }
    assert!(overlaps > 20, "{overlaps} {apart} {of:?}");
    assert!(apart > 80, "{overlaps} {apart} {of:?}");
    assert!(of.iter().all(|n| *n > 30), "{overlaps} {apart} {of:?}");
}

#[test]
fn bodies_of_pieces_are_met_on_time_in_both_orders() {
    let mut rng = Rng::new(92);
    let (mut hits, mut misses) = (0, 0);
    for k in 0..40 {
        let surface = BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.6)]).expect("a surface");
        let body = body(&mut rng, k);
        let from = Vector3::from(rng.unit()) * rng.range(2.5, 3.5);
        let velocity = Vector3::from(rng.unit()) * rng.range(0.0, 2.5) - from * 1.2;
        let moving = |at: Vector3<f64>, linear, angular| {
            Steady::new(&Isometry3::from(at), Velocity::new(linear, angular)).expect("a motion")
        };
        let still = moving(Vector3::zeros(), Vector3::zeros(), Vector3::from(rng.unit()));
        let flight = moving(from, velocity, Vector3::from(rng.unit()) * 2.0);
        let tolerance = Tolerance::Distance(1e-5);
        let found = cast(
            &mut PairTracker::new().pair(&surface, &body),
            &still,
            &flight,
            0.0..1.0,
            tolerance,
        );
        let mut tracker = PairTracker::new();
        let mut back = tracker.pair(&body, &surface);
        let swapped = cast(&mut back, &flight, &still, 0.0..1.0, tolerance).expect("a cast");
        let until = match (found.expect("a cast").impact, swapped.impact) {
            (
                Impact::Hit { safe, hit, .. },
                Impact::Hit {
                    safe: again,
                    hit: other,
                    ..
                },
            ) => {
                assert!(safe <= other && again <= hit, "{k}: {safe} {hit} {again} {other}");
                let (a, b) = (still.pose(hit), flight.pose(hit));
                let at = RelativePose::new(&a, &b).expect("a pose");
                let within = PairTracker::new().decide(&surface, &body, &at, 2e-5);
                assert_eq!(within, Decision::Yes, "{k}");
                hits += 1;
                safe
            }
            (Impact::Miss, Impact::Miss) => {
                misses += 1;
                1.0
            }
            other => panic!("{k}: {other:?}"),
        };
        for i in 0..=20 {
            let time = until * f64::from(i) / 20.0;
            let at = still.pose(time).inverse() * flight.pose(time);
            for piece in body.pieces() {
                let least = sampled(&surface, &piece.shape, &of_piece(&at, piece), 8);
                assert!(least > 0.0, "{k}: {least} at {time}, safe {until}");
            }
        }
    }
    assert!(hits > 20 && misses > 2, "{hits} {misses}");
}

/// Poses far beyond the size of the bodies, and invalid numbers.
#[test]
fn far_bodies_have_bounds() {
    let mut rng = Rng::new(93);
    let surface = BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.6)]).expect("a surface");
    let body = body(&mut rng, 0);
    let mut tracker = PairTracker::new();
    for far in [1e3, 1e9, 1e30, 1e120, 1e200, 1e305, 10.0] {
        let at = Isometry3::translation(0.0, 0.0, far);
        for width in [1e-9, 0.0, -1.0, f64::NAN] {
            let o = tracker.closest_with(&surface, &body, &pose(&at), &QueryOptions::default().width(width));
            assert!(o.lower <= o.distance && o.distance <= o.upper, "{far:e} {width}: {o:?}");
            assert!(o.lower <= far + 4.0 && far - 4.0 <= o.upper, "{far:e} {width}: {o:?}");
        }
        assert_eq!(tracker.decide(&surface, &body, &pose(&at), f64::NAN), Decision::No);
        assert_eq!(tracker.decide(&surface, &body, &pose(&at), -1.0), Decision::No);
        let found = tracker.decide(&surface, &body, &pose(&at), f64::INFINITY);
        assert_eq!(found, Decision::Yes);
    }
}

/// Rounding of a piece's pose grows with the distance of its vertices from the origin of the piece,
/// not with the size of the body.
#[test]
fn a_rotated_piece_far_from_its_origin_is_measured_with_its_rounding() {
    let corner = |k: usize| Point3::new(4.0 * (k / 2) as f64 - 2.0, 4.0 * (k % 2) as f64 - 2.0, 0.0);
    let patch = BezierPatch::polynomial([1, 1], &(0..4).map(corner).collect::<Vec<_>>()).expect("a patch");
    let surface = BezierSurface::new(vec![patch]).expect("a surface");
    let mut rng = Rng::new(96);
    for k in 0..200 {
        let far = [0.0, 1e3, 1e6][k % 3];
        let grid = |x: f64| (x * 1024.0).round() / 1024.0;
        let centre = scale(rng.unit(), far).map(grid);
        let corners: Vec<Point> = (0..8)
            .map(|i| {
                add(
                    centre,
                    [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 0.25 } else { -0.25 }),
                )
            })
            .collect();
        let q = rng.quat();
        let turned = Pose::new(q, [0.0; 3]).rotate(centre);
        let at = Pose::new(q, sub([0.0, 0.0, rng.range(0.5, 0.8)], turned));
        let body = ConvexPolyhedron::from_points(&corners.iter().map(|p| Point3::from(*p)).collect::<Vec<_>>());
        let piece = piece_at(at.isometry(), body.expect("a box"));
        let body = Compound::new(vec![piece]).expect("a piece");
        let stored = Pose {
            q: body.pieces()[0].pose.rotation.coords.into(),
            ..at
        };
        // The box is above the middle of the patch.
        let height = placed(&corners, &stored)
            .into_iter()
            .map(|p| p[2].clone())
            .min()
            .expect("corners");
        let found = PairTracker::new().closest(
            &surface,
            &body,
            &RelativePose::from_isometry(&Isometry3::identity()).expect("a pose"),
        );
        assert!(exact(found.lower) <= height, "{k}: {found:?}, not {}", rounded(&height));
        assert!(height <= exact(found.upper), "{k}: {found:?}, not {}", rounded(&height));
    }
}
