//! Logging of bodies, pairs and boxes.

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny_record::{Contact, RenderMesh};
use rerun::external::re_log_types::EntityPath;
use rerun::{
    Arrows3D, Boxes3D, Color, LineStrips3D, Mesh3D, Points3D, Quaternion, RecordingStream, RecordingStreamError,
    Transform3D,
};

const RED: [u8; 3] = [204, 0, 0];
const ORANGE: [u8; 3] = [230, 130, 0];

/// Colours of bodies, selected by the name of the entity (Okabe and Ito 2008).
const COLOURS: [[u8; 3]; 6] = [
    [86, 180, 233],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [0, 114, 178],
    [240, 228, 66],
];

fn single(p: &Point3<f64>) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

fn direction(v: &Vector3<f64>) -> [f32; 3] {
    single(&Point3::from(*v))
}

pub(crate) fn transform(pose: &Isometry3<f64>) -> Transform3D {
    let q = pose.rotation.coords.map(|x| x as f32);
    let turn = Quaternion::from_xyzw([q.x, q.y, q.z, q.w]);
    Transform3D::from_translation_rotation(direction(&pose.translation.vector), turn)
}

/// Logs the triangles of a body, or its edges if it has none.
pub(crate) fn body(
    stream: &RecordingStream,
    entity: &EntityPath,
    geometry: &Geometry,
) -> Result<(), RecordingStreamError> {
    let picture = RenderMesh::from_geometry(geometry);
    let number = entity.to_string().bytes().map(usize::from).sum::<usize>();
    let [r, g, b] = COLOURS[number % COLOURS.len()];
    let colour = Color::from_rgb(r, g, b);
    if picture.triangles.is_empty() {
        let edges = picture.edges.iter().map(|ends| ends.each_ref().map(single));
        return stream.log(entity.clone(), &LineStrips3D::new(edges).with_colors([colour]));
    }
    let corners = picture
        .triangles
        .iter()
        .flat_map(|(corners, _)| corners.iter().map(single));
    let normals = picture.triangles.iter().flat_map(|(_, normal)| [direction(normal); 3]);
    let count = picture.triangles.len() as u32;
    let mesh = Mesh3D::new(corners)
        .with_vertex_normals(normals)
        .with_triangle_indices((0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]))
        .with_albedo_factor(rerun::Rgba32::from_rgb(r, g, b));
    stream.log(entity.clone(), &mesh)
}

/// Logs the closest points and the segment between them.
pub(crate) fn closest(
    stream: &RecordingStream,
    entity: &EntityPath,
    points: [Point3<f64>; 2],
) -> Result<(), RecordingStreamError> {
    let ends = points.each_ref().map(single);
    let [r, g, b] = RED;
    let red = Color::from_rgb(r, g, b);
    stream.log(entity.clone(), &LineStrips3D::new([ends]).with_colors([red]))?;
    stream.log(entity.clone(), &Points3D::new(ends).with_colors([red]))
}

/// Logs contact points with their names, and normals from A to B.
pub(crate) fn contacts(
    stream: &RecordingStream,
    entity: &EntityPath,
    list: &[Contact],
) -> Result<(), RecordingStreamError> {
    let [r, g, b] = ORANGE;
    let orange = Color::from_rgb(r, g, b);
    let points: Vec<_> = list.iter().map(|c| single(&c.on_a)).collect();
    let names = list.iter().map(|c| c.name.as_str());
    let shown = Points3D::new(points.clone()).with_labels(names).with_colors([orange]);
    stream.log(entity.clone(), &shown)?;
    let normals = list.iter().map(|c| direction(&c.normal));
    let arrows = Arrows3D::from_vectors(normals)
        .with_origins(points)
        .with_colors([orange]);
    stream.log(entity.clone(), &arrows)
}

pub(crate) fn boxes(list: &[[Point3<f64>; 2]]) -> Boxes3D {
    let mins = list.iter().map(|[low, _]| single(low));
    let sizes = list.iter().map(|[low, high]| direction(&(high - low)));
    Boxes3D::from_mins_and_sizes(mins, sizes)
}

pub(crate) fn paths(list: &[Vec<Point3<f64>>]) -> LineStrips3D {
    let [r, g, b] = ORANGE;
    let strips = list.iter().map(|path| path.iter().map(single).collect::<Vec<_>>());
    LineStrips3D::new(strips).with_colors([Color::from_rgb(r, g, b)])
}
