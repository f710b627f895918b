//! Bodies as text of the Wavefront OBJ format, to be looked at in other programs.

use alloc::string::String;
use core::fmt::Write as _;

use nalgebra::Point3;

use super::ConvexPolyhedron;

impl ConvexPolyhedron {
    /// Returns the body as the text of an OBJ file: the vertices in the order of their ids, every
    /// bit kept, and the faces as polygons, counter-clockwise seen from outside.
    ///
    /// ```
    /// use lin_canny::nalgebra::Vector3;
    /// use lin_canny::polyhedron::solids;
    ///
    /// let body = solids::cuboid(Vector3::new(0.5, 0.5, 0.1))?;
    /// let text = body.to_obj(); // std::fs::write("cuboid.obj", text)?;
    /// assert_eq!(text.lines().filter(|l| l.starts_with("v ")).count(), 8);
    /// assert_eq!(text.lines().filter(|l| l.starts_with("f ")).count(), 6);
    /// # Ok::<(), lin_canny::BuildError>(())
    /// ```
    #[doc(alias = "write")]
    #[doc(alias = "export")]
    #[must_use]
    pub fn to_obj(&self) -> String {
        let face = |f| self.face_vertices(f).map(|v| v.index());
        obj(self.vertex_points(), self.faces().map(face))
    }
}

/// Returns the text of an OBJ file, whose vertices are counted from one.
pub(crate) fn obj<F>(points: impl Iterator<Item = Point3<f64>>, faces: impl Iterator<Item = F>) -> String
where
    F: Iterator<Item = usize>,
{
    let mut text = String::new();
    for p in points {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for face in faces {
        text.push('f');
        for vertex in face {
            let _ = write!(text, " {}", vertex + 1);
        }
        text.push('\n');
    }
    text
}
