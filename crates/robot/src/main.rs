//! Clearances, proven motions and paths of a robot from its URDF: see `lin-canny-robot --help`.
#![forbid(unsafe_code)]

mod tool;

fn main() -> std::process::ExitCode {
    tool::main()
}
