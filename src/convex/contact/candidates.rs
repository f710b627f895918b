//! Contact candidates: vertices of the overlap of two projected features.

/// Most candidates: for two features of 24 vertices, with some doubled by rounding.
const MAX_CANDIDATES: usize = 64;

/// Part of a projected feature that contains a point: a vertex, an edge, or the interior.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Location(u32);

impl Location {
    /// The interior of the feature.
    pub(super) const WHOLE: Location = Location(0);
    const VERTEX: u32 = 1 << 30;
    const EDGE: u32 = 2 << 30;

    #[inline(always)]
    pub(super) fn vertex(k: usize) -> Self {
        Location(Self::VERTEX | k as u32)
    }

    #[inline(always)]
    pub(super) fn edge(k: usize) -> Self {
        Location(Self::EDGE | k as u32)
    }

    /// Returns the index of the vertex, if the location is a vertex.
    pub(super) fn as_vertex(self) -> Option<usize> {
        (self.0 & Self::VERTEX != 0).then_some((self.0 & !Self::VERTEX) as usize)
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
pub(crate) struct ContactCandidate {
    pub(super) at: [f64; 2],
    /// Height of the point on B above the point on A.
    pub(super) separation: f64,
    pub(super) on: [Location; 2],
}

impl ContactCandidate {
    pub(super) const WITNESS: [Location; 2] = [Location::WHOLE; 2];

    /// Returns the candidate of a pair of points by its place in the plane of contact.
    pub(crate) fn at(at: [f64; 2], separation: f64) -> Self {
        Self {
            at,
            separation,
            on: Self::WITNESS,
        }
    }
}

/// Short list of the candidates no further apart than the prediction.
pub(super) struct Candidates {
    list: [ContactCandidate; MAX_CANDIDATES],
    count: usize,
    /// Signed distance of the witnesses.
    distance: f64,
    /// Largest accepted separation.
    prediction: f64,
}

impl Candidates {
    #[inline(always)]
    pub(super) fn new(distance: f64, prediction: f64) -> Self {
        const EMPTY: ContactCandidate = ContactCandidate {
            at: [0.0; 2],
            separation: 0.0,
            on: ContactCandidate::WITNESS,
        };
        Self {
            list: [EMPTY; MAX_CANDIDATES],
            count: 0,
            distance,
            prediction,
        }
    }

    /// Adds a candidate with the given heights over the witnesses if near enough. The
    /// witnesses are accepted at any separation.
    #[inline(always)]
    pub(super) fn push(&mut self, at: [f64; 2], [on_a, on_b]: [f64; 2], on: [Location; 2]) {
        let separation = self.distance + (on_b - on_a);
        let is_accepted =
            (separation <= self.prediction || on == ContactCandidate::WITNESS) && self.count < MAX_CANDIDATES;
        if is_accepted {
            self.list[self.count] = ContactCandidate { at, separation, on };
            self.count += 1;
        }
    }

    #[inline(always)]
    pub(super) fn all(&self) -> &[ContactCandidate] {
        &self.list[..self.count]
    }

    pub(super) fn all_mut(&mut self) -> &mut [ContactCandidate] {
        &mut self.list[..self.count]
    }
}
