//! One tracker for any two geometries.

use nalgebra::{Point3, Unit, Vector3};

use super::engine::AnyTracker;
use super::over::OverTime;
use crate::geometry::{Geometry, ShapeKind};
use crate::pair::outcome::{Class, Distance, Outcome, Until};
use crate::patch::Decision;
use crate::polyhedron::Feature;
use crate::pose::RelativePose;

/// No tracker follows two geometries of these kinds: a mesh and a surface of patches. A mesh that
/// is meant as its triangles alone stands against surfaces as
/// [`Surface::from_mesh`](crate::patch::Surface::from_mesh).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no tracker follows a {a} and a {b}")]
pub struct PairError {
    /// The kind of A.
    pub a: ShapeKind,
    /// The kind of B.
    pub b: ShapeKind,
}

/// The place of a witness on a geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spot {
    /// The piece of a composite, the triangle of a mesh or the patch of a surface, by the caller's
    /// index; zero for a convex geometry. Beside a mesh a composite of polyhedra is the mesh of its
    /// surface ([`Composite::to_mesh`](crate::Composite::to_mesh)).
    pub part: u32,
    /// The feature that holds the witness: of a polyhedron, of the core of a convex shape, or of
    /// the piece. Of two meshes, a vertex has the number of its point, an edge that of the point at
    /// which the edge begins, a face that of its triangle; beside another geometry a triangle is a
    /// polygon of three vertices. A patch is a face, with the number of the patch.
    pub feature: Feature,
}

/// The closest points of two geometries, with proof.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Answer {
    /// Whether the geometries are apart, touch or overlap, or whether the bounds leave that open.
    pub class: Class,
    /// The signed distance, between the bounds: negative by the penetration depth if two convex
    /// geometries overlap, zero if other geometries do.
    pub distance: f64,
    /// Lower bound of the signed distance; `-f64::INFINITY` for an overlap of geometries that are
    /// not both convex, whose depth is not searched.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the signed distance.
    pub upper: f64,
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
    /// The places of the witnesses on A and on B.
    pub on: [Spot; 2],
}

impl Answer {
    fn new(o: &Outcome, parts: [u32; 2]) -> Self {
        let spot = |part, feature| Spot { part, feature };
        Self {
            class: o.class,
            distance: o.distance,
            lower: o.lower,
            upper: o.upper,
            point_on_a: o.point_on_a,
            point_on_b: o.point_on_b,
            normal: o.normal,
            on: [spot(parts[0], o.features.a), spot(parts[1], o.features.b)],
        }
    }
}

impl From<&Answer> for Distance {
    fn from(o: &Answer) -> Self {
        Self {
            class: o.class,
            value: o.distance,
            lower: o.lower,
            upper: o.upper,
        }
    }
}

/// Follows a pair of geometries of any two kinds, in either order.
///
/// The tracker keeps the state of the pair that was asked last. Other geometries, or the same in
/// the other order, begin anew: keep a tracker for each pair. What the state may change stands on
/// the [front page](crate), as for every tracker. For two geometries that are known to be polyhedra
/// [`Tracker`](crate::Tracker) is the faster one: it compares no geometries and chooses no kind.
///
/// Two surfaces, or a surface and another geometry, have bounds that are at most `2^-30` of the
/// size of the pair apart; a surface and a mesh are refused.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Geometry, Mesh, PairTracker, RelativePose, Shape};
///
/// let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let part = Geometry::from(Mesh::from_convex(&die)?);
/// let post = Geometry::from(Shape::cylinder(2.0, 0.5)?);
/// let mut tracker = PairTracker::new();
/// for x in [4.0, 3.9, 3.8] {
///     let place = Isometry3::translation(x, 0.0, 0.0);
///     let pose = RelativePose::from_isometry(&place)?;
///     let answer = tracker.closest(&part, &post, &pose)?;
///     assert!((answer.distance - (x - 1.5)).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct PairTracker(Option<Followed>);

/// A pair and its tracker.
#[derive(Clone, Debug)]
struct Followed {
    pair: [Geometry; 2],
    tracker: AnyTracker,
}

impl PairTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub const fn new() -> Self {
        Self(None)
    }

    /// Returns the tracker of a pair, with its state if the pair was asked last.
    fn of(&mut self, a: &Geometry, b: &Geometry) -> Result<&mut AnyTracker, PairError> {
        let is_known = self.0.as_ref().is_some_and(|f| f.pair[0].is(a) && f.pair[1].is(b));
        if !is_known {
            self.0 = AnyTracker::new(a, b).map(|tracker| Followed {
                pair: [a.clone(), b.clone()],
                tracker,
            });
        }
        let refused = PairError {
            a: a.kind(),
            b: b.kind(),
        };
        self.0.as_mut().map(|followed| &mut followed.tracker).ok_or(refused)
    }

    /// Returns the closest points with bounds of the signed distance.
    ///
    /// # Errors
    /// If no tracker follows the two kinds.
    pub fn closest(&mut self, a: &Geometry, b: &Geometry, a_from_b: &RelativePose) -> Result<Answer, PairError> {
        let tracker = self.of(a, b)?;
        let outcome = tracker.measure((a, b), a_from_b, Until::Depth);
        Ok(Answer::new(&outcome, tracker.pieces()))
    }

    /// Returns the signed distance with bounds.
    ///
    /// # Errors
    /// If no tracker follows the two kinds.
    pub fn distance(&mut self, a: &Geometry, b: &Geometry, a_from_b: &RelativePose) -> Result<Distance, PairError> {
        Ok(Distance::from(&self.closest(a, b, a_from_b)?))
    }

    /// Returns whether the geometries share a point. Only pairs with a surface of patches may be
    /// undecided; curved shapes whose bounds hold both answers count as sharing one.
    ///
    /// # Errors
    /// If no tracker follows the two kinds.
    pub fn intersects(&mut self, a: &Geometry, b: &Geometry, a_from_b: &RelativePose) -> Result<Decision, PairError> {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the geometries are at most `d` apart. Only pairs with a surface of patches
    /// may be undecided; curved shapes whose bounds hold both answers count as within.
    ///
    /// # Errors
    /// If no tracker follows the two kinds.
    pub fn within(
        &mut self,
        a: &Geometry,
        b: &Geometry,
        a_from_b: &RelativePose,
        d: f64,
    ) -> Result<Decision, PairError> {
        Ok(self.of(a, b)?.within((a, b), a_from_b, d))
    }

    /// Returns two geometries that can be measured over time, followed by this tracker: what
    /// [`impact::cast`](crate::impact::cast) takes.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance, cast};
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Geometry, Mesh, PairTracker, Shape, Velocity};
    ///
    /// let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
    /// let wall = Geometry::from(Mesh::from_convex(&die)?);
    /// let ball = Geometry::from(Shape::ball(0.5)?);
    /// let still = Steady::new(&Isometry3::identity(), Velocity::default())?;
    /// let velocity = Velocity::new(Vector3::new(-2.0, 0.0, 0.0), Vector3::zeros());
    /// let thrown = Steady::new(&Isometry3::translation(4.0, 0.0, 0.0), velocity)?;
    /// let mut tracker = PairTracker::new();
    /// let mut pair = tracker.over(&wall, &ball)?;
    /// let tolerance = Tolerance::Distance(1e-9);
    /// let found = cast(&mut pair, &still, &thrown, (0.0, 2.0), tolerance)?;
    /// let Impact::Hit { safe, hit, .. } = found.impact else {
    ///     panic!("{:?}", found.impact)
    /// };
    /// assert!(safe < 1.25 && 1.25 < hit && hit - safe < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If no tracker follows the two kinds.
    pub fn over<'p>(&'p mut self, a: &'p Geometry, b: &'p Geometry) -> Result<OverTime<'p>, PairError> {
        let refused = PairError {
            a: a.kind(),
            b: b.kind(),
        };
        self.of(a, b)?.over((a, b)).ok_or(refused)
    }

    /// Forgets the pair.
    pub fn reset(&mut self) {
        self.0 = None;
    }
}
