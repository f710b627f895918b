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
use crate::nonconvex::query::near::{NearRoom, NearTriangle};
use crate::nonconvex::query::triangle;
use crate::nonconvex::simple_surface::SimpleSurface;
use crate::pair::draft::unit;
use crate::pair::outcome::ContactState;
use crate::pair::point::PointOutcome;

/// A distance this many times wider than its bounds gives the normal; a shorter one leaves it to
/// the triangle. Not measured.
const CLEAR_DIRECTION: f64 = 8.0;

impl Mesh {
    /// Returns the closest point and the signed distance of a point in the caller's coordinates.
    pub(crate) fn outcome_of(
        &self,
        point: &Point3<f64>,
        surface: Option<&SimpleSurface>,
        room: &mut MeshRoom,
    ) -> PointOutcome {
        let (p, is_far) = self.stored_point(point);
        let near = self.nearest_triangle(&p, -1.0, &mut room.near);
        let known = room.known.filter(|known| known.holds_at(self, &p));
        let state = match known {
            _ if is_far => ContactState::Separated,
            Some(known) => known.state,
            None => self.side_of_near(&p, surface, &room.near),
        };
        room.known = Some(KnownSide {
            mesh: self.fingerprint,
            at: p,
            free: near.lower,
            state,
        });
        self.outcome_at(point, &near, (&p, is_far), state)
    }

    /// Returns the outcome with the closest point on a triangle.
    ///
    /// `p` is the point in stored coordinates, with whether it was moved.
    fn outcome_at(
        &self,
        point: &Point3<f64>,
        near: &NearTriangle,
        (p, is_far): (&Vector3<f64>, bool),
        state: ContactState,
    ) -> PointOutcome {
        let corners = self.corners(near.item);
        let (square, foot, spot) = triangle::nearest_point(p, &corners);
        let (mut lower, mut upper) = (near.lower, near.upper);
        let mut distance = sqrt(square).clamped(lower, upper);
        let mut to_point = p - foot;
        if is_far {
            to_point = point.coords / self.unit() - foot;
            let size = to_point.amax();
            distance = size * sqrt((to_point / size).norm_squared());
            (lower, upper) = (distance * (1.0 - POINT_HEIGHT), distance * (1.0 + POINT_HEIGHT));
        }
        if state == ContactState::Touching {
            (lower, distance, upper) = (0.0, 0.0, 0.0);
        }
        let way = if state == ContactState::Overlapping { -1.0 } else { 1.0 };
        let own = triangle::normal(&corners);
        let is_clear = distance > CLEAR_DIRECTION * (upper - lower) && lower > 0.0;
        let normal = if is_clear { to_point * way } else { own };
        let scaled = |x: f64| x * self.unit();
        // Beyond the range of normal numbers the product is rounded.
        let outward = |x: f64, next: fn(f64) -> f64| {
            if self.exponent == 0 || x == 0.0 {
                x
            } else {
                next(scaled(x))
            }
        };
        let (lower, upper) = (
            outward(lower, f64::next_down).at_least(0.0),
            outward(upper, f64::next_up),
        );
        let distance = scaled(distance);
        let (distance, lower, upper) = match state {
            ContactState::Overlapping => (-distance, -upper, -lower),
            _ => (distance, lower, upper),
        };
        PointOutcome {
            state,
            distance,
            lower,
            upper,
            point: self.given(&foot),
            normal: unit(&normal),
            location: tracker::spot(self, near.item, spot),
        }
    }

    /// Returns whether a triangle, with bounds of its distance, contains a point.
    fn is_on(&self, p: &Vector3<f64>, t: &NearTriangle) -> bool {
        let corners = self.corners(t.item);
        t.lower == 0.0 && p.height(&corners) == 0 && p.is_on(&corners)
    }

    /// Returns whether the solid contains a point in the caller's coordinates, or the surface of an
    /// open mesh does.
    pub(crate) fn contains_point(&self, point: &Point3<f64>) -> bool {
        let (p, is_far) = self.stored_point(point);
        // Without a winding number the point is on the surface.
        !is_far
            && self
                .winding_about(&p, |_| true)
                .is_none_or(|w| self.is_solid() && w != 0)
    }

    /// Returns a point in stored coordinates, and whether it was moved towards the mesh.
    ///
    /// A point beyond 2^60 sizes is moved along its line to the mesh. The closest point stays the
    /// same up to rounding.
    pub(crate) fn stored_point(&self, point: &Point3<f64>) -> (Vector3<f64>, bool) {
        let p = point.coords / self.unit();
        let apart = p - self.tree.centre;
        let (size, far) = (apart.amax(), FAR_POINT * self.tree.unit() * f64::from(self.tree.reach));
        if size > far {
            return (self.tree.centre + apart * (far / size), true);
        }
        (self.flushed(&p), false)
    }

    /// Returns the side of a point whose closest triangles are in the room.
    fn side_of_near(&self, p: &Vector3<f64>, surface: Option<&SimpleSurface>, room: &NearRoom) -> ContactState {
        if room.found.iter().any(|t| self.is_on(p, t)) {
            return ContactState::Touching;
        }
        let is_out = |k: usize| p[k] < self.low[k] || p[k] > self.high[k];
        if !self.is_solid() || (0..3).any(is_out) {
            return ContactState::Separated;
        }
        let voted = surface.and_then(|surface| surface.winding_by_vote(self, p, &room.found));
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
        let (p, is_far) = self.stored_point(point);
        let near = self.near_triangle(&p, item);
        let is_on = !is_far && self.is_on(&p, &near);
        let state = if is_on {
            ContactState::Touching
        } else {
            ContactState::Separated
        };
        self.outcome_at(point, &near, (&p, is_far), state)
    }
}

/// Room of queries of points and meshes, reused from point to point.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshRoom {
    pub(crate) near: NearRoom,
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
