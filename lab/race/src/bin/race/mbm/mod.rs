//! Plans paths for the MotionBenchMaker problems and certifies each with a fresh checker.
//!
//! The problems are those of Chamzas et al. 2022, "MotionBenchMaker: a tool to generate and
//! benchmark motion planning datasets", as the package `vamp-planner` publishes them: folders
//! `ROBOT/problems/SET_ROBOT` beside `ROBOT/ROBOT.urdf` and `ROBOT/ROBOT.srdf`.
//!
//! A problem is valid if start and goal are within the limits and free. Meshes of the robot are
//! used as hulls and as they are. Times are processor times of the thread, without the checker's
//! construction; paths of a file have no time. The checkers of a robot share its bodies, so the hull
//! of a mesh is made once, and so are the boxes in which links of a wrist are apart.

mod problem;
#[path = "../../../../../../crates/robot/src/yaml.rs"]
mod yaml;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::Path;

use cpu_time::ThreadTime;
use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, JointMotion, JointTree, PairBoxes, PlanError, PlanMethod, PlanOptions, Shortcuts,
};
use lin_canny_robot::{CellFile, LoadOptions, MeshUse, Packages, Robot, Srdf};
use race::common::Options;
use race::progress::Progress;

use problem::Problem;

/// The robots of the problems.
pub(crate) const ROBOTS: [&str; 3] = ["panda", "ur5", "fetch"];

/// Problems of each set in a quick run.
const QUICK: usize = 3;

/// Attempts of a shortening.
const TRIES: usize = 20;

/// Boxes of a pair of links with one or two joints between them.
const PAIR_BOXES: u64 = 500;

/// A value of a path in single precision may exceed a limit by this.
const SINGLE: f64 = 1e-5;

/// The result of an engine and a problem.
struct Row {
    robot: &'static str,
    set: String,
    index: u32,
    engine: String,
    is_valid: bool,
    /// Whether each segment of the path is certified; `None` without a path.
    is_certified: Option<bool>,
    us: Option<f64>,
    length: Option<f64>,
}

/// Runs the race, prints a table and writes the rows.
///
/// # Errors
/// Returns an error if a file of a problem or of paths is missing or invalid. A robot that does not
/// load is named and left out.
pub(crate) fn run(options: &Options, data: Option<&Path>, paths: Option<&Path>) -> Result<(), String> {
    let data = data.ok_or("--data FOLDER is missing: the folder `resources` of the package vamp-planner")?;
    let paths = paths.map(load_paths).transpose()?.unwrap_or_default();
    let most = options.most().unwrap_or(if options.quick { QUICK } else { usize::MAX });
    let mut rows = Vec::new();
    for robot in ROBOTS {
        let folder = data.join(robot);
        if !options.wants(robot) || !folder.is_dir() {
            continue;
        }
        let problems = problem::load(&folder.join("problems"), robot, most)?;
        for (usage, meshes) in [("hulls", MeshUse::Hull), ("meshes", MeshUse::Mesh)] {
            let bench = match Bench::load(robot, &folder, meshes) {
                Ok(bench) => bench,
                Err(why) => {
                    println!("{robot}: left out: {why}");
                    break;
                }
            };
            if usage == "meshes" && !bench.has_meshes() {
                break;
            }
            let bar = Progress::new(&format!("{robot}, {usage}"), problems.len() as u64);
            for problem in &problems {
                bench.race(problem, usage, &paths, &mut rows)?;
                bar.step();
            }
        }
    }
    if rows.is_empty() {
        return Err(format!("{}: no robot (expected folders such as panda)", data.display()));
    }
    print!("{}", table(&rows));
    options.save(&csv(&rows))
}

/// A robot, and what its checkers share: bodies, hulls of meshes and excluded pairs.
struct Bench {
    name: &'static str,
    robot: Robot,
    cell: Cell,
    space: JointTree,
    pairs: PairBoxes,
    packages: Packages,
    options: LoadOptions,
}

impl Bench {
    fn load(name: &'static str, folder: &Path, meshes: MeshUse) -> Result<Self, String> {
        let packages = Packages::new([folder.to_owned()]);
        let options = LoadOptions::default().meshes(meshes);
        let robot = Robot::load_with(folder.join(format!("{name}.urdf")), &packages, &options);
        let robot = robot.map_err(|e| e.to_string())?;
        let srdf = Srdf::load(folder.join(format!("{name}.srdf")), &robot).map_err(|e| e.to_string())?;
        let text = |error: PlanError| error.to_string();
        let mut cell = Cell::new();
        cell.add_robot("", &robot, Isometry3::identity()).map_err(text)?;
        cell.exclude_adjacent();
        srdf.exclude_in(&mut cell, "").map_err(text)?;
        let mut checker = Checker::of_robots(cell).map_err(text)?;
        let began = ThreadTime::now();
        let pairs = PairBoxes::search(&mut checker, PAIR_BOXES, &mut |_| ControlFlow::Continue(())).map_err(text)?;
        let (count, seconds) = (pairs.pairs().count(), began.elapsed().as_secs_f64());
        println!("{name}: boxes of {count} pairs of links in {seconds:.2} s");
        Ok(Self {
            name,
            robot,
            cell: checker.cell().clone(),
            space: checker.space().clone(),
            pairs,
            packages,
            options,
        })
    }

    fn has_meshes(&self) -> bool {
        let mut bodies = self.robot.links().iter().flat_map(|link| &link.bodies);
        bodies.any(|body| body.mesh.is_some())
    }

    fn checker(&self, problem: &Problem) -> Result<Checker<JointTree>, String> {
        let mut cell = self.cell.clone();
        let file = CellFile::parse(&problem.cell, "cell.json", &self.packages, &self.options);
        let text = |error: PlanError| error.to_string();
        let file = file.map_err(|e| e.to_string())?;
        file.add_to(&mut cell).map_err(|e| e.to_string())?;
        let mut checker = Checker::new(self.space.clone(), cell).map_err(text)?;
        checker.set_pair_boxes(&self.pairs).map_err(text)?;
        Ok(checker)
    }

    /// Returns start and goal in the order of the robot's coordinates.
    fn ends(&self, problem: &Problem) -> Result<[Vec<f64>; 2], String> {
        let of = |values: &BTreeMap<String, f64>| {
            let one = |name: &String| {
                let value = values.get(name).copied();
                value.ok_or_else(|| format!("{} {}: no value of joint {name}", problem.set, problem.index))
            };
            let values = self.robot.coordinates().iter().map(|c| one(&c.name));
            values.collect::<Result<Vec<f64>, String>>()
        };
        Ok([of(&problem.start)?, of(&problem.goal)?])
    }

    /// Adds the rows of all engines for a problem.
    fn race(&self, problem: &Problem, usage: &str, paths: &Paths, rows: &mut Vec<Row>) -> Result<(), String> {
        let [start, goal] = self.ends(problem)?;
        let mut checker = self.checker(problem)?;
        let is_valid = self.is_valid(&mut checker, &start)? && self.is_valid(&mut checker, &goal)?;
        let row = |engine: &str, found: Option<(bool, f64)>, us: Option<f64>| Row {
            robot: self.name,
            set: problem.set.clone(),
            index: problem.index,
            engine: format!("{engine} {usage}"),
            is_valid,
            is_certified: found.map(|f| f.0),
            us,
            length: found.map(|f| f.1),
        };
        for method in PlanMethod::ALL {
            let name = method.name();
            if !is_valid {
                rows.push(row(name, None, None));
                continue;
            }
            let mut checker = self.checker(problem)?;
            let began = ThreadTime::now();
            let mut unwatched = |_| ControlFlow::Continue(());
            let plan = method.plan(&mut checker, [&start, &goal], &PlanOptions::default(), &mut unwatched);
            let plan = plan.map_err(|e| e.to_string())?;
            let us = began.elapsed().as_secs_f64() * 1e6;
            let Some(path) = plan.path else {
                rows.push(row(name, None, Some(us)));
                continue;
            };
            rows.push(row(name, Some(self.judged(problem, &path)?), Some(us)));
            let began = ThreadTime::now();
            let path = Shortcuts::new(TRIES, 1)
                .shorten(&mut checker, &path)
                .map_err(|e| e.to_string())?;
            let us = us + began.elapsed().as_secs_f64() * 1e6;
            let short = format!("{name} + shorten");
            rows.push(row(&short, Some(self.judged(problem, &path)?), Some(us)));
        }
        let key = (self.name.to_owned(), problem.set.clone(), problem.index);
        if let Some(path) = paths.get(&key) {
            let bounds = checker.space().bounds();
            let path = path.iter().map(|q| within(q, bounds)).collect::<Vec<_>>();
            rows.push(row("file", Some(self.judged(problem, &path)?), None));
        }
        Ok(())
    }

    fn is_valid(&self, checker: &mut Checker<JointTree>, q: &[f64]) -> Result<bool, String> {
        let bounds = checker.space().bounds();
        let is_within = bounds.iter().zip(q).all(|([low, high], x)| (*low..=*high).contains(x));
        Ok(is_within && checker.is_free_at(q).map_err(|e| e.to_string())?)
    }

    /// Returns whether a fresh checker certifies each segment of a path, and its length in radians
    /// and metres.
    fn judged(&self, problem: &Problem, path: &[Vec<f64>]) -> Result<(bool, f64), String> {
        let mut checker = self.checker(problem)?;
        let motion = JointMotion::path(path).map_err(|e| e.to_string())?;
        let verdict = checker.certify(&motion).map_err(|e| e.to_string())?;
        let segment = |ends: &[Vec<f64>]| {
            let squares = ends[0].iter().zip(&ends[1]).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        Ok((verdict.is_free(), path.windows(2).map(segment).sum()))
    }
}

/// Returns a configuration whose values exceed no limit by single precision alone.
fn within(q: &[f64], bounds: &[[f64; 2]]) -> Vec<f64> {
    let one = |(x, [low, high]): (&f64, &[f64; 2])| match *x {
        x if x < *low && x > low - SINGLE => *low,
        x if x > *high && x < high + SINGLE => *high,
        x => x,
    };
    q.iter().zip(bounds).map(one).collect()
}

/// Paths by robot, set and number.
type Paths = BTreeMap<(String, String, u32), Vec<Vec<f64>>>;

/// Reads the paths of another planner: a JSON object a line, with `robot`, `set`, `index` and
/// `path`, a list of configurations in the order of the joints of the URDF.
fn load_paths(file: &Path) -> Result<Paths, String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let one = |line: &str| {
        let row: serde_json::Value = serde_json::from_str(line).ok()?;
        let index = u32::try_from(row["index"].as_u64()?).ok()?;
        let key = (
            row["robot"].as_str()?.to_owned(),
            row["set"].as_str()?.to_owned(),
            index,
        );
        let numbers = |q: &serde_json::Value| q.as_array()?.iter().map(serde_json::Value::as_f64).collect();
        let path = row["path"].as_array()?.iter().map(numbers).collect::<Option<_>>()?;
        Some((key, path))
    };
    let lines = text.lines().enumerate();
    lines
        .map(|(k, line)| one(line).ok_or_else(|| format!("{}:{}: no path", file.display(), k + 1)))
        .collect()
}

/// Returns the rows as CSV.
fn csv(rows: &[Row]) -> String {
    let mut out = String::from("robot,set,index,engine,valid,solved,certified,us,length\n");
    let number = |x: Option<f64>, digits: usize| x.map_or(String::new(), |x| format!("{x:.digits$}"));
    for r in rows {
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{}",
            r.robot,
            r.set,
            r.index,
            r.engine,
            u8::from(r.is_valid),
            u8::from(r.is_certified.is_some()),
            u8::from(r.is_certified == Some(true)),
            number(r.us, 1),
            number(r.length, 4)
        );
    }
    out
}

/// Returns a table with a line for each robot and engine.
fn table(rows: &[Row]) -> String {
    let mut groups: Vec<(&str, &str)> = Vec::new();
    for r in rows {
        let group = (r.robot, r.engine.as_str());
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    let mut out = format!(
        "{:<7}{:<24}{:>9}{:>7}{:>8}{:>10}{:>11}{:>10}{:>10}{:>10}{:>8}\n",
        "robot", "engine", "problems", "valid", "solved", "certified", "median us", "mean", "p95", "max", "length"
    );
    for (robot, engine) in groups {
        let all = || rows.iter().filter(|r| (r.robot, r.engine.as_str()) == (robot, engine));
        let count = |is: fn(&Row) -> bool| all().filter(|r| is(r)).count();
        let sorted = |of: fn(&Row) -> Option<f64>| {
            let mut list: Vec<f64> = all().filter(|r| r.is_certified.is_some()).filter_map(of).collect();
            list.sort_by(f64::total_cmp);
            list
        };
        let at = |list: &[f64], part: f64| {
            let k = (part * list.len() as f64) as usize;
            list.get(k.min(list.len().saturating_sub(1)))
                .copied()
                .unwrap_or(f64::NAN)
        };
        let (us, lengths) = (sorted(|r| r.us), sorted(|r| r.length));
        let mean = us.iter().sum::<f64>() / us.len() as f64;
        let _ = writeln!(
            out,
            "{robot:<7}{engine:<24}{:>9}{:>7}{:>8}{:>10}{:>11.0}{mean:>10.0}{:>10.0}{:>10.0}{:>8.2}",
            all().count(),
            count(|r| r.is_valid),
            count(|r| r.is_certified.is_some()),
            count(|r| r.is_certified == Some(true)),
            at(&us, 0.5),
            at(&us, 0.95),
            at(&us, 1.0),
            at(&lengths, 0.5),
        );
    }
    out
}
