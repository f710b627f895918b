//! Distance of a mesh from itself: pairs of triangles that share no vertex.

use alloc::vec::Vec;
use nalgebra::Vector3;

use super::Mesh;
use super::tracker::MeshTracker;
use super::tracker::{TriangleJudge, spots};
use crate::base::num::Counter;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::RelativePose;
use crate::convex::tracker::Tracker;
use crate::nonconvex::front::FrontFault;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::front::self_front::{ItemVertices, SelfFront};
use crate::nonconvex::query::frame::TreeFrame;
use crate::nonconvex::query::overlap::Touching;
use crate::nonconvex::query::search::{Judge, Measured, MeshGoal, TreeSearch};
use crate::nonconvex::query::state::{PosedTrees, TreeAnswer};
use crate::nonconvex::query::triangle::TriangleSpot;
use crate::pair::location::PairOutcome;

/// The state of queries of a mesh against itself.
#[derive(Clone, Debug, Default)]
pub(super) struct SelfState {
    pub(super) front: SelfFront,
    fingerprint: Fingerprint,
    /// The pairs of triangles that were closest in the last query.
    last: [Option<NodePair>; 2],
}

/// Tests each pair of triangles that share no vertex once.
struct SelfJudge<'a> {
    mesh: &'a Mesh,
    pairs: TriangleJudge<'a>,
}

impl Judge for SelfJudge<'_> {
    type Features = [TriangleSpot; 2];

    const IS_SELF: bool = true;

    fn is_asked(&self, [i, j]: NodePair) -> bool {
        let (p, q) = (self.mesh.triangles[i as usize], self.mesh.triangles[j as usize]);
        i < j && p.iter().all(|v| q[0] != *v && q[1] != *v && q[2] != *v)
    }

    #[inline(always)]
    fn highest_in_a(&self, item: u32, n: &Vector3<f64>) -> f64 {
        self.pairs.highest_in_a(item, n)
    }

    #[inline(always)]
    fn lowest_in_b(&self, item: u32, n: &Vector3<f64>) -> f64 {
        self.pairs.lowest_in_b(item, n)
    }

    fn settled(&self) -> u64 {
        self.pairs.settled()
    }

    fn shares_inside(&self, _: &Touching, _: &Measured<Self::Features>) -> (bool, u64) {
        (false, 0)
    }

    fn measure(&mut self, frame: &TreeFrame, pair: NodePair, known: f64) -> Measured<Self::Features> {
        self.pairs.measure(frame, pair, known)
    }
}

impl SelfState {
    /// Drops the state of another mesh and takes the current vertices.
    fn recognise(&mut self, mesh: &Mesh) {
        if self.fingerprint == mesh.fingerprint {
            return;
        }
        if mesh.came_from(self.fingerprint) {
            self.front.follow(&mesh.tree, mesh.in_items());
        } else {
            self.front.clear();
            self.last = [None; 2];
        }
        self.fingerprint = mesh.fingerprint;
    }

    /// Checks the front against all pairs of triangles if it belongs to this mesh.
    pub(super) fn audit(&self, mesh: &Mesh) -> Result<(), FrontFault> {
        let pose = RelativePose::identity();
        let Some(posed) = PosedTrees::new(mesh, mesh, &pose).filter(|_| self.fingerprint == mesh.fingerprint) else {
            return Ok(());
        };
        let pairs = TriangleJudge::new(&posed, None);
        let judge = SelfJudge { mesh, pairs };
        // The check uses the query for polyhedra, because the claims come from closed formulas for
        // triangles.
        let polygons: Vec<_> = (0..mesh.triangles.len() as u32).map(|t| mesh.polygon(t)).collect();
        let apart = |[x, y]: NodePair| {
            let (p, q) = (polygons[x as usize].as_ref()?, polygons[y as usize].as_ref()?);
            Some(Tracker::new().closest(p, q, &pose).upper.at_least(0.0) / mesh.unit())
        };
        self.front.audit(mesh.tree.unit(), posed.frame.error, |pair| {
            let [of_a, of_b] = pair.each(|node| mesh.tree.range(node));
            let all = of_a.flat_map(|x| of_b.clone().map(move |y| [x, y]));
            let asked = all.filter(|p| judge.is_asked(*p));
            asked.filter_map(apart).fold(f64::INFINITY, f64::smaller)
        })
    }

    /// Searches the mesh from its front.
    fn search(&mut self, search: &mut TreeSearch<SelfJudge>) {
        let mesh = search.judge.mesh;
        self.recognise(mesh);
        if !matches!(search.goal, MeshGoal::All(_)) {
            for pair in self.last.into_iter().flatten() {
                search.measure(pair);
            }
            if search.goal == MeshGoal::Least && search.best.is_none() {
                search.seed();
            }
        }
        self.front.search(search, mesh.in_items());
        if let Some(best) = &search.best
            && self.last[0] != Some(best.pair)
        {
            self.last = [Some(best.pair), self.last[0]];
        }
    }
}

impl Mesh {
    fn in_items(&self) -> ItemVertices<'_> {
        ItemVertices {
            points: &self.points,
            items: &self.triangles,
        }
    }
}

/// Returns the outcome of a pair of triangles with a lower bound over all pairs, in the caller's
/// unit.
fn outcome_of(mesh: &Mesh, frame: &TreeFrame, m: &Measured<[TriangleSpot; 2]>, lower: f64) -> PairOutcome {
    let answer = TreeAnswer::of_one_body(m, lower, mesh.frame, frame);
    answer.on(spots(mesh, mesh, m.pair, m.features))
}

impl MeshTracker {
    /// Runs a query of a mesh against itself.
    ///
    /// Returns `None` if squares of the mesh's lengths overflow or underflow; no such mesh can be
    /// built.
    fn ask_self<R>(
        &mut self,
        mesh: &Mesh,
        goal: MeshGoal,
        within: Option<f64>,
        tell: impl FnOnce(&TreeSearch<SelfJudge>) -> R,
    ) -> Option<R> {
        let state = &mut self.state;
        state.kept.work.queries.count(1);
        let pose = RelativePose::identity();
        let posed = PosedTrees::new(mesh, mesh, &pose)?;
        let pairs = TriangleJudge::new(&posed, within);
        let mut search = TreeSearch::new([&mesh.tree; 2], &posed.frame, SelfJudge { mesh, pairs }, goal);
        search.ends_in_contact = true;
        self.own.get_or_insert_default().search(&mut search);
        state.kept.work += search.work;
        state.kept.work.settled.count(search.judge.settled());
        Some(tell(&search))
    }

    /// Returns the closest two triangles that share no vertex.
    ///
    /// Returns `None` if all pairs share a vertex.
    pub(crate) fn self_closest(&mut self, mesh: &Mesh) -> Option<PairOutcome> {
        self.ask_self(mesh, MeshGoal::Least, None, |search| {
            let best = search.best.as_ref()?;
            let lower = search.proven().at_least(0.0);
            Some(outcome_of(mesh, search.frame, best, lower))
        })?
    }

    /// Returns whether two triangles that share no vertex are at most `d` apart.
    pub(crate) fn self_within(&mut self, mesh: &Mesh, d: f64) -> bool {
        let goal = MeshGoal::Within(d / mesh.unit());
        d >= 0.0 && self.ask_self(mesh, goal, Some(d), |search| search.is_over()) == Some(true)
    }

    /// Returns all pairs of triangles that share no vertex and are at most `d` apart.
    pub(crate) fn self_pairs(&mut self, mesh: &Mesh, d: f64) -> Vec<PairOutcome> {
        if !(d >= 0.0) {
            return Vec::new();
        }
        let goal = MeshGoal::All(d / mesh.unit());
        let found = self.ask_self(mesh, goal, Some(d), |search| {
            let each = |m: &Measured<_>| outcome_of(mesh, search.frame, m, m.lower);
            search.found.iter().map(each).collect()
        });
        found.unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use nalgebra::Point3;
    use std::vec::Vec;

    use super::*;
    use crate::rng::Rng;

    /// Vertices move away and return, together with those of near nodes or independently.
    #[test]
    fn fronts_hold_what_they_claim() {
        let n = 14;
        let at = |k: u32| f64::from(k) / f64::from(n) - 0.5;
        let rest: Vec<_> = (0..=n).flat_map(|i| (0..=n).map(move |j| [at(i), at(j)])).collect();
        let number = |i: u32, j: u32| i * (n + 1) + j;
        let square = |i: u32, j: u32| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let triangles: Vec<_> = (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect();
        let flat: Vec<_> = rest.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect();
        let mut mesh = Mesh::new(&flat, &triangles).unwrap();
        let mut tracker = MeshTracker::default();
        let mut rng = Rng::new(23);
        let mut claims = 0;
        for frame in 0..60 {
            let (size, own) = (0.01 * f64::from(frame % 4), if frame % 3 == 0 { 0.001 } else { 0.0 });
            let mut place = |p: &[f64; 2]| {
                let z = size * (5.0 * p[0] + 2.0 * p[1]).sin() + rng.range(-own, own);
                Point3::new(p[0] * (1.0 + 0.5 * size), p[1], z)
            };
            let now: Vec<_> = rest.iter().map(&mut place).collect();
            mesh.set_vertices(&now).unwrap();
            match frame % 2 {
                0 => assert!(tracker.self_closest(&mesh).is_some()),
                _ => drop(tracker.self_pairs(&mesh, 0.03)),
            }
            tracker.own.as_ref().unwrap().audit(&mesh).unwrap();
            claims += tracker.front_len();
        }
        let work = tracker.work();
        assert!(
            claims > 10_000 && work.cuts < 50 && work.failed > 1000,
            "{claims} {work:?}"
        );
    }
}
