//! A convex region inside a solid mesh around an interior point.
//!
//! ```text
//!     +-----------.   own plane of the nearest triangle
//!     |    x      |
//!     |     `.    |   A plane through the point of a triangle that is nearest to x, upright on
//!     +--------`--+   the way there, has the triangle beyond it. So has the plane of a triangle
//!              / \    that x is below.
//! ```
//!
//! Triangles are processed in order of their distance, the nearest first. A triangle that is
//! already outside a plane needs no separate plane. For any other triangle, its own plane is added
//! if x is far enough below it. Otherwise the plane passes through the nearest point of the
//! triangle, perpendicular to the direction from x to this point. No triangle is below all planes,
//! so the region there is wholly inside or wholly outside the mesh, and a winding number decides.
//! The triangles and the vertices of the region are then checked against the planes, so no earlier
//! step has to be correct.
//!
//! Source: the first step of IRIS (Deits and Tedrake 2015, "Computing large convex regions of
//! obstacle-free space through semidefinite programming"), with a ball instead of the ellipsoid.
//! Departure: the plane of the triangle itself is used where it suffices.

use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use crate::base::num::Ranked;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::CELL;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::Shape;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::mesh::measure::From;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::penetration::BEYOND;
use crate::nonconvex::query::triangle;
use crate::nonconvex::tree::Below;
use crate::nonconvex::tree::height;

/// Maximum number of planes of a convex region; with more, the region is made half as wide.
///
/// In the overlaps of `CELL_REACH` the bounds are equal with 32 and with 512.
const CELL_PLANES: usize = 128;

/// Number of widths tried for a convex region. In the overlaps of `CELL_REACH` the bounds are equal
/// with one.
const CELL_HALVINGS: usize = 4;

/// Returns a convex body inside a solid mesh around a point; `None` if none is found.
///
/// The body is in the caller's unit and extends at most `reach` to each side. The point is in
/// stored coordinates.
pub(super) fn cell(mesh: &Mesh, place: &Vector3<f64>, reach: f64) -> Option<Shape> {
    let mut reach = reach.smaller(2.0 * mesh.half_size() / mesh.unit());
    let (planes, margin) = (0..CELL_HALVINGS).find_map(|_| {
        let cut = CellCut::new(mesh, place, reach).run();
        reach *= 0.5;
        cut
    })?;
    let all = corners(mesh, place, &planes, margin)?;
    let body = ConvexPolyhedron::from_points(&all).ok()?;
    let stored = |p: Point3<f64>| p.coords / mesh.unit();
    let is_in = |p: &Vector3<f64>| planes.iter().all(|plane| plane.n.dot(p) <= plane.level);
    let is_free = body.vertex_points().map(stored).all(|p| is_in(&p));
    let first = body.vertex_points().next().map(stored)?;
    let is_inside = is_free && mesh.winding(&first).is_some_and(|w| w != 0);
    is_inside.then(|| Shape::from(body))
}

/// A plane of the cell with normal `n`.
///
/// The cell is at most `level` high along `n`. Every triangle outside the plane is higher by more
/// than a margin.
struct CellPlane {
    n: Vector3<f64>,
    level: f64,
}

impl CellPlane {
    /// Returns how far a point is below the plane, minus the rounding error of a vertex of the
    /// cell.
    fn room(&self, place: &Vector3<f64>, margin: f64) -> f64 {
        self.level - margin - self.n.dot(place)
    }
}

/// The index of a node or a triangle, and whether it is a triangle; ranked by a lower bound of the
/// distance.
type OpenNode = Ranked<(u32, bool)>;

/// The planes around a point.
struct CellCut<'a> {
    mesh: &'a Mesh,
    place: &'a Vector3<f64>,
    from: From<'a>,
    planes: Vec<CellPlane>,
    /// Twice the rounding error of the height of a vertex of a triangle or of the cell.
    margin: f64,
    open: BinaryHeap<OpenNode>,
}

impl<'a> CellCut<'a> {
    fn new(mesh: &'a Mesh, place: &'a Vector3<f64>, reach: f64) -> Self {
        let box_plane = |k: usize| {
            let mut n = Vector3::zeros();
            n[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            CellPlane {
                level: n.dot(place) + reach,
                n,
            }
        };
        Self {
            planes: (0..6).map(box_plane).collect(),
            margin: CELL * (mesh.radius + 2.0 * reach),
            from: From::new(&mesh.tree, place),
            open: BinaryHeap::new(),
            mesh,
            place,
        }
    }

    /// Returns the planes and the margin; `None` if there are too many, or if a triangle is too
    /// near.
    fn run(mut self) -> Option<(Vec<CellPlane>, f64)> {
        self.add(false, 0);
        while let Some(open) = self.open.pop() {
            let (number, is_triangle) = open.key;
            if is_triangle {
                self.part(number)?;
                continue;
            }
            match self.mesh.tree.below(number) {
                Below::Children(c) => (c..c + 2).for_each(|node| self.add(false, node)),
                Below::Leaf(first, count) => (first..first + count).for_each(|t| self.add(true, t)),
            }
        }
        Some((self.planes, self.margin))
    }

    /// Adds a node or a triangle unless it is outside a plane.
    fn add(&mut self, is_triangle: bool, number: u32) {
        let rank = if is_triangle {
            let (square, _) = triangle::nearest(self.place, &self.mesh.corners(number));
            sqrt(square)
        } else {
            self.from.least(number)
        };
        let is_beyond = |plane: &CellPlane| {
            let lowest = -height(&self.mesh.tree, number, &-plane.n);
            lowest >= plane.level + 2.0 * self.margin
        };
        if is_triangle || !self.planes.iter().rev().any(is_beyond) {
            self.open.push(Ranked {
                rank,
                key: (number, is_triangle),
                item: (),
            });
        }
    }

    /// Adds a plane between the point and a triangle, if the triangle is not outside any plane.
    fn part(&mut self, number: u32) -> Option<()> {
        let corners = self.mesh.corners(number);
        let lowest = |n: &Vector3<f64>| corners.iter().map(|p| n.dot(p)).fold(f64::INFINITY, f64::smaller);
        if self.planes.iter().rev().any(|p| lowest(&p.n) >= p.level + self.margin) {
            return Some(());
        }
        let (square, foot) = triangle::foot_of(self.place, &corners);
        let distance = sqrt(square);
        let own = triangle::normal(&corners);
        let length = sqrt(own.norm_squared());
        let own = own / length;
        let rise = own.dot(&(corners[0] - self.place));
        // False for NaN.
        let n = if rise >= 0.5 * distance {
            own
        } else {
            (foot - self.place) / distance
        };
        let level = lowest(&n) - 2.0 * self.margin;
        let plane = CellPlane { n, level };
        if !(plane.room(self.place, self.margin) > 0.0) || self.planes.len() == CELL_PLANES {
            return None;
        }
        self.planes.push(plane);
        Some(())
    }
}

/// Returns the vertices of the region below all planes, in the caller's unit.
///
/// The region is the polar of the hull of the planes' poles.
fn corners(mesh: &Mesh, place: &Vector3<f64>, planes: &[CellPlane], margin: f64) -> Option<Vec<Point3<f64>>> {
    let room = |plane: &CellPlane| plane.room(place, margin);
    let poles: Vec<_> = planes.iter().map(|p| Point3::from(p.n / room(p))).collect();
    let polar = ConvexPolyhedron::from_points(&poles).ok()?;
    let corner = |(n, offset): (nalgebra::Unit<Vector3<f64>>, f64)| (offset > 0.0).then(|| n.into_inner() / offset);
    let ways: Vec<_> = polar
        .faces()
        .map(|f| polar.face_plane(f).and_then(corner))
        .collect::<Option<_>>()?;
    // Rounding may put vertices outside planes.
    let beyond = |way: &Vector3<f64>| planes.iter().map(|p| p.n.dot(way) / room(p)).fold(1.0, f64::larger);
    let most = ways.iter().map(beyond).fold(1.0, f64::larger) * BEYOND;
    Some(ways.iter().map(|way| mesh.given(&(place + way / most))).collect())
}
