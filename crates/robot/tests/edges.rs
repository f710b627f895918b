//! Promise: `is_free`, which tests configurations before it proves, has the verdict of `certify`; what is free is free at every
//! place, and what is blocked has a configuration in contact.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, Mesh, Shape};
use lin_canny_plan::{
    Cell, CellBody, Checker, ConfigurationSpace, Drive, JointKind, JointMotion, JointTree, TreeJoint, Verdict,
};
use lin_canny_robot::{LoadedCell, RobotFiles};
use truth::plans::{Ask, Furnish, cuboid};
use truth::rng::Rng;

/// A configuration in contact is at most this far from a contact, in metres: the pose of a configuration and that of a segment
/// differ by rounding.
const ROUNDING: f64 = 1e-9;

fn random_isometry(rng: &mut Rng, far: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
    let place = Point3::from([0, 1, 2].map(|_| rng.range(-far, far)));
    Isometry3::from_parts(Translation3::from(place), turn)
}

/// Returns a checker of a robot among boxes, cylinders and balls of a fifth of its size.
fn among_obstacles(file: &Path, srdf: Option<PathBuf>, rng: &mut Rng) -> Checker<JointTree> {
    let mut files = RobotFiles::new(file);
    files.srdf = srdf;
    let LoadedCell { cell: setup, .. } = files.load().expect("a robot");
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let size = 0.12 * checker.space().scales().iter().copied().fold(0.1, f64::max);
    add_obstacles(&mut checker, size, rng);
    checker
}

/// Adds boxes, cylinders and balls.
fn add_obstacles(checker: &mut Checker<JointTree>, size: f64, rng: &mut Rng) {
    for k in 0..8 {
        let geometry: Geometry = match k % 3 {
            0 => cuboid([size, 0.6 * size, 0.3 * size]).into(),
            1 => Shape::cylinder(size, 0.3 * size).expect("a cylinder").into(),
            _ => Shape::ball(0.5 * size).expect("a ball").into(),
        };
        let at = random_isometry(rng, 6.0 * size);
        checker.cell_mut().put(format!("obstacle {k}"), geometry, at);
    }
}

/// Returns a checker of a random robot among obstacles: a chain or a tree of turns and slides, some of which mimic others, with
/// bodies of all kinds.
fn by_program(rng: &mut Rng, size: f64, seed: u64) -> Checker<JointTree> {
    let count = 2 + rng.below(7);
    let coordinates = count - rng.below(2);
    let joint = |index: usize, rng: &mut Rng| {
        let kind = if rng.below(4) == 0 {
            JointKind::Prismatic
        } else {
            JointKind::Revolute
        };
        let unit = if kind == JointKind::Prismatic { 0.1 * size } else { 1.0 };
        TreeJoint {
            parent: if rng.below(6) == 0 { rng.below(index + 1) } else { index },
            kind,
            origin: random_isometry(rng, 0.3 * size),
            axis: Unit::new_normalize(rng.unit().into()),
            drive: Some(Drive {
                coordinate: index % coordinates,
                factor: unit * if index < coordinates { 1.0 } else { rng.range(-1.5, 1.5) },
                offset: 0.0,
            }),
        }
    };
    let joints: Vec<TreeJoint> = (0..count).map(|k| joint(k, rng)).collect();
    let mut cell = Cell::new();
    for k in 0..count {
        let half = Vector3::from_fn(|_, _| size * rng.range(0.03, 0.15));
        let hull = || solids::random_hull(20, half, seed + k as u64).expect("a hull");
        let body: Geometry = match rng.below(5) {
            0 => Shape::capsule(half.x, half.y).expect("a capsule").into(),
            1 => Shape::cylinder(half.x, half.y).expect("a cylinder").into(),
            2 => solids::cuboid(half).expect("a box").into(),
            3 => Mesh::from_convex(&hull()).expect("a mesh").into(),
            _ => hull().into(),
        };
        cell.robot_body(format!("body {k}"), body);
    }
    cell.exclude_if(|pair| match (pair.a, pair.b) {
        (CellBody::Robot(a), CellBody::Robot(b)) => joints[b].parent == a + 1,
        _ => false,
    });
    let (limits, radii) = (vec![[-2.5, 2.5]; coordinates], vec![0.3 * size; count + 1]);
    let tree = JointTree::new(Isometry3::identity(), joints, limits, (1..=count).collect(), radii);
    let mut checker = Checker::new(tree.expect("a tree"), cell).expect("a robot");
    add_obstacles(&mut checker, 0.2 * size, rng);
    checker
}

/// Judges random segments: short and long, from configurations that are free and others. Returns the numbers of segments that are
/// free, blocked and undecided; so many of the free ones are tested at `places` configurations.
fn judged(
    checker: &mut Checker<JointTree>,
    edges: u32,
    tested: u32,
    places: u32,
    rounding: f64,
    rng: &mut Rng,
) -> [u32; 3] {
    let mut counts = [0; 3];
    let bounds = checker.space().bounds().to_vec();
    let mut here = checker.space().sample(&mut || rng.range(0.0, 1.0));
    for k in 0..edges {
        let there: Vec<f64> = if k % 4 == 0 {
            checker.space().sample(&mut || rng.range(0.0, 1.0))
        } else {
            let far = [0.02, 0.2, 1.0][rng.below(3)];
            let each = here.iter().zip(&bounds);
            each.map(|(x, [low, high])| (x + rng.range(-far, far)).clamp(*low, *high))
                .collect()
        };
        let free = checker
            .is_free(&JointMotion::segment(&here, &there))
            .expect("a segment");
        let verdict = checker.verdict_of(&JointMotion::segment(&here, &there));
        let at = |t: f64| -> Vec<f64> { here.iter().zip(&there).map(|(a, b)| a + t * (b - a)).collect() };
        match verdict {
            Verdict::Free { .. } => {
                assert!(free, "{here:?} {there:?}");
                for _ in 0..if counts[0] < tested { places } else { 0 } {
                    let q = at(rng.range(0.0, 1.0));
                    assert!(
                        checker.is_free_at(&q).expect("a configuration"),
                        "{here:?} {there:?} {q:?}"
                    );
                }
                counts[0] += 1;
            }
            Verdict::Blocked { contact_at: t, .. } => {
                assert!(!free, "{here:?} {there:?}");
                let q = at(t);
                let near = checker.clearance(&q).expect("a configuration").expect("a pair");
                assert!(near.lower <= rounding, "{here:?} {there:?} {t} {near:?}");
                counts[1] += 1;
            }
            // Within rounding of contact either verdict is right.
            _ => counts[2] += 1,
        }
        // Half of the segments begin at a configuration that is known to be free.
        if matches!(verdict, Verdict::Free { .. }) || k % 2 == 0 {
            here = there;
        }
    }
    counts
}

#[test]
fn segments_of_the_example_have_one_verdict() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let (mut all, mut rng) = ([0; 3], Rng::new(74));
    for _ in 0..4 {
        let mut checker = among_obstacles(
            &examples.join("six_axis.urdf"),
            Some(examples.join("six_axis.srdf")),
            &mut rng,
        );
        let counts = judged(&mut checker, 2500, 125, 100, ROUNDING, &mut rng);
        counts.iter().zip(&mut all).for_each(|(count, all)| *all += count);
    }
    println!("free, blocked, undecided: {all:?}");
    assert!(all[0] > 1000 && all[1] > 1000 && all[2] < 10, "{all:?}");
}

fn robots_by_program(robots: u64, edges: u32, seed: u64) -> [u32; 3] {
    let mut all = [0; 3];
    for k in 0..robots {
        let (size, mut rng) = ([1.0, 1e-6, 1e6][(k % 3) as usize], Rng::new(seed + k));
        let mut checker = by_program(&mut rng, size, seed + k);
        let counts = judged(&mut checker, edges, edges / 20, 50, ROUNDING * size, &mut rng);
        counts.iter().zip(&mut all).for_each(|(count, all)| *all += count);
    }
    all
}

#[test]
fn segments_of_robots_by_program_have_one_verdict() {
    let all = robots_by_program(60, 50, 7400);
    println!("free, blocked, undecided: {all:?}");
    assert!(all[0] > 300 && all[1] > 300 && all[2] < 10, "{all:?}");
}

#[test]
#[ignore = "minutes: cargo test --release -p lin-canny-robot --test edges by_program -- --ignored --nocapture"]
fn segments_of_five_thousand_robots_by_program_have_one_verdict() {
    println!("free, blocked, undecided: {:?}", robots_by_program(5000, 50, 740_000));
}

/// `LIN_CANNY_EDGES` names files separated by `:`, a URDF or a URDF and an SRDF joined by `,`. Each robot has 250,000 segments in
/// 50 worlds; 12,500 free ones are tested at 1,000 places.
#[test]
#[ignore = "minutes a robot: LIN_CANNY_EDGES=panda.urdf,panda.srdf cargo test --release -p lin-canny-robot --test edges -- --ignored --nocapture"]
fn a_million_segments_have_one_verdict() {
    let files = std::env::var("LIN_CANNY_EDGES").expect("LIN_CANNY_EDGES names URDF files");
    for (number, file) in files.split(':').enumerate() {
        let (mut all, mut rng) = ([0; 3], Rng::new(740 + number as u64));
        let (urdf, srdf) = file
            .split_once(',')
            .map_or((file, None), |(urdf, srdf)| (urdf, Some(PathBuf::from(srdf))));
        for _ in 0..50 {
            let mut checker = among_obstacles(Path::new(urdf), srdf.clone(), &mut rng);
            let counts = judged(&mut checker, 5000, 250, 1000, ROUNDING, &mut rng);
            counts.iter().zip(&mut all).for_each(|(count, all)| *all += count);
        }
        println!("{urdf}: free, blocked, undecided: {all:?}");
    }
}
