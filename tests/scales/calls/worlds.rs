//! Worlds of boxes, and scenes of bodies of every kind: events, pairs and results.

use super::{Scene, compound, curved, dented};
use lin_canny::broad::{self, Aabb, SweepAndPrune};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::scene::{self, Body, Group, PairQueries};
use lin_canny::{Geometry, ManifoldOptions, Velocity};
use truth::rng::Rng;

pub(super) fn boxes(scene: &mut Scene, rng: &mut Rng) {
    let seed = rng.bits();
    world(scene, &mut Rng::new(seed), SweepAndPrune::new());
}

fn aabb(scene: &Scene, rng: &mut Rng) -> Aabb {
    let half = Vector3::from(std::array::from_fn(|_| rng.range(0.1, 0.6)));
    Aabb::from_center(
        Point3::from(Vector3::from(rng.in_ball()) * (2.0 * scene.unit)),
        half * scene.unit,
    )
}

fn world(scene: &mut Scene, rng: &mut Rng, mut broad: SweepAndPrune) {
    let margin = 0.05 * scene.unit;
    let insert = |broad: &mut SweepAndPrune, rng: &mut Rng, k: usize| {
        let body = [
            broad::BodyOptions::default().growth(margin).lookahead(1.0),
            broad::BodyOptions::default().fixed(true),
        ][k % 2];
        broad.insert(&aabb(scene, rng), body).expect("a box")
    };
    let ids: Vec<_> = (0..40).map(|k| insert(&mut broad, rng, k)).collect();
    for _ in 0..6 {
        for &id in ids.iter().step_by(2) {
            broad.set_box(id, &aabb(scene, rng)).expect("a box");
        }
        let events = broad.step();
        scene.plain("events", (events.ended, events.began));
        scene.plain("pairs", broad.pairs().collect::<Vec<_>>());
        let (asked, mut found) = (aabb(scene, rng), Vec::new());
        broad.overlapping(&asked, &mut found).expect("a box");
        scene.plain("overlapping", found);
        for near in broad.nearest(&asked, 5, 3.0 * scene.unit).expect("a box") {
            scene.plain("nearest", near.body);
            scene.lengths("nearest", [near.distance]);
        }
    }
}

const CONVEX: Group = Group::new(0).expect("a group");
const PARTS: Group = Group::new(1).expect("a group");

/// Bodies of every kind in one scene: first moved frame by frame, then by velocities.
pub(super) fn scenes(scene: &mut Scene, rng: &mut Rng) {
    let mut world = scene::Scene::new();
    let queries = PairQueries::none()
        .boxes(true)
        .overlap(true)
        .within(0.1 * scene.unit)
        .distance(0.5 * scene.unit)
        .features(true)
        .depth(true)
        .manifold(ManifoldOptions::default().prediction(0.1 * scene.unit))
        .impact(Tolerance::Distance(1e-4 * scene.unit));
    world.set_queries(CONVEX, CONVEX, queries).expect("queries");
    // Compounds and meshes have no depth in a scene.
    let queries = queries.depth(false);
    world.set_queries(PARTS, CONVEX, queries).expect("queries");
    world.set_queries(PARTS, PARTS, queries).expect("queries");
    let mut shapes: Vec<Geometry> = curved(scene).into_iter().map(Geometry::from).collect();
    shapes.extend((0..4).map(|_| Geometry::from(scene.round(rng, 20))));
    let convex = shapes.len();
    shapes.extend([dented(scene, rng).into(), compound(scene, rng).into()]);
    let place = |scene: &Scene, rng: &mut Rng| {
        let apart = rng.range(0.5, 3.0);
        scene.place(rng, apart)
    };
    let mut bodies = Vec::new();
    for (k, shape) in shapes.into_iter().enumerate() {
        let (pose, group) = (place(scene, rng), [CONVEX, PARTS][usize::from(k >= convex)]);
        bodies.push(world.insert(Body::moving(shape).group(group), pose).expect("a body"));
    }
    for frame in 0..4 {
        if frame < 2 {
            for &id in &bodies {
                world.set_pose(id, place(scene, rng)).expect("a pose");
            }
        } else {
            for &id in &bodies {
                let [linear, angular] = [0, 1].map(|_| Vector3::from(rng.in_ball()));
                let velocity = Velocity::new(linear * scene.unit, angular);
                world.set_velocity(id, velocity).expect("a velocity");
            }
            world.advance(0.3).expect("a tick");
        }
        world.step();
        tell(scene, &world);
    }
}

fn tell(scene: &mut Scene, world: &scene::Scene) {
    scene.plain("events", world.events());
    for pair in world.pairs() {
        scene.plain(
            "pair",
            (pair.a, pair.b, pair.pair, pair.overlaps, pair.within, pair.subshapes),
        );
        if let Some(d) = &pair.distance {
            scene.distance("distance", d);
        }
        if let Some(outcome) = pair.outcome {
            scene.outcome("pair", outcome);
        }
        if let Some(manifold) = pair.manifold {
            scene.manifold("pair", manifold);
        }
        for contact in pair.contacts.into_iter().flatten().flat_map(|group| &group.contacts) {
            scene.plain("contact", (contact.patches, contact.normal));
            scene.contact("contact", &contact.point);
        }
    }
    for met in world.impacts() {
        scene.plain("impact", (met.a, met.b));
        scene.impact("impact", met.impact);
    }
    let d = 0.3 * scene.unit;
    let first = world.bodies().next().expect("a body");
    let mut near = world.pairs_within(PARTS, CONVEX, d).expect("called for");
    near.extend(world.nearest(first, 3, 2.0 * scene.unit).expect("a body"));
    near.extend(world.closest_pair(PARTS, CONVEX).expect("called for"));
    near.extend(world.any_contact(PARTS, CONVEX).expect("called for"));
    for near in near {
        scene.plain("near", (near.a, near.b, near.subshapes));
        scene.outcome("near", &near.outcome);
    }
}
