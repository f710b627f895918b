//! Changes of a receipt that a checker must see.

use super::*;

pub(crate) fn make(rng: &mut Rng, k: usize) -> Receipt {
    match k % 6 {
        0 => overlap(rng),
        1 => above(rng),
        2 => hit(rng),
        3 => arm(rng, 0.01, 1, 1),
        4 => arm(rng, 0.01, 2, 2),
        _ => cast(rng, 0.01),
    }
}

pub(crate) fn time_of(line: &mut Line) -> Option<&mut [f64; 2]> {
    match line {
        Line::Plane { time, .. } | Line::Balls { time, .. } => Some(time),
        _ => None,
    }
}

/// Changes a receipt; false if this kind of change does not fit it.
pub(crate) fn change(kind: &str, receipt: &mut Receipt, rng: &mut Rng) -> bool {
    let timed: Vec<usize> = (0..receipt.evidence.len())
        .filter(|k| time_of(&mut receipt.evidence[*k]).is_some())
        .collect();
    match kind {
        "one bit of a number" => {
            let mut all = receipt.numbers();
            let count = all.len();
            let x = &mut all[rng.below(count)].1;
            let old = **x;
            **x = f64::from_bits(x.to_bits() ^ 1 << rng.below(64));
            // A zero has no sign in a receipt.
            x.is_finite() && **x != old
        }
        "a certificate left out" => {
            let k = rng.below(receipt.evidence.len());
            receipt.evidence.remove(k);
            true
        }
        "the end one unit earlier" | "the start one unit later" | "an interval halved" => {
            if timed.is_empty() {
                return false;
            }
            let k = timed[rng.below(timed.len())];
            let time = time_of(&mut receipt.evidence[k]).unwrap();
            match kind {
                "the end one unit earlier" => time[1] = f64::from_bits(time[1].to_bits() - 1),
                "the start one unit later" => time[0] = f64::from_bits(time[0].to_bits() + 1),
                _ => time[1] = 0.5 * (time[0] + time[1]),
            }
            true
        }
        "two certificates exchanged" => {
            let (i, j) = (rng.below(receipt.evidence.len()), rng.below(receipt.evidence.len()));
            receipt.evidence.swap(i, j);
            i != j
        }
        "the points of two bodies exchanged" => {
            let last = receipt.bodies.len() - 1;
            let (a, b) = (receipt.bodies[0].points.clone(), receipt.bodies[last].points.clone());
            receipt.bodies[0].points = b;
            receipt.bodies[last].points = a;
            true
        }
        "a pair unsaid" => receipt.ignored.pop().is_some(),
        "a larger margin" => match &mut receipt.apart {
            Some([_, _, margin]) => {
                *margin += rng.range(0.0, 0.5);
                true
            }
            None => false,
        },
        "an index" => {
            for line in &mut receipt.evidence {
                if let Line::Meet { points, .. } = line {
                    points[rng.below(4)][rng.below(2)] = rng.below(8);
                    return true;
                }
            }
            false
        }
        _ => unreachable!("{kind}"),
    }
}

pub(crate) const CHANGES: [&str; 10] = [
    "one bit of a number",
    "a certificate left out",
    "the end one unit earlier",
    "the start one unit later",
    "an interval halved",
    "two certificates exchanged",
    "the points of two bodies exchanged",
    "a pair unsaid",
    "a larger margin",
    "an index",
];
