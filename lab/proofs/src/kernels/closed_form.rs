//! Distances of features in double-double: `convex::solve::closed_form`.

use crate::vectors::Vectors;

/// `pair::transform::Turned::vector`: a vector of B's frame in A's, by both rotations.
pub fn turned<V: Vectors>([a, b]: [V::Matrix; 2], v: V::Vector) -> V::Vector {
    V::product(V::transposed(a), V::product(b, v))
}

/// The normal of two edges, and the height of a point over their plane times the length of the normal.
pub fn height<V: Vectors>(w: V::Vector, [u, v]: [V::Vector; 2]) -> (V::Vector, V::Number) {
    let n = V::cross(u, v);
    (n, V::dot(w, n))
}
