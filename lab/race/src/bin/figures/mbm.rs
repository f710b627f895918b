//! The time in which RRT-Connect solves the MotionBenchMaker problems, from a record of the race
//! `mbm`: every tenth problem with hulls and with meshes, in the order of the times.

use std::collections::BTreeMap;
use std::path::Path;

use race::plot::Chart;

use crate::Trouble;
use crate::records::{newest, text};

/// Returns the chart of problems solved over time.
pub(crate) fn picture(folder: &Path) -> Result<String, Trouble> {
    let file = newest(folder, "-mbm.csv")?;
    let mut engines: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for line in std::fs::read_to_string(&file)?.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [engine, solved, us] = cells[..] else {
            return Err(format!("{}: {line}", file.display()).into());
        };
        let point = (us.parse::<f64>()? / 1000.0, solved.parse()?);
        engines.entry(engine.to_owned()).or_default().push(point);
    }
    let mut chart = Chart::new("Panda, 700 problems of MotionBenchMaker: certified paths over time")
        .axes("processor time of a problem, ms", "problems solved")
        .log_x()
        .legend_low();
    for (engine, points) in engines
        .into_iter()
        .filter(|(engine, _)| engine.starts_with("rrt-connect"))
    {
        chart = chart.line(engine, points);
    }
    text(&chart)
}
