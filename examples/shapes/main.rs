//! Shapes of every kind: `shapes` prints a table of pairs and draws them in `images/shapes.svg`, `shapes FILE` answers the pairs
//! of a file.
//!
//! A line of a file is `KIND params; KIND params; x y z qx qy qz qw`, the pose that of B in A's frame:
//! `ball r`, `capsule half_length r` (along z), `box hx hy hz`, `hull x y z x y z ...`, `cylinder half_height r`,
//! `cone half_height r` (apex up z), `ellipsoid a b c`, `superquadric a b c e1 e2`, any with `+ r` for rounding. Empty
//! lines and those that begin with `#` are skipped. The answer is `distance lower upper`, 17 digits each, line for line.

mod draw;

use lab::curved::parse;
use lin_canny::PairTracker;

fn main() -> Result<(), String> {
    match std::env::args().nth(1) {
        Some(file) => answer(&file),
        None => draw::all(),
    }
}

fn answer(file: &str) -> Result<(), String> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{file}: {e}"))?;
    for (k, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let pair = parse::pair(line).map_err(|e| format!("{file}:{}: {e}", k + 1))?;
        let o = PairTracker::new().closest(&pair.a, &pair.b, &pair.pose);
        println!("{:.16e} {:.16e} {:.16e}", o.distance, o.lower, o.upper);
    }
    Ok(())
}
