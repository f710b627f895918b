//! What the command line asks for.

use std::path::PathBuf;

use lab::command::Arguments;

pub(crate) const USAGE: &str = "\
usage: track [A.obj|A.stl B.obj|B.stl] [--frames N] [--out FILE.svg] [--record FILE.jsonl]
       track A.obj|A.stl B.obj|B.stl --poses FILE --csv FILE

Two meshes, taken as their convex hulls, tumble past each other. Prints the closest features, the distance with its
bounds and the steps of each frame, and draws distance and steps over time.

  A B           meshes in OBJ or STL files (default: examples/meshes/gem.obj examples/meshes/nut.stl)
  --frames N    frames of the motion, 2 to 1000000 (default: 720)
  --out FILE    where to draw (default: target/track.svg)
  --record FILE where to write the frames, 2,000 of them at most, for the viewer (folder viewer/)

With --poses the meshes are taken as they are, convex or not, and nothing is drawn:

  --poses FILE  poses of B in A's frame, `x y z qx qy qz qw`, one a line
  --csv FILE    where to write `distance,lower,upper,ax,ay,az,bx,by,bz` for each (A's frame)";

/// Frames are kept in memory.
const MOST_FRAMES: usize = 1_000_000;

pub(crate) struct Options {
    pub(crate) meshes: [PathBuf; 2],
    pub(crate) frames: usize,
    pub(crate) out: PathBuf,
    /// Where to record the frames.
    pub(crate) record: Option<PathBuf>,
    /// Poses to answer, and where to write the answers.
    pub(crate) given: Option<(PathBuf, PathBuf)>,
}

/// The options; `None` if help is asked for.
pub(crate) fn parse(arguments: Option<Arguments>) -> Result<Option<Options>, String> {
    let Some(mut arguments) = arguments else {
        return Ok(None);
    };
    let frames = arguments.number("--frames", 2, 720)?;
    if frames > MOST_FRAMES {
        return Err(format!("--frames must be at most {MOST_FRAMES}, not {frames}"));
    }
    let out = arguments.value("--out")?.unwrap_or("target/track.svg".into()).into();
    let record = arguments.value("--record")?.map(PathBuf::from);
    let given = match (arguments.value("--poses")?, arguments.value("--csv")?) {
        (Some(poses), Some(csv)) => Some((poses.into(), csv.into())),
        (None, None) => None,
        _ => return Err("--poses and --csv belong together".into()),
    };
    let ours = |name: &str| {
        PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join("examples/meshes")
            .join(name)
    };
    let meshes: Vec<PathBuf> = arguments.files(2)?.into_iter().map(PathBuf::from).collect();
    let meshes = match <[PathBuf; 2]>::try_from(meshes) {
        Ok(two) => two,
        Err(none) if none.is_empty() => [ours("gem.obj"), ours("nut.stl")],
        Err(_) => return Err("two meshes are needed, or none; one is given".into()),
    };
    Ok(Some(Options {
        meshes,
        frames,
        out,
        record,
        given,
    }))
}
