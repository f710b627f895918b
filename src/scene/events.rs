//! List of the changes of a step.

use super::BodyId;
use crate::broad::PairId;
use crate::time::impact::Impact;

/// A change of the state of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Change {
    /// The boxes, grown by the distances called for, began to overlap.
    BoxesMet,
    /// The bodies began to share a point.
    OverlapBegan,
    /// The bodies came within the distance called for.
    CameWithin,
    /// The bodies are no longer within the distance called for.
    LeftWithin,
    /// The bodies ceased to share a point.
    OverlapEnded,
    /// The boxes ceased to overlap.
    BoxesParted,
}

impl core::fmt::Display for Change {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::BoxesMet => "boxes met",
            Self::OverlapBegan => "overlap began",
            Self::CameWithin => "came within",
            Self::LeftWithin => "left within",
            Self::OverlapEnded => "overlap ended",
            Self::BoxesParted => "boxes parted",
        })
    }
}

/// A change of one pair. A change is sent if its effect is called for; a pair that ends because a
/// body is removed, or because the groups no longer call for any effect, ends its overlap as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Event {
    /// The body with the lower index.
    pub a: BodyId,
    /// The body with the higher index.
    pub b: BodyId,
    /// Id of the pair while the boxes overlap.
    pub pair: PairId,
    /// The change of the pair.
    pub change: Change,
}

/// When two bodies first met in the last tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairImpact {
    /// The body with the lower index: operand A of the impact.
    pub a: BodyId,
    /// The body with the higher index: operand B of the impact.
    pub b: BodyId,
    /// Id of the pair while the boxes overlap.
    pub pair: PairId,
    /// The bracket, in time after the begin of the tick: [`Impact::Hit`], or [`Impact::Near`] and
    /// [`Impact::Unknown`] if the bodies are not proven to meet, nor to stay apart. The frames are
    /// those of the bodies.
    pub impact: Impact,
}

impl PairImpact {
    /// Returns the time after the begin of the tick up to which the bodies are proven apart.
    #[must_use]
    pub fn safe(&self) -> f64 {
        match self.impact {
            Impact::Hit { safe, .. } | Impact::Near { safe, .. } | Impact::Unknown { safe } => safe,
            _ => 0.0,
        }
    }
}

/// A change before the ids are known.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairChange {
    pub(super) id: PairId,
    pub(super) pair: (u32, u32),
    pub(super) change: Change,
}
