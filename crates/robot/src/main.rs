//! Computes clearances, proven motions and paths of a robot: see `lin-canny-robot --help`.
#![forbid(unsafe_code)]

mod tool;

fn main() -> std::process::ExitCode {
    tool::main()
}
