//! Segments, paths, curves and splines are one kind of motion: their pieces, tubes and times.

use lin_canny::Shape;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_plan::receipt::{Receipt, ReceiptError};
use lin_canny_plan::{
    Cell, CertifyOptions, Checker, Joint, JointCurve, JointMotion, JointTree, PlanError, TimedPoses, Verdict,
};
use truth::plans::{Ask, Furnish, bezier, cuboid};
use truth::rng::Rng;

/// A box on rails along x and y, and a post; with a cart, the post moves along y.
fn rails(has_cart: bool) -> Checker<JointTree> {
    let origin = Isometry3::identity();
    let rail = |axis| Joint::prismatic(origin, axis, [-4.0, 4.0]);
    let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    let block = JointTree::serial(origin, rails, vec![2], 0.1).expect("rails");
    let mut cell = Cell::new();
    cell.robot_body("block", cuboid([0.1; 3]));
    let post = cuboid([0.3; 3]);
    if has_cart {
        let at = |y: f64| Isometry3::translation(0.0, y, 0.0);
        let poses = TimedPoses::new(&[0.0, 10.0], &[at(-3.0), at(3.0)]).expect("poses");
        cell.put_moving("cart", post, poses);
    } else {
        cell.put("post", post, origin);
    }
    cell.put(
        "ball",
        Shape::ball(0.2).expect("a ball"),
        Isometry3::translation(2.0, 2.0, 0.0),
    );
    Checker::new(block, cell).expect("a world")
}

fn rows(rng: &mut Rng, count: usize) -> Vec<Vec<f64>> {
    (0..count)
        .map(|_| (0..2).map(|_| rng.range(-3.0, 3.0)).collect())
        .collect()
}

/// The curves of degree one along a path.
fn straight(rows: &[Vec<f64>]) -> Vec<JointCurve> {
    let each = rows.windows(2).map(bezier);
    each.collect()
}

#[test]
fn a_path_with_times_is_the_spline_of_its_segments() {
    let (mut rng, mut checker) = (Rng::new(3), rails(true));
    let (mut free, mut later) = (0, 0);
    for _ in 0..200 {
        let rows = rows(&mut rng, 4);
        let times = [0.5, 3.0, 6.0, 9.0];
        let timed = |motion: JointMotion| motion.with_times(&times).expect("times");
        let path = timed(JointMotion::path(&rows).expect("a path"));
        let spline = timed(JointMotion::spline(&straight(&rows)).expect("a spline"));
        checker.reset();
        let found = checker.verdict_of(&path);
        checker.reset();
        assert_eq!(checker.verdict_of(&spline), found);
        assert_eq!(checker.is_free(&path).expect("within limits"), found.is_free());
        free += usize::from(found.is_free());
        later += usize::from(found.piece() > Some(0));
        // Alone, the piece that is not free has the same verdict.
        if let Some(piece) = found.piece() {
            checker.reset();
            let alone = checker.verdict_of(&path.piece(piece).expect("a piece"));
            // Warm trackers differ in the last digits.
            assert_eq!(alone.name(), found.name());
            let off = (alone.free_until() - found.free_until()).abs();
            assert!(off < 1e-9, "{alone:?} {found:?}");
        }
    }
    assert!(free > 20 && later > 20, "{free} {later}");
}

#[test]
fn certificates_cover_each_piece_up_to_its_end() {
    let (mut rng, mut checker) = (Rng::new(4), rails(false));
    let (mut free, mut blocked) = (0, 0);
    for _ in 0..100 {
        let rows = rows(&mut rng, 4);
        let path = JointMotion::path(&rows).expect("a path");
        let with = || CertifyOptions::default().certificates(true);
        let found = checker.certify_with(&path, with()).expect("within limits");
        assert_eq!(found.pieces, 3);
        let last = found.verdict.piece().unwrap_or(2);
        assert_eq!(found.proofs.len(), last + 1);
        for (piece, proofs) in found.proofs.iter().enumerate() {
            let end = if piece == last { found.verdict.free_until() } else { 1.0 };
            assert_eq!(proofs.len(), if end > 0.0 { 2 } else { 0 });
            for proof in proofs {
                let mut at = 0.0;
                for certificate in &proof.certificates {
                    assert!(certificate.from <= at && certificate.until > at, "{proof:?}");
                    at = certificate.until;
                }
                assert!(at >= end, "{at} of {end}");
            }
        }
        // Asked for piece by piece, the answer is the same.
        let mut pieces = (0..3).map(|k| path.piece(k).expect("a piece"));
        let first = checker
            .certify_with(&pieces.next().expect("a piece"), with())
            .expect("within limits");
        let joined = pieces.fold(first, |all, piece| {
            all.followed_by(checker.certify_with(&piece, with()).expect("within limits"))
        });
        assert_eq!((joined.pieces, joined.proofs.len()), (3, last + 1));
        assert_eq!(joined.verdict.piece(), found.verdict.piece());
        free += usize::from(found.verdict.is_free());
        blocked += usize::from(matches!(found.verdict, Verdict::Blocked { .. }));
    }
    assert!(free > 20 && blocked > 20, "{free} {blocked}");
}

#[test]
fn a_tube_around_a_path_holds_for_each_piece() {
    let mut checker = rails(false);
    // The second piece passes the post at a distance of 0.2.
    let path = JointMotion::path(&[[-3.0, 3.0], [-3.0, 0.6], [3.0, 0.6]]).expect("a path");
    let tube = |y: f64| path.clone().with_tube(&[0.0, y]).expect("a tube");
    let around = |radius: f64| path.clone().with_radius(radius).expect("a radius");
    for (motion, is_free) in [
        (tube(0.19), true),
        (tube(0.21), false),
        (around(0.19), true),
        (around(0.21), false),
    ] {
        let found = checker.verdict_of(&motion);
        assert_eq!(found.is_free(), is_free, "{motion:?}");
        assert_eq!(found.piece(), (!is_free).then_some(1), "{motion:?}");
        assert_eq!(checker.is_free(&motion).expect("within limits"), is_free);
        // A tube of points is a distance that pairs keep; blocked motions of several pieces have no receipt.
        let error = Receipt::motion(&mut checker, &motion).err();
        if motion == around(0.19) {
            assert_eq!(error, None);
        } else if motion == tube(0.19) {
            assert_eq!(error, Some(ReceiptError::Tube));
        } else {
            assert_eq!(error, Some(ReceiptError::Blocked { piece: 1 }));
        }
    }
    let found = checker
        .tube_contact(&tube(0.21), 1, 0.0)
        .expect("a tube")
        .expect("a contact");
    assert!((found.1[1] - 0.39).abs() < 1e-12, "{found:?}");
    // The margin and the start contacts of the checker are as before.
    assert_eq!((checker.cell().margin(), checker.start_contact_margin()), (0.0, None));
    assert!(checker.is_free_along(&path));
    let along = checker.clearance_along(&path, 1e-2).expect("within limits");
    assert!(along.lower <= 0.2, "{along:?}");
    assert!(0.2 <= along.upper, "{along:?}");
    assert!(along.piece == 1, "{along:?}");
}

#[test]
fn numbers_that_make_no_motion_are_errors() {
    let rows = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    let path = || JointMotion::path(&rows).expect("a path");
    assert_eq!(JointMotion::path::<[f64; 2]>(&[]), Err(PlanError::Empty));
    assert_eq!(JointMotion::spline(&[]), Err(PlanError::Empty));
    assert_eq!(path().pieces(), 2);
    assert!(path().piece(2).is_none());
    let jump = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]].map(Vec::from);
    let apart = [straight(&jump[..2]), straight(&[jump[0].clone(), jump[2].clone()])].concat();
    assert_eq!(
        JointMotion::spline(&apart),
        Err(PlanError::CurveJump {
            index: 1,
            coordinate: 0
        })
    );
    for times in [
        &[0.0, 1.0][..],
        &[0.0, 1.0, 2.0, 3.0],
        &[0.0, 1.0, 1.0],
        &[0.0, 2.0, 1.0],
        &[0.0, f64::NAN, 1.0],
        &[0.0, 1.0, f64::INFINITY],
    ] {
        let found = path().with_times(times);
        assert!(matches!(found, Err(PlanError::Value { .. })), "{times:?}: {found:?}");
        let spline = JointMotion::spline(&straight(&rows.map(Vec::from))).expect("a spline");
        assert!(spline.with_times(times).is_err(), "{times:?}");
    }
    for tube in [
        &[0.1][..],
        &[0.1; 3],
        &[0.1, -0.1],
        &[0.1, f64::NAN],
        &[0.1, f64::INFINITY],
    ] {
        assert!(path().with_tube(tube).is_err(), "{tube:?}");
    }
    let along = bezier(&[[0.1; 2]; 2]);
    assert!(path().with_tube(&along).is_err(), "a curve of entries has one piece");
    assert!(JointMotion::segment(&rows[0], &rows[1]).with_tube(&along).is_ok());
    for radius in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(path().with_radius(radius).is_err(), "{radius}");
    }
    let mut checker = rails(false);
    for motion in [
        JointMotion::segment(&[], &[]),
        JointMotion::segment(&[0.0; 2], &[0.0; 3]),
        JointMotion::segment(&[0.0; 2], &[f64::NAN; 2]),
        JointMotion::path(&[vec![0.0; 2], vec![0.0]]).expect("a path"),
        JointMotion::segment(&[0.0; 2], &[0.0, 5.0]),
    ] {
        assert!(checker.certify(&motion).is_err(), "{motion:?}");
        assert!(checker.is_free(&motion).is_err(), "{motion:?}");
        assert!(checker.clearance_along(&motion, 0.1).is_err(), "{motion:?}");
        assert!(checker.tube_contact(&motion, 0, 0.0).is_err(), "{motion:?}");
        assert!(Receipt::scene(&checker, &motion).is_err(), "{motion:?}");
    }
    assert!(
        checker.tube_contact(&path(), 2, 0.0).is_err(),
        "there is no third piece"
    );
}
