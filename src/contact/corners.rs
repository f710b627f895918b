//! Contact candidates: vertices of the overlap of two projected features.

/// Most candidates: for two features of 24 vertices, with some doubled by rounding.
const MOST: usize = 64;

/// Part of a projected feature that contains a point: a vertex, an edge, or the interior.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Location(u32);

impl Location {
    /// The interior of the feature.
    pub(super) const WHOLE: Location = Location(0);
    const CORNER: u32 = 1 << 30;
    const EDGE: u32 = 2 << 30;

    #[inline(always)]
    pub(super) fn corner(k: usize) -> Self {
        Location(Self::CORNER | k as u32)
    }

    #[inline(always)]
    pub(super) fn edge(k: usize) -> Self {
        Location(Self::EDGE | k as u32)
    }

    /// Returns the index of the vertex, if the location is a vertex.
    pub(super) fn as_corner(self) -> Option<usize> {
        (self.0 & Self::CORNER != 0).then_some((self.0 & !Self::CORNER) as usize)
    }

    /// Returns the index of the edge, if the location is an edge.
    pub(super) fn as_edge(self) -> Option<usize> {
        (self.0 & Self::EDGE != 0).then_some((self.0 & !Self::EDGE) as usize)
    }
}

/// A pair of points opposite each other along the normal. Witnesses have no vertex or edge
/// location.
//
// The value of an empty slot is all zero bits, so an empty list is cheap to initialize.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactCandidate {
    pub(super) at: [f64; 2],
    /// Height of the point on B above the point on A.
    pub(super) separation: f64,
    pub(super) on: [Location; 2],
}

impl ContactCandidate {
    pub(super) const WITNESS: [Location; 2] = [Location::WHOLE; 2];
}

/// Short list of the candidates no further apart than the prediction.
pub(super) struct Corners {
    list: [ContactCandidate; MOST],
    count: usize,
    /// Signed distance of the witnesses.
    distance: f64,
    /// Largest accepted separation.
    prediction: f64,
}

impl Corners {
    #[inline(always)]
    pub(super) fn new(distance: f64, prediction: f64) -> Self {
        const NONE: ContactCandidate = ContactCandidate {
            at: [0.0; 2],
            separation: 0.0,
            on: ContactCandidate::WITNESS,
        };
        Self {
            list: [NONE; MOST],
            count: 0,
            distance,
            prediction,
        }
    }

    /// Adds a candidate with the given heights over the witnesses if near enough; returns whether
    /// added. The witnesses are accepted at any separation.
    #[inline(always)]
    pub(super) fn push(&mut self, at: [f64; 2], [on_a, on_b]: [f64; 2], on: [Location; 2]) -> bool {
        let separation = self.distance + (on_b - on_a);
        let wanted = (separation <= self.prediction || on == ContactCandidate::WITNESS) && self.count < MOST;
        if wanted {
            self.list[self.count] = ContactCandidate { at, separation, on };
            self.count += 1;
        }
        wanted
    }

    #[inline(always)]
    pub(super) fn all(&self) -> &[ContactCandidate] {
        &self.list[..self.count]
    }

    pub(super) fn all_mut(&mut self) -> &mut [ContactCandidate] {
        &mut self.list[..self.count]
    }
}
