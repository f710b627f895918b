//! Promise: what a pair must keep is one number, which says where it comes from: in verdicts, in the excess of a pair, and of
//! the objects that a link carries.

use lin_canny::nalgebra::{Isometry3, UnitQuaternion};
use lin_canny::{HalfSpace, Shape};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, JointMotion, PlanError, RequiredDistance, TranslationSpace, Verdict,
};
use truth::plans::{Ask, Furnish};

fn ball(radius: f64) -> Shape {
    Shape::ball(radius).expect("a ball")
}

fn at(x: f64, y: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, 0.0)
}

fn space() -> TranslationSpace {
    TranslationSpace::new([[-9.0, 9.0]; 3], UnitQuaternion::identity(), 1).expect("a space")
}

/// A ball of radius 0.5 flies along x past a post of radius 0.5 at x = 3.
fn checker() -> Checker<TranslationSpace> {
    let mut cell = Cell::new();
    cell.robot_body("hand", ball(0.5));
    cell.put("post", ball(0.5), at(3.0, 0.0));
    Checker::new(space(), cell).expect("a checker")
}

/// The motion along x at a distance from the axis.
fn past(y: f64) -> JointMotion {
    JointMotion::segment(&[0.0, y, 0.0], &[6.0, y, 0.0])
}

fn required(verdict: &Verdict) -> RequiredDistance {
    match verdict {
        Verdict::Blocked { required, .. } => *required,
        verdict => panic!("{verdict:?}"),
    }
}

#[test]
fn a_verdict_says_meet_only_if_nothing_is_required() {
    type Setting = fn(&mut Cell) -> Result<(), PlanError>;
    let settings: [(Setting, f64, f64, &str); 6] = [
        (|_| Ok(()), 0.9, 0.0, "which meet at "),
        (
            |c| c.set_margin(0.01),
            1.005,
            0.01,
            "which come within 0.01 (margin) at ",
        ),
        (
            |c| c.pad("post", 0.01).map(drop),
            1.005,
            0.01,
            "which come within 0.01 (padding of post) at ",
        ),
        (
            |c| c.set_pair_margin("hand", "post", Some(0.01)).map(drop),
            1.005,
            0.01,
            "which come within 0.01 (margin of the pair) at ",
        ),
        (
            |c| {
                c.set_margin(0.02)?;
                c.pad("post", 0.01).map(drop)
            },
            1.025,
            0.03,
            "which come within 0.03 (margin 0.02 + padding of post 0.01) at ",
        ),
        (
            |c| {
                c.pad("hand", 0.25)?;
                c.pad("post", 0.5).map(drop)
            },
            1.5,
            0.75,
            "which come within 0.75 (padding of hand 0.25 + padding of post 0.5) at ",
        ),
    ];
    for (set, y, distance, words) in settings {
        let mut checker = checker();
        set(&mut checker.cell_mut()).expect("a distance");
        let verdict = checker.verdict_of(&past(y));
        let text = checker.show(&verdict).to_string();
        assert!(text.starts_with("blocked by hand and post, "), "{text}");
        assert!(text.contains(words), "{text}");
        let sum = required(&verdict).distance;
        assert!(sum == distance || sum == distance.next_up(), "{text}");
        // The text is about the motion, whatever is set later.
        checker.cell_mut().set_margin(0.5).expect("a margin");
        assert_eq!(checker.show(&verdict).to_string(), text);
        // Just above what is required the motion is free.
        let mut checker = self::checker();
        set(&mut checker.cell_mut()).expect("a distance");
        assert!(checker.is_free_along(&past(1.0 + distance + 1e-6)));
    }
}

#[test]
fn a_verdict_in_a_tube_says_may() {
    let mut checker = checker();
    let tube = past(1.0).with_radius(0.1).expect("a tube");
    let verdict = checker.verdict_of(&tube);
    let text = checker.show(&verdict).to_string();
    assert!(text.contains("which may meet in the tube at "), "{text}");
    assert!(required(&verdict).tube >= 0.1 && required(&verdict).distance == 0.0);
    checker.cell_mut().pad("post", 0.01).expect("a padding");
    let verdict = checker.verdict_of(&tube);
    let text = checker.show(&verdict).to_string();
    let words = "which may come within 0.01 (padding of post) in the tube at ";
    assert!(text.contains(words), "{text}");
}

#[test]
fn a_required_distance_is_exact_or_rounded_up() {
    let mut cell = Cell::new();
    let hand = cell.robot_body("hand", ball(0.5));
    let post = cell.put("post", ball(0.5), at(3.0, 0.0));
    let pair = CellPair::new(hand, post).expect("a pair");
    cell.pad("post", 0.01).expect("a padding");
    assert_eq!(cell.required_distance(pair).distance, 0.01);
    // 0.1 + 2^-60 is above 0.1.
    cell.pad("post", 0.1).expect("a padding");
    cell.set_margin(2f64.powi(-60)).expect("a margin");
    assert_eq!(cell.required_distance(pair).distance, 0.1f64.next_up());
    cell.set_margin(0.5).expect("a margin");
    cell.pad("post", 0.25).expect("a padding");
    assert_eq!(cell.required_distance(pair).distance, 0.75);
    assert!(cell.requires_distance() && !checker().cell().requires_distance());
}

/// The hand carries a part at its side, which passes the post.
fn carrying() -> (Checker<TranslationSpace>, CellBody) {
    let mut checker = checker();
    let part = checker.cell_mut().carry("hand", "part", ball(0.5), at(0.0, -2.0), &[]);
    (checker, part)
}

#[test]
fn the_padding_of_a_link_covers_what_it_carries() {
    // The part is 0.1 from the post, the hand farther.
    let motion = past(3.1);
    let (mut checker, part) = carrying();
    assert!(checker.is_free_along(&motion));
    checker.cell_mut().pad("hand", 0.2).expect("a padding");
    let verdict = checker.verdict_of(&motion);
    let text = checker.show(&verdict).to_string();
    let words = "blocked by part and post, which come within 0.2 (padding of hand) at ";
    assert!(text.starts_with(words), "{text}");
    assert_eq!(checker.cell().padding(part), 0.2);
    // Its own padding replaces that of the link, also if it is 0.
    for (own, is_free) in [
        (Some(0.05), true),
        (Some(0.15), false),
        (Some(0.0), true),
        (None, false),
    ] {
        checker.cell_mut().pad("part", own).expect("a padding");
        let verdict = checker.verdict_of(&motion);
        assert_eq!(verdict.is_free(), is_free, "{own:?}: {}", checker.show(&verdict));
        assert_eq!(checker.cell().padding(part), own.unwrap_or(0.2));
        assert_eq!(checker.cell().own_padding(part), own);
        // A new checker of the same cell says the same.
        let mut again = Checker::new(space(), checker.cell().clone()).expect("a checker");
        assert_eq!(again.certify(&motion), Ok(verdict));
    }
    // An object that is attached after the link was padded is covered too.
    let late = checker
        .cell_mut()
        .carry("hand", "late", ball(0.5), at(0.0, 2.0), &["part"]);
    assert_eq!(checker.cell().padding(late), 0.2);
    assert!(!checker.is_free_at(&[3.0, -3.15, 0.0]).expect("a configuration"));
    // What is put down is no longer carried.
    let left = checker.detach_at("part", &[0.0; 3]).expect("a part");
    assert_eq!(checker.cell().own_padding(left), None);
    let left = checker.detach_at("late", &[-5.0, 0.0, 0.0]).expect("a part");
    assert_eq!(checker.cell().padding(left), 0.0);
}

#[test]
fn the_padding_of_a_link_covers_what_is_carried_by_a_frame_of_its_body() {
    let mut cell = Cell::new();
    let hand = cell.robot_body("palm", ball(0.5));
    cell.body_frame("hand", 0);
    cell.put("post", ball(0.5), at(3.0, 0.0));
    let part = cell.carry("hand", "part", ball(0.5), at(0.0, -2.0), &[]);
    cell.pad(hand, 0.2).expect("a padding");
    assert_eq!(cell.padding(part), 0.2);
}

#[test]
fn the_least_excess_decides_whether_a_configuration_is_free() {
    let mut checker = checker();
    checker.cell_mut().put("wall", ball(0.5), at(0.0, 3.0));
    checker.cell_mut().pad("wall", 0.5).expect("a padding");
    // The post is nearer, and the wall is padded.
    let q = [1.4, 1.6, 0.0];
    let post = checker.clearance(&q).expect("a configuration").expect("a pair");
    assert_eq!(checker.name(post.pair.b), "wall");
    for q in [[1.3, 0.9, 0.0], [0.2, 1.6, 0.0], [1.2, 0.8, 0.0], [1.55, 1.55, 0.0]] {
        let all = checker.nearest(&q, f64::INFINITY).expect("a configuration");
        let least = all.iter().map(|near| near.excess).fold(f64::INFINITY, f64::min);
        let found = checker.least_excess(&q).expect("a configuration").expect("a pair");
        assert_eq!(found.excess, least);
        assert_eq!(checker.is_free_at(&q), Ok(found.excess > 0.0));
        let kept = checker.cell().required_distance(found.pair).distance;
        assert_eq!(found.excess, found.distance - kept);
    }
    let near = checker
        .clearance(&[0.9, 0.4, 0.0])
        .expect("a configuration")
        .expect("a pair");
    let tight = checker
        .least_excess(&[0.9, 0.4, 0.0])
        .expect("a configuration")
        .expect("a pair");
    assert_eq!(
        [checker.name(near.pair.b), checker.name(tight.pair.b)],
        ["post", "post"]
    );
    let (near, tight) = ([1.55, 1.5, 0.0], [1.5, 1.45, 0.0]);
    for q in [near, tight] {
        let nearest = checker.clearance(&q).expect("a configuration").expect("a pair");
        let tightest = checker.least_excess(&q).expect("a configuration").expect("a pair");
        assert_eq!(
            [checker.name(nearest.pair.b), checker.name(tightest.pair.b)],
            ["post", "wall"],
        );
    }
}

#[test]
fn a_blocked_verdict_names_the_contacts_at_the_start() {
    let mut cell = Cell::new();
    cell.robot_body("part", ball(0.5));
    let floor = HalfSpace::new(lin_canny::nalgebra::Vector3::z(), -0.5).expect("a floor");
    cell.put("floor", floor, Isometry3::identity());
    cell.put("post", ball(0.5), at(3.0, 0.0));
    let mut checker = Checker::new(space(), cell).expect("a checker");
    checker.set_start_contact_margin(Some(1e-3)).expect("a margin");
    let motion = JointMotion::path(&[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [6.0, 0.0, 0.0]]).expect("a path");
    for motion in [motion.piece(1).expect("a piece"), motion] {
        let verdict = checker.verdict_of(&motion);
        assert_eq!(verdict.name(), "blocked");
        let pairs: Vec<String> = verdict
            .start_contacts()
            .iter()
            .map(|leaving| checker.show(&leaving.pair).to_string())
            .collect();
        assert_eq!(pairs, vec!["part and floor"; motion.pieces()]);
        let text = checker.show(&verdict).to_string();
        assert!(text.contains("leaving the contact of part and floor"), "{text}");
    }
}

#[test]
fn a_body_has_no_pair_with_itself() {
    let mut cell = checker().cell().clone();
    let hand = CellBody::Robot(0);
    let itself = Err(PlanError::Itself("hand".into()));
    assert_eq!(cell.exclude("hand", "hand"), itself);
    assert_eq!(cell.exclude(hand, "hand"), itself);
    assert_eq!(cell.exclude(hand, hand), itself);
    assert_eq!(cell.include("hand", "hand"), itself);
    assert_eq!(cell.set_pair_margin("hand", hand, Some(0.1)), itself);
    let text = PlanError::Itself("hand".into()).to_string();
    assert_eq!(text, "\"hand\" has no pair with itself (expected two bodies)");
    assert_eq!(cell.excluded().len(), 0);
    // Of a group, all pairs are excluded.
    let group = ["hand".to_owned(), "post".to_owned()];
    assert_eq!(cell.exclude(&group[..], &group[..]).map(|pairs| pairs.len()), Ok(1));
}

#[test]
fn a_length_that_is_negative_is_an_error() {
    let mut checker = checker();
    for bad in [-0.5, f64::NAN] {
        let found = checker.nearest(&[0.0; 3], bad).expect_err("a slack");
        assert!(
            found
                .to_string()
                .starts_with("slack of the distances is out of range: "),
            "{found}"
        );
        assert!(checker.nearest_batch(&[0.0; 3], 1, bad, 1).is_err());
        assert!(checker.cell_mut().pad("post", bad).is_err());
        assert!(checker.cell_mut().set_margin(bad).is_err());
        assert!(past(0.0).with_radius(bad).is_err());
    }
    assert!(checker.nearest(&[0.0; 3], f64::INFINITY).is_ok());
}
