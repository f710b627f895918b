//! Bézier curves and tensor-product patches: values, derivatives and halves.
//!
//! Sources: de Casteljau 1959; Farin 2002, "Curves and Surfaces for CAGD", chapters 4, 5 and 13.
//! Every step is a convex combination, so errors are relative to the control points
//! (`tolerance::PATCH_POINT`).

/// Largest number of control points along one direction.
pub(crate) const ORDER: usize = 8;

/// Largest number of control points of a patch.
pub(super) const NET: usize = ORDER * ORDER;

/// Value and derivatives at a point of a patch with `K` coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet<const K: usize> {
    pub(super) value: [f64; K],
    pub(crate) u: [f64; K],
    pub(super) v: [f64; K],
    pub(super) uu: [f64; K],
    pub(super) uv: [f64; K],
    pub(super) vv: [f64; K],
}

#[inline(always)]
fn mixed<const K: usize>(a: &[f64; K], b: &[f64; K], t: f64) -> [f64; K] {
    let s = 1.0 - t;
    core::array::from_fn(|k| s * a[k] + t * b[k])
}

#[inline(always)]
fn difference<const K: usize>(a: &[f64; K], b: &[f64; K], factor: f64) -> [f64; K] {
    core::array::from_fn(|k| factor * (b[k] - a[k]))
}

/// Returns value, first and second derivative of a Bézier curve of degree 1 or more. Overwrites the
/// points.
#[inline(always)]
fn along<const K: usize>(points: &mut [[f64; K]], t: f64) -> [[f64; K]; 3] {
    // Loops of a constant length take half as many instructions for the common degrees.
    match points.len() {
        3 => along_of(&mut points[..3], t),
        4 => along_of(&mut points[..4], t),
        _ => along_of(points, t),
    }
}

#[inline(always)]
fn along_of<const K: usize>(points: &mut [[f64; K]], t: f64) -> [[f64; K]; 3] {
    let degree = points.len() - 1;
    let n = degree as f64;
    for left in (3..=degree).rev() {
        for i in 0..left {
            points[i] = mixed(&points[i], &points[i + 1], t);
        }
    }
    if degree == 1 {
        let value = mixed(&points[0], &points[1], t);
        return [value, difference(&points[0], &points[1], 1.0), [0.0; K]];
    }
    let (a, b) = (mixed(&points[0], &points[1], t), mixed(&points[1], &points[2], t));
    let (p, q) = (
        difference(&points[0], &points[1], 1.0),
        difference(&points[1], &points[2], 1.0),
    );
    [
        mixed(&a, &b, t),
        difference(&a, &b, n),
        difference(&p, &q, n * (n - 1.0)),
    ]
}

/// Returns the value and derivatives of a patch. Rows of constant u follow each other in the net.
#[inline(always)]
pub(crate) fn jet<const K: usize>(net: &[[f64; K]], [p, q]: [usize; 2], [u, v]: [f64; 2]) -> Jet<K> {
    let mut columns = [[[0.0; K]; ORDER]; 3];
    let mut row = [[0.0; K]; ORDER];
    for i in 0..=p {
        row[..=q].copy_from_slice(&net[i * (q + 1)..][..=q]);
        let [value, first, second] = along(&mut row[..=q], v);
        columns[0][i] = value;
        columns[1][i] = first;
        columns[2][i] = second;
    }
    let [value, of_u, of_uu] = along(&mut columns[0][..=p], u);
    let [of_v, of_uv, _] = along(&mut columns[1][..=p], u);
    let [of_vv, ..] = along(&mut columns[2][..=p], u);
    Jet {
        value,
        u: of_u,
        v: of_v,
        uu: of_uu,
        uv: of_uv,
        vv: of_vv,
    }
}

/// Returns only the value of a patch, as [`jet`] does.
#[inline(always)]
pub(crate) fn value<const K: usize>(net: &[[f64; K]], [p, q]: [usize; 2], [u, v]: [f64; 2]) -> [f64; K] {
    let mut column = [[0.0; K]; ORDER];
    let mut row = [[0.0; K]; ORDER];
    let end = |points: &mut [[f64; K]], t: f64| {
        for left in (1..points.len()).rev() {
            for i in 0..left {
                points[i] = mixed(&points[i], &points[i + 1], t);
            }
        }
        points[0]
    };
    for i in 0..=p {
        row[..=q].copy_from_slice(&net[i * (q + 1)..][..=q]);
        column[i] = end(&mut row[..=q], v);
    }
    end(&mut column[..=p], u)
}

/// Splits one coordinate of a net in the middle of a direction: 0 for u, 1 for v.
#[inline(always)]
pub(crate) fn halves(net: &[f64], [p, q]: [usize; 2], direction: u8, low: &mut [f64], high: &mut [f64]) {
    high.copy_from_slice(net);
    let width = q + 1;
    if direction == 0 {
        for level in 0..p {
            low[level * width..][..width].copy_from_slice(&high[..width]);
            for k in 0..(p - level) * width {
                high[k] = 0.5 * (high[k] + high[k + width]);
            }
        }
        low[p * width..].copy_from_slice(&high[..width]);
    } else {
        for i in 0..=p {
            let row = i * width;
            for level in 0..q {
                low[row + level] = high[row];
                for k in row..row + q - level {
                    high[k] = 0.5 * (high[k] + high[k + 1]);
                }
            }
            low[row + q] = high[row];
        }
    }
}
