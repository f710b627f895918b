//! The tool `lin-canny-study`.
#![forbid(unsafe_code)]

mod tool;

fn main() -> std::process::ExitCode {
    tool::main()
}
