//! A mesh file: its objects, and what was skipped. The module `load` picks its reader.

use std::collections::HashMap;

/// Format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// STL, text or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// COLLADA 1.4 or 1.5.
    Collada,
    /// MSH, the binary meshes of MuJoCo.
    Msh,
    /// PLY 1.0, text or binary.
    Ply,
    /// glTF 2.0, as JSON (`.gltf`) or binary (`.glb`).
    Gltf,
}

/// A mesh file as read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// The format.
    pub format: MeshFormat,
    /// The objects with triangles, in the order of the file; those of points alone in a file that is
    /// [loaded for its hull](Self::load_for_hull) and has no triangle.
    pub objects: Vec<MeshObject>,
    /// What the reader has passed over because it is no part of a body.
    pub skipped: Vec<Skipped>,
}

/// An object of a mesh file: a solid of an STL, an object of an OBJ, a geometry of a scene, a PLY.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshObject {
    /// The name in the file; empty if it has none.
    pub name: String,
    /// The points that triangles use, or all if there are no triangles, in the unit of the file
    /// (metres for COLLADA and glTF).
    pub points: Vec<[f64; 3]>,
    /// Three indices of points per triangle, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Something that a reader has passed over.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Skipped {
    /// The line, counted from 1, if known. Of several in a row, the first.
    pub line: Option<usize>,
    /// What it is: `normals`, `l (lines)`, `usemtl`.
    pub what: String,
}

impl MeshFile {
    /// Returns the points and triangles of all objects as one mesh.
    #[must_use]
    pub fn whole(&self) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for object in &self.objects {
            let first = points.len() as u32;
            points.extend(&object.points);
            triangles.extend(object.triangles.iter().map(|t| t.map(|k| k + first)));
        }
        (points, triangles)
    }
}

impl MeshObject {
    /// Returns an object without triangles.
    pub(crate) fn of_points(name: String, points: Vec<[f64; 3]>) -> Self {
        let triangles = Vec::new();
        Self {
            name,
            points,
            triangles,
        }
    }
}

/// Collects the triangles of one object; points that no triangle uses are left out.
#[derive(Debug, Default)]
pub(crate) struct ObjectBuilder {
    object: MeshObject,
    /// The new index of each point of the file that a triangle uses.
    indices: HashMap<u64, u32>,
    /// What is passed over in this object; the reader adds it to the list of the file.
    pub(crate) skipped: SkippedList,
}

impl ObjectBuilder {
    pub(crate) fn new(name: impl Into<String>) -> Self {
        let mut builder = Self::default();
        builder.object.name = name.into();
        builder
    }

    /// Adds a triangle whose corners are points of a list of the file; `None` if an object has more
    /// points than 32 bits name.
    pub(crate) fn triangle(&mut self, corners: [u64; 3], point: impl Fn(u64) -> [f64; 3]) -> Option<()> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            *index = match self.indices.get(&corner) {
                Some(&known) => known,
                None => {
                    let new = u32::try_from(self.object.points.len()).ok()?;
                    self.object.points.push(point(corner));
                    self.indices.insert(corner, new);
                    new
                }
            };
        }
        self.object.triangles.push(triangle);
        Some(())
    }

    pub(crate) fn build(self) -> MeshObject {
        self.object
    }
}

/// Collects what a reader passes over: one entry for each kind, with its first line.
#[derive(Debug, Default)]
pub(crate) struct SkippedList(Vec<Skipped>);

impl SkippedList {
    pub(crate) fn add(&mut self, line: impl Into<Option<usize>>, what: &str) {
        if self.0.iter().all(|known| known.what != what) {
            self.0.push(Skipped {
                line: line.into(),
                what: what.into(),
            });
        }
    }

    pub(crate) fn append(&mut self, other: Self) {
        for one in other.0 {
            self.add(one.line, &one.what);
        }
    }

    pub(crate) fn build(self) -> Vec<Skipped> {
        self.0
    }
}
