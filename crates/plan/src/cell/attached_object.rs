//! Objects that links carry, and the frames to which they are fixed.

use std::string::String;

use nalgebra::Isometry3;

use lin_canny::Geometry;

/// The frame of a body of the space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Frame {
    /// That of a robot body.
    Robot(usize),
    /// That of a body of the space without geometry; these come after all robot bodies.
    Bare(usize),
}

/// An object that a link carries.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AttachedObject {
    /// The name of the object.
    pub name: String,
    /// The geometry of the object.
    pub geometry: Geometry,
    /// The link that carries the object.
    pub link: String,
    /// Pose of the object in the frame of the link.
    pub pose: Isometry3<f64>,
    pub(crate) frame: Frame,
}
