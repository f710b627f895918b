//! Bodies, and how they move.

use dashu_ratio::RBig;

use super::Scene;
use crate::Stop;
use crate::ellipsoid::Ellipsoid;
use crate::half_space::HalfSpace;
use crate::json::Json;
use crate::points::Points;
use crate::pose::Pose;
use crate::real::{Exact, Real};

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
    /// With the points they span the body, or the parts that have their points.
    pub(crate) ellipsoids: Vec<Ellipsoid>,
    /// The body is a half-space; the points are the origin alone.
    pub(crate) half: Option<HalfSpace>,
    /// The radius of each part, if they differ.
    pub(crate) radii: Vec<RBig>,
    /// The greatest radius of a part.
    pub(crate) radius: RBig,
    /// By how much it is larger than the body that it stands for, as the writer says.
    pub(crate) larger: Option<Real>,
    /// What was changed to make a solid of the triangles, as the writer says.
    pub(crate) repaired: Option<String>,
    pub(crate) motion: Motion,
    pub(crate) moves: bool,
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

    /// Returns the greatest radius of some parts.
    pub(crate) fn radius_of(&self, [low, high]: [usize; 2]) -> &RBig {
        let some = self.radii.get(low..high).into_iter().flatten();
        some.max().unwrap_or(&self.radius)
    }
}

impl Scene {
    pub(super) fn body(&mut self, line: &Json) -> Result<(), Stop> {
        let number = self.bodies.len();
        line.only(&[
            "body",
            "name",
            "points",
            "parts",
            "faces",
            "ellipsoids",
            "half",
            "radius",
            "radii",
            "larger",
            "repaired",
            "at",
            "link",
            "steady",
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
        let half = line.find("half").map(HalfSpace::read).transpose()?;
        if let Some(half) = &half {
            line.only(&["body", "name", "half", "at", "link", "steady"])?;
            self.lengths(&[half.end]);
        }
        let origin = [Json::Text("0x0p0"), Json::Text("0x0p0"), Json::Text("0x0p0")];
        let (points, most) = match half {
            Some(_) => Points::read(&Json::Array(vec![Json::Array(origin.into())]), pivot)?,
            None => Points::read(line.get("points")?, pivot)?,
        };
        self.lengths(&most);
        let ellipsoids = line
            .find("ellipsoids")
            .map(|all| Ellipsoid::read(all, points.all.len()));
        let ellipsoids = ellipsoids.transpose()?.unwrap_or_default();
        for ellipsoid in &ellipsoids {
            self.lengths(&[ellipsoid.size]);
        }
        let (faces, parts) = (line.find("faces"), line.find("parts"));
        let solid = faces.is_some();
        let parts = match faces.xor(parts) {
            Some(lists) => lists_of(lists, points.all.len(), solid)?,
            None if solid => return Stop::bad("a body has parts or faces, not both"),
            None => Vec::new(),
        };
        if !ellipsoids.is_empty() && solid {
            return Stop::bad("a body has faces or ellipsoids, not both");
        }
        let (radii, radius) = radii_of(line, parts.len())?;
        let larger = line.find("larger").map(Json::real).transpose()?;
        if larger.is_some_and(|larger| larger < Real::ZERO) {
            return Stop::bad("larger is negative");
        }
        let repaired = line.find("repaired").map(Json::text).transpose()?.map(Into::into);
        let name = line.get("name")?.text()?.into();
        self.bodies.push(Body {
            name,
            points,
            parts,
            solid,
            ellipsoids,
            half,
            radii,
            radius,
            larger,
            repaired,
            motion,
            moves,
        });
        Ok(())
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

/// Reads the radius of each part, if they differ, and the greatest of them.
fn radii_of(line: &Json, parts: usize) -> Result<(Vec<RBig>, RBig), Stop> {
    let (one, each) = (line.find("radius"), line.find("radii").map(Json::array).transpose()?);
    let reals = match (one, each) {
        (Some(_), Some(_)) => return Stop::bad("a body has a radius or radii, not both"),
        (Some(radius), None) => vec![radius.real()?],
        (None, Some(radii)) if radii.len() != parts || parts == 0 => {
            return Stop::bad("a radius for each part is expected");
        }
        (None, Some(radii)) => radii.iter().map(Json::real).collect::<Result<_, _>>()?,
        (None, None) => vec![Real::ZERO],
    };
    if reals.iter().any(|radius| *radius < Real::ZERO) {
        return Stop::bad("a negative radius");
    }
    let radii: Vec<RBig> = reals.into_iter().map(Real::exact).collect();
    let most = radii.iter().max().cloned().unwrap_or(RBig::ZERO);
    Ok((if each.is_some() { radii } else { Vec::new() }, most))
}
