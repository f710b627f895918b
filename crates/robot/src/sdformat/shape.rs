//! The geometry of a collision element.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, Unit, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, HullFit, Mesh, MeshKind};
use lin_canny_formats::MeshFile;
use roxmltree::Node;

use super::values::SdfFile;
use crate::error::{FileError, FileErrorKind};
use crate::geometry::{self, Solid};
use crate::mesh_file::MeshPlacing;
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::turn::direction;
use lin_canny_plan::turn_from_z;

/// The names of the shapes.
const SHAPES: [&str; 12] = [
    "box",
    "capsule",
    "cone",
    "cylinder",
    "ellipsoid",
    "empty",
    "heightmap",
    "image",
    "mesh",
    "plane",
    "polyline",
    "sphere",
];

/// The sine of an angle at a corner of a polygon, below which the corner is not surely convex.
const CONVEX: f64 = 1e-9;

/// A shape, and its pose in the frame of the collision element.
pub(super) struct SdfShape {
    pub(super) pose: Isometry3<f64>,
    pub(super) geometry: Geometry,
    pub(super) mesh: Option<PathBuf>,
    pub(super) hull_fit: Option<HullFit>,
}

impl From<Geometry> for SdfShape {
    fn from(geometry: Geometry) -> Self {
        Self {
            pose: Isometry3::identity(),
            geometry,
            mesh: None,
            hull_fit: None,
        }
    }
}

/// Returns the shape of an element `geometry` of a link; `None` if the element is empty by name.
pub(super) fn read(
    file: &SdfFile,
    geometry: Node,
    link: &str,
    packages: &Packages,
    options: &LoadOptions,
) -> Result<Option<SdfShape>, FileError> {
    let xml = file.xml;
    xml.check_attributes(geometry, &[], false)?;
    let shapes = xml.below(geometry, &SHAPES, &[])?;
    let is_polyline = |node: &Node| node.tag_name().name() == "polyline";
    let shape = match shapes[..] {
        [shape] => shape,
        [] => return Err(xml.error(&geometry, FileErrorKind::Missing("a shape".into()))),
        [_, second, ..] if shapes.iter().all(is_polyline) => {
            let what = "a geometry of several polylines".into();
            return Err(xml.error(&second, FileErrorKind::Unsupported(what)));
        }
        [_, second, ..] => return Err(xml.error(&second, FileErrorKind::Twice("shape".into()))),
    };
    let wrong = |reason| xml.error(&shape, reason);
    let kind = shape.tag_name().name();
    if kind == "mesh" {
        return of_mesh(file, shape, link, packages, options).map(Some);
    }
    xml.check_attributes(shape, &[], false)?;
    let solid = match kind {
        "box" => {
            let parts = xml.below(shape, &["size"], &[])?;
            let size = file.needed(&shape, &parts, "size")?;
            Solid::Box { size }
        }
        "sphere" => {
            let parts = xml.below(shape, &["radius"], &[])?;
            let [radius] = file.needed(&shape, &parts, "radius")?;
            Solid::Sphere { radius }
        }
        "ellipsoid" => {
            let parts = xml.below(shape, &["radii"], &[])?;
            let radii = file.needed(&shape, &parts, "radii")?;
            Solid::Ellipsoid { radii }
        }
        "cylinder" | "capsule" | "cone" => {
            let parts = xml.below(shape, &["radius", "length"], &[])?;
            let [radius] = file.needed(&shape, &parts, "radius")?;
            let [length] = file.needed(&shape, &parts, "length")?;
            match kind {
                "cylinder" => Solid::Cylinder { radius, length },
                "capsule" => Solid::Capsule { radius, length },
                _ => Solid::Cone { radius, length },
            }
        }
        "plane" => {
            let parts = xml.below(shape, &["normal"], &["size"])?;
            let normal = xml.one(&shape, &parts, "normal")?;
            let normal: Unit<Vector3<f64>> = direction(file.numbers(normal)?).ok_or_else(|| {
                let field = "length of the normal".into();
                wrong(FileErrorKind::Range { field, value: 0.0 })
            })?;
            let extent = options.plane_extent;
            let half_space = Solid::HalfSpace { extent }.geometry().map_err(wrong)?;
            let pose = Isometry3::from_parts(Translation3::identity(), turn_from_z(&normal));
            return Ok(Some(SdfShape {
                pose,
                ..half_space.into()
            }));
        }
        "polyline" => return of_polyline(file, shape).map(Some),
        "empty" => {
            xml.below(shape, &[], &[])?;
            return Ok(None);
        }
        _ => return Err(wrong(FileErrorKind::Unsupported(format!("the shape {kind}")))),
    };
    Ok(Some(solid.geometry().map_err(wrong)?.into()))
}

fn of_mesh(
    file: &SdfFile,
    shape: Node,
    link: &str,
    packages: &Packages,
    options: &LoadOptions,
) -> Result<SdfShape, FileError> {
    let xml = file.xml;
    let wrong = |reason| xml.error(&shape, reason);
    // How a simulator simplifies the mesh; the options of the caller decide this here.
    xml.check_attributes(shape, &["optimization"], false)?;
    let parts = xml.below(shape, &["uri", "scale", "submesh"], &["convex_decomposition"])?;
    let uri = file.word(xml.one(&shape, &parts, "uri")?)?;
    let scale = xml.at_most_one(&parts, "scale")?.map(|node| file.numbers(node));
    let placing = MeshPlacing::scaled(scale.transpose()?.unwrap_or([1.0; 3])).map_err(wrong)?;
    let folder = xml.file.parent().unwrap_or(Path::new(""));
    let path = packages.find(&uri, folder).map_err(wrong)?;
    let usage = options.mesh_of(link);
    let body = match xml.at_most_one(&parts, "submesh")? {
        None => geometry::of_mesh(&path, &placing, usage, options),
        Some(node) => {
            xml.check_attributes(node, &[], false)?;
            let parts = xml.below(node, &["name", "center"], &[])?;
            let name = file.word(xml.one(&node, &parts, "name")?)?;
            let is_centered = file.flag(&parts, "center")?.unwrap_or(false);
            geometry::of_submesh(&path, &name, is_centered, &placing, usage, options)
        }
    };
    let (geometry, hull_fit) = body.map_err(wrong)?;
    Ok(SdfShape {
        hull_fit,
        mesh: Some(path),
        ..geometry.into()
    })
}

/// Returns the prism over a polygon, from `z = 0` to the height.
fn of_polyline(file: &SdfFile, shape: Node) -> Result<SdfShape, FileError> {
    let xml = file.xml;
    let wrong = |reason| xml.error(&shape, reason);
    let parts = xml.below(shape, &["point", "height"], &[])?;
    let [height]: [f64; 1] = file.needed(&shape, &parts, "height")?;
    if !(height > 0.0) {
        let field = "height".into();
        return Err(wrong(FileErrorKind::Range { field, value: height }));
    }
    let points = parts.iter().filter(|node| node.tag_name().name() == "point");
    let points = points.map(|node| file.numbers::<2>(*node));
    let mut points: Vec<[f64; 2]> = points.collect::<Result<_, _>>()?;
    points.dedup();
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 {
        let what = format!("polyline has too few points: {} (expected at least 3)", points.len());
        return Err(wrong(FileErrorKind::Malformed(what)));
    }
    let geometry = if is_convex(&points) {
        let [low, high] = [0.0, height].map(|z| points.iter().map(move |[x, y]| Point3::new(*x, *y, z)));
        let corners: Vec<Point3<f64>> = low.chain(high).collect();
        let hull = ConvexPolyhedron::from_points(&corners);
        hull.map(Geometry::from)
            .map_err(|e| FileErrorKind::Geometry(e.to_string()))
    } else {
        prism(&points, height)
    };
    Ok(geometry.map_err(wrong)?.into())
}

/// Returns whether a polygon turns to one side at each corner, and once around in all.
fn is_convex(points: &[[f64; 2]]) -> bool {
    let at = |k: usize| points[k % points.len()];
    let edge = |k: usize| [at(k + 1)[0] - at(k)[0], at(k + 1)[1] - at(k)[1]];
    let length = |[x, y]: [f64; 2]| libm::hypot(x, y);
    let sine = |k: usize| {
        let (a, b) = (edge(k), edge(k + 1));
        (a[0] * b[1] - a[1] * b[0]) / (length(a) * length(b))
    };
    let sines: Vec<f64> = (0..points.len()).map(sine).collect();
    let is_one_sided = sines.iter().all(|s| *s > CONVEX) || sines.iter().all(|s| *s < -CONVEX);
    // A polygon that goes around once changes its direction along x twice.
    let is_right = |k: usize| edge(k)[0] > 0.0;
    let changes = (0..points.len()).filter(|&k| is_right(k) != is_right(k + 1)).count();
    is_one_sided && changes == 2
}

/// Returns the closed mesh of a prism over any polygon that does not cross itself.
fn prism(points: &[[f64; 2]], height: f64) -> Result<Geometry, FileErrorKind> {
    let count = points.len();
    let next = |k: usize| (k + 1) % count;
    let area = |k: usize| points[k][0] * points[next(k)][1] - points[k][1] * points[next(k)][0];
    let mut around: Vec<usize> = (1..=count).collect();
    if (0..count).map(area).sum::<f64>() < 0.0 {
        around.reverse();
    }
    // The reader of OBJ files cuts polygons into triangles without moving a corner.
    let vertex = |[x, y]: &[f64; 2], z: f64| format!("v {x:?} {y:?} {z:?}\n");
    let mut text: String = points.iter().map(|p| vertex(p, 0.0)).collect();
    text.extend(points.iter().map(|p| vertex(p, height)));
    let words = |numbers: &mut dyn Iterator<Item = usize>| -> String {
        let words: Vec<String> = numbers.map(|k| k.to_string()).collect();
        format!("f {}\n", words.join(" "))
    };
    text += &words(&mut around.iter().rev().copied());
    text += &words(&mut around.iter().map(|k| k + count));
    for k in 0..count {
        let (a, b) = (around[k], around[next(k)]);
        text += &words(&mut [a, b, b + count, a + count].into_iter());
    }
    let wrong = |reason: &dyn std::fmt::Display| FileErrorKind::Geometry(format!("polyline: {reason}"));
    let (points, triangles) = MeshFile::parse(text.as_bytes(), "polyline.obj")
        .map_err(|e| wrong(&e.fault))?
        .whole();
    let points: Vec<Point3<f64>> = points.into_iter().map(Point3::from).collect();
    let mesh = Mesh::new(&points, &triangles).map_err(|e| wrong(&e))?;
    if mesh.kind() != MeshKind::Solid {
        return Err(wrong(
            &"the prism is not closed (expected a line that does not cross itself)",
        ));
    }
    Ok(mesh.into())
}
