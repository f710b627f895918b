//! Scenes of cuboids and balls in metres, similar to rapier's examples. The tests of the crate
//! build them in both precisions.

use super::engine::rapier::prelude::*;

/// A fixed cuboid.
pub(crate) fn fixed(world: &mut PhysicsWorld, half: Vector, center: Vector) -> ColliderHandle {
    let collider = ColliderBuilder::cuboid(half.x, half.y, half.z);
    world.insert(RigidBodyBuilder::fixed().translation(center), collider).1
}

/// A floor whose top is at height 0.
pub(crate) fn floor(world: &mut PhysicsWorld, half_width: Real) -> ColliderHandle {
    let (half, center) = (Vector::new(half_width, 0.5, half_width), Vector::Y * -0.5);
    fixed(world, half, center)
}

fn dynamic(world: &mut PhysicsWorld, shape: SharedShape, at: Vector) -> RigidBodyHandle {
    let body = RigidBodyBuilder::dynamic().translation(at);
    world.insert(body, ColliderBuilder::new(shape)).0
}

/// Towers of planks laid crosswise, three to a level and two towers to a row; returns the planks
/// from below.
pub(crate) fn planks(world: &mut PhysicsWorld, levels: usize, towers: usize) -> Vec<RigidBodyHandle> {
    floor(world, 30.0);
    let half = Vector::new(0.1, 0.05, 0.6);
    let mut made = Vec::new();
    for (level, tower, k) in (0..levels).flat_map(|l| (0..towers).flat_map(move |t| (0..3).map(move |k| (l, t, k)))) {
        let aside = 0.5 * (k as Real - 1.0);
        let (half, along) = match level % 2 {
            0 => (half, Vector::X),
            _ => (Vector::new(half.z, half.y, half.x), Vector::Z),
        };
        let corner = Vector::new(3.0 * (tower % 2) as Real, 0.05, 3.0 * (tower / 2) as Real);
        let at = corner + along * aside + Vector::Y * (0.1 * level as Real);
        made.push(dynamic(world, SharedShape::cuboid(half.x, half.y, half.z), at));
    }
    made
}

/// A row of standing slabs, the first of which is pushed against the next; returns them in order.
pub(crate) fn dominoes(world: &mut PhysicsWorld, count: usize) -> Vec<RigidBodyHandle> {
    floor(world, 0.25 * count as Real + 5.0);
    let start = -0.2 * count as Real;
    let one = |k: usize| {
        let at = Vector::new(start + 0.4 * k as Real, 0.5, 0.0);
        let push = if k == 0 { -1.5 } else { 0.0 };
        let body = RigidBodyBuilder::dynamic().translation(at).angvel(Vector::Z * push);
        world.insert(body, ColliderBuilder::cuboid(0.05, 0.5, 0.25)).0
    };
    (0..count).map(one).collect()
}

/// Balls shot at a wall of four millimetres, all in continuous motion; returns the balls.
pub(crate) fn bullets(world: &mut PhysicsWorld, side: usize) -> Vec<RigidBodyHandle> {
    floor(world, 20.0);
    fixed(world, Vector::new(0.002, 10.0, 20.0), Vector::new(0.0, 10.0, 0.0));
    let one = |k: usize| {
        let (row, column) = ((k / side) as Real, (k % side) as Real);
        let at = Vector::new(-5.0 - 0.1 * row, 1.0 + row, 0.9 * (column - 0.5 * side as Real));
        let body = RigidBodyBuilder::dynamic().translation(at).ccd_enabled(true);
        let body = body.linvel(Vector::new(150.0 + 7.0 * row + column, 0.0, 0.0));
        world.insert(body, ColliderBuilder::ball(0.1).restitution(0.3)).0
    };
    (0..side * side).map(one).collect()
}

/// Balls that fall through sensors, cuboids and balls in turn, onto a floor; returns the balls and
/// the sensors.
pub(crate) fn sensors(world: &mut PhysicsWorld, side: usize) -> (Vec<RigidBodyHandle>, Vec<ColliderHandle>) {
    floor(world, side as Real);
    let at = |k: usize, height: Real| {
        let place = |j: usize| 1.5 * (j as Real - 0.5 * side as Real);
        Vector::new(place(k % side), height, place(k / side))
    };
    let (mut balls, mut seen) = (Vec::new(), Vec::new());
    for k in 0..side * side {
        balls.push(dynamic(world, SharedShape::ball(0.3), at(k, 3.0 + 0.01 * k as Real)));
        let shape = match k % 2 {
            0 => SharedShape::cuboid(0.5, 0.2, 0.5),
            _ => SharedShape::ball(0.4),
        };
        let sensor = ColliderBuilder::new(shape)
            .sensor(true)
            .active_events(ActiveEvents::COLLISION_EVENTS);
        let body = RigidBodyBuilder::fixed().translation(at(k, 1.5));
        seen.push(world.insert(body, sensor).1);
    }
    (balls, seen)
}

/// Platforms that move sideways or rise at constant speeds, a cuboid or a ball on each; returns
/// platforms and riders.
pub(crate) fn platforms(world: &mut PhysicsWorld, count: usize, rider: &SharedShape) -> Vec<[RigidBodyHandle; 2]> {
    let one = |k: usize| {
        let at = Vector::new(0.0, 0.0, 4.0 * k as Real);
        let speed = 0.1 * (1 + k % 5) as Real;
        let velocity = if k.is_multiple_of(2) {
            Vector::X * speed
        } else {
            Vector::Y * speed
        };
        let platform = RigidBodyBuilder::kinematic_velocity_based()
            .translation(at)
            .linvel(velocity);
        let platform = world.insert(platform, ColliderBuilder::cuboid(1.5, 0.1, 1.5)).0;
        [platform, dynamic(world, rider.clone(), at + Vector::Y * 0.45)]
    };
    (0..count).map(one).collect()
}

/// Spinning balls of restitution 0 to 1 that are thrown on a floor; returns them in order of
/// restitution.
pub(crate) fn bounces(world: &mut PhysicsWorld, count: usize) -> Vec<RigidBodyHandle> {
    let ground = floor(world, count as Real);
    if let Some(ground) = world.colliders.get_mut(ground) {
        ground.set_restitution(1.0);
    }
    let one = |k: usize| {
        let at = Vector::new(k as Real - 0.5 * count as Real, 5.0, 0.0);
        let ball = ColliderBuilder::ball(0.3).restitution(k as Real / count.max(2) as Real);
        let body = RigidBodyBuilder::dynamic().translation(at);
        let body = body.linvel(Vector::Z * 0.3).angvel(Vector::new(2.0, 1.0, -0.5));
        world.insert(body, ball).0
    };
    (0..count).map(one).collect()
}
