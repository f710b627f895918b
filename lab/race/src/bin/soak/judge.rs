//! Judges an outcome without the crate: bounds, normal and witnesses against the points of the
//! bodies.
//!
//! 1. Each frame is judged in `f64`, with an allowance for its rounding.
//! 2. Outcomes that fail there, and a share of the others, are judged by exact arithmetic.
//! 3. Three frames of each trial are also compared with the naive oracle, if the bodies are small.
//!    It computes the true distance.

use lin_canny::{ContactState, Manifold, Outcome};
use truth::motion::Frame;
use truth::pose::{add, cross, dot, norm, scale, sub, unit};
use truth::rng::Rng;
use truth::shapes::Shape;
use truth::support;
use truth::{Body, Point, Pose, bound, exact};

use crate::draw::{Drawn, Trial};

/// Half a unit in the last place of 1.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Fraction of the extents of the bodies that is added to the size of the pair, for coordinates
/// much larger than the pair.
const FAR: f64 = 1.0 / (1u64 << 48) as f64;

/// Promised width of bounds, in units of the pair's size.
const WIDTH: f64 = 1e-13;

/// One body as the judge sees it: the points of which it was made, and the faces that it reports.
pub(crate) struct Side {
    shape: Shape,
    /// A vertex and the unit normal of each face, in `f64`.
    planes: Vec<(Point, Point)>,
    /// Centre of the radius.
    middle: Point,
    radius: f64,
    /// Greatest distance of a point from the body's origin.
    reach: f64,
    /// The same shape with exactly computed faces, for the oracle.
    small: Option<Shape>,
}

impl Side {
    fn new(drawn: &Drawn) -> Self {
        let body = &drawn.body;
        let rim = |f| {
            let source = |v| body.source_vertex(v).expect("a vertex was a point") as u32;
            body.face_vertices(f).map(source).collect::<Vec<u32>>()
        };
        let points = drawn.shape.points.clone();
        let faces: Vec<_> = body.faces().map(rim).collect();
        let plane = |f: &Vec<u32>| {
            let at = |k: usize| points[f[k] as usize];
            let fan = (2..f.len()).map(|k| cross(sub(at(k - 1), at(0)), sub(at(k), at(0))));
            (at(0), unit(fan.fold([0.0; 3], add)))
        };
        let planes = faces.iter().map(plane).collect();
        // The centre of L: the middle of the box, with zero in every coordinate in which it is
        // within two half diagonals of the body's origin. A single point has centre zero.
        let bound = |worse: fn(f64, f64) -> f64| {
            let corner = |p: Point, q: &Point| std::array::from_fn(|k| worse(p[k], q[k]));
            points.iter().fold(points[0], corner)
        };
        let (low, high): (Point, Point) = (bound(f64::min), bound(f64::max));
        let half = 0.5 * norm(sub(high, low));
        let far = |x: f64| {
            if points.len() > 1 && x.abs() > 2.0 * half {
                x
            } else {
                0.0
            }
        };
        let middle: Point = std::array::from_fn(|k| far(0.5 * low[k] + 0.5 * high[k]));
        let radius = points.iter().map(|&p| norm(sub(p, middle))).fold(0.0, f64::max);
        Self {
            planes,
            middle,
            radius,
            reach: truth::pose::radius(&points),
            small: oracle_shape(&points),
            shape: Shape {
                name: drawn.shape.name.clone(),
                points,
                faces,
            },
        }
    }

    fn body(&self) -> Body<'_> {
        (&self.shape).into()
    }

    /// Returns the distance of a point outside the worst plane; a body without volume counts only
    /// perpendicular to its faces.
    fn outside(&self, p: Point) -> f64 {
        let heights = self.planes.iter().map(|&(c, n)| dot(n, sub(p, c)));
        heights.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Returns a shape that the oracle can solve within milliseconds.
fn oracle_shape(points: &[Point]) -> Option<Shape> {
    let shape = Shape::hull("small", points.to_vec());
    match points.len() {
        1 | 2 => Some(shape),
        4..=16 => Some(shape.solved()).filter(|s| !s.faces.is_empty()),
        _ => None,
    }
}

/// A pair of bodies as the judge sees it.
pub(crate) struct Judge {
    a: Side,
    b: Side,
}

/// Quantities of an outcome along its normal and at its witnesses.
#[derive(Clone, Copy, Debug)]
struct Shown {
    /// Distance of the supporting planes along the normal.
    gap: f64,
    /// Distance of the witnesses.
    apart: f64,
    /// Larger height of a witness above its body's faces, zero inside.
    outside: f64,
    /// Bound of the rounding errors in each of these.
    slack: f64,
}

impl Judge {
    pub(crate) fn new(trial: &Trial) -> Self {
        Self {
            a: Side::new(&trial.a),
            b: Side::new(&trial.b),
        }
    }

    /// Returns the size of the pair: both radii plus the distance of the centres. Bounds are
    /// relative to it.
    pub(crate) fn size(&self, f: &Frame) -> f64 {
        let a_from_b = f.relative();
        self.a.radius + self.b.radius + norm(sub(a_from_b.apply(self.b.middle), self.a.middle))
    }

    /// Returns a bound of the rounding errors of `f64` in the frame of A.
    fn slack(&self, f: &Frame) -> f64 {
        64.0 * UNIT * (self.a.reach + self.b.reach + norm(sub(f.b.t, f.a.t)))
    }

    /// Returns the distance of the supporting planes along `n`, in A's frame and in `f64`.
    fn gap(&self, a_from_b: &Pose, n: Point) -> f64 {
        let in_b = a_from_b.rotate_back(n);
        let high = self.a.shape.points.iter().map(|&p| dot(n, p));
        let low = self.b.shape.points.iter().map(|&p| dot(in_b, p));
        low.fold(f64::INFINITY, f64::min) + dot(n, a_from_b.t) - high.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns a fault of an outcome, and whether exact arithmetic was needed.
    ///
    /// The judge uses `f64` first. It uses exact arithmetic if `f64` finds a fault or is too
    /// coarse, or if `exactly` is set.
    pub(crate) fn fault(&self, f: &Frame, o: &Outcome, exactly: bool) -> (Option<String>, bool) {
        if let Some(fault) = contradiction(o) {
            return (Some(fault.into()), false);
        }
        let size = self.size(f);
        let rounded = self.shown(f, o);
        let found = self.weigh(f, o, &rounded, size);
        // A fault found in `f64` may be a rounding error of the judge. An outcome that passes is
        // judged only to the accuracy of `f64`.
        if !exactly && found.is_none() && rounded.slack <= 0.1 * size * WIDTH {
            return (None, false);
        }
        (self.weigh(f, o, &self.shown_exactly(f, o), size), true)
    }

    fn shown(&self, f: &Frame, o: &Outcome) -> Shown {
        let a_from_b = f.relative();
        let (p, q, n) = parts(o);
        Shown {
            gap: self.gap(&a_from_b, n),
            apart: norm(sub(a_from_b.apply(q), p)),
            outside: self.a.outside(p).max(self.b.outside(q)).max(0.0),
            slack: self.slack(f),
        }
    }

    fn shown_exactly(&self, f: &Frame, o: &Outcome) -> Shown {
        let (p, q, n) = parts(o);
        let (a, b) = (self.a.body(), self.b.body());
        let over = |s: &Side, p: Point| {
            if s.shape.faces.is_empty() {
                0.0
            } else {
                bound::outside_by(p, s.body())
            }
        };
        Shown {
            gap: bound::support_gap(a, &f.a, b, &f.b, f.a.rotate(n)),
            apart: bound::witness_distance(p, &f.a, q, &f.b),
            outside: over(&self.a, p).max(over(&self.b, q)).max(0.0),
            // A witness is rounded in the frame of its body.
            slack: 8.0 * UNIT * (self.a.reach + self.b.reach),
        }
    }

    /// Checks the promises one by one. The first two are soundness.
    fn weigh(&self, f: &Frame, o: &Outcome, s: &Shown, size: f64) -> Option<String> {
        let rounding = if s.slack > 8.0 * UNIT * (self.a.reach + self.b.reach) {
            s.slack
        } else {
            0.0
        };
        let overlapping = o.state == ContactState::Overlapping;
        let width = WIDTH * size + 2.0 * s.slack;
        let (p, q, n) = parts(o);
        let between = sub(f.relative().apply(q), p);
        let aside = norm(sub(between, scale(n, dot(n, between))));
        let reported = [
            (
                o.upper >= s.gap - rounding,
                "the upper bound is below the gap along the normal",
            ),
            (
                overlapping || o.lower <= s.apart + 2.0 * s.outside + s.slack,
                "the lower bound is above the distance of the witnesses",
            ),
            (
                o.upper - o.lower <= WIDTH * (size + FAR * (self.a.reach + self.b.reach)),
                "the bounds are wide",
            ),
            (s.gap >= o.lower - width, "the normal does not prove the lower bound"),
            (
                overlapping || s.apart <= o.upper + width,
                "the witnesses do not attain the upper bound",
            ),
            (s.outside <= width, "a witness lies outside its body"),
            (
                !overlapping || (dot(n, between) - o.distance).abs() <= width + self.slack(f),
                "the witnesses are not the depth apart along the normal",
            ),
            (
                // If needles cross, a rotation by rounding shifts the crossing point by much more.
                !overlapping || aside <= 1e-10 * size + self.slack(f),
                "the witnesses are not behind each other along the normal",
            ),
        ];
        // Comparisons with NaN are false.
        let fault = reported.iter().find(|(holds, _)| !holds)?.1;
        Some(format!("{fault}: {s:?}, size {size:e}"))
    }

    /// Returns a fault of the contacts of an outcome.
    ///
    /// Each contact must lie on both bodies. Its points must be opposite each other along the
    /// normal, at the reported separation.
    pub(crate) fn contact_fault(&self, f: &Frame, o: &Outcome, m: &Manifold) -> Option<String> {
        let (a_from_b, width) = (f.relative(), WIDTH * self.size(f) + 2.0 * self.slack(f));
        let (p, q, n) = parts(o);
        let aside = |between: Point| norm(sub(between, scale(n, dot(n, between))));
        let between = |p: Point, q: Point| sub(a_from_b.apply(q), p);
        let of_witnesses = aside(between(p, q));
        // The points of nearly parallel edges are feet of perpendiculars, not opposite points.
        let edges = m.features().is_some_and(|f| support::kinds(f) == (1, 1));
        let wrong = m.points().iter().find(|c| {
            let (p, q) = (c.point_on_a.coords.into(), c.point_on_b.coords.into());
            let off = self.a.outside(p).abs().max(self.b.outside(q).abs());
            let apart = between(p, q);
            let opposite = edges || aside(apart) <= of_witnesses + width;
            !(off <= width && opposite && (dot(n, apart) - c.separation).abs() <= width)
        });
        let reported = wrong.map(|c| format!("a contact off its bodies or not opposite: {c:?}"));
        reported.or_else(|| m.points().is_empty().then(|| "no contact".into()))
    }

    /// Searches directions that show a smaller depth or a greater distance than the outcome allows.
    pub(crate) fn refuted(&self, f: &Frame, o: &Outcome, rng: &mut Rng) -> Option<String> {
        let a_from_b = f.relative();
        let n = parts(o).2;
        let of_a = sample(&self.a.planes, rng).map(|(_, n)| n);
        let of_a: Vec<Point> = of_a.collect();
        let of_b = sample(&self.b.planes, rng).map(|(_, n)| scale(a_from_b.rotate(n), -1.0));
        let of_b: Vec<Point> = of_b.collect();
        let near = (0..48).map(|k| unit(add(n, scale(rng.unit(), 2f64.powi(-(k % 24))))));
        let near: Vec<Point> = near.collect();
        let allowed = o.upper + self.slack(f);
        let beats = |n: &&Point| norm(**n) > 0.5 && self.gap(&a_from_b, **n) > allowed;
        let better = of_a.iter().chain(&of_b).chain(&near).find(beats)?;
        let gap = bound::support_gap(self.a.body(), &f.a, self.b.body(), &f.b, f.a.rotate(*better));
        (gap > o.upper).then(|| format!("the gap along {better:?} of A is {gap:e}, above the upper bound"))
    }

    /// Returns the largest possible change of a signed distance between two frames.
    pub(crate) fn most_change(&self, f: &Frame, g: &Frame) -> f64 {
        let moved = |p: &Pose, q: &Pose, r: f64| {
            let axis = |k: usize| std::array::from_fn(|i| if i == k { r } else { 0.0 });
            let turn = [0, 1, 2].map(|k| norm(sub(p.rotate(axis(k)), q.rotate(axis(k)))));
            turn.iter().sum::<f64>()
        };
        let shift = norm(sub(sub(f.b.t, f.a.t), sub(g.b.t, g.a.t)));
        shift + moved(&f.a, &g.a, self.a.reach) + moved(&f.b, &g.b, self.b.reach) + self.slack(f) + self.slack(g)
    }

    /// Returns the true distance, if the bodies are small enough for the oracle.
    pub(crate) fn truth(&self, f: &Frame) -> Option<truth::Exact> {
        let (a, b) = (self.a.small.as_ref()?, self.b.small.as_ref()?);
        if a.faces.is_empty() && b.faces.is_empty() {
            return None;
        }
        Some(exact::solve(a.into(), &f.a, b.into(), &f.b))
    }
}

/// Returns at most 128 of the planes.
fn sample(planes: &[(Point, Point)], rng: &mut Rng) -> impl Iterator<Item = (Point, Point)> {
    let step = planes.len().div_ceil(128).max(1);
    planes.iter().skip(rng.below(step)).step_by(step).copied()
}

/// Returns witnesses and normal as plain data.
fn parts(o: &Outcome) -> (Point, Point, Point) {
    (
        o.point_on_a.coords.into(),
        o.point_on_b.coords.into(),
        o.normal.into_inner().into(),
    )
}

/// Returns a contradiction of an outcome with itself.
fn contradiction(o: &Outcome) -> Option<&'static str> {
    let (p, q, n) = parts(o);
    let finite = [o.distance, o.upper, o.lower];
    let finite = finite.iter().chain(&p).chain(&q).chain(&n).all(|x| x.is_finite());
    let classed = match o.state {
        // Below the resolution of `f64`, exact arithmetic may decide more than a bound can express.
        ContactState::Separated => o.lower >= 0.0,
        ContactState::Overlapping => o.upper <= 0.0,
        ContactState::Touching => o.lower <= 0.0 && o.upper >= 0.0,
        _ => false,
    };
    let reported = [
        (finite, "a number is not finite"),
        (
            o.lower <= o.distance && o.distance <= o.upper,
            "the distance is not between its bounds",
        ),
        (classed, "the contact state contradicts the bounds"),
        ((norm(n) - 1.0).abs() <= 16.0 * UNIT, "the normal is not of unit length"),
    ];
    reported.iter().find(|(holds, _)| !holds).map(|t| t.1)
}

/// Compares an outcome with the true distance, exactly.
pub(crate) fn against(truth: &truth::Exact, o: &Outcome) -> Option<String> {
    // The differences are small and therefore exact, or so large that their sign is certain.
    let above = (o.lower - truth.distance) - truth.remainder;
    let below = (o.upper - truth.distance) - truth.remainder;
    let right = o.state == support::state(truth.state) && above <= 0.0 && below >= 0.0;
    (!right).then(|| {
        format!(
            "the truth is {} {:e} {:+e}",
            truth.state, truth.distance, truth.remainder
        )
    })
}

/// Compares two outcomes of the same query.
pub(crate) fn differ(x: &Outcome, y: &Outcome) -> Option<String> {
    let width = (x.upper - x.lower) + (y.upper - y.lower);
    let agree =
        x.state == y.state && x.lower <= y.upper && y.lower <= x.upper && (x.distance - y.distance).abs() <= width;
    (!agree).then(|| format!("another answer to the question: {y:?}"))
}
