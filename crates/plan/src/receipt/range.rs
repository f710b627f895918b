//! Receipts of ranges: cells of configurations, each with a plane fixed to a link.
//!
//! The search for a verdict ([`RangeProver`]) has bounds of second order, swept joints and other
//! steps that a checker would have to repeat. A receipt has one kind of evidence: a plane, the first
//! derivatives at the middle of a cell, and one bound of the second ones. So the writer divides the
//! range again, until the checker's bound, computed here in double precision, proves each cell.
//!
//! [`RangeProver`]: crate::RangeProver

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Point3, Vector3};

use super::error::ReceiptError;
use super::groups::{Group, Groups, direction};
use super::number::{hex, hexes, rounded};
use super::scene::{Ignored, Scene, Way};
use super::segment::{EXCLUDED, ReceiptCell};
use super::stated::{Ellipsoid, half};
use super::{Claim, Leg, Receipt};
use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::joint::JointKind;
use crate::motion::space::ConfigurationSpace;
use crate::names::CellPair;
use crate::range::{RangeAnswer, RangeVerdict};
use crate::tolerance::RECEIPT;
use lin_canny::RelativePose;
use lin_canny::motion::Velocity;

/// Bits of the components of planes, few first.
const BITS: [u32; 3] = [6, 12, 20];

/// Most halvings from the range to a cell.
const HALVINGS: usize = 200;

impl Receipt {
    /// Returns the receipt of answers about pairs over one range: see
    /// [`RangeProver::all_pairs`](crate::RangeProver::all_pairs).
    ///
    /// A pair that never meets has cells with planes, which together are the range and, of a mesh or a
    /// compound, all its parts. The surfaces of a closed mesh are what stays apart. All other pairs
    /// are listed as not looked at, with the reason: pairs that meet or are undecided, and pairs that
    /// would need more than `cells` cells. The writer divides the range again, because a checker has
    /// simpler bounds than the search, so it may need more cells.
    ///
    /// # Errors
    /// Returns an error if there is no answer, if their ranges differ, if a body or the motion has no
    /// receipt ([module](crate::receipt)), or if no pair is proven ([`ReceiptError::Nothing`]).
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::receipt::Receipt;
    /// use lin_canny_plan::{Checker, Joint, RangeOptions, RangeProver, JointTree, Cell};
    ///
    /// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
    /// let turn = |x: f64| Joint::revolute(at(x), Vector3::z_axis(), [-3.0, 3.0]);
    /// let arm = JointTree::serial(at(0.0), vec![turn(0.0), turn(1.0)], vec![2], 1.0)?;
    /// let rod = solids::cuboid(Vector3::new(0.4, 0.05, 0.05))?;
    /// let mut cell = Cell::new();
    /// cell.robot_body("fore arm", rod.transformed(&at(0.5))?);
    /// let post = solids::cuboid(Vector3::new(0.1, 0.1, 1.0))?;
    /// cell.add_obstacle("post", post, at(1.5))?;
    /// let mut checker = Checker::new(arm, cell)?;
    ///
    /// let options = RangeOptions::default();
    /// let answers = RangeProver::new(&options).all_pairs(&mut checker, &[1.0, -1.0], &[2.0, 1.0])?;
    /// let receipt = Receipt::range(&checker, &answers, 20_000)?;
    /// assert!(receipt.to_string().contains("\"claim\":\"range\""));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn range<C: ConfigurationSpace>(
        checker: &Checker<C>,
        answers: &[RangeAnswer],
        cells: u64,
    ) -> Result<Self, ReceiptError> {
        let range = &answers.first().ok_or(PlanError::Empty)?.range;
        if let Some(other) = answers.iter().find(|answer| answer.range != *range) {
            return Err(PlanError::OtherRange(other.pair).into());
        }
        let [low, high] = [0, 1].map(|k| range.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
        checker.cell.check_at_rest()?;
        let segment = checker.segment(&low, &high)?;
        let mut stated = ReceiptCell::new(checker, &segment, None, 1)?;
        let known: BTreeMap<CellPair, &RangeAnswer> = answers.iter().map(|answer| (answer.pair, answer)).collect();
        let excluded = |ignored: &Ignored| ignored.why == EXCLUDED;
        let (others, rigid): (Vec<_>, Vec<_>) = core::mem::take(&mut stated.scene.ignored)
            .into_iter()
            .partition(excluded);
        let measured = core::mem::take(&mut stated.pairs)
            .into_iter()
            .map(|pair| (pair.0, None));
        let mut all: Vec<_> = measured
            .chain(others.into_iter().map(|one| (one.pair, Some(one.why))))
            .collect();
        all.sort_by_key(|one| one.0);
        stated.scene.ignored = rigid;
        let (mut proven, mut ignored) = (Vec::new(), Vec::new());
        for (pair, why) in all {
            let id = stated.pair(pair);
            let answer = id.and_then(|id| known.get(&id)).filter(|answer| answer.is_never());
            let keep = id.map_or(0.0, |id| checker.cell.required_distance(id).distance);
            let turns = |k: usize| stated.scene.bodies[k].half.is_some() && stated.scene.moves(k);
            let has_turning_plane = pair.into_iter().any(turns);
            let answer = answer.filter(|_| !has_turning_plane);
            let found = answer.and_then(|_| Divided::lines(&stated.scene, pair, keep, range, cells));
            match found {
                Some(cells) => proven.push((pair, keep, cells)),
                None => {
                    let reason = match id.and_then(|id| known.get(&id)).map(|answer| &answer.verdict) {
                        Some(RangeVerdict::Never) if has_turning_plane => "never meet, but a half-space moves",
                        Some(RangeVerdict::Never) => "never meet, but the proof has too many cells",
                        Some(RangeVerdict::Always) => "always meet",
                        Some(RangeVerdict::Both { .. }) => "can meet",
                        Some(_) => "undecided",
                        None => "no answer",
                    };
                    let why = why.unwrap_or_else(|| reason.into());
                    ignored.push(Ignored { pair, why });
                }
            }
        }
        stated.scene.ignored.extend(ignored);
        let margin = proven.iter().map(|one| one.1).fold(f64::INFINITY, f64::smaller);
        if proven.is_empty() {
            return Err(ReceiptError::Nothing);
        }
        let mut evidence = Vec::new();
        for ([a, b], keep, cells) in proven {
            let more = match keep == margin {
                true => String::new(),
                false => format!(",\"keep\":\"{}\"", hex(keep)),
            };
            evidence.extend(
                cells
                    .into_iter()
                    .map(|rest| format!("{{\"cell\":[{a},{b}]{rest}{more}}}")),
            );
        }
        let range = range.clone();
        Ok(Self {
            claim: Claim::Range { range, margin },
            files: Vec::new(),
            scene: stated.scene,
            legs: vec![Leg { rows: None, evidence }],
        })
    }
}

/// A step from a body to a link.
#[derive(Clone)]
enum Hop {
    Place(Isometry3<f64>),
    /// A joint with its axis along the step: whether it turns, its coordinate and factor.
    Joint {
        is_turn: bool,
        axis: Vector3<f64>,
        coordinate: usize,
        factor: f64,
    },
}

/// The steps from a body to a link, each with the offset of its joint.
type Hops = Vec<(Hop, f64)>;

/// A body of a pair.
struct Side {
    middle: Vector3<f64>,
    round: f64,
    link: Option<usize>,
    own: Isometry3<f64>,
    half: Option<(Vector3<f64>, f64)>,
}

/// A range that is divided for a pair.
struct Divided<'a> {
    scene: &'a Scene,
    sides: [Side; 2],
    /// The links between the bodies, and for each the steps from both bodies.
    links: Vec<(usize, [Hops; 2])>,
    groups: [Groups<'a>; 2],
    /// The distance that a pair must keep.
    keep: f64,
    room: f64,
    left: u64,
    cuts: Vec<String>,
    lines: Vec<String>,
}

impl Divided<'_> {
    /// Returns the lines of the cells of a pair, without the pair; `None` if they are too many.
    fn lines(scene: &Scene, pair: [usize; 2], keep: f64, range: &[[f64; 2]], cells: u64) -> Option<Vec<String>> {
        let sides = pair.map(|k| Side::new(scene, k));
        let mut on = vec![0];
        for side in &sides {
            on.extend(side.link.map_or(Vec::new(), |link| chain(scene, link)));
        }
        on.sort_unstable();
        on.dedup();
        if sides.iter().any(|side| side.half.is_some()) {
            // The plane of a half-space is in the frame of the base.
            on.truncate(1);
        }
        let links = on
            .into_iter()
            .map(|link| (link, [0, 1].map(|k| hops(scene, &sides[k], link))));
        let [a, b] = pair.map(|k| &scene.bodies[k]);
        let mut divided = Divided {
            links: links.collect(),
            groups: [a, b].map(Groups::new),
            scene,
            keep,
            room: RECEIPT * scene.size(),
            sides,
            left: cells,
            cuts: Vec::new(),
            lines: Vec::new(),
        };
        let all = [divided.groups[0].all(), divided.groups[1].all()];
        divided.divide(range.to_vec(), all, 0).then_some(divided.lines)
    }

    /// Proves a cell or both of its halves; returns whether all are proven.
    ///
    /// The cell is configurations, and parts of both bodies.
    fn divide(&mut self, cell: Vec<[f64; 2]>, parts: [[usize; 2]; 2], depth: usize) -> bool {
        if self.left == 0 || depth > HALVINGS {
            return false;
        }
        self.left -= 1;
        let mut ways = vec![0.0; cell.len()];
        let groups = [0, 1].map(|k| self.groups[k].get(parts[k]));
        let found = match &groups {
            [Some(a), Some(b)] => self.plane(&cell, [a, b], &mut ways),
            _ => None,
        };
        let largest = (0..2)
            .filter(|k| parts[*k][1] > parts[*k][0] + 1)
            .map(|k| (k, groups[k].as_ref().map_or(f64::INFINITY, |group| group.size)))
            .reduce(|x, y| if y.1 > x.1 { y } else { x });
        match (found, largest) {
            (None, None) => return false,
            // Groups that meet, or are larger than they move.
            (None, Some((side, _))) => return self.divide_parts(cell, parts, side, depth),
            (Some(Err(())), Some((side, size))) if ways.iter().all(|way| *way < size) => {
                return self.divide_parts(cell, parts, side, depth);
            }
            (Some(Ok(plane)), _) => {
                let cuts = core::mem::take(&mut self.cuts);
                let cut = match cuts.is_empty() {
                    true => String::new(),
                    false => format!(",\"cut\":[{}]", cuts.join(",")),
                };
                self.lines.push(cut + &plane);
                return true;
            }
            (Some(Err(())), _) => {}
        }
        let each = ways.iter().enumerate().filter(|(k, _)| {
            let [low, high] = cell[*k];
            let at = 0.5 * low + 0.5 * high;
            low < at && at < high
        });
        let Some((k, _)) = each.max_by(|x, y| x.1.total_cmp(y.1)).filter(|most| *most.1 > 0.0) else {
            return false;
        };
        let at = 0.5 * cell[k][0] + 0.5 * cell[k][1];
        self.cuts.push(format!("[{k},\"{}\"]", hex(at)));
        let (mut lower, mut upper) = (cell.clone(), cell);
        (lower[k][1], upper[k][0]) = (at, at);
        self.divide(lower, parts, depth + 1) && self.divide(upper, parts, depth + 1)
    }

    /// Proves both halves of the parts of a body.
    fn divide_parts(&mut self, cell: Vec<[f64; 2]>, parts: [[usize; 2]; 2], side: usize, depth: usize) -> bool {
        let middle = half(parts[side]);
        self.cuts.push(format!("[{side},{middle}]"));
        let [mut lower, mut upper] = [parts; 2];
        (lower[side][1], upper[side][0]) = (middle, middle);
        self.divide(cell.clone(), lower, depth + 1) && self.divide(cell, upper, depth + 1)
    }

    /// Returns a plane that proves a cell, or an error if none does; `None` if the groups meet at its
    /// middle. Adds how far each coordinate moves the bodies.
    fn plane(&self, cell: &[[f64; 2]], groups: [&Group; 2], ways: &mut [f64]) -> Option<Result<String, ()>> {
        let middle: Vec<f64> = cell.iter().map(|[low, high]| 0.5 * low + 0.5 * high).collect();
        let half: Vec<f64> = cell.iter().map(|[low, high]| 0.5 * high - 0.5 * low).collect();
        let kept = self.keep + groups[0].radius + groups[1].radius;
        // In the frame of link 0, the first of the list.
        let [x, y] = [0, 1].map(|k| pose(&self.links[0].1[k], &middle));
        let relative = RelativePose::new(&x, &y).ok()?;
        let floor = (0..2).find_map(|k| Some((k, self.sides[k].half?.0)));
        let normal = match floor {
            Some((0, normal)) => x.rotation * normal,
            Some((_, normal)) => y.rotation * -normal,
            None => {
                let (normal, upper) = direction(groups, &relative)?;
                if !(upper > kept) {
                    return None;
                }
                x.rotation * normal
            }
        };
        let mut best: Option<(f64, usize, Vector3<f64>)> = None;
        for (link, steps) in &self.links {
            let at = pose(&hops_of_link(self.scene, *link), &middle);
            let n = at.rotation * normal;
            let [high, low] =
                [0, 1].map(|k| self.sides[k].height(groups[k], &steps[k], [0.0, 1.0][k], &n, &middle, &half, ways));
            let gap = -low - high;
            if best.is_none_or(|best| gap > best.0) {
                best = Some((gap, *link, n));
            }
        }
        let (gap, link, n) = best?;
        if !(gap > (kept + self.room) * n.norm()) {
            return Some(Err(()));
        }
        if floor.is_some() {
            return Some(Ok(String::new()));
        }
        let steps = self.links.iter().find(|one| one.0 == link).map(|one| &one.1)?;
        let few = BITS.iter().map(|bits| rounded(&n, *bits)).find(|n| {
            let mut none = vec![0.0; half.len()];
            let [high, low] =
                [0, 1].map(|k| self.sides[k].height(groups[k], &steps[k], [0.0, 1.0][k], n, &middle, &half, &mut none));
            -low - high > (kept + self.room) * n.norm()
        });
        let normal = hexes(few.unwrap_or(n).as_slice());
        Some(Ok(format!(",\"link\":{link},\"normal\":{normal}")))
    }
}

impl Side {
    fn new(scene: &Scene, body: usize) -> Self {
        let body = &scene.bodies[body];
        let points: Vec<Vector3<f64>> = body.hull.vertex_points().map(|p| p.coords).collect();
        let first = points.first().copied().unwrap_or_default();
        let [low, high] = points.iter().fold([first; 2], |[low, high], p| {
            [low.zip_map(p, f64::smaller), high.zip_map(p, f64::larger)]
        });
        let middle = 0.5 * low + 0.5 * high;
        let wider = body.ellipsoids.iter().map(Ellipsoid::radius).fold(0.0, f64::larger);
        let round = points.iter().map(|p| (p - middle).norm()).fold(0.0, f64::larger) + wider;
        let (link, own) = match &body.way {
            Way::Rests(at) => (None, *at),
            Way::Link(link, at) => (Some(*link), at.unwrap_or_default()),
            Way::Steady(way) => (None, way.start()),
        };
        Self {
            middle,
            round,
            link,
            own,
            half: body.half,
        }
    }

    /// Returns an upper bound of the heights of vertices over a cell, of the depths (`sign` 1) or the
    /// heights along the normal: lemma 9 of the checker.
    #[allow(clippy::too_many_arguments)] // the numbers of the lemma
    fn height(
        &self,
        group: &Group,
        hops: &[(Hop, f64)],
        sign: f64,
        n: &Vector3<f64>,
        middle: &[f64],
        half: &[f64],
        ways: &mut [f64],
    ) -> f64 {
        let n = if sign > 0.0 { -n } else { *n };
        if let Some((_, offset)) = self.half {
            return offset + n.dot(&pose(hops, middle).translation.vector);
        }
        let (mut x, mut moved, mut rest) = (self.middle, 0.0, 0.0);
        for (hop, offset) in hops {
            if let Hop::Joint {
                is_turn,
                axis,
                coordinate,
                factor,
            } = hop
            {
                let h = half[*coordinate] * factor.abs();
                let size = axis.norm();
                let speed = if *is_turn {
                    axis.cross(&x).norm() + size * (self.round + moved)
                } else {
                    size
                };
                let way = speed * h;
                if *is_turn {
                    rest += size * h * (moved + 0.5 * way);
                }
                moved += way;
                ways[*coordinate] += way;
            }
            x = step(hop, *offset, middle).transform_point(&Point3::from(x)).coords;
        }
        let mut rows: Vec<(usize, Vector3<f64>, f64)> = vec![(usize::MAX, n, 0.0)];
        for (hop, offset) in hops.iter().rev() {
            let at = step(hop, *offset, middle);
            for (_, m, o) in &mut rows {
                *o += m.dot(&at.translation.vector);
                *m = at.rotation.inverse() * *m;
            }
            if let Hop::Joint {
                is_turn,
                axis,
                coordinate,
                factor,
            } = hop
            {
                let m = rows[0].1;
                let (m, o) = if *is_turn {
                    (m.cross(axis), 0.0)
                } else {
                    (Vector3::zeros(), m.dot(axis))
                };
                match rows[1..].iter_mut().find(|row| row.0 == *coordinate) {
                    // A row behind other joints: it is pulled through them from here on as well.
                    Some(row) => (row.1, row.2) = (row.1 + *factor * m, row.2 + factor * o),
                    None => rows.push((*coordinate, *factor * m, factor * o)),
                }
            }
        }
        let height = |p: &Vector3<f64>, ellipsoid: Option<&Ellipsoid>| {
            let wider = |m| ellipsoid.map_or(0.0, |ellipsoid| ellipsoid.half_height(m));
            let slopes = rows[1..]
                .iter()
                .map(|(c, m, o)| half[*c] * ((m.dot(p) + o).abs() + wider(m)));
            rows[0].1.dot(p) + rows[0].2 + wider(&rows[0].1) + slopes.sum::<f64>()
        };
        let points = group.vertices.iter().map(|p| height(p, None));
        let wide = group.ellipsoids.iter().map(|of| height(&of.at, Some(of)));
        let most = points.chain(wide).fold(f64::NEG_INFINITY, f64::larger);
        most + n.norm() * rest
    }
}

/// Returns the pose of a step at a configuration; `offset` is the offset of a joint.
fn step(hop: &Hop, offset: f64, q: &[f64]) -> Isometry3<f64> {
    match hop {
        Hop::Place(at) => *at,
        Hop::Joint {
            is_turn,
            axis,
            coordinate,
            factor,
        } => {
            let value = factor * q[*coordinate] + offset;
            match is_turn {
                true => {
                    let turn = Velocity::new(Vector3::zeros(), axis * value);
                    turn.applied(&Isometry3::identity(), 1.0)
                }
                false => Isometry3::from(axis * value),
            }
        }
    }
}

fn pose(hops: &[(Hop, f64)], q: &[f64]) -> Isometry3<f64> {
    hops.iter().fold(Isometry3::identity(), |pose, (hop, offset)| {
        step(hop, *offset, q) * pose
    })
}

/// Returns the links from a link to the base, the nearest first.
fn chain(scene: &Scene, mut link: usize) -> Vec<usize> {
    let mut all = Vec::new();
    while link > 0 {
        all.push(link);
        link = scene.joints()[link - 1].parent;
    }
    all
}

/// Returns the steps from a body to a link, as the checker takes them.
fn hops(scene: &Scene, side: &Side, link: usize) -> Hops {
    let mut all = vec![(Hop::Place(side.own), 0.0)];
    let (mut down, mut up) = (side.link.map_or(Vec::new(), |on| chain(scene, on)), chain(scene, link));
    while down.last().is_some_and(|link| up.last() == Some(link)) {
        down.pop();
        up.pop();
    }
    if side.link.is_none() {
        all.push((Hop::Place(scene.base().inverse()), 0.0));
    }
    for k in down {
        let joint = &scene.joints()[k - 1];
        all.extend(motion(scene, k, 1.0));
        all.push((Hop::Place(joint.origin), 0.0));
    }
    all.extend(upward(scene, &up));
    all
}

/// Returns the steps from link 0 to a link.
fn hops_of_link(scene: &Scene, link: usize) -> Hops {
    upward(scene, &chain(scene, link))
}

fn upward(scene: &Scene, up: &[usize]) -> Hops {
    let mut all = Vec::new();
    for k in up.iter().rev() {
        all.push((Hop::Place(scene.joints()[k - 1].origin.inverse()), 0.0));
        all.extend(motion(scene, *k, -1.0));
    }
    all
}

fn motion(scene: &Scene, link: usize, sign: f64) -> Option<(Hop, f64)> {
    let joint = &scene.joints()[link - 1];
    let drive = joint.drive?;
    let hop = Hop::Joint {
        is_turn: joint.kind == JointKind::Revolute,
        axis: sign * joint.axis.into_inner(),
        coordinate: drive.coordinate,
        factor: drive.factor,
    };
    Some((hop, drive.offset))
}
