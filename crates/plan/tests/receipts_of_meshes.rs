//! Receipts about meshes and compounds: groups of parts, and bodies that could be inside each other.

use lin_canny::impact::Tolerance;
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Compound, ContactState, Geometry, Mesh, Outcome, PairTracker, Piece, RelativePose, RepairOptions, Shape, Velocity,
};
use lin_canny_plan::receipt::{Receipt, ReceiptError};
use lin_canny_plan::{Cell, Checker, Joint, JointMotion, JointTree, RangeOptions, TranslationSpace, Verdict};
use truth::casts::aimed;
use truth::plans::{Ask, Furnish, cuboid};
use truth::rng::Rng;

#[path = "../../verify/tests/support/python.rs"]
#[allow(dead_code, reason = "the checkers' own tests use all of it")]
mod python;

/// A receipt that must hold: its text and what it proves.
fn holds(receipt: &Receipt) -> [String; 2] {
    let text = receipt.to_string();
    let (code, said) = python::judged(&text);
    assert_eq!(code, 0, "{said}\n{text}");
    [text, said]
}

/// A frame of four bars around a square hole of width 1, in the plane z = 0.
fn frame() -> Compound {
    let bar = |x: f64, y: f64, along_x: bool| {
        let half = if along_x { [1.0, 0.25, 0.25] } else { [0.25, 1.0, 0.25] };
        let mut piece = Piece::new(cuboid(half));
        piece.pose = Isometry3::translation(x, y, 0.0);
        piece
    };
    let bars = vec![
        bar(0.0, 0.75, true),
        bar(0.0, -0.75, true),
        bar(0.75, 0.0, false),
        bar(-0.75, 0.0, false),
    ];
    Compound::new(bars).expect("a frame")
}

/// A rod along z with a radius of about .3.
fn rod(kind: usize) -> Geometry {
    let rod = solids::prism(6, 0.8, 0.3).expect("a prism");
    match kind {
        0 => rod.into(),
        1 => Mesh::from_convex(&rod).expect("a mesh").into(),
        _ => Compound::new(vec![Piece::new(rod)]).expect("a body").into(),
    }
}

fn moved(rod: Geometry, around: Geometry) -> Checker<TranslationSpace> {
    let space = TranslationSpace::new([[-9.0, 9.0]; 3], UnitQuaternion::identity(), 1).expect("a space");
    let mut cell = Cell::new();
    cell.robot_body("rod", rod);
    cell.put("frame", around, Isometry3::identity());
    Checker::new(space, cell).expect("a world")
}

fn frames() -> [Geometry; 2] {
    let mesh = frame().to_mesh().expect("a mesh");
    [frame().into(), mesh.into()]
}

#[test]
fn a_receipt_says_that_a_mesh_was_repaired() {
    let block = Mesh::from_convex(&solids::cuboid(Vector3::repeat(0.5)).expect("a box")).expect("a mesh");
    let (points, triangles) = (block.vertices(), block.triangle_vertices());
    let repaired = |triangles: &[[u32; 3]]| Mesh::repaired(&points, triangles, &RepairOptions::default());
    for (kept, expected) in [(11, true), (12, false)] {
        let solid = repaired(&triangles[..kept]).expect("a mesh");
        let mut checker = moved(rod(0), solid.into());
        let motion = JointMotion::segment(&[2.0, 0.0, -3.0], &[2.0, 0.0, 3.0]);
        let receipt = Receipt::motion(&mut checker, &motion).expect("a receipt");
        let [_, said] = holds(&receipt);
        let what = "not looked at: the mesh of frame before its repair; changed, it says: 1 cap (8.33 % of the area, at \
                    most 3 corners)";
        assert_eq!(said.contains(what), expected, "{said}");
    }
}

const INSIDE: &str = "whether one is inside the other";

#[test]
fn a_rod_through_a_frame_has_a_receipt() {
    for around in frames() {
        for kind in 0..3 {
            let mut checker = moved(rod(kind), around.clone());
            // Through the hole, and within it.
            for (from, inside) in [(-3.0, false), (-0.2, true)] {
                let (from, to) = ([0.05, 0.0, from], [0.0, 0.05, 0.2]);
                assert!(checker.is_free_along(&JointMotion::segment(&from, &to)));
                let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)).expect("a receipt");
                let [text, said] = holds(&receipt);
                assert!(text.contains("\"cut\":["), "{text}");
                assert!(said.contains("1 pair of bodies stays more than 0 apart"), "{said}");
                let is_solid = text.contains("\"faces\":[");
                assert_eq!(said.contains(INSIDE), inside && is_solid, "{kind} {said}");
            }
        }
    }
}

/// From within the hole to a place where the hulls are apart: the way back proves the start.
#[test]
fn hulls_that_part_later_prove_that_no_body_is_inside() {
    let [_, around] = frames();
    let mut checker = moved(rod(1), around);
    let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&[0.0; 3], &[0.0, 0.0, 3.0])).expect("a receipt");
    let [text, said] = holds(&receipt);
    assert!(text.contains("{\"outside\":[0,1],"), "{text}");
    assert!(!said.contains(INSIDE), "{said}");
}

/// A small mesh within a hollow one touches no surface: the receipt does not say that it is free.
#[test]
fn a_body_inside_a_mesh_is_not_said_to_be_free() {
    let shell = cuboid([2.0; 3]);
    let grain = Geometry::from(Mesh::from_convex(&cuboid([0.1; 3])).expect("a mesh"));
    let solid = Geometry::from(Mesh::from_convex(&shell).expect("a mesh"));
    let mut checker = moved(grain.clone(), solid);
    let verdict = checker.verdict_of(&JointMotion::segment(&[0.0; 3], &[0.1, 0.0, 0.0]));
    assert!(matches!(verdict, Verdict::Blocked { .. }), "{verdict:?}");
    let error = Receipt::motion(&mut checker, &JointMotion::segment(&[0.0; 3], &[0.1, 0.0, 0.0])).unwrap_err();
    assert!(matches!(error, ReceiptError::Pair { .. }), "{error}");
    // Without a wall the box is no solid: its inside is free.
    let points = [-2.0, 2.0].map(|x| [-2.0, 2.0].map(|y| [-2.0, 2.0].map(|z| Point3::new(x, y, z))));
    let points: Vec<Point3<f64>> = points.into_iter().flatten().flatten().collect();
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4]];
    let triangles: Vec<[u32; 3]> = quads
        .iter()
        .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]])
        .collect();
    let open = Geometry::from(Mesh::new(&points, &triangles).expect("a mesh"));
    let mut checker = moved(grain, open);
    let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&[0.0; 3], &[0.1, 0.0, 0.0])).expect("a receipt");
    let [text, said] = holds(&receipt);
    assert!(text.contains("\"parts\":[") && text.contains("\"faces\":["), "{text}");
    assert!(said.contains(INSIDE), "{said}");
}

#[test]
fn a_rod_that_hits_a_frame_has_a_receipt() {
    let mut rng = Rng::new(21);
    let mut counts = [0; 3];
    for around in frames() {
        for k in 0..30 {
            let mut checker = moved(rod(k % 3), around.clone());
            let from = [rng.range(-0.2, 0.2), rng.range(-0.2, 0.2), rng.range(-2.0, 0.0)];
            let most = if k % 2 == 0 { 0.2 } else { 2.0 };
            let to = [rng.range(-most, most), rng.range(-most, most), rng.range(-1.0, 2.0)];
            let verdict = checker.verdict_of(&JointMotion::segment(&from, &to));
            let receipt = match (
                &verdict,
                Receipt::motion(&mut checker, &JointMotion::segment(&from, &to)),
            ) {
                (Verdict::Undecided { .. }, _) => continue,
                (_, Ok(receipt)) => receipt,
                (_, Err(error)) => panic!("{k}: {error} {verdict:?}"),
            };
            let [text, _] = holds(&receipt);
            let meets = text.contains("{\"meet\":[") || text.contains("{\"near\":[");
            assert_eq!(meets, !verdict.is_free(), "{text}");
            counts[usize::from(meets)] += 1;
            counts[2] += usize::from(text.contains("\"cut\":["));
        }
    }
    println!("free, blocked, with cuts: {counts:?}");
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

#[test]
fn casts_of_frames_that_turn_have_receipts() {
    let mut rng = Rng::new(22);
    let (mut counts, mut most) = ([0; 3], 0);
    let mesh = frame().to_mesh().expect("a mesh");
    for k in 0..80 {
        let size = if k % 4 < 2 { 2.0 } else { 0.4 };
        let throw = aimed(&mut rng, (size, size), 2.0);
        let [a, b] = throw.motions();
        let first = Geometry::from(frame());
        let second = match k % 4 {
            0 => Geometry::from(mesh.clone()),
            1 => Geometry::from(frame()),
            kind => rod(kind - 1),
        };
        let named = [("a", &first), ("b", &second)];
        let margin = if k % 3 == 0 { 0.02 } else { 0.0 };
        let receipt = Receipt::cast(named, [&a, &b], 0.0..1.0, Tolerance::Distance(1e-6), margin);
        let receipt = receipt.unwrap_or_else(|error| panic!("{k}: {error}"));
        let [text, said] = holds(&receipt);
        assert!(!said.contains(INSIDE), "{said}");
        most = most.max(receipt.certificates());
        counts[usize::from(text.contains("{\"meet\":[") || text.contains("{\"near\":["))] += 1;
        counts[2] += usize::from(text.contains("\"cut\":["));
    }
    println!("missed, hit, with cuts: {counts:?}; at most {most} certificates");
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

#[test]
fn pieces_keep_their_own_radii() {
    let mut ball = Piece::new(Shape::ball(0.2).expect("a ball"));
    ball.pose = Isometry3::translation(0.0, 0.0, 1.0);
    let rod = Piece::new(Shape::capsule(0.5, 0.1).expect("a capsule"));
    let body = Geometry::from(Compound::new(vec![rod, ball]).expect("a body"));
    let mut checker = moved(body, frame().into());
    let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&[0.0; 3], &[0.1, 0.0, 0.3])).expect("a receipt");
    let [text, _] = holds(&receipt);
    assert!(text.contains(",\"radii\":["), "{text}");
    let contact = Receipt::motion(&mut checker, &JointMotion::segment(&[0.0; 3], &[2.0, 0.0, 0.0]));
    holds(&contact.expect("a contact"));
}

/// An angle whose hull overlaps a block in its corner. Both turn about one axis, so the gap stays,
/// but a plane that keeps its direction proves only the time in which the normal turns by the gap.
#[test]
fn a_pair_that_grazes_has_a_receipt_of_at_most_20000_planes() {
    let bar = |half: [f64; 3], x: f64, y: f64| {
        let mut piece = Piece::new(cuboid(half));
        piece.pose = Isometry3::translation(x, y, 0.0);
        piece
    };
    let legs = vec![bar([1.0, 0.1, 0.5], 0.0, -1.1), bar([0.1, 1.2, 0.5], -1.1, 0.0)];
    let angle = Geometry::from(Compound::new(legs).expect("an angle"));
    let block = Geometry::from(cuboid([0.5; 3]));
    let turned = |gap: f64| {
        let spin = Velocity::new(Vector3::zeros(), Vector3::z());
        let about = |x: f64, y: f64| {
            let start = Isometry3::translation(x, y, 0.0);
            Steady::about(&start, Point3::new(-x, -y, 0.0), spin).expect("a motion")
        };
        let named = [("angle", &angle), ("block", &block)];
        let motions = [about(0.0, 0.0), about(gap - 0.5, gap - 0.5)];
        let tolerance = Tolerance::Distance(1e-7);
        Receipt::cast(named, motions.each_ref(), 0.0..1.0, tolerance, 0.0)
    };
    let receipt = turned(1e-3).expect("a receipt");
    assert!(
        (500..20_000).contains(&receipt.certificates()),
        "{}",
        receipt.certificates()
    );
    holds(&receipt);

    let started = std::time::Instant::now();
    let error = turned(2e-5).unwrap_err();
    let text = error.to_string();
    assert!(
        text.starts_with("angle and block have no evidence from time 0."),
        "{text}"
    );
    assert!(text.ends_with(": it takes more than 20000 planes"), "{text}");
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "{} planes at a gap of 1e-3; {seconds:.1} s for {text}",
        receipt.certificates()
    );
    assert!(seconds < 60.0, "{seconds} s");
}

/// Both bounds are those of the library, wider by 1e-12 of the scene at most.
#[test]
fn distances_of_meshes_and_compounds_have_receipts() {
    let mut rng = Rng::new(23);
    let (mut counts, mut most) = ([0; 3], 0);
    let ball = Mesh::from_convex(&solids::icosahedron(0.3).expect("a body")).expect("a mesh");
    let bodies: Vec<Geometry> = frames()
        .into_iter()
        .chain((0..3).map(rod))
        .chain([ball.into()])
        .collect();
    for k in 0..400 {
        let (a, b) = (&bodies[k % 2], &bodies[rng.below(bodies.len())]);
        // Within the hole, or around the frame.
        let size = if k % 3 == 0 { 0.2 } else { 2.0 };
        let at = Vector3::from(rng.in_ball()) * size;
        let turn = if k % 5 == 0 { 0.0 } else { rng.range(0.0, 1.0) };
        let at = Isometry3::new(at, Vector3::from(rng.unit()) * turn);
        let pose = RelativePose::from_isometry(&at).expect("a pose");
        let outcome = PairTracker::new().closest(a, b, &pose).outcome;
        let receipt = Receipt::outcome([("a", a), ("b", b)], &at, &outcome);
        let receipt = match (outcome.state, receipt) {
            (_, Ok(receipt)) => receipt,
            // A body inside a mesh, and pieces that touch.
            (ContactState::Separated, Err(error)) => panic!("{k}: {error} {outcome:?}"),
            (_, Err(_)) => {
                counts[2] += 1;
                continue;
            }
        };
        let [text, said] = holds(&receipt);
        if outcome.state != ContactState::Separated {
            counts[0] += 1;
            continue;
        }
        let bound = |word: &str| {
            let after = said.split(word).nth(1).expect("a bound");
            let number = after.split(' ').next().expect("a number");
            number.parse::<f64>().expect("a number")
        };
        let [lower, upper] = [bound("at least "), bound("at most ")];
        assert!(lower <= outcome.lower, "{said} {outcome:?}");
        assert!(lower >= outcome.lower - 1e-11, "{said} {outcome:?}");
        assert!(upper >= outcome.upper, "{said} {outcome:?}");
        assert!(upper <= outcome.upper + 1e-11, "{said} {outcome:?}");
        let has_cuts = !text.contains("\"cells\":[[[],");
        let is_solid = text.contains("\"faces\":[");
        assert_eq!(said.contains(INSIDE), has_cuts && is_solid, "{said}");
        counts[1] += usize::from(has_cuts);
        let cells = text
            .split("\"cells\":")
            .nth(1)
            .map(|rest| rest.split("\"on\"").next().unwrap_or(rest));
        most = most.max(cells.map_or(0, |cells| cells.matches("\"]").count()));
    }
    println!("in contact, of groups, without: {counts:?}; at most {most} planes");
    assert!(counts[0] > 50 && counts[1] > 50 && counts[2] < 10, "{counts:?}");
}

/// The library's bounds moved by 1e-9 are not proven: above, or by a normal that is another one.
#[test]
fn a_distance_that_is_too_large_or_too_small_has_no_receipt() {
    let [compound, mesh] = frames();
    let at = Isometry3::new(Vector3::new(0.02, 0.03, 0.01), Vector3::new(0.1, 0.2, 0.3));
    let pose = RelativePose::from_isometry(&at).expect("a pose");
    for around in [&compound, &mesh] {
        let rod = rod(1);
        let outcome = PairTracker::new().closest(around, &rod, &pose).outcome;
        assert!(outcome.state == ContactState::Separated, "{outcome:?}");
        assert!(outcome.lower > 0.01, "{outcome:?}");
        let bodies = [("a", around), ("b", &rod)];
        assert!(Receipt::outcome(bodies, &at, &outcome).is_ok());
        let (mut longer, mut shorter) = (outcome, outcome);
        (longer.lower, longer.upper) = (outcome.lower + 1e-9, outcome.upper + 1e-9);
        (shorter.lower, shorter.upper) = (outcome.lower - 1e-9, outcome.upper - 1e-9);
        let why = |outcome: &Outcome| Receipt::outcome(bodies, &at, outcome).unwrap_err().to_string();
        assert!(why(&longer).ends_with("no plane proves the distance of two of their parts"));
        assert!(why(&shorter).ends_with("no two points are near enough"));
    }
}

/// A rod that slides and turns in the hole of a frame: their hulls overlap all over the range.
#[test]
fn ranges_of_meshes_and_compounds_have_receipts() {
    let origin = Isometry3::identity();
    for around in frames() {
        for kind in 0..3 {
            let joints = vec![
                Joint::prismatic(origin, Vector3::z_axis(), [-9.0, 9.0]),
                Joint::revolute(origin, Vector3::z_axis(), [-3.0, 3.0]),
            ];
            let arm = JointTree::serial(origin, joints, vec![2], 1.0).expect("an arm");
            let mut cell = Cell::new();
            cell.robot_body("rod", rod(kind));
            cell.put("frame", around.clone(), origin);
            let mut checker = Checker::new(arm, cell).expect("a world");
            // In the hole, and from above it through the hole.
            for (low, inside) in [([-0.2, -1.0], true), ([-2.0, -0.5], false)] {
                let high = [0.2, 0.5];
                let answers = checker.answers_over(&RangeOptions::default(), &low, &high);
                assert!(answers[0].is_never(), "{:?}", answers[0]);
                let receipt = Receipt::range(&checker, &answers, 20_000).expect("a receipt");
                let [text, said] = holds(&receipt);
                println!("{} cells", receipt.certificates());
                assert!(
                    said.contains("1 pair of bodies stays more than 0 apart at every"),
                    "{said}"
                );
                let is_solid = text.contains("\"faces\":[");
                assert!(text.contains("\"cut\":[["), "{text}");
                // Outside of the hole the hulls are apart, but the writer may cut parts first.
                assert!(!inside || said.contains(INSIDE) == is_solid, "{said}");
            }
        }
    }
}

/// The rows of the table of meshes below "Receipts" in `benches/record/2026-12-01-tables.md`.
#[test]
#[ignore = "a measurement: cargo test -p lin-canny-plan --all-features --test receipts_of_meshes sizes -- --ignored --nocapture"]
fn sizes_and_times() {
    for side in [16, 32, 64, 128] {
        // A body turns and flies along a valley between hills.
        let step = 2.0 / f64::from(side);
        let count = side as usize + 1;
        let at = |k: usize| -1.0 + step * k as f64;
        let wave = |x: f64, y: f64| 0.2 * (3.0 * x).sin() * (3.0 * y).cos();
        let points: Vec<Point3<f64>> = (0..count * count)
            .map(|k| {
                let (x, y) = (at(k % count), at(k / count));
                Point3::new(x, y, wave(x, y))
            })
            .collect();
        let corner = |i: usize, j: usize| (j * count + i) as u32;
        let quads = (0..count - 1).flat_map(|j| (0..count - 1).map(move |i| (i, j)));
        let triangles: Vec<[u32; 3]> = quads
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let ground = Geometry::from(Mesh::new(&points, &triangles).expect("a mesh"));
        let gem = Mesh::from_convex(&solids::icosahedron(0.1).expect("a body")).expect("a mesh");
        let gem = Geometry::from(gem);
        let start = Isometry3::translation(-0.9, core::f64::consts::FRAC_PI_6, 0.16);
        let velocity = Velocity::new(Vector3::new(1.8, 0.0, 0.0), Vector3::new(0.5, 1.0, 0.2));
        let flight = Steady::new(&start, velocity).expect("a motion");
        let rest = Steady::new(&Isometry3::identity(), Velocity::default()).expect("a pose");
        let write = || {
            let named = [("ground", &ground), ("gem", &gem)];
            Receipt::cast(named, [&rest, &flight], 0.0..1.0, Tolerance::Distance(1e-6), 0.0).expect("a receipt")
        };
        let started = std::time::Instant::now();
        let receipt = write();
        let written = started.elapsed().as_secs_f64();
        let [text, _] = holds(&receipt);
        let timed = (0..5).map(|_| {
            let started = std::time::Instant::now();
            assert_eq!(python::judged(&text).0, 0);
            started.elapsed().as_secs_f64()
        });
        let checked = timed.fold(f64::INFINITY, f64::min);
        let evidence: usize = text
            .lines()
            .filter(|line| line.starts_with("{\"plane\""))
            .map(str::len)
            .sum();
        println!(
            "{} triangles: {} bytes, evidence {evidence}, {} certificates; written in {:.1} ms, checked in {:.1} ms",
            triangles.len() + 20,
            text.len(),
            receipt.certificates(),
            written * 1e3,
            checked * 1e3
        );
        if let Ok(folder) = std::env::var("FOLDER") {
            std::fs::write(format!("{folder}/{side}.jsonl"), text).expect("a file");
        }
    }
}
