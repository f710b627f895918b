//! Recordings of motions for the viewer, with the verdict about each segment.

use std::path::Path;

use lin_canny_robot::plan::{Checker, JointCurve, JointTree, Verdict};
use lin_canny_robot::{Coordinate, RobotRecorder, Setup, Trajectory};

use super::ToolError;
use super::text::{fraction_below, names, place, time_at};

/// Recorded frames per segment.
pub(super) const FRAMES: u32 = 32;

/// Records the motion along curves, with the closest pair and the verdict in each frame.
///
/// A segment that is blocked has one more frame, at the time of the contact.
pub(super) fn record(
    file: &Path,
    setup: &Setup,
    path: &Trajectory,
    (curves, verdicts): (&[JointCurve], &[Verdict]),
    unit: &str,
) -> Result<(), ToolError> {
    // Another checker, so that the queries of the verdicts are counted alone.
    let mut checker = setup.checker()?;
    let coordinates = setup.coordinates();
    let mut recorder = RobotRecorder::create(file, &checker, &path.rows[0])?;
    for (k, (curve, verdict)) in curves.iter().zip(verdicts).enumerate() {
        let end = told(&checker, path, k, verdict);
        let segment = format!("{unit} {} to {}", path.lines[k], path.lines[k + 1]);
        for t in times(k == 0, verdict) {
            let q = at(curve, t, coordinates);
            let Some(near) = checker.clearance(&q)? else { continue };
            match verdict {
                Verdict::Blocked { safe, t: hit, pair, .. }
                    if t == *hit && near.pair == *pair && near.distance <= 0.0 =>
                {
                    let ends = [*safe, *hit].map(|t| (time_at(path, k, t).unwrap_or(t), at(curve, t, coordinates)));
                    recorder.bracket(&checker, *pair, &ends)?;
                }
                _ => {}
            }
            let place = place(t, time_at(path, k, t));
            recorder.frame(&checker, &q, &format!("{segment}, {place} ({end})"), &near)?;
        }
    }
    Ok(recorder.finish()?)
}

/// Returns the recorded times of a segment, in order. A segment begins where the one before ended.
fn times(is_first: bool, verdict: &Verdict) -> Vec<f64> {
    let mut all: Vec<f64> = (u32::from(!is_first)..=FRAMES)
        .map(|k| f64::from(k) / f64::from(FRAMES))
        .collect();
    if let Verdict::Blocked { t, .. } = verdict
        && !all.contains(t)
    {
        all.push(*t);
        all.sort_by(f64::total_cmp);
    }
    all
}

/// Returns a configuration of a curve that keeps its limits except for rounding.
fn at(curve: &JointCurve, t: f64, coordinates: &[Coordinate]) -> Vec<f64> {
    let clamped = |(x, c): (f64, &Coordinate)| x.max(c.limits[0]).min(c.limits[1]);
    curve.at(t).into_iter().zip(coordinates).map(clamped).collect()
}

/// Returns a verdict in words.
fn told(checker: &Checker<JointTree>, path: &Trajectory, k: usize, verdict: &Verdict) -> String {
    match verdict {
        Verdict::Free { .. } => "free".into(),
        Verdict::Blocked { t, pair, .. } => {
            let [a, b] = names(checker, *pair);
            format!("blocked {}: {a} - {b}", place(*t, time_at(path, k, *t)))
        }
        _ => format!("undecided from {} of the segment on", fraction_below(verdict.safe())),
    }
}
