//! Saddles, poles, cusps, tangent and crossing surfaces, rejected input, budgets.

use lin_canny::nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use lin_canny::surface::{BezierPatch, BezierSurface, Nurbs, SurfaceError, revolution};
use lin_canny::{ContactState, Decision, Mesh, PairTracker, QueryOptions, RelativePose};
use truth::rng::Rng;
use truth::support::Decide;

use crate::bodies::{bumpy, place, pose, sphere, torus, tube, vase};
use crate::truth::judge;

fn square(f: impl Fn(f64, f64) -> f64) -> Vec<Point3<f64>> {
    let at = |k: usize| {
        let (x, y) = ((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0);
        Point3::new(x, y, f(x, y))
    };
    (0..9).map(at).collect()
}

fn one(degrees: [usize; 2], points: &[Point3<f64>]) -> BezierSurface {
    BezierSurface::new(vec![BezierPatch::polynomial(degrees, points).expect("a patch")]).expect("a surface")
}

#[test]
fn saddles_in_each_other() {
    let a = one([2, 2], &square(|x, y| x * y));
    for (gap, turn) in [(0.3, 0.0), (1e-3, 0.3), (0.05, 1.2)] {
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        let at = Isometry3::from_parts(Vector3::new(0.05, -0.02, gap).into(), turned);
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&a, &a, &pose(&at), &QueryOptions::default().width(1e-6));
        judge(&a, &a, &at, &o, 1e-13);
        println!("{gap} {turn}: {} {} {:?}", o.lower, o.upper, tracker.work());
    }
}

/// A saddle over a flatter one, and a dish in a wider dish: no plane separates them, and narrow
/// intervals cost no more.
#[test]
fn hollows_and_saddles_cost_no_more_when_narrow() {
    let saddle = [
        one([2, 2], &square(|x, y| x * x - y * y)),
        one([2, 2], &square(|x, y| 1.6 * x * x - 0.4 * y * y - 0.6)),
    ];
    let dish = [
        one([2, 2], &square(|x, y| 0.5 * x * x + 0.3 * y * y)),
        one([2, 2], &square(|x, y| x * x + 0.9 * y * y - 0.55)),
    ];
    let cubic = [one([3, 3], &cubic(0.3, 0.0)), one([3, 3], &cubic(0.8, -0.15))];
    let mut worst = 0.0_f64;
    for (k, [a, b]) in [saddle, dish, cubic].iter().enumerate() {
        for (x, gap, turn) in [(0.0, 0.05, 0.0), (0.03, 1e-3, 0.1), (-0.05, 0.05, 0.3)] {
            let turned = UnitQuaternion::from_axis_angle(&Unit::new_normalize(Vector3::new(0.1, 0.2, 1.0)), turn);
            let at = Isometry3::from_parts(Vector3::new(x, -0.5 * x, gap).into(), turned);
            let mut splits = Vec::new();
            for width in [1e-4, 1e-7, 1e-10] {
                let mut tracker = PairTracker::new();
                let o = tracker.closest_with(a, b, &pose(&at), &QueryOptions::default().width(width));
                judge(a, b, &at, &o, 1e-13);
                assert!(o.is_converged || o.lower == 0.0, "{k} {gap}: {o:?}");
                splits.push(tracker.work().surfaces.splits);
                // Warm, and in the other order.
                let again = tracker.closest_with(a, b, &pose(&at), &QueryOptions::default().width(width));
                let back =
                    PairTracker::new().closest_with(b, a, &pose(&at).swapped(), &QueryOptions::default().width(width));
                for other in [again, back] {
                    assert!(other.lower <= o.upper && o.lower <= other.upper, "{o:?} {other:?}");
                }
            }
            println!("{k} {gap} {turn}: {splits:?} splits");
            worst = worst.max(splits[2] as f64 / splits[1].max(8) as f64);
        }
    }
    assert!(worst < 1.3, "{worst}");
}

/// A wall that ends above a floor by less than any interval resolves does not meet the floor,
/// though the extended wall would.
#[test]
fn a_border_that_stops_short_is_no_crossing() {
    let floor = one([2, 2], &square(|_, _| 0.0));
    // The lowest boundary, z = 0 in its middle, is v = 0, v = 1, u = 0 and u = 1 in turn.
    let wall = |side: usize| {
        let at = |k: usize| {
            let (i, j) = (k / 3, k % 3);
            let (along, up) = [(i, j), (i, 2 - j), (j, i), (2 - j, 2 - i)][side];
            let (x, bottom) = (0.1 + 0.2 * along as f64, [0.04, -0.04, 0.04][along]);
            Point3::new(x, 0.1 * x, 0.5 * up as f64 + bottom)
        };
        one([2, 2], &(0..9).map(at).collect::<Vec<_>>())
    };
    for side in 0..4 {
        let wall = wall(side);
        for (gap, meets) in [(1e-14, false), (5e-14, false), (-0.01, true)] {
            let at = pose(&Isometry3::translation(0.0, 0.0, gap));
            let mut tracker = PairTracker::new();
            for found in [
                tracker.decide(&floor, &wall, &at, 0.0),
                tracker.decide(&wall, &floor, &at.swapped(), 0.0),
            ] {
                assert_eq!(found == Decision::Yes, meets, "{side} {gap:e}: {found:?}");
            }
            let answer = tracker
                .closest_with(&floor, &wall, &at, &QueryOptions::default().width(1e-9))
                .state
                == ContactState::Touching;
            assert_eq!(answer, meets, "{side} {gap:e}");
        }
    }
}

/// Returns control points of a bowl of degree 3.
fn cubic(bend: f64, height: f64) -> Vec<Point3<f64>> {
    let at = |k: usize| {
        let (x, y) = ((k / 4) as f64 / 1.5 - 1.0, (k % 4) as f64 / 1.5 - 1.0);
        Point3::new(x, y, height + bend * (x * x + y * y + 0.2 * x * x * x - 0.3 * x * y))
    };
    (0..16).map(at).collect()
}

#[test]
fn poles_face_each_other() {
    let a = sphere(1.0);
    for k in 0..20 {
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1e-4 * (k * k) as f64);
        let at = Isometry3::from_parts(Vector3::new(0.0, 1e-5 * k as f64, 2.01).into(), tilt);
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&a, &a, &pose(&at), &QueryOptions::default().width(1e-9));
        let truth = at.translation.vector.norm() - 2.0;
        assert!(
            o.is_converged && (o.distance - truth).abs() < 2e-9,
            "{k} {truth} {o:?} {:?}",
            tracker.work()
        );
    }
}

#[test]
fn cusps_and_points() {
    // A fold whose rows turn back, a patch that is a point, a patch that is a curve.
    let fold: Vec<_> = [0.0, 1.0, 2.0]
        .iter()
        .flat_map(|y| [0.0, 1.0, 0.0].map(|x| Point3::new(x, *y, x * x)))
        .collect();
    let point = vec![Point3::new(0.5, 0.5, 0.0); 4];
    let curve: Vec<_> = [0.0, 0.0, 1.0, 1.0].map(|x| Point3::new(x, x * x, 0.0)).into();
    let bodies = [one([2, 2], &fold), one([1, 1], &point), one([1, 1], &curve)];
    let mut rng = Rng::new(8);
    for a in &bodies {
        for b in &bodies {
            for _ in 0..5 {
                let at = place(&mut rng, 3.5);
                let o = PairTracker::new().closest_with(a, b, &pose(&at), &QueryOptions::default().width(1e-9));
                assert!(o.is_converged && o.lower > 0.0, "{o:?}");
                judge(a, b, &at, &o, 1e-13);
                assert!((o.normal.norm() - 1.0).abs() < 1e-14);
            }
        }
    }
    let share = PairTracker::new().closest_with(
        &bodies[1],
        &bodies[1],
        &pose(&Isometry3::identity()),
        &QueryOptions::default().width(1e-9),
    );
    assert!(share.is_converged && share.lower == 0.0 && share.state == ContactState::Undecided);
}

#[test]
fn tangent_and_crossing_surfaces() {
    let a = sphere(1.0);
    let mut tracker = PairTracker::new();
    let at = |x: f64| pose(&Isometry3::translation(0.6 * x, 0.8 * x, 0.0));
    let touching = tracker.closest_with(&a, &a, &at(2.0), &QueryOptions::default().width(1e-9));
    assert!(touching.is_converged, "{touching:?}");
    assert!(touching.upper < 1e-9, "{touching:?}");
    assert!(touching.state != ContactState::Separated, "{touching:?}");
    assert!(tracker.decide(&a, &a, &at(2.0), 0.0).as_bool() != Some(false));
    assert_eq!(tracker.decide(&a, &a, &at(2.1), 0.0), Decision::No);
    let mut yes = 0;
    for k in 0..40 {
        let cross = at(0.05 + 0.048 * k as f64);
        yes += u32::from(tracker.decide(&a, &a, &cross, 0.0).as_bool() == Some(true));
        let o = tracker.closest_with(&a, &a, &cross, &QueryOptions::default().width(1e-9));
        assert!(o.is_converged && o.lower == 0.0 && o.upper < 1e-12, "{o:?}");
    }
    assert_eq!(yes, 40);
    assert_eq!(tracker.decide(&a, &a, &at(2.5), 0.5 + 1e-9), Decision::Yes);
    assert_eq!(tracker.decide(&a, &a, &at(2.5), 0.5 - 1e-9), Decision::No);
    assert_eq!(tracker.decide(&a, &a, &at(2.5), -1.0), Decision::No);
    assert!(
        matches!(tracker.decide(&a, &a, &at(2.5), 0.5), Decision::Undecided { lower, upper } if lower <= 0.5 && upper >= 0.5)
    );
    // Nearly, but not.
    let flat = one([2, 2], &square(|_, _| 0.0));
    let dish = one([2, 2], &square(|x, y| x * x + y * y));
    let under = pose(&Isometry3::translation(0.0, 0.0, -1e-10));
    assert_eq!(PairTracker::new().decide(&dish, &flat, &under, 0.0), Decision::No);
}

#[test]
fn a_budget_ends_what_has_no_end() {
    // Two coaxial cylinders are equally far everywhere.
    let (a, b) = (tube(1.0, 1.0), tube(0.6, 1.0));
    let mut tracker = PairTracker::new();
    let few = QueryOptions::default().width(1e-9).splits(500);
    let o = tracker.closest_with(&a, &b, &pose(&Isometry3::identity()), &few);
    assert!(
        !o.is_converged && o.lower <= 0.4 && o.upper >= 0.4 - 1e-15 && o.upper - o.lower < 0.1,
        "{o:?}"
    );
    assert!(tracker.work().surfaces.splits <= 500);
    let coarse = PairTracker::new().closest_with(
        &a,
        &b,
        &pose(&Isometry3::identity()),
        &QueryOptions::default().width(0.01),
    );
    assert!(coarse.is_converged, "{coarse:?}");
    for width in [0.0, -1.0, f64::NAN] {
        let ball = sphere(1.0);
        let at = pose(&Isometry3::translation(2.5, 0.3, 0.1));
        let o = PairTracker::new().closest_with(&ball, &ball, &at, &QueryOptions::default().width(width));
        assert!(!o.is_converged && o.upper - o.lower < 1e-11, "{o:?}");
    }
}

/// Returns a random rotation about z.
fn about_z(rng: &mut Rng) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rng.range(-3.0, 3.0));
    Isometry3::from_parts(Vector3::zeros().into(), turn)
}

/// Returns two surfaces that are equally far along a curve or over an area, one inside the other,
/// with their pose and distance.
fn level(rng: &mut Rng, kind: usize) -> (BezierSurface, BezierSurface, Isometry3<f64>, f64) {
    let (r, part) = (rng.range(0.3, 1.5), rng.range(0.2, 0.999));
    let s = r * part;
    match kind {
        0 => (sphere(r), sphere(s), place(rng, 0.0), r - s),
        1 => (tube(r, 1.0), tube(s, 1.0), about_z(rng), r - s),
        2 => (torus(2.0, r), torus(2.0, s), about_z(rng), r - s),
        3 => (torus(2.0 * r, r), sphere(s), place(rng, 0.0), r - s),
        _ => (sphere(r), tube(0.8 * s, 0.6 * s), about_z(rng), r - s),
    }
}

/// Such pairs end long before their budget, with valid bounds; warm too.
#[test]
fn surfaces_that_are_level_end_soon() {
    let mut widest = [0.0_f64; 5];
    for k in 0..15 {
        let mut rng = Rng::of_case(71, k);
        let kind = k as usize % 5;
        let (a, b, at, truth) = level(&mut rng, kind);
        let mut tracker = PairTracker::new();
        for _ in 0..2 {
            let before = tracker.work().surfaces.splits;
            let o = tracker.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-9));
            assert!(o.lower <= truth + 1e-14, "{k} {truth}: {o:?}");
            assert!(truth <= o.upper + 1e-14, "{k} {truth}: {o:?}");
            assert!(
                tracker.work().surfaces.splits - before <= 4_096,
                "{k} {truth}: {:?}",
                tracker.work()
            );
            widest[kind] = widest[kind].max(o.upper - o.lower);
        }
        // A wide interval costs no more than for other pairs.
        assert!(
            tracker
                .closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(0.3))
                .is_converged,
            "{k}"
        );
    }
    println!("widths {widest:?}");
    assert!(widest.iter().all(|w| *w < 0.3), "{widest:?}");
}

/// A patch and its slightly raised copy are close everywhere.
#[test]
fn a_patch_just_above_itself_is_decided_soon_or_not() {
    for k in 0..6 {
        let mut rng = Rng::of_case(72, k);
        let degrees = [1 + rng.below(4), 2 + rng.below(3)];
        let patch = BezierSurface::new(vec![bumpy(&mut rng, degrees, 0.7)]).expect("a surface");
        let up = rng.log_range(1e-8, 3e-6);
        let mut tracker = PairTracker::new();
        let found = tracker.decide(&patch, &patch, &pose(&Isometry3::translation(0.0, 0.0, up)), 0.0);
        assert!(found != Decision::Yes, "{k} {up:e}");
        assert!(
            tracker.work().surfaces.splits <= 4_096,
            "{k} {up:e}: {:?}",
            tracker.work()
        );
        let away = pose(&Isometry3::translation(0.0, 0.0, 2.0));
        assert_eq!(tracker.decide(&patch, &patch, &away, 0.0), Decision::No);
        // Farther up, the query may use all of its budget, and no more.
        let up = rng.log_range(1e-5, 1e-3);
        let before = tracker.work().surfaces.splits;
        let found = tracker.decide(&patch, &patch, &pose(&Isometry3::translation(0.0, 0.0, up)), 0.0);
        let is_honest = match found {
            Decision::No => true,
            Decision::Undecided { lower, upper } => lower == 0.0 && 0.0 < upper && upper <= up,
            _ => false,
        };
        let splits = tracker.work().surfaces.splits - before;
        assert!(is_honest && splits <= 20_000, "{k} {up:e}: {found:?} {splits}");
    }
}

#[test]
fn far_and_foreign() {
    let (a, b) = (sphere(1.0), vase());
    let far = RelativePose::from_isometry(&Isometry3::translation(1e200, 0.0, 0.0)).expect("a pose");
    let o = PairTracker::new().closest_with(&a, &a, &far, &QueryOptions::default().width(1e-9));
    assert!(o.lower <= 1e200 && o.upper >= 1e200 && o.lower > 0.9e200 && !o.is_converged);
    // A tracker of other surfaces.
    let mut tracker = PairTracker::new();
    let at = pose(&Isometry3::translation(3.0, 0.2, 0.1));
    let first = tracker.closest_with(&a, &b, &at, &QueryOptions::default().width(1e-9));
    tracker.closest_with(&b, &a, &at, &QueryOptions::default().width(1e-9));
    tracker.closest_with(&b, &b, &at, &QueryOptions::default().width(1e-9));
    let again = tracker.closest_with(&a, &b, &at, &QueryOptions::default().width(1e-9));
    assert!(first.lower <= again.upper && again.lower <= first.upper && again.is_converged);
    assert!(tracker.memory_usage() > 0 && tracker.front_len() > 0);
    tracker.reset();
    assert_eq!((tracker.front_len(), tracker.work()), (0, Default::default()));
}

/// Returns the mesh of a sphere with vertices on it.
fn globe(n: usize) -> Mesh {
    let mut points = Vec::new();
    for i in 0..=n {
        for j in 0..2 * n {
            let s = std::f64::consts::PI * i as f64 / n as f64;
            let t = std::f64::consts::PI * j as f64 / n as f64;
            points.push(Point3::new(s.sin() * t.cos(), s.sin() * t.sin(), s.cos()));
        }
    }
    let at = |i: usize, j: usize| (i * 2 * n + j % (2 * n)) as u32;
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..2 * n {
            triangles.extend([
                [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
            ]);
        }
    }
    Mesh::new(&points, &triangles).expect("a mesh")
}

#[test]
fn finer_meshes_come_closer() {
    let a = sphere(1.0);
    let at = pose(&Isometry3::new(
        Vector3::new(1.9, 0.8, 0.9),
        Vector3::new(0.4, 0.5, 0.6),
    ));
    let exact = PairTracker::new().closest_with(&a, &a, &at, &QueryOptions::default().width(1e-11));
    let mut errors = Vec::new();
    for n in [8, 16, 32] {
        let mesh = globe(n);
        let o = PairTracker::new().closest(&mesh, &mesh, &at);
        assert!(o.lower >= exact.upper - 1e-11, "an inscribed mesh is farther");
        let flat = BezierSurface::from_mesh(&mesh).expect("a surface");
        let p = PairTracker::new().closest_with(&flat, &flat, &at, &QueryOptions::default().width(1e-9));
        assert!(p.is_converged, "{o:?} {p:?}");
        assert!(p.lower <= o.upper, "{o:?} {p:?}");
        assert!(o.lower <= p.upper, "{o:?} {p:?}");
        errors.push(o.distance - exact.distance);
    }
    assert!(errors[2] < 0.5 * errors[0], "{errors:?}");
    assert!(errors[2] < 8.0 / (32.0 * 32.0), "{errors:?}");
}

#[test]
fn what_is_no_surface_is_named() {
    let p = square(|_, _| 0.0);
    let bad = |k: usize, x: f64| {
        let mut q = p.clone();
        q[k].y = x;
        BezierPatch::polynomial([2, 2], &q)
    };
    assert!(matches!(
        bad(4, f64::NAN),
        Err(SurfaceError::Coordinate { index: 4, axis: 1, .. })
    ));
    assert!(matches!(
        bad(7, 1e70),
        Err(SurfaceError::Coordinate { index: 7, axis: 1, .. })
    ));
    assert_eq!(
        BezierPatch::polynomial([8, 2], &p),
        Err(SurfaceError::Degree {
            direction: 0,
            degree: 8
        })
    );
    assert_eq!(
        BezierPatch::polynomial([2, 0], &p),
        Err(SurfaceError::Degree {
            direction: 1,
            degree: 0
        })
    );
    let found = BezierPatch::polynomial([2, 3], &p);
    assert_eq!(found, Err(SurfaceError::Count { given: 9, expected: 12 }));
    let found = BezierPatch::triangular(2, &p, None);
    assert_eq!(found, Err(SurfaceError::Count { given: 9, expected: 6 }));
    let weights = |k: usize, w: f64| {
        let mut all = vec![1.0; 9];
        all[k] = w;
        BezierPatch::rational([2, 2], &p, &all)
    };
    for w in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-20] {
        assert!(matches!(weights(3, w), Err(SurfaceError::Weight { .. })), "{w}");
    }
    let answer = BezierPatch::rational([2, 2], &p, &[1.0; 8]);
    assert_eq!(answer, Err(SurfaceError::WeightCount { given: 8, expected: 9 }));
    assert!(matches!(BezierSurface::new(vec![]), Err(SurfaceError::Empty)));
    let knots: [&[f64]; 2] = [&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]; 2];
    let good = Nurbs {
        degrees: [2, 2],
        knots,
        points: &p,
        ..Nurbs::default()
    };
    assert!(BezierSurface::from_nurbs(&good).is_ok());
    let refused = |n: Nurbs| BezierSurface::from_nurbs(&n).expect_err("refused");
    let found = refused(Nurbs {
        trimming_curves: 1,
        ..good
    });
    assert_eq!(found, SurfaceError::Trimmed { curves: 1 });
    let late: &[f64] = &[0.0, 0.0, 0.0, 1.0, 0.5, 1.0];
    assert!(matches!(
        refused(Nurbs {
            knots: [late, late],
            ..good
        }),
        SurfaceError::Knot {
            direction: 0,
            index: 4,
            ..
        }
    ));
    let torn: &[f64] = &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0];
    assert!(matches!(
        refused(Nurbs {
            knots: [knots[0], torn],
            ..good
        }),
        SurfaceError::Knot { direction: 1, .. }
    ));
    let short: &[f64] = &[0.0, 1.0];
    assert!(matches!(
        refused(Nurbs {
            knots: [short, short],
            ..good
        }),
        SurfaceError::KnotCount { direction: 0, .. }
    ));
    assert!(revolution(&[&[[1.0, 0.0, 1.0]]]).is_err() && revolution(&[]).is_err());
    let text = SurfaceError::Trimmed { curves: 2 }.to_string();
    assert!(text.contains("trimm"), "{text}");
}
