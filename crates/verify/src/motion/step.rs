//! Steps from the world to a body: constant poses, shifts and turns.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use dashu_ratio::RBig;

use super::Span;
use crate::int::Int;
use crate::pose::Pose;
use crate::real::{Exact, dot as exact_dot};
use crate::taylor::Taylor;
use crate::turn::turn;
use crate::vectors::{Vector, cross, dot, each, fixed3};

/// One step of the way from the world to a body.
pub(crate) enum Step<I> {
    Place([Vector<I>; 3], Vector<I>),
    /// Polynomials in time.
    Shift([Vec<RBig>; 3]),
    Turn(Turn<I>),
}

type Known<I> = RefCell<HashMap<(u64, u64), Rc<[Taylor<I>; 2]>>>;

/// exp([axis] angle), the angle a polynomial in time; square is that of the axis.
pub(crate) struct Turn<I> {
    axis: Vector<I>,
    square: RBig,
    angle: Vec<RBig>,
    known: Known<I>,
}

impl<I: Int> Turn<I> {
    pub(crate) fn new(axis: &Exact, angle: Vec<RBig>) -> Option<Self> {
        Some(Self {
            axis: fixed3(axis)?,
            square: exact_dot(axis, axis),
            angle,
            known: Known::default(),
        })
    }

    /// Returns s and u of lemma 1.
    fn over(&self, span: &Span) -> Option<Rc<[Taylor<I>; 2]>> {
        let key = (span.from.bits(), span.until.bits());
        let mut known = self.known.borrow_mut();
        if let Some(parts) = known.get(&key) {
            return Some(parts.clone());
        }
        let parts = Rc::new(turn(&self.square, &span.moved(&self.angle))?);
        if known.len() == 1024 {
            known.clear();
        }
        known.insert(key, parts.clone());
        Some(parts)
    }

    pub(crate) fn point(&self, x: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        let (parts, once) = (self.over(span)?, cross(&self.axis, x)?);
        let twice = cross(&self.axis, &once)?;
        each(|k| x[k].plus(&parts[0].times(&once[k])?)?.plus(&parts[1].times(&twice[k])?))
    }

    fn row(&self, m: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        let (parts, once) = (self.over(span)?, cross(m, &self.axis)?);
        let twice = cross(&once, &self.axis)?;
        each(|k| m[k].plus(&parts[0].times(&once[k])?)?.plus(&parts[1].times(&twice[k])?))
    }
}

impl<I: Int> Step<I> {
    pub(crate) fn place(pose: &Pose, unit: &RBig) -> Option<Self> {
        let rows = each(|k| fixed3(&pose.rows[k]))?;
        Some(Self::Place(rows, fixed3(&pose.shift.each_ref().map(|x| x * unit))?))
    }

    pub(crate) fn point(&self, x: &Vector<I>, span: &Span) -> Option<Vector<I>> {
        match self {
            Self::Place(rows, shift) => each(|k| dot(&rows[k], x)?.plus(&shift[k])),
            Self::Shift(way) => each(|k| x[k].plus(&Taylor::polynomial(&span.moved(&way[k]))?)),
            Self::Turn(turn) => turn.point(x, span),
        }
    }

    /// Of m . (step of x) + o the new m and o.
    pub(crate) fn plane(&self, m: &Vector<I>, o: &Taylor<I>, span: &Span) -> Option<(Vector<I>, Taylor<I>)> {
        Some(match self {
            Self::Place(rows, shift) => {
                let column = |k: usize| {
                    m[0].times(&rows[0][k])?
                        .plus(&m[1].times(&rows[1][k])?)?
                        .plus(&m[2].times(&rows[2][k])?)
                };
                (each(column)?, o.plus(&dot(m, shift)?)?)
            }
            Self::Shift(way) => {
                let way = each(|k| Taylor::polynomial(&span.moved(&way[k])))?;
                (m.clone(), o.plus(&dot(m, &way)?)?)
            }
            Self::Turn(turn) => (turn.row(m, span)?, o.clone()),
        })
    }
}
