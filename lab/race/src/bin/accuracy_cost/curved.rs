//! Measures the cost of curved shapes: as themselves, and replaced by hulls of more and more
//! vertices.
//!
//! The error is measured against the interval that the judge of `truth::curved` proves in
//! double-double, from the normal and the points of an outcome.

use std::hint::black_box;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ConvexPolyhedron, PairTracker, RelativePose, Shape, Tracker};
use race::progress::Progress;
use race::record::Row;
use truth::curved::{Kind, Place};
use truth::motion::{self, Frame};
use truth::parry::{Core, Map, MapGjk};
use truth::rng::Rng;

use crate::measure;
use crate::options::Options;
use crate::truth::{Sampled, Truth};
use truth::pairs::ball;

type Trouble = Box<dyn std::error::Error>;

/// Vertices of the hulls.
const SIZES: [usize; 7] = [16, 64, 256, 1024, 4096, 16_384, 65_536];

/// Names of the shapes in each pair.
const PAIRS: [[&str; 2]; 3] = [
    ["cylinder", "ellipsoid"],
    ["cylinder", "cone"],
    ["ellipsoid", "ellipsoid"],
];

/// A shape in the form of each engine.
struct Body {
    kind: Kind,
    shape: Shape,
    map: Map,
}

impl Body {
    fn of(name: &str) -> Self {
        let (kind, core) = match name {
            "cylinder" => (Kind::Cylinder(0.7, 0.5), Core::Cylinder(0.7, 0.5)),
            "cone" => (Kind::Cone(0.7, 0.6), Core::Cone(0.7, 0.6)),
            _ => (Kind::Ellipsoid([0.9, 0.6, 0.4]), Core::Ellipsoid([0.9, 0.6, 0.4])),
        };
        Self {
            shape: kind.shape(),
            map: Map { core, round: 0.0 },
            kind,
        }
    }

    /// Returns a hull of about `n` vertices, all on the surface.
    fn hull(&self, n: usize) -> Result<ConvexPolyhedron, Trouble> {
        let circle = |count: usize, r: f64, z: f64| {
            (0..count).map(move |k| {
                let (y, x) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
                Point3::new(r * x, r * y, z)
            })
        };
        let points: Vec<Point3<f64>> = match &self.kind {
            Kind::Cylinder(h, r) => circle(n / 2, *r, -h).chain(circle(n / 2, *r, *h)).collect(),
            Kind::Cone(h, r) => circle(n - 1, *r, -h)
                .chain(std::iter::once(Point3::new(0.0, 0.0, *h)))
                .collect(),
            Kind::Ellipsoid([a, b, c]) => {
                let sphere = ball(n);
                sphere
                    .iter()
                    .map(|p| Point3::new(a * p[0], b * p[1], c * p[2]))
                    .collect()
            }
            other => return Err(format!("{other:?} is in no pair").into()),
        };
        Ok(ConvexPolyhedron::from_points(&points)?)
    }
}

/// A motion in the form of each engine.
struct Scene {
    a: Body,
    b: Body,
    frames: Vec<Frame>,
    poses: Vec<(Isometry3<f64>, Isometry3<f64>)>,
    truth: Sampled,
}

impl Scene {
    fn new([a, b]: [&str; 2], options: &Options) -> Self {
        let (a, b) = (Body::of(a), Body::of(b));
        let radii = (a.kind.radius(), b.kind.radius());
        let frames = motion::orbit_and_spin(&mut Rng::new(31), options.frames(), 0.5, radii, (0.02, 0.5), 200);
        let truth = |f: usize| {
            let place = Place::of(&frames[f]);
            let o = PairTracker::new().closest(&a.shape, &b.shape, &place.pose());
            let (lower, upper) = place.truth(&a.kind, &b.kind, &o);
            let [lower, upper] = [lower.0, upper.0];
            (Truth { lower, upper }, place.size(&a.kind, &b.kind))
        };
        let truth = Sampled::of(frames.len(), options.sampled(), truth);
        let poses = frames.iter().map(|f| (f.a.isometry(), f.b.isometry())).collect();
        Self {
            a,
            b,
            frames,
            poses,
            truth,
        }
    }

    fn seen<S>(
        &self,
        options: &Options,
        fresh: impl Fn() -> S + Copy,
        ask: impl Fn(usize, &mut S) -> f64 + Copy,
    ) -> [Vec<f64>; 2] {
        measure::passes(options, (self.frames.len(), &self.truth), fresh, ask)
    }

    fn relative(&self, f: usize) -> RelativePose {
        RelativePose::new(&self.poses[f].0, &self.poses[f].1).expect("poses of a motion")
    }

    /// Returns the distance of the shapes, and computes both witnesses in the world frame.
    fn curved(&self, f: usize, pair: &mut PairTracker) -> f64 {
        let o = pair.closest(&self.a.shape, &self.b.shape, &self.relative(f));
        black_box((self.poses[f].0 * o.point_on_a, self.poses[f].1 * o.point_on_b));
        o.distance
    }

    fn gjk(&self, f: usize, gjk: &mut MapGjk) -> f64 {
        let found = gjk.closest(&self.a.map, &self.b.map, &self.frames[f]);
        black_box(&found).as_ref().map_or(0.0, |w| w.distance)
    }

    fn hulls(&self, f: usize, (a, b): (&ConvexPolyhedron, &ConvexPolyhedron), pair: &mut Tracker) -> f64 {
        let o = pair.closest(a, b, &self.relative(f));
        black_box((self.poses[f].0 * o.point_on_a, self.poses[f].1 * o.point_on_b));
        o.distance
    }
}

pub(crate) fn count(options: &Options) -> u64 {
    if options.does("curved") && options.meshes().is_none() {
        PAIRS.len() as u64
    } else {
        0
    }
}

pub(crate) fn run(options: &Options, rows: &mut Vec<Row>, progress: &Progress) -> Result<(), Trouble> {
    measure::title(
        "Curved shapes as themselves (n = 0) and as hulls of n vertices, 0.5 degrees a frame",
        "pair",
    );
    for names in PAIRS {
        let family = names.join("-");
        progress.say(&family);
        let scene = Scene::new(names, options);
        let mut note = |n: usize, engine: &str, level: &str, seen: [Vec<f64>; 2]| {
            measure::line(rows, ("curved", &family, n), (engine, level), seen);
        };
        note(
            0,
            "ours",
            "certified",
            scene.seen(options, PairTracker::new, |f, s| scene.curved(f, s)),
        );
        let cold = |f: usize, (): &mut ()| scene.curved(f, &mut PairTracker::new());
        note(0, "ours-cold", "certified", scene.seen(options, || (), cold));
        note(
            0,
            "gjk-cached",
            "closest",
            scene.seen(options, MapGjk::default, |f, s| scene.gjk(f, s)),
        );
        for &n in if options.quick { &SIZES[..3] } else { &SIZES } {
            let (a, b) = (scene.a.hull(n)?, scene.b.hull(n)?);
            let hulls = |f: usize, s: &mut Tracker| scene.hulls(f, (&a, &b), s);
            note(n, "ours", "hull", scene.seen(options, Tracker::new, hulls));
        }
        progress.step();
    }
    Ok(())
}
