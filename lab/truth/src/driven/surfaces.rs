//! Bézier surfaces in motion; bounds are judged by points of both.
//!
//! Any two points are an upper bound of the distance. The judge takes a grid of points of each
//! surface, and descends from the closest pairs: no pair may be closer than a lower bound. The
//! witnesses lie on the surfaces, where [`BezierSurface::point`] puts them.
//!
//! The instrument `soak` uses this module.

use crate::casts::rotation;
use crate::nets;
use crate::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{PairTracker, QueryOptions, RelativePose};

/// Frames of a motion.
const FRAMES: usize = 6;

/// Points of a surface along each parameter.
const GRID: u32 = 12;

/// Error of points and bounds: surfaces have a size of about 2.
const NOISE: f64 = 1e-9;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Frames with the surfaces apart, and those that may touch.
        pub frames: [u64; 2],
        /// Frames at which the judge came within `1e-6` of the upper bound.
        pub reached: u64,
        /// Frames with bounds wider than requested.
        pub wide: u64,
    }
}

fn surface(rng: &mut Rng) -> Result<BezierSurface, String> {
    let degrees = [1 + rng.below(3), 1 + rng.below(3)];
    let bump = rng.range(0.1, 0.8);
    let points: Vec<_> = nets::bumps(rng, degrees, bump).into_iter().map(Point3::from).collect();
    let patch = if rng.chance(0.5) {
        let weights: Vec<f64> = points.iter().map(|_| rng.range(0.4, 2.0)).collect();
        BezierPatch::rational(degrees, &points, &weights)
    } else {
        BezierPatch::polynomial(degrees, &points)
    };
    BezierSurface::new(vec![patch.map_err(|e| e.to_string())?]).map_err(|e| e.to_string())
}

/// Returns the least distance of two points that a descent over the parameters finds.
fn least(a: &BezierPatch, b: &BezierPatch, pose: &Isometry3<f64>) -> f64 {
    let distance = |at: &[f64; 4]| (a.point(at[0], at[1]) - pose * b.point(at[2], at[3])).norm();
    let grid = |patch: &BezierPatch| {
        let step = |k: u32| f64::from(k) / f64::from(GRID);
        let all = (0..=GRID).flat_map(|i| (0..=GRID).map(move |k| [step(i), step(k)]));
        all.map(|at| (at, patch.point(at[0], at[1]))).collect::<Vec<_>>()
    };
    let (first, second) = (grid(a), grid(b));
    let mut starts: Vec<(f64, [f64; 4])> = Vec::new();
    for (at, p) in &first {
        let near = second.iter().map(|(to, q)| ((p - pose * q).norm(), to));
        if let Some((d, to)) = near.min_by(|x, y| x.0.total_cmp(&y.0)) {
            starts.push((d, [at[0], at[1], to[0], to[1]]));
        }
    }
    starts.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut best = f64::INFINITY;
    for (mut d, mut at) in starts.into_iter().take(4) {
        let mut step = 1.0 / f64::from(GRID);
        while step > 1e-7 {
            let mut is_lower = false;
            for k in 0..8 {
                let mut to = at;
                to[k % 4] = (to[k % 4] + if k < 4 { step } else { -step }).clamp(0.0, 1.0);
                let other = distance(&to);
                if other < d {
                    (d, at, is_lower) = (other, to, true);
                }
            }
            step *= if is_lower { 1.0 } else { 0.5 };
        }
        best = best.min(d);
    }
    best
}

/// Plays a pair of surfaces.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let (a, b) = (surface(&mut rng)?, surface(&mut rng)?);
    let options = QueryOptions::default().width(1e-6).splits(4000);
    let mut at = Vector3::from(rng.unit()) * rng.range(0.2, 3.0);
    let step = Vector3::from(rng.in_ball()) * 0.05;
    let mut turn = rotation(&mut rng);
    let small = UnitQuaternion::new(Vector3::from(rng.in_ball()) * 0.05);
    let mut warm = PairTracker::new();
    for frame in 0..FRAMES {
        at += step;
        turn = small * turn;
        let place = Isometry3::from_parts(at.into(), turn);
        let pose = RelativePose::from_isometry(&place).map_err(|e| e.to_string())?;
        let best = least(&a.patches()[0], &b.patches()[0], &place);
        let answers = [
            warm.closest_with(&a, &b, &pose, &options),
            PairTracker::new().closest_with(&a, &b, &pose, &options),
            PairTracker::new().closest_with(&b, &a, &pose.swapped(), &options),
        ];
        for (k, found) in answers.into_iter().enumerate() {
            let wrong = |what: &str| Err(format!("frame {frame}, answer {k}, {best:e}: {what}: {found:?}"));
            if !(found.lower <= found.distance && found.distance <= found.upper) {
                return wrong("bounds out of order");
            }
            if found.lower > best + NOISE {
                return wrong("two points are closer");
            }
            let (on_a, on_b) = if k == 2 { (&b, &a) } else { (&a, &b) };
            let points = [(on_a, found.point_on_a, 0), (on_b, found.point_on_b, 1)];
            for (surface, point, side) in points {
                let there = surface.point(&found.locations[side]);
                if !there.is_some_and(|p| (p - point).norm() <= NOISE) {
                    return wrong("a witness is not on its surface");
                }
            }
            let place = if k == 2 { place.inverse() } else { place };
            let apart = (found.point_on_a - place * found.point_on_b).norm();
            if found.upper < apart - NOISE && found.lower > 0.0 {
                return wrong("the witnesses are farther apart than the upper bound");
            }
            mix.wide += u64::from(!found.is_converged);
        }
        let found = &answers[0];
        mix.frames[usize::from(found.lower <= 0.0)] += 1;
        mix.reached += u64::from((best - found.upper).abs() < 1e-6);
    }
    Ok(mix)
}
