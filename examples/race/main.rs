//! Races against other libraries on the same motions.
//!
//! ```text
//! cargo run --release --example race -- pairs [--csv FILE] [--quick] [--only SCENE]
//! cargo run --release --example race -- contact [--csv FILE] [--quick] [--only SCENE]
//! cargo run --release --example race -- boxes [--csv FILE] [--scene NAME] [--upto N]
//! cargo run --release --example race -- scene [--csv FILE] [--only SCENE] [--upto N]
//! ```

mod boxes;
mod common;
mod contact;
mod hulls;
mod pairs;
mod scene;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("pairs") => pairs::run(&arguments[1..]),
        Some("contact") => contact::run(&arguments[1..]),
        Some("boxes") => boxes::run(&arguments[1..]),
        Some("scene") => scene::run(&arguments[1..]),
        _ => eprintln!("usage: race pairs|contact|boxes|scene [--csv FILE] (see the head of examples/race/main.rs)"),
    }
}
