//! Bounds of the depth of two bodies at rest: the shortest translation that separates them.
//!
//! **Lemma 7, upper.** If max over A of n . a - min over B of n . b <= s |n|, moving B by s along
//! n leaves all of A below all of B: they are apart or touch. So the depth of the hulls is at
//! most s >= 0, and that of the bodies at most s + radii.
//!
//! **Lemma 7, lower.** Let triangles of differences a_i - b_j, points of the convex set D = A -
//! B, be given, each with 0 strictly on its inner side, at least r from its plane, and such that
//! each directed edge is there as often as its opposite. Seen from 0 the triangles are a closed
//! surface that covers each direction equally often, and at least once, as each covers some and
//! none with the opposite sense. So each ray from 0 meets a triangle, at least r away, and D
//! holds the ball of radius r around 0. A translation shorter than r is a point of D: the moved
//! hulls still share a point. So the depth is at least r, and that of the bodies at least r +
//! radii.

use std::collections::BTreeMap;

use dashu_ratio::RBig;

use crate::Stop;
use crate::claim::{Moment, radii};
use crate::json::Json;
use crate::pose::Placed;
use crate::real::{Exact, Real, at_most, cross, dot, minus};
use crate::scene::Scene;

/// Checks a line; returns what it proves.
pub(crate) fn check(scene: &Scene, line: &Json) -> Result<String, Stop> {
    line.only(&["depth", "upper", "normal", "lower", "points", "facets"])?;
    let moment = Moment::read(scene, line)?;
    let placed = [scene.placed(moment.pair.0)?, scene.placed(moment.pair.1)?];
    let has = |keys: &[&str]| keys.iter().map(|k| line.find(k).is_some()).collect::<Vec<_>>();
    let (above, below) = (has(&["upper", "normal"]), has(&["lower", "points", "facets"]));
    let one = above != [false; 2] || below != [false; 3];
    if !one || above.contains(&true) && above.contains(&false) || below.contains(&true) && below.contains(&false) {
        return Stop::bad("a depth has upper and normal, or lower, points and facets, or all five");
    }
    let radii = radii(scene, moment.pair);
    let mut said = ["at least", "at most"].map(|side| format!("{side} side not looked at"));
    if above[0] {
        let upper = line.get("upper")?.real()?;
        said[1] = format!("at most {:?}", upper.shown());
        let (n, size) = (
            line.get("normal")?.reals::<3>()?.map(Real::exact),
            upper.exact() - &radii,
        );
        let [[_, high], [low, _]] = [placed[0].heights(None, &n), placed[1].heights(None, &n)];
        let square = dot(&n, &n);
        if square.is_zero() || size < RBig::ZERO || !at_most(&(high - low), &size, &square) {
            return Stop::fails(format!("{}: the upper bound is not proven", scene.names(moment.pair)));
        }
    }
    if below[0] {
        let lower = line.get("lower")?.real()?;
        if [moment.pair.0, moment.pair.1]
            .iter()
            .any(|k| !scene.bodies[*k].parts.is_empty())
        {
            return Stop::fails(format!("{}: a ball in bodies of parts", scene.names(moment.pair)));
        }
        said[0] = format!("at least {:?}", lower.shown());
        if !ball(scene, &moment, &placed, line, &(lower.exact() - &radii))? {
            return Stop::fails(format!("{}: the lower bound is not proven", scene.names(moment.pair)));
        }
    }
    Ok(format!("the depth of {} is: {}", moment.text(scene), said.join(", ")))
}

/// Decides whether the facets enclose the ball of this radius.
fn ball(scene: &Scene, moment: &Moment, placed: &[Placed; 2], line: &Json, radius: &RBig) -> Result<bool, Stop> {
    let mut points: Vec<Exact> = Vec::new();
    for pair in line.get("points")?.array()? {
        let [i, j] = pair.list::<2>()?;
        let [i, j] = [i.whole()?, j.whole()?];
        moment.has(scene, [i, j])?;
        points.extend(placed[0].get(i).zip(placed[1].get(j)).map(|(a, b)| minus(&a, &b)));
    }
    let (mut edges, facets) = (BTreeMap::<(usize, usize), i64>::new(), line.get("facets")?.array()?);
    let mut truth = !facets.is_empty() && *radius >= RBig::ZERO;
    for facet in facets {
        let mut corners = [0; 3];
        for (corner, json) in corners.iter_mut().zip(facet.list::<3>()?) {
            *corner = json.whole()?;
            if *corner >= points.len() {
                return Stop::bad("a facet names a point that does not exist");
            }
        }
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
        let [p, q, r] = corners.map(|k| &points[k]);
        let normal = cross(&minus(q, p), &minus(r, p));
        let height = dot(&normal, p);
        truth &= height > RBig::ZERO && &height * &height >= radius * radius * dot(&normal, &normal);
    }
    Ok(truth && edges.values().all(|count| *count == 0))
}
