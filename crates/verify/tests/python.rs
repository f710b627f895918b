//! Promise: the checker in Python gives the same answer. Skipped without `python3`.

mod support;

use support::python::{code, codes};
use support::*;

/// A point turns past another one, so near that polynomials of degree 4 prove it, and those of
/// degree 5 do not.
fn proven_by_degree_4() -> String {
    let [zero, spin] = [[0.0; 3], [0.0, 0.0, 1.0]].map(|v| hexes(&v));
    let point = hexes(&[f64::cos(1.57), f64::sin(1.57), 0.0]);
    let [rest, start] = [0.0, 0.842].map(|x| hexes(&[x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
    sealed(&[
        "{\"receipt\":1,\"claim\":\"apart\",\"from\":\"0x0p0\",\"until\":\"0x1p0\",\"margin\":\"0x0p0\"}".into(),
        format!("{{\"body\":0,\"name\":\"wall\",\"points\":[{zero}],\"at\":{rest}}}"),
        format!(
            "{{\"body\":1,\"name\":\"rod\",\"points\":[{point}],\"at\":{start},\"steady\":{{\"pivot\":{zero},\
             \"linear\":{zero},\"angular\":{spin},\"push\":{zero}}}}}"
        ),
        "{\"plane\":[0,1],\"normal\":[\"0x1p0\",\"0x0p0\",\"0x0p0\"]}".into(),
    ])
}

#[test]
fn both_checkers_agree() {
    let mut rng = Rng(31);
    let mut cases = vec![(proven_by_degree_4(), None)];
    assert_eq!(code(&cases[0].0, None), 0);
    for k in 0..50 {
        let receipt = match k % 8 {
            0 => overlap(&mut rng),
            1 | 2 => above(&mut rng),
            3 => hit(&mut rng),
            4 => arm(&mut rng, 0.01, 2, 1),
            5 => arm(&mut rng, 0.0, 1, 3),
            _ => cast(&mut rng, 0.01),
        };
        cases.push((receipt.text(), None));
        // One bit of a number, sealed again.
        let mut changed = receipt.clone();
        let mut all = changed.numbers();
        let count = all.len();
        let x = &mut all[rng.below(count)].1;
        **x = f64::from_bits(x.to_bits() ^ 1 << rng.below(62));
        if x.is_finite() {
            cases.push((changed.text(), None));
        }
        // One byte.
        let mut bytes = receipt.text().into_bytes();
        let at = rng.below(bytes.len());
        bytes[at] = b"0123456789abcdef{}[]\",:\n x"[rng.below(26)];
        cases.push((String::from_utf8(bytes).unwrap(), None));
        if k % 8 == 4 {
            let mut other = receipt.clone();
            let Move::Rest(pose) = &mut other.bodies[4].motion else {
                unreachable!()
            };
            pose[1] += rng.range(-0.4, 0.4);
            cases.push((receipt.text(), Some(other.text())));
        }
    }
    let Some(found) = codes(&cases) else { return };
    let mut counts = [0; 4];
    for ((receipt, other), code_of_python) in cases.iter().zip(found) {
        assert_eq!(code(receipt, other.as_deref()), code_of_python, "{receipt}");
        counts[code_of_python as usize] += 1;
    }
    println!("{} hold, {} do not, {} cannot be read", counts[0], counts[1], counts[3]);
    assert!(counts[0] > 40 && counts[1] > 10 && counts[3] > 10, "{counts:?}");
}
