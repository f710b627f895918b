//! Reads a body from a file, and reports its properties to the user.

use std::collections::HashMap;
use std::path::Path;

use lin_canny::nalgebra::Point3;
use lin_canny::polyhedron::BuildError;
use lin_canny::{ConvexPolyhedron, Feature, Mesh, MeshError, MeshKind};
use lin_canny_formats::{MeshFile, MeshFormat};
use truth::say;

/// A mesh counts as convex if the void fraction of its hull is at most this: files in single
/// precision round flat faces by about 1e-7 of the size.
const CONVEX_TO: f64 = 1e-4;

/// Vertices of a face that are printed.
const CORNERS: usize = 3;

/// A body, and the numbers of its points in the file.
pub(crate) struct Loaded {
    pub(crate) body: ConvexPolyhedron,
    numbers: Vec<u32>,
}

impl Loaded {
    /// Returns the name of a feature by the numbers of its points in the file: `v7`, `e7-9`,
    /// `f7-9-4`, or `f7-9-4..` for more vertices.
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
    let file = MeshFile::load_for_hull(path)?;
    let (points, triangles) = file.whole();
    let numbers = match file.format {
        MeshFormat::Obj => numbers(&String::from_utf8_lossy(&std::fs::read(path)?), &points),
        _ => (0..points.len() as u32).collect(),
    };
    let refused = |e: BuildError| format!("{}: no body: {e}", path.display());
    let points: Vec<_> = points.into_iter().map(Point3::from).collect();
    let body = match ConvexPolyhedron::from_points(&points) {
        Err(BuildError::Flat { dimension: 2, .. } | BuildError::TooFewPoints { count: 3, .. }) => {
            ConvexPolyhedron::polygon(&points).map_err(refused)?
        }
        other => other.map_err(refused)?,
    };
    say!("{letter}: {}", path.display());
    say!("   mesh: points {}, triangles {}", points.len(), triangles.len());
    say!("   hull: {}", body.report());
    if !triangles.is_empty() {
        let convexity = convexity(&points, &triangles, &numbers, &body);
        say!("   {}", convexity.map_err(|e| format!("{}: {e}", path.display()))?);
    }
    Ok(Loaded { body, numbers })
}

/// Returns the number of the first `v` line with the coordinates of each point of an OBJ, from 1; 0
/// if there is none.
fn numbers(text: &str, points: &[[f64; 3]]) -> Vec<u32> {
    let key = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
    let vertex = |line: &str| {
        let mut words = line.split_whitespace().skip(1).map_while(|word| word.parse().ok());
        Some(key([words.next()?, words.next()?, words.next()?]))
    };
    let lines = text.lines().filter(|line| line.split_whitespace().next() == Some("v"));
    let mut first = HashMap::new();
    for (line, number) in lines.zip(1..) {
        if let Some(key) = vertex(line) {
            first.entry(key).or_insert(number);
        }
    }
    points
        .iter()
        .map(|p| first.get(&key(*p)).copied().unwrap_or(0))
        .collect()
}

/// Describes how the hull differs from the mesh: whether the mesh is closed and convex, and how
/// much the hull adds.
fn convexity(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    numbers: &[u32],
    body: &ConvexPolyhedron,
) -> Result<String, MeshError> {
    if body.volume() == 0.0 {
        return Ok("the mesh is flat and is taken as a polygon".into());
    }
    let surface = Mesh::new(points, triangles)?;
    let report = surface.report();
    if let [[p, q], ..] = report.boundary_edges[..] {
        let [p, q] = [p, q].map(|i| numbers[i as usize]);
        let count = report.boundary_edges.len();
        return Ok(format!(
            "the mesh is open: {count} edges have a triangle on one side only (one from v{p} to v{q}); the hull is used"
        ));
    }
    if surface.kind() == MeshKind::Open {
        return Ok(format!("the mesh is not a solid ({report}); the hull is used"));
    }
    let fit = surface.hull_fit(body);
    Ok(match fit.void_fraction() {
        Some(void_fraction) if void_fraction <= CONVEX_TO => "the mesh is convex".into(),
        _ => format!("the mesh is not convex: {fit}; the hull is used"),
    })
}
