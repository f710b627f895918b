//! A point and a mesh: distance, side and closest point.
//!
//! The distance comes from the search of [`near`](crate::nonconvex::query::near). The side of a
//! point that is not on the surface comes from its winding number, or costs nothing:
//!
//! - A point outside the bounding box is outside.
//! - The triangles that may be closest vote, if the surface is proven simple ([`SimpleSurface`]).
//!   If the point is above the planes of some and below none, it is on the front side of them all.
//!   Signs are exact.
//!
//! Why the vote is a proof: let c be a closest point, u the vector from c to the point, and N the
//! sum of the normals of the triangles at c, weighted by their angles. The sign of `u . N` decides
//! the side, and is not zero (Baerentzen and Aanaes 2005). All triangles at c may be closest, so
//! all of them vote. If no `u . n` is negative, neither is `u . N`.

use nalgebra::{Point3, Vector3};

use crate::base::num::extremes::Bounded;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{FAR_POINT, POINT_HEIGHT, ROUND_UP};
use crate::nonconvex::mesh::{Mesh, tracker};
use crate::nonconvex::near_parts::NearItems;
use crate::nonconvex::query::inside::ExactSigns;
use crate::nonconvex::query::near::{self, NearMemory, NearTriangle};
use crate::nonconvex::query::triangle::{self, Triangle, TriangleSpot};
use crate::nonconvex::simple_surface::SimpleSurface;
use crate::pair::draft::unit;
use crate::pair::location::WitnessLocation;
use crate::pair::outcome::ContactState;
use crate::pair::point::PointOutcome;
use crate::pair::transform::StoredFrame;

/// A distance this many times wider than its bounds gives the normal; a shorter one leaves it to
/// the triangle.
const CLEAR_DIRECTION: f64 = 8.0;

impl Mesh {
    /// Returns the closest point and the signed distance of a point in the caller's coordinates.
    pub(crate) fn outcome_of(
        &self,
        point: &Point3<f64>,
        surface: Option<&SimpleSurface>,
        memory: &mut MeshMemory,
    ) -> PointOutcome {
        let stored = self.stored_point(point);
        let p = &stored.place;
        let near = self.nearest_triangle(p, -1.0, &mut memory.near);
        let near = self.refined(p, near, &memory.near.found);
        let known = memory.known.filter(|known| known.holds_at(self, p));
        let state = match known {
            _ if stored.is_far => ContactState::Separated,
            Some(known) => known.state,
            None => self.side_of_near(p, surface, &memory.near),
        };
        memory.known = Some(KnownSide {
            mesh: self.fingerprint,
            at: *p,
            free: near.lower,
            state,
        });
        self.outcome_at(&stored, &near, state)
    }

    /// Returns the work of a query: leaves that the search visits, and triangles that the ray of
    /// the winding number tests.
    #[cfg(feature = "__internals")]
    pub(crate) fn work_of_point(&self, point: &Point3<f64>) -> [usize; 2] {
        let stored = self.stored_point(point);
        let mut memory = NearMemory::default();
        self.nearest_triangle(&stored.place, -1.0, &mut memory);
        let mut crossings = 0;
        self.winding_about(&stored.place, |_| {
            crossings += 1;
            true
        });
        [memory.leaves, crossings]
    }

    /// Returns the closest triangle with the narrowest bounds: see [`near::refined`].
    fn refined(&self, p: &Vector3<f64>, best: NearTriangle, found: &[NearTriangle]) -> NearTriangle {
        let size = self.tree.unit() * f64::from(self.tree.reach);
        near::refined(p, size, best, found, |t| self.corners(t))
    }

    /// Returns the outcome with the closest point on a triangle.
    fn outcome_at(&self, stored: &StoredPoint, near: &NearTriangle, state: ContactState) -> PointOutcome {
        let located = |feature| tracker::spot(self, near.item, feature);
        let is_inward = || self.is_solid() && self.may_face_inward() && self.is_inward(near.item) == Some(true);
        stored.outcome(near, &self.corners(near.item), state, is_inward, located)
    }

    /// Returns whether the solid contains a point in the caller's coordinates, or the surface of an
    /// open mesh does.
    pub(crate) fn contains_point(&self, point: &Point3<f64>) -> bool {
        // Without a winding number the point is on the surface.
        self.winding_number(point).is_none_or(|w| self.is_solid() && w != 0)
    }

    /// Returns the winding number of a point in the caller's coordinates, which only a solid has,
    /// or `None` if the point is on the surface.
    pub(crate) fn winding_number(&self, point: &Point3<f64>) -> Option<i32> {
        let stored = self.stored_point(point);
        if stored.is_far {
            return Some(0);
        }
        self.winding_about(&stored.place, |_| true)
    }

    /// Returns a point in stored coordinates.
    fn stored_point(&self, point: &Point3<f64>) -> StoredPoint {
        let size = self.tree.unit() * f64::from(self.tree.reach);
        let mut stored = StoredPoint::new(point, self.frame, &self.tree.centre, size);
        if !stored.is_far {
            stored.place = self.flushed(&stored.place);
        }
        stored
    }

    /// Returns the side of a point whose closest triangles are in the memory.
    fn side_of_near(&self, p: &Vector3<f64>, surface: Option<&SimpleSurface>, memory: &NearMemory) -> ContactState {
        if memory.found.iter().any(|t| t.contains(p, &self.corners(t.item))) {
            return ContactState::Touching;
        }
        let is_out = |k: usize| p[k] < self.low[k] || p[k] > self.high[k];
        if !self.is_solid() || (0..3).any(is_out) {
            return ContactState::Separated;
        }
        let voted = surface.and_then(|surface| surface.winding_by_vote(self, p, &memory.found));
        match voted.or_else(|| self.winding_about(p, |_| true)) {
            Some(0) => ContactState::Separated,
            Some(_) => ContactState::Overlapping,
            // Not reached: a triangle that contains the point is among those found.
            None => ContactState::Touching,
        }
    }
}

impl NearItems for Mesh {
    /// Returns the outcome of a triangle alone, which has no inside.
    fn outcome_of_item(&self, item: u32, point: &Point3<f64>) -> PointOutcome {
        let stored = self.stored_point(point);
        let near = self.near_triangle(&stored.place, item);
        let near = self.refined(&stored.place, near, &[near]);
        let state = stored.state_beside([near].iter(), |t| self.corners(t));
        self.outcome_at(&stored, &near, state)
    }
}

impl NearTriangle {
    /// Returns whether the triangle contains a point.
    fn contains(&self, p: &Vector3<f64>, corners: &Triangle) -> bool {
        self.lower == 0.0 && p.height(corners) == 0 && p.is_on(corners)
    }
}

/// A point in stored coordinates of a body.
pub(super) struct StoredPoint {
    /// In the caller's coordinates.
    given: Point3<f64>,
    pub(super) place: Vector3<f64>,
    /// Whether the place was moved towards the body.
    is_far: bool,
    /// The frame of stored coordinates, and one stored unit in the caller's unit.
    frame: StoredFrame,
    unit: f64,
}

impl StoredPoint {
    /// Returns a point, with the body's centre and radius in stored coordinates.
    ///
    /// A point beyond 2^60 sizes is moved along its line to the body. The closest point stays the
    /// same up to rounding.
    pub(super) fn new(given: &Point3<f64>, frame: StoredFrame, centre: &Vector3<f64>, size: f64) -> Self {
        let place = frame.stored(given);
        let apart = place - centre;
        let (length, far) = (apart.amax(), FAR_POINT * size);
        let is_far = length > far;
        Self {
            given: *given,
            place: if is_far { centre + apart * (far / length) } else { place },
            is_far,
            unit: frame.unit(),
            frame,
        }
    }

    /// Replaces coordinates below a bound by zero.
    pub(super) fn flush(&mut self, below: f64) {
        if !self.is_far {
            self.place.apply(|x| {
                if x.abs() < below {
                    *x = 0.0;
                }
            });
        }
    }

    /// Returns whether a surface of triangles, of which some may be closest, contains the point.
    pub(super) fn state_beside<'a>(
        &self,
        mut found: impl Iterator<Item = &'a NearTriangle>,
        corners: impl Fn(u32) -> Triangle,
    ) -> ContactState {
        if !self.is_far && found.any(|t| t.contains(&self.place, &corners(t.item))) {
            ContactState::Touching
        } else {
            ContactState::Separated
        }
    }

    /// Returns the outcome with the closest point on a triangle, and whether it faces inward.
    pub(super) fn outcome(
        &self,
        near: &NearTriangle,
        corners: &Triangle,
        state: ContactState,
        is_inward: impl FnOnce() -> bool,
        located: impl FnOnce(TriangleSpot) -> WitnessLocation,
    ) -> PointOutcome {
        let (square, foot, spot) = triangle::nearest_point(&self.place, corners);
        let (mut lower, mut upper) = (near.lower, near.upper);
        let mut distance = sqrt(square).clamped(lower, upper);
        let mut to_point = self.place - foot;
        if self.is_far {
            to_point = self.frame.stored(&self.given) - foot;
            let size = to_point.amax();
            distance = size * sqrt((to_point / size).norm_squared());
            (lower, upper) = (distance * (1.0 - POINT_HEIGHT), distance * (1.0 + POINT_HEIGHT));
        }
        if state == ContactState::Touching {
            (lower, distance, upper) = (0.0, 0.0, 0.0);
        }
        let way = if state == ContactState::Overlapping { -1.0 } else { 1.0 };
        let own = triangle::normal(corners);
        let is_clear = distance > CLEAR_DIRECTION * (upper - lower) && lower > 0.0;
        let normal = if is_clear {
            to_point * way
        } else if is_inward() {
            -own
        } else {
            own
        };
        // Beyond the range of normal numbers the product is rounded.
        let outward = |x: f64, next: fn(f64) -> f64| {
            if self.unit == 1.0 || x == 0.0 {
                x
            } else {
                next(x * self.unit)
            }
        };
        let (lower, upper) = (
            outward(lower, f64::next_down).at_least(0.0),
            outward(upper, f64::next_up),
        );
        let distance = distance * self.unit;
        let (distance, lower, upper) = match state {
            ContactState::Overlapping => (-distance, -upper, -lower),
            _ => (distance, lower, upper),
        };
        PointOutcome {
            state,
            distance,
            lower,
            upper,
            point: self.frame.given(&foot),
            normal: unit(&normal),
            location: located(spot),
        }
    }
}

/// Room of queries of points and meshes, reused from point to point.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshMemory {
    pub(crate) near: NearMemory,
    known: Option<KnownSide>,
}

/// The side of a point, which holds in a ball that the surface does not reach.
#[derive(Clone, Copy, Debug)]
struct KnownSide {
    mesh: Fingerprint,
    at: Vector3<f64>,
    free: f64,
    state: ContactState,
}

impl KnownSide {
    /// Returns whether a point is certainly on the same side.
    fn holds_at(&self, mesh: &Mesh, p: &Vector3<f64>) -> bool {
        let moved = sqrt((p - self.at).norm_squared()) * ROUND_UP;
        self.mesh == mesh.fingerprint && moved < self.free
    }
}
