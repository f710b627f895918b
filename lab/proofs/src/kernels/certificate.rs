//! The certificate: heights of supporting planes and distances of witnesses, before the error term.

use crate::number::{Number, Vector, named};
use crate::vectors::Vectors;

/// The rotation and the translation of a relative pose, as computed.
pub struct Placing<V: Vectors> {
    /// The matrix of the rotation.
    pub rotation: V::Matrix,
    /// The translation.
    pub translation: V::Vector,
}

impl<V: Vectors> Placing<V> {
    /// `pair::posed::PosedPair::point_in_a`: a point of B in A's frame.
    pub fn in_a(&self, q: V::Vector) -> V::Vector {
        V::sum(V::product(self.rotation, q), self.translation)
    }

    /// `pair::posed::PosedPair::point_in_b`: a point of A in B's frame.
    pub fn in_b(&self, p: V::Vector) -> V::Vector {
        V::product(V::transposed(self.rotation), V::sub(p, self.translation))
    }

    /// `pair::posed::PosedPair::vector_in_a`: a vector of B's frame in A's.
    pub fn turned_to_a(&self, v: V::Vector) -> V::Vector {
        V::product(self.rotation, v)
    }

    /// `pair::posed::PosedPair::direction_in_b`: a vector of A's frame in B's.
    pub fn turned_to_b(&self, v: V::Vector) -> V::Vector {
        V::product(V::transposed(self.rotation), v)
    }

    /// `pair::certificate::support_distance`, for a direction of length one and the support points of A and B.
    pub fn support_distance(&self, n: V::Vector, [p, q]: [V::Vector; 2]) -> V::Number {
        let high_a = V::dot(n, p);
        let high_b = -V::dot(self.turned_to_b(n), q);
        V::dot(n, self.translation) - high_a - high_b
    }

    /// `convex::walk::edge_edge::bound_by_planes`, for the bounds of both supports.
    pub fn between_bounds(&self, n: V::Vector, [high_a, high_b]: [V::Number; 2]) -> V::Number {
        V::dot(n, self.translation) - high_a - high_b
    }

    /// `pair::difference::difference_point`: `p - q`, in A's frame.
    pub fn difference(&self, [p, q]: [V::Vector; 2]) -> V::Vector {
        V::sub(p, self.in_a(q))
    }

    /// `convex::walk::vertex_vertex`: from a vertex of A to one of B.
    pub fn between_vertices(&self, [p, q]: [V::Vector; 2]) -> V::Vector {
        V::sub(self.in_a(q), p)
    }

    /// `convex::walk::edge_edge`: an edge of each body in A's frame, from tail to head.
    pub fn edges(&self, [p1, q1]: [V::Vector; 2], [p2, q2]: [V::Vector; 2]) -> Edges<V> {
        let u = V::sub(q1, p1);
        let w = self.turned_to_a(V::sub(q2, p2));
        let start = self.in_a(p2);
        Edges {
            u,
            w,
            start,
            between: V::sub(start, p1),
        }
    }
}

/// `convex::walk::vertex_face`: the height of a point over the plane of a face, by its offset.
pub fn over_plane<V: Vectors>(normal: V::Vector, x: V::Vector, offset: V::Number) -> V::Number {
    V::dot(normal, x) - offset
}

/// The same, by a corner of the face.
pub fn over_corner<V: Vectors>(normal: V::Vector, x: V::Vector, corner: V::Vector) -> V::Number {
    V::dot(normal, V::sub(x, corner))
}

/// `convex::walk::vertex_face::closest_on_edge`: to `x` from a point of an edge.
pub fn from_edge<V: Vectors>(x: V::Vector, [p, q]: [V::Vector; 2], s: V::Number) -> V::Vector {
    V::sub(x, V::sum(p, V::scaled(V::sub(q, p), s)))
}

/// `convex::walk::vertex_edge`: the vector of an edge, and the one from its tail to a point.
pub fn along_edge<V: Vectors>(x: V::Vector, [p, q]: [V::Vector; 2]) -> [V::Vector; 2] {
    [V::sub(q, p), V::sub(x, p)]
}

/// `convex::walk::{vertex_edge, edge_edge}`: a vector less a part of an edge.
pub fn less<V: Vectors>(v: V::Vector, edge: V::Vector, part: V::Number) -> V::Vector {
    V::sub(v, V::scaled(edge, part))
}

/// An edge of each body, in A's frame.
pub struct Edges<V: Vectors> {
    /// The vector of the edge of A.
    pub u: V::Vector,
    /// The vector of the edge of B.
    pub w: V::Vector,
    /// The tail of the edge of B.
    pub start: V::Vector,
    /// From the tail of the edge of A to that of B.
    pub between: V::Vector,
}

impl<V: Vectors> Edges<V> {
    /// From the witness of A, whose edge begins at `p1`, to that of B.
    pub fn between_witnesses(&self, p1: V::Vector, [s, t]: [V::Number; 2]) -> V::Vector {
        let on_b = V::sum(self.start, V::scaled(self.w, t));
        V::sub(on_b, V::sum(p1, V::scaled(self.u, s)))
    }
}

/// `convex::minimum::simplex::Simplex::witness_distance`: the combination of points by weights.
pub fn combined<V: Vectors>(points: &[V::Vector], weights: &[V::Number]) -> V::Vector {
    let mut terms = points.iter().zip(weights).map(|(w, weight)| V::scaled(*w, *weight));
    let first = terms.next().expect("a point");
    terms.fold(first, V::sum)
}

/// `pair::transform::rotation`: the matrix of a quaternion of double-doubles, for a factor `s = 2 / |q|^2`.
pub fn rotation<N: Number>([x, y, z, w]: [N; 4], s: N) -> [Vector<N>; 3] {
    let one = N::exact(1.0);
    [
        named(
            'i',
            [one - (y * y + z * z) * s, (x * y - w * z) * s, (x * z + w * y) * s],
        ),
        named(
            'j',
            [(x * y + w * z) * s, one - (x * x + z * z) * s, (y * z - w * x) * s],
        ),
        named(
            'k',
            [(x * z - w * y) * s, (y * z + w * x) * s, one - (x * x + y * y) * s],
        ),
    ]
}

/// `pair::transform::Transform::<DoubleDouble>::between`: the rotation of both, of bodies in one unit.
pub fn rotation_between<V: Vectors>([a, b]: [V::Matrix; 2]) -> V::Matrix {
    // Entries of `a^T b`, each summed along a column of both.
    V::products(V::transposed(a), V::transposed(b))
}

/// `pair::transform::Transform::<DoubleDouble>::shift`: the origin of B in A's frame, of both rotations, both origins
/// and the difference of the translations.
pub fn shift<V: Vectors>(
    [a, b]: [V::Matrix; 2],
    [origin_a, origin_b]: [V::Vector; 2],
    difference: V::Vector,
) -> V::Vector {
    let offset = V::sum(V::product(b, origin_b), difference);
    V::sub(V::product(V::transposed(a), offset), origin_a)
}

/// `surface::gap::Trees::gap`, before the errors are taken off: for the heights of both nets.
pub fn between_nets<V: Vectors>(n: V::Vector, translation: V::Vector, [high_a, high_b]: [V::Number; 2]) -> V::Number {
    V::dot(n, translation) - high_b - high_a
}
