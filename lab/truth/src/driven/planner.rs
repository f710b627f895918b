//! Worlds of the planner that change, and segments, curves and ranges through them.
//!
//! The judge measures every pair with a new tracker, at poses from a new checker: at single
//! configurations, at times along segments and curves, and at random configurations of ranges. A
//! checker must give the answers of a new checker of the same world, bit for bit.
//!
//! The test `driven` and the instrument `soak` share this module.

use crate::casts::rotation;
use crate::plans::blocked;
use crate::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Point3, Unit, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Cloud, CloudElement, Compound, Geometry, HalfSpace, Mesh, PairTracker, Piece, RelativePose, Shape};
use lin_canny_plan::{
    Cell, CellBody, CellPair, Checker, ConfigurationSpace, Drive, JointCurve, JointKind, JointMotion, JointTree,
    PlanError, RangeAnswer, RangeOptions, RangeProver, RangeVerdict, TimedPoses, TreeJoint, Verdict,
};

/// Bounds within this of what a pair must keep leave the judge undecided. Bodies have a size of
/// about 1.
const TIE: f64 = 1e-9;

/// Rounds of a world: each a change and all questions.
const ROUNDS: usize = 4;

/// Configurations of a round: a pair that is lost is often not the only one in contact.
const CONFIGURATIONS: usize = 8;

/// Times at which a motion is judged.
const TIMES: u32 = 24;

/// First and last time of a moving obstacle.
const CLOCK: [f64; 2] = [-1.0, 3.0];

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Worlds, and those with a moving obstacle.
        pub worlds: [u64; 2],
        /// Changes made and changes rejected.
        pub changes: [u64; 2],
        /// Configurations that are free and that are not.
        pub configurations: [u64; 2],
        /// Segments that are free, blocked, undecided.
        pub segments: [u64; 3],
        /// Curves that are free, blocked, undecided.
        pub curves: [u64; 3],
        /// Ranges of pairs that never, always or both meet, or are open.
        pub ranges: [u64; 4],
    }
}

/// Plays a world.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    Play::new(seed)?.rounds()
}

fn told(error: PlanError) -> String {
    error.to_string()
}

fn vector(rng: &mut Rng, most: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.range(-most, most))
}

fn pose(rng: &mut Rng, far: f64) -> Isometry3<f64> {
    Isometry3::from_parts(vector(rng, far).into(), rotation(rng))
}

/// Returns a body of any kind with a size of about `size`.
fn geometry(rng: &mut Rng, size: f64) -> Geometry {
    let half = Vector3::from_fn(|_, _| size * rng.range(0.2, 1.0));
    let hull = solids::random_hull(16, half, rng.bits()).expect("a hull");
    match rng.below(9) {
        0 => Shape::ball(half.x).expect("a ball").into(),
        1 => Shape::cylinder(half.x, half.y).expect("a cylinder").into(),
        2 => Shape::from(hull).rounded(0.1 * half.z).expect("a shape").into(),
        3 => Mesh::from_convex(&hull).expect("a mesh").into(),
        4 => {
            let mut second = Piece::new(Shape::ball(half.x).expect("a ball"));
            second.pose = pose(rng, size);
            Compound::new(vec![Piece::new(hull), second])
                .expect("a compound")
                .into()
        }
        5 => {
            let points: Vec<Point3<f64>> = (0..20).map(|_| Point3::from(vector(rng, size))).collect();
            Cloud::new(&points, CloudElement::Ball(0.1 * size))
                .expect("a cloud")
                .into()
        }
        _ => hull.into(),
    }
}

/// A bound of the distance of a pair, less what it must keep.
#[derive(Clone, Copy, Debug)]
struct Excess {
    lower: f64,
    upper: f64,
    pair: CellPair,
}

struct Play {
    rng: Rng,
    space: JointTree,
    checker: Checker<JointTree>,
    mix: Mix,
}

/// Returns a chain of two to four joints in any directions, each with a link, and maybe a body on the base.
fn chain(rng: &mut Rng) -> (JointTree, Cell) {
    let count = 2 + rng.below(3);
    let (mut cell, mut links) = (Cell::new(), Vec::new());
    // Its pairs with obstacles are at rest.
    if rng.chance(0.2) {
        cell.robot_body("base", geometry(rng, 0.15));
        links.push(0);
    }
    let mut joints = Vec::new();
    for k in 0..count {
        let is_slide = rng.chance(0.25);
        joints.push(TreeJoint {
            parent: k,
            kind: if is_slide {
                JointKind::Prismatic
            } else {
                JointKind::Revolute
            },
            origin: Isometry3::from_parts((Vector3::x() * 0.5 + vector(rng, 0.2)).into(), rotation(rng)),
            axis: Unit::new_normalize(Vector3::from(rng.unit())),
            drive: Some(Drive {
                coordinate: k,
                factor: if is_slide { 0.2 } else { 1.0 },
                offset: 0.0,
            }),
        });
        cell.robot_body(format!("link {k}"), geometry(rng, 0.25));
    }
    for k in 1..count {
        cell.exclude(&format!("link {}", k - 1)[..], &format!("link {k}")[..])
            .expect("names");
    }
    let (limits, radii) = (vec![[-3.0, 3.0]; count], vec![0.5; count + 1]);
    links.extend(1..=count);
    let space = JointTree::new(Isometry3::identity(), joints, limits, links, radii).expect("a chain");
    (space, cell)
}

impl Play {
    fn new(seed: u64) -> Result<Self, String> {
        let mut rng = Rng::new(seed);
        let (space, mut cell) = chain(&mut rng);
        for k in 0..1 + rng.below(3) {
            cell.add_obstacle(format!("thing {k}"), geometry(&mut rng, 0.4), pose(&mut rng, 1.2))
                .expect("an obstacle");
        }
        if rng.chance(0.3) {
            let floor = HalfSpace::new(Vector3::from(rng.unit()), -1.0).map_err(|e| e.to_string())?;
            cell.add_obstacle("floor", floor, Isometry3::identity())
                .expect("an obstacle");
        }
        let mut mix = Mix::default();
        mix.worlds[0] = 1;
        if rng.chance(0.3) {
            let times = [CLOCK[0], rng.range(0.0, 0.4), rng.range(0.5, 1.0), CLOCK[1]];
            let rows = times.map(|_| pose(&mut rng, 1.2));
            let poses = TimedPoses::new(&times, &rows).map_err(told)?;
            cell.add_moving_obstacle("cart", geometry(&mut rng, 0.3), poses)
                .expect("an obstacle");
            mix.worlds[1] = 1;
        }
        let mut checker = Checker::new(space.clone(), cell).map_err(told)?;
        checker.set_time(0.0).map_err(told)?;
        Ok(Self {
            rng,
            space,
            checker,
            mix,
        })
    }

    /// Returns a new checker of the world as it is now.
    fn fresh(&self, time: f64) -> Result<Checker<JointTree>, String> {
        let mut fresh = Checker::new(self.space.clone(), self.checker.cell().clone()).map_err(told)?;
        fresh.set_time(time).map_err(told)?;
        Ok(fresh)
    }

    fn sample(&mut self) -> Vec<f64> {
        let rng = &mut self.rng;
        self.space.sample(&mut || rng.uniform())
    }

    /// Returns a configuration near another.
    fn near(&mut self, q: &[f64], far: f64) -> Vec<f64> {
        q.iter()
            .map(|x| (x + self.rng.range(-far, far)).clamp(-3.0, 3.0))
            .collect()
    }

    fn rounds(mut self) -> Result<Mix, String> {
        for _ in 0..ROUNDS {
            self.change()?;
            for _ in 0..CONFIGURATIONS {
                let q = self.sample();
                self.configuration(&q)?;
            }
            let q = self.sample();
            let far = if self.rng.chance(0.5) { 0.3 } else { 2.0 };
            let p = self.near(&q, far);
            self.segment(&q, &p)?;
            self.curve(&q, far)?;
            self.range(&q)?;
            self.afresh(&q, &p)?;
        }
        Ok(self.mix)
    }

    fn change(&mut self) -> Result<(), String> {
        let rng = &mut self.rng;
        let all: Vec<CellBody> = self.checker.cell().bodies().map(|b| b.0).collect();
        let (id, link) = (*rng.pick(&all), format!("link {}", rng.below(2)));
        let name = format!("thing {}", rng.below(6));
        let checker = &mut self.checker;
        let is_done = match rng.below(9) {
            0 | 1 => checker
                .cell_mut()
                .add_obstacle(&name, geometry(rng, 0.4), pose(rng, 1.2))
                .is_ok(),
            2 | 3 => checker.cell_mut().move_obstacle(&name[..], pose(rng, 1.2)).is_ok(),
            4 => checker
                .cell_mut()
                .replace_obstacle(&name[..], geometry(rng, 0.4))
                .is_ok(),
            5 => checker.cell_mut().remove_obstacle(&name[..]).is_ok(),
            6 => checker
                .cell_mut()
                .attach(&link, &name, geometry(rng, 0.15), pose(rng, 0.3), &[])
                .is_ok(),
            7 => checker.cell_mut().detach(&name[..]).is_ok(),
            _ => checker.cell_mut().pad(id, *rng.pick(&[0.0, 0.01, 0.1])).is_ok(),
        };
        self.mix.changes[usize::from(!is_done)] += 1;
        Ok(())
    }

    /// Returns the pairs that are measured: not those that keep their pose relative to each other.
    fn pairs(&self) -> Vec<CellPair> {
        let cell = self.checker.cell();
        let carrier = |id: CellBody| match id {
            CellBody::Attached(_) => {
                let held = cell.attached().find(|held| held.0 == id);
                held.map(|held| held.1.link.clone()).unwrap_or_default()
            }
            _ => cell.name(id).to_owned(),
        };
        let excluded: Vec<[CellBody; 2]> = cell.excluded().collect();
        let all: Vec<CellBody> = cell.bodies().map(|b| b.0).collect();
        let mut found = Vec::new();
        for (k, x) in all.iter().enumerate() {
            for y in &all[k + 1..] {
                let Some(pair) = CellPair::new(*x, *y) else { continue };
                let is_rigid = !matches!(pair.b, CellBody::Obstacle(_)) && carrier(pair.a) == carrier(pair.b);
                let is_excluded = excluded.contains(&[pair.a, pair.b]) || excluded.contains(&[pair.b, pair.a]);
                if !is_rigid && !is_excluded {
                    found.push(pair);
                }
            }
        }
        found
    }

    /// Measures a pair at a configuration, at the poses of a checker.
    fn excess(&self, judge: &Checker<JointTree>, pair: CellPair, q: &[f64]) -> Result<Excess, String> {
        let cell = self.checker.cell();
        let shape = |id| cell.geometry(id).ok_or_else(|| format!("{id:?} has no geometry"));
        let x = judge.pose(pair.a, q).map_err(told)?;
        let y = judge.pose(pair.b, q).map_err(told)?;
        let pose = RelativePose::new(&x, &y).map_err(|e| e.to_string())?;
        let found = PairTracker::new().closest(shape(pair.a)?, shape(pair.b)?, &pose);
        let kept = cell.required_distance(pair).distance;
        Ok(Excess {
            lower: found.lower - kept,
            upper: found.upper - kept,
            pair,
        })
    }

    fn excesses(&self, time: f64, q: &[f64]) -> Result<Vec<Excess>, String> {
        let judge = self.fresh(time)?;
        self.pairs()
            .into_iter()
            .map(|pair| self.excess(&judge, pair, q))
            .collect()
    }

    fn configuration(&mut self, q: &[f64]) -> Result<(), String> {
        let all = self.excesses(0.0, q)?;
        let is_free = self.checker.is_free_at(q).map_err(told)?;
        let hit = all.iter().find(|e| e.upper < -TIE);
        if is_free && hit.is_some() {
            return Err(format!("free at {q:?}: {hit:?}"));
        }
        if !is_free && all.iter().all(|e| e.lower > TIE) {
            return Err(format!("not free at {q:?}: {all:?}"));
        }
        self.mix.configurations[usize::from(!is_free)] += 1;
        // Margins and paddings do not change the distance.
        let kept = |pair| self.checker.cell().required_distance(pair).distance;
        let apart: Vec<[f64; 2]> = all
            .iter()
            .map(|e| [e.lower + kept(e.pair), e.upper + kept(e.pair)])
            .collect();
        let near = self.checker.clearance(q).map_err(told)?;
        let Some(near) = near else {
            return if all.is_empty() {
                Ok(())
            } else {
                Err(format!("no pair at {q:?}: {all:?}"))
            };
        };
        // Depths are judged elsewhere: bodies that are not convex have none.
        if apart.iter().all(|e| e[0] > TIE) {
            let least = |k: usize| apart.iter().map(|e| e[k]).fold(f64::INFINITY, f64::min);
            if near.lower > least(1) + TIE || near.upper < least(0) - TIE {
                return Err(format!("clearance {near:?} at {q:?}: {all:?}"));
            }
        } else if near.lower > TIE {
            return Err(format!("clearance {near:?} at {q:?}: {all:?}"));
        }
        Ok(())
    }

    /// Judges a motion: `at` returns the configuration at a time from 0 to 1, and the time on the
    /// clock.
    fn motion(&self, verdict: &Verdict, at: impl Fn(&Self, f64) -> (Vec<f64>, f64)) -> Result<usize, String> {
        let safe = verdict.free_until();
        // Nothing is proven of a motion that starts in contact.
        let times = if safe > 0.0 { 0..TIMES + 1 } else { 0..0 };
        for k in times {
            let time = safe * f64::from(k) / f64::from(TIMES);
            let (q, clock) = at(self, time);
            let hit = self.excesses(clock, &q)?.into_iter().find(|e| e.upper < -TIE);
            if let Some(hit) = hit {
                return Err(format!("{verdict:?} but {hit:?} at {time}, {q:?}"));
            }
        }
        let Some(([_, t], pair)) = blocked(verdict) else {
            return Ok(if verdict.is_free() { 0 } else { 2 });
        };
        let (q, clock) = at(self, t);
        let found = self.excess(&self.fresh(clock)?, pair, &q)?;
        if found.lower > TIE {
            return Err(format!("{verdict:?} but {found:?} at {q:?}"));
        }
        Ok(1)
    }

    fn segment(&mut self, q: &[f64], p: &[f64]) -> Result<(), String> {
        // Segments have no time.
        if self.mix.worlds[1] > 0 {
            return Ok(());
        }
        let verdict = self.checker.certify(&JointMotion::segment(q, p)).map_err(told)?;
        let which = self.motion(&verdict, |play, time| (play.space.between(q, p, time), 0.0))?;
        self.mix.segments[which] += 1;
        Ok(())
    }

    fn curve(&mut self, q: &[f64], far: f64) -> Result<(), String> {
        let degree = 1 + self.rng.below(5);
        let mut points = vec![q.to_vec()];
        for _ in 0..degree {
            let last = points[points.len() - 1].clone();
            points.push(self.near(&last, far));
        }
        let clock = [self.rng.range(CLOCK[0], 0.5), self.rng.range(0.6, CLOCK[1])];
        let curve = JointCurve::bezier(&points)
            .and_then(|c| c.with_times(clock))
            .map_err(told)?;
        let verdict = self.checker.certify(&JointMotion::curve(&curve)).map_err(told)?;
        // De Casteljau's algorithm, apart from that of the crate.
        let value = |time: f64| {
            let mut row = points.clone();
            while row.len() > 1 {
                let mixed = |w: &[Vec<f64>]| w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * time).collect();
                row = row.windows(2).map(mixed).collect();
            }
            row.remove(0)
        };
        let at = |_: &Self, time: f64| (value(time), clock[0] + (clock[1] - clock[0]) * time);
        let which = self.motion(&verdict, at)?;
        self.mix.curves[which] += 1;
        let along = self
            .checker
            .clearance_along(&JointMotion::curve(&curve), 0.05)
            .map_err(told)?;
        for k in 0..=8 {
            let (q, clock) = at(self, f64::from(k) / 8.0);
            for e in self.excesses(clock, &q)? {
                let upper = e.upper + self.checker.cell().required_distance(e.pair).distance;
                if upper.max(0.0) < along.lower - TIE {
                    return Err(format!("{along:?} but {e:?} at {q:?}"));
                }
            }
        }
        Ok(())
    }

    fn range(&mut self, q: &[f64]) -> Result<(), String> {
        // Obstacles that move have no range.
        if self.mix.worlds[1] > 0 {
            return Ok(());
        }
        let half = self.rng.log_range(1e-3, 1.0);
        let low: Vec<f64> = q.iter().map(|x| (x - half).max(-3.0)).collect();
        let high: Vec<f64> = q.iter().map(|x| (x + half).min(3.0)).collect();
        let options = RangeOptions::default().cells(80).samples(6);
        let answers = RangeProver::new(&options)
            .all_pairs(&mut self.checker, &low, &high)
            .map_err(told)?;
        let mut left = self.pairs();
        for answer in &answers {
            left.retain(|pair| *pair != answer.pair);
            self.answer(answer, [&low, &high])?;
        }
        if left.is_empty() {
            Ok(())
        } else {
            Err(format!("pairs without an answer: {left:?}"))
        }
    }

    fn answer(&mut self, answer: &RangeAnswer, [low, high]: [&[f64]; 2]) -> Result<(), String> {
        let (judge, pair) = (self.fresh(0.0)?, answer.pair);
        let which = match &answer.verdict {
            RangeVerdict::Never => 0,
            RangeVerdict::Always => 1,
            RangeVerdict::Both { free, touching } => {
                let (free, touching) = (self.excess(&judge, pair, free)?, self.excess(&judge, pair, touching)?);
                if free.upper < -TIE || touching.lower > TIE {
                    return Err(format!("{answer:?} but {free:?} {touching:?}"));
                }
                2
            }
            _ => 3,
        };
        self.mix.ranges[which] += 1;
        let kept = self.checker.cell().required_distance(pair).distance;
        for _ in 0..8 {
            let ends = low.iter().zip(high);
            let q: Vec<f64> = ends.map(|(a, b)| self.rng.range(*a, *b).clamp(*a, *b)).collect();
            let found = self.excess(&judge, pair, &q)?;
            let is_wrong = match which {
                0 => found.upper < -TIE,
                1 => found.lower > TIE,
                _ => false,
            };
            // The depth of an overlap counts as no distance.
            if is_wrong || (found.upper + kept).max(0.0) < answer.lower - TIE {
                return Err(format!("{answer:?} but {found:?} at {q:?}"));
            }
        }
        Ok(())
    }

    /// Compares the checker with a new one of its world.
    fn afresh(&mut self, q: &[f64], p: &[f64]) -> Result<(), String> {
        let mut fresh = self.fresh(0.0)?;
        self.checker.reset();
        let ask = |checker: &mut Checker<JointTree>| {
            let near = checker.nearest(q, 0.3);
            format!(
                "{near:?} {:?} {:?}",
                checker.in_contact(q),
                checker.certify(&JointMotion::segment(q, p))
            )
        };
        let (old, new) = (ask(&mut self.checker), ask(&mut fresh));
        if old == new {
            Ok(())
        } else {
            Err(format!("{old}\nbut a new checker: {new}"))
        }
    }
}
