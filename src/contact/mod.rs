//! Contact manifolds: the few points by which two bodies hold each other apart, kept from frame to frame; and what a motion does to
//! the signed distance.
//!
//! A manifold begins with a certified answer: its normal, its features, its witnesses. The features are promoted to the faces (or
//! edges) within a small angle of the normal ([`promote`]), both are seen along it ([`shadow`]), and the corners of what they
//! share ([`clip`], and [`rims`] for faces of many corners) are the contacts. A few of them are kept ([`reduce`]): the
//! deepest, and those that span the most area. [`manifold`] keeps them over frames.
//!
//! Every pair of points (a of A, b of B) fulfils `n . b - n . a >= lower`, the bound of the answer, so the deepest contact is the
//! answer's own; no other can be deeper.
//!
//! Source: the clipping of a reference and an incident face (Gregorius 2013, "The separating axis test between convex
//! polyhedra", GDC). Departures:
//! 1. Both faces are seen along the certified normal, and play the same part: points on A and on B are across from each other along the
//!    normal, whichever body is named first.
//! 2. The reference says with which body the normal turns between two answers, no more.
//! 3. What is old is kept by how far the bodies can have moved, not by distances of points.

mod clip;
mod gradient;
mod manifold;
mod promote;
mod reduce;
mod shadow;

use nalgebra::Vector3;

use crate::closest::outcome::{Layer, Outcome};
use crate::closest::placed::Placed;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, Feature, FeaturePair, VertexId};
use crate::scalar::sqrt;
use crate::tolerance::{ACROSS, CERTIFICATE, UNIT};
use clip::{Corner, Corners, Meet};
use promote::Promotion;
use reduce::{Choice, reduce};
use shadow::{Axes, Shadow};

pub use gradient::Gradient;
pub use manifold::{ContactPoint, Manifold};

/// The most points a manifold holds.
pub(crate) const MOST_POINTS: usize = 8;

/// What is asked of a manifold. Numbers that are none (NaN) ask for nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ManifoldOptions {
    /// Contacts up to this separation are wanted, in the caller's unit. Zero: those that touch or overlap.
    pub prediction: f64,
    /// How many points at most, 1 to 8.
    pub max_points: usize,
    /// The sine of the largest angle between the normal and a face that bears the contact. Default 1/64, a little less than one degree.
    pub sine: f64,
    /// How far the bodies may move before a manifold is made anew, in radii of the smaller one; till then its points stay
    /// where they are on the bodies, with new separations. Contacts nearer to each other than this are one. Default 1/1024; zero: every
    /// motion asks anew.
    pub drift: f64,
}

impl Default for ManifoldOptions {
    fn default() -> Self {
        Self {
            prediction: 0.0,
            max_points: 4,
            sine: 1.0 / 64.0,
            drift: 1.0 / 1024.0,
        }
    }
}

impl ManifoldOptions {
    /// The default with a prediction distance.
    pub fn within(prediction: f64) -> Self {
        Self {
            prediction,
            ..Self::default()
        }
    }

    fn most(&self) -> usize {
        self.max_points.clamp(1, MOST_POINTS)
    }
}

/// The contacts of one answer.
struct Contacts {
    points: [ContactPoint; MOST_POINTS],
    count: usize,
    /// What bears them.
    features: FeaturePair,
}

/// The contacts of an answer whose lower bound is within the prediction.
fn contacts(placed: Option<&Placed>, outcome: &Outcome, options: &ManifoldOptions, before: &Manifold) -> Contacts {
    let mut contacts = Contacts {
        points: [ContactPoint::witness(outcome); MOST_POINTS],
        count: 1,
        features: outcome.features,
    };
    if let Some(placed) = placed
        && placed.has_one_unit()
        && outcome.layer != Layer::Far
    {
        let seen = Seen::new(placed, outcome, options, before);
        contacts.features = seen.features;
        seen.choose(options, before, &mut contacts);
    }
    contacts
}

/// Two features seen along the normal.
struct Seen<'a> {
    placed: &'a Placed<'a>,
    outcome: &'a Outcome,
    axes: [Axes; 2],
    features: FeaturePair,
    shadows: [Option<Shadow>; 2],
    /// One stored unit in the caller's.
    unit: f64,
}

impl<'a> Seen<'a> {
    #[inline(always)]
    fn new(placed: &'a Placed<'a>, outcome: &'a Outcome, options: &ManifoldOptions, before: &Manifold) -> Self {
        let (a, b) = (placed.a, placed.b);
        let normal = outcome.normal.into_inner();
        let across = across(&normal);
        let turned = |v: &Vector3<f64>| placed.vector_in_b(v);
        let axes = [
            Axes {
                across,
                normal,
                witness: a.stored(&outcome.point_on_a),
            },
            Axes {
                across: [turned(&across[0]), turned(&across[1])],
                normal: turned(&normal),
                witness: b.stored(&outcome.point_on_b),
            },
        ];
        let promote = |body, outward, feature, kept| {
            let promotion = Promotion {
                body,
                outward,
                sine: options.sine,
                kept,
            };
            promotion.of(feature)
        };
        let kept = before.features();
        let features = FeaturePair {
            a: promote(a, normal, outcome.features.a, kept.map(|f| f.a)),
            b: promote(b, -axes[1].normal, outcome.features.b, kept.map(|f| f.b)),
        };
        let shadows = [
            Shadow::new(a, features.a, &axes[0], true),
            Shadow::new(b, features.b, &axes[1], false),
        ];
        Self {
            placed,
            outcome,
            axes,
            features,
            shadows,
            unit: a.unit(),
        }
    }

    /// The separation at a corner, in stored units.
    fn separation(&self, corner: &Corner) -> f64 {
        self.outcome.distance / self.unit + (corner.heights[1] - corner.heights[0])
    }

    /// The corners within the prediction, the witnesses among them where no corner is as deep.
    fn corners(&self, options: &ManifoldOptions) -> Corners {
        let mut corners = Corners::new();
        let noise = ACROSS * self.placed.size();
        if let [Some(a), Some(b)] = &self.shadows {
            if a.is_edge() && b.is_edge() {
                clip::beside(a, b, options.sine, &mut corners);
            } else {
                clip::clip(a, b, noise, &mut corners);
            }
        }
        let prediction = options.prediction / self.unit;
        corners.keep(|c| self.separation(c) <= prediction);
        let deep = self.outcome.upper / self.unit + CERTIFICATE * UNIT * self.placed.size();
        if !corners.all().iter().any(|c| self.separation(c) <= deep) {
            corners.push(Corner {
                at: [0.0; 2],
                heights: [0.0; 2],
                meet: Meet::Witness,
            });
        }
        corners
    }

    fn choose(&self, options: &ManifoldOptions, before: &Manifold, contacts: &mut Contacts) {
        let corners = self.corners(options);
        let corners = corners.all();
        let (a, b) = (self.placed.a, self.placed.b);
        let noise = ACROSS * self.placed.size();
        let merge = noise.max(options.drift * a.radius.min(b.radius));
        let mut choices = [Choice::default(); clip::MOST];
        for (choice, c) in choices.iter_mut().zip(corners) {
            *choice = Choice {
                at: c.at,
                separation: self.separation(c),
                kept: corners.len() > options.most() && before.has(self.name(c)),
            };
        }
        let chosen = reduce(&choices[..corners.len()], options.most(), merge, noise);
        contacts.count = chosen.all().len();
        for (point, &k) in contacts.points.iter_mut().zip(chosen.all()) {
            *point = self.contact(&corners[k]);
        }
    }

    fn name(&self, corner: &Corner) -> FeaturePair {
        let [Some(a), Some(b)] = &self.shadows else {
            return self.outcome.features;
        };
        let vertex = |s: &Shadow, k: u8| Feature::Vertex(VertexId(s.vertices[usize::from(k)]));
        let edge = |s: &Shadow, k: u8| Feature::Edge(EdgeId(s.edges[usize::from(k)]));
        let (a, b) = match corner.meet {
            Meet::Witness => return self.outcome.features,
            Meet::CornerOfA(k) => (vertex(a, k), b.feature),
            Meet::CornerOfB(k) => (a.feature, vertex(b, k)),
            Meet::Crossing(i, j) => (edge(a, i), edge(b, j)),
        };
        FeaturePair { a, b }
    }

    fn contact(&self, corner: &Corner) -> ContactPoint {
        let [Some(a), Some(b)] = &self.shadows else {
            return ContactPoint::witness(self.outcome);
        };
        let (on_a, on_b) = match corner.meet {
            Meet::Witness => return ContactPoint::witness(self.outcome),
            Meet::CornerOfA(k) => (Some(k), b.is_edge().then_some(0)),
            Meet::CornerOfB(k) => (a.is_edge().then_some(0), Some(k)),
            Meet::Crossing(i, j) => (Some(i), Some(j)),
        };
        let features = self.name(corner);
        let place = |which: usize, body: &ConvexPolyhedron, shadow: &Shadow, k: Option<u8>, feature| {
            let end = |k: usize| body.points[shadow.vertices[k] as usize];
            let p = match (feature, k.map(usize::from)) {
                (Feature::Vertex(_), Some(k)) => end(k),
                (Feature::Edge(_), Some(k)) => {
                    let t = shadow.along(k, corner.at);
                    end(k) + (end(shadow.next(k)) - end(k)) * t
                }
                _ => self.axes[which].point(corner.at, corner.heights[which]),
            };
            body.given(&p)
        };
        ContactPoint {
            point_on_a: place(0, self.placed.a, a, on_a, features.a),
            point_on_b: place(1, self.placed.b, b, on_b, features.b),
            separation: self.separation(corner) * self.unit,
            features,
            id: features,
        }
    }
}

impl ConvexPolyhedron {
    /// A point in the caller's coordinates, in stored ones.
    fn stored(&self, given: &nalgebra::Point3<f64>) -> Vector3<f64> {
        if self.as_given {
            given.coords
        } else {
            (given.coords - self.origin) / self.unit()
        }
    }
}

/// Two unit directions at right angles to a unit direction and to each other, right-handed with it.
fn across(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if n.x.abs() < 0.6 {
        Vector3::new(0.0, -n.z, n.y)
    } else {
        Vector3::new(n.z, 0.0, -n.x)
    };
    let first = other / sqrt(other.norm_squared());
    [first, n.cross(&first)]
}
