//! Meshes and compounds as convex members under a tree, and relative poses of members.

use core::ops::Range;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{Feature, VertexId};
use crate::body::shape::{Shape, Top};
#[cfg(feature = "exact")]
use crate::convex::exact::place::ExactVector;
use crate::nonconvex::cloud::Cloud;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::pieces::Compound;
use crate::nonconvex::query::frame::{TreeSide, of_stored};

/// Number of triangles whose centroids are tested for being inside another solid.
///
/// They are tested if all vertices tested before lie within rounding of its surface.
const MIDDLES: usize = 256;

/// A mesh, a compound or a cloud.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PartsRef<'a> {
    /// A triangle mesh.
    Mesh(&'a Mesh),
    /// A compound.
    Pieces(&'a Compound),
    /// A cloud.
    Cloud(&'a Cloud),
}

/// A body of convex members under a tree: a [`Mesh`], a [`Compound`] or a [`Cloud`].
///
/// The members are the triangles of the mesh, the pieces of the compound or the elements of the
/// cloud. Points and directions
/// are in stored units of the body. An item is the index of a member in the tree.
pub(crate) trait Parted {
    /// Returns the body by its kind, for queries that meshes and compounds answer differently.
    fn by_kind(&self) -> PartsRef<'_>;

    /// Returns the body as the tree searches use it.
    fn side(&self) -> TreeSide<'_>;

    /// Returns the fingerprint by which a tracker recognises the body.
    fn fingerprint(&self) -> Fingerprint;

    /// Returns whether a fingerprint is an earlier one of this body.
    ///
    /// If so, the paths of its tree bound how far its points have moved since then. Only vertices
    /// of meshes move.
    fn came_from(&self, _: Fingerprint) -> bool {
        false
    }

    /// Returns one stored unit in the caller's unit.
    fn stored_unit(&self) -> f64;

    /// Returns the corners of a bounding box in the body's frame, exact up to rounding.
    fn corners_of_box(&self) -> (Point3<f64>, Point3<f64>);

    /// Returns the size of the body, wherever its origin is, in the caller's unit.
    ///
    /// It is half the diagonal of the bounding box, or the radius about the stored origin if that
    /// is smaller.
    fn half_size(&self) -> f64 {
        let (low, high) = self.corners_of_box();
        let radius = self.side().radius * self.stored_unit();
        radius.smaller(0.5 * sqrt((high - low).norm_squared()))
    }

    /// Returns whether the frames of all members equal the body's, so that no pose is composed.
    fn is_in_place(&self) -> bool;

    /// Returns whether the body and its members are stored in their frames as given.
    ///
    /// If not, depths are computed in a frame about the stored origin ([`Centred`]).
    fn is_near(&self) -> bool {
        self.side().frame.is_at_origin()
    }

    /// Returns whether the frames of all members are shifted, never rotated.
    ///
    /// Then the pose of a member in the world is exact if the pose of the body is the identity.
    fn is_shifted(&self) -> bool {
        false
    }

    /// Returns an upper bound of the support value of an item along a direction of any length.
    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64;

    /// Returns the highest point of an item along a unit direction, in the caller's unit.
    fn peak(&self, item: u32, n: &Vector3<f64>) -> Top {
        let (part, origin) = if self.is_near() || self.is_in_place() {
            (self.part(item), Vector3::zeros())
        } else {
            (self.stored_part(item), self.side().frame.origin)
        };
        match part {
            Some((shape, pose)) => {
                let top = shape.top(&pose.rotation.inverse_transform_vector(n));
                let point = pose.rotation * top.point + pose.translation.vector + origin;
                Top { point, ..top }
            }
            None => {
                let point = self.corners_of_box().0.coords;
                let (feature, error) = (Feature::Vertex(VertexId(0)), 2.0 * self.half_size());
                Top {
                    point,
                    feature,
                    excess: 0.0,
                    error,
                }
            }
        }
    }

    /// Computes upper bounds of the support values of some items, like [`highest`](Self::highest).
    #[inline(always)]
    fn heights(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) {
        items.zip(to).for_each(|(item, to)| *to = self.highest(item, n));
    }

    /// Returns the caller's index of an item.
    fn number(&self, item: u32) -> u32;

    /// Returns the shape of an item and its pose in the body.
    ///
    /// Returns `None` for a triangle that is too small, compared with its mesh, to be a body.
    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)>;

    /// Returns [`part`](Self::part) in a frame about the stored origin: shape and pose are near
    /// this origin, for all coordinates in the body.
    fn stored_part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)>;

    /// Returns the pose of an item whose shape is that of other items; `None` for other items.
    ///
    /// Items for which this is not `None` share the tracker of a pair: their features are alike.
    fn shared_pose(&self, _: u32) -> Option<Isometry3<f64>> {
        None
    }

    /// Returns whether points inside belong to the body; false for open meshes.
    fn is_solid(&self) -> bool {
        true
    }

    /// Returns whether [`holds`](Self::holds) can return true; only for solid meshes.
    fn may_hold(&self) -> bool {
        false
    }

    /// Returns the number of pieces, or of connected components of a mesh, as far as it is known.
    fn probe_count(&self) -> usize;

    /// Returns points of a connected component that are far from each other.
    ///
    /// For a mesh the points are not all in one plane, unless the component is flat. For a piece
    /// the first point is an inner one.
    fn probe(&self, k: usize) -> [Vector3<f64>; 4];

    /// Returns the centroid of one of up to 256 triangles spread over a mesh of one component.
    ///
    /// Returns `None` beyond the last one, for other meshes, for compounds and for clouds.
    fn further_probe(&self, _: usize) -> Option<Vector3<f64>> {
        None
    }

    /// Returns a point of a connected component without rounding, in the caller's unit.
    #[cfg(feature = "exact")]
    fn exact_probe(&self, k: usize) -> ExactVector;

    /// Returns whether a point with a position error of `doubt` is inside a solid mesh.
    ///
    /// Returns false for compounds and clouds, whose members are measured as solids. Returns `None`
    /// if the surface is no farther than `doubt`, or if every segment to the outside met an edge.
    fn holds(&self, _point: &Vector3<f64>, _doubt: f64) -> Option<bool> {
        Some(false)
    }
}

impl Parted for Mesh {
    fn by_kind(&self) -> PartsRef<'_> {
        PartsRef::Mesh(self)
    }

    fn side(&self) -> TreeSide<'_> {
        TreeSide {
            tree: &self.tree,
            frame: self.frame,
            radius: self.radius,
            off: self.off,
        }
    }

    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn came_from(&self, earlier: Fingerprint) -> bool {
        Mesh::came_from(self, earlier)
    }

    fn stored_unit(&self) -> f64 {
        self.unit()
    }

    fn corners_of_box(&self) -> (Point3<f64>, Point3<f64>) {
        self.aabb()
    }

    fn is_in_place(&self) -> bool {
        true
    }

    #[inline(always)]
    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64 {
        let [a, b, c] = self.corners(item);
        n.dot(&a).at_least(n.dot(&b)).at_least(n.dot(&c))
    }

    fn peak(&self, item: u32, n: &Vector3<f64>) -> Top {
        let [a, b, c] = self.corners(item).each(|p| n.dot(&p));
        let k = if a >= b && a >= c { 0 } else { 1 + u32::from(c > b) };
        Top {
            point: self.given(&self.corners(item)[k as usize]).coords,
            feature: Feature::Vertex(VertexId(k)),
            excess: 0.0,
            error: 0.0,
        }
    }

    fn number(&self, item: u32) -> u32 {
        self.source_triangles[item as usize]
    }

    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        Some((Shape::from(self.polygon(item)?), Isometry3::identity()))
    }

    fn stored_part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        Some((Shape::from(self.stored_polygon(item)?), Isometry3::identity()))
    }

    fn is_solid(&self) -> bool {
        Mesh::is_solid(self)
    }

    fn may_hold(&self) -> bool {
        Mesh::is_solid(self)
    }

    fn probe_count(&self) -> usize {
        self.part_vertices.len()
    }

    fn probe(&self, k: usize) -> [Vector3<f64>; 4] {
        self.part_vertices[k].each(|v| self.points[v as usize])
    }

    fn further_probe(&self, k: usize) -> Option<Vector3<f64>> {
        let count = self.triangles.len();
        let t = k * count.div_ceil(MIDDLES);
        (self.part_vertices.len() == 1 && t < count).then(|| self.triangle_middle(t as u32))
    }

    #[cfg(feature = "exact")]
    fn exact_probe(&self, k: usize) -> ExactVector {
        let [first, ..] = self.probe(k);
        let about = ExactVector::new(&first).in_units(-self.frame.exponent);
        about.plus(&self.frame.origin)
    }

    fn holds(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool> {
        self.holds_point(point, doubt)
    }
}

/// A body whose frame is about its stored origin.
#[derive(Clone, Debug)]
pub(crate) enum Centred {
    Mesh(Mesh),
    Pieces(Compound),
    Cloud(Cloud),
}

impl Centred {
    /// Moves the frame of a body to its stored origin.
    pub(crate) fn new(body: PartsRef) -> Self {
        match body {
            PartsRef::Mesh(mesh) => Self::Mesh(mesh.centred()),
            PartsRef::Pieces(pieces) => Self::Pieces(pieces.centred()),
            PartsRef::Cloud(cloud) => Self::Cloud(cloud.centred()),
        }
    }

    pub(crate) fn parts(&self) -> PartsRef<'_> {
        match self {
            Self::Mesh(mesh) => PartsRef::Mesh(mesh),
            Self::Pieces(pieces) => PartsRef::Pieces(pieces),
            Self::Cloud(cloud) => PartsRef::Cloud(cloud),
        }
    }
}

macro_rules! either {
    ($parts:expr, $body:ident => $result:expr) => {
        match *$parts {
            PartsRef::Mesh($body) => $result,
            PartsRef::Pieces($body) => $result,
            PartsRef::Cloud($body) => $result,
        }
    };
}

macro_rules! forward {
    ($(fn $name:ident(&self $(, $argument:ident: $kind:ty)*) -> $result:ty;)*) => {$(
        fn $name(&self $(, $argument: $kind)*) -> $result {
            either!(self, body => Parted::$name(body $(, $argument)*))
        }
    )*};
}

impl Parted for PartsRef<'_> {
    fn by_kind(&self) -> PartsRef<'_> {
        *self
    }

    #[cfg(feature = "exact")]
    fn exact_probe(&self, k: usize) -> ExactVector {
        either!(self, body => body.exact_probe(k))
    }

    forward! {
        fn side(&self) -> TreeSide<'_>;
        fn fingerprint(&self) -> Fingerprint;
        fn came_from(&self, earlier: Fingerprint) -> bool;
        fn stored_unit(&self) -> f64;
        fn corners_of_box(&self) -> (Point3<f64>, Point3<f64>);
        fn is_in_place(&self) -> bool;
        fn is_near(&self) -> bool;
        fn is_shifted(&self) -> bool;
        fn highest(&self, item: u32, n: &Vector3<f64>) -> f64;
        fn peak(&self, item: u32, n: &Vector3<f64>) -> Top;
        fn heights(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) -> ();
        fn number(&self, item: u32) -> u32;
        fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)>;
        fn stored_part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)>;
        fn shared_pose(&self, item: u32) -> Option<Isometry3<f64>>;
        fn is_solid(&self) -> bool;
        fn may_hold(&self) -> bool;
        fn probe_count(&self) -> usize;
        fn probe(&self, k: usize) -> [Vector3<f64>; 4];
        fn further_probe(&self, k: usize) -> Option<Vector3<f64>>;
        fn holds(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool>;
    }
}

/// Returns the pose of B in A's frame, exact up to rounding.
pub(crate) fn relative(pose: &RelativePose) -> Isometry3<f64> {
    let (pose_a, pose_b) = pose.poses();
    let unit = |q: UnitQuaternion<f64>| UnitQuaternion::new_normalize(q.into_inner());
    let rotation = unit(unit(pose_a.rotation).inverse() * unit(pose_b.rotation));
    Isometry3::from_parts(pose.translation().into(), rotation)
}

/// Computes the poses of members from the pose of two bodies.
pub(crate) struct Placed<'a> {
    pose: &'a RelativePose,
    frames: MemberFrames,
}

/// How the poses of members follow from the poses of the bodies.
enum MemberFrames {
    /// The frames of all members are those of their bodies.
    Bodies,
    /// Members have the poses of their bodies, or shifted frames in a body whose frame is the
    /// world: no pose is rounded.
    World([Isometry3<f64>; 2]),
    /// Poses are composed with the pose of B in A's frame, both about the stored origins.
    Composed(Isometry3<f64>),
}

impl<'a> Placed<'a> {
    /// Takes the pose of two bodies.
    ///
    /// `is_in_place` is true if the frames of all members of both bodies equal the bodies' frames.
    pub(crate) fn new(pose: &'a RelativePose, is_in_place: bool) -> Self {
        let frames = if is_in_place {
            MemberFrames::Bodies
        } else {
            MemberFrames::Composed(relative(pose))
        };
        Self { pose, frames }
    }

    pub(super) fn of(pose: &'a RelativePose, a: &impl Parted, b: &impl Parted) -> Self {
        let (pose_a, pose_b) = pose.poses();
        let is_exact = |is_in_place: bool, is_shifted: bool, pose: &Isometry3<f64>| {
            is_in_place || is_shifted && *pose == Isometry3::identity()
        };
        if (a.is_shifted() || b.is_shifted())
            && is_exact(a.is_in_place(), a.is_shifted(), &pose_a)
            && is_exact(b.is_in_place(), b.is_shifted(), &pose_b)
        {
            let frames = MemberFrames::World([pose_a, pose_b]);
            return Self { pose, frames };
        }
        let is_in_place = a.is_in_place() && b.is_in_place();
        match of_stored(a.side(), b.side(), pose) {
            Some((about, _)) if !is_in_place => Self {
                pose,
                frames: MemberFrames::Composed(relative(&about)),
            },
            _ => Self::new(pose, is_in_place),
        }
    }

    /// Returns whether the poses of members are those in the caller's frames.
    pub(crate) fn is_given(&self) -> bool {
        !matches!(self.frames, MemberFrames::Composed(_))
    }

    /// Returns the relative pose of two members, and whether it has no rounding error.
    ///
    /// The poses of the members are those of [`Parted::part`] if [`is_given`](Self::is_given), and
    /// those of [`Parted::stored_part`] otherwise.
    pub(crate) fn between(&self, p: &Isometry3<f64>, q: &Isometry3<f64>) -> (RelativePose, bool) {
        match &self.frames {
            MemberFrames::Bodies => (*self.pose, true),
            MemberFrames::World(bodies) => {
                // One of both is the identity.
                let pick = |body: &Isometry3<f64>, own: &Isometry3<f64>| {
                    if *body == Isometry3::identity() { *own } else { *body }
                };
                let placed = RelativePose::new(&pick(&bodies[0], p), &pick(&bodies[1], q));
                placed.map_or((*self.pose, false), |pose| (pose, true))
            }
            MemberFrames::Composed(composed) => {
                let mut placed = composed * q;
                placed.rotation = UnitQuaternion::new_normalize(placed.rotation.into_inner());
                RelativePose::new(p, &placed).map_or((*self.pose, false), |pose| (pose, false))
            }
        }
    }
}
