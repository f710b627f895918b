//! Writes the recordings of `crates/record/examples/`, or a large one.
//!
//! ```text
//! cargo run --release -p lin-canny-record --example recordings -- crates/record/examples
//! cargo run --release -p lin-canny-record --example recordings -- FOLDER --many BODIES FRAMES
//! ```

use std::error::Error;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{Compound, Geometry, ManifoldOptions, Mesh, PairTracker, Piece, RelativePose, Shape, Velocity, impact};
use lin_canny_record::{Bracket, ColumnLine, Recorder};

type Trouble = Box<dyn Error>;

/// Write the recordings of crates/record/examples, or a large one, to a folder
#[derive(Parser)]
struct Options {
    /// Output folder
    folder: PathBuf,
    /// Numbers of bodies and frames of one large recording, which replaces the others
    #[arg(long, num_args = 2, value_names = ["BODIES", "FRAMES"])]
    many: Vec<usize>,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(Options { folder, many }: &Options) -> Result<(), Trouble> {
    if let [bodies, frames] = many[..] {
        return self::many(&folder.join(format!("many-{bodies}.jsonl")), bodies, frames);
    }
    pair(&folder.join("pair.jsonl"))?;
    kinds(&folder.join("kinds.jsonl"))?;
    pile(&folder.join("pile.jsonl"))?;
    cast(&folder.join("cast.jsonl"))
}

/// Two hulls pass each other and touch.
fn pair(file: &Path) -> Result<(), Trouble> {
    let mut recorder = Recorder::create(file, "Two hulls pass each other")?;
    let hulls = [
        Geometry::from(solids::random_hull(28, Vector3::new(1.0, 0.8, 0.7), 7)?),
        Geometry::from(solids::random_hull(20, Vector3::new(0.6, 0.7, 0.5), 11)?),
    ];
    let still = Isometry3::identity();
    let a = recorder.body("still", &hulls[0], &still)?;
    let b = recorder.body("moved", &hulls[1], &still)?;
    let mut tracker = PairTracker::new();
    let place = |time: f64| Vector3::new(1.75 - 0.8 * time, -1.6 + 3.2 * time, 0.25);
    for frame in 0..120 {
        let time = f64::from(frame) / 119.0;
        let turn = UnitQuaternion::from_euler_angles(2.0 * time, 1.2 * time, 0.5);
        let pose = Isometry3::from_parts(Translation3::from(place(time)), turn);
        recorder.pose(b, &pose)?;
        let answer = tracker.closest(&hulls[0], &hulls[1], &RelativePose::new(&still, &pose)?);
        recorder.answer(a, b, &answer)?;
        recorder.path((0..24).map(|k| Point3::from(place(f64::from(k) / 23.0))));
        recorder.end_frame()?;
    }
    Ok(recorder.finish().map(|_| ())?)
}

/// A body of every kind around a ball that rises and sinks.
fn kinds(file: &Path) -> Result<(), Trouble> {
    let mut recorder = Recorder::create(file, "A body of every kind about a ball")?;
    let ball = Geometry::from(Shape::ball(0.45)?);
    let middle = recorder.body("ball", &ball, &Isometry3::identity())?;
    let mut bodies = Vec::new();
    let all = all_kinds()?;
    for (k, (name, geometry)) in all.iter().enumerate() {
        let angle = TAU * k as f64 / all.len() as f64;
        let place = Translation3::new(2.1 * angle.cos(), 2.1 * angle.sin(), 0.0);
        let pose = Isometry3::from_parts(place, UnitQuaternion::from_euler_angles(0.5, 0.3, angle));
        bodies.push((
            recorder.body(name, geometry, &pose)?,
            geometry,
            pose,
            PairTracker::new(),
        ));
    }
    for frame in 0..60 {
        let angle = TAU * f64::from(frame) / 60.0;
        let pose = Isometry3::translation(0.3 * angle.cos(), 0.3 * angle.sin(), 0.5 * angle.sin());
        recorder.pose(middle, &pose)?;
        for (body, geometry, at, tracker) in &mut bodies {
            let poses = RelativePose::new_normalized(&pose, at)?;
            recorder.answer(middle, *body, &tracker.closest(&ball, *geometry, &poses))?;
        }
        recorder.end_frame()?;
    }
    Ok(recorder.finish().map(|_| ())?)
}

fn all_kinds() -> Result<Vec<(&'static str, Geometry)>, Trouble> {
    let half = Vector3::new(0.5, 0.35, 0.25);
    let cube = solids::cuboid(half)?;
    let upright =
        solids::cuboid(Vector3::new(0.15, 0.15, 0.5))?.transformed(&Isometry3::translation(0.35, 0.0, 0.4))?;
    let pieces = vec![Piece::new(Shape::from(cube.clone())), Piece::new(Shape::from(upright))];
    let height = |k: usize, l: usize| if (k, l) == (1, 1) { 0.7 } else { -0.1 };
    let net: Vec<Point3<f64>> = (0..9)
        .map(|i| Point3::new((i / 3) as f64 - 1.0, (i % 3) as f64 - 1.0, height(i / 3, i % 3)) * 0.55)
        .collect();
    Ok(vec![
        ("polyhedron", solids::dodecahedron(0.55)?.into()),
        ("capsule", Shape::capsule(0.4, 0.25)?.into()),
        ("rounded box", Shape::cuboid(half)?.rounded(0.12)?.into()),
        ("cylinder", Shape::cylinder(0.5, 0.3)?.into()),
        ("cone", Shape::cone(0.5, 0.4)?.into()),
        ("ellipsoid", Shape::ellipsoid(Vector3::new(0.6, 0.4, 0.25))?.into()),
        ("compound", Compound::new(pieces)?.into()),
        ("mesh", Mesh::from_convex(&solids::geodesic_sphere(2, 0.5)?)?.into()),
        (
            "Bézier surface",
            BezierSurface::new(vec![BezierPatch::polynomial([2, 2], &net)?])?.into(),
        ),
        (
            "polygon",
            Geometry::from(lin_canny::ConvexPolyhedron::polygon(&[
                Point3::new(-0.5, -0.4, 0.0),
                Point3::new(0.5, -0.4, 0.0),
                Point3::new(0.0, 0.5, 0.0),
            ])?),
        ),
    ])
}

/// A tower of boxes on a floor, in a scene, with contacts and boxes of the broad phase.
fn pile(file: &Path) -> Result<(), Trouble> {
    let mut recorder = Recorder::create(file, "A tower of boxes settles on a floor")?;
    let mut scene = Scene::new();
    let queries = PairQueries::none().distance(0.05).features(true).depth(true);
    let all = Group::default();
    scene.set_queries(all, all, queries.manifold(ManifoldOptions::default().prediction(0.02)))?;
    scene.insert(
        Body::fixed(solids::cuboid(Vector3::new(2.0, 2.0, 0.1))?),
        Isometry3::translation(0.0, 0.0, -0.1),
    )?;
    let cube = Geometry::from(solids::cuboid(Vector3::new(0.4, 0.3, 0.2))?);
    let mut cubes = Vec::new();
    for k in 0..5u64 {
        cubes.push(scene.insert(Body::moving(cube.clone()).user_data(k + 1), Isometry3::identity())?);
    }
    for frame in 0..40 {
        let gap = 0.03 * (1.0 - f64::from(frame) / 20.0).max(-0.05);
        for (k, id) in cubes.iter().enumerate() {
            let k = k as f64;
            let place = Translation3::new(0.06 * k, 0.03 * k * k, 0.2 + (0.4 + gap) * k + gap);
            scene.set_pose(
                *id,
                Isometry3::from_parts(place, UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3 * k)),
            )?;
        }
        scene.step();
        for column in 0..2u32 {
            let x = -2.0 + 2.0 * f64::from(column);
            let listed = cubes.len() as u32;
            recorder.column(ColumnLine {
                axis: 2,
                lo: [x, -2.0],
                hi: [x + 2.0, 2.0],
                listed,
            });
        }
        recorder.note(format!("gap {gap:+.4}"));
        recorder.scene(&scene)?;
    }
    Ok(recorder.finish().map(|_| ())?)
}

/// A bar flies at a post: the bracket of the first contact.
fn cast(file: &Path) -> Result<(), Trouble> {
    let mut recorder = Recorder::create(file, "A turning bar meets a post: the bracket of the first contact")?;
    let post = Geometry::from(solids::prism(24, 1.0, 0.2)?);
    let bar = Geometry::from(solids::cuboid(Vector3::new(0.8, 0.1, 0.1))?);
    let (still, begin) = (Isometry3::identity(), Isometry3::translation(-3.0, 0.7, 0.2));
    let velocity = Velocity::new(Vector3::new(2.0, -0.15, 0.0), Vector3::new(0.0, 0.4, 2.5));
    let a = recorder.body("post", &post, &still)?;
    let b = recorder.body("bar", &bar, &begin)?;
    let mut tracker = PairTracker::new();
    let rest = Steady::new(&still, Velocity::new(Vector3::zeros(), Vector3::zeros()))?;
    let flight = Steady::new(&begin, velocity)?;
    let tolerance = impact::Tolerance::Time(0.05);
    let found = impact::cast(&mut tracker.pair(&post, &bar), &rest, &flight, 0.0..2.0, tolerance)?;
    for frame in 0..60 {
        let pose = velocity.applied(&begin, f64::from(frame) / 40.0);
        recorder.pose(b, &pose)?;
        recorder.answer(
            a,
            b,
            &tracker.closest(&post, &bar, &RelativePose::new_normalized(&still, &pose)?),
        )?;
        if let impact::Impact::Hit { safe, hit, .. } = found.impact {
            let at = |time| [still, velocity.applied(&begin, time)];
            recorder.bracket(Bracket {
                bodies: [a, b],
                safe,
                hit,
                at_safe: at(safe),
                at_hit: at(hit),
            })?;
            recorder.note(format!("apart until {safe:.4}, together at {hit:.4}"));
        }
        recorder.end_frame()?;
    }
    Ok(recorder.finish().map(|_| ())?)
}

/// A lattice of turning hulls, each watched with the next.
fn many(file: &Path, bodies: usize, frames: usize) -> Result<(), Trouble> {
    let mut recorder = Recorder::create(file, &format!("{bodies} bodies"))?;
    let shapes = (0..16u64)
        .map(|k| {
            Ok(Geometry::from(solids::random_hull(
                24,
                Vector3::new(0.5, 0.45, 0.4),
                k + 1,
            )?))
        })
        .collect::<Result<Vec<_>, Trouble>>()?;
    let side = (1..).find(|s| s * s * s >= bodies).unwrap_or(1);
    let middle = 0.5 * (side as f64 - 1.0);
    let pose = |k: usize, frame: usize| {
        let cell = [k % side, k / side % side, k / side / side].map(|i| 1.5 * (i as f64 - middle));
        let axis = Vector3::new(1.0, 0.6 * (k % 3) as f64, 0.4 * (k % 5) as f64).normalize();
        Isometry3::from_parts(
            Translation3::from(cell),
            UnitQuaternion::new(axis * (0.02 * frame as f64)),
        )
    };
    for k in 0..bodies {
        recorder.body(&format!("body {k}"), &shapes[k % shapes.len()], &pose(k, 0))?;
    }
    let mut trackers = vec![PairTracker::new(); bodies.saturating_sub(1)];
    for frame in 0..frames {
        for k in 0..bodies {
            recorder.pose(k as u32, &pose(k, frame))?;
        }
        // Pairs of all bodies of small recordings, of the first hundred of large ones.
        for (k, tracker) in trackers.iter_mut().enumerate().take(99) {
            let poses = RelativePose::new_normalized(&pose(k, frame), &pose(k + 1, frame))?;
            let [a, b] = [k, k + 1].map(|i| &shapes[i % shapes.len()]);
            recorder.answer(k as u32, k as u32 + 1, &tracker.closest(a, b, &poses))?;
        }
        recorder.end_frame()?;
    }
    Ok(recorder.finish().map(|_| ())?)
}
