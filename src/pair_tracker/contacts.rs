//! Contacts of two geometries of any kind, and bounds of the depth of two solids.

use alloc::boxed::Box;
use alloc::vec::Vec;
use nalgebra::Point3;

use super::borrowed_pair::BorrowedPair;
use super::engine::TrackedPair;
use super::tracker::PairTracker;
use super::tracker::{PairError, refused};
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::sort::sort_by_key;
use crate::base::pose::RelativePose;
use crate::body::shape::Shape;
use crate::convex::contact::{Manifold, ManifoldOptions};
use crate::nonconvex::cloud::Cloud;
use crate::nonconvex::contact::{ContactGroup, ContactTracker, ConvexPatches, PatchContact};
use crate::nonconvex::parts::PartsRef;
use crate::nonconvex::parts::{Parted, relative};
use crate::nonconvex::penetration::{Narrowing, PenetrationBounds};
use crate::nonconvex::pieces::{Compound, CompoundTracker};
use crate::pair::options::QueryOptions;
use crate::pair_tracker::geometry::{Borrowed, GeometryRef};

/// The contacts of a pair.
#[derive(Clone, Debug)]
pub(crate) enum PairContacts {
    /// Two convex bodies.
    Convex(Box<ConvexContacts>),
    /// A compound or a mesh, and any other body.
    Patches(Box<PatchwiseContacts>),
}

impl PairContacts {
    /// Returns the contacts of a pair with a body that is not convex, none so far.
    pub(crate) fn of_patches() -> Self {
        Self::Patches(Box::default())
    }
}

/// The contacts of a pair with a compound, a mesh, a cloud or a half-space.
#[derive(Clone, Debug, Default)]
pub(crate) struct PatchwiseContacts {
    tracker: ContactTracker,
    /// The patches of bodies for which the caller has made none.
    copies: [Option<ConvexPatches>; 2],
    /// The elements of clouds near the other body.
    near: [Option<NearElements>; 2],
    /// The contacts of a pair with a half-space or a cloud, which are not as the tracker has them.
    converted: Option<Vec<ContactGroup>>,
}

/// The elements of a cloud near another body, as patches.
#[derive(Clone, Debug)]
struct NearElements {
    cloud: Fingerprint,
    /// The number of the point of each patch; they rise.
    numbers: Vec<u32>,
    patches: ConvexPatches,
}

/// Factor by which the ball of a body grows around which elements are collected, so that the same
/// elements serve for some frames.
const COLLECTED: f64 = 1.25;

impl NearElements {
    /// Returns the elements within a ball in the frame of the cloud; `None` if there are none.
    ///
    /// Elements that were collected before stay if they contain all of these.
    fn collect(before: Option<Self>, cloud: &Cloud, (centre, radius): (Point3<f64>, f64)) -> Option<Self> {
        let sorted = |radius: f64| {
            let mut items = cloud.items_near((centre, radius));
            sort_by_key(&mut items, |item| cloud.number(*item));
            items
        };
        let numbers = |items: &[u32]| -> Vec<u32> { items.iter().map(|item| cloud.number(*item)).collect() };
        let needed = numbers(&sorted(radius));
        if needed.is_empty() {
            return None;
        }
        let holds_all = |before: &Self| {
            let mut held = before.numbers.iter();
            before.cloud == cloud.fingerprint() && needed.iter().all(|number| held.any(|k| k == number))
        };
        if let Some(before) = before.filter(holds_all) {
            return Some(before);
        }
        let items = sorted(COLLECTED * radius);
        Some(Self {
            cloud: cloud.fingerprint(),
            numbers: numbers(&items),
            patches: ConvexPatches::from_compound(cloud.compound_of(items.into_iter()).ok()?),
        })
    }
}

impl PatchwiseContacts {
    /// Returns the contacts of two bodies at a pose; `None` if one of them can have no contacts.
    ///
    /// Bodies without patches get them here once, and clouds those of the elements near the other
    /// body. A mesh gets new patches after its vertices have moved.
    pub(crate) fn find(
        &mut self,
        bodies: [GeometryRef<'_>; 2],
        patches: [Option<&ConvexPatches>; 2],
        pose: &RelativePose,
        options: &ManifoldOptions,
    ) -> Option<&[ContactGroup]> {
        if let Some(pair) = GeometryRef::half_space_pair(bodies) {
            return Some(self.converted.insert(pair.contacts(pose, options)));
        }
        self.converted = None;
        for (k, own) in bodies.into_iter().enumerate() {
            let is_known = |known: &ConvexPatches| own.mesh().is_none_or(|mesh| known.are_of(mesh));
            if patches[k].is_none() && !self.copies[k].as_ref().is_some_and(is_known) {
                self.copies[k] = patches_of(own);
            }
        }
        let is_cloud = |k: usize| matches!(bodies[k].0, Borrowed::Cloud(_));
        if (0..2).any(|k| !is_cloud(k) && patches[k].is_none() && self.copies[k].is_none()) {
            return None;
        }
        let balls = bodies.each(GeometryRef::bounding_ball);
        for (k, own) in bodies.into_iter().enumerate() {
            let Borrowed::Cloud(cloud) = own.0 else { continue };
            let at = relative(pose);
            let (centre, radius) = balls[1 - k];
            let centre = if k == 0 {
                at * centre
            } else {
                at.inverse_transform_point(&centre)
            };
            let ball = (centre, radius + options.prediction.at_least(0.0));
            self.near[k] = NearElements::collect(self.near[k].take(), cloud.get(), ball);
            if self.near[k].is_none() {
                return Some(self.converted.insert(Vec::new()));
            }
        }
        let part = |k: usize| {
            let near = self.near[k].as_ref().map(|near| &near.patches);
            near.or(patches[k]).or(self.copies[k].as_ref())
        };
        let found = self.tracker.contacts(part(0)?, part(1)?, pose, options);
        if self.near.iter().all(Option::is_none) {
            return Some(found);
        }
        let mut found = found.to_vec();
        for contact in found.iter_mut().flat_map(|group| &mut group.contacts) {
            for (patch, near) in contact.patches.iter_mut().zip(&self.near) {
                if let Some(near) = near {
                    *patch = near.numbers[*patch as usize];
                }
            }
        }
        Some(self.converted.insert(found))
    }

    pub(crate) fn found(&self) -> &[ContactGroup] {
        match &self.converted {
            Some(found) => found,
            None => self.tracker.found(),
        }
    }
}

/// Returns the patches of a body; `None` for a cloud, a Bézier surface and a half-space.
pub(crate) fn patches_of(own: GeometryRef) -> Option<ConvexPatches> {
    match own.0 {
        Borrowed::Mesh(mesh) => Some(ConvexPatches::from_mesh(mesh.to_arc())),
        Borrowed::Compound(body) => Some(ConvexPatches::from_compound(body.to_arc())),
        Borrowed::Polyhedron(_) | Borrowed::Convex(_) => own.to_shape().map(|s| ConvexPatches::from((*s).clone())),
        #[cfg(feature = "surfaces")]
        Borrowed::BezierSurface(_) => None,
        Borrowed::Cloud(_) | Borrowed::HalfSpace(_) => None,
    }
}

/// The contacts of two convex bodies: their manifold, and its points as the contacts of one patch
/// per body.
#[derive(Clone, Debug, Default)]
pub(crate) struct ConvexContacts {
    manifold: Manifold,
    found: Vec<ContactGroup>,
}

impl ConvexContacts {
    /// Returns the points of the manifold.
    fn found(&mut self) -> &[ContactGroup] {
        let normal = self.manifold.normal();
        let contact = |point: &_| PatchContact {
            patches: [0; 2],
            normal,
            point: *point,
        };
        let points = self.manifold.points();
        if points.is_empty() {
            self.found.clear();
            return &self.found;
        }
        let mut contacts = self.found.pop().map(|group| group.contacts).unwrap_or_default();
        contacts.clear();
        contacts.extend(points.iter().map(contact));
        self.found.push(ContactGroup { normal, contacts });
        &self.found
    }
}

impl PairTracker {
    /// Returns the contact points within `options.prediction`, in groups of one direction each.
    ///
    /// The group of the deepest contact comes first.
    ///
    /// Two convex geometries have one group: the points of their [`manifold`](Self::manifold).
    /// Otherwise the groups belong to the patches of meshes and the pieces of compounds, as in
    /// [`contacts_between`](Self::contacts_between). The tracker makes the patches of a body at the
    /// first call; if the body is borrowed without being shared, it makes them from a copy. Of a
    /// cloud, the elements near the other body are its patches, with the numbers of their points.
    ///
    /// A body on a half-space has one group: the lowest point, and the points within the prediction
    /// that span the most area. They are vertices, points of flat round faces, or ends of straight
    /// generators; a surface has its lowest point only. Seen from the lowest point, all of them are
    /// as flat over the plane as `options.max_face_sine` permits.
    ///
    /// In an inner corner, each wall has a contact, and no contact is deeper than the penetration
    /// depth of the solids, up to the rounding error of the pair. This is tested, not proven.
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
    /// let options = ManifoldOptions::default().prediction(0.02);
    /// let found = tracker.contacts(&floor, &die, &at, &options)?;
    /// assert_eq!((found.len(), found[0].contacts.len()), (1, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if one of the geometries is a Bézier surface, because a surface has no
    /// contacts, unless the other is a half-space.
    pub fn contacts<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> Result<&[ContactGroup], PairError> {
        let [a, b] = [a.into(), b.into()];
        let TrackedPair { engine, contacts, .. } = self.follow([a, b]);
        let new = || {
            if a.kind().is_convex() && b.kind().is_convex() {
                PairContacts::Convex(Box::default())
            } else {
                PairContacts::of_patches()
            }
        };
        match contacts.get_or_insert_with(new) {
            PairContacts::Convex(convex) => {
                engine.borrow([a, b]).manifold(a_from_b, options, &mut convex.manifold);
                Ok(convex.found())
            }
            PairContacts::Patches(kept) => {
                let found = kept.find([a, b], [None; 2], a_from_b, options);
                found.ok_or_else(|| refused([a, b], "contacts"))
            }
        }
    }

    /// Returns the contact points of two bodies whose patches the caller has made.
    ///
    /// Works like [`contacts`](Self::contacts). Use it for bodies of many pairs, which can then
    /// share their patches, and for patches with a tolerance that you choose.
    ///
    /// `options.max_face_sine` and `options.rebuild_motion` apply to the manifold of two patches.
    /// Contacts exist for shallow overlap only: a body that is wholly behind a face, or whose
    /// deepest point has left the mesh on another side, has no contact with that face.
    ///
    /// If solids overlap but the hulls of their patches have no contact at all, the pair gets one
    /// contact. It lies along a translation that separates the bodies, the one of
    /// [`penetration`](Self::penetration), at the cost of that query. A solid deep inside another
    /// solid, far from all patches, has no contact.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{ConvexPatches, ManifoldOptions, Mesh};
    /// use lin_canny::{PairTracker, RelativePose, Shape};
    ///
    /// let half = Vector3::new(5.0, 5.0, 1.0);
    /// let floor = Mesh::from_convex(&solids::cuboid(half)?)?;
    /// let floor = ConvexPatches::from_mesh(floor);
    /// let die = Shape::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// let die = ConvexPatches::from(die);
    /// let at = Isometry3::translation(0.1, 0.0, 1.49);
    /// let at = RelativePose::from_isometry(&at)?;
    /// let mut tracker = PairTracker::new();
    /// let options = ManifoldOptions::default().prediction(0.02);
    /// let found = tracker.contacts_between(&floor, &die, &at, &options);
    /// assert_eq!((found.len(), found[0].contacts.len()), (1, 4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn contacts_between(
        &mut self,
        a: &ConvexPatches,
        b: &ConvexPatches,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> &[ContactGroup] {
        self.between.get_or_insert_default().contacts(a, b, a_from_b, options)
    }

    /// Returns bounds of the penetration depth of two solids; `None` if one of them has no inside.
    ///
    /// The depth is the length of the shortest translation of B after which the solids share no
    /// inner point. A mesh that is not closed and a Bézier surface have no inside. A solid may have
    /// [sheets](crate::MeshKind::Solid) without thickness: the translation also leaves these.
    ///
    /// Lower bound: the greatest depth of a sampled vertex inside the other body (some thousand
    /// vertices), of a pair of pieces, or of convex parts of both bodies around the overlap. Upper
    /// bound: a translation that is proven to separate the bodies.
    ///
    /// The interval may be wide. Bodies that interlock at several positions are deeper than at any
    /// one of them, and slots mislead the search. A translation after which a body exactly fills a
    /// slot is not proven to separate the bodies, so the upper bound is the way out of the slot.
    /// [`penetration_with`](Self::penetration_with) narrows it. For two convex geometries,
    /// [`closest`](Self::closest) returns the depth itself.
    ///
    /// Two meshes take at most 35 queries and 13 passes over up to 2,048 vertices of each body.
    /// This takes milliseconds to tens of milliseconds for meshes of thousands of triangles. For
    /// compounds, every pair of pieces is measured, or every piece against the points of a mesh,
    /// followed by dozens of queries.
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
        self.borrow([a.into(), b.into()]).penetration(a_from_b, None)
    }

    /// Returns bounds of the penetration depth of two solids, narrowed to a width.
    ///
    /// Works like [`penetration`](Self::penetration). Afterwards, if the bounds are further apart
    /// than `options.width`, a search over translations narrows them: it splits cells of
    /// translations until the width is reached, or `options.splits` cells have been split. Without
    /// a width, the result is that of `penetration`. Compare `upper - lower` with the width to see
    /// whether it was reached.
    ///
    /// The number of cells grows with the depth divided by the width. A cell takes microseconds if
    /// the bodies are convex around the overlap, and up to the time of `penetration` if they are
    /// not.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{Compound, PairTracker, Piece, QueryOptions};
    /// use lin_canny::{RelativePose, Shape};
    ///
    /// // A bar in a slot that is too narrow: the shortest way out is upwards.
    /// let wall = |x: f64| -> Result<Piece, lin_canny::ShapeError> {
    ///     let half = Vector3::new(0.5, 2.0, 1.0);
    ///     let pose = Isometry3::translation(x, 0.0, 0.0);
    ///     let shape = Shape::cuboid(half)?;
    ///     Ok(Piece { pose, ..Piece::new(shape) })
    /// };
    /// let slot = Compound::new(vec![wall(-1.0)?, wall(1.0)?])?;
    /// let bar = Shape::cuboid(Vector3::new(0.7, 0.7, 0.7))?;
    /// let at = RelativePose::from_isometry(&Isometry3::identity())?;
    /// let mut tracker = PairTracker::new();
    /// let wide = tracker.penetration(&slot, &bar, &at).expect("solids");
    /// assert!(wide.lower < 0.3 && wide.upper >= 1.7);
    /// let options = QueryOptions::default().width(0.1);
    /// let narrow = tracker.penetration_with(&slot, &bar, &at, &options);
    /// let narrow = narrow.expect("solids");
    /// assert!(narrow.lower <= 1.7 && 1.7 <= narrow.upper);
    /// assert!(narrow.upper - narrow.lower <= 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn penetration_with<'g>(
        &mut self,
        a: impl Into<GeometryRef<'g>>,
        b: impl Into<GeometryRef<'g>>,
        a_from_b: &RelativePose,
        options: &QueryOptions,
    ) -> Option<PenetrationBounds> {
        let narrowing = Narrowing::new(options);
        self.borrow([a.into(), b.into()]).penetration(a_from_b, narrowing)
    }
}

impl BorrowedPair<'_> {
    /// Returns bounds of the penetration depth of two solids.
    fn penetration(&mut self, pose: &RelativePose, narrowing: Option<Narrowing>) -> Option<PenetrationBounds> {
        let [a, b] = match self {
            Self::Polyhedra(pair) => {
                let (a, b, _) = pair.sides();
                [a, b].each(|body| Compound::from(Shape::from(body.clone())))
            }
            Self::Shapes(pair) => {
                let (a, b, _) = pair.sides();
                [a, b].each(|shape| Compound::from(shape.clone()))
            }
            Self::Pieces(pair) => return pair.tracker.penetration(&pair.a, &pair.b, pose, narrowing),
            Self::Meshes(pair) => return pair.tracker.penetration(pair.a, pair.b, pose, narrowing),
            _ => return None,
        };
        // As all other callers do: the search is compiled once.
        let [a, b] = [&a, &b].each(PartsRef::Pieces);
        CompoundTracker::new().penetration(&a, &b, pose, narrowing)
    }
}
