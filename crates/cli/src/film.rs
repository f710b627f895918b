//! Recordings of motions: where they are written, and motions with the verdict about each segment.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use lin_canny_robot::plan::{Cell, Checker, JointCurve, JointTree, Verdict};
use lin_canny_robot::record::{PageOptions, Recording, page};
use lin_canny_robot::{Coordinate, RobotRecorder, Trajectory};

use crate::end::ToolError;
use crate::text::{fraction_below, names, place, time_at, write};

/// Recorded frames per segment.
pub(crate) const FRAMES: u32 = 32;

/// Where a command writes what it records.
#[derive(Args)]
pub(crate) struct FilmOptions {
    /// Output recording: the robot, its cell and the closest pair in each frame; `certify` adds the verdict
    #[arg(long, value_name = "OUT.jsonl")]
    record: Option<PathBuf>,
    /// Output page: the same recording as one HTML file, which any browser with WebGL 2 plays
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,
}

/// The lines of a recording, in a file, in memory for a page, or both.
pub(crate) struct Film {
    file: Option<BufWriter<File>>,
    lines: Option<Vec<u8>>,
}

impl Write for Film {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(file) = &mut self.file {
            file.write_all(bytes)?;
        }
        if let Some(lines) = &mut self.lines {
            lines.extend_from_slice(bytes);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), BufWriter::flush)
    }
}

impl FilmOptions {
    /// Returns the file that errors name; `None` if nothing is recorded.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.record.as_deref().or(self.page.as_deref())
    }

    /// Starts a recording if one was requested, with the robot at the configuration `q`.
    pub(crate) fn start(
        &self,
        checker: &Checker<JointTree>,
        q: &[f64],
    ) -> Result<Option<RobotRecorder<Film>>, ToolError> {
        let Some(named) = self.file() else { return Ok(None) };
        let create = |file: &PathBuf| {
            File::create(file)
                .map(BufWriter::new)
                .map_err(|reason| ToolError::Write {
                    file: file.clone(),
                    reason,
                })
        };
        let film = Film {
            file: self.record.as_ref().map(create).transpose()?,
            lines: self.page.as_ref().map(|_| Vec::new()),
        };
        Ok(Some(RobotRecorder::new(film, named, checker, q)?))
    }

    /// Ends the recording and writes the page.
    pub(crate) fn finish(&self, recorder: RobotRecorder<Film>) -> Result<(), ToolError> {
        let film = recorder.finish()?;
        let (Some(file), Some(lines)) = (&self.page, film.lines) else {
            return Ok(());
        };
        let recording = Recording::read(lines.as_slice()).map_err(|error| ToolError::State {
            file: file.clone(),
            reason: error.to_string(),
        })?;
        write(file, &page(&recording, &PageOptions::default()))
    }
}

/// Records the motion along curves, with the closest pair and the verdict in each frame.
///
/// A segment that is blocked has one more frame, at the time of the contact.
pub(crate) fn record(
    film: &FilmOptions,
    cell: &Cell,
    path: &Trajectory,
    (curves, verdicts): (&[JointCurve], &[Verdict]),
    unit: &str,
) -> Result<(), ToolError> {
    // Another checker, so that the queries of the verdicts are counted alone.
    let mut checker = Checker::of_robots(cell.clone())?;
    let coordinates = cell.coordinates();
    let Some(mut recorder) = film.start(&checker, &path.rows[0])? else {
        return Ok(());
    };
    for (k, (curve, verdict)) in curves.iter().zip(verdicts).enumerate() {
        let end = reported(&checker, path, k, verdict);
        let segment = format!("{unit} {} to {}", path.lines[k], path.lines[k + 1]);
        for t in times(k == 0, verdict) {
            let q = at(curve, t, coordinates);
            let Some(near) = checker.clearance(&q)? else { continue };
            match verdict {
                Verdict::Blocked {
                    free_until: safe,
                    contact_at: hit,
                    pair,
                    ..
                } if t == *hit && near.pair == *pair && near.distance <= 0.0 => {
                    let ends = [*safe, *hit].map(|t| (time_at(path, k, t).unwrap_or(t), at(curve, t, coordinates)));
                    recorder.bracket(&checker, *pair, &ends)?;
                }
                _ => {}
            }
            let place = place(t, time_at(path, k, t));
            recorder.frame(&checker, &q, &format!("{segment}, {place} ({end})"), &near)?;
        }
    }
    film.finish(recorder)
}

/// Returns the recorded times of a segment, in order. A segment begins where the one before ended.
fn times(is_first: bool, verdict: &Verdict) -> Vec<f64> {
    let mut all: Vec<f64> = (u32::from(!is_first)..=FRAMES)
        .map(|k| f64::from(k) / f64::from(FRAMES))
        .collect();
    if let Verdict::Blocked { contact_at: t, .. } = verdict
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
fn reported(checker: &Checker<JointTree>, path: &Trajectory, k: usize, verdict: &Verdict) -> String {
    match verdict {
        Verdict::Free { .. } => verdict.name().into(),
        Verdict::Blocked {
            contact_at: t, pair, ..
        } => {
            let [a, b] = names(checker, *pair);
            format!("blocked {}: {a} - {b}", place(*t, time_at(path, k, *t)))
        }
        _ => format!(
            "undecided from {} of the segment on",
            fraction_below(verdict.free_until())
        ),
    }
}
