//! The supporting planes of a body of any kind: half-spaces that are proven to contain it.

use nalgebra::{Point3, Vector3};

use super::CoverError;
use crate::base::num::extremes::Extremes;
use crate::base::pose::RelativePose;
use crate::base::tolerance::UNIT_LENGTH;
use crate::body::polyhedron::build::cloud::{exponent_of, power_of_two};
use crate::convex::contact::HalfSpace;
use crate::pair::options::QueryOptions;
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};

/// Coordinates of a unit normal below this are zero, so that products with them are exact.
const LEAST: f64 = f64::from_bits((1023 - 200) << 52);

/// A body as its supporting planes.
pub(super) struct Supports<'a> {
    pub(super) geometry: GeometryRef<'a>,
    pub(super) kind: GeometryKind,
    /// The box of the body.
    pub(super) low: Point3<f64>,
    pub(super) high: Point3<f64>,
    /// A power of two, about half the longest side of the box; one if the body is a single point.
    pub(super) unit: f64,
}

/// A half-space that contains a body, and a point of the body near its plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Support {
    pub(super) space: HalfSpace,
    pub(super) point: Point3<f64>,
}

impl<'a> Supports<'a> {
    pub(super) fn new(geometry: GeometryRef<'a>) -> Result<Self, CoverError> {
        let (kind, (low, high)) = (geometry.kind(), geometry.outer_box());
        let half = (high - low).amax() * 0.5;
        if kind == GeometryKind::HalfSpace || !half.is_finite() {
            return Err(CoverError::Unbounded { kind });
        }
        let unit = if half > 0.0 {
            power_of_two(exponent_of(half))
        } else {
            1.0
        };
        Ok(Self {
            geometry,
            kind,
            low,
            high,
            unit,
        })
    }

    /// Returns whether the body is known to be convex.
    pub(super) fn is_convex(&self) -> bool {
        self.geometry.polyhedron().is_some() || self.geometry.shape().is_some()
    }

    /// Returns the largest coordinate of the box.
    pub(super) fn reach(&self) -> f64 {
        self.low.coords.amax().larger(self.high.coords.amax())
    }

    /// Returns the half-space along a direction whose plane touches the body up to rounding.
    ///
    /// The signed distance of the body from the opposite half-space through the origin has a lower
    /// bound `b`: no point of the body is higher along the direction than `-b`. `None` if the
    /// direction is zero or not finite.
    pub(super) fn along(&self, direction: &Vector3<f64>) -> Option<Support> {
        let size = direction.amax();
        let direction = (direction / size).map(|x| if x.abs() < LEAST { 0.0 } else { x });
        let opposite = HalfSpace::new(-direction, 0.0).ok()?;
        let pair = GeometryRef::half_space_pair([GeometryRef::from(&opposite), self.geometry])?;
        let found = pair.closest_with(&RelativePose::identity(), &QueryOptions::default());
        let height = -found.outcome.lower;
        if !height.is_finite() {
            return None;
        }
        // The plane is that of the stored normal, whose length is one within `UNIT_LENGTH`.
        let offset = (height + UNIT_LENGTH * height.abs()).next_up();
        Some(Support {
            space: HalfSpace::at(&-opposite.normal().into_inner(), offset),
            point: found.outcome.point_on_b,
        })
    }
}
