//! Bodies of placed convex pieces, and the queries of two of them.

mod pair;
mod tracker;

use alloc::string::String;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

pub use tracker::{CompositeOutcome, CompositeTracker};

use super::mesh::{Mesh, MeshError};
use super::tree::Tree;
use crate::num::scalar::sqrt;
use crate::polyhedron::{ConvexPolyhedron, bounding_box, exponent_of, power_of_two};
use crate::tolerance::{CERTIFICATE, EXPONENT_FREE, PLACE_MAX, UNIT};

/// A convex piece of a [`Composite`]: a shape, its pose in the body's frame, and a name.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Piece {
    /// The caller's name; names may repeat.
    pub name: String,
    /// The shape in its own frame.
    pub shape: ConvexPolyhedron,
    /// From the shape's frame to the body's. The rotation is normalised when the body is built.
    pub pose: Isometry3<f64>,
}

impl Piece {
    /// Returns a piece whose frame is the body's, without a name.
    #[must_use]
    pub fn new(shape: ConvexPolyhedron) -> Self {
        Self {
            name: String::new(),
            shape,
            pose: Isometry3::identity(),
        }
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

/// A body made of placed convex pieces, which may overlap: the links of URDF and MJCF files, or a
/// decomposition.
///
/// The body is the union of the pieces, each a solid. Immutable, `Send + Sync`.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Composite, CompositeTracker, Piece, RelativePose};
///
/// let beam = solids::cuboid(Vector3::new(1.0, 0.1, 0.1))?;
/// let mut upright = Piece::new(beam.clone());
/// let quarter = Vector3::z() * std::f64::consts::FRAC_PI_2;
/// upright.pose = Isometry3::new(Vector3::new(1.0, 0.9, 0.0), quarter);
/// let bracket = Composite::new(vec![Piece::new(beam), upright])?;
/// let mut pair = CompositeTracker::new();
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
    fingerprint: u64,
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
            let first = points.len() as u32;
            points.extend(piece.shape.vertex_points().map(|p| (piece.pose * p).coords));
            let placed = &points[first as usize..];
            // Written so that NaN is refused.
            if !placed.iter().all(|p: &Vector3<f64>| p.amax() < PLACE_MAX) {
                return Err(CompositeError::Pose { piece: k });
            }
            corners.push((first..points.len() as u32).collect());
        }
        Ok(Self::assemble(pieces, &points, &corners))
    }

    fn assemble(pieces: Vec<Piece>, given: &[Vector3<f64>], corners: &[Vec<u32>]) -> Self {
        let (low, high) = bounding_box(given);
        let size = sqrt(((high - low) * 0.5).norm_squared()).max(f64::MIN_POSITIVE);
        let window = 2 * EXPONENT_FREE;
        let exponent = (exponent_of(size) + EXPONENT_FREE).div_euclid(window) * window;
        let scale = power_of_two(-exponent);
        let stored: Vec<_> = given.iter().map(|p| p * scale).collect();
        let (mut tree, order) = Tree::split(&stored, corners, 1);
        let mut points = Vec::with_capacity(stored.len());
        let items: Vec<Vec<u32>> = order
            .iter()
            .map(|&k| {
                let first = points.len() as u32;
                points.extend(corners[k as usize].iter().map(|&v| stored[v as usize]));
                (first..points.len() as u32).collect()
            })
            .collect();
        let reach = |p: &Piece| {
            let (centre, radius) = p.shape.bounding_ball();
            sqrt(centre.coords.norm_squared()) + radius + sqrt(p.pose.translation.vector.norm_squared())
        };
        let farthest = pieces.iter().map(reach).fold(0.0, f64::max) * scale;
        tree.fit(&points, &items, CERTIFICATE * UNIT * farthest);
        let (low, high) = bounding_box(&points);
        let print = |h: u64, p: &Piece| {
            let pose = p.pose.rotation.coords.iter().chain(p.pose.translation.vector.iter());
            pose.fold(stir(h ^ p.shape.fingerprint), |h, x| stir(h ^ x.to_bits()))
        };
        Self {
            fingerprint: pieces.iter().fold(stir(pieces.len() as u64), print),
            in_place: pieces.iter().all(|p| p.pose == Isometry3::identity()),
            radius: farthest * (1.0 + 64.0 * UNIT),
            pieces,
            order,
            tree,
            exponent,
            low,
            high,
        }
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

    /// Returns the surfaces of all pieces as one solid mesh, whose parts may overlap: what queries
    /// against meshes take.
    ///
    /// # Errors
    ///
    /// Pieces without faces only, as segments and points.
    pub fn to_mesh(&self) -> Result<Mesh, MeshError> {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for piece in &self.pieces {
            let base = points.len() as u32;
            points.extend(piece.shape.vertex_points().map(|p| piece.pose * p));
            for face in piece.shape.faces() {
                let rim: Vec<u32> = piece
                    .shape
                    .face_vertices(face)
                    .map(|v| base + v.index() as u32)
                    .collect();
                triangles.extend(rim.windows(2).skip(1).map(|w| [rim[0], w[0], w[1]]));
            }
        }
        Mesh::new(&points, &triangles)
    }

    /// Returns the sum of the pieces' volumes: what pieces share is counted as often.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.pieces.iter().map(|p| p.shape.volume()).sum()
    }

    /// Returns the centre of mass of the pieces at unit density, the mean of their centroids if
    /// none has volume. What pieces share is counted as often.
    #[must_use]
    pub fn centroid(&self) -> Point3<f64> {
        let volume = self.volume();
        let weight = |p: &Piece| {
            if volume > 0.0 {
                p.shape.volume() / volume
            } else {
                1.0 / self.pieces.len() as f64
            }
        };
        let parts = self
            .pieces
            .iter()
            .map(|p| (p.pose * p.shape.centroid()).coords * weight(p));
        Point3::from(parts.sum::<Vector3<f64>>())
    }

    /// Returns the inertia tensor about the centroid at unit density, in the body's axes. What
    /// pieces share is counted as often.
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        let centre = self.centroid();
        let part = |p: &Piece| {
            let turn = p.pose.rotation.to_rotation_matrix().into_inner();
            let d = p.pose * p.shape.centroid() - centre;
            let shift = Matrix3::identity() * d.norm_squared() - d * d.transpose();
            turn * p.shape.inertia() * turn.transpose() + shift * p.shape.volume()
        };
        self.pieces.iter().map(part).sum()
    }

    fn unit(&self) -> f64 {
        power_of_two(self.exponent)
    }
}

/// One round of multiply and shift, a bijection.
fn stir(x: u64) -> u64 {
    super::mesh::stir(x)
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
