//! Pairs of bodies that a scene excludes, for instance adjacent links of an arm, or a gripper and
//! the workpiece that it holds.

use alloc::collections::BTreeSet;

use super::{BodyId, Scene, SceneError};

/// Excluded pairs by the indices of the bodies. Every pair is listed in both orders, so the
/// partners of one body form a range.
#[derive(Clone, Debug, Default)]
pub(super) struct Excluded(BTreeSet<(u32, u32)>);

impl Excluded {
    #[inline]
    pub(super) fn contains(&self, a: u32, b: u32) -> bool {
        self.0.contains(&(a, b))
    }

    /// Adds or removes a pair; returns whether the list changed.
    pub(super) fn set(&mut self, a: u32, b: u32, excluded: bool) -> bool {
        for pair in [(a, b), (b, a)] {
            let changed = if excluded {
                self.0.insert(pair)
            } else {
                self.0.remove(&pair)
            };
            if !changed {
                return false;
            }
        }
        true
    }

    /// Removes all pairs of a body.
    pub(super) fn remove_body(&mut self, a: u32) {
        while let Some(&(_, b)) = self.0.range((a, 0)..=(a, u32::MAX)).next() {
            self.set(a, b, false);
        }
    }

    /// Iterates over the pairs, the lower index first.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.0.iter().copied().filter(|(a, b)| a < b)
    }

    /// Returns an estimate of the bytes of the list.
    pub(super) fn bytes(&self) -> usize {
        2 * self.0.len() * size_of::<(u32, u32)>()
    }
}

impl Scene {
    /// Excludes a pair of bodies, in either order, from everything that the scene computes.
    ///
    /// Use it for adjacent links of an arm, or for a gripper and the workpiece that it holds. The
    /// call takes effect with the next step; a state of the pair that had started ends then, with
    /// events. The number of excluded pairs is not limited. A pair is forgotten when one of its
    /// bodies is removed.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::scene::{Body, PairQueries, Scene};
    ///
    /// let overlaps = PairQueries::none().overlap(true);
    /// let mut scene = Scene::with_queries(overlaps)?;
    /// let link = solids::cuboid(Vector3::new(0.1, 0.1, 0.5))?;
    /// let mut links = Vec::new();
    /// for k in 0..6 {
    ///     let pose = Isometry3::translation(0.0, 0.0, 0.9 * f64::from(k));
    ///     links.push(scene.insert(Body::moving(link.clone()), pose)?);
    /// }
    /// scene.step();
    /// assert_eq!(scene.pair_count(), 5); // every link overlaps the next one
    /// for adjacent in links.windows(2) {
    ///     scene.exclude_pair(adjacent[0], adjacent[1])?;
    /// }
    /// scene.step();
    /// assert_eq!(scene.pair_count(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if an id is stale.
    #[doc(alias = "filter")]
    #[doc(alias = "collision matrix")]
    pub fn exclude_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), SceneError> {
        self.set_excluded(a, b, true)
    }

    /// Reverses [`exclude_pair`](Self::exclude_pair) with the next step; does nothing if the pair
    /// is not excluded.
    ///
    /// # Errors
    /// Returns an error if an id is stale.
    pub fn include_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), SceneError> {
        self.set_excluded(a, b, false)
    }

    /// Returns whether a pair of bodies is excluded; false if an id is stale.
    #[must_use]
    pub fn is_excluded(&self, a: BodyId, b: BodyId) -> bool {
        let index = |id| self.bodies.index_of(id).ok();
        index(a).is_some_and(|_| index(b).is_some() && self.excluded.contains(a.index, b.index))
    }

    /// Iterates over the excluded pairs, the body with the lower index first.
    pub fn excluded_pairs(&self) -> impl Iterator<Item = (BodyId, BodyId)> + '_ {
        self.excluded
            .iter()
            .map(|(a, b)| (self.bodies.id(a), self.bodies.id(b)))
    }

    fn set_excluded(&mut self, a: BodyId, b: BodyId, excluded: bool) -> Result<(), SceneError> {
        let i = self.bodies.index_of(a)?;
        self.bodies.index_of(b)?;
        if a != b && self.excluded.set(a.index, b.index, excluded) {
            // The broad phase calls the filter again for all pairs of A; the id is not stale.
            let _ = self.broad.regroup(self.bodies.proxies[i]);
            self.changed = true;
        }
        Ok(())
    }
}
