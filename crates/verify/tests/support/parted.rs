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

pub(crate) const PART_CHANGES: [&str; 7] = [
    "a point of a part",
    "a cut moved",
    "a group left out",
    "a group twice",
    "an interval shifted",
    "the frame moved",
    "a rod that flies aside",
];
