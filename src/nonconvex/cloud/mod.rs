//! Clouds: one convex element at many points, under the tree and the front of meshes.
//!
//! A leaf of the tree has up to sixteen points, and the box of a node contains the elements of its
//! points. Only the construction of the tree (`tree/morton`) and the leaves differ from meshes;
//! searches, fronts, casts and depths are those of [`Parted`] bodies.

#[cfg(feature = "serde")]
mod persist;
mod points;

use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use self::points::{Points, Radii};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::scalar::sqrt;
use crate::base::num::sort::sort_by_key;
use crate::base::tolerance::{EXPONENT_FREE, EXTENT_MAX, PLACE_MAX, UNIT};
use crate::body::polyhedron::{BuildError, ConvexPolyhedron, exponent_of, far_origin, power_of_two};
use crate::body::shape::{Shape, ShapeError, is_rounding};
#[cfg(feature = "exact")]
use crate::convex::exact::place::ExactVector;
use crate::nonconvex::near_parts::{NearItems, outcome_of_ball, outcome_of_box, outcome_of_shape};
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::pieces::{Compound, CompoundError, Piece, inner_points};
use crate::nonconvex::query::frame::TreeSide;
use crate::nonconvex::separation::ball_about;
use crate::nonconvex::tree::Tree;
use crate::nonconvex::tree::morton::ElementExtent;
use crate::pair::point::PointOutcome;
use crate::pair::transform::StoredFrame;

/// Largest number of points: the index of an item in a leaf has 27 bits.
const POINTS_MOST: usize = 1 << 27;

/// The convex body that is at every point of a [`Cloud`].
///
/// Lengths are in the caller's unit. The element has the frame of the cloud, shifted to the point.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum CloudElement {
    /// A ball with this radius; zero for the point itself.
    Ball(f64),
    /// A ball with a radius per point, zero for the point itself.
    Balls(Vec<f64>),
    /// A box with these half extents, all positive, along the axes of the cloud.
    Box(Vector3<f64>),
    /// A shape of any kind.
    Shape(Shape),
}

impl From<Shape> for CloudElement {
    fn from(shape: Shape) -> Self {
        Self::Shape(shape)
    }
}

/// Error returned if points and an element do not form a valid cloud.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// There is no point, or there are more than 2^27.
    #[error("number of points is out of range: {count} (expected 1..=134217728)")]
    Count {
        /// Number of points given.
        count: usize,
    },
    /// A coordinate is not finite, or its absolute value is 1e116 or more.
    #[error("point {point} is not finite or farther than 1e116 from the origin: {value:?}")]
    Point {
        /// Index of the point.
        point: usize,
        /// The coordinates.
        value: [f64; 3],
    },
    /// The extent of the cloud is larger than 1e100.
    #[error("extent of the cloud is out of range: {extent:e} (expected at most 1e100)")]
    Extent {
        /// Longest side of the bounding box of all points.
        extent: f64,
    },
    /// A radius is negative, not finite, or out of the range of a ball.
    #[error("radius of point {point} is out of range: {radius:?}")]
    Radius {
        /// Index of the point; zero if all points have this radius.
        point: usize,
        /// The radius.
        radius: f64,
    },
    /// The numbers of points and of radii, or of cells and of bits, differ.
    #[error("number of {what} is {count} (expected {expected})")]
    Length {
        /// The name of what was counted.
        what: &'static str,
        /// Number of entries given.
        count: usize,
        /// Number of entries expected.
        expected: usize,
    },
    /// The number of cells of a grid along an axis is larger than 65,536.
    #[error("number of cells along axis {axis} is out of range: {count} (expected at most 65536)")]
    Cells {
        /// The axis, 0 to 2.
        axis: usize,
        /// Number of cells.
        count: usize,
    },
    /// The element is invalid.
    #[error(transparent)]
    Element(#[from] ShapeError),
}

/// The element as queries use it.
#[derive(Clone, Debug)]
enum Element {
    Ball(f64),
    Balls(Radii),
    Box(Vector3<f64>),
    Shape,
}

/// One convex element at many points: points of a depth camera, voxels, particles.
///
/// The body is the union of the elements, each of them a solid, and has the frame of the caller's
/// points. The elements are never rotated relative to this frame. The cloud is immutable and `Send
/// + Sync`.
///
/// [`PairTracker`](crate::PairTracker) and scenes take a cloud like a compound. In an outcome, the
/// number of the point is the [`subshape`](crate::WitnessLocation::subshape) of its location.
///
/// If the frame of the cloud is the world, that is, if its pose is the identity, and all other
/// members have the frame of their body, then the poses of elements are not rounded. Distances are
/// then as tight, and predicates as exact, as for the element alone. At other poses, bounds are
/// wider by the rounding of composed poses, and ties count as within.
///
/// **Inside of a solid mesh.** A mesh that contains an element overlaps the cloud, in every query
/// and whether or not the surfaces meet. The witness is then a point of that element, but the
/// locations of the outcome are those of the closest pair of an element and a triangle.
///
/// **Contacts and surfaces.** Contacts are those of a compound of the elements near the other body,
/// which is made again when the bodies have moved. Against a Bézier surface, the whole cloud is
/// converted to a compound of some hundred bytes per point.
///
/// A cloud takes about 29 bytes per `f32` point, 41 per `f64` point, and 19 per cell of
/// [`from_cells`](Self::from_cells), its tree included (measured on 50,000 points of a sheet).
/// Balls with a radius per point take 4 bytes more, or 8 if a radius is no `f32`.
///
/// ```
/// use lin_canny::nalgebra::Isometry3;
/// use lin_canny::{Cloud, CloudElement, PairTracker, RelativePose};
/// use lin_canny::Shape;
///
/// // A floor of points, 10 cm apart, as a depth camera returns them.
/// let row = |k: u16| [f32::from(k / 40), f32::from(k % 40), 0.0];
/// let points: Vec<[f32; 3]> = (0..1600)
///     .map(|k| row(k).map(|x| 0.1 * x))
///     .collect();
/// let floor = Cloud::from_f32(&points, CloudElement::Ball(0.05))?;
/// let tool = Shape::capsule(0.2, 0.1)?;
/// let at = Isometry3::translation(2.0, 1.0, 0.5);
/// let floor_from_tool = RelativePose::from_isometry(&at)?;
/// let mut pair = PairTracker::new();
/// let found = pair.closest(&floor, &tool, &floor_from_tool);
/// assert!((found.distance - 0.15).abs() < 1e-6);
/// assert_eq!(points[found.locations[0].subshape as usize], [2.0, 1.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "point cloud")]
#[doc(alias = "voxels")]
#[doc(alias = "octree")]
#[derive(Clone, Debug)]
pub struct Cloud {
    /// In the order of the tree.
    points: Points,
    /// The caller's index of each point of the tree; empty if it is the same.
    order: Vec<u32>,
    element: Element,
    /// The element at the origin; of balls with a radius per point, the point.
    shape: Shape,
    /// An inner point of the element at the origin and another of its points.
    probes: [Vector3<f64>; 2],
    tree: Tree,
    /// The frame of stored coordinates: about the middle of the box if that is far from the
    /// caller's origin.
    frame: StoredFrame,
    /// Radius about the stored origin, in stored units.
    radius: f64,
    /// Corners of the bounding box about the stored origin, in the caller's unit.
    low: Vector3<f64>,
    high: Vector3<f64>,
    fingerprint: Fingerprint,
}

impl Cloud {
    /// Builds a cloud from points in double precision.
    ///
    /// Points may be equal. Points in contact or inside of other elements stay. Of more than 64
    /// equal points, that with the largest radius answers queries, or the first.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no point or more than 2^27; if a point is not finite or its
    /// coordinates reach 1e116; if the extent exceeds 1e100; if a radius is negative, not finite or
    /// out of the range of a ball, or the number of radii is not the number of points; if a half
    /// extent of a box is not positive or out of range.
    pub fn new(points: &[Point3<f64>], element: impl Into<CloudElement>) -> Result<Self, CloudError> {
        Self::build(
            Points::Double(points.iter().map(|p| (*p).into()).collect()),
            element.into(),
        )
    }

    /// Builds a cloud from points in single precision, which are stored as given.
    ///
    /// # Errors
    ///
    /// Returns the errors of [`new`](Self::new).
    pub fn from_f32(points: &[[f32; 3]], element: impl Into<CloudElement>) -> Result<Self, CloudError> {
        Self::build(Points::Single(points.to_vec()), element.into())
    }

    /// Builds a cloud of boxes from the occupied cells of a grid.
    ///
    /// `origin` is the least corner of the cell `[0, 0, 0]`, and `size` the sides of a cell. The
    /// centre of a cell `[i, j, k]` is `origin + size (i + 1/2, j + 1/2, k + 1/2)`, rounded to
    /// f64, and the box has exactly the sides `size`. So adjacent boxes may overlap or be apart by
    /// the rounding of their centres.
    ///
    /// The points of this cloud have an order of their own: [`cell`](Self::cell) returns the cell
    /// of a point.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no cell or more than 2^27, if `origin` or a centre is not
    /// finite or reaches 1e116, if the extent exceeds 1e100, or if a side is not positive or out of
    /// range.
    pub fn from_cells(origin: Point3<f64>, size: Vector3<f64>, cells: &[[u16; 3]]) -> Result<Self, CloudError> {
        let origin = origin.coords;
        let cells = cells.to_vec();
        Self::build(Points::Grid { origin, size, cells }, CloudElement::Box(size * 0.5))
    }

    /// Builds a cloud of boxes from a grid with a flag for each cell.
    ///
    /// `counts` are the numbers of cells along the axes. The flag of the cell `[i, j, k]` has the
    /// index `(i counts[1] + j) counts[2] + k`. The rest is as in
    /// [`from_cells`](Self::from_cells).
    ///
    /// # Errors
    ///
    /// Returns the errors of [`from_cells`](Self::from_cells). Returns an error if the number of
    /// flags is not the number of cells, or if there are more than 65,536 cells along an axis.
    pub fn from_mask(
        origin: Point3<f64>,
        size: Vector3<f64>,
        counts: [usize; 3],
        occupied: &[bool],
    ) -> Result<Self, CloudError> {
        if let Some(axis) = (0..3).find(|k| counts[*k] > 1 << 16) {
            let count = counts[axis];
            return Err(CloudError::Cells { axis, count });
        }
        let expected = counts
            .iter()
            .try_fold(1usize, |all, n| all.checked_mul(*n))
            .unwrap_or(usize::MAX);
        if occupied.len() != expected {
            let (what, count) = ("flags of cells", occupied.len());
            return Err(CloudError::Length { what, count, expected });
        }
        let [_, rows, columns] = counts;
        let cell = |at: usize| [at / (rows * columns), at / columns % rows, at % columns].each(|k| k as u16);
        let full = occupied.iter().enumerate().filter(|(_, is_full)| **is_full);
        let cells: Vec<_> = full.map(|(at, _)| cell(at)).collect();
        Self::from_cells(origin, size, &cells)
    }

    fn build(given: Points, element: CloudElement) -> Result<Self, CloudError> {
        let count = given.len();
        if count == 0 || count > POINTS_MOST {
            return Err(CloudError::Count { count });
        }
        let (element, shape) = Element::new(element, count)?;
        let mut all: Vec<[f64; 3]> = (0..count).map(|k| given.at(k).into()).collect();
        // Written so that NaN is an error.
        let is_bad = |p: &[f64; 3]| !p.iter().all(|x| x.abs() < PLACE_MAX);
        if let Some(point) = all.iter().position(is_bad) {
            let value = all[point];
            return Err(CloudError::Point { point, value });
        }
        let start = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        let (low, high) = all.iter().fold(start, |(low, high), p| {
            let p = Vector3::from(*p);
            (low.smaller(p), high.larger(p))
        });
        let extent = (high - low).iter().copied().fold(0.0, f64::larger);
        if !(extent <= EXTENT_MAX) {
            return Err(CloudError::Extent { extent });
        }
        let core = |n: &Vector3<f64>| element.support(&shape, n);
        let of_point = |k: u32| element.radius_at(k as usize);
        let reach = element.reach(&shape);
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let own = if let Element::Balls(_) = element { reach } else { 0.0 };
        let wide = |sign: f64| Vector3::from_fn(|k, _| core(&(axes[k] * sign)) + own);
        let (low, high) = (low - wide(-1.0), high + wide(1.0));
        let half = sqrt(((high - low) * 0.5).norm_squared());
        let origin = far_origin(&(low * 0.5 + high * 0.5), half, all.iter().map(|p| Vector3::from(*p)));
        if origin != Vector3::zeros() {
            all.iter_mut().for_each(|p| *p = (Vector3::from(*p) - origin).into());
        }
        // A cloud of equal points has no size but the rounding of its place.
        let size = half.larger(low.amax().larger(high.amax()) * UNIT);
        let size = if size > 0.0 { size } else { 1.0 };
        let (low, high) = (low - origin, high - origin);
        let extents = ElementExtent {
            reach,
            support: &core,
            round: matches!(element, Element::Balls(_)).then_some(&of_point),
        };
        let (mut tree, order) = Tree::over_points(&all, &extents);
        let square = all
            .iter()
            .fold(0.0, |far: f64, p| far.larger(Vector3::from(*p).norm_squared()));
        drop(all);
        let window = 2 * EXPONENT_FREE;
        let exponent = (exponent_of(size) + EXPONENT_FREE).div_euclid(window) * window;
        let scale = power_of_two(-exponent);
        // Stored lengths differ from the caller's by a power of two.
        tree.centre *= scale;
        tree.exponent -= exponent;
        let points = given.in_order(&order);
        let element = element.in_order(&order);
        let is_grid = matches!(points, Points::Grid { .. });
        let mut cloud = Self {
            probes: inner_points(&shape).each(|p| p.coords),
            radius: (sqrt(square) + reach) * scale * (1.0 + 64.0 * UNIT),
            points,
            order: if is_grid { Vec::new() } else { order },
            element,
            shape,
            tree,
            frame: StoredFrame { origin, exponent },
            low,
            high,
            fingerprint: Fingerprint::default(),
        };
        cloud.fingerprint = cloud.hash();
        Ok(cloud)
    }

    fn hash(&self) -> Fingerprint {
        let mut all = Fingerprinter::new(*b"cloud   ");
        all.fingerprint(self.shape.fingerprint());
        self.points.add_to(&mut all);
        all.indices(self.order.iter().copied());
        if let Element::Balls(radii) = &self.element {
            (0..self.len()).for_each(|item| all.number(radii.at(item)));
        }
        all.end()
    }

    /// Returns the number of points.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a cloud has at least one point")]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Returns a point by its number; `None` beyond the last.
    ///
    /// The call searches for the number, in time proportional to the number of points. Points of
    /// cells are found at once.
    #[must_use]
    pub fn point(&self, number: usize) -> Option<Point3<f64>> {
        Some(Point3::from(self.points.at(self.item_of(number)?)))
    }

    /// Returns all points, in the caller's order.
    #[must_use]
    pub fn points(&self) -> Vec<Point3<f64>> {
        let mut all = alloc::vec![Point3::origin(); self.len()];
        for item in 0..self.len() {
            all[self.number_of(item) as usize] = Point3::from(self.points.at(item));
        }
        all
    }

    /// Returns the grid cell of a point of [`from_cells`](Self::from_cells) by its number.
    ///
    /// Returns `None` beyond the last point, and for other clouds.
    #[must_use]
    pub fn cell(&self, number: usize) -> Option<[u16; 3]> {
        match &self.points {
            Points::Grid { cells, .. } => cells.get(number).copied(),
            _ => None,
        }
    }

    /// Returns the element at every point; radii are in the caller's order.
    #[must_use]
    pub fn element(&self) -> CloudElement {
        match &self.element {
            Element::Ball(radius) => CloudElement::Ball(*radius),
            Element::Box(half) => CloudElement::Box(*half),
            Element::Shape => CloudElement::Shape(self.shape.clone()),
            Element::Balls(radii) => {
                let mut all = alloc::vec![0.0; self.len()];
                (0..self.len()).for_each(|item| all[self.number_of(item) as usize] = radii.at(item));
                CloudElement::Balls(all)
            }
        }
    }

    /// Returns the corners of a bounding box of all elements, exact up to rounding.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let about = |p: &Vector3<f64>| Point3::from(p + self.frame.origin);
        (about(&self.low), about(&self.high))
    }

    /// Returns a ball that contains all elements, in the frame of the cloud: centre and radius.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        ball_about(self.aabb())
    }

    /// Returns the bytes on the heap, the tree included.
    #[must_use]
    pub fn memory_usage(&self) -> usize {
        let radii = if let Element::Balls(radii) = &self.element {
            radii.memory_usage()
        } else {
            0
        };
        self.points.memory_usage() + radii + size_of_val(&self.order[..]) + self.tree.memory_usage()
    }

    /// Returns the same body as a compound with a piece per point.
    ///
    /// A compound takes some hundred bytes per point.
    ///
    /// # Errors
    ///
    /// Returns an error if an element reaches farther than 1e116 from the origin.
    pub fn to_compound(&self) -> Result<Compound, CompoundError> {
        let mut items: Vec<u32> = (0..self.len() as u32).collect();
        sort_by_key(&mut items, |item| self.number_of(*item as usize));
        self.compound_of(items.into_iter())
    }

    /// Returns a compound of some elements, in the order given.
    pub(crate) fn compound_of(&self, items: impl Iterator<Item = u32>) -> Result<Compound, CompoundError> {
        let piece = |item: u32| {
            let (shape, pose) = self.posed(item);
            Piece {
                pose,
                ..Piece::new(shape)
            }
        };
        Compound::new(items.map(piece).collect())
    }

    /// Returns the items whose leaf comes within a ball, given by its centre and radius.
    ///
    /// The ball is in the frame of the cloud and in the caller's unit.
    pub(crate) fn items_near(&self, (centre, radius): (Point3<f64>, f64)) -> Vec<u32> {
        let (scale, mut items) = (1.0 / self.unit(), Vec::new());
        // The tree doubles the length; a hundredth covers rounding.
        let half = 0.505 * radius * scale;
        self.tree.any_near(&self.frame.stored(&centre), half, |item| {
            items.push(item);
            false
        });
        items
    }

    /// Returns a polyhedron that contains the cloud: its box.
    pub(super) fn hull(&self) -> Result<ConvexPolyhedron, BuildError> {
        let (low, high) = self.aabb();
        let end = |k: usize, i: usize| if k >> i & 1 == 1 { high[i] } else { low[i] };
        let corners: Vec<_> = (0..8).map(|k| Point3::new(end(k, 0), end(k, 1), end(k, 2))).collect();
        ConvexPolyhedron::from_points(&corners)
    }

    fn number_of(&self, item: usize) -> u32 {
        self.order.get(item).copied().unwrap_or(item as u32)
    }

    fn item_of(&self, number: usize) -> Option<usize> {
        if self.order.is_empty() {
            return (number < self.len()).then_some(number);
        }
        self.order.iter().position(|k| *k as usize == number)
    }

    /// Returns the shape of the element at a point.
    fn shape_of(&self, item: u32) -> Shape {
        let Element::Balls(radii) = &self.element else {
            return self.shape.clone();
        };
        // Radii were checked when the cloud was built.
        let radius = radii.at(item as usize);
        Shape::ball(radius).unwrap_or_else(|_| self.shape.clone())
    }

    fn pose_of(&self, item: u32) -> Isometry3<f64> {
        let shift = Translation3::from(self.points.at(item as usize));
        Isometry3::from_parts(shift, UnitQuaternion::identity())
    }

    fn posed(&self, item: u32) -> (Shape, Isometry3<f64>) {
        (self.shape_of(item), self.pose_of(item))
    }

    fn unit(&self) -> f64 {
        self.frame.unit()
    }

    /// Returns a point about the stored origin, in the caller's unit.
    #[inline(always)]
    fn place(&self, item: usize) -> Vector3<f64> {
        let point = self.points.at(item);
        if self.frame.is_at_origin() {
            point
        } else {
            point - self.frame.origin
        }
    }

    /// Returns the cloud with its frame moved to the stored origin.
    pub(crate) fn centred(&self) -> Self {
        let places = (0..self.len()).map(|item| self.place(item).into());
        Self {
            points: Points::Double(places.collect()),
            frame: StoredFrame {
                origin: Vector3::zeros(),
                ..self.frame
            },
            fingerprint: self.fingerprint.with(*b"centred ", 0.0),
            ..self.clone()
        }
    }
}

impl Element {
    /// Checks an element, and returns it with its shape at the origin.
    fn new(given: CloudElement, count: usize) -> Result<(Self, Shape), CloudError> {
        let is_valid = |radius: f64| radius == 0.0 || radius > 0.0 && is_rounding(radius);
        let point = || Shape::from(ConvexPolyhedron::origin());
        Ok(match given {
            CloudElement::Ball(radius) if !is_valid(radius) => return Err(CloudError::Radius { point: 0, radius }),
            CloudElement::Ball(radius) => {
                let shape = if radius > 0.0 { Shape::ball(radius)? } else { point() };
                (Self::Ball(radius), shape)
            }
            CloudElement::Balls(radii) => {
                if radii.len() != count {
                    let (what, count, expected) = ("radii", radii.len(), count);
                    return Err(CloudError::Length { what, count, expected });
                }
                if let Some(point) = radii.iter().position(|r| !is_valid(*r)) {
                    let radius = radii[point];
                    return Err(CloudError::Radius { point, radius });
                }
                (Self::Balls(Radii::new(radii)), point())
            }
            CloudElement::Box(half) => (Self::Box(half), Shape::cuboid(half)?),
            CloudElement::Shape(shape) => (Self::Shape, shape),
        })
    }

    /// Returns the support value of the common part of all elements, for a direction of any length.
    ///
    /// It is raised by its rounding error.
    #[inline(always)]
    fn support(&self, shape: &Shape, n: &Vector3<f64>) -> f64 {
        let up = 1.0 + 4.0 * UNIT;
        match self {
            Self::Ball(radius) => radius * sqrt(n.norm_squared()) * up,
            Self::Balls(_) => 0.0,
            Self::Box(half) => (half.x * n.x.abs() + half.y * n.y.abs() + half.z * n.z.abs()) * up,
            Self::Shape => shape.support_height(n),
        }
    }

    /// Returns the radius around the common part, by index.
    #[inline(always)]
    fn radius_at(&self, k: usize) -> f64 {
        if let Self::Balls(radii) = self {
            radii.at(k)
        } else {
            0.0
        }
    }

    /// Returns the largest distance of a point of an element from its point of the cloud.
    fn reach(&self, shape: &Shape) -> f64 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Balls(radii) => radii.largest(),
            Self::Box(half) => sqrt(half.norm_squared()) * (1.0 + 8.0 * UNIT),
            Self::Shape => {
                let (centre, radius) = shape.bounding_ball();
                sqrt(centre.coords.norm_squared()) + radius
            }
        }
    }

    fn in_order(self, order: &[u32]) -> Self {
        match self {
            Self::Balls(radii) => Self::Balls(radii.in_order(order)),
            other => other,
        }
    }
}

impl Parted for Cloud {
    fn by_kind(&self) -> PartsRef<'_> {
        PartsRef::Cloud(self)
    }

    fn side(&self) -> TreeSide<'_> {
        TreeSide {
            tree: &self.tree,
            frame: self.frame,
            radius: self.radius,
            // Queries of elements count the rounding of composed poses.
            off: 0.0,
        }
    }

    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn stored_unit(&self) -> f64 {
        self.unit()
    }

    fn corners_of_box(&self) -> (Point3<f64>, Point3<f64>) {
        self.aabb()
    }

    fn is_in_place(&self) -> bool {
        false
    }

    fn is_shifted(&self) -> bool {
        true
    }

    #[inline(always)]
    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64 {
        // Scaled first: the square of a direction in the unit of another body may leave the range.
        let n = &(n * power_of_two(-self.frame.exponent));
        let height = n.dot(&self.place(item as usize)) + self.element.support(&self.shape, n);
        match &self.element {
            Element::Balls(radii) => height + radii.at(item as usize) * (sqrt(n.norm_squared()) * (1.0 + 4.0 * UNIT)),
            _ => height,
        }
    }

    fn heights(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) {
        if matches!(self.element, Element::Balls(_)) || !self.frame.is_at_origin() {
            items.zip(to).for_each(|(item, to)| *to = self.highest(item, n));
            return;
        }
        // As in `highest`, but the support value of the element is computed once.
        let n = &(n * power_of_two(-self.frame.exponent));
        let own = self.element.support(&self.shape, n);
        let range = items.start as usize..items.end as usize;
        self.points.for_each(range.zip(to), |p, to| *to = n.dot(&p) + own);
    }

    fn number(&self, item: u32) -> u32 {
        self.number_of(item as usize)
    }

    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        Some(self.posed(item))
    }

    fn stored_part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        let (shape, pose) = self.posed(item);
        Some((shape, self.frame.about(&pose)))
    }

    fn shared_pose(&self, item: u32) -> Option<Isometry3<f64>> {
        let is_shared = !matches!(self.element, Element::Balls(_));
        is_shared.then(|| self.pose_of(item))
    }

    fn probe_count(&self) -> usize {
        self.tree.range(0).len()
    }

    fn probe(&self, k: usize) -> [Vector3<f64>; 4] {
        let (at, scale) = (self.place(k), power_of_two(-self.frame.exponent));
        let [inner, other] = self.probes.each(|offset| (at + offset) * scale);
        [inner, other, inner, other]
    }

    #[cfg(feature = "exact")]
    fn exact_probe(&self, k: usize) -> ExactVector {
        let (_, pose) = self.posed(k as u32);
        ExactVector::new(&self.probes[1]).placed(&pose)
    }
}

impl NearItems for Cloud {
    fn outcome_of_item(&self, item: u32, point: &Point3<f64>) -> PointOutcome {
        let (centre, number) = (self.points.at(item as usize), self.number(item));
        match &self.element {
            Element::Ball(radius) => outcome_of_ball(&centre, *radius, point, number),
            Element::Balls(radii) => outcome_of_ball(&centre, radii.at(item as usize), point, number),
            Element::Box(half) => outcome_of_box(&centre, half, point, number),
            Element::Shape => outcome_of_shape(&self.shape, &self.pose_of(item), point, number),
        }
    }
}
