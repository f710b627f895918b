//! Atlases: what a box says is what the predicate says at each of its configurations, with and without an atlas.

use core::ops::{ControlFlow, Range};

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Progress, Shape};
use lin_canny_plan::{
    Atlas, AtlasBox, AtlasOptions, AtlasVerdict, Checker, ConfigurationSpace, Joint, JointTree, PlanError, PlanMethod,
    PlanOptions, PlanarSpace, SerialArm, TimedPoses, World,
};
use truth::rng::Rng;

use crate::range_worlds::add_obstacles;
use crate::ranges::{at, pose, robot};

pub(crate) fn random_checker(k: u64, seed: u64) -> Checker<JointTree> {
    let mut rng = Rng::new(seed + k);
    let size = [1.0, 1e-6, 1e6][(k % 3) as usize];
    let (tree, mut world) = robot(&mut rng, size, seed + k);
    // Every fifth robot is alone.
    if !k.is_multiple_of(5) {
        add_obstacles(&mut world, &mut rng, size);
        world.set_pair_margin("a", "cloud", Some(0.2 * size)).expect("a margin");
        world.set_pair_margin("b", "open box", Some(0.0)).expect("a margin");
        world.exclude("a", "walls").expect("a pair");
    }
    world.set_margin(0.03 * size).expect("a margin");
    world.pad("b", 0.05 * size).expect("a padding");
    let mut checker = Checker::new(tree, world).expect("a robot");
    let part = solids::cuboid(Vector3::repeat(0.1 * size)).expect("a box");
    let part_pose = pose(&mut rng, 0.5 * size);
    checker.attach("b", "part", part, part_pose, &[]).expect("a part");
    checker.set_time(0.3).expect("a time");
    checker
}

/// Share of the volume of a box.
fn volume(of: &AtlasBox, [low, high]: [&[f64]; 2]) -> f64 {
    let each = (0..low.len()).filter(|k| low[*k] < high[*k]);
    each.map(|k| (of.high[k] - of.low[k]) / (high[k] - low[k])).product()
}

/// Checks boxes against the predicate, and segments against their proofs; returns how many were decided.
fn judge(checker: &mut Checker<JointTree>, atlas: &Atlas, samples: u32, rng: &mut Rng) -> [u32; 4] {
    let shares = atlas.shares();
    assert_eq!(shares.free + shares.contact + shares.left, 1.0);
    let boxes: Vec<AtlasBox> = atlas.boxes().collect();
    let sum = |verdict| -> f64 {
        let each = boxes.iter().filter(|one| one.verdict == verdict);
        each.map(|one| volume(one, atlas.range())).sum()
    };
    for (of, share) in [
        (Some(AtlasVerdict::Free), shares.free),
        (Some(AtlasVerdict::Contact), shares.contact),
        (None, shares.left),
    ] {
        assert!((sum(of) - share).abs() < 1e-12, "{of:?} {shares:?}");
    }
    for (k, one) in boxes.iter().take(60).enumerate() {
        for other in &boxes[..k] {
            let is_apart = |c: usize| one.high[c] <= other.low[c] || other.high[c] <= one.low[c];
            assert!((0..one.low.len()).any(is_apart), "{one:?} {other:?}");
        }
    }
    let mut tally = [0; 4];
    let decided: Vec<&AtlasBox> = boxes.iter().filter(|one| one.verdict.is_some()).collect();
    checker.clear_atlas();
    for k in 0..samples {
        // Half of the samples are in boxes, with many at their corners.
        let q = match decided.is_empty() || k % 2 == 0 {
            true => at(rng, atlas.range()),
            false => {
                let one = decided[rng.range(0.0, decided.len() as f64) as usize % decided.len()];
                at(rng, [&one.low, &one.high])
            }
        };
        let is_free = checker.is_free_at(&q).expect("a configuration");
        if let Some(found) = atlas.verdict_at(&q) {
            assert_eq!(found == AtlasVerdict::Free, is_free, "{q:?}");
            tally[usize::from(is_free)] += 1;
        } else if k % 2 == 1 {
            assert!(decided.is_empty(), "{q:?} is in a box");
        }
    }
    tally
}

fn judge_segments(checker: &mut Checker<JointTree>, atlas: &Atlas, samples: u32, rng: &mut Rng) -> [u32; 2] {
    let mut tally = [0; 2];
    for _ in 0..samples {
        let from = at(rng, atlas.range());
        let share = rng.range(0.0, 0.6);
        let mut to = at(rng, atlas.range());
        for (x, start) in to.iter_mut().zip(&from) {
            *x = start + share * (*x - start);
        }
        if checker.space().check(&to).is_err() {
            continue;
        }
        checker.clear_atlas();
        let (without, is_free) = (
            checker.certify(&from, &to).expect("a segment"),
            checker.is_free(&from, &to).expect("a segment"),
        );
        checker.set_atlas(atlas.clone()).expect("the atlas");
        assert_eq!(
            checker.is_free(&from, &to).expect("a segment"),
            is_free,
            "{from:?} {to:?}"
        );
        match atlas.verdict_along(&from, &to) {
            Some(AtlasVerdict::Free) => {
                assert_eq!(
                    checker.certify(&from, &to).expect("a segment"),
                    without,
                    "{from:?} {to:?}"
                );
                tally[1] += 1;
            }
            Some(AtlasVerdict::Contact) => {
                assert!(!without.is_free(), "{from:?} {to:?}");
                tally[0] += 1;
            }
            None => {}
        }
    }
    tally
}

fn random_robots(robots: Range<u64>, samples: u32, seed: u64) -> [u32; 4] {
    let mut all = [0; 4];
    for k in robots {
        let mut rng = Rng::new(seed + 1000 + k);
        let mut checker = random_checker(k, seed);
        let atlas = checker
            .free_boxes(&AtlasOptions::default().boxes(400))
            .expect("an atlas");
        let mut tally = judge(&mut checker, &atlas, samples, &mut rng);
        // A world without obstacles that move has segments.
        if k % 5 == 0 {
            let of = judge_segments(&mut checker, &atlas, samples / 10, &mut rng);
            tally[2..].copy_from_slice(&of);
        }
        all.iter_mut().zip(tally).for_each(|(sum, count)| *sum += count);
    }
    all
}

#[test]
fn boxes_say_what_the_predicate_says() {
    let tally = random_robots(0..20, 500, 7);
    assert!(tally.iter().all(|count| *count > 20), "{tally:?}");
}

#[test]
#[ignore = "minutes: cargo test --release -p lin-canny-plan --test plan hundred_robots -- --ignored"]
fn boxes_of_three_hundred_robots_say_what_the_predicate_says() {
    let tally = random_robots(crate::chosen_robots(0..300), 3_000, 70_000);
    println!("contact, free; segments in contact, free: {tally:?}");
}

/// A block on two or three rails about a post.
fn block(rails: usize) -> Checker<SerialArm> {
    let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let rail = |k: usize| Joint::prismatic(Isometry3::identity(), axes[k], [-2.0, 2.0]);
    let arm = SerialArm::new(Isometry3::identity(), (0..rails).map(rail).collect(), vec![rails], 0.1);
    let mut world = World::new();
    world.robot_body("block", solids::cuboid(Vector3::repeat(0.1)).expect("a box"));
    let post = solids::cuboid(Vector3::new(0.5, 0.5, 0.5)).expect("a box");
    world.obstacle("post", post, Isometry3::identity());
    Checker::new(arm.expect("an arm"), world).expect("a checker")
}

fn go(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn a_search_in_parts_gives_the_same_boxes() {
    for k in 0..6 {
        let mut checker = random_checker(k, 40);
        let once = checker
            .free_boxes(&AtlasOptions::default().boxes(120))
            .expect("an atlas");
        let mut parts = checker.free_boxes(&AtlasOptions::default().boxes(0)).expect("an atlas");
        for boxes in [1, 2, 30, 7, 80] {
            checker.forget();
            parts = checker
                .resume_boxes(&parts, &AtlasOptions::default().boxes(boxes), &mut go)
                .expect("an atlas");
        }
        assert!(parts == once, "{k}");
        let mut count = 0;
        let stopped = checker
            .free_boxes_with_progress(&AtlasOptions::default(), &mut |_| {
                count += 1;
                Progress::stop_if(count == 50)
            })
            .expect("an atlas");
        assert!(stopped.searched() == 50 || stopped.is_complete());
        let rest = AtlasOptions::default().boxes(120 - stopped.searched());
        assert!(checker.resume_boxes(&stopped, &rest, &mut go).expect("an atlas") == once);
    }
}

#[test]
fn the_volume_of_a_square_is_known() {
    let mut checker = block(2);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(20_000))
        .expect("an atlas");
    let shares = atlas.shares();
    let contact = 1.2 * 1.2 / 16.0;
    assert!(
        shares.contact < contact && shares.contact > contact - 2e-3,
        "{shares:?}"
    );
    assert!(
        shares.free < 1.0 - contact && shares.free > 1.0 - contact - 2e-3,
        "{shares:?}"
    );
}

#[test]
fn each_change_of_the_world_drops_the_atlas() {
    let ball = || Shape::ball(0.1).expect("a ball");
    let far = Isometry3::translation(0.0, 9.0, 0.0);
    type Change = fn(&mut Checker<SerialArm>) -> Result<(), PlanError>;
    let changes: [(&str, Change); 12] = [
        ("margin", |c| c.set_margin(0.1)),
        ("padding", |c| c.pad("block", 0.1).map(drop)),
        ("pair margin", |c| {
            c.set_pair_margin("block", "post", Some(0.1)).map(drop)
        }),
        ("exclude", |c| c.exclude("block", "post").map(drop)),
        ("move", |c| {
            c.move_obstacle("post", Isometry3::translation(1.0, 0.0, 0.0)).map(drop)
        }),
        ("remove", |c| c.remove_obstacle("post").map(drop)),
        ("replace", |c| {
            c.replace_obstacle("post", Shape::ball(0.1).expect("a ball")).map(drop)
        }),
        ("add", |c| {
            c.add_obstacle(
                "new",
                Shape::ball(0.1).expect("a ball"),
                Isometry3::translation(1.0, 1.0, 0.0),
            )
            .map(drop)
        }),
        ("attach", |c| {
            let pose = Isometry3::translation(1.0, 0.0, 0.0);
            c.attach("block", "part", Shape::ball(0.1).expect("a ball"), pose, &["block"])
                .map(drop)
        }),
        ("detach", |c| c.detach("load").map(drop)),
        ("detach_at", |c| c.detach_at("load", &[1.0, 1.0]).map(drop)),
        ("add moving", |c| {
            let poses = TimedPoses::new(
                &[0.0, 1.0],
                &[Isometry3::identity(), Isometry3::translation(1.0, 0.0, 0.0)],
            )?;
            c.add_moving_obstacle("cart", Shape::ball(0.1).expect("a ball"), poses)
                .map(drop)?;
            c.set_time(0.5)
        }),
    ];
    for (name, change) in changes {
        let mut checker = block(2);
        checker
            .attach(
                "block",
                "load",
                ball(),
                Isometry3::translation(0.0, 0.3, 0.0),
                &["block"],
            )
            .expect("a load");
        let atlas = checker
            .free_boxes(&AtlasOptions::default().boxes(300))
            .expect("an atlas");
        checker.set_atlas(atlas.clone()).expect("the atlas");
        assert!(checker.atlas().is_some());
        change(&mut checker).expect(name);
        assert!(checker.atlas().is_none(), "{name}");
        let mut other = checker.set_atlas(atlas.clone());
        assert!(matches!(other, Err(PlanError::OtherAtlas(_))), "{name}: {other:?}");
        other = checker
            .resume_boxes(&atlas, &AtlasOptions::default(), &mut go)
            .map(drop);
        assert!(matches!(other, Err(PlanError::OtherAtlas(_))), "{name}: {other:?}");
        // Its own atlas says what the changed world says.
        let own = checker
            .free_boxes(&AtlasOptions::default().boxes(300))
            .expect("an atlas");
        let mut rng = Rng::new(3);
        for _ in 0..200 {
            let q = at(&mut rng, own.range());
            let is_free = checker.is_free_at(&q).expect("a configuration");
            let found = own.verdict_at(&q);
            assert!(
                found.is_none_or(|found| (found == AtlasVerdict::Free) == is_free),
                "{name} {q:?}"
            );
        }
    }
    let mut checker = block(2);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(30))
        .expect("an atlas");
    checker.set_atlas(atlas.clone()).expect("the atlas");
    checker.add_obstacle("far", ball(), far).expect("an obstacle");
    let said = checker.set_atlas(atlas).expect_err("another world").to_string();
    assert!(
        said.starts_with("the atlas does not belong to this checker: block and far"),
        "{said}"
    );
    assert!(said.ends_with("does not measure the pair"), "{said}");
}

#[test]
fn a_clock_that_moves_an_obstacle_drops_the_atlas() {
    let mut checker = block(2);
    let poses = [
        Isometry3::translation(1.5, 0.0, 0.0),
        Isometry3::translation(1.5, 1.5, 0.0),
    ];
    let poses = TimedPoses::new(&[0.0, 1.0], &poses).expect("poses");
    let ball = Shape::ball(0.1).expect("a ball");
    checker.add_moving_obstacle("cart", ball, poses).expect("a cart");
    let options = AtlasOptions::default().boxes(500);
    assert_eq!(checker.free_boxes(&options), Err(PlanError::NoTime("cart".into())));
    checker.set_time(0.0).expect("a time");
    let atlas = checker.free_boxes(&options).expect("an atlas");
    checker.set_atlas(atlas.clone()).expect("the atlas");
    assert!(!checker.is_free_at(&[1.5, 0.0]).expect("a configuration"));
    checker.set_time(1.0).expect("a time");
    assert!(checker.is_free_at(&[1.5, 0.0]).expect("a configuration"));
    assert!(checker.set_atlas(atlas.clone()).is_err());
    checker.set_time(0.0).expect("a time");
    checker.set_atlas(atlas).expect("the atlas of this time");
}

#[test]
fn a_fork_has_the_atlas_and_gives_the_same_answers() {
    let mut checker = random_checker(1, 40);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(200))
        .expect("an atlas");
    checker.set_atlas(atlas.clone()).expect("the atlas");
    checker.set_start_contact_margin(Some(0.01)).expect("a margin");
    let mut fork = checker.fork().expect("a fork");
    assert_eq!((fork.time(), fork.start_contact_margin()), (Some(0.3), Some(0.01)));
    assert!(fork.atlas().is_some_and(|own| **own == atlas));
    let mut rng = Rng::new(8);
    for _ in 0..200 {
        let q = at(&mut rng, atlas.range());
        let both = [&mut checker, &mut fork].map(|one| one.is_free_at(&q).expect("a configuration"));
        assert_eq!(both[0], both[1], "{q:?}");
    }
}

#[test]
fn a_configuration_on_faces_is_in_all_boxes_around_it() {
    let mut checker = block(3);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(3_000))
        .expect("an atlas");
    let boxes: Vec<AtlasBox> = atlas.boxes().collect();
    let mut corners = 0;
    for one in boxes.iter().filter(|one| one.verdict.is_some()) {
        let q: Vec<f64> = (0..3)
            .map(|k| if corners >> k & 1 == 0 { one.low[k] } else { one.high[k] })
            .collect();
        corners += 1;
        // The verdicts of closed boxes agree where they meet.
        assert_eq!(atlas.verdict_at(&q), one.verdict, "{one:?}");
    }
    assert!(corners > 100);
}

#[test]
fn contacts_at_the_start_and_tubes_do_not_use_the_atlas() {
    let mut checker = block(2);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(2_000))
        .expect("an atlas");
    checker.set_atlas(atlas).expect("the atlas");
    let (from, to) = ([-1.0, -1.0], [-1.0, 1.0]);
    assert!(checker.certify(&from, &to).expect("a segment").is_free());
    assert_eq!(checker.work().queries, 0);
    assert!(!checker.certify_tube(&from, &to, 0.5).expect("a tube").is_free());
    assert!(checker.certify_tube(&from, &to, 0.3).expect("a tube").is_free());
    checker.set_start_contact_margin(Some(0.5)).expect("a margin");
    let with = checker.certify(&from, &to).expect("a segment");
    checker.clear_atlas();
    assert_eq!(checker.certify(&from, &to).expect("a segment"), with);
}

#[test]
fn limits_without_width_have_one_box() {
    for (x, verdict) in [(0.3, AtlasVerdict::Contact), (0.7, AtlasVerdict::Free)] {
        let rail = |axis, limits| Joint::prismatic(Isometry3::identity(), axis, limits);
        let rails = vec![rail(Vector3::x_axis(), [x; 2]), rail(Vector3::y_axis(), [0.0; 2])];
        let arm = SerialArm::new(Isometry3::identity(), rails, vec![2], 0.1).expect("an arm");
        let world = block(2).world().clone();
        let mut checker = Checker::new(arm, world).expect("a checker");
        let atlas = checker.free_boxes(&AtlasOptions::default()).expect("an atlas");
        assert_eq!((atlas.searched(), atlas.is_complete()), (1, true));
        assert_eq!(atlas.verdict_at(&[x, 0.0]), Some(verdict));
        assert_eq!(atlas.verdict_along(&[x, 0.0], &[x, 0.0]), Some(verdict));
        assert_eq!(
            checker.is_free_at(&[x, 0.0]).expect("a configuration"),
            verdict == AtlasVerdict::Free
        );
    }
    // One of two coordinates has a width, and the post ends a free box within rounding.
    let rail = |axis, limits| Joint::prismatic(Isometry3::identity(), axis, limits);
    let rails = vec![rail(Vector3::x_axis(), [-2.0, 2.0]), rail(Vector3::y_axis(), [0.0; 2])];
    let arm = SerialArm::new(Isometry3::identity(), rails, vec![2], 0.1).expect("an arm");
    let mut checker = Checker::new(arm, block(2).world().clone()).expect("a checker");
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(5_000))
        .expect("an atlas");
    assert!((atlas.shares().free - 0.7).abs() < 1e-9, "{atlas:?}");
}

#[test]
fn configurations_outside_and_wrong_lengths_have_no_verdict() {
    let mut checker = block(3);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(100))
        .expect("an atlas");
    assert_eq!(atlas.verdict_at(&[2.5, 0.0, 0.0]), None);
    assert_eq!(atlas.verdict_at(&[f64::NAN, 0.0, 0.0]), None);
    assert_eq!(atlas.verdict_at(&[2.0, 2.0]), None);
    assert_eq!(atlas.verdict_along(&[2.0; 3], &[2.5, 0.0, 0.0]), None);
    assert_eq!(atlas.verdict_at(&[2.0; 3]), Some(AtlasVerdict::Free));
    let space = PlanarSpace::new([[-2.0, 2.0]; 2], 0.5, 1).expect("a space");
    let mut planar = Checker::new(space, block(2).world().clone()).expect("a checker");
    let refused = planar.free_boxes(&AtlasOptions::default());
    assert!(matches!(refused, Err(PlanError::Value { .. })), "{refused:?}");
}

#[test]
fn plans_with_an_atlas_are_those_without_it() {
    let mut checker = block(3);
    let atlas = checker
        .free_boxes(&AtlasOptions::default().boxes(3_000))
        .expect("an atlas");
    let mut fresh = block(3);
    let mut rng = Rng::new(5);
    let mut lookups = 0;
    for seed in 0..20 {
        let ends = [at(&mut rng, atlas.range()), at(&mut rng, atlas.range())];
        if ends.iter().any(|q| !fresh.is_free_at(q).expect("a configuration")) {
            continue;
        }
        for method in PlanMethod::ALL {
            let options = PlanOptions::default().method(method).seed(seed);
            checker.set_atlas(atlas.clone()).expect("the atlas");
            checker.forget();
            let with = checker.plan(&ends[0], &ends[1], &options).expect("a plan");
            checker.clear_atlas();
            checker.forget();
            let without = checker.plan(&ends[0], &ends[1], &options).expect("a plan");
            assert_eq!(with.path, without.path, "{seed} {method:?}");
            lookups += with.work.checks.lookups;
            if let Some(path) = with.path {
                assert!(fresh.certify_path(&path).expect("a path").1.is_free());
            }
        }
    }
    assert!(lookups > 100, "{lookups}");
}

#[cfg(feature = "serde")]
mod stored {
    use super::*;

    #[test]
    fn a_stored_atlas_has_the_same_bits_and_goes_on() {
        for boxes in [0, 1, 2, 77, 300] {
            let mut checker = random_checker(1, 40);
            let atlas = checker
                .free_boxes(&AtlasOptions::default().boxes(boxes))
                .expect("an atlas");
            let text = serde_json::to_string(&atlas).expect("text");
            let read: Atlas = serde_json::from_str(&text).expect("the atlas");
            assert!(read == atlas, "{boxes}");
            let options = AtlasOptions::default().boxes(50);
            let more = checker.resume_boxes(&read, &options, &mut go).expect("an atlas");
            assert!(more == checker.resume_boxes(&atlas, &options, &mut go).expect("an atlas"));
        }
    }

    #[test]
    fn a_damaged_file_is_an_error_that_names_the_place() {
        let mut checker = block(2);
        let atlas = checker.free_boxes(&AtlasOptions::default().boxes(5)).expect("an atlas");
        let whole = serde_json::to_value(&atlas).expect("json");
        type Damage = fn(&mut serde_json::Value);
        let cases: [(&str, Damage); 9] = [
            ("version 2 (expected 1)", |v| v["version"] = 2.into()),
            ("2 lower and 1 upper limits", |v| v["high"] = serde_json::json!([2.0])),
            ("limits of coordinate 1: 3.0 to 2.0", |v| v["low"][1] = 3.0.into()),
            ("box 0 cannot be halved along coordinate 7", |v| {
                v["boxes"][0] = 7.into()
            }),
            ("box 1 belongs to no halved box", |v| v["boxes"][0] = (-1).into()),
            ("0 boxes", |v| v["boxes"] = serde_json::json!([])),
            ("comes after boxes that were not searched", |v| {
                v["boxes"][0] = (-3).into()
            }),
            ("sets of pairs (expected", |v| v["waiting"] = serde_json::json!([])),
            ("set 0 has pairs that do not exist", |v| v["waiting"][0][0] = 2.into()),
        ];
        for (expected, damage) in cases {
            let mut value = whole.clone();
            damage(&mut value);
            let read: Result<Atlas, _> = serde_json::from_value(value);
            let said = read.expect_err(expected).to_string();
            assert!(said.contains(expected), "{said}");
        }
    }
}
