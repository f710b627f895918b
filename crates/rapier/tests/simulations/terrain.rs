//! Small bodies on a terrain: a mesh of hills under every kind of convex body.

use truth::rng::Rng;

use super::engine::rapier::parry::query::{QueryDispatcher, Ray, RayCast};
use super::engine::rapier::prelude::*;
use super::engine::{CertifiedDispatcher, Hull, MeshShape, certified_world};

/// Hills with y up, of `2 n^2` triangles a tenth wide.
fn hills(n: usize) -> MeshShape {
    let soup = truth::turned::terrain(n);
    let up = |p: &[f64; 3]| Vector::new(p[0] as Real, p[2] as Real, -p[1] as Real);
    let points: Vec<Vector> = soup.points.iter().map(up).collect();
    MeshShape::from_triangles(&points, &soup.triangles).expect("hills")
}

/// How far a point is above the hills; `None` below them.
fn height(hills: &MeshShape, p: Vector) -> Option<Real> {
    let ray = Ray::new(p, -Vector::Y);
    let hit = hills.cast_local_ray_and_get_normal(&ray, 100.0, true)?;
    Some(hit.time_of_impact)
}

#[test]
fn small_bodies_of_every_kind_stay_on_hills() {
    let (size, ground) = (0.02, hills(40));
    let mut world = certified_world(CertifiedDispatcher::default(), size, 1.0 / 240.0);
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    let floor = ColliderBuilder::new(SharedShape::from(ground.clone())).friction(1.0);
    world.insert(RigidBodyBuilder::fixed(), floor);
    let mut rng = Rng::new(43);
    let hull: Vec<Vector> = (0..14)
        .map(|_| Vector::from(rng.unit().map(|x| (0.5 * f64::from(size) * x) as Real)))
        .collect();
    let hull = Hull::from_points(&hull).expect("a hull");
    let handles: Vec<RigidBodyHandle> = (0..36)
        .map(|k| {
            let shape = match k % 6 {
                0 => SharedShape::from(hull.clone()),
                1 => SharedShape::cuboid(0.5 * size, 0.3 * size, 0.4 * size),
                2 => SharedShape::capsule_y(0.3 * size, 0.2 * size),
                3 => SharedShape::ball(0.5 * size),
                4 => SharedShape::cylinder(0.3 * size, 0.4 * size),
                _ => SharedShape::cone(0.4 * size, 0.4 * size),
            };
            let [x, z] = [0; 2].map(|_| rng.range(-1.5, 1.5) as Real);
            let top = height(&ground, Vector::new(x, 10.0, z)).expect("hills below");
            let place = Vector::new(x, 10.0 - top + size, z);
            let body = RigidBodyBuilder::dynamic().translation(place).angular_damping(2.0);
            world.insert(body, ColliderBuilder::new(shape).friction(1.0)).0
        })
        .collect();
    (0..300).for_each(|_| world.step());
    for (k, handle) in handles.iter().enumerate() {
        let body = &world.bodies[*handle];
        let above = height(&ground, body.position().translation);
        assert!(
            above.is_some_and(|h| h > 0.1 * size && h < 10.0 * size),
            "{k}: {above:?}"
        );
        let shape = world.colliders[body.colliders()[0]].shape();
        let contact = CertifiedDispatcher::default().contact(body.position(), &ground, shape, 0.0);
        let depth = contact.expect("answered").map_or(0.0, |c| -c.dist);
        assert!(depth < 0.05 * size, "{k}: {depth}");
    }
}

/// A closed tray of two millimetres, whose top is at zero.
fn tray(half: Real) -> MeshShape {
    let corner = |k: u32| {
        let side = |bit: u32| if k >> bit & 1 == 0 { -half } else { half };
        Vector::new(side(0), if k >> 1 & 1 == 0 { -0.002 } else { 0.0 }, side(2))
    };
    let corners: Vec<Vector> = (0..8).map(corner).collect();
    let faces = [
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    MeshShape::from_triangles(&corners, &halves.collect::<Vec<_>>()).expect("a tray")
}

/// Returns how many of 36 parts fall through a thin tray on which they lie, and at which they are
/// pushed, spinning, by many times its thickness a step.
fn fallen(is_swept: bool) -> usize {
    let mut world = certified_world(CertifiedDispatcher::default(), 0.02, 1.0 / 60.0);
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    if !is_swept {
        world.integration_parameters.max_ccd_substeps = 0;
    }
    let tray = ColliderBuilder::new(SharedShape::from(tray(1.0)));
    world.insert(RigidBodyBuilder::fixed(), tray);
    let mut rng = Rng::new(44);
    let handles: Vec<RigidBodyHandle> = (0..36)
        .map(|k| {
            let (shape, low) = match k % 3 {
                0 => (SharedShape::cylinder(0.002, 0.008), 0.002),
                1 => (SharedShape::cuboid(0.015, 0.002, 0.002), 0.002),
                _ => (SharedShape::cone(0.006, 0.006), 0.006),
            };
            let place = Vector::new(0.05 * (k % 6) as Real, low, 0.05 * (k / 6) as Real);
            let spin = Vector::from(rng.unit().map(|x| 20.0 * x as Real));
            let body = RigidBodyBuilder::dynamic().translation(place).angvel(spin);
            let body = body.linvel(Vector::new(0.3, -3.0, 0.1));
            world.insert(body, ColliderBuilder::new(shape).density(7800.0)).0
        })
        .collect();
    (0..60).for_each(|_| world.step());
    let is_fallen = |h: &&RigidBodyHandle| world.bodies[**h].center_of_mass().y < -0.02;
    handles.iter().filter(is_fallen).count()
}

/// Parts that touch a thin tray at the start of a step are swept against it by their cores.
#[test]
fn fewer_parts_that_touch_a_thin_tray_pass_it() {
    let (swept, not) = (fallen(true), fallen(false));
    println!("{swept} fall through the tray, {not} without sweeps");
    assert!(2 * swept < not, "{swept} {not}");
}
