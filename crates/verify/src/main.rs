//! `lin-canny-verify`: judges a receipt, as `verify.py` does, with the same arguments and exit codes.

use std::ffi::OsString;
use std::fs::File;
use std::io::{BufReader, Write};
use std::process::ExitCode;

use lin_canny_verify::{Unreadable, Verdict, verify, verify_on};

const USAGE: &str = "\
usage: lin-canny-verify [--all] RECEIPT [SCENE]
Judges a receipt by exact arithmetic, on the bodies and motions of SCENE if it is given.
--all names every pair. Exit codes: 0 the receipt holds, 1 it does not, 3 it cannot be read.";

fn judge(names: &[OsString]) -> Result<Verdict, Unreadable> {
    let open = |name| File::open(name).map(BufReader::new).map_err(Unreadable::Io);
    let receipt = open(&names[0])?;
    match names.get(1) {
        Some(scene) => verify_on(receipt, open(scene)?),
        None => verify(receipt),
    }
}

fn main() -> ExitCode {
    let (flags, names): (Vec<_>, Vec<_>) = std::env::args_os()
        .skip(1)
        .partition(|argument| argument.to_str().is_some_and(|text| text.starts_with("--")));
    let has = |name: &str| flags.iter().any(|flag| flag == name);
    let (code, text) = if has("--version") {
        (
            0,
            concat!("lin-canny-verify ", env!("CARGO_PKG_VERSION"), "\n").to_owned(),
        )
    } else if has("--help") {
        (0, format!("{USAGE}\n"))
    } else if flags.iter().any(|flag| flag != "--all") || !(1..=2).contains(&names.len()) {
        (3, format!("{USAGE}\n"))
    } else {
        match judge(&names) {
            Ok(verdict) if has("--all") => (u8::from(!verdict.holds()), format!("{verdict:#}")),
            Ok(verdict) => (u8::from(!verdict.holds()), verdict.to_string()),
            Err(error) => (3, format!("{error}\n")),
        }
    };
    // A reader that has gone changes no exit code.
    let _ = std::io::stdout().write_all(text.as_bytes());
    ExitCode::from(code)
}
