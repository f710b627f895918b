//! Bodies that rest on each other: coins, small parts, snapshots, threads.

use std::f64::consts::TAU;

use lin_canny_rapier::lin_canny_parry::lin_canny::{RelativePose, Tracker};
use truth::rng::Rng;

use super::engine::rapier::prelude::*;
use super::engine::{CertifiedDispatcher, Hull, certified_world};

fn prism(sides: usize, radius: f64, half_height: f64) -> Vec<Vector> {
    let at = |k: usize, y: f64| {
        let (s, c) = (TAU * (k as f64 + 0.5) / sides as f64).sin_cos();
        Vector::new((radius * c) as Real, y as Real, (radius * s) as Real)
    };
    (0..sides)
        .flat_map(|k| [at(k, -half_height), at(k, half_height)])
        .collect()
}

/// A floor and four walls about a square of `2 half` in width.
fn bin(world: &mut PhysicsWorld, half: Real) {
    let mut wall = |h: [Real; 3], c: [Real; 3]| {
        let collider = ColliderBuilder::cuboid(h[0] * half, h[1] * half, h[2] * half);
        world.insert(RigidBodyBuilder::fixed().translation(Vector::from(c) * half), collider);
    };
    wall([2.0, 0.5, 2.0], [0.0, -0.5, 0.0]);
    for (x, z) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let along = |c: Real| if c == 0.0 { 1.5 } else { 0.25 };
        wall([along(x), 3.0, along(z)], [1.25 * x, 3.0, 1.25 * z]);
    }
}

/// Hulls of 12 points, some of them inside, over a bin; all lengths and gravity times `scale`.
fn pile(count: usize, scale: Real, dispatcher: CertifiedDispatcher) -> (PhysicsWorld, Vec<(RigidBodyHandle, Hull)>) {
    let mut world = certified_world(dispatcher, scale, 1.0 / 60.0);
    world.gravity = Vector::new(0.0, -9.81 * scale, 0.0);
    bin(&mut world, 2.0 * scale);
    let mut rng = Rng::new(41);
    let bodies = (0..count).map(|k| {
        let axes = std::array::from_fn(|_| rng.range(0.3, 0.5));
        let shell = truth::shapes::ellipsoid(&mut rng, 12, axes).points;
        let inner = shell.iter().take(3).map(|p| p.map(|x| 0.5 * x));
        let narrow = |p: [f64; 3]| Vector::from(p.map(|x| x as Real)) * scale;
        let points: Vec<Vector> = inner.chain(shell.iter().copied()).map(narrow).collect();
        let hull = Hull::from_points(&points).expect("a solid");
        let at = [k % 3, k / 9, k / 3 % 3].map(|j| j as Real * 1.2 - 1.2);
        let at = Vector::new(at[0], at[1] + 2.0, at[2]) * scale;
        let [x, y, z, w] = rng.quat().map(|x| x as Real);
        let pose = Pose::from_parts(at, Rotation::from_xyzw(x, y, z, w).normalize());
        let collider = ColliderBuilder::new(SharedShape::from(hull.clone()));
        (world.insert(RigidBodyBuilder::dynamic().pose(pose), collider).0, hull)
    });
    let bodies: Vec<_> = bodies.collect();
    (world, bodies)
}

/// All bits of the poses and velocities.
#[cfg(any(feature = "serde", feature = "parallel"))]
fn bits(world: &PhysicsWorld, bodies: &[(RigidBodyHandle, Hull)]) -> Vec<u64> {
    let of = |(handle, _): &(RigidBodyHandle, Hull)| {
        let b = &world.bodies[*handle];
        let p = b.position();
        let lists = [p.translation, b.linvel(), b.angvel()].map(|v| v.to_array());
        let turn = p.rotation.to_array();
        lists
            .concat()
            .into_iter()
            .chain(turn)
            .map(|x| f64::from(x).to_bits())
            .collect::<Vec<_>>()
    };
    bodies.iter().flat_map(of).collect()
}

#[test]
fn a_coin_laid_flat_lies_still() {
    for sides in [4, 6, 12, 64, 128] {
        for on_space in [true, false] {
            let mut world = certified_world(CertifiedDispatcher::default(), 1.0, 1.0 / 60.0);
            world.gravity = Vector::new(0.0, -9.81, 0.0);
            let (ground, at) = match on_space {
                true => (SharedShape::halfspace(Vector::Y), 0.0),
                false => (SharedShape::cuboid(5.0, 0.5, 5.0), -0.5),
            };
            world.insert(
                RigidBodyBuilder::fixed().translation(Vector::Y * at),
                ColliderBuilder::new(ground),
            );
            let hull = Hull::from_points(&prism(sides, 0.4, 0.05)).expect("a solid");
            let body = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.05);
            let (coin, _) = world.insert(body, ColliderBuilder::new(SharedShape::from(hull)));
            (0..120).for_each(|_| world.step());
            let coin = &world.bodies[coin];
            let up = (coin.rotation() * Vector::Y).y;
            assert!(up > 0.999_999, "{sides} sides, half-space {on_space}: {up}");
            assert!(coin.is_sleeping(), "{sides} sides, half-space {on_space}: {up}");
            let off = (coin.translation().y - 0.05).abs();
            assert!(off < 1e-3, "{sides} {:?}", coin.translation());
        }
    }
}

#[test]
fn hulls_of_a_thousandth_pile_up_as_large_ones_do() {
    let deepest = |scale: Real| {
        let (mut world, bodies) = pile(40, scale, CertifiedDispatcher::default());
        let mut deepest = 0.0f64;
        for step in 0..240 {
            world.step();
            if step % 8 == 0 && step > 120 {
                deepest = deepest.max(depth(&world, &bodies) / f64::from(scale));
            }
        }
        for (handle, _) in &bodies {
            let p = world.bodies[*handle].center_of_mass() / scale;
            let held = p.y > 0.0 && p.y < 8.0 && p.x.abs() < 2.0 && p.z.abs() < 2.0;
            assert!(held, "scale {scale}: {p:?}");
        }
        deepest
    };
    let (large, small) = (deepest(1.0), deepest(1e-3));
    assert!(large < 0.1 && small < 0.1, "{large} {small}");
    assert!(large > 1e-5 && small > 1e-5, "bodies must touch: {large} {small}");
}

/// Towers of five of rapier's own cuboids, and of five capsules between walls, stand at any size.
#[test]
fn towers_of_plain_shapes_stand_at_any_size() {
    for size in [0.005, 0.01, 0.02, 0.1, 1.0] {
        let mut world = certified_world(CertifiedDispatcher::default(), size, 1.0 / 240.0);
        world.gravity = Vector::new(0.0, -9.81 * size.min(0.1) * 10.0, 0.0);
        let floor = ColliderBuilder::cuboid(20.0 * size, size, 20.0 * size);
        let at = |x: Real, y: Real| Vector::new(x * size, y * size, 0.0);
        world.insert(RigidBodyBuilder::fixed().translation(at(0.0, -1.0)), floor);
        for x in [5.5, 6.5] {
            let wall = ColliderBuilder::cuboid(0.1 * size, 5.0 * size, size);
            world.insert(RigidBodyBuilder::fixed().translation(at(x, 5.0)), wall);
        }
        let mut bodies = Vec::new();
        for k in 0..5 {
            let y = k as Real + 0.5;
            let cuboid = ColliderBuilder::cuboid(0.5 * size, 0.5 * size, 0.5 * size);
            bodies.push((
                y,
                world
                    .insert(RigidBodyBuilder::dynamic().translation(at(0.0, y)), cuboid)
                    .0,
            ));
            let capsule = ColliderBuilder::capsule_z(0.5 * size, 0.39 * size);
            let y = 0.39 + 0.78 * k as Real;
            bodies.push((
                y,
                world
                    .insert(RigidBodyBuilder::dynamic().translation(at(6.0, y)), capsule)
                    .0,
            ));
        }
        (0..480).for_each(|_| world.step());
        for (y, handle) in &bodies {
            let sunk = y - world.bodies[*handle].translation().y / size;
            assert!(sunk.abs() < 0.05, "size {size}: {sunk} sizes at {y}");
        }
    }
}

/// The greatest depth of two bodies in each other.
fn depth(world: &PhysicsWorld, bodies: &[(RigidBodyHandle, Hull)]) -> f64 {
    let pose = |h: RigidBodyHandle| {
        let p = world.bodies[h].position();
        let [i, j, k, w] = p.rotation.to_array().map(f64::from);
        let t = p.translation.to_array().map(f64::from);
        truth::Pose::new(truth::pose::unit_quat([i, j, k, w]), t).isometry()
    };
    let mut deepest = 0.0f64;
    for (k, (a, x)) in bodies.iter().enumerate() {
        for (b, y) in &bodies[k + 1..] {
            let relative = RelativePose::new(&pose(*a), &pose(*b)).expect("a pose");
            let d = Tracker::new().distance(x.body(), y.body(), &relative).value;
            deepest = deepest.max(-d);
        }
    }
    deepest
}

/// A world that is written, read and given its dispatcher again goes on as the world it was written from.
#[cfg(feature = "serde")]
#[test]
fn snapshots_go_on_bit_for_bit() {
    for moment in [20, 60, 100, 160] {
        let (mut world, bodies) = pile(30, 1.0, CertifiedDispatcher::default());
        (0..moment).for_each(|_| world.step());
        let mut file = Vec::new();
        ciborium::into_writer(&world, &mut file).expect("a snapshot");
        let mut again: PhysicsWorld = ciborium::from_reader(&file[..]).expect("a world");
        again.narrow_phase.set_query_dispatcher(CertifiedDispatcher::default());
        assert_eq!(bits(&again, &bodies), bits(&world, &bodies), "moment {moment}: as read");
        let contacts = world
            .narrow_phase
            .contact_pairs()
            .filter(|p| p.has_any_active_contact())
            .count();
        assert!(contacts > 5, "moment {moment}: {contacts} contacts");
        for step in 1..=120 {
            world.step();
            again.step();
            let found = bits(&again, &bodies);
            assert_eq!(found, bits(&world, &bodies), "moment {moment}: step {step}");
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        let (mut world, bodies) = pile(60, 1.0, CertifiedDispatcher::default());
        world.physics_pipeline.configure_thread_pool(threads).expect("threads");
        (0..150).for_each(|_| world.step());
        bits(&world, &bodies)
    };
    let one = run(1);
    for threads in [2, 4] {
        assert!(run(threads) == one, "{threads} threads");
    }
}
