//! Hulls of few faces that contain the collision elements of a robot, as URDF and JSON.

use std::path::Path;

use lin_canny::cover::{HullCover, hull_outside};
use lin_canny_record::escaped;
use serde_json::{Map, Value, json};

use crate::cover::{LinkCoverError, edited};
use crate::error::FileError;
use crate::robot::Robot;

/// The hulls of a link.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LinkHulls {
    /// Name of the link.
    pub link: String,
    /// A hull for each body of the link, in the frame of the body, which it contains.
    pub hulls: Vec<HullCover>,
}

/// Returns hulls of at most `faces` faces around the bodies of a robot, for programs that know only
/// convex polyhedra, or only half-spaces.
///
/// The result has a row for each link with bodies, in the order of [`Robot::links`]. Bodies are
/// those of the robot: the hull of a mesh, or its triangles with
/// [`MeshUse::Mesh`](crate::MeshUse::Mesh). Each hull is in the frame of its body, whose pose is
/// [`LinkBody::origin`](crate::LinkBody::origin), so no pose rounds it. It contains the body, and no
/// point of it is farther from the convex hull of the body than the gap; see
/// [`hull_outside`].
///
/// ```
/// use lin_canny_robot::{Packages, Robot, hull_links};
///
/// let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/gripper.urdf");
/// let robot = Robot::load(urdf, &Packages::default())?;
/// for link in hull_links(&robot, 16)? {
///     for cover in &link.hulls {
///         assert!(cover.planes.len() <= 16 && cover.gap < 0.1, "{}", link.link);
///     }
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// Returns an error if the number of faces is out of range, if a link has a half-space, or if a
/// hull would be out of range. The error names the link and the body.
pub fn hull_links(robot: &Robot, faces: usize) -> Result<Vec<LinkHulls>, LinkCoverError> {
    let with_bodies = robot.links().iter().filter(|link| !link.bodies.is_empty());
    let of_link = |link: &lin_canny_plan::RobotLink| {
        let bodies = link.bodies.iter().enumerate();
        let hulls = bodies.map(|(k, body)| {
            hull_outside(&body.geometry, faces).map_err(|reason| LinkCoverError {
                link: link.name.clone(),
                body: k,
                reason,
            })
        });
        Ok(LinkHulls {
            link: link.name.clone(),
            hulls: hulls.collect::<Result<_, _>>()?,
        })
    };
    with_bodies.map(of_link).collect()
}

/// Returns the text of a URDF file with meshes instead of the geometries of the collision
/// elements.
///
/// All the rest of the file stays as it is: joints, visuals, origins, comments. A link without a
/// row in `hulls` keeps its geometries. `name` returns the file of a hull by the index of its row
/// and of the hull in the row; write [`ConvexPolyhedron::to_obj`] there, whose numbers keep every
/// bit. `hulls` must be those of all elements: of a robot without
/// [`skipped`](Robot::skipped) meshes.
///
/// [`ConvexPolyhedron::to_obj`]: lin_canny::ConvexPolyhedron::to_obj
///
/// # Errors
///
/// Returns an error if the file cannot be read, is not a URDF, or declares entities.
pub fn urdf_of_hulls(
    path: impl AsRef<Path>,
    hulls: &[LinkHulls],
    name: impl Fn(usize, usize) -> String,
) -> Result<String, FileError> {
    edited(path.as_ref(), |link, element, k| {
        let row = hulls.iter().position(|hulls| hulls.link == link)?;
        let geometry = element.children().find(|node| node.has_tag_name("geometry"))?;
        hulls[row].hulls.get(k)?;
        let file = escaped(&name(row, k));
        Some((
            geometry.range(),
            format!("<geometry><mesh filename=\"{file}\"/></geometry>"),
        ))
    })
}

/// Returns hulls of links as JSON.
///
/// The object has `hulls`: for each link a list of objects, one for each body. Each has the pose of
/// the body in the frame of the link, `translation` and `rotation` (a quaternion x, y, z, w); in the
/// frame of the body `vertices`, `triangles` as indices, and the planes of the faces, `normals` and
/// `offsets`, with `normal . x <= offset` inside; and the `gap`.
#[must_use]
pub fn json_of_hulls(robot: &Robot, hulls: &[LinkHulls]) -> String {
    let of_body = |body: &lin_canny_plan::LinkBody, cover: &HullCover| -> Value {
        let vertices = cover.hull.vertex_points().map(|p| json!(p.coords.as_slice()));
        let triangles = cover.hull.triangles().map(|t| json!(t.map(|v| v.index())));
        let normals = cover.planes.iter().map(|plane| json!(plane.normal().as_slice()));
        let offsets = cover.planes.iter().map(|plane| json!(plane.offset()));
        json!({
            "translation": body.origin.translation.vector.as_slice(),
            "rotation": body.origin.rotation.coords.as_slice(),
            "vertices": vertices.collect::<Value>(),
            "triangles": triangles.collect::<Value>(),
            "normals": normals.collect::<Value>(),
            "offsets": offsets.collect::<Value>(),
            "gap": cover.gap,
        })
    };
    let of_link = |row: &LinkHulls| -> Option<(String, Value)> {
        let link = robot.links().iter().find(|link| link.name == row.link)?;
        let bodies = link.bodies.iter().zip(&row.hulls);
        Some((
            row.link.clone(),
            bodies.map(|(body, cover)| of_body(body, cover)).collect(),
        ))
    };
    let all: Map<String, Value> = hulls.iter().filter_map(of_link).collect();
    format!("{:#}\n", json!({"robot": robot.name(), "hulls": all}))
}
