//! The judge: an independent subdivision, in double-double.
//!
//! The points at the returned parameters judge the upper bound. A search judges the lower bound: it
//! must prove that every pair of parts is at least this far apart, along the returned normal or
//! along the line of the middles of both parts. `f64` decides only with ample margin.

use std::cell::OnceCell;
use std::rc::Rc;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::surface::BezierSurface;
use lin_canny::{ConvexPolyhedron, PairOutcome, PairTracker, RelativePose, Shape, WitnessLocation};

use truth::curved::{Kind, Triple, Wide, dot, matrix, norm, turned, turned_back, wide};

type Homogeneous = [Wide; 4];

/// Largest number of pairs that the judge tests before it gives up.
const LOOKS: usize = 600_000;

/// Error bound of `f64` on sets of a size of some tens.
const ROUGH: f64 = 1e-12;

/// A part of a surface, in A's frame.
struct Part {
    degrees: [usize; 2],
    net: Vec<Homogeneous>,
    /// The rounded control points, and a bounding ball.
    rough: Vec<Vector3<f64>>,
    middle: Vector3<f64>,
    size: f64,
    halves: OnceCell<[Rc<Part>; 2]>,
}

/// Result of the judge.
#[derive(Debug, PartialEq)]
pub(crate) enum Sentence {
    Holds,
    /// The search was too long.
    Open,
}

fn mixed(a: &Homogeneous, b: &Homogeneous, t: f64) -> Homogeneous {
    let (t, s) = (Wide::from(t), Wide::from(1.0) - Wide::from(t));
    [0, 1, 2, 3].map(|k| a[k] * s + b[k] * t)
}

fn half(a: &Homogeneous, b: &Homogeneous) -> Homogeneous {
    [0, 1, 2, 3].map(|k| a[k] + b[k]).map(|x| Wide(0.5 * x.0, 0.5 * x.1))
}

fn place(h: &Homogeneous) -> Triple {
    [0, 1, 2].map(|k| h[k] / h[3])
}

fn less(a: &Triple, b: &Triple) -> Triple {
    [0, 1, 2].map(|k| a[k] - b[k])
}

/// A pose in double-double.
struct Place {
    rotation: [Triple; 3],
    t: Triple,
}

impl Place {
    fn new(pose: &Isometry3<f64>) -> Self {
        let c = pose.rotation.coords;
        Self {
            rotation: matrix([c.x, c.y, c.z, c.w]),
            t: wide(pose.translation.vector.into()),
        }
    }

    fn of(&self, p: &Triple) -> Triple {
        let q = turned(&self.rotation, p);
        [0, 1, 2].map(|k| q[k] + self.t[k])
    }
}

impl Part {
    fn new(degrees: [usize; 2], net: Vec<Homogeneous>) -> Rc<Self> {
        let rough: Vec<_> = net.iter().map(|h| Vector3::from(place(h).map(|x| x.0))).collect();
        let middle = rough.iter().sum::<Vector3<f64>>() / rough.len() as f64;
        let size = rough.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
        Rc::new(Self {
            degrees,
            net,
            rough,
            middle,
            size,
            halves: OnceCell::new(),
        })
    }

    /// Returns the patches of a surface at a pose; numbers are those of the surface.
    fn all(surface: &BezierSurface, pose: &Isometry3<f64>) -> Vec<Rc<Self>> {
        let pose = Place::new(pose);
        let placed = |(p, w): (Point3<f64>, f64)| {
            let (q, w) = (pose.of(&wide(p.coords.into())), Wide::from(w));
            [q[0] * w, q[1] * w, q[2] * w, w]
        };
        let part =
            |p: &lin_canny::surface::BezierPatch| Self::new(p.degrees(), p.control_points().map(placed).collect());
        surface.patches().iter().map(part).collect()
    }

    fn point(&self, at: &WitnessLocation) -> Triple {
        let q = self.degrees[1];
        let curve = |mut c: Vec<Homogeneous>, t: f64| {
            while c.len() > 1 {
                c = c.windows(2).map(|w| mixed(&w[0], &w[1], t)).collect();
            }
            c[0]
        };
        let rows = self.net.chunks(q + 1).map(|row| curve(row.to_vec(), at.parameters[1]));
        place(&curve(rows.collect(), at.parameters[0]))
    }

    /// Returns the halves along the direction in which the net is longer.
    fn halves(&self) -> &[Rc<Self>; 2] {
        self.halves.get_or_init(|| {
            let [p, q] = self.degrees;
            let at = |i: usize, j: usize| i * (q + 1) + j;
            let leg = |i: usize, j: usize| (self.rough[i] - self.rough[j]).norm();
            let long_u = (0..=q)
                .map(|j| (0..p).map(|i| leg(at(i, j), at(i + 1, j))).sum::<f64>())
                .fold(0.0, f64::max);
            let long_v = (0..=p)
                .map(|i| (0..q).map(|j| leg(at(i, j), at(i, j + 1))).sum::<f64>())
                .fold(0.0, f64::max);
            let (mut low, mut high) = (self.net.clone(), self.net.clone());
            let mut line = |ids: Vec<usize>| {
                let mut c: Vec<Homogeneous> = ids.iter().map(|&k| self.net[k]).collect();
                for level in 0..ids.len() {
                    low[ids[level]] = c[0];
                    high[ids[ids.len() - 1 - level]] = c[c.len() - 1];
                    c = c.windows(2).map(|w| half(&w[0], &w[1])).collect();
                }
            };
            if long_u >= long_v {
                (0..=q).for_each(|j| line((0..=p).map(|i| at(i, j)).collect()));
            } else {
                (0..=p).for_each(|i| line((0..=q).map(|j| at(i, j)).collect()));
            }
            [low, high].map(|net| Self::new(self.degrees, net))
        })
    }

    /// Returns the support value along a direction.
    fn high(&self, n: &Triple) -> Wide {
        let heights = self.net.iter().map(|h| dot(&place(h), n));
        heights.reduce(Wide::max).expect("a point")
    }

    fn rough_high(&self, n: &Vector3<f64>) -> f64 {
        self.rough.iter().map(|p| p.dot(n)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn corner(&self) -> Triple {
        place(&self.net[0])
    }
}

/// Returns whether two parts are at least `goal` apart along a direction.
fn is_apart(a: &Part, b: &Part, n: &Vector3<f64>, goal: f64) -> bool {
    let length = n.norm();
    if !(length > 0.0) {
        return false;
    }
    let rough = (-b.rough_high(&-n) - a.rough_high(n)) / length;
    if (rough - goal).abs() > ROUGH {
        return rough > goal;
    }
    let (n, back) = (wide((*n).into()), wide((-n).into()));
    ((-b.high(&back) - a.high(&n)) / norm(&n) - Wide::from(goal)).0 >= 0.0
}

/// Judges an outcome; panics if a bound is wrong by more than `slack`.
pub(crate) fn judge(
    a: &BezierSurface,
    b: &BezierSurface,
    pose: &Isometry3<f64>,
    o: &PairOutcome,
    slack: f64,
) -> Sentence {
    let (parts_a, parts_b) = (Part::all(a, &Isometry3::identity()), Part::all(b, pose));
    let p = parts_a[o.locations[0].subshape as usize].point(&o.locations[0]);
    let q = parts_b[o.locations[1].subshape as usize].point(&o.locations[1]);
    let between = norm(&less(&q, &p)).0;
    assert!(between <= o.upper, "witnesses are {between:e} apart: {o:?}");
    if o.lower <= 0.0 {
        return Sentence::Holds;
    }
    let goal = o.lower - slack;
    let mut open: Vec<(Rc<Part>, Rc<Part>)> = Vec::new();
    parts_a
        .iter()
        .for_each(|x| open.extend(parts_b.iter().map(|y| (x.clone(), y.clone()))));
    let mut looks = 0;
    while let Some((x, y)) = open.pop() {
        looks += 1;
        if looks > LOOKS {
            return Sentence::Open;
        }
        let line = y.middle - x.middle;
        if line.norm() - x.size - y.size > goal + 1e-9
            || is_apart(&x, &y, &o.normal, goal)
            || is_apart(&x, &y, &line, goal)
        {
            continue;
        }
        let apart = norm(&less(&x.corner(), &y.corner())).0;
        assert!(apart >= goal, "two points are {apart:e} apart: {o:?}");
        if x.size >= y.size {
            let [low, high] = x.halves();
            open.extend([(low.clone(), y.clone()), (high.clone(), y)]);
        } else {
            let [low, high] = y.halves();
            open.extend([(x.clone(), low.clone()), (x, high.clone())]);
        }
    }
    Sentence::Holds
}

/// A convex shape of the judge, at a pose.
pub(crate) struct Body {
    pub(crate) kind: Kind,
    pub(crate) round: f64,
    pub(crate) shape: Shape,
}

impl Body {
    /// Returns the support point along a direction.
    pub(crate) fn top(&self, n: &Vector3<f64>) -> Vector3<f64> {
        let point = ConvexPolyhedron::point(Point3::from(n * 100.0)).expect("a point");
        let at = RelativePose::from_isometry(&Isometry3::identity()).expect("a pose");
        let found = PairTracker::new().closest(&Shape::from(point), &self.shape, &at);
        found.point_on_b.coords
    }

    /// Returns the least height along a direction.
    fn low(&self, place: &Place, n: &Triple) -> Wide {
        let m = turned_back(&place.rotation, n).map(|x| -x);
        dot(n, &place.t) - self.kind.height(&m) - Wide::from(self.round) * norm(n)
    }

    /// Judges the upper bound and the witnesses.
    fn judge_witnesses(&self, place: &Place, p: &Triple, o: &PairOutcome, slack: f64) {
        let inward = turned_back(&place.rotation, &wide((*o.normal).into()));
        let q = wide(o.point_on_b.coords.into());
        let core = [0, 1, 2].map(|k| q[k] + inward[k] * Wide::from(self.round));
        let off = self.kind.outside(&core);
        if o.upper == 0.0 {
            let inside = turned_back(&place.rotation, &less(p, &place.t));
            let near = norm(&less(&inside, &core)).0;
            assert!(
                self.kind.outside(&inside) <= slack || off <= slack && near <= self.round + slack,
                "a point outside: {o:?}"
            );
            return;
        }
        assert!(off <= slack, "a witness {off:e} outside: {o:?}");
        // By the core: a witness on a rounded shape is sideways by the error of the normal.
        let between = norm(&less(&place.of(&core), p)).0 - self.round;
        assert!(between <= o.upper + slack, "witnesses are {between:e} apart: {o:?}");
    }
}

/// Judges an outcome; panics if a bound is wrong by more than `slack`.
///
/// The tracker of shapes supplies the directions and the points that might refute a bound.
pub(crate) fn judge_shape(a: &BezierSurface, b: &Body, pose: &Isometry3<f64>, o: &PairOutcome, slack: f64) -> Sentence {
    let (parts, place) = (Part::all(a, &Isometry3::identity()), Place::new(pose));
    b.judge_witnesses(
        &place,
        &parts[o.locations[0].subshape as usize].point(&o.locations[0]),
        o,
        slack,
    );
    if o.lower <= 0.0 {
        return Sentence::Holds;
    }
    let goal = o.lower - slack;
    let point = Shape::from(ConvexPolyhedron::point(Point3::origin()).expect("a point"));
    let mut tracker = PairTracker::new();
    let mut open = parts;
    let mut looks = 0;
    while let Some(x) = open.pop() {
        looks += 1;
        if looks > LOOKS {
            return Sentence::Open;
        }
        let mut from = |p: Vector3<f64>| {
            let at = RelativePose::new(&Isometry3::from(p), pose).expect("a pose");
            tracker.closest(&point, &b.shape, &at)
        };
        let seen = from(x.middle);
        let is_apart = |n: &Vector3<f64>| {
            let n = wide((*n).into());
            ((b.low(&place, &n) - x.high(&n)) / norm(&n) - Wide::from(goal)).0 >= 0.0
        };
        if seen.lower - x.size > goal + 1e-9 || is_apart(&o.normal) || is_apart(&seen.normal) {
            continue;
        }
        let near = from(x.rough[0]);
        assert!(near.upper >= goal - 1e-14, "a point is {} near: {o:?}", near.upper);
        open.extend(x.halves().iter().cloned());
    }
    Sentence::Holds
}
