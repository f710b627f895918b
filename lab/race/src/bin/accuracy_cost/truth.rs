//! Computes the true distance of a frame by exact arithmetic, the same for all engines.
//!
//! Pairs of small bodies are solved over the integers. For larger bodies, a direction and two
//! points serve as a proposal: exact arithmetic computes the lower bound that the direction proves
//! and the distance of the points, an upper bound. The true distance lies between them.

use lin_canny::{RelativePose, Tracker};
use truth::bound;
use truth::exact::solve;
use truth::rng::Rng;

use truth::pairs::Pair;

/// Largest number of vertices of a body for which pairs are solved over the integers.
const SMALL: usize = 16;

/// Bounds of the true distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

impl Truth {
    /// Returns the bounds for a frame in which the bodies are separated.
    pub(crate) fn of(pair: &Pair, frame: usize) -> Self {
        let f = &pair.frames[frame];
        let (a, b) = (pair.a.plain(), pair.b.plain());
        if a.points.len().max(b.points.len()) <= SMALL {
            let d = solve(a, &f.a, b, &f.b).distance;
            return Self { lower: d, upper: d };
        }
        let (pa, pb) = &pair.isometries[frame];
        let relative = RelativePose::new(pa, pb).expect("poses of a motion");
        let o = Tracker::new().closest_exact(&pair.a.ours, &pair.b.ours, &relative);
        let normal = f.a.rotate(o.normal.into_inner().into());
        let c = bound::check(a, &f.a, b, &f.b, normal, o.point_on_a.into(), o.point_on_b.into());
        Self {
            lower: c.lower,
            upper: c.upper + 2.0 * c.outside.max(0.0),
        }
    }

    /// Returns the least possible error of a distance; infinite for NaN.
    pub(crate) fn miss(&self, distance: f64) -> f64 {
        if distance.is_nan() {
            f64::INFINITY
        } else {
            (self.lower - distance).max(distance - self.upper).max(0.0)
        }
    }
}

/// The true distances of some frames of a motion.
pub(crate) struct Sampled {
    pub(crate) frames: Vec<usize>,
    truths: Vec<Truth>,
    sizes: Vec<f64>,
}

impl Sampled {
    pub(crate) fn new(pair: &Pair, count: usize) -> Self {
        Self::of(pair.frames.len(), count, |f| (Truth::of(pair, f), pair.size(f)))
    }

    /// Samples some of `total` frames, by a function that returns the bounds of a frame and the
    /// size of the pair.
    pub(crate) fn of(total: usize, count: usize, truth: impl Fn(usize) -> (Truth, f64)) -> Self {
        // A random frame of each stretch, so that periodic events are sampled too.
        let mut rng = Rng::new(29);
        let stretch = |k: usize| k * total / count..(k + 1) * total / count;
        let frames: Vec<usize> = (0..count)
            .map(stretch)
            .filter(|s| !s.is_empty())
            .map(|s| s.start + rng.below(s.len()))
            .collect();
        let (truths, sizes) = frames.iter().map(|&f| truth(f)).unzip();
        Self { frames, truths, sizes }
    }

    /// Returns the greatest width of the bounds, relative to the size of the pair.
    pub(crate) fn width(&self) -> f64 {
        let widths = self
            .truths
            .iter()
            .zip(&self.sizes)
            .map(|(t, l)| (t.upper - t.lower) / l);
        widths.fold(0.0, f64::max)
    }

    /// Returns the largest error relative to the size of the pair, in each of `parts` stretches of
    /// the motion.
    pub(crate) fn errors(&self, parts: usize, distance: impl Fn(usize) -> f64) -> Vec<f64> {
        let miss = |k: usize| self.truths[k].miss(distance(self.frames[k])) / self.sizes[k];
        let n = self.frames.len();
        (0..parts)
            .map(|p| (p * n / parts..(p + 1) * n / parts).map(miss).fold(0.0, f64::max))
            .collect()
    }
}
