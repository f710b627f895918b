//! What follows a walk that the certificate refuses: each layer finer and slower than the one before.

use nalgebra::{Point3, Unit, Vector3};

use super::fallback::{Minimum, solve};
use super::outcome::{Class, Layer, Outcome};
use super::placed::{Frame, Placed};
use super::simplex::Simplex;
use super::{certified_walk, seed};
use crate::double_double::DoubleDouble;
use crate::polyhedron::topology::MANY;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pose::Which;
use crate::scalar::Scalar;
use crate::tolerance::{AGREE, CERTIFICATE, UNIT};

/// Restart, fallback, double-double, exact: the first that proves its outcome.
#[cold]
pub(crate) fn refine(placed: &Placed, warm: bool, outcome: &mut Outcome) {
    if warm && placed.has_one_unit() {
        outcome.work.restarts += 1;
        outcome.features = seed::cold(placed, &mut outcome.work);
        outcome.layer = Layer::Restart;
        if certified_walk(placed, outcome) {
            return;
        }
    }
    outcome.work.fallbacks += 1;
    outcome.layer = Layer::Fallback;
    take(placed, &solve(placed, &Frame::of(placed), outcome.features), outcome);
    if !is_proven(placed, outcome) {
        doubled(placed, outcome);
    }
}

/// The f64 solver alone, its bounds not looked at.
#[cold]
pub(crate) fn unchecked(placed: &Placed, outcome: &mut Outcome) {
    outcome.work.fallbacks += 1;
    outcome.layer = Layer::Fallback;
    take(placed, &solve(placed, &Frame::of(placed), outcome.features), outcome);
}

/// The double-double layer and what follows it.
fn doubled(placed: &Placed, outcome: &mut Outcome) {
    outcome.work.double_doubles += 1;
    outcome.layer = Layer::DoubleDouble;
    match Frame::<DoubleDouble>::new(placed.a, placed.b, placed.pose) {
        Some(frame) => take(placed, &solve(placed, &frame, outcome.features), outcome),
        None => give_up(placed, outcome),
    }
    if !is_proven(placed, outcome) {
        last(placed, outcome);
    }
}

/// What no floating-point arithmetic decides.
#[cfg(feature = "exact")]
fn last(placed: &Placed, outcome: &mut Outcome) {
    outcome.work.exacts += 1;
    super::exact::settle(placed, outcome);
}

/// Without the exact rung, bounds that are narrow and straddle zero are called touching.
#[cfg(not(feature = "exact"))]
fn last(placed: &Placed, outcome: &mut Outcome) {
    outcome.class = match outcome.class {
        Class::Overlapping => Class::Overlapping,
        _ if is_narrow(placed, outcome) => Class::Touching,
        _ => Class::Undecided,
    };
}

/// The distance of a separated pair within one unit in the last place: by the double-double layer where its bounds
/// are that close, else by the exact rung.
#[cfg(feature = "exact")]
pub(crate) fn sharpen(placed: &Placed, outcome: &mut Outcome) {
    if outcome.class != Class::Separated || outcome.layer == Layer::Exact {
        return;
    }
    outcome.work.double_doubles += 1;
    outcome.layer = Layer::DoubleDouble;
    if let Some(frame) = Frame::<DoubleDouble>::new(placed.a, placed.b, placed.pose) {
        let minimum = solve(placed, &frame, outcome.features);
        if let Minimum::Outside { simplex, lower, .. } = &minimum {
            let distance = simplex.reach();
            let gap = (distance - *lower).value().abs()
                + 2.0 * CERTIFICATE * DoubleDouble::UNIT * placed.reach::<DoubleDouble>().whole();
            let d = distance.value();
            // Rounding takes half a unit; what is left open must not take the other half.
            if gap <= 0.25 * (d - d.next_down()) {
                take(placed, &minimum, outcome);
                (outcome.distance, outcome.lower, outcome.upper) = (d, d.next_down(), d.next_up());
                return;
            }
        }
    }
    last(placed, outcome);
}

/// Whether class and distance are settled: apart with bounds no wider than they should be, or overlapping with witnesses
/// that are one point up to rounding (the weights of a flat tetrahedron around the origin may be wrong in every digit
/// while the signs of its volumes are certain).
fn is_proven(placed: &Placed, outcome: &Outcome) -> bool {
    match outcome.class {
        Class::Overlapping => {
            let between = placed.point_in_a(&outcome.point_on_b.coords) - outcome.point_on_a.coords;
            crate::scalar::sqrt(between.norm_squared()) <= AGREE * placed.size()
        }
        Class::Separated => is_narrow(placed, outcome),
        Class::Touching | Class::Undecided => false,
    }
}

/// Whether the bounds agree as well as a certified answer's must.
fn is_narrow(placed: &Placed, outcome: &Outcome) -> bool {
    outcome.upper - outcome.lower <= (AGREE + 2.0 * CERTIFICATE * UNIT) * placed.size()
}

/// Takes over what a solve proves, and its witnesses.
fn take<T: Scalar>(placed: &Placed, minimum: &Minimum<T>, outcome: &mut Outcome) {
    let term = CERTIFICATE * T::UNIT * placed.reach::<T>().whole();
    let (Minimum::Inside { simplex } | Minimum::Outside { simplex, .. }) = minimum;
    outcome.features = features(placed, simplex);
    (outcome.point_on_a, outcome.point_on_b) = witnesses(placed, simplex);
    match minimum {
        Minimum::Inside { .. } => overlapping(outcome),
        Minimum::Outside {
            simplex,
            lower,
            direction: d,
        } => {
            let distance = simplex.reach();
            outcome.lower = outward(*lower, -term);
            outcome.upper = outward(distance, term);
            outcome.class = if outcome.lower > 0.0 {
                Class::Separated
            } else {
                Class::Undecided
            };
            outcome.distance = distance.value().clamp(outcome.lower.max(0.0), outcome.upper.max(0.0));
            outcome.normal = unit(&Vector3::new(-d[0].value(), -d[1].value(), -d[2].value()));
        }
    }
}

/// The witnesses of a tetrahedron around the origin; features stay those of the answer before. Whether that settles the overlap.
pub(super) fn take_overlap(placed: &Placed, simplex: &Simplex<f64>, outcome: &mut Outcome) -> bool {
    (outcome.point_on_a, outcome.point_on_b) = witnesses(placed, simplex);
    overlapping(outcome);
    is_proven(placed, outcome)
}

/// Depth and normal of an overlap are not known here (they are the work of `penetration`); the direction has no meaning
/// yet, but it is a unit vector.
pub(super) fn overlapping(outcome: &mut Outcome) {
    outcome.class = Class::Overlapping;
    outcome.distance = 0.0;
    outcome.normal = Vector3::x_axis();
    (outcome.lower, outcome.upper) = (f64::NEG_INFINITY, 0.0);
}

/// The unit vector along `v`; some unit vector where `v` has no direction.
#[inline]
pub(crate) fn unit(v: &Vector3<f64>) -> Unit<Vector3<f64>> {
    let largest = v.amax();
    if largest > 0.0 && largest < f64::INFINITY {
        let scaled = v / largest;
        Unit::new_unchecked(scaled / crate::scalar::sqrt(scaled.norm_squared()))
    } else {
        Vector3::x_axis()
    }
}

/// Out of the range of the finer arithmetic: what any two vertices prove.
pub(super) fn give_up(placed: &Placed, outcome: &mut Outcome) {
    let (a, b) = outcome.features.vertices_of(placed.a, placed.b);
    let (p, q) = (placed.a.points[a as usize], placed.b.points[b as usize]);
    (outcome.point_on_a, outcome.point_on_b) = (p.into(), q.into());
    let between = placed.point_in_a(&q) - p;
    outcome.normal = unit(&between);
    outcome.distance = crate::scalar::sqrt(between.norm_squared());
    outcome.upper = outcome.distance + CERTIFICATE * UNIT * placed.size();
    outcome.lower = f64::NEG_INFINITY;
    outcome.class = Class::Undecided;
}

/// `x + by`, rounded away from `x` by the last place, in f64.
pub(crate) fn outward<T: Scalar>(x: T, by: f64) -> f64 {
    let sum = (x + T::from(by)).value();
    if by < 0.0 { sum.next_down() } else { sum.next_up() }
}

/// The convex combinations of the corners' vertices, each in its body's stored frame.
pub(crate) fn witnesses<T: Scalar>(placed: &Placed, simplex: &Simplex<T>) -> (Point3<f64>, Point3<f64>) {
    let (mut on_a, mut on_b) = ([T::from(0.0); 3], [T::from(0.0); 3]);
    for (c, &w) in simplex.kept().iter().zip(simplex.weights()) {
        let (p, q) = (placed.a.points[c.a as usize], placed.b.points[c.b as usize]);
        for k in 0..3 {
            on_a[k] = on_a[k] + w * T::from(p[k]);
            on_b[k] = on_b[k] + w * T::from(q[k]);
        }
    }
    (
        Point3::from(on_a.map(|c| c.value())),
        Point3::from(on_b.map(|c| c.value())),
    )
}

/// The smallest features that hold the corners' vertices.
pub(super) fn features<T: Scalar>(placed: &Placed, simplex: &Simplex<T>) -> FeaturePair {
    let (mut a, mut b) = ([0; 4], [0; 4]);
    for (k, c) in simplex.kept().iter().enumerate() {
        (a[k], b[k]) = (c.a, c.b);
    }
    state_of(placed, &a[..simplex.len()], &b[..simplex.len()])
}

/// The smallest features that hold one to four vertices of each body.
pub(crate) fn state_of(placed: &Placed, a: &[u32], b: &[u32]) -> FeaturePair {
    let (fa, fb) = (placed.a.feature_of(a), placed.b.feature_of(b));
    let features = FeaturePair { a: fa, b: fb };
    if fa.dimension() + fb.dimension() <= 2 {
        return features;
    }
    // An edge over a face, or two faces: parallel features, of which a vertex beside the face is closest too.
    match (fa, fb) {
        (Feature::Face(f), _) => FeaturePair::vertex_face(Which::B, b[0], f.0),
        (_, Feature::Face(f)) => FeaturePair::vertex_face(Which::A, a[0], f.0),
        _ => features,
    }
}

impl ConvexPolyhedron {
    /// The smallest feature that holds the given vertices (one to four, with repeats); the first vertex where no face
    /// holds them all.
    ///
    /// The candidates are those about the vertex of fewest edges toward another.
    pub(crate) fn feature_of(&self, vertices: &[u32]) -> Feature {
        let t = &self.topology;
        let first = vertices[0];
        let v = vertices
            .iter()
            .fold(first, |v, &x| if t.fan(x).len() < t.fan(v).len() { x } else { v });
        let Some(&w) = vertices.iter().find(|&&w| w != v) else {
            return Feature::Vertex(VertexId(v));
        };
        if vertices.iter().all(|&x| x == v || x == w)
            && let Some(h) = self.toward(v, w).find(|&h| t.half_edge(h).to == w)
        {
            return Feature::Edge(EdgeId(t.edge(h)));
        }
        // Among many faces or corners the exact plane of the face tells.
        let is_at = |x: u32, f: u32| {
            if t.fan(x).len() > MANY {
                self.face_side(f, &self.points[x as usize]) == 0.0
            } else {
                t.fan(x).any(|h| t.half_edge(h).face == f)
            }
        };
        let holds = |f: u32| vertices.iter().all(|&x| x == v || is_at(x, f));
        match self.toward(v, w).map(|h| t.half_edge(h).face).find(|&f| holds(f)) {
            Some(f) => Feature::Face(FaceId(f)),
            None => Feature::Vertex(VertexId(first)),
        }
    }
}
