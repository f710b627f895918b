//! What a receipt states: bodies, joints, legs, pairs that are ignored.

use std::collections::BTreeMap;

use dashu_ratio::RBig;

use crate::Stop;
use crate::json::Json;
use crate::points::{Placed, Points, Pose};
use crate::real::{Exact, Real};
use crate::taylor::choose;

/// How a body moves.
#[derive(Debug)]
pub(crate) enum Motion {
    Rest(Pose),
    /// With a link, at a pose on it.
    Link(usize, Pose),
    Steady(Box<Steady>),
}

/// x(t) = p + R pivot + linear t + push t^2 / 2 + exp([angular] t) R (x - pivot).
#[derive(Debug)]
pub(crate) struct Steady {
    pub(crate) pose: Pose,
    pub(crate) pivot: Exact,
    pub(crate) linear: Exact,
    pub(crate) angular: Exact,
    pub(crate) push: Exact,
}

#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) points: Points,
    /// The body is the hulls of these points, and, if it is a solid, what these triangles enclose; all
    /// points are one part if there is none.
    pub(crate) parts: Vec<Vec<usize>>,
    pub(crate) solid: bool,
    pub(crate) radius: RBig,
    pub(crate) motion: Motion,
    pub(crate) moves: bool,
}

#[derive(Debug, PartialEq)]
pub(crate) enum Kind {
    Fixed,
    Turn,
    Slide,
}

/// Joint k carries link k.
#[derive(Debug)]
pub(crate) struct Joint {
    pub(crate) parent: usize,
    pub(crate) kind: Kind,
    pub(crate) origin: Pose,
    pub(crate) axis: Exact,
    /// Coordinate, factor and offset of its value.
    drive: (usize, RBig, RBig),
    moves: bool,
}

impl Joint {
    /// Returns the value of the joint as a polynomial in time.
    pub(crate) fn value(&self, leg: &Leg) -> Vec<RBig> {
        let mut value: Vec<RBig> = leg.power(self.drive.0).iter().map(|x| x * &self.drive.1).collect();
        value[0] += &self.drive.2;
        value
    }

    /// Returns the value of the joint at these values of the coordinates.
    pub(crate) fn at(&self, coordinate: impl Fn(usize) -> RBig) -> RBig {
        match self.kind {
            Kind::Fixed => RBig::ZERO,
            _ => coordinate(self.drive.0) * &self.drive.1 + &self.drive.2,
        }
    }

    pub(crate) fn coordinate(&self) -> usize {
        self.drive.0
    }

    pub(crate) fn factor(&self) -> &RBig {
        &self.drive.1
    }
}

/// Bezier control points of the coordinates, over the times 0 to 1.
#[derive(Clone, Debug)]
pub(crate) struct Leg(pub(crate) Vec<Vec<Real>>);

impl Leg {
    pub(crate) fn read(json: &Json) -> Result<Self, Stop> {
        json.only(&["leg"])?;
        let row = |x: &Json| x.array()?.iter().map(Json::real).collect::<Result<Vec<_>, _>>();
        let rows = json
            .get("leg")?
            .array()?
            .iter()
            .map(row)
            .collect::<Result<Vec<_>, _>>()?;
        if !(1..=17).contains(&rows.len()) || rows[0].len() > 1024 || rows.iter().any(|x| x.len() != rows[0].len()) {
            return Stop::bad("a leg has 1 to 17 rows of equal length, at most 1024");
        }
        Ok(Self(rows))
    }

    /// Returns the coefficients of a coordinate by powers of t.
    fn power(&self, coordinate: usize) -> Vec<RBig> {
        let mut differences: Vec<RBig> = self.0.iter().map(|row| row[coordinate].exact()).collect();
        let n = differences.len();
        for first in 1..n {
            for k in (first..n).rev() {
                differences[k] = &differences[k] - &differences[k - 1];
            }
        }
        differences
            .into_iter()
            .enumerate()
            .map(|(k, x)| x * RBig::from(choose(n - 1, k)))
            .collect()
    }
}

/// The order of the lines of a scene.
const ORDER: [&str; 5] = ["file", "base", "joint", "body", "ignored"];

#[derive(Debug, Default)]
pub(crate) struct Scene {
    pub(crate) files: Vec<(String, String)>,
    pub(crate) base: Option<Pose>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) bodies: Vec<Body>,
    /// For each pair its place among the reasons.
    pub(crate) ignored: BTreeMap<(usize, usize), usize>,
    pub(crate) reasons: Vec<String>,
    pub(crate) coordinates: usize,
    /// All coordinates are less than 2^scale.
    pub(crate) scale: i64,
    at: usize,
}

impl Body {
    /// Returns the points of some parts; `None` stands for all points.
    pub(crate) fn of_parts(&self, [low, high]: [usize; 2]) -> Option<Vec<usize>> {
        let some = self.parts.get(low..high).filter(|some| some.len() < self.parts.len())?;
        let mut points: Vec<usize> = some.iter().flatten().copied().collect();
        points.sort_unstable();
        points.dedup();
        Some(points)
    }
}

impl Scene {
    pub(crate) fn new() -> Self {
        Self {
            scale: -1022,
            ..Self::default()
        }
    }

    /// Reads a line; false if it is none of a scene.
    pub(crate) fn line(&mut self, line: &Json) -> Result<bool, Stop> {
        let Some(order) = ORDER.iter().position(|x| *x == line.kind()) else {
            return Ok(false);
        };
        if order < self.at {
            return Stop::bad(format!("a line {} after a line {}", ORDER[order], ORDER[self.at]));
        }
        self.at = order;
        match line.kind() {
            "file" => {
                line.only(&["file", "sha256"])?;
                let hash = hash(line.get("sha256")?)?;
                self.files.push((line.get("file")?.text()?.into(), hash.into()));
            }
            "base" => {
                line.only(&["base"])?;
                let base = self.pose(line.get("base")?)?;
                if self.base.replace(base).is_some() {
                    return Stop::bad("a second base");
                }
            }
            "joint" => self.joint(line)?,
            "body" => self.body(line)?,
            _ => self.ignore(line)?,
        }
        Ok(true)
    }

    /// Checks that the scene is whole.
    pub(crate) fn end(&self) -> Result<(), Stop> {
        if self.bodies.is_empty() || self.base.is_some() && self.joints.is_empty() {
            return Stop::bad("the scene has no body, or a base without joints");
        }
        Ok(())
    }

    fn lengths(&mut self, numbers: &[Real]) {
        self.scale = numbers.iter().fold(self.scale, |scale, x| scale.max(x.scale()));
    }

    fn pose(&mut self, json: &Json) -> Result<Pose, Stop> {
        let numbers = json.reals::<7>()?;
        self.lengths(&numbers[..3]);
        Pose::of(&numbers)
    }

    fn joint(&mut self, line: &Json) -> Result<(), Stop> {
        let number = self.joints.len() + 1;
        let kind = match line.get("kind")?.text()? {
            "fixed" => Kind::Fixed,
            "turn" => Kind::Turn,
            "slide" => Kind::Slide,
            _ => return Stop::bad("unknown kind of a joint"),
        };
        let fields = ["joint", "parent", "kind", "origin", "axis", "drive"];
        line.only(&fields[..if kind == Kind::Fixed { 4 } else { 6 }])?;
        let parent = line.get("parent")?.whole()?;
        if number > 1024 || line.get("joint")?.whole()? != number || parent >= number {
            return Stop::bad(format!(
                "joint {number} is expected, at most 1024, and a parent before it"
            ));
        }
        let origin = self.pose(line.get("origin")?)?;
        let mut joint = Joint {
            parent,
            kind,
            origin,
            axis: crate::real::zero(),
            drive: Default::default(),
            moves: self.carries(parent),
        };
        if joint.kind != Kind::Fixed {
            let [coordinate, factor, offset] = line.get("drive")?.list::<3>()?;
            joint.axis = line.get("axis")?.reals::<3>()?.map(Real::exact);
            let coordinate = coordinate.whole()?;
            if coordinate >= 1024 {
                return Stop::bad(format!("coordinate {coordinate}, of at most 1024"));
            }
            joint.drive = (coordinate, factor.real()?.exact(), offset.real()?.exact());
            joint.moves = true;
            self.coordinates = self.coordinates.max(joint.drive.0 + 1);
        }
        self.joints.push(joint);
        Ok(())
    }

    /// Returns whether a link moves.
    fn carries(&self, link: usize) -> bool {
        link > 0 && self.joints[link - 1].moves
    }

    fn body(&mut self, line: &Json) -> Result<(), Stop> {
        let number = self.bodies.len();
        line.only(&[
            "body", "name", "points", "parts", "faces", "radius", "at", "link", "steady",
        ])?;
        if number == 4096 || line.get("body")?.whole()? != number {
            return Stop::bad(format!("body {number} is expected, at most 4096"));
        }
        let at = line.find("at").map(|x| self.pose(x)).transpose()?;
        let mut pivot = [Real::ZERO; 3];
        let (motion, moves) = match (line.find("link"), line.find("steady"), at) {
            (Some(link), None, at) => {
                let link = link.whole()?;
                if link > self.joints.len() {
                    return Stop::bad(format!("unknown link {link}"));
                }
                (
                    Motion::Link(link, at.unwrap_or_else(Pose::identity)),
                    self.carries(link),
                )
            }
            (None, Some(steady), Some(pose)) => {
                steady.only(&["pivot", "linear", "angular", "push"])?;
                pivot = steady.get("pivot")?.reals::<3>()?;
                let vector = |key| Ok(steady.get(key)?.reals::<3>()?.map(Real::exact));
                let [linear, angular, push] = [vector("linear")?, vector("angular")?, vector("push")?];
                {
                    let pivot = pivot.map(Real::exact);
                    let steady = Steady {
                        pose,
                        pivot,
                        linear,
                        angular,
                        push,
                    };
                    (Motion::Steady(Box::new(steady)), true)
                }
            }
            (None, None, Some(pose)) => (Motion::Rest(pose), false),
            _ => return Stop::bad("a body moves in one way: at, link, link and at, or at and steady"),
        };
        let (points, most) = Points::read(line.get("points")?, pivot)?;
        self.lengths(&most);
        let (faces, parts) = (line.find("faces"), line.find("parts"));
        let solid = faces.is_some();
        let parts = match faces.xor(parts) {
            Some(lists) => lists_of(lists, points.all.len(), solid)?,
            None if solid => return Stop::bad("a body has parts or faces, not both"),
            None => Vec::new(),
        };
        let radius = line.find("radius").map_or(Ok(Real::ZERO), Json::real)?;
        if radius < Real::ZERO {
            return Stop::bad("a negative radius");
        }
        let name = line.get("name")?.text()?.into();
        self.bodies.push(Body {
            name,
            points,
            parts,
            solid,
            radius: radius.exact(),
            motion,
            moves,
        });
        Ok(())
    }

    fn ignore(&mut self, line: &Json) -> Result<(), Stop> {
        line.only(&["ignored", "why"])?;
        let why = line.get("why")?.text()?;
        if why.is_empty() {
            return Stop::bad("an ignored pair without a reason");
        }
        for pair in self.star(line.get("ignored")?)? {
            if self.ignored.insert(pair, self.reasons.len()).is_some() {
                return Stop::bad("a pair is ignored twice");
            }
        }
        self.reasons.push(why.into());
        Ok(())
    }

    /// Returns the joints between a link and the base, the nearest first.
    pub(crate) fn chain(&self, mut link: usize) -> Vec<usize> {
        let mut chain = Vec::new();
        while link > 0 {
            chain.push(link - 1);
            link = self.joints[link - 1].parent;
        }
        chain
    }

    /// Returns the vertices of a body at rest, in the world.
    pub(crate) fn placed(&self, body: usize) -> Result<Placed<'_>, Stop> {
        let body = &self.bodies[body];
        let pose = match &body.motion {
            Motion::Rest(pose) => pose.clone(),
            Motion::Link(link, at) if !body.moves => {
                let chain = self.chain(*link);
                if chain.len() > 16 {
                    return Stop::bad("more than 16 joints between a body at rest and the base");
                }
                let joints = chain
                    .iter()
                    .fold(at.clone(), |pose, k| self.joints[*k].origin.then(&pose));
                self.base.as_ref().map_or(joints.clone(), |base| base.then(&joints))
            }
            _ => return Stop::bad("the claim is about bodies at rest"),
        };
        Ok(Placed {
            pose,
            points: &body.points,
        })
    }
}

/// Reads the points of each part of a body; those of a solid are triangles.
fn lists_of(json: &Json, points: usize, triangles: bool) -> Result<Vec<Vec<usize>>, Stop> {
    let mut all = Vec::new();
    for part in json.array()? {
        let part = part.array()?.iter().map(Json::whole).collect::<Result<Vec<_>, _>>()?;
        if part.is_empty() || triangles && part.len() != 3 || part.iter().any(|k| *k >= points) {
            return Stop::bad("a part without points, or of an unknown point, or a face that is no triangle");
        }
        all.push(part);
    }
    if all.is_empty() || all.len() > 1 << 18 {
        return Stop::bad("a body has 1 to 262144 parts");
    }
    Ok(all)
}

/// Reads a SHA-256 in 64 hex digits.
pub(crate) fn hash<'a>(json: &Json<'a>) -> Result<&'a str, Stop> {
    let text = json.text()?;
    if text.len() == 64 && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f')) {
        return Ok(text);
    }
    Stop::bad("not a SHA-256")
}
