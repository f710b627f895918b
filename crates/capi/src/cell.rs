//! Answers of checkers: pairs of bodies, verdicts, counts.

use lin_canny_plan::{CellBody, CellPair, CheckWork, NearPair, Verdict};

use crate::memory::Plain;

/// A body of a checker: a robot body, an object that the robot carries, or an obstacle.
///
/// It is valid in its checker, and in copies made later, until the body is removed. It is never
/// used again.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct lc_world_body {
    /// The id; zero is none.
    pub id: u64,
}

/// Bits of an id below its kind.
const KIND: u32 = 56;

pub(crate) fn number(id: CellBody) -> lc_world_body {
    let (kind, index) = match id {
        CellBody::Robot(k) => (1, k),
        CellBody::Attached(k) => (2, k),
        CellBody::Obstacle(k) => (3, k),
    };
    lc_world_body {
        id: kind << KIND | index as u64,
    }
}

/// Returns the id of a body; an invented number is an id that no world has.
pub(crate) fn id(body: lc_world_body) -> CellBody {
    let index = (body.id & ((1 << KIND) - 1)) as usize;
    match body.id >> KIND {
        1 => CellBody::Robot(index),
        2 => CellBody::Attached(index),
        3 => CellBody::Obstacle(index),
        _ => CellBody::Obstacle(usize::MAX),
    }
}

/// The signed distance of a pair of bodies, with points in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_near {
    /// The first body; zero if there is no pair: then the distances are infinite and all else is
    /// zero.
    pub a: lc_world_body,
    /// The second body.
    pub b: lc_world_body,
    /// The signed distance: negative for an overlap, zero for an overlap of unknown depth.
    pub distance: f64,
    /// Proven lower bound of the signed distance.
    pub lower: f64,
    /// Proven upper bound of the signed distance.
    pub upper: f64,
    /// The signed distance less the required distance of the pair.
    pub excess: f64,
    /// The witness on the first body.
    pub point_on_a: [f64; 3],
    /// The witness on the second body.
    pub point_on_b: [f64; 3],
    /// The unit vector from the first body to the second; zero for an overlap of unknown depth.
    pub normal: [f64; 3],
}

// SAFETY: numbers only.
unsafe impl Plain for lc_near {
    const FIRST: usize = 120;
}

pub(crate) const NO_PAIR: lc_near = lc_near {
    a: lc_world_body { id: 0 },
    b: lc_world_body { id: 0 },
    distance: f64::INFINITY,
    lower: f64::INFINITY,
    upper: f64::INFINITY,
    excess: f64::INFINITY,
    point_on_a: [0.0; 3],
    point_on_b: [0.0; 3],
    normal: [0.0; 3],
};

fn bodies(pair: CellPair) -> [lc_world_body; 2] {
    [number(pair.a), number(pair.b)]
}

pub(crate) fn near(near: &NearPair) -> lc_near {
    let [a, b] = bodies(near.pair);
    lc_near {
        a,
        b,
        distance: near.distance,
        lower: near.lower,
        upper: near.upper,
        excess: near.excess,
        point_on_a: near.witnesses[0].into(),
        point_on_b: near.witnesses[1].into(),
        normal: near.normal.into(),
    }
}

/// The whole motion is proven free.
pub const LC_FREE: u32 = 0;
/// A pair is proven in contact, or closer than its required distance.
pub const LC_BLOCKED: u32 = 1;
/// A pair is within rounding error of contact or of its required distance.
pub const LC_OPEN: u32 = 2;

/// The verdict about a motion. Times are from 0 to 1 along the segment or curve.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_verdict {
    /// `LC_FREE`, `LC_BLOCKED` or `LC_OPEN`.
    pub state: u32,
    /// The number of contacts at the start that were accepted: these pairs are proven apart only after
    /// they have left the contact.
    pub start_contacts: u32,
    /// The segment of a path to which the verdict belongs.
    pub segment: u64,
    /// All pairs are proven apart up to this time.
    pub free_until: f64,
    /// The pair is proven in contact at this time, if blocked; else infinite.
    pub contact_at: f64,
    /// The distance that all pairs are proven to keep, if free; else zero.
    pub clearance: f64,
    /// The first body of the pair, if blocked; else zero.
    pub a: lc_world_body,
    /// The second body of the pair.
    pub b: lc_world_body,
    /// The closest point of the first body, if blocked, in the world.
    pub point_on_a: [f64; 3],
    /// The closest point of the second body.
    pub point_on_b: [f64; 3],
}

// SAFETY: numbers only.
unsafe impl Plain for lc_verdict {
    const FIRST: usize = 104;
}

pub(crate) fn verdict(verdict: &Verdict) -> lc_verdict {
    let none = lc_world_body { id: 0 };
    let mut answer = lc_verdict {
        state: LC_OPEN,
        start_contacts: verdict.start_contacts().len() as u32,
        segment: verdict.piece().unwrap_or(0) as u64,
        free_until: verdict.free_until(),
        contact_at: f64::INFINITY,
        clearance: 0.0,
        a: none,
        b: none,
        point_on_a: [0.0; 3],
        point_on_b: [0.0; 3],
    };
    match verdict {
        Verdict::Free { clearance, .. } => {
            answer.state = LC_FREE;
            answer.clearance = *clearance;
        }
        Verdict::Blocked {
            contact_at,
            pair,
            witnesses,
            ..
        } => {
            answer.state = LC_BLOCKED;
            answer.contact_at = *contact_at;
            [answer.a, answer.b] = bodies(*pair);
            [answer.point_on_a, answer.point_on_b] = witnesses.map(Into::into);
        }
        _ => {}
    }
    answer
}

/// Counts of the work of a checker since it was made.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lc_check_work {
    /// Segments checked.
    pub segments: u64,
    /// Segments proven free.
    pub free: u64,
    /// Distance queries on segments.
    pub queries: u64,
    /// Single configurations checked.
    pub configurations: u64,
    /// Distance queries at single configurations.
    pub measures: u64,
    /// Margin predicates at single configurations.
    pub decisions: u64,
}

// SAFETY: numbers only.
unsafe impl Plain for lc_check_work {
    const FIRST: usize = 48;
}

pub(crate) fn work(work: &CheckWork) -> lc_check_work {
    lc_check_work {
        segments: work.segments,
        free: work.free,
        queries: work.queries,
        configurations: work.configurations,
        measures: work.measures,
        decisions: work.decisions,
    }
}
