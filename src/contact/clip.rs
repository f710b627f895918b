//! What two features share, seen along the normal: the corners of the polygon, segment or point.
//!
//! A corner is a corner of one feature inside the other, or a crossing of two edges. Both kinds are found from one table of signs,
//! in which A and B play the same part; corners on the border within rounding belong to both.

use super::shadow::Shadow;
use crate::polyhedron::topology::LARGE;

/// The most corners there are: of each feature, and crossings, two for each edge of one.
pub(super) const MOST: usize = 4 * LARGE;

/// Which corners or edges meet, by their numbers in the two shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meet {
    /// The witnesses.
    Witness,
    /// A corner of A's.
    CornerOfA(u8),
    CornerOfB(u8),
    /// Two edges.
    Crossing(u8, u8),
}

/// A pair of points across from each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) at: [f64; 2],
    /// Of the points on A and on B.
    pub(super) heights: [f64; 2],
    pub(super) meet: Meet,
}

/// A short list.
pub(super) struct Corners {
    list: [Corner; MOST],
    count: usize,
}

impl Corners {
    pub(super) fn new() -> Self {
        let none = Corner {
            at: [0.0; 2],
            heights: [0.0; 2],
            meet: Meet::Witness,
        };
        Self {
            list: [none; MOST],
            count: 0,
        }
    }

    pub(super) fn push(&mut self, corner: Corner) {
        if self.count < MOST {
            self.list[self.count] = corner;
            self.count += 1;
        }
    }

    pub(super) fn all(&self) -> &[Corner] {
        &self.list[..self.count]
    }

    pub(super) fn keep(&mut self, wanted: impl Fn(&Corner) -> bool) {
        let mut kept = 0;
        for k in 0..self.count {
            if wanted(&self.list[k]) {
                self.list[kept] = self.list[k];
                kept += 1;
            }
        }
        self.count = kept;
    }
}

/// For each edge of one shadow, which corners of the other lie outside it: beyond rounding, and by sign.
struct Sides {
    beyond: [u32; LARGE],
    outside: [u32; LARGE],
}

impl Sides {
    fn new(of: &Shadow, corners: &Shadow, noise: f64) -> Self {
        let mut sides = Self {
            beyond: [0; LARGE],
            outside: [0; LARGE],
        };
        for j in 0..of.count {
            let (p, q) = (of.corners[j], of.corners[of.next(j)]);
            let u = [q[0] - p[0], q[1] - p[1]];
            let margin = -noise * (u[0].abs() + u[1].abs());
            let (mut beyond, mut outside) = (0, 0);
            for (i, x) in corners.corners[..corners.count].iter().enumerate() {
                let side = u[0] * (x[1] - p[1]) - u[1] * (x[0] - p[0]);
                beyond |= u32::from(side < margin) << i;
                outside |= u32::from(side < 0.0) << i;
            }
            (sides.beyond[j], sides.outside[j]) = (beyond, outside);
        }
        sides
    }

    /// The corners inside all edges.
    fn inside(&self, of: &Shadow, corners: &Shadow) -> u32 {
        let all = (1u32 << corners.count) - 1;
        // An edge has no inside; its two sides would be a line.
        if of.is_edge() {
            return 0;
        }
        all & !self.beyond[..of.count].iter().fold(0, |m, b| m | b)
    }

    /// Whether the ends of edge `k` of the other shadow are on both sides of the line of edge `j`.
    fn parts(&self, j: usize, k: usize, next: usize) -> bool {
        (self.outside[j] >> k ^ self.outside[j] >> next) & 1 == 1
    }
}

/// The corners of what two features share, `noise` the rounding of a place. Two edges share nothing but crossings here.
pub(super) fn clip(a: &Shadow, b: &Shadow, noise: f64, corners: &mut Corners) {
    let of_b = Sides::new(b, a, noise);
    let of_a = Sides::new(a, b, noise);
    let (inside_b, inside_a) = (of_b.inside(b, a), of_a.inside(a, b));
    for i in (0..a.count).filter(|i| inside_b >> i & 1 == 1) {
        let [x, y, height] = a.corners[i];
        corners.push(Corner {
            at: [x, y],
            heights: [height, b.slope.height([x, y])],
            meet: Meet::CornerOfA(i as u8),
        });
    }
    for j in (0..b.count).filter(|j| inside_a >> j & 1 == 1) {
        let [x, y, height] = b.corners[j];
        corners.push(Corner {
            at: [x, y],
            heights: [a.slope.height([x, y]), height],
            meet: Meet::CornerOfB(j as u8),
        });
    }
    let all = (1u32 << a.count) - 1;
    let edges = |s: &Shadow| if s.is_edge() { 1 } else { s.count };
    for j in 0..edges(b) {
        if of_b.outside[j] == 0 || of_b.outside[j] == all {
            continue;
        }
        let next = b.next(j);
        for i in 0..edges(a) {
            if of_b.parts(j, i, a.next(i)) && of_a.parts(i, j, next) {
                corners.push(crossing(a, b, i, j));
            }
        }
    }
}

/// Where edge `i` of A's shadow crosses the line of edge `j` of B's, which parts its ends.
fn crossing(a: &Shadow, b: &Shadow, i: usize, j: usize) -> Corner {
    let (p, q) = (a.corners[i], a.corners[a.next(i)]);
    let (r, s) = (b.corners[j], b.corners[b.next(j)]);
    let side = |x: &[f64; 3]| (s[0] - r[0]) * (x[1] - r[1]) - (s[1] - r[1]) * (x[0] - r[0]);
    let (from, to) = (side(&p), side(&q));
    // One of the two is negative and the other is not.
    let t = from / (from - to);
    let at = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
    Corner {
        at,
        heights: [p[2] + t * (q[2] - p[2]), b.height_on_edge(j, at)],
        meet: Meet::Crossing(i as u8, j as u8),
    }
}

/// The ends of what two nearly parallel edges share, each end across from its foot on the other edge. Nothing for edges that
/// are not: then they cross at the witnesses.
pub(super) fn beside(a: &Shadow, b: &Shadow, sine: f64, corners: &mut Corners) {
    let direction = |s: &Shadow| [s.corners[1][0] - s.corners[0][0], s.corners[1][1] - s.corners[0][1]];
    let (u, v) = (direction(a), direction(b));
    let squared = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
    let turn = u[0] * v[1] - u[1] * v[0];
    if turn * turn > sine * sine * squared(u) * squared(v) {
        return;
    }
    for (of, to, is_a) in [(a, b, true), (b, a, false)] {
        for k in 0..2 {
            let [x, y, height] = of.corners[k];
            let t = to.along(0, [x, y]);
            if t > 0.0 && t < 1.0 {
                let foot = to.height_on_edge(0, [x, y]);
                corners.push(Corner {
                    at: [x, y],
                    heights: if is_a { [height, foot] } else { [foot, height] },
                    meet: if is_a {
                        Meet::CornerOfA(k as u8)
                    } else {
                        Meet::CornerOfB(k as u8)
                    },
                });
            }
        }
    }
}
