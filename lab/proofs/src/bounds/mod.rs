//! What each constant of the crate has to cover, proved from the transcribed kernels.

mod bends;
mod boxes;
mod certificate;
mod chains;
mod closed_form;
mod curved;
mod double;
mod motions;
mod patches;
mod paths;
mod places;
mod poses;
mod roots;
mod signs;

pub use poses::{product as turned_by_matrix, product_in, rotation};

use super::majorant::{SINGLE, rounding, unit, unit_of};
use super::norm::root_above;
use super::polynomial::Polynomial;
use dashu_ratio::RBig;

/// A bound that was proved.
pub struct Bound {
    /// The constant of `tolerance`.
    pub constant: &'static str,
    /// The part of its derivation; empty for all of it.
    pub part: &'static str,
    /// The kernel whose rounding it is.
    pub kernel: &'static str,
    /// What is proved, in roundings of the format: UNIT, `UNIT_SINGLE`, or UNIT^2 for double-double.
    pub proved: RBig,
    /// What the bound is compared with.
    pub allowed: Allowed,
}

/// What a bound is compared with.
#[derive(Clone, Copy, Debug)]
pub enum Allowed {
    /// The constant as the source has it.
    Constant,
    /// A sum of so many of these constants: what the code adds up.
    Sum(&'static [(f64, &'static str)]),
    /// What the derivation of the constant gives a part, no more than the constant.
    Part(f64),
}

impl Bound {
    /// All of a constant of single precision.
    fn single(constant: &'static str, kernel: &'static str, error: RBig) -> Self {
        Self {
            proved: error / unit_of(SINGLE),
            ..Self::whole(constant, kernel, RBig::ZERO)
        }
    }

    /// All of a constant.
    fn whole(constant: &'static str, kernel: &'static str, error: RBig) -> Self {
        Self {
            constant,
            part: "",
            kernel,
            proved: error / unit(),
            allowed: Allowed::Constant,
        }
    }

    /// A part of the derivation of a constant.
    fn part(self, part: &'static str, allowed: f64) -> Self {
        Self {
            part,
            allowed: Allowed::Part(allowed),
            ..self
        }
    }

    /// One of the cases of a constant, each of which has all of it.
    fn case(self, part: &'static str) -> Self {
        Self { part, ..self }
    }

    /// A bound that the code makes of several constants.
    fn sum(self, part: &'static str, of: &'static [(f64, &'static str)]) -> Self {
        Self {
            part,
            allowed: Allowed::Sum(of),
            ..self
        }
    }
}

/// All bounds.
pub fn all() -> Vec<Bound> {
    [
        signs::bounds(),
        poses::bounds(),
        certificate::bounds(),
        closed_form::bounds(),
        curved::bounds(),
        places::bounds(),
        patches::bounds(),
        paths::bounds(),
        double::bounds(),
        roots::bounds(),
        chains::bounds(),
        motions::bounds(),
        boxes::bounds(),
        bends::bounds(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// One rounding.
fn once() -> RBig {
    rounding(53)
}

/// A number of roundings to first order.
fn units(count: f64) -> RBig {
    truth::rational::exact(count) * unit()
}

/// The root of a whole number, rounded up.
pub fn root(square: u32) -> RBig {
    root_above(&RBig::from(square))
}

/// The absolute terms of a dot product.
fn terms(a: char, b: char) -> Polynomial {
    (0..3).fold(Polynomial::default(), |sum, k| {
        sum.plus(&Polynomial::variable(a, k).times(&Polynomial::variable(b, k)))
    })
}
