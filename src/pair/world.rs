//! Outcomes in the common frame of both poses, and as text.

use core::fmt;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::pose::RelativePose;
use crate::pair::outcome::{Distance, Outcome, Solver};

/// Witness points and normal of an [`Outcome`] in the common frame of the two poses (the world).
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
///
/// let cube = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let pose_a = Isometry3::translation(5.0, 0.0, 0.0);
/// let pose_b = Isometry3::translation(8.0, 0.0, 0.0);
/// let poses = RelativePose::new(&pose_a, &pose_b)?;
/// let world = Tracker::new().closest(&cube, &cube, &poses).in_world(&poses);
/// assert_eq!((world.point_on_a.x, world.point_on_b.x), (6.0, 7.0));
/// assert_eq!(world.normal.x, 1.0);
/// assert_eq!(world.swapped().normal.x, -1.0); // as seen from B
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WorldWitnesses {
    /// Witness point on A.
    pub point_on_a: Point3<f64>,
    /// Witness point on B.
    pub point_on_b: Point3<f64>,
    /// Unit vector from A to B.
    pub normal: Unit<Vector3<f64>>,
}

impl WorldWitnesses {
    /// Returns the witnesses with A and B exchanged, for a caller whose own body is B.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self {
            point_on_a: self.point_on_b,
            point_on_b: self.point_on_a,
            normal: Unit::new_unchecked(-self.normal.into_inner()),
        }
    }
}

impl Outcome {
    /// Returns the witness points and the normal in the frame of the two poses that
    /// [`RelativePose::new`] was given. Points in the world carry the rounding of the world's
    /// coordinates; distance and bounds do not.
    #[inline]
    #[must_use]
    pub fn in_world(&self, poses: &RelativePose) -> WorldWitnesses {
        let (a, b) = poses.poses();
        WorldWitnesses {
            point_on_a: a * self.point_on_a,
            point_on_b: b * self.point_on_b,
            normal: a * self.normal,
        }
    }
}

/// Class, distance and bounds: `separated, 1.5 in [1.4999999999999993, 1.5000000000000007]`.
impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} in [{}, {}]", self.class, self.value, self.lower, self.upper)
    }
}

/// Class, distance, bounds, features and solver on one line.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, features {}, by {}",
            Distance::from(self),
            self.features,
            self.solver
        )
    }
}

/// Query counts by solver as text: `answered by walk 12, exact 3`; solvers without a query are left
/// out.
pub(crate) struct AnsweredBy<'a>(pub(crate) &'a [u64; Solver::COUNT]);

impl fmt::Display for AnsweredBy<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("answered by")?;
        let counted = Solver::ALL.iter().zip(self.0).filter(|(_, count)| **count > 0);
        for (k, (solver, count)) in counted.enumerate() {
            write!(f, "{} {solver} {count}", if k > 0 { "," } else { "" })?;
        }
        Ok(())
    }
}
