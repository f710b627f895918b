//! Comparison of the scenes of a world after a step, with each other and with the exact state.

use super::{Keys, NONE, World};
use crate::forms::{self, Form};
use lin_canny::impact::Impact;
use lin_canny::scene::{BodyId, Change, PairImpact, PairQueries, PairResults, Scene};
use lin_canny::{ContactState, RelativePose};
use std::collections::BTreeSet;

/// Bodies of an impact, and the bits of its distance.
fn name(impact: &PairImpact) -> (BodyId, BodyId, u64) {
    (impact.a, impact.b, impact.distance.to_bits())
}

/// Instants of a tick at which impacts are tested.
const INSTANTS: u32 = 5;

impl<C: Fn(&Scene) -> Scene> World<C> {
    /// Compares the scenes with each other.
    pub(super) fn compare_scenes(&mut self) {
        let [main, plain, threads, saved] = &self.scenes[..] else {
            unreachable!("there are four scenes")
        };
        for other in [plain, threads, saved] {
            assert_eq!(main.events(), other.events());
        }
        assert_eq!(main.report().counts, threads.report().counts);
        assert!(main.pairs().eq(threads.pairs()) && main.impacts() == threads.impacts());
        let met = |scene: &Scene| -> BTreeSet<_> { scene.impacts().iter().map(name).collect() };
        assert_eq!(met(main), met(saved));
        // Trackers of compounds, meshes and surfaces start cold after reading.
        if self.kind < 2 {
            // Sorted lists are also rebuilt.
            let mut counts = saved.report().counts;
            counts.swaps = main.report().counts.swaps;
            assert_eq!(counts, main.report().counts);
            let differing = main.pairs().zip(saved.pairs()).find(|(x, y)| x != y);
            assert_eq!(differing, None);
            assert_eq!(main.impacts(), saved.impacts());
        }
        // A hit proven by one scene must not be missed by another.
        for (one, other) in [(main, plain), (plain, main)] {
            let hits = one.impacts().iter().filter(|i| matches!(i.impact, Impact::Hit { .. }));
            let all = met(other);
            hits.for_each(|i| assert!(all.contains(&name(i)), "{i:?} {all:?}"));
        }
    }

    /// Returns the pairs of bodies that are not both fixed, or whose queries include fixed bodies.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (BodyId, BodyId)> + '_ {
        let others = |a: BodyId| self.bodies.iter().map(move |b| (a, b)).filter(move |(a, b)| a < b.0);
        let pairs = self
            .bodies
            .iter()
            .flat_map(move |(a, (_, fixed))| others(*a).map(move |(a, b)| (a, b, *fixed)));
        pairs
            .filter(|(a, b, fixed)| !(*fixed && b.1.1) || self.enabled(*a, *b.0).fixed)
            .map(|(a, b, _)| (a, *b.0))
    }

    /// Returns the queries of the groups of two bodies.
    fn enabled(&self, a: BodyId, b: BodyId) -> PairQueries {
        let [g, h] = [a, b].map(|id| self.main().group(id).expect("the body lives"));
        self.main().queries(g, h)
    }

    /// Returns the queries of two bodies.
    pub(super) fn called(&self, a: BodyId, b: BodyId) -> PairQueries {
        if self.main().is_excluded(a, b) {
            return NONE;
        }
        self.enabled(a, b)
    }

    /// Counts the pairs of fixed bodies that the step left out.
    pub(super) fn judge_left_out(&mut self) {
        let fixed: Vec<BodyId> = self.bodies.iter().filter(|b| b.1.1).map(|b| *b.0).collect();
        let pairs = (0..fixed.len()).flat_map(|k| (0..k).map(move |l| (k, l)));
        let is_left_out = |&(k, l): &(usize, usize)| {
            let queries = self.called(fixed[k], fixed[l]);
            queries != NONE && !queries.fixed
        };
        let left_out = pairs.filter(is_left_out).count() as u64;
        for scene in &self.scenes {
            assert_eq!(scene.report().counts.fixed_left_out, left_out);
        }
        self.mix.fixed[0] += left_out;
    }

    fn forms_of(&self, a: BodyId, b: BodyId) -> [&Form; 2] {
        [a, b].map(|id| &self.forms[self.bodies[&id].0].1)
    }

    fn between(&self, a: BodyId, b: BodyId) -> RelativePose {
        let [p, q] = [a, b].map(|id| self.main().pose(id).expect("the body lives"));
        RelativePose::new(p, q).expect("poses of a scene")
    }

    /// Compares the results of a pair with the exact state.
    pub(super) fn judge(&mut self, a: BodyId, b: BodyId, now: &mut [Keys; 2]) {
        let found = self.main().pair(a, b);
        let queries = self.called(a, b);
        let (pose, [x, y]) = (self.between(a, b), self.forms_of(a, b));
        let at_most = |d: f64| {
            if d == f64::INFINITY {
                Some(true)
            } else {
                forms::within(x, y, &pose, d)
            }
        };
        let mut is_said = |said: Option<bool>, d: Option<f64>, keys: usize| {
            let Some(d) = d else { return };
            let said = said == Some(true);
            assert!(
                at_most(d).is_none_or(|truth| truth == said),
                "{a} {b}: within {d} is said to be {said}"
            );
            if said {
                now[keys].insert((a, b));
            }
        };
        is_said(found.and_then(|p| p.overlaps), queries.overlap.then_some(0.0), 0);
        is_said(found.and_then(|p| p.within), queries.within, 1);
        let distance = found.and_then(|p| p.distance);
        let is_measured = range(&queries).map_or(Some(false), at_most);
        assert!(
            is_measured.is_none_or(|truth| truth == distance.is_some()),
            "{a} {b}: {queries:?} {distance:?}"
        );
        let whole = queries.features || queries.manifold.is_some();
        assert_eq!(found.and_then(|p| p.outcome).is_some(), distance.is_some() && whole);
        let near = queries.manifold.map_or(Some(false), |m| at_most(m.prediction));
        let has_contacts = |p: &PairResults<'_>| p.manifold.is_some() || p.contacts.is_some();
        let has_contacts = found.as_ref().is_some_and(has_contacts);
        assert!(
            near.is_none_or(|truth| truth == has_contacts),
            "{a} {b}: contacts {has_contacts}"
        );
        let Some(d) = distance else { return };
        let is_deep = queries.depth || queries.local_depth || queries.manifold.is_some();
        if d.state != ContactState::Overlapping || is_deep && x.is_convex() && y.is_convex() {
            let truth = forms::distance(x, y, &pose);
            let tie = forms::TIE;
            assert!(d.lower <= truth.upper + tie, "{d:?} {truth:?}");
            assert!(truth.lower <= d.upper + tie, "{d:?} {truth:?}");
        }
        self.mix.distances[0] += 1;
        self.mix.distances[1] += u64::from(d.state == ContactState::Overlapping);
    }

    /// Compares the events of the step with the changes since the last step.
    pub(super) fn judge_events(&mut self, now: &[Keys; 2]) {
        let events = self.main().events();
        assert!(events.is_sorted_by_key(|e| (e.a.index, e.b.index, e.change)));
        let of = |change: Change| -> Keys {
            let those = events.iter().filter(|e| e.change == change);
            those.map(|e| (e.a, e.b)).collect()
        };
        let is_overlap = |e: &PairQueries| e.overlap;
        let is_within = |e: &PairQueries| e.within.is_some();
        let [overlaps, withins] = [
            (of(Change::OverlapBegan), of(Change::OverlapEnded)),
            (of(Change::CameWithin), of(Change::LeftWithin)),
        ];
        self.judge_changes((&self.overlapping, &now[0]), &overlaps, is_overlap);
        self.judge_changes((&self.within, &now[1]), &withins, is_within);
        let boxes: Keys = self.main().pairs().map(|p| (p.a, p.b)).collect();
        let boxes: Keys = boxes.into_iter().filter(|(a, b)| self.called(*a, *b).boxes).collect();
        assert_eq!(of(Change::BoxesMet), boxes.difference(&self.boxes).copied().collect());
        let sum = overlaps.0.len() + overlaps.1.len() + withins.0.len() + withins.1.len();
        self.boxes = boxes;
        self.mix.events += sum as u64;
    }

    fn judge_changes(
        &self,
        (before, now): (&Keys, &Keys),
        (began, ended): &(Keys, Keys),
        active: fn(&PairQueries) -> bool,
    ) {
        assert_eq!(*began, now.difference(before).copied().collect());
        // A pair whose query is no longer enabled may be dropped without an event.
        let may: Keys = before.difference(now).copied().collect();
        let is_called = |(a, b): &(BodyId, BodyId)| {
            let groups = self.main().group(*a).zip(self.main().group(*b));
            groups.is_some_and(|(g, h)| active(&self.main().queries(g, h)))
        };
        let must: Keys = may.iter().copied().filter(is_called).collect();
        assert!(must.is_subset(ended), "{must:?} {ended:?} {may:?}");
        assert!(ended.is_subset(&may), "{must:?} {ended:?} {may:?}");
    }

    /// Compares the impacts of the step with samples of the motions of its tick: those of the bodies
    /// and distances that are called.
    pub(super) fn judge_impacts(&mut self, called: &[(BodyId, BodyId, f64)]) {
        let impacts = self.main().impacts();
        let with_distance = impacts.iter().filter(|i| i.distance > 0.0).count() as u64;
        let all = impacts.len() as u64;
        let impacts: BTreeSet<_> = impacts.iter().map(name).collect();
        self.mix.impacts[0] += all - with_distance;
        self.mix.impacts[1] += with_distance;
        let Some((length, motions)) = self.motions.take() else {
            return assert!(self.has_tick || impacts.is_empty());
        };
        for &(a, b, d) in called {
            let (Some((p, v)), Some((q, w))) = (motions.get(&a), motions.get(&b)) else {
                continue;
            };
            let [x, y] = self.forms_of(a, b);
            let is_slow = v.angular.norm() < 1e6 && w.angular.norm() < 1e6;
            if !x.is_convex() || !y.is_convex() || !is_slow {
                continue;
            }
            let at = |k: u32| length * f64::from(k) / f64::from(INSTANTS);
            let meets = |k: u32| {
                let pose = RelativePose::new(&v.applied(p, at(k)), &w.applied(q, at(k)));
                forms::within(x, y, &pose.expect("poses of a tick"), d)
            };
            let is_hit = meets(0) == Some(false) && (1..=INSTANTS).any(|k| meets(k) == Some(true));
            let is_found = impacts.contains(&(a, b, d.to_bits()));
            assert!(!is_hit || is_found, "{a} and {b} pass each other within {d}");
            assert!(
                meets(0) != Some(true) || !is_found,
                "{a} and {b} were not farther apart than {d}"
            );
        }
    }
}

/// Returns the largest distance for which a distance is computed; `None` if none is computed.
fn range(queries: &PairQueries) -> Option<f64> {
    let is_measured = queries.distance.is_some() || queries.depth || queries.local_depth || queries.features;
    let own = is_measured.then(|| queries.distance.or(queries.within).unwrap_or(0.0));
    let prediction = queries.manifold.map(|m| m.prediction);
    own.into_iter().chain(prediction).reduce(f64::max)
}
