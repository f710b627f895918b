//! Engines that step whole scenes, behind one interface.

use crate::common::tree::Tree;
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{Body, BodyId, Group, PairQueries, Report, Scene};
use lin_canny::{ManifoldOptions, Solver};
use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose as Pose32, Rotation, Vector};
use parry3d::query;
use parry3d::shape::SharedShape;
use std::time::Duration;
use truth::Pose;
use truth::crowd::Crowd;

/// Range of the distance queries; the prediction distance of rapier.
pub const RANGE: f64 = 0.02;

/// An engine that is given a crowd.
pub trait Engine {
    /// Name in tables and records.
    fn name(&self) -> &'static str;
    /// Converts the poses into the engine's form; not timed.
    fn prepare(&mut self, poses: &[Pose]);
    /// Runs the timed part.
    fn step(&mut self);
    /// Returns the number of near pairs.
    fn pairs(&self) -> usize;
    /// Additional results of one engine, after the race.
    fn remarks(&self) -> String {
        String::new()
    }
    /// Marks the end of the warm-up steps.
    fn warmed_up(&mut self) {}
}

struct Ours {
    name: &'static str,
    scene: Scene,
    ids: Vec<BodyId>,
    poses: Vec<Isometry3<f64>>,
    sum: Report,
}

impl Ours {
    fn new(name: &'static str, crowd: &Crowd) -> Self {
        let shapes = crowd.hulls();
        let mut scene = Scene::new();
        let mut queries = PairQueries::none().overlap(true).distance(RANGE).features(true);
        queries.depth = name != "ours";
        queries.manifold = (name == "ours-manifold").then_some(ManifoldOptions::default().prediction(RANGE));
        let all = Group::default();
        scene.set_queries(all, all, queries).expect("a range");
        let insert = |(shape, pose): (&usize, &Pose)| {
            let body = Body::moving(shapes[*shape].clone());
            scene.insert(body, pose.isometry()).expect("a pose")
        };
        let ids = crowd.shape_of.iter().zip(&crowd.poses).map(insert).collect();
        Self {
            name,
            scene,
            ids,
            poses: vec![],
            sum: Report::default(),
        }
    }
}

impl Engine for Ours {
    fn name(&self) -> &'static str {
        self.name
    }

    fn prepare(&mut self, poses: &[Pose]) {
        self.poses.clear();
        self.poses.extend(poses.iter().map(Pose::isometry));
    }

    fn step(&mut self) {
        for (id, pose) in self.ids.iter().zip(&self.poses) {
            self.scene.set_pose(*id, *pose).expect("a pose");
        }
        self.sum += *self.scene.step();
    }

    fn pairs(&self) -> usize {
        self.scene.pairs().filter(|p| p.distance.is_some()).count()
    }

    fn warmed_up(&mut self) {
        self.sum = Report::default();
    }

    fn remarks(&self) -> String {
        let (c, t) = (&self.sum.counts, &self.sum.times);
        let steps = c.steps.max(1) as f64;
        let us = |d: Duration| d.as_secs_f64() * 1e6 / steps;
        let bytes = self.scene.memory_usage();
        let (n, pairs) = (self.scene.body_count().max(1), (c.active as f64 / steps).max(1.0));
        format!(
            "    wall us a step: boxes {:.0}, pairs {:.0}, look {:.0}, events {:.0}; a step: {:.0} box pairs, {:.0} by budget, {:.0} by balls, {:.0} asked ({:.0} walk, {:.0} kept proof, {:.0} other); {} bytes a body, {:.0} a pair",
            us(t.boxes),
            us(t.pairs),
            us(t.narrow_phase),
            us(t.events),
            c.pairs as f64 / steps,
            c.skipped as f64 / steps,
            c.balls as f64 / steps,
            c.queries as f64 / steps,
            c.answered_by(Solver::Walk) as f64 / steps,
            c.answered_by(Solver::Polytope) as f64 / steps,
            (c.queries - c.answered_by(Solver::Walk) - c.answered_by(Solver::Polytope)) as f64 / steps,
            (bytes.bodies + bytes.broad + bytes.scratch) / n,
            bytes.pairs as f64 / pairs,
        )
    }
}

/// Returns the pose in the types of parry and rapier.
pub fn pose32(pose: &Pose) -> Pose32 {
    let ([x, y, z], [i, j, k, w]) = (pose.t.map(|v| v as f32), pose.q.map(|v| v as f32));
    Pose32::from_parts(Vector::new(x, y, z), Rotation::from_xyzw(i, j, k, w))
}

/// Returns the shapes of a crowd as parry's hulls in single precision.
pub fn hulls32(crowd: &Crowd) -> Vec<SharedShape> {
    let vector = |p: &[f64; 3]| Vector::new(p[0] as f32, p[1] as f32, p[2] as f32);
    let hull = |points: Vec<_>| SharedShape::convex_hull(&points).expect("points of a crowd are a hull");
    crowd
        .shapes
        .iter()
        .map(|s| hull(s.points.iter().map(vector).collect()))
        .collect()
}

/// The parts of parry that a scene needs, combined as its documentation recommends.
struct Parry {
    shapes: Vec<SharedShape>,
    poses: Vec<Pose32>,
    tree: Tree,
    near: usize,
}

impl Parry {
    fn new(crowd: &Crowd) -> Self {
        let distinct = hulls32(crowd);
        let shapes: Vec<_> = crowd.shape_of.iter().map(|k| distinct[*k].clone()).collect();
        let poses: Vec<_> = crowd.poses.iter().map(pose32).collect();
        let leaves: Vec<Aabb> = shapes.iter().zip(&poses).map(|(s, p)| s.compute_aabb(p)).collect();
        Self {
            tree: Tree::new(&leaves),
            shapes,
            poses,
            near: 0,
        }
    }
}

impl Engine for Parry {
    fn name(&self) -> &'static str {
        "parry-parts"
    }

    fn prepare(&mut self, poses: &[Pose]) {
        self.poses.clear();
        self.poses.extend(poses.iter().map(pose32));
    }

    fn step(&mut self) {
        let boxes = self.shapes.iter().zip(&self.poses).map(|(s, p)| s.compute_aabb(p));
        self.tree.step((0..).zip(boxes));
        self.near = 0;
        for &(a, b) in &self.tree.pairs {
            let (a, b) = (a as usize, b as usize);
            let (shape_a, shape_b) = (&*self.shapes[a], &*self.shapes[b]);
            let found = query::distance(&self.poses[a], shape_a, &self.poses[b], shape_b);
            self.near += usize::from(found.is_ok_and(|d| d.distance <= RANGE as f32));
        }
    }

    fn pairs(&self) -> usize {
        self.near
    }
}

/// Constructor of an engine for a crowd.
pub type Make = fn(&Crowd) -> Box<dyn Engine>;

/// The engines in the order of the tables.
pub const ENGINES: [(&str, Make); 4] = [
    ("ours", |crowd| Box::new(Ours::new("ours", crowd))),
    ("ours-depth", |crowd| Box::new(Ours::new("ours-depth", crowd))),
    ("ours-manifold", |crowd| Box::new(Ours::new("ours-manifold", crowd))),
    ("parry-parts", |crowd| Box::new(Parry::new(crowd))),
];
