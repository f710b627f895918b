//! Lines that prove a contact, and points of features.

use nalgebra::{Isometry3, Point3, Vector3};

use super::error::ReceiptError;
use super::groups::{Group, Groups, near_parts};
use super::number::hex;
use super::scene::{Body, Scene};
use super::taylor::pose;
use crate::extremes::Extremes;
use crate::tolerance::RECEIPT;
use lin_canny::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use lin_canny::{RelativePose, Tracker};

/// Most pairs of parts that are tried as the position of a contact.
pub(super) const PARTS: usize = 256;

/// Times after a bracket at which a contact is proven if it is not certain at its end, in brackets.
const LATER: [f64; 10] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 256.0, 1024.0, 4096.0];

/// Why a contact has no evidence although the bodies have points.
const UNCERTAIN: &str = "they touch, and no common point is certain";

/// Returns the error of a pair at one time.
pub(super) fn missing(scene: &Scene, [a, b]: [usize; 2], time: f64, why: &'static str) -> ReceiptError {
    let [a, b] = [a, b].map(|k| scene.bodies[k].name.clone());
    let (from, until) = (time, time);
    ReceiptError::Pair { a, b, from, until, why }
}

/// Returns the line of a contact in a bracket, at its end or, if no evidence is certain there, at
/// most so many brackets later.
pub(super) fn contact(
    scene: &Scene,
    rows: Option<&[Vec<f64>]>,
    pair: [usize; 2],
    [safe, hit]: [f64; 2],
    last: f64,
    kept: f64,
) -> Result<String, ReceiptError> {
    let first = meeting(scene, rows, pair, Some(hit), kept);
    if first.is_ok() {
        return first;
    }
    let later = LATER.iter().map(|brackets| hit + brackets * (hit - safe));
    let mut later = later.filter(|time| *time <= last);
    let found = later.find_map(|time| meeting(scene, rows, pair, Some(time), kept).ok());
    found.map_or(first, Ok)
}

/// Returns the line that proves that two bodies share a point, or are at most `kept` apart, at a
/// time; without a time if they rest.
pub(super) fn meeting(
    scene: &Scene,
    rows: Option<&[Vec<f64>]>,
    pair: [usize; 2],
    time: Option<f64>,
    kept: f64,
) -> Result<String, ReceiptError> {
    let now = time.unwrap_or(0.0);
    let at = time.map_or(String::new(), |time| format!(",\"at\":\"{}\"", hex(time)));
    let [a, b] = pair;
    let [x, y] = pair.map(|k| pose(&scene.steps(k, rows), now));
    let [first, second] = pair.map(|k| &scene.bodies[k]);
    let refused = |why: &'static str| missing(scene, pair, now, why);
    if [first, second].iter().any(|body| !body.ellipsoids.is_empty()) {
        return Err(refused("a curved body proves no contact"));
    }
    if first.larger > 0.0 || second.larger > 0.0 {
        return Err(refused(
            "a surface, which is stated larger than it is, proves no contact",
        ));
    }
    if first.half.is_some() && second.half.is_some() {
        return Err(refused("two half-spaces prove no contact"));
    }
    let halves = [first.half, second.half].into_iter().enumerate();
    if let Some((side, half)) = halves.filter_map(|(k, half)| Some((k, half?))).next() {
        let (body, poses) = ([second, first][side], [[&x, &y], [&y, &x]][side]);
        let least = kept - RECEIPT * scene.size();
        let point = lowest(&half, body, poses, least).ok_or_else(|| refused(UNCERTAIN))?;
        let on = weights_text(&[(point, 1.0)]);
        let (within, on) = (hex(kept), [format!("[],{on}"), format!("{on},[]")][side].clone());
        return Ok(format!(
            "{{\"near\":[{a},{b}],\"within\":\"{within}\",\"on\":[{on}]{at}}}"
        ));
    }
    let relative = RelativePose::new(&x, &y).map_err(|_| refused("a pose is out of range"))?;
    let (groups, reach) = (
        [Groups::new(first), Groups::new(second)],
        kept + first.radius + second.radius,
    );
    let (all, mut near) = ([groups[0].all(), groups[1].all()], Vec::new());
    near_parts(&groups, all, &relative, reach, PARTS, &mut near);
    for [first, second] in &near {
        let mut tracker = Tracker::new();
        tracker.closest(&first.hull, &second.hull, &relative);
        let started = [Tracker::new(), tracker];
        let mut proofs = started
            .iter()
            .map(|start| start.overlap_proof(&first.hull, &second.hull, &relative));
        if let Some(pairs) = proofs.find_map(|proof| proof) {
            let pair = |[i, j]: [VertexId; 2]| format!("[{},{}]", first.points[i.index()], second.points[j.index()]);
            let pairs = pairs.map(pair).join(",");
            return Ok(format!("{{\"meet\":[{a},{b}]{at},\"points\":[{pairs}]}}"));
        }
    }
    let within = hex(kept);
    let mut points = near.iter().filter_map(|[x_part, y_part]| {
        let reach = kept + x_part.radius + y_part.radius;
        points_within([x_part, y_part], [&x, &y], &relative, reach)
    });
    match points.next() {
        Some(on) => Ok(format!(
            "{{\"near\":[{a},{b}],\"within\":\"{within}\",\"on\":[{on}]{at}}}"
        )),
        None => Err(refused(UNCERTAIN)),
    }
}

/// Returns the point of a body that is deepest in a half-space, if with its radius it is less than `least` above it. The
/// pose of the half-space is first.
fn lowest(
    (normal, end): &(Vector3<f64>, f64),
    body: &Body,
    [floor, pose]: [&Isometry3<f64>; 2],
    least: f64,
) -> Option<usize> {
    let n = floor.rotation * normal;
    let height =
        |k: usize| (n.dot(&((pose * body.points[k]) - Point3::from(floor.translation.vector))) - end) / n.norm();
    let all: Vec<usize> = (0..body.points.len()).collect();
    let parts: Vec<&[usize]> = match body.parts[..] {
        [] => vec![&all],
        ref parts => parts.iter().map(Vec::as_slice).collect(),
    };
    let above = parts.iter().enumerate().flat_map(|(part, points)| {
        let radius = body.radius_of([part, part + 1]);
        points.iter().map(move |k| (height(*k) - radius, *k))
    });
    let lowest = above.reduce(|x, y| if y.0 < x.0 { y } else { x })?;
    (lowest.0 < least).then_some(lowest.1)
}

/// Returns weights of two points, one of each part, that are less than `reach` apart.
pub(super) fn points_within(
    parts: [&Group; 2],
    poses: [&Isometry3<f64>; 2],
    relative: &RelativePose,
    reach: f64,
) -> Option<String> {
    let seen = Tracker::new().closest(&parts[0].hull, &parts[1].hull, relative);
    let on = [
        weights(&parts[0].hull, seen.features.a, &seen.point_on_a),
        weights(&parts[1].hull, seen.features.b, &seen.point_on_b),
    ];
    let point = |k: usize| poses[k] * Point3::from(mean(&parts[k].hull, &on[k]));
    if !((point(0) - point(1)).norm() < reach) {
        return None;
    }
    let named = |k: usize| {
        let on: Vec<_> = on[k].iter().map(|(v, part)| (parts[k].points[*v], *part)).collect();
        weights_text(&on)
    };
    Some([named(0), named(1)].join(","))
}

/// Returns vertices of a feature, and weights whose mean is about a point.
pub(super) fn weights(hull: &ConvexPolyhedron, feature: Feature, point: &Point3<f64>) -> Vec<(usize, f64)> {
    let all: Vec<Point3<f64>> = hull.vertex_points().collect();
    let corners: Vec<usize> = match feature {
        Feature::Vertex(v) => vec![v.index()],
        Feature::Edge(e) => hull
            .edge_vertices(e)
            .map_or(Vec::new(), |ends| ends.map(|v| v.index()).into()),
        Feature::Face(f) => hull.face_vertices(f).map(|v| v.index()).collect(),
    };
    match corners[..] {
        [] => vec![(0, 1.0)],
        [v] => vec![(v, 1.0)],
        [v, w] => {
            let way = all[w] - all[v];
            let part = ((point - all[v]).dot(&way) / way.norm_squared()).clamped(0.0, 1.0);
            vec![(v, 1.0 - part), (w, part)]
        }
        [first, ..] => {
            // The triangle of the fan whose least weight is greatest.
            let mut best = (f64::NEG_INFINITY, vec![(first, 1.0)]);
            for ends in corners[1..].windows(2) {
                let corner = [first, ends[0], ends[1]];
                let (u, v, w) = (
                    all[corner[1]] - all[first],
                    all[corner[2]] - all[first],
                    point - all[first],
                );
                let normal = u.cross(&v);
                let square = normal.norm_squared();
                let [y, z] = [w.cross(&v), u.cross(&w)].map(|part| part.dot(&normal) / square);
                let parts = [1.0 - y - z, y, z];
                let least = parts.iter().copied().fold(f64::INFINITY, f64::smaller);
                if least > best.0 {
                    let each = corner.iter().zip(parts);
                    best = (least, each.map(|(v, part)| (*v, part.at_least(0.0))).collect());
                }
            }
            best.1
        }
    }
}

fn mean(hull: &ConvexPolyhedron, on: &[(usize, f64)]) -> Vector3<f64> {
    let all: Vec<Point3<f64>> = hull.vertex_points().collect();
    let total: f64 = on.iter().map(|x| x.1).sum();
    on.iter().map(|(k, part)| all[*k].coords * (part / total)).sum()
}

pub(super) fn weights_text(on: &[(usize, f64)]) -> String {
    let all: Vec<String> = on.iter().map(|(k, part)| format!("[{k},\"{}\"]", hex(*part))).collect();
    format!("[{}]", all.join(","))
}
