//! Paths of straight segments: proof, length, shortening.

use std::vec::Vec;

use crate::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::random::Random;
use crate::space::ConfigurationSpace;
use crate::verdict::Verdict;
use lin_canny::tolerance::EXTENT_MAX;

/// Configurations joined by segments.
pub type Path = Vec<Vec<f64>>;

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the verdict on a path: free, or the number of the first segment that is not, and its
    /// verdict. A path of one configuration is judged as a segment without length.
    ///
    /// # Errors
    /// A path without a configuration, or a configuration that is not of the space.
    pub fn certify_path(&mut self, path: &[Vec<f64>]) -> Result<(usize, Verdict), PlanError> {
        let first = path.first().ok_or(PlanError::Empty)?;
        if path.len() == 1 {
            return Ok((0, self.certify(first, first)?));
        }
        for (k, ends) in path.windows(2).enumerate() {
            let verdict = self.certify(&ends[0], &ends[1])?;
            if !verdict.is_free() {
                return Ok((k, verdict));
            }
        }
        let clearance = self.margin();
        Ok((0, Verdict::Free { clearance }))
    }

    /// Returns the verdict on a tube about a segment: on all motions that keep every point of the
    /// robot within `radius` of its place on the segment at the same time, such as a spline between
    /// the ends, or the segment driven with an error of tracking. The margin of the checker holds
    /// inside the tube.
    ///
    /// `Blocked` and `Unknown` say that a pair comes within the margin and the radius; a tube of
    /// which this is true may hold a motion that is free. Pairs of two bodies of the robot count
    /// the radius twice, and so do all pairs of a robot with such pairs.
    ///
    /// # Errors
    /// A configuration that is not of the space, or a radius that is negative or not finite.
    pub fn certify_tube(&mut self, from: &[f64], to: &[f64], radius: f64) -> Result<Verdict, PlanError> {
        if !(0.0..=EXTENT_MAX).contains(&radius) {
            return Err(PlanError::Value {
                what: "radius",
                value: radius,
            });
        }
        let margin = self.margin();
        let moving = if self.pairs.own < self.pairs.all.len() {
            2.0
        } else {
            1.0
        };
        self.set_margin((margin + moving * radius).next_up())?;
        let verdict = self.certify(from, to);
        self.set_margin(margin)?;
        Ok(match verdict? {
            Verdict::Free { .. } => Verdict::Free { clearance: margin },
            other => other,
        })
    }

    /// Returns the length of a path.
    pub fn path_length(&self, path: &[Vec<f64>]) -> f64 {
        path.windows(2).map(|e| self.space.distance(&e[0], &e[1])).sum()
    }

    /// Shortens a path: pairs of places on the path, chosen at random, are joined by a straight
    /// segment if the segment is proven free and keeps the margin of the checker. Every segment of
    /// the path returned is proven free if every segment of the path given is.
    ///
    /// Cuts inside a segment leave a part of the segment, which is proven anew.
    ///
    /// # Errors
    /// A configuration that is not of the space.
    pub fn shorten(&mut self, path: &[Vec<f64>], tries: usize, seed: u64) -> Result<Path, PlanError> {
        let mut random = Random::new(seed);
        let mut path: Path = path.into();
        self.thin(&mut path)?;
        for _ in 0..tries {
            if path.len() < 3 {
                break;
            }
            self.cut(&mut path, &mut random)?;
        }
        self.thin(&mut path)?;
        Ok(path)
    }

    /// Leaves out corners whose neighbours are joined by a segment proven free, as long as there
    /// are any.
    fn thin(&mut self, path: &mut Path) -> Result<(), PlanError> {
        let mut before = path.len() + 1;
        while path.len() < before {
            before = path.len();
            let mut k = 1;
            while k + 1 < path.len() {
                let way = self.path_length(&path[k - 1..=k + 1]);
                let is_shorter = self.space.distance(&path[k - 1], &path[k + 1]) <= way;
                if is_shorter && self.is_free(&path[k - 1], &path[k + 1])? {
                    path.remove(k);
                } else {
                    k += 1;
                }
            }
        }
        Ok(())
    }

    /// Tries one shortcut between two places of a path.
    fn cut(&mut self, path: &mut Path, random: &mut Random) -> Result<(), PlanError> {
        let lengths: Vec<f64> = path.windows(2).map(|e| self.space.distance(&e[0], &e[1])).collect();
        let whole: f64 = lengths.iter().sum();
        let mut places = [random.uniform() * whole, random.uniform() * whole];
        places.sort_by(f64::total_cmp);
        let [(i, x), (j, y)] = places.map(|at| place(&lengths, at));
        if i == j {
            return Ok(());
        }
        let from = self.space.between(&path[i], &path[i + 1], x);
        let to = self.space.between(&path[j], &path[j + 1], y);
        let way: f64 = lengths[i] * (1.0 - x) + lengths[i + 1..j].iter().sum::<f64>() + lengths[j] * y;
        // A cut that saves nothing to speak of leaves more corners than before.
        if self.space.distance(&from, &to) > way * (1.0 - SAVED) {
            return Ok(());
        }
        let is_free = self.is_free(&from, &to)? && self.is_free(&path[i], &from)? && self.is_free(&to, &path[j + 1])?;
        if is_free {
            path.splice(i + 1..=j, [from, to]);
        }
        Ok(())
    }

    /// Moves the inner corners of a path away from obstacles: each corner goes towards larger
    /// clearance, up to `clearance`, if both segments beside it are proven free. Returns the path
    /// after some rounds over all corners; each segment is first halved until no segment is longer
    /// than `longest`.
    ///
    /// # Errors
    /// A configuration that is not of the space, or a length that is not positive.
    pub fn widen(&mut self, path: &[Vec<f64>], clearance: f64, longest: f64, rounds: usize) -> Result<Path, PlanError> {
        if !(longest > 0.0) {
            return Err(PlanError::Value {
                what: "longest segment",
                value: longest,
            });
        }
        let mut path = self.divided(path, longest);
        for _ in 0..rounds {
            for k in 1..path.len().saturating_sub(1) {
                self.push(&mut path, k, clearance, longest)?;
            }
        }
        Ok(path)
    }

    /// Moves one corner, half the way again after each refusal.
    fn push(&mut self, path: &mut Path, k: usize, clearance: f64, longest: f64) -> Result<(), PlanError> {
        let Some(near) = self.clearance(&path[k])? else {
            return Ok(());
        };
        let short = clearance - near.distance;
        let square: f64 = near.gradient.iter().map(|g| g * g).sum();
        if !(short > 0.0) || square == 0.0 {
            return Ok(());
        }
        let mut way = short.smaller(0.5 * longest);
        for _ in 0..4 {
            let parts = near.gradient.iter().zip(self.space.scales());
            let step: Vec<f64> = parts.map(|(g, s)| g * way / (square * s)).collect();
            let moved = self.space.moved(&path[k], &step);
            let is_better = self.clearance(&moved)?.is_some_and(|n| n.distance > near.distance);
            if is_better && self.is_free(&path[k - 1], &moved)? && self.is_free(&moved, &path[k + 1])? {
                path[k] = moved;
                return Ok(());
            }
            way *= 0.5;
        }
        Ok(())
    }

    fn divided(&self, path: &[Vec<f64>], longest: f64) -> Path {
        let mut all: Path = path.iter().take(1).cloned().collect();
        for ends in path.windows(2) {
            let parts = (self.space.distance(&ends[0], &ends[1]) / longest).at_most(PARTS as f64) as usize + 1;
            let inner = (1..parts).map(|k| self.space.between(&ends[0], &ends[1], k as f64 / parts as f64));
            all.extend(inner);
            all.push(ends[1].clone());
        }
        all
    }
}

/// Part of the length that a shortcut must save.
const SAVED: f64 = 1.0 / 1024.0;

/// Parts of a divided segment, at most.
const PARTS: usize = 1024;

/// Returns the segment in which a place on a path lies, and the part of the segment before it.
fn place(lengths: &[f64], mut at: f64) -> (usize, f64) {
    for (k, &length) in lengths.iter().enumerate() {
        if at < length || k + 1 == lengths.len() {
            return (k, if length > 0.0 { (at / length).at_most(1.0) } else { 0.0 });
        }
        at -= length;
    }
    (0, 0.0)
}
