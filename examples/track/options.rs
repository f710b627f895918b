//! What the command line asks for.

use std::path::PathBuf;

use clap::Parser;
use truth::command::file;

/// Two meshes tumble past each other. Prints the closest features, the distance with its bounds and the
/// steps of each frame, and draws the closest frame, and distance and steps over time
///
/// The meshes are taken as their convex hulls. With --poses they are taken as they are, convex or not,
/// and nothing is drawn.
#[derive(Parser)]
pub(crate) struct Options {
    /// Two meshes in OBJ or STL files
    ///
    /// [default: examples/meshes/gem.obj examples/meshes/nut.stl]
    #[arg(num_args = 2, value_names = ["A", "B"])]
    pub(crate) meshes: Vec<PathBuf>,
    /// Frames of the motion
    #[arg(long, value_name = "N", default_value_t = 720, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub(crate) frames: u32,
    /// Where to draw
    #[arg(long, value_name = "FILE.svg", default_value = "target/track.svg", value_parser = file("svg"))]
    pub(crate) out: PathBuf,
    /// Where to write the frames, 2,000 of them at most, for the viewer (folder crates/viewer/)
    #[arg(long, value_name = "FILE.jsonl", value_parser = file("jsonl"))]
    pub(crate) record: Option<PathBuf>,
    /// Poses of B in A's frame, `x y z qx qy qz qw`, one a line, with blanks or commas between them; the
    /// first line may name the columns. The meshes are taken as they are, not as hulls
    #[arg(long, value_name = "FILE", requires_all = ["csv", "meshes"])]
    pub(crate) poses: Option<PathBuf>,
    /// Where to write `distance,lower,upper,ax,ay,az,bx,by,bz` for each pose (A's frame); meshes that overlap have
    /// the distance 0 and the lower bound -inf
    #[arg(long, value_name = "FILE.csv", requires = "poses", value_parser = file("csv"))]
    pub(crate) csv: Option<PathBuf>,
}

impl Options {
    /// Returns the two meshes: those given, or ours.
    pub(crate) fn pair(&self) -> [PathBuf; 2] {
        let ours = |name: &str| {
            PathBuf::from(env!("CARGO_MANIFEST_DIR"))
                .join("examples/meshes")
                .join(name)
        };
        match self.meshes.as_slice() {
            [a, b] => [a.clone(), b.clone()],
            _ => [ours("gem.obj"), ours("nut.stl")],
        }
    }
}
