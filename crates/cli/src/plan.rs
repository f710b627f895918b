//! The command `plan`: searches for a path from the first to the last row of a file.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use lin_canny::Progress;
use lin_canny_cli::{
    RobotOptions,
    output::{self, progress},
    values,
};
use lin_canny_robot::plan::{Checker, ConfigurationSpace, JointTree, PlanError, PlanMethod, PlanOptions, Shortcuts};
use lin_canny_robot::{Trajectory, csv_text};

use crate::end::{End, ToolError};
use crate::film::{FRAMES, FilmOptions};
use crate::options::{RowOptions, check_at_rest};
use crate::pair_boxes::PairBoxArguments;
use crate::text::{distance, names, write};

/// The method of the search.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    /// Two trees that grow towards random configurations and each other
    RrtConnect,
    /// Freeways of largest clearance in slices
    Opportunistic,
}

impl From<Method> for PlanMethod {
    fn from(method: Method) -> Self {
        match method {
            Method::RrtConnect => Self::RrtConnect,
            Method::Opportunistic => Self::Opportunistic,
        }
    }
}

#[derive(Args)]
pub(crate) struct PlanArguments {
    #[command(flatten)]
    robot: RobotOptions,
    #[command(flatten)]
    rows: RowOptions,
    /// Output file with the path [default: stdout]
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    film: FilmOptions,
    /// Required distance of all pairs in metres, without their paddings [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    margin: Option<f64>,
    #[command(flatten)]
    pair_boxes: PairBoxArguments,
    /// Method of the search
    #[arg(long, value_enum, default_value = "rrt-connect")]
    method: Method,
    /// Random seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Time limit of the search in seconds
    #[arg(long, default_value = "10", value_parser = values::duration)]
    seconds: Duration,
    /// Number of attempts to shorten the path
    #[arg(long, default_value_t = 300)]
    shorten: usize,
}

pub(crate) fn run(options: &PlanArguments) -> Result<End, ToolError> {
    let (robot, cell) = options.robot.load()?;
    let rows = options.rows.load(&options.robot, &robot, &cell, 2)?;
    let (start, goal) = (&rows.rows[0], &rows.rows[rows.rows.len() - 1]);
    let mut checker = Checker::of_robots(cell.clone())?;
    check_at_rest(
        checker.cell(),
        options.rows.file(),
        "obstacles at rest in the search for a path",
    )?;
    if let Some(margin) = options.margin {
        checker.cell_mut().set_margin(margin)?;
    }
    options.pair_boxes.set(&mut checker)?;
    let began = Instant::now();
    let search = PlanOptions::default().seed(options.seed).unlimited();
    let bar = progress("seconds", options.seconds.as_secs());
    let mut stop = |_| {
        bar.set_position(began.elapsed().as_secs());
        Progress::stop_if(began.elapsed() > options.seconds)
    };
    let found = PlanMethod::from(options.method).plan(&mut checker, [start, goal], &search, &mut stop);
    bar.finish_and_clear();
    let found = match found {
        Err(PlanError::Contact { end, a, b }) => return Err(blocked(options, &mut checker, &rows, end, [a, b])),
        found => found?,
    };
    let Some(path) = found.path else {
        warn!("no path found in {:.1?}; a path may exist", began.elapsed());
        return Ok(End::NoPath);
    };
    let short = Shortcuts::new(options.shorten, options.seed).shorten(&mut checker, &path)?;
    let text = csv_text(cell.coordinates(), &short);
    match &options.csv {
        Some(file) => write(file, &text)?,
        None => output::put(format_args!("{text}")),
    }
    record(&options.film, &mut checker, &short)?;
    warn!(
        "a path of {} rows, length {:.3} ({:.3} before it was shortened)",
        short.len(),
        checker.space().path_length(&short),
        checker.space().path_length(&path)
    );
    Ok(End::Free)
}

/// Returns the error of a start or goal at which a pair does not keep its required distance.
fn blocked(
    options: &PlanArguments,
    checker: &mut Checker<JointTree>,
    rows: &Trajectory,
    end: &'static str,
    [mut a, mut b]: [String; 2],
) -> ToolError {
    let row = if end == "start" { 0 } else { rows.rows.len() - 1 };
    let mut how = "in contact or closer than required".to_owned();
    if let Ok(Some(near)) = checker.least_excess(&rows.rows[row]) {
        [a, b] = names(checker, near.pair);
        let far = distance(near.lower, near.upper);
        let required = checker.cell().required_distance(near.pair);
        let required = checker.show(&required).length(" m");
        how = if near.upper <= 0.0 {
            format!("in contact at the {end}")
        } else {
            format!("{far} apart at the {end} (expected more than {required})")
        };
    }
    ToolError::Blocked {
        file: options.rows.file().to_owned(),
        line: rows.lines[row],
        reason: format!("{a} and {b} are {how}"),
    }
}

/// Records the motion along a path, with the closest pair of each frame.
fn record(film: &FilmOptions, checker: &mut Checker<JointTree>, path: &[Vec<f64>]) -> Result<(), ToolError> {
    let Some(mut recorder) = film.start(checker, &path[0])? else {
        return Ok(());
    };
    for (row, ends) in path.windows(2).enumerate() {
        // A segment begins where the one before ended.
        for k in u32::from(row > 0)..=FRAMES {
            let part = f64::from(k) / f64::from(FRAMES);
            let q = checker.space().between(&ends[0], &ends[1], part);
            if let Some(near) = checker.clearance(&q)? {
                recorder.frame(checker, &q, &format!("segment {}, {part}", row + 1), &near)?;
            }
        }
    }
    film.finish(recorder)
}
