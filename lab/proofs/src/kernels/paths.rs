//! Vertices on straight paths: places, heights, volumes, areas.

use crate::number::{Number, Vector, cross, dot, sub, sum};

/// `continuous::paths::place`, by coordinates: for the shares of the begin and of the end.
pub fn place<N: Number>([begin, end]: [N; 2], shares: [N; 2]) -> N {
    begin * shares[0] + end * shares[1]
}

/// `continuous::paths::VertexPlaces::gap`, before the doubt is taken off: how far one place is above another.
pub fn gap<N: Number>(n: Vector<N>, [low, high]: [Vector<N>; 2]) -> N {
    dot(n, low) - dot(n, high)
}

/// `continuous::paths::determinant`: six times the volume of three places and the origin.
pub fn volume<N: Number>([a, b, c]: [Vector<N>; 3]) -> N {
    dot(cross(a, b), c)
}

/// `continuous::paths::third`, before the division by three: the sum of the volumes of a coefficient.
pub fn thrice<N: Number>([a, b, c]: [N; 3]) -> N {
    a + b + c
}

/// `continuous::paths::areas`: the middle coefficient of an area, of the places of three vertices at two instants,
/// along a direction.
pub fn middle<N: Number>([[i, j, k], [l, m, o]]: [[Vector<N>; 3]; 2], n: Vector<N>) -> N {
    let ([a, b], [c, d]) = ([sub(j, i), sub(k, i)], [sub(m, l), sub(o, l)]);
    let both = sum(cross(a, d), cross(c, b));
    dot(both.map(|x| x.times_power(-1)), n)
}

/// The coefficient at an end: the area itself.
pub fn end<N: Number>([i, j, k]: [Vector<N>; 3], n: Vector<N>) -> N {
    dot(cross(sub(j, i), sub(k, i)), n)
}
