//! Contact manifolds of shapes.

use nalgebra::Vector3;

use super::ShapeTracker;
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::STAY;
use crate::body::polyhedron::{EdgeId, FaceId, Feature, VertexId};
use crate::body::shape::{Cone, Core, Cylinder, Shape};
use crate::convex::contact::{Extent, Facet, Manifold, ManifoldOptions, Query, RoundFace};
use crate::convex::smooth;
use crate::pair::outcome::{DepthMode, Outcome};

impl ShapeTracker {
    /// Computes the contact points of two shapes within `options.prediction`, in `manifold`.
    ///
    /// `PairTracker::manifold` describes them.
    pub(crate) fn manifold(
        &mut self,
        a: &Shape,
        b: &Shape,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) {
        self.manifold_by([a, b], a_from_b, options, manifold, |tracker| {
            tracker.closest_cores(a, b, a_from_b, options.until())
        });
    }

    /// Computes the contact points as [`manifold`](Self::manifold) does, from an outcome of the
    /// cores.
    ///
    /// The outcome is queried only if the old points are no longer valid.
    pub(crate) fn manifold_by(
        &mut self,
        [a, b]: [&Shape; 2],
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
        outcome: impl FnOnce(&mut Self) -> Outcome,
    ) {
        let radii = [a.rounding_radius(), b.rounding_radius()];
        // The distance of the cores is larger by the radii.
        let of_cores = ManifoldOptions {
            prediction: options.prediction + radii[0] + radii[1],
            ..*options
        };
        if let (Core::Polyhedron(x), Core::Polyhedron(y)) = (a.core(), b.core()) {
            let facets = [Facet::Body(x), Facet::Body(y)];
            let query = Query::of([extent(a), extent(b)], facets, a_from_b, &of_cores).rounded(radii);
            if let Err(moved) = manifold.refresh(&query) {
                manifold.renew(&query, &outcome(self), moved);
            }
            return;
        }
        let extents = [extent(a), extent(b)];
        let mut query = Query::of(extents, [Facet::Point; 2], a_from_b, &of_cores).rounded(radii);
        if let Err(moved) = manifold.refresh(&query) {
            let outcome = outcome(self);
            let normal = outcome.normal.into_inner();
            let bears = |previous: Option<Feature>| Bearing {
                sine: options.max_face_sine,
                previous,
            };
            let previous = manifold.features();
            query.facets = [
                bears(previous.map(|f| f.a)).facet(a.core(), &normal),
                bears(previous.map(|f| f.b)).facet(b.core(), &-a_from_b.rotation().tr_mul(&normal)),
            ];
            manifold.renew(&query, &outcome, moved);
        }
    }

    /// Makes the witness points of an outcome of the cores the only contact of `manifold`, as a new
    /// contact.
    pub(crate) fn manifold_of_witnesses(
        [a, b]: [&Shape; 2],
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        outcome: &Outcome,
    ) -> Manifold {
        let radii = [a.rounding_radius(), b.rounding_radius()];
        let of_cores = ManifoldOptions {
            prediction: options.prediction + radii[0] + radii[1],
            ..*options
        };
        let extents = [extent(a), extent(b)];
        let query = Query::of(extents, [Facet::Point; 2], a_from_b, &of_cores).rounded(radii);
        let mut manifold = Manifold::new();
        manifold.renew(&query, outcome, 0.0);
        manifold
    }

    /// Returns the closest points of the cores of two shapes, with a local depth if that is enough.
    pub(crate) fn closest_cores(&mut self, a: &Shape, b: &Shape, a_from_b: &RelativePose, until: DepthMode) -> Outcome {
        if let (Core::Polyhedron(x), Core::Polyhedron(y)) = (a.core(), b.core()) {
            return self.polyhedral.checked(x, y, a_from_b, until);
        }
        let outcome = smooth::closest(a.core(), b.core(), a_from_b, until, &mut self.curved);
        self.count(&outcome);
        outcome
    }
}

/// Returns the extent of the core of a shape, with the fingerprint of the shape.
#[inline]
fn extent(shape: &Shape) -> Extent {
    let (core, fingerprint) = (shape.core(), shape.fingerprint());
    if let Core::Polyhedron(body) = core {
        return Extent {
            fingerprint,
            ..Extent::of(body)
        };
    }
    Extent {
        fingerprint,
        origin: core.origin(),
        radius: core.radius(),
        is_unscaled: true,
    }
}

/// Largest accepted tilt of a facet against the plane perpendicular to the normal.
struct Bearing {
    /// Sine of the largest angle.
    sine: f64,
    /// The feature that carried the contact before: its angle may be larger by a factor `STAY`.
    previous: Option<Feature>,
}

impl Bearing {
    fn accepts(&self, feature: Feature, sine: f64) -> bool {
        let stay = if self.previous == Some(feature) { STAY } else { 1.0 };
        sine.abs() <= stay * self.sine
    }

    /// Returns the facet of a core that carries a contact with an outward normal.
    fn facet<'a>(&self, core: &'a Core, n: &Vector3<f64>) -> Facet<'a> {
        match core {
            Core::Polyhedron(body) => Facet::Body(body),
            Core::Cylinder(core) => self.of_cylinder(core, n),
            Core::Cone(core) => self.of_cone(core, n),
            Core::Ellipsoid(_) => Facet::Point,
        }
    }

    fn of_cylinder(&self, core: &Cylinder, n: &Vector3<f64>) -> Facet<'static> {
        let (r, h) = (core.radius(), core.half_height());
        let flat = sqrt(n.x * n.x + n.y * n.y);
        let lower = u32::from(n.z < 0.0);
        let (face, side) = (Feature::Face(FaceId(lower)), Feature::Face(FaceId(2)));
        let [upper_rim, lower_rim] = [0, 1].each(|k| Feature::Edge(EdgeId(k)));
        if self.accepts(face, flat) {
            let is_lower = lower == 1;
            return Facet::Round(RoundFace {
                z: if is_lower { -h } else { h },
                radius: r,
                face,
                rim: if is_lower { lower_rim } else { upper_rim },
                first: 8 * lower,
            });
        }
        if !self.accepts(side, n.z) {
            return Facet::Point;
        }
        let out = Vector3::new(n.x, n.y, 0.0) * (r / flat);
        Facet::Straight {
            ends: [out + Vector3::z() * h, out - Vector3::z() * h],
            radii: [r; 2],
            names: [upper_rim, lower_rim],
            side,
        }
    }

    fn of_cone(&self, core: &Cone, n: &Vector3<f64>) -> Facet<'static> {
        let (r, h, height) = (core.radius(), core.half_height(), 2.0 * core.half_height());
        let flat = sqrt(n.x * n.x + n.y * n.y);
        let [face, side] = [0, 1].each(|k| Feature::Face(FaceId(k)));
        let rim = Feature::Edge(EdgeId(0));
        if n.z < 0.0 && self.accepts(face, flat) {
            return Facet::Round(RoundFace {
                z: -h,
                radius: r,
                face,
                rim,
                first: 1,
            });
        }
        // The normal of the side is (height, r) over the slant.
        let slant = sqrt(r * r + height * height);
        let is_outward = flat * height + n.z * r > 0.0;
        if !(is_outward && self.accepts(side, (flat * r - n.z * height) / slant) && flat > 0.0) {
            return Facet::Point;
        }
        let end = Vector3::new(n.x * (r / flat), n.y * (r / flat), -h);
        Facet::Straight {
            ends: [Vector3::z() * h, end],
            radii: [0.0, r],
            names: [Feature::Vertex(VertexId(0)), rim],
            side,
        }
    }
}
