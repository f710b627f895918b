//! Pairs of composites and of meshes over time.
//!
//! No plane separates bodies that reach into each other's hollows, so a look ahead bounds every
//! pair of nodes of the two trees along a direction of its own (`ahead`), and the displacement of
//! all points: bodies that are `d` apart stay apart until their points, seen from each other, may
//! have moved by `d` (Mirtich 1996, conservative advancement). The longer time counts.

use nalgebra::{Point3, Vector3};

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::BOX_TURNED;
use crate::composite::front::memory::FrontMemory;
use crate::composite::meet::look_ahead::LookAhead;
use crate::composite::meet::state::PosedTrees;
use crate::composite::mesh::Mesh;
use crate::composite::mesh::tracker::MeshTracker;
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::pieces::CompositeTracker;
use crate::pair::outcome::Decision;
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::time::separation::{Flight, Free, Measure, Proof, Separation};

/// Two composites, or a composite and a mesh, that can be measured over time.
#[derive(Debug)]
pub(crate) struct CompositePair<'a> {
    pub(crate) a: PartsRef<'a>,
    pub(crate) b: PartsRef<'a>,
    pub(crate) tracker: &'a mut CompositeTracker,
}

/// Two meshes that can be measured over time.
#[derive(Debug)]
pub(crate) struct MeshPair<'a> {
    pub(crate) a: &'a Mesh,
    pub(crate) b: &'a Mesh,
    pub(crate) tracker: &'a mut MeshTracker,
}

impl CompositePair<'_> {
    /// Returns the closest points.
    pub(crate) fn ask(&mut self, a_from_b: &RelativePose, _: &Question) -> Answer {
        self.tracker.closest(&self.a, &self.b, a_from_b).without_depth()
    }

    /// Returns whether the bodies are at most `d` apart.
    pub(crate) fn ask_within(&mut self, a_from_b: &RelativePose, d: f64, _: &Question) -> Decision {
        Decision::of(self.tracker.within(&self.a, &self.b, a_from_b, d))
    }
}

impl MeshPair<'_> {
    /// Returns the closest points.
    pub(crate) fn ask(&mut self, a_from_b: &RelativePose, _: &Question) -> Answer {
        self.tracker.closest(self.a, self.b, a_from_b).without_depth()
    }

    /// Returns whether the meshes are at most `d` apart.
    pub(crate) fn ask_within(&mut self, a_from_b: &RelativePose, d: f64, _: &Question) -> Decision {
        Decision::of(self.tracker.within(self.a, self.b, a_from_b, d))
    }
}

/// Returns the ball about a bounding box that is right up to rounding.
pub(crate) fn ball_about((low, high): (Point3<f64>, Point3<f64>)) -> (Point3<f64>, f64) {
    let half: Vector3<f64> = (high - low) * 0.5;
    let centre = low + half;
    let far = centre.coords.abs().sum() + half.sum();
    (centre, sqrt(half.norm_squared()) + BOX_TURNED * far)
}

/// Returns how long the lower bound of a distance lasts, or the pairs of nodes stay apart.
fn ahead<S: Separation, A: Parted, B: Parted>(
    pair: &S,
    (a, b, kept): (&A, &B, &FrontMemory),
    seen: &Measure,
    flight: &Flight,
) -> Free {
    let (timed, tick) = flight.on_own_clock();
    let flight = &timed;
    let apart = flight.apart(pair);
    let mut span = flight.held(pair, seen.lower - flight.keep - apart.noise);
    if span < flight.span
        && seen.lower > flight.keep
        && let Ok(pose) = RelativePose::new(&flight.pose_a, &flight.pose_b)
        && let Some(posed) = PosedTrees::new(a, b, &pose)
    {
        span = span.larger(LookAhead::new(&posed, flight, apart.noise, apart.radii).span(kept, seen));
    }
    Free {
        span: span * tick,
        proof: Proof::Own,
    }
}

impl Separation for CompositePair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        ball_about(if of == Operand::A { self.a } else { self.b }.corners_of_box())
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Measure::from(&self.tracker.closest(&self.a, &self.b, a_from_b))
    }

    /// By `CompositeTracker::within`: ties count as met.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        self.tracker.within(&self.a, &self.b, a_from_b, distance)
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        ahead(self, (&self.a, &self.b, self.tracker.kept()), seen, flight)
    }
}

impl Separation for MeshPair<'_> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        ball_about(if of == Operand::A { self.a } else { self.b }.aabb())
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measure {
        Measure::from(&self.tracker.closest(self.a, self.b, a_from_b))
    }

    /// By `MeshTracker::within`: ties count as met.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measure) -> bool {
        self.tracker.within(self.a, self.b, a_from_b, distance)
    }

    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        ahead(self, (self.a, self.b, self.tracker.kept()), seen, flight)
    }
}
