//! The command line tool `lin-canny-rerun`: converts a recording to a file of rerun.
#![forbid(unsafe_code)]

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lin_canny_record::Recording;

/// Convert a recording of lin-canny (JSON lines) to a file of rerun
///
/// Exit codes: 0 done, 2 wrong arguments, 3 a file is invalid or cannot be written.
#[derive(Parser)]
#[command(name = "lin-canny-rerun", version)]
struct Arguments {
    /// Recording to convert
    #[arg(value_name = "IN.jsonl")]
    recording: PathBuf,
    /// Output file
    #[arg(value_name = "OUT.rrd")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match converted(&arguments) {
        Ok(frames) => {
            println!("{frames} frames in {}", arguments.out.display());
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("lin-canny-rerun: {reason}");
            ExitCode::from(3)
        }
    }
}

fn converted(arguments: &Arguments) -> Result<usize, String> {
    let Arguments { recording: file, out } = arguments;
    let recording = Recording::open(file).map_err(|e| format!("{}: {e}", file.display()))?;
    lin_canny_rerun::save(&recording, out).map_err(|e| format!("{}: {e}", out.display()))?;
    Ok(recording.frames.len())
}
