//! What a receipt states: bodies, joints, legs, pairs that are ignored.

mod body;
mod joint;

use std::collections::BTreeMap;

pub(crate) use body::{Body, Motion, Steady};
pub(crate) use joint::{Joint, Kind, Leg};

use crate::Stop;
use crate::json::Json;
use crate::pose::{Placed, Pose};
use crate::real::Real;

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

    fn lengths(&mut self, numbers: &[Real]) {
        self.scale = numbers.iter().fold(self.scale, |scale, x| scale.max(x.scale()));
    }

    fn pose(&mut self, json: &Json) -> Result<Pose, Stop> {
        let numbers = json.reals::<7>()?;
        self.lengths(&numbers[..3]);
        Pose::of(&numbers)
    }

    /// Returns whether a link moves.
    fn carries(&self, link: usize) -> bool {
        link > 0 && self.joints[link - 1].moves
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

/// Reads a SHA-256 in 64 hex digits.
pub(crate) fn hash<'a>(json: &Json<'a>) -> Result<&'a str, Stop> {
    let text = json.text()?;
    if text.len() == 64 && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f')) {
        return Ok(text);
    }
    Stop::bad("not a SHA-256")
}
