//! One tracker for any two geometries: the engine of the last pair, the queries, the manifold of
//! two convex geometries, and the work of queries.

use crate::base::num::each::Each;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::RelativePose;
use crate::convex::contact::{Manifold, ManifoldOptions};
use crate::convex::replay::Replay;
use crate::convex::tracker::TrackerWork;
#[cfg(feature = "meshes")]
use crate::nonconvex::contact::ContactTracker;
#[cfg(feature = "meshes")]
use crate::nonconvex::query::search::TreeWork;
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{Decision, Distance};
use crate::pair_tracker::borrowed_pair::{BorrowedPair, MovingPair};
use crate::pair_tracker::engine::{Engine, TrackedPair};
use crate::pair_tracker::geometry::{GeometryKind, GeometryRef};
#[cfg(feature = "meshes")]
use crate::pair_tracker::overlaps::ConvertedSolid;
#[cfg(feature = "surfaces")]
use crate::surface::SurfaceWork;
#[cfg(feature = "meshes")]
use alloc::boxed::Box;
use alloc::string::String;
use nalgebra::{Unit, Vector3};

/// Tracks a pair of geometries of any two kinds, in either order.
///
/// Pass a geometry as a reference to a [`Geometry`](crate::Geometry) or to a body of any kind. The
/// tracker caches the state of the last pair, which it recognises by fingerprints. If the
/// geometries or their order change, the tracker starts cold: keep one tracker per pair. The [front
/// page](crate) says what the cached state may change in a result, for every tracker. If both
/// geometries are known to be polyhedra, [`Tracker`](crate::Tracker) is faster, because it compares
/// no geometries and chooses no kind.
///
/// | geometries | width of the bounds | `intersects`, `within` |
/// |---|---|---|
/// | polyhedra, rounded or not | `1e-13 L` | exact (feature `exact`) |
/// | curved [cores](crate::shape::Core) | `1e-13 L`; depths `2^-19 L` | ties count as within |
/// | meshes, compounds whose pieces have no pose | `1e-13 L` | exact (`exact`), but for two ties |
/// | compounds whose pieces have poses | `1.5e-13 L` | ties count as within |
/// | a cloud | `1.5e-13 L` | ties count as within, see [`Cloud`](crate::Cloud) |
/// | a half-space, and a body of another kind | `1e-13 L`, as the body | ties count as within |
/// | a Bézier surface | as requested, or `2^-30` of the radii plus `2^-38 L` | may be undecided |
///
/// The contact state of curved shapes may be [`Undecided`](crate::ContactState::Undecided), even
/// with the feature `exact`. This happens if the bounds straddle zero and are farther apart than a
/// contact leaves them.
///
/// The bounds of a depth of curved shapes are as close as the bounds of a distance if balls inside
/// the cores prove them, and for cylinders and cones with parallel axes. If the shapes have a
/// common centre and many directions are nearly as deep, the interval may stay wider than
/// `2^-19 L`. Both bounds hold in all cases.
///
/// The depth of every body in a half-space is known: it is minus the signed distance, with both
/// bounds. See [`HalfSpace`](crate::HalfSpace).
///
/// A mesh that is not closed and a Bézier surface have no inside, so a body inside one is separated
/// from it.
///
/// The test of whether a point, or a body smaller than rounding, is inside a closed mesh is exact
/// too, at any distance from the surface (feature `exact`). Without the feature and within
/// `1e-13 L` of the surface, the contact state is [`Undecided`](crate::ContactState::Undecided),
/// and `intersects` and `within` return true.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Mesh, PairTracker, RelativePose, Shape};
///
/// let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let part = Mesh::from_convex(&die)?;
/// let post = Shape::cylinder(2.0, 0.5)?;
/// let mut tracker = PairTracker::new();
/// for x in [4.0, 3.9, 3.8] {
///     let place = Isometry3::translation(x, 0.0, 0.0);
///     let pose = RelativePose::from_isometry(&place)?;
///     let answer = tracker.closest(&part, &post, &pose);
///     assert!((answer.distance - (x - 1.5)).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "collision")]
#[doc(alias = "GJK")]
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "PairWork", into = "PairWork"))]
pub struct PairTracker {
    pub(super) followed: Option<Followed>,
    /// The contacts between patches that the caller has made.
    #[cfg(feature = "meshes")]
    pub(super) between: Option<Box<ContactTracker>>,
    /// The meshes of the last bodies whose overlap was computed, if they were no meshes.
    #[cfg(feature = "meshes")]
    pub(super) solids: [Option<Box<ConvertedSolid>>; 2],
    /// The work of earlier pairs.
    pub(super) work: PairWork,
}

/// The serialised form: a restored tracker starts cold, with its counters.
#[cfg(feature = "serde")]
impl From<PairTracker> for PairWork {
    fn from(tracker: PairTracker) -> Self {
        tracker.work()
    }
}

#[cfg(feature = "serde")]
impl From<PairWork> for PairTracker {
    fn from(work: PairWork) -> Self {
        Self {
            work,
            ..Self::default()
        }
    }
}

/// A pair that is recognised by its fingerprints.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    pair: [Fingerprint; 2],
    pub(super) tracked: TrackedPair,
}

impl PairTracker {
    /// Returns a tracker that starts cold.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns a tracker whose first query of a curved convex pair starts along a direction.
    ///
    /// The direction leads from A to B, in the frame of A. It applies to two convex geometries of
    /// which one has a curved [`Core`](crate::shape::Core); other pairs start cold. Use this if
    /// you keep the normal of the last result yourself and no tracker. A wrong direction costs time
    /// and never makes a bound wrong; it may change what the state of any tracker may change.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{PairTracker, RelativePose, Shape};
    ///
    /// let floor = Shape::cuboid(Vector3::new(5.0, 5.0, 1.0))?;
    /// let can = Shape::cylinder(0.5, 0.25)?;
    /// let tilted = Isometry3::rotation(Vector3::x() * 0.3);
    /// let pose = |x| {
    ///     RelativePose::from_isometry(&(Isometry3::translation(x, 0.0, 1.6) * tilted))
    /// };
    /// let before = PairTracker::new().closest(&floor, &can, &pose(0.0)?);
    ///
    /// // In the next frame, from what the caller kept:
    /// let mut pair = PairTracker::with_direction(&before.normal, &floor, &can);
    /// let now = pair.closest(&floor, &can, &pose(0.01)?);
    /// assert!((now.distance - before.distance).abs() < 1e-12);
    /// assert!(now.work.steps < before.work.steps);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_direction<'g>(
        normal: &Unit<Vector3<f64>>,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
    ) -> Self {
        let mut tracker = Self::new();
        tracker.follow([a.into(), b.into()]).engine.begin_along(normal);
        tracker
    }

    /// Returns the state of a pair, cached if the last query was of the same pair.
    #[inline]
    pub(super) fn follow(&mut self, bodies: [GeometryRef<'_>; 2]) -> &mut TrackedPair {
        let pair = bodies.each(GeometryRef::fingerprint);
        self.follow_by(pair, || Engine::new(bodies))
    }

    /// Returns the state of a pair by its fingerprints, and drops the state of another pair.
    #[inline]
    pub(super) fn follow_by(&mut self, pair: [Fingerprint; 2], new: impl FnOnce() -> Engine) -> &mut TrackedPair {
        if let Some(other) = self.followed.take_if(|f| f.pair != pair) {
            self.work += other.tracked.engine.report().work;
        }
        let new = || Followed {
            pair,
            tracked: TrackedPair::from(new()),
        };
        &mut self.followed.get_or_insert_with(new).tracked
    }

    /// Borrows the engine of a pair.
    #[inline]
    pub(super) fn borrow<'p>(&'p mut self, bodies: [GeometryRef<'p>; 2]) -> BorrowedPair<'p> {
        self.follow(bodies).engine.borrow(bodies)
    }

    /// Returns the closest points with bounds of the signed distance.
    ///
    /// If two convex geometries overlap, their distance is minus the penetration depth.
    ///
    /// **Witnesses of convex shapes** lie on the rounded surfaces, opposite each other along the
    /// normal at the returned distance, in every contact state. Exceptions:
    ///
    /// - one shape has a curved core: to 1e-9 times the pair size, and at flush faces or common
    ///   axes sometimes only to 3e-8;
    /// - only an interval of the depth is known: to 1e-6.
    ///
    /// **Witnesses of meshes** are as far apart as the upper bound, up to the rounding of their
    /// positions, `1e-12 L`. If one body is inside the other, the witness is a point of the inner
    /// body. If several subshapes overlap, the witnesses need not coincide.
    ///
    /// **Solid meshes in contact**: if their surfaces touch and do not certainly cross, they
    /// overlap if the search finds a point inside both. The search tests all pairs of triangles in
    /// contact and points of each component, up to 16,384 pairs of boxes and about 1,024 points. If
    /// more are needed, an overlap may be missed; the contact state is then
    /// [`ContactState::Touching`](crate::ContactState::Touching). The bounds of meshes bound the
    /// unsigned distance, which is zero for bodies that touch or overlap. The lower bound of an
    /// overlap is minus infinity, because no depth is searched.
    ///
    /// **Meshes within `1e-13 L` of contact**: integers decide the contact state if at most 16
    /// pairs of triangles are that near, and none of them lies in one plane (feature `exact`).
    /// Otherwise the state may differ between warm and cold trackers, and between A to B and B to
    /// A. Witnesses of meshes that share a point are one point, up to `1e-13 L`.
    ///
    /// **Cost of meshes**: time in proportion to the pairs of triangles that are as close as the
    /// closest pair, up to rounding. Most bodies have a few such pairs; a dome 1e-9 above a copy of
    /// itself has six per triangle.
    #[doc(alias = "EPA")]
    #[doc(alias = "penetration depth")]
    pub fn closest<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> PairOutcome {
        self.closest_with(a, b, a_from_b, &QueryOptions::default())
    }

    /// Returns the closest points as [`closest`](Self::closest) does, with the options of a query.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Point3};
    /// use lin_canny::surface::{BezierPatch, BezierSurface};
    /// use lin_canny::{PairTracker, QueryOptions, RelativePose, Shape};
    ///
    /// // A ball over the top of a dome.
    /// let at = |k: usize| {
    ///     let (x, y) = ((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0);
    ///     Point3::new(x, y, -x.abs() - y.abs())
    /// };
    /// let points: Vec<_> = (0..9).map(at).collect();
    /// let patch = BezierPatch::polynomial([2, 2], &points)?;
    /// let dome = BezierSurface::new(vec![patch])?;
    /// let ball = Shape::ball(0.5)?;
    /// let pose = Isometry3::translation(0.1, 0.0, 2.0);
    /// let pose = RelativePose::from_isometry(&pose)?;
    /// let narrow = QueryOptions::default().width(1e-9);
    /// let mut tracker = PairTracker::new();
    /// let answer = tracker.closest_with(&dome, &ball, &pose, &narrow);
    /// assert!(answer.is_converged && answer.upper - answer.lower <= 1e-9);
    /// // The parameters of the closest point of the dome.
    /// let [u, v] = answer.locations[0].parameters;
    /// assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_with<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        question: &QueryOptions,
    ) -> PairOutcome {
        let bodies = [a.into(), b.into()];
        self.follow(bodies).engine.closest_with(bodies, a_from_b, question)
    }

    /// Returns the signed distance and its bounds without the witnesses.
    #[doc(alias = "signed distance")]
    pub fn distance<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b))
    }

    /// Returns a lower bound of the distance, or zero if nothing better is known.
    ///
    /// For compounds and meshes this takes one pass over the cached state, without a search for the
    /// closest pair.
    pub fn lower_bound<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> f64 {
        self.borrow([a.into(), b.into()]).lower_bound(a_from_b)
    }

    /// Returns whether the geometries share a point; touching counts.
    ///
    /// If the bounds of a pair with a curved shape or a Bézier surface allow both answers, the
    /// answer is yes. [`decide_within`](Self::decide_within) with a distance of zero reports this
    /// case as undecided for a Bézier surface.
    pub fn intersects<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the geometries are at most `d` apart, in the caller's unit.
    ///
    /// The answer is no for a negative `d` and for NaN.
    ///
    /// If the bounds of a pair with a curved shape or a Bézier surface allow both answers, the
    /// answer is yes. For such a `d` the answer may depend on the previous query.
    ///
    /// For two meshes or compounds, two kinds of ties count as within:
    ///
    /// - A component of one solid is close to the surface of the other. Close means: its four
    ///   vertices farthest from each other are all nearer than `1e-13 L` to this surface. For a
    ///   solid of one component the middles of up to 256 triangles all over it must be near as
    ///   well.
    /// - The bodies are at least 1e58 times as far apart as they are large.
    ///
    /// Every pair of triangles whose distance is nearer to `d` than rounding takes an exact query,
    /// about 10 µs. Flush faces, and surfaces that lie on each other at a gap below `1e-13 L`, have
    /// three to twelve such pairs per triangle, and no budget limits them. Solids that certainly
    /// share inner points are recognised after 128 pairs in contact.
    pub fn within<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        d: f64,
    ) -> bool {
        !self.decide_within(a, b, a_from_b, d, &QueryOptions::default()).is_no()
    }

    /// Decides whether the geometries are at most `d` apart, with three possible results.
    ///
    /// Only a pair with a Bézier surface may be undecided: if `d` is within rounding of the
    /// distance, if the query uses up its budget, or if `d` is zero and two surfaces touch. For
    /// curved shapes, a distance that the bounds cannot distinguish from `d` counts as within. All
    /// other pairs are always decided, with the ties of [`within`](Self::within).
    pub fn decide_within<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        d: f64,
        options: &QueryOptions,
    ) -> Decision {
        let bodies = [a.into(), b.into()];
        self.follow(bodies).engine.decide_within(bodies, a_from_b, d, options)
    }

    /// Returns the two geometries as a pair for queries over time.
    ///
    /// [`impact::cast`](crate::impact::cast) takes such a pair.
    ///
    /// A measurement of a pair with a Bézier surface has bounds that are at most a quarter of the
    /// distance apart. A hit of two surfaces is proven by a crossing, so the tolerance must leave
    /// room for a crossing: at least about `1e-8` of the size. A hit of a surface and a solid is
    /// proven by a point of the surface inside the solid.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance, cast};
    /// use lin_canny::motion::Steady;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, PairTracker, Shape, Velocity};
    ///
    /// let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
    /// let (wall, ball) = (Mesh::from_convex(&die)?, Shape::ball(0.5)?);
    /// let still = Steady::new(&Isometry3::identity(), Velocity::default())?;
    /// let velocity = Velocity::new(Vector3::new(-2.0, 0.0, 0.0), Vector3::zeros());
    /// let thrown = Steady::new(&Isometry3::translation(4.0, 0.0, 0.0), velocity)?;
    /// let mut tracker = PairTracker::new();
    /// let mut pair = tracker.pair(&wall, &ball);
    /// let tolerance = Tolerance::Distance(1e-9);
    /// let found = cast(&mut pair, &still, &thrown, 0.0..2.0, tolerance)?;
    /// let Impact::Hit { safe, hit, .. } = found.impact else {
    ///     panic!("{:?}", found.impact)
    /// };
    /// assert!(safe < 1.25 && 1.25 < hit && hit - safe < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn pair<'p>(&'p mut self, a: impl Into<GeometryRef<'p>>, b: impl Into<GeometryRef<'p>>) -> MovingPair<'p> {
        self.borrow([a.into(), b.into()]).over_time()
    }

    /// Drops all cached state and resets the counters.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Returns a query of two convex geometries as a text that rebuilds it exactly.
    ///
    /// Call this before the query, as [`Tracker::replay`](crate::Tracker::replay). `None` unless
    /// both geometries are polyhedra, rounded or not.
    #[must_use]
    pub fn replay<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Option<Replay> {
        self.borrow([a.into(), b.into()]).replay(a_from_b)
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub fn work(&self) -> PairWork {
        let mut work = self.work;
        if let Some(followed) = &self.followed {
            work += followed.tracked.engine.report().work;
        }
        work
    }

    /// Returns the number of entries of the cached front; zero for convex geometries, which have no
    /// front.
    ///
    /// An entry is a pair of nodes, one of each geometry, that is proven farther apart than the
    /// distance. Every pair of triangles, pieces or patches lies under an entry.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.followed
            .as_ref()
            .map_or(0, |f| f.tracked.engine.report().front_len)
    }

    /// Returns the bytes of the cached state on the heap, without converted bodies and contacts.
    #[must_use]
    pub fn memory_usage(&self) -> usize {
        self.followed.as_ref().map_or(0, |f| f.tracked.engine.memory_usage())
    }

    /// Returns the first broken invariant of the cached state: a tool for tests and fuzzing.
    ///
    /// The check compares the front of two meshes with all vertices, at the pose of the last
    /// [`closest`](Self::closest). Its time is proportional to entries times triangles.
    ///
    /// # Errors
    /// Returns an error that names the broken invariant.
    pub fn check<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Result<(), String> {
        self.borrow([a.into(), b.into()]).check(a_from_b)
    }
}

impl Replay {
    /// Returns a tracker of [`shapes`](Self::shapes) with the recorded start.
    #[must_use]
    pub fn pair_tracker(&self) -> PairTracker {
        let [a, b] = self.shapes();
        let mut tracker = PairTracker::new();
        tracker.follow([(&a).into(), (&b).into()]).engine.begin_as(self);
        tracker
    }
}

/// The work of the queries of a [`PairTracker`](crate::PairTracker), by the kind of search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairWork {
    /// Queries of two convex geometries.
    pub convex: TrackerWork,
    /// Queries of compounds and meshes.
    #[cfg(feature = "meshes")]
    pub trees: TreeWork,
    /// Queries with a Bézier surface.
    #[cfg(feature = "surfaces")]
    pub surfaces: SurfaceWork,
}

impl PairWork {
    pub(super) fn of_convex(convex: TrackerWork) -> Self {
        Self {
            convex,
            ..Self::default()
        }
    }

    #[cfg(feature = "meshes")]
    pub(super) fn of_trees(trees: TreeWork) -> Self {
        Self {
            trees,
            ..Self::default()
        }
    }

    #[cfg(feature = "surfaces")]
    pub(super) fn of_surfaces(surfaces: SurfaceWork) -> Self {
        Self {
            surfaces,
            ..Self::default()
        }
    }
}

impl core::ops::AddAssign for PairWork {
    /// Adds all counts. Sums saturate.
    fn add_assign(&mut self, other: Self) {
        self.convex += other.convex;
        #[cfg(feature = "meshes")]
        {
            self.trees += other.trees;
        }
        #[cfg(feature = "surfaces")]
        {
            self.surfaces += other.surfaces;
        }
    }
}

/// Error returned if two geometries of these kinds have no such query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{asked} cannot be computed for a {a} and a {b}")]
#[non_exhaustive]
pub struct PairError {
    /// The kind of A.
    pub a: GeometryKind,
    /// The kind of B.
    pub b: GeometryKind,
    /// The requested query.
    pub asked: &'static str,
}

impl PairTracker {
    /// Computes the contact points of two convex geometries within `options.prediction`.
    ///
    /// `manifold` keeps the ids and the order of the contacts of the previous query. Keep one
    /// manifold per pair and pass it in every frame. [`contacts`](Self::contacts) returns contacts
    /// for all kinds of geometry.
    ///
    /// Rounded polyhedra have the contacts of their cores, moved outward by the radii along the
    /// normal. Curved shapes have contacts on their flat round faces and straight generators if
    /// these are within `options.max_face_sine` of the normal. An ellipsoid, or a rim or
    /// apex without such a face has one contact: the witnesses.
    ///
    /// A flat round face has two kinds of contacts: eight points of its rim at multiples of 45
    /// degrees, if they are over the other shape, and the crossings of the rim with the boundary
    /// of the other face. They do not move on a shape that trembles. If the shapes are tilted by
    /// less than about 2e-4, the deepest contact may be shallower than [`closest`](Self::closest)
    /// by `2^-16` times the radius of the smaller shape.
    ///
    /// Names of features: points of the upper rim of a cylinder are vertices 0 to 7, of its lower
    /// rim 8 to 15, and of the rim of a cone 1 to 8. The second crossing of an edge with a rim has
    /// the face as its feature instead of the rim.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{Manifold, ManifoldOptions, PairTracker, RelativePose, Shape};
    ///
    /// let floor = Shape::cuboid(Vector3::new(5.0, 5.0, 1.0))?;
    /// let can = Shape::cylinder(0.5, 0.25)?;
    /// let at = RelativePose::from_isometry(&Isometry3::translation(1.0, 2.0, 1.51))?;
    /// let (mut tracker, mut manifold) = (PairTracker::new(), Manifold::new());
    /// let options = ManifoldOptions::default().prediction(0.02);
    /// tracker.manifold(&floor, &can, &at, &options, &mut manifold)?;
    /// assert_eq!(manifold.points().len(), 4);
    /// assert!(manifold.points().iter().all(|p| (p.separation - 0.01).abs() < 1e-12));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if one of the geometries is not convex.
    pub fn manifold<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) -> Result<(), PairError> {
        let bodies = [a.into(), b.into()];
        if self.borrow(bodies).manifold(a_from_b, options, manifold) {
            Ok(())
        } else {
            Err(refused(bodies, "manifold"))
        }
    }
}

pub(super) fn refused(bodies: [GeometryRef<'_>; 2], asked: &'static str) -> PairError {
    let [a, b] = bodies.each(GeometryRef::kind);
    PairError { a, b, asked }
}
