//! From many planes around a body to few: the plane whose loss makes the cover grow least is
//! removed, again and again. It proposes: nothing relies on the choice.
//!
//! With a point inside as the origin, the plane `n . x = s` is the point `w = n / s`. The hull of
//! these points, the *dual*, has a vertex for each plane that bounds the cover, and a face for each
//! corner: the face in the plane `m . w = o` is the corner `m / o`. Without a plane, the faces at
//! its point are replaced by faces of the points around it.
//!
//! At last the choice is improved at the farthest corner: a new plane cuts it off and another is
//! removed, or a plane of the corner is tilted.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::inner::{FromInner, Inner};
use super::supports::{Support, Supports};
use crate::base::num::extremes::Extremes;
use crate::base::num::sort::sort;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, VertexId};

/// A corner that another plane cuts off by more than this part of the plane's height is none.
const SLACK: f64 = 1.0 / 16.0;

/// A corner farther than this many sizes from the point inside counts as infinitely far.
const FAR: f64 = (1u64 << 30) as f64;

/// Weights of two planes that are replaced by a plane between them.
const WEIGHTS: [f64; 9] = [0.0039, 0.0156, 0.0625, 0.25, 1.0, 4.0, 16.0, 64.0, 256.0];

/// Steps that improve a choice, each accepted if the sum of the eighth powers of the distances
/// falls by this part; the least tilt of a plane.
const ROUNDS: usize = 192;
const PROGRESS: f64 = 1.0 / 256.0;
const LEAST_STEP: f64 = 1.0 / 64.0;

/// A distance from the body below this many sizes is not improved.
const ENOUGH: f64 = 1.0 / (1u64 << 36) as f64;

/// A supporting plane, and its point of the dual.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) support: Support,
    pub(super) point: Vector3<f64>,
}

/// The dual of planes that bound a body.
pub(super) struct Dual {
    pub(super) hull: ConvexPolyhedron,
    /// The plane of each vertex.
    pub(super) planes: Vec<Plane>,
    /// The number of that plane in the list of which the dual was made.
    numbers: Vec<usize>,
}

impl Dual {
    /// Returns the dual of planes; `None` unless they bound a body.
    ///
    /// The point inside is strictly inside the dual, too: this is exact.
    pub(super) fn new(planes: &[Plane]) -> Option<Self> {
        let points: Vec<_> = planes.iter().map(|plane| Point3::from(plane.point)).collect();
        let hull = ConvexPolyhedron::from_points(&points).ok()?;
        let numbers: Vec<usize> = hull.vertices().filter_map(|v| hull.source_vertex(v)).collect();
        let used = numbers.iter().map(|k| planes[*k]).collect();
        let is_around = hull.side_of(&Point3::origin()) < 0;
        is_around.then_some(Self {
            hull,
            planes: used,
            numbers,
        })
    }

    /// Returns the vertices of the faces at a vertex, without this vertex.
    fn around(&self, vertex: VertexId) -> Vec<VertexId> {
        let faces = self.hull.vertex_faces(vertex);
        let mut all: Vec<VertexId> = faces.flat_map(|face| self.hull.face_vertices(face)).collect();
        sort(&mut all, Ord::cmp);
        all.dedup();
        all.retain(|v| *v != vertex);
        all
    }
}

/// Returns the corner that a face of a dual is, over the point inside; `None` if it is too far.
fn corner(hull: &ConvexPolyhedron, face: FaceId) -> Option<Vector3<f64>> {
    let (m, o) = hull.face_plane(face)?;
    let corner = m.into_inner() / o;
    (o > 0.0 && corner.amax() < FAR).then_some(corner)
}

/// How far a cover is from the body, in sizes.
struct Cost {
    farthest: f64,
    /// Sum of the eighth powers of the distances of the corners.
    sum: f64,
    /// The farthest corner as a face of the dual, and the direction in which it sticks out.
    face: FaceId,
    out: Vector3<f64>,
}

/// The choice of planes around a body.
pub(super) struct Chooser<'a, 'b> {
    supports: &'b Supports<'a>,
    /// The point inside, in the coordinates of the inner hull.
    middle: Point3<f64>,
    from_inner: FromInner<'b>,
}

impl<'a, 'b> Chooser<'a, 'b> {
    pub(super) fn new(supports: &'b Supports<'a>, inner: &'b Inner) -> Self {
        Self {
            supports,
            middle: inner.middle(),
            from_inner: FromInner::new(inner),
        }
    }

    /// Returns the dual of at most `count` planes of a list, or of planes near some of them; `None`
    /// if the planes do not bound the body.
    pub(super) fn choose(&mut self, candidates: Vec<Support>, count: usize) -> Option<Dual> {
        let planes: Vec<Plane> = candidates
            .into_iter()
            .filter_map(|support| self.plane(support))
            .collect();
        let mut best = self.reduced(&planes, count)?;
        let mut cost = self.cost(&best);
        let (mut step, mut is_cut) = (0.5, true);
        for _ in 0..ROUNDS {
            if cost.farthest <= ENOUGH || step < LEAST_STEP {
                break;
            }
            let next = if is_cut {
                self.cut(&best, &cost, count)
            } else {
                self.tilted(&best, &cost, step)
            };
            match next.filter(|(_, next)| next.sum < cost.sum * (1.0 - PROGRESS)) {
                Some(next) => (best, cost) = next,
                None if is_cut => is_cut = false,
                None => (step, is_cut) = (0.5 * step, true),
            }
        }
        Some(best)
    }

    /// Removes planes until at most `count` are left.
    fn reduced(&mut self, planes: &[Plane], count: usize) -> Option<Dual> {
        let mut dual = Dual::new(planes)?;
        // Infinite for planes without which the others bound no body: they are never removed.
        let mut costs = vec![f64::INFINITY; planes.len()];
        if dual.planes.len() > count {
            for v in dual.hull.vertices() {
                costs[dual.numbers[v.index()]] = self.cost_without(&dual, v);
            }
        }
        while dual.planes.len() > count {
            let mut least = (None, f64::INFINITY);
            for v in dual.hull.vertices() {
                let cost = costs[dual.numbers[v.index()]];
                if cost < least.1 {
                    least = (Some(v), cost);
                }
            }
            let Some(vertex) = least.0 else { break };
            let number = dual.numbers[vertex.index()];
            costs[number] = f64::INFINITY;
            let left: Vec<usize> = dual.numbers.iter().copied().filter(|k| *k != number).collect();
            let chosen: Vec<Plane> = left.iter().map(|k| planes[*k]).collect();
            let Some(mut next) = Dual::new(&chosen) else { continue };
            next.numbers.iter_mut().for_each(|k| *k = left[*k]);
            let near: Vec<usize> = dual.around(vertex).iter().map(|v| dual.numbers[v.index()]).collect();
            for v in next.hull.vertices() {
                let number = next.numbers[v.index()];
                if near.contains(&number) && costs[number] < f64::INFINITY {
                    costs[number] = self.cost_without(&next, v);
                }
            }
            dual = next;
        }
        while dual.planes.len() > count {
            dual = self.joined(&dual)?;
        }
        Some(dual)
    }

    /// Returns the planes with one more, which cuts off the farthest corner, and one less.
    fn cut(&mut self, dual: &Dual, cost: &Cost, count: usize) -> Option<(Dual, Cost)> {
        let plane = self.supports.along(&cost.out).and_then(|support| self.plane(support))?;
        let planes: Vec<Plane> = dual.planes.iter().copied().chain([plane]).collect();
        let next = self.reduced(&planes, count)?;
        let cost = self.cost(&next);
        Some((next, cost))
    }

    /// Returns the planes with one of those at the farthest corner tilted: the best such list.
    fn tilted(&mut self, dual: &Dual, cost: &Cost, step: f64) -> Option<(Dual, Cost)> {
        let mut best: Option<(Dual, Cost)> = None;
        for vertex in dual.hull.face_vertices(cost.face) {
            let k = vertex.index();
            let n = dual.planes[k].support.space.normal().into_inner();
            let across = n.cross(&cost.out);
            for way in [cost.out, -cost.out, across, -across] {
                let tilted = self
                    .supports
                    .along(&(n + way * step))
                    .and_then(|support| self.plane(support));
                let Some(plane) = tilted else { continue };
                let mut planes = dual.planes.clone();
                planes[k] = plane;
                let Some(next) = Dual::new(&planes) else { continue };
                let cost = self.cost(&next);
                if best.as_ref().is_none_or(|(_, least)| cost.sum < least.sum) {
                    best = Some((next, cost));
                }
            }
        }
        best
    }

    /// Returns the plane with its point; `None` unless the point inside is below the plane.
    fn plane(&self, support: Support) -> Option<Plane> {
        let (space, unit) = (&support.space, self.supports.unit);
        let height = (space.offset() - space.normal().dot(&(self.middle * unit).coords)) / unit;
        let point = space.normal().into_inner() / height;
        (height > 0.0 && point.amax() < f64::INFINITY).then_some(Plane { support, point })
    }

    /// Returns how far the cover is from the body near a plane that is left out.
    fn cost_without(&mut self, dual: &Dual, vertex: VertexId) -> f64 {
        let ring = dual.around(vertex);
        let points = ring.iter().filter_map(|v| dual.hull.vertex(*v));
        let points: Vec<_> = points.chain([Point3::origin()]).collect();
        let Ok(local) = ConvexPolyhedron::from_points(&points) else {
            return f64::MAX;
        };
        let mut cost = 0.0f64;
        for face in local.faces() {
            // Faces through the point inside are sides of the cone of the points around.
            if local.face_side(face, &(-local.origin / local.unit())) == 0.0 {
                continue;
            }
            let Some(corner) = corner(&local, face) else {
                return f64::MAX;
            };
            let others = dual.hull.vertices().zip(&dual.planes).filter(|(v, _)| *v != vertex);
            let is_cut = |(_, plane): (VertexId, &Plane)| plane.point.dot(&corner) > 1.0 + SLACK;
            if !others.into_iter().any(is_cut) {
                cost = cost.larger(self.from_inner.distance(&(self.middle + corner)).0);
            }
        }
        cost
    }

    /// Returns the dual with two planes replaced by one between them: the one that sticks out
    /// least.
    ///
    /// Some lists of at most six planes cannot be made shorter otherwise, such as those of a box.
    fn joined(&mut self, dual: &Dual) -> Option<Dual> {
        let mut best: (Option<Dual>, f64) = (None, f64::INFINITY);
        for i in 0..dual.planes.len() {
            for j in 0..i {
                let mut rest = dual.planes.clone();
                let (a, b) = (rest.remove(i), rest.remove(j));
                for weight in WEIGHTS {
                    let between = self.supports.along(&(a.point + b.point * weight));
                    let Some(plane) = between.and_then(|support| self.plane(support)) else {
                        continue;
                    };
                    let planes: Vec<Plane> = rest.iter().copied().chain([plane]).collect();
                    let Some(next) = Dual::new(&planes) else { continue };
                    let cost = self.cost(&next).farthest;
                    if cost < best.1 {
                        best = (Some(next), cost);
                    }
                }
            }
        }
        best.0
    }

    /// Returns how far a cover is from the body.
    fn cost(&mut self, dual: &Dual) -> Cost {
        let mut cost = Cost {
            farthest: -1.0,
            sum: 0.0,
            face: FaceId(0),
            out: Vector3::zeros(),
        };
        for face in dual.hull.faces() {
            let corner = corner(&dual.hull, face).unwrap_or_else(|| Vector3::repeat(FAR));
            let (d, out) = self.from_inner.distance(&(self.middle + corner));
            let square = d * d;
            cost.sum += square * square * square * square;
            if d > cost.farthest {
                (cost.farthest, cost.face, cost.out) = (d, face, out);
            }
        }
        cost
    }
}
