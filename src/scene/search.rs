//! Queries about the poses of the last step: all pairs within a distance, the nearest bodies, any
//! contact, the closest pair of two groups, and ray casts.
//!
//! The queries use the boxes of the step. They are allowed for groups between which any query is
//! enabled; `boxes` is enough. No result is stored. If the scene tracks a pair, the query starts
//! from the features of that tracker.
//!
//! The closest pair of two groups is found best first, over lower bounds from balls and boxes:
//!
//! Two balls and two boxes give a lower bound of the signed distance of each pair. First, for each
//! body of the smaller group, the search measures the pair with the least bound. It considers only
//! bodies whose boxes are no farther away than the least upper bound found so far. Then it measures
//! the remaining pairs in ascending order of their bounds, until a bound exceeds the least upper
//! bound. Every pair that is not measured is farther apart than the pair found.

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{BOX_DISTANCE_DOWN, RAY, SCENE_REACH};
use crate::body::polyhedron::BoxHint;
use crate::broad::{Aabb, StoredBox};
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{DepthMode, Outcome};
use crate::pair_tracker::Engine;
use crate::pair_tracker::geometry::{Geometry, GeometryRef};
use crate::ray::{Ray, RayCast, RayCaster, placed_ball};
use crate::scene::body::box_of;
use crate::scene::body::{BodyTable, least_distance};
use crate::scene::queries::{Detail, GROUPS, Group, group_pair_of};
use crate::scene::{BodyId, Scene, SceneError};
use alloc::vec::Vec;
use nalgebra::Point3;

/// Two bodies and their outcome, in the frames of the bodies as in
/// [`PairResults`](super::PairResults).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ClosestPair {
    /// Operand A of the outcome: the query body, or the body of the first group. If both bodies are
    /// in one group, the one with the lower index.
    pub a: BodyId,
    /// Operand B of the outcome: the second body.
    pub b: BodyId,
    /// Distance with bounds, features, witness points and normal.
    pub outcome: Outcome,
    /// The subshapes of the features, as in
    /// [`PairResults::subshapes`](super::PairResults::subshapes).
    pub subshapes: [u32; 2],
}

impl Scene {
    /// Returns all pairs of two groups that are at most `d` apart, exactly.
    ///
    /// The first body of a pair is of group `these`, the second of group `those`. Pairs are in
    /// ascending order of the bodies. Two fixed bodies are a pair if the queries include
    /// [`fixed`](field@super::PairQueries::fixed). Overlaps have the distance 0; no depth is
    /// computed.
    ///
    /// # Errors
    /// Returns an error if no query is enabled between the groups, if a step is due, or if `d` is
    /// NaN, negative or beyond 1e37.
    pub fn pairs_within(&self, these: Group, those: Group, d: f64) -> Result<Vec<ClosestPair>, SceneError> {
        if !(0.0..=SCENE_REACH).contains(&d) {
            return Err(SceneError::Range { value: d });
        }
        let mut found = Vec::new();
        self.visit_pairs(these, those, d, |a, b| {
            found.extend(self.near_within(a, b, d));
            true
        })?;
        Ok(found)
    }

    /// Returns the first pair of two groups, in ascending order, that shares a point.
    ///
    /// The first body is of group `these`, the second of group `those`. The search ends at this
    /// pair. If both bodies are convex, the depth is computed.
    ///
    /// # Errors
    /// Returns an error if no query is enabled between the groups, or a step is due.
    #[doc(alias = "early exit")]
    pub fn any_contact(&self, these: Group, those: Group) -> Result<Option<ClosestPair>, SceneError> {
        let mut found = None;
        self.visit_pairs(these, those, 0.0, |a, b| {
            found = self.near_within(a, b, 0.0);
            found.is_none()
        })?;
        Ok(found.map(|near| {
            let outcome = self
                .query(near.a.index, near.b.index)
                .map(|mut q| q.measure(DepthMode::Full).outcome);
            ClosestPair {
                outcome: outcome.unwrap_or(near.outcome),
                ..near
            }
        }))
    }

    /// Returns the `count` bodies nearest to a body and at most `farthest` away.
    ///
    /// The nearest body comes first; ties are in ascending order. A body counts if any query is
    /// enabled between its group and the group of the given body. Overlaps have the distance 0; no
    /// depth is computed.
    ///
    /// # Errors
    /// Returns an error if the id is stale, if a step is due, if no query is enabled between the
    /// group of the body and any group, or if `farthest` is NaN or negative.
    #[doc(alias = "k-nearest")]
    pub fn nearest(&self, id: BodyId, count: usize, farthest: f64) -> Result<Vec<ClosestPair>, SceneError> {
        let i = self.bodies.index_of(id)?;
        if self.is_due() {
            return Err(SceneError::StepDue);
        }
        if let Some(group) = self.bodies.group(id.index).filter(|g| self.table.partners(*g) == 0) {
            return Err(SceneError::GroupNotEnabled { group });
        }
        if !(farthest >= 0.0) {
            return Err(SceneError::Range { value: farthest });
        }
        let around = self.box_around(i, 0.0);
        let mut asked = count.saturating_add(1);
        loop {
            asked = asked.saturating_mul(2);
            let boxes = self.broad.nearest(&around, asked, farthest)?;
            let others = boxes.iter().map(|n| self.bodies.body_of_proxy[n.body.index as usize]);
            let mut found: Vec<ClosestPair> = others
                .filter(|&other| self.may_pair(id.index, other))
                .filter_map(|other| self.near_within(id.index, other, farthest))
                .collect();
            sort(&mut found, |x, y| {
                x.outcome.distance.total_cmp(&y.outcome.distance).then(x.b.cmp(&y.b))
            });
            found.truncate(count);
            // Boxes that were not returned are no nearer than the last box, and bodies are no
            // nearer than their boxes.
            let covered = boxes.last().map_or(0.0, |n| n.distance * BOX_DISTANCE_DOWN);
            let settled = found.len() == count && found.last().is_none_or(|n| n.outcome.upper <= covered);
            if settled || boxes.len() < asked {
                return Ok(found);
            }
        }
    }

    /// Returns an error if the boxes of two groups are missing or do not belong to the current
    /// poses.
    pub(super) fn check_query(&self, these: Group, those: Group) -> Result<(), SceneError> {
        if self.is_due() {
            return Err(SceneError::StepDue);
        }
        if self.table.plan(group_pair_of(these, those)).detail == Detail::Nothing {
            return Err(SceneError::NotEnabled { these, those });
        }
        Ok(())
    }

    /// Visits pairs whose boxes are at most `d` apart, in ascending order, until `visit` returns
    /// false.
    fn visit_pairs(
        &self,
        these: Group,
        those: Group,
        d: f64,
        mut visit: impl FnMut(u32, u32) -> bool,
    ) -> Result<(), SceneError> {
        self.check_query(these, those)?;
        let mut near = Vec::new();
        let mut others: Vec<u32> = Vec::new();
        for id in self
            .bodies
            .ids()
            .filter(|id| self.bodies.group(id.index) == Some(these))
        {
            near.clear();
            self.broad
                .overlapping(&self.box_around(id.index as usize, d), &mut near)?;
            others.clear();
            others.extend(near.iter().map(|other| self.bodies.body_of_proxy[other.index as usize]));
            others.sort_unstable();
            for &other in &others {
                let twice = these == those && other < id.index;
                let asked = self.bodies.group(other) == Some(those) && self.may_pair(id.index, other);
                if asked && !twice && !visit(id.index, other) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    pub(super) fn box_around(&self, i: usize, d: f64) -> Aabb {
        let pose = &self.bodies.poses[i];
        match &self.bodies.solids[i] {
            Some(solid) => box_of(&solid.shape, pose, d, &mut BoxHint::default()),
            None => Aabb::from_center(pose.translation.vector.into(), nalgebra::Vector3::zeros()),
        }
    }

    pub(super) fn may_pair(&self, a: u32, b: u32) -> bool {
        let [x, y] = [a, b].each(|i| self.bodies.solids[i as usize].as_ref());
        let (Some(x), Some(y)) = (x, y) else { return false };
        let plan = self.table.plan(group_pair_of(x.group, y.group));
        let pairs = a != b && (plan.fixed || !(x.fixed && y.fixed)) && !self.excluded.contains(a, b);
        pairs && plan.detail > Detail::Nothing
    }

    /// Returns the pair if it is at most `d` apart.
    fn near_within(&self, a: u32, b: u32, d: f64) -> Option<ClosestPair> {
        let [x, y] = [a, b].each(|i| &self.bodies.balls[i as usize]);
        if least_distance(x, y) > d {
            return None;
        }
        let mut query = self.query(a, b)?;
        let answer = query.measure(DepthMode::None);
        query.decides_within(&answer, d).then(|| ClosestPair {
            a: self.bodies.id(a),
            b: self.bodies.id(b),
            outcome: answer.outcome,
            subshapes: answer.parts(),
        })
    }

    /// Returns a query of two bodies that starts with the state of the tracker of the step.
    pub(super) fn query(&self, a: u32, b: u32) -> Option<PairQuery<'_>> {
        let [i, j] = [a as usize, b as usize];
        let (x, y) = (
            &self.bodies.solids[i].as_ref()?.shape,
            &self.bodies.solids[j].as_ref()?.shape,
        );
        let pose = RelativePose::new(&self.bodies.poses[i], &self.bodies.poses[j]).ok()?;
        let pair = self.broad.pair(self.bodies.proxies[i], self.bodies.proxies[j]);
        let known = pair.and_then(|pair| self.pair_tables.started(pair.id.slot, [x, y], a < b));
        let shapes = [x.into(), y.into()];
        Some(PairQuery {
            engine: known.unwrap_or_else(|| Engine::new(shapes)),
            shapes,
            pose,
        })
    }
}

/// Two bodies and their engine.
pub(super) struct PairQuery<'a> {
    engine: Engine,
    shapes: [GeometryRef<'a>; 2],
    pose: RelativePose,
}

impl PairQuery<'_> {
    pub(super) fn measure(&mut self, until: DepthMode) -> PairOutcome {
        let question = QueryOptions::default().depth(until);
        self.engine.borrow(self.shapes).closest_with(&self.pose, &question)
    }

    fn decides_within(&mut self, outcome: &Outcome, d: f64) -> bool {
        self.engine.borrow(self.shapes).decides_within(&self.pose, outcome, d)
    }
}

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
    /// Returns the pair of two groups with the least signed distance, at any distance.
    ///
    /// The first body is of group `these`, the second of group `those`. The pair is the closest one
    /// or, if bodies overlap, the one with the deepest overlap; `None` if there is no pair. Every
    /// other pair is at least as far apart, up to the widths of the bounds of the two pairs. Of
    /// equally close pairs the first in ascending order is returned.
    ///
    /// Two fixed bodies are a pair if the queries include
    /// [`fixed`](field@super::PairQueries::fixed). Overlaps of meshes and compounds have the
    /// distance 0. Pairs of kinds that cannot be measured are skipped.
    ///
    /// Boxes and balls exclude most pairs, so the cost grows with the number of pairs that are
    /// about as close as the closest pair. [`boxes`](super::PairQueries::boxes) between the groups
    /// is enough for this call. Queries with a long range enlarge the boxes and make this search
    /// about 20 % slower. The search keeps no features between calls. If you need the closest pair
    /// in every cycle, see the [table](super#the-nearest-pair-of-a-robot-and-its-cell).
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::scene::{Body, PairQueries, Group, Scene};
    ///
    /// const CELL: Group = Group::new(1).unwrap();
    /// const ARM: Group = Group::new(2).unwrap();
    ///
    /// let mut scene = Scene::new();
    /// let boxes = PairQueries::none().boxes(true);
    /// scene.set_queries(ARM, CELL, boxes)?;
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
    /// Returns an error if no query is enabled between the groups, or a step is due.
    #[doc(alias = "clearance")]
    #[doc(alias = "minimum distance")]
    pub fn closest_pair(&self, these: Group, those: Group) -> Result<Option<ClosestPair>, SceneError> {
        self.check_query(these, those)?;
        Ok(self.search_closest(these, those)?.0)
    }

    /// Returns the closest pair and the number of pairs measured.
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
            if let Some(least) = least
                && search.may_be_closer(&candidates[least])
            {
                search.measure(candidates.swap_remove(least));
            }
            left.append(&mut candidates);
        }
        left.retain(|candidate| search.may_be_closer(candidate));
        sort(&mut left, by_bound);
        for candidate in left {
            if search.may_be_closer(&candidate) {
                search.measure(candidate);
            }
        }
        Ok((search.best, search.measured))
    }
}

fn by_bound(x: &Candidate, y: &Candidate) -> core::cmp::Ordering {
    x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2)))
}

impl ClosestSearch<'_> {
    /// Returns the least upper bound found so far.
    fn upper(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |near| near.outcome.upper)
    }

    /// Returns whether a pair may come before the best one: closer, or as close with lower indices.
    fn may_be_closer(&self, &(bound, a, b): &Candidate) -> bool {
        self.best.is_none_or(|best| {
            let upper = best.outcome.upper;
            bound < upper || bound == upper && (a, b) < (best.a.index, best.b.index)
        })
    }

    /// Returns the pairs of a body of the smaller group that may be as close as the closest pair
    /// found. `many` are the bodies of the larger group, in ascending order. Within one group only
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
        // Boxes that overlap give no bound.
        let shape = |k: u32| bodies.solids[k as usize].as_ref().map(|solid| &solid.shape);
        let has_depth = match (shape(i), shape(j)) {
            (Some(Geometry::HalfSpace(_)), _) | (_, Some(Geometry::HalfSpace(_))) => true,
            (Some(x), Some(y)) => is_convex(x) && is_convex(y),
            _ => true,
        };
        let pair = self
            .scene
            .broad
            .pair(bodies.proxies[i as usize], bodies.proxies[j as usize]);
        let overlaps = pair.and_then(|pair| self.scene.answer(&pair).overlaps);
        let bound = match overlaps {
            _ if boxes > 0.0 => balls.larger(boxes),
            // The step proved them apart.
            Some(false) => balls.larger(f64::MIN_POSITIVE),
            _ if has_depth => balls,
            // Overlaps of other bodies have the distance 0.
            _ => balls.larger(0.0),
        };
        let (a, b) = if self.is_first_smaller { (i, j) } else { (j, i) };
        (bound, a, b)
    }

    /// Measures a pair, and stores it if it is closer than the best pair.
    fn measure(&mut self, (_, a, b): Candidate) {
        self.measured += 1;
        let scene = self.scene;
        let Some(mut query) = scene.query(a, b) else {
            return;
        };
        let answer = query.measure(DepthMode::Full);
        let (outcome, subshapes) = (answer.outcome, answer.parts());
        let [a, b] = [a, b].each(|i| scene.bodies.id(i));
        let is_closer = |best: &ClosestPair| {
            let order = outcome.distance.total_cmp(&best.outcome.distance);
            order.then((a, b).cmp(&(best.a, best.b))).is_lt()
        };
        if self.best.as_ref().is_none_or(is_closer) {
            self.best = Some(ClosestPair {
                a,
                b,
                outcome,
                subshapes,
            });
        }
    }
}

fn is_convex(shape: &Geometry) -> bool {
    matches!(shape, Geometry::Polyhedron(_) | Geometry::Convex(_))
}

/// Returns a lower bound of the distance of the bodies in two boxes.
fn least_between(x: &StoredBox, y: &StoredBox) -> f64 {
    sqrt(x.distance_squared(y)) * BOX_DISTANCE_DOWN
}

impl Scene {
    /// Returns the first body that a ray hits within `length`, and the hit.
    ///
    /// The length may be infinite. If the ray enters several bodies equally early, the one with the
    /// lowest index is returned. Only bodies for which `may_hit` returns true count.
    ///
    /// Each body counts at its current pose, even if no query is enabled for it. The result for a
    /// body is that of [`RayCaster::cast`]. Bodies of groups without any query keep the box of the
    /// pose at which they were inserted; each of them that has moved since is tested by a ball, in
    /// about 10 ns.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
    /// use lin_canny::scene::{Body, Scene};
    /// use lin_canny::{Ray, RayCast, Shape};
    ///
    /// let mut scene = Scene::new();
    /// let ball = Shape::ball(0.5)?;
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// scene.insert(Body::moving(ball.clone()), at(3.0))?;
    /// let near = scene.insert(Body::moving(ball), at(1.5))?;
    /// scene.step();
    /// let ray = Ray::new(Point3::origin(), Vector3::x())?;
    /// let (body, found) = scene.cast_ray(&ray, 10.0, |_| true)?.expect("a body");
    /// let RayCast::Hit(hit) = found else { panic!("{found:?}") };
    /// assert!(body == near && (hit.hit - 1.0).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a step is due, or if the length or the ray is invalid.
    #[doc(alias = "raycast")]
    pub fn cast_ray(
        &self,
        ray: &Ray,
        length: f64,
        mut may_hit: impl FnMut(BodyId) -> bool,
    ) -> Result<Option<(BodyId, RayCast)>, SceneError> {
        if self.is_due() {
            return Err(SceneError::StepDue);
        }
        ray.flight(length)?;
        let mut met = Vec::new();
        self.broad.overlapping(&box_of_ray(ray, length), &mut met)?;
        let stale = &self.bodies.stale;
        let boxed = met.iter().map(|proxy| self.bodies.body_of_proxy[proxy.index as usize]);
        let boxed = boxed.filter(|k| stale.binary_search(k).is_err());
        let bodies = boxed.chain(stale.iter().copied());
        let mut candidates: Vec<(f64, u32)> = bodies
            .filter_map(|k| {
                let shape = &self.bodies.solids[k as usize].as_ref()?.shape;
                let (centre, radius) = shape.bounding_ball();
                let (centre, radius) = placed_ball(&centre, radius, &self.bodies.poses[k as usize]);
                let [from, _] = ray.within_ball(&centre, radius, length)?;
                Some((from, k))
            })
            .collect();
        sort(&mut candidates, |x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut caster = RayCaster::new();
        let mut first: Option<(f64, BodyId, RayCast)> = None;
        for (from, k) in candidates {
            // No later candidate can be hit earlier.
            if first.as_ref().is_some_and(|f| from > f.0) {
                break;
            }
            let id = self.bodies.id(k);
            let Some(solid) = self.bodies.solids[k as usize].as_ref().filter(|_| may_hit(id)) else {
                continue;
            };
            let found = caster.cast(&solid.shape, &self.bodies.poses[k as usize], ray, length)?;
            let Some(at) = found.safe() else { continue };
            let is_first = first.as_ref().is_none_or(|f| at < f.0 || at == f.0 && id < f.1);
            if is_first {
                first = Some((at, id, found));
            }
        }
        Ok(first.map(|(_, id, found)| (id, found)))
    }
}

/// Returns a box around a ray up to a length. If the ray or the length is not finite, the box is
/// invalid and rejected.
fn box_of_ray(ray: &Ray, length: f64) -> Aabb {
    let way = |d: f64| if d == 0.0 { 0.0 } else { d * length };
    let end = Point3::from(ray.origin.coords + ray.direction.map(way));
    let low = ray.origin.smaller(end);
    let high = ray.origin.larger(end);
    Aabb::new(low, high).grown(RAY * (ray.origin.coords.abs().sum() + length.at_most(1e37)))
}

impl BodyTable {
    /// Lists the bodies that are due but get no box because no query needs one. Removes from the
    /// list the bodies that were removed or get a box. `partners` are the groups to pair with by
    /// group, as bits.
    pub(super) fn list_stale(&mut self, partners: &[u32; GROUPS]) {
        let Self {
            slots,
            solids,
            due,
            stale,
            ..
        } = self;
        let is_without = |i: u32| {
            let solid = solids[i as usize].as_ref().filter(|_| slots.lives(i));
            solid.is_some_and(|s| s.boxed && partners[s.group.index()] == 0)
        };
        stale.retain(|&i| is_without(i));
        stale.extend(due.iter().copied().filter(|&i| is_without(i)));
        stale.sort_unstable();
        stale.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::{ConvexPolyhedron, solids};
    use crate::scene::{Body, PairQueries};
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

    /// Six links of an arm in a cell of 300 boxes, all within `room` metres: 1800 pairs.
    fn cell(numbers: &mut Numbers, room: f64) -> (Scene, [Group; 2]) {
        let groups = [1, 2].map(|g| Group::new(g).unwrap());
        let mut scene = Scene::new();
        let boxes = PairQueries::none().boxes(true);
        scene.set_queries(groups[0], groups[1], boxes).unwrap();
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
