//! `race clouds`: clouds of points beside a k-d tree of the same points, in nanoseconds of thread
//! CPU time.
//!
//! The points are those of a depth camera in `f32`: a floor, a wall and three balls, with noise of
//! a millimetre. Each point is a ball of 2 mm. The other body is a hull of 32 vertices with a
//! radius of 0.1, or a ball of this radius. It moves on a circle by half a degree (4 mm) per frame:
//! `near` the floor and into the balls, `close` above them, or `far` from them. `n` is the number
//! of points.
//!
//! - `build`: the tree of all points.
//! - `replace`: a six-axis arm in its cell gets a new cloud of the camera. Converts the points,
//!   builds their tree, replaces the obstacle, and asks for the clearance.
//! - `tracked-0.5`: closest points, with the state of the last frame; for the k-d tree, the
//!   distance without state.
//! - `cold`: closest points without any state.
//! - `within`: whether the body is within 0, 0.02 or 0.1. `ours` keeps its state, `ours-cold` does
//!   not.
//!
//! The k-d tree is kiddo's. It knows points and balls only. For a hull, it returns all points near
//! the middle of the hull that may matter, and our tracker of two polyhedra measures each of them.
//! All points in double precision are the judge (`wrong`): of verdicts at the three distances and a
//! millionth beside the true one, and of distances off by more than 1e-9.

use std::hint::black_box;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::{Cloud, CloudElement, ConvexPolyhedron, Geometry, PairTracker, RelativePose, Shape, Tracker};
use lin_canny_plan::Checker;
use race::common::{Options, Rows};
use race::progress::Progress;
use truth::rng::Rng;

use crate::curves::arm_in_cell;
use crate::meshes::time;

pub(crate) const SCENES: [&str; 5] = ["build", "replace", "tracked-0.5", "cold", "within"];

/// Frames of a full circle.
const FRAMES: usize = 720;

/// Number of frames from one judged frame to the next.
const JUDGED: usize = 12;

/// Radius of the balls at the points, and of the other body.
const POINT: f64 = 0.002;
const BODY: f64 = 0.1;

/// Heights of the circle.
const HEIGHTS: [(&str, f64); 3] = [("near", 0.22), ("close", 0.6), ("far", 2.0)];

const DISTANCES: [f64; 3] = [0.0, 0.02, 0.1];

/// Returns what a depth camera sees.
fn camera(n: usize) -> Vec<[f32; 3]> {
    let mut rng = Rng::new(3);
    let balls = [[0.5, 0.3, 0.2], [-0.4, 0.5, 0.15], [-0.2, -0.5, 0.25]];
    let mut seen = |k: usize| {
        let p = match k % 4 {
            0 | 1 => [rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), 0.0],
            2 => {
                let (ball, u) = (balls[rng.below(3)], rng.unit());
                [0, 1, 2].map(|i| ball[i] + u[i] * ball[2])
            }
            _ => [rng.range(-1.0, 1.0), 1.0, rng.range(0.0, 1.0)],
        };
        p.map(|x| (x + rng.range(-0.001, 0.001)) as f32)
    };
    (0..n).map(&mut seen).collect()
}

/// Returns the poses of a circle at a height.
fn circle(height: f64) -> Vec<Isometry3<f64>> {
    let pose = |k: usize| {
        let a = (0.5 * k as f64).to_radians();
        let at = Vector3::new(0.45 * a.cos(), 0.45 * a.sin(), height + 0.1 * (0.7 * a).sin());
        Isometry3::from_parts(
            Translation3::from(at),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), a),
        )
    };
    (0..FRAMES).map(pose).collect()
}

/// The body over the cloud.
struct Over {
    name: &'static str,
    ours: Geometry,
    /// The hull, or the middle of the ball.
    core: ConvexPolyhedron,
    /// Radius around the core, and of the core.
    radius: f64,
    reach: f64,
}

/// Returns the polyhedron of a point.
fn point() -> ConvexPolyhedron {
    ConvexPolyhedron::point(Point3::origin()).expect("a point")
}

fn bodies() -> [Over; 2] {
    let mut rng = Rng::new(11);
    let points: Vec<_> = (0..32).map(|_| Point3::from(rng.unit().map(|x| x * BODY))).collect();
    let hull = ConvexPolyhedron::from_points(&points).expect("a hull");
    let hull = Over {
        name: "hull",
        ours: hull.clone().into(),
        core: hull,
        radius: 0.0,
        reach: BODY,
    };
    let ball = Over {
        name: "ball",
        ours: Shape::ball(BODY).expect("a ball").into(),
        core: point(),
        radius: BODY,
        reach: 0.0,
    };
    [hull, ball]
}

/// The same points for each engine.
struct Points {
    points: Vec<[f32; 3]>,
    cloud: Geometry,
    tree: ImmutableKdTree<f32, 3>,
    origin: ConvexPolyhedron,
}

fn cloud(points: &[[f32; 3]]) -> Cloud {
    Cloud::from_f32(points, CloudElement::Ball(POINT)).expect("finite points")
}

fn tree(points: &[[f32; 3]]) -> ImmutableKdTree<f32, 3> {
    ImmutableKdTree::new_from_slice(points).expect("finite points")
}

impl Points {
    /// Returns the pose of a body from a point.
    fn pose_at_point(&self, k: usize, at: &Isometry3<f64>) -> RelativePose {
        let [x, y, z] = self.points[k].map(f64::from);
        RelativePose::new(&Isometry3::translation(x, y, z), at).expect("rigid")
    }

    /// Returns the points within a distance of the middle of a body, by the k-d tree.
    fn around(&self, at: &Isometry3<f64>, reach: f64) -> impl Iterator<Item = usize> {
        let found = self
            .tree
            .query(&middle(at))
            .within::<SquaredEuclidean<f32>>((reach * reach) as f32)
            .unsorted()
            .execute();
        found.into_iter().map(|point| point.item as usize)
    }

    /// Returns the distance of a body from the balls at the points, by the k-d tree.
    fn distance(&self, over: &Over, at: &Isometry3<f64>, tracker: &mut Tracker) -> f64 {
        let radii = over.radius + POINT;
        let nearest = self
            .tree
            .query(&middle(at))
            .nearest_one::<SquaredEuclidean<f32>>()
            .execute();
        let mut measure = |k: usize| {
            tracker
                .distance(&self.origin, &over.core, &self.pose_at_point(k, at))
                .value
        };
        let mut least = measure(nearest.item as usize);
        // A point that is nearer lies within this of the middle. The factor covers `f32`.
        for k in self.around(at, (least.max(0.0) + over.reach) * (1.0 + 1e-6)) {
            if least <= radii {
                break;
            }
            least = least.min(measure(k));
        }
        (least - radii).max(0.0)
    }

    /// Returns whether a body is within `d` of the balls at the points, by the k-d tree.
    fn within(&self, over: &Over, at: &Isometry3<f64>, d: f64, tracker: &mut Tracker) -> bool {
        let most = d + over.radius + POINT;
        if over.reach == 0.0 {
            let nearest = self
                .tree
                .query(&middle(at))
                .nearest_one::<SquaredEuclidean<f32>>()
                .execute();
            return nearest.distance <= (most * most) as f32;
        }
        self.around(at, most + over.reach)
            .any(|k| tracker.within(&self.origin, &over.core, &self.pose_at_point(k, at), most))
    }

    /// Returns bounds of the distance of a body, over all points.
    fn truth(&self, over: &Over, at: &Isometry3<f64>) -> (f64, f64) {
        let centre = at.translation.vector;
        let from_middle = |p: &[f32; 3]| (Vector3::from(p.map(f64::from)) - centre).norm();
        let least = self.points.iter().map(from_middle).fold(f64::INFINITY, f64::min);
        let radii = over.radius + POINT;
        if over.reach == 0.0 {
            return (least - radii - 1e-12, least - radii + 1e-12);
        }
        let (mut tracker, mut bounds) = (Tracker::new(), (f64::INFINITY, f64::INFINITY));
        for (k, p) in self.points.iter().enumerate() {
            if from_middle(p) > least + 2.0 * over.reach {
                continue;
            }
            let found = tracker.distance(&self.origin, &over.core, &self.pose_at_point(k, at));
            bounds = (bounds.0.min(found.lower), bounds.1.min(found.upper));
        }
        (bounds.0 - radii - 1e-14, bounds.1 - radii + 1e-14)
    }
}

fn middle(at: &Isometry3<f64>) -> [f32; 3] {
    let [x, y, z] = at.translation.vector.into();
    [x as f32, y as f32, z as f32]
}

fn poses(all: &[Isometry3<f64>]) -> Vec<RelativePose> {
    let pose = |at| RelativePose::from_isometry(at).expect("rigid");
    all.iter().map(pose).collect()
}

/// Prints a result, and adds it to the table.
fn note(rows: &mut Rows, scene: &str, shape: &str, n: usize, results: &[(&str, f64)]) {
    print!("{scene:<12}{shape:<16}{n:>8}");
    for (engine, ns) in results {
        print!("  {engine} {ns:.0}");
        rows.push((scene, shape, n), engine, *ns, 0);
    }
    println!();
}

/// Races all sizes of clouds.
pub(crate) fn run(options: &Options) -> Rows {
    let mut rows = Rows::default();
    let bodies = bodies();
    for n in options.sizes([1_000, 20_000, 100_000, 1_000_000]) {
        let points = camera(n);
        if options.wants("build") {
            let ours = time(1, |_| {
                black_box(cloud(&points));
            });
            let kiddo = time(1, |_| {
                black_box(tree(&points));
            });
            note(&mut rows, "build", "camera", n, &[("ours", ours), ("kiddo", kiddo)]);
        }
        if options.wants("replace") {
            let ours = replace(&points);
            note(&mut rows, "replace", "camera", n, &[("ours", ours)]);
        }
        let all = Points {
            cloud: cloud(&points).into(),
            tree: tree(&points),
            points,
            origin: point(),
        };
        for (place, height) in HEIGHTS {
            let circle = circle(height);
            if options.wants("tracked-0.5") || options.wants("cold") {
                closest(&mut rows, options, &all, &bodies[0], place, &circle);
            }
            if options.wants("within") {
                for over in &bodies {
                    within(&mut rows, &all, over, place, &circle);
                }
            }
        }
    }
    rows
}

/// Returns the nanoseconds of a new cloud in the cell of an arm, up to the clearance.
fn replace(points: &[[f32; 3]]) -> f64 {
    let (space, cell) = arm_in_cell().expect("the arm");
    let mut checker = Checker::new(space, cell).expect("a world");
    let aside = Isometry3::translation(2.0, 0.0, 0.0);
    checker
        .cell_mut()
        .add_obstacle("scan", cloud(points), aside)
        .expect("an obstacle");
    let q = [0.3, 0.2, 0.4, 0.1, 0.2, 0.0];
    time(10, |_| {
        checker
            .cell_mut()
            .replace_obstacle("scan", cloud(points))
            .expect("the obstacle");
        black_box(checker.clearance(&q).expect("a configuration"));
    })
}

/// Races the closest points of the hull.
fn closest(rows: &mut Rows, options: &Options, all: &Points, over: &Over, place: &str, at: &[Isometry3<f64>]) {
    let (n, pose, shape) = (all.points.len(), poses(at), format!("{}-{place}", over.name));
    let progress = Progress::new(&format!("closest {shape} {n}"), 4);
    let mut warm = PairTracker::new();
    let tracked = time(FRAMES, |k| {
        black_box(warm.closest(&all.cloud, &over.ours, &pose[k]));
    });
    progress.step();
    let cold = time(FRAMES, |k| {
        black_box(PairTracker::new().closest(&all.cloud, &over.ours, &pose[k]));
    });
    progress.step();
    let mut tracker = Tracker::new();
    let kiddo = time(FRAMES, |k| {
        black_box(all.distance(over, &at[k], &mut tracker));
    });
    progress.step();
    let mut wrong = [0u32; 2];
    for k in (0..FRAMES).step_by(JUDGED) {
        let (lower, upper) = all.truth(over, &at[k]);
        let answers = [
            PairTracker::new().closest(&all.cloud, &over.ours, &pose[k]).distance,
            all.distance(over, &at[k], &mut tracker),
        ];
        for (wrong, d) in wrong.iter_mut().zip(answers) {
            *wrong += u32::from(d < lower.max(0.0) - 1e-9 || d > upper.max(0.0) + 1e-9);
        }
    }
    drop(progress);
    let wrong = wrong.map(f64::from);
    if options.wants("tracked-0.5") {
        note(rows, "tracked-0.5", &shape, n, &[("ours", tracked), ("kiddo", kiddo)]);
    }
    if options.wants("cold") {
        let results = [
            ("ours", cold),
            ("kiddo", kiddo),
            ("ours-wrong", wrong[0]),
            ("kiddo-wrong", wrong[1]),
        ];
        note(rows, "cold", &shape, n, &results);
    }
}

/// Races the predicate.
fn within(rows: &mut Rows, all: &Points, over: &Over, place: &str, at: &[Isometry3<f64>]) {
    let (n, pose) = (all.points.len(), poses(at));
    let truths: Vec<_> = at.iter().step_by(JUDGED).map(|at| all.truth(over, at)).collect();
    let mut tracker = Tracker::new();
    for d in DISTANCES {
        let shape = format!("{}-{place}-{d}", over.name);
        let mut warm = PairTracker::new();
        let ours = time(FRAMES, |k| {
            black_box(warm.within(&all.cloud, &over.ours, &pose[k], d));
        });
        let cold = time(FRAMES, |k| {
            black_box(PairTracker::new().within(&all.cloud, &over.ours, &pose[k], d));
        });
        let kiddo = time(FRAMES, |k| {
            black_box(all.within(over, &at[k], d, &mut tracker));
        });
        let mut wrong = [0u32; 2];
        for ((lower, upper), k) in truths.iter().zip((0..).step_by(JUDGED)) {
            for d in [d, lower * (1.0 - 1e-6), upper * (1.0 + 1e-6)] {
                if d < 0.0 || (*lower..*upper).contains(&d) {
                    continue;
                }
                let answers = [
                    warm.within(&all.cloud, &over.ours, &pose[k], d),
                    all.within(over, &at[k], d, &mut tracker),
                ];
                for (wrong, answer) in wrong.iter_mut().zip(answers) {
                    *wrong += u32::from(answer != (d >= *upper));
                }
            }
        }
        let [wrong, theirs] = wrong.map(f64::from);
        let results = [
            ("ours", ours),
            ("ours-cold", cold),
            ("kiddo", kiddo),
            ("ours-wrong", wrong),
            ("kiddo-wrong", theirs),
        ];
        note(rows, "within", &shape, n, &results);
    }
}
