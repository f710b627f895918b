//! Judges segments by dense exact predicates on an interpolation of its own, and certificates at every vertex.

use lin_canny::impact::Certificate;
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::separation::{Proof, Separation};
use lin_canny::{ConvexPolyhedron, Operand, RelativePose, Tracker, Velocity, normalize_rotation};
use lin_canny_plan::{CellBody, PairProof, Verdict};

/// Verdicts by kind, and the widest bracket of a contact.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    pub(crate) free: u32,
    pub(crate) blocked: u32,
    pub(crate) undecided: u32,
    pub(crate) queries: u64,
    pub(crate) widest: f64,
}

impl Counts {
    /// Counts a verdict of a motion and judges it: in contact at the time named, and free at `places` times up to where it
    /// is called free.
    pub(crate) fn judge(
        &mut self,
        verdict: &Verdict,
        places: u32,
        mut is_free: impl FnMut(f64) -> bool,
        what: &impl std::fmt::Debug,
    ) {
        match verdict {
            Verdict::Free { .. } => self.free += 1,
            Verdict::Blocked {
                contact_at, free_until, ..
            } => {
                self.blocked += 1;
                self.widest = self.widest.max(contact_at - free_until);
                assert!(!is_free(*contact_at), "{verdict:?} of {what:?}");
            }
            _ => {
                println!("undecided: {what:?}, {verdict:?}");
                self.undecided += 1;
            }
        }
        for i in 0..=places {
            let t = verdict.free_until() * f64::from(i) / f64::from(places);
            assert!(is_free(t), "{verdict:?} of {what:?} meets at {t}");
        }
    }
}

/// Hulls at poses.
pub(crate) type Placed = (ConvexPolyhedron, Isometry3<f64>);

/// Straight line and slerp, by nalgebra.
pub(crate) fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, t: f64) -> Isometry3<f64> {
    let at = from.translation.vector * (1.0 - t) + to.translation.vector * t;
    let turn = from.rotation.slerp(&to.rotation, t);
    normalize_rotation(&Isometry3::from_parts(at.into(), turn))
}

pub(crate) fn meet(tracker: &mut Tracker, a: &Placed, b: &Placed) -> bool {
    let ((p, r), (q, s)) = (a.0.bounding_ball(), b.0.bounding_ball());
    if (a.1 * p - b.1 * q).norm() > (r + s) * 1.001 {
        return false;
    }
    let pose = RelativePose::new(&a.1, &b.1).expect("poses are poses");
    tracker.intersects(&a.0, &b.0, &pose)
}

/// The first of `steps` samples of a segment in `0..=until` at which a hull of the robot meets an obstacle.
pub(crate) fn first_contact(
    robot: &[ConvexPolyhedron],
    obstacles: &[Placed],
    [from, to]: [&Isometry3<f64>; 2],
    until: f64,
    steps: usize,
) -> Option<f64> {
    let mut trackers = vec![Tracker::new(); robot.len() * obstacles.len()];
    (0..=steps).map(|k| until * k as f64 / steps as f64).find(|&t| {
        let pose = between(from, to, t);
        robot.iter().enumerate().any(|(i, hull)| {
            let body = (hull.clone(), pose);
            obstacles
                .iter()
                .enumerate()
                .any(|(k, obstacle)| meet(&mut trackers[i * obstacles.len() + k], &body, obstacle))
        })
    })
}

/// The certificates of a pair follow one another from 0 to 1.
pub(crate) fn follow(proof: &PairProof) {
    let mut reached = 0.0;
    for certificate in &proof.certificates {
        assert_eq!(certificate.from, reached, "{proof:?}");
        assert!(certificate.until > certificate.from);
        reached = certificate.until;
    }
    assert_eq!(reached, 1.0, "{proof:?}");
}

/// Replays the certificates of a segment of one rigid hull: they follow one another from 0 to 1, and at sampled times every
/// vertex lies on its side of the plane, or the balls are apart.
pub(crate) fn replay(
    proofs: &[PairProof],
    robot: &ConvexPolyhedron,
    obstacles: &[Placed],
    [from, to]: [&Isometry3<f64>; 2],
) {
    assert_eq!(proofs.len(), obstacles.len());
    let motion = Steady::between(from, to, 1.0, Point3::origin()).expect("a segment");
    for proof in proofs {
        let CellBody::Obstacle(k) = proof.pair.b else {
            panic!("{proof:?}")
        };
        let resting = Steady::new(&obstacles[k].1, Velocity::default()).expect("a pose");
        follow(proof);
        for certificate in &proof.certificates {
            for i in 0..=8 {
                let time = certificate.from + (certificate.until - certificate.from) * f64::from(i) / 8.0;
                let bodies = [(robot, motion.pose(time)), (&obstacles[k].0, resting.pose(time))];
                holds(certificate, bodies, time);
            }
        }
    }
}

fn holds(certificate: &Certificate, [(a, pose_a), (b, pose_b)]: [(&ConvexPolyhedron, Isometry3<f64>); 2], time: f64) {
    match certificate.proof {
        Proof::Plane { .. } => {
            let n = certificate.normal(time).expect("a plane has a normal");
            let along = |p: Point3<f64>| n.dot(&p.coords);
            let high = a
                .vertex_points()
                .map(|p| along(pose_a * p))
                .fold(f64::NEG_INFINITY, f64::max);
            let low = b
                .vertex_points()
                .map(|p| along(pose_b * p))
                .fold(f64::INFINITY, f64::min);
            assert!(
                low - high > certificate.distance,
                "{certificate:?} at {time}: {low} {high}"
            );
        }
        Proof::Balls => {
            // The balls of the pair contain the vertices; that of the robot turns about the pivot, the origin.
            let mut tracker = Tracker::new();
            let pair = tracker.pair(a, b);
            let [(p, r), (q, s)] = [Operand::A, Operand::B].map(|of| pair.ball(of));
            for (body, centre, radius) in [(a, p, r), (b, q, s)] {
                assert!(
                    body.vertex_points()
                        .all(|x| (x - centre).norm() <= radius * (1.0 + 1e-15))
                );
            }
            let gap = (pose_b * q - Point3::from(pose_a.translation.vector)).norm() - p.coords.norm() - r - s;
            assert!(gap > certificate.distance, "{certificate:?} at {time}: {gap}");
        }
        Proof::Own => panic!("polyhedra have planes: {certificate:?}"),
    }
}

/// The pose of a configuration of a rigid body.
pub(crate) fn pose_of(q: &[f64]) -> Isometry3<f64> {
    use lin_canny::nalgebra::{Quaternion, UnitQuaternion};
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(q[6], q[3], q[4], q[5]));
    Isometry3::from_parts(Vector3::new(q[0], q[1], q[2]).into(), turn)
}
