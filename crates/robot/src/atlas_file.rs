//! Files of free boxes, as JSON.

use std::path::Path;

use lin_canny_plan::Atlas;

use crate::error::{FileError, FileErrorKind};

/// Writes free boxes to a file. Numbers are exact.
///
/// ```
/// use lin_canny_robot::plan::AtlasOptions;
/// use lin_canny_robot::{RobotFiles, load_atlas, save_atlas};
///
/// let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
/// let mut files = RobotFiles::new(format!("{examples}/gripper.urdf"));
/// files.cell = Some(format!("{examples}/cell.json").into());
/// let mut checker = files.load()?.1.checker()?;
/// let atlas = checker.free_boxes(&AtlasOptions::default().boxes(100))?;
/// # let path = std::env::temp_dir().join(format!("lin-canny-atlas-{}.json", std::process::id()));
/// save_atlas(&atlas, &path)?;
/// assert!(load_atlas(&path)? == atlas);
/// checker.set_atlas(load_atlas(&path)?)?;
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error if the file cannot be written.
pub fn save_atlas(atlas: &Atlas, path: impl AsRef<Path>) -> Result<(), FileError> {
    let path = path.as_ref();
    let of = |error| FileError::new(path, None, "", FileErrorKind::Write(error));
    let text = serde_json::to_string(atlas).map_err(|error| of(error.into()))?;
    std::fs::write(path, text).map_err(of)
}

/// Reads free boxes from a file.
///
/// [`Checker::set_atlas`](lin_canny_plan::Checker::set_atlas) checks whether they belong to a robot
/// and its cell.
///
/// # Errors
/// Returns an error if the file cannot be read or is damaged. It names the place.
pub fn load_atlas(path: impl AsRef<Path>) -> Result<Atlas, FileError> {
    let path = path.as_ref();
    let of = |error: serde_json::Error| FileError::new(path, None, "", FileErrorKind::Malformed(error.to_string()));
    serde_json::from_str(&FileError::read(path)?).map_err(of)
}
