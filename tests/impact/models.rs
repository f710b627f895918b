//! Promise: a body on a motion is never farther from its motion model than the remainder states,
//! with poses as rounded.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, MotionError, MotionModel, Nlerp, Remainder, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, Mesh, Operand, PairTracker, PoseError, Velocity};
use truth::rng::Rng;

fn vector(rng: &mut Rng, size: f64) -> Vector3<f64> {
    Vector3::from(rng.in_ball()) * size
}

fn pose(rng: &mut Rng) -> Isometry3<f64> {
    let [x, y, z, w] = rng.quat();
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(vector(rng, 3.0)), rotation)
}

/// Returns the position of a point `s` after `pose` according to a motion model.
fn place(model: &MotionModel, pose: &Isometry3<f64>, p: &Point3<f64>, s: f64) -> Vector3<f64> {
    let centre = (pose * model.pivot).coords + model.linear * s + model.acceleration * (0.5 * s * s);
    let turn = UnitQuaternion::from_scaled_axis(model.angular * s);
    centre + turn * (pose.rotation * (p - model.pivot))
}

/// The largest used fraction of the remainder, with and without the allowance for rounding.
#[derive(Default, Debug)]
struct Used {
    rounding: f64,
    whole: f64,
    way: f64,
}

/// `truth` is the intended motion, `motion` the tested one.
fn check(rng: &mut Rng, motion: &impl Motion, truth: &impl Motion, latest: f64, used: &mut Used) {
    let from = rng.range(0.0, latest);
    let span = rng.range(0.0, latest - from);
    let model = motion.model(from, span);
    let start = motion.pose(from);
    let radius = rng.log_range(0.01, 10.0);
    for k in 0..20 {
        let s = if k == 0 { span } else { rng.range(0.0, span) };
        let s = (from + s) - from;
        if s > span {
            continue;
        }
        let p = model.pivot + Vector3::from(rng.unit()) * radius;
        let off = (truth.pose(from + s) * p).coords - place(&model, &start, &p, s);
        let bound = model.shift.at(s) + radius * model.turn.at(s);
        let constant = model.shift.0[0] + radius * model.turn.0[0];
        // The rounding of the model evaluation in this test.
        let own = 1e-15 * radius * (1.0 + model.angular.norm() * s);
        assert!(
            off.norm() <= bound + own,
            "{} exceeds {bound:e} after {s}: {model:?}",
            off.norm()
        );
        if bound < 2.0 * constant {
            used.rounding = used.rounding.max(off.norm() / (bound + own));
        } else {
            used.whole = used.whole.max(off.norm() / bound);
        }
        let way = (truth.pose(from + s) * p - start * p).norm();
        let most = model.displacement(radius, span);
        assert!(way <= most, "{way} {most}");
        used.way = used.way.max(way / most);
    }
}

#[test]
fn steady_motions_keep_to_their_courses() {
    let mut rng = Rng::new(1901);
    let mut used = Used::default();
    for k in 0..3000 {
        let spin = rng.log_range(1e-3, 600.0);
        let velocity = Velocity::new(vector(&mut rng, 5.0), Vector3::from(rng.unit()) * spin);
        let pivot = if k % 2 == 0 {
            Point3::origin()
        } else {
            vector(&mut rng, 4.0).into()
        };
        let mut motion = Steady::about(&pose(&mut rng), pivot, velocity).expect("a motion");
        if k % 3 == 0 {
            motion = motion
                .with_acceleration(vector(&mut rng, 9.8))
                .expect("an acceleration");
        }
        check(&mut rng, &motion, &motion, 1.0, &mut used);
    }
    // A good part of the rounding bound is used, and it is never exceeded.
    assert!((0.05..=1.0).contains(&used.rounding) && used.way > 0.9, "{used:?}");
}

/// Motions whose accelerations differ from the known ones by the full allowance.
#[test]
fn open_motions_keep_to_their_courses() {
    let mut rng = Rng::new(1902);
    let mut used = Used::default();
    for _ in 0..3000 {
        let spin = rng.range(-3.0, 3.0);
        let axis = Vector3::from(rng.unit());
        let start = pose(&mut rng);
        let nominal = Steady::new(&start, Velocity::new(vector(&mut rng, 5.0), axis * spin)).expect("a motion");
        let (push, twist) = (vector(&mut rng, 1.0).normalize() * 4.0, rng.range(-2.0, 2.0));
        let open = nominal.with_acceleration_bounds(4.0, 2.0).expect("bounds");
        let truth = Pushed {
            nominal,
            axis,
            start,
            push,
            twist,
        };
        check(&mut rng, &open, &truth, 1.0, &mut used);
    }
    assert!(used.whole > 0.9 && used.whole <= 1.0, "{used:?}");
}

/// Constant accelerations added to a steady motion.
struct Pushed {
    nominal: Steady,
    axis: Vector3<f64>,
    start: Isometry3<f64>,
    push: Vector3<f64>,
    twist: f64,
}

impl Motion for Pushed {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let mut pose = self.start;
        let velocity = self.nominal.velocity();
        pose.translation.vector += velocity.linear * time + self.push * (0.5 * time * time);
        let angle = velocity.angular.dot(&self.axis) * time + 0.5 * self.twist * time * time;
        pose.rotation = UnitQuaternion::from_scaled_axis(self.axis * angle) * pose.rotation;
        pose
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        self.nominal.model(time, span)
    }
}

#[test]
fn sweeps_keep_to_their_courses_and_ends() {
    let mut rng = Rng::new(1903);
    let (mut lerps, mut slerps) = (Used::default(), Used::default());
    for _ in 0..3000 {
        let (from, to) = (pose(&mut rng), pose(&mut rng));
        let duration = rng.log_range(0.1, 10.0);
        let pivot = Point3::from(vector(&mut rng, 1.0));
        let slerp = Steady::between(&from, &to, duration, pivot).expect("a motion");
        let nlerp = Nlerp::new(&from, &to, duration, pivot).expect("a motion");
        check(&mut rng, &slerp, &slerp, duration, &mut slerps);
        check(&mut rng, &nlerp, &nlerp, duration, &mut lerps);
        for (time, end) in [(0.0, from), (duration, to)] {
            for at in [slerp.pose(time), nlerp.pose(time)] {
                assert!((at.translation.vector - end.translation.vector).norm() < 1e-14);
                assert!(at.rotation.angle_to(&end.rotation) < 1e-7);
            }
        }
        // Both are equal halfway.
        let (p, q) = (slerp.pose(0.5 * duration), nlerp.pose(0.5 * duration));
        assert!(
            (p.rotation.coords - q.rotation.coords)
                .norm()
                .min((p.rotation.coords + q.rotation.coords).norm())
                < 1e-14
        );
    }
    assert!(lerps.whole > 0.3, "{lerps:?} {slerps:?}");
    assert!(lerps.way > 0.9, "{lerps:?} {slerps:?}");
    assert!(slerps.way > 0.9, "{lerps:?} {slerps:?}");
}

#[test]
fn a_screw_stays_on_its_line() {
    let mut rng = Rng::new(1904);
    for _ in 0..300 {
        let (start, point) = (pose(&mut rng), Point3::from(vector(&mut rng, 2.0)));
        let axis = vector(&mut rng, 2.0);
        let screw = Steady::screw(&start, &point, &axis, 2.5, 0.3).expect("a motion");
        let u = axis.normalize();
        let turn = UnitQuaternion::from_scaled_axis(u * 2.5 * 0.7);
        for _ in 0..5 {
            let p = Point3::from(vector(&mut rng, 1.0));
            let expected = point + turn * (start * p - point) + u * (0.3 * 0.7);
            assert!((screw.pose(0.7) * p - expected).norm() < 2e-14);
        }
    }
}

#[test]
fn numbers_that_are_no_motion_are_refused() {
    let one = Isometry3::identity();
    let nan = Velocity::new(Vector3::new(0.0, f64::NAN, 0.0), Vector3::zeros());
    assert!(matches!(
        Steady::new(&one, nan),
        Err(MotionError::Value {
            what: "linear velocity",
            ..
        })
    ));
    let far = Velocity::new(Vector3::zeros(), Vector3::x() * 1e101);
    assert!(matches!(
        Steady::new(&one, far),
        Err(MotionError::Value {
            what: "angular velocity",
            ..
        })
    ));
    assert!(matches!(
        Nlerp::new(&one, &one, 0.0, Point3::origin()),
        Err(MotionError::Size { .. })
    ));
    assert!(matches!(
        Steady::between(&one, &one, -1.0, Point3::origin()),
        Err(MotionError::Size { .. })
    ));
    assert!(Steady::screw(&one, &Point3::origin(), &Vector3::zeros(), 1.0, 1.0).is_err());
    let rest = Steady::new(&one, Velocity::default()).expect("rest is a motion");
    assert!(rest.with_acceleration_bounds(-1.0, 0.0).is_err());
    assert!(rest.with_acceleration(Vector3::repeat(f64::INFINITY)).is_err());
    let long = Isometry3::from_parts(
        Translation3::identity(),
        UnitQuaternion::new_unchecked(Quaternion::new(1.1, 0.0, 0.0, 0.0)),
    );
    // The error of a single pose names A; of two poses, the first is A's.
    let on = |made: Result<(), MotionError>, of: Operand| match made {
        Err(MotionError::Pose(PoseError::Rotation { body, .. } | PoseError::Translation { body, .. })) => {
            assert_eq!(body, of);
        }
        other => panic!("{other:?}"),
    };
    let lost = Isometry3::translation(0.0, f64::NAN, 0.0);
    let (origin, still) = (Point3::origin(), Velocity::default());
    for bad in [&long, &lost] {
        on(Steady::new(bad, still).map(drop), Operand::A);
        on(Steady::about(bad, origin, still).map(drop), Operand::A);
        on(
            Steady::screw(bad, &origin, &Vector3::x(), 1.0, 1.0).map(drop),
            Operand::A,
        );
        on(Steady::between(bad, &one, 1.0, origin).map(drop), Operand::A);
        on(Steady::between(&one, bad, 1.0, origin).map(drop), Operand::B);
        on(Nlerp::new(bad, &one, 1.0, origin).map(drop), Operand::A);
        on(Nlerp::new(&one, bad, 1.0, origin).map(drop), Operand::B);
    }
}

/// A motion of the caller whose quaternion is off unit length by almost as much as a pose may be.
struct OffUnit(f64);

impl Motion for OffUnit {
    fn pose(&self, _: f64) -> Isometry3<f64> {
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.5, 0.5, 0.5, 0.5) * self.0);
        Isometry3::from_parts(Translation3::identity(), turn)
    }

    fn model(&self, _: f64, _: f64) -> MotionModel {
        MotionModel {
            pivot: Point3::origin(),
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            shift: Remainder::default(),
            turn: Remainder::default(),
        }
    }
}

#[test]
fn a_cast_at_a_motion_off_unit_length_is_true() {
    let cube = solids::cuboid(Vector3::repeat(0.5)).expect("a cube");
    let mesh = Geometry::from(Mesh::from_convex(&cube).expect("a mesh"));
    let flight = Velocity::new(-Vector3::x(), Vector3::zeros());
    let flight = Steady::new(&Isometry3::translation(2.0, 0.0, 0.0), flight).expect("a motion");
    for by in [1.0, 1.0 + 4.9e-13, 1.0 - 4.9e-13] {
        for (a, b) in [
            (&Geometry::from(cube.clone()), &Geometry::from(cube.clone())),
            (&mesh, &mesh),
        ] {
            let mut tracker = PairTracker::new();
            let mut pair = tracker.pair(a, b);
            let found = cast(&mut pair, &OffUnit(by), &flight, 0.0..2.0, Tolerance::Distance(1e-12));
            let Ok(Impact::Hit { safe, hit, .. }) = found.map(|cast| cast.impact) else {
                panic!("{by}: no hit");
            };
            // The faces meet at one exactly.
            assert!(safe < 1.0 && 1.0 <= hit && hit - safe < 3e-12, "{by}: {safe:e} {hit:e}");
        }
    }
}
