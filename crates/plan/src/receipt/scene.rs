//! What a receipt states: bodies, how they move, and the pairs that are not looked at.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use super::error::ReceiptError;
use super::number::{hex, hexes};
use super::stated::{Ellipsoid, StatedHull, StatedParts, hull_of};
use super::taylor::Step;
use crate::extremes::Extremes;
use crate::motion::joint::JointKind;
use crate::motion::joint::TreeJoint;
use crate::motion::space::JointPath;
use lin_canny::motion::{Motion, Steady, Velocity};
use lin_canny::polyhedron::ConvexPolyhedron;
use lin_canny::{Compound, Geometry, MeshRepair};

/// Greatest number of vertices of a body.
const VERTICES: usize = 1 << 18;

/// Greatest number of parts of a body.
const PARTS: usize = 1 << 18;

/// Bodies and motions of a receipt.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    base: Isometry3<f64>,
    /// The joints; joint k carries link k + 1.
    joints: Vec<TreeJoint>,
    /// The link that each joint of the space carries, by its number in the space.
    links: BTreeMap<usize, usize>,
    pub(super) bodies: Vec<Body>,
    pub(super) ignored: Vec<Ignored>,
}

/// A pair that is not looked at.
#[derive(Clone, Debug)]
pub(super) struct Ignored {
    pub(super) pair: [usize; 2],
    pub(super) why: String,
}

/// A body: the hull of its points, or the hulls of its parts, rounded by a radius.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) name: String,
    pub(super) points: Vec<Point3<f64>>,
    /// The points of each part; none if the body is convex.
    pub(super) parts: Vec<Vec<usize>>,
    /// The parts are triangles, and what they enclose belongs to the body.
    pub(super) is_solid: bool,
    /// The hull of the points; of a body without parts it has the same points.
    pub(super) hull: Arc<ConvexPolyhedron>,
    /// The ellipsoids about points: of the body, or of the parts that have the points.
    pub(super) ellipsoids: Vec<Ellipsoid>,
    /// Normal and offset of a half-space; its only point is the origin.
    pub(super) half: Option<(Vector3<f64>, f64)>,
    /// The body or each of its parts itself, if it is not the hull of its points; empty if all are.
    pub(super) curved: Vec<Option<Geometry>>,
    /// The radius of each part; empty if all have that of the body.
    /// What a repair has changed in the mesh.
    repaired: Option<String>,
    pub(super) radii: Vec<f64>,
    /// The greatest radius of a part.
    pub(super) radius: f64,
    /// By how much it is larger than the body that it stands for, at most.
    pub(super) larger: f64,
    pub(super) way: Way,
}

/// How a body moves.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// Rests at a pose.
    Rests(Isometry3<f64>),
    /// Moves with a link, at a pose in its frame.
    Link(usize, Option<Isometry3<f64>>),
    /// Moves at constant velocities.
    Steady(SteadyWay),
}

/// The numbers of a motion at constant velocities.
#[derive(Clone, Debug)]
pub(super) struct SteadyWay {
    at: Isometry3<f64>,
    pub(super) pivot: Vector3<f64>,
    velocity: Velocity,
    push: Vector3<f64>,
}

impl Body {
    /// States a body, a surface with so many triangles as the fineness asks for.
    pub(super) fn new(
        name: &str,
        geometry: &Geometry,
        way: Way,
        #[cfg_attr(not(feature = "surfaces"), expect(unused))] fineness: usize,
    ) -> Result<Self, ReceiptError> {
        let refused = || ReceiptError::Body {
            name: name.into(),
            kind: geometry.kind(),
        };
        let of_pieces = |compound: &Compound| StatedParts::of_compound(compound).ok_or_else(refused);
        let mut body = Self {
            name: name.into(),
            points: vec![Point3::origin()],
            parts: Vec::new(),
            is_solid: false,
            hull: Arc::new(ConvexPolyhedron::point(Point3::origin()).map_err(|_| refused())?),
            ellipsoids: Vec::new(),
            half: None,
            curved: Vec::new(),
            radii: Vec::new(),
            radius: 0.0,
            larger: 0.0,
            repaired: None,
            way,
        };
        let stated = match geometry {
            Geometry::HalfSpace(half) => {
                body.half = Some((half.normal().into_inner(), half.offset()));
                return Ok(body);
            }
            Geometry::Mesh(mesh) => {
                let repair = mesh.report().repair.as_deref().filter(|repair| !repair.is_nothing());
                body.repaired = repair.map(MeshRepair::to_string);
                StatedParts::of_mesh(mesh)
            }
            #[cfg(feature = "surfaces")]
            Geometry::BezierSurface(surface) => {
                let (stated, larger) =
                    super::surface::triangles(surface, fineness, PARTS).ok_or_else(|| ReceiptError::Parts {
                        name: name.into(),
                        count: PARTS + 1,
                    })?;
                body.larger = larger;
                stated
            }
            Geometry::Compound(compound) => of_pieces(compound)?,
            Geometry::Cloud(cloud) => of_pieces(&cloud.to_compound().map_err(|_| refused())?)?,
            _ => {
                let stated = StatedHull::new(geometry).ok_or_else(refused)?;
                body.points = stated.hull.vertex_points().collect();
                if !stated.ellipsoids.is_empty() {
                    body.curved = vec![Some(geometry.clone())];
                }
                (body.hull, body.ellipsoids, body.radius) = (stated.hull, stated.ellipsoids, stated.radius);
                return body.checked();
            }
        };
        body.hull = Arc::new(hull_of(&stated.points).ok_or_else(refused)?);
        (body.points, body.parts, body.is_solid) = (stated.points, stated.parts, stated.is_solid);
        (body.ellipsoids, body.curved) = (stated.ellipsoids, stated.curved);
        let [least, most] = stated
            .radii
            .iter()
            .fold([f64::INFINITY, 0.0], |[low, high], r| [r.smaller(low), r.larger(high)]);
        body.radius = most;
        if least < most {
            body.radii = stated.radii;
        }
        body.checked()
    }

    /// Returns whether the receipt states no points of the surface of the body.
    pub(super) fn has_no_points(&self) -> bool {
        !self.ellipsoids.is_empty() || self.half.is_some() || self.larger > 0.0
    }

    /// Returns the greatest radius of some parts.
    pub(super) fn radius_of(&self, [low, high]: [usize; 2]) -> f64 {
        let some = self.radii.get(low..high).into_iter().flatten().copied();
        some.reduce(f64::larger).unwrap_or(self.radius)
    }

    /// Refuses a body with too many points or parts.
    fn checked(self) -> Result<Self, ReceiptError> {
        let (name, count) = (self.name.clone(), self.points.len());
        if count > VERTICES {
            return Err(ReceiptError::Vertices { name, count });
        }
        if self.parts.len() > PARTS {
            let count = self.parts.len();
            return Err(ReceiptError::Parts { name, count });
        }
        Ok(self)
    }

    /// Returns the point about which the ball of the body lies, in its frame.
    pub(super) fn centre(&self) -> Vector3<f64> {
        match &self.way {
            Way::Steady(way) => way.pivot,
            _ => Vector3::zeros(),
        }
    }

    fn line(&self, number: usize) -> String {
        let points = self.points.iter().map(|p| hexes(p.coords.as_slice()));
        let points: Vec<String> = points.collect();
        let form = match &self.half {
            Some((normal, offset)) => format!("\"half\":[{},\"{}\"]", hexes(normal.as_slice()), hex(*offset)),
            None => format!("\"points\":[{}]", points.join(",")),
        };
        let mut text = format!("{{\"body\":{number},\"name\":\"{}\",{form}", plain(&self.name));
        if !self.ellipsoids.is_empty() {
            let ellipsoid = |of: &Ellipsoid| {
                let axes: Vec<String> = of.axes.iter().map(|v| hexes(v.as_slice())).collect();
                format!("[{},[{}]]", of.centre, axes.join(","))
            };
            let all: Vec<String> = self.ellipsoids.iter().map(ellipsoid).collect();
            text += &format!(",\"ellipsoids\":[{}]", all.join(","));
        }
        if !self.parts.is_empty() {
            let parts: Vec<String> = self.parts.iter().map(|part| list(part)).collect();
            let key = if self.is_solid { "faces" } else { "parts" };
            text += &format!(",\"{key}\":[{}]", parts.join(","));
        }
        // Writing to a text never fails.
        if !self.radii.is_empty() {
            let _ = write!(text, ",\"radii\":{}", hexes(&self.radii));
        } else if self.radius > 0.0 {
            let _ = write!(text, ",\"radius\":\"{}\"", hex(self.radius));
        }
        if let Some(repaired) = &self.repaired {
            let _ = write!(text, ",\"repaired\":\"{}\"", plain(repaired));
        }
        if self.larger > 0.0 {
            let _ = write!(text, ",\"larger\":\"{}\"", hex(self.larger));
        }
        let _ = match &self.way {
            Way::Rests(at) => write!(text, ",\"at\":{}", pose(at)),
            Way::Link(link, None) => write!(text, ",\"link\":{link}"),
            Way::Link(link, Some(at)) => write!(text, ",\"link\":{link},\"at\":{}", pose(at)),
            Way::Steady(way) => write!(
                text,
                ",\"at\":{},\"steady\":{{\"pivot\":{},\"linear\":{},\"angular\":{},\"push\":{}}}",
                pose(&way.at),
                hexes(way.pivot.as_slice()),
                hexes(way.velocity.linear.as_slice()),
                hexes(way.velocity.angular.as_slice()),
                hexes(way.push.as_slice())
            ),
        };
        text.push('}');
        text
    }
}

impl SteadyWay {
    /// Returns the motion of a body that has the pose `at` in the frame that moves.
    pub(super) fn new(motion: &Steady, at: &Isometry3<f64>) -> Option<Self> {
        (motion.acceleration_bounds() == [0.0; 2]).then(|| Self {
            at: Motion::pose(motion, 0.0) * at,
            pivot: at.inverse_transform_point(&motion.pivot()).coords,
            velocity: motion.velocity(),
            push: motion.acceleration(),
        })
    }

    /// Returns whether the body rests.
    pub(super) fn is_still(&self) -> bool {
        self.velocity == Velocity::default() && self.push == Vector3::zeros()
    }

    pub(super) fn start(&self) -> Isometry3<f64> {
        self.at
    }
}

impl Scene {
    /// Returns the link that a path of joints leads to, and states the joints.
    ///
    /// Returns `None` if the paths have different bases.
    pub(super) fn link(&mut self, path: &JointPath) -> Option<usize> {
        // Bodies without joints are on the base, too.
        if !self.bodies.iter().any(|body| matches!(body.way, Way::Link(..))) {
            self.base = path.base;
        }
        if self.base != path.base {
            return None;
        }
        let mut parent = 0;
        for (number, joint) in &path.joints {
            let next = self.joints.len() + 1;
            let link = *self.links.entry(*number).or_insert(next);
            if link == next {
                let joint = TreeJoint {
                    parent,
                    ..joint.clone()
                };
                self.joints.push(joint);
            }
            parent = link;
        }
        Some(parent)
    }

    /// Adds a joint that is not of the robot, and returns its link.
    pub(super) fn add_joint(&mut self, joint: TreeJoint) -> usize {
        self.joints.push(joint);
        self.joints.len()
    }

    /// Makes bodies on the base rest if there are no joints.
    pub(super) fn settle(&mut self) {
        if self.joints.is_empty() {
            for body in &mut self.bodies {
                if let Way::Link(_, at) = body.way {
                    body.way = Way::Rests(self.base * at.unwrap_or_default());
                }
            }
        }
    }

    pub(super) fn base(&self) -> &Isometry3<f64> {
        &self.base
    }

    /// Returns the joints; joint k carries link k + 1.
    pub(super) fn joints(&self) -> &[TreeJoint] {
        &self.joints
    }

    /// Returns whether a body is stated larger than it is.
    pub(super) fn is_coarse(&self) -> bool {
        self.bodies.iter().any(|body| body.larger > 0.0)
    }

    /// Returns whether a coordinate drives a joint, so that a leg is needed.
    pub(super) fn is_driven(&self) -> bool {
        self.joints.iter().any(|joint| joint.drive.is_some())
    }

    /// Returns whether a body moves.
    pub(super) fn moves(&self, body: usize) -> bool {
        match self.bodies[body].way {
            Way::Rests(_) => false,
            Way::Steady(_) => true,
            Way::Link(link, _) => self.path(link).iter().any(|joint| joint.drive.is_some()),
        }
    }

    /// Returns the joints from the base to a link.
    fn path(&self, mut link: usize) -> Vec<&TreeJoint> {
        let mut path = Vec::new();
        while link > 0 {
            let joint = &self.joints[link - 1];
            path.push(joint);
            link = joint.parent;
        }
        path.reverse();
        path
    }

    /// Returns the steps from the world to a body, along a leg of these control points.
    pub(super) fn steps(&self, body: usize, rows: Option<&[Vec<f64>]>) -> Vec<Step> {
        let place = |at: &Isometry3<f64>| Step::place(at);
        match &self.bodies[body].way {
            Way::Rests(at) => vec![place(at)],
            Way::Steady(way) => {
                let lever = way.at.rotation * way.pivot;
                let start = way.at.translation.vector + lever;
                let coefficients = |k: usize| vec![start[k], way.velocity.linear[k], 0.5 * way.push[k]];
                let turn = Step::Turn {
                    axis: way.velocity.angular,
                    angle: vec![0.0, 1.0],
                };
                let own = Isometry3::from_parts(Translation3::from(-lever), way.at.rotation);
                vec![Step::Shift([0, 1, 2].map(coefficients)), turn, place(&own)]
            }
            Way::Link(link, at) => {
                let mut steps = vec![place(&self.base)];
                for joint in self.path(*link) {
                    steps.push(place(&joint.origin));
                    let (Some(drive), Some(rows)) = (joint.drive, rows) else {
                        continue;
                    };
                    let values = rows.iter().map(|q| drive.factor * q[drive.coordinate] + drive.offset);
                    let (axis, angle) = (joint.axis.into_inner(), powers(values.collect()));
                    steps.push(match joint.kind {
                        JointKind::Revolute => Step::Turn { axis, angle },
                        JointKind::Prismatic => {
                            Step::Shift([0, 1, 2].map(|k| angle.iter().map(|x| axis[k] * x).collect()))
                        }
                    });
                }
                steps.extend(at.iter().map(place));
                steps
            }
        }
    }

    /// Returns the greatest absolute coordinate of points and poses.
    pub(super) fn size(&self) -> f64 {
        let mut size = 0.0f64;
        let mut take = |v: &Vector3<f64>| {
            for x in v.iter() {
                size = if x.abs() > size { x.abs() } else { size };
            }
        };
        take(&self.base.translation.vector);
        self.joints
            .iter()
            .for_each(|joint| take(&joint.origin.translation.vector));
        for body in &self.bodies {
            body.points.iter().for_each(|p| take(&p.coords));
            body.ellipsoids.iter().flat_map(|of| &of.axes).for_each(&mut take);
            body.half.iter().for_each(|half| take(&Vector3::repeat(half.1)));
            match &body.way {
                Way::Rests(at) | Way::Link(_, Some(at)) => take(&at.translation.vector),
                Way::Steady(way) => take(&way.at.translation.vector),
                Way::Link(_, None) => {}
            }
        }
        size
    }

    /// Returns the lines of the scene, without the files.
    pub(super) fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if !self.joints.is_empty() {
            lines.push(format!("{{\"base\":{}}}", pose(&self.base)));
        }
        for (k, joint) in self.joints.iter().enumerate() {
            let (number, parent, origin) = (k + 1, joint.parent, pose(&joint.origin));
            let Some(drive) = joint.drive else {
                lines.push(format!(
                    "{{\"joint\":{number},\"parent\":{parent},\"kind\":\"fixed\",\"origin\":{origin}}}"
                ));
                continue;
            };
            let kind = match joint.kind {
                JointKind::Revolute => "turn",
                JointKind::Prismatic => "slide",
            };
            let (axis, coordinate) = (hexes(joint.axis.as_slice()), drive.coordinate);
            let [factor, offset] = [drive.factor, drive.offset].map(hex);
            lines.push(format!(
                "{{\"joint\":{number},\"parent\":{parent},\"kind\":\"{kind}\",\"origin\":{origin},\"axis\":{axis},\
                 \"drive\":[{coordinate},\"{factor}\",\"{offset}\"]}}"
            ));
        }
        lines.extend(self.bodies.iter().enumerate().map(|(k, body)| body.line(k)));
        let mut reasons: BTreeMap<&str, Vec<[usize; 2]>> = BTreeMap::new();
        for ignored in &self.ignored {
            reasons.entry(&ignored.why).or_default().push(ignored.pair);
        }
        for (why, pairs) in reasons {
            for (a, others) in grouped(pairs) {
                let (others, why) = (list(&others), plain(why));
                lines.push(format!("{{\"ignored\":[{a},{others}],\"why\":\"{why}\"}}"));
            }
        }
        lines
    }
}

/// Returns the coefficients by powers of t of Bezier control points.
fn powers(mut points: Vec<f64>) -> Vec<f64> {
    let n = points.len();
    for first in 1..n {
        for k in (first..n).rev() {
            points[k] -= points[k - 1];
        }
    }
    let mut choose = 1.0;
    for (k, point) in points.iter_mut().enumerate() {
        *point *= choose;
        choose *= (n - 1 - k) as f64 / (k + 1) as f64;
    }
    points
}

/// Returns pairs as few lists: a body, and those that it is paired with.
pub(super) fn grouped(mut pairs: Vec<[usize; 2]>) -> Vec<(usize, Vec<usize>)> {
    let mut groups = Vec::new();
    while !pairs.is_empty() {
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        for body in pairs.iter().flatten() {
            *counts.entry(*body).or_default() += 1;
        }
        // The first of those with the most pairs.
        let best = counts.iter().fold(
            (0, 0),
            |best, (&body, &count)| if count > best.1 { (body, count) } else { best },
        );
        let mut others = Vec::new();
        pairs.retain(|pair| match pair {
            [a, b] if *a == best.0 => {
                others.push(*b);
                false
            }
            [a, b] if *b == best.0 => {
                others.push(*a);
                false
            }
            _ => true,
        });
        others.sort_unstable();
        groups.push((best.0, others));
    }
    groups
}

/// Returns a list of numbers of bodies.
pub(super) fn list(all: &[usize]) -> String {
    let all: Vec<String> = all.iter().map(usize::to_string).collect();
    format!("[{}]", all.join(","))
}

fn pose(at: &Isometry3<f64>) -> String {
    let (t, q) = (at.translation.vector, at.rotation.coords);
    hexes(&[t.x, t.y, t.z, q.x, q.y, q.z, q.w])
}

/// Returns a text without the characters that a receipt does not hold: those that end a line or change how it
/// is shown.
pub(super) fn plain(text: &str) -> String {
    let is_bad = |c: char| match c {
        '"' | '\\' | '\u{2028}' | '\u{2029}' | '\u{200e}' | '\u{200f}' => true,
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        _ => c.is_control(),
    };
    text.chars().map(|c| if is_bad(c) { '_' } else { c }).collect()
}
