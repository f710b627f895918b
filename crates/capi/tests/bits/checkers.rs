//! Checkers of a body that moves, of one that turns, and of a robot.

use std::ffi::CString;
use std::ops::ControlFlow;

use lin_canny_c::*;
use lin_canny_plan::{
    Cell, CellBody, Checker, ConfigurationSpace, JointCurve, JointMotion, NearPair, Path, PlanMethod, PlanOptions,
    RigidSpace, Shortcuts, TranslationSpace, Verdict,
};
use lin_canny_robot::RobotFiles;

use super::*;

/// Configurations of each of the three checkers.
const EACH: usize = QUERIES / 2 + 1;

const BOUNDS: [[f64; 2]; 3] = [[-4.0, 4.0]; 3];

/// Returns a world of a body, and a checker of C of the same body.
fn body(radius: f64) -> (Cell, lc_checker) {
    let all = geometries();
    let mut cell = Cell::new();
    cell.robot_body("body", all[4].0.clone());
    // SAFETY: six numbers and a place for a handle.
    let c = written(|out| unsafe { lc_checker_new_body(all[4].1, BOUNDS.as_ptr().cast(), radius, out) });
    (cell, c)
}

/// Adds an obstacle of nearly every kind to both sides.
fn add_obstacles<C: ConfigurationSpace>(rust: &mut Checker<C>, c: lc_checker, random: &mut Random) {
    for (k, (geometry, handle)) in geometries().iter().enumerate().take(9) {
        let (pose, name) = (random.pose(3.0), format!("obstacle {k}"));
        rust.cell_mut().add_obstacle(&name, geometry.clone(), pose).unwrap();
        let name = CString::new(name).unwrap();
        // SAFETY: a text, a pose and a place for an id.
        written(|out| unsafe { lc_checker_obstacle_add(c, name.as_ptr(), *handle, &of(&pose), out) });
    }
}

#[test]
fn a_body_that_moves_has_the_bits_of_rust() {
    let mut random = Random(18);
    let (cell, c) = body(0.0);
    let space = TranslationSpace::new(BOUNDS, UnitQuaternion::identity(), 1).unwrap();
    let mut rust = Checker::new(space, cell).unwrap();
    add_obstacles(&mut rust, c, &mut random);
    let q: Vec<f64> = (0..EACH).flat_map(|_| random.vector(3.9)).collect();
    compare(&mut rust, c, &q, 3);
    compare_curves(&mut rust, c, &q, 3);
    ok(lc_checker_free(c));
}

#[test]
fn a_body_that_turns_has_the_bits_of_rust() {
    let mut random = Random(12);
    let (cell, c) = body(0.5);
    let mut rust = Checker::new(RigidSpace::new(BOUNDS, 0.5, 1).unwrap(), cell).unwrap();
    add_obstacles(&mut rust, c, &mut random);
    let q: Vec<f64> = (0..EACH)
        .flat_map(|_| RigidSpace::configuration(&random.pose(3.0)))
        .collect();
    compare(&mut rust, c, &q, 7);
    ok(lc_checker_free(c));
}

#[test]
fn a_robot_has_the_bits_of_rust() {
    let mut random = Random(19);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../robot/examples");
    let mut files = RobotFiles::new(format!("{folder}/six_axis.urdf"));
    files.srdf = Some(format!("{folder}/six_axis.srdf").into());
    files.cell = Some(format!("{folder}/six_axis_cell.json").into());
    let mut rust = Checker::of_robots(files.load().unwrap().cell).unwrap();
    let texts = ["six_axis.urdf", "six_axis.srdf", "six_axis_cell.json"]
        .map(|file| CString::new(format!("{folder}/{file}")).unwrap());
    let [robot, srdf, cell] = texts.each_ref().map(|text| text.as_ptr());
    let files = lc_robot_files {
        robot,
        srdf,
        cell,
        packages: null(),
        package_count: 0,
        flags: 0,
        reserved: 0,
    };
    // SAFETY: files of the stated size, whose texts live until the call ends, and a place for a
    // handle.
    let c = written(|out| unsafe { lc_checker_load(&files, size_of::<lc_robot_files>(), out) });
    let q: Vec<f64> = (0..6 * EACH).map(|_| random.uniform()).collect();
    compare(&mut rust, c, &q, 6);
    compare_curves(&mut rust, c, &q, 6);
    ok(lc_checker_free(c));
}

/// Returns the id of a body in C.
fn number(id: CellBody) -> u64 {
    match id {
        CellBody::Robot(k) => 1 << 56 | k as u64,
        CellBody::Attached(k) => 2 << 56 | k as u64,
        CellBody::Obstacle(k) => 3 << 56 | k as u64,
    }
}

fn same_near(r: &NearPair, c: &lc_near) {
    assert_eq!((number(r.pair.a), number(r.pair.b)), (c.a.id, c.b.id));
    let numbers = [r.distance, r.lower, r.upper, r.excess];
    assert_eq!(bits(numbers), bits([c.distance, c.lower, c.upper, c.excess]));
    let vectors = [r.witnesses[0].into(), r.witnesses[1].into(), r.normal.into()];
    assert_eq!(vectors.map(bits), [c.point_on_a, c.point_on_b, c.normal].map(bits));
}

fn same_numbers(r: &[f64], c: &[f64]) {
    assert!(
        r.iter().map(|x| x.to_bits()).eq(c.iter().map(|x| x.to_bits())),
        "{r:?} {c:?}"
    );
}

/// Compares verdicts, and returns whether the motion is blocked.
fn same_verdict(r: &Verdict, c: &lc_verdict) -> bool {
    let segment = r.piece().unwrap_or(0);
    assert_eq!(
        (segment as u64, r.free_until().to_bits()),
        (c.segment, c.free_until.to_bits())
    );
    match r {
        Verdict::Free { clearance, .. } => {
            assert_eq!((c.state, c.clearance.to_bits()), (LC_FREE, clearance.to_bits()));
            assert_eq!(c.contact_at, f64::INFINITY);
        }
        Verdict::Blocked {
            contact_at: t,
            pair,
            witnesses,
            ..
        } => {
            assert_eq!((c.state, c.contact_at.to_bits()), (LC_BLOCKED, t.to_bits()));
            assert_eq!((number(pair.a), number(pair.b)), (c.a.id, c.b.id));
            let points = witnesses.map(|point| bits(point.into()));
            assert_eq!(points, [c.point_on_a, c.point_on_b].map(bits));
            return true;
        }
        _ => assert_eq!((c.state, c.contact_at), (LC_OPEN, f64::INFINITY)),
    }
    false
}

/// Compares all queries at configurations, of the segments between each and the next, and of paths.
fn compare<C: ConfigurationSpace + Clone + Sync>(rust: &mut Checker<C>, c: lc_checker, q: &[f64], n: usize) {
    let count = q.len() / n;
    let at = |k: usize| &q[k * n..(k + 1) * n];
    let size = size_of::<lc_checker_info>();
    // SAFETY: a place for an answer.
    let info = written(|out| unsafe { lc_checker_get_info(c, out, size) });
    assert_eq!(info.coordinates, n);
    let freedom = info.degrees_of_freedom;
    let mut done = 0;

    let mut free = vec![9_u8; count];
    // SAFETY: as many configurations and places as stated.
    ok(unsafe { lc_checker_free_at_many(c, q.as_ptr(), n, count, free.as_mut_ptr(), &mut done) });
    assert_eq!(done, count);
    for (k, free) in free.iter().enumerate() {
        assert_eq!(u8::from(rust.is_free_at(at(k)).unwrap()), *free);
    }

    for k in 0..count {
        let body = CellBody::Robot(k % info.robot_bodies);
        let id = lc_world_body { id: number(body) };
        // SAFETY: a configuration and a place for a pose.
        let pose = written(|out| unsafe { lc_checker_pose(c, id, at(k).as_ptr(), n, out) });
        let r = of(&rust.pose(body, at(k)).unwrap());
        assert_eq!(bits(r.translation), bits(pose.translation));
        assert_eq!(bits(r.rotation), bits(pose.rotation));
    }

    let size = size_of::<lc_near>();
    let (mut found, mut gradients) = (Vec::<lc_near>::with_capacity(count), vec![0.0; count * freedom]);
    let (place, derivatives) = (found.as_mut_ptr(), gradients.as_mut_ptr());
    // SAFETY: as many configurations and places as stated.
    ok(unsafe { lc_checker_clearance_many(c, q.as_ptr(), n, count, place, size, derivatives, &mut done) });
    // SAFETY: all answers are written.
    unsafe { found.set_len(count) };
    for (k, (c, gradient)) in found.iter().zip(gradients.chunks(freedom)).enumerate() {
        let r = rust.clearance(at(k)).unwrap().unwrap();
        same_near(&r, c);
        same_numbers(&r.gradient, gradient);
    }

    let mut found = Vec::<lc_near>::with_capacity(3 * count);
    let mut gradients = vec![0.0; 3 * count * freedom];
    let (place, derivatives) = (found.as_mut_ptr(), gradients.as_mut_ptr());
    // SAFETY: as many configurations and places as stated.
    ok(unsafe { lc_checker_nearest_many(c, q.as_ptr(), n, count, 3, 1.0, 2, place, size, derivatives) });
    // SAFETY: all answers are written.
    unsafe { found.set_len(3 * count) };
    for k in 0..count {
        rust.reset();
        let near = rust.nearest(at(k), 1.0).unwrap();
        for j in 0..3 {
            let c = &found[3 * k + j];
            let Some(r) = near.get(j) else {
                assert_eq!((c.a.id, c.distance), (0, f64::INFINITY));
                continue;
            };
            same_near(r, c);
            same_numbers(&r.gradient, &gradients[(3 * k + j) * freedom..][..freedom]);
        }
    }
    // The checker of C has kept its state.
    let (rust, c) = (&mut fresh(rust), copy(c));

    let size = size_of::<lc_verdict>();
    let mut verdicts = Vec::<lc_verdict>::with_capacity(count - 1);
    let place = verdicts.as_mut_ptr();
    // SAFETY: as many segments and places as stated.
    ok(unsafe { lc_checker_certify_many(c, q.as_ptr(), q[n..].as_ptr(), n, count - 1, place, size, &mut done) });
    // SAFETY: all verdicts are written.
    unsafe { verdicts.set_len(count - 1) };
    let mut blocked = 0;
    for (k, c) in verdicts.iter().enumerate() {
        blocked += u32::from(same_verdict(
            &rust.certify(&JointMotion::segment(at(k), at(k + 1))).unwrap(),
            c,
        ));
    }
    assert!(blocked > 100, "{blocked} segments are blocked");

    let mut later = 0;
    for k in 0..count - 2 {
        let path = &q[k * n..(k + 3) * n];
        // SAFETY: three configurations and a place for a verdict.
        let c = written(|out| unsafe { lc_checker_certify_path(c, path.as_ptr(), n, 3, out, size) });
        let path: Path = path.chunks(n).map(<[f64]>::to_vec).collect();
        let r = rust.certify(&JointMotion::path(&path).unwrap()).unwrap();
        same_verdict(&r, &c);
        later += r.piece().unwrap_or(0);
    }
    assert!(later > 100, "{later} paths are blocked in their second segment");

    compare_plans(rust, c, q, n);
    ok(lc_checker_free(c));
}

/// Returns a checker without state.
fn fresh<C: ConfigurationSpace + Clone>(rust: &Checker<C>) -> Checker<C> {
    Checker::new(rust.space().clone(), rust.cell().clone()).unwrap()
}

/// Returns a checker without state.
fn copy(c: lc_checker) -> lc_checker {
    // SAFETY: a place for a handle.
    written(|out| unsafe { lc_checker_copy(c, out) })
}

/// Compares searches with small budgets between each configuration and the next.
fn compare_plans<C: ConfigurationSpace>(rust: &mut Checker<C>, c: lc_checker, q: &[f64], n: usize) {
    let at = |k: usize| &q[k * n..(k + 1) * n];
    let (mut found, mut refused) = (0, 0);
    for k in 0..q.len() / n - 1 {
        let (seed, tries) = (k as u64, k % 4);
        let options = PlanOptions::default().seed(seed).samples(8).slices(1).queries(300);
        let mut unwatched = |_| ControlFlow::Continue(());
        let r = PlanMethod::ALL[k % 2].plan(rust, [at(k), at(k + 1)], &options, &mut unwatched);
        let r = r.map(|plan| {
            plan.path
                .map(|path| Shortcuts::new(tries, seed).shorten(rust, &path).unwrap())
        });
        let options = lc_plan_options {
            seed,
            slices: 1,
            queries: 300,
            shorten: tries as u64,
            samples: 8,
            method: (k % 2) as u32,
            reserved: 0,
        };
        let (from, to, size, mut count) = (at(k).as_ptr(), at(k + 1).as_ptr(), size_of::<lc_plan_options>(), 0);
        // SAFETY: two configurations, options of the stated size and a place for a count.
        let status = unsafe { lc_checker_plan(c, from, to, n, &options, size, None, null_mut(), &mut count) };
        let Ok(r) = r else {
            assert_eq!(status, lc_status::LC_REFUSED);
            refused += 1;
            continue;
        };
        ok(status);
        let r = r.unwrap_or_default();
        assert_eq!(r.len(), count);
        let mut path = vec![0.0; count * n];
        // SAFETY: as many places as stated.
        ok(unsafe { lc_checker_path(c, path.as_mut_ptr(), n, count, &mut count) });
        assert_eq!(r.len(), count);
        same_numbers(&r.concat(), &path);
        found += usize::from(count > 0);
    }
    assert!(found > 50, "{found} paths, {refused} refused ends");
}

/// Compares curves of two to five control points.
fn compare_curves<C: ConfigurationSpace + Clone>(rust: &mut Checker<C>, c: lc_checker, q: &[f64], n: usize) {
    let (rust, c) = (&mut fresh(rust), copy(c));
    let size = size_of::<lc_verdict>();
    let mut blocked = 0;
    for k in 0..q.len() / n - 1 {
        let end = (k + 2 + k % 4).min(q.len() / n);
        let points = &q[k * n..end * n];
        let count = end - k;
        // SAFETY: as many control points as stated, and a place for a verdict.
        let c = written(|out| unsafe { lc_checker_certify_curve(c, points.as_ptr(), n, count, out, size) });
        let points: Path = points.chunks(n).map(<[f64]>::to_vec).collect();
        let r = rust
            .certify(&JointMotion::curve(&JointCurve::bezier(&points).unwrap()))
            .unwrap();
        blocked += u32::from(same_verdict(&r, &c));
    }
    assert!(blocked > 100, "{blocked} curves are blocked");
    ok(lc_checker_free(c));
}
