//! Motions of configuration spaces keep the contract of `Motion`, and gradients are derivatives.

use lin_canny::motion::MotionModel;
use lin_canny::nalgebra::{Isometry3, Point3, Unit, Vector3};
use lin_canny_plan::{
    ConfigurationSpace, Drive, Joint, JointKind, JointTree, PlanarSpace, RigidSpace, SegmentMotion, TranslationSpace,
    TreeJoint,
};
use truth::casts::rotation;
use truth::errors::says;
use truth::rng::Rng;

/// An arm of random joints, both kinds, bodies on every link.
fn arm(rng: &mut Rng, joints: usize) -> JointTree {
    let pose = |rng: &mut Rng| {
        let at = Vector3::from(rng.in_ball());
        Isometry3::from_parts(at.into(), rotation(rng))
    };
    let base = pose(rng);
    let joint = |rng: &mut Rng| {
        let (origin, axis) = (pose(rng), Unit::new_normalize(Vector3::from(rng.unit())));
        if rng.chance(0.3) {
            Joint::prismatic(origin, axis, [-1.0, 2.0])
        } else {
            Joint::revolute(origin, axis, [-3.0, 3.0])
        }
    };
    let joints: Vec<Joint> = (0..joints).map(|_| joint(rng)).collect();
    let links = (0..=joints.len()).collect();
    JointTree::serial(base, joints, links, 1.0).expect("an arm")
}

/// A random tree: a third of the joints mimics another with a random factor and offset, a sixth is fixed; a body on every
/// link.
fn tree(rng: &mut Rng, joints: usize) -> JointTree {
    let pose = |rng: &mut Rng| Isometry3::from_parts(Vector3::from(rng.in_ball()).into(), rotation(rng));
    let mut limits = vec![];
    let joint = |index: usize, limits: &mut Vec<[f64; 2]>, rng: &mut Rng| {
        let slides = rng.chance(0.3);
        let drive = match rng.below(6) {
            0 => None,
            1 | 2 if !limits.is_empty() => Some(Drive {
                coordinate: rng.below(limits.len()),
                factor: rng.range(-2.0, 2.0),
                offset: rng.range(-1.0, 1.0),
            }),
            _ => {
                limits.push(if slides { [-1.0, 2.0] } else { [-3.0, 3.0] });
                Some(Drive::by(limits.len() - 1))
            }
        };
        TreeJoint {
            parent: rng.below(index + 1),
            kind: if slides {
                JointKind::Prismatic
            } else {
                JointKind::Revolute
            },
            origin: pose(rng),
            axis: Unit::new_normalize(Vector3::from(rng.unit())),
            drive,
        }
    };
    let base = pose(rng);
    let joints: Vec<TreeJoint> = (0..joints).map(|index| joint(index, &mut limits, rng)).collect();
    let links: Vec<usize> = (0..=joints.len()).collect();
    let radii = vec![1.0; links.len()];
    JointTree::new(base, joints, limits, links, radii).expect("a tree")
}

fn configuration<C: ConfigurationSpace>(space: &C, rng: &mut Rng) -> Vec<f64> {
    space.sample(&mut || rng.uniform())
}

/// For random segments, bodies, stems, times and spans: no point leaves the motion model by more than the bound. Returns
/// how many bounds were used by a fifth and more, and how many were those of a body as seen from another link.
fn contract<C: ConfigurationSpace>(space: &C, rng: &mut Rng, rounds: usize, exact: bool) -> [u32; 2] {
    let (mut tight, mut stems) = (0, 0);
    for _ in 0..rounds {
        let (from, to) = (configuration(space, rng), configuration(space, rng));
        let segment = space.segment(&from, &to).expect("a segment");
        let body = rng.below(space.bodies());
        // The begin is looked at most.
        let time = if rng.chance(0.25) { 0.0 } else { rng.uniform() };
        let span = (1.0 - time) * rng.log_range(1e-3, 1.0);
        let stem = segment.stem(body, rng.below(space.bodies()));
        let (start, model) = segment.placed(stem, body, time, span);
        // The rounding of the poses in the world counts, whatever the stem.
        let in_world = segment.model(body, time, span);
        let constant = |model: &MotionModel| [model.shift.0[0], model.turn.0[0]];
        let [seen, least] = [&model, &in_world].map(constant);
        assert!(seen[0] >= least[0] * (1.0 - 1e-12) && seen[1] >= least[1] * (1.0 - 1e-12));
        for _ in 0..8 {
            let s = span * rng.uniform();
            let now = segment.placed(stem, body, time + s, 0.0).0;
            if stem > 0 {
                stems += 1;
                // Body k of these trees is link k.
                let placed = segment.pose(stem, time + s) * now;
                let off = (placed * model.pivot - segment.pose(body, time + s) * model.pivot).norm();
                assert!(off <= model.shift.0[0], "{off:e} of {stem} and {body}");
            }
            let x = Point3::from(Vector3::from(rng.unit()) * rng.range(0.0, 2.0));
            let arm = x - model.pivot;
            let pivot = start * model.pivot + model.linear * s + model.acceleration * (0.5 * s * s);
            let turn = lin_canny::nalgebra::UnitQuaternion::from_scaled_axis(model.angular * s);
            let at = pivot + turn * (start.rotation * arm);
            let bound = model.shift.at(s) + arm.norm() * model.turn.at(s);
            let off = (now * x - at).norm();
            // The comparison itself rounds.
            let slack = if exact { 4e-15 * (1.0 + at.coords.norm()) } else { 0.0 };
            assert!(
                off <= bound + slack,
                "{off:e} {bound:e} at {time} + {s} of {from:?} {to:?}"
            );
            tight += u32::from(off > 0.2 * bound);
        }
    }
    [tight, stems]
}

#[test]
fn segments_keep_the_contract_of_motions() {
    let mut rng = Rng::new(3);
    let bounds = [[-3.0, 3.0]; 3];
    let plane = PlanarSpace::new([[-3.0, 3.0]; 2], 1.0, 1).expect("a space");
    let rigid = RigidSpace::new(bounds, 1.0, 1).expect("a space");
    let straight = TranslationSpace::new(bounds, rotation(&mut rng), 1).expect("a space");
    contract(&plane, &mut rng, 500, true);
    contract(&rigid, &mut rng, 500, true);
    contract(&straight, &mut rng, 500, true);
    let mut used = [0; 2];
    for joints in [1, 2, 3, 6, 9] {
        for _ in 0..40 {
            let arm = arm(&mut rng, joints);
            let more = contract(&arm, &mut rng, 20, true);
            used = [used[0] + more[0], used[1] + more[1]];
        }
    }
    // Bounds of arms are sums of magnitudes; a share of them is nearly used.
    assert!(used[0] > 200 && used[1] > 2000, "{used:?}");
}

/// 1,000 segments of trees with branches, mimics and fixed joints, each at 8 times.
#[test]
fn trees_keep_the_contract_of_motions() {
    let mut rng = Rng::new(8);
    let mut used = [0; 2];
    for joints in [1, 2, 4, 8, 14] {
        for _ in 0..20 {
            let tree = tree(&mut rng, joints);
            let more = contract(&tree, &mut rng, 10, true);
            used = [used[0] + more[0], used[1] + more[1]];
        }
    }
    assert!(used[0] > 100 && used[1] > 500, "{used:?}");
}

/// Poses of links are products along their path, mimics and branches included.
#[test]
fn places_of_a_tree_are_products_along_the_path() {
    let mut rng = Rng::new(9);
    for _ in 0..200 {
        let turn = |rng: &mut Rng| TreeJoint {
            parent: 0,
            kind: JointKind::Revolute,
            origin: Isometry3::from_parts(Vector3::from(rng.in_ball()).into(), rotation(rng)),
            axis: Unit::new_normalize(Vector3::from(rng.unit())),
            drive: Some(Drive::by(0)),
        };
        let (a, mut b, mut c) = (turn(&mut rng), turn(&mut rng), turn(&mut rng));
        let mimic = Drive {
            coordinate: 0,
            factor: -0.5,
            offset: 0.25,
        };
        (b.parent, b.drive) = (1, Some(mimic));
        (c.parent, c.drive) = (1, None);
        let step = |joint: &TreeJoint, value: f64| {
            joint.origin * lin_canny::nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, value)
        };
        let q = rng.range(-2.0, 2.0);
        let first = step(&a, q);
        let expected = [first, first * step(&b, 0.25 - 0.5 * q), first * c.origin];
        let base = Isometry3::identity();
        let tree = JointTree::new(base, vec![a, b, c], vec![[-2.0, 2.0]], vec![1, 2, 3], vec![0.1; 4]).expect("a tree");
        let mut poses = vec![];
        tree.place(&[q], &mut poses);
        for (pose, expected) in poses.iter().zip(&expected) {
            let off = (pose.to_homogeneous() - expected.to_homogeneous()).norm();
            assert!(off < 1e-14, "{off:e}");
        }
        assert!(tree.is_rigid(0, 2) && !tree.is_rigid(0, 1));
    }
}

/// Ends of segments are the configurations, and `between` follows the segment.
#[test]
fn segments_lead_from_end_to_end() {
    fn ends<C: ConfigurationSpace>(space: &C, rng: &mut Rng) {
        for _ in 0..200 {
            let (from, to) = (configuration(space, rng), configuration(space, rng));
            let segment = space.segment(&from, &to).expect("a segment");
            let mut poses = vec![];
            for t in [0.0, rng.uniform(), 1.0] {
                let q = space.between(&from, &to, t);
                space.check(&q).expect("a configuration between two");
                space.place(&q, &mut poses);
                for (body, pose) in poses.iter().enumerate() {
                    let other = segment.pose(body, t);
                    let off = (other.translation.vector - pose.translation.vector).norm();
                    assert!(off < 1e-13, "{t} {off:e}");
                    assert!(other.rotation.angle_to(&pose.rotation) < 1e-7, "{t} {off:e}");
                }
            }
            assert!((space.distance(&from, &to) - space.distance(&to, &from)).abs() < 1e-12);
        }
    }
    let mut rng = Rng::new(4);
    ends(&PlanarSpace::new([[-3.0, 3.0]; 2], 1.0, 2).expect("a space"), &mut rng);
    ends(&RigidSpace::new([[-3.0, 3.0]; 3], 1.0, 2).expect("a space"), &mut rng);
    for joints in [1, 4, 7] {
        let arm = arm(&mut rng, joints);
        ends(&arm, &mut rng);
    }
}

/// A roadmap drives its segments both ways: with the ends exchanged a segment is the same motion backwards. Half turns decide
/// between two motions, so angles are multiples of a quarter turn half of the time, and rotations often half turns about axes.
#[test]
fn segments_are_the_same_motion_backwards() {
    fn backwards<C: ConfigurationSpace>(space: &C, rng: &mut Rng, draw: impl Fn(&mut Rng) -> Vec<f64>) {
        for _ in 0..2000 {
            let (from, to) = (draw(rng), draw(rng));
            let [there, back] = [(&from, &to), (&to, &from)].map(|(p, q)| space.segment(p, q).expect("a segment"));
            for t in [0.0, 0.25, 0.5, rng.uniform(), 1.0] {
                let [p, q] = [there.pose(0, t), back.pose(0, 1.0 - t)];
                let off = (p.translation.vector - q.translation.vector).norm();
                let turned = p.rotation.angle_to(&q.rotation);
                assert!(off < 1e-12, "{from:?} {to:?} at {t}: {off:e} {turned:e}");
                assert!(turned < 1e-7, "{from:?} {to:?} at {t}: {off:e} {turned:e}");
            }
        }
    }
    let mut rng = Rng::new(6);
    let quarter = std::f64::consts::FRAC_PI_2;
    let plane = PlanarSpace::new([[-3.0, 3.0]; 2], 1.0, 1).expect("a space");
    backwards(&plane, &mut rng, |rng| {
        let mut q = configuration(&plane, rng);
        if rng.chance(0.5) {
            q[2] = quarter * rng.int(-8, 8) as f64;
        }
        q
    });
    let rigid = RigidSpace::new([[-3.0, 3.0]; 3], 1.0, 1).expect("a space");
    backwards(&rigid, &mut rng, |rng| {
        let mut q = configuration(&rigid, rng);
        if rng.chance(0.7) {
            q[3..].fill(0.0);
            q[3 + rng.below(4)] = *rng.pick(&[1.0, -1.0]);
        }
        q
    });
    let arm = arm(&mut rng, 5);
    backwards(&arm, &mut rng, |rng| configuration(&arm, rng));
}

/// Links by number and configurations by length: what does not exist is refused by name.
#[test]
fn the_pose_of_a_link_is_that_of_the_body_on_it() {
    let mut rng = Rng::new(7);
    let arm = arm(&mut rng, 4);
    let mut poses = vec![];
    for _ in 0..20 {
        let q = configuration(&arm, &mut rng);
        arm.place(&q, &mut poses);
        for (link, pose) in poses.iter().enumerate() {
            assert_eq!(arm.link_pose(&q, link), Ok(*pose));
        }
        says(arm.link_pose(&q, 5), "link");
        for wrong in [&[][..], &q[1..], &[f64::NAN; 4], &[9.0; 4]] {
            assert!(arm.link_pose(wrong, 0).is_err(), "{wrong:?}");
        }
    }
}

/// Against central differences of the place of a point.
#[test]
fn gradients_are_derivatives() {
    fn differences<C: ConfigurationSpace>(space: &C, rng: &mut Rng) {
        let mut gradient = vec![0.0; space.degrees_of_freedom()];
        for _ in 0..100 {
            let q = space.between(&configuration(space, rng), &configuration(space, rng), 0.5);
            let body = rng.below(space.bodies());
            let (own, direction) = (Point3::from(rng.in_ball()), Vector3::from(rng.unit()));
            let place = |q: &[f64]| {
                let mut poses = vec![];
                space.place(q, &mut poses);
                poses[body] * own
            };
            space.gradient(&q, body, &place(&q), &direction, &mut gradient);
            for (k, value) in gradient.iter().enumerate() {
                let height = |h: f64| {
                    let mut step = vec![0.0; space.degrees_of_freedom()];
                    step[k] = h;
                    direction.dot(&place(&space.moved(&q, &step)).coords)
                };
                let slope = (height(1e-6) - height(-1e-6)) / 2e-6;
                assert!((slope - value).abs() < 1e-8, "component {k}: {slope} {value}");
            }
        }
    }
    let mut rng = Rng::new(5);
    differences(&PlanarSpace::new([[-3.0, 3.0]; 2], 1.0, 1).expect("a space"), &mut rng);
    differences(&RigidSpace::new([[-3.0, 3.0]; 3], 1.0, 1).expect("a space"), &mut rng);
    let arm = arm(&mut rng, 6);
    differences(&arm, &mut rng);
    differences(&tree(&mut rng, 8), &mut rng);
}
