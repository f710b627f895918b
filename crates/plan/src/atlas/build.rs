//! The search for free boxes: largest first.

use core::ops::ControlFlow;
use std::vec::Vec;

use super::{Atlas, AtlasVerdict, middle};
use crate::checker::Checker;
use crate::error::PlanError;
use crate::range::{BoxProof, PairProver};
use crate::space::ConfigurationSpace;
use crate::world::WorldPair;
use lin_canny::Progress;

/// Most boxes of an atlas: they are numbered by 32 bits.
const MOST: usize = u32::MAX as usize - 2;

/// How long a search for free boxes goes on. It ends when the first budget is spent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct AtlasOptions {
    /// Most boxes that are searched (default 20,000).
    pub boxes: u64,
    /// Most proofs of a pair over a box, checked between boxes (default `u64::MAX`).
    pub proofs: u64,
}

impl Default for AtlasOptions {
    fn default() -> Self {
        Self {
            boxes: 20_000,
            proofs: u64::MAX,
        }
    }
}

impl AtlasOptions {
    /// Sets the most boxes that are searched.
    #[must_use]
    pub const fn boxes(self, boxes: u64) -> Self {
        Self { boxes, ..self }
    }

    /// Sets the most proofs of a pair over a box.
    #[must_use]
    pub const fn proofs(self, proofs: u64) -> Self {
        Self { proofs, ..self }
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Searches for boxes of configurations within the limits that are proven free, or in contact.
    ///
    /// A box is free if every pair that is measured is farther apart than it must keep at each of
    /// its configurations: margins, paddings and excluded pairs count as in
    /// [`is_free_at`](Self::is_free_at). The boxes are disjoint, except for their faces. The result
    /// depends on the robot, the world and the budgets alone. Obstacles that move are at their poses
    /// at the time of [`set_time`](Self::set_time).
    ///
    /// Each coordinate multiplies the work. Boxes cover most of the volume of three joints in a
    /// second, and a third of the free volume of a six-axis cell in about a minute. With more joints
    /// or a tight cell they cover little.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::{AtlasOptions, Checker, Joint, SerialArm, World};
    ///
    /// // A block on two rails, x and y.
    /// let origin = Isometry3::identity();
    /// let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// let block = SerialArm::new(origin, rails, vec![2], 0.1)?;
    /// let mut world = World::new();
    /// world.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// let post = solids::cuboid(Vector3::repeat(0.5))?;
    /// world.obstacle("post", post, origin);
    /// let mut checker = Checker::new(block, world)?;
    ///
    /// let atlas = checker.free_boxes(&AtlasOptions::default().boxes(2_000))?;
    /// // A square with a side of 1.2 of one with a side of 4 is in contact.
    /// assert!(atlas.shares().free > 0.9 && atlas.shares().contact > 0.08);
    ///
    /// // The checker answers by it from now on.
    /// checker.set_atlas(atlas)?;
    /// assert!(checker.certify(&[-1.5, -1.5], &[-1.5, 1.5])?.is_free());
    /// assert_eq!(checker.work().queries, 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the space does not move its bodies by joints
    /// ([`ConfigurationSpace::joint_path`]) or has a coordinate without limits, or if an obstacle
    /// moves and no time is set.
    pub fn free_boxes(&mut self, options: &AtlasOptions) -> Result<Atlas, PlanError> {
        self.free_boxes_with_progress(options, &mut |_| ControlFlow::Continue(()))
    }

    /// Searches for free boxes as [`free_boxes`](Self::free_boxes) does, with a progress callback.
    ///
    /// The callback receives the number of boxes, after each. If it stops the search, the atlas has
    /// what was proven until then, and [`resume_boxes`](Self::resume_boxes) goes on.
    ///
    /// # Errors
    /// As [`free_boxes`](Self::free_boxes).
    pub fn free_boxes_with_progress(
        &mut self,
        options: &AtlasOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Atlas, PlanError> {
        let [low, high] = self.range_of_limits()?;
        self.with_provers(&low.clone(), &high.clone(), |provers| {
            let pairs = provers.iter().map(|prover| (prover.pair(), prover.fingerprint()));
            let mut atlas = Atlas::new(low, high, pairs.collect());
            atlas.search(provers, options, progress)?;
            Ok(atlas)
        })
    }

    /// Goes on with the boxes that an atlas has left, for as many as the options allow.
    ///
    /// Two calls give the same atlas, bit for bit, as one call with the sum of both numbers of boxes.
    ///
    /// # Errors
    /// As [`set_atlas`](Self::set_atlas).
    pub fn resume_boxes(
        &mut self,
        atlas: &Atlas,
        options: &AtlasOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Atlas, PlanError> {
        self.check_atlas(atlas)?;
        let mut atlas = atlas.clone();
        let [low, high] = atlas.range().map(<[f64]>::to_vec);
        self.with_provers(&low, &high, |provers| {
            atlas.search(provers, options, progress)?;
            Ok(atlas)
        })
    }

    /// Returns the limits of all coordinates.
    pub(super) fn range_of_limits(&self) -> Result<[Vec<f64>; 2], PlanError> {
        let bounds = self.space.bounds();
        if bounds.len() != self.space.coordinates() {
            return Err(PlanError::Value {
                what: "number of coordinates without limits",
                value: (self.space.coordinates() - bounds.len()) as f64,
            });
        }
        let limits = [0, 1].map(|k| bounds.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
        self.check_range(&limits[0], &limits[1])?;
        Ok(limits)
    }

    /// Checks that an atlas belongs to this robot and this world as they are.
    pub(super) fn check_atlas(&mut self, atlas: &Atlas) -> Result<(), PlanError> {
        let [low, high] = self.range_of_limits()?;
        if let Some(index) = (0..low.len().max(atlas.low.len())).find(|&k| {
            let of =
                |own: &[f64], others: &[f64]| own.get(k).map(|x| x.to_bits()) != others.get(k).map(|x| x.to_bits());
            of(&low, &atlas.low) || of(&high, &atlas.high)
        }) {
            let what = std::format!("the limits of coordinate {index} differ");
            return Err(PlanError::OtherAtlas(what));
        }
        let own = self.with_provers(&low, &high, |provers| {
            let own = provers.iter().map(|prover| (prover.pair(), prover.fingerprint()));
            Ok(own.collect::<Vec<_>>())
        })?;
        let known = |all: &[(WorldPair, u64)], pair: WorldPair| {
            let found = all.binary_search_by_key(&pair, |entry| entry.0).ok();
            found.map(|k| all[k].1)
        };
        for (pair, hash) in &own {
            let reason = match known(&atlas.pairs, *pair) {
                Some(found) if found == *hash => continue,
                Some(_) => "the bodies, the joints or the margin differ",
                None => "the atlas does not measure the pair",
            };
            let pair = self.show(pair);
            return Err(PlanError::OtherAtlas(std::format!("{pair}: {reason}")));
        }
        match atlas.pairs.iter().find(|entry| known(&own, entry.0).is_none()) {
            Some((pair, _)) => {
                let what = std::format!("{pair}: the checker does not measure the pair");
                Err(PlanError::OtherAtlas(what))
            }
            None => Ok(()),
        }
    }
}

/// Scratch memory of a search.
#[derive(Default)]
struct Room {
    low: Vec<f64>,
    high: Vec<f64>,
    left: Vec<u64>,
    /// For each coordinate, how much halving it helps.
    gains: Vec<f64>,
}

/// What the proofs of all pairs say about a box.
enum Found {
    Proven(AtlasVerdict),
    Halve(usize, f64),
    Stuck,
}

impl Atlas {
    /// Searches boxes until a budget is spent or the caller stops.
    pub(super) fn search(
        &mut self,
        provers: &mut [PairProver<'_>],
        options: &AtlasOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), PlanError> {
        let most = (self.next as u64).saturating_add(options.boxes);
        let proofs = self.proofs.saturating_add(options.proofs);
        let mut room = Room::default();
        while (self.next as u64) < most && self.proofs < proofs && !self.is_complete() && self.nodes.len() < MOST {
            self.search_box(provers, &mut room)?;
            let total = usize::try_from(options.boxes)
                .ok()
                .and_then(|_| usize::try_from(most).ok());
            if progress(Progress::new("boxes", self.next, total)).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// Searches the box that comes next.
    fn search_box(&mut self, provers: &mut [PairProver<'_>], room: &mut Room) -> Result<(), PlanError> {
        let node = self.next;
        let level = self.ends(node, &mut room.low, &mut room.high);
        let found = self.proven(provers, room)?;
        match found {
            Found::Proven(verdict) => self.prove(node, verdict, level),
            Found::Stuck => self.nodes[node] = super::Node::Stuck,
            Found::Halve(coordinate, at) => {
                self.halve(node, coordinate, at);
                self.waiting.push_back(room.left.clone());
            }
        }
        self.next += 1;
        // The second half is the last to need the pairs of both; the whole range has no other half.
        if node.is_multiple_of(2) {
            self.waiting.pop_front();
        }
        Ok(())
    }

    /// Proves the pairs that are left over a box.
    fn proven(&mut self, provers: &mut [PairProver<'_>], room: &mut Room) -> Result<Found, PlanError> {
        let Room { low, high, left, gains } = room;
        let Some(all) = self.waiting.front() else {
            return Ok(Found::Stuck);
        };
        left.clear();
        left.resize(all.len(), 0);
        gains.clear();
        gains.resize(low.len(), 0.0);
        let (mut least, mut can_halve) = (f64::INFINITY, true);
        let mut is_free = true;
        for (word, bits) in all.iter().enumerate() {
            let mut bits = *bits;
            while bits != 0 {
                let bit = bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let prover = &mut provers[64 * word + bit];
                self.proofs += 1;
                let lower = match prover.prove(low, high)? {
                    BoxProof::Free => continue,
                    BoxProof::Contact => return Ok(Found::Proven(AtlasVerdict::Contact)),
                    BoxProof::Left(lower) => lower,
                };
                is_free = false;
                left[word] |= 1 << bit;
                let mut lever = (0.0, None);
                for (c, way) in prover.levers() {
                    if (lever.1.is_none() || way > lever.0) && middle(low[c], high[c]).is_some() {
                        lever = (way, Some(c));
                    }
                }
                let Some(coordinate) = lever.1 else {
                    can_halve = false;
                    continue;
                };
                if lower < least {
                    least = lower;
                    gains.fill(0.0);
                    gains[coordinate] = 1.0;
                }
            }
        }
        if is_free {
            return Ok(Found::Proven(AtlasVerdict::Free));
        }
        let best = (0..gains.len()).find(|k| gains[*k] > 0.0);
        let at = best.and_then(|k| Some((k, middle(low[k], high[k])?)));
        Ok(match at {
            Some((coordinate, at)) if can_halve => Found::Halve(coordinate, at),
            _ => Found::Stuck,
        })
    }
}
