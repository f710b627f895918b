//! The frame of an example with options.

use std::fmt::Display;
use std::process::ExitCode;

/// Runs with the options of the command line: `parsed` is those, nothing where help is asked for, or what is wrong with them.
/// Success, failure, or 2 for a wrong call.
pub fn main<O, W: Display, T: Display>(
    name: &str,
    usage: &str,
    parsed: Result<Option<O>, W>,
    run: impl FnOnce(&O) -> Result<(), T>,
) -> ExitCode {
    match parsed {
        Ok(Some(options)) => match run(&options) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => {
                eprintln!("{name}: {why}");
                ExitCode::FAILURE
            }
        },
        Ok(None) => {
            println!("{usage}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("{name}: {why}\n\n{usage}");
            ExitCode::from(2)
        }
    }
}
