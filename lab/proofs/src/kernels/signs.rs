//! Signs of sums of products.

use crate::number::{Number, Vector, cross, dot, named, one_norm, scaled, sub, sum};

/// `num::sign::rise`: a dot product, and the sum of its absolute terms.
pub fn rise<N: Number>(n: Vector<N>, e: Vector<N>) -> (N, N) {
    let [x, y, z] = [n[0] * e[0], n[1] * e[1], n[2] * e[2]];
    (x + y + z, x.abs() + y.abs() + z.abs())
}

/// `polyhedron::heights::slopes`: which of two edges rises more along an axis, and the sum of the absolute terms.
pub fn slopes<N: Number>([n, m]: [Vector<N>; 2], [e, f]: [Vector<N>; 2]) -> (N, N) {
    let ((ne, s_ne), (mf, s_mf)) = (rise(n, e), rise(m, f));
    let ((nf, s_nf), (me, s_me)) = (rise(n, f), rise(m, e));
    (ne * mf - nf * me, s_ne * s_mf + s_nf * s_me)
}

/// `hull::Hull::create` and `height`: the height of a point over a triangle, times twice its area.
pub fn side<N: Number>([u, w, to]: [Vector<N>; 3]) -> N {
    dot(cross(u, w), to)
}

/// `hull::products`: by coordinates, the absolute terms of a cross product.
pub fn products<N: Number>(u: Vector<N>, v: Vector<N>) -> Vector<N> {
    let (u, v) = (u.map(N::abs), v.map(N::abs));
    [
        u[1] * v[2] + u[2] * v[1],
        u[2] * v[0] + u[0] * v[2],
        u[0] * v[1] + u[1] * v[0],
    ]
}

/// `hull::guard`: the bound of a height over a triangle, with sides for the distance of the point.
pub fn guard<N: Number>([u, w, sides]: [Vector<N>; 3], error: f64) -> N {
    let error = N::exact(error);
    error * dot(products(u, w), sides) * (N::exact(1.0) + error) + N::exact(f64::MIN_POSITIVE)
}

/// `minimum::simplex`: the volume of three points with the origin.
pub fn volume<N: Number>([a, b, c]: [Vector<N>; 3]) -> N {
    dot(a, cross(b, c))
}

/// `depth::pyramid::PyramidSide::new`: the normal of a side and the height of the origin below it.
pub fn pyramid_side<N: Number>([from, to, apex]: [Vector<N>; 3]) -> (Vector<N>, N) {
    let (u, v) = (named('u', sub(from, to)), named('v', sub(apex, to)));
    let n = named('n', cross(u, v));
    (n, dot(n, to))
}

/// `minimum::simplex::ClosestPoint::triangle`: the normal of a triangle, of two of its edges.
pub fn normal<N: Number>([u, v]: [Vector<N>; 2]) -> Vector<N> {
    cross(u, v)
}

/// The weight of a corner, before the division by the sum of all: of the edge opposite to it, from its begin `x`.
pub fn weight<N: Number>(n: Vector<N>, edge: Vector<N>, x: Vector<N>) -> N {
    -dot(n, cross(edge, x))
}

/// `polyhedron::query::over_side`: how far a point is inside the plane of a side of a face.
pub fn over_side<N: Number>(n: Vector<N>, edge: Vector<N>, to: Vector<N>) -> N {
    dot(named('c', cross(edge, to)), n)
}

/// `polyhedron::query::foot`: a point less its height along a normal.
pub fn foot<N: Number>(p: Vector<N>, n: Vector<N>, height: N) -> Vector<N> {
    std::array::from_fn(|k| p[k] - n[k] * height)
}

/// `separation::polyhedra`: a height over a middle, before the bound is added.
pub fn height_over<N: Number>(n: Vector<N>, p: Vector<N>, middle: Vector<N>) -> N {
    dot(n, p) - dot(n, middle)
}

/// What the bound of a support by two planes is made of, see [`two_planes`].
pub struct TwoPlanes<N> {
    /// The sum of the two normals with their weights.
    pub combined: Vector<N>,
    /// The weights' share of the error, before the constant.
    pub weights: N,
    /// The factor times the sum of the offsets.
    pub offsets: N,
    /// What the direction is beyond the sum of the normals.
    pub rest: Vector<N>,
    /// Its 1-norm.
    pub norm: N,
}

/// `pair::star::two_planes_bound`: the support along `n` by two planes with their offsets and weights, for the factor
/// `scale` of the sum of the normals.
pub fn two_planes<N: Number>(n: Vector<N>, planes: [(Vector<N>, N); 2], weights: [N; 2], scale: N) -> TwoPlanes<N> {
    let ([(left, o_left), (right, o_right)], [alpha, beta]) = (planes, weights);
    let combined = named('m', sum(scaled(left, alpha), scaled(right, beta)));
    let rest = named('z', sub(n, scaled(combined, scale)));
    TwoPlanes {
        combined,
        weights: scale * (alpha + beta),
        offsets: scale * (alpha * o_left + beta * o_right),
        rest,
        norm: one_norm(rest),
    }
}

/// The bound itself, for the constant `error` and the radius of the body.
pub fn two_planes_bound<N: Number>(parts: &TwoPlanes<N>, error: f64, radius: N) -> N {
    parts.offsets + (parts.norm + parts.weights * N::exact(error)) * radius
}
