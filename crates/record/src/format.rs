//! The lines of a recording.

use std::borrow::Cow;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Geometry, Outcome};
use serde::{Deserialize, Serialize};

/// Name of the format, in the first line of each recording.
pub const FORMAT: &str = "lin-canny recording";

/// The version that this crate writes, and the only one that it reads.
pub const VERSION: u32 = 2;

/// The first line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// The title of the recording.
    #[serde(default)]
    pub title: String,
}

/// A line after the first.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Line<'a> {
    Geometry(Geometry),
    Body(BodyLine),
    Frame(Cow<'a, Frame>),
}

/// A body, shown from the next frame on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyLine {
    /// Name; several bodies may have the same name.
    pub name: String,
    /// Number of the geometry.
    pub geometry: u32,
    /// Pose in the world until a frame sets another one.
    #[serde(with = "poses::one")]
    pub pose: Isometry3<f64>,
    /// Index of the first frame that shows the body; the reader sets it.
    #[serde(skip)]
    pub since: usize,
}

/// A frame. Empty lists are not written.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Frame {
    /// Bodies whose poses changed since the previous frame, with the new poses.
    #[serde(with = "poses::many", skip_serializing_if = "Vec::is_empty")]
    pub poses: Vec<(u32, Isometry3<f64>)>,
    /// Meshes whose vertices changed since the previous frame, with all new vertices in the order
    /// of the mesh and in the body's frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub vertices: Vec<(u32, Vec<Point3<f64>>)>,
    /// Bodies that are removed from this frame on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub removed: Vec<u32>,
    /// Pairs of bodies, with their outcomes and contacts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairLine>,
    /// Boxes of the broad phase: lower and upper corner.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub boxes: Vec<[Point3<f64>; 2]>,
    /// Columns of the broad phase.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub columns: Vec<ColumnLine>,
    /// Brackets of times of impact.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub brackets: Vec<Bracket>,
    /// Paths through the world.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub paths: Vec<Vec<Point3<f64>>>,
    /// A line of text about the frame.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// A pair of bodies in a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairLine {
    /// Number of body A.
    pub a: u32,
    /// Number of body B.
    pub b: u32,
    /// The closest points with their bounds, in the frames of the bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome: Option<Outcome>,
    /// Index of the piece, triangle or patch of A and of B that contains the features; zero for
    /// convex bodies.
    #[serde(default, skip_serializing_if = "is_whole")]
    pub subshapes: [u32; 2],
    /// Contact points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<Contact>,
}

fn is_whole(subshapes: &[u32; 2]) -> bool {
    *subshapes == [0; 2]
}

/// A contact point, in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Id that persists as long as the contact.
    pub name: String,
    /// The point on A.
    pub on_a: Point3<f64>,
    /// The point on B.
    pub on_b: Point3<f64>,
    /// Unit direction from A to B.
    pub normal: Vector3<f64>,
    /// Signed distance along the normal, negative for an overlap.
    pub separation: f64,
}

/// A column of the broad phase, infinite along one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColumnLine {
    /// The axis of the column: 0, 1, 2 for x, y, z. The other two follow in cyclic order.
    pub axis: u8,
    /// Lower corner on the two other axes, in the world.
    pub lo: [f64; 2],
    /// Upper corner on the two other axes.
    pub hi: [f64; 2],
    /// Number of bodies in the column.
    pub listed: u32,
}

/// The bracket of a first contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bracket {
    /// Numbers of the two bodies.
    pub bodies: [u32; 2],
    /// The bodies are proven apart up to this time.
    pub safe: f64,
    /// The bodies are proven to be in contact at this time.
    pub hit: f64,
    /// The poses of the two bodies at `safe`.
    #[serde(with = "poses::both")]
    pub at_safe: [Isometry3<f64>; 2],
    /// The poses of the two bodies at `hit`.
    #[serde(with = "poses::both")]
    pub at_hit: [Isometry3<f64>; 2],
}

/// Poses as arrays of seven numbers: translation x, y, z and quaternion x, y, z, w.
pub mod poses {
    use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, Unit};

    /// Returns the seven numbers of a pose.
    #[must_use]
    pub fn numbers(pose: &Isometry3<f64>) -> [f64; 7] {
        let (t, q) = (&pose.translation.vector, &pose.rotation.coords);
        [t.x, t.y, t.z, q.x, q.y, q.z, q.w]
    }

    /// Returns the pose of seven numbers, without rounding.
    ///
    /// Returns `None` if a number is not finite or the norm of the quaternion differs from 1 by
    /// more than 1e-6.
    #[must_use]
    pub fn pose([x, y, z, i, j, k, w]: [f64; 7]) -> Option<Isometry3<f64>> {
        let turn = Quaternion::new(w, i, j, k);
        let good = (turn.norm() - 1.0).abs() <= 1e-6 && [x, y, z].iter().all(|t| t.is_finite());
        good.then(|| Isometry3::from_parts(Translation3::new(x, y, z), Unit::new_unchecked(turn)))
    }

    fn checked<E: serde::de::Error>(numbers: [f64; 7]) -> Result<Isometry3<f64>, E> {
        pose(numbers).ok_or_else(|| {
            E::custom(format!(
                "invalid pose: {numbers:?} (expected a finite translation and a unit quaternion)"
            ))
        })
    }

    macro_rules! serialized {
        ($name:ident, $of:ty, $stored:ty, $write:expr, $read:expr) => {
            pub(crate) mod $name {
                use lin_canny::nalgebra::Isometry3;
                use serde::{Deserialize, Deserializer, Serialize, Serializer};

                pub(crate) fn serialize<S: Serializer>(value: &$of, to: S) -> Result<S::Ok, S::Error> {
                    let write: fn(&$of) -> $stored = $write;
                    write(value).serialize(to)
                }

                pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<$of, D::Error> {
                    let read: fn($stored) -> Result<$of, D::Error> = $read;
                    read(<$stored>::deserialize(from)?)
                }
            }
        };
    }

    serialized!(
        one,
        Isometry3<f64>,
        [f64; 7],
        |p| super::numbers(p),
        |n| super::checked(n)
    );
    serialized!(
        both,
        [Isometry3<f64>; 2],
        [[f64; 7]; 2],
        |p| [super::numbers(&p[0]), super::numbers(&p[1])],
        |n| Ok([super::checked(n[0])?, super::checked(n[1])?])
    );
    serialized!(
        many,
        Vec<(u32, Isometry3<f64>)>,
        Vec<(u32, [f64; 7])>,
        |list| list.iter().map(|(k, p)| (*k, super::numbers(p))).collect(),
        |list| list.into_iter().map(|(k, n)| Ok((k, super::checked(n)?))).collect()
    );
}
