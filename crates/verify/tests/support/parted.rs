//! Receipts of bodies of parts, made without the library: a rod that passes through a frame.

use super::*;

/// A rod, and a frame of four bars whose parts are boxes or triangles.
#[derive(Clone)]
pub(crate) struct Parted {
    /// Until which time the hulls are apart, and the end of the claim.
    pub(crate) times: [f64; 2],
    pub(crate) rod: Vec<V>,
    /// Start along z, velocity and spin.
    pub(crate) motion: (f64, V, V),
    pub(crate) points: Vec<V>,
    pub(crate) parts: Vec<Vec<usize>>,
    pub(crate) is_solid: bool,
    pub(crate) at: Pose,
    /// Lines of evidence.
    pub(crate) lines: Vec<String>,
}

/// The triangles of a box whose points are those of [`cuboid`], from a number on.
pub(crate) fn triangles(first: usize) -> Vec<Vec<usize>> {
    let quads = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let halves = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    halves.map(|t| t.iter().map(|k| first + k).collect()).collect()
}

pub(crate) fn vectors(all: &[V]) -> String {
    rows(all.iter().map(|p| hexes(p)))
}

pub(crate) fn lists(all: &[Vec<usize>]) -> String {
    rows(all.iter().map(|part| rows(part.iter().map(usize::to_string))))
}

impl Parted {
    /// The hole has the half width .5, and the rod half the width of its points. A plane proves that
    /// the hulls are apart up to the first time, one for each bar does so for the rest.
    pub(crate) fn new(rod: V, motion: (f64, V, V), is_solid: bool) -> Self {
        let bars: [[V; 2]; 4] = [
            [[0.0, -0.75, 0.0], [1.0, 0.25, 0.25]],
            [[0.0, 0.75, 0.0], [1.0, 0.25, 0.25]],
            [[-0.75, 0.0, 0.0], [0.25, 1.0, 0.25]],
            [[0.75, 0.0, 0.0], [0.25, 1.0, 0.25]],
        ];
        let boxes = bars.map(|[middle, half]| cuboid(half).iter().map(|p| add(*p, middle)).collect::<Vec<V>>());
        let parts: Vec<Vec<usize>> = match is_solid {
            true => (0..4).flat_map(|k| triangles(8 * k)).collect(),
            false => (0..4).map(|k| (8 * k..8 * k + 8).collect()).collect(),
        };
        let (half, at) = (hex(0.5), parts.len() / 4);
        let plane = |normal: V, more: String| format!("{{\"plane\":[0,1],\"normal\":{}{more}}}", hexes(&normal));
        let from = format!(",\"from\":{half}");
        let lines = vec![
            plane([0.0, 0.0, 1.0], format!(",\"until\":{half}")),
            plane([0.0, -1.0, 0.0], format!("{from},\"cut\":[[1,{}],[1,{at}]]", 2 * at)),
            plane([0.0, 1.0, 0.0], from.clone()),
            plane([-1.0, 0.0, 0.0], format!("{from},\"cut\":[[1,{}]]", 3 * at)),
            plane([1.0, 0.0, 0.0], from),
        ];
        Self {
            times: [0.0, 1.0],
            rod: cuboid(rod),
            motion,
            points: boxes.concat(),
            parts,
            is_solid,
            at: REST,
            lines,
        }
    }

    /// One whose rod has room in the hole.
    pub(crate) fn random(rng: &mut Rng) -> Self {
        let rod = [rng.range(0.05, 0.25), rng.range(0.05, 0.25), rng.range(0.05, 0.25)];
        let aside = [rng.range(-0.05, 0.05), rng.range(-0.05, 0.05), 2.0];
        let spin = rng.vector(0.2);
        Self::new(rod, (-2.0, aside, spin), rng.below(2) == 0)
    }

    /// Head, rod, frame, evidence: the lines without the tail.
    pub(crate) fn all_lines(&self) -> Vec<String> {
        let (key, zero) = (if self.is_solid { "faces" } else { "parts" }, hexes(&[0.0; 3]));
        let (z, velocity, spin) = self.motion;
        let [from, until] = self.times.map(hex);
        let start = hexes(&[0.0, 0.0, z, 0.0, 0.0, 0.0, 1.0]);
        let mut all = vec![
            format!("{{\"receipt\":1,\"claim\":\"apart\",\"from\":{from},\"until\":{until},\"margin\":\"0x0p0\"}}"),
            format!(
                "{{\"body\":0,\"name\":\"rod\",\"points\":{},\"at\":{start},\"steady\":{{\"pivot\":{zero},\"linear\":{},\
                 \"angular\":{},\"push\":{zero}}}}}",
                vectors(&self.rod),
                hexes(&velocity),
                hexes(&spin)
            ),
            format!(
                "{{\"body\":1,\"name\":\"frame\",\"points\":{},\"{key}\":{},\"at\":{}}}",
                vectors(&self.points),
                lists(&self.parts),
                hexes(&self.at)
            ),
        ];
        all.extend(self.lines.iter().cloned());
        all
    }

    pub(crate) fn text(&self) -> String {
        sealed(&self.all_lines())
    }

    /// The least distance of the rod from a part at samples of the time.
    pub(crate) fn nearest(&self) -> f64 {
        let (z, velocity, spin) = self.motion;
        let parts = self
            .parts
            .iter()
            .map(|part| part.iter().map(|k| posed(&self.at, self.points[*k])).collect());
        let parts: Vec<Vec<V>> = parts.collect();
        let [from, until] = self.times;
        let mut least = f64::INFINITY;
        for k in 0..=32 {
            let t = from + (until - from) * f64::from(k) / 32.0;
            let place = |p: &V| add(turned(scale(spin, t), *p), add([0.0, 0.0, z], scale(velocity, t)));
            let rod: Vec<V> = self.rod.iter().map(place).collect();
            for part in &parts {
                least = least.min(closest(&[rod.clone(), part.clone()]).0);
            }
        }
        least
    }

    /// Changes one thing.
    pub(crate) fn change(&mut self, rng: &mut Rng, way: usize) {
        let count = self.parts.len();
        let k = rng.below(self.lines.len());
        match way {
            0 => {
                let part = &mut self.parts[rng.below(count)];
                let corner = rng.below(part.len());
                part[corner] = rng.below(32);
            }
            1 => {
                let cuts: Vec<usize> = (0..self.lines.len())
                    .filter(|k| self.lines[*k].contains("cut"))
                    .collect();
                let line = &mut self.lines[cuts[rng.below(cuts.len())]];
                let at = line.rfind("[1,").unwrap() + 3;
                let end = at + line[at..].find(']').unwrap();
                line.replace_range(at..end, &rng.below(count + 1).to_string());
            }
            2 => drop(self.lines.remove(k)),
            3 => self.lines.insert(k, self.lines[k].clone()),
            4 => {
                let from = rng.range(0.4, 0.6);
                let line = &mut self.lines[k];
                *line = line.replace("\"0x1p-1\"", &hex(from));
            }
            5 => {
                let shift = rng.vector(0.5);
                self.at[..3].copy_from_slice(&shift);
            }
            _ => self.motion.1[rng.below(2)] = rng.range(-1.0, 1.0),
        }
    }
}

/// The rod at rest in the hole of the frame: both bounds of the distance.
#[derive(Clone)]
pub(crate) struct Gapped {
    /// The frame, and the points of the rod.
    pub(crate) frame: Parted,
    /// The pose of the rod.
    pub(crate) start: Pose,
    pub(crate) bounds: [f64; 2],
    /// Cuts and a normal for each cell.
    pub(crate) cells: Vec<(Vec<[usize; 2]>, V)>,
    pub(crate) on: [Weights; 2],
}

impl Gapped {
    /// `room` widens both bounds, as the pose rounds.
    pub(crate) fn new(rod: V, start: Pose, is_solid: bool, room: f64) -> Self {
        let frame = Parted::new(rod, (0.0, [0.0; 3], [0.0; 3]), is_solid);
        let normals = [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        let at = frame.parts.len() / 4;
        let cuts = [vec![[1, 2 * at], [1, at]], vec![], vec![[1, 3 * at]], vec![]];
        let placed: Vec<V> = frame.rod.iter().map(|p| posed(&start, *p)).collect();
        let gap = |k: usize, v: usize| 0.5 - dot(normals[k], placed[v]);
        let all = (0..4).flat_map(|k| (0..8).map(move |v| (k, v)));
        let (k, v) = all.min_by(|x, y| gap(x.0, x.1).total_cmp(&gap(y.0, y.1))).unwrap();
        let point = add(placed[v], scale(normals[k], gap(k, v)));
        // The face of the bar towards the rod, as two triangles.
        let [a, b, c, d] = [[2, 3, 7, 6], [0, 4, 5, 1], [1, 5, 7, 3], [0, 2, 6, 4]][k].map(|i| 8 * k + i);
        let weights = |corners: [usize; 3]| {
            let [p, q, r] = corners.map(|i| frame.points[i]);
            let (u, w, x) = (sub(q, p), sub(r, p), sub(point, p));
            let (uu, uw, ww, ux, wx) = (dot(u, u), dot(u, w), dot(w, w), dot(u, x), dot(w, x));
            let square = uu * ww - uw * uw;
            let (s, t) = ((ux * ww - wx * uw) / square, (wx * uu - ux * uw) / square);
            corners.into_iter().zip([1.0 - s - t, s, t]).collect::<Weights>()
        };
        let inside = |on: &Weights| on.iter().all(|x| x.1 >= 0.0);
        let on = [[a, b, c], [a, c, d]].map(weights).into_iter().find(inside).unwrap();
        Self {
            bounds: [gap(k, v) - room, gap(k, v) + room],
            cells: cuts.into_iter().zip(normals).collect(),
            on: [vec![(v, 1.0)], on],
            frame,
            start,
        }
    }

    /// Half of them with exact bounds.
    pub(crate) fn random(rng: &mut Rng) -> Self {
        let (is_exact, is_solid) = (rng.below(2) == 0, rng.below(2) == 0);
        if is_exact {
            let mut dyadic = |low: f64, high: f64| (rng.range(low, high) * 64.0).round() / 64.0;
            let rod = std::array::from_fn(|_| dyadic(0.0625, 0.25));
            let shift = [dyadic(-0.125, 0.125), dyadic(-0.125, 0.125), 0.0, 0.0, 0.0, 0.0, 1.0];
            return Self::new(rod, shift, is_solid, 0.0);
        }
        let rod = [rng.range(0.05, 0.2), rng.range(0.05, 0.2), rng.range(0.05, 0.12)];
        let (shift, turn) = (rng.vector(0.05), rng.vector(0.1));
        let pose = [shift[0], shift[1], shift[2], turn[0], turn[1], turn[2], 1.0];
        let n = (dot(turn, turn) + 1.0).sqrt();
        let pose = std::array::from_fn(|k| if k < 3 { pose[k] } else { pose[k] / n });
        Self::new(rod, pose, is_solid, 1e-14)
    }

    pub(crate) fn text(&self) -> String {
        let body = |k: usize, points: &str, at: &Pose| {
            let name = ["rod", "frame"][k];
            format!("{{\"body\":{k},\"name\":\"{name}\",{points},\"at\":{}}}", hexes(at))
        };
        let key = if self.frame.is_solid { "faces" } else { "parts" };
        let (rod, frame) = (vectors(&self.frame.rod), vectors(&self.frame.points));
        let cell = |(cuts, normal): &(Vec<[usize; 2]>, V)| {
            let cuts = rows(cuts.iter().map(|[side, at]| format!("[{side},{at}]")));
            format!("[{cuts},{}]", hexes(normal))
        };
        let [lower, upper] = self.bounds.map(hex);
        let (cells, on) = (rows(self.cells.iter().map(cell)), on(&self.on));
        sealed(&[
            "{\"receipt\":1,\"claim\":\"lines\"}".into(),
            body(0, &format!("\"points\":{rod}"), &self.start),
            body(
                1,
                &format!("\"points\":{frame},\"{key}\":{}", lists(&self.frame.parts)),
                &self.frame.at,
            ),
            format!("{{\"distance\":[0,1],\"lower\":{lower},\"upper\":{upper},\"cells\":{cells},\"on\":{on}}}"),
        ])
    }

    /// Whether another way to measure refutes a bound.
    pub(crate) fn is_false(&self) -> bool {
        let rod: Vec<V> = self.frame.rod.iter().map(|p| posed(&self.start, *p)).collect();
        let parts = self.frame.parts.iter();
        let (mut least, mut most) = (f64::INFINITY, f64::INFINITY);
        for part in parts {
            let part: Vec<V> = part
                .iter()
                .map(|k| posed(&self.frame.at, self.frame.points[*k]))
                .collect();
            let (far, n) = closest(&[rod.clone(), part.clone()]);
            let low = part.iter().map(|p| dot(n, *p)).fold(f64::INFINITY, f64::min);
            let high = rod.iter().map(|p| dot(n, *p)).fold(f64::NEG_INFINITY, f64::max);
            let near = if far > 0.0 { (low - high) / far } else { 0.0 };
            (least, most) = (least.min(near), most.min(far));
        }
        self.bounds[0] > most + 1e-9 || self.bounds[1] < least - 1e-9
    }

    /// Changes one thing; returns whether it must be refused.
    pub(crate) fn change(&mut self, rng: &mut Rng, way: usize) -> bool {
        let (count, cell) = (self.frame.parts.len(), rng.below(self.cells.len()));
        let is_exact = self.bounds[0] == self.bounds[1];
        match way {
            0 => {
                let part = &mut self.frame.parts[rng.below(count)];
                let corner = rng.below(part.len());
                part[corner] = rng.below(32);
                false
            }
            1 => {
                let k = 2 * rng.below(2);
                let cut = rng.below(self.cells[k].0.len());
                let old = std::mem::replace(&mut self.cells[k].0[cut][1], rng.below(count + 1));
                self.cells[k].0[cut][1] != old
            }
            2 => {
                self.cells.remove(cell);
                true
            }
            3 => {
                self.cells.insert(cell, self.cells[cell].clone());
                true
            }
            4 => {
                self.cells[cell].1 = scale(self.cells[cell].1, -1.0);
                true
            }
            5 => {
                self.bounds[0] = f64::from_bits(self.bounds[0].to_bits() + 1);
                is_exact
            }
            6 => {
                self.bounds[1] = f64::from_bits(self.bounds[1].to_bits() - 1);
                is_exact
            }
            7 => {
                let shift = rng.vector(0.2);
                self.frame.at[..3].copy_from_slice(&shift);
                false
            }
            8 => {
                self.on[1][0].0 = rng.below(32);
                false
            }
            _ => {
                let cut = rng.below(2);
                self.cells[0].0.remove(cut);
                true
            }
        }
    }
}

pub(crate) const GAP_CHANGES: [&str; 10] = [
    "a point of a part of a distance",
    "a cut of a distance moved",
    "a group of a distance left out",
    "a group of a distance twice",
    "a normal of a distance turned round",
    "a lower bound one unit more",
    "an upper bound one unit less",
    "the frame of a distance moved",
    "a point of an upper bound",
    "a cut of a distance left out",
];

pub(crate) const PART_CHANGES: [&str; 7] = [
    "a point of a part",
    "a cut moved",
    "a group left out",
    "a group twice",
    "an interval shifted",
    "the frame moved",
    "a rod that flies aside",
];
