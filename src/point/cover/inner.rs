//! The hull of points of the body, and planes that may bound a cover. They propose: nothing relies
//! on them.

use alloc::vec;
use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use super::supports::{Support, Supports};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::polyhedron::build::error::BuildError;
use crate::point::{PointQuery, PointTracker};

/// A face of the inner hull is right if the body is higher by less than this part of the size.
/// Planes whose normals differ by less are one.
const NEAR: f64 = 1.0 / (1u64 << 40) as f64;

/// Half the thickness of the inner hull of a flat body, as a part of the size and of the largest
/// coordinate.
const THIN: f64 = NEAR;
const THIN_PLACE: f64 = 1.0 / (1u64 << 50) as f64;

/// Two faces form a sharp edge if the cosine of their normals is less than this.
const SHARP: f64 = -0.5;

/// The hull of some points of a body. Coordinates are those of the body over `Supports::unit`.
pub(super) struct Inner {
    points: Vec<Point3<f64>>,
    pub(super) hull: ConvexPolyhedron,
}

impl Inner {
    /// Returns the hull of about `most` points of the body; `None` if there is none.
    ///
    /// Faces below the body are moved outward, those farthest below first.
    pub(super) fn new(supports: &Supports<'_>, most: usize) -> Option<Self> {
        let mut points = vec![];
        for k in 0..27 {
            let way = Vector3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1).map(f64::from);
            points.extend(supports.along(&way).map(|s| s.point / supports.unit));
        }
        let mut inner = Self::of(points)?;
        while inner.points.len() < most {
            let mut found = vec![];
            for (n, offset) in inner.planes().into_iter().chain(inner.sharp_edges()) {
                if let Some(support) = supports.along(&n) {
                    let p = support.point / supports.unit;
                    found.push((n.dot(&p.coords) - offset, p));
                }
            }
            sort(&mut found, |a, b| b.0.total_cmp(&a.0));
            let worst = found.first().map_or(0.0, |first| first.0);
            found.retain(|(height, _)| *height > NEAR && *height > 0.5 * worst);
            found.truncate(most - inner.points.len());
            if !inner.add(found.into_iter().map(|(_, p)| p)) {
                break;
            }
        }
        Some(inner)
    }

    /// Returns the hull of points. A flat one becomes thin: two pyramids along each axis.
    fn of(mut points: Vec<Point3<f64>>) -> Option<Self> {
        let mut all: Vec<Point3<f64>> = vec![];
        points.retain(|p| {
            !all.contains(p) && {
                all.push(*p);
                true
            }
        });
        let first = *points.first()?;
        let hull = match ConvexPolyhedron::from_points(&points) {
            Err(BuildError::Flat { .. } | BuildError::TooFewPoints { .. } | BuildError::OutOfRange { .. }) => {
                let thin = THIN.larger(first.coords.amax() * THIN_PLACE);
                for k in 0..3 {
                    let way = Vector3::ith(k, thin);
                    points.extend([first + way, first - way]);
                }
                ConvexPolyhedron::from_points(&points)
            }
            hull => hull,
        };
        hull.ok().map(|hull| Self { points, hull })
    }

    /// Adds points to the hull. Returns whether one is new.
    pub(super) fn add(&mut self, more: impl IntoIterator<Item = Point3<f64>>) -> bool {
        let (mut points, before) = (self.points.clone(), self.points.len());
        for p in more {
            if !points.contains(&p) {
                points.push(p);
            }
        }
        let is_new = points.len() > before;
        match Self::of(points).filter(|_| is_new) {
            Some(next) => {
                *self = next;
                true
            }
            None => false,
        }
    }

    /// Returns the planes of the faces: normals and offsets.
    fn planes(&self) -> Vec<(Vector3<f64>, f64)> {
        let planes = self.hull.faces().filter_map(|face| self.hull.face_plane(face));
        planes.map(|(n, offset)| (n.into_inner(), offset)).collect()
    }

    /// Returns the planes at sharp edges that are as far from both faces: normals and offsets.
    ///
    /// The faces of a flat body have nearly two normals only.
    fn sharp_edges(&self) -> Vec<(Vector3<f64>, f64)> {
        let plane = |edge| {
            let [m, n] = self.hull.edge_faces(edge)?.each(|f| self.hull.face_plane(f));
            let (m, n) = (m?.0.into_inner(), n?.0.into_inner());
            let [a, b] = self.hull.edge_vertices(edge)?.each(|v| self.hull.vertex(v));
            let out = unit(&unit(&(b? - a?)).cross(&(m - n)));
            let out = if out.dot(&(m + n)) < 0.0 { -out } else { out };
            (m.dot(&n) < SHARP).then_some((out, out.dot(&a?.coords)))
        };
        self.hull.edges().filter_map(plane).collect()
    }

    /// Returns the mean of the vertices.
    pub(super) fn middle(&self) -> Point3<f64> {
        let share = 1.0 / self.hull.vertex_count() as f64;
        let first = self.hull.vertex_points().next().unwrap_or_else(Point3::origin);
        let sum = |sum: Vector3<f64>, p: Point3<f64>| sum + (p - first) * share;
        first + self.hull.vertex_points().fold(Vector3::zeros(), sum)
    }

    /// Returns supporting planes of the body along the normals of the faces, the axes, and the
    /// directions between the two faces of sharp edges.
    pub(super) fn candidates(&self, supports: &Supports<'_>) -> Vec<Support> {
        let planes = self.planes().into_iter().chain(self.sharp_edges());
        let mut ways: Vec<Vector3<f64>> = planes.map(|(n, _)| n).collect();
        let frame = self.frame();
        ways.extend((0..3).map(|k| Vector3::ith(k, 1.0)).chain(frame).flat_map(|n| [n, -n]));
        let mut all: Vec<Support> = vec![];
        for support in ways.iter().filter_map(|n| supports.along(n)) {
            let n = support.space.normal();
            let is_near = |other: &Support| (other.space.normal().into_inner() - n.into_inner()).amax() < NEAR;
            if !all.iter().any(is_near) {
                all.push(support);
            }
        }
        all
    }

    /// Returns three orthogonal directions: about the longest extent, the longest across, the rest.
    fn frame(&self) -> [Vector3<f64>; 3] {
        let points: Vec<Point3<f64>> = self.hull.vertex_points().collect();
        let most = |measure: &dyn Fn(&Point3<f64>) -> f64| {
            let start = (self.middle(), -1.0);
            let better = |best: (Point3<f64>, f64), p: &Point3<f64>| {
                let m = measure(p);
                if m > best.1 { (*p, m) } else { best }
            };
            points.iter().fold(start, better).0
        };
        let middle = self.middle();
        let one = most(&|p| (p - middle).norm_squared());
        let other = most(&|p| (p - one).norm_squared());
        let x = unit(&(other - one));
        let across = |p: &Point3<f64>| (p - one) - x * x.dot(&(p - one));
        let far = across(&most(&|p| across(p).norm_squared()));
        let y = if far.amax() > NEAR {
            unit(&far)
        } else {
            unit(&x.cross(&Vector3::ith(x.iamin(), 1.0)))
        };
        [x, y, x.cross(&y)]
    }
}

/// Returns a vector of length one; a vector that is zero stays.
fn unit(v: &Vector3<f64>) -> Vector3<f64> {
    let size = v.amax();
    if !(size > 0.0) {
        return *v;
    }
    let v = v / size;
    v / sqrt(v.norm_squared())
}

/// Distances of points from the inner hull, in its coordinates.
pub(super) struct FromInner<'a> {
    query: PointQuery<'a>,
    tracker: PointTracker,
}

impl<'a> FromInner<'a> {
    pub(super) fn new(inner: &'a Inner) -> Self {
        Self {
            query: PointQuery::new(&inner.hull),
            tracker: PointTracker::new(),
        }
    }

    /// Returns an upper bound of the distance, not negative, and the outward direction from the
    /// closest point; infinite beyond the range of coordinates.
    pub(super) fn distance(&mut self, p: &Point3<f64>) -> (f64, Vector3<f64>) {
        match self.tracker.closest_point(&self.query, p) {
            Ok(found) => (found.upper.larger(0.0), found.normal.into_inner()),
            Err(_) => (f64::INFINITY, Vector3::zeros()),
        }
    }
}
