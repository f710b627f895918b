//! Options of a body, and settings of a broad phase.

use super::BroadPhaseError;
use nalgebra::Point3;

/// Groups of a body. Two bodies are paired if each is a member of a group that the other pairs
/// with. If both are fixed, each must also be a member of a group in the `fixed_with` of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Groups {
    /// Groups that the body belongs to, one bit each.
    pub member_of: u32,
    /// Groups that the body pairs with, one bit each.
    pub pairs_with: u32,
    /// Groups whose fixed bodies the body pairs with if it is fixed itself, one bit each.
    #[cfg_attr(feature = "serde", serde(default))]
    pub fixed_with: u32,
}

impl Groups {
    /// Member of every group; pairs with every group. Two fixed bodies are not paired.
    pub const ALL: Self = Self {
        member_of: u32::MAX,
        pairs_with: u32::MAX,
        fixed_with: 0,
    };

    /// Returns whether two bodies of these groups may be paired.
    #[must_use]
    pub fn meet(self, other: Self) -> bool {
        self.member_of & other.pairs_with != 0 && other.member_of & self.pairs_with != 0
    }

    /// Returns whether two fixed bodies of these groups may be paired.
    #[must_use]
    pub fn meet_fixed(self, other: Self) -> bool {
        self.meet(other) && self.member_of & other.fixed_with != 0 && other.member_of & self.fixed_with != 0
    }
}

/// Options of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BodyOptions {
    /// Groups that decide which bodies are paired.
    pub groups: Groups,
    /// Whether the body is fixed. Two fixed bodies are paired only if [`Groups::fixed_with`] says
    /// so. A fixed body may be moved, but a step in which it moves costs more.
    pub fixed: bool,
    /// Growth of the stored box beyond the given box. A new stored box is computed when the given
    /// box leaves it; 0 keeps the stored box tight. Growth saves work if few bodies move or all
    /// move slowly, but gives more pairs.
    #[cfg_attr(feature = "serde", serde(rename = "margin"))]
    pub growth: f64,
    /// Number of steps of the body's last motion by which a new stored box also extends in the
    /// direction of motion.
    pub lookahead: f64,
}

impl Default for BodyOptions {
    /// A body that moves, with a tight box, and pairs with everything.
    fn default() -> Self {
        Self {
            groups: Groups::ALL,
            fixed: false,
            growth: 0.0,
            lookahead: 0.0,
        }
    }
}

impl BodyOptions {
    /// Returns the body as one that is fixed, or as one that moves.
    ///
    /// Two fixed bodies are paired only by [`Groups::fixed_with`].
    #[must_use]
    pub fn fixed(self, fixed: bool) -> Self {
        Self { fixed, ..self }
    }

    /// Returns the body with other groups.
    #[must_use]
    pub fn groups(self, groups: Groups) -> Self {
        Self { groups, ..self }
    }

    /// Returns the body with this growth of its stored box.
    #[must_use]
    pub fn growth(self, growth: f64) -> Self {
        Self { growth, ..self }
    }

    /// Returns the body with this look-ahead, in steps.
    #[must_use]
    pub fn lookahead(self, steps: f64) -> Self {
        Self {
            lookahead: steps,
            ..self
        }
    }

    pub(super) fn check(&self) -> Result<(), BroadPhaseError> {
        let sound = |v: f64| (0.0..f64::from(f32::MAX)).contains(&v);
        for (what, value) in [("growth", self.growth), ("lookahead", self.lookahead)] {
            if !sound(value) {
                return Err(BroadPhaseError::Growth { what, value });
            }
        }
        Ok(())
    }
}

/// Settings of a broad phase.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Settings {
    /// Stored boxes are relative to this point, and most precise near it. If it is not finite, the
    /// insertion of the first body returns an error.
    pub origin: Point3<f64>,
    /// The number of bodies from which threads are used (feature `parallel`). Each thread gets at
    /// least a sixteenth of this number of bodies or changes. A [scene](crate::scene) uses threads
    /// in the narrow phase if a step makes at least a thirty-second of this number of queries (625
    /// by default), for any number of bodies. The result does not depend on this number.
    pub parallel_from: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            origin: Point3::origin(),
            parallel_from: 20_000,
        }
    }
}

impl Settings {
    /// Returns the settings with another origin.
    #[must_use]
    pub fn origin(self, origin: Point3<f64>) -> Self {
        Self { origin, ..self }
    }

    /// Returns the settings with threads from this number of bodies.
    #[must_use]
    pub fn parallel_from(self, bodies: usize) -> Self {
        Self {
            parallel_from: bodies,
            ..self
        }
    }
}
