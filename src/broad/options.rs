//! Options of a body and settings of a structure.

use super::BroadPhaseError;
use nalgebra::Point3;

/// Groups of a body: two bodies pair if each is a member of a group that the partner pairs with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Groups {
    /// Groups the body belongs to, one bit each.
    pub member_of: u32,
    /// Groups the body pairs with, one bit each.
    pub pairs_with: u32,
}

impl Groups {
    /// Member of every group, pairing with every group.
    pub const ALL: Self = Self {
        member_of: u32::MAX,
        pairs_with: u32::MAX,
    };

    /// Returns whether two bodies of these groups may pair.
    #[must_use]
    pub fn meet(self, other: Self) -> bool {
        self.member_of & other.pairs_with != 0 && other.member_of & self.pairs_with != 0
    }
}

/// Options of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BodyOptions {
    /// Groups for pairing.
    pub groups: Groups,
    /// Two fixed bodies never pair. A fixed body may be moved, at some cost in the steps in which
    /// the body moves.
    pub fixed: bool,
    /// How far a renewed stored box reaches beyond the given box; the stored box is renewed when
    /// the given box leaves the stored box. 0 keeps the stored box tight. A margin saves work if
    /// few bodies move or all move slowly, and costs pairs.
    pub margin: f64,
    /// Number of steps of the body's last motion by which the renewed box also reaches ahead.
    pub lookahead: f64,
}

impl BodyOptions {
    /// Returns a body that moves, with a tight box, pairing with everything.
    #[must_use]
    pub fn moving() -> Self {
        Self {
            groups: Groups::ALL,
            fixed: false,
            margin: 0.0,
            lookahead: 0.0,
        }
    }

    /// Returns a body at rest, pairing with everything that moves.
    #[must_use]
    pub fn fixed() -> Self {
        Self {
            fixed: true,
            ..Self::moving()
        }
    }

    /// Returns the body with other groups.
    #[must_use]
    pub fn groups(self, groups: Groups) -> Self {
        Self { groups, ..self }
    }

    /// Returns the body with this margin.
    #[must_use]
    pub fn margin(self, margin: f64) -> Self {
        Self { margin, ..self }
    }

    /// Returns the body with this lookahead, in steps.
    #[must_use]
    pub fn lookahead(self, steps: f64) -> Self {
        Self {
            lookahead: steps,
            ..self
        }
    }

    pub(super) fn check(&self) -> Result<(), BroadPhaseError> {
        let sound = |v: f64| (0.0..f64::from(f32::MAX)).contains(&v);
        if sound(self.margin) && sound(self.lookahead) {
            Ok(())
        } else {
            Err(BroadPhaseError::Margin)
        }
    }
}

/// Settings of a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Settings {
    /// Stored boxes are relative to this point and most precise near the point. An origin that is
    /// not finite is refused with the first body.
    pub origin: Point3<f64>,
    /// With feature `parallel`: the number of bodies from which on threads are used, each for no
    /// less than a sixteenth as many bodies or changes. A [scene](crate::scene) uses threads in the
    /// narrow phase if a step makes at least a thirty-second as many queries (625 by default),
    /// however few the bodies are. The result does not depend on this number.
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

    /// Returns the settings with threads from this number of bodies on.
    #[must_use]
    pub fn parallel_from(self, bodies: usize) -> Self {
        Self {
            parallel_from: bodies,
            ..self
        }
    }
}
