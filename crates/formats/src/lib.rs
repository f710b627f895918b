//! Mesh, point and grid files as the world writes them, with nothing dropped in silence.
//!
//! ```
//! use lin_canny_formats::{MeshFile, PointFile, Points};
//!
//! let text = "solid a
//!   facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet
//! endsolid a";
//! let file = MeshFile::parse(text.as_bytes(), "a.stl")?;
//! let (points, triangles) = file.whole();
//! assert_eq!((points.len(), triangles), (3, vec![[0, 1, 2]]));
//!
//! // The points of a depth camera. It has seen nothing at the second pixel.
//! let file = PointFile::parse(b"0.5 0.25 1\nnan nan nan\n", "a.xyz")?;
//! assert_eq!(file.points, Points::F64(vec![[0.5, 0.25, 1.0]]));
//! assert_eq!(file.dropped, 1);
//! # Ok::<(), lin_canny_formats::FormatError>(())
//! ```
//!
//! # Rules of all readers
//!
//! * The content decides the format first, and then the extension of the file.
//! * What could be geometry and cannot be read is an error with file, line and reason; an error
//!   of a glTF names the element instead of the line, such as `meshes[0]`. What is no geometry
//!   (lines, points, normals, materials) is in [`MeshFile::skipped`], with its line if it has one.
//! * A point belongs to an object only if a triangle uses it. A file of points alone is an error,
//!   except for [`MeshFile::load_for_hull`].
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
//! # Points
//!
//! [`PointFile`] reads the points of PLY, PCD, XYZ and npy files by the same rules, with these
//! differences:
//!
//! * Points are `f32` if all three coordinates are `f32` in a binary file, and `f64` otherwise: a
//!   decimal of a text keeps all its digits.
//! * A point with a coordinate that is NaN or infinite is a pixel or a ray without a return. It is
//!   dropped and counted in [`PointFile::dropped`], or is an error with [`Invalid::Refuse`]. So the
//!   number of a point is its number in the file only if no point is dropped. A number out of range,
//!   such as `1e400`, is always an error.
//! * All the rest is in [`PointFile::skipped`]: colours, normals, faces, and the pose of the sensor
//!   of a PCD (`VIEWPOINT`), by which points are not moved. So are the zeros up to a page that PCL
//!   leaves behind binary data.
//!
//! # Grids
//!
//! [`Grid`] reads a rectangle of numbers from an npy file or a text, such as the heights of a
//! terrain. A number that is not finite is an error with its row and column.
//!
//! # Grids in space
//!
//! [`Volume`] writes numbers at the nodes of a grid in space, such as signed distances, as npy, NRRD
//! or raw. It is written only: a grid of distances is no geometry.
//!
//! # When not to use it
//!
//! The crate reads positions, triangles and radii of points. It reads no normals, colours, textures or animations.
// Bits that differ by target are refused by `.clippy.toml`; tests are free.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod collada;
mod error;
mod gltf;
mod grid;
mod load;
mod mesh;
mod msh;
mod npy;
mod number;
mod obj;
mod pcd;
mod ply;
mod points;
mod polygon;
mod scene;
mod stl;
mod text;
mod transform;
mod volume;
mod xml;
mod xyz;

pub use error::{FormatError, FormatFault};
pub use grid::Grid;
pub use mesh::{MeshFile, MeshFormat, MeshObject, Skipped};
pub use points::{Invalid, PointFile, PointFormat, Points};
pub use scene::{MeshNode, MeshScene};
pub use volume::{Volume, VolumeFormat};
