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
