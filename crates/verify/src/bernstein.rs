//! The least and the greatest value of a polynomial on [0, 1], by its Bernstein coefficients.
//!
//! A polynomial of degree D on [0, 1] lies between the least and the greatest of its Bernstein
//! coefficients b_k = sum over j <= k of C(k, j) / C(D, j) c_j. Here they are multiplied by W, the
//! least common multiple of the C(D, j), to stay integers.

use crate::int::Int;
use crate::taylor::Taylor;

/// Binomials.
pub(crate) fn choose(n: usize, k: usize) -> i32 {
    (0..k).fold(1, |c, j| c * (n - j) as i32 / (j + 1) as i32)
}

impl<I: Int> Taylor<I> {
    /// Returns the Bernstein coefficients, times W.
    pub(crate) fn net(&self) -> Option<Vec<I>> {
        let term = |k, j, c: &I| c.mul(&I::small(choose(k, j) * (I::W / choose(I::D, j))));
        let sum = |k| {
            self.c
                .iter()
                .enumerate()
                .take(k + 1)
                .try_fold(I::small(0), |s, (j, c)| s.add(&term(k, j, c)?))
        };
        (0..=I::D).map(sum).collect()
    }
}

/// No value of a polynomial is less: the least Bernstein coefficient of its eighths.
pub(crate) fn least<I: Int>(net: Vec<I>) -> Option<I> {
    let mut nets = vec![net];
    for _ in 0..3 {
        let mut halves = Vec::new();
        for mut net in nets {
            let (mut first, n) = (vec![net[0].clone()], net.len());
            for k in 1..n {
                for j in 0..n - k {
                    net[j] = net[j].add(&net[j + 1])?.half();
                }
                first.push(net[0].clone());
            }
            halves.extend([first, net]);
        }
        nets = halves;
    }
    nets.into_iter().flatten().min()
}
