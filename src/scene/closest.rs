//! The closest pair of two groups: best first over lower bounds from balls and boxes.
//!
//! Two balls and two boxes give each pair a lower bound of its signed distance. First, for each
//! body of the smaller group, the pair with the least bound is measured; only bodies whose boxes
//! are no farther away than the least upper bound found so far are looked at. Then the pairs left
//! are measured in ascending order of their bounds, until a bound exceeds the least upper bound:
//! every pair left out is farther apart than the pair found.

use alloc::vec::Vec;

use super::ball::least_distance;
use super::effects::Group;
use super::search::ClosestPair;
use super::{Scene, SceneError};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::BOX_DISTANCE_DOWN;
use crate::broad::{BroadPhase, StoredBox};
use crate::pair::outcome::Until;

/// A pair to measure: a lower bound of the signed distance, and the bodies of the first and of the
/// second group.
type Candidate = (f64, u32, u32);

/// The search for one pair of groups.
struct ClosestSearch<'a> {
    scene: &'a Scene,
    /// Whether bodies of the smaller group are A of a pair.
    is_first_smaller: bool,
    best: Option<ClosestPair>,
    /// Number of pairs measured.
    measured: usize,
}

impl Scene {
    /// Returns the pair of a body of group `these` and a body of group `those` of least signed
    /// distance, however far apart: the closest pair or, if bodies overlap, the deepest overlap.
    /// `None` if there is no pair. Every other pair is at least as far apart, up to the widths of
    /// the bounds of the two pairs; ties go to the first pair in ascending order.
    ///
    /// Two fixed bodies are no pair. Overlaps of meshes and composites have the distance 0; pairs
    /// of kinds that cannot be measured are left out.
    ///
    /// Boxes and balls exclude most pairs, so that the cost grows with the pairs about as close as
    /// the closest pair. [`boxes`](super::Effects::boxes) between the groups is enough to ask;
    /// effects of long range make the boxes, and so this search, some 20 % slower. The search keeps
    /// no features from call to call; for a closest pair every cycle see the
    /// [table](super#the-nearest-pair-of-a-robot-and-its-cell).
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::scene::{Body, Effects, Group, Scene};
    ///
    /// const CELL: Group = Group::new(1).unwrap();
    /// const ARM: Group = Group::new(2).unwrap();
    ///
    /// let mut scene = Scene::new();
    /// let boxes = Effects::none().boxes(true);
    /// scene.call_for(ARM, CELL, boxes)?;
    /// let cube = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// for k in 0..9 {
    ///     let body = Body::fixed(cube.clone()).group(CELL).user_data(k);
    ///     scene.insert(body, Isometry3::translation(2.0 * k as f64, 0.0, 0.0))?;
    /// }
    /// let arm = Body::moving(cube).group(ARM);
    /// scene.insert(arm, Isometry3::translation(6.1, 3.0, 0.0))?;
    /// scene.step();
    ///
    /// let closest = scene.closest_pair(ARM, CELL)?.expect("both groups have bodies");
    /// assert_eq!(scene.user_data(closest.b), Some(3));
    /// assert!((closest.outcome.distance - 2.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If nothing is called for between the groups, or a step is due.
    #[doc(alias = "clearance")]
    #[doc(alias = "minimum distance")]
    pub fn closest_pair(&self, these: Group, those: Group) -> Result<Option<ClosestPair>, SceneError> {
        self.check_query(these, those)?;
        Ok(self.search_closest(these, those)?.0)
    }

    /// Returns the closest pair, and how many pairs were measured.
    fn search_closest(&self, these: Group, those: Group) -> Result<(Option<ClosestPair>, usize), SceneError> {
        let members = |g: Group| -> Vec<u32> {
            let ids = self.bodies.ids().map(|id| id.index);
            ids.filter(|&i| self.bodies.group(i) == Some(g)).collect()
        };
        let (first, second) = (members(these), members(those));
        let is_first_smaller = first.len() <= second.len();
        let (few, many) = if is_first_smaller {
            (first, second)
        } else {
            (second, first)
        };
        let mut search = ClosestSearch {
            scene: self,
            is_first_smaller,
            best: None,
            measured: 0,
        };
        let mut left = Vec::new();
        for &i in &few {
            let mut candidates = search.candidates(i, &many, these == those)?;
            let least = (0..candidates.len()).min_by(|&x, &y| by_bound(&candidates[x], &candidates[y]));
            if let Some(least) = least {
                search.measure(candidates.swap_remove(least));
            }
            left.append(&mut candidates);
        }
        left.retain(|(bound, ..)| *bound <= search.upper());
        left.sort_unstable_by(by_bound);
        for candidate in left {
            if candidate.0 > search.upper() {
                break;
            }
            search.measure(candidate);
        }
        Ok((search.best, search.measured))
    }
}

fn by_bound(x: &Candidate, y: &Candidate) -> core::cmp::Ordering {
    x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2)))
}

impl ClosestSearch<'_> {
    /// Returns the least upper bound found.
    fn upper(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |near| near.outcome.upper)
    }

    /// Returns the pairs of a body of the smaller group that may be as close as the closest pair
    /// found; `many` are the bodies of the larger group, in ascending order. Within one group only
    /// pairs with a body of higher index are returned.
    fn candidates(&self, i: u32, many: &[u32], is_one_group: bool) -> Result<Vec<Candidate>, SceneError> {
        let upper = self.upper();
        let pairs = |j: &u32| (!is_one_group || i < *j) && self.scene.may_pair(i, *j);
        let bounded = |j: u32| self.bounded(i, j);
        if self.best.is_none() {
            return Ok(many.iter().copied().filter(pairs).map(bounded).collect());
        }
        let mut found = Vec::new();
        let around = self.scene.box_around(i as usize, upper.at_least(0.0));
        self.scene.broad.overlapping(&around, &mut found)?;
        let others = found.iter().map(|p| self.scene.bodies.body_of_proxy[p.index as usize]);
        let others = others.filter(|j| many.binary_search(j).is_ok()).filter(pairs);
        Ok(others.map(bounded).filter(|(bound, ..)| *bound <= upper).collect())
    }

    /// Returns the pair of a body of the smaller and a body of the larger group with its bound.
    fn bounded(&self, i: u32, j: u32) -> Candidate {
        let bodies = &self.scene.bodies;
        let stored = |k: u32| self.scene.broad.stored_box(bodies.proxies[k as usize]);
        let balls = least_distance(&bodies.balls[i as usize], &bodies.balls[j as usize]);
        let boxes = stored(i).zip(stored(j)).map_or(0.0, |(x, y)| least_between(&x, &y));
        // Boxes that overlap bound nothing.
        let bound = if boxes > 0.0 { balls.larger(boxes) } else { balls };
        let (a, b) = if self.is_first_smaller { (i, j) } else { (j, i) };
        (bound, a, b)
    }

    /// Measures a pair, and keeps the pair if no other pair is closer.
    fn measure(&mut self, (_, a, b): Candidate) {
        self.measured += 1;
        let scene = self.scene;
        let Some(mut query) = scene.query(a, b) else {
            return;
        };
        let answer = query.measure(Until::Depth);
        let (outcome, pieces) = (answer.outcome, answer.parts());
        let [a, b] = [a, b].map(|i| scene.bodies.id(i));
        let is_closer = |best: &ClosestPair| {
            let order = outcome.distance.total_cmp(&best.outcome.distance);
            order.then((a, b).cmp(&(best.a, best.b))).is_lt()
        };
        if self.best.as_ref().is_none_or(is_closer) {
            self.best = Some(ClosestPair { a, b, outcome, pieces });
        }
    }
}

/// Returns a lower bound of the distance of the contents of two boxes.
fn least_between(x: &StoredBox, y: &StoredBox) -> f64 {
    sqrt(x.distance_squared(y)) * BOX_DISTANCE_DOWN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::{ConvexPolyhedron, solids};
    use crate::scene::{Body, Effects};
    use nalgebra::{Isometry3, Vector3};

    /// Numbers in [0, 1) by a linear congruential generator (Knuth 1997, section 3.3.4).
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn vector(&mut self, size: f64) -> Vector3<f64> {
            Vector3::from_fn(|_, _| size * (2.0 * self.next() - 1.0))
        }
    }

    /// Six links of an arm in a cell of 300 boxes, all in `room` metres: 1800 pairs.
    fn cell(numbers: &mut Numbers, room: f64) -> (Scene, [Group; 2]) {
        let groups = [1, 2].map(|g| Group::new(g).unwrap());
        let mut scene = Scene::new();
        let boxes = Effects::none().boxes(true);
        scene.call_for(groups[0], groups[1], boxes).unwrap();
        for _ in 0..300 {
            let half = numbers.vector(0.1).map(|x| 0.02 + x.abs());
            let shape: ConvexPolyhedron = solids::cuboid(half).unwrap();
            let pose = Isometry3::new(numbers.vector(room), numbers.vector(3.0));
            scene.insert(Body::fixed(shape).group(groups[1]), pose).unwrap();
        }
        for k in 0..6 {
            let link = solids::prism(12, 0.2, 0.06).unwrap();
            let pose = Isometry3::new(numbers.vector(0.3), Vector3::new(0.0, 0.4 * f64::from(k), 0.0));
            scene.insert(Body::moving(link).group(groups[0]), pose).unwrap();
        }
        scene.step();
        (scene, groups)
    }

    #[test]
    fn a_fifth_of_the_pairs_is_enough() {
        let mut numbers = Numbers(7);
        let (mut measured, mut pairs) = (0, 0);
        for k in 0..20 {
            let (scene, [arm, cell]) = cell(&mut numbers, 1.0 + 0.2 * f64::from(k));
            let (found, count) = scene.search_closest(arm, cell).unwrap();
            assert!(found.is_some());
            measured += count;
            pairs += 1800;
            assert!(count * 5 <= 1800, "{count} pairs measured");
        }
        std::println!("{measured} of {pairs} pairs measured");
    }
}
