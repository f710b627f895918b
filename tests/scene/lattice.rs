//! Promise: a scene reports what brute force reports if bounds are equal everywhere.
//!
//! Unit cubes on lattices jump, are removed and inserted again, and slide slowly. Coordinates are
//! multiples of 1/8, so touching is exact in any arithmetic.

use crate::ALL;
use std::collections::BTreeSet;
use std::sync::Arc;

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, PairQueries, Scene};
use truth::rng::Rng;

type Place = [i32; 3];

struct World {
    scene: Scene,
    cube: Arc<ConvexPolyhedron>,
    /// Positions in eighths.
    bodies: Vec<(BodyId, Place)>,
    /// Overlaps according to the events.
    told: BTreeSet<(BodyId, BodyId)>,
}

fn pose(place: Place) -> Isometry3<f64> {
    let [x, y, z] = place.map(|k| f64::from(k) / 8.0);
    Isometry3::translation(x, y, z)
}

impl World {
    fn wall(size: i32, gap: i32) -> Self {
        let cube = Arc::new(solids::cuboid(Vector3::repeat(0.5)).expect("a cube"));
        let mut scene = Scene::new();
        let queries = PairQueries::none().overlap(true);
        scene.set_queries(ALL, ALL, queries).expect("finite ranges");
        let mut world = Self {
            scene,
            cube,
            bodies: Vec::new(),
            told: BTreeSet::new(),
        };
        for x in 0..size {
            for y in 0..size {
                let place = [gap * x, gap * y, 0];
                let id = world.insert(place);
                world.bodies.push((id, place));
            }
        }
        world
    }

    fn insert(&mut self, place: Place) -> BodyId {
        let body = Body::moving(self.cube.clone()).group(ALL);
        self.scene.insert(body, pose(place)).expect("a finite pose")
    }

    fn place(&mut self, k: usize, place: Place) {
        self.bodies[k].1 = place;
        self.scene
            .set_pose(self.bodies[k].0, pose(place))
            .expect("a living body");
    }

    /// Removes a body and inserts another, which reuses its index.
    fn replace(&mut self, k: usize, place: Place) {
        self.scene.remove(self.bodies[k].0).expect("a living body");
        self.bodies[k] = (self.insert(place), place);
    }

    fn step(&mut self) -> Result<usize, String> {
        self.scene.step();
        for e in self.scene.events() {
            let key = (e.a.min(e.b), e.a.max(e.b));
            let is_new = match e.change {
                Change::OverlapBegan => self.told.insert(key),
                _ => self.told.remove(&key),
            };
            if !is_new {
                return Err(format!("{e:?} twice"));
            }
        }
        let mut truth = BTreeSet::new();
        for (k, (a, p)) in self.bodies.iter().enumerate() {
            for (b, q) in &self.bodies[k + 1..] {
                if (0..3).all(|axis| (p[axis] - q[axis]).abs() <= 8) {
                    truth.insert((*a.min(b), *a.max(b)));
                }
            }
        }
        if self.told != truth {
            let missing: Vec<_> = truth.difference(&self.told).take(3).collect();
            let extra: Vec<_> = self.told.difference(&truth).take(3).collect();
            return Err(format!("missing {missing:?}, extra {extra:?}"));
        }
        Ok(truth.len())
    }
}

/// A brick is lifted out or replaced, then bricks slide along each other by less than a quarter of
/// their size.
#[test]
fn bricks_that_leave_a_wall_meet_others_again() {
    let mut overlaps = 0;
    for size in [4, 8, 12] {
        for gap in [8, 12, 16, 24] {
            for replace in [false, true] {
                let mut world = World::wall(size, gap);
                let what = format!("size {size}, gap {gap}, replace {replace}");
                world.step().unwrap();
                if replace {
                    world.replace(0, [0, 0, 0]);
                } else {
                    world.place(0, [-400, 320, 0]);
                    world.step().unwrap();
                    world.place(0, [0, 0, 0]);
                }
                world.step().unwrap();
                for (k, y) in [(0, 2), (1, 4)] {
                    for x in 0..=24 {
                        world.place(k, [2 * x, y, 0]);
                        overlaps += world
                            .step()
                            .unwrap_or_else(|why| panic!("{what}, brick {k} at {x}: {why}"));
                    }
                }
            }
        }
    }
    assert!(overlaps > 10_000, "{overlaps}");
}

#[test]
fn random_moves_on_lattices_equal_brute_force() {
    let (mut overlaps, mut jumps, mut slides, mut replaced) = (0, 0, 0, 0);
    for seed in 0..300 {
        let mut rng = Rng::of_case(4711, seed);
        let mut world = World::wall([3, 4, 6, 8][rng.below(4)], [4, 8, 12, 16][rng.below(4)]);
        world.step().unwrap();
        for frame in 0..25 {
            for _ in 0..1 + rng.below(3) {
                let k = rng.below(world.bodies.len());
                let mut place = world.bodies[k].1;
                let axis = rng.below(3);
                match rng.below(6) {
                    0 => (jumps, place) = (jumps + 1, place.map(|_| 8 * rng.int(-6, 6) as i32)),
                    1 => replaced += 1,
                    _ => {
                        slides += 1;
                        place[axis] += rng.int(-2, 2) as i32;
                    }
                }
                if jumps + replaced > 0 && rng.chance(0.15) {
                    world.replace(k, place);
                } else {
                    world.place(k, place);
                }
            }
            overlaps += world
                .step()
                .unwrap_or_else(|why| panic!("seed {seed} frame {frame}: {why}"));
        }
    }
    assert!(jumps > 1000, "{jumps} {slides} {replaced}");
    assert!(slides > 5000, "{jumps} {slides} {replaced}");
    assert!(replaced > 1000, "{jumps} {slides} {replaced}");
    assert!(overlaps > 50_000, "{overlaps}");
}
