//! The draft of an outcome, in stored units and frames, and what several solvers write into it.
//!
//! Solvers write directions, rounded bounds and features of vertex lists. `is_proven` tests a
//! finished draft.

use core::ops::{Deref, DerefMut};

use nalgebra::{Unit, Vector3};

use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::{Scalar, sqrt};
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{AGREE, CERTIFICATE, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, FeaturePair, VertexId};
use crate::pair::outcome::{ContactState, Outcome};
use crate::pair::posed::PosedPair;

/// Outcome that one solver passes to the next: the fields of an [`Outcome`], in stored units and
/// frames. The bounds are proven only after a certificate accepts them.
///
/// Solvers write the draft in place. It becomes an outcome only at the end of the query
/// ([`into_outcome`](Self::into_outcome)), so no solver can return an unproven outcome to a caller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draft(Outcome);

impl Draft {
    /// Returns a draft that holds only the start of a solver.
    #[inline(always)]
    pub(crate) fn starting_at(pair: FeaturePair) -> Self {
        Self(Outcome::starting_at(pair))
    }

    /// Exchanges the bodies: the draft of B against A becomes the draft of A against B.
    pub(crate) fn swap(&mut self, b_from_a: &RelativePose) {
        self.features = self.features.swapped();
        let draft = &mut self.0;
        core::mem::swap(&mut draft.point_on_a, &mut draft.point_on_b);
        let normal = -b_from_a.rotation().tr_mul(&draft.normal);
        draft.normal = Unit::new_normalize(normal);
    }

    /// Converts stored units and frames to the caller's. Bounds change their unit only here.
    ///
    /// `unit` is a power of two, so only numbers that leave the normal range are rounded. Bounds
    /// are rounded outward.
    #[cold]
    pub(crate) fn scale(&mut self, unit: f64, a: &ConvexPolyhedron, b: &ConvexPolyhedron) {
        self.lower = scaled_down(self.lower, unit);
        self.upper = -scaled_down(-self.upper, unit);
        self.distance *= unit;
        self.point_on_a = a.to_user(&self.point_on_a.coords);
        self.point_on_b = b.to_user(&self.point_on_b.coords);
    }

    /// Returns the finished outcome, in which no zero has a sign.
    #[inline(always)]
    pub(crate) fn into_outcome(mut self) -> Outcome {
        self.0.unsign_zeros();
        self.0
    }
}

/// An outcome in the caller's units from the start, if the bodies are too far apart for a common
/// unit.
impl From<Outcome> for Draft {
    fn from(outcome: Outcome) -> Self {
        Self(outcome)
    }
}

impl Deref for Draft {
    type Target = Outcome;

    #[inline(always)]
    fn deref(&self) -> &Outcome {
        &self.0
    }
}

impl DerefMut for Draft {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut Outcome {
        &mut self.0
    }
}

/// Returns the largest f64 that is no greater than `x` times a power of two.
pub(crate) fn scaled_down(x: f64, unit: f64) -> f64 {
    let y = x * unit;
    // The conversion back is exact, or overflows if the conversion there did.
    if y / unit > x { y.next_down() } else { y }
}

/// Returns the unit vector along `v`; `None` if `v` has no direction.
#[inline]
pub(crate) fn direction(v: &Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let largest = v.amax();
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return None;
    }
    // Divided twice, because a quotient of a subnormal number loses bits.
    let scaled = v / largest;
    Some(Unit::new_unchecked(scaled / sqrt(scaled.norm_squared())))
}

/// Returns the unit vector along `v`, or any unit vector if `v` has no direction.
#[inline]
pub(crate) fn unit(v: &Vector3<f64>) -> Unit<Vector3<f64>> {
    direction(v).unwrap_or_else(Vector3::x_axis)
}

/// Returns `x + by` in f64, rounded away from `x` by the last place.
pub(crate) fn round_outward<T: Scalar>(x: T, by: f64) -> f64 {
    let sum = (x + T::from(by)).value();
    if by < 0.0 { sum.next_down() } else { sum.next_up() }
}

/// Returns the distance of the origins of two frames, rounded, and the direction from A to B.
pub(crate) fn origins_apart(pose: &RelativePose) -> (f64, Vector3<f64>) {
    let sixteenth = pose.translation_sixteenth();
    let length = sixteenth.amax();
    let n = if length > 0.0 { sixteenth / length } else { Vector3::x() };
    let norm = sqrt(n.norm_squared());
    (length * norm * 16.0, n / norm)
}

/// Returns bounds of the distance by the origins alone, and the direction from A to B.
pub(crate) fn far(reach: [f64; 2], pose: &RelativePose) -> (f64, f64, Vector3<f64>) {
    let (distance, n) = origins_apart(pose);
    let slack = distance * (CERTIFICATE * UNIT) + 2.0 * (reach[0] + reach[1]);
    ((distance - slack).at_least(0.0), distance + slack, n)
}

/// Marks an outcome as overlapping, with unknown depth and normal.
///
/// `depth` computes both. The normal has no meaning yet, but is a unit vector.
pub(crate) fn set_overlapping(draft: &mut Draft) {
    draft.state = ContactState::Overlapping;
    draft.distance = 0.0;
    draft.normal = Vector3::x_axis();
    (draft.lower, draft.upper) = (f64::NEG_INFINITY, 0.0);
}

/// Leaves a pair undecided, with the upper bound that any two vertices prove.
///
/// The pair is out of the range of the finer arithmetic.
pub(crate) fn set_undecided(posed: &PosedPair, draft: &mut Draft) {
    let (a, b) = draft.features.vertices_of(posed.a, posed.b);
    let (p, q) = (posed.a.points[a.index()], posed.b.points[b.index()]);
    (draft.point_on_a, draft.point_on_b) = (p.into(), q.into());
    let between = posed.point_in_a(&q) - p;
    draft.normal = unit(&between);
    draft.distance = sqrt(between.norm_squared());
    draft.upper = draft.distance + CERTIFICATE * UNIT * posed.size();
    draft.lower = f64::NEG_INFINITY;
    draft.state = ContactState::Undecided;
}

/// Returns the smallest features that contain one to four vertices of each body, as a state of the
/// walk.
pub(crate) fn walk_state(posed: &PosedPair, a: &[VertexId], b: &[VertexId]) -> FeaturePair {
    let (fa, fb) = (posed.a.feature_of(a), posed.b.feature_of(b));
    let features = FeaturePair { a: fa, b: fb };
    if fa.dimension() + fb.dimension() <= 2 {
        return features;
    }
    // An edge over a face, or two faces: parallel features, so a vertex with the face is closest
    // too.
    match (fa, fb) {
        (Feature::Face(f), _) => FeaturePair::vertex_face(Operand::B, b[0], f),
        (_, Feature::Face(f)) => FeaturePair::vertex_face(Operand::A, a[0], f),
        _ => features,
    }
}

/// Returns whether contact state and distance are proven.
///
/// A separated pair needs bounds no wider than they should be. An overlapping pair needs witnesses
/// that coincide up to rounding, because the weights of a flat tetrahedron around the origin may be
/// wrong in every digit while the signs of its volumes are certain.
pub(crate) fn is_proven(posed: &PosedPair, draft: &Draft) -> bool {
    match draft.state {
        ContactState::Overlapping => {
            let between = posed.point_in_a(&draft.point_on_b.coords) - draft.point_on_a.coords;
            sqrt(between.norm_squared()) <= AGREE * posed.size()
        }
        ContactState::Separated => is_narrow(posed, draft),
        ContactState::Touching | ContactState::Undecided => false,
    }
}

/// Returns whether the bounds are as close as a certified outcome requires.
pub(crate) fn is_narrow(posed: &PosedPair, draft: &Draft) -> bool {
    draft.upper - draft.lower <= (AGREE + 2.0 * CERTIFICATE * UNIT) * posed.size()
}
