//! Tests with few indices, generations or steps, so that each of these runs out.

use super::pairs::Most;
use super::{Aabb, BodyId, BodyOptions, BroadPhaseError, SweepAndPrune};
use nalgebra::{Point3, Vector3};

fn cube(x: f64) -> Aabb {
    Aabb::from_center(Point3::new(x, 0.0, 0.0), Vector3::repeat(0.5))
}

fn body_without_index(mut broad: SweepAndPrune) {
    broad.state.bodies.most = 2;
    let [a, b] = [0.0, 0.5].map(|x| {
        broad
            .insert(&cube(x), BodyOptions::default())
            .expect("there is room for two")
    });
    for _ in 0..2 {
        assert_eq!(
            broad.insert(&cube(0.2), BodyOptions::default()),
            Err(BroadPhaseError::TooManyBodies)
        );
        assert_eq!(
            broad.insert_unbounded(&Aabb::everything(), BodyOptions::default().fixed(true)),
            Err(BroadPhaseError::TooManyBodies)
        );
        broad.step();
        assert!(broad.bodies().eq([a, b]) && broad.pair_count() == 1, "nothing changed");
    }
    broad.remove(b).expect("it is there");
    // The index is free once the step has reported that the pairs of its body ended.
    assert_eq!(
        broad.insert(&cube(0.2), BodyOptions::default()),
        Err(BroadPhaseError::TooManyBodies)
    );
    assert_eq!(broad.step().ended.len(), 1);
    let again = broad
        .insert(&cube(0.2), BodyOptions::default())
        .expect("there is room again");
    assert!(again.index == b.index && again != b);
}

#[test]
fn a_body_without_an_index_is_refused_and_changes_nothing() {
    body_without_index(SweepAndPrune::new());
}

fn pairs_without_slot(mut broad: SweepAndPrune) {
    broad.state.pairs.most = Most(2);
    let ids: [BodyId; 4] =
        [0.0, 0.1, 0.2, 9.0].map(|x| broad.insert(&cube(x), BodyOptions::default()).expect("a sound box"));
    let [a, b, c, d] = ids;
    let reported = broad.step();
    let named = |pairs: &[super::Pair]| pairs.iter().map(|p| (p.a, p.b)).collect::<alloc::vec::Vec<_>>();
    assert_eq!(named(reported.began), [(a, b), (a, c)]);
    let error = BroadPhaseError::TooManyPairs { a: b, b: c, refused: 1 };
    assert_eq!(reported.refused, Some(error));
    assert_eq!(broad.pair_count(), 2);
    assert!(broad.pair(b, c).is_none());
    // Not rejected twice. An ended pair frees a slot, and a pair that has to wait starts when the
    // boxes overlap again.
    assert_eq!(broad.step().refused, None);
    broad.set_box(a, &cube(-9.0)).expect("a sound box");
    let reported = broad.step();
    assert_eq!(
        (reported.ended.len(), reported.began.len(), reported.refused),
        (2, 0, None)
    );
    broad.regroup(c).expect("it is there");
    assert_eq!(named(broad.step().began), [(b, c)]);
    // The rejected pair ends without an event.
    broad.set_box(d, &cube(0.0)).expect("a sound box");
    let reported = broad.step();
    assert_eq!(
        (reported.began.len(), reported.refused),
        (1, Some(BroadPhaseError::TooManyPairs { a: c, b: d, refused: 1 }))
    );
    broad.set_box(d, &cube(9.0)).expect("a sound box");
    assert_eq!(named(broad.step().ended), [(b, d)]);
    assert_eq!(broad.pair_count(), 1);
}

#[test]
fn pairs_without_a_slot_are_told_and_change_nothing() {
    pairs_without_slot(SweepAndPrune::new());
}

fn last_generation(mut broad: SweepAndPrune) {
    let first = broad.insert(&cube(0.0), BodyOptions::default()).expect("there is room");
    let last = BodyId {
        generation: u32::MAX - 2,
        ..first
    };
    let slots = &mut broad.state.bodies.slots;
    slots.set_generation(first.index, last.generation);
    broad.remove(last).expect("it is there");
    broad.step();
    let next = broad.insert(&cube(0.0), BodyOptions::default()).expect("there is room");
    assert_ne!(next.index, last.index);
    assert!(!broad.contains(first) && !broad.contains(last));
}

#[test]
fn an_index_of_the_last_generation_is_not_given_again() {
    last_generation(SweepAndPrune::new());
}

/// A body that moved in a step long ago has not moved in the step whose number is equal after
/// wrap-around.
fn last_step(mut broad: SweepAndPrune) {
    for x in [0.0, 0.1, 9.0] {
        broad.insert(&cube(x), BodyOptions::default()).expect("there is room");
    }
    let mover = broad
        .insert(&cube(20.0), BodyOptions::default())
        .expect("there is room");
    assert_eq!(broad.step().began.len(), 1);
    broad.state.bodies.step = u32::MAX;
    for x in [21.0, 22.0, 9.1, 22.0] {
        broad.set_box(mover, &cube(x)).expect("it is there");
        let meets = usize::from(x < 10.0);
        assert_eq!(broad.step().began.len(), meets, "{x}");
    }
    assert_eq!((broad.step().ended.len(), broad.pair_count()), (0, 1));
}

#[test]
fn steps_are_numbered_anew() {
    last_step(SweepAndPrune::new());
}
