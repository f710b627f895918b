//! Errors of the calls of a scene, and their messages.

use super::{BodyId, Group};
use crate::base::num::axis_name;
use crate::base::pose::PoseError;
use crate::broad::BroadPhaseError;
#[cfg(feature = "meshes")]
use crate::nonconvex::mesh::VertexError;
use crate::pair_tracker::geometry::GeometryKind;
use crate::ray::RayError;

/// Error of a call of a scene; the scene is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The id is not of this scene, or its body was removed.
    #[error("{body} does not exist in this scene, or was removed")]
    StaleBody {
        /// The id as given.
        body: BodyId,
    },
    /// The pose is not a rigid motion. Poses of one body are reported as poses of A.
    #[error("the pose of {} is invalid: {}", BodyName(*.body), OfOne(.error))]
    Pose {
        /// The body; `None` for a body to be inserted.
        body: Option<BodyId>,
        /// What is wrong with the pose.
        error: PoseError,
    },
    /// A coordinate of the pose is beyond 1e37, measured from the origin of the world.
    #[error("the pose of {} is out of range: {} is {value:e} (expected -1e37..=1e37)", BodyName(*.body), axis_name(*.axis))]
    TooFar {
        /// The body; `None` for a body to be inserted.
        body: Option<BodyId>,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// The coordinate.
        value: f64,
    },
    /// A coordinate of the geometry, in its frame, may be beyond 1e37.
    #[error("the geometry is too large: a coordinate may be {reach:e} (expected at most 1e37)")]
    TooLarge {
        /// The largest coordinate of a vertex of a polyhedron; for other geometries an upper bound
        /// of the largest coordinate.
        reach: f64,
    },
    /// The body is not a mesh. Only meshes have vertices that can be replaced.
    #[error("{body} is not a mesh")]
    NotAMesh {
        /// The body.
        body: BodyId,
    },
    /// The new vertices of a mesh are invalid.
    #[cfg(feature = "meshes")]
    #[error("the vertices of {body} are invalid: {error}")]
    Vertices {
        /// The body.
        body: BodyId,
        /// What is wrong with the vertices.
        error: VertexError,
    },
    /// The distance of a query is NaN, negative or beyond 1e37. Only `distance` may be infinite.
    #[error("query distance {value} is out of range (expected 0..=1e37; `distance` may be infinite)")]
    Range {
        /// The distance.
        value: f64,
    },
    /// `max_face_sine`, `rebuild_motion` or `reselect_motion` of the manifold options is NaN.
    #[error("a manifold option is NaN (`max_face_sine`, `rebuild_motion` or `reselect_motion`)")]
    ManifoldOptions,
    /// Two bodies of the scene cannot answer an enabled query.
    #[error("the query {query} does not exist between a {these} and a {those}")]
    Unanswered {
        /// The name of the query.
        query: &'static str,
        /// The kind of the first geometry.
        these: GeometryKind,
        /// The kind of the second geometry.
        those: GeometryKind,
    },
    /// A velocity or a time is NaN or infinite.
    #[error("a velocity or a time is not finite")]
    Velocity,
    /// The velocity of a fixed body cannot be set.
    #[error("cannot set the velocity of {body}: it is fixed")]
    Fixed {
        /// The body.
        body: BodyId,
    },
    /// A step is due. The query refers to the poses of the last step, and bodies or queries changed
    /// since then.
    #[error("bodies or queries changed since the last step; call `Scene::step` first")]
    StepDue,
    /// No query is enabled between the two groups, so the scene has no boxes for them.
    #[error("no query is enabled between {these} and {those}; enable one with `Scene::set_queries`")]
    NotEnabled {
        /// The first group.
        these: Group,
        /// The second group.
        those: Group,
    },
    /// No query is enabled for the group of the body.
    #[error("no query is enabled between {group} and any group; enable one with `Scene::set_queries`")]
    GroupNotEnabled {
        /// The group of the body.
        group: Group,
    },
    /// The origin of the scene's [`Settings`](crate::broad::Settings) is NaN or infinite. Such a
    /// scene cannot contain a body.
    #[error("the origin of the scene is not finite on axis {}", axis_name(*.axis))]
    Origin {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// There are too many bodies: a scene holds at most 2^31 - 1.
    #[error("too many bodies in the scene (expected at most 2147483647)")]
    TooManyBodies,
    /// The ray or its length is invalid.
    #[error(transparent)]
    Ray(#[from] RayError),
}

impl From<BroadPhaseError> for SceneError {
    /// Converts the only two possible errors: the origin and the number of bodies. Boxes come from
    /// checked geometries at checked poses.
    fn from(error: BroadPhaseError) -> Self {
        match error {
            BroadPhaseError::Origin { axis } => Self::Origin { axis },
            _ => Self::TooManyBodies,
        }
    }
}

struct BodyName(Option<BodyId>);

impl core::fmt::Display for BodyName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            Some(id) => id.fmt(f),
            None => f.write_str("the body to insert"),
        }
    }
}

/// Displays the error of the pose of one body, without the letter that distinguishes two bodies.
struct OfOne<'a>(&'a PoseError);

impl core::fmt::Display for OfOne<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            PoseError::Translation { axis, value, .. } => {
                write!(f, "{} of its translation is {value:e}", axis_name(*axis))
            }
            PoseError::Rotation { norm_squared, .. } => {
                write!(
                    f,
                    "its rotation is not a unit quaternion but has the squared norm {norm_squared}"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::pose::RelativePose;
    use alloc::string::ToString;
    use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

    #[test]
    fn a_refused_pose_of_one_body_is_not_said_to_be_of_a() {
        let said = |pose: Isometry3<f64>| {
            let error = RelativePose::new(&pose, &Isometry3::identity()).unwrap_err();
            SceneError::Pose { body: None, error }.to_string()
        };
        let far = said(Isometry3::translation(0.0, f64::NAN, 0.0));
        assert_eq!(
            far,
            "the pose of the body to insert is invalid: y of its translation is NaN"
        );
        let long = UnitQuaternion::new_unchecked(Quaternion::new(2.0, 0.0, 0.0, 0.0));
        let long = said(Isometry3::from_parts(Translation3::identity(), long));
        assert!(
            long.ends_with("its rotation is not a unit quaternion but has the squared norm 4"),
            "{long}"
        );
    }
}
