//! Overlays of the bodies as triangles and strokes, in single precision relative to the target of
//! the camera.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{ContactState, Outcome};
use lin_canny_record::{Bracket, ColumnLine};

use crate::lit::{self, Lit};
use crate::stage::{Pair, Stage};

/// Red, green, blue, opacity.
pub type Colour = [u8; 4];

const LIT: Colour = [120, 235, 120, 255];
const GAP: Colour = [255, 70, 190, 255];
const OVERLAP: Colour = [255, 60, 50, 255];
const REGION: Colour = [70, 190, 110, 46];
const REGION_EDGE: Colour = [50, 150, 90, 150];
const CONTACT: Colour = [250, 215, 40, 255];
const BOX: Colour = [70, 80, 110, 110];
const PENCIL: Colour = [40, 130, 150, 60];
const SAFE: Colour = [40, 150, 70, 200];
const HIT: Colour = [210, 50, 40, 200];
const PATH: Colour = [120, 60, 200, 255];

/// Words of a vertex: position, normal, colour.
pub const CORNER_WORDS: usize = 7;
/// Words of a stroke: two ends, colour, width in pixels.
pub const STROKE_WORDS: usize = 8;

/// What to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Show {
    /// Closest points, segment and features.
    pub witnesses: bool,
    /// Closest points of all pairs, not only of the chosen pair.
    pub all: bool,
    /// Voronoi regions of the features of the chosen pair.
    pub regions: bool,
    /// Contact points with their normals.
    pub contacts: bool,
    /// Names of contacts.
    pub names: bool,
    /// Boxes of the broad phase.
    pub boxes: bool,
    /// Columns of the broad phase.
    pub columns: bool,
    /// Brackets of casts.
    pub brackets: bool,
    /// Paths.
    pub paths: bool,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            witnesses: true,
            all: true,
            regions: false,
            contacts: true,
            names: true,
            boxes: false,
            columns: false,
            brackets: true,
            paths: true,
        }
    }
}

/// Data for the graphics card, in words of 32 bits.
#[derive(Default)]
pub struct DrawList {
    /// Vertices of triangles.
    pub corners: Vec<u32>,
    /// Strokes that bodies in front of them hide.
    pub strokes: Vec<u32>,
    /// Strokes that nothing hides.
    pub marks: Vec<u32>,
    /// Texts and their positions in the world.
    pub texts: Vec<(Point3<f64>, String)>,
    origin: Vector3<f64>,
}

impl DrawList {
    /// Starts a list relative to a point.
    pub fn begin(&mut self, origin: &Point3<f64>) {
        self.corners.clear();
        self.strokes.clear();
        self.marks.clear();
        self.texts.clear();
        self.origin = origin.coords;
    }

    /// Adds everything except the bodies.
    pub fn add(&mut self, stage: &Stage, show: &Show, chosen: Option<usize>) {
        let size = if stage.pairs.len() <= 2 { 1.0 } else { 0.5 };
        for (k, pair) in stage.pairs.iter().enumerate() {
            let is_chosen = chosen == Some(k);
            if show.witnesses && (show.all || is_chosen) {
                self.witnesses(stage, pair, if is_chosen { 1.0 } else { size });
            }
            if show.regions && is_chosen {
                self.regions(stage, pair);
            }
            if show.contacts {
                self.contacts(stage, pair, show.names);
            }
        }
        if show.boxes {
            stage.boxes.iter().for_each(|b| self.aabb(b, BOX));
        }
        if show.columns {
            let (centre, radius) = stage.ball();
            stage.columns.iter().for_each(|p| self.column(p, &centre, radius));
        }
        if show.brackets {
            stage.brackets.iter().for_each(|b| self.bracket(stage, b));
        }
        if show.paths {
            for path in &stage.paths {
                path.windows(2).for_each(|w| self.mark(w[0], w[1], PATH, 2.5));
            }
        }
    }

    fn witnesses(&mut self, stage: &Stage, pair: &Pair, size: f32) {
        let Some(outcome) = &pair.outcome else { return };
        let bodies = pair.bodies.map(|k| &stage.bodies[k]);
        let features = [outcome.features.a, outcome.features.b];
        for ((body, feature), part) in bodies.into_iter().zip(features).zip(pair.subshapes) {
            let geometry = &stage.geometries[body.geometry];
            let lift = 2e-3 * stage.solids[body.geometry].radius;
            match lit::feature(geometry, &body.pose, part, feature) {
                Some(Lit::Vertex(p)) => self.mark(p, p, LIT, 15.0 * size),
                Some(Lit::Edge([p, q])) => self.mark(p, q, LIT, 6.0 * size),
                Some(Lit::Face(rim, normal)) => self.face(&rim, &normal, lift),
                None => {}
            }
        }
        let [p, q] = ends(outcome, bodies.map(|b| &b.pose));
        let colour = if outcome.state == ContactState::Separated {
            GAP
        } else {
            OVERLAP
        };
        self.mark(p, q, colour, 3.0 * size);
        for end in [p, q] {
            self.mark(end, end, [255; 4], 10.0 * size);
            self.mark(end, end, colour, 7.0 * size);
        }
    }

    /// Adds a face, lifted along its normal.
    fn face(&mut self, rim: &[Point3<f64>], normal: &Vector3<f64>, lift: f64) {
        let up = normal * lift;
        self.fan(rim, normal, &up, LIT);
    }

    fn fan(&mut self, rim: &[Point3<f64>], normal: &Vector3<f64>, up: &Vector3<f64>, colour: Colour) {
        for k in 2..rim.len() {
            for p in [rim[0], rim[k - 1], rim[k]] {
                push(&mut self.corners, p.coords + up - self.origin);
                push(&mut self.corners, *normal);
                self.corners.push(u32::from_le_bytes(colour));
            }
        }
    }

    fn regions(&mut self, stage: &Stage, pair: &Pair) {
        let Some(outcome) = &pair.outcome else { return };
        let features = [outcome.features.a, outcome.features.b];
        for ((k, feature), part) in pair.bodies.into_iter().zip(features).zip(pair.subshapes) {
            let body = &stage.bodies[k];
            let height = 1.3 * stage.solids[body.geometry].radius;
            for wall in lit::region(&stage.geometries[body.geometry], &body.pose, part, feature, height) {
                let normal = (wall[1] - wall[0]).cross(&(wall[2] - wall[0])).normalize();
                self.fan(&wall, &normal, &Vector3::zeros(), REGION);
                for i in 0..wall.len() {
                    self.stroke(wall[i], wall[(i + 1) % wall.len()], REGION_EDGE, 1.2);
                }
            }
        }
    }

    fn contacts(&mut self, stage: &Stage, pair: &Pair, names: bool) {
        let length = 0.35 * pair.bodies.map(|k| stage.solids[stage.bodies[k].geometry].radius)[1];
        for contact in &pair.contacts {
            let p = contact.on_a;
            self.mark(p, p + contact.normal * length, CONTACT, 2.5);
            self.mark(p, p, [60, 50, 0, 255], 9.0);
            self.mark(p, p, CONTACT, 6.5);
            if names {
                self.texts.push((p + contact.normal * length, contact.name.clone()));
            }
        }
    }

    fn aabb(&mut self, [low, high]: &[Point3<f64>; 2], colour: Colour) {
        let corner = |k: usize| Point3::from(Vector3::from_fn(|i, _| if k >> i & 1 == 0 { low[i] } else { high[i] }));
        for k in 0..8 {
            for axis in [1, 2, 4] {
                if k & axis == 0 {
                    self.stroke(corner(k), corner(k | axis), colour, 1.3);
                }
            }
        }
    }

    fn column(&mut self, column: &ColumnLine, centre: &Point3<f64>, radius: f64) {
        let axis = usize::from(column.axis) % 3;
        let (mut low, mut high) = (*centre, *centre);
        low[axis] -= radius;
        high[axis] += radius;
        for (k, other) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
            low[other] = column.lo[k];
            high[other] = column.hi[k];
        }
        self.aabb(&[low, high], PENCIL);
    }

    /// Adds the edges of both bodies at both ends of the bracket.
    fn bracket(&mut self, stage: &Stage, bracket: &Bracket) {
        for (poses, colour) in [(&bracket.at_safe, SAFE), (&bracket.at_hit, HIT)] {
            for (body, pose) in bracket.bodies.iter().zip(poses) {
                let Some(body) = stage.bodies.get(*body as usize) else {
                    continue;
                };
                for [p, q] in &stage.solids[body.geometry].edges {
                    self.stroke(pose * p, pose * q, colour, 1.6);
                }
            }
        }
    }

    fn stroke(&mut self, p: Point3<f64>, q: Point3<f64>, colour: Colour, width: f32) {
        stroke(&mut self.strokes, [p, q].map(|p| p.coords - self.origin), colour, width);
    }

    fn mark(&mut self, p: Point3<f64>, q: Point3<f64>, colour: Colour, width: f32) {
        stroke(&mut self.marks, [p, q].map(|p| p.coords - self.origin), colour, width);
    }
}

/// Returns the witnesses in the world frame.
fn ends(outcome: &Outcome, [a, b]: [&lin_canny::nalgebra::Isometry3<f64>; 2]) -> [Point3<f64>; 2] {
    [a * outcome.point_on_a, b * outcome.point_on_b]
}

fn push(words: &mut Vec<u32>, v: Vector3<f64>) {
    words.extend(v.iter().map(|&x| (x as f32).to_bits()));
}

fn stroke(words: &mut Vec<u32>, ends: [Vector3<f64>; 2], colour: Colour, width: f32) {
    ends.into_iter().for_each(|end| push(words, end));
    words.push(u32::from_le_bytes(colour));
    words.push(width.to_bits());
}
