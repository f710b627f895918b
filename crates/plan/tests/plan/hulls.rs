//! Hulls of meshes answer first: the same verdicts as the meshes alone, by fewer queries of the
//! meshes.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::{Mesh, PairTracker, RelativePose};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, ConfigurationSpace, JointMotion, RigidSpace, TimedPoses, TranslationSpace,
};
use truth::plans::{self, Ask, Furnish, bezier, cuboid};
use truth::rng::Rng;

/// An L of arms 2 long and 0.5 wide and thick, as a closed mesh about its inner corner.
fn angle() -> Mesh {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 2.0], [0.0, 2.0]];
    let at = |z: f64| outline.map(|[x, y]| Point3::new(x - 0.5, y - 0.5, z));
    let points: Vec<Point3<f64>> = at(-0.25).into_iter().chain(at(0.25)).collect();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for k in 1..5 {
        triangles.extend([[0, k + 1, k], [6, 6 + k, 7 + k]]);
    }
    for k in 0..6 {
        let next = (k + 1) % 6;
        triangles.extend([[k, next, next + 6], [k, next + 6, k + 6]]);
    }
    Mesh::new(&points, &triangles).expect("a closed mesh")
}

/// A mesh among meshes and hulls; with a flat mesh, which has no hull.
fn room(seed: u64) -> Checker<RigidSpace> {
    let mut rng = Rng::new(seed);
    let mut cell = Cell::new();
    cell.robot_body("angle", angle());
    let block = cuboid([0.3, 0.4, 0.5]);
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let sheet = Mesh::new(&corners, &[[0, 1, 2]]).expect("a triangle");
    for k in 0..12 {
        let at = Vector3::from([0; 3].map(|_| rng.range(-4.0, 4.0)));
        let turn = Vector3::from(rng.unit()) * rng.range(0.0, 3.0);
        let pose = Isometry3::from_parts(at.into(), UnitQuaternion::from_scaled_axis(turn));
        match k % 4 {
            0 => cell.put(k, block.clone(), pose),
            1 => cell.put(k, sheet.clone(), pose),
            _ => cell.put(k, angle(), pose),
        };
    }
    let space = RigidSpace::new([[-5.0, 5.0]; 3], 1.6, 1).expect("a space");
    Checker::new(space, cell).expect("a world")
}

fn sample(checker: &Checker<RigidSpace>, rng: &mut Rng) -> Vec<f64> {
    checker.space().sample(&mut || rng.range(0.0, 1.0))
}

/// The distances of all pairs at a configuration by the meshes alone; 0 in contact.
fn distances(checker: &Checker<RigidSpace>, q: &[f64]) -> Vec<f64> {
    let mut poses = Vec::new();
    checker.space().place(q, &mut poses);
    let cell = checker.cell();
    let robot = cell.geometry(CellBody::Robot(0)).expect("the angle");
    let of = |(_, shape, pose)| {
        let relative = RelativePose::new(&poses[0], pose).expect("poses are poses");
        PairTracker::new().closest(robot, shape, &relative).distance.max(0.0)
    };
    cell.obstacles().map(of).collect()
}

#[test]
fn configurations_have_the_answers_of_the_meshes() {
    let (mut hulls, mut meshes, mut free) = (0, 0, 0);
    for seed in 0..4 {
        let mut checker = room(seed);
        let mut rng = Rng::new(100 + seed);
        for margin in [0.0, 0.2] {
            checker.cell_mut().set_margin(margin).expect("a margin");
            for _ in 0..60 {
                let q = sample(&checker, &mut rng);
                let all = distances(&checker, &q);
                let least = all.iter().copied().fold(f64::INFINITY, f64::min);
                let is_free = checker.is_free_at(&q).expect("a configuration");
                assert_eq!(is_free, least > margin, "{least}");
                free += u32::from(is_free);
                let near = checker.clearance(&q).expect("a configuration").expect("a pair");
                assert!((near.distance.max(0.0) - least).abs() < 1e-12, "{near:?} {least}");
                let within = all.iter().filter(|d| **d <= least + 0.5).count();
                assert_eq!(checker.nearest(&q, 0.5).expect("a configuration").len(), within);
                let touching = all.iter().filter(|d| **d == 0.0).count();
                assert_eq!(checker.in_contact(&q).expect("a configuration").len(), touching);
            }
        }
        hulls += checker.work().hulls;
        meshes += checker.work().measures + checker.work().decisions;
    }
    println!("{free} free, {hulls} queries of hulls, {meshes} of other bodies");
    assert!(free > 60 && hulls > 0, "{free} {hulls}");
}

/// Certificates ask no hull: they are those of the meshes.
#[test]
fn segments_have_the_verdicts_of_the_meshes() {
    let (mut free, mut blocked) = (0, 0);
    for seed in 0..4 {
        let (mut checker, mut judge) = (room(seed), room(seed));
        let mut rng = Rng::new(200 + seed);
        for _ in 0..30 {
            let from = sample(&checker, &mut rng);
            let to = sample(&checker, &mut rng);
            let to = checker.space().between(&from, &to, 0.3);
            let verdict = checker.verdict_of(&JointMotion::segment(&from, &to));
            let before = judge.work().hulls;
            let proof = crate::prove(&mut judge, &JointMotion::segment(&from, &to)).expect("a segment");
            assert_eq!(verdict.is_free(), proof.is_some(), "{verdict:?}");
            assert!(proof.is_none() || judge.work().hulls == before);
            let found = checker.is_free(&JointMotion::segment(&from, &to)).expect("a segment");
            assert_eq!(found, proof.is_some());
            let Some(([safe, t], pair)) = plans::blocked(&verdict) else {
                free += 1;
                continue;
            };
            blocked += 1;
            let at = |t: f64| checker.space().between(&from, &to, t);
            let all = distances(&checker, &at(t));
            let CellBody::Obstacle(k) = pair.b else {
                panic!("{pair:?}")
            };
            assert!(all[k] < 1e-9, "{pair:?} at {t}: {}", all[k]);
            for k in 0..=20 {
                let all = distances(&checker, &at(safe * 0.999_999 * f64::from(k) / 20.0));
                assert!(
                    safe == 0.0 || all.iter().all(|d| *d > 0.0),
                    "free up to {safe}: {all:?}"
                );
            }
        }
    }
    println!("{free} free, {blocked} blocked");
    assert!(free > 15 && blocked > 15, "{free} {blocked}");
}

/// Two meshes whose boxes overlap, but not their hulls: no query of the meshes. In the notch of the
/// other, the meshes decide.
#[test]
fn meshes_are_not_queried_where_their_hulls_are_apart() {
    let mut cell = Cell::new();
    cell.robot_body("angle", angle());
    let turned = UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::PI);
    let other = cell.put("other", angle(), Isometry3::from_parts(Vector3::zeros().into(), turned));
    let space = RigidSpace::new([[-5.0, 5.0]; 3], 1.6, 1).expect("a space");
    let mut checker = Checker::new(space.clone(), cell.clone()).expect("a world");
    let at = |x: f64, y: f64| RigidSpace::configuration(&Isometry3::translation(x, y, 0.0));
    // The notches face each other. In the third place an arm of each is in the notch of the other.
    let [far, near, notch] = [at(-1.6, -1.6), at(-1.7, -1.55), at(-1.4, -1.51)];
    let apart = |checker: &mut Checker<RigidSpace>| {
        assert!(checker.is_free_at(&far).expect("a configuration"));
        assert!(checker.is_free_along(&JointMotion::segment(&far, &near)));
        assert!(checker.is_free(&JointMotion::segment(&near, &far)).expect("a segment"));
        let work = checker.work();
        assert_eq!((work.decisions, work.queries, work.measures), (0, 0, 0), "{work:?}");
        assert!(work.hulls >= 3, "{work:?}");
    };
    apart(&mut checker);
    // A copy of the world shares the hulls.
    apart(&mut Checker::new(space, checker.cell().clone()).expect("a world"));
    let before = checker.work();
    assert!(!checker.is_free_at(&at(-0.2, 0.2)).expect("a configuration"));
    assert_eq!(checker.work().decisions, before.decisions + 1);
    assert!(checker.is_free_at(&notch).expect("a configuration"));
    assert!(checker.work().decisions > before.decisions + 1);
    // The hull of a geometry that is replaced goes with it.
    let block = cuboid([4.0; 3]);
    let large = Mesh::from_convex(&block).expect("a mesh");
    checker.cell_mut().replace_obstacle(other, large).expect("the obstacle");
    assert!(!checker.is_free_at(&far).expect("a configuration"));
}

/// Hulls keep what each pair must keep: paddings, margins of pairs, an attached mesh and an open one.
#[test]
fn hulls_keep_what_each_pair_must_keep() {
    let (mut free, mut blocked, mut hulls) = (0, 0, 0);
    for seed in 0..3 {
        let mut checker = room(seed);
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.7]].map(Point3::from);
        let tent = Mesh::new(&corners, &[[0, 1, 3], [1, 2, 3]]).expect("an open mesh");
        let pose = Isometry3::translation(1.0, -1.0, 0.5);
        checker.cell_mut().put("tent", tent, pose);
        let grip = Isometry3::translation(1.2, 0.0, 0.3);
        let tool = checker.cell_mut().attach("angle", "tool", angle(), grip, &["angle"]);
        let tool = tool.expect("a tool");
        checker.cell_mut().set_margin(0.01).expect("a margin");
        checker.cell_mut().pad(tool, 0.15).expect("the tool");
        checker.cell_mut().pad("tent", 0.05).expect("the tent");
        let pair = checker.cell_mut().set_pair_margin("angle", "2", Some(0.4));
        pair.expect("a pair");
        // The least distance of a pair by the meshes alone, less what it must keep.
        let excess = |checker: &Checker<RigidSpace>, q: &[f64]| {
            let cell = checker.cell();
            let mut least = f64::INFINITY;
            for (other, _) in cell.bodies().filter(|(id, _)| matches!(id, CellBody::Obstacle(_))) {
                for mover in [CellBody::Robot(0), tool] {
                    let pair = CellPair::new(mover, other).expect("a pair");
                    let [a, b] = [mover, other].map(|id| checker.pose(id, q).expect("a body"));
                    let relative = RelativePose::new(&a, &b).expect("poses are poses");
                    let [a, b] = [mover, other].map(|id| cell.geometry(id).expect("a body"));
                    let distance = PairTracker::new().closest(a, b, &relative).distance.max(0.0);
                    least = least.min(distance - cell.required_distance(pair).distance);
                }
            }
            least
        };
        let mut judge = Checker::new(checker.space().clone(), checker.cell().clone()).expect("a world");
        let mut rng = Rng::new(400 + seed);
        for _ in 0..60 {
            let from = sample(&checker, &mut rng);
            let to = sample(&checker, &mut rng);
            let to = checker.space().between(&from, &to, 0.1);
            let least = excess(&checker, &from);
            if least.abs() > 1e-9 {
                let found = checker.is_free_at(&from).expect("a configuration");
                assert_eq!(found, least > 0.0, "{least}");
            }
            let verdict = checker.verdict_of(&JointMotion::segment(&from, &to));
            let proof = crate::prove(&mut judge, &JointMotion::segment(&from, &to)).expect("a segment");
            assert_eq!(verdict.is_free(), proof.is_some(), "{verdict:?}");
            free += u32::from(verdict.is_free());
            blocked += u32::from(!verdict.is_free());
        }
        hulls += checker.work().hulls;
    }
    println!("{free} free, {blocked} blocked, {hulls} queries of hulls");
    assert!(free > 0 && blocked > 0 && hulls > 0, "{free} {blocked} {hulls}");
}

#[test]
fn moving_meshes_have_the_verdicts_of_the_meshes() {
    let (mut free, mut blocked, mut hulls) = (0, 0, 0);
    for seed in 0..40 {
        let mut rng = Rng::new(500 + seed);
        let mut place = || Vector3::from([0; 3].map(|_| rng.range(-3.0, 3.0)));
        let [from, to] = [place(), place()].map(|at| [at.x, at.y, at.z]);
        let poses = [place(), place(), place()].map(|at| {
            let turn = UnitQuaternion::from_scaled_axis(at * 0.2);
            Isometry3::from_parts(at.into(), turn)
        });
        let mut cell = Cell::new();
        cell.robot_body("angle", angle());
        let poses = TimedPoses::new(&[0.0, 1.0, 3.0], &poses).expect("timed poses");
        cell.put_moving("other", angle(), poses);
        let space = TranslationSpace::new([[-5.0, 5.0]; 3], UnitQuaternion::identity(), 1).expect("a space");
        let mut checker = Checker::new(space, cell).expect("a world");
        let curve = bezier(&[from, to]);
        let curve = curve.with_times([0.5, 2.5]).expect("times");
        let verdict = checker.verdict_of(&JointMotion::curve(&curve));
        hulls += checker.work().hulls;
        let proof = crate::prove(&mut checker, &JointMotion::curve(&curve)).expect("a curve");
        assert_eq!(verdict.is_free(), proof.is_some(), "{seed}: {verdict:?}");
        free += u32::from(verdict.is_free());
        blocked += u32::from(!verdict.is_free());
    }
    println!("{free} free, {blocked} blocked, {hulls} queries of hulls");
    assert!(free > 0 && blocked > 0 && hulls > 0, "{free} {blocked} {hulls}");
}
