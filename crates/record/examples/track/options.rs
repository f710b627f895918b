//! Options of the command line.

use std::path::PathBuf;

use clap::Parser;
use truth::command::file;

/// Track the closest features of two meshes that tumble past each other
///
/// Prints the closest features, the distance with its bounds and the steps of each frame. Draws the
/// closest frame, and distance and steps over time. The bodies are the convex hulls of the meshes.
/// With --poses the bodies are the meshes themselves; --csv writes the answer at each pose.
#[derive(Parser)]
pub(crate) struct Options {
    /// Two meshes in STL, OBJ, COLLADA, PLY, glTF or MSH files
    ///
    /// [default: examples/meshes/gem.obj examples/meshes/nut.stl]
    #[arg(num_args = 2, value_names = ["A", "B"])]
    pub(crate) meshes: Vec<PathBuf>,
    /// Number of frames of the motion
    #[arg(long, value_name = "N", default_value_t = 720, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub(crate) frames: u32,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/track.svg", value_parser = file("svg"))]
    pub(crate) out: PathBuf,
    /// Output recording of at most 2,000 frames
    #[arg(long, value_name = "FILE.jsonl", value_parser = file("jsonl"))]
    pub(crate) record: Option<PathBuf>,
    /// Output page: the same recording as one HTML file, for any browser with WebGL 2
    #[arg(long, value_name = "FILE.html", value_parser = file("html"))]
    pub(crate) page: Option<PathBuf>,
    /// File with one pose of B in A's frame per line, `x y z qx qy qz qw`, separated by blanks or
    /// commas; the first line may name the columns. The bodies are then the meshes, not their hulls
    #[arg(long, value_name = "FILE", requires = "meshes", conflicts_with_all = ["frames", "record", "page"])]
    pub(crate) poses: Option<PathBuf>,
    /// Output table, `distance,lower,upper,ax,ay,az,bx,by,bz` for each pose (A's frame); if the
    /// meshes overlap, the distance is 0 and the lower bound -inf
    #[arg(long, value_name = "FILE.csv", requires = "poses", value_parser = file("csv"))]
    pub(crate) csv: Option<PathBuf>,
}

impl Options {
    /// Returns the two given meshes, or the built-in meshes.
    pub(crate) fn pair(&self) -> [PathBuf; 2] {
        let ours = |name: &str| {
            PathBuf::from(env!("CARGO_MANIFEST_DIR"))
                .join("../../examples/meshes")
                .join(name)
        };
        match self.meshes.as_slice() {
            [a, b] => [a.clone(), b.clone()],
            _ => [ours("gem.obj"), ours("nut.stl")],
        }
    }
}
