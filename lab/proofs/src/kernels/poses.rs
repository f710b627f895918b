//! Relative poses.

use crate::number::{Number, Vector, cross, named, scaled, sum};

/// Vector part, then scalar part.
pub type Quaternion<N> = [N; 4];

/// `pose::PoseBits::of`: the squared norm of a quaternion.
pub fn squared_norm<N: Number>([x, y, z, w]: Quaternion<N>) -> N {
    (x * x + z * z) + (y * y + w * w)
}

/// `num::packed::quotient`: the product of the conjugate of `a` with `b`.
pub fn quotient<N: Number>([ax, ay, az, aw]: Quaternion<N>, [bx, by, bz, bw]: Quaternion<N>) -> Quaternion<N> {
    named(
        'q',
        [
            (aw * bx - bw * ax) + (bz * -ay - az * -by),
            (aw * by - bw * ay) + (bz * ax - az * bx),
            (aw * bz + az * -bw) + (bx * ay + by * -ax),
            (aw * bw + az * bz) + (bx * ax + by * ay),
        ],
    )
}

/// `num::packed::PackedRotation::of`: the matrix of a quaternion, for a factor `s = 2 / |q|^2`. `pose::rotation_matrix`
/// has the same roundings.
pub fn matrix<N: Number>([x, y, z, w]: Quaternion<N>, s: N) -> [Vector<N>; 3] {
    let (xs, ys, zs) = (x * s, y * s, z * s);
    let (xx, yy, zz) = (x * xs, y * ys, z * zs);
    let (xy, xz, yz) = (x * ys, x * zs, y * zs);
    let (wx, wy, wz) = (xs * w, ys * w, w * zs);
    let one = N::exact(1.0);
    [
        named('i', [one - (yy + zz), xy - wz, xz + wy]),
        named('j', [xy + wz, one - (xx + zz), yz - wx]),
        named('k', [xz - wy, yz + wx, one - (xx + yy)]),
    ]
}

/// `pose::RelativePose::packed_rotation`: twice the quotient of one by both squared norms, which are almost one.
pub fn rotation_factor<N: Number>(norm_a: N, norm_b: N) -> N {
    let two = N::exact(2.0);
    (two - norm_a).times_power(1) * (two - norm_b)
}

/// `num::packed::combined`: a matrix times a vector.
pub fn product<N: Number>(m: [Vector<N>; 3], v: Vector<N>) -> Vector<N> {
    named('r', m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]))
}

/// `pose::RelativePose::rotated_to_a`: an offset in A's frame, for the factor `s = 2 / |q|^2`.
pub fn rotated_to_a<N: Number>([x, y, z, w]: Quaternion<N>, offset: Vector<N>, s: N) -> Vector<N> {
    let axis = [x, y, z];
    let c = named('c', cross(offset, axis));
    let g = named('g', cross(c, axis));
    let t = named('t', sum(scaled(c, w), g));
    named('r', sum(offset, named('f', scaled(t, s))))
}

/// `pose::RelativePose::translation`: twice the quotient of one by the squared norm.
pub fn translation_factor<N: Number>(norm: N) -> N {
    (N::exact(2.0) - norm).times_power(1)
}

/// A unit quaternion of `nalgebra` times a vector.
pub fn turned<N: Number>([x, y, z, w]: Quaternion<N>, v: Vector<N>) -> Vector<N> {
    let axis = [x, y, z];
    let t = named('c', cross(axis, v)).map(|x| x.times_power(1));
    let g = named('g', cross(axis, t));
    let h = named('h', sum(scaled(t, w), g));
    named('r', sum(h, v))
}
