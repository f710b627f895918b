//! Compounds of convex pieces; the state of a pair of bodies with convex members, and its queries.
//!
//! Cached trackers query the pairs of members at a pose ([`PartJudge`]).

use alloc::borrow::Cow;
use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

use crate::base::callbacks::Watch;
use crate::base::num::Counter;
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{RelativePose, normalised};
use crate::base::tolerance::{CERTIFICATE, EXPONENT_FREE, NORMALISED, PLACE_MAX, PLACED_PIECE, UNIT};
use crate::body::polyhedron::{
    BoxHint, BuildError, ConvexPolyhedron, FeaturePair, bounding_box, exponent_of, far_origin, power_of_two,
};
use crate::body::shape::{Core, Mass, Shape};
#[cfg(feature = "exact")]
use crate::convex::exact::place::ExactVector;
use crate::convex::shape_tracker::ShapeTracker;
use crate::nonconvex::front::NodePair;
use crate::nonconvex::front::memory::FrontMemory;
use crate::nonconvex::mesh::{Mesh, MeshError, MeshKind};
use crate::nonconvex::near_parts::{NearItems, outcome_of_shape};
use crate::nonconvex::parts::Placed;
use crate::nonconvex::parts::{Parted, PartsRef};
use crate::nonconvex::query::frame::{TreeFrame, TreeSide};
use crate::nonconvex::query::overlap::Touching;
use crate::nonconvex::query::search::TreeWork;
use crate::nonconvex::query::search::{Judge, Measured};
use crate::nonconvex::query::state::{PosedTrees, Recognised, TreeAnswer, TreeState};
use crate::nonconvex::tree::Tree;
use crate::pair::location::{PairOutcome, WitnessLocation};
use crate::pair::outcome::{ContactState, Outcome};
use crate::pair::point::PointOutcome;
use crate::pair::transform::{StoredFrame, placed_from};

/// A convex piece of a [`Compound`]: a shape of any kind, its pose, and a name.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piece {
    /// The caller's name; several pieces may have the same name.
    pub name: String,
    /// The shape in its frame.
    pub shape: Shape,
    /// Pose of the shape's frame in the body's frame.
    ///
    /// [`Compound::new`] normalises the rotation.
    pub pose: Isometry3<f64>,
}

impl Piece {
    /// Returns a piece without a name whose frame is the body's frame.
    #[must_use]
    pub fn new(shape: impl Into<Shape>) -> Self {
        Self {
            name: String::new(),
            shape: shape.into(),
            pose: Isometry3::identity(),
        }
    }
}

/// A shape and its pose in the frame of a body.
type Member = (Shape, Isometry3<f64>);

/// Returns an upper bound of the radius of a posed shape about a point.
///
/// It is the radius of the shape about this point in its frame, plus the length of the translation.
/// A shape with a rotation is taken about the origin.
fn reach((shape, pose): &Member, from: &Vector3<f64>) -> f64 {
    let (centre, radius) = shape.bounding_ball();
    sqrt((centre.coords - from).norm_squared()) + radius + sqrt(pose.translation.vector.norm_squared())
}

/// Returns the origin about which the polyhedral core of a shape is stored, in its frame.
fn core_origin(shape: &Shape) -> Vector3<f64> {
    match shape.core() {
        Core::Polyhedron(body) => body.origin,
        _ => Vector3::zeros(),
    }
}

/// Returns a piece about another origin of its body's frame, as the queries use it.
///
/// A shape that is far from the origin of its frame becomes one about this origin. Its pose is then
/// rounded by less than the rounding of the piece.
fn about(piece: &Piece, origin: &Vector3<f64>) -> Member {
    let (shape, pose) = (&piece.shape, &piece.pose);
    let core = core_origin(shape);
    if core == Vector3::zeros() && *origin == core {
        return (shape.clone(), *pose);
    }
    let place = placed_from(pose, &core, origin);
    let shape = if core == Vector3::zeros() {
        shape.clone()
    } else {
        shape.with_origin(&Vector3::zeros())
    };
    (shape, Isometry3::from_parts(place.into(), pose.rotation))
}

/// Error returned if pieces do not form a valid compound.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompoundError {
    /// There is no piece, or there are more than 2^27.
    #[error("number of pieces is out of range: {count} (expected 1..=134217728)")]
    Count {
        /// Number of pieces given.
        count: usize,
    },
    /// A pose is not finite, squares of its quaternion leave the range of f64, or a piece is
    /// farther than 1e116 from the body's origin.
    #[error("the pose of piece {piece} is not finite or farther than 1e116 from the origin")]
    Pose {
        /// Index of the piece.
        piece: usize,
    },
}

/// A body made of convex pieces of any kind of [`Shape`], which may overlap.
///
/// Examples are the links of URDF and MJCF files, and convex decompositions. A compound of one
/// piece represents a convex body in queries against meshes and compounds.
///
/// The body is the union of the pieces, each of them a solid. It is immutable and `Send + Sync`.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Compound, PairTracker, Piece, RelativePose};
///
/// let beam = solids::cuboid(Vector3::new(1.0, 0.1, 0.1))?;
/// let mut upright = Piece::new(beam.clone());
/// let quarter = Vector3::z() * std::f64::consts::FRAC_PI_2;
/// upright.pose = Isometry3::new(Vector3::new(1.0, 0.9, 0.0), quarter);
/// let bracket = Compound::new(vec![Piece::new(beam), upright])?;
/// let mut pair = PairTracker::new();
/// let pose = Isometry3::translation(0.0, 0.0, 0.5);
/// let a_from_b = RelativePose::from_isometry(&pose)?;
/// let found = pair.closest(&bracket, &bracket, &a_from_b);
/// assert!((found.distance - 0.3).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "compound")]
#[derive(Clone, Debug)]
pub struct Compound {
    /// The pieces in the caller's order.
    pieces: Vec<Piece>,
    /// The pieces about the stored origin, unless all frames equal the body's, or the pieces are
    /// about this origin as given.
    stored: Option<Vec<Member>>,
    /// The index of the piece of each leaf of the tree.
    order: Vec<u32>,
    /// Whether all frames equal the body's, so that no pose is composed.
    in_place: bool,
    tree: Tree,
    /// The frame of stored coordinates: about the middle of the box if that is far from the
    /// caller's origin.
    frame: StoredFrame,
    radius: f64,
    /// Corners of the bounding box, in stored coordinates.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// An inner point of each piece and another point of the piece, in stored units.
    probes: Vec<[Vector3<f64>; 2]>,
    fingerprint: Fingerprint,
}

impl Compound {
    /// Builds a compound from pieces.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no piece or more than 2^27, if a pose is not finite, or if a
    /// piece is farther than 1e116 from the body's origin.
    pub fn new(mut pieces: Vec<Piece>) -> Result<Self, CompoundError> {
        if pieces.is_empty() || pieces.len() > 1 << 27 {
            return Err(CompoundError::Count { count: pieces.len() });
        }
        let mut points = Vec::new();
        let mut corners: Vec<Vec<u32>> = Vec::new();
        for (k, piece) in pieces.iter_mut().enumerate() {
            piece.pose.rotation = normalised(piece.pose.rotation);
            let first = points.len();
            extend_by_hull(&mut points, &piece.shape);
            let placed = &mut points[first..];
            placed
                .iter_mut()
                .for_each(|p| *p = (piece.pose * Point3::from(*p)).coords);
            // Squares of a very long or short quaternion leave the range of f64.
            let is_unit = (piece.pose.rotation.norm_squared() - 1.0).abs() <= NORMALISED;
            // Written so that NaN is an error.
            if !is_unit || !placed.iter().all(|p: &Vector3<f64>| p.amax() < PLACE_MAX) {
                return Err(CompoundError::Pose { piece: k });
            }
            corners.push((first as u32..points.len() as u32).collect());
        }
        Ok(Self::assemble(pieces, &points, &corners))
    }

    fn assemble(pieces: Vec<Piece>, given: &[Vector3<f64>], corners: &[Vec<u32>]) -> Self {
        let (low, high) = bounding_box(given);
        let half = sqrt(((high - low) * 0.5).norm_squared());
        let origin = far_origin(&(low * 0.5 + high * 0.5), half, given.iter().copied());
        let in_place = pieces.iter().all(|p| p.pose == Isometry3::identity());
        let is_far = origin != Vector3::zeros() || pieces.iter().any(|p| core_origin(&p.shape) != Vector3::zeros());
        let stored = (is_far && !in_place).then(|| pieces.iter().map(|p| about(p, &origin)).collect::<Vec<_>>());
        let (given, from) = match &stored {
            Some(members) => (Cow::Owned(hulls_of(members)), Vector3::zeros()),
            None => (Cow::Borrowed(given), origin),
        };
        let members = stored.clone();
        let members = members.unwrap_or_else(|| pieces.iter().map(|p| (p.shape.clone(), p.pose)).collect());
        // The size is at least the rounding error of the position: for a point, and for a body far
        // smaller than its distance from the origin.
        let place = low.amax().larger(high.amax()) * UNIT;
        let size = half.larger(place);
        // A point at the body's origin has no size, so any unit will do.
        let size = if size > 0.0 { size } else { 1.0 };
        let window = 2 * EXPONENT_FREE;
        let exponent = (exponent_of(size) + EXPONENT_FREE).div_euclid(window) * window;
        let scale = power_of_two(-exponent);
        let places: Vec<_> = given.iter().map(|p| (p - from) * scale).collect();
        let (mut tree, order) = Tree::split(&places, corners, 1, &mut Watch::none());
        let mut points = Vec::with_capacity(places.len());
        let items: Vec<Vec<u32>> = order
            .iter()
            .map(|&k| {
                let first = points.len() as u32;
                points.extend(corners[k as usize].iter().map(|&v| places[v as usize]));
                (first..points.len() as u32).collect()
            })
            .collect();
        let farthest = members.iter().map(|m| reach(m, &from)).fold(0.0, f64::larger) * scale;
        tree.fit(&points, &items, CERTIFICATE * UNIT * farthest, &mut Watch::none());
        let (low, high) = bounding_box(&points);
        // The box contains the pieces: the points of rotated ones are rounded. The corners of the
        // box of a curved piece are up to the root of three farther from its origin than the piece.
        let turned = members.iter().filter(|m| m.1.rotation != UnitQuaternion::identity());
        let off = 2.0 * PLACED_PIECE * scale * turned.map(|m| reach(m, &from)).fold(0.0, f64::larger);
        let (low, high) = (low.add_scalar(-off), high.add_scalar(off));
        Self {
            fingerprint: fingerprint(&pieces),
            in_place,
            radius: farthest * (1.0 + 64.0 * UNIT),
            probes: members.iter().map(|m| probe(m).each(|x| (x - from) * scale)).collect(),
            pieces,
            stored,
            order,
            tree,
            frame: StoredFrame { origin, exponent },
            low,
            high,
        }
    }

    /// Returns the hash of shapes and poses.
    pub(crate) fn recognised(&self) -> Fingerprint {
        self.fingerprint
    }

    /// Returns the pieces in the caller's order.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the corners of a bounding box in the body's frame, exact up to rounding.
    ///
    /// The box of rotated pieces is larger by the rounding of their vertices, `1.5e-14` of the
    /// distances from the origins of the pieces, or from their middles if those are far away.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        (self.frame.given(&self.low), self.frame.given(&self.high))
    }

    /// Returns the surfaces of all pieces as one solid mesh, whose components may overlap.
    ///
    /// Vertices of pieces that have a pose are rounded.
    ///
    /// # Errors
    ///
    /// Returns an error if a piece is rounded or curved ([`MeshError::Curved`]), if a piece would
    /// be missing from the mesh ([`MeshError::Thin`]), or if the extent is outside 1e-100..1e100.
    pub fn to_mesh(&self) -> Result<Mesh, MeshError> {
        let given: Vec<Member> = self.pieces.iter().map(|p| (p.shape.clone(), p.pose)).collect();
        mesh_of(given.iter())
    }

    /// Returns the mesh that is the same body as the compound, up to rounding.
    ///
    /// The mesh has a bound of the position error of its points, because the vertices of posed
    /// pieces are rounded. The result is `None` if there is no such mesh: a piece has no volume, or
    /// the mesh would change its surface.
    pub(crate) fn surface_mesh(&self) -> Option<Mesh> {
        let has_volume = |p: &Piece| matches!(p.shape.core(), Core::Polyhedron(body) if body.face_count() > 2);
        if !self.pieces.iter().all(has_volume) {
            return None;
        }
        let mesh = match &self.stored {
            Some(members) => mesh_of(members.iter()).ok()?.moved_to(&self.frame.origin)?,
            None => self.to_mesh().ok()?,
        };
        // Welding points and dropping repeated triangles changes neither the set of points nor its
        // inside.
        let is_same = mesh.kind() == MeshKind::Solid && mesh.report().flushed_coordinates == 0;
        is_same.then(|| mesh.with_points_off(self.off()))
    }

    /// Returns the largest position error of a vertex of a posed piece, in the caller's unit.
    fn off(&self) -> f64 {
        if self.in_place {
            return 0.0;
        }
        // Vertices of pieces about another origin are rounded too, whatever their pose.
        let placed = self
            .members()
            .filter(|m| self.stored.is_some() || m.1 != Isometry3::identity());
        PLACED_PIECE * placed.map(|m| reach(&m, &Vector3::zeros())).fold(0.0, f64::larger)
    }

    /// Returns the pieces about the stored origin, if their frames are not all the body's, and the
    /// pieces as given otherwise.
    fn members(&self) -> impl Iterator<Item = Member> + '_ {
        let given = |k: usize| (self.pieces[k].shape.clone(), self.pieces[k].pose);
        (0..self.pieces.len()).map(move |k| self.stored.as_ref().map_or_else(|| given(k), |m| m[k].clone()))
    }

    /// Returns the pieces about another origin of the body's frame.
    pub(crate) fn pieces_about(&self, origin: &Vector3<f64>) -> Vec<Piece> {
        let moved = |p: &Piece| {
            let (name, (shape, pose)) = (p.name.clone(), about(p, origin));
            Piece { name, shape, pose }
        };
        self.pieces.iter().map(moved).collect()
    }

    /// Returns a shape of a piece in place, moved to a frame about the stored origin.
    ///
    /// The shift is exact, as for the vertices.
    fn to_middle(&self, shape: &Shape) -> Shape {
        shape.with_origin(&(core_origin(shape) - self.frame.origin))
    }

    /// Returns the body with its frame moved to the stored origin.
    pub(crate) fn centred(&self) -> Self {
        let origin = &self.frame.origin;
        let to_middle = |p: &Piece| Piece {
            shape: self.to_middle(&p.shape),
            ..p.clone()
        };
        let pieces = if self.in_place {
            self.pieces.iter().map(to_middle).collect()
        } else {
            self.pieces_about(origin)
        };
        Self {
            pieces,
            stored: None,
            frame: StoredFrame {
                origin: Vector3::zeros(),
                ..self.frame
            },
            fingerprint: self.fingerprint.with(*b"centred ", 0.0),
            ..self.clone()
        }
    }

    /// Returns volume, centre of mass and inertia at unit density, in the body's frame.
    ///
    /// A region that several pieces share counts once for each of them. For a body without volume
    /// the centre of mass is the mean of the pieces' centres. The result is `None` if the mass of a
    /// piece has no closed form ([`Shape::mass`]).
    #[must_use]
    pub fn mass(&self) -> Option<Mass> {
        let own: Vec<Mass> = self.pieces.iter().map(|p| p.shape.mass()).collect::<Option<_>>()?;
        let placed = || self.pieces.iter().zip(&own);
        let volume: f64 = own.iter().map(|m| m.volume).sum();
        let weight = |m: &Mass| {
            if volume > 0.0 {
                m.volume / volume
            } else {
                1.0 / own.len() as f64
            }
        };
        let parts = placed().map(|(p, m)| (p.pose * m.centroid).coords * weight(m));
        let centroid = Point3::from(parts.sum::<Vector3<f64>>());
        let inertia = placed().map(|(p, m)| {
            let turn = p.pose.rotation.to_rotation_matrix().into_inner();
            let d = p.pose * m.centroid - centroid;
            let shift = Matrix3::identity() * d.norm_squared() - d * d.transpose();
            turn * m.inertia * turn.transpose() + shift * m.volume
        });
        Some(Mass {
            volume,
            centroid,
            inertia: inertia.sum(),
        })
    }

    /// Returns a polyhedron that contains all pieces.
    ///
    /// It is the hull if all pieces are polyhedra without a rounding radius. Otherwise it contains
    /// the boxes of the other pieces.
    pub(super) fn hull(&self) -> Result<ConvexPolyhedron, BuildError> {
        let mut points = Vec::new();
        for piece in &self.pieces {
            let mut own = Vec::new();
            extend_by_hull(&mut own, &piece.shape);
            points.extend(own.into_iter().map(|p| piece.pose * Point3::from(p)));
        }
        ConvexPolyhedron::from_points(&points)
    }

    fn unit(&self) -> f64 {
        self.frame.unit()
    }
}

/// Returns the surfaces of posed shapes as one mesh.
fn mesh_of<'a>(members: impl Iterator<Item = &'a Member>) -> Result<Mesh, MeshError> {
    let (mut points, mut triangles, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for (k, (shape, pose)) in members.enumerate() {
        let (Core::Polyhedron(body), 0.0) = (shape.core(), shape.rounding_radius()) else {
            return Err(MeshError::Curved { piece: k });
        };
        if body.face_count() == 0 {
            return Err(MeshError::Thin { piece: k });
        }
        let base = points.len() as u32;
        points.extend(body.vertex_points().map(|p| pose * p));
        for face in body.faces() {
            let rim: Vec<u32> = body.face_vertices(face).map(|v| base + v.index() as u32).collect();
            triangles.extend(rim.windows(2).skip(1).map(|w| [rim[0], w[0], w[1]]));
        }
        ends.push(triangles.len());
    }
    let lost = |triangle: u32| MeshError::Thin {
        piece: ends.partition_point(|end| *end <= triangle as usize),
    };
    match Mesh::new(&points, &triangles) {
        Ok(mesh) => match mesh.report().degenerate.first() {
            Some(&triangle) => Err(lost(triangle)),
            None => Ok(mesh),
        },
        Err(MeshError::Empty { .. }) => Err(lost(0)),
        Err(other) => Err(other),
    }
}

impl From<Shape> for Compound {
    /// Returns a compound of one piece in its frame.
    fn from(shape: Shape) -> Self {
        let mut points = Vec::new();
        extend_by_hull(&mut points, &shape);
        let corners = [(0..points.len() as u32).collect()];
        Self::assemble(alloc::vec![Piece::new(shape)], &points, &corners)
    }
}

impl Parted for Compound {
    fn by_kind(&self) -> PartsRef<'_> {
        PartsRef::Pieces(self)
    }

    fn side(&self) -> TreeSide<'_> {
        TreeSide {
            tree: &self.tree,
            frame: self.frame,
            radius: self.radius,
            // Queries of pieces count the rounding of composed poses.
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
        self.in_place
    }

    fn is_near(&self) -> bool {
        self.stored.is_none() && self.frame.is_at_origin()
    }

    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64 {
        let number = self.order[item as usize] as usize;
        let scale = power_of_two(-self.frame.exponent);
        if self.in_place {
            return self.pieces[number].shape.support_from(n, &self.frame.origin) * scale;
        }
        let (shape, pose) = match &self.stored {
            Some(members) => (&members[number].0, &members[number].1),
            None => (&self.pieces[number].shape, &self.pieces[number].pose),
        };
        let local = pose.rotation.inverse_transform_vector(n);
        let height = pose.translation.vector.dot(n) + shape.support_height(&local);
        height * scale + CERTIFICATE * UNIT * self.radius * (n.x.abs() + n.y.abs() + n.z.abs())
    }

    fn number(&self, item: u32) -> u32 {
        self.order[item as usize]
    }

    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        let piece = &self.pieces[self.order[item as usize] as usize];
        Some((piece.shape.clone(), piece.pose))
    }

    fn stored_part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        match &self.stored {
            Some(members) => Some(members[self.order[item as usize] as usize].clone()),
            None if self.frame.is_at_origin() => self.part(item),
            None => {
                let shape = &self.pieces[self.order[item as usize] as usize].shape;
                Some((self.to_middle(shape), Isometry3::identity()))
            }
        }
    }

    fn probe_count(&self) -> usize {
        self.probes.len()
    }

    fn probe(&self, k: usize) -> [Vector3<f64>; 4] {
        let [inner, other] = self.probes[k];
        [inner, other, inner, other]
    }

    #[cfg(feature = "exact")]
    fn exact_probe(&self, k: usize) -> ExactVector {
        let piece = &self.pieces[k];
        let vertex = match piece.shape.core() {
            Core::Polyhedron(body) => body.vertex_points().next(),
            _ => None,
        };
        let point = ExactVector::new(&vertex.unwrap_or_else(Point3::origin).coords);
        if piece.pose == Isometry3::identity() {
            point
        } else {
            point.placed(&piece.pose)
        }
    }
}

impl NearItems for Compound {
    fn outcome_of_item(&self, item: u32, point: &Point3<f64>) -> PointOutcome {
        let number = self.order[item as usize];
        let piece = &self.pieces[number as usize];
        outcome_of_shape(&piece.shape, &piece.pose, point, number)
    }
}

/// Returns an inner point of a posed shape and another of its points.
///
/// Both are in the caller's unit and the body's frame.
fn probe((shape, pose): &Member) -> [Vector3<f64>; 2] {
    inner_points(shape).each(|p| (pose * p).coords)
}

/// Returns points whose hulls contain posed shapes, in their order.
fn hulls_of(members: &[Member]) -> Vec<Vector3<f64>> {
    let mut points = Vec::new();
    for (shape, pose) in members {
        let first = points.len();
        extend_by_hull(&mut points, shape);
        let placed = points[first..].iter_mut();
        placed.for_each(|p| *p = (pose * Point3::from(*p)).coords);
    }
    points
}

/// Returns an inner point of a shape and another of its points, in the caller's unit.
///
/// The inner point of a polyhedron is the mean of its vertices, because its centroid costs more
/// than a query.
pub(super) fn inner_points(shape: &Shape) -> [Point3<f64>; 2] {
    let Core::Polyhedron(body) = shape.core() else {
        return [Point3::origin(); 2];
    };
    let share = 1.0 / body.vertex_count() as f64;
    // Scaled first, because a sum may leave the range.
    let middle: Vector3<f64> = body.vertex_points().map(|p| p.coords * share).sum();
    let vertex = body.vertex_points().next().unwrap_or_else(Point3::origin);
    [Point3::from(middle), vertex]
}

/// Adds points whose hull contains a shape.
///
/// These are the vertices of a polyhedron, and the corners of a box for any other shape.
fn extend_by_hull(points: &mut Vec<Vector3<f64>>, shape: &Shape) {
    match (shape.core(), shape.rounding_radius()) {
        (Core::Polyhedron(body), 0.0) => points.extend(body.vertex_points().map(|p| p.coords)),
        _ => {
            let (low, high) = shape.aabb_at(&Isometry3::identity(), &mut BoxHint::default());
            let end = |k: usize, i: usize| if k >> i & 1 == 1 { high[i] } else { low[i] };
            points.extend((0..8).map(|k| Vector3::new(end(k, 0), end(k, 1), end(k, 2))));
        }
    }
}

/// Returns the fingerprint of shapes and poses.
fn fingerprint(pieces: &[Piece]) -> Fingerprint {
    let mut all = Fingerprinter::new(*b"pieces  ");
    all.word(pieces.len() as u64);
    for Piece { shape, pose, .. } in pieces {
        all.fingerprint(shape.fingerprint());
        pose.rotation.coords.iter().for_each(|x| all.number(*x));
        all.vector(&pose.translation.vector);
    }
    all.end()
}

#[cfg(feature = "serde")]
impl serde::Serialize for Compound {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.pieces.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Compound {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::new(Vec::deserialize(deserializer)?).map_err(serde::de::Error::custom)
    }
}

/// Number of cached pair trackers per entry of the front; if there are more, they are dropped.
const TRACKERS: usize = 4;

/// State of a pair: the front of the last answer, and a tracker for each pair of members that came
/// near. All elements of a cloud with one shape share a tracker.
///
/// Each body is a [`Compound`](crate::Compound) or a [`Mesh`](crate::Mesh); for two meshes a
/// `MeshTracker` is faster. A convex body against a mesh is a compound of one piece: one leaf with
/// its own support points.
///
/// The tracker owns no body. Its state changes the time of a query, never the answer. Saving a
/// tracker (feature `serde`) saves only its counters.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CompoundTracker {
    state: TreeState,
    #[cfg_attr(feature = "serde", serde(skip))]
    near: BTreeMap<NodePair, NearParts>,
    /// Whether a pair of members counted as within the distance of the last
    /// [`within`](Self::within) because nothing proved otherwise.
    #[cfg_attr(feature = "serde", serde(skip))]
    is_tie: bool,
}

impl CompoundTracker {
    /// Returns a tracker without any state.
    #[must_use]
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far; `measured` counts queries of two members.
    #[must_use]
    pub(crate) fn work(&self) -> TreeWork {
        self.state.kept.work
    }

    pub(super) fn kept(&self) -> &FrontMemory {
        &self.state.kept
    }

    pub(super) fn count_windings(&mut self, taken: u64) {
        self.state.kept.work.windings.count(taken);
    }

    /// Returns the number of entries of the stored front.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.kept.front.len()
    }

    /// Returns the size of the front on the heap in bytes.
    pub(crate) fn memory_usage(&self) -> usize {
        self.state.kept.memory_usage()
    }

    /// Returns the closest points with bounds of the distance.
    ///
    /// `PairTracker::closest` documents the bounds. They are 1.5 times as wide if pieces have poses
    /// that differ from the body's. Curved pieces add the width of their bounds.
    pub(crate) fn closest<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> PairOutcome {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.closest(b, a, &a_from_b.swapped()).swapped(a_from_b);
        }
        self.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let answer = match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => {
                let judge = PartJudge::new(&posed, None, &mut self.near);
                self.state.closest(&posed, judge)
            }
            None => PosedTrees::far(a, b, a_from_b),
        };
        self.forget_some();
        answered(a, b, &answer)
    }

    /// Returns whether the bodies are at most `d` apart.
    ///
    /// The answer is as exact as `PairTracker::intersects`, with the limits of
    /// `MeshTracker::within`. It is false if `d` is negative or NaN.
    pub(crate) fn within<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.within(b, a, &a_from_b.swapped(), d);
        }
        self.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let Some(posed) = PosedTrees::new(a, b, a_from_b) else {
            return PosedTrees::far::<()>(a, b, a_from_b).lower <= d;
        };
        let mut judge = PartJudge::new(&posed, Some(d), &mut self.near);
        self.is_tie = false;
        judge.tie = Some(&mut self.is_tie);
        let is_within = self.state.within(&posed, judge, d / a.stored_unit());
        self.forget_some();
        is_within
    }

    /// Returns whether the bodies are proven to be at most `d` apart; false without a proof.
    pub(crate) fn meets<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose, d: f64) -> bool {
        self.within(a, b, a_from_b, d) && (!self.is_tie || self.closest(a, b, a_from_b).upper <= d)
    }

    /// Returns a lower bound of the distance from one pass over the front.
    ///
    /// The call does not search for the closest pair. It returns zero if nothing better is known.
    pub(crate) fn lower_bound<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> f64 {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.lower_bound(b, a, &a_from_b.swapped());
        }
        self.recognise(a, b);
        PosedTrees::new(a, b, a_from_b).map_or(0.0, |posed| self.state.lower_bound(&posed))
    }

    fn recognise<A: Parted, B: Parted>(&mut self, a: &A, b: &B) {
        // The members near each other are copies.
        if self.state.recognise(a, b) != Recognised::Same {
            self.near.clear();
        }
    }

    fn forget_some(&mut self) {
        if self.near.len() > TRACKERS * self.state.kept.front.len() + 64 {
            self.near.clear();
        }
    }
}

fn answered<A: Parted, B: Parted>(a: &A, b: &B, found: &TreeAnswer<FeaturePair>) -> PairOutcome {
    let ([i, j], features) = found.of.unwrap_or(([0, 0], FeaturePair::FIRST));
    found.on([
        WitnessLocation::new(a.number(i), features.a),
        WitnessLocation::new(b.number(j), features.b),
    ])
}

/// Two members that came near each other, and their tracker.
#[derive(Clone, Debug)]
struct NearParts {
    /// Whether the members are in the frames of their bodies, not about the stored origins.
    is_given: bool,
    parts: [(Shape, Isometry3<f64>); 2],
    tracker: ShapeTracker,
}

/// Measures pairs of members.
struct PartJudge<'a, A, B> {
    posed: &'a PosedTrees<'a, A, B>,
    placed: Placed<'a>,
    /// The distance to compare with, in the caller's unit, if the query is `within`.
    within: Option<f64>,
    near: &'a mut BTreeMap<NodePair, NearParts>,
    /// Set if members count as within although rounding hides it.
    tie: Option<&'a mut bool>,
}

impl<'a, A: Parted, B: Parted> PartJudge<'a, A, B> {
    pub(super) fn new(
        posed: &'a PosedTrees<'a, A, B>,
        within: Option<f64>,
        near: &'a mut BTreeMap<NodePair, NearParts>,
    ) -> Self {
        Self {
            posed,
            placed: Placed::of(posed.pose, posed.a, posed.b),
            within,
            near,
            tie: None,
        }
    }

    /// Returns the bounds of two members about which nothing is known.
    fn unknown(&self, frame: &TreeFrame, pair: NodePair) -> Measured<FeaturePair> {
        let (on_a, on_b) = (self.posed.a.side().tree.centre, self.posed.b.side().tree.centre);
        Measured {
            pair,
            distance: frame.size,
            lower: 0.0,
            upper: frame.size,
            normal: Vector3::x(),
            on_a,
            on_b,
            features: FeaturePair::FIRST,
            crosses: false,
        }
    }
}

impl<A: Parted, B: Parted> Judge for PartJudge<'_, A, B> {
    type Features = FeaturePair;

    const MAY_BE_CLOUD: bool = true;

    fn highest_in_a(&self, item: u32, n: &Vector3<f64>) -> f64 {
        self.posed.a.highest(item, n)
    }

    fn lowest_in_b(&self, item: u32, n: &Vector3<f64>) -> f64 {
        -self.posed.b.highest(item, &-n)
    }

    fn heights_in_a(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) {
        self.posed.a.heights(items, n, to);
    }

    fn heights_in_b(&self, items: Range<u32>, n: &Vector3<f64>, to: &mut [f64]) {
        let count = items.len();
        self.posed.b.heights(items, &-n, to);
        to.iter_mut().take(count).for_each(|height| *height = -*height);
    }

    fn shares_inside(&self, touching: &Touching, found: &Measured<FeaturePair>) -> (bool, u64) {
        self.posed.shares_inside(touching, found, false)
    }

    fn measure(&mut self, frame: &TreeFrame, pair: NodePair, _: f64) -> Measured<FeaturePair> {
        let (a, b) = (self.posed.a, self.posed.b);
        let is_given = self.placed.is_given();
        let mut shared = [a.shared_pose(pair[0]), b.shared_pose(pair[1])];
        if !is_given {
            shared = [
                shared[0].map(|at| a.side().frame.about(&at)),
                shared[1].map(|at| b.side().frame.about(&at)),
            ];
        }
        let key = [0, 1].each(|k: usize| if shared[k].is_some() { 0 } else { pair[k] });
        if self.near.get(&key).is_none_or(|near| near.is_given != is_given) {
            let parts = if is_given {
                (a.part(pair[0]), b.part(pair[1]))
            } else {
                (a.stored_part(pair[0]), b.stored_part(pair[1]))
            };
            let (Some(p), Some(q)) = parts else {
                return self.unknown(frame, pair);
            };
            let near = NearParts {
                is_given,
                parts: [p, q],
                tracker: ShapeTracker::new(),
            };
            self.near.insert(key, near);
        }
        let Some(NearParts { parts, tracker, .. }) = self.near.get_mut(&key) else {
            return self.unknown(frame, pair);
        };
        let [(p, at_p), (q, at_q)] = parts;
        let (at_p, at_q) = (&shared[0].unwrap_or(*at_p), &shared[1].unwrap_or(*at_q));
        let (pose, exact) = self.placed.between(at_p, at_q);
        let mut o: Outcome = tracker.closest_or_class(p, q, &pose);
        let unit = 1.0 / a.stored_unit();
        // The rounding error of composed poses: two products of rotations and two sums.
        let error = if exact { 0.0 } else { 2.0 * frame.error };
        if !exact && o.state == ContactState::Overlapping && !(o.upper * unit < -error) {
            // Only a depth beyond the rounding of composed poses proves an overlap.
            o = tracker.closest(p, q, &pose);
        }
        let meets = o.state == ContactState::Overlapping;
        let stored = |side: TreeSide, point: Point3<f64>| {
            if is_given {
                side.frame.stored(&point)
            } else {
                point.coords / side.frame.unit()
            }
        };
        let distance = if meets { 0.0 } else { (o.distance * unit).at_least(0.0) };
        let mut m = Measured {
            pair,
            distance,
            lower: if meets {
                0.0
            } else {
                (o.lower * unit - error).at_least(0.0)
            },
            // An overlap that is not deeper than rounding may be a gap.
            upper: if meets {
                (o.upper * unit + error).at_least(0.0)
            } else {
                (o.upper * unit).larger(distance) + error
            },
            normal: at_p.rotation * *o.normal,
            on_a: stored(a.side(), *at_p * o.point_on_a),
            on_b: stored(b.side(), *at_q * o.point_on_b),
            features: o.features,
            crosses: meets && (exact || o.upper * unit < -error),
        };
        let Some(d) = self.within else { return m };
        let stored = d * unit;
        if !(m.lower > stored || m.upper <= stored) {
            if !exact || tracker.within(p, q, &pose, d) {
                let are_exact = exact && [p, q].iter().all(|shape| matches!(shape.core(), Core::Polyhedron(_)));
                if let (Some(tie), false) = (&mut self.tie, are_exact) {
                    **tie = true;
                }
                (m.lower, m.distance, m.upper) = (
                    m.lower.smaller(stored),
                    m.distance.smaller(stored),
                    m.upper.smaller(stored),
                );
            } else {
                m.lower = stored.next_up();
                m.distance = m.distance.larger(m.lower);
                m.upper = m.upper.larger(m.lower);
            }
        }
        m
    }
}
