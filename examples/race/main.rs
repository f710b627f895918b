//! Races against other libraries on the same motions.
//!
//! ```text
//! cargo run --release --example race -- pairs [--csv FILE] [--quick]
//! ```

mod pairs;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("pairs") => pairs::run_pairs(&arguments[1..]),
        _ => eprintln!("usage: race pairs [--csv FILE] [--quick]"),
    }
}
