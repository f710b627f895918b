//! Broad phases behind one interface.

use crate::common::tree::Tree;
use lin_canny::broad::{Aabb, BodyId, BodyOptions, SweepAndPrune};
use truth::boxes::{Kind, Scene};

/// A broad phase that is given a scene.
pub trait Engine {
    /// Name in tables and records.
    fn name(&self) -> &'static str;
    /// Converts the input of a step into the engine's form; not timed.
    fn prepare(&mut self, scene: &Scene);
    /// Runs the timed part.
    fn step(&mut self);
    /// Number of pairs, if the engine counts them.
    fn pairs(&self) -> Option<usize>;
    /// Bytes of the whole structure, if the engine reports them.
    fn bytes(&self) -> Option<usize>;
}

struct Ours {
    broad: SweepAndPrune,
    ids: Vec<BodyId>,
    batch: Vec<(BodyId, Aabb)>,
}

impl Ours {
    fn new(scene: &Scene) -> Self {
        let mut broad = SweepAndPrune::new();
        let growth = if matches!(scene.kind, Kind::Movers | Kind::UniformSlow) {
            0.04
        } else {
            0.0
        };
        let body = BodyOptions::default().growth(growth);
        let ids = scene.boxes.iter().filter_map(|b| broad.insert(b, body).ok()).collect();
        Self {
            broad,
            ids,
            batch: Vec::new(),
        }
    }
}

impl Engine for Ours {
    fn name(&self) -> &'static str {
        "ours"
    }

    fn prepare(&mut self, scene: &Scene) {
        self.batch.clear();
        self.batch.extend(
            scene
                .moved
                .iter()
                .map(|&i| (self.ids[i as usize], scene.boxes[i as usize])),
        );
    }

    fn step(&mut self) {
        assert!(self.broad.set_boxes(&self.batch).is_ok());
        std::hint::black_box(self.broad.step());
    }

    fn pairs(&self) -> Option<usize> {
        Some(self.broad.pair_count())
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.broad.memory_usage())
    }
}

/// parry's tree alone: leaves updated in place, optimised and refitted as its documentation
/// recommends, all pairs listed.
struct Parry {
    tree: Tree,
    boxes: Vec<(u32, parry3d::bounding_volume::Aabb)>,
}

fn parry_box(aabb: &Aabb) -> parry3d::bounding_volume::Aabb {
    let point = |p: &lin_canny::nalgebra::Point3<f64>| parry3d::math::Vector::new(p.x as f32, p.y as f32, p.z as f32);
    parry3d::bounding_volume::Aabb::new(point(&aabb.min), point(&aabb.max))
}

impl Parry {
    fn new(scene: &Scene) -> Self {
        let leaves: Vec<_> = scene.boxes.iter().map(parry_box).collect();
        Self {
            tree: Tree::new(&leaves),
            boxes: Vec::new(),
        }
    }
}

impl Engine for Parry {
    fn name(&self) -> &'static str {
        "parry-bvh"
    }

    fn prepare(&mut self, scene: &Scene) {
        self.boxes.clear();
        self.boxes
            .extend(scene.moved.iter().map(|&i| (i, parry_box(&scene.boxes[i as usize]))));
    }

    fn step(&mut self) {
        self.tree.step(self.boxes.iter().copied());
    }

    fn pairs(&self) -> Option<usize> {
        Some(self.tree.pairs.len())
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.tree.bytes())
    }
}

/// Constructor of an engine for a scene.
pub type Make = fn(&Scene) -> Box<dyn Engine>;

/// The engines in the order of the tables.
pub const ENGINES: [(&str, Make); 2] = [
    ("ours", |scene| Box::new(Ours::new(scene))),
    ("parry-bvh", |scene| Box::new(Parry::new(scene))),
];
