//! Races segments of a long hull in rooms of 40 and 150 hulls, then whole searches.
//!
//! Segments are certified over their whole length, or checked at steps of 0.2, 0.05 and 0.01, as
//! most planners do. The checker at fixed steps uses the same boxes and predicates
//! (`Tracker::intersects`, one warm tracker per pair). A pair counts as a check if its boxes
//! overlap. Segments are wrong if the steps report them free and the certificate proves them
//! blocked.

use std::hint::black_box;
use std::time::Duration;

use cpu_time::ThreadTime;
use lin_canny::broad::{Aabb, BodyOptions, SweepAndPrune};
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{BoxHint, RelativePose, Tracker};
use lin_canny_plan::{Checker, ConfigurationSpace, JointMotion, PlanMethod, PlanOptions, RigidSpace, Verdict};
use race::progress::Progress;
use truth::cells::ArmCell;
use truth::rng::Rng;
use truth::rooms::Room;

use crate::rrt;
use race::common::{Options, Rows, median};

pub(crate) const SCENES: [&str; 5] = ["room-40", "room-150", "search-150", "search-hole", "free-at"];

/// Time limit of a search: processor time, but wall time for `oxmpl`.
const LIMIT: Duration = Duration::from_secs(1);

/// Lengths of the fixed steps.
const STEPS: [f64; 3] = [0.2, 0.05, 0.01];

/// A segment with its two end configurations.
struct Segment {
    ends: [Vec<f64>; 2],
    length: f64,
    is_free: bool,
}

/// A checker at fixed steps.
struct Fixed<'a> {
    room: &'a Room,
    space: RigidSpace,
    boxes: SweepAndPrune,
    trackers: Vec<Tracker>,
    hint: BoxHint,
    checks: u64,
}

impl<'a> Fixed<'a> {
    fn new(room: &'a Room) -> Self {
        let mut boxes = SweepAndPrune::new();
        for (hull, pose) in &room.hulls {
            let aabb = Aabb::from(hull.aabb_at(pose, &mut BoxHint::default()));
            boxes
                .insert(&aabb, BodyOptions::default().fixed(true))
                .expect("a finite box");
        }
        boxes.step();
        Self {
            room,
            space: room.space(),
            boxes,
            trackers: vec![Tracker::new(); room.hulls.len()],
            hint: BoxHint::default(),
            checks: 0,
        }
    }

    fn is_clear(&mut self, pose: &Isometry3<f64>) -> bool {
        let robot = &self.room.robot;
        let aabb = Aabb::from(robot.aabb_at(pose, &mut self.hint));
        let mut found = Vec::new();
        self.boxes.overlapping(&aabb, &mut found).expect("a finite box");
        found.into_iter().all(|id| {
            let k = id.index as usize;
            let (hull, placed) = &self.room.hulls[k];
            self.checks += 1;
            let relative = RelativePose::new(pose, placed).expect("poses are poses");
            !self.trackers[k].intersects(robot, hull, &relative)
        })
    }

    fn is_free(&mut self, segment: &Segment, step: f64) -> bool {
        let count = (segment.length / step).ceil().max(1.0) as usize;
        let mut poses = Vec::new();
        (0..=count).all(|k| {
            let q = self
                .space
                .between(&segment.ends[0], &segment.ends[1], k as f64 / count as f64);
            self.space.place(&q, &mut poses);
            self.is_clear(&poses[0])
        })
    }
}

/// Returns nanoseconds per segment, for free and for blocked segments: the least of some passes.
fn time(segments: &[Segment], passes: usize, mut is_free: impl FnMut(&Segment) -> bool) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..passes {
        for (free, least) in [true, false].into_iter().zip(&mut least) {
            let some = segments.iter().filter(|s| s.is_free == free);
            let began = ThreadTime::now();
            let count = some.inspect(|s| _ = black_box(is_free(s))).count();
            *least = least.min(began.elapsed().as_nanos() as f64 / count.max(1) as f64);
        }
    }
    least
}

fn segments(room: &Room, checker: &mut Checker<RigidSpace>, count: u64) -> Vec<Segment> {
    let one = |k: u64| {
        let ends = room
            .segment(&mut Rng::of_case(17, k))
            .map(|pose| RigidSpace::configuration(&pose));
        let is_free = checker
            .is_free(&JointMotion::segment(&ends[0], &ends[1]))
            .expect("a segment");
        let length = checker.space().distance(&ends[0], &ends[1]);
        Segment { ends, length, is_free }
    };
    (0..count).map(one).collect()
}

fn room(o: &Options, scene: &str, n: usize, rows: &mut Rows) {
    let room = Room::new(n, 1);
    let mut checker = Checker::new(room.space(), room.cell()).expect("a room");
    let segments = segments(&room, &mut checker, if o.quick { 400 } else { 10_000 });
    let free: Vec<&Segment> = segments.iter().filter(|s| s.is_free).collect();
    let passes = if o.quick { 2 } else { 3 };
    let before = checker.work();
    for s in &free {
        black_box(
            checker
                .is_free(&JointMotion::segment(&s.ends[0], &s.ends[1]))
                .expect("a segment"),
        );
    }
    let calls = (checker.work().queries - before.queries) as f64 / free.len() as f64;
    let ours = time(&segments, passes, |s| {
        checker
            .is_free(&JointMotion::segment(&s.ends[0], &s.ends[1]))
            .expect("a segment")
    });
    println!("{scene}: {} of {} segments free", free.len(), segments.len());
    let line = |name: &str, wrong: usize, calls: f64, [free, blocked]: [f64; 2]| {
        println!(
            "  {name:<12}{wrong:>7}{calls:>10.2}{:>10.2}{:>7.3}{:>12.2}",
            free / 1000.0,
            ours[0] / free,
            blocked / 1000.0
        );
    };
    println!(
        "  {:<12}{:>7}{:>10}{:>10}{:>7}{:>12}",
        "", "wrong", "calls", "free us", "ratio", "blocked us"
    );
    line("certified", 0, calls, ours);
    rows.push((scene, "free", n), "certified", ours[0], 1);
    rows.push((scene, "blocked", n), "certified", ours[1], 1);
    for step in STEPS {
        let mut fixed = Fixed::new(&room);
        let wrong = segments.iter().filter(|s| fixed.is_free(s, step) && !s.is_free).count();
        fixed.checks = 0;
        free.iter().for_each(|s| _ = black_box(fixed.is_free(s, step)));
        let calls = fixed.checks as f64 / free.len() as f64;
        let times = time(&segments, passes, |s| fixed.is_free(s, step));
        let name = format!("step {step}");
        line(&name, wrong, calls, times);
        rows.push((scene, "free", n), &name, times[0], 1);
        rows.push((scene, "blocked", n), &name, times[1], 1);
    }
}

/// Times of searches, number of paths found, and number of paths that a certificate proves blocked.
#[derive(Default)]
struct Searches {
    times: Vec<f64>,
    found: usize,
    wrong: usize,
}

impl Searches {
    fn push(&mut self, took: Duration, path: Option<(&[Vec<f64>], &mut Checker<RigidSpace>)>) {
        self.times.push(took.as_nanos() as f64);
        if let Some((path, checker)) = path {
            self.found += 1;
            let verdict = checker
                .certify(&JointMotion::path(path).expect("a path"))
                .expect("a path");
            self.wrong += usize::from(matches!(verdict, Verdict::Blocked { .. }));
        }
    }

    fn print(mut self, (scene, n): (&str, usize), engine: &str, rows: &mut Rows) {
        let typical = median(&mut self.times);
        let worst = self.times[self.times.len() - 1];
        println!(
            "  {engine:<16}{:>5} of {:<5}{:>6}{:>12.2}{:>12.2}",
            self.found,
            self.times.len(),
            self.wrong,
            typical / 1e6,
            worst / 1e6
        );
        rows.push((scene, "median", n), engine, typical, 0);
        rows.push((scene, "worst", n), engine, worst, 0);
    }
}

/// Runs one search per seed and method between two configurations, and RRT-Connect at steps of 0.01
/// for comparison.
fn search(scene: &str, room: Room, space: &RigidSpace, ends: [Vec<f64>; 2], seeds: u64, rows: &mut Rows) {
    let [first, second] = PlanMethod::ALL.map(PlanMethod::name);
    let engines = [first, second, "oxmpl step 0.01"];
    let mut searches = [(); 3].map(|()| Searches::default());
    // The checker of `oxmpl` needs a `'static` lifetime.
    let room: &'static Room = Box::leak(Box::new(room));
    let [start, goal] = &ends;
    for seed in 0..seeds {
        let fresh = || Checker::new(space.clone(), room.cell()).expect("a room");
        for (method, searches) in PlanMethod::ALL.into_iter().zip(&mut searches) {
            let mut checker = fresh();
            let options = PlanOptions::default().seed(seed);
            let began = ThreadTime::now();
            let mut stop = |_| lin_canny::Progress::stop_if(began.elapsed() > LIMIT);
            let plan = method.plan(&mut checker, [start, goal], &options, &mut stop);
            let plan = plan.expect("free ends");
            let took = began.elapsed();
            searches.push(took, plan.path.as_deref().map(|path| (path, &mut checker)));
        }
        let (mut fixed, mut poses) = (Fixed::new(room), Vec::new());
        let is_clear = move |q: &[f64]| {
            fixed.space.place(q, &mut poses);
            fixed.is_clear(&poses[0])
        };
        let began = ThreadTime::now();
        let path = rrt::search(space, [start, goal], 0.01, seed, LIMIT, is_clear);
        let took = began.elapsed();
        let mut checker = fresh();
        searches[2].push(took, path.as_deref().map(|path| (path, &mut checker)));
    }
    println!(
        "{scene}\n  {:<16}{:>14}{:>6}{:>12}{:>12}",
        "", "found", "wrong", "median ms", "worst ms"
    );
    let n = room.hulls.len();
    for (searches, engine) in searches.into_iter().zip(engines) {
        searches.print((scene, n), engine, rows);
    }
}

/// Searches from corner to corner of a room of 150 hulls, and for a plank 0.2 wide through a hole
/// of 0.4.
fn searches(o: &Options, progress: &Progress, rows: &mut Rows) {
    if o.wants("search-150") {
        let room = Room::new(150, 3);
        let ends = [-5.0, 5.0].map(|c| RigidSpace::configuration(&Isometry3::translation(c, c, c)));
        let space = room.space();
        search("search-150", room, &space, ends, if o.quick { 5 } else { 50 }, rows);
    }
    progress.step();
    if o.wants("search-hole") {
        let robot = solids::cuboid(Vector3::new(0.8, 0.1, 0.1)).expect("a box");
        let hulls = truth::rooms::wall(0.4);
        let (space, ends) = truth::rooms::passage();
        search(
            "search-hole",
            Room { robot, hulls },
            &space,
            ends,
            if o.quick { 3 } else { 20 },
            rows,
        );
    }
}

/// Checks random configurations of an arm of meshes.
///
/// `ours` uses [`Checker::is_free_at`], `is-free` uses segments of one configuration. `n` is the
/// number of triangles of the arm.
fn is_free_at(o: &Options, rows: &mut Rows) {
    let cell = ArmCell::new(84);
    let n = cell.links.iter().map(|l| l.triangles.len()).sum();
    let mut rng = Rng::of_case(23, 0);
    let samples: Vec<Vec<f64>> = (0..if o.quick { 400 } else { 4_000 })
        .map(|_| ArmCell::sample(&mut rng))
        .collect();
    let mut free = Vec::new();
    println!(
        "free-at\n  {:<12}{:>10}{:>12}{:>12}{:>14}",
        "", "free", "us", "pairs", "ns a pair"
    );
    for engine in ["ours", "is-free"] {
        let mut checker = Checker::new(cell.arm(), cell.cell()).expect("a cell");
        let is_ours = engine == "ours";
        let mut ask = |q: &Vec<f64>| match is_ours {
            true => checker.is_free_at(q).expect("a configuration"),
            false => checker.is_free(&JointMotion::segment(q, q)).expect("a configuration"),
        };
        let (mut least, mut found) = (f64::INFINITY, Vec::new());
        for _ in 0..3 {
            let began = ThreadTime::now();
            found = samples.iter().map(|q| black_box(ask(q))).collect();
            least = least.min(began.elapsed().as_nanos() as f64 / samples.len() as f64);
        }
        let w = checker.work();
        let pairs = if is_ours { w.decisions } else { w.queries } as f64 / (3 * samples.len()) as f64;
        let count = found.iter().filter(|f| **f).count();
        println!(
            "  {engine:<12}{count:>10}{:>12.2}{pairs:>12.2}{:>14.0}",
            least / 1e3,
            least / pairs
        );
        rows.push(("free-at", "arm", n), engine, least, 1);
        free.push(found);
    }
    let differ = (0..samples.len()).filter(|&k| free[0][k] != free[1][k]).count();
    println!("  answers that differ: {differ} of {}", samples.len());
}

pub(crate) fn run(o: &Options) -> Rows {
    println!(
        "a segment of up to 1.6 and 1.6 radians: segments called free that are not, distance calls a free segment, microseconds,\n\
         ratio of the certified time to that of the steps.\n"
    );
    let mut rows = Rows::default();
    let progress = Progress::new("race plan", SCENES.len() as u64);
    for (scene, n) in [("room-40", 40), ("room-150", 150)] {
        if o.wants(scene) {
            room(o, scene, n, &mut rows);
        }
        progress.step();
    }
    searches(o, &progress, &mut rows);
    progress.step();
    if o.wants("free-at") {
        is_free_at(o, &mut rows);
    }
    progress.step();
    rows
}
