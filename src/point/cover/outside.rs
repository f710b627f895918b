//! Balls whose union contains the body.
//!
//! 1. **Samples**: centres of cells inside the body, and points of the surface near other cells.
//! 2. **Clusters**: the cluster whose ball sticks out most is divided in two, again and again.
//! 3. **Rounds**: samples go to their nearest balls, and balls become small again.
//! 4. **Proof**: cells are halved, all of one size after the other, until each is empty or in a
//!    ball. A ball grows if the cell is small, if it needs little more, or if the budget of cells
//!    is spent. So the last cells are small.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::Point3;

use super::cells::{Body, BoxCell, DEPTH};
use super::clusters::{assigned, greatest, halves, halves_along, min_ball};
use super::{BALLS_MAX, Ball, BallCover, CoverError, CoverGoal, check_count};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::COVER;
use crate::pair_tracker::geometry::GeometryRef;

/// Least number of cells that yield samples, and cells for each ball.
const SAMPLES: usize = 4_000;
const SAMPLES_PER_BALL: usize = 48;

/// Rounds in which samples change clusters.
const ROUNDS: usize = 6;

/// A ball may grow by this fraction of the gap at once, and cells of this size are not halved.
const GROWTH: f64 = 1.0 / 64.0;

/// The same as a fraction of the size of the body, for balls that hardly stick out.
const LEAST_GROWTH: f64 = 1.0 / 512.0;

/// Balls are at last larger by this part of a step: they overlap where they meet, so that a point
/// that a user rounds is still in one of them.
const MARGIN: f64 = 1.0 / 16.0;

/// Cells that a proof visits before balls grow around cells of any size.
const CELLS: usize = 100_000;

pub(super) fn cover(geometry: GeometryRef<'_>, goal: CoverGoal) -> Result<BallCover, CoverError> {
    match goal {
        CoverGoal::Balls(count) => {
            check_count(count)?;
            let mut search = Search::new(geometry, SAMPLES.max(SAMPLES_PER_BALL * count))?;
            let one = search.one_ball(geometry);
            search.divide(count, 0.0);
            let found = search.proven();
            Ok(if one.gap <= found.gap { one } else { found })
        }
        CoverGoal::Gap(gap) => {
            // Written so that NaN is an error.
            if !(gap > 0.0 && gap < f64::INFINITY) {
                return Err(CoverError::Gap { gap });
            }
            reach(geometry, gap)
        }
    }
}

/// Returns a cover whose gap is at most `gap`: finer samples and more balls until it is.
fn reach(geometry: GeometryRef<'_>, gap: f64) -> Result<BallCover, CoverError> {
    let mut samples = SAMPLES;
    let mut search = Search::new(geometry, samples)?;
    let one = search.one_ball(geometry);
    if one.gap <= gap {
        return Ok(one);
    }
    // Balls that samples propose stick out a little less than those that are proven.
    let mut wanted = gap * (1.0 - 4.0 * GROWTH);
    loop {
        search.divide(BALLS_MAX, wanted);
        let count = search.clusters.len();
        if samples < SAMPLES_PER_BALL * count && samples < SAMPLES_PER_BALL * BALLS_MAX {
            samples = SAMPLES_PER_BALL * count.saturating_mul(2).min(BALLS_MAX);
            search = Search::new(geometry, samples)?;
            continue;
        }
        let found = search.proven();
        if found.gap <= gap {
            return Ok(found);
        }
        if found.balls.len() >= BALLS_MAX || wanted < 0.25 * gap {
            let (balls, reached) = (found.balls.len(), found.gap);
            return Err(CoverError::TooFine { gap, balls, reached });
        }
        wanted *= 0.8;
    }
}

/// The samples, and the clusters with their balls.
struct Search<'a> {
    body: Body<'a>,
    samples: Vec<Point3<f64>>,
    clusters: Vec<Cluster>,
}

#[derive(Clone)]
struct Cluster {
    samples: Vec<u32>,
    ball: Ball,
    /// How far the ball sticks out.
    excess: f64,
}

impl<'a> Search<'a> {
    fn new(geometry: GeometryRef<'a>, count: usize) -> Result<Self, CoverError> {
        let mut body = Body::new(geometry)?;
        let mut samples = Vec::new();
        for (cell, found) in body.cells(count, 12) {
            if found.upper <= 0.0 {
                samples.push(cell.center);
            }
            if found.distance.abs() <= body.radius(&cell) {
                samples.push(found.point);
            }
        }
        if samples.is_empty() {
            samples.push(body.root.center);
        }
        let all = (0..samples.len() as u32).collect();
        let mut search = Self {
            body,
            samples,
            clusters: vec![],
        };
        let whole = search.cluster(all);
        search.clusters.push(whole);
        Ok(search)
    }

    /// Returns the ball that bounds the geometry: exact for a ball.
    fn one_ball(&mut self, geometry: GeometryRef<'_>) -> BallCover {
        let (center, radius) = geometry.bounding_ball();
        let radius = radius * (1.0 + COVER) + self.body.slack;
        let balls = vec![Ball { center, radius }];
        let gap = greatest(balls.iter().map(|ball| self.body.excess(ball)));
        BallCover { balls, gap }
    }

    fn cluster(&mut self, samples: Vec<u32>) -> Cluster {
        let ball = min_ball(&self.samples, &samples);
        let excess = self.body.excess(&ball);
        Cluster { samples, ball, excess }
    }

    /// Divides clusters until there are `count`, or none sticks out by more than `gap`.
    ///
    /// Half a ball sticks out more than the ball. So more clusters are not always better, and the
    /// best ones of all stages are kept.
    fn divide(&mut self, count: usize, gap: f64) {
        let mut best = self.clusters.clone();
        while self.clusters.len() < count {
            let list = self.clusters.iter().enumerate();
            let can = list.filter(|(_, c)| c.excess > gap && c.samples.len() > 1);
            let worst = can.fold(
                (None, gap),
                |best, (k, c)| {
                    if c.excess > best.1 { (Some(k), c.excess) } else { best }
                },
            );
            let Some(worst) = worst.0 else { break };
            let Some(parts) = self.parts(worst) else { break };
            let [one, other] = parts.map(|part| self.cluster(part));
            self.clusters[worst] = one;
            self.clusters.push(other);
            if worst_of(&self.clusters) < worst_of(&best) {
                best.clone_from(&self.clusters);
            }
        }
        for _ in 0..ROUNDS {
            let balls: Vec<Ball> = self.clusters.iter().map(|c| c.ball).collect();
            let parts = assigned(&self.samples, &balls);
            let next: Vec<Cluster> = parts.into_iter().map(|part| self.cluster(part)).collect();
            if !(worst_of(&next) < worst_of(&self.clusters)) {
                break;
            }
            self.clusters = next;
        }
        if worst_of(&best) < worst_of(&self.clusters) {
            self.clusters = best;
        }
    }

    /// Returns the two parts of a cluster whose balls are smallest; `None` if all its samples are
    /// at one place.
    fn parts(&self, cluster: usize) -> Option<[Vec<u32>; 2]> {
        let (samples, chosen) = (&self.samples, &self.clusters[cluster].samples);
        let along = (0..3).map(|axis| halves_along(axis, samples, chosen));
        let mut best: Option<([Vec<u32>; 2], f64)> = None;
        for parts in along.chain([halves(samples, chosen)]) {
            let largest = greatest(parts.iter().map(|part| min_ball(samples, part).radius));
            let is_best = best.as_ref().is_none_or(|(_, least)| largest < *least);
            if is_best && !parts.iter().any(Vec::is_empty) {
                best = Some((parts, largest));
            }
        }
        best.map(|(parts, _)| parts)
    }

    /// Returns the balls of the clusters, grown until the cells prove that they contain the body.
    fn proven(&mut self) -> BallCover {
        let size = self.body.radius(&self.body.root);
        let step = (GROWTH * worst_of(&self.clusters)).larger(size * LEAST_GROWTH);
        let mut balls: Vec<Grown> = self.clusters.iter().map(|c| Grown::new(c, step)).collect();
        // All cells of a list have the same size. The second number is the ball tested first.
        let (mut open, mut visits) = (vec![(self.body.root, 0usize)], 0);
        for depth in 0.. {
            let mut next = Vec::new();
            for (cell, last) in open {
                let is_held = |k: &usize| self.body.holds(&balls[*k].ball, &cell);
                if is_held(&last) || (0..balls.len()).any(|k| is_held(&k)) {
                    continue;
                }
                visits += 1;
                let found = self.body.ask(&cell.center);
                if found.is_some_and(|found| self.body.is_empty(&cell, &found)) {
                    continue;
                }
                let must = visits > CELLS || depth >= DEPTH || self.body.radius(&cell) <= 0.5 * step;
                if !self.grow(&mut balls, &cell, must) {
                    let near = nearest(&balls, &cell);
                    next.extend(cell.halves().map(|half| (half, near)));
                }
            }
            if next.is_empty() {
                break;
            }
            open = next;
        }
        let wider = |Ball { center, radius }| Ball {
            center,
            radius: radius + step * MARGIN,
        };
        let balls: Vec<Ball> = balls.into_iter().map(|b| wider(b.ball)).collect();
        let gap = greatest(balls.iter().map(|ball| self.body.excess(ball)));
        BallCover { balls, gap }
    }

    /// Grows the ball that then contains a cell and sticks out least: within its limit, or by any
    /// length if it must. Returns whether a ball grows.
    fn grow(&self, balls: &mut [Grown], cell: &BoxCell, must: bool) -> bool {
        let mut best: Option<(usize, f64, f64)> = None;
        for (k, b) in balls.iter().enumerate() {
            let radius = sqrt(self.body.reach_squared(cell, &b.ball.center)) * (1.0 + COVER);
            let excess = radius + b.height;
            if (must || radius <= b.most) && best.is_none_or(|(_, _, least)| excess < least) {
                best = Some((k, radius, excess));
            }
        }
        let Some((k, radius, _)) = best else { return false };
        balls[k].ball.radius = balls[k].ball.radius.larger(radius);
        true
    }
}

/// A ball of a proof.
struct Grown {
    ball: Ball,
    /// Signed distance of the centre.
    height: f64,
    /// Radius up to which the ball grows around cells of any size.
    most: f64,
}

impl Grown {
    fn new(cluster: &Cluster, step: f64) -> Self {
        let ball = cluster.ball;
        Self {
            ball,
            height: cluster.excess - ball.radius,
            most: ball.radius + step,
        }
    }
}

/// Returns the largest excess of some clusters.
fn worst_of(clusters: &[Cluster]) -> f64 {
    greatest(clusters.iter().map(|c| c.excess))
}

/// Returns the ball whose surface is nearest to the centre of a cell, or in which it is deepest.
fn nearest(balls: &[Grown], cell: &BoxCell) -> usize {
    let power = |b: &Grown| (cell.center - b.ball.center).norm_squared() - b.ball.radius * b.ball.radius;
    let best = (0..balls.len()).fold((0, f64::INFINITY), |best, k| {
        let d = power(&balls[k]);
        if d < best.1 { (k, d) } else { best }
    });
    best.0
}
