//! Counts of a run.

use std::collections::BTreeMap;

use crate::curved;
use crate::faulty;
use lin_canny::Outcome;
use truth::driven::lattice::Mix;
use truth::driven::{
    bytes, calls, clouds, copies, corners, distances, far, overlaps, planner, points, rays, repairs, scenes, slivers,
    solids, surfaces, throws, turned_boxes, underflow,
};

const CLASSES: [&str; 4] = ["separated", "touching", "overlapping", "undecided"];
const LAYERS: [&str; 7] = [
    "walk",
    "restart",
    "fallback",
    "double-double",
    "exact",
    "far",
    "surface",
];

truth::tally! {
    #[derive(Default)]
    pub(crate) struct Tally {
        pub(crate) trials: u64,
        /// Frames of motions, each judged.
        pub(crate) frames: u64,
        /// Calls of the crate, including the calls that are compared with a frame's outcome.
        pub(crate) queries: u64,
        /// Frames judged by exact arithmetic.
        pub(crate) exactly: u64,
        /// Frames compared with the true distance of the oracle.
        pub(crate) truths: u64,
        pub(crate) failures: u64,
        /// Manifolds judged.
        pub(crate) manifolds: u64,
        /// Worlds of equal boxes.
        pub(crate) worlds: Mix,
        /// Calls of the broad phase.
        pub(crate) calls: calls::Tally,
        /// Bodies of random bytes.
        pub(crate) bytes: bytes::Tally,
        /// Scenes of bodies of every kind.
        pub(crate) scenes: scenes::Mix,
        /// Motions of curved shapes.
        pub(crate) curves: curved::Mix,
        /// Meshes with faults.
        pub(crate) faulty: faulty::Mix,
        /// Volumes that two solids share.
        pub(crate) overlaps: overlaps::Mix,
        /// Damaged meshes.
        pub(crate) repairs: repairs::Mix,
        /// Meshes of slivers.
        pub(crate) slivers: slivers::Mix,
        /// Solids with faces in common.
        pub(crate) solids: solids::Mix,
        /// Bodies in inner corners.
        pub(crate) corners: corners::Mix,
        /// Points and rays next to closed meshes.
        pub(crate) points: points::Mix,
        /// Rays at bodies of every kind.
        pub(crate) rays: rays::Mix,
        /// Points on rotated pieces of compounds.
        pub(crate) turned_boxes: turned_boxes::Mix,
        /// Stand-in bodies.
        pub(crate) copies: copies::Mix,
        /// Bodies thrown at each other.
        pub(crate) throws: throws::Mix,
        /// Signed distances of points.
        pub(crate) distances: distances::Mix,
        /// Polyhedra whose distance underflows.
        pub(crate) underflows: underflow::Mix,
        /// Clouds.
        pub(crate) clouds: clouds::Mix,
        /// Bodies far from the origins of their frames.
        pub(crate) far: far::Mix,
        /// Pairs of surfaces.
        pub(crate) surfaces: surfaces::Mix,
        /// Worlds of the planner.
        pub(crate) planner: planner::Mix,
        /// Nanoseconds of the slowest query, and its trial.
        pub(crate) slowest: (u128, u64),
        classes: [u64; 4],
        layers: [u64; 7],
        bodies: BTreeMap<&'static str, u64>,
        motions: BTreeMap<&'static str, [u64; 4]>,
    }
}

impl Tally {
    /// Counts one frame of a trial.
    pub(crate) fn frame(&mut self, motion: &'static str, o: &Outcome) {
        self.frames += 1;
        self.classes[o.state as usize] += 1;
        self.layers[o.solver as usize] += 1;
        self.motions.entry(motion).or_default()[o.state as usize] += 1;
    }

    pub(crate) fn body(&mut self, family: &'static str, frames: u64) {
        *self.bodies.entry(family).or_default() += frames;
    }

    /// Prints all counts; `seconds` is wall time.
    pub(crate) fn print(&self, seconds: f64) {
        let list = |names: &[&str], counts: &[u64]| {
            let words = names.iter().zip(counts).filter(|(_, n)| **n > 0);
            words.map(|(w, n)| format!("{w} {n}")).collect::<Vec<_>>().join(", ")
        };
        println!(
            "{} queries in {:.0} s, {:.0} a second with their judgement",
            self.queries,
            seconds,
            self.queries as f64 / seconds
        );
        println!("worlds of equal boxes: {:?}", self.worlds);
        println!("calls of the broad phase: {:?}", self.calls);
        println!("bodies of random bytes: {:?}", self.bytes);
        println!("scenes of bodies of every kind: {:?}", self.scenes);
        println!("meshes with faults: {:?}", self.faulty);
        println!("volumes that solids share: {:?}", self.overlaps);
        println!("damaged meshes: {:?}", self.repairs);
        println!("meshes of slivers: {:?}", self.slivers);
        println!("solids with faces in common: {:?}", self.solids);
        println!("bodies in inner corners: {:?}", self.corners);
        println!("points and rays next to a mesh: {:?}", self.points);
        println!("rays at bodies: {:?}", self.rays);
        println!("points on rotated pieces: {:?}", self.turned_boxes);
        println!("bodies that are queried through copies: {:?}", self.copies);
        println!("throws of two bodies: {:?}", self.throws);
        println!("signed distances of points: {:?}", self.distances);
        println!("distances that underflow: {:?}", self.underflows);
        println!("clouds: {:?}", self.clouds);
        println!("far: {:?}", self.far);
        println!("pairs of surfaces: {:?}", self.surfaces);
        println!("worlds of the planner: {:?}", self.planner);
        let c = &self.curves;
        println!(
            "{} frames of curved shapes, {} queries: {}; {} of rounded shapes, {} separated beyond the first solver, bounds at most {:.1e} L wide",
            c.frames,
            c.queries,
            list(&CLASSES, &c.classes),
            c.rounded,
            c.beyond,
            c.widest
        );
        println!(
            "{} frames of {} motions: {}",
            self.frames,
            self.trials,
            list(&CLASSES, &self.classes)
        );
        println!("answered by: {}", list(&LAYERS, &self.layers));
        println!(
            "judged: all in f64, {} by exact bounds, {} by the exact oracle, {} manifolds; slowest query {:.1} ms (trial {})",
            self.exactly,
            self.truths,
            self.manifolds,
            self.slowest.0 as f64 / 1e6,
            self.slowest.1
        );
        println!("\nframes by motion: separated, touching, overlapping");
        for (name, [apart, touch, over, _]) in &self.motions {
            println!("  {name:<16} {apart:>11} {touch:>11} {over:>11}");
        }
        println!("frames by body");
        for (name, n) in &self.bodies {
            println!("  {name:<16} {n:>11}");
        }
        println!("\n{} failures", self.failures);
    }
}
