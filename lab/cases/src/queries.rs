//! Cases of version 2: points and rays against meshes, pairs of meshes, and casts of convex bodies.

use crate::verdict::ContactState;
use crate::{Point, Pose};
use serde::{Deserialize, Serialize};

/// A query whose answer is exact. Bodies are named by their numbers in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Query {
    /// A point in the frame of a mesh.
    Point {
        /// The mesh.
        mesh: usize,
        /// The point.
        point: Point,
    },
    /// Two meshes at two poses.
    Meshes {
        /// The mesh A.
        a: usize,
        /// The mesh B.
        b: usize,
        /// World pose of A.
        pose_a: Pose,
        /// World pose of B.
        pose_b: Pose,
    },
    /// Two convex bodies, of which B moves along a line from time 0 to time 1.
    Cast {
        /// The body A.
        a: usize,
        /// The body B.
        b: usize,
        /// World pose of A.
        pose_a: Pose,
        /// World pose of B at time 0.
        pose_b: Pose,
        /// Velocity of B.
        velocity: Point,
    },
    /// A ray in the frame of a mesh, from time 0 to time 1.
    Ray {
        /// The mesh.
        mesh: usize,
        /// Where the ray starts.
        origin: Point,
        /// What the ray moves by.
        direction: Point,
    },
}

/// A query with its exact answer.
#[derive(Clone, Debug, PartialEq)]
pub struct QueryCase {
    /// Number, unique in the file.
    pub id: u64,
    /// Family of cases.
    pub family: String,
    /// Difficulty within the family.
    pub level: String,
    /// What is queried.
    pub query: Query,
    /// The exact values, unless the file is blind.
    pub truth: Option<QueryTruth>,
}

/// The exact answer of a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryTruth {
    /// Outside, on the surface or inside; apart, touching or overlapping; never met, only touched, or
    /// entered.
    pub state: ContactState,
    /// Signed distance, or time of the first contact: the nearest number and what rounding lost.
    /// `None` without a contact, and for the depth of meshes that are not convex.
    pub value: Option<[f64; 2]>,
    /// Size of the pair, to which tolerances are relative.
    pub size: f64,
}

/// A line of the file.
#[derive(Deserialize, Serialize)]
pub(crate) struct RawQuery {
    id: u64,
    #[serde(default)]
    fam: String,
    #[serde(default)]
    lvl: String,
    a: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    b: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    qa: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ta: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    qb: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tb: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    p: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    v: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cls: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    s_lo: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_lo: Option<f64>,
    #[serde(rename = "L", skip_serializing_if = "Option::is_none")]
    size: Option<f64>,
}

impl Query {
    /// Returns the numbers of the bodies; twice the same for a point and a ray.
    pub fn bodies(&self) -> [usize; 2] {
        match *self {
            Self::Point { mesh, .. } | Self::Ray { mesh, .. } => [mesh; 2],
            Self::Meshes { a, b, .. } | Self::Cast { a, b, .. } => [a, b],
        }
    }

    /// Returns the kind of the line.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Point { .. } => "point",
            Self::Meshes { .. } => "meshes",
            Self::Cast { .. } => "cast",
            Self::Ray { .. } => "ray",
        }
    }
}

impl RawQuery {
    /// Returns the case of a line of a kind.
    pub(crate) fn check(self, kind: &str) -> Result<QueryCase, String> {
        let id = self.id;
        let missing = |key: &str| format!("{kind} {id} has no {key}");
        let need = |x: Option<Point>, key: &str| x.ok_or_else(|| missing(key));
        let pose = |q: Option<[f64; 4]>, t: Option<Point>, of: char| {
            let pose = q.zip(t).map(|(q, t)| Pose { q, t });
            pose.ok_or_else(|| missing(&format!("q{of} and t{of}")))
        };
        let b = self.b.ok_or_else(|| missing("b"));
        let query = match kind {
            "point" => Query::Point {
                mesh: self.a,
                point: need(self.p, "p")?,
            },
            "meshes" => Query::Meshes {
                a: self.a,
                b: b?,
                pose_a: pose(self.qa, self.ta, 'a')?,
                pose_b: pose(self.qb, self.tb, 'b')?,
            },
            "cast" => Query::Cast {
                a: self.a,
                b: b?,
                pose_a: pose(self.qa, self.ta, 'a')?,
                pose_b: pose(self.qb, self.tb, 'b')?,
                velocity: need(self.v, "v")?,
            },
            _ => Query::Ray {
                mesh: self.a,
                origin: need(self.p, "p")?,
                direction: need(self.v, "v")?,
            },
        };
        let value = match (self.s, self.time) {
            (Some(s), None) => Some([s, self.s_lo.unwrap_or(0.0)]),
            (None, Some(t)) => Some([t, self.time_lo.unwrap_or(0.0)]),
            (None, None) => None,
            _ => return Err(format!("{kind} {id} has both s and time")),
        };
        let truth = match self.cls {
            None => None,
            Some(word) => Some(QueryTruth {
                state: ContactState::from_word(&word).ok_or_else(|| format!("class {word:?} of {kind} {id}"))?,
                value,
                size: self.size.ok_or_else(|| missing("L"))?,
            }),
        };
        Ok(QueryCase {
            id,
            family: self.fam,
            level: self.lvl,
            query,
            truth,
        })
    }
}

impl From<&QueryCase> for RawQuery {
    fn from(case: &QueryCase) -> Self {
        let (mut b, mut poses, mut p, mut v) = (None, None, None, None);
        let a = match case.query {
            Query::Point { mesh, point } => {
                p = Some(point);
                mesh
            }
            Query::Meshes {
                a,
                b: other,
                pose_a,
                pose_b,
            } => {
                (b, poses) = (Some(other), Some([pose_a, pose_b]));
                a
            }
            Query::Cast {
                a,
                b: other,
                pose_a,
                pose_b,
                velocity,
            } => {
                (b, poses, v) = (Some(other), Some([pose_a, pose_b]), Some(velocity));
                a
            }
            Query::Ray {
                mesh,
                origin,
                direction,
            } => {
                (p, v) = (Some(origin), Some(direction));
                mesh
            }
        };
        let is_time = matches!(case.query, Query::Cast { .. } | Query::Ray { .. });
        let value = case.truth.and_then(|t| t.value);
        let (s, time) = if is_time { (None, value) } else { (value, None) };
        Self {
            id: case.id,
            fam: case.family.clone(),
            lvl: case.level.clone(),
            a,
            b,
            qa: poses.map(|p| p[0].q),
            ta: poses.map(|p| p[0].t),
            qb: poses.map(|p| p[1].q),
            tb: poses.map(|p| p[1].t),
            p,
            v,
            cls: case.truth.map(|t| t.state.word().to_owned()),
            s: s.map(|s| s[0]),
            s_lo: s.map(|s| s[1]),
            time: time.map(|t| t[0]),
            time_lo: time.map(|t| t[1]),
            size: case.truth.map(|t| t.size),
        }
    }
}
