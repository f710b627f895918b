//! Receipts made without the library: bodies of eight points, motions by `f64`, planes by search.
//! The generator proves nothing. What it writes is for the checker to judge, and what the checker
//! accepts is judged by [`Receipt::is_false`], which samples distances.
#![allow(dead_code, unreachable_pub)]

#[path = "../../../../lab/truth/src/rows.rs"]
pub(crate) mod rows;
#[path = "../../src/sha256.rs"]
mod sha256;

pub(crate) mod changes;
pub(crate) mod parted;
pub(crate) mod python;
pub(crate) mod ranged;
pub(crate) mod scenes;

use std::fmt::Write;

pub(crate) type V = [f64; 3];
/// x, y, z, then the quaternion x, y, z, w.
pub(crate) type Pose = [f64; 7];
pub(crate) const REST: Pose = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ x >> 31
    }
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    pub(crate) fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
    pub(crate) fn vector(&mut self, size: f64) -> V {
        std::array::from_fn(|_| self.range(-size, size))
    }
    pub(crate) fn pose(&mut self, size: f64) -> Pose {
        let (p, q) = (
            self.vector(size),
            std::array::from_fn::<f64, 4, _>(|_| self.range(-1.0, 1.0)),
        );
        let n = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        if n < 0.1 {
            self.pose(size)
        } else {
            [p[0], p[1], p[2], q[0] / n, q[1] / n, q[2] / n, q[3] / n]
        }
    }
}

pub(crate) fn add(a: V, b: V) -> V {
    std::array::from_fn(|k| a[k] + b[k])
}
pub(crate) fn sub(a: V, b: V) -> V {
    std::array::from_fn(|k| a[k] - b[k])
}
pub(crate) fn scale(a: V, s: f64) -> V {
    a.map(|x| x * s)
}
pub(crate) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
pub(crate) fn cross(a: V, b: V) -> V {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
/// exp([w]) x.
pub(crate) fn turned(w: V, x: V) -> V {
    let (a, once) = (dot(w, w).sqrt(), cross(w, x));
    if a == 0.0 {
        return x;
    }
    let twice = cross(w, once);
    add(
        x,
        add(scale(once, a.sin() / a), scale(twice, (1.0 - a.cos()) / (a * a))),
    )
}
pub(crate) fn posed(p: &Pose, x: V) -> V {
    let (q, w) = ([p[3], p[4], p[5]], p[6]);
    let n = dot(q, q) + w * w;
    let t = scale(cross(q, x), 2.0 / n);
    add([p[0], p[1], p[2]], add(x, add(scale(t, w), cross(q, t))))
}

/// The one written form of a number.
pub(crate) fn hex(x: f64) -> String {
    let bits = x.to_bits();
    let sign = if x < 0.0 { "-" } else { "" };
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
    let digits = format!("{fraction:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    match (exponent, fraction) {
        (0, 0) => "\"0x0p0\"".into(),
        (0, _) => format!("\"{sign}0x0{point}{digits}p-1022\""),
        _ => format!("\"{sign}0x1{point}{digits}p{}\"", exponent - 1023),
    }
}
pub(crate) fn hexes(all: &[f64]) -> String {
    format!("[{}]", all.iter().map(|x| hex(*x)).collect::<Vec<_>>().join(","))
}
fn rows(all: impl Iterator<Item = String>) -> String {
    format!("[{}]", all.collect::<Vec<_>>().join(","))
}

#[derive(Clone, Debug)]
pub(crate) enum Move {
    Rest(Pose),
    Link(usize, Option<Pose>),
    /// Pose, pivot, linear, angular, push.
    Steady(Pose, [V; 4]),
}

#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) points: Vec<V>,
    pub(crate) radius: f64,
    pub(crate) motion: Move,
}

#[derive(Clone, Debug)]
pub(crate) struct Joint {
    pub(crate) parent: usize,
    pub(crate) kind: &'static str,
    pub(crate) origin: Pose,
    pub(crate) axis: V,
    pub(crate) drive: (usize, f64, f64),
}

impl Joint {
    pub(crate) fn new(parent: usize, kind: &'static str, origin: Pose, axis: V, drive: (usize, f64, f64)) -> Self {
        Self {
            parent,
            kind,
            origin,
            axis,
            drive,
        }
    }
}

pub(crate) type Weights = Vec<(usize, f64)>;

#[derive(Clone, Debug)]
pub(crate) enum Line {
    Leg(Vec<Vec<f64>>),
    Plane {
        pair: [usize; 2],
        normal: V,
        spin: Option<V>,
        time: [f64; 2],
        keep: f64,
    },
    Balls {
        a: usize,
        others: Vec<usize>,
        time: [f64; 2],
        keep: f64,
    },
    Meet {
        pair: [usize; 2],
        at: Option<f64>,
        points: [[usize; 2]; 4],
    },
    Near {
        pair: [usize; 2],
        at: Option<f64>,
        within: f64,
        on: [Weights; 2],
    },
    Features {
        pair: [usize; 2],
        bounds: [f64; 2],
        on: [Vec<usize>; 2],
    },
    Normal {
        pair: [usize; 2],
        bounds: [f64; 2],
        normal: V,
        on: [Weights; 2],
    },
}

impl Line {
    /// A plane that does not turn.
    pub(crate) fn plane(pair: [usize; 2], normal: V, time: [f64; 2], keep: f64) -> Self {
        Self::Plane {
            pair,
            normal,
            spin: None,
            time,
            keep,
        }
    }

    /// A point that the first two bodies have in common.
    pub(crate) fn meet(at: Option<f64>, points: [[usize; 2]; 4]) -> Self {
        let pair = [0, 1];
        Self::Meet { pair, at, points }
    }
}

/// What a receipt holds, to be changed before it is written.
#[derive(Clone, Debug)]
pub(crate) struct Receipt {
    /// From, until and margin of the claim "apart".
    pub(crate) apart: Option<[f64; 3]>,
    pub(crate) base: Option<Pose>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) ignored: Vec<(usize, Vec<usize>, &'static str)>,
    pub(crate) evidence: Vec<Line>,
}

fn on(weights: &[Weights; 2]) -> String {
    rows(
        weights
            .iter()
            .map(|w| rows(w.iter().map(|(k, x)| format!("[{k},{}]", hex(*x))))),
    )
}

/// Adds the tail.
pub(crate) fn sealed(lines: &[String]) -> String {
    let mut text: String = lines.iter().map(|line| line.clone() + "\n").collect();
    let mut sum = sha256::Sha256::new();
    sum.add(text.as_bytes());
    let (count, hash) = (lines.len(), sum.text());
    writeln!(text, "{{\"end\":{count},\"sha256\":\"{hash}\"}}").unwrap();
    text
}

impl Receipt {
    pub(crate) fn new(apart: Option<[f64; 3]>, bodies: Vec<Body>) -> Self {
        Self {
            apart,
            base: None,
            joints: Vec::new(),
            bodies,
            ignored: Vec::new(),
            evidence: Vec::new(),
        }
    }

    pub(crate) fn lines(&self) -> Vec<String> {
        let mut all = vec![match self.apart {
            Some([from, until, margin]) => {
                let [from, until, margin] = [from, until, margin].map(hex);
                format!("{{\"receipt\":1,\"claim\":\"apart\",\"from\":{from},\"until\":{until},\"margin\":{margin}}}")
            }
            None => "{\"receipt\":1,\"claim\":\"lines\"}".into(),
        }];
        all.extend(self.base.map(|base| format!("{{\"base\":{}}}", hexes(&base))));
        for (k, j) in self.joints.iter().enumerate() {
            let (k, parent, kind, origin) = (k + 1, j.parent, j.kind, hexes(&j.origin));
            let mut text = format!("{{\"joint\":{k},\"parent\":{parent},\"kind\":\"{kind}\",\"origin\":{origin}");
            if kind != "fixed" {
                let (c, f, o) = j.drive;
                write!(
                    text,
                    ",\"axis\":{},\"drive\":[{c},{},{}]",
                    hexes(&j.axis),
                    hex(f),
                    hex(o)
                )
                .unwrap();
            }
            all.push(text + "}");
        }
        for (k, b) in self.bodies.iter().enumerate() {
            let points = rows(b.points.iter().map(|p| hexes(p)));
            let mut text = format!("{{\"body\":{k},\"name\":\"part {k}\",\"points\":{points}");
            if b.radius != 0.0 {
                write!(text, ",\"radius\":{}", hex(b.radius)).unwrap();
            }
            match &b.motion {
                Move::Rest(pose) => write!(text, ",\"at\":{}", hexes(pose)),
                Move::Link(link, None) => write!(text, ",\"link\":{link}"),
                Move::Link(link, Some(pose)) => write!(text, ",\"link\":{link},\"at\":{}", hexes(pose)),
                Move::Steady(pose, v) => {
                    let [pivot, linear, angular, push] = v.map(|v| hexes(&v));
                    let pose = hexes(pose);
                    write!(
                        text,
                        ",\"at\":{pose},\"steady\":{{\"pivot\":{pivot},\"linear\":{linear},\"angular\":{angular},\"push\":{push}}}"
                    )
                }
            }
            .unwrap();
            all.push(text + "}");
        }
        for (a, others, why) in &self.ignored {
            all.push(format!(
                "{{\"ignored\":[{a},{}],\"why\":\"{why}\"}}",
                rows(others.iter().map(usize::to_string))
            ));
        }
        all.extend(self.evidence.iter().map(|line| self.line(line)));
        all
    }

    fn line(&self, line: &Line) -> String {
        let [begin, end, margin] = self.apart.unwrap_or_default();
        let times = |[from, until]: [f64; 2], keep: f64| {
            let mut text = String::new();
            for (key, value, usual) in [("from", from, begin), ("until", until, end), ("keep", keep, margin)] {
                if value != usual {
                    write!(text, ",\"{key}\":{}", hex(value)).unwrap();
                }
            }
            text
        };
        let at = |time: &Option<f64>| time.map_or(String::new(), |t| format!(",\"at\":{}", hex(t)));
        let pairs = |all: &[[usize; 2]]| rows(all.iter().map(|[i, j]| format!("[{i},{j}]")));
        match line {
            Line::Leg(all) => format!("{{\"leg\":{}}}", rows(all.iter().map(|row| hexes(row)))),
            Line::Plane {
                pair: [a, b],
                normal,
                spin,
                time,
                keep,
            } => {
                let spin = spin.map_or(String::new(), |x| format!(",\"spin\":{}", hexes(&x)));
                format!(
                    "{{\"plane\":[{a},{b}],\"normal\":{}{spin}{}}}",
                    hexes(normal),
                    times(*time, *keep)
                )
            }
            Line::Balls { a, others, time, keep } => {
                let others = rows(others.iter().map(usize::to_string));
                format!("{{\"balls\":[{a},{others}]{}}}", times(*time, *keep))
            }
            Line::Meet {
                pair: [a, b],
                at: time,
                points,
            } => {
                format!("{{\"meet\":[{a},{b}]{},\"points\":{}}}", at(time), pairs(points))
            }
            Line::Near {
                pair: [a, b],
                at: time,
                within,
                on: weights,
            } => {
                format!(
                    "{{\"near\":[{a},{b}]{},\"within\":{},\"on\":{}}}",
                    at(time),
                    hex(*within),
                    on(weights)
                )
            }
            Line::Features {
                pair: [a, b],
                bounds: [lower, upper],
                on,
            } => {
                let on = rows(on.iter().map(|all| rows(all.iter().map(usize::to_string))));
                let [lower, upper] = [lower, upper].map(|x| hex(*x));
                format!("{{\"distance\":[{a},{b}],\"lower\":{lower},\"upper\":{upper},\"on\":{on}}}")
            }
            Line::Normal {
                pair: [a, b],
                bounds,
                normal,
                on: weights,
            } => {
                let ([lower, upper], normal, on) = (bounds.map(hex), hexes(normal), on(weights));
                format!(
                    "{{\"distance\":[{a},{b}],\"lower\":{lower},\"upper\":{upper},\"normal\":{normal},\"on\":{on}}}"
                )
            }
        }
    }

    pub(crate) fn text(&self) -> String {
        sealed(&self.lines())
    }

    fn value(&self, joint: &Joint, leg: &[Vec<f64>], t: f64) -> f64 {
        let (c, factor, offset) = joint.drive;
        let mut row: Vec<f64> = leg.iter().map(|q| q[c]).collect();
        while row.len() > 1 {
            row = row.windows(2).map(|w| w[0] + (w[1] - w[0]) * t).collect();
        }
        factor * row[0] + offset
    }

    /// Places a point of a body at a time of a leg.
    pub(crate) fn place(&self, body: usize, leg: Option<&[Vec<f64>]>, t: f64, x: V) -> V {
        match &self.bodies[body].motion {
            Move::Rest(pose) => posed(pose, x),
            Move::Steady(pose, [pivot, linear, angular, push]) => {
                let (arm, centre) = (sub(posed(pose, x), posed(pose, *pivot)), posed(pose, *pivot));
                let way = add(scale(*linear, t), scale(*push, t * t / 2.0));
                add(add(centre, way), turned(scale(*angular, t), arm))
            }
            Move::Link(link, pose) => {
                let (mut x, mut link) = (pose.map_or(x, |pose| posed(&pose, x)), *link);
                while link > 0 {
                    let joint = &self.joints[link - 1];
                    x = match joint.kind {
                        "turn" => turned(scale(joint.axis, self.value(joint, leg.unwrap(), t)), x),
                        "slide" => add(x, scale(joint.axis, self.value(joint, leg.unwrap(), t))),
                        _ => x,
                    };
                    x = posed(&joint.origin, x);
                    link = joint.parent;
                }
                self.base.map_or(x, |base| posed(&base, x))
            }
        }
    }

    pub(crate) fn placed(&self, body: usize, leg: Option<&[Vec<f64>]>, t: f64) -> Vec<V> {
        self.bodies[body]
            .points
            .iter()
            .map(|x| self.place(body, leg, t, *x))
            .collect()
    }

    pub(crate) fn moves(&self, body: usize) -> bool {
        match &self.bodies[body].motion {
            Move::Rest(_) => false,
            Move::Steady(..) => true,
            Move::Link(link, _) => {
                let mut link = *link;
                while link > 0 && self.joints[link - 1].kind == "fixed" {
                    link = self.joints[link - 1].parent;
                }
                link > 0
            }
        }
    }

    /// Adds certificates that a pair stays apart, found by halving; false if there are none.
    pub(crate) fn prove(&mut self, pair: [usize; 2], leg: Option<&[Vec<f64>]>, time: [f64; 2], depth: usize) -> bool {
        let [from, until] = time;
        let keep = self.apart.unwrap()[2];
        let [a, b] = pair;
        let radii = self.bodies[a].radius + self.bodies[b].radius;
        let samples: Vec<f64> = (0..9).map(|k| from + (until - from) * f64::from(k) / 8.0).collect();
        let pivot = |k: usize| {
            if let Move::Steady(_, v) = &self.bodies[k].motion {
                v[0]
            } else {
                [0.0; 3]
            }
        };
        let reach = |k: usize| {
            let far = |p: &V| dot(sub(*p, pivot(k)), sub(*p, pivot(k))).sqrt();
            self.bodies[k].points.iter().map(far).fold(0.0, f64::max)
        };
        let way = |t: f64| sub(self.place(b, leg, t, pivot(b)), self.place(a, leg, t, pivot(a)));
        let least = samples
            .iter()
            .map(|t| dot(way(*t), way(*t)).sqrt())
            .fold(f64::INFINITY, f64::min);
        let middle = 0.5 * (from + until);
        let wide = 0.02 + 0.5 * (until - from);
        if least > reach(a) + reach(b) + radii + keep + wide {
            self.evidence.push(Line::Balls {
                a,
                others: vec![b],
                time,
                keep,
            });
            return true;
        }
        let at = |t: f64| [self.placed(a, leg, t), self.placed(b, leg, t)];
        let gap = |n: V, [a, b]: &[Vec<V>; 2]| {
            let high = a.iter().map(|p| dot(n, *p)).fold(f64::NEG_INFINITY, f64::max);
            b.iter().map(|p| dot(n, *p)).fold(f64::INFINITY, f64::min) - high
        };
        let (_, n) = closest(&at(middle));
        let size = dot(n, n).sqrt();
        if size > 1e-6 {
            let n = scale(n, 1.0 / size);
            let gaps = samples.iter().map(|t| gap(n, &at(*t))).fold(f64::INFINITY, f64::min);
            if gaps > keep + radii + 0.002 + 0.02 * (until - from) {
                self.evidence.push(Line::plane(pair, n, time, keep));
                return true;
            }
        }
        depth > 0
            && self.prove(pair, leg, [from, middle], depth - 1)
            && self.prove(pair, leg, [middle, until], depth - 1)
    }

    /// All numbers that can be changed, each with the name of what it belongs to.
    pub(crate) fn numbers(&mut self) -> Vec<(&'static str, &mut f64)> {
        let mut all: Vec<(&'static str, &mut f64)> = Vec::new();
        all.extend(self.apart.iter_mut().flatten().map(|x| ("head", x)));
        all.extend(self.base.iter_mut().flatten().map(|x| ("scene", x)));
        for j in self.joints.iter_mut().filter(|j| j.kind != "fixed") {
            all.extend(j.origin.iter_mut().chain(&mut j.axis).map(|x| ("scene", x)));
            all.extend([("scene", &mut j.drive.1), ("scene", &mut j.drive.2)]);
        }
        for b in &mut self.bodies {
            all.extend(b.points.iter_mut().flatten().map(|x| ("scene", x)));
            match &mut b.motion {
                Move::Rest(pose) | Move::Link(_, Some(pose)) => all.extend(pose.iter_mut().map(|x| ("scene", x))),
                Move::Link(_, None) => {}
                Move::Steady(pose, v) => {
                    all.extend(pose.iter_mut().chain(v.iter_mut().flatten()).map(|x| ("scene", x)))
                }
            }
        }
        for line in &mut self.evidence {
            match line {
                Line::Leg(all_rows) => all.extend(all_rows.iter_mut().flatten().map(|x| ("scene", x))),
                Line::Plane {
                    normal,
                    spin,
                    time,
                    keep,
                    ..
                } => {
                    let numbers = normal
                        .iter_mut()
                        .chain(spin.iter_mut().flatten())
                        .chain(time)
                        .chain([keep]);
                    all.extend(numbers.map(|x| ("certificate", x)));
                }
                Line::Balls { time, keep, .. } => all.extend(time.iter_mut().chain([keep]).map(|x| ("certificate", x))),
                Line::Meet { at, .. } => all.extend(at.iter_mut().map(|x| ("certificate", x))),
                Line::Near { at, within, on, .. } => {
                    let numbers = at
                        .iter_mut()
                        .chain([within])
                        .chain(on.iter_mut().flatten().map(|x| &mut x.1));
                    all.extend(numbers.map(|x| ("certificate", x)));
                }
                Line::Features { bounds, .. } => all.extend(bounds.iter_mut().map(|x| ("certificate", x))),
                Line::Normal { bounds, normal, on, .. } => {
                    let weights = on.iter_mut().flatten().map(|x| &mut x.1);
                    all.extend(
                        bounds
                            .iter_mut()
                            .chain(normal)
                            .chain(weights)
                            .map(|x| ("certificate", x)),
                    );
                }
            }
        }
        all
    }

    /// Whether sampling refutes what the receipt claims, by more than rounding.
    pub(crate) fn is_false(&self) -> bool {
        let mut leg: Option<&[Vec<f64>]> = None;
        let legs: Vec<_> = self
            .evidence
            .iter()
            .filter_map(|x| if let Line::Leg(rows) = x { Some(&rows[..]) } else { None })
            .collect();
        if let Some([from, until, margin]) = self.apart {
            let ignored = |a, b| {
                self.ignored
                    .iter()
                    .any(|(x, others, _)| *x == a && others.contains(&b) || *x == b && others.contains(&a))
            };
            let times: Vec<f64> = (0..33).map(|k| from + (until - from) * f64::from(k) / 32.0).collect();
            let each: Vec<Option<&[Vec<f64>]>> = if legs.is_empty() {
                vec![None]
            } else {
                legs.iter().map(|x| Some(*x)).collect()
            };
            for a in 0..self.bodies.len() {
                for b in a + 1..self.bodies.len() {
                    if ignored(a, b) || !self.moves(a) && !self.moves(b) {
                        continue;
                    }
                    let radii = self.bodies[a].radius + self.bodies[b].radius;
                    for (leg, t) in each.iter().flat_map(|leg| times.iter().map(move |t| (leg, *t))) {
                        let (d, _) = closest(&[self.placed(a, *leg, t), self.placed(b, *leg, t)]);
                        if d - radii < margin - 1e-9 - 1e-3 * margin {
                            return true;
                        }
                    }
                }
            }
        }
        for line in &self.evidence {
            let (pair, at, bounds) = match line {
                Line::Leg(rows) => {
                    leg = Some(rows);
                    continue;
                }
                Line::Meet { pair, at, .. } => (*pair, *at, [f64::NEG_INFINITY, 0.0]),
                Line::Near { pair, at, within, .. } => (*pair, *at, [f64::NEG_INFINITY, *within]),
                Line::Features { pair, bounds, .. } | Line::Normal { pair, bounds, .. } => (*pair, None, *bounds),
                _ => continue,
            };
            let [a, b] = pair;
            let placed = [
                self.placed(a, leg, at.unwrap_or(0.0)),
                self.placed(b, leg, at.unwrap_or(0.0)),
            ];
            let radii = if matches!(line, Line::Meet { .. }) {
                0.0
            } else {
                self.bodies[a].radius + self.bodies[b].radius
            };
            let (upper, n) = closest(&placed);
            let size = dot(n, n).sqrt();
            let low = placed[1].iter().map(|p| dot(n, *p)).fold(f64::INFINITY, f64::min);
            let high = placed[0].iter().map(|p| dot(n, *p)).fold(f64::NEG_INFINITY, f64::max);
            let lower = if size > 0.0 { (low - high) / size } else { 0.0 };
            if bounds[0] > upper - radii + 1e-6 || bounds[1] < lower - radii - 1e-9 {
                return true;
            }
        }
        false
    }
}

/// An upper bound of the distance of two hulls, and the way that it is found along (Gilbert 1966).
pub(crate) fn closest([a, b]: &[Vec<V>; 2]) -> (f64, V) {
    let mut v = sub(b[0], a[0]);
    for _ in 0..300 {
        let lowest = *b.iter().min_by(|x, y| dot(v, **x).total_cmp(&dot(v, **y))).unwrap();
        let highest = *a.iter().max_by(|x, y| dot(v, **x).total_cmp(&dot(v, **y))).unwrap();
        let way = sub(sub(lowest, highest), v);
        let square = dot(way, way);
        if !(square > 0.0) || -dot(v, way) <= 1e-12 * dot(v, v) {
            break;
        }
        v = add(v, scale(way, (-dot(v, way) / square).clamp(0.0, 1.0)));
    }
    (dot(v, v).sqrt(), v)
}

pub(crate) fn cuboid(h: V) -> Vec<V> {
    (0..8)
        .map(|k| std::array::from_fn(|i| if k >> i & 1 == 1 { h[i] } else { -h[i] }))
        .collect()
}

pub(crate) fn random_box(rng: &mut Rng) -> Vec<V> {
    cuboid(std::array::from_fn(|_| rng.range(0.1, 0.5)))
}

pub(crate) fn body(points: Vec<V>, motion: Move) -> Body {
    Body {
        points,
        radius: 0.0,
        motion,
    }
}

/// Two boxes that pass each other.
pub(crate) fn cast(rng: &mut Rng, margin: f64) -> Receipt {
    loop {
        let mut side = |x: f64| {
            let mut pose = rng.pose(0.3);
            pose[0] += x;
            let linear = [-x, rng.range(-0.3, 0.3), rng.range(-0.3, 0.3)];
            let v = [rng.vector(0.2), linear, rng.vector(1.0), rng.vector(0.2)];
            body(random_box(rng), Move::Steady(pose, v))
        };
        let bodies = vec![side(-1.5), side(1.5)];
        let mut receipt = Receipt::new(Some([0.0, 1.0, margin]), bodies);
        let Move::Steady(pose, _) = &mut receipt.bodies[1].motion else {
            unreachable!()
        };
        pose[2] += 1.3;
        if receipt.prove([0, 1], None, [0.0, 1.0], 7) {
            return receipt;
        }
    }
}

/// An arm of three turns and a slide beside two boxes, along one or several legs.
pub(crate) fn arm(rng: &mut Rng, margin: f64, legs: usize, degree: usize) -> Receipt {
    loop {
        let joint = |parent, kind, z: f64, axis, c| {
            Joint::new(parent, kind, [0.0, 0.0, z, 0.0, 0.0, 0.0, 1.0], axis, (c, 1.0, 0.0))
        };
        let joints = vec![
            joint(0, "turn", 0.3, [0.0, 0.0, 1.0], 0),
            joint(1, "turn", 0.2, [0.0, 1.0, 0.0], 1),
            joint(2, "fixed", 0.6, [0.0; 3], 0),
            joint(3, "turn", 0.1, [0.0, 1.0, 0.0], 2),
            joint(4, "slide", 0.4, [0.0, 0.0, 1.0], 3),
        ];
        let limb = |rng: &mut Rng, z: f64| {
            let r = rng.range(0.03, 0.08);
            cuboid([r, r, z])
                .into_iter()
                .map(|p| add(p, [0.0, 0.0, z]))
                .collect::<Vec<_>>()
        };
        let mut bodies = vec![
            body(limb(rng, 0.1), Move::Link(0, None)),
            body(limb(rng, 0.28), Move::Link(2, None)),
            body(limb(rng, 0.18), Move::Link(4, None)),
            body(cuboid([0.05, 0.04, 0.06]), Move::Link(5, Some(rng.pose(0.02)))),
        ];
        for _ in 0..2 {
            let mut pose = rng.pose(0.2);
            pose[0] += if rng.below(2) == 0 { 0.9 } else { -0.9 };
            bodies.push(body(random_box(rng), Move::Rest(pose)));
        }
        bodies[4].radius = 0.0625;
        let mut receipt = Receipt::new(Some([0.0, 1.0, margin]), bodies);
        receipt.joints = joints;
        receipt.base = Some([0.0, 0.0, -0.25, 0.0, 0.0, 0.6, 0.8]);
        receipt.ignored = vec![
            (1, vec![0, 2], "neighbours"),
            (2, vec![3, 0], "neighbours"),
            (0, vec![3], "cannot meet"),
        ];
        let mut start: Vec<f64> = vec![
            rng.range(-1.5, 1.5),
            rng.range(-0.4, 0.4),
            rng.range(-1.0, 1.0),
            rng.range(0.0, 0.1),
        ];
        let mut truth = true;
        for _ in 0..legs {
            let mut rows = vec![start.clone()];
            for _ in 0..degree {
                rows.push(start.iter().map(|x| x + rng.range(-0.2, 0.2)).collect());
            }
            start = rows[degree].clone();
            receipt.evidence.push(Line::Leg(rows.clone()));
            for pair in [[1, 3], [0, 4], [0, 5], [1, 4], [1, 5], [2, 4], [2, 5], [3, 4], [3, 5]] {
                if pair[0] == 0 {
                    continue; // both rest: the base carries body 0
                }
                // Powers of a curve's angle are enclosed well over short intervals.
                let parts = if degree > 1 { 4 } else { 1 };
                for k in 0..parts {
                    let time = [k, k + 1].map(|k| f64::from(k) / f64::from(parts));
                    truth = truth && receipt.prove(pair, Some(&rows), time, 6);
                }
            }
        }
        if truth {
            return receipt;
        }
    }
}

/// A lever of a turn, a slide and a turn that follows the first, near a box, along one or two legs.
pub(crate) fn lever(rng: &mut Rng, margin: f64, legs: usize, degree: usize) -> Receipt {
    loop {
        let joint = |parent, kind, x: f64, axis, drive| {
            Joint::new(parent, kind, [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], axis, drive)
        };
        let joints = vec![
            joint(0, "turn", 0.1, [0.0, -0.6, 0.8], (0, 1.0, 0.0)),
            joint(1, "slide", 0.4, [1.0, 0.0, 0.0], (1, 1.0, 0.0)),
            joint(2, "turn", 0.1, [0.0, 0.0, 1.0], (0, -0.5, 0.2)),
        ];
        let rod = cuboid([0.2, rng.range(0.03, 0.08), 0.05]).into_iter();
        let rod = rod.map(|p| add(p, [0.2, 0.0, 0.0])).collect();
        let tip = cuboid([0.1, 0.04, rng.range(0.03, 0.08)]);
        let mut pose = rng.pose(0.1);
        pose[0] += 1.1;
        let mut bodies = vec![
            body(rod, Move::Link(1, None)),
            body(tip, Move::Link(3, Some(rng.pose(0.02)))),
            body(random_box(rng), Move::Rest(pose)),
        ];
        bodies[2].radius = 0.03125;
        let mut receipt = Receipt::new(Some([0.0, 1.0, margin]), bodies);
        receipt.joints = joints;
        receipt.base = Some([0.0, 0.0, -0.25, 0.0, 0.0, 0.6, 0.8]);
        receipt.ignored = vec![(0, vec![1], "neighbours")];
        let mut row = vec![rng.range(-2.5, -0.5), rng.range(0.0, 0.2)];
        let mut truth = true;
        for _ in 0..legs {
            let mut rows = vec![row.clone()];
            for _ in 0..degree {
                rows.push(row.iter().map(|x| x + rng.range(-0.2, 0.2)).collect());
            }
            row = rows[degree].clone();
            receipt.evidence.push(Line::Leg(rows.clone()));
            for pair in [[0, 2], [1, 2]] {
                truth = truth && receipt.prove(pair, Some(&rows), [0.0, 1.0], 6);
            }
        }
        if truth {
            return receipt;
        }
    }
}

/// Four pairs of vertices whose differences enclose 0, found by chance.
pub(crate) fn enclosing(rng: &mut Rng, a: &[V], b: &[V]) -> Option<[[usize; 2]; 4]> {
    for _ in 0..5000 {
        let pairs: [[usize; 2]; 4] = std::array::from_fn(|_| [rng.below(a.len()), rng.below(b.len())]);
        let d = pairs.map(|[i, j]| sub(a[i], b[j]));
        let volume = |i: usize, j: usize, k: usize| dot(d[i], cross(d[j], d[k]));
        let all = [volume(1, 2, 3), -volume(0, 2, 3), volume(0, 1, 3), -volume(0, 1, 2)];
        if all.iter().all(|x| *x > 1e-6) || all.iter().all(|x| *x < -1e-6) {
            return Some(pairs);
        }
    }
    None
}

/// Two boxes at rest that overlap.
pub(crate) fn overlap(rng: &mut Rng) -> Receipt {
    loop {
        let bodies = [0, 1].map(|_| body(random_box(rng), Move::Rest(rng.pose(0.2))));
        let mut receipt = Receipt::new(None, bodies.into());
        if let Some(points) = enclosing(rng, &receipt.placed(0, None, 0.0), &receipt.placed(1, None, 0.0)) {
            receipt.evidence.push(Line::meet(None, points));
            return receipt;
        }
    }
}

/// Two boxes at rest whose faces touch, without depth.
pub(crate) fn touching(rng: &mut Rng) -> Receipt {
    loop {
        let mut dyadic = |low: f64, high: f64| (rng.range(low, high) * 64.0).round() / 64.0;
        let [a, b]: [V; 2] = [0, 1].map(|_| std::array::from_fn(|_| dyadic(0.125, 0.5)));
        let at = [
            a[0] + b[0],
            dyadic(-0.125, 0.125),
            dyadic(-0.125, 0.125),
            0.0,
            0.0,
            0.0,
            1.0,
        ];
        let bodies = vec![body(cuboid(a), Move::Rest(REST)), body(cuboid(b), Move::Rest(at))];
        let mut receipt = Receipt::new(None, bodies);
        let placed = [0, 1].map(|k| receipt.placed(k, None, 0.0));
        // 0 is in a triangle of differences in the plane of the faces; the fourth is behind it.
        let found = (0..2000).find_map(|_| {
            let mut pairs: [[usize; 2]; 4] = std::array::from_fn(|_| [1 + 2 * rng.below(4), 2 * rng.below(4)]);
            pairs[3] = [2 * rng.below(4), 1 + 2 * rng.below(4)];
            let d = pairs.map(|[i, j]| sub(placed[0][i], placed[1][j]));
            let volume = |i: usize, j: usize, k: usize| dot(d[i], cross(d[j], d[k]));
            let all = [volume(1, 2, 3), -volume(0, 2, 3), volume(0, 1, 3)];
            (all.iter().all(|x| *x > 0.0) || all.iter().all(|x| *x < 0.0)).then_some(pairs)
        });
        if let Some(points) = found {
            receipt.evidence.push(Line::meet(None, points));
            return receipt;
        }
    }
}

/// A box and a vertex of another one above a triangle of its face: bounds by features and by a
/// normal.
pub(crate) fn above(rng: &mut Rng) -> Receipt {
    let h = rng.range(0.2, 0.5);
    let flat = body(cuboid([0.5, 0.5, h]), Move::Rest(REST));
    let (x, y, z) = (rng.range(0.05, 0.3), rng.range(-0.4, -0.35), h + rng.range(0.01, 0.3));
    let tip = body(
        vec![
            [x, y, z],
            [x + 0.2, y, z + 0.3],
            [x, y + 0.2, z + 0.4],
            [x - 0.1, y, z + 0.5],
        ],
        Move::Rest(REST),
    );
    let mut receipt = Receipt::new(None, vec![flat, tip]);
    let d = z - h;
    // The face z = h has the vertices 4 (--), 5 (+-), 6 (-+), 7 (++).
    receipt.evidence.push(Line::Features {
        pair: [0, 1],
        bounds: [d * (1.0 - 1e-15), d * (1.0 + 1e-15)],
        on: [vec![4, 5, 7], vec![0]],
    });
    let near = vec![(4, 0.5 - x), (5, x - y), (7, 0.5 + y)];
    let on = [near, vec![(0, 1.0)]];
    receipt.evidence.push(Line::Normal {
        pair: [0, 1],
        bounds: [d - 1e-12, d + 1e-12],
        normal: [0.0, 0.0, 0.5],
        on: on.clone(),
    });
    receipt.evidence.push(Line::Near {
        pair: [0, 1],
        at: None,
        within: d + 1e-12,
        on,
    });
    receipt
}

/// A cast up to a time, and a common point at a later one.
pub(crate) fn hit(rng: &mut Rng) -> Receipt {
    loop {
        let pose = rng.pose(0.1);
        let still = body(random_box(rng), Move::Rest(pose));
        let mut start = rng.pose(0.1);
        start[0] -= 2.0;
        let v = [[0.0; 3], [2.0, 0.0, 0.0], rng.vector(0.5), [0.0; 3]];
        let bodies = vec![body(random_box(rng), Move::Steady(start, v)), still];
        let mut receipt = Receipt::new(Some([0.0, 0.25, 0.0]), bodies);
        let found = enclosing(rng, &receipt.placed(0, None, 1.0), &receipt.placed(1, None, 1.0));
        if let Some(points) = found
            && receipt.prove([0, 1], None, [0.0, 0.25], 6)
        {
            receipt.evidence.push(Line::meet(Some(1.0), points));
            return receipt;
        }
    }
}
