//! The stage: bodies, watched pairs, and everything else that a frame shows.

use std::collections::HashMap;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Geometry, GeometryKind, ManifoldOptions, Outcome, PairTracker, RelativePose};
use lin_canny_record::{Bracket, ColumnLine, Contact, RenderMesh};

/// A body and its pose.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Number of the geometry.
    pub geometry: usize,
    /// Pose in the world frame.
    pub pose: Isometry3<f64>,
    /// Whether the body is drawn and may be picked.
    pub shown: bool,
    /// Red, green, blue, opacity.
    pub colour: [u8; 4],
}

/// A pair and its results.
#[derive(Clone, Debug)]
pub struct Pair {
    /// The two bodies.
    pub bodies: [usize; 2],
    /// Closest points and bounds.
    pub outcome: Option<Outcome>,
    /// The piece, triangle or patch of each body.
    pub subshapes: [u32; 2],
    /// Contact points in the world frame.
    pub contacts: Vec<Contact>,
}

impl Pair {
    /// Returns a pair without results.
    #[must_use]
    pub fn of(a: usize, b: usize) -> Self {
        Self {
            bodies: [a, b],
            outcome: None,
            subshapes: [0; 2],
            contacts: Vec::new(),
        }
    }
}

/// Bodies, pairs and decorations.
#[derive(Default)]
pub struct Stage {
    /// All geometries.
    pub geometries: Vec<Geometry>,
    /// Their render meshes, by the same number.
    pub solids: Vec<RenderMesh>,
    /// All bodies.
    pub bodies: Vec<Body>,
    /// The watched pairs.
    pub pairs: Vec<Pair>,
    /// Boxes of the broad phase.
    pub boxes: Vec<[Point3<f64>; 2]>,
    /// Columns of the broad phase.
    pub columns: Vec<ColumnLine>,
    /// Brackets of casts.
    pub brackets: Vec<Bracket>,
    /// Paths.
    pub paths: Vec<Vec<Point3<f64>>>,
    /// A line of text.
    pub note: String,
    trackers: HashMap<[usize; 2], PairTracker>,
}

/// Colours of bodies, in turn.
pub const PALETTE: [[u8; 4]; 6] = [
    [86, 140, 200, 255],
    [222, 150, 60, 255],
    [130, 175, 110, 255],
    [175, 130, 190, 255],
    [200, 110, 105, 255],
    [150, 150, 160, 255],
];

impl Stage {
    /// Adds a geometry and returns its number.
    pub fn geometry(&mut self, geometry: impl Into<Geometry>) -> usize {
        let geometry = geometry.into();
        self.solids.push(RenderMesh::from_geometry(&geometry));
        self.geometries.push(geometry);
        self.geometries.len() - 1
    }

    /// Adds a body in the next colour and returns its number.
    pub fn body(&mut self, name: impl Into<String>, geometry: usize, pose: Isometry3<f64>) -> usize {
        self.bodies.push(Body {
            name: name.into(),
            geometry,
            pose,
            shown: true,
            colour: PALETTE[self.bodies.len() % PALETTE.len()],
        });
        self.bodies.len() - 1
    }

    /// Measures a pair at the poses of its bodies.
    pub fn measure(&mut self, pair: usize) {
        let Some(watched) = self.pairs.get_mut(pair) else {
            return;
        };
        let [a, b] = watched.bodies.map(|k| &self.bodies[k]);
        let Ok(poses) = RelativePose::new_normalized(&a.pose, &b.pose) else {
            watched.outcome = None;
            return;
        };
        let (shape_a, shape_b) = (&self.geometries[a.geometry], &self.geometries[b.geometry]);
        let tracker = self.trackers.entry(watched.bodies).or_default();
        let answer = tracker.closest(shape_a, shape_b, &poses);
        watched.outcome = Some(answer.outcome);
        watched.subshapes = [answer.locations[0].subshape, answer.locations[1].subshape];
        if !watched.contacts.is_empty() {
            let options = ManifoldOptions::with_prediction(0.02 * self.solids[b.geometry].radius);
            let groups = tracker.contacts(shape_a, shape_b, &poses, &options).unwrap_or_default();
            watched.contacts = groups
                .iter()
                .flat_map(|group| &group.contacts)
                .map(|c| Contact {
                    name: c.point.id.to_string(),
                    on_a: a.pose * c.point.point_on_a,
                    on_b: b.pose * c.point.point_on_b,
                    normal: a.pose * c.normal.into_inner(),
                    separation: c.point.separation,
                })
                .collect();
        }
    }

    /// Measures every pair.
    pub fn measure_all(&mut self) {
        (0..self.pairs.len()).for_each(|k| self.measure(k));
    }

    /// Measures the pairs of a body that has moved. A body without a pair gets one with the closest
    /// body.
    pub fn moved(&mut self, body: usize) {
        let is_mine = |p: &Pair| p.bodies.contains(&body);
        if !self.pairs.iter().any(is_mine)
            && let Some(other) = self.nearest(body)
        {
            self.pairs.push(Pair::of(other, body));
        }
        for k in 0..self.pairs.len() {
            if is_mine(&self.pairs[k]) {
                self.measure(k);
            }
        }
    }

    fn nearest(&self, body: usize) -> Option<usize> {
        let of = &self.bodies[body];
        let ball = |k: &Body| {
            let (centre, radius) = self.geometries[k.geometry].bounding_ball();
            (k.pose * centre, radius)
        };
        let (centre, _) = ball(of);
        let others = self.bodies.iter().enumerate().filter(|(k, b)| *k != body && b.shown);
        let gap = |b: &Body| {
            let (c, r) = ball(b);
            (c - centre).norm() - r
        };
        others.min_by(|x, y| gap(x.1).total_cmp(&gap(y.1))).map(|(k, _)| k)
    }

    /// Returns the first body along a ray, and the distance along the ray.
    #[must_use]
    pub fn pick(&self, from: &Point3<f64>, along: &Vector3<f64>) -> Option<(usize, f64)> {
        let shown = self.bodies.iter().enumerate().filter(|(_, b)| b.shown);
        let hits = shown.filter_map(|(k, body)| {
            let solid = &self.solids[body.geometry];
            let from = body.pose.inverse_transform_point(from);
            let along = body.pose.inverse_transform_vector(along);
            let beside = from.coords - along * from.coords.dot(&along);
            if beside.norm() > solid.radius {
                return None;
            }
            let triangles = solid.triangles.iter().filter_map(|(c, _)| meets(c, &from, &along));
            Some((k, triangles.min_by(f64::total_cmp)?))
        });
        hits.min_by(|x, y| x.1.total_cmp(&y.1))
    }

    /// Returns centre and radius of a ball around all shown bodies. A half-space counts with the part
    /// that is drawn, and only if there is nothing else.
    #[must_use]
    pub fn ball(&self) -> (Point3<f64>, f64) {
        let is_bounded = |b: &&Body| self.geometries[b.geometry].kind() != GeometryKind::HalfSpace;
        if !self.bodies.iter().filter(|b| b.shown).any(|b| is_bounded(&b)) {
            let drawn = self.bodies.iter().find(|b| b.shown);
            let ball = drawn.map(|b| (b.pose * Point3::origin(), self.solids[b.geometry].radius));
            return ball.unwrap_or((Point3::origin(), 1.0));
        }
        let shown = || self.bodies.iter().filter(|b| b.shown).filter(is_bounded);
        let middle = |b: &Body| b.pose * self.geometries[b.geometry].bounding_ball().0;
        let radius = |b: &Body| self.geometries[b.geometry].bounding_ball().1;
        let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for b in shown() {
            let (p, r) = (middle(b).coords, Vector3::repeat(radius(b)));
            low = low.inf(&(p - r));
            high = high.sup(&(p + r));
        }
        if low.x > high.x {
            return (Point3::origin(), 1.0);
        }
        let centre = Point3::from((low + high) * 0.5);
        let far = shown()
            .map(|b| (middle(b) - centre).norm() + radius(b))
            .fold(0.0, f64::max);
        (centre, far.max(1e-12))
    }
}

/// Returns the distance along the ray to a triangle; `None` if it is missed.
fn meets([p, q, r]: &[Point3<f64>; 3], from: &Point3<f64>, along: &Vector3<f64>) -> Option<f64> {
    let (e, f) = (q - p, r - p);
    let across = along.cross(&f);
    let volume = e.dot(&across);
    let s = from - p;
    let u = s.dot(&across) / volume;
    let turned = s.cross(&e);
    let v = along.dot(&turned) / volume;
    let t = f.dot(&turned) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}
