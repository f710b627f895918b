//! Meshes of height fields.

use alloc::vec::Vec;
use nalgebra::Point3;

use super::{Mesh, MeshError};
use crate::base::num::each::Each;

impl Mesh {
    /// Builds a mesh from heights on a grid: a solid down to a base, or an open surface.
    ///
    /// `heights` are `rows` times `columns` values of z, row by row: value `[i][j]` is at
    /// `(j x, i y)` with the spacing `[x, y]`. Every square is cut along the diagonal from `[i][j]`
    /// to `[i + 1][j + 1]`. Triangles `2 k` and `2 k + 1` are those of square k, row by row, first
    /// the one towards x.
    ///
    /// With a `base`, the mesh is closed: a solid with walls down to the plane `z = base`, which is
    /// below all heights. Without one it is an open surface, and a body below it does not overlap
    /// it.
    ///
    /// ```
    /// use lin_canny::nalgebra::Isometry3;
    /// use lin_canny::{ContactState, Mesh, MeshKind, PairTracker, RelativePose, Shape};
    ///
    /// let heights = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    /// let hill = Mesh::from_heights(3, 3, [2.0, 2.0], &heights, Some(-1.0))?;
    /// assert_eq!(hill.kind(), MeshKind::Solid);
    /// let ball = Shape::ball(0.5)?;
    /// let over = |z| {
    ///     RelativePose::from_isometry(&Isometry3::translation(2.0, 2.0, z))
    /// };
    /// let mut tracker = PairTracker::new();
    /// let above = tracker.closest(&hill, &ball, &over(2.0)?);
    /// assert!((above.distance - 0.5).abs() < 1e-12);
    /// let below = tracker.closest(&hill, &ball, &over(0.0)?);
    /// assert_eq!(below.state, ContactState::Overlapping);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns an error in these cases:
    ///
    /// - There are fewer than two rows or columns, or not `rows` times `columns` heights.
    /// - A spacing is not positive and finite, or the base is not finite.
    /// - A height is not finite, or not above the base.
    /// - [`Mesh::new`] rejects the points.
    #[doc(alias = "height field")]
    #[doc(alias = "heightmap")]
    #[doc(alias = "terrain")]
    pub fn from_heights(
        rows: usize,
        columns: usize,
        spacing: [f64; 2],
        heights: &[f64],
        base: Option<f64>,
    ) -> Result<Self, MeshError> {
        let count = heights.len();
        if rows < 2 || columns < 2 || rows.checked_mul(columns) != Some(count) {
            return Err(MeshError::HeightCount { rows, columns, count });
        }
        if let Some(axis) = (0..2).find(|&k| !(spacing[k] > 0.0 && spacing[k] < f64::INFINITY)) {
            let value = spacing[axis];
            return Err(MeshError::Spacing { axis, value });
        }
        if let Some(value) = base.filter(|z| !z.is_finite()) {
            return Err(MeshError::Base { value });
        }
        let floor = base.unwrap_or(f64::NEG_INFINITY);
        if let Some(index) = heights.iter().position(|z| !(*z > floor && *z < f64::INFINITY)) {
            let value = heights[index];
            return Err(MeshError::Height { index, value });
        }
        // Ids of points have 27 bits; a larger grid would overflow them.
        if count > 1 << 27 {
            return Err(MeshError::TooMany { count });
        }
        let place = |i: usize, j: usize| [j as f64 * spacing[0], i as f64 * spacing[1]];
        let index = |i: usize, j: usize| (i * columns + j) as u32;
        let mut points: Vec<_> = (0..count)
            .map(|k| {
                let [x, y] = place(k / columns, k % columns);
                Point3::new(x, y, heights[k])
            })
            .collect();
        let mut triangles = Vec::with_capacity(2 * (rows - 1) * (columns - 1));
        for i in 0..rows - 1 {
            for j in 0..columns - 1 {
                let [a, b, c, d] = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)].each(|(i, j)| index(i, j));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        if let Some(z) = base {
            close(&mut points, &mut triangles, [rows, columns], z);
        }
        Self::new(&points, &triangles)
    }
}

/// Adds walls down to a base, and the base: a fan about its middle.
fn close(points: &mut Vec<Point3<f64>>, triangles: &mut Vec<[u32; 3]>, [rows, columns]: [usize; 2], z: f64) {
    let index = |i: usize, j: usize| (i * columns + j) as u32;
    // The border, counter-clockwise seen from above.
    let mut border: Vec<u32> = (0..columns - 1).map(|j| index(0, j)).collect();
    border.extend((0..rows - 1).map(|i| index(i, columns - 1)));
    border.extend((1..columns).rev().map(|j| index(rows - 1, j)));
    border.extend((1..rows).rev().map(|i| index(i, 0)));
    let first = points.len() as u32;
    for &k in &border {
        let top = points[k as usize];
        points.push(Point3::new(top.x, top.y, z));
    }
    let far = points[index(rows - 1, columns - 1) as usize];
    let middle = points.len() as u32;
    points.push(Point3::new(0.5 * far.x, 0.5 * far.y, z));
    for (k, &a) in border.iter().enumerate() {
        let next = (k + 1) % border.len();
        let (b, below_a, below_b) = (border[next], first + k as u32, first + next as u32);
        triangles.extend([[below_a, below_b, b], [below_a, b, a], [middle, below_b, below_a]]);
    }
}
