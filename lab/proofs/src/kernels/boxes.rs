//! Pairs of oriented boxes and entries of a front, in single precision. Quotients by lengths, roots and signs are left
//! to the caller.

use crate::number::Number;
use crate::vectors::Vectors;

/// A box: rows of axes, centre, half extents.
pub struct Oriented<V: Vectors> {
    /// Axes.
    pub axes: V::Matrix,
    /// Centre.
    pub centre: V::Vector,
    /// Half extents.
    pub half: V::Vector,
}

/// What a pair of boxes is bounded by, in A's frame.
pub struct Posed<V: Vectors> {
    /// Difference of the centres.
    pub between: V::Vector,
    /// The difference in the axes of either box.
    pub along: [V::Vector; 2],
    /// Axes of B.
    pub axes_b: V::Matrix,
    /// Products of the axes of A with those of B.
    pub products: V::Matrix,
}

/// `nonconvex::query::box_gaps::bound_eight`, one lane, up to the gaps.
pub fn posed<V: Vectors>(rotation: V::Matrix, shift: V::Vector, [a, b]: [&Oriented<V>; 2]) -> Posed<V> {
    let axes_b = V::products(b.axes, rotation);
    let at = V::product(rotation, b.centre);
    let between = V::sub(V::sum(at, shift), a.centre);
    Posed {
        between,
        along: [V::product(a.axes, between), V::product(axes_b, between)],
        axes_b,
        products: V::products(a.axes, axes_b),
    }
}

/// The gap along the line of the centres, times their distance.
pub fn by_centres<V: Vectors>(between: V::Vector, along: [V::Vector; 2], half: [V::Vector; 2]) -> V::Number {
    let [a, b] = [0, 1].map(|k| V::dot(half[k], V::absolute(along[k])));
    V::dot(between, between) - a - b
}

/// `box_gaps::excess`: the gap along an excess vector `e` with the absolute coordinates `x`, times its length, from the
/// amounts `over` by which the centres are farther apart along the axes of one box than it reaches, and half extents of
/// the other box.
pub fn excess<V: Vectors>(e: [V::Vector; 2], over: V::Vector, other: V::Vector, products: V::Matrix) -> V::Number {
    let [signed, absolute] = e;
    let turned = V::product(V::transposed(products), signed);
    V::dot(absolute, over) - V::dot(other, V::absolute(turned))
}

/// `box_gaps::excess`: by how much the centres are farther apart than both boxes reach.
pub fn beyond<V: Vectors>(along: V::Vector, [own, other]: [V::Vector; 2], products: V::Matrix) -> [V::Vector; 2] {
    let over = V::sub(V::absolute(along), own);
    [over, V::sub(over, V::spread(products, other))]
}

/// `BestGaps::offer`: the gap along a direction, times its length.
pub fn along<V: Vectors>(
    direction: V::Vector,
    between: V::Vector,
    half: [V::Vector; 2],
    axes: [V::Matrix; 2],
) -> V::Number {
    let [a, b] = [0, 1].map(|k| V::dot(half[k], V::absolute(V::product(axes[k], direction))));
    V::dot(direction, between).abs() - a - b
}

/// `Front::set`: the direction in the other frame, and the base.
pub fn entry<V: Vectors>(
    (rotation, shift): (V::Matrix, V::Vector),
    n: V::Vector,
    centre: V::Vector,
    gap: V::Number,
) -> (V::Vector, V::Number) {
    let at = V::sum(V::product(rotation, centre), shift);
    (V::product(V::transposed(rotation), n), gap - V::dot(n, at))
}

/// `FrontBlock::gaps`: the turn of the direction, and the gap before what the turn takes.
pub fn carried<V: Vectors>(
    (rotation, shift): (V::Matrix, V::Vector),
    [n, m]: [V::Vector; 2],
    centre: V::Vector,
    base: V::Number,
) -> (V::Vector, V::Number) {
    let x = V::product(V::transposed(rotation), n);
    let along = V::dot(x, centre) + V::dot(n, shift);
    (V::sub(x, m), base + along)
}
