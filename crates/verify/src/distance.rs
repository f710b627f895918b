//! Both bounds of the distance of two bodies at rest, to the last bit.
//!
//! **Lemma 6.** Let the closest points of the flats (points, lines, planes) through at most four
//! named vertices lie within the named features, and d be the way between them. Both points
//! belong to the hulls, so the distance of the hulls is at most |d|. If along n = d all of A lies
//! below all of B by the gap g > 0, it is at least g / |n|. The radii are taken off both. The
//! closest points are found by Cramer's rule in fractions: one or two unknowns. In the second
//! form a normal n and two points, by weights, are given: the same bounds, each for what is
//! given. In the third form the lower bound is that of lemma 7.

use dashu_ratio::RBig;

use crate::Stop;
use crate::claim::{Moment, all_parts, radii as radii_of};
use crate::groups;
use crate::half_space;
use crate::json::Json;
use crate::near;
use crate::pose::Placed;
use crate::real::{Exact, Real, dot, minus};
use crate::scene::Scene;

/// Checks a line; returns what it proves.
pub(crate) fn check(scene: &Scene, line: &Json) -> Result<String, Stop> {
    line.only(&["distance", "lower", "upper", "normal", "cells", "on"])?;
    let moment = Moment::read(scene, line)?;
    half_space::refuse(scene, moment.pair)?;
    if [moment.pair.0, moment.pair.1]
        .iter()
        .any(|k| !scene.bodies[*k].ellipsoids.is_empty())
    {
        return Stop::bad("a distance of a body with ellipsoids");
    }
    let placed = [scene.placed(moment.pair.0)?, scene.placed(moment.pair.1)?];
    let bounds = [line.get("lower")?.real()?, line.get("upper")?.real()?];
    let [lower, upper] = bounds.map(Real::exact);
    let names = || scene.names(moment.pair);
    let (normal, cells) = (line.find("normal"), line.find("cells"));
    let (way, radii) = match normal.or(cells) {
        Some(_) => {
            let ([a, b], radii) = near::points(scene, &moment, line)?;
            (minus(&placed[1].pose.point(&b), &placed[0].pose.point(&a)), radii)
        }
        None => nearest(scene, &moment, &placed, line)?,
    };
    let hulls_apart = match (normal, cells) {
        (Some(_), Some(_)) => return Stop::bad("a distance has a normal or cells, not both"),
        (None, Some(cells)) => groups::check(scene, &moment, &placed, cells, &lower)?,
        (normal, None) => {
            let normal = normal.map(Json::reals::<3>).transpose()?;
            let n = normal.map_or_else(|| way.clone(), |n| n.map(Real::exact));
            let lower = lower + radii_of(scene, moment.pair, all_parts(scene, moment.pair));
            let found = groups::below(&placed, [None, None], &n, &lower);
            found.map_err(|why| Stop::Fails(format!("{}: {why}", names())))?;
            true
        }
    };
    let upper = upper + radii;
    if upper < RBig::ZERO || dot(&way, &way) > &upper * &upper {
        return Stop::fails(format!("{}: the upper bound is not proven", names()));
    }
    let ([lower, upper], text) = (bounds.map(Real::shown), moment.text(scene));
    let is_solid = [moment.pair.0, moment.pair.1].iter().any(|k| scene.bodies[*k].solid);
    let [of, inside] = match is_solid && !hulls_apart {
        true => ["the surfaces of ", "; not looked at: whether one is inside the other"],
        false => [""; 2],
    };
    Ok(format!(
        "{of}{text} are at least {lower} and at most {upper} apart{inside}"
    ))
}

/// Returns the way between the closest points of the flats through the named vertices, and the radii around these.
fn nearest(scene: &Scene, moment: &Moment, placed: &[Placed; 2], line: &Json) -> Result<(Exact, RBig), Stop> {
    let named = line.get("on")?.list::<2>()?;
    let (mut ends, mut edges, mut sides) = (Vec::new(), Vec::new(), Vec::new());
    let mut names: [Vec<usize>; 2] = Default::default();
    for side in 0..2 {
        let mut corners = Vec::new();
        for k in named[side].array()?.iter().take(4) {
            let k = k.whole()?;
            moment.has(scene, if side == 0 { [k, 0] } else { [0, k] })?;
            corners.extend(placed[side].get(k));
            names[side].push(k);
        }
        let Some(first) = corners.first() else {
            return Stop::bad("a feature without vertex");
        };
        for c in &corners[1..] {
            edges.push(if side == 0 { minus(first, c) } else { minus(c, first) });
            sides.push(side);
        }
        ends.push(first.clone());
    }
    let radii = moment.in_part(scene, [&names[0], &names[1]])?;
    let way = minus(&ends[1], &ends[0]);
    let product = |i: usize, j: usize| dot(&edges[i], &edges[j]);
    let right = |i: usize| -dot(&edges[i], &way);
    let parts = match edges.len() {
        0 => vec![],
        1 => vec![(right(0), product(0, 0))],
        2 => {
            let d = product(0, 0) * product(1, 1) - product(0, 1) * product(0, 1);
            let first = right(0) * product(1, 1) - right(1) * product(0, 1);
            vec![
                (first, d.clone()),
                (right(1) * product(0, 0) - right(0) * product(0, 1), d),
            ]
        }
        _ => return Stop::bad("features of more than four vertices"),
    };
    if parts.iter().any(|(_, d)| *d <= RBig::ZERO) {
        return Stop::fails(format!("{}: a feature without extent", scene.names(moment.pair)));
    }
    let parts: Vec<RBig> = parts.into_iter().map(|(x, d)| x / d).collect();
    for side in 0..2 {
        let own = || parts.iter().zip(&sides).filter(|x| *x.1 == side).map(|x| x.0);
        if own().any(|x| *x < RBig::ZERO) || own().fold(RBig::ZERO, |sum, x| sum + x) > RBig::ONE {
            return Stop::fails(format!(
                "{}: a closest point outside its feature",
                scene.names(moment.pair)
            ));
        }
    }
    let way = std::array::from_fn(|k| parts.iter().zip(&edges).fold(way[k].clone(), |s, (t, e)| s + t * &e[k]));
    Ok((way, radii))
}
