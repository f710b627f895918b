//! Two bodies are within a distance of each other.
//!
//! **Lemma 5.** The mean of vertices with weights that are not negative is a point of the hull. Two
//! such points at most `within` + radii apart prove that the bodies are at most `within` apart. The
//! weights are divided by their sum exactly, so they need not add up to one. Of a half-space the point nearest to
//! that of the other body counts: its distance is how far that one is above the plane, or 0.

use crate::Stop;
use crate::claim::{AtMoment, Claim, Moment};
use crate::half_space::Floor;
use crate::int::Int;
use crate::json::Json;
use crate::motion::Stage;
use crate::points::weights;
use crate::real::{Exact, Real, at_most, dot as exact_dot, minus as exact_minus, two_to};
use crate::scene::Scene;
use crate::vectors::{dot, fixed3, minus};
use dashu_ratio::RBig;

/// Two points that are at most `within` and the radii apart.
pub(crate) struct Near {
    moment: Moment,
    within: Real,
    /// The distance of the points that proves it: with the radii.
    reach: RBig,
    /// In the frames of the bodies.
    on: [Exact; 2],
    /// One of the two is a half-space.
    floor: Option<Floor>,
}

/// Reads two lists of weights; returns their points in the frames of the bodies and the sum of the radii around them.
pub(crate) fn points(scene: &Scene, moment: &Moment, line: &Json) -> Result<([Exact; 2], RBig), Stop> {
    let on = line.get("on")?.list::<2>()?;
    let weights_of = |side: usize, body: usize| match (&scene.bodies[body].half, on[side].array()?) {
        (None, _) => weights(&on[side]),
        (Some(_), []) => Ok(vec![(0, Real::ONE)]),
        (Some(_), _) => Stop::bad("points of a half-space"),
    };
    let (a, b) = (weights_of(0, moment.pair.0)?, weights_of(1, moment.pair.1)?);
    a.iter().try_for_each(|x| moment.has(scene, [x.0, 0]))?;
    b.iter().try_for_each(|x| moment.has(scene, [0, x.0]))?;
    let names = [&a, &b].map(|on| on.iter().map(|x| x.0).collect::<Vec<_>>());
    let radii = moment.in_part(scene, [&names[0], &names[1]])?;
    let [x, y] = [moment.pair.0, moment.pair.1].map(|k| &scene.bodies[k].points);
    let points = x.mean(&a).zip(y.mean(&b)).map(|(x, y)| ([x, y], radii));
    points.ok_or(Stop::Bad("weights".into()))
}

impl Near {
    pub(crate) fn read(scene: &Scene, line: &Json) -> Result<Self, Stop> {
        line.only(&["near", "at", "within", "on"])?;
        let moment = Moment::read(scene, line)?;
        let within = line.get("within")?.real()?;
        if within < Real::ZERO {
            return Stop::bad("within is negative");
        }
        let (on, radii) = points(scene, &moment, line)?;
        Ok(Self {
            floor: Floor::of_pair(scene, moment.pair, false)?,
            reach: within.exact() + radii,
            moment,
            within,
            on,
        })
    }
}

impl AtMoment for Near {
    fn moment(&self) -> &Moment {
        &self.moment
    }

    fn says(&self, scene: &Scene) -> String {
        format!("{} are at most {} apart", self.moment.text(scene), self.within.shown())
    }

    fn at_rest(&self, scene: &Scene) -> Result<bool, Stop> {
        let (a, b) = (scene.placed(self.moment.pair.0)?, scene.placed(self.moment.pair.1)?);
        let ends = [a.pose.point(&self.on[0]), b.pose.point(&self.on[1])];
        if let Some(floor) = &self.floor {
            let gap = floor.gap(exact_dot(&floor.normal, &ends[1 - floor.side]));
            return Ok(at_most(&gap, &self.reach, &exact_dot(&floor.normal, &floor.normal)));
        }
        let way = exact_minus(&ends[1], &ends[0]);
        Ok(exact_dot(&way, &way) <= &self.reach * &self.reach)
    }
}

impl Claim for Near {
    fn holds<I: Int>(&self, scene: &Scene, stage: &Stage<I>) -> Option<bool> {
        let (span, (a, b)) = (self.moment.span(), self.moment.pair);
        let end = |body: usize, x: &Exact| {
            let x = fixed3(&x.each_ref().map(|x| x * &stage.unit))?;
            stage.point(scene, body, &x, &span)
        };
        if let Some(floor) = &self.floor {
            let point = end([a, b][1 - floor.side], &self.on[1 - floor.side])?;
            let from_foot = minus(&point, &floor.foot(scene, stage, &span)?)?;
            let along = dot(&from_foot, &floor.direction(scene, stage, &span)?)?;
            let most = match floor.side {
                0 => along.c[0].add(&along.r)?,
                _ => along.c[0].sub(&along.r)?,
            };
            let gap = floor.gap(RBig::from(most.wide()) * two_to(-(I::P as i64)) / &stage.unit);
            return Some(at_most(&gap, &self.reach, &exact_dot(&floor.normal, &floor.normal)));
        }
        let way = minus(&end(b, &self.on[1])?, &end(a, &self.on[0])?)?;
        let square = dot(&way, &way)?;
        let most = RBig::from(square.c[0].add(&square.r)?.wide()) * two_to(-(I::P as i64));
        let reach = &self.reach * &stage.unit;
        Some(most <= &reach * &reach)
    }
}
