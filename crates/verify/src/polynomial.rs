//! Polynomials in time with exact coefficients.

use dashu_ratio::RBig;

/// Returns the coefficients of p(start + span x) in x.
pub(crate) fn moved(p: &[RBig], start: &RBig, span: &RBig) -> Vec<RBig> {
    let mut all: Vec<RBig> = p.to_vec();
    // Horner, as often as there are coefficients: p(start + y) in y.
    for first in 0..all.len() {
        for k in (first..all.len().saturating_sub(1)).rev() {
            let next = &all[k + 1] * start;
            all[k] += next;
        }
    }
    let mut factor = RBig::ONE;
    for x in &mut all {
        *x *= &factor;
        factor *= span;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_moved() {
        let p = [3, -2, 5, 1].map(RBig::from);
        // p(2 + 3 x)
        assert_eq!(
            moved(&p, &RBig::from(2), &RBig::from(3)),
            [27, 90, 99, 27].map(RBig::from)
        );
    }
}
