//! One tracker for any two geometries.

use alloc::boxed::Box;
use alloc::string::String;
use alloc::vec::Vec;

use super::contacts::ConvexContacts;
use super::engine::AnyTracker;
use super::over::{Kinds, OverTime};
use super::pair::Asked;
use super::work::PairWork;
use crate::composite::contact::{ContactPatches, ContactTracker, PatchContacts};
use crate::composite::decomposition::Decomposition;
use crate::composite::parts::PartsRef;
use crate::composite::penetration::PenetrationBounds;
use crate::contact::{Manifold, ManifoldOptions};
use crate::geometry::{GeometryRef, ShapeKind};
use crate::num::fingerprint::Fingerprint;
use crate::pair::outcome::{Decision, Distance};
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::patch::{Surface, SurfacePart};
use crate::pose::RelativePose;
use crate::replay::Replay;

/// Two geometries of these kinds do not have what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a {a} and a {b} have no {asked}")]
pub struct PairError {
    /// The kind of A.
    pub a: ShapeKind,
    /// The kind of B.
    pub b: ShapeKind,
    /// What was asked for.
    pub asked: &'static str,
}

/// Follows a pair of geometries of any two kinds, in either order.
///
/// A geometry is given as a reference to a [`Geometry`](crate::Geometry) or to a body of any kind. The
/// tracker keeps the state of the pair that was asked last, by its fingerprints. Other geometries, or
/// the same in the other order, begin anew: keep a tracker for each pair. What the state may change
/// stands on the [front page](crate), as for every tracker. For two geometries that are known to be
/// polyhedra [`Tracker`](crate::Tracker) is the faster one: it compares no geometries and chooses no
/// kind.
///
/// | geometries | bounds of `closest`, of the size L of the pair | `intersects` and `within` |
/// |---|---|---|
/// | two polyhedra | `1e-13 L`, on both sides of contact | exact (feature `exact`) |
/// | polyhedra, one rounded at least | `1e-13 L` apart, on both sides of contact | exact (feature `exact`) |
/// | cylinder, cone, ellipsoid, superquadric | `1e-13 L` apart, `2e-13 L` of superquadrics; depths to `2^-19 L` | a distance that the bounds cannot tell from `d` counts as within |
/// | meshes, composites in place | `1e-13 L` apart | exact (feature `exact`) |
/// | composites with placed pieces | `1.5e-13 L` apart | ties count as within |
/// | a surface of patches | as asked for, `2^-30 L` if nothing is | may be undecided |
///
/// Curved shapes within rounding of contact may be [`Undecided`](crate::Class::Undecided), and
/// superquadrics with exponents near 0 or 2 may take some hundred times as long as usual. A mesh that
/// is not closed and a surface of patches have no inside: a body within is apart from them.
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
pub struct PairTracker {
    #[cfg_attr(feature = "serde", serde(skip))]
    followed: Option<Followed>,
    /// The contacts between patches given by the caller.
    #[cfg_attr(feature = "serde", serde(skip))]
    between: Option<Box<ContactTracker>>,
    /// The work for pairs that are followed no more.
    work: PairWork,
}

/// A pair and its tracker.
#[derive(Clone, Debug)]
struct Followed {
    pair: [Fingerprint; 2],
    tracker: AnyTracker,
    contacts: Option<Box<ConvexContacts>>,
}

impl PairTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the state of a pair, kept if the pair was asked last.
    fn of(&mut self, a: GeometryRef, b: GeometryRef) -> &mut Followed {
        let pair = [a.fingerprint(), b.fingerprint()];
        self.kept(pair, || AnyTracker::new((a, b)))
    }

    /// Returns the state of a pair by its fingerprints; that of another pair is dropped.
    fn kept(&mut self, pair: [Fingerprint; 2], new: impl FnOnce() -> AnyTracker) -> &mut Followed {
        let followed = match self.followed.take() {
            Some(followed) if followed.pair == pair => followed,
            other => {
                if let Some(other) = other {
                    self.work += other.tracker.work();
                }
                Followed {
                    pair,
                    tracker: new(),
                    contacts: None,
                }
            }
        };
        self.followed.insert(followed)
    }

    /// Measures two bodies of parts, the first of which is a composite that stays one beside a mesh.
    fn distance_by_pieces(
        &mut self,
        a: GeometryRef,
        b: GeometryRef,
        a_from_b: &RelativePose,
        bounds: impl FnOnce(&Answer, &PartsRef) -> Distance,
    ) -> Distance {
        let pair = [a, b].map(|body| body.fingerprint().with(*b"pieces  ", 0.0));
        let followed = self.kept(pair, || AnyTracker::of_pieces((a, b)));
        match followed.tracker.over((a, b)) {
            Kinds::Pieces(pair) => {
                let found = pair.tracker.closest(&pair.a, &pair.b, a_from_b);
                bounds(&found, &pair.b)
            }
            mut other => Distance::from(&other.answer(a_from_b, &Question::new())),
        }
    }

    fn pair<'p>(&'p mut self, a: GeometryRef<'p>, b: GeometryRef<'p>) -> Kinds<'p> {
        self.of(a, b).tracker.over((a, b))
    }

    /// Returns the closest points with bounds of the signed distance. Two convex geometries that
    /// overlap have their penetration depth as a negative distance.
    ///
    /// Witnesses of convex shapes lie on the rounded surfaces, opposite each other along the normal at
    /// the distance returned, whether the shapes are apart, touch or overlap. If one of them is a
    /// cylinder, cone or ellipsoid, to 1e-9 times the size of the pair, and at flush faces or common
    /// axes now and then only to 3e-8; if one is a superquadric, to 1e-7; if only an interval of the
    /// depth is known, to 1e-6. Those of meshes are as far apart as the upper bound, up to rounding of
    /// their places, `1e-12 L`. If one body is inside the other, the witness is a point of the inner
    /// one; if several parts overlap, the witnesses need not coincide.
    ///
    /// Solids whose surfaces touch and do not certainly cross overlap if an inner point of both is
    /// found: by up to 128 of the pairs of triangles in contact, by 32 triangles from all over each
    /// mesh, and by points of each connected part. If all of these miss an overlap, the class is
    /// [`Class::Touching`](crate::Class::Touching); the bounds, both zero, hold all the same. Within
    /// `1e-13 L` of contact the class of such a pair may differ between warm and cold trackers, and
    /// between A to B and B to A.
    ///
    /// A query of meshes takes time in proportion to the pairs of triangles that are as close as the
    /// closest ones, up to rounding: a few for most bodies, six for each triangle of a dome 1e-9 above
    /// a copy of itself.
    pub fn closest<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Answer {
        self.ask(a, b, a_from_b, &Question::new())
    }

    /// Returns the closest points as [`closest`](Self::closest) does, with the options of a question.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Point3};
    /// use lin_canny::patch::{Patch, Surface};
    /// use lin_canny::{PairTracker, Question, RelativePose, Shape};
    ///
    /// // A ball over the top of a dome.
    /// let at = |k: usize| {
    ///     let (x, y) = ((k / 3) as f64 - 1.0, (k % 3) as f64 - 1.0);
    ///     Point3::new(x, y, -x.abs() - y.abs())
    /// };
    /// let points: Vec<_> = (0..9).map(at).collect();
    /// let patch = Patch::polynomial([2, 2], &points)?;
    /// let dome = Surface::new(vec![patch])?;
    /// let ball = Shape::ball(0.5)?;
    /// let pose = Isometry3::translation(0.1, 0.0, 2.0);
    /// let pose = RelativePose::from_isometry(&pose)?;
    /// let narrow = Question::new().width(1e-9);
    /// let mut tracker = PairTracker::new();
    /// let answer = tracker.ask(&dome, &ball, &pose, &narrow);
    /// assert!(answer.is_reached && answer.upper - answer.lower <= 1e-9);
    /// // The parameters of the closest point of the dome.
    /// let [u, v] = answer.on[0].parameters;
    /// assert!((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn ask<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        question: &Question,
    ) -> Answer {
        self.pair(a.into(), b.into()).answer(a_from_b, question)
    }

    /// Returns the signed distance and its bounds without the witnesses.
    pub fn distance<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b))
    }

    /// Returns a lower bound of the distance: for composites and meshes in one pass over what the
    /// tracker keeps, without looking for the closest pair; zero if nothing better is known.
    pub fn lower_bound<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> f64 {
        self.pair(a.into(), b.into()).lower_bound(a_from_b)
    }

    /// Returns whether the geometries share a point; touching counts. Only pairs with a surface of
    /// patches may be undecided; curved shapes whose bounds hold both answers count as sharing one.
    pub fn intersects<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Decision {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the geometries are at most `d` apart, `d` in the caller's unit; no for a
    /// negative `d` and NaN. Only pairs with a surface of patches may be undecided: if `d` is within
    /// rounding of the distance, or a budget is used up; so may be two surfaces that touch, for a `d`
    /// of zero. For curved shapes, a distance that the bounds cannot tell from `d` counts as within,
    /// and for such a `d` the answer may depend on the last query.
    ///
    /// Of two meshes or composites, two kinds of ties count as within: a connected part of one solid
    /// of which four vertices, the farthest from each other, are all nearer than `1e-13 L` to the
    /// surface of the other (and, of a solid of one part, the middles of up to 256 triangles all over
    /// it), and bodies 1e58 times as far apart as they are large or more. Every pair of triangles
    /// that is nearer to `d` than rounding takes an exact query of its own, some 10 us: flush faces,
    /// and surfaces that lie on each other at a gap below `1e-13 L`, have three to twelve such pairs
    /// for each triangle, and no budget cuts them short. Solids that certainly share inner points are
    /// told after 128.
    pub fn within<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        d: f64,
    ) -> Decision {
        self.ask_within(a, b, a_from_b, d, &Question::new())
    }

    /// Returns whether the geometries are at most `d` apart as [`within`](Self::within) does, with
    /// the budget of a question.
    pub fn ask_within<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        d: f64,
        question: &Question,
    ) -> Decision {
        self.pair(a.into(), b.into()).within(a_from_b, d, question)
    }

    /// Returns the contact points within `options.prediction`, in groups of one direction, the group
    /// of the deepest contact first.
    ///
    /// Two convex geometries have one group, the points of their [`manifold`](Self::manifold); else
    /// the groups are those of the patches of meshes and the pieces of composites, as of
    /// [`contacts_between`](Self::contacts_between). The tracker makes the patches of a body at the
    /// first call: of a body that is lent without being shared, from a copy.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Geometry, ManifoldOptions, Mesh};
    /// use lin_canny::{PairTracker, RelativePose, Shape};
    ///
    /// let half = Vector3::new(5.0, 5.0, 1.0);
    /// let floor = Mesh::from_convex(&solids::cuboid(half)?)?;
    /// let floor = Geometry::from(floor);
    /// let die = Shape::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// let at = Isometry3::translation(0.1, 0.0, 1.49);
    /// let at = RelativePose::from_isometry(&at)?;
    /// let mut tracker = PairTracker::new();
    /// let options = ManifoldOptions::within(0.02);
    /// let found = tracker.contacts(&floor, &die, &at, &options)?;
    /// assert_eq!((found.len(), found[0].contacts.len()), (1, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If one of both is a surface of patches, which bears no contacts.
    pub fn contacts<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> Result<&[PatchContacts], PairError> {
        let (a, b) = (a.into(), b.into());
        let followed = self.of(a, b);
        let Followed { tracker, contacts, .. } = followed;
        if contacts.is_some() || tracker.is_convex() {
            let convex = contacts.get_or_insert_default();
            tracker.manifold((a, b), a_from_b, options, &mut convex.manifold);
            return Ok(convex.found());
        }
        tracker
            .contacts((a, b), a_from_b, options)
            .ok_or_else(|| refused(a, b, "contacts"))
    }

    /// Returns the contact points of two bodies whose patches the caller has made, as
    /// [`contacts`](Self::contacts) does: for bodies of many pairs, which share their patches, and for
    /// patches with a tolerance of their own.
    ///
    /// `options.sine` and `options.drift` are those of the manifold of two patches. Contacts are those
    /// of shallow overlap: a body that is wholly behind a face, or whose deepest point has left the
    /// mesh on another side, has no contact with that face. If solids overlap whose hulls of patches
    /// bear no contact at all, they have one along a translation that parts them, that of
    /// [`penetration`](Self::penetration), at its price; a solid that is deep inside another one, away
    /// from all patches, has none.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{ContactPatches, ManifoldOptions, Mesh};
    /// use lin_canny::{PairTracker, RelativePose, Shape};
    ///
    /// let half = Vector3::new(5.0, 5.0, 1.0);
    /// let floor = Mesh::from_convex(&solids::cuboid(half)?)?;
    /// let floor = ContactPatches::of_mesh(floor);
    /// let die = Shape::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// let die = ContactPatches::from(die);
    /// let at = Isometry3::translation(0.1, 0.0, 1.49);
    /// let at = RelativePose::from_isometry(&at)?;
    /// let mut tracker = PairTracker::new();
    /// let options = ManifoldOptions::within(0.02);
    /// let found = tracker.contacts_between(&floor, &die, &at, &options);
    /// assert_eq!((found.len(), found[0].contacts.len()), (1, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contacts_between(
        &mut self,
        a: &ContactPatches,
        b: &ContactPatches,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> &[PatchContacts] {
        self.between.get_or_insert_default().contacts(a, b, a_from_b, options)
    }

    /// Computes the contact points of two convex geometries within `options.prediction`, in
    /// `manifold`, which keeps ids and order of the contacts of the previous query: one manifold for
    /// each pair, passed in every frame. [`contacts`](Self::contacts) returns them for all kinds.
    ///
    /// Rounded polyhedra have the contacts of their cores, moved out by the radii along the normal.
    /// Curved shapes bear contacts by their flat round faces and straight generators within
    /// `options.sine` of the normal; an ellipsoid, a superquadric, or a rim or apex without such a
    /// face has one contact, the witnesses.
    ///
    /// Contacts of a flat round face are eight points of its rim at multiples of 45 degrees, as far
    /// as they are over the other shape, and the crossings of the rim with the boundary of the
    /// other face. They stand still on a shape that trembles: if the shapes are tilted by less than
    /// some 2e-4, the deepest contact may be shallower than [`closest`](Self::closest) by `2^-16`
    /// times the radius of the smaller shape. As features, the points of the upper rim of a
    /// cylinder are vertices 0 to 7, of the lower rim 8 to 15, and of the rim of a cone 1 to 8; the
    /// second crossing of an edge with a rim is named by the face instead of the rim.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{Manifold, ManifoldOptions, PairTracker, RelativePose, Shape};
    ///
    /// let floor = Shape::cuboid(Vector3::new(5.0, 5.0, 1.0))?;
    /// let can = Shape::cylinder(0.5, 0.25)?;
    /// let at = RelativePose::from_isometry(&Isometry3::translation(1.0, 2.0, 1.51))?;
    /// let (mut tracker, mut manifold) = (PairTracker::new(), Manifold::new());
    /// let options = ManifoldOptions::within(0.02);
    /// tracker.manifold(&floor, &can, &at, &options, &mut manifold)?;
    /// assert_eq!(manifold.points().len(), 4);
    /// assert!(manifold.points().iter().all(|p| (p.separation - 0.01).abs() < 1e-12));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If one of both is not convex.
    pub fn manifold<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) -> Result<(), PairError> {
        let (a, b) = (a.into(), b.into());
        let tracker = &mut self.of(a, b).tracker;
        if tracker.manifold((a, b), a_from_b, options, manifold) {
            Ok(())
        } else {
            Err(refused(a, b, "manifold"))
        }
    }

    /// Returns bounds of the penetration depth of two solids, the length of the shortest translation
    /// of B after which they share no inner point. `None` if one of both has no inside: a mesh that is
    /// not closed, or a surface of patches.
    ///
    /// Below stands the depth of the deepest of some thousand vertices inside the other body, of the
    /// deepest pair of pieces, or of convex parts of both bodies where they overlap; above a
    /// translation that parts the bodies. The interval may be wide: bodies that hold each other at
    /// several places are deeper than at any one of them, and slots lead the search astray. Of two
    /// convex geometries [`closest`](Self::closest) tells the depth itself.
    ///
    /// Two meshes take at most 35 queries and 13 looks at up to 2,048 vertices of each body:
    /// milliseconds to tens of them for meshes of thousands of triangles. Of composites every pair of
    /// pieces is measured, or every piece against the points of a mesh, then dozens of queries.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, PairTracker, RelativePose, Shape};
    ///
    /// let half = Vector3::new(1.0, 1.0, 0.5);
    /// let table = Mesh::from_convex(&solids::cuboid(half)?)?;
    /// let ball = Shape::ball(0.3)?;
    /// let at = Isometry3::translation(0.0, 0.0, 0.7);
    /// let at = RelativePose::from_isometry(&at)?;
    /// let found = PairTracker::new().penetration(&table, &ball, &at);
    /// let found = found.expect("two solids");
    /// assert!(found.lower > 0.0999 && found.lower <= 0.1);
    /// assert!(found.upper >= 0.1 && found.upper < 0.1002);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn penetration<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Option<PenetrationBounds> {
        self.pair(a.into(), b.into()).penetration(a_from_b)
    }

    /// Returns two geometries that can be measured over time, followed by this tracker: what
    /// [`impact::cast`](crate::impact::cast) takes.
    ///
    /// A measure of a pair with a surface of patches has bounds that are at most a quarter of the
    /// distance apart. A hit of two surfaces is proven by a crossing, so a tolerance must leave room
    /// for one: from some `1e-8` of the size on; that of a surface and a solid by a point of the
    /// surface within the solid.
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
    /// let mut pair = tracker.over(&wall, &ball);
    /// let tolerance = Tolerance::Distance(1e-9);
    /// let found = cast(&mut pair, &still, &thrown, (0.0, 2.0), tolerance)?;
    /// let Impact::Hit { safe, hit, .. } = found.impact else {
    ///     panic!("{:?}", found.impact)
    /// };
    /// assert!(safe < 1.25 && 1.25 < hit && hit - safe < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn over<'p>(&'p mut self, a: impl Into<GeometryRef<'p>>, b: impl Into<GeometryRef<'p>>) -> OverTime<'p> {
        OverTime(self.pair(a.into(), b.into()))
    }

    /// Returns a query of two convex geometries as a text that rebuilds the query bit for bit, as
    /// [`Tracker::replay`](crate::Tracker::replay): call this before the query. `None` unless both are
    /// polyhedra, rounded or not.
    #[must_use]
    pub fn replay<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Option<Replay> {
        let (a, b) = (a.into(), b.into());
        self.of(a, b).tracker.replay((a, b), a_from_b)
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub fn work(&self) -> PairWork {
        let mut work = self.work;
        if let Some(followed) = &self.followed {
            work += followed.tracker.work();
        }
        work
    }

    /// Returns the number of entries of the front that is kept: pairs of parts of both geometries that
    /// are proven farther apart than the distance, under which every pair of triangles, pieces or
    /// patches lies. Zero for convex geometries, which have none.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.followed.as_ref().map_or(0, |f| f.tracker.front_len())
    }

    /// Returns the front that is kept of two surfaces of patches: pairs of parts of A and of B that
    /// are proven apart. Empty for surfaces other than those of the last query.
    #[must_use]
    pub fn surface_front(&self, a: &Surface, b: &Surface) -> Vec<[SurfacePart; 2]> {
        let tracker = self.followed.as_ref().and_then(|f| f.tracker.surfaces());
        tracker.map(|t| t.front(a, b).collect()).unwrap_or_default()
    }

    /// Returns the bytes that the tracker keeps on the heap, without those of stand-ins and contacts.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        self.followed.as_ref().map_or(0, |f| f.tracker.heap_bytes())
    }

    /// Returns the first broken invariant of what is kept: a tool of tests and fuzzing. The front of
    /// two meshes is compared with all vertices, at the pose of the last [`closest`](Self::closest), in
    /// time that is entries times triangles.
    ///
    /// # Errors
    /// A text that names the broken invariant.
    pub fn check<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
    ) -> Result<(), String> {
        self.pair(a.into(), b.into()).check(a_from_b)
    }

    /// Forgets everything that is kept, counters too.
    pub fn reset(&mut self) {
        *self = Self::new();
    }
}

impl Decomposition {
    /// Returns bounds of the distance of the mesh from another geometry, by the distance of the
    /// pieces.
    ///
    /// If the bounds leave open whether the bodies meet, the class is
    /// [`Class::Undecided`](crate::Class::Undecided); no depth is told. A surface of patches is
    /// measured against the mesh.
    pub fn distance<'g>(
        &'g self,
        tracker: &mut PairTracker,
        other: impl Into<GeometryRef<'g>>,
        mesh_from_other: &RelativePose,
    ) -> Distance {
        let other = other.into();
        let pieces = GeometryRef::from(self.pieces());
        if other.surface().is_some() {
            return tracker.distance(self.mesh(), other, mesh_from_other);
        }
        tracker.distance_by_pieces(pieces, other, mesh_from_other, |found, other| {
            self.bounds(found, other, mesh_from_other)
        })
    }
}

impl Replay {
    /// Returns a tracker of [`shapes`](Self::shapes) with the recorded start.
    #[must_use]
    pub fn pair_tracker(&self) -> PairTracker {
        let [a, b] = self.shapes();
        let mut tracker = PairTracker::new();
        tracker.of((&a).into(), (&b).into()).tracker.begin_as(self);
        tracker
    }
}

fn refused(a: GeometryRef, b: GeometryRef, asked: &'static str) -> PairError {
    let (a, b) = (a.kind(), b.kind());
    PairError { a, b, asked }
}
