//! Races against other libraries on the same motions.
//!
//! ```text
//! cargo run --release --example race -- boxes [--csv FILE]
//! ```

mod boxes;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("boxes") => boxes::run(&arguments[1..]),
        _ => eprintln!("usage: race boxes [--csv FILE] [--scene NAME] [--upto N]"),
    }
}
