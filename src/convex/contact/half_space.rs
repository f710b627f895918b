//! Contacts of a polyhedron with a half-space, for example an infinite floor.
//!
//! ```text
//!        \   body   /
//!         \        .'      n      outward normal of the half-space
//!          v-----.'  ^     v      lowest vertex: its height is the signed distance
//!     ___________ n__|__   v - .  face that carries the contact, nearly parallel to the plane
//!      half-space
//! ```
//!
//! The signed distance is the height of the lowest vertex, for separated and for overlapping
//! bodies: one proven support vertex, and no walk. Of the faces at the lowest vertex, the one most
//! nearly parallel to the plane carries the contact; its vertices are the contacts, as for two
//! polyhedra ([`mod@crate::convex::contact`]).

use nalgebra::{Isometry3, Point3, Unit, Vector3};
use thiserror::Error;

use super::clip::{Candidates, Location};
use super::reduce::reduce;
use super::{MOST_POINTS, ManifoldOptions, tangents_of};
use crate::base::num::each::Each;
use crate::base::num::extremes::{ByValue, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::sqrt;
use crate::base::pose::{RelativePose, rotation_matrix};
#[cfg(feature = "serde")]
use crate::base::tolerance::UNIT_LENGTH;
use crate::base::tolerance::{ACROSS, BOX_TURNED, CERTIFICATE, PLACE_MAX, STEEP, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, VertexId};
use crate::pair::outcome::{ContactState, Distance};

/// The largest number of vertices of a face on a half-space that are contact candidates. If there
/// are more, every second, third and so on is used.
const SAMPLE: usize = 48;

/// A half-space: the points `x` with `normal . x <= offset`, solid below its plane.
///
/// It is an infinite floor or wall in its own frame, and a [`Geometry`](crate::Geometry) like any
/// other: [`PairTracker`](crate::PairTracker) and scenes query it against every kind of body. The
/// signed distance is the height of the lowest point of the body over the plane, so the depth of
/// every kind of body is known, meshes and surfaces included. The methods of this type measure a
/// polyhedron without a tracker; their results depend only on body, relative pose and options.
///
/// - Two half-spaces overlap without end, with no lower bound, unless their normals are opposite to
///   1e-14. Then the distance is that of the two planes.
/// - A half-space has no finite size: the pair size L is the radius of the other body about its
///   origin, plus the distance of the origins, plus the distance of the plane from its origin.
/// - Distances within rounding, `1e-13 L`, of a threshold count as within.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{HalfSpace, ManifoldOptions, RelativePose};
///
/// let floor = HalfSpace::new(Vector3::z(), 0.0)?;
/// let part = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
/// let resting = Isometry3::translation(3.0, 0.0, 0.49);
/// let pose = RelativePose::from_isometry(&resting)?;
/// let options = ManifoldOptions::default().prediction(0.02);
/// let contacts = floor.contacts(&part, &pose, &options);
/// assert_eq!(contacts.points().len(), 4);
/// assert!((contacts.distance().value + 0.01).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{Geometry, HalfSpace, Mesh, PairTracker, RelativePose};
///
/// let floor = Geometry::from(HalfSpace::new(Vector3::z(), 0.0)?);
/// let die = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
/// let part = Mesh::from_convex(&die)?;
/// let sunk = Isometry3::translation(3.0, 0.0, 0.4);
/// let pose = RelativePose::from_isometry(&sunk)?;
/// let found = PairTracker::new().closest(&floor, &part, &pose);
/// assert!((found.distance + 0.1).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "plane")]
#[doc(alias = "floor")]
#[doc(alias = "ground")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredHalfSpace", into = "StoredHalfSpace"))]
pub struct HalfSpace {
    normal: Unit<Vector3<f64>>,
    offset: f64,
}

/// Error of [`HalfSpace::new`]: the normal has no direction or the plane is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HalfSpaceError {
    /// The normal is zero or not finite.
    #[error("normal {0:?} has no direction")]
    Normal([f64; 3]),
    /// The offset of the plane is NaN or exceeds `1e116`.
    #[error("plane offset {0} is NaN or exceeds 1e116")]
    Offset(f64),
}

/// The serialised form of a half-space: the unit normal and the offset, bit for bit.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "HalfSpace")]
struct StoredHalfSpace {
    normal: [f64; 3],
    offset: f64,
}

#[cfg(feature = "serde")]
impl From<HalfSpace> for StoredHalfSpace {
    fn from(space: HalfSpace) -> Self {
        let (normal, offset) = (space.normal.into_inner().into(), space.offset);
        Self { normal, offset }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredHalfSpace> for HalfSpace {
    type Error = HalfSpaceError;

    /// A normal of unit length is kept bit for bit.
    fn try_from(stored: StoredHalfSpace) -> Result<Self, HalfSpaceError> {
        let normal = Vector3::from(stored.normal);
        let space = Self::new(normal, stored.offset)?;
        if (normal.norm_squared() - 1.0).abs() <= UNIT_LENGTH {
            let (normal, offset) = (Unit::new_unchecked(normal), stored.offset);
            return Ok(Self { normal, offset });
        }
        Ok(space)
    }
}

/// A contact of a vertex of a body with the plane of a half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HalfSpaceContact {
    /// The vertex of the body, which identifies the contact from frame to frame.
    pub vertex: VertexId,
    /// The point of the plane below the vertex, in the frame of the half-space.
    pub point_on_plane: Point3<f64>,
    /// The vertex, in the frame of the body.
    pub point_on_body: Point3<f64>,
    /// Height of the vertex above the plane, negative below it.
    pub separation: f64,
}

/// The contacts of a body with a half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpaceContacts {
    distance: Distance,
    lowest: HalfSpaceContact,
    points: [HalfSpaceContact; MOST_POINTS],
    count: usize,
}

impl HalfSpaceContacts {
    /// Returns the contacts within the prediction, the lowest vertex first. Empty if the body is
    /// farther away.
    #[must_use]
    pub fn points(&self) -> &[HalfSpaceContact] {
        &self.points[..self.count]
    }

    /// Returns the contact of the lowest vertex, at any distance from the plane.
    #[must_use]
    pub fn lowest(&self) -> &HalfSpaceContact {
        &self.lowest
    }

    /// Returns the signed distance with its bounds. For an overlap it is minus the depth along the
    /// normal.
    #[must_use]
    pub fn distance(&self) -> Distance {
        self.distance
    }
}

impl HalfSpace {
    /// Returns the half-space of the points `x` with `normal . x <= offset`. The normal may have
    /// any length.
    ///
    /// # Errors
    /// Returns an error if the normal has no direction, or the plane is farther than `1e116` from
    /// the origin.
    pub fn new(normal: Vector3<f64>, offset: f64) -> Result<Self, HalfSpaceError> {
        let largest = normal.amax();
        if !(largest > 0.0 && normal.iter().all(|x| x.is_finite())) {
            return Err(HalfSpaceError::Normal(normal.into()));
        }
        let scaled = normal / largest;
        let length = sqrt(scaled.norm_squared());
        let offset = offset / largest / length;
        // NaN is an error.
        if !(offset.abs() <= PLACE_MAX) {
            return Err(HalfSpaceError::Offset(offset));
        }
        let normal = Unit::new_unchecked(scaled / length);
        Ok(Self { normal, offset })
    }

    /// Returns the half-space with a unit normal.
    pub(crate) fn at(normal: &Vector3<f64>, offset: f64) -> Self {
        Self {
            normal: Unit::new_unchecked(*normal),
            offset,
        }
    }

    /// Returns the outward unit normal.
    #[must_use]
    pub fn normal(&self) -> Unit<Vector3<f64>> {
        self.normal
    }

    /// Returns the signed distance of the plane from the origin, along the normal.
    #[must_use]
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Returns the point of the plane that is closest to the origin.
    #[must_use]
    pub fn foot(&self) -> Point3<f64> {
        Point3::from(self.normal.into_inner() * self.offset)
    }

    /// Returns the hash by which cached state recognises the half-space.
    pub(crate) fn fingerprint(&self) -> Fingerprint {
        let n = &self.normal;
        Fingerprint::of(*b"halfspac", &[n.x, n.y, n.z, self.offset])
    }

    /// Returns the axis-aligned box at a pose, rounded outward.
    ///
    /// It is infinite on all sides, except the outer side if the normal is along an axis there.
    pub(crate) fn aabb_at(&self, pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
        let q = pose.rotation.coords;
        let matrix = rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared());
        let n: Vector3<f64> = matrix * self.normal.into_inner();
        let mut low = Point3::from(Vector3::repeat(f64::NEG_INFINITY));
        let mut high = Point3::from(Vector3::repeat(f64::INFINITY));
        let axis = n.iamax();
        if (0..3).all(|k| k == axis || n[k] == 0.0) {
            let t = pose.translation.vector[axis];
            let (side, margin) = (n[axis], BOX_TURNED * (t.abs() + self.offset.abs()));
            if side > 0.0 {
                high[axis] = t + self.offset + margin;
            } else {
                low[axis] = t - self.offset - margin;
            }
        }
        (low, high)
    }

    /// Returns the signed distance of a body, with bounds that include all rounding.
    ///
    /// `a_from_b` is the pose of the body in the frame of the half-space. If zero lies between the
    /// bounds, the state is touching.
    #[must_use]
    pub fn distance(&self, body: &ConvexPolyhedron, a_from_b: &RelativePose) -> Distance {
        PlacedPlane::new(self, body, a_from_b).distance()
    }

    /// Returns the contacts of a body within `options.prediction`.
    ///
    /// They are the vertices of the face at the lowest vertex that is most nearly parallel to the
    /// plane, if the sine of its angle to the plane is at most `options.max_face_sine`. Otherwise
    /// they are the ends of an edge, or only the lowest vertex.
    #[must_use]
    pub fn contacts(
        &self,
        body: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> HalfSpaceContacts {
        let placed = PlacedPlane::new(self, body, a_from_b);
        let (distance, lowest) = (placed.distance(), placed.contact(placed.lowest));
        let mut contacts = HalfSpaceContacts {
            distance,
            lowest,
            points: [lowest; MOST_POINTS],
            count: 0,
        };
        if lowest.separation <= options.prediction {
            placed.add_points(options, &mut contacts);
        }
        contacts
    }
}

/// A body over a half-space.
struct PlacedPlane<'a> {
    space: &'a HalfSpace,
    body: &'a ConvexPolyhedron,
    pose: &'a RelativePose,
    /// Direction in the body's frame along which the body approaches the half-space.
    down: Vector3<f64>,
    lowest: VertexId,
}

impl<'a> PlacedPlane<'a> {
    fn new(space: &'a HalfSpace, body: &'a ConvexPolyhedron, pose: &'a RelativePose) -> Self {
        let down = -pose.rotation().tr_mul(&space.normal);
        let lowest = body.support_certified(&down, body.lookup.cell(&down)).vertex;
        Self {
            space,
            body,
            pose,
            down,
            lowest,
        }
    }

    /// Returns a vertex in the frame of the half-space, and its height above the plane.
    fn place(&self, vertex: VertexId) -> (Vector3<f64>, f64) {
        let point = self.body.to_user(&self.body.points[vertex.index()]);
        let at = self.pose.rotation() * point.coords + self.pose.translation();
        (at, self.space.normal.dot(&at) - self.space.offset)
    }

    fn contact(&self, vertex: VertexId) -> HalfSpaceContact {
        let (at, separation) = self.place(vertex);
        HalfSpaceContact {
            vertex,
            point_on_plane: (at - self.space.normal.into_inner() * separation).into(),
            point_on_body: self.body.to_user(&self.body.points[vertex.index()]),
            separation,
        }
    }

    /// Returns the sum of the lengths whose rounding enters a height.
    fn size(&self) -> f64 {
        let (body, far) = (self.body, |v: &Vector3<f64>| v.abs().sum());
        body.radius * body.unit() + far(&body.origin) + far(&self.pose.translation()) + self.space.offset.abs()
    }

    fn distance(&self) -> Distance {
        let value = self.place(self.lowest).1;
        let term = CERTIFICATE * UNIT * self.size();
        let (lower, upper) = (value - term, value + term);
        let state = if lower > 0.0 {
            ContactState::Separated
        } else if upper < 0.0 {
            ContactState::Overlapping
        } else {
            ContactState::Touching
        };
        Distance {
            state,
            value,
            lower,
            upper,
        }
    }

    /// Adds the lowest vertex, and the vertices of the feature that carries the contact.
    fn add_points(&self, options: &ManifoldOptions, contacts: &mut HalfSpaceContacts) {
        let axes = tangents_of(&self.space.normal);
        let mut candidates = Candidates::new(0.0, options.prediction);
        let mut add = |vertex: VertexId| {
            let (at, height) = self.place(vertex);
            let at = axes.each(|axis| axis.dot(&at));
            candidates.push(at, [0.0, height], [Location::WHOLE, Location::vertex(vertex.index())]);
        };
        add(self.lowest);
        let t = &self.body.topology;
        if let Some(face) = self.bearing_face(options.max_face_sine) {
            let corners = t.rim(face).count();
            let corner = t.rim(face).map(|h| t.from(h)).step_by(corners.div_ceil(SAMPLE));
            corner.filter(|&v| v != self.lowest).for_each(add);
        } else if let Some(end) = self.bearing_edge(options.max_face_sine) {
            add(end);
        }
        let noise = ACROSS * self.size();
        let merge = noise.larger(options.rebuild_motion * self.body.radius * self.body.unit());
        let all = candidates.all();
        for &k in reduce(all, 0, options.most(), merge, noise).all() {
            if let Some(vertex) = all[k].on[1].as_vertex() {
                contacts.points[contacts.count] = self.contact(VertexId(vertex as u32));
                contacts.count += 1;
            }
        }
    }

    /// Returns the face at the lowest vertex most nearly parallel to the plane, if its angle is
    /// small enough.
    fn bearing_face(&self, sine: f64) -> Option<FaceId> {
        let t = &self.body.topology;
        let along = |f: FaceId| self.body.planes[f.index()].normal.dot(&self.down);
        let faces = t.fan(self.lowest).iter().map(|h| t.half_edge(h).face);
        let face = faces.max_by(|f, g| along(*f).by_value(along(*g)))?;
        // The null face of a segment has no normal.
        let cosine = along(face);
        (cosine > STEEP && cosine * cosine >= 1.0 - sine * sine).then_some(face)
    }

    /// Returns the other end of the edge at the lowest vertex that is most nearly parallel to the
    /// plane, if its angle is small enough.
    fn bearing_edge(&self, sine: f64) -> Option<VertexId> {
        let (t, points) = (&self.body.topology, &self.body.points);
        let slope = |v: VertexId| {
            let e = points[v.index()] - points[self.lowest.index()];
            -self.down.dot(&e) / sqrt(e.norm_squared())
        };
        let end = t.neighbours(self.lowest).min_by(|v, w| slope(*v).by_value(slope(*w)))?;
        (slope(end) <= sine).then_some(end)
    }
}
