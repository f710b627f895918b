//! Ids of bodies: an index into tables, and a generation that distinguishes bodies that use the
//! index one after the other.
//!
//! The generation of an index is odd as long as a body uses it. The id of a removed body is stale
//! at once. The index becomes free at the end of the step, so within a step no index has two
//! bodies. An index without further generations is *retired* and never used again.

use super::BodyId;
use super::tables::push;
use alloc::vec::Vec;

/// The generation from which an index is never used again.
const RETIRED: u32 = u32::MAX - 1;

/// Generations of the indices of one table, and the indices without a body.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slots {
    generations: Vec<u32>,
    free: Vec<u32>,
    /// Indices of the bodies removed since the last step.
    leaving: Vec<u32>,
    /// Number of living bodies.
    living: usize,
}

impl Slots {
    /// Returns the slots with the given generations and lists of indices without a body; `None` if
    /// these contradict each other.
    #[cfg(feature = "serde")]
    pub(crate) fn restored(generations: Vec<u32>, free: Vec<u32>, leaving: Vec<u32>) -> Option<Self> {
        let slots = Self {
            living: generations.iter().filter(|g| **g % 2 == 1).count(),
            generations,
            free,
            leaving,
        };
        slots.is_consistent().then_some(slots)
    }

    /// Returns whether every index without a body is listed once, and no other index is.
    pub(crate) fn is_consistent(&self) -> bool {
        let mut is_listed = alloc::vec![false; self.generations.len()];
        for (list, most) in [(&self.free, RETIRED), (&self.leaving, u32::MAX)] {
            for &index in list {
                let Some(&generation) = self.generations.get(index as usize) else {
                    return false;
                };
                let is_twice = core::mem::replace(&mut is_listed[index as usize], true);
                if is_twice || generation % 2 == 1 || generation >= most {
                    return false;
                }
            }
        }
        // Generation u32::MAX would have no successor.
        let sound = |(g, listed): (&u32, &bool)| *g < u32::MAX && (g % 2 == 1 || *listed || *g >= RETIRED);
        let living = self.generations.iter().filter(|g| **g % 2 == 1).count();
        living == self.living && self.generations.iter().zip(&is_listed).all(sound)
    }

    /// Returns the number of indices, of living bodies and others.
    pub(crate) fn index_count(&self) -> usize {
        self.generations.len()
    }

    /// Returns the number of living bodies.
    pub(crate) fn len(&self) -> usize {
        self.living
    }

    /// Returns the index of a living body.
    #[inline]
    pub(crate) fn index_of(&self, id: BodyId) -> Option<usize> {
        is_living(&self.generations, id.index as usize, id).then_some(id.index as usize)
    }

    /// Returns the id of the body at an index. Until the next step, a removed body keeps its id.
    #[inline]
    pub(crate) fn id(&self, index: u32) -> BodyId {
        let generation = self.generations.get(index as usize);
        BodyId {
            index,
            generation: generation.map_or(0, |g| g.wrapping_sub(1) | 1),
        }
    }

    /// Returns whether a body lives at an index.
    #[inline]
    pub(crate) fn lives(&self, index: u32) -> bool {
        self.generations.get(index as usize).is_some_and(|g| g % 2 == 1)
    }

    /// Iterates over the ids of all living bodies in ascending order.
    pub(crate) fn ids(&self) -> impl Iterator<Item = BodyId> + '_ {
        let living = self.generations.iter().enumerate().filter(|(_, g)| **g % 2 == 1);
        living.map(|(i, g)| BodyId {
            index: i as u32,
            generation: *g,
        })
    }

    /// Returns the generations by index.
    pub(crate) fn generations(&self) -> &[u32] {
        &self.generations
    }

    /// Returns a free index, or a new index if no index is free and there are fewer than `most`.
    pub(crate) fn vacant(&mut self, most: usize) -> Option<u32> {
        if let Some(index) = self.free.pop() {
            return Some(index);
        }
        if self.generations.len() >= most {
            return None;
        }
        push(&mut self.generations, 0);
        Some((self.generations.len() - 1) as u32)
    }

    /// Starts the life of a body at a vacant index.
    pub(crate) fn begin(&mut self, index: u32) -> BodyId {
        self.generations[index as usize] += 1;
        self.living += 1;
        self.id(index)
    }

    /// Makes the id of the body at an index stale; the index stays in use until the step ends.
    pub(crate) fn remove(&mut self, index: u32) {
        self.generations[index as usize] += 1;
        self.living -= 1;
        self.leaving.push(index);
    }

    /// Returns the indices that are free, and those of the bodies removed since the last step.
    #[cfg(feature = "serde")]
    pub(crate) fn vacancies(&self) -> [&Vec<u32>; 2] {
        [&self.free, &self.leaving]
    }

    /// Returns whether bodies were removed since the last step.
    pub(crate) fn has_leaving(&self) -> bool {
        !self.leaving.is_empty()
    }

    /// Ends the step: the indices of removed bodies, passed to `freed`, become free.
    pub(crate) fn end_step(&mut self, mut freed: impl FnMut(usize)) {
        for index in self.leaving.drain(..) {
            freed(index as usize);
            if self.generations[index as usize] < RETIRED {
                self.free.push(index);
            }
        }
    }

    /// Returns the bytes reserved.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.generations.capacity() + self.free.capacity() + self.leaving.capacity())
    }

    /// Sets the generation of an index.
    #[cfg(test)]
    pub(crate) fn set_generation(&mut self, index: u32, generation: u32) {
        self.generations[index as usize] = generation;
    }
}

/// Returns whether an id is that of the living body at index `i` of these generations.
#[inline]
pub(crate) fn is_living(generations: &[u32], i: usize, id: BodyId) -> bool {
    id.generation % 2 == 1 && generations.get(i) == Some(&id.generation)
}
