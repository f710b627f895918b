//! Queries of boxes agree with brute force.

use lin_canny::broad::*;
use nalgebra::{Point3, Vector3};
use truth::boxes::{Kind, Scene};
use truth::rng::Rng;

fn ask(kind: Kind) -> usize {
    let mut scene = Scene::new(kind, 500);
    let mut broad = SweepAndPrune::new();
    let mut ids: Vec<BodyId> = scene
        .boxes
        .iter()
        .map(|b| broad.insert(b, BodyOptions::default()).unwrap())
        .collect();
    let mut ground = Aabb::everything();
    ground.max.z = -2.0;
    ids.push(
        broad
            .insert_unbounded(&ground, BodyOptions::default().fixed(true))
            .unwrap(),
    );
    let (mut random, mut seen) = (Rng::new(3), 0);
    for _ in 0..8 {
        broad.step();
        let boxes: Vec<StoredBox> = ids.iter().map(|id| broad.stored_box(*id).unwrap()).collect();
        scene.step();
        // Calls have no effect on queries before the next step.
        ids.iter()
            .zip(&scene.boxes)
            .for_each(|(id, b)| broad.set_box(*id, b).unwrap());
        for _ in 0..40 {
            let about = scene.boxes[random.below(500)];
            let half = Vector3::from_fn(|_, _| random.range(0.0, 3.0));
            let asked = Aabb::from_center(about.min + Vector3::from(random.in_ball()) * 3.0, half);
            let stored = StoredBox::outward(&asked, &Point3::origin());
            let expected: Vec<BodyId> = ids
                .iter()
                .zip(&boxes)
                .filter(|(_, b)| b.overlaps(&stored))
                .map(|(id, _)| *id)
                .collect();
            let mut found = Vec::new();
            broad.overlapping(&asked, &mut found).unwrap();
            assert_eq!(found, expected);
            seen += found.len();

            let gap = |b: &StoredBox| {
                let side = |x: f32, y: f32| f64::from(x) - f64::from(y);
                let axis = |k: usize| side(b.lo[k], stored.hi[k]).max(side(stored.lo[k], b.hi[k])).max(0.0);
                (0..3).map(|k| axis(k) * axis(k)).sum::<f64>().sqrt()
            };
            let mut order: Vec<(f64, BodyId)> = boxes.iter().map(gap).zip(ids.iter().copied()).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            // Exactly as far as one of the boxes.
            let last = order[random.below(40)].0;
            for (count, farthest) in [(7, f64::INFINITY), (usize::MAX, 1.5), (usize::MAX, last), (20, last)] {
                let near = broad.nearest(&asked, count, farthest).unwrap();
                let found: Vec<(f64, BodyId)> = near.iter().map(|n| (n.distance, n.body)).collect();
                let expected = order.iter().take_while(|(d, _)| *d <= farthest).take(count);
                assert_eq!(found, expected.copied().collect::<Vec<_>>());
            }
        }
    }
    seen
}

#[test]
fn overlapping_and_nearest_equal_brute_force() {
    for kind in [Kind::Uniform, Kind::Pile, Kind::Mixed, Kind::Clusters] {
        assert!(ask(kind) > 300, "{}", kind.name());
    }
}

#[test]
fn nearest_of_few_ends() {
    let mut broad = SweepAndPrune::new();
    let cube = |x: f64| Aabb::from_center(Point3::new(x, 0.0, 0.0), Vector3::repeat(0.5));
    assert!(broad.nearest(&cube(0.0), 3, f64::INFINITY).unwrap().is_empty());
    let id = broad.insert(&cube(1e6), BodyOptions::default()).unwrap();
    broad.step();
    let near = broad.nearest(&cube(0.0), 3, f64::INFINITY).unwrap();
    assert_eq!(near.len(), 1);
    assert!(near[0].body == id && (near[0].distance - 999_999.0).abs() < 0.2);
    assert!(broad.nearest(&cube(0.0), 3, f64::NAN).unwrap().is_empty());
    let error = broad.nearest(&Aabb::everything(), 1, 1.0).unwrap_err();
    assert_eq!(error, BroadPhaseError::NonFinite { body: None, axis: 0 });
}

#[test]
fn same_pairs_as_the_tree_of_parry() {
    use parry3d_f64::bounding_volume::Aabb as ParryBox;
    use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
    for kind in Kind::ALL {
        let mut scene = Scene::new(kind, 800);
        let mut broad = SweepAndPrune::new();
        let ids: Vec<BodyId> = scene
            .boxes
            .iter()
            .map(|b| broad.insert(b, BodyOptions::default()).unwrap())
            .collect();
        for _ in 0..5 {
            broad.step();
            let leaves: Vec<ParryBox> = ids
                .iter()
                .map(|id| broad.stored_box(*id).unwrap())
                .map(|b| {
                    ParryBox::new(
                        parry3d_f64::math::Vector::from_array(b.lo.map(f64::from)),
                        parry3d_f64::math::Vector::from_array(b.hi.map(f64::from)),
                    )
                })
                .collect();
            let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
            let mut theirs = Vec::new();
            let mut workspace = BvhWorkspace::default();
            tree.traverse_bvtt_single_tree::<false>(&mut workspace, &mut |a, b| theirs.push((a.min(b), a.max(b))));
            theirs.sort_unstable();
            let mut ours: Vec<(u32, u32)> = broad.pairs().map(|p| (p.a.index, p.b.index)).collect();
            ours.sort_unstable();
            assert_eq!(ours, theirs, "{}", kind.name());
            scene.step();
            ids.iter()
                .zip(&scene.boxes)
                .for_each(|(id, b)| broad.set_box(*id, b).unwrap());
        }
    }
}
