//! Bézier and NURBS patches, coordinate by coordinate.

use crate::number::{Number, Vector, dot};

/// `surface::bezier::value` along one direction: the point of a curve at `t`, for `s = 1 - t`.
pub fn end<N: Number>(mut points: Vec<N>, s: N, t: N) -> N {
    for left in (1..points.len()).rev() {
        for i in 0..left {
            points[i] = s * points[i] + t * points[i + 1];
        }
    }
    points[0]
}

/// `surface::bezier::along_of`: the first derivative of a curve at `t`, over its degree, for `s = 1 - t`.
pub fn first<N: Number>(mut points: Vec<N>, s: N, t: N) -> N {
    for left in (2..points.len()).rev() {
        for i in 0..left {
            points[i] = s * points[i] + t * points[i + 1];
        }
    }
    points[1] - points[0]
}

/// `surface::bezier::value`: the point of a patch of degrees `p` and `q`, for `[s, t]` of each direction.
pub fn value<N: Number>(net: &[N], [p, q]: [usize; 2], [u, v]: [[N; 2]; 2]) -> N {
    let row = |i: usize| end(net[i * (q + 1)..][..=q].to_vec(), v[0], v[1]);
    end((0..=p).map(row).collect(), u[0], u[1])
}

/// `surface::nurbs::blossom`: the value of a blossom, for the two factors of each level and point.
pub fn blossom<N: Number>(mut points: Vec<N>, factors: impl Fn(usize, usize) -> [N; 2]) -> N {
    let degree = points.len() - 1;
    for level in 1..=degree {
        for i in (level..=degree).rev() {
            let [s, r] = factors(level, i);
            points[i] = s * points[i - 1] + r * points[i];
        }
    }
    points[degree]
}

/// `surface::net::raise`: a curve of degree `n` with a degree more, for the two factors of each point.
pub fn raise<N: Number>(mut points: Vec<N>, factors: impl Fn(usize) -> [N; 2]) -> Vec<N> {
    let n = points.len() - 1;
    points.push(points[n]);
    for j in (1..=n).rev() {
        let [s, t] = factors(j);
        points[j] = s * points[j] + t * points[j - 1];
    }
    points
}

/// `surface::height`: a coefficient of the height over a level.
pub fn coefficient<N: Number>(n: Vector<N>, homogeneous: Vector<N>, level: N, weight: N) -> N {
    dot(n, homogeneous) - level * weight
}
