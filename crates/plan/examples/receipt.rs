//! Writes the proof that an arm moves a part freely from bin to bin as a file that anybody can
//! check, and checks it.
//!
//! `cargo run --release -p lin-canny-plan --example receipt -- --out FILE.jsonl`

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lin_canny_plan::receipt::Receipt;
use lin_canny_plan::{CertifyOptions, Checker, JointMotion};
use truth::arm::{self, motion};

/// Write the proof that an arm moves freely through its cell as a file, and check it
#[derive(Parser)]
struct Options {
    /// Number of straight segments of the motion
    #[arg(long, default_value_t = 20, value_parser = truth::command::count(1))]
    segments: usize,
    /// Distance that all pairs must keep, in metres
    #[arg(long, default_value_t = 0.0, value_parser = truth::command::number(0.0))]
    margin: f64,
    /// Output file
    #[arg(long, default_value = "target/receipt.jsonl", value_parser = truth::command::file("jsonl"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let (arm, mut cell) = arm::in_cell()?;
    cell.set_margin(options.margin)?;
    let mut checker = Checker::new(arm, cell)?;

    let count = options.segments;
    let rows: Vec<Vec<f64>> = (0..=count).map(|k| motion::carry(k as f64 / count as f64)).collect();
    let path = JointMotion::path(&rows)?;
    let found = checker.certify_with(&path, CertifyOptions::default().certificates(true))?;
    let receipt = match found.verdict.piece() {
        None => Receipt::certified(&checker, &path, &found)?,
        Some(piece) => {
            println!("segment {piece} is {}", checker.show(&found.verdict));
            Receipt::motion(&mut checker, &JointMotion::segment(&rows[piece], &rows[piece + 1]))?
        }
    };
    let text = receipt.to_string();
    println!("{} pieces of evidence, {} bytes", receipt.certificates(), text.len());
    truth::command::write(&options.out, &text)?;
    println!("{}", options.out.display());
    match lin_canny_verify::verify(text.as_bytes())? {
        verdict if verdict.holds() => print!("{verdict}"),
        verdict => return Err(verdict.to_string().into()),
    }
    Ok(())
}
