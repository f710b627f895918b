//! Evidence about bodies that are not convex: planes between groups of their parts.
//!
//! The parts of both bodies over the whole time are a cell. A plane proves a cell as far in time as
//! it can; what is left is cut, where the parts of the larger body are halved.

use nalgebra::Vector3;

use super::evidence::{Missing, PairJudge, Piece};
use super::groups::Group;
use super::stated::half;
use lin_canny::separation::Proof;

/// Greatest number of halvings of the time before parts are cut, and of two single parts.
const HALVINGS: [u32; 2] = [4, 24];

/// Greatest number of pieces of evidence of a pair, and why there is no receipt beyond it.
pub(super) const PIECES: usize = 20_000;
pub(super) const TOO_MANY: &str = "it takes more than 20000 planes";

/// Times at which the hulls of two bodies are tried, in parts of the interval.
const TIMES: u32 = 16;

impl PairJudge<'_> {
    /// Returns whether a body has parts.
    pub(super) fn has_parts(&self) -> bool {
        !self.a.body.parts.is_empty() || !self.b.body.parts.is_empty()
    }

    /// Returns evidence for all pairs of parts.
    pub(super) fn by_parts(&self, [from, until]: [f64; 2]) -> Result<Vec<Piece>, Missing> {
        let all = [self.a.groups.all(), self.b.groups.all()];
        let mut pieces = Vec::new();
        self.fill(all, [from, until], &mut Vec::new(), &mut pieces)?;
        Ok(pieces)
    }

    /// Returns a time and a plane between the hulls, which proves that no body is inside the other.
    pub(super) fn outside(&self, [from, until]: [f64; 2]) -> Option<(f64, Vector3<f64>)> {
        let [x, y] = [
            self.a.groups.get(self.a.groups.all())?,
            self.b.groups.get(self.b.groups.all())?,
        ];
        (0..=TIMES).find_map(|k| {
            let part = f64::from(k) / f64::from(TIMES);
            let time = from + part * (until - from);
            let time = if k == TIMES { until } else { time };
            let normal = self.between([&x, &y], time)?;
            let hulls = Some([&*x, &*y]);
            match self.plane_between(hulls, normal, Vector3::zeros(), time, time, 0.0)? {
                Proof::Plane { normal, .. } => Some((time, normal)),
                _ => None,
            }
        })
    }

    /// Appends evidence for a cell of parts from a time on.
    fn fill(
        &self,
        ranges: [[usize; 2]; 2],
        [from, until]: [f64; 2],
        cuts: &mut Vec<[usize; 2]>,
        pieces: &mut Vec<Piece>,
    ) -> Result<(), Missing> {
        let groups = [self.a.groups.get(ranges[0]), self.b.groups.get(ranges[1])];
        let is_cut = |side: usize| ranges[side][1] > ranges[side][0] + 1;
        let mut at = from;
        if let [Some(x), Some(y)] = &groups {
            let most = HALVINGS[usize::from(!is_cut(0) && !is_cut(1))];
            while let Some((end, proof)) = self.reached([x, y], [at, until], most) {
                if pieces.len() == PIECES {
                    let why = TOO_MANY;
                    return Err(Missing { from: at, until, why });
                }
                pieces.push(Piece {
                    from: at,
                    until: end,
                    proof,
                    cuts: core::mem::take(cuts),
                });
                if end == until {
                    return Ok(());
                }
                at = end;
            }
        }
        let size = |side: usize| groups[side].as_ref().map_or(f64::INFINITY, |group| group.size);
        let side = match [is_cut(0), is_cut(1)] {
            [false, false] => {
                return Err(Missing {
                    from: at,
                    until,
                    why: "two of their parts are not separated by more than rounding",
                });
            }
            [true, true] => usize::from(size(1) > size(0)),
            [first, _] => usize::from(!first),
        };
        let middle = half(ranges[side]);
        cuts.push([side, middle]);
        let [mut lower, mut upper] = [ranges; 2];
        (lower[side][1], upper[side][0]) = (middle, middle);
        self.fill(lower, [at, until], cuts, pieces)?;
        self.fill(upper, [at, until], cuts, pieces)
    }

    /// Returns a plane between two groups and how far it holds, with at most so many halvings.
    fn reached(&self, groups: [&Group; 2], [from, until]: [f64; 2], most: u32) -> Option<(f64, Proof)> {
        let mut end = until;
        for k in 0..=most {
            let middle = 0.5 * from + 0.5 * end;
            let normal = self.between(groups, middle);
            let plane = normal
                .and_then(|normal| self.plane_between(Some(groups), normal, Vector3::zeros(), from, end, self.keep));
            if let Some(proof) = plane {
                return Some((end, proof));
            }
            if k == 0 {
                // Groups that overlap at the start must be cut.
                self.between(groups, from)?;
            }
            if !(from < middle && middle < end) {
                return None;
            }
            end = middle;
        }
        None
    }
}
