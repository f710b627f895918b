//! Writes a recording as a page: one HTML file for any browser with WebGL 2.
//!
//! ```text
//! cargo run --release -p lin-canny-record --example page -- FILE.jsonl --page FILE.html
//! ```

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lin_canny_record::{PageOptions, Recording, page};

/// Write a recording as a page: one HTML file for any browser with WebGL 2
#[derive(Parser)]
struct Options {
    /// The recording
    file: PathBuf,
    /// Output page
    #[arg(long, value_name = "FILE.html", default_value = "target/recording.html", value_parser = truth::command::file("html"))]
    page: PathBuf,
    /// The frame that the page shows first
    #[arg(long, default_value_t = 0)]
    frame: usize,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), String> {
    let file = options.file.display();
    let recording = Recording::open(&options.file).map_err(|e| format!("{file}: {e}"))?;
    let frame = options.frame;
    let text = page(&recording, &PageOptions::default().frame(frame));
    truth::command::write(&options.page, &text)?;
    println!("{}", options.page.display());
    Ok(())
}
