//! Pairs of bodies in the form of each engine, and their motions, for `accuracy_cost` and the bench
//! `accuracy`.

use crate::motion::Frame;
use crate::parry::Climber;
use crate::rng::Rng;
use crate::{Face, Point, Pose, shapes, workload};
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, RelativePose, Tracker};
use lin_canny_formats::MeshFile;

/// A body in the form of each engine. Engines get the vertices and faces of our hull, so all have
/// the same body.
pub struct Body {
    /// The hull of this crate.
    pub ours: ConvexPolyhedron,
    /// Vertices of the hull.
    pub points: Vec<Point>,
    /// Faces of the hull.
    pub faces: Vec<Face>,
    /// Adjacency for a hill-climbing support map.
    pub climber: Climber,
    /// parry's hull in double precision, if parry can build it.
    pub parry: Option<crate::parry::Hull>,
}

impl Body {
    /// Returns the hull of points for all engines.
    ///
    /// # Errors
    /// Returns an error if the points have no hull.
    pub fn new(points: &[Point]) -> Result<Self, String> {
        let cloud: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
        let ours = ConvexPolyhedron::from_points(&cloud).map_err(|e| e.to_string())?;
        let points: Vec<Point> = ours.vertex_points().map(Into::into).collect();
        let faces: Vec<Face> = ours
            .faces()
            .map(|f| ours.face_vertices(f).map(|v| v.index() as u32).collect())
            .collect();
        Ok(Self {
            climber: Climber::new(&points, &faces),
            parry: crate::parry::mesh(&points, &faces),
            points,
            faces,
            ours,
        })
    }

    /// Returns the body in the form of the exact arithmetic.
    pub fn plain(&self) -> crate::Body<'_> {
        crate::Body {
            points: &self.points,
            faces: &self.faces,
        }
    }
}

/// A pair of bodies and its motion.
pub struct Pair {
    /// Body A.
    pub a: Body,
    /// Body B.
    pub b: Body,
    /// Poses of both bodies, frame by frame.
    pub frames: Vec<Frame>,
    /// The same poses as isometries.
    pub isometries: Vec<(Isometry3<f64>, Isometry3<f64>)>,
}

impl Pair {
    /// Returns a pair without a motion.
    pub fn new(a: Body, b: Body) -> Self {
        Self {
            a,
            b,
            frames: Vec::new(),
            isometries: Vec::new(),
        }
    }

    /// Returns two bodies of a family: `sphere`, `flat` or `box`.
    pub fn of(shape: &str, n: usize) -> Result<Self, String> {
        let mut rng = Rng::new(1000 + n as u64);
        let mut body = || Body::new(&workload::points(shape, n, &mut rng));
        Ok(Self::new(body()?, body()?))
    }

    /// Adds a motion at a gap of 2 % of the radius: B orbits A and spins by `degrees` per frame, or
    /// takes a new pose every frame.
    pub fn moving(self, degrees: Option<f64>, frames: usize) -> Self {
        let mut tracker = Tracker::new();
        let frames = workload::motion(degrees, frames, &mut Rng::new(17), |f| {
            let o = self.closest(&mut tracker, f);
            (o.state == ContactState::Separated).then(|| witnesses(f, &o))
        });
        self.with(frames)
    }

    /// Adds the same motion at a gap of `gap`, as nearly as poses in `f64` allow; frames that
    /// overlap are left out.
    pub fn at_gap(self, gap: f64, frames: usize) -> Self {
        let mut pair = self.moving(Some(0.5), frames);
        let mut tracker = Tracker::new();
        let mut frames = std::mem::take(&mut pair.frames);
        for f in &mut frames {
            for _ in 0..2 {
                let o = pair.closest(&mut tracker, f);
                let n = f.a.rotate(o.normal.into_inner().into());
                f.b.t = std::array::from_fn(|k| f.b.t[k] + n[k] * (gap - o.distance));
            }
        }
        frames.retain(|f| pair.closest(&mut tracker, f).state == ContactState::Separated);
        pair.with(frames)
    }

    /// Returns two boxes face on face, separated by `gap`, with B rotating and sliding over A.
    ///
    /// A common rotation makes the faces parallel only up to rounding. Frames that overlap are left
    /// out.
    pub fn flush(gap: f64, frames: usize) -> Result<Self, String> {
        let mut rng = Rng::new(23);
        let (a, b) = (Self::of("box", 8)?, rng.quat());
        let common = Pose::new(b, rng.unit());
        let thick = 2.0 * a.a.points.iter().fold(0.0f64, |h, p| h.max(p[2]));
        let at = |k: usize| {
            let slide = 0.4 * (0.01 * k as f64).sin();
            let turn = (0.5 * k as f64).to_radians();
            let b = Pose::turn([0.0, 0.0, 1.0], turn, [slide, -0.5 * slide, thick + gap]);
            Frame::new(Pose::IDENTITY, b).moved(&common)
        };
        let mut tracker = Tracker::new();
        let mut frames: Vec<Frame> = (0..frames).map(at).collect();
        frames.retain(|f| a.closest(&mut tracker, f).state == ContactState::Separated);
        Ok(a.with(frames))
    }

    /// Adds a motion in which B orbits A and spins by `degrees` per frame, approaching and
    /// receding.
    pub fn swinging(self, degrees: f64, frames: usize) -> Self {
        let mut pair = self.moving(Some(degrees), frames);
        let mut tracker = Tracker::new();
        let mut moved = std::mem::take(&mut pair.frames);
        for (k, f) in moved.iter_mut().enumerate() {
            let o = pair.closest(&mut tracker, f);
            let n = f.a.rotate(o.normal.into_inner().into());
            let swing = 0.5 - 0.5 * (std::f64::consts::TAU * k as f64 / frames as f64).cos();
            f.b.t = std::array::from_fn(|i| f.b.t[i] + 0.5 * swing * n[i]);
        }
        pair.with(moved)
    }

    fn with(mut self, frames: Vec<Frame>) -> Self {
        self.isometries = frames.iter().map(|f| (f.a.isometry(), f.b.isometry())).collect();
        self.frames = frames;
        self
    }

    fn closest(&self, tracker: &mut Tracker, f: &Frame) -> Outcome {
        let pose = RelativePose::new(&f.a.isometry(), &f.b.isometry()).expect("poses of a motion");
        tracker.closest(&self.a.ours, &self.b.ours, &pose)
    }

    /// Returns the size L of the pair in a frame: both radii plus the distance of the origins.
    pub fn size(&self, frame: usize) -> f64 {
        let f = &self.frames[frame];
        let radius = |b: &Body| crate::pose::radius(&b.points);
        radius(&self.a) + radius(&self.b) + crate::pose::norm(crate::pose::sub(f.b.t, f.a.t))
    }
}

/// Returns both witnesses in the world frame.
fn witnesses(f: &Frame, o: &Outcome) -> (Point, Point) {
    (f.a.apply(o.point_on_a.into()), f.b.apply(o.point_on_b.into()))
}

/// Returns `n` points spread evenly over the unit sphere, on a spiral.
pub fn ball(n: usize) -> Vec<Point> {
    let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let at = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f64 / n as f64;
        let (r, angle) = ((1.0 - z * z).sqrt(), turn * k as f64);
        [r * angle.cos(), r * angle.sin(), z]
    };
    match n {
        12 => shapes::icosphere(0).points,
        _ => (0..n).map(at).collect(),
    }
}

/// Returns a mesh from a file as a hull of radius 1, centred at the middle of its box.
pub fn mesh(path: &str) -> Result<Body, String> {
    let (points, _) = MeshFile::load(path).map_err(|e| e.to_string())?.whole();
    let body = Body::new(&points).map_err(|e| format!("{path}: {e}"))?;
    let (centre, radius) = body.ours.bounding_ball();
    let points: Vec<Point> = body
        .points
        .iter()
        .map(|p| std::array::from_fn(|k| (p[k] - centre[k]) / radius))
        .collect();
    Body::new(&points)
}
