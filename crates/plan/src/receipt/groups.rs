//! Ranges of the parts of a body, each with its hull.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::scene::Body;
use super::stated::{Ellipsoid, half, hull_of};
use crate::extremes::Extremes;
use lin_canny::polyhedron::ConvexPolyhedron;
use lin_canny::{ContactState, Geometry, PairTracker, RelativePose, Tracker};

/// Some parts of a body: their hull, and which point of the body each of its vertices is.
///
/// With ellipsoids, the hull is nearly that of the parts, and its vertices have no numbers: it proposes, and proves nothing.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) hull: Arc<ConvexPolyhedron>,
    pub(super) points: Vec<usize>,
    pub(super) vertices: Vec<Vector3<f64>>,
    pub(super) ellipsoids: Vec<Ellipsoid>,
    /// The greatest radius of the parts.
    pub(super) radius: f64,
    /// The body or the only part itself, if it is not the hull.
    curved: Option<Geometry>,
    /// Diagonal of the box.
    pub(super) size: f64,
}

impl Group {
    fn new(body: &Body, [low, high]: [usize; 2]) -> Option<Self> {
        if body.parts.is_empty() {
            let all = Self::of_hull(body.hull.clone(), (0..body.points.len()).collect());
            return all.map(|all| Self {
                ellipsoids: body.ellipsoids.clone(),
                radius: body.radius,
                curved: body.curved.first().cloned().flatten(),
                ..all
            });
        }
        let radius = body.radius_of([low, high]);
        let mut named: Vec<usize> = body.parts.get(low..high)?.iter().flatten().copied().collect();
        named.sort_unstable();
        named.dedup();
        let cloud: Vec<Point3<f64>> = named.iter().map(|k| body.points[*k]).collect();
        // Sorted by their points, of which each has one at most.
        let about = |k: &usize| body.ellipsoids.binary_search_by_key(k, |of| of.centre).ok();
        let ellipsoids: Vec<Ellipsoid> = named
            .iter()
            .filter_map(about)
            .map(|k| body.ellipsoids[k].clone())
            .collect();
        if !ellipsoids.is_empty() {
            let samples = ellipsoids.iter().flat_map(Ellipsoid::samples);
            let nearly: Vec<Point3<f64>> = cloud.iter().copied().chain(samples).collect();
            let is_one = high == low + 1;
            return Some(Self {
                vertices: cloud.iter().map(|p| p.coords).collect(),
                curved: is_one.then(|| body.curved.get(low).cloned().flatten()).flatten(),
                ellipsoids,
                radius,
                ..Self::of_hull(Arc::new(hull_of(&nearly)?), Vec::new())?
            });
        }
        let hull = hull_of(&cloud)?;
        let mut numbers = BTreeMap::new();
        let key = |p: &Point3<f64>| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
        for (k, p) in named.iter().zip(&cloud) {
            numbers.entry(key(p)).or_insert(*k);
        }
        let points: Option<Vec<usize>> = hull.vertex_points().map(|p| numbers.get(&key(&p)).copied()).collect();
        let group = Self::of_hull(Arc::new(hull), points?);
        group.map(|group| Self { radius, ..group })
    }

    fn of_hull(hull: Arc<ConvexPolyhedron>, points: Vec<usize>) -> Option<Self> {
        let vertices: Vec<Vector3<f64>> = hull.vertex_points().map(|p| p.coords).collect();
        let first = *vertices.first()?;
        let [low, high] = vertices.iter().fold([first; 2], |[low, high], p| {
            [low.zip_map(p, f64::smaller), high.zip_map(p, f64::larger)]
        });
        Some(Self {
            hull,
            points,
            vertices,
            ellipsoids: Vec::new(),
            radius: 0.0,
            curved: None,
            size: (high - low).norm(),
        })
    }
}

/// Returns the unit direction from the closest point of A to that of B in the frame of A, and an upper bound
/// of the distance without the radii, if they are apart.
pub(super) fn direction([a, b]: [&Group; 2], relative: &RelativePose) -> Option<(Vector3<f64>, f64)> {
    let seen = match (&a.curved, &b.curved) {
        (None, None) => Tracker::new().closest(&a.hull, &b.hull, relative),
        _ => {
            let whole = |of: &Group| {
                of.curved
                    .clone()
                    .unwrap_or_else(|| Geometry::Polyhedron(of.hull.clone()))
            };
            PairTracker::new().closest(&whole(a), &whole(b), relative).outcome
        }
    };
    let radii = [a, b].map(|of| if of.curved.is_some() { of.radius } else { 0.0 });
    (seen.state == ContactState::Separated).then(|| (seen.normal.into_inner(), seen.upper + radii[0] + radii[1]))
}

/// The groups of a body that were made already.
pub(super) struct Groups<'a> {
    body: &'a Body,
    known: RefCell<BTreeMap<[usize; 2], Option<Rc<Group>>>>,
}

impl<'a> Groups<'a> {
    pub(super) fn new(body: &'a Body) -> Self {
        let known = RefCell::default();
        Self { body, known }
    }

    /// Returns all parts of the body.
    pub(super) fn all(&self) -> [usize; 2] {
        [0, self.body.parts.len()]
    }

    pub(super) fn get(&self, range: [usize; 2]) -> Option<Rc<Group>> {
        let mut known = self.known.borrow_mut();
        let group = known
            .entry(range)
            .or_insert_with(|| Group::new(self.body, range).map(Rc::new));
        group.clone()
    }
}

/// Appends pairs of single parts that are at most `reach` apart, at most so many.
pub(super) fn near_parts(
    groups: &[Groups<'_>; 2],
    ranges: [[usize; 2]; 2],
    a_from_b: &RelativePose,
    reach: f64,
    most: usize,
    found: &mut Vec<[Rc<Group>; 2]>,
) {
    let (Some(x), Some(y)) = (groups[0].get(ranges[0]), groups[1].get(ranges[1])) else {
        return;
    };
    let far = Tracker::new().closest(&x.hull, &y.hull, a_from_b).lower > reach;
    if far || found.len() == most {
        return;
    }
    let is_cut = |side: usize| ranges[side][1] > ranges[side][0] + 1;
    let side = match [is_cut(0), is_cut(1)] {
        [false, false] => return found.push([x, y]),
        [true, true] => usize::from(y.size > x.size),
        [first, _] => usize::from(!first),
    };
    let [mut lower, mut upper] = [ranges; 2];
    let middle = half(ranges[side]);
    (lower[side][1], upper[side][0]) = (middle, middle);
    for ranges in [lower, upper] {
        near_parts(groups, ranges, a_from_b, reach, most, found);
    }
}
