//! Bodies of placed convex pieces, and the queries of two of them.

mod pair;
mod tracker;

use alloc::string::String;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

pub(crate) use tracker::CompositeTracker;

use crate::base::notice::Watch;
use crate::base::num::extremes::Extremes;
use crate::base::num::fingerprint::{Fingerprint, Fingerprinter};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{CERTIFICATE, EXPONENT_FREE, PLACE_MAX, PLACED, UNIT};
use crate::body::polyhedron::{BoxHint, BuildError, ConvexPolyhedron, bounding_box, exponent_of, power_of_two};
use crate::body::shape::{Core, Mass, Shape};
use crate::composite::meet::frame::TreeSide;
use crate::composite::mesh::{Mesh, MeshError, MeshKind};
use crate::composite::parts::{Parted, PartsRef};
use crate::composite::tree::Tree;
#[cfg(feature = "exact")]
use crate::convex::exact::place::ExactVector;

/// A convex piece of a [`Composite`]: a shape of any kind, its pose in the body's frame, and a
/// name.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piece {
    /// The caller's name; names may repeat.
    pub name: String,
    /// The shape in its own frame.
    pub shape: Shape,
    /// From the shape's frame to the body's. The rotation is normalised when the body is built.
    pub pose: Isometry3<f64>,
}

impl Piece {
    /// Returns a piece whose frame is the body's, without a name.
    #[must_use]
    pub fn new(shape: impl Into<Shape>) -> Self {
        Self {
            name: String::new(),
            shape: shape.into(),
            pose: Isometry3::identity(),
        }
    }

    /// Returns the distance of the farthest point of the shape from the origin of its frame, plus
    /// the length of the translation.
    fn reach(&self) -> f64 {
        let (centre, radius) = self.shape.bounding_ball();
        sqrt(centre.coords.norm_squared()) + radius + sqrt(self.pose.translation.vector.norm_squared())
    }
}

/// Reason why pieces make no body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompositeError {
    /// No piece, or more than 2^27.
    #[error("{count} pieces make no body")]
    Count {
        /// Pieces given.
        count: usize,
    },
    /// A pose that is not finite, or a piece farther than 1e116 from the body's origin.
    #[error("piece {piece} stands at no finite place")]
    Pose {
        /// The piece.
        piece: usize,
    },
}

/// A body made of placed convex pieces of every kind of [`Shape`], which may overlap: the links of
/// URDF and MJCF files, or a decomposition. A body of one piece is a convex body against meshes and
/// composites.
///
/// The body is the union of the pieces, each a solid. Immutable, `Send + Sync`.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Composite, PairTracker, Piece, RelativePose};
///
/// let beam = solids::cuboid(Vector3::new(1.0, 0.1, 0.1))?;
/// let mut upright = Piece::new(beam.clone());
/// let quarter = Vector3::z() * std::f64::consts::FRAC_PI_2;
/// upright.pose = Isometry3::new(Vector3::new(1.0, 0.9, 0.0), quarter);
/// let bracket = Composite::new(vec![Piece::new(beam), upright])?;
/// let mut pair = PairTracker::new();
/// let pose = Isometry3::translation(0.0, 0.0, 0.5);
/// let a_from_b = RelativePose::from_isometry(&pose)?;
/// let found = pair.closest(&bracket, &bracket, &a_from_b);
/// assert!((found.distance - 0.3).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "compound")]
#[derive(Clone, Debug)]
pub struct Composite {
    /// In the caller's order.
    pieces: Vec<Piece>,
    /// The piece of each leaf of the tree.
    order: Vec<u32>,
    /// Whether all frames are the body's, so that no pose is composed.
    in_place: bool,
    tree: Tree,
    exponent: i32,
    radius: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// An inner point of each piece and another of its points, in stored units.
    probes: Vec<[Vector3<f64>; 2]>,
    fingerprint: Fingerprint,
}

impl Composite {
    /// Builds a body of pieces.
    ///
    /// # Errors
    ///
    /// No piece, or a pose that is not finite.
    pub fn new(mut pieces: Vec<Piece>) -> Result<Self, CompositeError> {
        if pieces.is_empty() || pieces.len() > 1 << 27 {
            return Err(CompositeError::Count { count: pieces.len() });
        }
        let mut points = Vec::new();
        let mut corners: Vec<Vec<u32>> = Vec::new();
        for (k, piece) in pieces.iter_mut().enumerate() {
            piece.pose.rotation = UnitQuaternion::new_normalize(piece.pose.rotation.into_inner());
            let first = points.len();
            extend_by_hull(&mut points, &piece.shape);
            let placed = &mut points[first..];
            placed
                .iter_mut()
                .for_each(|p| *p = (piece.pose * Point3::from(*p)).coords);
            // Written so that NaN is refused.
            if !placed.iter().all(|p: &Vector3<f64>| p.amax() < PLACE_MAX) {
                return Err(CompositeError::Pose { piece: k });
            }
            corners.push((first as u32..points.len() as u32).collect());
        }
        Ok(Self::assemble(pieces, &points, &corners))
    }

    fn assemble(pieces: Vec<Piece>, given: &[Vector3<f64>], corners: &[Vec<u32>]) -> Self {
        let (low, high) = bounding_box(given);
        // A point, or a body far smaller than its distance from the origin, is as large as the
        // rounding of its place.
        let place = low.amax().larger(high.amax()) * UNIT;
        let size = sqrt(((high - low) * 0.5).norm_squared()).larger(place);
        // A point at the body's own origin has no size: any unit serves.
        let size = if size > 0.0 { size } else { 1.0 };
        let window = 2 * EXPONENT_FREE;
        let exponent = (exponent_of(size) + EXPONENT_FREE).div_euclid(window) * window;
        let scale = power_of_two(-exponent);
        let stored: Vec<_> = given.iter().map(|p| p * scale).collect();
        let (mut tree, order) = Tree::split(&stored, corners, 1, &mut Watch::none());
        let mut points = Vec::with_capacity(stored.len());
        let items: Vec<Vec<u32>> = order
            .iter()
            .map(|&k| {
                let first = points.len() as u32;
                points.extend(corners[k as usize].iter().map(|&v| stored[v as usize]));
                (first..points.len() as u32).collect()
            })
            .collect();
        let farthest = pieces.iter().map(Piece::reach).fold(0.0, f64::larger) * scale;
        tree.fit(&points, &items, CERTIFICATE * UNIT * farthest, &mut Watch::none());
        let (low, high) = bounding_box(&points);
        Self {
            fingerprint: fingerprint(&pieces),
            in_place: pieces.iter().all(|p| p.pose == Isometry3::identity()),
            radius: farthest * (1.0 + 64.0 * UNIT),
            probes: pieces.iter().map(|p| probe(p).map(|x| x * scale)).collect(),
            pieces,
            order,
            tree,
            exponent,
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

    /// Returns the corners of a bounding box in the body's own frame, right up to rounding.
    #[must_use]
    pub fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let unit = self.unit();
        (Point3::from(self.low * unit), Point3::from(self.high * unit))
    }

    /// Returns the surfaces of all pieces as one solid mesh, whose parts may overlap. Vertices of
    /// placed pieces are rounded.
    ///
    /// # Errors
    ///
    /// A piece that is rounded or curved ([`MeshError::Curved`]); a piece that would be missing
    /// from the mesh ([`MeshError::Thin`]); an extent outside 1e-100..1e100.
    pub fn to_mesh(&self) -> Result<Mesh, MeshError> {
        let (mut points, mut triangles, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        for (k, piece) in self.pieces.iter().enumerate() {
            let (Core::Polyhedron(shape), 0.0) = (piece.shape.core(), piece.shape.round()) else {
                return Err(MeshError::Curved { piece: k });
            };
            if shape.face_count() == 0 {
                return Err(MeshError::Thin { piece: k });
            }
            let base = points.len() as u32;
            points.extend(shape.vertex_points().map(|p| piece.pose * p));
            for face in shape.faces() {
                let rim: Vec<u32> = shape.face_vertices(face).map(|v| base + v.index() as u32).collect();
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

    /// Returns the mesh that is the same body as the pieces, but for the rounding of placed ones,
    /// by which its points are known to be off their places. `None` if there is no such mesh: a
    /// piece without volume, or one whose surface the mesh would change.
    pub(crate) fn stand_in(&self) -> Option<Mesh> {
        let has_volume = |p: &Piece| matches!(p.shape.core(), Core::Polyhedron(body) if body.face_count() > 2);
        if !self.pieces.iter().all(has_volume) {
            return None;
        }
        let mesh = self.to_mesh().ok()?;
        // Welded points and repeated triangles leave the set of points, and what it encloses.
        let is_same = mesh.kind() == MeshKind::Solid && mesh.report().flushed_coordinates == 0;
        is_same.then(|| mesh.with_points_off(self.off()))
    }

    /// Returns how far a vertex of a placed piece may be off its place, in the caller's unit.
    fn off(&self) -> f64 {
        let placed = self.pieces.iter().filter(|p| p.pose != Isometry3::identity());
        PLACED * placed.map(Piece::reach).fold(0.0, f64::larger)
    }

    /// Returns volume, centre of mass and inertia at unit density, in the body's frame: what pieces
    /// share is counted as often, and bodies without volume have the mean of the pieces' centres.
    /// `None` if the mass of a piece has no closed form ([`Shape::mass`]).
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

    /// Returns a polyhedron about all pieces: the hull, if all are polyhedra without a radius; else
    /// with the boxes of the others.
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
        power_of_two(self.exponent)
    }
}

impl From<Shape> for Composite {
    /// Returns a body of one piece in its own frame.
    fn from(shape: Shape) -> Self {
        let mut points = Vec::new();
        extend_by_hull(&mut points, &shape);
        let corners = [(0..points.len() as u32).collect()];
        Self::assemble(alloc::vec![Piece::new(shape)], &points, &corners)
    }
}

impl Parted for Composite {
    fn by_kind(&self) -> PartsRef<'_> {
        PartsRef::Pieces(self)
    }

    fn side(&self) -> TreeSide<'_> {
        TreeSide {
            tree: &self.tree,
            exponent: self.exponent,
            radius: self.radius,
            // Judges of pieces count the rounding of composed poses.
            off: 0.0,
        }
    }

    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn came_from(&self, _: Fingerprint) -> bool {
        false
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

    fn highest(&self, item: u32, n: &Vector3<f64>) -> f64 {
        let piece = &self.pieces[self.order[item as usize] as usize];
        let scale = power_of_two(-self.exponent);
        if self.in_place {
            return piece.shape.support_height(n) * scale;
        }
        let pose = &piece.pose;
        let local = pose.rotation.inverse_transform_vector(n);
        let height = pose.translation.vector.dot(n) + piece.shape.support_height(&local);
        height * scale + CERTIFICATE * UNIT * self.radius * (n.x.abs() + n.y.abs() + n.z.abs())
    }

    fn number(&self, item: u32) -> u32 {
        self.order[item as usize]
    }

    fn part(&self, item: u32) -> Option<(Shape, Isometry3<f64>)> {
        let piece = &self.pieces[self.order[item as usize] as usize];
        Some((piece.shape.clone(), piece.pose))
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn may_hold(&self) -> bool {
        false
    }

    fn probe_count(&self) -> usize {
        self.probes.len()
    }

    fn probe(&self, k: usize) -> [Vector3<f64>; 4] {
        let [inner, other] = self.probes[k];
        [inner, other, inner, other]
    }

    fn further_probe(&self, _: usize) -> Option<Vector3<f64>> {
        None
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

    fn holds(&self, _: &Vector3<f64>, _: f64) -> Option<bool> {
        Some(false)
    }
}

/// Returns an inner point of a piece and another of its points, in the caller's unit and the body's
/// frame.
fn probe(piece: &Piece) -> [Vector3<f64>; 2] {
    let two = match piece.shape.core() {
        Core::Polyhedron(body) => [Some(body.centroid()), body.vertex_points().next()],
        _ => [None; 2],
    };
    two.map(|p| (piece.pose * p.unwrap_or_else(Point3::origin)).coords)
}

/// Adds points in whose hull a shape lies: the vertices of a polyhedron, the corners of a box of
/// any other shape.
fn extend_by_hull(points: &mut Vec<Vector3<f64>>, shape: &Shape) {
    match (shape.core(), shape.round()) {
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
impl serde::Serialize for Composite {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.pieces.serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Composite {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::new(Vec::deserialize(deserializer)?).map_err(serde::de::Error::custom)
    }
}
