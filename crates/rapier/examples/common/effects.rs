//! Hulls thrown into a bin, with effects added one by one.

use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::polyhedron::solids;
use lin_canny_rapier::lin_canny_parry::lin_canny::{ManifoldOptions, Velocity, scene};
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::Pose;
use lin_canny_rapier::single::{Hull, Simulation};
use lin_canny_rapier::{Body, Continuous, Effects, FrictionModel, Settings};
use truth::rng::Rng;

use super::{bin, pebble, turn};

const NOTHING: scene::PairQueries = scene::PairQueries::none();

/// The sets of effects, each with one more than the one before.
pub(crate) fn sets() -> Vec<(&'static str, Effects, scene::PairQueries)> {
    let near = ManifoldOptions::default().prediction(0.02);
    let overlap = NOTHING.overlap(true);
    let contacts = overlap.manifold(near);
    let mut e = Effects::none();
    let mut list = vec![("motion on lines", e, NOTHING)];
    e.rotation = true;
    list.push(("+ rotation", e, NOTHING));
    e.gravity = Some(Vector3::y() * -9.81);
    list.push(("+ gravity", e, NOTHING));
    list.push(("+ overlaps told", e, overlap));
    list.push(("+ contact points", e, contacts));
    (e.response, e.iterations) = (true, 1);
    list.push(("response, 1 iteration", e, NOTHING));
    e.iterations = 4;
    list.push(("+ 4 iterations", e, NOTHING));
    e.friction = Some(0.5);
    list.push(("+ friction", e, NOTHING));
    e.restitution = Some(0.3);
    list.push(("+ restitution", e, NOTHING));
    e.sleeping = true;
    list.push(("+ sleeping", e, NOTHING));
    e.continuous = Continuous::AgainstFixed;
    list.push(("+ swept against fixed", e, NOTHING));
    e.continuous = Continuous::AgainstAll;
    list.push(("+ swept against all", e, NOTHING));
    e.friction_model = FrictionModel::Coulomb;
    list.push(("+ Coulomb friction", e, NOTHING));
    list
}

/// Returns the bin with bodies above it that fly apart.
pub(crate) fn simulation(
    effects: Effects,
    observe: scene::PairQueries,
    bodies: usize,
) -> Result<Simulation, Box<dyn std::error::Error>> {
    let settings = Settings::default().queries(observe);
    let mut simulation = Simulation::new(effects, settings)?;
    for (half, center) in bin(4.0, 12.0) {
        let wide = |v: [f32; 3]| Vector3::from(v.map(f64::from));
        let wall = Hull::new(solids::cuboid(wide(half.to_array()))?);
        let pose = Isometry3::from_parts(wide(center.to_array()).into(), Default::default());
        simulation.insert(&wall, Body::fixed(pose))?;
    }
    let mut rng = Rng::new(5);
    for k in 0..bodies {
        let hull = Hull::from_points(&pebble(&mut rng, 64, 0.3, 0.5))?;
        let at = |j: usize| (j as f32 - 3.0) * 1.05;
        let place = [at(k % 7), 1.0 + 1.05 * (k / 49) as f32, at(k / 7 % 7)];
        let pose = isometry(&Pose::from_parts(place.into(), turn(&mut rng)));
        let throw = |rng: &mut Rng| Vector3::from(rng.unit());
        let velocity = Velocity::new(throw(&mut rng), throw(&mut rng) * 2.0);
        simulation.insert(&hull, Body::moving(pose, 1.0).velocity(velocity))?;
    }
    Ok(simulation)
}
