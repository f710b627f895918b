//! The corners of what two features share: candidates for contacts.

/// The most corners there are: those of two features of 24, and some that rounding doubles.
const MOST: usize = 64;

/// On what of a shadow a point lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Location(u32);

impl Location {
    /// Between its corners.
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

    /// The number of the corner.
    pub(super) fn as_corner(self) -> Option<usize> {
        (self.0 & Self::CORNER != 0).then_some((self.0 & !Self::CORNER) as usize)
    }

    /// The number of the edge.
    pub(super) fn as_edge(self) -> Option<usize> {
        (self.0 & Self::EDGE != 0).then_some((self.0 & !Self::EDGE) as usize)
    }
}

/// A pair of points across from each other. The witnesses are on neither corners nor edges of the shadows.
//
// All zero in memory where nothing is in it, so that a list of them is soon made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactCandidate {
    pub(super) at: [f64; 2],
    /// From the point on A to that on B.
    pub(super) separation: f64,
    pub(super) on: [Location; 2],
}

impl ContactCandidate {
    pub(super) const WITNESS: [Location; 2] = [Location::WHOLE; 2];
}

/// A short list of those no further apart than wanted.
pub(super) struct Corners {
    list: [ContactCandidate; MOST],
    count: usize,
    /// Of the witnesses.
    distance: f64,
    /// The largest separation that is wanted.
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

    /// A corner whose points are at these heights over the witnesses, if it is near enough, which is told. The witnesses are in any
    /// case.
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
