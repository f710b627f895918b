//! Small symmetric linear systems, for Newton's method in up to four variables.

use crate::base::tolerance::PIVOT;

/// The variables of a [`newton_jump`](super::newton_jump): `x`, `y` of A, then `x`, `y` of B.
pub(super) type Variables = [f64; 4];

/// Symmetric system in some of four variables: the lower half of the matrix, and the right side.
#[derive(Clone, Copy, Default)]
pub(super) struct System {
    /// The variables of the rows.
    pub(super) variables: [usize; 4],
    pub(super) len: usize,
    rows: [[f64; 4]; 4],
    right: Variables,
}

impl System {
    /// Adds a row of the lower half of the matrix, for the next variable.
    pub(super) fn push(&mut self, variable: usize, row: [f64; 4], right: f64) {
        let n = self.len;
        (self.variables[n], self.rows[n], self.right[n]) = (variable, row, right);
        self.len += 1;
    }

    /// Solves by Cholesky's method, with zero for the absent variables; `None` if the matrix is not
    /// positive definite.
    pub(super) fn solve(mut self) -> Option<Variables> {
        let (n, h, g) = (self.len, &mut self.rows, &mut self.right);
        for i in 0..n {
            let diagonal = h[i][i];
            for j in 0..i {
                // So far h[i][j] is the entry times the pivot of j.
                let factor = h[i][j] / h[j][j];
                for k in j + 1..i {
                    h[i][k] -= factor * h[k][j];
                }
                h[i][i] -= factor * h[i][j];
                g[i] -= factor * g[j];
            }
            if !(h[i][i] > PIVOT * diagonal) {
                return None;
            }
        }
        let mut x = [0.0; 4];
        for i in (0..n).rev() {
            for k in i + 1..n {
                g[i] -= h[k][i] * g[k];
            }
            g[i] /= h[i][i];
            x[self.variables[i]] = g[i];
        }
        Some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solver_solves() {
        let full = [
            [4.0, 1.0, 0.5, -1.0],
            [1.0, 3.0, 0.25, 0.5],
            [0.5, 0.25, 2.0, 0.125],
            [-1.0, 0.5, 0.125, 5.0],
        ];
        let x: Variables = [1.0, -2.0, 3.0, 0.5];
        for variables in [&[0, 1, 2, 3][..], &[0, 2], &[1, 2, 3], &[3], &[]] {
            let mut system = System::default();
            for &i in variables {
                let mut row = [0.0; 4];
                variables
                    .iter()
                    .zip(&mut row)
                    .filter(|(j, _)| **j <= i)
                    .for_each(|(&j, r)| *r = full[i][j]);
                system.push(i, row, variables.iter().map(|&j| full[i][j] * x[j]).sum());
            }
            let solved = system.solve().expect("positive");
            for k in 0..4 {
                let truth = if variables.contains(&k) { x[k] } else { 0.0 };
                assert!((solved[k] - truth).abs() < 1e-14, "{solved:?}");
            }
        }
        let mut bad = System::default();
        bad.push(2, [-1.0, 0.0, 0.0, 0.0], 1.0);
        assert_eq!(bad.solve(), None);
    }
}
