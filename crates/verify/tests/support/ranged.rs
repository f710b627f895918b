//! Receipts of ranges, made without the library: cells by halving, planes by the closest points.

use super::*;

pub(crate) type Cell = Vec<[f64; 2]>;

/// The scene of an arm with a range of its joints, and for each pair the lines that prove it.
pub(crate) struct Ranged {
    pub(crate) arm: Receipt,
    pub(crate) pairs: Vec<[usize; 2]>,
    pub(crate) range: Cell,
    pub(crate) margin: f64,
    pub(crate) lines: Vec<String>,
}

pub(crate) fn middle(cell: &Cell) -> Vec<f64> {
    cell.iter().map(|[low, high]| 0.5 * (low + high)).collect()
}

/// The distance of a pair at a configuration without the radii, and the direction of the way.
pub(crate) fn at(arm: &Receipt, [a, b]: [usize; 2], q: Vec<f64>) -> (f64, V) {
    let leg = [q];
    closest(&[arm.placed(a, Some(&leg), 0.0), arm.placed(b, Some(&leg), 0.0)])
}

/// A direction in the frame of a link.
pub(crate) fn on_link(arm: &Receipt, link: usize, q: &[f64], n: V) -> V {
    let (mut arm, leg) = (arm.clone(), [q.to_vec()]);
    arm.bodies.push(Body {
        points: Vec::new(),
        radius: 0.0,
        motion: Move::Link(link, None),
    });
    let place = |x: V| arm.place(arm.bodies.len() - 1, Some(&leg), 0.0, x);
    let axis = |k: usize| {
        sub(
            place(std::array::from_fn(|j| f64::from(u8::from(j == k)))),
            place([0.0; 3]),
        )
    };
    std::array::from_fn(|k| dot(axis(k), n))
}

/// Writes the lines of a cell; false if it is too small.
pub(crate) fn prove(
    arm: &Receipt,
    pair: [usize; 2],
    margin: f64,
    cell: Cell,
    cuts: &mut Vec<String>,
    rng: &mut Rng,
    lines: &mut Vec<String>,
) -> bool {
    let radii = arm.bodies[pair[0]].radius + arm.bodies[pair[1]].radius;
    let (d, n) = at(arm, pair, middle(&cell));
    let widest = (0..cell.len())
        .max_by(|i, j| (cell[*i][1] - cell[*i][0]).total_cmp(&(cell[*j][1] - cell[*j][0])))
        .unwrap();
    let moved: f64 = cell.iter().map(|[low, high]| 0.9 * (high - low)).sum();
    if d - radii - margin > moved && d > 0.0 {
        let link = rng.below(arm.joints.len() + 1);
        let (normal, [a, b]) = (hexes(&on_link(arm, link, &middle(&cell), n)), pair);
        let cut = if cuts.is_empty() {
            String::new()
        } else {
            format!(",\"cut\":[{}]", cuts.join(","))
        };
        cuts.clear();
        lines.push(format!(
            "{{\"cell\":[{a},{b}]{cut},\"link\":{link},\"normal\":{normal}}}"
        ));
        return true;
    }
    if moved < 2e-2 {
        return false;
    }
    let at = middle(&cell)[widest];
    cuts.push(format!("[{widest},{}]", hex(at)));
    let (mut lower, mut upper) = (cell.clone(), cell);
    (lower[widest][1], upper[widest][0]) = (at, at);
    prove(arm, pair, margin, lower, cuts, rng, lines) && prove(arm, pair, margin, upper, cuts, rng, lines)
}

/// An arm of four joints and two boxes.
pub(crate) fn ranged(rng: &mut Rng, k: usize) -> Ranged {
    loop {
        let mut arm = arm(rng, 0.01, 1, 1);
        if k % 2 == 1 {
            arm.joints[3].drive = (1, -0.5, 0.2);
        }
        arm.ignored.push((1, vec![3], "they may meet"));
        let pairs = vec![[1, 4], [1, 5], [2, 4], [2, 5], [3, 4], [3, 5]];
        if let Some(found) = over(rng, k, arm, pairs) {
            return found;
        }
    }
}

/// A lever of three joints, one of which follows another, and a box.
pub(crate) fn small_ranged(rng: &mut Rng, k: usize) -> Ranged {
    loop {
        let lever = lever(rng, 0.01, 1, 1);
        if let Some(found) = over(rng, k, lever, vec![[0, 2], [1, 2]]) {
            return found;
        }
    }
}

/// A range about the start of the first leg, if all pairs are proven.
fn over(rng: &mut Rng, k: usize, mut arm: Receipt, pairs: Vec<[usize; 2]>) -> Option<Ranged> {
    let Line::Leg(rows) = arm.evidence[0].clone() else {
        unreachable!()
    };
    arm.evidence.clear();
    let half = [0.02, 0.08][k % 2];
    let range: Cell = rows[0]
        .iter()
        .map(|x| [x - half, x + half * rng.range(0.0, 1.0)])
        .collect();
    let margin = [0.0, 0.015625][k % 2];
    let mut lines = Vec::new();
    pairs
        .iter()
        .all(|pair| prove(&arm, *pair, margin, range.clone(), &mut Vec::new(), rng, &mut lines))
        .then_some(Ranged {
            arm,
            pairs,
            range,
            margin,
            lines,
        })
}

impl Ranged {
    pub(crate) fn text(&self) -> String {
        let range: Vec<String> = self.range.iter().map(|ends| hexes(ends)).collect();
        let (range, margin) = (range.join(","), hex(self.margin));
        let mut all = self.arm.lines();
        all[0] = format!("{{\"receipt\":1,\"claim\":\"range\",\"range\":[{range}],\"margin\":{margin}}}");
        all.extend(self.lines.iter().cloned());
        sealed(&all)
    }

    /// Whether a random configuration refutes the claim.
    pub(crate) fn is_false(&self, rng: &mut Rng) -> bool {
        (0..20).any(|_| {
            let q: Vec<f64> = self.range.iter().map(|[low, high]| rng.range(*low, *high)).collect();
            self.pairs.iter().any(|pair| {
                let radii = self.arm.bodies[pair[0]].radius + self.arm.bodies[pair[1]].radius;
                at(&self.arm, *pair, q.clone()).0 - radii < self.margin - 1e-9 - 1e-3 * self.margin
            })
        })
    }

    /// Whether a random configuration refutes the claim, for all pairs of which one body moves, at
    /// any time.
    pub(crate) fn is_false_anywhere(&self, rng: &mut Rng) -> bool {
        let mut one = self.arm.clone();
        // From 0 to 4, so that a body that flies arrives.
        one.apart = Some([0.0, 4.0, self.margin]);
        (0..20).any(|_| {
            let q = self.range.iter().map(|[low, high]| rng.range(*low, *high)).collect();
            one.evidence = vec![Line::Leg(vec![q])];
            one.is_false()
        })
    }

    /// Changes one thing; returns whether it must be refused.
    pub(crate) fn change(&mut self, rng: &mut Rng, k: usize) -> bool {
        let one = rng.below(self.lines.len());
        match k % 7 {
            0 => {
                // If its cut goes too, another plane may prove both halves.
                self.lines.remove(one);
                false
            }
            1 => {
                let line = self.lines[one].clone();
                self.lines.insert(one, line);
                true
            }
            2 => {
                // One unit more is claimed.
                let c = rng.below(self.range.len());
                let end = &mut self.range[c][1];
                *end = f64::from_bits(end.to_bits() + 1);
                false
            }
            3 => {
                let c = rng.below(self.range.len());
                self.range[c][0] -= 2.0;
                false
            }
            4 => {
                self.margin *= 64.0;
                self.margin += 0.25;
                false
            }
            5 => {
                let line = &mut self.lines[one];
                let at = line.find("\"normal\"").unwrap();
                let turned = line[at..].replace("\"-0x", "\"+0x").replace("\"0x", "\"-0x");
                line.replace_range(at.., &turned.replace("\"+0x", "\"0x").replace("\"-0x0p0", "\"0x0p0"));
                true
            }
            _ => {
                let Move::Rest(pose) = &mut self.arm.bodies[self.pairs[0][1]].motion else {
                    unreachable!()
                };
                pose[0] *= 0.5;
                false
            }
        }
    }
}
