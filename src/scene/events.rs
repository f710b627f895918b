//! What a step changed, as a list.

use super::BodyId;
use crate::broad::PairId;

/// What happened to a pair.
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
    /// The bodies are no longer within it.
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

/// One change of one pair. A change is told where its effect is called for; a pair that ends because a body is removed or because
/// its groups no longer call for anything ends its overlap as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Event {
    /// The body with the lower index.
    pub a: BodyId,
    /// The body with the higher index.
    pub b: BodyId,
    /// The pair's name while its boxes overlap.
    pub pair: PairId,
    /// What happened.
    pub change: Change,
}

/// A change before it has its names.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairChange {
    pub(super) id: PairId,
    pub(super) pair: (u32, u32),
    pub(super) change: Change,
}
