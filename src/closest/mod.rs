//! The Lin-Canny core: from a pair of features to the closest pair, with proof.
//!
//! 1. **Walk** ([`walk`]): from the cached pair, or from the support vertices along the line of centres ([`seed`]).
//! 2. **Certify**: witnesses against supporting planes. Agreement within `32 UNIT L` is an answer; its bounds are
//!    widened by the error term and reported.
//! 3. Where they do not agree: both supports along the same direction are proven afresh; a walk from a cached pair is
//!    started again from the support vertices; then comes the minimum-norm solver in f64, the same in double-double,
//!    and the exact rung ([`fallback`], `exact`). Each is judged by bounds of its own.
//!
//! The class is never guessed: separated needs a positive lower bound, overlapping a tetrahedron of the Minkowski
//! difference around the origin. Bounds that straddle zero send the pair to the next finer arithmetic.

mod edge_edge;
#[cfg(feature = "exact")]
pub(crate) mod exact;
pub(crate) mod fallback;
mod fan;
pub(crate) mod far;
pub(crate) mod outcome;
pub(crate) mod placed;
mod refine;
pub(crate) mod seed;
pub(crate) mod simplex;
mod slide;
pub(crate) mod state;
pub(crate) mod trace;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;
pub(crate) mod walk;

use nalgebra::Vector3;

use crate::certificate;
use crate::tolerance::{AGREE, CERTIFICATE, UNIT};
use outcome::{Class, Layer, Work};
use placed::Placed;
use state::{Found, State};

/// An answer in stored units and frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) class: Class,
    pub(crate) distance: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) state: State,
    /// In A's stored frame.
    pub(crate) point_a: Vector3<f64>,
    /// In B's stored frame.
    pub(crate) point_b: Vector3<f64>,
    /// From A to B in A's frame, of any length that is not zero.
    pub(crate) normal: Vector3<f64>,
    pub(crate) layer: Layer,
    pub(crate) work: Work,
}

/// The answer of the walk with its certificate, or `None` and how far it got.
#[inline]
pub(crate) fn certified_walk(placed: &Placed, start: State, layer: Layer, work: &mut Work) -> Result<Answer, State> {
    let walk = walk::walk::<true>(placed, start);
    work.steps += walk.steps;
    work.certificates += 1;
    let Some(found) = walk.found else {
        return Err(walk.state);
    };
    let agree = AGREE * placed.size();
    // Comparisons are written so that NaN refuses.
    if found.distance - found.lower <= agree {
        return separated(placed, walk.state, &found, layer, work);
    }
    let (a, b) = walk.state.vertices_of(placed.a, placed.b);
    let found = Found {
        lower: certificate::supports(placed, &found.normal, a, b),
        ..found
    };
    if found.distance - found.lower <= agree {
        return separated(placed, walk.state, &found, layer, work);
    }
    Err(walk.state)
}

/// Takes the error terms and refuses what they leave open.
#[inline]
fn separated(placed: &Placed, state: State, found: &Found, layer: Layer, work: &Work) -> Result<Answer, State> {
    let term = CERTIFICATE * UNIT * placed.size();
    let (lower, upper) = (found.lower - term, found.distance + term);
    if !(lower > 0.0) {
        return Err(state);
    }
    Ok(Answer {
        class: Class::Separated,
        distance: found.distance,
        lower,
        upper,
        state,
        point_a: found.point_a,
        point_b: found.point_b,
        normal: found.normal,
        layer,
        work: *work,
    })
}

/// The certified answer, from `start` where there is one.
#[inline]
pub(crate) fn certified(placed: &Placed, start: Option<State>) -> Answer {
    let mut work = Work::default();
    let first = start.unwrap_or_else(|| seed::facing(placed));
    match certified_walk(placed, first, Layer::Walk, &mut work) {
        Ok(answer) => answer,
        Err(state) => refine::refine(placed, state, start.is_some(), &mut work),
    }
}

/// The certified answer, sharpened to one unit in the last place where the bodies are apart, and with an exact class.
#[cfg(feature = "exact")]
pub(crate) fn exactly(placed: &Placed, start: Option<State>) -> Answer {
    refine::sharpen(placed, certified(placed, start))
}

/// The walk's word for it, or the f64 solver's where the walk does not end.
pub(crate) fn proposed(placed: &Placed, start: Option<State>) -> Answer {
    let mut work = Work::default();
    let walk = walk::walk::<false>(placed, start.unwrap_or_else(|| seed::facing(placed)));
    work.steps += walk.steps;
    let Some(found) = walk.found else {
        return refine::unchecked(placed, walk.state, &mut work);
    };
    Answer {
        class: Class::Separated,
        distance: found.distance,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        state: walk.state,
        point_a: found.point_a,
        point_b: found.point_b,
        normal: found.normal,
        layer: Layer::Walk,
        work,
    }
}
