//! A box along given axes about points whose heights are known.

use wide::f32x4;

use super::OrientedBox;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::BOX_SKEW;

/// Three axes in single precision: by axis, and the same by coordinate.
pub(super) struct BoxAxes {
    pub(super) rows: [[f32; 3]; 3],
    columns: [f32x4; 3],
}

impl BoxAxes {
    #[inline(always)]
    pub(super) fn new(rows: [[f32; 3]; 3]) -> Self {
        let columns = [0, 1, 2].map(|k| f32x4::new([rows[0][k], rows[1][k], rows[2][k], 0.0]));
        Self { rows, columns }
    }

    /// Returns the heights of a point along the axes.
    #[inline(always)]
    pub(super) fn heights(&self, point: f32x4) -> f32x4 {
        let [x, y, z, _] = point.to_array().map(f32x4::splat);
        self.columns[0] * x + self.columns[1] * y + self.columns[2] * z
    }

    /// Returns a box that holds all points whose heights along the axes as stored are at least
    /// `low` and at most `high`, up to `slack`, the longest side first.
    ///
    /// Heights `h` about the centre are the coordinates `s` of a point, `p = sum of s_k axis_k`, up
    /// to the products of the axes: `h = G s` with the matrix G of products, which is the unit
    /// matrix up to `e = 8 UNIT_SINGLE` in every place. So `|s_k - h_k| <= e sum |s_j|`, and `sum
    /// |s_j| <= sum |h_j| / (1 - 3 e)`; `|p|^2 = s . G s <= (1 + 3 e) |s|^2`. The last factors hold
    /// the roundings of the sums of positive numbers.
    #[inline(always)]
    pub(super) fn fitted(&self, low: f32x4, high: f32x4, slack: f32) -> OrientedBox {
        let up = 1.0 + 8.0 * f32::EPSILON;
        let [p, q, r, _] = ((low + high) * f32x4::splat(0.5)).to_array();
        let rows = &self.rows;
        let centre = [0, 1, 2].map(|k| rows[0][k] * p + rows[1][k] * q + rows[2][k] * r);
        let at = self.heights(f32x4::new([centre[0], centre[1], centre[2], 0.0]));
        let reach = (high - at).fast_max(at - low) + f32x4::splat(slack);
        let [x, y, z, _] = reach.to_array();
        let skew = f32x4::splat((x + y + z) * BOX_SKEW as f32);
        let half = ((reach + skew) * f32x4::splat(up)).to_array();
        let [x, y, z, _] = half;
        let square = f64::from(x * x + y * y + z * z);
        let radius = sqrt(square) as f32 * ((1.0 + 3.0 * BOX_SKEW as f32) * up);
        let [i, j, k] = descending((high - low).to_array());
        let ([a, b, c], [p, q, r]) = ([rows[i], rows[j], rows[k]], centre);
        OrientedBox {
            rows: [
                [a[0], a[1], a[2], b[0]],
                [b[1], b[2], c[0], c[1]],
                [c[2], p, q, r],
                [half[i], half[j], half[k], radius],
            ],
        }
    }
}

/// Returns the order of the first three numbers, the greatest first.
#[inline(always)]
fn descending([a, b, c, _]: [f32; 4]) -> [usize; 3] {
    // Ranks by three comparisons: how many of the others come first.
    let (ba, ca, cb) = (usize::from(b > a), usize::from(c > a), usize::from(c > b));
    let mut order = [0; 3];
    order[ba + ca] = 0;
    order[1 - ba + cb] = 1;
    order[2 - ca - cb] = 2;
    order
}
