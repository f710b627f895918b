//! Balls that lie inside the body.
//!
//! 1. **Samples**: points inside the body, from cells that may meet it.
//! 2. **Candidates**: each sample moves away from its closest point of the surface as long as its
//!    ball grows by nearly as much: then it contains nearly all of the ball before.
//! 3. **Choice**: the largest candidate, moved to where it is larger, then again and again the one
//!    that contains most samples that no ball contains yet.
//! 4. **Gap**: cells are halved until each is empty, near a ball, or so small that it does not
//!    matter.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::cells::{Body, BoxCell, DEPTH};
use super::{Ball, BallCover, CoverError, check_count};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::COVER;
use crate::pair_tracker::geometry::GeometryRef;

/// Least number of cells that yield samples, and cells for each ball.
const SAMPLES: usize = 3_000;
const SAMPLES_PER_BALL: usize = 48;

/// Samples inside below which points near the surface are searched for some.
const FEW: usize = 200;

/// Halvings of the depth at which a point inside is searched below the surface.
const HALVINGS: u32 = 40;

/// Halvings of the step by which a candidate moves, down to this part of its radius.
const STEPS: u32 = 8;

/// Rounds in which the largest ball moves.
const ROUNDS: u32 = 24;

/// Cells that the bound of the gap visits, and its width as a part of the size.
const CELLS: usize = 100_000;
const WIDTH: f64 = 1.0 / 256.0;

pub(super) fn cover(geometry: GeometryRef<'_>, count: usize) -> Result<BallCover, CoverError> {
    check_count(count)?;
    let mut body = Body::new(geometry)?;
    let mut candidates = candidates(&mut body, SAMPLES.max(SAMPLES_PER_BALL * count));
    let larger = |a: Ball, b: Ball| if b.radius > a.radius { b } else { a };
    let Some(largest) = candidates.iter().map(|c| c.ball).reduce(larger) else {
        return Err(CoverError::NoInside { kind: body.kind });
    };
    let ball = body.widest(largest);
    let sample = ball.center;
    candidates.push(Candidate { sample, ball });
    let balls = chosen(&candidates, count);
    let gap = gap(&mut body, &balls);
    Ok(BallCover { balls, gap })
}

/// A sample inside the body, and the largest ball that is found around it.
struct Candidate {
    sample: Point3<f64>,
    ball: Ball,
}

fn candidates(body: &mut Body<'_>, count: usize) -> Vec<Candidate> {
    let cells = body.cells(count, 12);
    let inside = cells.iter().filter(|(_, found)| found.upper < 0.0);
    let mut starts: Vec<Point3<f64>> = inside.map(|(cell, _)| cell.center).collect();
    if starts.len() < FEW {
        starts.extend(cells.iter().filter_map(|(cell, found)| {
            let mut depth = body.radius(cell);
            for _ in 0..HALVINGS {
                let p = found.point - found.normal.into_inner() * depth;
                if body.ball(&p).is_some() {
                    return Some(p);
                }
                depth *= 0.5;
            }
            None
        }));
    }
    let deepest = |p: Point3<f64>| body.deepened(&p).map(|ball| Candidate { sample: p, ball });
    starts.into_iter().filter_map(deepest).collect()
}

impl Body<'_> {
    /// Returns the ball about a point that is proven to be inside the body; `None` if there is
    /// none.
    fn ball(&mut self, p: &Point3<f64>) -> Option<Ball> {
        let found = self.ask(p)?;
        let (center, radius) = (*p, -found.upper);
        (radius > 0.0).then_some(Ball { center, radius })
    }

    /// Returns a ball that contains nearly all of the ball about a point, and is larger if it can
    /// be.
    fn deepened(&mut self, p: &Point3<f64>) -> Option<Ball> {
        let mut best = self.ball(p)?;
        let (mut step, mut halvings) = (best.radius, 0);
        while halvings < STEPS {
            let Some(found) = self.ask(&best.center) else { break };
            let center = best.center - found.normal.into_inner() * step;
            let next = self.ball(&center);
            // The next ball contains nearly all of this one: it grows by most of the way.
            match next.filter(|next| next.radius - best.radius >= 0.75 * step) {
                Some(next) => (best, step) = (next, 2.0 * step),
                None => (step, halvings) = (0.5 * step, halvings + 1),
            }
        }
        Some(best)
    }

    /// Returns a ball that is about as large as those near a ball can be.
    fn widest(&mut self, start: Ball) -> Ball {
        let (mut best, mut step) = (start, 0.5 * start.radius);
        for _ in 0..ROUNDS {
            let from = best;
            for k in 0..27 {
                let way = Vector3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                let next = self.ball(&(from.center + way.map(f64::from) * step));
                best = next.filter(|next| next.radius > best.radius).unwrap_or(best);
            }
            if best.radius == from.radius {
                step *= 0.5;
            }
        }
        best
    }
}

/// Returns the balls: the largest one, then those that contain most samples that are left.
fn chosen(candidates: &[Candidate], count: usize) -> Vec<Ball> {
    let holds = |ball: &Ball, p: &Point3<f64>| (p - ball.center).norm_squared() <= ball.radius * ball.radius;
    let mut left: Vec<Point3<f64>> = candidates.iter().map(|c| c.sample).collect();
    // What a candidate gains never grows, so a value of an earlier round is an upper bound.
    let mut gains = vec![usize::MAX; candidates.len()];
    let mut balls: Vec<Ball> = Vec::new();
    while balls.len() < count && !left.is_empty() {
        let mut best: Option<(usize, usize)> = None;
        for (k, c) in candidates.iter().enumerate() {
            let is_better = |gain: usize, best: Option<(usize, usize)>| match best {
                None => gain > 0,
                Some((_, most)) if gain != most => gain > most,
                Some((other, _)) => c.ball.radius > candidates[other].ball.radius,
            };
            if balls.is_empty() {
                // The first is the largest.
                if best.is_none_or(|(other, _)| c.ball.radius > candidates[other].ball.radius) {
                    best = Some((k, 1));
                }
            } else if is_better(gains[k], best) {
                gains[k] = left.iter().filter(|p| holds(&c.ball, p)).count();
                if is_better(gains[k], best) {
                    best = Some((k, gains[k]));
                }
            }
        }
        let Some((k, _)) = best else { break };
        let ball = candidates[k].ball;
        left.retain(|p| !holds(&ball, p));
        balls.push(ball);
    }
    balls
}

/// Returns an upper bound of the distance of a point of the body from the balls.
fn gap(body: &mut Body<'_>, balls: &[Ball]) -> f64 {
    let width = WIDTH * body.radius(&body.root);
    let from_balls = |p: &Point3<f64>| {
        let far = |ball: &Ball| {
            let d = sqrt((p - ball.center).norm_squared());
            d * (1.0 + COVER) - ball.radius * (1.0 - COVER)
        };
        balls.iter().map(far).fold(f64::INFINITY, f64::smaller)
    };
    // A point of the body is about this far from the balls, and cells up to `proven` are done.
    let (mut known, mut proven, mut visits) = (0.0f64, 0.0f64, 0);
    let mut open: Vec<BoxCell> = vec![body.root];
    for depth in 0..=DEPTH {
        let mut next = Vec::new();
        for cell in open {
            visits += 1;
            let bound = from_balls(&cell.center) + body.radius(&cell) * (1.0 + COVER);
            if bound <= proven {
                continue;
            }
            if bound <= known + width || visits > CELLS || depth == DEPTH {
                let is_empty = body.ask(&cell.center).is_some_and(|found| body.is_empty(&cell, &found));
                proven = if is_empty { proven } else { proven.larger(bound) };
                continue;
            }
            let Some(found) = body.ask(&cell.center) else {
                return f64::INFINITY;
            };
            if body.is_empty(&cell, &found) {
                continue;
            }
            let point = if found.upper <= 0.0 { cell.center } else { found.point };
            known = known.larger(from_balls(&point));
            next.extend(cell.halves());
        }
        if next.is_empty() {
            break;
        }
        open = next;
    }
    proven.at_least(0.0)
}
