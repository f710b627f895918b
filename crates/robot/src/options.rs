//! Options for loading a robot or a cell.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// The body that is made from a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MeshUse {
    /// The convex hull: the fastest queries, but the hull is larger than the mesh.
    #[default]
    Hull,
    /// The triangles of the mesh; a closed mesh is solid, any other has no inside.
    Mesh,
    /// The triangles after a [repair](lin_canny::Mesh::repaired) of inverted triangles and holes: a
    /// solid.
    Solid,
    /// Convex pieces from a separate file: the hull of each object of an OBJ.
    Pieces,
}

/// Options for loading a robot or a cell from files.
///
/// ```
/// use lin_canny_robot::{LoadOptions, MeshUse};
///
/// let options = LoadOptions::default()
///     .meshes(MeshUse::Mesh)
///     .link_meshes([("gripper".into(), MeshUse::Hull)]);
/// assert_eq!(options.mesh_of("gripper"), MeshUse::Hull);
/// assert_eq!(options.mesh_of("base"), MeshUse::Mesh);
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LoadOptions {
    /// The body that is made from a mesh file.
    pub meshes: MeshUse,
    /// The bodies that are made from the mesh files of single links, by link name.
    ///
    /// A cell has no links and ignores them.
    pub link_meshes: BTreeMap<String, MeshUse>,
    /// Folder of the convex pieces: the objects of `arm.obj` are the pieces of `arm.stl`.
    pub pieces: Option<PathBuf>,
    /// Whether to measure how much each hull differs from its mesh; slow for large meshes.
    pub measure_hulls: bool,
    /// Whether to skip collision elements of a robot and bodies of a cell whose mesh file does not
    /// exist.
    ///
    /// They are listed in [`Robot::skipped`](crate::Robot::skipped) and
    /// [`CellFile::skipped`](crate::CellFile::skipped), and nothing is checked against them.
    pub skip_missing_meshes: bool,
    /// Whether points without a return (NaN or infinite) in the file of a cloud are an error. If
    /// not, they are dropped and counted.
    pub keep_invalid: bool,
    /// Least and greatest value of a revolute joint without limits, in radians.
    pub continuous_limits: [f64; 2],
    /// Least and greatest position of planar and floating joints, which URDF does not limit, and of
    /// sliding joints without limits, in the unit of the file.
    ///
    /// They are widened to contain the pose at which an MJCF or SDFormat file draws a body.
    pub floating_limits: [f64; 2],
    /// Half the side of the box that stands for a plane of a link that a joint moves, in MJCF or
    /// SDFormat; the box is as deep. In the unit of the file.
    ///
    /// A body that moves is bounded. A plane of any other link, or of a cell, is a half-space.
    pub plane_extent: f64,
}

impl Default for LoadOptions {
    /// Hulls that are not measured; missing meshes are errors; points without a return are dropped;
    /// two full turns and ten metres in
    /// both directions; planes that move extend a thousand metres.
    fn default() -> Self {
        let turns = 4.0 * std::f64::consts::PI;
        Self {
            meshes: MeshUse::Hull,
            link_meshes: BTreeMap::new(),
            pieces: None,
            measure_hulls: false,
            skip_missing_meshes: false,
            keep_invalid: false,
            continuous_limits: [-turns, turns],
            floating_limits: [-10.0, 10.0],
            plane_extent: 1000.0,
        }
    }
}

impl LoadOptions {
    /// Returns the options with another kind of body for all mesh files.
    #[must_use]
    pub fn meshes(mut self, usage: MeshUse) -> Self {
        self.meshes = usage;
        self
    }

    /// Returns the options with other kinds of bodies for the mesh files of some links.
    #[must_use]
    pub fn link_meshes(mut self, links: impl IntoIterator<Item = (String, MeshUse)>) -> Self {
        self.link_meshes = links.into_iter().collect();
        self
    }

    /// Returns the options with a folder of convex pieces.
    #[must_use]
    pub fn pieces(mut self, folder: impl Into<PathBuf>) -> Self {
        self.pieces = Some(folder.into());
        self
    }

    /// Returns the options with or without a measurement of each hull.
    #[must_use]
    pub fn measure_hulls(mut self, measure: bool) -> Self {
        self.measure_hulls = measure;
        self
    }

    /// Returns the options that skip bodies without their mesh file, or do not.
    #[must_use]
    pub fn skip_missing_meshes(mut self, skip: bool) -> Self {
        self.skip_missing_meshes = skip;
        self
    }

    /// Returns the options that reject files with points without a return, or drop such points.
    #[must_use]
    pub fn keep_invalid(mut self, keep: bool) -> Self {
        self.keep_invalid = keep;
        self
    }

    /// Returns the options with other limits for revolute joints without limits, in radians.
    #[must_use]
    pub fn continuous_limits(mut self, limits: [f64; 2]) -> Self {
        self.continuous_limits = limits;
        self
    }

    /// Returns the options with other limits for the positions of planar and floating joints.
    #[must_use]
    pub fn floating_limits(mut self, limits: [f64; 2]) -> Self {
        self.floating_limits = limits;
        self
    }

    /// Returns the options with another extent of the boxes that stand for planes that move.
    #[must_use]
    pub fn plane_extent(mut self, extent: f64) -> Self {
        self.plane_extent = extent;
        self
    }

    /// Returns the kind of body that is made from the mesh files of a link.
    #[must_use]
    pub fn mesh_of(&self, link: &str) -> MeshUse {
        self.link_meshes.get(link).copied().unwrap_or(self.meshes)
    }
}
