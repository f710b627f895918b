//! The tool `lin-canny-study`.
#![forbid(unsafe_code)]
// They panic if the reader of a pipe has gone: see `lin_canny_cli::output::put`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use(say, warn)]
extern crate lin_canny_cli;

mod tool;

fn main() -> std::process::ExitCode {
    tool::main()
}
