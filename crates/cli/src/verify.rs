//! The command `verify`: checks a receipt in exact arithmetic.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use clap::Args;
use lin_canny_verify::{verify, verify_on};

use crate::end::{End, ToolError};
use crate::receipt::refused;

#[derive(Args)]
pub(crate) struct VerifyOptions {
    /// Receipt, as `certify --receipt` writes it
    #[arg(value_name = "RECEIPT")]
    receipt: PathBuf,
    /// Receipt or scene (`certify --scene`) with bodies and motion after a change, on which the
    /// proof is checked
    #[arg(long, value_name = "FILE")]
    on: Option<PathBuf>,
    /// Name every pair, not only their number for each reason
    #[arg(long)]
    all: bool,
}

pub(crate) fn run(options: &VerifyOptions) -> Result<End, ToolError> {
    let open = |file: &Path| {
        let opened = File::open(file).map(BufReader::new);
        opened.map_err(|error| refused(file, error))
    };
    let receipt = open(&options.receipt)?;
    let found = match &options.on {
        Some(other) => verify_on(receipt, open(other)?),
        None => verify(receipt),
    };
    let verdict = found.map_err(|error| refused(&options.receipt, error))?;
    let text = match options.all {
        true => format!("{verdict:#}"),
        false => verdict.to_string(),
    };
    say!("{}", text.trim_end());
    Ok(if verdict.holds() { End::Free } else { End::Blocked })
}
