//! Random pairs of every two kinds of surfaces, and of surfaces and shapes, against the judge.

use std::sync::atomic::{AtomicU64, Ordering};

use lin_canny::nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::{BezierPatch, BezierSurface, Nurbs, revolution};
use lin_canny::{PairTracker, QueryOptions};
use truth::curved::{KINDS as SHAPES, Kind};
use truth::rng::Rng;

use crate::bodies::{grid, place, pose};
use crate::truth::{Body, Sentence, judge, judge_shape};

/// Kinds of surfaces, all of size about 2.
pub(crate) const KINDS: [&str; 8] = [
    "polynomial",
    "rational",
    "triangle",
    "saddle",
    "cusp",
    "revolved",
    "spline",
    "flat",
];

/// Relative positions of a pair.
pub(crate) const PLACES: [&str; 4] = ["apart", "tangent", "nested", "close"];

/// Columns of the counts: far, near (within 0.01), sharing points as far as intervals resolve,
/// wider than requested, too long for the judge.
const COUNTS: [&str; 5] = ["apart", "near", "zero", "not reached", "not judged"];

fn weights(rng: &mut Rng, count: usize) -> Vec<f64> {
    (0..count).map(|_| rng.range(0.2, 3.0)).collect()
}

fn tensor(rng: &mut Rng, degrees: [usize; 2], points: &[Point3<f64>], is_rational: bool) -> BezierPatch {
    if is_rational {
        BezierPatch::rational(degrees, points, &weights(rng, points.len())).expect("a patch")
    } else {
        BezierPatch::polynomial(degrees, points).expect("a patch")
    }
}

/// Returns a patch with coinciding boundary or inner points: poles, cusps, folds.
fn cusp(rng: &mut Rng, degrees: [usize; 2]) -> BezierPatch {
    let [p, q] = [degrees[0].max(2), degrees[1].max(2)];
    let mut points = grid(rng, [p, q], 0.8);
    match rng.below(4) {
        0 => (0..=q).for_each(|j| points[j] = points[0]),
        1 => (0..=q).for_each(|j| points[(q + 1) + j] = points[j]),
        2 => (0..=p).for_each(|i| points.swap(i * (q + 1), i * (q + 1) + q - 1)),
        _ => (0..=p).for_each(|i| points[i * (q + 1) + 1] = points[i * (q + 1) + 2]),
    }
    let is_rational = rng.chance(0.4);
    tensor(rng, [p, q], &points, is_rational)
}

/// Returns a surface of revolution with profiles that start on the axis: poles and seams.
fn revolved(rng: &mut Rng) -> BezierSurface {
    if rng.chance(0.3) {
        return crate::bodies::sphere(rng.range(0.4, 1.0));
    }
    let degree = 1 + rng.below(4);
    let mut point = |k: usize| {
        let r = if k == 0 { 0.0 } else { rng.range(0.2, 1.0) };
        [r, 2.0 * k as f64 / degree as f64 - 1.0, rng.range(0.5, 2.0)]
    };
    let profile: Vec<[f64; 3]> = (0..=degree).map(&mut point).collect();
    revolution(&[&profile]).expect("a profile")
}

/// Returns a B-spline of several patches.
fn spline(rng: &mut Rng) -> BezierSurface {
    let degrees = [1 + rng.below(4), 1 + rng.below(4)];
    let counts = degrees.map(|d| d + 1 + rng.below(3));
    let mut knots = |d: usize, count: usize| {
        let mut all = vec![0.0; d + 1];
        let inner = count - d - 1;
        let mut last = 0.0;
        for _ in 0..inner {
            // Occasionally a double knot: the surface is less smooth there.
            last += if d > 1 && last > 0.0 && rng.chance(0.3) {
                0.0
            } else {
                rng.range(0.2, 1.0)
            };
            all.push(last);
        }
        all.extend(vec![last + 0.5; d + 1]);
        all
    };
    let (u, v) = (knots(degrees[0], counts[0]), knots(degrees[1], counts[1]));
    let points = grid(rng, counts.map(|c| c - 1), 0.7);
    let weights = rng.chance(0.5).then(|| weights(rng, points.len()));
    BezierSurface::from_nurbs(&Nurbs {
        degrees,
        knots: [&u, &v],
        points: &points,
        weights: weights.as_deref(),
        trimming_curves: 0,
    })
    .expect("a surface")
}

pub(crate) fn surface(rng: &mut Rng, kind: &str) -> BezierSurface {
    let degrees = [1 + rng.below(7), 1 + rng.below(7)];
    let bump = rng.range(0.1, 1.2);
    let patch = match kind {
        "revolved" => return revolved(rng),
        "spline" => return spline(rng),
        "flat" => {
            let body = match rng.below(3) {
                0 => solids::cuboid(Vector3::new(rng.range(0.1, 1.0), 0.7, 0.4)),
                1 => solids::octahedron(0.9),
                _ => solids::icosahedron(0.8),
            };
            return BezierSurface::from_convex(&body.expect("a body")).expect("faces");
        }
        "triangle" => {
            let n = degrees[0];
            let count = (n + 1) * (n + 2) / 2;
            let points = &grid(rng, [n, n], bump)[..count];
            let weights = rng.chance(0.5).then(|| weights(rng, count));
            BezierPatch::triangular(n, points, weights.as_deref()).expect("a patch")
        }
        "saddle" => {
            let (a, b) = (rng.range(0.1, 1.0), rng.range(-1.0, -0.1));
            let at = |k: usize| {
                let [x, y] = [(k / 4) as f64, (k % 4) as f64].map(|t| t / 1.5 - 1.0);
                Point3::new(x, y, a * x * x + b * y * y + 0.1 * x * y)
            };
            let points: Vec<_> = (0..16).map(at).collect();
            let is_rational = rng.chance(0.3);
            tensor(rng, [3, 3], &points, is_rational)
        }
        "cusp" => cusp(rng, degrees),
        _ => {
            let points = grid(rng, degrees, bump);
            tensor(rng, degrees, &points, kind == "rational")
        }
    };
    BezierSurface::new(vec![patch]).expect("a surface")
}

/// Returns a random point of a surface with its normal.
pub(crate) fn spot(rng: &mut Rng, s: &BezierSurface) -> (Vector3<f64>, Unit<Vector3<f64>>) {
    let patch = rng.pick(s.patches());
    // Occasionally at a boundary or a corner.
    let mut side = || {
        if rng.chance(0.15) {
            *rng.pick(&[0.0, 1.0])
        } else {
            rng.uniform()
        }
    };
    let (u, v) = (side(), side());
    (
        patch.point(u, v).coords,
        patch.normal(u, v).unwrap_or_else(Vector3::z_axis),
    )
}

/// Returns a rotation that maps one direction to another, with a random rotation about it.
fn turn(rng: &mut Rng, from: &Vector3<f64>, to: &Vector3<f64>) -> UnitQuaternion<f64> {
    let about = UnitQuaternion::from_axis_angle(&Unit::new_normalize(*to), rng.range(-3.0, 3.0));
    let half = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    about * UnitQuaternion::rotation_between(from, to).unwrap_or(half)
}

/// Puts B at A with two points opposite each other at a gap along the normal, tilted slightly or
/// not at all.
fn touching(rng: &mut Rng, [(p, n), (q, m)]: [(Vector3<f64>, Unit<Vector3<f64>>); 2], facing: f64) -> Isometry3<f64> {
    let gap = rng.log_range(1e-11, 0.1);
    let tilt = *rng.pick(&[0.0, 0.0, 1e-9, 1e-4, 0.1]);
    let tilt = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * tilt);
    let rotation = tilt * turn(rng, &m, &(*n * facing));
    let t = p + *n * gap - rotation * q;
    Isometry3::from_parts(t.into(), rotation)
}

pub(crate) fn placed(rng: &mut Rng, how: &str, spots: [(Vector3<f64>, Unit<Vector3<f64>>); 2]) -> Isometry3<f64> {
    match how {
        "tangent" => touching(rng, spots, -1.0),
        "nested" => touching(rng, spots, 1.0),
        "close" => {
            let apart = rng.range(0.0, 1.2);
            place(rng, apart)
        }
        _ => {
            let apart = rng.range(1.5, 5.0);
            place(rng, apart)
        }
    }
}

/// Counts per kind of surface or shape, or per relative position.
type Rows<const N: usize> = [[AtomicU64; 5]; N];

fn add<const N: usize>(rows: &Rows<N>, row: usize, of: [bool; 5]) {
    for (cell, is) in rows[row].iter().zip(of) {
        cell.fetch_add(u64::from(is), Ordering::Relaxed);
    }
}

fn print<const N: usize>(rows: &Rows<N>, names: [&str; N]) -> [u64; 5] {
    let mut sums = [0; 5];
    println!(
        "{:14} {:>8} {:>8} {:>8} {:>12} {:>12}",
        "", COUNTS[0], COUNTS[1], COUNTS[2], COUNTS[3], COUNTS[4]
    );
    for (name, row) in names.iter().zip(rows) {
        let row: [u64; 5] = std::array::from_fn(|k| row[k].load(Ordering::Relaxed));
        println!(
            "{name:14} {:8} {:8} {:8} {:12} {:12}",
            row[0], row[1], row[2], row[3], row[4]
        );
        (0..5).for_each(|k| sums[k] += row[k]);
    }
    sums
}

fn state(lower: f64) -> [bool; 3] {
    [lower > 0.01, lower > 0.0 && lower <= 0.01, lower <= 0.0]
}

/// Runs cases on two threads.
fn each(cases: u64, case: impl Fn(u64) + Sync) {
    std::thread::scope(|scope| {
        for half in 0..2 {
            let case = &case;
            scope.spawn(move || (half..cases).step_by(2).for_each(case));
        }
    });
}

const WIDTHS: [f64; 3] = [1e-4, 1e-9, 1.2e-11];

fn surfaces(seed: u64, cases: u64) -> [u64; 5] {
    let (kinds, places): (Rows<8>, Rows<4>) = Default::default();
    each(cases, |k| {
        let mut rng = Rng::of_case(seed, k);
        let (i, j, how) = (k as usize % 8, k as usize / 8 % 8, rng.below(4));
        let (a, b) = (surface(&mut rng, KINDS[i]), surface(&mut rng, KINDS[j]));
        let spots = [spot(&mut rng, &a), spot(&mut rng, &b)];
        let at = placed(&mut rng, PLACES[how], spots);
        let width = *rng.pick(&WIDTHS);
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(width));
        let what = || {
            format!(
                "case {k}: {} {} {} {width:e} {at:?}: {o:?}",
                KINDS[i], KINDS[j], PLACES[how]
            )
        };
        assert!(o.lower <= o.distance && o.distance <= o.upper, "{}", what());
        assert_eq!(o.is_converged, o.upper - o.lower <= width, "{}", what());
        let sentence = judge(&a, &b, &at, &o, 2e-14 * (4.0 + at.translation.vector.norm()));
        // Back at the same pose by another path, and exchanged.
        let mut near = at;
        near.translation.vector += Vector3::from(rng.unit()) * rng.log_range(1e-6, 0.1);
        tracker.closest_with(&a, &b, &pose(&near), &QueryOptions::default().width(width));
        let again = tracker.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(width));
        let back = PairTracker::new().closest_with(&b, &a, &pose(&at).swapped(), &QueryOptions::default().width(width));
        for other in [again, back] {
            assert!(other.lower <= o.upper && o.lower <= other.upper, "{} {other:?}", what());
        }
        let wide = [o, again, back].iter().any(|o| !o.is_converged);
        if wide || sentence == Sentence::Open {
            println!("{} {again:?} {back:?}", what());
        }
        let [x, y, z] = state(o.lower);
        let row = [x, y, z, wide, sentence == Sentence::Open];
        add(&kinds, i, row);
        add(&kinds, j, row);
        add(&places, how, row);
    });
    print(&kinds, KINDS);
    print(&places, PLACES)
}

#[test]
fn bounds_hold_on_random_pairs() {
    let [.., wide, open] = surfaces(11, 192);
    assert!(wide <= 1 && open <= 2, "{wide} {open}");
}

#[test]
#[ignore = "a minute"]
fn bounds_hold_on_many_random_pairs() {
    let [.., wide, open] = surfaces(12, 10_000);
    assert!(wide <= 7 && open <= 18, "{wide} {open}");
}

fn shapes(seed: u64, cases: u64) -> [u64; 5] {
    let (kinds, solids, places): (Rows<8>, Rows<6>, Rows<4>) = Default::default();
    each(cases, |k| {
        let mut rng = Rng::of_case(seed, k);
        let (i, j, how) = (k as usize % 8, k as usize / 8 % 6, rng.below(4));
        let a = surface(&mut rng, KINDS[i]);
        let kind = Kind::random(SHAPES[j], &mut rng, 5.0);
        let round = if rng.chance(0.3) { rng.range(0.05, 0.3) } else { 0.0 };
        let shape = kind.shape().rounded(round).expect("a radius");
        let b = Body { kind, round, shape };
        let m = Unit::new_normalize(Vector3::from(rng.unit()));
        let spots = [spot(&mut rng, &a), (b.top(&m), m)];
        let at = placed(&mut rng, PLACES[how], spots);
        let width = *rng.pick(&WIDTHS);
        let mut tracker = PairTracker::new();
        let o = tracker.closest_with(&a, &b.shape, &pose(&at), &QueryOptions::default().width(width));
        let what = || {
            format!(
                "case {k}: {} {} {round} {} {width:e} {at:?}: {o:?}",
                KINDS[i], SHAPES[j], PLACES[how]
            )
        };
        assert!(o.lower <= o.distance && o.distance <= o.upper, "{}", what());
        let sentence = judge_shape(&a, &b, &at, &o, 2e-14 * (4.0 + at.translation.vector.norm()));
        let mut near = at;
        near.translation.vector += Vector3::from(rng.unit()) * rng.log_range(1e-6, 0.1);
        tracker.closest_with(&a, &b.shape, &pose(&near), &QueryOptions::default().width(width));
        let again = tracker.closest_with(&a, &b.shape, &pose(&at), &QueryOptions::default().width(width));
        assert!(again.lower <= o.upper && o.lower <= again.upper, "{} {again:?}", what());
        let wide = !o.is_converged || !again.is_converged;
        if wide || sentence == Sentence::Open {
            println!("{} {:?}", what(), tracker.work());
        }
        let [x, y, z] = state(o.lower);
        let row = [x, y, z, wide, sentence == Sentence::Open];
        add(&kinds, i, row);
        add(&solids, j, row);
        add(&places, how, row);
    });
    print(&kinds, KINDS);
    print(&solids, SHAPES);
    print(&places, PLACES)
}

#[test]
fn bounds_hold_on_random_shapes() {
    let [.., wide, open] = shapes(13, 192);
    assert!(wide <= 1 && open <= 1, "{wide} {open}");
}

#[test]
#[ignore = "a minute"]
fn bounds_hold_on_many_random_shapes() {
    let [.., wide, open] = shapes(14, 10_000);
    assert!(wide <= 14 && open <= 2, "{wide} {open}");
}

/// Closest points inside patches, at boundaries and at corners: their neighbourhoods are nearly
/// always proven at once, and few nodes are split.
#[test]
fn surroundings_of_the_closest_points_are_proven_at_once() {
    use crate::bodies::bumpy;
    let mut sum = lin_canny::surface::SurfaceWork::default();
    for k in 0..128 {
        let mut rng = Rng::of_case(62, k);
        let mut one = || BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.5)]).expect("a surface");
        let (a, b) = (one(), one());
        let mut at = place(&mut rng, 3.0);
        let mut tracker = PairTracker::new();
        for _ in 0..20 {
            let d = tracker
                .closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-3))
                .distance;
            at.translation.vector *= 1.0 + 0.3 * (0.2 - d);
        }
        let mut cold = PairTracker::new();
        assert!(
            cold.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-9))
                .is_converged
        );
        (sum.regions, sum.splits) = (
            sum.regions + cold.work().surfaces.regions,
            sum.splits + cold.work().surfaces.splits,
        );
    }
    println!("{} regions, {} splits", sum.regions, sum.splits);
    assert!(sum.regions > 110 && sum.splits < 128 * 40, "{sum:?}");
}

/// Prints the work of two bicubic patches that tumble by half a degree per frame, cold and tracked.
#[test]
#[ignore = "prints times"]
fn cost() {
    use crate::bodies::bumpy;
    use lin_canny::nalgebra::{UnitQuaternion, Vector3};
    for width in [1e-4, 1e-9] {
        let (mut cold, mut warm) = (Vec::new(), Vec::new());
        let mut works = [lin_canny::surface::SurfaceWork::default(); 2];
        let mut add = |k: usize, w: lin_canny::surface::SurfaceWork| {
            let sum = &mut works[k];
            sum.gaps += w.gaps;
            sum.caps += w.caps;
            sum.bowls += w.bowls;
            sum.steps += w.steps;
            sum.splits += w.splits;
            sum.entries += w.entries;
            sum.failed += w.failed;
            sum.queries += w.queries;
            sum.regions += w.regions;
            sum.refused += w.refused;
            sum.searches += w.searches;
        };
        for k in 0..16 {
            let mut rng = Rng::of_case(61, k);
            let mut one = || BezierSurface::new(vec![bumpy(&mut rng, [3, 3], 0.5)]).expect("a surface");
            let (a, b) = (one(), one());
            let mut at = place(&mut rng, 3.0);
            let axis = Vector3::from(rng.unit()) * 0.5_f64.to_radians();
            let mut tracker = PairTracker::new();
            for _ in 0..40 {
                at.rotation = UnitQuaternion::from_scaled_axis(axis) * at.rotation;
                let d = tracker
                    .closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(1e-3))
                    .distance;
                at.translation.vector *= 1.0 + 0.3 * (0.2 - d);
            }
            tracker = PairTracker::new();
            for _ in 0..40 {
                at.rotation = UnitQuaternion::from_scaled_axis(axis) * at.rotation;
                let began = std::time::Instant::now();
                std::hint::black_box(tracker.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(width)));
                warm.push(began.elapsed().as_nanos());
                let began = std::time::Instant::now();
                let mut fresh = PairTracker::new();
                std::hint::black_box(fresh.closest_with(&a, &b, &pose(&at), &QueryOptions::default().width(width)));
                cold.push(began.elapsed().as_nanos());
                add(0, fresh.work().surfaces);
            }
            add(1, tracker.work().surfaces);
        }
        for (k, (name, times)) in [("cold", &mut cold), ("warm", &mut warm)].into_iter().enumerate() {
            times.sort_unstable();
            let at = |p: usize| times[(times.len() - 1) * p / 100];
            println!(
                "{width:e} {name}: median {} p90 {} max {} ns; sums {:?}",
                at(50),
                at(90),
                at(100),
                works[k]
            );
        }
    }
}
