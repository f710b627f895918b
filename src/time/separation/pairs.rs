//! The pairs of convex bodies over time: two polyhedra, or two shapes, and their tracker.

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{HEIGHT, UNIT};
use crate::body::polyhedron::support::Extreme;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, HalfEdgeId, VertexId};
use crate::body::shape::Shape;
use crate::convex::minimum::OverlapProof;
use crate::convex::shape_tracker::ShapeTracker;
use crate::convex::tracker::Tracker;
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{Decision, DepthMode, Outcome};
use crate::time::separation::{Measurement, Separation, SupportPoint, Tangent};
use nalgebra::{Point3, Vector3};

/// Faces with longer boundaries are not triangulated for the guess of an overlap, because the
/// search takes linear time.
const RIM: usize = 64;

/// Factor by which a ball around the centre of the box must be smaller to replace the ball around
/// the origin.
///
/// The smaller ball is tighter, but adds a lever arm to every bound.
const SMALLER: f64 = 0.8;

/// Support values of bodies with at most this many vertices come from a scan. It takes linear time,
/// but needs no climb and no proof.
const FEW: usize = 24;

/// Directions nearer than this to the normal of a face, as a 1-norm, use the plane of the face.
///
/// The support value is that of the plane plus a bound of the difference. This saves a climb along
/// the face; the value is slightly too large.
const FLUSH: f64 = 1.0 / (1u64 << 40) as f64;

/// Two convex polyhedra that can be measured over time.
#[derive(Debug)]
pub(crate) struct PolyhedronPair<'a> {
    a: BoundedHull<'a>,
    b: BoundedHull<'a>,
    tracker: &'a mut Tracker,
}

/// A body, a ball around it, and the vertex of the last support query.
#[derive(Clone, Debug)]
struct BoundedHull<'a> {
    shape: &'a ConvexPolyhedron,
    /// The centre of the ball in stored coordinates.
    middle: Vector3<f64>,
    centre: Point3<f64>,
    radius: f64,
    hint: VertexId,
    /// The face of the last measurement.
    face: Option<FaceId>,
}

impl<'a> BoundedHull<'a> {
    #[inline]
    fn new(shape: &'a ConvexPolyhedron) -> Self {
        let half = (shape.high - shape.low) * 0.5;
        let diagonal = sqrt(half.norm_squared()) * (1.0 + 8.0 * UNIT);
        // If a body is stored about a separate origin, only this origin has no rounding.
        let (middle, radius) = if shape.origin == Vector3::zeros() && diagonal < SMALLER * shape.radius {
            (shape.low + half, diagonal + 2.0 * UNIT * shape.radius)
        } else {
            (Vector3::zeros(), shape.radius)
        };
        Self {
            shape,
            middle,
            centre: Point3::from(middle * shape.unit() + shape.origin),
            radius: radius * shape.unit(),
            hint: VertexId(0),
            face: None,
        }
    }

    #[inline]
    fn support(&mut self, direction: &Vector3<f64>) -> SupportPoint {
        let highest = self.highest(direction);
        self.hint = highest.vertex;
        let length = one_norm(direction);
        let height = over_middle(highest.value, direction, &self.middle) + HEIGHT * length * self.shape.radius;
        let unit = self.shape.unit();
        SupportPoint {
            height: height * unit,
            point: (self.shape.points[highest.vertex.index()] - self.middle) * unit,
        }
    }

    /// Returns the support vertex in stored coordinates, and a value that no vertex exceeds except
    /// by rounding.
    #[inline]
    fn highest(&self, direction: &Vector3<f64>) -> Extreme {
        let points = &self.shape.points;
        if points.len() <= FEW {
            let first = Extreme {
                vertex: VertexId(0),
                value: f64::NEG_INFINITY,
            };
            return self.shape.vertices().zip(points).fold(first, |best, (vertex, p)| {
                let value = direction.dot(p);
                if value > best.value {
                    Extreme { vertex, value }
                } else {
                    best
                }
            });
        }
        if let Some(face) = self.face {
            let plane = &self.shape.planes[face.index()];
            let off = one_norm(&(direction - plane.normal));
            if off < FLUSH {
                return Extreme {
                    vertex: self.hint,
                    value: plane.offset + off * self.shape.radius,
                };
            }
        }
        self.shape.support_certified(direction, self.hint)
    }

    /// Stores the measured feature and one of its vertices.
    fn note(&mut self, feature: Feature, vertex: VertexId) {
        self.hint = vertex;
        self.face = match feature {
            Feature::Face(face) => Some(face),
            _ => None,
        };
    }

    fn edge(&self, edge: EdgeId) -> [VertexId; 2] {
        let (t, h) = (&self.shape.topology, edge.half_edge());
        [t.from(h), t.half_edge(h).to]
    }

    fn direction(&self, edge: EdgeId) -> Vector3<f64> {
        let [from, to] = self.edge(edge).each(|v| self.shape.points[v.index()]);
        to - from
    }

    /// Returns the triangle of a face's fan whose least side is farthest from a point.
    ///
    /// The triangle contains the point if the face does.
    fn triangle(&self, face: FaceId, point: &Vector3<f64>) -> Option<[VertexId; 3]> {
        let t = &self.shape.topology;
        let normal = self.shape.planes[face.index()].normal;
        let corner = |h: HalfEdgeId| self.shape.points[t.from(h).index()];
        let side = |p: Vector3<f64>, q: Vector3<f64>| normal.dot(&(q - p).cross(&(point - p)));
        let mut rim = t.rim(face);
        let first = rim.next()?;
        let mut before = rim.next()?;
        let mut best = (f64::NEG_INFINITY, None);
        for (k, h) in rim.enumerate() {
            if k > RIM {
                return None;
            }
            let [p, q, r] = [first, before, h].each(corner);
            let least = side(p, q).smaller(side(q, r)).smaller(side(r, p));
            if least > best.0 {
                best = (least, Some([first, before, h].each(|h| t.from(h))));
            }
            before = h;
        }
        best.1
    }
}

impl<'a> PolyhedronPair<'a> {
    #[inline]
    pub(crate) fn new(a: &'a ConvexPolyhedron, b: &'a ConvexPolyhedron, tracker: &'a mut Tracker) -> Self {
        Self {
            a: BoundedHull::new(a),
            b: BoundedHull::new(b),
            tracker,
        }
    }

    /// Returns the closest points.
    #[inline]
    pub(crate) fn closest_with(&mut self, a_from_b: &RelativePose, question: &QueryOptions) -> PairOutcome {
        let (a, b, tracker) = self.sides();
        PairOutcome::of_convex(tracker.measure(a, b, a_from_b, question.depth))
    }

    /// Returns whether the polyhedra are at most `d` apart.
    #[inline]
    pub(crate) fn decide_within(&mut self, a_from_b: &RelativePose, d: f64, _: &QueryOptions) -> Decision {
        let (a, b, tracker) = self.sides();
        Decision::of(tracker.within(a, b, a_from_b, d))
    }

    /// Returns the polyhedra and the tracker.
    #[inline]
    pub(crate) fn sides(&mut self) -> (&'a ConvexPolyhedron, &'a ConvexPolyhedron, &mut Tracker) {
        (self.a.shape, self.b.shape, self.tracker)
    }

    /// Returns an outcome of the tracker as a measurement, and stores the features.
    #[inline]
    pub(crate) fn seen(&mut self, outcome: &Outcome) -> Measurement {
        let (on_a, on_b) = outcome.features.vertices_of(self.a.shape, self.b.shape);
        self.a.note(outcome.features.a, on_a);
        self.b.note(outcome.features.b, on_b);
        let mut seen = Measurement::new(outcome, self.tangent(outcome.features.a, outcome.features.b));
        // If the bodies are stored in different units, the normal was rotated once more.
        seen.by_plane &= self.a.shape.exponent == self.b.shape.exponent;
        seen
    }

    fn tangent(&self, a: Feature, b: Feature) -> Tangent {
        match (a, b) {
            (Feature::Face(_), _) | (Feature::Edge(_), Feature::Vertex(_)) => Tangent::WithA,
            (_, Feature::Face(_)) | (Feature::Vertex(_), Feature::Edge(_)) => Tangent::WithB,
            (Feature::Edge(a), Feature::Edge(b)) => Tangent::Edges(self.a.direction(a), self.b.direction(b)),
            (Feature::Vertex(_), Feature::Vertex(_)) => Tangent::Free,
        }
    }

    /// Returns four points of the Minkowski difference that probably contain the origin.
    ///
    /// The origin is then just behind the facet of the closest features.
    ///
    /// They are the triangle of the facet that contains the witnesses, and the point farthest
    /// behind the facet.
    fn behind(&self, a_from_b: &RelativePose, seen: &Measurement) -> Option<OverlapProof> {
        if !(self.a.shape.is_unscaled && self.b.shape.is_unscaled) {
            return None;
        }
        let features = seen.features?;
        let (on_a, on_b) = (&seen.point_on_a.coords, &seen.point_on_b.coords);
        let facet = match (features.a, features.b) {
            (Feature::Face(f), Feature::Vertex(v)) => self.a.triangle(f, on_a)?.each(|u| [u, v]),
            (Feature::Vertex(u), Feature::Face(f)) => self.b.triangle(f, on_b)?.each(|v| [u, v]),
            (Feature::Edge(e), Feature::Edge(f)) => {
                let ([p, q], [r, s]) = (self.a.edge(e), self.b.edge(f));
                let along = |body: &BoundedHull, edge: EdgeId, from: VertexId, at: &Vector3<f64>| {
                    let way = body.direction(edge);
                    (at - body.shape.points[from.index()]).dot(&way) / way.norm_squared()
                };
                if along(&self.a, e, p, on_a) + along(&self.b, f, r, on_b) < 1.0 {
                    [[p, r], [q, r], [p, s]]
                } else {
                    [[q, s], [q, r], [p, s]]
                }
            }
            _ => return None,
        };
        let normal = seen.normal.into_inner();
        let normal_in_b = a_from_b.rotation().tr_mul(&normal);
        let deep = [
            self.a.shape.support_cold(&-normal),
            self.b.shape.support_cold(&normal_in_b),
        ];
        Some(OverlapProof::guess([facet[0], facet[1], facet[2], deep]))
    }
}

impl Separation for PolyhedronPair<'_> {
    #[inline]
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let body = if of == Operand::A { &self.a } else { &self.b };
        (body.centre, body.radius)
    }

    #[inline]
    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        let outcome = self
            .tracker
            .measure(self.a.shape, self.b.shape, a_from_b, DepthMode::None);
        self.seen(&outcome)
    }

    /// Uses [`Tracker::intersects`] and [`Tracker::within`]: without the feature `exact`, ties
    /// count as met.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measurement) -> bool {
        let (a, b) = (self.a.shape, self.b.shape);
        if distance > 0.0 {
            return self.tracker.within(a, b, a_from_b, distance);
        }
        if let Some(hold) = self.behind(a_from_b, seen) {
            self.tracker.expect(hold);
        }
        self.tracker.intersects(a, b, a_from_b)
    }

    #[inline]
    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let body = if of == Operand::A { &mut self.a } else { &mut self.b };
        body.support(direction)
    }
}

/// Returns a support value along a direction, relative to the centre of the body.
#[inline(always)]
pub(crate) fn over_middle(height: f64, direction: &Vector3<f64>, middle: &Vector3<f64>) -> f64 {
    height - direction.dot(middle)
}

/// Returns the sum of the absolute coordinates, which is at least the length.
fn one_norm(v: &Vector3<f64>) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

/// Two rounded or curved shapes that can be measured over time.
#[derive(Debug)]
pub(crate) struct ShapePair<'a> {
    shapes: [&'a Shape; 2],
    /// Balls around both shapes, which a query at one pose does not need.
    balls: Option<[(Point3<f64>, f64); 2]>,
    tracker: &'a mut ShapeTracker,
}

impl<'a> ShapePair<'a> {
    #[inline]
    pub(crate) fn new(a: &'a Shape, b: &'a Shape, tracker: &'a mut ShapeTracker) -> Self {
        Self {
            shapes: [a, b],
            balls: None,
            tracker,
        }
    }

    /// Computes both balls, once for all steps of a cast.
    pub(crate) fn with_balls(self) -> Self {
        Self {
            balls: Some(self.shapes.each(Shape::bounding_ball)),
            ..self
        }
    }

    /// Returns the closest points; an overlap gets the depth that the options request.
    ///
    /// Rounded shapes need the depth of their cores, because only the depth distinguishes a deep
    /// overlap from touching.
    #[inline]
    pub(crate) fn closest_with(&mut self, a_from_b: &RelativePose, question: &QueryOptions) -> PairOutcome {
        let (a, b, tracker) = self.sides();
        PairOutcome::of_convex(match question.depth {
            DepthMode::None => tracker.closest(a, b, a_from_b).without_depth(),
            until => tracker.measure(a, b, a_from_b, until),
        })
    }

    /// Returns whether the shapes are at most `d` apart.
    #[inline]
    pub(crate) fn decide_within(&mut self, a_from_b: &RelativePose, d: f64, _: &QueryOptions) -> Decision {
        let (a, b, tracker) = self.sides();
        Decision::of(tracker.within(a, b, a_from_b, d))
    }

    /// Returns the shapes and the tracker.
    #[inline]
    pub(crate) fn sides(&mut self) -> (&'a Shape, &'a Shape, &mut ShapeTracker) {
        let [a, b] = self.shapes;
        (a, b, self.tracker)
    }

    /// Returns an outcome of the tracker as a measurement.
    pub(crate) fn seen(outcome: &Outcome) -> Measurement {
        Measurement {
            // A radius moves the lower bound; the support value along the normal is computed again.
            by_plane: false,
            ..Measurement::new(outcome, Tangent::Free)
        }
    }
}

impl Separation for ShapePair<'_> {
    #[inline]
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        let k = usize::from(of == Operand::B);
        match self.balls {
            Some(balls) => balls[k],
            None => self.shapes[k].bounding_ball(),
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        let (a, b, tracker) = self.sides();
        Self::seen(&tracker.closest(a, b, a_from_b))
    }

    /// Proven by the upper bound of the distance; exact for rounded polyhedra with the feature
    /// `exact`.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        let (a, b, tracker) = self.sides();
        tracker.closest(a, b, a_from_b).upper <= distance
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let (centre, radius) = self.ball(of);
        let shape = self.shapes[usize::from(of == Operand::B)];
        let length = direction.x.abs() + direction.y.abs() + direction.z.abs();
        let size = radius + centre.coords.abs().sum();
        let height = shape.support_height(direction) - direction.dot(&centre.coords);
        SupportPoint {
            height: height + HEIGHT * length * size,
            // Only guides the search: the point of the ball.
            point: direction * (height / direction.norm_squared().at_least(f64::MIN_POSITIVE)),
        }
    }
}
