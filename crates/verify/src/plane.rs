//! A plane between two bodies over an interval.
//!
//! **Lemma 3.** n(t) = exp([spin] (t - from)) normal, so |n(t)| = |normal|. For a body X at
//! x -> R(t) x + p(t) the height of vertex x is m(t) . x + o(t) with m = R^T n and o = n . p:
//! forms of lemma 0. Bernstein coefficients are linear in the polynomial, so coefficient by
//! coefficient the greatest over A's vertices bounds all heights of A from above, and the least
//! over B's all heights of B from below. The rests of m count times the largest coordinate. If
//! the difference is at least g > 0 at each t, and g^2 > (keep + radii)^2 |normal|^2, the bodies
//! are more than `keep` apart on the interval. No root is needed. A gap of exactly `keep` is
//! refused: fixed point cannot see it.

use dashu_ratio::RBig;

use crate::claim::{Claim, beyond};
use crate::half_space::Floor;
use crate::int::Int;
use crate::motion::{Span, Stage, Turn};
use crate::real::{Exact, Real};
use crate::scene::Scene;
use crate::vectors::fixed3;

/// A plane keeps two bodies, or some of their vertices, more than `kept` apart.
pub(crate) struct Plane {
    pub(crate) pair: (usize, usize),
    pub(crate) some: [Option<Vec<usize>>; 2],
    pub(crate) span: Span,
    /// What the line keeps, and the radii.
    pub(crate) kept: RBig,
    pub(crate) normal: Exact,
    pub(crate) spin: Option<Exact>,
    /// One of the two is a half-space.
    pub(crate) floor: Option<Floor>,
}

impl Claim for Plane {
    fn holds<I: Int>(&self, scene: &Scene, stage: &Stage<I>) -> Option<bool> {
        let mut n = match &self.floor {
            Some(floor) => floor.direction(scene, stage, &self.span)?,
            None => fixed3(&self.normal)?,
        };
        let length = self.span.length();
        if let Some(spin) = self.spin.as_ref().filter(|_| !length.is_zero()) {
            // Over [0, 1] the angle grows from 0 to the length of the interval.
            let whole = Span {
                from: Real::ZERO,
                until: Real::ONE,
            };
            n = Turn::new(spin, vec![RBig::ZERO, length])?.point(&n, &whole)?;
        }
        let heights = |side: usize| match &self.floor {
            Some(floor) if floor.side == side => {
                let heights = floor.heights(scene, stage, &n, &self.span)?;
                Some([heights.clone(), heights])
            }
            _ => {
                let body = [self.pair.0, self.pair.1][side];
                stage.heights(scene, body, self.some[side].as_deref(), &n, &self.span)
            }
        };
        let ([_, high], [low, _]) = (heights(0)?, heights(1)?);
        let gaps = high
            .iter()
            .zip(&low)
            .map(|(x, y)| y.sub(x))
            .collect::<Option<Vec<_>>>()?;
        Some(beyond(
            &gaps.into_iter().min()?,
            I::W,
            &self.kept,
            &self.normal,
            &stage.unit,
        ))
    }
}
