//! Configuration spaces: clearances, segments, paths, curves, ranges, receipts, moving obstacles,
//! worlds that change.

use crate::make::*;
use crate::{Random, Teller};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Cloud, CloudElement, Geometry, HalfSpace, Shape, Tracker};
use lin_canny_plan::receipt::Receipt;
use lin_canny_plan::{
    Cell, Certified, CertifyOptions, Checker, ClearanceWidth, ConfigurationSpace, Joint, JointCurve, JointMotion,
    JointTree, PlanError, PlanOptions, PlanarSpace, RangeOptions, RangeProver, RigidSpace, RrtConnect, Shortcuts,
    SmoothOptions, Smoother, TimedPoses, TranslationSpace, widen,
};
use std::ops::ControlFlow;

/// Returns the verdict with the certificates behind it.
fn prove<C: ConfigurationSpace>(checker: &mut Checker<C>, motion: &JointMotion) -> Result<Certified, PlanError> {
    checker.certify_with(motion, CertifyOptions::default().certificates(true))
}

fn room(r: &mut Random) -> Cell {
    let mut cell = Cell::new();
    cell.robot_body("robot", hull(r, 14, 1));
    for k in 0..5 {
        cell.add_obstacle(format!("obstacle {k}"), round(r, 16), isometry(r, 3.0))
            .expect("an obstacle");
    }
    cell.add_obstacle("mesh", dented(&round(r, 12), 0.8), isometry(r, 3.5))
        .expect("an obstacle");
    cell
}

fn questions<C: ConfigurationSpace>(t: &mut Teller, r: &mut Random, space: C, cell: Cell, rounds: u64) {
    let mut checker = Checker::new(space, cell).expect("a checker");
    let mut last = checker.space().sample(&mut || r.range(0.0, 1.0));
    for k in 0..rounds {
        let q = checker.space().sample(&mut || r.range(0.0, 1.0));
        t.tell("q", &q);
        let mut poses = Vec::new();
        checker.space().place(&q, &mut poses);
        t.tell("poses", &poses);
        t.tell("clearance", checker.clearance(&q));
        t.tell("nearest", checker.nearest(&q, 0.3));
        t.tell("free at", checker.is_free_at(&q));
        t.tell("certify", checker.certify(&JointMotion::segment(&last, &q)));
        t.tell("is free", checker.is_free(&JointMotion::segment(&last, &q)));
        let near: Vec<f64> = q.iter().map(|x| x + r.range(-0.02, 0.02)).collect();
        t.tell("near", checker.certify(&JointMotion::segment(&q, &near)));
        t.tell(
            "tube",
            checker.certify(&JointMotion::segment(&q, &near).with_radius(0.001).expect("a motion")),
        );
        t.tell("prove", prove(&mut checker, &JointMotion::segment(&q, &near)));
        if k % 4 == 0 {
            t.tell("along", checker.clearance_along(&JointMotion::segment(&last, &q), 1e-2));
        }
        last = q;
    }
    t.tell("work", checker.work());
}

pub(super) fn spaces(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(16) {
        let cell = room(r);
        let planar = PlanarSpace::new([[-4.0, 4.0]; 2], 1.0, 1).expect("a space");
        questions(t, r, planar, cell.clone(), 10);
        let rotation = turn(r, 1.0);
        let translations = TranslationSpace::new([[-4.0, 4.0]; 3], rotation, 1).expect("a space");
        questions(t, r, translations, cell.clone(), 10);
        let rigid = RigidSpace::new([[-4.0, 4.0]; 3], 1.0, 1).expect("a space");
        questions(t, r, rigid, cell, 10);
    }
}

/// Six axes; boxes, a prism and a curved shape on its links; a cell.
fn six_axes() -> (JointTree, Cell) {
    let mut cell = Cell::new();
    let block = |size: [f64; 3], z: f64| {
        let solid = solids::cuboid(Vector3::from(size) * 0.5).expect("a box");
        solid.transformed(&Isometry3::translation(0.0, 0.0, z)).expect("a box")
    };
    let bodies: [(&str, usize, Geometry); 7] = [
        ("base", 0, block([0.2, 0.2, 0.12], 0.06).into()),
        ("shoulder", 1, block([0.17, 0.17, 0.2], 0.1).into()),
        ("upper arm", 2, block([0.11, 0.13, 0.56], 0.225).into()),
        ("forearm", 3, block([0.09, 0.1, 0.42], 0.19).into()),
        ("wrist 1", 4, solids::prism(12, 0.07, 0.045).expect("a prism").into()),
        ("wrist 2", 5, Shape::capsule(0.05, 0.04).expect("a shape").into()),
        ("gripper", 6, block([0.05, 0.14, 0.12], 0.06).into()),
    ];
    let links = bodies.iter().map(|b| b.1).collect();
    let names = bodies.each_ref().map(|b| b.0);
    for (name, _, shape) in bodies {
        cell.robot_body(name, shape);
    }
    let (y, z) = (Vector3::y_axis(), Vector3::z_axis());
    let joints = [
        (0.12, z, 2.9),
        (0.2, y, 1.8),
        (0.45, y, 2.6),
        (0.4, z, 2.9),
        (0.15, y, 2.2),
        (0.11, z, 2.9),
    ];
    let joint = |(height, axis, limit): (f64, Unit<Vector3<f64>>, f64)| {
        Joint::revolute(Isometry3::translation(0.0, 0.0, height), axis, [-limit, limit])
    };
    let arm = JointTree::serial(Isometry3::identity(), joints.map(joint).into(), links, 0.15).expect("an arm");
    for (name, size, at) in [
        ("floor", [3.0, 3.0, 0.05], [0.0, 0.0, -0.03]),
        ("table", [0.5, 1.2, 0.04], [0.65, 0.0, 0.28]),
        ("shelf", [0.9, 0.3, 0.02], [0.0, -0.85, 0.75]),
        ("post", [0.06, 0.06, 1.8], [-0.7, 0.7, 0.9]),
    ] {
        let [x, y, z] = at;
        cell.add_obstacle(name, block(size, 0.0), Isometry3::translation(x, y, z))
            .expect("an obstacle");
    }
    cell.add_obstacle(
        "tank",
        Shape::cylinder(0.3, 0.2).expect("a shape"),
        Isometry3::translation(-0.6, -0.3, 0.3),
    )
    .expect("an obstacle");
    for (k, name) in names.iter().enumerate() {
        for other in names.iter().skip(k + 1).take(2) {
            cell.exclude(name, other).expect("names");
        }
    }
    cell.exclude("base", "floor").expect("names");
    (arm, cell)
}

pub(super) fn arm(t: &mut Teller, r: &mut Random) {
    let (arm, cell) = six_axes();
    let rounds = t.rounds(240);
    questions(t, r, arm, cell, rounds);
}

pub(super) fn arm_plan(t: &mut Teller, r: &mut Random) {
    for seed in 0..t.rounds(30) {
        let (arm, cell) = six_axes();
        let mut checker = Checker::new(arm, cell).expect("a checker");
        let mut free = || loop {
            let q = checker.space().sample(&mut || r.range(0.0, 1.0));
            if checker
                .clearance(&q)
                .expect("a configuration")
                .is_some_and(|near| near.lower > 0.02)
            {
                return q;
            }
        };
        let (start, goal) = (free(), free());
        let found = RrtConnect::new(&PlanOptions::default().seed(seed))
            .plan(&mut checker, &start, &goal)
            .expect("a search");
        t.tell("plan", (&found.path, found.work));
        if let Some(path) = found.path {
            t.tell("path", checker.certify(&JointMotion::path(&path).expect("a motion")));
            t.tell("short", Shortcuts::new(30, seed).shorten(&mut checker, &path));
            t.tell("widen", widen(&mut checker, &path, 0.05, 0.5, 2));
        }
    }
}

/// Returns configurations near each other.
fn near(r: &mut Random, space: &impl ConfigurationSpace, count: usize, far: f64) -> Vec<Vec<f64>> {
    let first = space.sample(&mut || r.range(0.2, 0.8));
    let mut all = vec![first];
    while all.len() < count {
        let last = &all[all.len() - 1];
        all.push(last.iter().map(|x| x + r.range(-far, far)).collect());
    }
    all
}

pub(super) fn curves(t: &mut Teller, r: &mut Random) {
    let (arm, cell) = six_axes();
    let mut checker = Checker::new(arm, cell).expect("a checker");
    for k in 0..t.rounds(60) {
        let q = near(r, checker.space(), 6, [0.02, 0.1][k as usize % 2]);
        let rates: Vec<Vec<f64>> = q
            .iter()
            .map(|q| q.iter().map(|_| r.range(-0.1, 0.1)).collect())
            .collect();
        let quintic = JointCurve::quintic([&q[0], &q[1]], [&rates[0], &rates[1]], [&rates[2], &rates[3]], 1.0);
        let curves = [
            JointCurve::bezier(&q[..2 + k as usize % 5]),
            JointCurve::cubic(&q[0], &q[1], &rates[0], &rates[1], 0.7),
            quintic,
            JointCurve::power(&[&q[0], &rates[0], &rates[1]]),
        ];
        for curve in curves {
            let Ok(curve) = curve else {
                t.tell("none", curve.err());
                continue;
            };
            t.tell(
                "points",
                (0..=curve.degree()).map(|k| curve.control_point(k)).collect::<Vec<_>>(),
            );
            t.tell("at", (curve.at(0.3), curve.velocity(0.3), curve.acceleration(0.3)));
            t.tell("certify", checker.certify(&JointMotion::curve(&curve)));
            t.tell("prove", prove(&mut checker, &JointMotion::curve(&curve)));
            t.tell("along", checker.clearance_along(&JointMotion::curve(&curve), 1e-2));
            t.tell(
                "tube",
                checker.certify(&JointMotion::curve(&curve).with_tube(&[1e-3; 6]).expect("a motion")),
            );
        }
        let knots = [0.0, 0.0, 0.0, 0.0, 0.4, 0.5, 1.0, 1.0, 1.0, 1.0];
        for spline in [JointCurve::b_spline(&q, 3, &knots), JointCurve::uniform_b_spline(&q, 3)] {
            t.tell("spline", &spline);
            if let Ok(curves) = spline {
                t.tell(
                    "certify",
                    checker.certify(&JointMotion::spline(&curves).expect("a motion")),
                );
            }
        }
        let options = SmoothOptions::new(vec![1.0; 6], vec![2.0; 6]).continuous_acceleration(k % 3 == 0);
        t.tell("smooth", Smoother::new(&options).smooth(&mut checker, &q));
    }
    t.tell("work", checker.work());
}

pub(super) fn ranges(t: &mut Teller, r: &mut Random) {
    for k in 0..t.rounds(12) {
        let (arm, cell) = six_axes();
        let mut checker = Checker::new(arm, cell).expect("a checker");
        let q = checker.space().sample(&mut || r.range(0.3, 0.7));
        let half = [0.05, 0.3, 0.6][k as usize % 3];
        let low: Vec<f64> = q.iter().map(|x| x - half).collect();
        let high: Vec<f64> = q.iter().map(|x| x + half).collect();
        let mut options = RangeOptions::default().cells(60).samples(8).seed(k);
        if k % 2 == 1 {
            options = options.width(ClearanceWidth::Share(0.1));
        }
        let answers = RangeProver::new(&options)
            .all_pairs(&mut checker, &low, &high)
            .expect("a range");
        let open = answers.iter().find(|answer| !answer.open.is_empty()).cloned();
        t.tell("range", answers);
        if let Some(open) = open {
            let resumed = RangeProver::new(&options)
                .progress(&mut |_| ControlFlow::Continue(()))
                .resume(&mut checker, &open);
            t.tell("resumed", resumed);
        }
        t.tell("work", checker.work());
    }
    for _ in 0..t.rounds(12) {
        let space = RigidSpace::new([[-4.0, 4.0]; 3], 1.0, 1).expect("a space");
        let mut checker = Checker::new(space, room(r)).expect("a checker");
        let q = checker.space().sample(&mut || r.range(0.3, 0.7));
        let low: Vec<f64> = q.iter().map(|x| x - 0.1).collect();
        let high: Vec<f64> = q.iter().map(|x| x + 0.1).collect();
        let options = RangeOptions::default().cells(40).samples(4);
        t.tell("rigid", RangeProver::new(&options).all_pairs(&mut checker, &low, &high));
    }
}

pub(super) fn receipts(t: &mut Teller, r: &mut Random) {
    let text = |receipt: Result<Receipt, _>| receipt.map(|receipt| receipt.to_string());
    let (arm, cell) = six_axes();
    let mut checker = Checker::new(arm, cell).expect("a checker");
    for k in 0..t.rounds(60) {
        let q = near(r, checker.space(), 3, [0.02, 0.3][k as usize % 2]);
        t.tell(
            "segment",
            text(Receipt::motion(&mut checker, &JointMotion::segment(&q[0], &q[1]))),
        );
        t.tell(
            "path",
            text(Receipt::motion(&mut checker, &JointMotion::path(&q).expect("a motion"))),
        );
    }
    for _ in 0..t.rounds(200) {
        let bodies = [round(r, 16), hull(r, 14, 1)].map(Geometry::from);
        let [a, b] = &bodies;
        let named = [("a", a), ("b", b)];
        let at = isometry(r, 1.6);
        if let (Geometry::Polyhedron(a), Geometry::Polyhedron(b)) = (a, b) {
            let outcome = Tracker::new().closest(a, b, &relative(&at));
            t.tell("outcome", text(Receipt::outcome(named, &at, &outcome)));
        }
        let motions = [steady(r, 2.0), steady(r, 3.0)];
        let [p, q] = motions.each_ref();
        let tolerance = Tolerance::Distance(1e-4);
        t.tell("cast", text(Receipt::cast(named, [p, q], 0.0..1.0, tolerance, 0.0)));
    }
}

pub(super) fn timed_obstacles(t: &mut Teller, r: &mut Random) {
    let times = [-1.0, 0.25, 0.5, 2.0];
    for k in 0..t.rounds(60) {
        let (arm, mut cell) = six_axes();
        let cart = [Geometry::from(dented(&round(r, 12), 0.8)), round(r, 12).into()][k as usize % 2].clone();
        let rows: Vec<_> = times.iter().map(|_| isometry(r, 1.8)).collect();
        let poses = TimedPoses::new(&times, &rows).expect("timed poses");
        t.tell("poses", [-1.0, -0.3, 0.3, 0.5, 1.9].map(|time| poses.at(time)));
        cell.add_moving_obstacle("cart", cart, poses).expect("an obstacle");
        let mut checker = Checker::new(arm, cell).expect("a checker");
        for frame in 0..4 {
            let time = 0.3 * f64::from(frame);
            checker.set_time(time).expect("a time");
            let q = near(r, checker.space(), 4, 0.2);
            t.tell("clearance", checker.clearance(&q[0]));
            t.tell("free at", checker.is_free_at(&q[1]));
            let curve = JointCurve::bezier(&q).and_then(|curve| curve.with_times([time, time + 0.7]));
            let curve = curve.expect("a curve");
            t.tell("certify", checker.certify(&JointMotion::curve(&curve)));
            t.tell("prove", prove(&mut checker, &JointMotion::curve(&curve)));
            t.tell("along", checker.clearance_along(&JointMotion::curve(&curve), 1e-2));
        }
    }
}

/// Worlds whose obstacles come, move, are replaced and go, and objects that the arm carries.
pub(super) fn worlds(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(12) {
        let (arm, cell) = six_axes();
        let mut checker = Checker::new(arm, cell).expect("a checker");
        for k in 0..24 {
            let name = format!("thing {k}");
            let pose = isometry(r, 1.2);
            let size = r.range(0.05, 0.3);
            let geometry: Geometry = match r.below(4) {
                0 => Shape::ball(size).expect("a ball").into(),
                1 => round(r, 12).scaled(size).expect("a body").into(),
                2 => HalfSpace::new(unit(r), -1.5).expect("a half-space").into(),
                _ => Cloud::new(&cloud(r, 60, 1), CloudElement::Ball(0.02))
                    .expect("a cloud")
                    .into(),
            };
            let known = format!("thing {}", r.below(k + 1));
            let done = match r.below(7) {
                0 | 1 => checker
                    .cell_mut()
                    .add_obstacle(&name, geometry, pose)
                    .map(|id| vec![id]),
                2 => checker.cell_mut().move_obstacle(&known[..], pose),
                3 => checker.cell_mut().replace_obstacle(&known[..], geometry),
                4 => checker.cell_mut().remove_obstacle(&known[..]),
                5 => {
                    let held = Shape::ball(0.05).expect("a ball");
                    let place = Isometry3::translation(0.0, 0.0, 0.2);
                    checker
                        .cell_mut()
                        .attach("gripper", &name, held, place, &["wrist 2"])
                        .map(|id| vec![id])
                }
                _ => checker.cell_mut().pad("floor", 0.01 * size),
            };
            t.tell("change", done);
            let q = near(r, checker.space(), 2, 0.3);
            t.tell("clearance", checker.clearance(&q[0]));
            t.tell("nearest", checker.nearest(&q[0], 0.1));
            t.tell("certify", checker.certify(&JointMotion::segment(&q[0], &q[1])));
            t.tell("contacts", checker.in_contact(&q[1]));
        }
        t.tell("work", checker.work());
        let stored = serde_json::to_string(checker.cell()).expect("JSON");
        t.tell("cell", stored);
    }
}
