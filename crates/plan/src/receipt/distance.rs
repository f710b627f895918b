//! The line of a distance: both bounds, by features, by a normal, or by planes between groups of
//! parts.

use nalgebra::{Isometry3, Vector3};

use super::cells::{PIECES, TOO_MANY};
use super::contact::{PARTS, missing, points_within, weights, weights_text};
use super::error::ReceiptError;
use super::evidence::BITS;
use super::groups::{Group, Groups, near_parts};
use super::number::{hex, hexes, rounded};
use super::scene::{Body, Scene, list};
use super::stated::half;
use crate::extremes::Extremes;
use crate::tolerance::{INSIDE, RECEIPT};
use lin_canny::{ContactState, RelativePose, Tracker};

/// Returns the line of a distance: by the features if they are certainly the closest, or else by a
/// normal and two points.
pub(super) fn distance(
    scene: &Scene,
    pair: [usize; 2],
    poses: [&Isometry3<f64>; 2],
    relative: &RelativePose,
    bounds: [f64; 2],
) -> Result<String, ReceiptError> {
    let refused = |why: &'static str| missing(scene, pair, 0.0, why);
    let [a, b] = pair.map(|k| &scene.bodies[k]);
    if a.has_no_points() || b.has_no_points() {
        return Err(refused("a curved body or a half-space proves no distance"));
    }
    if !a.parts.is_empty() || !b.parts.is_empty() {
        return of_parts(scene, pair, poses, relative, bounds).map_err(refused);
    }
    let seen = Tracker::new().closest(&a.hull, &b.hull, relative);
    if seen.state != ContactState::Separated || !bounds[0].is_finite() {
        return Err(refused("the hulls without their radii are not apart"));
    }
    let on = [
        weights(&a.hull, seen.features.a, &seen.point_on_a),
        weights(&b.hull, seen.features.b, &seen.point_on_b),
    ];
    let ([lower, upper], [i, j]) = (bounds.map(hex), pair);
    let line = format!("{{\"distance\":[{i},{j}],\"lower\":\"{lower}\",\"upper\":\"{upper}\"");
    if are_features([a, b], poses, &on) {
        let on = on.map(|on| list(&on.iter().map(|x| x.0).collect::<Vec<_>>())).join(",");
        return Ok(format!("{line},\"on\":[{on}]}}"));
    }
    let normal = poses[0].rotation * seen.normal.into_inner();
    let (normal, on) = (hexes(normal.as_slice()), on.map(|on| weights_text(&on)).join(","));
    Ok(format!("{line},\"normal\":{normal},\"on\":[{on}]}}"))
}

/// Returns the line of a distance of bodies of which one has parts.
///
/// Both bounds leave room for rounding: each group of parts has its plane, and the normals
/// are rounded.
fn of_parts(
    scene: &Scene,
    pair: [usize; 2],
    poses: [&Isometry3<f64>; 2],
    relative: &RelativePose,
    [lower, upper]: [f64; 2],
) -> Result<String, &'static str> {
    let bodies = pair.map(|k| &scene.bodies[k]);
    let (radii, room) = (bodies[0].radius + bodies[1].radius, RECEIPT * scene.size());
    let (lower, upper) = ((lower - room).at_least(0.0), upper + room);
    if !(lower <= upper && upper.is_finite()) {
        return Err("its distance is not bounded");
    }
    let groups = bodies.map(Groups::new);
    let (all, mut near) = ([groups[0].all(), groups[1].all()], Vec::new());
    near_parts(&groups, all, relative, upper + radii - 0.5 * room, PARTS, &mut near);
    let mut points = near.iter().filter_map(|[x, y]| {
        let reach = upper + x.radius + y.radius - 0.5 * room;
        points_within([x, y], poses, relative, reach)
    });
    let on = points.next().ok_or("no two points are near enough")?;
    let mut planes = Planes {
        groups: &groups,
        poses,
        relative,
        gap: lower + 0.5 * room,
        cuts: Vec::new(),
        cells: Vec::new(),
    };
    planes.fill(all)?;
    let ([lower, upper], [i, j], cells) = ([lower, upper].map(hex), pair, planes.cells.join(","));
    Ok(format!(
        "{{\"distance\":[{i},{j}],\"lower\":\"{lower}\",\"upper\":\"{upper}\",\"cells\":[{cells}],\"on\":[{on}]}}"
    ))
}

/// The cells of a distance: cuts of the parts of both bodies, and a normal for each cell.
struct Planes<'a> {
    groups: &'a [Groups<'a>; 2],
    poses: [&'a Isometry3<f64>; 2],
    relative: &'a RelativePose,
    /// What each plane must prove, without the radii.
    gap: f64,
    /// Cuts of the cell at hand.
    cuts: Vec<String>,
    cells: Vec<String>,
}

impl Planes<'_> {
    fn fill(&mut self, ranges: [[usize; 2]; 2]) -> Result<(), &'static str> {
        let groups = [0, 1].map(|k| self.groups[k].get(ranges[k]));
        if let [Some(x), Some(y)] = &groups
            && let Some(normal) = self.normal([x, y])
        {
            if self.cells.len() == PIECES {
                return Err(TOO_MANY);
            }
            let cuts = core::mem::take(&mut self.cuts).join(",");
            self.cells.push(format!("[[{cuts}],{}]", hexes(normal.as_slice())));
            return Ok(());
        }
        let is_cut = |side: usize| ranges[side][1] > ranges[side][0] + 1;
        let size = |side: usize| groups[side].as_ref().map_or(f64::INFINITY, |group| group.size);
        let side = match [is_cut(0), is_cut(1)] {
            [false, false] => return Err("no plane proves the distance of two of their parts"),
            [true, true] => usize::from(size(1) > size(0)),
            [first, _] => usize::from(!first),
        };
        let middle = half(ranges[side]);
        self.cuts.push(format!("[{side},{middle}]"));
        let [mut lower, mut upper] = [ranges; 2];
        (lower[side][1], upper[side][0]) = (middle, middle);
        self.fill(lower)?;
        self.fill(upper)
    }

    /// Returns a normal in the world, with few bits, along which two groups are far enough apart.
    fn normal(&self, groups: [&Group; 2]) -> Option<Vector3<f64>> {
        let seen = Tracker::new().closest(&groups[0].hull, &groups[1].hull, self.relative);
        let normal = (seen.state == ContactState::Separated).then(|| self.poses[0].rotation * *seen.normal)?;
        let highest = |k: usize, n: Vector3<f64>| {
            let (m, base) = (
                self.poses[k].rotation.inverse() * n,
                self.poses[k].translation.vector.dot(&n),
            );
            let heights = groups[k].vertices.iter().map(|p| m.dot(p) + base);
            heights.fold(f64::NEG_INFINITY, f64::larger)
        };
        let gap = self.gap + groups[0].radius + groups[1].radius;
        let is_enough = |n: &Vector3<f64>| -highest(1, -n) - highest(0, *n) >= gap * n.norm();
        let short = BITS.iter().map(|bits| rounded(&normal, *bits));
        short.chain([normal]).find(is_enough)
    }
}

/// Returns whether the vertices name features whose closest points are certainly inside them.
fn are_features(bodies: [&Body; 2], poses: [&Isometry3<f64>; 2], on: &[Vec<(usize, f64)>; 2]) -> bool {
    if !on.iter().flatten().all(|x| x.1 > INSIDE) {
        return false;
    }
    let edge = |side: usize| {
        let [p, q] = [0, 1].map(|k| bodies[side].points[on[side][k].0]);
        poses[side].rotation * (q - p).normalize()
    };
    match on.each_ref().map(Vec::len) {
        [1, 1..=3] | [2..=3, 1] => true,
        [2, 2] => edge(0).cross(&edge(1)).norm() > INSIDE,
        _ => false,
    }
}
