//! Consistency of the tables of a scene with each other. Tests and fuzzing check it after each
//! call, and every scene that is read from a file is checked.

use alloc::format;
use alloc::string::String;

use super::Scene;
use super::body::{BodyTable, checked};
use super::pair_table::{PairFlags, PairHeader};
use super::queries::Census;
use super::queries::{Detail, GROUPS, NEVER, PairPlan, Table, group_pair_of};
use super::step::{bodies_of, group};
use crate::base::motion::Velocity;
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::BoxHint;
use crate::broad::{self, Aabb, StoredBox, SweepAndPrune};
use crate::scene::lookahead::TICKS;

impl Scene {
    /// Returns the first contradiction among the tables of the scene: bodies and odometers, motions
    /// and ticks, boxes, queries, pairs and their wake-ups. This is a tool for tests and fuzzing,
    /// between any two calls. It reads everything, so it costs far more than a step.
    ///
    /// # Errors
    /// Returns a text that names the contradiction, which is always a defect of the crate,
    /// regardless of the calls made.
    pub fn check(&self) -> Result<(), String> {
        self.broad.check()?;
        self.check_tables()
    }

    /// Checks everything that the broad phase does not check itself.
    pub(super) fn check_tables(&self) -> Result<(), String> {
        check_bodies(&self.bodies)?;
        check_motions(&self.bodies)?;
        check_sweeps(&self.bodies)?;
        check_proxies(&self.bodies, &self.broad)?;
        self.check_boxes()?;
        self.check_groups()?;
        if census_of(&self.bodies, &self.table)? != self.census {
            return Err("the bodies of the scene are miscounted".into());
        }
        let is_excluded =
            |(a, b)| self.bodies.slots.lives(a) && self.bodies.slots.lives(b) && self.excluded.contains(b, a);
        if !self.excluded.iter().all(is_excluded) {
            return Err("a pair that the scene excludes is not of two bodies".into());
        }
        self.check_pairs()
    }

    /// Checks that every body is in its box, unless the box must be computed again or no query
    /// needs it.
    fn check_boxes(&self) -> Result<(), String> {
        let bodies = &self.bodies;
        if !bodies.stale.is_sorted_by(|a, b| a < b) {
            return Err("a list of the scene names a body twice".into());
        }
        for (i, solid) in bodies.solids.iter().enumerate() {
            let Some(solid) = solid.as_ref().filter(|_| bodies.lives(i)) else {
                continue;
            };
            let is_late = bodies.travels[i].is_due(bodies.step) || bodies.stale.binary_search(&(i as u32)).is_ok();
            let Some(stored) = self.broad.stored_box(bodies.proxies[i]).filter(|_| !is_late) else {
                continue;
            };
            // If several points are extreme, another one may have been chosen.
            let ball = &bodies.balls[i];
            let rounding = 16.0 * UNIT * (ball.centre.abs().sum() + ball.radius);
            let (low, high) = solid.shape.aabb_at(&bodies.poses[i], &mut BoxHint::default());
            let is_in = (0..3).all(|k| {
                let (mut below, mut above) = (Aabb::new(low, high), Aabb::new(low, high));
                below.max[k] = low[k] + rounding;
                above.min[k] = high[k] - rounding;
                let outward = |side: &Aabb| StoredBox::outward(side, &self.settings.origin);
                stored.overlaps(&outward(&below)) && stored.overlaps(&outward(&above))
            });
            if !is_in {
                return Err(format!("body {i} of the scene is not in its box"));
            }
        }
        Ok(())
    }

    /// Checks the boxes of groups whose queries no call has changed since the last step.
    fn check_groups(&self) -> Result<(), String> {
        let is_planned = |g: usize| self.replanned & 1 << g != 0;
        for g in (0..GROUPS).filter(|&g| !is_planned(g)) {
            let group = group(g);
            if self.growths[g] != self.table.growth(group) || self.partners[g] != self.table.partners(group) {
                return Err("the boxes of a group of the scene are not what its queries need".into());
            }
        }
        for solid in self.bodies.solids.iter().flatten() {
            let g = solid.group.index();
            if !is_planned(g) && solid.boxed != (self.growths[g] < f64::INFINITY) {
                return Err("a body of the scene has a box where it should have none, or none where it should".into());
            }
        }
        Ok(())
    }

    /// Checks that every row contains a pair of the broad phase, and that every pair has the row
    /// that its queries need.
    fn check_pairs(&self) -> Result<(), String> {
        if !self.pair_tables.is_consistent() {
            return Err("a seat of the scene is not where its pair looks for it".into());
        }
        for header in self.pair_tables.headers() {
            let pair = self.broad.pair_of(header.pair);
            if pair.map(|pair| bodies_of(&self.bodies, &pair)) != Some([header.a, header.b]) || header.a == header.b {
                return Err("a seat of the scene is taken by no pair".into());
            }
            if usize::from(header.groups) >= GROUPS * GROUPS || !self.may_sleep(header) {
                return Err(format!("{} sleeps, or has a group, as no pair does", header.pair));
            }
        }
        for pair in self.broad.pairs().filter(|_| self.replanned == 0) {
            let [a, b] = bodies_of(&self.bodies, &pair);
            let (Some(g), Some(h)) = (self.bodies.group(a), self.bodies.group(b)) else {
                return Err(format!("{} is of a body that is gone", pair.id));
            };
            let groups = group_pair_of(g, h);
            let plan = self.table.plan(groups);
            let table = || plan.detail as u32 - Detail::Predicates as u32;
            let detail = (plan.detail > Detail::Boxes).then(table);
            if self.pair_tables.place(pair.id.slot) != (detail, plan.boxes) {
                return Err(format!("{} is in another table than its queries need", pair.id));
            }
            let header = self.pair_tables.get(pair.id.slot).map(|seen| *seen.header);
            if header.is_some_and(|header| header.groups != groups || !is_called(&header.state, plan)) {
                return Err(format!("{} has an answer that is not enabled", pair.id));
            }
        }
        Ok(())
    }

    /// Returns whether the time or the displacement until a pair is tested again is one that a test
    /// may give.
    fn may_sleep(&self, header: &PairHeader) -> bool {
        let PairFlags {
            known,
            overlaps,
            within,
            measured,
            sleeps,
        } = header.state;
        if !sleeps {
            return header.wake >= 0.0 && header.wake < f64::INFINITY;
        }
        // A disturbance of a body without a row of motions would be lost.
        known
            && !(overlaps || within || measured)
            && self.bodies.moving.len() == self.bodies.poses.len()
            && (0.0..=self.bodies.ticks.later(TICKS + 1)).contains(&header.wake)
    }
}

/// Returns whether a pair has results of enabled queries only.
fn is_called(state: &PairFlags, plan: &PairPlan) -> bool {
    (plan.overlap || !state.overlaps)
        && (plan.within != NEVER || !state.within)
        && (plan.range != NEVER || !state.measured)
}

/// Counts the bodies, and returns an error if bodies cannot answer the queries of their groups.
pub(super) fn census_of(bodies: &BodyTable, table: &Table) -> Result<Census, String> {
    let mut census = Census::default();
    let living = bodies.solids.iter().enumerate().filter(|(i, _)| bodies.lives(*i));
    for solid in living.filter_map(|(_, solid)| solid.as_ref()) {
        census
            .check_body(solid.member(), |other| table.queries(solid.group, other))
            .map_err(|e| format!("{e}"))?;
        census.add(solid.member());
    }
    Ok(census)
}

/// Checks geometries, poses, balls, odometers and the list of boxes to compute again.
fn check_bodies(bodies: &BodyTable) -> Result<(), String> {
    let n = bodies.slots.index_count();
    let rows = [
        bodies.solids.len(),
        bodies.poses.len(),
        bodies.balls.len(),
        bodies.travels.len(),
        bodies.hints.len(),
        bodies.proxies.len(),
    ];
    if !bodies.slots.is_consistent() || rows != [n; 6] {
        return Err("the lists of removed bodies contradict the scene".into());
    }
    let mut due = 0;
    for i in 0..n {
        let (solid, travel) = (&bodies.solids[i], &bodies.travels[i]);
        if bodies.lives(i) && solid.is_none() {
            return Err("a body of the scene has no shape".into());
        }
        checked(&bodies.poses[i], None).map_err(|e| format!("{e}"))?;
        if solid
            .as_ref()
            .is_some_and(|s| s.ball.at(&bodies.poses[i]) != bodies.balls[i])
        {
            return Err(format!("body {i} of the scene is not in its ball"));
        }
        // Above this value an odometer would no longer grow.
        if !(travel.odometer >= 0.0 && travel.odometer < f64::MAX) {
            return Err("an odometer of the scene is no number".into());
        }
        due += usize::from(travel.is_due(bodies.step));
    }
    let is_due = |i: &u32| bodies.travels.get(*i as usize).is_some_and(|t| t.is_due(bodies.step));
    if due != bodies.due.len() || !bodies.due.iter().all(is_due) {
        return Err("a list of the scene names a body that is not there".into());
    }
    Ok(())
}

fn is_finite(v: &Velocity) -> bool {
    v.linear.iter().chain(v.angular.iter()).all(|x| x.is_finite())
}

/// Checks velocities and ticks.
fn check_motions(bodies: &BodyTable) -> Result<(), String> {
    let ticks = &bodies.ticks;
    if !bodies.moving.iter().all(|m| is_finite(&m.velocity)) || !ticks.length.is_finite() {
        return Err("a velocity of the scene is not finite".into());
    }
    let may_move = |i: usize| bodies.lives(i) && bodies.solids[i].as_ref().is_some_and(|s| !s.fixed);
    let rest = Velocity::default();
    let is_sound = bodies.moving.is_empty() || bodies.moving.len() == bodies.poses.len();
    if !is_sound
        || !bodies
            .moving
            .iter()
            .enumerate()
            .all(|(i, m)| m.velocity == rest || may_move(i))
    {
        return Err("a velocity of the scene is that of no moving body".into());
    }
    if !ticks.is_pending && (ticks.is_swept || !bodies.swept.is_empty()) {
        return Err("a sweep of the scene belongs to no tick".into());
    }
    Ok(())
}

/// Checks the swept motions of the step being prepared, and the list of the boxes that contain the
/// last ones.
fn check_sweeps(bodies: &BodyTable) -> Result<(), String> {
    let n = bodies.poses.len();
    let mut is_listed = alloc::vec![false; n];
    for &i in &bodies.swept {
        let is_twice = is_listed
            .get_mut(i as usize)
            .is_none_or(|l| core::mem::replace(l, true));
        // A body that was removed has lost its sweep.
        if is_twice || bodies.lives(i as usize) && bodies.sweeps.get(i as usize).is_none_or(Option::is_none) {
            return Err("a sweep of the scene is not there, or is there twice".into());
        }
    }
    let sweeps = bodies
        .sweeps
        .iter()
        .enumerate()
        .filter_map(|(i, sweep)| Some((i, (*sweep)?)));
    for (i, sweep) in sweeps {
        checked(&sweep.from, None).map_err(|e| format!("{e}"))?;
        if !is_finite(&sweep.velocity) || !is_listed.get(i).is_some_and(|listed| *listed) {
            return Err("a sweep of the scene is not finite, or not listed".into());
        }
    }
    if !bodies.wide.iter().all(|i| (*i as usize) < n) {
        return Err("a list of the scene names a body that is not there".into());
    }
    Ok(())
}

/// Checks that every body has a proxy in the broad phase, and every proxy a body.
fn check_proxies(bodies: &BodyTable, broad: &SweepAndPrune) -> Result<(), String> {
    let n = bodies.slots.index_count();
    let is_kept = |i: usize| broad.contains(bodies.proxies[i]);
    let is_linked = |i: usize| bodies.body_of_proxy.get(bodies.proxies[i].index as usize) == Some(&(i as u32));
    if !(0..n).all(|i| !bodies.lives(i) || is_kept(i) && is_linked(i)) {
        return Err("a body of the scene has no place in its broad phase".into());
    }
    let has_body = |id: broad::BodyId| {
        bodies
            .body_of_proxy
            .get(id.index as usize)
            .is_some_and(|o| (*o as usize) < n)
    };
    if !broad.bodies().all(has_body) {
        return Err("a box of the scene belongs to no body".into());
    }
    if !broad.pairs().all(|p| has_body(p.a) && has_body(p.b)) {
        return Err("a pair of the scene has no bodies".into());
    }
    Ok(())
}
