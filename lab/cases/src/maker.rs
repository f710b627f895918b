//! Writes the cases of a file, and puts a body at a wanted signed distance.

use crate::minkowski::{self, size};
use crate::pose::{add, scale};
use crate::queries::{Query, QueryCase};
use crate::rng::Rng;
use crate::shapes::Shape;
use crate::solid;
use crate::suite::{self, Case, Header, Line, SuiteShape, Truth};
use crate::{Body, ContactState, Point, Pose};
use std::io::{self, Write};

/// How numbers of bodies and poses are rounded before the exact answer is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Not at all.
    Double,
    /// To `f32`, so that an engine in single precision gets exactly what the file states.
    Single,
}

impl Precision {
    fn round<const N: usize>(self, x: [f64; N]) -> [f64; N] {
        match self {
            Self::Double => x,
            Self::Single => x.map(|x| f64::from(x as f32)),
        }
    }
}

/// A body of the file that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyId(usize);

/// Writes a file of cases.
pub struct Maker<W> {
    out: W,
    precision: Precision,
    /// The bodies, and their numbers in the file as soon as a case uses them.
    bodies: Vec<(Shape, Option<usize>)>,
    /// The bodies that are meshes.
    meshes: Vec<BodyId>,
    named: usize,
    cases: u64,
    motions: u64,
    family: &'static str,
    /// Random numbers of the family.
    pub rng: Rng,
    /// How many cases the family shall have.
    pub count: usize,
}

/// Whether a case stands alone, or which frame of the current motion it is.
#[derive(Clone, Copy, Debug)]
pub enum Frame {
    /// The case stands alone.
    Alone,
    /// Frame of the current motion.
    Of(u64),
}

impl<W: Write> Maker<W> {
    /// Starts a file.
    pub fn new(
        mut out: W,
        version: u32,
        name: &str,
        seed: u64,
        count: usize,
        precision: Precision,
    ) -> io::Result<Self> {
        let name = name.to_owned();
        suite::write(&mut out, &Line::Header(Header { version, name, seed }))?;
        Ok(Self {
            out,
            precision,
            bodies: Vec::new(),
            meshes: Vec::new(),
            named: 0,
            cases: 0,
            motions: 0,
            family: "",
            rng: Rng::new(seed),
            count,
        })
    }

    /// Starts a family with its own random numbers, so that it is the same whatever precedes it.
    pub fn start(&mut self, family: &'static str, seed: u64) {
        let number = family
            .bytes()
            .fold(0u64, |n, b| n.wrapping_mul(257).wrapping_add(b.into()));
        self.family = family;
        self.rng = Rng::of_case(seed, number);
    }

    /// Adds a body. Faces that are not given are computed, which takes long beyond 40 points.
    pub fn body(&mut self, shape: Shape) -> BodyId {
        let precision = self.precision;
        let points: Vec<Point> = shape.points.iter().map(|&p| precision.round(p)).collect();
        let shape = Shape { points, ..shape };
        let is_known = !shape.faces.is_empty() && precision == Precision::Double;
        let shape = if is_known { shape } else { shape.solved() };
        self.bodies.push((shape, None));
        BodyId(self.bodies.len() - 1)
    }

    /// Adds a closed mesh of triangles.
    pub fn mesh(&mut self, mut shape: Shape) -> BodyId {
        let precision = self.precision;
        shape.points.iter_mut().for_each(|p| *p = precision.round(*p));
        self.bodies.push((shape, None));
        let id = BodyId(self.bodies.len() - 1);
        self.meshes.push(id);
        id
    }

    /// Returns the corners of a random triangle, in random order.
    pub fn triangle(&mut self, mesh: BodyId) -> [Point; 3] {
        let shape = &self.bodies[mesh.0].0;
        let face = self.rng.pick(&shape.faces);
        let first = self.rng.below(3);
        [0, 1, 2].map(|k| shape.points[face[(first + k) % 3] as usize])
    }

    /// Adds `n` bodies that `draw` returns.
    pub fn bodies(&mut self, n: usize, draw: impl Fn(&mut Rng) -> Shape) -> Vec<BodyId> {
        let mut rng = self.rng.clone();
        let ids = (0..n).map(|_| self.body(draw(&mut rng))).collect();
        self.rng = rng;
        ids
    }

    /// Returns one of some bodies.
    pub fn pick(&mut self, ids: &[BodyId]) -> BodyId {
        *self.rng.pick(ids)
    }

    /// Returns the points of a body.
    pub fn points(&self, id: BodyId) -> &[Point] {
        &self.bodies[id.0].0.points
    }

    fn plain(&self, id: BodyId) -> Body<'_> {
        (&self.bodies[id.0].0).into()
    }

    fn solve(&self, a: BodyId, pose_a: &Pose, b: BodyId, pose_b: &Pose) -> Truth {
        minkowski::solve(self.plain(a), pose_a, self.plain(b), pose_b)
    }

    /// Returns the size of a pair at the origin.
    pub fn extent(&self, a: BodyId, b: BodyId) -> f64 {
        size(self.plain(a), &Pose::IDENTITY, self.plain(b), &Pose::IDENTITY)
    }

    /// Returns the pose of B, turned by `q`, at the signed distance `gap` from A as nearly as a
    /// rounded translation allows. B comes from the unit `direction`.
    pub fn aim(&mut self, a: BodyId, pose_a: &Pose, b: BodyId, q: [f64; 4], direction: Point, gap: f64) -> Pose {
        let extent = self.extent(a, b);
        assert!(extent > 0.0, "two points have no size");
        let from = |far: f64| Pose {
            q,
            t: add(pose_a.t, scale(direction, far * extent)),
        };
        let mut pose = from(1.1);
        let mut truth = self.solve(a, pose_a, b, &pose);
        let mut far = 1.1;
        while truth.state != ContactState::Separated {
            far *= 2.0; // bodies that are far from their own origins
            pose = from(far);
            truth = self.solve(a, pose_a, b, &pose);
        }
        // Along the normal the supporting planes stay the nearest ones; the second step corrects
        // what the first rounded.
        for _ in 0..2 {
            let n = truth.normal.expect("solved");
            pose.t = add(pose.t, scale(n, gap - truth.distance));
            truth = self.solve(a, pose_a, b, &pose);
            if truth.state != ContactState::Separated {
                break;
            }
        }
        pose
    }

    /// Writes a case that stands alone.
    pub fn case(&mut self, level: &str, a: BodyId, pose_a: Pose, b: BodyId, pose_b: Pose) -> io::Result<()> {
        self.frame(level, Frame::Alone, (a, pose_a), (b, pose_b))
    }

    /// Writes the side and the distance of a point from a mesh.
    pub fn point(&mut self, level: &str, mesh: BodyId, point: Point) -> io::Result<()> {
        let point = self.precision.round(point);
        let mesh = self.named(mesh)?;
        self.query(level, Query::Point { mesh, point })
    }

    /// Writes a pair of meshes.
    pub fn meshes(&mut self, level: &str, a: (BodyId, Pose), b: (BodyId, Pose)) -> io::Result<()> {
        let [pose_a, pose_b] = [self.rounded(a.1), self.rounded(b.1)];
        let [a, b] = [self.named(a.0)?, self.named(b.0)?];
        self.query(level, Query::Meshes { a, b, pose_a, pose_b })
    }

    /// Returns the contact state of two meshes.
    pub fn state(&self, a: (BodyId, Pose), b: (BodyId, Pose)) -> ContactState {
        let query = Query::Meshes {
            a: a.0.0,
            b: b.0.0,
            pose_a: a.1,
            pose_b: b.1,
        };
        solid::solve(&query, |id| &self.bodies[id].0).state
    }

    /// Writes a translation of B at a velocity.
    pub fn cast(&mut self, level: &str, a: (BodyId, Pose), b: (BodyId, Pose), velocity: Point) -> io::Result<()> {
        let [pose_a, pose_b] = [self.rounded(a.1), self.rounded(b.1)];
        let velocity = self.precision.round(velocity);
        let [a, b] = [self.named(a.0)?, self.named(b.0)?];
        let query = Query::Cast {
            a,
            b,
            pose_a,
            pose_b,
            velocity,
        };
        self.query(level, query)
    }

    /// Writes a ray against a mesh.
    pub fn ray(&mut self, level: &str, mesh: BodyId, origin: Point, direction: Point) -> io::Result<()> {
        let [origin, direction] = [origin, direction].map(|p| self.precision.round(p));
        let mesh = self.named(mesh)?;
        let query = Query::Ray {
            mesh,
            origin,
            direction,
        };
        self.query(level, query)
    }

    fn query(&mut self, level: &str, query: Query) -> io::Result<()> {
        let shape = |id: usize| {
            let named = self.bodies.iter().find(|body| body.1 == Some(id));
            &named.expect("a body of the file").0
        };
        let case = QueryCase {
            id: self.cases,
            family: self.family.to_owned(),
            level: level.to_owned(),
            truth: Some(solid::solve(&query, shape)),
            query,
        };
        self.cases += 1;
        suite::write(&mut self.out, &Line::Query(Box::new(case)))
    }

    fn rounded(&self, pose: Pose) -> Pose {
        Pose {
            q: self.precision.round(pose.q),
            t: self.precision.round(pose.t),
        }
    }

    /// Writes a motion of B past A, frame by frame.
    pub fn motion(&mut self, level: &str, a: BodyId, pose_a: Pose, b: BodyId, poses: &[Pose]) -> io::Result<()> {
        for (k, pose_b) in poses.iter().enumerate() {
            self.frame(level, Frame::Of(k as u64), (a, pose_a), (b, *pose_b))?;
        }
        self.motions += 1;
        Ok(())
    }

    fn frame(&mut self, level: &str, frame: Frame, a: (BodyId, Pose), b: (BodyId, Pose)) -> io::Result<()> {
        let (pose_a, pose_b) = (self.rounded(a.1), self.rounded(b.1));
        let truth = self.solve(a.0, &pose_a, b.0, &pose_b);
        let [a, b] = [self.named(a.0)?, self.named(b.0)?];
        let (sequence, frame) = match frame {
            Frame::Alone => (None, 0),
            Frame::Of(k) => (Some(self.motions), k),
        };
        let case = Case {
            id: self.cases,
            family: self.family.to_owned(),
            level: level.to_owned(),
            sequence,
            frame,
            a,
            b,
            pose_a,
            pose_b,
            truth: Some(truth),
        };
        self.cases += 1;
        suite::write(&mut self.out, &Line::Case(Box::new(case)))
    }

    /// Returns the number of a body in the file, and writes the body when it is used first.
    fn named(&mut self, body: BodyId) -> io::Result<usize> {
        let (shape, number) = &mut self.bodies[body.0];
        let id = match *number {
            Some(id) => return Ok(id),
            None => self.named,
        };
        *number = Some(id);
        self.named += 1;
        let (shape, is_mesh) = (shape.clone(), self.meshes.contains(&body));
        suite::write(&mut self.out, &Line::Shape(SuiteShape { id, shape, is_mesh }))?;
        Ok(id)
    }
}

/// Returns the lowest point of a turned body: what rests on a plane below it.
pub fn lowest(points: &[Point], q: [f64; 4]) -> Point {
    let turned = points.iter().map(|&p| Pose { q, t: [0.0; 3] }.apply(p));
    turned.reduce(|a, b| if b[2] < a[2] { b } else { a }).expect("points")
}
