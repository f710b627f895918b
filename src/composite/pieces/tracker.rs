//! What a caller keeps of a pair of bodies of pieces, and the queries.

use alloc::collections::BTreeMap;
use nalgebra::{Point3, Unit, Vector3};

use super::Composite;
use super::pair::{PiecePair, side};
use crate::composite::frame::Frame;
use crate::composite::front::Pair;
use crate::composite::kept::Kept;
use crate::composite::search::{Goal, MeshWork, Search};
use crate::pair::outcome::{Class, Distance};
use crate::polyhedron::FeaturePair;
use crate::pose::RelativePose;
use crate::tracker::Tracker;
use crate::tuning::composite::TRACKERS;

/// The closest points of two bodies of pieces, with proof.
///
/// The distance is that of the bodies as sets of points: zero if they share one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CompositeOutcome {
    /// Which side of contact.
    pub class: Class,
    /// The distance, between the bounds; zero for bodies that share a point.
    pub distance: f64,
    /// No greater than the distance.
    pub lower: f64,
    /// No less than the distance.
    pub upper: f64,
    /// The closest piece of A and of B, by the caller's order.
    pub pieces: [u32; 2],
    /// The closest features of these two.
    pub features: FeaturePair,
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
}

impl From<&CompositeOutcome> for Distance {
    fn from(outcome: &CompositeOutcome) -> Self {
        Self {
            class: outcome.class,
            value: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
        }
    }
}

/// The front of the last answer for one pair of bodies of pieces, and a [`Tracker`] for each pair
/// of pieces that came near.
///
/// Owns no body. What is kept changes time, never an answer.
#[derive(Clone, Debug, Default)]
pub struct CompositeTracker {
    fingerprints: [u64; 2],
    kept: Kept,
    trackers: BTreeMap<Pair, Tracker>,
}

impl CompositeTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far; `measured` counts queries of two pieces.
    #[must_use]
    pub fn work(&self) -> MeshWork {
        self.kept.work
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.kept.front.len()
    }

    /// Forgets everything that is kept, counters too.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Returns the closest points with bounds of the distance: for bodies apart no wider than
    /// `1e-13 L`, with `L` the sum of both radii about the bodies' own origins and the distance of
    /// these; half as much more if pieces have poses of their own.
    pub fn closest(&mut self, a: &Composite, b: &Composite, a_from_b: &RelativePose) -> CompositeOutcome {
        self.recognise(a, b);
        self.kept.work.queries += 1;
        let Some(frame) = Frame::new(side(a), side(b), a_from_b) else {
            return far(a, b, a_from_b);
        };
        let judge = PiecePair::new(a, b, a_from_b, &mut self.trackers);
        let mut search = Search::new((&a.tree, &b.tree), &frame, judge, Goal::Least);
        self.kept.closest(&mut search);
        let (best, lower) = (search.best, search.lower);
        self.forget_some();
        let Some(best) = best else { return far(a, b, a_from_b) };
        let unit = a.unit();
        let lower = lower.min(best.lower).max(0.0) * unit;
        let class = match best.crosses {
            true => Class::Overlapping,
            false if lower > 0.0 => Class::Separated,
            false => Class::Touching,
        };
        CompositeOutcome {
            class,
            distance: best.distance * unit,
            lower,
            upper: best.upper * unit,
            pieces: [a.order[best.pair[0] as usize], b.order[best.pair[1] as usize]],
            features: best.features,
            point_on_a: Point3::from(best.on_a * unit),
            point_on_b: Point3::from(best.on_b * b.unit()),
            normal: Unit::new_unchecked(best.normal),
        }
    }

    /// Returns the distance and its bounds without the witnesses.
    pub fn distance(&mut self, a: &Composite, b: &Composite, a_from_b: &RelativePose) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b))
    }

    /// Returns whether the bodies share a point; touching counts. Exact, with the feature `exact`,
    /// if no piece has a pose of its own; else ties count as touching.
    pub fn intersects(&mut self, a: &Composite, b: &Composite, a_from_b: &RelativePose) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the bodies are at most `d` apart: as exact as
    /// [`intersects`](Self::intersects). False for a negative `d` and NaN.
    pub fn within(&mut self, a: &Composite, b: &Composite, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        self.recognise(a, b);
        self.kept.work.queries += 1;
        let Some(frame) = Frame::new(side(a), side(b), a_from_b) else {
            return far(a, b, a_from_b).lower <= d;
        };
        let mut judge = PiecePair::new(a, b, a_from_b, &mut self.trackers);
        judge.within = Some(d);
        let mut search = Search::new((&a.tree, &b.tree), &frame, judge, Goal::Within(d / a.unit()));
        let is_within = self.kept.is_within(&mut search);
        self.forget_some();
        is_within
    }

    fn recognise(&mut self, a: &Composite, b: &Composite) {
        let fingerprints = [a.fingerprint, b.fingerprint];
        if self.fingerprints != fingerprints {
            let work = self.kept.work;
            self.reset();
            (self.fingerprints, self.kept.work) = (fingerprints, work);
        }
    }

    fn forget_some(&mut self) {
        if self.trackers.len() > TRACKERS * self.kept.front.len() + 64 {
            self.trackers.clear();
        }
    }
}

/// Bodies so far apart, or so small beside their distance, that only balls about their origins
/// count.
fn far(a: &Composite, b: &Composite, pose: &RelativePose) -> CompositeOutcome {
    let (distance, slack, normal) = crate::composite::frame::far(side(a), side(b), pose);
    let lower = (distance - slack).max(0.0);
    CompositeOutcome {
        class: if lower > 0.0 {
            Class::Separated
        } else {
            Class::Undecided
        },
        distance,
        lower,
        upper: distance + slack,
        pieces: [0; 2],
        features: FeaturePair::vertices(crate::pose::Operand::A, 0, 0),
        point_on_a: a.pieces[0].pose * a.pieces[0].shape.centroid(),
        point_on_b: b.pieces[0].pose * b.pieces[0].shape.centroid(),
        normal: Unit::new_unchecked(normal),
    }
}
