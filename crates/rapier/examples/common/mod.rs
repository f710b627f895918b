//! Scenes under two engines that differ in shape and dispatcher alone, their judge and their picture.

#![allow(dead_code, reason = "no example uses all of it")]

pub(crate) mod effects;
pub(crate) mod picture;

use lin_canny_rapier::lin_canny_parry::lin_canny::{RelativePose, Tracker};
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::*;
use lin_canny_rapier::single::{CertifiedDispatcher, Hull, certified_world};
use truth::rng::Rng;

/// Who answers the contacts of hulls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Engine {
    /// parry's convex polyhedron and dispatcher.
    Parry,
    /// Our hull and dispatcher.
    Ours,
}

impl Engine {
    pub(crate) const BOTH: [Self; 2] = [Self::Parry, Self::Ours];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Parry => "parry",
            Self::Ours => "ours",
        }
    }
}

/// A body of a scene: a hull of points, where it starts.
#[derive(Clone)]
pub(crate) struct Start {
    pub(crate) points: Vec<Vector>,
    pub(crate) pose: Pose,
}

/// A world and its moving bodies.
pub(crate) struct Scene {
    pub(crate) world: PhysicsWorld,
    pub(crate) bodies: Vec<RigidBodyHandle>,
    pub(crate) hulls: Vec<Hull>,
}

/// What a scene has in common.
#[derive(Clone, Copy)]
pub(crate) struct Setup {
    pub(crate) engine: Engine,
    /// Length unit of rapier.
    pub(crate) size: f32,
    pub(crate) step: f32,
    pub(crate) density: f32,
    pub(crate) skin: f32,
    pub(crate) gravity: f32,
}

impl Setup {
    /// An ordinary scene in metres, at 60 steps a second.
    pub(crate) fn of(engine: Engine) -> Self {
        Self {
            engine,
            size: 1.0,
            step: 1.0 / 60.0,
            density: 1.0,
            skin: 0.0,
            gravity: 9.81,
        }
    }

    /// Returns a scene of fixed cuboids (half extents, centre) and moving hulls. All hulls have the same mass properties under
    /// either engine: parry's own are wrong for small bodies.
    pub(crate) fn scene(&self, walls: &[(Vector, Vector)], starts: &[Start]) -> Scene {
        let mut world = certified_world(CertifiedDispatcher::default(), self.size, self.step);
        world.gravity = Vector::new(0.0, -self.gravity, 0.0);
        if self.engine == Engine::Parry {
            world.narrow_phase = NarrowPhase::new();
        }
        for (half, center) in walls {
            let collider = ColliderBuilder::cuboid(half.x, half.y, half.z).contact_skin(self.skin);
            world.insert(RigidBodyBuilder::fixed().translation(*center), collider);
        }
        let (mut bodies, mut hulls) = (Vec::new(), Vec::new());
        for start in starts {
            let hull = Hull::from_points(&start.points).expect("a solid");
            let shape = match self.engine {
                Engine::Parry => SharedShape::convex_hull(&start.points).expect("a hull"),
                Engine::Ours => SharedShape::from(hull.clone()),
            };
            let mass = hull.mass_properties_at(self.density);
            let collider = ColliderBuilder::new(shape)
                .mass_properties(mass)
                .contact_skin(self.skin);
            bodies.push(world.insert(RigidBodyBuilder::dynamic().pose(start.pose), collider).0);
            hulls.push(hull);
        }
        Scene { world, bodies, hulls }
    }
}

impl Scene {
    pub(crate) fn pose(&self, k: usize) -> Pose {
        *self.world.bodies[self.bodies[k]].position()
    }

    pub(crate) fn asleep(&self) -> usize {
        self.bodies
            .iter()
            .filter(|&&b| self.world.bodies[b].is_sleeping())
            .count()
    }

    /// Returns the number of bodies whose centre is outside of a box, or no number.
    pub(crate) fn lost(&self, low: Vector, high: Vector) -> usize {
        let inside = |k: usize| {
            let p = self.world.bodies[self.bodies[k]].center_of_mass();
            low.cmple(p).all() && p.cmple(high).all()
        };
        (0..self.bodies.len()).filter(|&k| !inside(k)).count()
    }

    /// Returns the depths of all overlaps of moving bodies, by the certified distance at the poses in `f64`.
    pub(crate) fn depths(&self) -> Vec<f64> {
        let mut order: Vec<(Pose, usize)> = (0..self.bodies.len()).map(|k| (self.pose(k), k)).collect();
        order.sort_by(|a, b| a.0.translation.x.total_cmp(&b.0.translation.x));
        let reach = |k: usize| self.hulls[k].body().bounding_ball().1 as f32 * 2.0;
        let most = (0..self.hulls.len()).map(reach).fold(0.0, f32::max);
        let mut depths = Vec::new();
        for (i, (p, a)) in order.iter().enumerate() {
            for (q, b) in &order[i + 1..] {
                if q.translation.x - p.translation.x > most {
                    break;
                }
                let Ok(pose) = RelativePose::new(&isometry(p), &isometry(q)) else {
                    continue;
                };
                let d = Tracker::new().distance(self.hulls[*a].body(), self.hulls[*b].body(), &pose);
                if d.value < 0.0 {
                    depths.push(-d.value);
                }
            }
        }
        depths
    }
}

/// Returns `n` points on an ellipsoid with semi-axes between `least` and `most`.
pub(crate) fn pebble(rng: &mut Rng, n: usize, least: f64, most: f64) -> Vec<Vector> {
    let axes = std::array::from_fn(|_| rng.range(least, most));
    let points = truth::shapes::ellipsoid(rng, n, axes).points;
    points.into_iter().map(|p| Vector::from(p.map(|x| x as f32))).collect()
}

/// Returns the vertices of a prism about y.
pub(crate) fn prism(sides: usize, radius: f32, half_height: f32) -> Vec<Vector> {
    let at = |k: usize, y: f32| {
        let angle = std::f32::consts::TAU * (k as f32 + 0.5) / sides as f32;
        Vector::new(radius * angle.cos(), y, radius * angle.sin())
    };
    (0..sides)
        .flat_map(|k| [at(k, -half_height), at(k, half_height)])
        .collect()
}

/// Returns a random rotation.
pub(crate) fn turn(rng: &mut Rng) -> Rotation {
    let [x, y, z, w] = rng.quat().map(|x| x as f32);
    Rotation::from_xyzw(x, y, z, w).normalize()
}

/// Returns a floor and four walls of a square bin, open above: half extents and centres.
pub(crate) fn bin(half_width: f32, height: f32) -> Vec<(Vector, Vector)> {
    let (w, t) = (half_width, half_width / 4.0);
    let wall = |x: f32, z: f32| {
        let along = |c: f32| if c == 0.0 { w + 2.0 * t } else { t };
        let half = Vector::new(along(x), height, along(z));
        (half, Vector::new(x * (w + t), height, z * (w + t)))
    };
    let floor = (Vector::new(w + 2.0 * t, t, w + 2.0 * t), Vector::new(0.0, -t, 0.0));
    vec![floor, wall(1.0, 0.0), wall(-1.0, 0.0), wall(0.0, 1.0), wall(0.0, -1.0)]
}

/// Returns bodies in layers over a bin, turned at random.
pub(crate) fn layers(rng: &mut Rng, shapes: Vec<Vec<Vector>>, half_width: f32, spacing: f32) -> Vec<Start> {
    let side = ((2.0 * half_width / spacing) as usize).max(1);
    let place = |k: usize| {
        let at = |j: usize| (j as f32 - (side - 1) as f32 / 2.0) * spacing;
        Vector::new(
            at(k % side),
            spacing * (1.0 + (k / (side * side)) as f32),
            at(k / side % side),
        )
    };
    let one = |(k, points)| {
        let pose = Pose::from_parts(place(k), turn(rng));
        Start { points, pose }
    };
    shapes.into_iter().enumerate().map(one).collect()
}
