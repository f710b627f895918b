//! From a file to a body, and what the user should know about it.

use std::path::Path;

use lab::meshes::{self, Mesh};
use lab::pose::{add, cross, dot, sub};
use lin_canny::nalgebra::Point3;
use lin_canny::polyhedron::BuildError;
use lin_canny::{ConvexPolyhedron, Feature};

/// A mesh that encloses the volume of its hull up to this part of it is called convex: single precision files round
/// flat faces by some 1e-7 of the size.
const CONVEX_TO: f64 = 1e-4;

/// Corners of a face that are printed.
const CORNERS: usize = 3;

/// A body and the numbers its file gives to its points.
pub(crate) struct Loaded {
    pub(crate) body: ConvexPolyhedron,
    numbers: Vec<u32>,
}

impl Loaded {
    /// A feature by the numbers of its points in the file: `v7`, `e7-9`, `f7-9-4`, `f7-9-4..` for more corners.
    pub(crate) fn name(&self, feature: Feature) -> String {
        let number = |v| {
            self.body
                .source_vertex(v)
                .map_or("?".into(), |i| self.numbers[i].to_string())
        };
        match feature {
            Feature::Vertex(v) => format!("v{}", number(v)),
            Feature::Edge(e) => {
                let ends = self.body.edge_vertices(e).into_iter().flatten();
                format!("e{}", ends.map(number).collect::<Vec<_>>().join("-"))
            }
            Feature::Face(f) => {
                let corners: Vec<String> = self.body.face_vertices(f).map(number).collect();
                let more = if corners.len() > CORNERS { ".." } else { "" };
                format!("f{}{more}", corners[..corners.len().min(CORNERS)].join("-"))
            }
        }
    }
}

/// Reads a mesh, builds its hull and prints the report.
pub(crate) fn load(letter: char, path: &Path) -> Result<Loaded, Box<dyn std::error::Error>> {
    let mesh = meshes::load(path)?;
    let refused = |e: BuildError| format!("{}: no body: {e}", path.display());
    let points: Vec<_> = mesh.points.iter().map(|&p| Point3::from(p)).collect();
    let body = match ConvexPolyhedron::from_points(&points) {
        Err(BuildError::Flat { dimension: 2, .. } | BuildError::TooFewPoints { count: 3, .. }) => {
            ConvexPolyhedron::polygon(&points).map_err(refused)?
        }
        other => other.map_err(refused)?,
    };
    println!("{letter}: {}", path.display());
    println!("   mesh of {} points and {} faces", mesh.points.len(), mesh.faces.len());
    println!("   hull: {}", body.report());
    println!("   {}", convexity(&mesh, &body));
    Ok(Loaded {
        body,
        numbers: mesh.numbers,
    })
}

/// Whether the mesh is its hull, by volume.
fn convexity(mesh: &Mesh, body: &ConvexPolyhedron) -> String {
    let hull = body.volume();
    if hull == 0.0 {
        return "the mesh is flat and is taken as a polygon".into();
    }
    let part = enclosed(mesh, body.centroid().into()) / hull;
    if (part.abs() - 1.0).abs() <= CONVEX_TO {
        "the mesh is convex".into()
    } else if (0.0..1.0).contains(&part.abs()) {
        format!(
            "the mesh is not convex (it encloses {:.1} % of its hull): the hull is used",
            100.0 * part.abs()
        )
    } else {
        "the mesh is not closed, or its faces cross: the hull of its points is used".into()
    }
}

/// Volume that the faces enclose, seen from `from`: the sum of signed tetrahedra.
fn enclosed(mesh: &Mesh, from: [f64; 3]) -> f64 {
    let corner = |i: u32| sub(mesh.points[i as usize], from);
    let cone = |f: &lab::Face| {
        let fan = f[1..].windows(2).map(|w| cross(corner(w[0]), corner(w[1])));
        dot(corner(f[0]), fan.fold([0.0; 3], add)) / 6.0
    };
    mesh.faces.iter().map(cone).sum()
}
