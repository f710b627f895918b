//! The scenes, made by program.

use lin_canny_rapier::single::rapier::prelude::*;
use lin_canny_rapier::single::{CertifiedDispatcher, Hull, certified_world};
use truth::rng::Rng;

use super::Scene;
use crate::common::{Engine, bin, layers, pebble, turn};
use crate::ordinary;

/// Points of a hull of a pile, and the names of its rows.
const PILES: [(usize, &str, &str); 5] = [
    (8, "plain-8", "hull-8"),
    (24, "plain-24", "hull-24"),
    (64, "plain-64", "hull-64"),
    (256, "plain-256", "hull-256"),
    (1024, "plain-1024", "hull-1024"),
];

/// A world of bodies of a metre at 60 steps a second.
fn world(engine: Engine) -> PhysicsWorld {
    let mut world = certified_world(CertifiedDispatcher::default(), 1.0, 1.0 / 60.0);
    world.gravity = Vector::Y * -9.81;
    if engine == Engine::Parry {
        world.narrow_phase = NarrowPhase::new();
    }
    world
}

/// A bin of a half width with bodies in layers over it, turned at random.
fn binned(engine: Engine, rng: &mut Rng, half_width: f32, spacing: f32, shapes: &[ColliderBuilder]) -> PhysicsWorld {
    let mut world = world(engine);
    for (half, center) in bin(half_width, 30.0) {
        ordinary::fixed(&mut world, half, center);
    }
    let places = layers(rng, vec![Vec::new(); shapes.len()], half_width - 0.1, spacing);
    for (shape, start) in shapes.iter().zip(places) {
        world.insert(RigidBodyBuilder::dynamic().pose(start.pose), shape.clone());
    }
    world
}

fn plain(points: &[Vector]) -> ColliderBuilder {
    ColliderBuilder::new(SharedShape::convex_hull(points).expect("a hull"))
}

/// Our hull under our dispatcher, parry's under parry's; both have the mass of ours.
fn hull(engine: Engine, points: &[Vector]) -> ColliderBuilder {
    let hull = Hull::from_points(points).expect("a solid");
    let mass = hull.mass_properties_at(1.0);
    match engine {
        Engine::Parry => plain(points).mass_properties(mass),
        Engine::Ours => ColliderBuilder::new(SharedShape::from(hull)).mass_properties(mass),
    }
}

/// Columns of round hulls of ten points, all different, on a floor.
fn round_hulls(engine: Engine, seed: u64) -> PhysicsWorld {
    let (mut rng, mut world) = (Rng::new(seed + 3), world(engine));
    ordinary::floor(&mut world, 40.0);
    for k in 0..625 {
        let points: Vec<Vector> = (0..10).map(|_| within(&mut rng, 1.0)).collect();
        let shape = SharedShape::round_convex_hull(&points, 0.1).expect("a hull");
        let [x, y, z] = [k % 5, k / 25, k / 5 % 5].map(|j| 2.2 * j as f32);
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, y + 2.0, z));
        world.insert(body, ColliderBuilder::new(shape));
    }
    world
}

/// A point of a cube.
fn within(rng: &mut Rng, half: f64) -> Vector {
    Vector::from(std::array::from_fn::<f32, 3, _>(|_| rng.range(-half, half) as f32))
}

/// A pile of hulls of `points` points on ellipsoids, as `Hull` or as parry's convex polyhedra.
fn pile(engine: Engine, seed: u64, (count, points): (usize, usize), half_width: f32, as_hull: bool) -> PhysicsWorld {
    let mut rng = Rng::new(seed + 17);
    let one = |rng: &mut Rng| {
        let points = pebble(rng, points, 0.3, 0.5);
        if as_hull { hull(engine, &points) } else { plain(&points) }
    };
    let shapes: Vec<_> = (0..count).map(|_| one(&mut rng)).collect();
    binned(engine, &mut rng, half_width, 1.1, &shapes)
}

/// Rings of eight convex pieces, as a decomposition gives them.
fn rings(engine: Engine, seed: u64, count: usize) -> PhysicsWorld {
    let mut rng = Rng::new(seed + 29);
    let piece = |k: usize| {
        let at = |j: usize, radius: f32, y: f32| {
            let (s, c) = (std::f32::consts::TAU * j as f32 / 8.0).sin_cos();
            Vector::new(radius * c, y, radius * s)
        };
        let corners: Vec<Vector> = [k, k + 1]
            .into_iter()
            .flat_map(|j| {
                [0.25, 0.5]
                    .into_iter()
                    .flat_map(move |r| [-0.12, 0.12].map(|y| at(j, r, y)))
            })
            .collect();
        (Pose::IDENTITY, SharedShape::convex_hull(&corners).expect("a piece"))
    };
    let ring = ColliderBuilder::new(SharedShape::compound((0..8).map(piece).collect()));
    binned(engine, &mut rng, 2.0, 1.1, &vec![ring; count])
}

/// Cylinders or cones that are thrown into a bin: rapier sweeps what is fast against the walls.
fn thrown(engine: Engine, seed: u64, count: usize, shape: &SharedShape) -> PhysicsWorld {
    let mut rng = Rng::new(seed + 31);
    let mut world = binned(
        engine,
        &mut rng,
        3.0,
        1.1,
        &vec![ColliderBuilder::new(shape.clone()); count],
    );
    for (_, body) in world.bodies.iter_mut() {
        if body.is_dynamic() {
            body.set_linvel(within(&mut rng, 5.0) - Vector::Y * 10.0, true);
            body.set_rotation(turn(&mut rng), true);
        }
    }
    world
}

fn scene(
    (name, shape, n): (&'static str, &'static str, usize),
    (steps, seeds): (usize, u64),
    build: impl Fn(Engine, u64) -> PhysicsWorld + 'static,
) -> Scene {
    let build = Box::new(build);
    Scene {
        name,
        shape,
        n,
        steps,
        seeds,
        build,
    }
}

/// A scene of cuboids and balls.
fn plain_scene(name: (&'static str, &'static str, usize), steps: usize, fill: fn(&mut PhysicsWorld)) -> Scene {
    scene(name, (steps, 1), move |engine, _| {
        let mut world = world(engine);
        fill(&mut world);
        world
    })
}

/// Scenes of hulls, rounded, in piles, in compounds; cylinders and cones.
fn of_hulls() -> Vec<Scene> {
    let mut list = vec![scene(("round-hulls", "round", 625), (150, 1), round_hulls)];
    for (points, plain, hull) in PILES {
        for (shape, as_hull) in [(plain, false), (hull, true)] {
            let build = move |engine, seed| pile(engine, seed, (60, points), 2.0, as_hull);
            list.push(scene(("pile", shape, 60), (240, 3), build));
        }
    }
    let many = |engine, seed| pile(engine, seed, (2000, 24), 6.0, true);
    list.push(scene(("many-hulls", "hull-24", 2000), (100, 1), many));
    list.push(scene(("compounds", "ring", 60), (240, 3), |e, s| rings(e, s, 60)));
    let cylinder = SharedShape::cylinder(0.3, 0.3);
    let cone = SharedShape::cone(0.4, 0.4);
    let build = move |e, s| thrown(e, s, 180, &cylinder);
    list.push(scene(("continuous", "cylinder", 180), (200, 1), build));
    let build = move |e, s| thrown(e, s, 180, &cone);
    list.push(scene(("continuous", "cone", 180), (200, 1), build));
    for (n, half_width) in [(4000, 8.0), (4300, 8.0), (20_000, 16.0)] {
        let build = move |engine, seed| pile(engine, seed, (n, 10), half_width, false);
        list.push(scene(("distinct", "plain-10", n), (40, 1), build));
    }
    list
}

pub(super) fn scenes() -> Vec<Scene> {
    let mut list = of_hulls();
    list.push(plain_scene(("planks", "cuboid", 720), 200, |w| {
        ordinary::planks(w, 60, 4);
    }));
    list.push(plain_scene(("dominoes", "cuboid", 200), 300, |w| {
        ordinary::dominoes(w, 200);
    }));
    list.push(plain_scene(("bullets", "ball", 256), 200, |w| {
        ordinary::bullets(w, 16);
    }));
    list.push(plain_scene(("sensors", "ball", 400), 200, |w| {
        ordinary::sensors(w, 20);
    }));
    list.push(plain_scene(("platforms", "cuboid", 200), 200, |w| {
        ordinary::platforms(w, 100, &SharedShape::cuboid(0.3, 0.3, 0.3));
    }));
    list.push(plain_scene(("restitution", "ball", 100), 200, |w| {
        ordinary::bounces(w, 100);
    }));
    list
}
