//! Convex shapes: a core and a rounding radius.
//!
//! `Shape { core, rounding }` is the set of points at most `rounding` from the core: a ball is a
//! rounded point, a capsule a rounded segment. With `P = A - B` the signed distance of two shapes
//! is `-min over unit n of h_P(n)`, and `h_P` grows by `r` if a shape is rounded by a ball of
//! radius `r`. So rounding needs no other solver: the signed distance of two rounded shapes is that
//! of their cores minus both radii, for separated and for overlapping shapes.
//!
//! Sources: the parallel body of a convex body, Steiner 1840 and Schneider 2014, "Convex Bodies:
//! The Brunn-Minkowski Theory", section 4.2; the convex radius of the engines (van den Bergen 2003,
//! section 4.5). Departures:
//! 1. The radius is not a margin that a fast method uses and a slow one ignores. It belongs to the
//!    shape, for separated and for overlapping shapes.
//! 2. Parameters are checked once, when a shape is constructed. Every shape has a support point
//!    along every direction.

mod cone;
mod cylinder;
mod ellipsoid;
mod mass;
#[cfg(feature = "serde")]
mod persist;
mod support;
mod top;

use crate::base::num::each::Each;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{dot, sqrt};
use crate::base::pose::rotation_matrix;
use crate::base::tolerance::{BOX, EXTENT_MAX, EXTENT_MIN, UNIT};
use crate::body::polyhedron::{BoxHint, BuildError, ConvexPolyhedron, solids};
pub use crate::body::shape::cone::Cone;
pub use crate::body::shape::cylinder::Cylinder;
pub use crate::body::shape::ellipsoid::Ellipsoid;
pub use crate::body::shape::mass::Mass;
pub(crate) use crate::body::shape::support::{Curved, Disc, Flat, Support};
pub(crate) use crate::body::shape::top::Top;
use alloc::sync::Arc;
use nalgebra::{Isometry3, Point3, Vector3};

/// A convex shape: all points at most [`rounding_radius`](Self::rounding_radius) from its
/// [`core`](Self::core).
///
/// It is immutable, and cheap to clone because clones share the polyhedron of the core. Lengths are
/// in the caller's unit, coordinates in the frame of the shape.
///
/// ```
/// use lin_canny::nalgebra::Vector3;
/// use lin_canny::shape::Shape;
///
/// let pill = Shape::capsule(1.0, 0.25)?;
/// let die = Shape::cuboid(Vector3::new(1.0, 1.0, 1.0))?.rounded(0.1)?;
/// assert_eq!((pill.rounding_radius(), die.rounding_radius()), (0.25, 0.1));
/// # Ok::<(), lin_canny::shape::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "persist::StoredShape", into = "persist::StoredShape")
)]
pub struct Shape {
    core: Core,
    rounding: f64,
    fingerprint: Fingerprint,
}

/// Declares [`Core`] and what follows from the curved kinds.
macro_rules! cores {
    (
        $(#[$of_core:meta])*
        pub enum Core {
            $(#[$of_polyhedron:meta])*
            Polyhedron($polyhedron:ty),
            $($(#[$of_kind:meta])* $kind:ident,)*
        }
    ) => {
        $(#[$of_core])*
        pub enum Core {
            $(#[$of_polyhedron])*
            Polyhedron($polyhedron),
            $($(#[$of_kind])* $kind($kind),)*
        }

        /// Matches a core: an expression for the polyhedron, and one for every kind of [`Curved`]
        /// core.
        macro_rules! match_core {
            ($core:expr, $body:pat => $polyhedral:expr, $curved:pat => $round:expr) => {
                match $core {
                    Core::Polyhedron($body) => $polyhedral,
                    $(Core::$kind($curved) => $round,)*
                }
            };
        }

        /// Calls a macro with the names of all curved kinds.
        macro_rules! with_curved_kinds {
            ($then:ident) => {
                $then! { $($kind),* }
            };
        }

        /// Returns a shape of each curved kind with these half lengths of its box, by name, for
        /// tests and pictures of all kinds. A body of revolution takes x and z.
        #[cfg(feature = "__internals")]
        #[doc(hidden)]
        pub fn curved_kinds(half: Vector3<f64>) -> alloc::vec::Vec<(&'static str, Shape)> {
            [$((stringify!($kind), Core::$kind($kind::of_half_lengths(half)))),*]
                .map(|(name, core)| (name, Shape::sharp(core)))
                .into()
        }

        /// The order in which the cores of a pair are solved.
        enum Rank {
            Polyhedron,
            $($kind,)*
        }

        impl Core {
            /// Returns the rank of the kind in the order in which the cores of a pair are solved.
            #[inline]
            pub(crate) fn rank(&self) -> u32 {
                (match self {
                    Self::Polyhedron(_) => Rank::Polyhedron,
                    $(Self::$kind(_) => Rank::$kind,)*
                }) as u32
            }
        }
    };
}

cores! {
    /// Core of a shape: the shape before rounding.
    #[derive(Clone, Debug, PartialEq)]
    #[non_exhaustive]
    // A new kind comes last: some formats store the number of a kind.
    pub enum Core {
        /// A convex polyhedron, polygon, segment or point.
        Polyhedron(Arc<ConvexPolyhedron>),
        /// An ellipsoid around the origin with axes along x, y and z.
        Ellipsoid,
        /// A circular cylinder along z around the origin.
        Cylinder,
        /// A circular cone along z with its apex up. The origin is half-way between apex and base.
        Cone,
    }
}

pub(crate) use {match_core, with_curved_kinds};

/// Returns whether a shape may be rounded by a ball of this radius: zero, or between 1e-100 and
/// 1e100.
pub(crate) fn is_rounding(radius: f64) -> bool {
    radius == 0.0 || (EXTENT_MIN..=EXTENT_MAX).contains(&radius)
}

/// Returns a length between 1e-100 and 1e100; any other is an error.
fn length(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    if (EXTENT_MIN..=EXTENT_MAX).contains(&value) {
        Ok(value)
    } else {
        Err(ShapeError::BadParameter { what, value })
    }
}

impl Shape {
    /// Returns a ball around the origin.
    ///
    /// # Errors
    ///
    /// Returns an error if the radius is not between 1e-100 and 1e100.
    #[doc(alias = "sphere")]
    pub fn ball(radius: f64) -> Result<Self, ShapeError> {
        Self::from(ConvexPolyhedron::origin()).rounded(length("radius", radius)?)
    }

    /// Returns a capsule along z around the origin: all points at most `radius` from a segment of
    /// length `2 half_length`.
    ///
    /// # Errors
    ///
    /// Returns an error if the length or radius is not between 1e-100 and 1e100. The half length of
    /// a [`ball`](Self::ball), zero, has a separate error, which names that call.
    pub fn capsule(half_length: f64, radius: f64) -> Result<Self, ShapeError> {
        if half_length == 0.0 {
            return Err(ShapeError::NoLength);
        }
        let end = Vector3::z() * length("half length", half_length)?;
        let core = ConvexPolyhedron::segment(Point3::from(-end), Point3::from(end))?;
        Self::from(core).rounded(length("radius", radius)?)
    }

    /// Returns a box around the origin with faces perpendicular to the axes.
    ///
    /// # Errors
    ///
    /// Returns an error if a half extent is not between 1e-100 and 1e100.
    #[doc(alias = "box")]
    pub fn cuboid(half_extents: Vector3<f64>) -> Result<Self, ShapeError> {
        for &x in half_extents.iter() {
            length("half extent", x)?;
        }
        Ok(Self::from(solids::cuboid(half_extents)?))
    }

    /// Returns the convex hull of points.
    ///
    /// # Errors
    ///
    /// Returns an error if the points have no hull with volume, see
    /// [`ConvexPolyhedron::from_points`].
    pub fn hull(points: &[Point3<f64>]) -> Result<Self, ShapeError> {
        Ok(Self::from(ConvexPolyhedron::from_points(points)?))
    }

    /// Returns a circular cylinder along z around the origin, `2 half_height` high.
    ///
    /// # Errors
    ///
    /// Returns an error if the height or radius is not between 1e-100 and 1e100.
    pub fn cylinder(half_height: f64, radius: f64) -> Result<Self, ShapeError> {
        Ok(Self::sharp(Core::Cylinder(Cylinder::new(half_height, radius)?)))
    }

    /// Returns a circular cone along z.
    ///
    /// The apex is at `z = half_height`, the base at `z = -half_height`.
    ///
    /// # Errors
    ///
    /// Returns an error if the height or radius is not between 1e-100 and 1e100.
    pub fn cone(half_height: f64, radius: f64) -> Result<Self, ShapeError> {
        Ok(Self::sharp(Core::Cone(Cone::new(half_height, radius)?)))
    }

    /// Returns an ellipsoid around the origin with axes along x, y and z.
    ///
    /// # Errors
    ///
    /// Returns an error if a semi-axis is not between 1e-100 and 1e100.
    pub fn ellipsoid(semi_axes: Vector3<f64>) -> Result<Self, ShapeError> {
        Ok(Self::sharp(Core::Ellipsoid(Ellipsoid::new(semi_axes)?)))
    }

    /// Returns the shape rounded by a ball of radius `by`: all points at most `by` from the shape.
    ///
    /// # Errors
    ///
    /// Returns an error if the radius is negative, or if the sum of all rounding radii exceeds
    /// 1e100. A radius that is not zero must be at least 1e-100.
    pub fn rounded(mut self, by: f64) -> Result<Self, ShapeError> {
        let rounding = self.rounding + by;
        if !is_rounding(by) || rounding > EXTENT_MAX {
            return Err(ShapeError::BadParameter {
                what: "rounding radius",
                value: by,
            });
        }
        self.rounding = rounding;
        self.fingerprint = self.core.rounded_fingerprint(rounding);
        Ok(self)
    }

    /// Returns the core: the shape before rounding.
    #[must_use]
    pub fn core(&self) -> &Core {
        &self.core
    }

    /// Returns the radius by which the core is rounded; zero for a shape without rounding.
    #[must_use]
    pub fn rounding_radius(&self) -> f64 {
        self.rounding
    }

    /// Returns the fingerprint of core and rounding.
    pub(crate) fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn sharp(core: Core) -> Self {
        Self {
            fingerprint: core.fingerprint(),
            core,
            rounding: 0.0,
        }
    }
}

impl From<ConvexPolyhedron> for Shape {
    fn from(body: ConvexPolyhedron) -> Self {
        Self::from(Arc::new(body))
    }
}

impl From<Arc<ConvexPolyhedron>> for Shape {
    fn from(body: Arc<ConvexPolyhedron>) -> Self {
        Self::sharp(Core::Polyhedron(body))
    }
}

/// Error of a constructor of a shape: a parameter is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A parameter is not finite, or outside the range of its constructor.
    #[error("{what} of the shape is out of range: {value:?}")]
    BadParameter {
        /// Name of the parameter.
        what: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// The half length of a capsule is zero.
    #[error("half length of the capsule is zero; use a ball")]
    NoLength,
    /// The points of a core have no hull with volume.
    #[error(transparent)]
    Core(#[from] BuildError),
}

impl Core {
    /// Returns the largest distance of a point from [`origin`](Self::origin), rounded up.
    pub(crate) fn radius(&self) -> f64 {
        match_core!(self, body => body.radius * body.unit(), core => core.reach())
    }

    /// Returns the point relative to which the core is stored.
    pub(crate) fn origin(&self) -> Vector3<f64> {
        match self {
            Self::Polyhedron(body) => body.origin,
            _ => Vector3::zeros(),
        }
    }

    /// Returns the fingerprint of kind and parameters.
    pub(super) fn fingerprint(&self) -> Fingerprint {
        match_core!(self, body => body.fingerprint, core => core.fingerprint())
    }

    /// Returns the fingerprint of the core rounded by a radius.
    pub(super) fn rounded_fingerprint(&self, radius: f64) -> Fingerprint {
        let core = self.fingerprint();
        if radius == 0.0 {
            core
        } else {
            core.with(*b"rounded ", radius)
        }
    }
}

impl Shape {
    /// Returns centre and radius of a ball that contains the shape, the radius rounded up.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let (centre, radius) = match_core!(
            &self.core,
            body => body.bounding_ball(),
            core => (Point3::origin(), core.reach())
        );
        (centre, (radius + self.rounding) * (1.0 + 2.0 * UNIT))
    }

    /// Returns an upper bound of `direction . x` over the shape.
    ///
    /// It is too large by at most `1e-14` times the size of the shape times the length of the
    /// direction. `direction` is in the frame of the shape and of any length; if it is zero or not
    /// finite, the result is zero.
    #[doc(alias = "support")]
    #[must_use]
    pub fn support_height(&self, direction: &Vector3<f64>) -> f64 {
        self.support_from(direction, &Vector3::zeros())
    }

    /// Returns an upper bound of `direction . (x - from)`, as [`support_height`] does.
    ///
    /// If the shape and `from` are far from the origin and near each other, the bound is relative
    /// to their distance from each other.
    ///
    /// [`support_height`]: Self::support_height
    pub(crate) fn support_from(&self, direction: &Vector3<f64>, from: &Vector3<f64>) -> f64 {
        let size = direction.amax();
        if !(size > 0.0 && size.is_finite()) {
            return 0.0;
        }
        if let Core::Polyhedron(body) = &self.core
            && self.rounding == 0.0
            && let Some(height) = body.scanned_height(direction, from)
        {
            let reach = body.radius * body.unit() + (body.origin - from).abs().sum();
            return height + BOX * reach * direction.abs().sum();
        }
        let length = size * sqrt((direction / size).norm_squared());
        let n = direction / length;
        let of = |height: f64, reach: f64| height + BOX * reach;
        let height = match_core!(&self.core, body => {
            let v = body.vertex(body.extreme_vertex(&n)).unwrap_or_else(Point3::origin).coords - from;
            of(n.dot(&v), body.radius * body.unit() + v.abs().sum())
        }, core => of(height(core, &n) - n.dot(from), core.reach() + from.abs().sum()));
        (height + self.rounding * (1.0 + BOX)) * length
    }

    /// Returns the shape with a polyhedral core stored about another origin: the shape moves with
    /// it. Curved cores, which have no other origin, stay as they are.
    pub(crate) fn with_origin(&self, origin: &Vector3<f64>) -> Self {
        let Core::Polyhedron(body) = &self.core else {
            return self.clone();
        };
        let core = Core::Polyhedron(Arc::new(body.with_origin(origin)));
        Self {
            fingerprint: core.rounded_fingerprint(self.rounding),
            core,
            rounding: self.rounding,
        }
    }

    /// Returns an approximate support point of the core along a unit direction, and the vertex of a
    /// polyhedral core.
    pub(crate) fn core_point(&self, n: &Vector3<f64>) -> (Option<u32>, Vector3<f64>) {
        let along = [n.x, n.y, n.z];
        match_core!(&self.core, body => {
            let v = body.extreme_vertex(n);
            let p = body.vertex(v).unwrap_or_else(Point3::origin);
            (Some(v.0), p.coords)
        }, core => (None, core.support(&along, 0).1.into()))
    }

    /// Returns the axis-aligned box of the shape at a pose, rounded outward.
    ///
    /// The result is the least and greatest corner, in the frame to which the pose leads. `hint`
    /// caches the extreme vertices of a polyhedron from one frame to the next.
    ///
    /// If the pose is not finite, the box is not finite either.
    #[doc(alias = "compute_aabb")]
    #[must_use]
    pub fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        let (low, high) = match_core!(&self.core, body => body.aabb_at(pose, hint), core => box_at(core, pose));
        if self.rounding == 0.0 {
            return (low, high);
        }
        let out = |x: f64, by: f64| x + by + (x.abs() + by.abs()) * UNIT * by.signum();
        (low.map(|x| out(x, -self.rounding)), high.map(|x| out(x, self.rounding)))
    }
}

/// Returns the greatest `n . x` over a core, up to rounding.
fn height<C: Support>(core: &C, n: &Vector3<f64>) -> f64 {
    let n = [n.x, n.y, n.z];
    dot(&n, &core.support(&n, 0).1)
}

/// Returns the box of six support points, rounded outward.
fn box_at<C: Support>(core: &C, pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
    let q = pose.rotation.coords;
    let matrix = rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared());
    let t = pose.translation.vector;
    let (mut low, mut high) = (t, t);
    for k in 0..3 {
        let row = [matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)]];
        let norm = sqrt(dot(&row, &row));
        let up = Vector3::from(row.each(|x| x / norm));
        let margin = BOX * (core.reach() + t[k].abs());
        high[k] += height(core, &up) + margin;
        low[k] -= height(core, &-up) + margin;
    }
    (Point3::from(low), Point3::from(high))
}
