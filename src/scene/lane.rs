//! Pairs in lanes: one lane for each kind of answer, so that a pair takes room for what is called for and no more.
//!
//! A lane is three lists side by side; a pair has the same seat in all. Lists have no gaps: who leaves gives the seat to the last.

use alloc::vec::Vec;

use super::effects::{Class, NEVER, Plan, Rung};
use super::kept::{Answer, Contact};
use crate::broad::PairId;
use crate::contact::Manifold;
use crate::pair::outcome::{Distance, Outcome, Until};
use crate::tracker::Tracker;

/// What the stages before a query read of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Head {
    /// Indices of the bodies, `a < b`.
    pub(super) a: u32,
    pub(super) b: u32,
    /// The pair's name in the broad phase.
    pub(super) pair: PairId,
    pub(super) class: Class,
    pub(super) state: State,
    /// The sum of odometers from which on the pair is looked at again.
    pub(super) wake: f64,
}

/// What was last found of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct State {
    /// Looked at since its plan last changed; the rest is of then.
    pub(super) known: bool,
    pub(super) overlaps: bool,
    pub(super) within: bool,
    /// The distance is within the range it was called for, so the lane has an answer.
    pub(super) measured: bool,
}

/// Pairs that keep the same kind of answer.
#[derive(Clone, Debug)]
pub(super) struct Lane<A> {
    pub(super) heads: Vec<Head>,
    pub(super) trackers: Vec<Tracker>,
    pub(super) answers: Vec<A>,
}

impl<A> Default for Lane<A> {
    fn default() -> Self {
        Self {
            heads: Vec::new(),
            trackers: Vec::new(),
            answers: Vec::new(),
        }
    }
}

impl<A: Answer> Lane<A> {
    fn push(&mut self, head: Head, tracker: Tracker) -> u32 {
        self.heads.push(head);
        self.trackers.push(tracker);
        self.answers.push(A::blank());
        (self.heads.len() - 1) as u32
    }

    /// Frees a seat; the last pair of the lane takes it, if it was not its own.
    fn leave(&mut self, seat: u32) -> (Head, Tracker, Option<u32>) {
        let i = seat as usize;
        let head = self.heads.swap_remove(i);
        let tracker = self.trackers.swap_remove(i);
        self.answers.swap_remove(i);
        (head, tracker, self.heads.get(i).map(|moved| moved.pair.slot))
    }

    fn bytes(&self) -> usize {
        let surfaces: usize = self.trackers.iter().map(Tracker::heap_bytes).sum();
        let manifolds = self.answers.iter().filter(|a| a.contacts().is_some()).count();
        self.heads.capacity() * size_of::<Head>()
            + manifolds * size_of::<Manifold>()
            + self.trackers.capacity() * size_of::<Tracker>()
            + self.answers.capacity() * size_of::<A>()
            + surfaces
    }

    /// Gives room back where most of it is empty.
    fn trim(&mut self) {
        if self.heads.capacity() > 4 * self.heads.len() + 64 {
            self.heads.shrink_to(2 * self.heads.len());
            self.trackers.shrink_to(2 * self.trackers.len());
            self.answers.shrink_to(2 * self.answers.len());
        }
    }
}

/// Where the pair of a slot sits: the lane in the three upper bits, below them whether its boxes were told of, and the seat in
/// the lower half. There are fewer pairs than 2^32 at once, so every seat has room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seat(u64);

const LANE: u32 = 61;
const TOLD: u64 = 1 << 60;

impl Seat {
    /// Of a pair of boxes alone, and of a slot without a pair.
    const NONE: Self = Self(7 << LANE);

    fn of(lane: u32, seat: u32) -> Self {
        Self(u64::from(lane) << LANE | u64::from(seat))
    }

    fn lane(self) -> u32 {
        (self.0 >> LANE) as u32
    }

    fn seat(self) -> u32 {
        self.0 as u32
    }

    fn is_told(self) -> bool {
        self.0 & TOLD != 0
    }
}

/// What a pair takes along from one seat to the next.
#[derive(Debug, Default)]
pub(super) struct Luggage {
    pub(super) state: State,
    pub(super) tracker: Tracker,
    /// Whether it was told that the boxes met.
    pub(super) told: bool,
}

/// A pair's part in the lanes, as queries see it.
pub(super) struct Seen<'a> {
    pub(super) head: &'a Head,
    pub(super) tracker: &'a Tracker,
    pub(super) distance: Option<Distance>,
    pub(super) outcome: Option<&'a Outcome>,
    pub(super) manifold: Option<&'a Manifold>,
}

/// All lanes, and the seats by slot.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanes {
    pub(super) predicates: Lane<()>,
    pub(super) distances: Lane<Distance>,
    pub(super) features: Lane<Outcome>,
    pub(super) contacts: Lane<Contact>,
    seats: Vec<Seat>,
}

impl Lanes {
    /// Seats a pair in the lane of its rung, with what of its luggage is still called for; pairs of boxes alone have no seat.
    /// The pair is looked at in this step, whatever was known of it.
    pub(super) fn seat(&mut self, plan: &Plan, head: Head, luggage: Luggage) {
        let slot = head.pair.slot as usize;
        let state = State {
            overlaps: plan.overlap && luggage.state.overlaps,
            within: plan.within != NEVER && luggage.state.within,
            ..State::default()
        };
        let head = Head { state, ..head };
        let mut tracker = luggage.tracker;
        if plan.until == Until::Class {
            tracker.shed();
        }
        let seat = match plan.rung {
            Rung::Nothing | Rung::Boxes => Seat::NONE,
            Rung::Predicates => Seat::of(0, self.predicates.push(head, tracker)),
            Rung::Distance => Seat::of(1, self.distances.push(head, tracker)),
            Rung::Features => Seat::of(2, self.features.push(head, tracker)),
            Rung::Manifold => Seat::of(3, self.contacts.push(head, tracker)),
        };
        if slot >= self.seats.len() {
            self.seats.resize(slot + 1, Seat::NONE);
        }
        self.seats[slot] = Seat(seat.0 | if plan.boxes { TOLD } else { 0 });
    }

    /// Takes the pair of a slot out of its lane, if it sits in one.
    pub(super) fn leave(&mut self, slot: u32) -> Luggage {
        let Some(place) = self.seats.get_mut(slot as usize) else {
            return Luggage::default();
        };
        let left = core::mem::replace(place, Seat::NONE);
        let taken = match left.lane() {
            0 => Some(self.predicates.leave(left.seat())),
            1 => Some(self.distances.leave(left.seat())),
            2 => Some(self.features.leave(left.seat())),
            3 => Some(self.contacts.leave(left.seat())),
            _ => None,
        };
        let told = left.is_told();
        let Some((head, tracker, moved)) = taken else {
            return Luggage {
                told,
                ..Luggage::default()
            };
        };
        if let Some(moved) = moved {
            // The last of the lane took the seat; what was told of it stays.
            let place = &mut self.seats[moved as usize];
            *place = Seat(left.0 & !TOLD | place.0 & TOLD);
        }
        Luggage {
            state: head.state,
            tracker,
            told,
        }
    }

    /// The pair of a slot, if it sits in a lane.
    pub(super) fn get(&self, slot: u32) -> Option<Seen<'_>> {
        fn seen<A: Answer>(lane: &Lane<A>, seat: u32) -> Option<Seen<'_>> {
            let (head, answer) = (lane.heads.get(seat as usize)?, &lane.answers[seat as usize]);
            Some(Seen {
                head,
                tracker: &lane.trackers[seat as usize],
                distance: answer.distance().filter(|_| head.state.measured),
                outcome: answer.outcome().filter(|_| head.state.measured),
                manifold: answer.contacts().filter(|_| head.state.measured),
            })
        }
        let place = self.seats.get(slot as usize)?;
        match place.lane() {
            0 => seen(&self.predicates, place.seat()),
            1 => seen(&self.distances, place.seat()),
            2 => seen(&self.features, place.seat()),
            3 => seen(&self.contacts, place.seat()),
            _ => None,
        }
    }

    /// Slots whose boxes were told of.
    #[cfg(feature = "serde")]
    pub(super) fn told(&self) -> impl Iterator<Item = u32> + '_ {
        let seats = self.seats.iter().zip(0u32..);
        seats.filter(|(seat, _)| seat.is_told()).map(|(_, slot)| slot)
    }

    /// The pairs of all lanes.
    #[cfg(feature = "serde")]
    pub(super) fn heads(&self) -> impl Iterator<Item = &Head> {
        let lanes = [
            &self.predicates.heads,
            &self.distances.heads,
            &self.features.heads,
            &self.contacts.heads,
        ];
        lanes.into_iter().flatten()
    }

    /// Lanes with their seats found anew; `None` where two pairs have one slot. Slots are those of a broad phase.
    #[cfg(feature = "serde")]
    pub(super) fn restored(
        predicates: Lane<()>,
        distances: Lane<Distance>,
        features: Lane<Outcome>,
        contacts: Lane<Contact>,
        told: &[u32],
        slots: usize,
    ) -> Option<Self> {
        let mut seats = alloc::vec![Seat::NONE; slots];
        for (lane, heads) in [&predicates.heads, &distances.heads, &features.heads, &contacts.heads]
            .into_iter()
            .enumerate()
        {
            for (head, seat) in heads.iter().zip(0u32..) {
                let place = seats.get_mut(head.pair.slot as usize)?;
                if *place != Seat::NONE {
                    return None;
                }
                *place = Seat::of(lane as u32, seat);
            }
        }
        for slot in told {
            let place = seats.get_mut(*slot as usize)?;
            *place = Seat(place.0 | TOLD);
        }
        Some(Self {
            predicates,
            distances,
            features,
            contacts,
            seats,
        })
    }

    pub(super) fn trim(&mut self) {
        self.predicates.trim();
        self.distances.trim();
        self.features.trim();
        self.contacts.trim();
    }

    pub(super) fn bytes(&self) -> usize {
        self.predicates.bytes()
            + self.distances.bytes()
            + self.features.bytes()
            + self.contacts.bytes()
            + self.seats.capacity() * size_of::<Seat>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seats_keep_lane_number_and_flag_apart() {
        for lane in [0, 3] {
            for seat in [0, 1, (1 << 28) - 1, 1 << 28, (1 << 29) + 5, u32::MAX] {
                for told in [0, TOLD] {
                    let place = Seat(Seat::of(lane, seat).0 | told);
                    assert_eq!((place.lane(), place.seat(), place.is_told()), (lane, seat, told != 0));
                    assert_ne!(place, Seat::NONE);
                }
            }
        }
    }
}
