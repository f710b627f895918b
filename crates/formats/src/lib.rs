//! Mesh files as the world writes them: triangles in `f64`, and nothing dropped in silence.
//!
//! ```
//! use lin_canny_formats::MeshFile;
//!
//! let text = "solid a
//!   facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet
//! endsolid a";
//! let file = MeshFile::parse(text.as_bytes(), "a.stl")?;
//! let (points, triangles) = file.whole();
//! assert_eq!((points.len(), triangles), (3, vec![[0, 1, 2]]));
//! # Ok::<(), lin_canny_formats::MeshFileError>(())
//! ```
//!
//! # Rules of all readers
//!
//! * The content decides the format first, and then the extension of the file.
//! * Whatever could be geometry and cannot be read is an error with file, line and reason; an error
//!   of a glTF names the element instead of the line, such as `meshes[0]`. Whatever is no geometry
//!   (lines, points, normals, materials) is in [`MeshFile::skipped`], with its line if it has one.
//! * A point belongs to an object only if a triangle uses it.
//! * Numbers are `f64` and finite. A count in a header is never believed: memory grows with the
//!   file, not with the count.
//! * A reader holds at most 4 MiB and 400 bytes for each byte of the file, and of the files of a
//!   glTF. Repeated instances of COLLADA and glTF take at most 128 MiB more; a file that asks for
//!   more is an error.
//! * A polygon is cut into triangles that cover the polygon and nothing else. Its corners may
//!   depart from a plane by half its size, because quads of curved bodies often do. The file
//!   then leaves the surface between them open, and the reader chooses the diagonals. It lists such
//!   polygons, and those without area, in [`MeshFile::skipped`].
//! * Points are not turned: in COLLADA the file chooses which axis is up, in glTF it is Y.
//! * A mirror turns triangles over, so that they keep their outside.
//!
//! # When not to use it
//!
//! The crate reads positions and triangles. It reads no normals, colours, textures or animations.

mod collada;
mod error;
mod gltf;
mod mesh;
mod msh;
mod obj;
mod ply;
mod polygon;
mod stl;
mod text;
mod transform;
mod xml;

pub use error::{MeshFault, MeshFileError};
pub use mesh::{MeshFile, MeshFormat, MeshObject, Skipped};
