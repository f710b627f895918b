//! Two bodies of convex parts at a pose: pairs of parts are asked by trackers that are kept.

use alloc::collections::BTreeMap;
use nalgebra::{Isometry3, Vector3};

use crate::base::num::extremes::{Bounded, Extremes};
use crate::body::polyhedron::FeaturePair;
use crate::body::shape::Shape;
use crate::composite::front::NodePair;
use crate::composite::meet::frame::TreeFrame;
use crate::composite::meet::overlap::Touching;
use crate::composite::meet::search::{Judge, Measured};
use crate::composite::meet::state::PosedTrees;
use crate::composite::parts::Parted;
use crate::composite::placement::Placed;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::{Class, Outcome};

/// Two parts that came near.
#[derive(Clone, Debug)]
pub(super) struct NearParts {
    parts: [(Shape, Isometry3<f64>); 2],
    pub(super) tracker: ShapeTracker,
}

/// Judges pairs of parts.
pub(super) struct PartJudge<'a, A, B> {
    posed: &'a PosedTrees<'a, A, B>,
    placed: Placed<'a>,
    /// The distance in question, in the caller's unit, if that is the question.
    within: Option<f64>,
    near: &'a mut BTreeMap<NodePair, NearParts>,
}

impl<'a, A: Parted, B: Parted> PartJudge<'a, A, B> {
    pub(super) fn new(
        posed: &'a PosedTrees<'a, A, B>,
        within: Option<f64>,
        near: &'a mut BTreeMap<NodePair, NearParts>,
    ) -> Self {
        Self {
            posed,
            placed: Placed::of(posed.pose, posed.a, posed.b),
            within,
            near,
        }
    }

    /// Returns the bounds of two parts about which nothing is known.
    fn unknown(&self, frame: &TreeFrame, pair: NodePair) -> Measured<FeaturePair> {
        let (on_a, on_b) = (self.posed.a.side().tree.centre, self.posed.b.side().tree.centre);
        Measured {
            pair,
            distance: frame.size,
            lower: 0.0,
            upper: frame.size,
            normal: Vector3::x(),
            on_a,
            on_b,
            features: FeaturePair::FIRST,
            crosses: false,
        }
    }
}

impl<A: Parted, B: Parted> Judge for PartJudge<'_, A, B> {
    type Features = FeaturePair;

    fn highest_in_a(&self, item: u32, n: &Vector3<f64>) -> f64 {
        self.posed.a.highest(item, n)
    }

    fn lowest_in_b(&self, item: u32, n: &Vector3<f64>) -> f64 {
        -self.posed.b.highest(item, &-n)
    }

    fn shares_inside(&self, touching: &Touching, found: &Measured<FeaturePair>) -> (bool, u64) {
        self.posed.shares_inside(touching, found, false)
    }

    fn measure(&mut self, frame: &TreeFrame, pair: NodePair, _: f64) -> Measured<FeaturePair> {
        let (a, b) = (self.posed.a, self.posed.b);
        if !self.near.contains_key(&pair) {
            let (Some(p), Some(q)) = (a.part(pair[0]), b.part(pair[1])) else {
                return self.unknown(frame, pair);
            };
            let near = NearParts {
                parts: [p, q],
                tracker: ShapeTracker::new(),
            };
            self.near.insert(pair, near);
        }
        let Some(NearParts { parts, tracker }) = self.near.get_mut(&pair) else {
            return self.unknown(frame, pair);
        };
        let [(p, at_p), (q, at_q)] = parts;
        let (pose, exact) = self.placed.between(at_p, at_q);
        let mut o: Outcome = tracker.closest_or_class(p, q, &pose);
        if !exact && o.class == Class::Overlapping {
            // Only a depth beyond the rounding of composed poses proves an overlap.
            o = tracker.closest(p, q, &pose);
        }
        let unit = 1.0 / a.stored_unit();
        // The rounding of composed poses: two products of rotations and two sums.
        let error = if exact { 0.0 } else { 2.0 * frame.error };
        let meets = o.class == Class::Overlapping;
        let distance = if meets { 0.0 } else { (o.distance * unit).at_least(0.0) };
        let mut m = Measured {
            pair,
            distance,
            lower: if meets {
                0.0
            } else {
                (o.lower * unit - error).at_least(0.0)
            },
            // An overlap no deeper than rounding may be a gap.
            upper: if meets {
                (o.upper * unit + error).at_least(0.0)
            } else {
                (o.upper * unit).larger(distance) + error
            },
            normal: at_p.rotation * *o.normal,
            on_a: (*at_p * o.point_on_a).coords * unit,
            on_b: (*at_q * o.point_on_b).coords / b.stored_unit(),
            features: o.features,
            crosses: meets && (exact || o.upper * unit < -error),
        };
        let Some(d) = self.within else { return m };
        let stored = d * unit;
        if !(m.lower > stored || m.upper <= stored) {
            if !exact || tracker.within(p, q, &pose, d) {
                (m.lower, m.distance, m.upper) = (
                    m.lower.smaller(stored),
                    m.distance.smaller(stored),
                    m.upper.smaller(stored),
                );
            } else {
                m.lower = stored.next_up();
                m.distance = m.distance.larger(m.lower);
                m.upper = m.upper.larger(m.lower);
            }
        }
        m
    }
}
