//! Motions, planes, balls and rays.

use super::poses::{entries, product, quaternion_of, rotation, squared_norm, translation, turned};
use super::{Bound, once, units};
use crate::factor::{Factor, Positive};
use crate::kernels::planes::{self, Turning};
use crate::majorant::{DOUBLE, power, unit};
use crate::norm::root_above;
use crate::number::Number;
use crate::vectors::{Arrow, Lengths, Turn, Vectors, Within};
use dashu_ratio::RBig;

pub(super) fn bounds() -> Vec<Bound> {
    let whole = Bound::whole;
    let both = |of: RBig| RBig::from(2) * of;
    vec![
        whole("TURN", "motion::steady::pose", both(turn())).case("steady"),
        whole("TURN", "motion::nlerp::pose", both(interpolated())).case("nlerp"),
        whole("NORMALISED", "motion::steady::restored", normalised()),
        whole("PLANE", "separation::plane::coefficients", plane()),
        whole("BALLS", "separation::balls::until_as_near", balls()).case("a square, and the root"),
        whole("RAY", "ray::within_ball", ball_of_ray()).case("a ball"),
        whole("RAY", "ray::mesh::pierce", place_on_ray()).case("a mesh"),
        whole("PLACED_BALL", "ray::placed_ball", ball_at_pose()),
        whole("PLACED", "plan::clearance::balls", placed()),
        whole("ARM_TURN", "plan::tree::TreeJoint::after", arm_turn()),
        whole("ARM_PLACE", "plan::tree::TreeJoint::after", arm_place()),
        whole("LENGTH", "plan::tree_motion::length", of_length()),
        whole("SHAPE_POINT", "patch::shape_tracker", shape_point()),
        whole("CARRIED", "patch::front::NetEntry", carried()).case("a pose"),
        whole("PARALLEL_AXES", "smooth::parallel::prove", parallel()).sum(
            "with CERTIFICATE, twice",
            &[(2.0, "PARALLEL_AXES"), (1.0, "CERTIFICATE")],
        ),
        whole("INNER", "shape::ellipsoid::inner_ball", inner_ball()),
        whole("WAY", "motion::displacement::displacement", way()),
    ]
}

fn one() -> RBig {
    RBig::ONE
}

fn arrow(most: RBig, error: RBig) -> Arrow {
    Arrow::new(DOUBLE, most, error)
}

fn within(most: RBig, error: RBig) -> Within {
    Within::new(DOUBLE, most, error)
}

/// A length: three squares and two sums, half of which the root leaves, and the root.
fn of_length() -> RBig {
    let square = || Factor::input().squared();
    (square() + square() + square()).root().error()
}

/// The quaternion of a turn. Sine and cosine err by less than one in the last place, so by UNIT of one at most; the axis
/// is divided by its length; what the rounding of the half angle leaves out is counted apart, by the phase.
fn spun() -> RBig {
    let axis = arrow(one(), of_length() + once());
    let sine = within(one(), unit() + once());
    let vector = Lengths::scaled(axis, sine).error();
    let scalar = unit() + once();
    root_above(&(&vector * &vector + &scalar * &scalar))
}

/// The angle of a pose: an error of a quaternion turns by twice as much.
fn turn() -> RBig {
    RBig::from(2) * (spun() + quaternion_of(planes::composed))
}

/// A normalised sum of two quaternions, at a time between both, over a norm of at least the root of a half. The part of
/// the way is off by two roundings, which turns by no more than so much of half a turn.
fn interpolated() -> RBig {
    let part = within(one(), RBig::from(2) * once());
    let [p, q] = [part, part].map(|x| Lengths::scaled(arrow(one(), RBig::ZERO), x));
    // Both parts are no longer than one together.
    let sum = p.error() + q.error() - RBig::from(2) * once() + once();
    let root_of_two = super::root(2);
    RBig::from(2) * (sum * root_of_two + of_length() + once())
}

/// The squared norm of a quaternion over its norm, less one.
fn normalised() -> RBig {
    let four = |of: fn() -> Factor| {
        let square = || of().squared();
        ((square() + square()) + square()) + square()
    };
    fn divided() -> Factor {
        let square = || Factor::input().squared();
        Factor::input() / (((square() + square()) + square()) + square()).root()
    }
    four(divided).error()
}

/// The matrix of a unit quaternion, for a factor that is a quotient by its squared norm.
fn matrix() -> Turn {
    let factor = squared_norm() + once();
    Turn::new(DOUBLE, one(), RBig::from(2) * factor + entries())
}

/// Lengths of a flight: reach of a body, the difference of the translations, pivot, distance to keep, and the ways of the
/// pivots by velocity and by acceleration.
type Sizes = [RBig; 6];

/// The error of the coefficients, for angles that the normal and a body turn by.
fn coefficients(sizes: &Sizes, [spin, rate]: [u32; 2]) -> RBig {
    let [reach, offset, pivot, keep, velocity, acceleration] = sizes;
    let two = Within::exact(2.0);
    let (all, half) = (Within::exact(1.0), Within::exact(0.5));
    let turning = Turning::<Lengths> {
        // A unit vector turned into the world.
        normal: arrow(one() + units(4.0), RBig::ZERO),
        spin: arrow(RBig::from(spin), RBig::ZERO),
        rate: arrow(RBig::from(rate), RBig::ZERO),
    };
    let derivatives = planes::derivatives(&turning, two);
    let [near, far] = planes::directions::<Lengths>(turning.normal, derivatives, [half, all]);
    // The way of a pivot is counted by the 1-norm of the pivot, the pivot twice.
    let pivot = Lengths::product(matrix(), arrow(pivot / RBig::from(2), RBig::ZERO));
    let offset = arrow(offset.clone(), offset * once());
    let between = Lengths::sum(offset, pivot);
    let ways = [
        between,
        arrow(velocity.clone(), velocity * once()),
        arrow(acceleration.clone(), acceleration * once()),
    ];
    let [f0, f1, f2] = planes::way(&turning, ways, two);
    let part = arrow(reach.clone(), RBig::ZERO);
    let none = arrow(RBig::ZERO, RBig::ZERO);
    let height = |direction| planes::height::<Lengths>(matrix(), direction, none, part);
    let taken = within(keep.clone(), once() * keep);
    let b0 = f0 - height(turning.normal) - taken;
    let b1 = f0 + f1 * half - height(near) - taken;
    let b2 = f0 + (f1 + f2 * half) * all - height(far) - taken;
    let third = within(RBig::ONE / RBig::from(3), once());
    let c1 = (b0 + two * b1) * third;
    let c2 = (two * b1 + b2) * third;
    let of = [b0, c1, c2, b2].map(|b| b.error());
    of.into_iter().max().expect("four coefficients")
}

/// Over `(1 + q)^2`, with q the sum of both angles: a form of degree two in them, whose coefficients are those of six
/// pairs of angles.
fn plane() -> RBig {
    let of_size = |k: usize| {
        let sizes: Sizes = std::array::from_fn(|i| if i == k { one() } else { RBig::ZERO });
        let at = |spin, rate| coefficients(&sizes, [spin, rate]);
        let none = at(0, 0);
        let form = |spin: u32, rate: u32| {
            let (x, y) = (at(spin, rate), at(2 * spin, 2 * rate));
            // The value, and twice the argument: the linear and the square part.
            let square = (&y - RBig::from(2) * &x + &none) / RBig::from(2);
            (x - &none - &square, square)
        };
        let ((s, ss), (w, ww)) = (form(1, 0), form(0, 1));
        let mixed = at(1, 1) - &none - &s - &ss - &w - &ww;
        let two = RBig::from(2);
        [none, s / &two, w / &two, ss, ww, mixed / &two]
            .into_iter()
            .max()
            .expect("six coefficients")
    };
    // The length of the normal, times the distance to keep, and the second order.
    (0..6).map(of_size).max().expect("six lengths") + units(5.0)
}

/// Relative to the square of the distance and that of the radii, in lengths and velocities of one: what is counted to the
/// radii has to be more, also times the square of the velocity under the root.
fn balls() -> RBig {
    let unit_vector = arrow(one(), RBig::ZERO);
    let radius = within(one(), RBig::ZERO);
    let more = within(power(-40), RBig::ZERO);
    let [above, .., root] = planes::approach::<Lengths>(unit_vector, unit_vector, radius, more);
    RBig::from(2) * (above.error() + root.error())
}

/// A place by a quaternion that was divided by its length: off by twice the deviation of its square.
fn place() -> RBig {
    RBig::from(2) * normalised() + turned()
}

/// The foot of a ball's middle on a ray of a direction that is one up to its division by its length; the place of the
/// middle is counted at `PLACED_BALL`.
fn ball_of_ray() -> RBig {
    let off = of_length() + once();
    let direction = arrow(one(), off);
    let way = arrow(one(), once());
    let along = Lengths::dot(way, direction);
    let aside = Lengths::sub(way, Lengths::scaled(direction, along));
    let apart = Within::length_of(aside).at_most(one());
    along.error() + apart.error() + units(3.0)
}

/// A place of a ray in a mesh's frame, as the translation of a relative pose, and its height over a triangle's corner along a unit vector.
fn place_on_ray() -> RBig {
    let direction = arrow(one(), of_length() + once());
    let at = Lengths::sum(
        arrow(one(), RBig::ZERO),
        Lengths::scaled(direction, within(one(), RBig::ZERO)),
    );
    let placed = at.error() + translation();
    let n = arrow(one(), of_length() + once());
    // The sum of the lengths is the unit.
    let height = Lengths::dot(n, arrow(one(), placed));
    height.error() + RBig::from(2) * once()
}

/// A place by a quaternion whose square is off one by `POSE_UNIT`.
fn ball_at_pose() -> RBig {
    RBig::from(2) * truth::rational::exact(1e-12) + turned() + units(2.0)
}

/// A rotation that was divided by its length, the sum with the translation; and the distance of two middles less radii.
fn placed() -> RBig {
    place() + once() + once() + of_length() + units(4.0)
}

/// The products with the fixed rotation and with that of the joint, and the division by the length.
fn arm_turn() -> RBig {
    let product = quaternion_of(planes::composed);
    RBig::from(2) * (&product + spun() + product + of_length() + once())
}

/// A vector turned by a rotation, with the value of a prismatic joint, and the sum.
fn arm_place() -> RBig {
    place() + units(8.0) + RBig::from(2) * once()
}

/// The relative rotation as a product of two quaternions, divided by its length; then a place by it.
fn shape_point() -> RBig {
    let product = quaternion_of(planes::composed);
    RBig::from(2) * (product + of_length() + once()) + place() + RBig::from(2) * once()
}

/// A height of a middle at a pose, and the turned direction with the radius of a ball.
fn carried() -> RBig {
    let of_place = rotation() + product() + translation() + once();
    let turned = rotation() + product();
    let n = arrow(one(), of_length() + once());
    let height = Lengths::dot(n, arrow(one(), of_place)).error() + units(4.0);
    height + RBig::from(2) * turned + units(8.0)
}

/// The axis by the matrix and by the rotation, the heights along its normals; see the constant.
fn parallel() -> RBig {
    rotation() + RBig::from(2) * entries() + units(4.0) + units(12.0) + units(9.0)
}

/// `c^2 / (n . s)` of a support point, whose coordinates are products of their own; the normal there is off by as much
/// relative to each coordinate, which counts by its square.
fn inner_ball() -> RBig {
    let support = || {
        let square = || (Factor::input() * Factor::input()).squared();
        Factor::input().squared() * Factor::input() / (square() + square() + square()).root()
    };
    let part = || Factor::input() * support();
    let height = part() + part() + part();
    let radius = (Factor::input() * (Factor::input() / height)) * Factor::input();
    radius.error() + RBig::from(4) * support().error()
}

/// Quaternions off unit length by half of `POSE_UNIT` are nearer to each other by as much at most; differences, squares,
/// roots, and the sum of a way and a turn.
fn way() -> RBig {
    let square = || Factor::difference().squared();
    let four = || (square() + square()) + (square() + square());
    let turn = Factor::input() * four().root();
    let shift = (square() + square() + square()).root();
    (turn + shift).error() + truth::rational::exact(0.51e-12) + units(2.0)
}
