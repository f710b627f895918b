//! What the script of the page draws.
//!
//! Positions and lengths are relative to the ball around all bodies at the first frame that is
//! shown: 0 is its centre and 1 its radius. Bodies of another frame may be of any other size.

use std::collections::BTreeMap;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ContactState, Feature, Geometry, GeometryKind, Outcome};
use serde::Serialize;

use super::PageOptions;
use super::feature::feature;
use crate::format::{Bracket, ColumnLine, Contact, Frame, PairLine, poses};
use crate::picture::RenderMesh;
use crate::read::{Cursor, Recording};

/// Colours of bodies, in turn.
const PALETTE: [[u8; 3]; 6] = [
    [86, 140, 200],
    [222, 150, 60],
    [130, 175, 110],
    [175, 130, 190],
    [200, 110, 105],
    [150, 150, 160],
];

#[derive(Serialize)]
pub(super) struct Data<'r> {
    title: &'r str,
    frame: usize,
    view: [f64; 3],
    panel: bool,
    /// The ball around all bodies at the first frame that is shown, in the caller's units.
    center: [f64; 3],
    radius: f64,
    solids: Vec<Solid>,
    bodies: Vec<Body<'r>>,
    features: Vec<Lit>,
    frames: Vec<Shown<'r>>,
}

/// Triangles and edges in the body's frame, in units of its radius: single precision,
/// little-endian, in base 64.
#[derive(Serialize)]
struct Solid {
    triangles: String,
    edges: String,
    radius: f64,
}

#[derive(Serialize)]
struct Body<'r> {
    name: &'r str,
    color: [u8; 3],
    solid: usize,
}

/// A feature in the body's frame.
#[derive(Serialize)]
struct Lit {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
}

/// A frame, as what changes against the frame before and what is drawn with it alone.
#[derive(Serialize)]
struct Shown<'r> {
    poses: Vec<(usize, [f64; 7])>,
    hidden: Vec<usize>,
    /// Bodies whose meshes deformed, with their new solids.
    solids: Vec<(u32, usize)>,
    /// Centre and radius of a ball around all bodies.
    ball: [f64; 4],
    pairs: Vec<Pair<'r>>,
    /// Lower and upper corners.
    boxes: Vec<[[f64; 3]; 2]>,
    columns: Vec<[[f64; 3]; 2]>,
    brackets: Vec<Ends>,
    paths: Vec<Vec<[f64; 3]>>,
    note: &'r str,
}

#[derive(Serialize)]
struct Pair<'r> {
    bodies: [u32; 2],
    answer: Option<Answer>,
    contacts: Vec<(&'r str, [f64; 3], [f64; 3])>,
}

#[derive(Serialize)]
struct Answer {
    distance: f64,
    separated: bool,
    points: [[f64; 3]; 2],
    features: [Option<usize>; 2],
    /// Names and values for the panel.
    told: Vec<(&'static str, String)>,
}

/// The poses of two bodies where they are proven apart and in contact.
#[derive(Serialize)]
struct Ends {
    bodies: [u32; 2],
    safe: [[f64; 7]; 2],
    hit: [[f64; 7]; 2],
}

/// The map from the caller's units to those of the page.
#[derive(Clone, Copy)]
struct Scale {
    center: Point3<f64>,
    radius: f64,
}

impl Scale {
    fn point(&self, p: &Point3<f64>) -> [f64; 3] {
        ((p - self.center) / self.radius).into()
    }

    fn pose(&self, pose: &Isometry3<f64>) -> [f64; 7] {
        let [.., i, j, k, w] = poses::numbers(pose);
        let [x, y, z] = self.point(&Point3::from(pose.translation.vector));
        [x, y, z, i, j, k, w]
    }

    fn length(&self, v: &Vector3<f64>) -> [f64; 3] {
        (v / self.radius).into()
    }
}

/// The data in the making.
struct Builder<'r> {
    recording: &'r Recording,
    scale: Scale,
    /// The geometry of each solid.
    geometries: Vec<Geometry>,
    solids: Vec<Solid>,
    /// The solid of each body.
    of_bodies: Vec<usize>,
    features: Vec<Lit>,
    known: BTreeMap<(usize, u32, Feature), Option<usize>>,
}

impl<'r> Data<'r> {
    pub(super) fn new(recording: &'r Recording, options: &PageOptions) -> Self {
        let frame = options.frame.min(recording.frames.len().saturating_sub(1));
        let mut cursor = Cursor::default();
        // A recording without a frame shows its bodies.
        cursor.seek(recording, frame);
        if recording.frames.is_empty() {
            cursor.poses = recording.bodies.iter().map(|body| Some(body.pose)).collect();
        }
        let of_bodies: Vec<usize> = recording.bodies.iter().map(|b| b.geometry as usize).collect();
        let (center, radius) = ball(&recording.geometries, &of_bodies, &cursor.poses);
        let is_length = radius > 0.0 && radius.is_finite();
        let mut builder = Builder {
            recording,
            scale: Scale {
                center,
                radius: if is_length { radius } else { 1.0 },
            },
            geometries: Vec::new(),
            solids: Vec::new(),
            of_bodies,
            features: Vec::new(),
            known: BTreeMap::new(),
        };
        for geometry in &recording.geometries {
            builder.solid(geometry.clone());
        }
        let color = |k: usize| options.colors.get(k).copied().unwrap_or(PALETTE[k % PALETTE.len()]);
        let bodies = recording.bodies.iter().enumerate().map(|(k, body)| Body {
            name: &body.name,
            color: color(k),
            solid: body.geometry as usize,
        });
        let bodies = bodies.collect();
        let frames = if recording.frames.is_empty() {
            let poses = recording.bodies.iter().map(|body| builder.scale.pose(&body.pose));
            vec![Shown {
                poses: poses.enumerate().collect(),
                ..Shown::empty([0.0, 0.0, 0.0, 1.0])
            }]
        } else {
            builder.frames()
        };
        Self {
            title: &recording.title,
            frame,
            view: options.view,
            panel: options.panel,
            center: builder.scale.center.coords.into(),
            radius: builder.scale.radius,
            solids: builder.solids,
            bodies,
            features: builder.features,
            frames,
        }
    }
}

impl Shown<'_> {
    fn empty(ball: [f64; 4]) -> Self {
        Self {
            poses: Vec::new(),
            hidden: Vec::new(),
            solids: Vec::new(),
            ball,
            pairs: Vec::new(),
            boxes: Vec::new(),
            columns: Vec::new(),
            brackets: Vec::new(),
            paths: Vec::new(),
            note: "",
        }
    }
}

impl<'r> Builder<'r> {
    fn solid(&mut self, geometry: Geometry) -> usize {
        let mesh = RenderMesh::from_geometry(&geometry);
        let corners = mesh.triangles.iter().flat_map(|(corners, _)| corners);
        let unit = if mesh.radius > 0.0 { mesh.radius } else { 1.0 };
        self.solids.push(Solid {
            triangles: floats(corners, unit),
            edges: floats(mesh.edges.iter().flatten(), unit),
            radius: mesh.radius / self.scale.radius,
        });
        self.geometries.push(geometry);
        self.solids.len() - 1
    }

    fn frames(&mut self) -> Vec<Shown<'r>> {
        let recording = self.recording;
        let mut cursor = Cursor::default();
        let mut before = vec![None; recording.bodies.len()];
        let mut all = Vec::with_capacity(recording.frames.len());
        for (k, frame) in recording.frames.iter().enumerate() {
            cursor.seek(recording, k);
            let mut solids = Vec::new();
            for (body, vertices) in &frame.vertices {
                if let Some(solid) = self.deformed(*body, vertices) {
                    solids.push((*body, solid));
                }
            }
            let mut shown = self.frame(frame, &cursor.poses);
            shown.solids = solids;
            for (body, (last, pose)) in before.iter().zip(&cursor.poses).enumerate() {
                match pose {
                    Some(pose) if *last != Some(*pose) => shown.poses.push((body, self.scale.pose(pose))),
                    None if last.is_some() => shown.hidden.push(body),
                    _ => {}
                }
            }
            before.clone_from(&cursor.poses);
            all.push(shown);
        }
        all
    }

    /// Returns the solid of a mesh with other vertices.
    fn deformed(&mut self, body: u32, vertices: &[Point3<f64>]) -> Option<usize> {
        let of_body = self.of_bodies.get_mut(body as usize)?;
        let Geometry::Mesh(mesh) = &self.geometries[*of_body] else {
            return None;
        };
        let mut mesh = (**mesh).clone();
        mesh.set_vertices(vertices).ok()?;
        *of_body = self.solids.len();
        Some(self.solid(mesh.into()))
    }

    fn frame(&mut self, frame: &'r Frame, poses: &[Option<Isometry3<f64>>]) -> Shown<'r> {
        let scale = self.scale;
        let (center, radius) = ball(&self.geometries, &self.of_bodies, poses);
        let [x, y, z] = scale.point(&center);
        let point = |p: &Point3<f64>| scale.point(p);
        let ends = |bracket: &Bracket| Ends {
            bodies: bracket.bodies,
            safe: bracket.at_safe.each_ref().map(|p| scale.pose(p)),
            hit: bracket.at_hit.each_ref().map(|p| scale.pose(p)),
        };
        let columns = frame.columns.iter().map(|c| column(c, &center, radius));
        let boxes = frame.boxes.iter();
        Shown {
            pairs: frame.pairs.iter().map(|pair| self.pair(pair, poses)).collect(),
            boxes: boxes.map(|b| b.each_ref().map(point)).collect(),
            columns: columns.map(|b| b.each_ref().map(point)).collect(),
            brackets: frame.brackets.iter().map(ends).collect(),
            paths: frame
                .paths
                .iter()
                .map(|path| path.iter().map(point).collect())
                .collect(),
            note: &frame.note,
            ..Shown::empty([x, y, z, radius / scale.radius])
        }
    }

    fn pair(&mut self, pair: &'r PairLine, poses: &[Option<Isometry3<f64>>]) -> Pair<'r> {
        let bodies = [pair.a, pair.b];
        let shown = bodies.map(|body| poses.get(body as usize).copied().flatten());
        let answer = match (&pair.outcome, shown) {
            (Some(outcome), [Some(a), Some(b)]) => {
                let points = [a * outcome.point_on_a, b * outcome.point_on_b];
                Some(Answer {
                    distance: outcome.distance,
                    separated: outcome.state == ContactState::Separated,
                    points: points.each_ref().map(|p| self.scale.point(p)),
                    features: [
                        self.feature(pair.a, pair.subshapes[0], outcome.features.a),
                        self.feature(pair.b, pair.subshapes[1], outcome.features.b),
                    ],
                    told: told(outcome, pair.contacts.len()),
                })
            }
            _ => None,
        };
        let scale = self.scale;
        let contact = |c: &'r Contact| (c.name.as_str(), scale.point(&c.on_a), c.normal.into());
        Pair {
            bodies,
            answer,
            contacts: pair.contacts.iter().map(contact).collect(),
        }
    }

    /// Returns the number of a feature of a body.
    fn feature(&mut self, body: u32, part: u32, of: Feature) -> Option<usize> {
        let solid = *self.of_bodies.get(body as usize)?;
        if let Some(known) = self.known.get(&(solid, part, of)) {
            return *known;
        }
        let lit = feature(&self.geometries[solid], part, of).map(|lit| {
            let points = lit.points.iter().map(|p| self.scale.length(&p.coords));
            self.features.push(Lit {
                points: points.collect(),
                normals: lit.normals.into_iter().map(Into::into).collect(),
            });
            self.features.len() - 1
        });
        self.known.insert((solid, part, of), lit);
        lit
    }
}

/// Returns centre and radius of a ball around all bodies that are shown. A half-space counts with
/// the part that is drawn, and only if there is nothing else.
fn ball(geometries: &[Geometry], of_bodies: &[usize], poses: &[Option<Isometry3<f64>>]) -> (Point3<f64>, f64) {
    let shown = || {
        let all = of_bodies.iter().zip(poses);
        all.filter_map(|(k, pose)| Some((&geometries[*k], (*pose)?)))
    };
    let bounded = || {
        let all = shown().filter(|(geometry, _)| geometry.kind() != GeometryKind::HalfSpace);
        all.map(|(geometry, pose)| {
            let (center, radius) = geometry.bounding_ball();
            (pose * center, radius)
        })
    };
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for (center, radius) in bounded() {
        low = low.inf(&center.coords.add_scalar(-radius));
        high = high.sup(&center.coords.add_scalar(radius));
    }
    if low.x > high.x {
        let drawn = shown().next();
        let ball = drawn.map(|(geometry, pose)| {
            let radius = RenderMesh::from_geometry(geometry).radius;
            (Point3::from(pose.translation.vector), radius)
        });
        return ball.unwrap_or((Point3::origin(), 1.0));
    }
    let center = Point3::from((low + high) * 0.5);
    let radius = bounded().map(|(c, r)| (c - center).norm() + r).fold(0.0, f64::max);
    (center, if radius > 0.0 { radius } else { 1.0 })
}

/// Returns the box of a column within a ball.
fn column(column: &ColumnLine, center: &Point3<f64>, radius: f64) -> [Point3<f64>; 2] {
    let axis = usize::from(column.axis) % 3;
    let (mut low, mut high) = (*center, *center);
    low[axis] -= radius;
    high[axis] += radius;
    for (k, other) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().enumerate() {
        low[other] = column.lo[k];
        high[other] = column.hi[k];
    }
    [low, high]
}

fn told(o: &Outcome, contacts: usize) -> Vec<(&'static str, String)> {
    let kind = |feature| match feature {
        Feature::Vertex(_) => "vertex",
        Feature::Edge(_) => "edge",
        Feature::Face(_) => "face",
    };
    let mut rows = vec![
        ("contact state", o.state.to_string()),
        ("distance", number(o.distance)),
        ("lower", number(o.lower)),
        ("upper", number(o.upper)),
        ("between", format!("{:.1e}", o.upper - o.lower)),
        ("features", o.features.to_string()),
        ("", format!("{} - {}", kind(o.features.a), kind(o.features.b))),
        ("solver", o.solver.to_string()),
        ("steps", o.work.steps.to_string()),
    ];
    if contacts > 0 {
        rows.push(("contacts", contacts.to_string()));
    }
    rows
}

/// Formats a number with fixed digits if these are sufficient, otherwise with an exponent.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e6).contains(&x.abs()) {
        format!("{x:.15}")
    } else {
        format!("{x:.12e}")
    }
}

/// Returns the coordinates of points in a unit of length.
fn floats<'p>(points: impl Iterator<Item = &'p Point3<f64>>, unit: f64) -> String {
    let numbers = points.flat_map(|p| [p.x / unit, p.y / unit, p.z / unit]);
    base64(numbers.flat_map(|x| (x as f32).to_le_bytes()))
}

/// Returns bytes in base 64 (RFC 4648).
fn base64(bytes: impl Iterator<Item = u8>) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    let (mut bits, mut count) = (0u32, 0);
    for byte in bytes {
        bits = bits << 8 | u32::from(byte);
        count += 8;
        while count >= 6 {
            count -= 6;
            text.push(char::from(DIGITS[(bits >> count & 63) as usize]));
        }
    }
    if count > 0 {
        text.push(char::from(DIGITS[(bits << (6 - count) & 63) as usize]));
    }
    let padding = text.len().wrapping_neg() % 4;
    text + &"=".repeat(padding)
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn bytes_in_base_64() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
        ] {
            assert_eq!(base64(bytes.bytes()), text);
        }
    }
}
