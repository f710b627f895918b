//! What the command line asks for.

use std::path::PathBuf;

pub(crate) const USAGE: &str = "\
usage: track [A.obj|A.stl B.obj|B.stl] [--frames N] [--out FILE.svg]
       track A.obj|A.stl B.obj|B.stl --poses FILE --csv FILE

Two meshes, taken as their convex hulls, tumble past each other. Prints the closest features, the distance with its
bounds and the steps of each frame, and draws distance and steps over time.

  A B           meshes in OBJ or STL files (default: examples/meshes/gem.obj examples/meshes/nut.stl)
  --frames N    frames of the motion, 2 to 1000000 (default: 720)
  --out FILE    where to draw (default: target/track.svg)

With --poses the meshes are taken as they are, convex or not, and nothing is drawn:

  --poses FILE  poses of B in A's frame, `x y z qx qy qz qw`, one a line
  --csv FILE    where to write `distance,lower,upper,ax,ay,az,bx,by,bz` for each (A's frame)";

/// Frames are kept in memory.
const MOST_FRAMES: usize = 1_000_000;

pub(crate) struct Options {
    pub(crate) meshes: [PathBuf; 2],
    pub(crate) frames: usize,
    pub(crate) out: PathBuf,
    /// Poses to answer, and where to write the answers.
    pub(crate) given: Option<(PathBuf, PathBuf)>,
}

/// The options, or what to tell the user: `Ok(None)` when asked for help.
pub(crate) fn parse(mut words: impl Iterator<Item = String>) -> Result<Option<Options>, String> {
    let (mut meshes, mut frames, mut out) = (vec![], 720, PathBuf::from("target/track.svg"));
    let (mut poses, mut csv) = (None, None);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "-h" | "--help" => return Ok(None),
            "--frames" => frames = frame_count(&value()?)?,
            "--out" => out = value()?.into(),
            "--poses" => poses = Some(value()?.into()),
            "--csv" => csv = Some(value()?.into()),
            _ if word.starts_with("--") => return Err(format!("{word} is no option")),
            _ => meshes.push(PathBuf::from(word)),
        }
    }
    let ours = |name: &str| {
        PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join("examples/meshes")
            .join(name)
    };
    let meshes = match <[PathBuf; 2]>::try_from(meshes) {
        Ok(two) => two,
        Err(none) if none.is_empty() => [ours("gem.obj"), ours("nut.stl")],
        Err(other) => return Err(format!("two meshes are needed, or none; {} given", other.len())),
    };
    let given = match (poses, csv) {
        (Some(poses), Some(csv)) => Some((poses, csv)),
        (None, None) => None,
        _ => return Err("--poses and --csv belong together".into()),
    };
    Ok(Some(Options {
        meshes,
        frames,
        out,
        given,
    }))
}

fn frame_count(word: &str) -> Result<usize, String> {
    let count = word.parse().ok().filter(|n| (2..=MOST_FRAMES).contains(n));
    count.ok_or(format!("--frames must be between 2 and {MOST_FRAMES}, not {word}"))
}
