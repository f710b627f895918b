//! The outcome of a query of two meshes.

use nalgebra::{Point3, Unit, Vector3};

use crate::pair::outcome::{Class, Distance};
use crate::pose::RelativePose;

/// A feature of a mesh by the caller's indices of its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MeshFeature {
    /// A vertex.
    Vertex(u32),
    /// The edge between two vertices, in the sense of the triangle.
    Edge([u32; 2]),
    /// The inside of the triangle.
    Face,
}

/// A triangle by the caller's index, and the feature that holds a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshSpot {
    /// The triangle.
    pub triangle: u32,
    /// Its feature.
    pub feature: MeshFeature,
}

impl core::fmt::Display for MeshSpot {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.feature {
            MeshFeature::Vertex(v) => write!(f, "v{v} of t{}", self.triangle),
            MeshFeature::Edge([a, b]) => write!(f, "e{a}-{b} of t{}", self.triangle),
            MeshFeature::Face => write!(f, "t{}", self.triangle),
        }
    }
}

/// The closest points of two bodies, with proof.
///
/// The distance is the distance of the bodies as sets of points: zero if they share a point. A
/// solid holds its inside, so a body within a solid is at distance zero. No depth is returned here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MeshOutcome {
    /// The side of contact. Surfaces have no inside, so a pair with one is never
    /// [`Class::Overlapping`]; [`Class::Undecided`] if no segment from a vertex to the outside
    /// avoids all edges of the other mesh. Within `1e-13 L` of contact the class may differ between
    /// warm and cold trackers, and between A to B and B to A.
    ///
    /// Solids whose surfaces touch and do not certainly cross overlap if an inner point of both is
    /// found: by up to 128 of the pairs of triangles in contact, by 32 triangles from all over each
    /// mesh, and by points of each connected part. If all of these miss an overlap, the class is
    /// [`Class::Touching`]; the bounds, both zero, hold all the same.
    pub class: Class,
    /// The distance, between the bounds; zero for bodies that share a point.
    pub distance: f64,
    /// Lower bound of the distance.
    pub lower: f64,
    /// Upper bound of the distance.
    pub upper: f64,
    /// The triangle and the feature of A that hold the witness.
    pub on_a: MeshSpot,
    /// The triangle and the feature of B that hold the witness.
    pub on_b: MeshSpot,
    /// The witness on A, in A's frame; both are as far apart as `upper` tells, up to rounding of
    /// their places, `1e-12 L`. If one body is inside the other: a vertex of the inner one.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame, along which the closest triangles are proven
    /// apart.
    pub normal: Unit<Vector3<f64>>,
}

impl MeshOutcome {
    /// The outcome of B and A as that of A and B.
    pub(super) fn swapped(self, a_from_b: &RelativePose) -> Self {
        Self {
            on_a: self.on_b,
            on_b: self.on_a,
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            normal: Unit::new_unchecked(-(a_from_b.rotation() * *self.normal)),
            ..self
        }
    }
}

impl From<&MeshOutcome> for Distance {
    fn from(outcome: &MeshOutcome) -> Self {
        Self {
            class: outcome.class,
            value: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
        }
    }
}
