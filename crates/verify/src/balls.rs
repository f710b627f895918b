//! Balls that stay apart over an interval.
//!
//! **Lemma 2.** Let rho_X be no less than the distance of any vertex of X from its pivot; the ball
//! of radius rho_X + radius of X around the pivot holds X at all times, as X is rigid. If
//! |p_B(t) - p_A(t)|^2 > (rho_A + rho_B + radii + keep)^2 on the interval, the bodies are more than
//! `keep` apart there. The left side is a form of lemma 0; the Bernstein coefficients of its
//! eighths bound it from below. rho_X^2 is exact, and its root is rounded up.

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::bernstein::least;
use crate::claim::Claim;
use crate::int::Int;
use crate::motion::{Span, Stage};
use crate::real::two_to;
use crate::scene::Scene;
use crate::vectors::{dot, minus};

/// The balls of two bodies stay more than `kept` apart.
pub(crate) struct Balls {
    pub(crate) pair: (usize, usize),
    pub(crate) span: Span,
    /// What the line keeps, and the radii.
    pub(crate) kept: RBig,
}

impl Claim for Balls {
    fn holds<I: Int>(&self, scene: &Scene, stage: &Stage<I>) -> Option<bool> {
        let (a, b) = self.pair;
        let reach = stage.reach(a) + stage.reach(b) + &self.kept * &stage.unit;
        let way = minus(
            &stage.centre(scene, b, &self.span)?,
            &stage.centre(scene, a, &self.span)?,
        )?;
        let square = dot(&way, &way)?;
        let least = least(square.net()?)?.sub(&square.r.mul(&I::small(I::W))?)?;
        let least = RBig::from(least.wide()) * two_to(-(I::P as i64)) / RBig::from(IBig::from(I::W));
        Some(least > &reach * &reach)
    }
}
