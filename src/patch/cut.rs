//! The part of a patch over a box of parameters, by de Casteljau's algorithm at both ends.

use nalgebra::Vector3;

use super::bezier::NET;
use super::net::Patch;
use super::tree::{Net, Node};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{NET as NET_ERROR, NET_CUT};

/// The part of a patch over a box of parameters.
pub(super) struct Cut {
    pub(super) node: Node,
    /// Layout as `NetTree::numbers`.
    numbers: [f64; 7 * NET],
}

impl Cut {
    /// Returns the part over a box of some size.
    pub(super) fn new(patch: &Patch, [u, v]: [[f64; 2]; 2]) -> Self {
        let [p, q] = patch.degrees;
        let count = patch.net.len();
        let mut numbers = [0.0; 7 * NET];
        let planes = if patch.is_rational { 3..7 } else { 0..3 };
        for (k, plane) in planes.clone().enumerate() {
            let of = &mut numbers[plane * count..][..count];
            of.iter_mut().zip(&patch.net).for_each(|(x, h)| *x = h[k]);
            keep(of, [p, q + 1, q + 1], u);
            for row in of.chunks_mut(q + 1) {
                keep(row, [q, 1, 1], v);
            }
        }
        if patch.is_rational {
            let (points, homogeneous) = numbers.split_at_mut(3 * count);
            let (three, weights) = homogeneous.split_at(3 * count);
            for k in 0..3 * count {
                points[k] = three[k] / weights[k % count];
            }
        }
        let error = patch.reach * (NET_ERROR + patch.noise + NET_CUT * (p + q) as f64);
        let mut cut = Self {
            node: Node::part(patch, error),
            numbers,
        };
        (cut.node.centre, cut.node.radius) = cut.ball();
        cut
    }

    pub(super) fn net(&self) -> Net<'_> {
        Net::of(&self.numbers, self.node.count as usize, self.node.is_rational)
    }

    /// Returns a ball that reaches as far as the part, for what is tried alone.
    fn ball(&self) -> (Vector3<f64>, f64) {
        let net = self.net();
        let count = self.node.count as usize;
        let centre = (net.point(0) + net.point(count - 1)) * 0.5;
        let far = |k: usize| (net.point(k) - centre).norm_squared();
        let most = (0..count).map(far).fold(0.0, f64::larger);
        (centre, sqrt(most))
    }
}

/// Cuts a curve, or rows of `width` numbers `step` apart as one, down to an interval of its
/// parameter.
fn keep(c: &mut [f64], [degree, step, width]: [usize; 3], [low, high]: [f64; 2]) {
    if high < 1.0 {
        for level in 1..=degree {
            for k in (level * step..degree * step + width).rev() {
                c[k] = (1.0 - high) * c[k - step] + high * c[k];
            }
        }
    }
    if low > 0.0 {
        let t = low / high;
        for level in 1..=degree {
            for k in 0..(degree - level) * step + width {
                c[k] = (1.0 - t) * c[k] + t * c[k + step];
            }
        }
    }
}
