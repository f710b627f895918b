//! Finds the files that a URDF names.

use std::path::{Path, PathBuf};

use crate::error::FileErrorKind;

/// Folders in which packages are searched.
///
/// `package://NAME/REST` is `DIR/NAME/REST` for the first folder DIR that has this file, or
/// `DIR/REST` if the folder itself has the name NAME. The folders above the URDF are searched last.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Packages {
    folders: Vec<PathBuf>,
}

impl Packages {
    /// Returns packages in these folders only.
    #[must_use]
    pub fn new(folders: impl IntoIterator<Item = impl Into<PathBuf>>) -> Self {
        let folders = folders.into_iter().map(Into::into).collect();
        Self { folders }
    }

    /// Appends the folders of the environment variable `ROS_PACKAGE_PATH`.
    #[must_use]
    pub fn with_environment(mut self) -> Self {
        if let Some(path) = std::env::var_os("ROS_PACKAGE_PATH") {
            self.folders
                .extend(std::env::split_paths(&path).filter(|p| !p.as_os_str().is_empty()));
        }
        self
    }

    /// Returns the file of a name in a URDF that is in `folder`.
    pub(crate) fn find(&self, name: &str, folder: &Path) -> Result<PathBuf, FileErrorKind> {
        let missing = |what: String| FileErrorKind::Missing(what);
        let Some(inside) = name.strip_prefix("package://") else {
            let file = folder.join(name.strip_prefix("file://").unwrap_or(name));
            let is_there = file.is_file();
            return if is_there {
                Ok(file)
            } else {
                Err(missing(format!("mesh {}", file.display())))
            };
        };
        let inside = inside.trim_start_matches('/');
        let (package, rest) = inside.split_once('/').unwrap_or((inside, ""));
        let places = self.folders.iter().map(PathBuf::as_path).chain(folder.ancestors());
        let candidates = places.flat_map(|place| {
            let is_package = place.file_name().is_some_and(|n| n == package);
            [Some(place.join(inside)), is_package.then(|| place.join(rest))]
        });
        candidates.flatten().find(|file| file.is_file()).ok_or_else(|| {
            let folders: Vec<_> = self.folders.iter().map(|f| f.display().to_string()).collect();
            missing(format!(
                "mesh {name:?} (looked for in {}the folders above the URDF)",
                folders.iter().map(|f| format!("{f}, ")).collect::<String>()
            ))
        })
    }
}
