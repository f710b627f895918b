//! Segments of a long hull in rooms of 40 and 150 hulls: certified over their whole length, and checked at steps of 0.2, 0.05
//! and 0.01 of the segment's length as most planners do; then whole searches.
//!
//! The fixed steps use the same boxes, balls and predicates (`Tracker::intersects`, one warm tracker a pair); a pair counts as a
//! check if its balls overlap. Wrong are the segments that the steps call free and the certificate proves blocked.

use std::hint::black_box;

use cpu_time::ThreadTime;
use lab::progress::Progress;
use lab::rng::Rng;
use lab::rooms::Room;
use lin_canny::broad::{Aabb, Body, BroadPhase, PencilSweep};
use lin_canny::nalgebra::Isometry3;
use lin_canny::plan::{Checker, ConfigurationSpace, PlanOptions, RigidSpace};
use lin_canny::{BoxHint, RelativePose, Tracker};

use crate::common::{Options, Rows, median};

pub(crate) const SCENES: [&str; 3] = ["room-40", "room-150", "search"];

/// Lengths of the fixed steps.
const STEPS: [f64; 3] = [0.2, 0.05, 0.01];

/// One segment as poses and as configurations.
struct Segment {
    ends: [Vec<f64>; 2],
    length: f64,
    is_free: bool,
}

/// A checker at fixed steps.
struct Fixed<'a> {
    room: &'a Room,
    space: RigidSpace,
    boxes: PencilSweep,
    trackers: Vec<Tracker>,
    hint: BoxHint,
    checks: u64,
}

impl<'a> Fixed<'a> {
    fn new(room: &'a Room) -> Self {
        let mut boxes = PencilSweep::new();
        for (hull, pose) in &room.hulls {
            let aabb = Aabb::from(hull.aabb_at(pose, &mut BoxHint::default()));
            boxes.insert(&aabb, Body::fixed()).expect("a finite box");
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

/// Nanoseconds a segment, for those that are free and those that are not: the least of some passes.
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
        let is_free = checker.is_free(&ends[0], &ends[1]).expect("a segment");
        let length = checker.space().distance(&ends[0], &ends[1]);
        Segment { ends, length, is_free }
    };
    (0..count).map(one).collect()
}

fn room(o: &Options, scene: &str, n: usize, rows: &mut Rows) {
    let room = Room::new(n, 1);
    let mut checker = Checker::new(room.space(), room.world()).expect("a room");
    let segments = segments(&room, &mut checker, if o.quick { 400 } else { 10_000 });
    let free: Vec<&Segment> = segments.iter().filter(|s| s.is_free).collect();
    let passes = if o.quick { 2 } else { 3 };
    let before = checker.work();
    for s in &free {
        black_box(checker.is_free(&s.ends[0], &s.ends[1]).expect("a segment"));
    }
    let calls = (checker.work().queries - before.queries) as f64 / free.len() as f64;
    let ours = time(&segments, passes, |s| {
        checker.is_free(&s.ends[0], &s.ends[1]).expect("a segment")
    });
    println!("{scene}: {} of {} segments free", free.len(), segments.len());
    let line = |name: &str, wrong: usize, calls: f64, [free, blocked]: [f64; 2]| {
        println!(
            "  {name:<12}{wrong:>7}{calls:>10.2}{:>10.2}{:>7.3}{:>10.2}",
            free / 1000.0,
            ours[0] / free,
            blocked / 1000.0
        );
    };
    println!(
        "  {:<12}{:>7}{:>10}{:>10}{:>7}{:>10}",
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

/// Searches through the room of 150 hulls, corner to corner, by seed.
fn search(o: &Options, rows: &mut Rows) {
    let room = Room::new(150, 3);
    let seeds = if o.quick { 5 } else { 50 };
    let mut times: Vec<f64> = Vec::new();
    let (mut queries, mut found) = (0, 0);
    for seed in 0..seeds {
        let mut checker = Checker::new(room.space(), room.world()).expect("a room");
        let corner = |side: f64| RigidSpace::configuration(&Isometry3::translation(side * 5.0, side * 5.0, side * 5.0));
        let options = PlanOptions {
            seed,
            slices: 200,
            ..PlanOptions::default()
        };
        let began = ThreadTime::now();
        let plan = checker
            .plan(&corner(-1.0), &corner(1.0), &options)
            .expect("corners are free");
        times.push(began.elapsed().as_nanos() as f64);
        queries += plan.work.checks.queries + plan.work.checks.measures;
        found += u32::from(plan.path.is_some());
    }
    let typical = median(&mut times);
    let worst = times[times.len() - 1];
    println!(
        "search: {found} of {seeds} seeds, {:.2} ms median, {:.2} ms at most, {} distance queries on average",
        typical / 1e6,
        worst / 1e6,
        queries / seeds
    );
    rows.push(("search", "median", 150), "opportunistic", typical, 0);
    rows.push(("search", "worst", 150), "opportunistic", worst, 0);
}

pub(crate) fn run(o: &Options) -> Rows {
    println!(
        "a segment of up to 1.6 and 1.6 radians: segments called free that are not, distance calls a free segment, microseconds,\n\
         ratio of the certified time to that of the steps.\n"
    );
    let mut rows = Rows::new();
    let progress = Progress::new("race plan", SCENES.len() as u64);
    for (scene, n) in [("room-40", 40), ("room-150", 150)] {
        if o.wants(scene) {
            room(o, scene, n, &mut rows);
        }
        progress.step();
    }
    if o.wants("search") {
        search(o, &mut rows);
    }
    rows
}
