//! The greatest of unimodal values on a ring, by bisection.

/// Returns the index of the greatest of `m` unimodal values on a ring: values that rise to an index
/// and fall from there.
pub(crate) fn top_of_ring<V: PartialOrd>(m: usize, value: impl Fn(usize) -> V) -> usize {
    let stride = m.div_ceil(4).max(1);
    let (mut best, mut top) = (0, value(0));
    for k in 1..4 {
        let (k, v) = ((k * stride) % m, value((k * stride) % m));
        if v > top {
            (best, top) = (k, v);
        }
    }
    top_from(m, best, stride, value)
}

/// Returns the index of the greatest of `m` unimodal values, searching from index `best` by strides
/// from the given one down to one.
pub(super) fn top_from<V: PartialOrd>(
    m: usize,
    mut best: usize,
    mut stride: usize,
    value: impl Fn(usize) -> V,
) -> usize {
    let mut top = value(best);
    // Each round finds a higher value or halves the stride: no more rounds than values and
    // halvings, whatever the values.
    for _ in 0..m + usize::BITS as usize {
        let (left, right) = ((best + m - stride % m) % m, (best + stride) % m);
        let (at_left, at_right) = (value(left), value(right));
        if at_left > top {
            (best, top) = (left, at_left);
        } else if at_right > top {
            (best, top) = (right, at_right);
        } else if stride == 1 {
            break;
        } else {
            stride = stride.div_ceil(2);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_finds_the_top_of_a_ring() {
        for m in 3..200 {
            for top in 0..m {
                let height = |k: usize| (core::f64::consts::TAU * (k as f64 - top as f64) / m as f64).cos();
                assert_eq!(top_of_ring(m, height), top);
            }
        }
    }
}
