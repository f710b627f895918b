//! What the claims share: bounds over time that two widths of integers can evaluate.

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::Stop;
use crate::cover::Parts;
use crate::int::Int;
use crate::json::Json;
use crate::motion::{Span, Stage};
use crate::real::{Exact, Real, dot, two_to};
use crate::scene::Scene;

/// A claim about bodies that move.
pub(crate) trait Claim {
    /// Returns whether it is seen to hold, or `None` if a number does not fit.
    fn holds<I: Int>(&self, scene: &Scene, stage: &Stage<I>) -> Option<bool>;
}

/// A claim about two bodies at a time, or at rest.
pub(crate) trait AtMoment: Claim {
    fn moment(&self) -> &Moment;
    /// Decides for two bodies at rest.
    fn at_rest(&self, scene: &Scene) -> Result<bool, Stop>;
    fn says(&self, scene: &Scene) -> String;
}

/// Two bodies at a time; they rest if there is none.
pub(crate) struct Moment {
    pub(crate) pair: (usize, usize),
    pub(crate) time: Option<Real>,
}

impl Moment {
    /// Reads a pair, and its time if one of the two moves.
    pub(crate) fn read(scene: &Scene, line: &Json) -> Result<Self, Stop> {
        let pair = scene.pair(line.get(line.kind())?)?;
        let time = line.find("at").map(Json::real).transpose()?;
        if time.is_some() != (scene.bodies[pair.0].moves || scene.bodies[pair.1].moves) {
            return Stop::bad("a pair that moves has a time, one that rests has none");
        }
        if scene.coordinates > 0 && time.is_some_and(|t| !(Real::ZERO..=Real::ONE).contains(&t)) {
            return Stop::bad("a time outside of a leg: it lasts from 0 to 1");
        }
        Ok(Self { pair, time })
    }

    /// Refuses a vertex that a body does not have.
    pub(crate) fn has(&self, scene: &Scene, [i, j]: [usize; 2]) -> Result<(), Stop> {
        let (a, b) = (&scene.bodies[self.pair.0], &scene.bodies[self.pair.1]);
        if i < a.points.all.len() && j < b.points.all.len() {
            return Ok(());
        }
        Stop::fails(format!("{}: no such vertex, of {i} and {j}", scene.names(self.pair)))
    }

    /// Returns the sum of the radii around points of both bodies.
    ///
    /// Refuses points that no single part of its body has: their hull may be outside of the body. If several parts
    /// have them, the greatest radius counts.
    pub(crate) fn in_part(&self, scene: &Scene, points: [&[usize]; 2]) -> Result<RBig, Stop> {
        let mut sum = RBig::ZERO;
        for (body, points) in [self.pair.0, self.pair.1].into_iter().zip(points) {
            let body = &scene.bodies[body];
            let has = |k: &usize| points.iter().all(|point| body.parts[*k].contains(point));
            let parts = (0..body.parts.len()).filter(has).map(|k| body.radius_of([k, k + 1]));
            match parts.max() {
                Some(radius) => sum += radius,
                None if body.parts.is_empty() => sum += &body.radius,
                None => return Stop::fails(format!("{}: points of several parts", scene.names(self.pair))),
            }
        }
        Ok(sum)
    }

    pub(crate) fn span(&self) -> Span {
        Span::at(self.time.unwrap_or(Real::ZERO))
    }

    /// Returns the names of the bodies and the time.
    pub(crate) fn text(&self, scene: &Scene) -> String {
        let [a, b] = [self.pair.0, self.pair.1].map(|k| &scene.bodies[k].name);
        let when = self.time.map_or(String::new(), |t| format!(" at t = {}", t.shown()));
        format!("{a} and {b}{when}")
    }
}

/// Decides whether a gap along a normal, in units of 2^-2P / scale, is more than `kept`.
pub(crate) fn beyond<I: Int>(gap: &I, scale: i32, kept: &RBig, normal: &Exact, unit: &RBig) -> bool {
    let gap = RBig::from(gap.wide()) * two_to(-2 * I::P as i64) / RBig::from(IBig::from(scale));
    let kept = kept * unit;
    gap > RBig::ZERO && &gap * &gap > &kept * &kept * dot(normal, normal)
}

/// Returns the numbers of all parts of two bodies.
pub(crate) fn all_parts(scene: &Scene, (a, b): (usize, usize)) -> Parts {
    [a, b].map(|k| [0, scene.bodies[k].parts.len()])
}

/// Returns the sum of the greatest radii of some parts of two bodies.
pub(crate) fn radii(scene: &Scene, (a, b): (usize, usize), parts: Parts) -> RBig {
    scene.bodies[a].radius_of(parts[0]) + scene.bodies[b].radius_of(parts[1])
}
