//! Contact state of two bodies, and the result of the oracle.

use crate::rational::sqrt;
use dashu_ratio::RBig;
use std::cmp::Ordering;
use std::fmt;

/// Exact contact state of two closed bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContactState {
    /// No common point.
    Separated,
    /// Common points, but no common interior point.
    Touching,
    /// A common interior point.
    Overlapping,
}

impl ContactState {
    /// Returns the contact state of a signed distance, from its comparison with zero.
    pub fn of_sign(distance_to_zero: Ordering) -> Self {
        match distance_to_zero {
            Ordering::Greater => Self::Separated,
            Ordering::Equal => Self::Touching,
            Ordering::Less => Self::Overlapping,
        }
    }

    /// Returns the word of case files: `sep`, `touch` or `pen`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Separated => "sep",
            Self::Touching => "touch",
            Self::Overlapping => "pen",
        }
    }

    /// Returns the contact state of a word of case files.
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Separated, Self::Touching, Self::Overlapping]
            .into_iter()
            .find(|c| c.word() == word)
    }
}

impl fmt::Display for ContactState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// The result of the oracle.
#[derive(Clone, Debug)]
pub struct Exact {
    /// Contact state.
    pub state: ContactState,
    /// Signed distance, correctly rounded: minus the depth if the bodies overlap.
    pub distance: f64,
    /// Remainder lost by rounding `distance`: `distance + remainder` is accurate to 106 bits, if
    /// the range of doubles allows it.
    pub remainder: f64,
    /// The exact square of the signed distance.
    pub squared: RBig,
}

impl Exact {
    /// Returns the result from its contact state and the square of the distance.
    pub fn new(state: ContactState, squared: RBig) -> Self {
        let (head, tail) = sqrt(&squared);
        let sign = if state == ContactState::Overlapping { -1.0 } else { 1.0 };
        Self {
            state,
            distance: sign * head,
            remainder: sign * tail,
            squared,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lead_back_to_their_class() {
        for c in [
            ContactState::Separated,
            ContactState::Touching,
            ContactState::Overlapping,
        ] {
            assert_eq!(ContactState::from_word(&c.to_string()), Some(c));
        }
        assert_eq!(ContactState::from_word("none"), None);
    }

    #[test]
    fn overlap_is_negative() {
        let e = Exact::new(ContactState::of_sign(Ordering::Less), 2.into());
        assert_eq!((e.distance, e.remainder > 0.0), (-std::f64::consts::SQRT_2, true));
    }
}
