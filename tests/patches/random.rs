//! Random pairs against the judge.

use lab::rng::Rng;
use lin_canny::patch::{Patch, Surface, SurfaceTracker};

use crate::bodies::{bumpy, grid, place, pose};
use crate::truth::{Sentence, judge};

/// A patch of any kind and degree, of size 2.
fn any(rng: &mut Rng) -> Surface {
    let most = if rng.chance(0.2) { 7 } else { 4 };
    let degrees = [1 + rng.below(most), 1 + rng.below(most)];
    let bump = rng.range(0.1, 1.5);
    let weights = |rng: &mut Rng, count: usize| -> Vec<f64> { (0..count).map(|_| rng.range(0.2, 3.0)).collect() };
    let patch = match rng.below(4) {
        0 | 1 => bumpy(rng, degrees, bump),
        2 => {
            let points = grid(rng, degrees, bump);
            let weights = weights(rng, points.len());
            Patch::rational(degrees, &points, &weights).expect("a patch")
        }
        _ => {
            let n = degrees[0];
            let count = (n + 1) * (n + 2) / 2;
            let points = &grid(rng, [n, n], bump)[..count];
            let weights = weights(rng, count);
            Patch::triangular(n, points, Some(&weights)).expect("a patch")
        }
    };
    Surface::new(vec![patch]).expect("a surface")
}

fn run(cases: u64) {
    let (mut open, mut wide, mut warm_open) = (0, 0, 0);
    for k in 0..cases {
        let mut rng = Rng::of_case(11, k);
        let (a, b) = (any(&mut rng), any(&mut rng));
        let apart = rng.range(0.3, 4.0);
        let at = place(&mut rng, apart);
        let width = *rng.pick(&[1e-4, 1e-9, 1e-11]);
        let mut tracker = SurfaceTracker::new();
        let o = tracker.closest(&a, &b, &pose(&at), width);
        wide += u64::from(!o.is_reached);
        assert!(o.lower <= o.distance && o.distance <= o.upper, "{o:?}");
        let slack = 1e-14 * (4.0 + apart);
        open += u64::from(judge(&a, &b, &at, &o, slack) == Sentence::Open);
        // Back at the same pose by another way, and exchanged.
        let near = place(&mut rng, apart);
        tracker.closest(&a, &b, &pose(&near), width);
        let again = tracker.closest(&a, &b, &pose(&at), width);
        let back = SurfaceTracker::new().closest(&b, &a, &pose(&at).swapped(), width);
        for other in [again, back] {
            assert!(
                other.lower <= o.upper && o.lower <= other.upper,
                "case {k}: {o:?} {other:?}"
            );
            warm_open += u64::from(other.is_reached != o.is_reached);
        }
    }
    println!("{cases} cases: {open} too long for the judge, {wide} not reached, {warm_open} of both");
    assert!(open * 20 <= cases && wide * 100 <= cases, "{open} {wide}");
}

#[test]
fn bounds_hold_on_random_pairs() {
    run(200);
}

#[test]
#[ignore = "minutes"]
fn bounds_hold_on_many_random_pairs() {
    run(10_000);
}

/// Work of two bicubic patches that tumble by half a degree a frame, cold and tracked.
#[test]
#[ignore = "prints times"]
fn cost() {
    use crate::bodies::bumpy;
    use lin_canny::nalgebra::{UnitQuaternion, Vector3};
    for width in [1e-4, 1e-9] {
        let (mut cold, mut warm) = (Vec::new(), Vec::new());
        let mut works = [lin_canny::patch::SurfaceWork::default(); 2];
        let mut add = |k: usize, w: lin_canny::patch::SurfaceWork| {
            let sum = &mut works[k];
            sum.gaps += w.gaps;
            sum.caps += w.caps;
            sum.bowls += w.bowls;
            sum.steps += w.steps;
            sum.splits += w.splits;
            sum.entries += w.entries;
            sum.failed += w.failed;
            sum.queries += w.queries;
        };
        for k in 0..16 {
            let mut rng = Rng::of_case(61, k);
            let mut one = || Surface::new(vec![bumpy(&mut rng, [3, 3], 0.5)]).expect("a surface");
            let (a, b) = (one(), one());
            let mut at = place(&mut rng, 3.0);
            let axis = Vector3::from(rng.unit()) * 0.5_f64.to_radians();
            let mut tracker = SurfaceTracker::new();
            for _ in 0..40 {
                at.rotation = UnitQuaternion::from_scaled_axis(axis) * at.rotation;
                let d = tracker.distance(&a, &b, &pose(&at), 1e-3).value;
                at.translation.vector *= 1.0 + 0.3 * (0.2 - d);
            }
            tracker = SurfaceTracker::new();
            for _ in 0..40 {
                at.rotation = UnitQuaternion::from_scaled_axis(axis) * at.rotation;
                let began = std::time::Instant::now();
                std::hint::black_box(tracker.closest(&a, &b, &pose(&at), width));
                warm.push(began.elapsed().as_nanos());
                let began = std::time::Instant::now();
                let mut fresh = SurfaceTracker::new();
                std::hint::black_box(fresh.closest(&a, &b, &pose(&at), width));
                cold.push(began.elapsed().as_nanos());
                add(0, fresh.work());
            }
            add(1, tracker.work());
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
