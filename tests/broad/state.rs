//! A broad phase saved at any time and read back continues identically, including slots and order.
#![cfg(feature = "serde")]

use lin_canny::broad::*;
use nalgebra::{Point3, Vector3};
use truth::boxes::{Kind, Scene};
use truth::rng::Rng;

fn copy<B: serde::Serialize + serde::de::DeserializeOwned>(broad: &B) -> B {
    serde_json::from_str(&serde_json::to_string(broad).unwrap()).unwrap()
}

/// Makes the calls of one step, drawn from `random`.
fn feed(broad: &mut SweepAndPrune, ids: &mut Vec<BodyId>, scene: &Scene, random: &mut Rng) {
    for k in 0..ids.len() {
        if broad.contains(ids[k]) && random.below(3) > 0 {
            broad.set_box(ids[k], &scene.boxes[k % scene.boxes.len()]).unwrap();
        }
    }
    if random.below(2) == 0 {
        let _ = broad.remove(ids[random.below(ids.len())]);
        let aabb = Aabb::from_center(
            Point3::from(Vector3::from(random.in_ball()) * 4.0),
            Vector3::repeat(0.7),
        );
        ids.push(broad.insert(&aabb, BodyOptions::default().growth(0.1)).unwrap());
    }
}

fn goes_on(mut broad: SweepAndPrune, n: usize) {
    let mut scene = Scene::new(Kind::Pile, n);
    let mut ids: Vec<BodyId> = scene
        .boxes
        .iter()
        .map(|b| broad.insert(b, BodyOptions::default()).unwrap())
        .collect();
    ids.push(
        broad
            .insert_unbounded(&Aabb::everything(), BodyOptions::default().fixed(true))
            .unwrap(),
    );
    let mut random = Rng::new(5);
    for _ in 0..20 {
        // Saved between steps, and after half the calls of a step.
        let mut again = copy(&broad);
        let (mut other_ids, mut other_random) = (ids.clone(), random.clone());
        scene.step();
        feed(&mut broad, &mut ids, &scene, &mut random);
        feed(&mut again, &mut other_ids, &scene, &mut other_random);
        let mut third = copy(&again);
        for _ in 0..2 {
            let events = broad.step();
            assert_eq!(again.step(), events);
            assert_eq!(third.step(), events);
        }
        assert!(again.pairs().eq(broad.pairs()) && third.pairs().eq(broad.pairs()));
    }
}

#[test]
fn restart_goes_on_identically() {
    for n in [5, 150] {
        goes_on(SweepAndPrune::new(), n);
    }
}

#[test]
fn damaged_text_is_refused_or_harmless() {
    let mut broad = SweepAndPrune::new();
    let scene = Scene::new(Kind::Pile, 12);
    let ids: Vec<_> = scene
        .boxes
        .iter()
        .map(|b| broad.insert(b, BodyOptions::default()).unwrap())
        .collect();
    broad.step();
    broad.remove(ids[3]).unwrap();
    broad.step();
    let text = serde_json::to_string(&broad).unwrap();
    let mut random = Rng::new(11);
    let mut accepted = 0;
    for _ in 0..3000 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..1 + random.below(2) {
            let at = random.below(bytes.len());
            if bytes[at].is_ascii_digit() {
                bytes[at] = b'0' + random.below(10) as u8;
            }
        }
        if let Ok(mut read) = serde_json::from_slice::<SweepAndPrune>(&bytes) {
            accepted += 1;
            read.step();
            let cube = Aabb::from_center(Point3::origin(), Vector3::repeat(1.0));
            let id = read.insert(&cube, BodyOptions::default()).unwrap();
            read.step();
            let _ = read.set_box(ids[5], &cube);
            read.remove(id).unwrap();
            read.step();
        }
    }
    assert!(accepted > 100, "most digits do no harm: {accepted}");
}
