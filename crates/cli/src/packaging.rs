//! The hidden command `packaging`: manual pages and completions of shells, for packagers of the tool.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use clap_complete::Shell;

use crate::end::{End, ToolError};

#[derive(Args)]
pub(crate) struct PackagingOptions {
    /// Folder to write into: `man1` gets a page for each command, `completions` a file for each shell
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

pub(crate) fn run(options: &PackagingOptions, mut tool: clap::Command) -> Result<End, ToolError> {
    let folder = |name: &str| {
        let file = options.folder.join(name);
        let made = std::fs::create_dir_all(&file);
        made.map(|()| file.clone()).map_err(|reason| unwritten(&file, reason))
    };
    let pages = folder("man1")?;
    clap_mangen::generate_to(tool.clone(), &pages).map_err(|reason| unwritten(&pages, reason))?;
    let completions = folder("completions")?;
    for shell in Shell::value_variants() {
        let written = clap_complete::generate_to(*shell, &mut tool, "lin-canny", &completions);
        written.map_err(|reason| unwritten(&completions, reason))?;
    }
    Ok(End::Free)
}

fn unwritten(file: &Path, reason: std::io::Error) -> ToolError {
    let file = file.to_path_buf();
    ToolError::Write { file, reason }
}
