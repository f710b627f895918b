//! The broad phase, and scenes.

use crate::make::*;
use crate::{Random, Teller};
use lin_canny::broad::{self, Aabb, SweepAndPrune};
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::{Geometry, ManifoldOptions, Ray};

fn aabb(r: &mut Random) -> Aabb {
    let half = Vector3::new(r.range(0.1, 0.6), r.range(0.1, 0.6), r.range(0.1, 0.6));
    Aabb::from_center(Point3::from(in_ball(r) * 6.0), half)
}

pub(super) fn boxes(t: &mut Teller, r: &mut Random) {
    let mut broad = SweepAndPrune::new();
    let mut ids: Vec<_> = (0..300)
        .map(|k| {
            let moving = broad::BodyOptions::default().growth(0.05).lookahead(1.0);
            let body = [moving, broad::BodyOptions::default().fixed(true)][k % 2];
            broad.insert(&aabb(r), body).expect("a box")
        })
        .collect();
    for frame in 0..t.rounds(30) {
        for id in ids.iter_mut().step_by(2) {
            if frame % 10 == 3 && r.below(8) == 0 {
                broad.remove(*id).expect("a body");
                *id = broad.insert(&aabb(r), broad::BodyOptions::default()).expect("a box");
            }
            broad.set_box(*id, &aabb(r)).expect("a box");
        }
        let events = broad.step();
        t.tell("events", (events.ended, events.began));
        t.tell("pairs", broad.pairs().collect::<Vec<_>>());
        for _ in 0..20 {
            let (asked, mut found) = (aabb(r), Vec::new());
            broad.overlapping(&asked, &mut found).expect("a box");
            t.tell("overlapping", found);
            t.tell("nearest", broad.nearest(&asked, 5, 3.0));
        }
    }
}

pub(super) const CONVEX: Group = Group::new(0).expect("a group");

pub(super) const PARTS: Group = Group::new(1).expect("a group");

pub(super) fn scenes(t: &mut Teller, r: &mut Random) {
    for _ in 0..t.rounds(3) {
        let mut world = Scene::new();
        let queries = PairQueries::none()
            .boxes(true)
            .overlap(true)
            .within(0.1)
            .distance(0.5)
            .features(true)
            .depth(true)
            .manifold(ManifoldOptions::default().prediction(0.1))
            .impact(Tolerance::Distance(1e-4));
        world.set_queries(CONVEX, CONVEX, queries).expect("queries");
        let queries = queries.depth(false);
        world.set_queries(PARTS, CONVEX, queries).expect("queries");
        world.set_queries(PARTS, PARTS, queries).expect("queries");
        let mut shapes: Vec<Geometry> = curved().into_iter().map(Geometry::from).collect();
        shapes.extend((0..30).map(|_| Geometry::from(round(r, 20))));
        let convex = shapes.len();
        shapes.extend([dented(&round(r, 24), 0.8).into(), compound(r).into()]);
        let mut ids = Vec::new();
        for (k, shape) in shapes.into_iter().enumerate() {
            let apart = r.range(0.5, 5.0);
            let (pose, group) = (isometry(r, apart), [CONVEX, PARTS][usize::from(k >= convex)]);
            ids.push(world.insert(Body::moving(shape).group(group), pose).expect("a body"));
        }
        for frame in 0..16 {
            if frame % 3 != 2 {
                for &id in &ids {
                    let mut pose = *world.pose(id).expect("a pose");
                    pose.translation.vector += in_ball(r) * 0.1;
                    pose.rotation = turn(r, 3.0);
                    world.set_pose(id, pose).expect("a pose");
                }
            } else {
                for &id in &ids {
                    world.set_velocity(id, velocity(r, 1.0, 1.0)).expect("a velocity");
                }
                world.advance(0.3).expect("a tick");
            }
            world.step();
            tell_scene(t, r, &world);
        }
    }
}

pub(super) fn tell_scene(t: &mut Teller, r: &mut Random, world: &Scene) {
    t.tell("events", world.events());
    for pair in world.pairs() {
        t.tell("pair", pair);
    }
    t.tell("impacts", world.impacts());
    let first = world.bodies().next().expect("a body");
    t.tell(
        "poses",
        world
            .bodies()
            .map(|id| *world.pose(id).expect("a pose"))
            .collect::<Vec<_>>(),
    );
    t.tell("near", world.pairs_within(PARTS, CONVEX, 0.3));
    t.tell("nearest", world.nearest(first, 3, 2.0));
    t.tell("closest", world.closest_pair(PARTS, CONVEX));
    t.tell("first", world.any_contact(PARTS, CONVEX));
    for _ in 0..5 {
        let from = unit(r) * 7.0;
        let ray = Ray::new(Point3::from(from), -from + in_ball(r)).expect("a ray");
        t.tell("ray", world.cast_ray(&ray, 20.0, |_| true));
    }
}
