//! Where motions put a body, and cubics of time.

use crate::number::Number;

/// `motion::steady::Steady::pose`: one coordinate of the pivot after a time.
pub fn pivot<N: Number>([centre, velocity, acceleration]: [N; 3], time: N) -> N {
    centre + velocity * time + acceleration * (time.times_power(-1) * time)
}

/// `separation::bernstein::rest`: the coefficients of a cubic over `[x, 1]`, for `y = 1 - x`.
pub fn rest<N: Number>(c: [N; 4], x: N, y: N) -> [N; 4] {
    let (p, q, r) = (y * c[0] + x * c[1], y * c[1] + x * c[2], y * c[2] + x * c[3]);
    let (s, t) = (y * p + x * q, y * q + x * r);
    [y * s + x * t, t, r, c[3]]
}
