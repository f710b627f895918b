//! Two bodies of pieces at a pose: pairs of pieces are asked by trackers that are kept.

use alloc::collections::BTreeMap;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::{Composite, Piece};
use crate::composite::frame::{Frame, Side};
use crate::composite::front::Pair;
use crate::composite::search::{Judge, Measured};
use crate::pair::outcome::{Class, Outcome};
use crate::polyhedron::FeaturePair;
use crate::pose::RelativePose;
use crate::tracker::Tracker;

/// The body as its tree sees it.
pub(super) fn side(body: &Composite) -> Side<'_> {
    Side {
        tree: &body.tree,
        exponent: body.exponent,
        radius: body.radius,
    }
}

/// Judges pairs of pieces.
pub(super) struct PiecePair<'a> {
    pub(super) a: &'a Composite,
    pub(super) b: &'a Composite,
    pub(super) pose: &'a RelativePose,
    /// B in A's frame, if poses have to be composed.
    composed: Option<Isometry3<f64>>,
    /// The distance in question, in the caller's unit, if that is the question.
    pub(super) within: Option<f64>,
    pub(super) trackers: &'a mut BTreeMap<Pair, Tracker>,
}

impl<'a> PiecePair<'a> {
    pub(super) fn new(
        a: &'a Composite,
        b: &'a Composite,
        pose: &'a RelativePose,
        trackers: &'a mut BTreeMap<Pair, Tracker>,
    ) -> Self {
        let composed = (!(a.in_place && b.in_place)).then(|| {
            let (pose_a, pose_b) = pose.poses();
            let unit = |q: UnitQuaternion<f64>| UnitQuaternion::new_normalize(q.into_inner());
            let rotation = unit(unit(pose_a.rotation).inverse() * unit(pose_b.rotation));
            Isometry3::from_parts(pose.translation().into(), rotation)
        });
        Self {
            a,
            b,
            pose,
            composed,
            within: None,
            trackers,
        }
    }

    fn pieces(&self, [i, j]: Pair) -> (&'a Piece, &'a Piece) {
        let at = |body: &'a Composite, k: u32| &body.pieces[body.order[k as usize] as usize];
        (at(self.a, i), at(self.b, j))
    }

    /// The relative pose of two pieces, and whether it is the bodies' own without rounding.
    fn pose_of(&self, p: &Piece, q: &Piece) -> (RelativePose, bool) {
        let Some(composed) = &self.composed else {
            return (*self.pose, true);
        };
        let mut placed = composed * q.pose;
        placed.rotation = UnitQuaternion::new_normalize(placed.rotation.into_inner());
        RelativePose::new(&p.pose, &placed).map_or((*self.pose, false), |pose| (pose, false))
    }
}

impl Judge for PiecePair<'_> {
    type Features = FeaturePair;

    const HAS_HEIGHTS: bool = false;

    fn highest_in_a(&self, _: u32, _: &Vector3<f64>) -> f64 {
        f64::INFINITY
    }

    fn lowest_in_b(&self, _: u32, _: &Vector3<f64>) -> f64 {
        f64::NEG_INFINITY
    }

    fn measure(&mut self, frame: &Frame, pair: Pair, _: f64) -> Measured<FeaturePair> {
        let (p, q) = self.pieces(pair);
        let (pose, exact) = self.pose_of(p, q);
        let tracker = self.trackers.entry(pair).or_default();
        let mut o: Outcome = tracker.closest_or_class(&p.shape, &q.shape, &pose);
        if !exact && o.class == Class::Overlapping {
            // Only a depth beyond the rounding of composed poses proves an overlap.
            o = tracker.closest(&p.shape, &q.shape, &pose);
        }
        let unit = 1.0 / self.a.unit();
        // What composing poses has rounded: two products of rotations and two sums.
        let error = if exact { 0.0 } else { 2.0 * frame.error };
        let meets = o.class == Class::Overlapping;
        let distance = if meets { 0.0 } else { (o.distance * unit).max(0.0) };
        let mut m = Measured {
            pair,
            distance,
            lower: if meets { 0.0 } else { (o.lower * unit - error).max(0.0) },
            upper: if meets {
                0.0
            } else {
                (o.upper * unit).max(distance) + error
            },
            normal: p.pose.rotation * *o.normal,
            on_a: (p.pose * o.point_on_a).coords * unit,
            on_b: (q.pose * o.point_on_b).coords / self.b.unit(),
            features: o.features,
            crosses: meets && (exact || o.upper * unit < -error),
        };
        let Some(d) = self.within else { return m };
        let stored = d * unit;
        if !(m.lower > stored || m.upper <= stored) {
            if !exact || tracker.within(&p.shape, &q.shape, &pose, d) {
                (m.lower, m.distance, m.upper) = (m.lower.min(stored), m.distance.min(stored), m.upper.min(stored));
            } else {
                m.lower = stored.next_up();
                m.distance = m.distance.max(m.lower);
                m.upper = m.upper.max(m.lower);
            }
        }
        m
    }
}
