//! Trees with ball joints: segments, curves and ranges beside other kinematics, of matrices and Euler angles.

use core::ops::Range;

use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, PairTracker, RelativePose};
use lin_canny_plan::{
    Cell, CellBody, Checker, Drive, JointKind, JointMotion, JointTree, RangeOptions, RangeVerdict, TreeJoint, Verdict,
};
use truth::casts::rotation;
use truth::plans::{Ask, Furnish, bezier};
use truth::rng::Rng;

/// A joint as the judge knows it.
enum Foreign {
    Ball(usize),
    Turn(usize, Vector3<f64>),
    Slide(usize, Vector3<f64>),
}

/// A tree, and what the judge knows of it: for each body its parent body, the frame of its joint, and the joint.
struct Robot {
    checker: Checker<JointTree>,
    bodies: Vec<(Option<usize>, Isometry3<f64>, Foreign, ConvexPolyhedron)>,
    obstacles: Vec<(ConvexPolyhedron, Isometry3<f64>)>,
    coordinates: usize,
}

impl Robot {
    fn random(rng: &mut Rng) -> Self {
        let (mut joints, mut limits, mut links, mut bodies) = (vec![], vec![], vec![], vec![]);
        let mut cell = Cell::new();
        for k in 0..2 + rng.below(4) {
            let parent = (k > 0).then(|| rng.below(k));
            let link = parent.map_or(0, |body| links[body]);
            let far = if k == 0 { 0.0 } else { 0.5 };
            let origin = Isometry3::from_parts((far * Vector3::from(rng.unit())).into(), rotation(rng));
            let (first, coordinate) = (joints.len(), limits.len());
            let axis = lin_canny::nalgebra::Unit::new_normalize(Vector3::from(rng.unit()));
            let foreign = match rng.below(if k == 0 { 1 } else { 4 }) {
                0 | 1 => {
                    joints.extend(TreeJoint::ball(first, link, origin, coordinate));
                    limits.extend([[-4.0, 4.0]; 3]);
                    Foreign::Ball(coordinate)
                }
                which => {
                    let kind = [JointKind::Revolute, JointKind::Prismatic][which - 2];
                    let drive = Some(Drive::by(coordinate));
                    joints.push(TreeJoint {
                        parent: link,
                        kind,
                        origin,
                        axis,
                        drive,
                    });
                    limits.push([-4.0, 4.0]);
                    match kind {
                        JointKind::Revolute => Foreign::Turn(coordinate, axis.into_inner()),
                        _ => Foreign::Slide(coordinate, axis.into_inner()),
                    }
                }
            };
            links.push(joints.len());
            let half = Vector3::new(rng.range(0.05, 0.3), rng.range(0.02, 0.1), rng.range(0.02, 0.1));
            let shift = Isometry3::translation(half.x, 0.0, 0.0);
            let body = solids::cuboid(half).expect("a box").transformed(&shift).expect("a box");
            cell.robot_body(format!("link {k}"), body.clone());
            if let Some(parent) = parent {
                cell.exclude(&format!("link {parent}"), &format!("link {k}"))
                    .expect("a pair");
            }
            bodies.push((parent, origin, foreign, body));
        }
        let mut obstacles = vec![];
        for k in 0..3 {
            let half = Vector3::new(rng.range(0.05, 0.4), rng.range(0.05, 0.4), rng.range(0.05, 0.4));
            let body = solids::cuboid(half).expect("a box");
            let place = rng.range(0.4, 1.6) * Vector3::from(rng.unit());
            let pose = Isometry3::from_parts(place.into(), rotation(rng));
            cell.put(format!("box {k}"), body.clone(), pose);
            obstacles.push((body, pose));
        }
        let (coordinates, radii) = (limits.len(), vec![0.6; joints.len() + 1]);
        let tree = JointTree::new(Isometry3::identity(), joints, limits, links, radii).expect("a tree");
        Self {
            checker: Checker::new(tree, cell).expect("a world"),
            bodies,
            obstacles,
            coordinates,
        }
    }

    /// The poses of the bodies, by the judge's kinematics.
    fn poses(&self, q: &[f64]) -> Vec<Isometry3<f64>> {
        let mut poses: Vec<Isometry3<f64>> = vec![];
        for (parent, origin, joint, _) in &self.bodies {
            let before = parent.map_or(Isometry3::identity(), |parent| poses[parent]) * origin;
            poses.push(match joint {
                Foreign::Ball(k) => before * UnitQuaternion::from_euler_angles(q[*k], q[k + 1], q[k + 2]),
                Foreign::Turn(k, axis) => before * UnitQuaternion::from_scaled_axis(axis * q[*k]),
                Foreign::Slide(k, axis) => {
                    before * Isometry3::translation(axis.x * q[*k], axis.y * q[*k], axis.z * q[*k])
                }
            });
        }
        poses
    }

    /// The least distance over all pairs that are checked; 0 for an overlap.
    fn distance(&self, q: &[f64]) -> f64 {
        let poses = self.poses(q);
        let distance = |a: &ConvexPolyhedron, p: &Isometry3<f64>, b: &ConvexPolyhedron, r: &Isometry3<f64>| {
            let pose = RelativePose::new(p, r).expect("poses");
            PairTracker::new().closest(a, b, &pose).upper.max(0.0)
        };
        let mut least = f64::INFINITY;
        for (k, (_, _, _, body)) in self.bodies.iter().enumerate() {
            for (other, at) in &self.obstacles {
                least = least.min(distance(body, &poses[k], other, at));
            }
            for (j, (parent, _, _, other)) in self.bodies.iter().enumerate().skip(k + 1) {
                if *parent != Some(k) {
                    least = least.min(distance(body, &poses[k], other, &poses[j]));
                }
            }
        }
        least
    }
}

/// Judges a segment, a curve and a range of each of these trees; returns how many are free, blocked and undecided, and
/// of ranges how many pairs never meet, and how many others there are.
fn judged(trees: Range<u64>, places: u32) -> [u32; 5] {
    let mut counts = [0; 5];
    for seed in trees {
        let mut rng = Rng::new(seed);
        let mut robot = Robot::random(&mut rng);
        let reach = [0.2, 1.0, 3.0][(seed % 3) as usize];
        let row = |rng: &mut Rng, around: &[f64], by: f64| -> Vec<f64> {
            around
                .iter()
                .map(|x| (x + rng.range(-by, by)).clamp(-4.0, 4.0))
                .collect()
        };
        // The pitch is often a quarter turn, where roll and yaw are one.
        let mut from = row(&mut rng, &vec![0.0; robot.coordinates], 3.0);
        if seed % 5 == 0 {
            from[1] = core::f64::consts::FRAC_PI_2;
        }
        let rows: Vec<Vec<f64>> = core::iter::once(from.clone())
            .chain((0..3).map(|_| row(&mut rng, &from, reach)))
            .collect();
        let poses = robot.poses(&from);
        for (k, pose) in poses.iter().enumerate() {
            let found = robot.checker.pose(CellBody::Robot(k), &from).expect("a pose");
            let off = (found.to_homogeneous() - pose.to_homogeneous()).amax();
            assert!(off < 1e-13, "{seed}");
        }
        let curve = bezier(&rows);
        let line = |t: f64| -> Vec<f64> { from.iter().zip(&rows[1]).map(|(a, b)| a + (b - a) * t).collect() };
        for (motion, at) in [
            (
                JointMotion::segment(&rows[0], &rows[1]),
                &line as &dyn Fn(f64) -> Vec<f64>,
            ),
            (JointMotion::curve(&curve), &|t| curve.at(t)),
        ] {
            let verdict = robot.checker.verdict_of(&motion);
            let until = verdict.free_until();
            match verdict {
                Verdict::Free { .. } => counts[0] += 1,
                Verdict::Blocked { contact_at, .. } => {
                    counts[1] += 1;
                    assert!(robot.distance(&at(contact_at)) < 1e-11, "{seed}: {verdict:?}");
                }
                _ => counts[2] += 1,
            }
            // A blocked motion may begin in contact.
            for k in (0..=places).filter(|_| until > 0.0) {
                let t = until * f64::from(k) / f64::from(places);
                assert!(robot.distance(&at(t)) > 0.0, "{seed}: contact at {t}, {verdict:?}");
            }
        }
        let half = rng.range(0.01, 0.2);
        let [low, high] = [-half, half].map(|by| from.iter().map(|x| (x + by).clamp(-4.0, 4.0)).collect::<Vec<f64>>());
        let options = RangeOptions::default().cells(100);
        let answers = robot.checker.answers_over(&options, &low, &high);
        let never = answers
            .iter()
            .filter(|answer| answer.verdict == RangeVerdict::Never)
            .count();
        counts[3] += never as u32;
        counts[4] += (answers.len() - never) as u32;
        let least = answers.iter().map(|answer| answer.lower).fold(f64::INFINITY, f64::min);
        for _ in 0..places {
            let q: Vec<f64> = low.iter().zip(&high).map(|(a, b)| rng.range(*a, *b)).collect();
            let found = robot.distance(&q);
            assert!(found + 1e-12 > least, "{seed}: {found} below {least} at {q:?}");
            assert!(never < answers.len() || found > 0.0, "{seed}: contact at {q:?}");
        }
    }
    counts
}

#[test]
fn trees_with_ball_joints_are_as_other_kinematics_say() {
    let counts = judged(0..50, 40);
    println!("free, blocked, undecided; pairs that never meet, others: {counts:?}");
    assert!(
        counts[0] > 10 && counts[1] > 10 && counts[2] == 0 && counts[3] > 100,
        "{counts:?}"
    );
}

#[test]
#[ignore = "5,000 trees: cargo test --release -p lin-canny-plan --test plan five_thousand_trees -- --ignored --nocapture"]
fn five_thousand_trees_with_ball_joints_are_as_other_kinematics_say() {
    let counts = judged(crate::chosen_robots(0..5_000), 400);
    println!("free, blocked, undecided; pairs that never meet, others: {counts:?}");
}
