//! Columns of a box: a regular grid over the two axes that are not swept.
//!
//! Monotone arithmetic (subtract, multiply, clamp, truncate) gives the column numbers of a box.
//! This is enough for correctness: boxes that overlap share a column, and `cell(max(a, b)) =
//! max(cell(a), cell(b))`. Boxes beyond the grid are clamped into the border columns: the result is
//! still correct, only slower.

use super::simd_box::Bounds;
use crate::base::num::each::Each;
use wide::f32x4;

/// A move across columns that is longer than this fraction of the column width is a jump.
const LEAP: f32 = 0.25;

/// Largest number of columns along one axis; column coordinates are 16 bits wide.
pub(crate) const MOST_COLUMNS_OF_AXIS: usize = 4096;

/// The columns of a box: least and greatest coordinate along both axes of the grid, inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    pub(crate) least: [u16; 2],
    pub(crate) most: [u16; 2],
}

impl Range {
    /// Packs both coordinates of a corner into one number.
    #[inline(always)]
    pub(crate) fn pack(corner: [u16; 2]) -> u32 {
        u32::from(corner[0]) | u32::from(corner[1]) << 16
    }

    #[inline(always)]
    pub(crate) fn unpack(packed: u32) -> [u16; 2] {
        [packed as u16, (packed >> 16) as u16]
    }

    /// The range without columns: for bodies that are not present, and for unbounded bodies, which
    /// are stored separately.
    pub(crate) const NONE: Self = Self {
        least: [u16::MAX; 2],
        most: [0; 2],
    };

    #[inline(always)]
    pub(crate) fn contains(&self, column: [u16; 2]) -> bool {
        (self.least[0] <= column[0])
            & (column[0] <= self.most[0])
            & (self.least[1] <= column[1])
            & (column[1] <= self.most[1])
    }

    /// Returns the number of columns in the range.
    pub(crate) fn count(&self) -> usize {
        (0..2)
            .map(|k| (usize::from(self.most[k]) + 1).saturating_sub(usize::from(self.least[k])))
            .product()
    }

    /// Iterates over all columns of the range, row by row.
    pub(crate) fn columns(self) -> impl Iterator<Item = [u16; 2]> {
        (self.least[0]..=self.most[0]).flat_map(move |u| (self.least[1]..=self.most[1]).map(move |v| [u, v]))
    }
}

/// A regular grid of columns along axis `axis`. Stored boxes have their coordinates in the cyclic
/// order that starts at the swept axis: "axis 0" of a stored box is the swept axis, and 1 and 2 are
/// the axes of the grid.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// The swept axis: 0, 1, 2 for x, y, z.
    pub(crate) axis: usize,
    /// Lower corner of column (0, 0), twice.
    corners: [f32; 4],
    /// Side of a column.
    pub(crate) width: f32,
    inverse: f32,
    /// Number of columns along the two axes.
    pub(crate) size: [u16; 2],
    last: [f32; 4],
    /// A move longer than this on some axis is a jump; lane 3 is arbitrary.
    pub(crate) leap: f32x4,
}

impl Grid {
    /// Returns the grid of one column that contains everything, swept along `axis`.
    pub(crate) fn single(axis: usize) -> Self {
        Self::new(axis, [0.0; 2], 1.0, [1, 1])
    }

    /// Returns a grid; `width` must be positive and finite and `size` at least 1 by 1.
    pub(crate) fn new(axis: usize, corner: [f32; 2], width: f32, size: [u16; 2]) -> Self {
        let [u, v] = corner;
        let [last_u, last_v] = size.each(|n| f32::from(n.max(1) - 1));
        let (corners, last) = ([u, v, u, v], [last_u, last_v, last_u, last_v]);
        Self {
            axis,
            corners,
            width,
            inverse: 1.0 / width,
            size,
            last,
            leap: f32x4::splat(width * LEAP),
        }
    }

    /// Returns the grid with moves along the swept axis treated as jumps beyond this length: a move
    /// that is no jump widens the windows of the whole column.
    pub(crate) fn leaping(mut self, length: f32) -> Self {
        self.leap.as_mut_array()[0] = length;
        self
    }

    pub(crate) fn corner(&self) -> [f32; 2] {
        [self.corners[0], self.corners[1]]
    }

    pub(crate) fn column_count(&self) -> usize {
        usize::from(self.size[0]) * usize::from(self.size[1])
    }

    #[inline(always)]
    pub(crate) fn index(&self, column: [u16; 2]) -> usize {
        usize::from(column[0]) * usize::from(self.size[1]) + usize::from(column[1])
    }

    pub(crate) fn column(&self, index: usize) -> [u16; 2] {
        let row = usize::from(self.size[1]).max(1);
        [(index / row) as u16, (index % row) as u16]
    }

    /// Computes the four column coordinates of a box, in parallel lanes.
    #[inline(always)]
    pub(crate) fn range(&self, bounds: &Bounds) -> Range {
        let ([_, a, b, _], [_, c, d, _]) = (bounds.lo.to_array(), bounds.hi.to_array());
        let cells = (f32x4::from([a, b, c, d]) - f32x4::from(self.corners)) * f32x4::splat(self.inverse);
        let inside = cells.fast_max(f32x4::ZERO).fast_min(f32x4::from(self.last));
        let [a, b, c, d] = inside.fast_trunc_int().to_array();
        Range {
            least: [a as u16, b as u16],
            most: [c as u16, d as u16],
        }
    }

    /// Returns the column that owns the pair: the column of the lower corner of the intersection.
    /// Both boxes touch this column.
    #[inline(always)]
    pub(crate) fn owner(&self, a: &Bounds, b: &Bounds) -> [u16; 2] {
        let lower = Bounds {
            lo: a.lo.fast_max(b.lo),
            hi: a.hi,
        };
        self.range(&lower).least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::broad::aabb::StoredBox;

    #[test]
    fn far_boxes_fall_into_border_columns() {
        let grid = Grid::new(0, [-10.0, 0.0], 2.0, [5, 3]);
        let at = |u: f32, v: f32| {
            let point = [0.0, u, v];
            grid.range(&Bounds::from_box(&StoredBox { lo: point, hi: point }))
        };
        assert_eq!(at(-1e38, -1e38).least, [0, 0]);
        assert_eq!(at(1e38, 1e38).most, [4, 2]);
        assert_eq!(
            at(-6.5, 2.0),
            Range {
                least: [1, 1],
                most: [1, 1]
            }
        );
        assert_eq!(
            (0..15)
                .map(|i| grid.index(grid.column(i)))
                .collect::<alloc::vec::Vec<_>>(),
            (0..15).collect::<alloc::vec::Vec<_>>()
        );
        assert_eq!(Range::NONE.count(), 0);
        assert_eq!(Range::NONE.columns().count(), 0);
    }
}
