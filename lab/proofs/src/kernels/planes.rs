//! Planes and balls that part bodies in motion.

use crate::number::Number;
use crate::vectors::Vectors;

/// A normal, the rate at which it turns, and the rate of a body, both times an interval.
pub struct Turning<V: Vectors> {
    /// The normal.
    pub normal: V::Vector,
    /// Rate of the normal.
    pub spin: V::Vector,
    /// Rate of the body.
    pub rate: V::Vector,
}

/// `separation::plane::derivatives`: first and second derivative of the direction as the body sees it.
pub fn derivatives<V: Vectors>(t: &Turning<V>, two: V::Number) -> [V::Vector; 2] {
    let (n, spin, w) = (t.normal, t.spin, t.rate);
    let with_spin = V::cross(spin, n);
    let first = V::cross(V::sub(spin, w), n);
    let back = V::scaled(V::cross(w, with_spin), two);
    let second = V::sum(V::sub(V::cross(spin, with_spin), back), V::cross(w, V::cross(w, n)));
    [first, second]
}

/// `PlaneBetween::coefficients`: both directions, of derivatives, half an interval and an interval.
pub fn directions<V: Vectors>(
    n: V::Vector,
    [first, second]: [V::Vector; 2],
    [half, all]: [V::Number; 2],
) -> [V::Vector; 2] {
    let near = V::sum(n, V::scaled(first, half));
    let far = V::sum(n, V::scaled(V::sum(first, V::scaled(second, half)), all));
    [near, far]
}

/// `PlaneSide::height`: the height along a direction of the world, for the height of the support in the body's frame.
pub fn height<V: Vectors>(rotation: V::Matrix, direction: V::Vector, arm: V::Vector, support: V::Vector) -> V::Number {
    let own = V::product(V::transposed(rotation), direction);
    V::dot(own, support) + V::dot(own, arm)
}

/// `plane::way_along`: the way of the pivots along the normal, and its derivatives.
pub fn way<V: Vectors>(
    t: &Turning<V>,
    [between, velocity, acceleration]: [V::Vector; 3],
    two: V::Number,
) -> [V::Number; 3] {
    let (n, spin) = (t.normal, t.spin);
    let turned = V::cross(spin, n);
    let bent = V::cross(spin, V::cross(spin, n));
    [
        V::dot(n, between),
        V::dot(turned, between) + V::dot(n, velocity),
        V::dot(bent, between) + two * V::dot(turned, velocity) + V::dot(n, acceleration),
    ]
}

/// `separation::balls::flight_of_ball`: what the radii leave of the square of the distance, the approach, the square of
/// the velocity, and what is under the root.
pub fn approach<V: Vectors>(
    from: V::Vector,
    velocity: V::Vector,
    radius: V::Number,
    more: V::Number,
) -> [V::Number; 4] {
    let square = V::dot(from, from);
    let above = square - (radius * radius + more * (square + radius * radius));
    let approach = -V::dot(from, velocity);
    let speed = V::dot(velocity, velocity);
    [above, approach, speed, approach * approach - speed * above]
}

/// A product of quaternions of `nalgebra`.
pub fn composed<N: Number>([ax, ay, az, aw]: [N; 4], [bx, by, bz, bw]: [N; 4]) -> [N; 4] {
    crate::number::named(
        'q',
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ],
    )
}

/// `motion::rotation::half_turn`: the quaternion of a turn, of the axis, sine and cosine of half the angle, and what the
/// rounding of this half leaves out.
pub fn spun<N: Number>(axis: [N; 3], [sine, cosine]: [N; 2], rest: N) -> [N; 4] {
    let by = sine + cosine * rest;
    let [x, y, z] = axis.map(|a| a * by);
    [x, y, z, cosine - sine * rest]
}
