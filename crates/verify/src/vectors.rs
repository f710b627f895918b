//! Vectors of functions of x on [0, 1].

use crate::int::Int;
use crate::real::Exact;
use crate::taylor::Taylor;

pub(crate) type Vector<I> = [Taylor<I>; 3];

pub(crate) fn fixed3<I: Int>(v: &Exact) -> Option<Vector<I>> {
    Some([Taylor::fixed(&v[0])?, Taylor::fixed(&v[1])?, Taylor::fixed(&v[2])?])
}

/// Makes a vector of three components that may not fit.
pub(crate) fn each<T>(part: impl Fn(usize) -> Option<T>) -> Option<[T; 3]> {
    Some([part(0)?, part(1)?, part(2)?])
}

pub(crate) fn minus<I: Int>(u: &Vector<I>, v: &Vector<I>) -> Option<Vector<I>> {
    each(|k| u[k].minus(&v[k]))
}

pub(crate) fn dot<I: Int>(u: &Vector<I>, v: &Vector<I>) -> Option<Taylor<I>> {
    u[0].times(&v[0])?.plus(&u[1].times(&v[1])?)?.plus(&u[2].times(&v[2])?)
}

pub(crate) fn cross<I: Int>(u: &Vector<I>, v: &Vector<I>) -> Option<Vector<I>> {
    each(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[i].times(&v[j])?.minus(&u[j].times(&v[i])?)
    })
}
