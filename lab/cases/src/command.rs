//! Entry point of a program with options: `clap` parses them, and every program of the repository
//! exits alike.

use std::fmt::{Arguments, Display};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use clap::builder::RangedU64ValueParser;

/// Runs a program with the options of its command line, and returns its exit code.
///
/// The code is 0 on success, and 1 if `run` fails; its error is printed to standard error. `clap`
/// answers `--help` and exits with 2 for invalid options. If the reader of the output has gone, as in
/// `... | head`, the next `println!` ends the program with 0; [`say!`](crate::say) goes on.
pub fn main<O: Parser, T: Display>(run: impl FnOnce(&O) -> Result<(), T>) -> ExitCode {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let why = panic.payload().downcast_ref::<String>();
        if why.is_some_and(|why| why.starts_with("failed printing to stdout: Broken pipe")) {
            std::process::exit(0);
        }
        report(panic);
    }));
    match run(&O::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Prints a line to standard output, for a program that still has files to write: if the reader has
/// gone, the line is dropped.
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => {
        $crate::command::print(format_args!($($words)*))
    };
}

/// Prints the line of [`say!`](crate::say).
///
/// # Panics
/// If the line cannot be written for another reason.
pub fn print(line: Arguments<'_>) {
    match writeln!(std::io::stdout(), "{line}") {
        Err(why) if why.kind() != ErrorKind::BrokenPipe => panic!("failed printing to stdout: {why}"),
        _ => {}
    }
}

/// Rejects any options of a program without options; answers `--help` with `about`.
pub fn no_options(about: &'static str) {
    clap::Command::new("").about(about).get_matches();
}

/// Returns the parser of a whole number that is at least `least`.
pub fn count(least: u64) -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(least..=1_000_000_000)
}

/// Returns the parser of a finite number that is at least `least`.
pub fn number(least: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |word| {
        let number = word.parse().ok().filter(|x: &f64| *x >= least && x.is_finite());
        number.ok_or(format!("not a number of at least {least}"))
    }
}

/// Parses a duration in seconds.
///
/// # Errors
/// Returns an error if the word is not a number, or not a valid duration.
pub fn seconds(word: &str) -> Result<Duration, String> {
    let number = number(0.0)(word)?;
    Duration::try_from_secs_f64(number).map_err(|e| e.to_string())
}

/// Returns the parser of the name of an output file.
///
/// An existing file is accepted only if its name ends in `.extension`, so that a user's mistake
/// does not overwrite a mesh or a program.
pub fn file(extension: &'static str) -> impl Fn(&str) -> Result<PathBuf, String> + Clone + Send + Sync + 'static {
    move |word| {
        let path = PathBuf::from(word);
        let fits = path.extension().is_some_and(|e| e == extension) || !path.exists();
        fits.then_some(path)
            .ok_or(format!("is there already and does not end in .{extension}"))
    }
}

/// Rejects a path that cannot be written, before long work, without changing an existing file.
/// Creates its folder, but only below `target`.
///
/// # Errors
/// Returns an error that names the folder or the file that cannot be written.
pub fn writable(path: &Path) -> Result<(), String> {
    let named = |e: std::io::Error| format!("{}: {e}", path.display());
    if let Some(folder) = path.parent().filter(|f| f.starts_with("target")) {
        std::fs::create_dir_all(folder).map_err(named)?;
    }
    let is_new = !path.exists();
    std::fs::OpenOptions::new()
        .append(true)
        .create(true)
        .open(path)
        .map_err(named)?;
    if is_new {
        std::fs::remove_file(path).map_err(named)?;
    }
    Ok(())
}

/// Writes `text` to `path`, as [`writable`] allows.
///
/// # Errors
/// Returns an error that names the folder or the file that cannot be written.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    writable(path)?;
    std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// Returns the text of a file.
///
/// # Errors
/// Returns an error that names the file if it cannot be read.
pub fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Parser, Debug)]
    struct Options {
        #[arg(long, default_value_t = 7, value_parser = count(1))]
        frames: usize,
        #[arg(long, default_value_t = 0.5, value_parser = number(0.0))]
        width: f64,
        #[arg(long, default_value = "target/out.svg", value_parser = file("svg"))]
        out: PathBuf,
    }

    fn of(line: &str) -> Result<Options, String> {
        Options::try_parse_from(line.split(' ')).map_err(|e| e.to_string())
    }

    #[test]
    fn values_and_defaults_are_read() {
        let o = of("program --frames 20 --out a/b.svg").expect("options in order");
        assert_eq!((o.frames, o.width, o.out), (20, 0.5, "a/b.svg".into()));
    }

    #[test]
    fn nonsense_is_named() {
        for (line, word) in [
            ("program --frames 0", "0"),
            ("program --frames x", "x"),
            ("program --width NaN", "NaN"),
            ("program --width inf", "inf"),
            ("program --out Cargo.toml", "Cargo.toml"),
            ("program --nonsense", "--nonsense"),
            ("program file", "file"),
        ] {
            assert!(of(line).is_err_and(|e| e.contains(word)), "{line}");
        }
    }

    #[test]
    fn no_folder_is_made_but_below_target() {
        let folder = std::env::temp_dir().join("lin-canny-no-such-folder");
        assert!(write(&folder.join("x.svg"), "").is_err());
        assert!(!folder.exists());
    }
}
