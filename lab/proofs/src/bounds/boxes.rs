//! Boxes and fronts of compounds.
//!
//! Bounds are linear in the lengths of a pair, which sum up to its size: each is the greatest of what a pair of which
//! one length alone is there has to bear.

use super::{Bound, root};
use crate::kernels::boxes::{self, Oriented};
use crate::majorant::{DOUBLE, SINGLE, power, rounding, unit, unit_of};
use crate::norm::length;
use crate::number::Number;
use crate::polynomial::Polynomial;
use crate::vectors::{Arrow, Lengths, Turn, Vectors, Within};
use dashu_ratio::RBig;
use truth::rational::exact;

pub(super) fn bounds() -> Vec<Bound> {
    let single = |part, kernel, error: RBig| Bound::single("BOXES", kernel, error).case(part);
    let worst = |of: fn(&Sizes) -> RBig| Sizes::all().iter().map(of).max().expect("sizes");
    vec![
        single("line of centres", "query::box_gaps::bound_eight", worst(centres)),
        single("excess of A", "query::box_gaps::excess", worst(excess_of_a)),
        single("excess of B", "query::box_gaps::excess", worst(excess_of_b)),
        single("direction", "query::box_gaps::offer", worst(direction)),
        single("front", "front::FrontBlock::gaps", worst(front)),
        single("front, segments", "front::FrontBlock::gaps", worst(front_of_segments)),
        Bound::single("BOXES", "tree::OrientedBox::rod", around()).part("about a segment", 32.0),
        Bound::whole("BOX_EXTENT", "tree::fit::store_extents", extent()),
        Bound::single("REFIT_HEIGHT", "tree::eight::FittedEight::new", refit_height()),
        Bound::single("BOX_SKEW", "tree::eight::FittedEight::new", skew()),
        Bound::whole("SLAB_HEIGHT", "tree::fit::flat_axes", gram())
            .sum("a point of three heights", &[(2.0, "SLAB_HEIGHT")]),
    ]
}

fn single(most: RBig, error: RBig) -> Arrow {
    Arrow::new(SINGLE, most, error)
}

/// One rounding of single precision.
fn v() -> RBig {
    rounding(SINGLE)
}

/// The lengths of a pair: distances of the centres from the origins of their trees, radii, the distance of the origins.
struct Sizes {
    centres: [RBig; 2],
    radii: [RBig; 2],
    shift: RBig,
}

impl Sizes {
    fn all() -> [Self; 5] {
        [0, 1, 2, 3, 4].map(|k| {
            let at = |i: usize| if i == k { RBig::ONE } else { RBig::ZERO };
            Self {
                centres: [at(0), at(1)],
                radii: [at(2), at(3)],
                shift: at(4),
            }
        })
    }

    /// A bound of the distance of the centres.
    fn between(&self) -> RBig {
        &self.centres[0] + &self.centres[1] + &self.shift
    }

    /// The radius of the smaller node is at most half of the sum.
    fn smaller(&self) -> RBig {
        (&self.radii[0] + &self.radii[1]) / RBig::from(2)
    }

    /// Each half extent is at most the radius.
    fn half(&self, k: usize) -> Arrow {
        single(root(3) * &self.radii[k], RBig::ZERO)
    }

    fn posed(&self) -> boxes::Posed<Lengths> {
        let of = |k: usize| Oriented {
            axes: axes(),
            centre: single(self.centres[k].clone(), RBig::ZERO),
            half: self.half(k),
        };
        boxes::posed::<Lengths>(rotation(), self.shift(), [&of(0), &of(1)])
    }

    /// Rounded once.
    fn shift(&self) -> Arrow {
        single(self.shift.clone(), &self.shift * v())
    }
}

/// Axes as stored, without an error: what is computed is a proof for them.
fn axes() -> Turn {
    Turn::new(SINGLE, RBig::ONE + longer(), RBig::ZERO)
}

/// By how much rows of axes may stretch, each coordinate rounded once, of axes that are orthonormal in double precision
/// within a part of that.
fn longer() -> RBig {
    root(3) * v() + power(-40)
}

/// The largest length of what the product of the axes with each other differs from the identity by.
fn skew() -> RBig {
    longer() * (RBig::from(2) + longer())
}

/// A matrix rounded once.
fn rotation() -> Turn {
    Turn::new(SINGLE, RBig::ONE, root(3) * v())
}

/// The inverse of a length, with the product that is taken with it: three squares and two sums, half of which the root
/// leaves, root, quotient and product.
fn inverse() -> RBig {
    (RBig::ONE + v()).pow(5) - RBig::ONE
}

/// The error of a gap, from the error of the gap times a length: the quotient, and the direction as rounded, longer or
/// shorter than one by as much and by the rounding of a combination of axes, `made`.
fn gap(sizes: &Sizes, numerator: Within, made: &RBig) -> RBig {
    let most = sizes.between() + numerator.error();
    numerator.error() + (inverse() * RBig::from(2) + made) * most
}

/// The direction is the computed difference of the centres, of length one: exact as such, and off as the difference.
fn centres(sizes: &Sizes) -> RBig {
    let posed = sizes.posed();
    let c = single(RBig::ONE, RBig::ZERO);
    let along = [Lengths::product(axes(), c), Lengths::product(posed.axes_b, c)];
    let half = [sizes.half(0), sizes.half(1)];
    let [a, b] = [0, 1].map(|k| Lengths::dot(half[k], along[k]));
    gap(sizes, Lengths::dot(c, posed.between) - a - b, &RBig::ZERO)
}

/// The excess vector has length one; the direction is the combination of the axes with it.
fn excess(sizes: &Sizes, own: usize, skewed: &RBig) -> RBig {
    let posed = sizes.posed();
    let e = single(RBig::ONE, RBig::ZERO);
    let over = Lengths::sub(posed.along[own], sizes.half(own));
    let numerator = boxes::excess::<Lengths>([e, e], over, sizes.half(1 - own), posed.products);
    let of_axes = sizes.half(own).most() * skewed;
    let made = Lengths::product(axes(), e);
    gap(sizes, numerator, &(made.error() + longer())) + of_axes
}

fn excess_of_a(sizes: &Sizes) -> RBig {
    excess(sizes, 0, &skew())
}

/// The axes of B are turned, so they are off by more.
fn excess_of_b(sizes: &Sizes) -> RBig {
    let off = sizes.posed().axes_b.error() * (RBig::ONE + longer());
    excess(sizes, 1, &(skew() + off))
}

/// A direction of length one, exact whatever it is.
fn direction(sizes: &Sizes) -> RBig {
    let posed = sizes.posed();
    let c = single(RBig::ONE, RBig::ZERO);
    let half = [sizes.half(0), sizes.half(1)];
    let numerator = boxes::along::<Lengths>(c, posed.between, half, [axes(), posed.axes_b]);
    gap(sizes, numerator, &RBig::ZERO)
}

/// Made at one pose and tested at another; the ball is that of the smaller node. The direction may have been turned into
/// the other frame, which moves heights by its error times the size, and makes it longer.
fn entry(sizes: &Sizes, radius: &RBig, segment: &RBig) -> RBig {
    let turned = Lengths::product(rotation(), single(RBig::ONE + inverse(), RBig::ZERO));
    let moved = turned.error() * RBig::from(2);
    let n = single(RBig::ONE + inverse() + turned.error(), RBig::ZERO);
    let centre = single(&sizes.centres[0] + &sizes.centres[1], RBig::ZERO);
    let claim = Within::new(SINGLE, sizes.between(), RBig::ZERO);
    let pose = (rotation(), sizes.shift());
    let (m, base) = boxes::entry::<Lengths>(pose, n, centre, claim);
    let (turn, gap) = boxes::carried::<Lengths>(pose, [n, m], centre, base);
    let taken = Within::new(SINGLE, radius.clone(), RBig::ZERO) * Within::length_of(turn);
    // The segment is the product of an axis with a half extent, rounded once.
    let rod = Lengths::dot(turn, single(segment.clone(), segment * v()));
    let left = if *segment == RBig::ZERO {
        gap - taken
    } else {
        gap - taken - rod.abs()
    };
    left.error() + moved
}

fn front(sizes: &Sizes) -> RBig {
    entry(sizes, &sizes.smaller(), &RBig::ZERO)
}

/// The radius about a segment is less than a third of that of the ball.
fn front_of_segments(sizes: &Sizes) -> RBig {
    let r = sizes.smaller();
    entry(sizes, &(&r / RBig::from(3)), &r)
}

/// Two axes that are stored with an error span a point; the root of two squares, rounded to single precision.
fn around() -> RBig {
    longer() + ((RBig::ONE + v()).pow(4) - RBig::ONE) + power(-40)
}

/// A point's coordinate along a dual axis, `y x z / (x . (y x z))`, over lengths up to four.
fn extent() -> RBig {
    let axis = Arrow::new(DOUBLE, RBig::ONE + longer(), RBig::ZERO);
    let across = Lengths::cross(axis, axis);
    let volume = Lengths::dot(axis, across);
    // The volume is one but for the skew of three axes.
    let least = RBig::ONE - RBig::from(3) * skew();
    let relative = volume.error() / &least + rounding(DOUBLE);
    let most = across.most() / &least;
    let dual = Arrow::new(DOUBLE, most.clone(), across.error() / least + most * relative);
    let four = RBig::from(4);
    // A place is rounded once, and its difference from the centre once.
    let point = Arrow::new(DOUBLE, four.clone(), four * RBig::from(2) * rounding(DOUBLE));
    Lengths::dot(dual, point).error()
}

/// The height of a place of length one that is rounded once over a centre up to `sqrt 3` as far.
fn refit_height() -> RBig {
    let axis = single(RBig::ONE + longer(), RBig::ZERO);
    let vertex = Lengths::dot(axis, single(RBig::ONE, v()));
    let centre = Lengths::dot(axis, single(root(3) * (RBig::ONE + power(-10)), RBig::ZERO));
    (vertex - centre).error().clone()
}

/// `I - sum of a a^T` for a normal of length one, an axis made perpendicular to it and divided by its length, and the cross
/// product of both.
fn gram() -> RBig {
    let u = unit();
    // A length: three squares and two sums, half of which the root leaves, root and quotient; squared.
    let unit_length = RBig::from(2) * (RBig::from(7) / RBig::from(2)) * &u * (RBig::ONE + power(-40));
    let n = Arrow::new(DOUBLE, RBig::ONE, RBig::ZERO);
    // The axis before has a cosine of a tenth, see `FLAT` in `tree::fit`.
    let cosine = exact(0.1001);
    let height = Lengths::dot(n, n);
    let part = Lengths::scaled(n, Within::new(DOUBLE, cosine.clone(), height.error()));
    let off = part.error() + &u + &cosine * &unit_length;
    let off = (off / exact(0.994) + &u) * (RBig::ONE + unit_of(20));
    let wide = Lengths::cross(n, n).error();
    let wide_length = RBig::from(2) * &unit_length + RBig::from(2) * &wide;
    let rows: [[RBig; 3]; 3] = [
        [unit_length.clone(), off.clone(), wide.clone()],
        [off, unit_length, wide.clone()],
        [wide.clone(), wide, wide_length],
    ];
    let errors = rows.map(|row| {
        (0..3u8).fold(Polynomial::default(), |sum, k| {
            sum.plus(&Polynomial::variable('p', k).scaled(&row[k as usize]))
        })
    });
    length(&errors.each_ref(), &[])
}
