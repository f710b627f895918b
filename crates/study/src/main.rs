//! The tool `lin-canny-study`.
#![forbid(unsafe_code)]
// They panic if the reader of a pipe has gone: see `tool::text::put`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod tool;

fn main() -> std::process::ExitCode {
    tool::main()
}
