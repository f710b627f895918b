//! Receipts: what the writers write holds for a checker that shares no code with them, and a wrong
//! proof does not.

use lin_canny::impact::Tolerance;
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ContactState, Geometry, HalfSpace, PairTracker, RelativePose, Shape, Tracker, Velocity};
use lin_canny_plan::receipt::{Receipt, ReceiptError};
use lin_canny_plan::{
    Cell, CellBody, CertifyOptions, Checker, ConfigurationSpace, Drive, Joint, JointCurve, JointKind, JointMotion,
    JointTree, PlanError, PlanarSpace, RangeOptions, RigidSpace, TimedPoses, TranslationSpace, TreeJoint, Verdict,
};
use truth::arm::{self, motion};
use truth::casts::{SHAPES, aimed, body, rotation};
use truth::plans::{Ask, Furnish, bezier, cuboid};
use truth::rng::Rng;
use truth::support::piece_at;
use truth::tally::{is_whole, tenth};

#[path = "../../verify/tests/support/python.rs"]
#[allow(dead_code, reason = "the checkers' own tests use all of it")]
mod python;

/// What a receipt proves, or the first line that does not hold.
fn checked(text: &str) -> Result<String, String> {
    match python::judged(text) {
        (0, said) => Ok(said),
        (_, why) => Err(why),
    }
}

/// Checks a receipt that must hold, and returns its text and what it proves.
fn holds(receipt: &Receipt) -> [String; 2] {
    let text = receipt.to_string();
    match checked(&text) {
        Ok(said) => [text, said],
        Err(why) => panic!("{why}\n{text}"),
    }
}

/// The built-in arm in its cell.
fn arm() -> Checker<JointTree> {
    let (arm, cell) = arm::in_cell().expect("the built-in cell");
    Checker::new(arm, cell).expect("a cell")
}

/// Writes and checks the receipt of a segment; returns whether it is free, blocked later (1), at
/// the start (2) or undecided.
fn judge<C: ConfigurationSpace>(checker: &mut Checker<C>, from: &[f64], to: &[f64]) -> usize {
    let verdict = checker.verdict_of(&JointMotion::segment(from, to));
    let receipt = Receipt::motion(checker, &JointMotion::segment(from, to));
    if matches!(verdict, Verdict::Undecided { .. }) {
        assert!(matches!(receipt, Err(ReceiptError::Undecided { .. })), "{receipt:?}");
        return 3;
    }
    let receipt = receipt.unwrap_or_else(|error| panic!("{error}: {verdict:?} {from:?} {to:?}"));
    let [text, _] = holds(&receipt);
    let meets = text.contains("{\"meet\":[") || text.contains("{\"near\":[");
    let is_apart = text.starts_with("{\"receipt\":1,\"claim\":\"apart\"");
    match verdict {
        Verdict::Free { .. } => {
            assert!(is_apart && !meets, "{text}");
            0
        }
        Verdict::Blocked { free_until: safe, .. } if safe > 0.0 => {
            assert!(is_apart && meets, "{text}");
            1
        }
        _ => {
            assert!(!is_apart && meets, "{text}");
            2
        }
    }
}

#[test]
fn random_segments_of_an_arm_have_receipts() {
    let mut checker = arm();
    let mut rng = Rng::new(7);
    let mut counts = [0; 4];
    let mut size = 0;
    for k in 0..tenth(40) {
        let from = match k % 2 {
            0 => motion::carry(rng.uniform()),
            _ => checker.space().sample(&mut || rng.uniform()),
        };
        let most = if k % 4 < 2 { 0.3 } else { 2.0 };
        let step: Vec<f64> = (0..6).map(|_| rng.range(-most, most)).collect();
        let to = checker.space().moved(&from, &step);
        counts[judge(&mut checker, &from, &to)] += 1;
        if let Ok(receipt) = Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)) {
            let of_evidence = |line: &&str| line.starts_with("{\"plane\"") || line.starts_with("{\"balls\"");
            size = size.max(receipt.to_string().lines().filter(of_evidence).map(str::len).sum());
        }
    }
    println!("free, blocked, blocked at the start, undecided: {counts:?}; at most {size} bytes of evidence");
    assert!(
        !is_whole() || counts[0] > 4 && counts[1] > 4 && counts[2] > 0,
        "{counts:?}"
    );
}

#[test]
fn a_path_has_the_scene_once() {
    let mut checker = arm();
    let rows: Vec<Vec<f64>> = (0..=20).map(|k| motion::carry(f64::from(k) / 20.0)).collect();
    assert!(checker.is_free_along(&JointMotion::path(&rows).expect("a motion")));
    let receipt = Receipt::motion(&mut checker, &JointMotion::path(&rows).expect("a motion")).expect("a free path");
    let [text, _] = holds(&receipt);
    let count = |kind: &str| {
        text.lines()
            .filter(|line| line.starts_with(&format!("{{\"{kind}\"")))
            .count()
    };
    assert_eq!(
        [count("leg"), count("base"), count("joint"), count("body")],
        [20, 1, 6, 9 + 12]
    );
    println!("{} bytes, {} pieces of evidence", text.len(), receipt.certificates());
    // A path of several segments that is blocked has none.
    let first = vec![0.0, 0.3, 1.0, 0.0, 1.0, 0.0];
    let rows = [first.clone(), first, vec![0.0, 1.7, 0.0, 0.0, 0.0, 0.0]];
    let found = Receipt::motion(&mut checker, &JointMotion::path(&rows).expect("a motion")).unwrap_err();
    assert_eq!(found, ReceiptError::Blocked { piece: 1 });
}

/// Replaces the tail of lines that were changed.
fn sealed(lines: &[String]) -> String {
    let text: String = lines.iter().flat_map(|line| [line.as_str(), "\n"]).collect();
    // A receipt hashes the files that it names.
    let die = Geometry::from(cuboid([0.5; 3]));
    let far = Isometry3::translation(3.0, 0.0, 0.0);
    let outcome = Tracker::new().closest(
        die.as_polyhedron().expect("a box"),
        die.as_polyhedron().expect("a box"),
        &RelativePose::from_isometry(&far).expect("a pose"),
    );
    let mut hashed = Receipt::outcome([("a", &die), ("b", &die)], &far, &outcome).expect("a distance");
    hashed.add_file("text", text.as_bytes());
    let hash = hashed.to_string();
    let at = hash.find("\"sha256\":\"").expect("a hash") + 10;
    format!(
        "{text}{{\"end\":{},\"sha256\":\"{}\"}}\n",
        lines.len(),
        &hash[at..at + 64]
    )
}

#[test]
fn a_wrong_proof_is_refused() {
    let mut checker = arm();
    let mut rng = Rng::new(11);
    let mut counts = [0; 4];
    let mut tried = 0;
    while tried < 6 {
        let from = motion::carry(rng.uniform());
        let step: Vec<f64> = (0..6).map(|_| rng.range(-1.5, 1.5)).collect();
        let to = checker.space().moved(&from, &step);
        let Ok(Verdict::Blocked { free_until: safe, .. }) = checker.certify(&JointMotion::segment(&from, &to)) else {
            continue;
        };
        if !(safe > 0.1 && safe < 0.9) {
            continue;
        }
        tried += 1;
        let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)).expect("a receipt");
        let [text, _] = holds(&receipt);
        let lines: Vec<String> = text.lines().map(String::from).collect();
        let lines = &lines[..lines.len() - 1];
        assert_eq!(sealed(lines), text);
        // The whole segment is claimed to be free.
        let mut all = lines.to_vec();
        let at = all[0].find("\"until\":").expect("an end");
        let end = at + all[0][at..].find(',').expect("more");
        all[0].replace_range(at..end, "\"until\":\"0x1p0\"");
        counts[0] += usize::from(checked(&sealed(&all)).is_err());
        // A normal points the other way.
        let mut all = lines.to_vec();
        let plane = all
            .iter()
            .rposition(|line| line.starts_with("{\"plane\""))
            .expect("a plane");
        let turned = all[plane]
            .replace("[\"0x", "[\"-0x")
            .replace(",\"0x", ",\"-0x")
            .replace("--", "");
        counts[1] += usize::from(checked(&sealed(&[&all[..plane], &[turned], &all[plane + 1..]].concat())).is_err());
        // A pair is left out.
        all.remove(plane);
        counts[2] += usize::from(checked(&sealed(&all)).is_err());
        // The receipt is changed and not sealed again.
        let other = text.replacen("\"name\":\"table\"", "\"name\":\"tablet\"", 1);
        counts[3] += usize::from(checked(&other).is_err());
    }
    assert_eq!(counts, [6; 4]);
}

#[test]
fn random_curves_of_an_arm_have_receipts() {
    let mut checker = arm();
    let mut rng = Rng::new(9);
    let mut counts = [0; 3];
    for k in 0..tenth(12) {
        let start = match k % 2 {
            0 => motion::carry(rng.uniform()),
            _ => checker.space().sample(&mut || rng.uniform()),
        };
        let most = if k % 4 < 2 { 0.2 } else { 0.8 };
        let mut points = vec![start];
        for _ in 0..[2, 3, 5, 7][k % 4] {
            let step: Vec<f64> = (0..6).map(|_| rng.range(-most, most)).collect();
            points.push(checker.space().moved(&points[points.len() - 1], &step));
        }
        let Ok(curve) = JointCurve::bezier(&points) else {
            panic!("{points:?}")
        };
        let Ok(verdict) = checker.certify(&JointMotion::curve(&curve)) else {
            continue;
        };
        let receipt = Receipt::motion(&mut checker, &JointMotion::curve(&curve))
            .unwrap_or_else(|error| panic!("{error} {verdict:?}"));
        let [text, _] = holds(&receipt);
        counts[usize::from(!verdict.is_free())] += 1;
        // The control points matter: another curve has other legs, and needs another proof.
        let line = text.lines().find(|line| line.starts_with("{\"leg\"")).expect("a leg");
        assert_eq!(line.matches('[').count(), points.len() + 1);
        if verdict.is_free() {
            let spline = [curve.clone(), bezier(&[curve.at(1.0), curve.at(1.0)])];
            let spline =
                Receipt::motion(&mut checker, &JointMotion::spline(&spline).expect("a motion")).expect("a free spline");
            counts[2] += usize::from(holds(&spline)[1].contains("each of 2 legs"));
        }
    }
    println!("free, blocked, splines: {counts:?}");
    assert_eq!(counts[2], counts[0]);
    assert!(!is_whole() || counts[0] > 2 && counts[1] > 2, "{counts:?}");
}

/// A range around a configuration, of a width that grows with the number.
fn range_around(q: &[f64], checker: &Checker<JointTree>, half: f64) -> [Vec<f64>; 2] {
    let step = vec![half; q.len()];
    let back: Vec<f64> = step.iter().map(|x| -x).collect();
    [checker.space().moved(q, &back), checker.space().moved(q, &step)]
}

#[test]
fn ranges_of_an_arm_have_receipts() {
    let mut checker = arm();
    let mut rng = Rng::new(21);
    let (mut proven, mut cells, mut bytes, mut refused) = (0, 0, 0, 0);
    for k in 0..3 {
        let q = motion::carry(rng.uniform());
        let [low, high] = range_around(&q, &checker, [0.03, 0.15, 0.4][k % 3]);
        let options = RangeOptions::default().cells(2000);
        let answers = checker.answers_over(&options, &low, &high);
        let never = answers.iter().filter(|answer| answer.is_never()).count();
        let receipt = Receipt::range(&checker, &answers, 4000).expect("a receipt");
        let [text, said] = holds(&receipt);
        let stated = said
            .lines()
            .find(|line| line.contains("pairs of bodies stay"))
            .expect("a claim");
        let count: usize = stated.split(' ').nth(1).expect("a number").parse().expect("a number");
        println!("{count} of {never} pairs that never meet, of {}", answers.len());
        // What is missing are pairs of the base and an obstacle, which both rest.
        assert!(count <= never, "{said}");
        assert!(count + 12 >= never, "{said}");
        assert!(!said.contains("too many cells"), "{said}");
        proven += count;
        cells += receipt.certificates();
        bytes += text
            .lines()
            .filter(|line| line.starts_with("{\"cell\""))
            .map(str::len)
            .sum::<usize>();
        // A wider range with the same evidence.
        let lines: Vec<String> = text.lines().map(String::from).collect();
        let mut lines = lines[..lines.len() - 1].to_vec();
        lines.retain(|line| !line.starts_with("{\"cell\":[7,"));
        refused += usize::from(checked(&sealed(&lines)).is_err());
    }
    println!("{proven} pairs, {cells} cells, {bytes} bytes");
    assert_eq!(refused, 3);
}

/// A library that takes an obstacle to be elsewhere proves segments free that are not.
#[test]
fn a_proof_of_a_library_that_errs_is_refused() {
    let mut rng = Rng::new(15);
    let mut refused = 0;
    for _ in 0..300 {
        let from = motion::carry(rng.uniform());
        let mut checker = arm();
        let step: Vec<f64> = (0..6).map(|_| rng.range(-0.6, 0.6)).collect();
        let to = checker.space().moved(&from, &step);
        let Ok(Verdict::Blocked { pair, .. }) = checker.certify(&JointMotion::segment(&from, &to)) else {
            continue;
        };
        if !matches!(pair.b, CellBody::Obstacle(_)) {
            continue;
        }
        let path = [from.clone(), to.clone()];
        let truth = Receipt::scene(&checker, &JointMotion::path(&path).expect("a motion"))
            .expect("a scene")
            .to_string();
        let elsewhere = Isometry3::translation(0.0, 0.0, -3.0);
        checker
            .cell_mut()
            .move_obstacle(pair.b, elsewhere)
            .expect("an obstacle");
        if !checker.is_free_along(&JointMotion::segment(&from, &to)) {
            continue;
        }
        let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)).expect("a receipt");
        let [text, _] = holds(&receipt);
        let is_body = |line: &&str| line.starts_with("{\"body\"");
        let mut bodies = truth.lines().filter(is_body);
        let lines = text.lines().map(|line| match is_body(&line) {
            true => bodies.next().expect("as many bodies").to_string(),
            false => line.to_string(),
        });
        let lines: Vec<String> = lines.collect();
        let said = checked(&sealed(&lines[..lines.len() - 1])).expect_err("a false claim");
        assert!(said.starts_with("does not hold"), "{said}");
        refused += 1;
    }
    println!("{refused} refused");
    assert!(refused > 4, "{refused}");
}

/// Sizes of a path's receipt and times to check it: run with `--ignored --nocapture`.
#[test]
#[ignore = "a measurement: cargo test -p lin-canny-plan --test receipts sizes -- --ignored --nocapture"]
fn sizes_and_times() {
    let mut checker = arm();
    for segments in [1, 11, 20] {
        let rows: Vec<Vec<f64>> = match segments {
            1 => vec![motion::carry(0.0), motion::carry(1.0 / 11.0)],
            _ => (0..=segments)
                .map(|k| motion::carry(f64::from(k) / f64::from(segments)))
                .collect(),
        };
        let receipt = Receipt::motion(&mut checker, &JointMotion::path(&rows).expect("a motion")).expect("a receipt");
        let text = receipt.to_string();
        let scene = Receipt::scene(&checker, &JointMotion::path(&rows).expect("a motion"))
            .expect("a scene")
            .to_string();
        let bytes = |kinds: &[&str]| -> usize {
            let lines = text
                .lines()
                .filter(|line| kinds.iter().any(|kind| line.starts_with(kind)));
            lines.map(|line| line.len() + 1).sum()
        };
        let evidence = bytes(&["{\"plane\"", "{\"balls\""]);
        let count = |line: &str| match line.strip_prefix("{\"balls\":[") {
            Some(rest) => rest[..rest.find(']').expect("a list")].matches(',').count(),
            None => usize::from(line.starts_with("{\"plane\"")),
        };
        let pairs: usize = text.lines().map(count).sum();
        let timed = |text: &str| {
            let times = (0..10).map(|_| {
                let started = std::time::Instant::now();
                let found = lin_canny_verify::verify(text.as_bytes()).expect("a receipt");
                (started.elapsed().as_secs_f64(), found)
            });
            times.min_by(|x, y| x.0.total_cmp(&y.0)).expect("a time")
        };
        let ((time, found), (idle, _)) = (timed(&text), timed(&scene));
        let lin_canny_verify::Verdict::Holds(report) = found else {
            panic!("{found}")
        };
        println!(
            "{segments} segments: {} bytes, legs {}, evidence {evidence} ({} a segment); {pairs} certificates of pairs in {} \
             lines, {} wide; {:.2} ms, scene {:.2} ms, {:.1} us a certificate",
            text.len(),
            bytes(&["{\"leg\""]),
            evidence / segments as usize,
            report.certificates,
            report.wide,
            time * 1e3,
            idle * 1e3,
            (time - idle) * 1e6 / pairs as f64,
        );
    }
}

#[test]
fn bodies_that_move_as_one_have_receipts() {
    let mut rng = Rng::new(3);
    let mut counts = [0; 4];
    let cell = || {
        let mut cell = Cell::new();
        cell.robot_body("rod", cuboid([0.5, 0.1, 0.1]));
        cell.robot_body("ball", Shape::ball(0.15).expect("a ball"));
        let block = cuboid([0.2, 1.0, 2.0]);
        for y in [1.3, -1.3] {
            cell.put(
                cell.free_name("wall"),
                block.clone(),
                Isometry3::translation(0.0, y, 0.0),
            );
        }
        cell.put(
            "knob",
            Shape::ball(0.2).expect("a ball"),
            Isometry3::translation(1.0, 0.3, 0.0),
        );
        cell.set_margin(0.01).expect("a margin");
        cell
    };
    let space = RigidSpace::new([[-2.0, 2.0]; 3], 0.5, 2).expect("a space");
    let mut checker = Checker::new(space, cell()).expect("a world");
    for _ in 0..30 {
        let [from, to] = [(); 2].map(|()| checker.space().sample(&mut || rng.uniform()));
        counts[judge(&mut checker, &from, &to)] += 1;
    }
    let space = PlanarSpace::new([[-2.0, 2.0]; 2], 0.5, 2).expect("a space");
    let mut checker = Checker::new(space, cell()).expect("a world");
    for _ in 0..30 {
        let [from, to] = [(); 2].map(|()| checker.space().sample(&mut || rng.uniform()));
        counts[judge(&mut checker, &from, &to)] += 1;
    }
    let turn = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
    let space = TranslationSpace::new([[-2.0, 2.0]; 3], turn, 2).expect("a space");
    let mut checker = Checker::new(space, cell()).expect("a world");
    for _ in 0..30 {
        let [from, to] = [(); 2].map(|()| checker.space().sample(&mut || rng.uniform()));
        counts[judge(&mut checker, &from, &to)] += 1;
    }
    assert!(counts[0] > 10 && counts[1] > 10 && counts[2] > 5, "{counts:?}");
}

/// A slide, a turn and a joint that mimics it, an attached object, a padding and a margin of a
/// pair.
#[test]
fn a_tree_with_attached_objects_and_margins_has_receipts() {
    let joint = |parent: usize, kind, origin: Isometry3<f64>, axis, drive| TreeJoint {
        parent,
        kind,
        origin,
        axis,
        drive,
    };
    let mimic = Drive {
        coordinate: 1,
        factor: -0.5,
        offset: 0.2,
    };
    let turned = Isometry3::new(Vector3::new(0.3, 0.0, 0.2), Vector3::new(0.3, -0.2, 0.5));
    let joints = vec![
        joint(
            0,
            JointKind::Prismatic,
            Isometry3::translation(0.0, 0.1, 0.0),
            Vector3::x_axis(),
            Some(Drive::by(0)),
        ),
        joint(1, JointKind::Revolute, turned, Vector3::z_axis(), Some(Drive::by(1))),
        TreeJoint::fixed(2, Isometry3::new(Vector3::new(0.5, 0.0, 0.0), Vector3::x())),
        joint(
            3,
            JointKind::Revolute,
            Isometry3::identity(),
            Vector3::y_axis(),
            Some(mimic),
        ),
    ];
    let limits = vec![[-1.0, 1.0], [-2.0, 2.0]];
    let base = Isometry3::new(Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.0, 0.1, 0.0));
    let space = JointTree::new(base, joints, limits, vec![0, 2, 4], vec![0.5; 5]).expect("a tree");
    let mut cell = Cell::new();
    cell.robot_body("foot", cuboid([0.1, 0.1, 0.4]));
    cell.robot_body("upper \"arm\"\u{202e}", Shape::capsule(0.2, 0.05).expect("a capsule"));
    cell.robot_body("hand", solids::octahedron(0.15).expect("a body"));
    cell.carry(
        "hand",
        "part",
        Shape::cylinder(0.1, 0.05).expect("a cylinder"),
        turned,
        &["hand"],
    );
    cell.put(
        "post",
        solids::prism(7, 0.5, 0.1).expect("a prism"),
        Isometry3::translation(0.9, 0.5, 0.5),
    );
    cell.put(
        "cone",
        Shape::cone(0.2, 0.1).expect("a cone"),
        Isometry3::translation(-0.4, -0.9, 0.7),
    );
    cell.set_margin(0.002).expect("a margin");
    cell.pad("post", 0.01).expect("a body");
    cell.set_pair_margin("hand", "cone", Some(0.03)).expect("a pair");
    cell.exclude("foot", "upper \"arm\"\u{202e}").expect("a pair");
    let mut checker = Checker::new(space, cell).expect("a world");
    let mut rng = Rng::new(5);
    let mut counts = [0; 2];
    for _ in 0..60 {
        let [from, to] = [(); 2].map(|()| checker.space().sample(&mut || rng.uniform()));
        let is_free = checker.is_free_along(&JointMotion::segment(&from, &to));
        let receipt = match Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)) {
            Ok(receipt) => receipt,
            // A cylinder or a cone has no points of a contact.
            Err(ReceiptError::Pair { a, b, why, .. }) if !is_free => {
                assert!(a == "part" || b == "part" || b == "cone", "{a} {b}: {why}");
                continue;
            }
            Err(error) => panic!("{error} {from:?} {to:?}"),
        };
        let [text, _] = holds(&receipt);
        assert!(text.contains("\"ellipsoids\":[[0,") && text.contains("\"upper _arm__\""));
        assert!(text.contains("\"keep\":\"0x1.eb851eb851eb8p-6\"") || !is_free, "{text}");
        counts[usize::from(is_free)] += 1;
    }
    assert!(counts[0] > 10 && counts[1] > 10, "{counts:?}");
}

#[test]
fn casts_have_receipts() {
    let mut rng = Rng::new(13);
    let mut counts = [0; 3];
    for k in 0..120 {
        let bodies = [0, 1].map(|_| body(SHAPES[rng.below(SHAPES.len())], 24, &mut rng));
        let throw = aimed(&mut rng, (1.0, 1.0), if k % 3 == 0 { 0.0 } else { 2.0 });
        let [a, b] = throw.motions();
        let push = Vector3::from(rng.in_ball());
        let b = if k % 5 == 0 {
            b.with_acceleration(push).expect("finite")
        } else {
            b
        };
        let margin = if k % 4 == 0 { 0.05 } else { 0.0 };
        let shapes = bodies.map(|body| {
            let rounding = if k % 7 == 0 { 0.1 } else { 0.0 };
            Geometry::from(Shape::from(body).rounded(rounding).expect("a radius"))
        });
        let named = [("a", &shapes[0]), ("b", &shapes[1])];
        let receipt = Receipt::cast(named, [&a, &b], 0.0..1.0, Tolerance::Distance(1e-6), margin);
        let receipt = receipt.unwrap_or_else(|error| panic!("{k}: {error}"));
        let [text, _] = holds(&receipt);
        let meets = text.contains("{\"meet\":[") || text.contains("{\"near\":[");
        counts[if meets { usize::from(!text.contains("apart")) } else { 2 }] += 1;
    }
    assert!(counts[0] > 20 && counts[2] > 20, "{counts:?}");
}

/// A wall without end turns about its foot while a ball flies by or into it.
#[test]
fn casts_at_a_half_space_that_turns_have_receipts() {
    let mut rng = Rng::new(17);
    let mut counts = [0; 2];
    for _ in 0..60 {
        let wall = Geometry::from(HalfSpace::new(Vector3::from(rng.unit()), rng.range(-0.5, 0.5)).expect("a plane"));
        let die = Geometry::from(cuboid([rng.range(0.1, 0.4); 3]));
        let any = |rng: &mut Rng, far: f64| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
            let at = Isometry3::from_parts((Vector3::from(rng.unit()) * far).into(), turn);
            let velocity = Velocity::new(Vector3::from(rng.in_ball()), Vector3::from(rng.in_ball()));
            Steady::new(&at, velocity).expect("a motion")
        };
        let [a, b] = [any(&mut rng, 0.5), any(&mut rng, 3.0)];
        let (named, motions) = match rng.below(2) {
            0 => ([("wall", &wall), ("die", &die)], [&a, &b]),
            _ => ([("die", &die), ("wall", &wall)], [&b, &a]),
        };
        let receipt = Receipt::cast(named, motions, 0.0..1.0, Tolerance::Distance(1e-6), 0.0).expect("a receipt");
        let [text, _] = holds(&receipt);
        counts[usize::from(text.contains("{\"near\":["))] += 1;
    }
    assert!(counts[0] > 10 && counts[1] > 10, "{counts:?}");
}

/// A body without joints among obstacles that move: one leg between two poses of every obstacle. Times at some pieces
/// of a spline are none.
#[test]
fn moving_obstacles_need_a_clock_and_one_leg_for_a_body_without_joints() {
    let at = |y: f64| Isometry3::translation(2.0, y, 0.0);
    let mut cell = Cell::new();
    cell.robot_body("drone", Shape::ball(0.2).expect("a ball"));
    let crossing = TimedPoses::new(&[0.0, 4.0, 6.0], &[at(-4.0), at(4.0), at(9.0)]).expect("timed poses");
    cell.put_moving("train", Shape::ball(0.5).expect("a ball"), crossing);
    let space = TranslationSpace::new([[-9.0, 9.0]; 3], UnitQuaternion::identity(), 1).expect("a space");
    let mut checker = Checker::new(space, cell).expect("a world");
    let flight = |times: [f64; 2]| {
        let segment = JointMotion::segment(&[0.0; 3], &[4.0, 0.0, 0.0]);
        segment.with_times(&times).expect("times")
    };
    holds(&Receipt::motion(&mut checker, &flight([0.0, 2.0])).expect("it is past before the train arrives"));
    // The train is met.
    let [text, _] = holds(&Receipt::motion(&mut checker, &flight([1.0, 3.0])).expect("a contact"));
    assert!(text.contains("{\"near\":["), "{text}");
    // Its pose at 4 s lies between: two legs would state the drone's own motion twice.
    let error = Receipt::motion(&mut checker, &flight([3.5, 4.5])).unwrap_err();
    assert!(matches!(error, ReceiptError::Motion { .. }), "{error}");
    assert!(Receipt::scene(&checker, &JointMotion::segment(&[0.0; 3], &[1.0; 3])).is_err());
    assert!(Receipt::scene(&checker, &flight([5.0, 7.0])).is_err());

    let slide = Joint::prismatic(Isometry3::identity(), Vector3::z_axis(), [-9.0, 9.0]);
    let tree = JointTree::serial(Isometry3::identity(), vec![slide], vec![1], 1.0).expect("a tree");
    let mut checker = Checker::new(tree, checker.cell().clone()).expect("a world");
    let ends = [[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let curves: Vec<JointCurve> = ends
        .iter()
        .enumerate()
        .map(|(k, [from, to])| {
            let curve = bezier(&[[*from], [*to]]);
            match k {
                1 => curve,
                _ => curve.with_times([k as f64, k as f64 + 1.0]).expect("times"),
            }
        })
        .collect();
    let partly = JointMotion::spline(&curves).expect("a spline");
    let whole = partly.clone().with_times(&[0.0, 0.5, 1.0, 1.5]).expect("times");
    let found = checker
        .certify_with(&whole, CertifyOptions::default())
        .expect("a motion");
    assert!(found.verdict.is_free());
    holds(&Receipt::certified(&checker, &whole, &found).expect("a receipt"));
    let error = Receipt::certified(&checker, &partly, &found).unwrap_err();
    assert!(matches!(error, ReceiptError::Plan(PlanError::NoTime(_))), "{error}");
}

#[test]
fn distances_and_overlaps_have_receipts() {
    let mut rng = Rng::new(17);
    let mut counts = [0; 3];
    for k in 0..300 {
        let bodies = [0, 1].map(|_| body(SHAPES[rng.below(SHAPES.len())], 20, &mut rng));
        let at = Isometry3::from_parts(
            (Vector3::from(rng.unit()) * rng.range(0.3, 3.0)).into(),
            rotation(&mut rng),
        );
        let pose = RelativePose::from_isometry(&at).expect("a pose");
        let rounding = if k % 5 == 0 { 0.1 } else { 0.0 };
        let outcome = match rounding > 0.0 {
            true => {
                let [a, b] = bodies
                    .each_ref()
                    .map(|body| Shape::from(body.clone()).rounded(rounding).expect("a radius"));
                PairTracker::new().closest(&a, &b, &pose).outcome
            }
            false if k % 2 == 0 => Tracker::new().closest(&bodies[0], &bodies[1], &pose),
            false => Tracker::new().closest_exact(&bodies[0], &bodies[1], &pose),
        };
        let shapes = bodies.map(|body| Geometry::from(Shape::from(body).rounded(rounding).expect("a radius")));
        let receipt = Receipt::outcome([("a", &shapes[0]), ("b", &shapes[1])], &at, &outcome);
        let receipt = receipt.unwrap_or_else(|error| panic!("{k}: {error} {outcome:?}"));
        let [text, _] = holds(&receipt);
        match outcome.state {
            ContactState::Separated => counts[usize::from(text.contains("normal"))] += 1,
            _ => counts[2] += usize::from(text.contains("{\"meet\":") || text.contains("{\"near\":")),
        }
    }
    println!("by features, by a normal, overlaps: {counts:?}");
    assert!(counts[0] > 100 && counts[2] > 30, "{counts:?}");
}

#[test]
fn what_has_no_receipt_is_an_error_with_a_name() {
    let space = || TranslationSpace::new([[-9.0, 9.0]; 3], UnitQuaternion::identity(), 1).expect("a space");
    let die = cuboid([0.5; 3]);

    // A contact at the start that is left, and a path of a rigid body.
    let mut cell = Cell::new();
    cell.robot_body("die", die.clone());
    cell.put("table", die.clone(), Isometry3::translation(0.0, 0.0, -1.0));
    let mut checker = Checker::new(space(), cell).expect("a world");
    checker.set_start_contact_margin(Some(1e-3)).expect("a margin");
    let (down, up) = ([0.0; 3], [0.0, 0.0, 2.0]);
    assert!(checker.is_free_along(&JointMotion::segment(&down, &up)));
    let error = Receipt::motion(&mut checker, &JointMotion::segment(&down, &up)).unwrap_err();
    assert_eq!(error, ReceiptError::Nothing);
    let path = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [2.0, 0.0, 1.0]].map(Vec::from);
    let error = Receipt::motion(&mut checker, &JointMotion::path(&path).expect("a motion")).unwrap_err();
    assert!(
        error.to_string().starts_with("the motion of \"die\" has no receipt"),
        "{error}"
    );
    assert!(
        holds(&Receipt::motion(&mut checker, &JointMotion::path(&path[..2]).expect("a motion")).expect("a segment"))[0]
            .contains("steady")
    );

    // Motions with unknown accelerations.
    let rest = Steady::new(&Isometry3::identity(), lin_canny::Velocity::default()).expect("a pose");
    let open = rest.with_acceleration_bounds(1.0, 0.0).expect("bounds");
    let die = Geometry::from(die);
    let bodies = [("still", &die), ("open", &die)];
    let error = Receipt::cast(bodies, [&rest, &open], 0.0..1.0, Tolerance::Time(1e-6), 0.0).unwrap_err();
    assert!(
        error.to_string().starts_with("the motion of \"open\" has no receipt"),
        "{error}"
    );
    assert_eq!(open.pivot(), Point3::origin());
}

/// Motions of the built-in arm past a round post, which stands as close as the arm leaves it free to a hundredth of a
/// millimetre; returns how many there are, and how many have a receipt.
fn past_a_round_post(seeds: core::ops::Range<u64>) -> [usize; 2] {
    let mut counts = [0; 2];
    for seed in seeds {
        let mut rng = Rng::new(seed);
        let (from, way) = (motion::carry(rng.uniform()), rng.range(0.05, 0.3));
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-way, way)).collect();
        let turn = rng.range(-3.0, 3.0);
        let direction = Vector3::new(turn.cos(), turn.sin(), 0.0);
        let tilt = UnitQuaternion::from_scaled_axis(Vector3::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5), 0.0));
        let (path, height) = (JointMotion::segment(&from, &to), rng.range(0.3, 1.0));
        let with_post = |far: f64| {
            let (arm, mut cell) = arm::in_cell().expect("the built-in cell");
            let at = Isometry3::from_parts((direction * far + Vector3::z() * height).into(), tilt);
            let post = Shape::cylinder(0.25, 0.06).expect("a post");
            cell.put("round post", post, at);
            Checker::new(arm, cell).expect("a cell")
        };
        let is_free = |far: f64| with_post(far).is_free(&path).expect("a segment");
        let (mut near, mut far) = (0.0, 3.0);
        if !is_free(far) || is_free(near) {
            continue;
        }
        while far - near > 1e-5 {
            let middle = 0.5 * (near + far);
            *(if is_free(middle) { &mut far } else { &mut near }) = middle;
        }
        counts[0] += 1;
        let receipt = Receipt::motion(&mut with_post(far), &path);
        holds(&receipt.unwrap_or_else(|error| panic!("{seed}: {error}")));
        counts[1] += 1;
    }
    counts
}

#[test]
fn paths_past_a_round_post_have_receipts() {
    let counts = past_a_round_post(0..12);
    println!("past a post, with a receipt: {counts:?}");
    assert!(counts[0] > 4 && counts[1] == counts[0], "{counts:?}");
}

#[test]
#[ignore = "90 paths take a minute: cargo test -p lin-canny-plan --all-features --test receipts ninety -- --ignored --nocapture"]
fn ninety_paths_past_a_round_post_have_receipts() {
    let mut counts = [0; 2];
    for seed in 0.. {
        let found = past_a_round_post(seed..seed + 1);
        counts = [counts[0] + found[0], counts[1] + found[1]];
        if counts[0] == 90 {
            break;
        }
    }
    println!("past a post, with a receipt: {counts:?}");
    assert_eq!(counts, [90, 90]);
}

#[test]
fn two_half_spaces_have_no_receipt_of_a_contact() {
    let wall =
        |x: f64, offset: f64| Geometry::from(HalfSpace::new(Vector3::new(x, 0.0, 1.0), offset).expect("a plane"));
    let (a, b, at) = (wall(0.0, -1.0), wall(1.0, -2.0), Isometry3::identity());
    let pose = RelativePose::from_isometry(&at).expect("a pose");
    let outcome = PairTracker::new().closest(&a, &b, &pose).outcome;
    let error = Receipt::outcome([("a", &a), ("b", &b)], &at, &outcome).unwrap_err();
    assert!(error.to_string().contains("half-space"), "{error}");
}

/// As many ends of cylinders as a checker reads, and more than it evaluates often.
#[test]
fn a_body_of_many_cylinders_has_a_receipt() {
    let rod = Shape::cylinder(0.01, 0.01).expect("a rod");
    let piece = |k: u32| {
        piece_at(
            Isometry3::translation(0.1 * f64::from(k % 100), 0.1 * f64::from(k / 100), 0.0),
            rod.clone(),
        )
    };
    let brush = Geometry::from(Compound::new((0..9000).map(piece).collect()).expect("a brush"));
    let die = Geometry::from(cuboid([0.5; 3]));
    let at = Isometry3::translation(0.0, 0.0, 40.0);
    let rest = Steady::new(&Isometry3::identity(), Velocity::default()).expect("rest");
    let flight = Steady::new(&at, Velocity::new(Vector3::x(), Vector3::zeros())).expect("a motion");
    let bodies = [("brush", &brush), ("die", &die)];
    let receipt = Receipt::cast(bodies, [&rest, &flight], 0.0..1.0, Tolerance::Distance(1e-6), 0.0);
    holds(&receipt.expect("a receipt"));
}
