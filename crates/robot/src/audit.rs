//! Proves for each two links, and each link and obstacle, whether they can ever meet.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use lin_canny::Progress;
use lin_canny_plan::{
    CellBody, CellPair, Checker, ConfigurationSpace, JointTree, PlanError, RangeAnswer, RangeOptions, RangeProver,
    RangeVerdict, nearest_name,
};

use crate::srdf::{ExcludedPair, Srdf};

/// Whether two links can ever meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum AuditVerdict {
    /// No body of one link meets a body of the other at any configuration.
    Never,
    /// Two bodies meet at every configuration.
    Always,
    /// Two bodies meet at one configuration and are free at another.
    ///
    /// One such pair of bodies is enough, even if other bodies of the links are open: the links meet
    /// at one configuration at least, so no exclusion may claim the contrary. Whether they are free as
    /// a whole at some configuration is not said.
    Both,
    /// The budget ended before a verdict, and no two bodies are proven to meet.
    Open,
}

impl AuditVerdict {
    /// Returns the name of the verdict: `never`, `always`, `both` or `open`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Never => "never",
            Self::Always => "always",
            Self::Both => "both",
            Self::Open => "open",
        }
    }
}

impl std::fmt::Display for AuditVerdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// The answer about two links, or a link and an obstacle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinkAudit {
    /// Names of both.
    pub names: [String; 2],
    /// The answer about each two bodies.
    pub answers: Vec<RangeAnswer>,
    /// The verdict.
    pub verdict: AuditVerdict,
    /// Number of coordinates that move one against the other.
    pub joints: usize,
    /// Proven lower bound of the distance at every configuration, in metres; 0 if they may meet.
    pub lower: f64,
    /// Least distance that was found, in metres; 0 in contact.
    pub upper: f64,
    /// The configuration at which `upper` was found.
    pub at: Vec<f64>,
    /// Share of the volume of the ranges that is left.
    pub open: f64,
    /// Number of cells that were searched.
    pub cells: u64,
    /// Time of this run.
    pub time: Duration,
}

/// Cells of each pair in the first round of an audit, and growth from round to round: pairs that few
/// cells decide come first, if the time is limited.
const FIRST_ROUND: u64 = 256;
const GROWTH: u64 = 4;

/// Proves for each two links, and each link and obstacle, whether they can ever meet.
///
/// All pairs are answered, excluded ones too, without those that keep their relative pose. The
/// ranges are the limits of the coordinates. Answers of an earlier run that are open go on; others
/// are taken over. `progress` is called after each cell and may end the run: pairs without a verdict
/// are then open.
///
/// # Errors
/// Returns an error if an earlier answer belongs to another robot or cell.
pub fn audit(
    checker: &mut Checker<JointTree>,
    options: &RangeOptions,
    earlier: &[RangeAnswer],
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<LinkAudit>, PlanError> {
    let [low, high] = [0, 1].map(|k| {
        checker
            .space()
            .bounds()
            .iter()
            .map(|ends| ends[k])
            .collect::<Vec<f64>>()
    });
    let has_other_range = |answer: &&RangeAnswer| {
        let ends = low.iter().zip(&high).map(|(low, high)| [*low, *high]);
        !ends.eq(answer.range.iter().copied())
    };
    if let Some(answer) = earlier.iter().find(has_other_range) {
        return Err(PlanError::OtherRange(answer.pair));
    }
    let known: BTreeMap<CellPair, &RangeAnswer> = earlier.iter().map(|answer| (answer.pair, answer)).collect();
    let mut rows: Vec<(CellPair, [String; 2], Option<RangeAnswer>, Duration)> = pairs(checker)
        .into_iter()
        .map(|(pair, names)| (pair, names, known.get(&pair).copied().cloned(), Duration::ZERO))
        .collect();
    let (mut left, mut budget, mut is_stopped) = (options.cells, FIRST_ROUND, false);
    loop {
        let round = options.cells(left.min(budget));
        // The first round recognises the bodies of earlier answers.
        let is_first = left == options.cells;
        let is_left = |answer: &RangeAnswer| is_first || matches!(answer.verdict, RangeVerdict::Open { .. });
        for (pair, _, answer, time) in &mut rows {
            if !answer.as_ref().is_none_or(is_left) {
                continue;
            }
            let began = Instant::now();
            let mut watch = |now| {
                is_stopped = is_stopped || progress(now).is_break();
                Progress::stop_if(is_stopped)
            };
            let prover = RangeProver::new(&round).progress(&mut watch);
            *answer = Some(match answer.take() {
                Some(answer) => prover.resume(checker, &answer)?,
                None => prover.pair(checker, pair.a, pair.b, &low, &high)?,
            });
            *time += began.elapsed();
        }
        left = left.saturating_sub(budget);
        budget = budget.saturating_mul(GROWTH);
        rows.retain(|(_, _, answer, _)| answer.as_ref().is_none_or(|answer| !answer.coordinates.is_empty()));
        if left == 0 || is_stopped {
            break;
        }
    }
    let mut found: Vec<LinkAudit> = Vec::new();
    for (_, names, answer, time) in rows {
        let Some(answer) = answer else { continue };
        match found.iter_mut().find(|one| one.names == names) {
            Some(one) => one.add(answer, time),
            None => {
                let mut one = LinkAudit::new(names);
                one.add(answer, time);
                found.push(one);
            }
        }
    }
    Ok(found)
}

/// Proves whether two links, or a link and an obstacle, can meet at any configuration of a range.
///
/// `low` and `high` hold the least and the greatest value of each coordinate. This is one row of
/// [`audit`] over a part of the limits: [`audit_cells`] divides a large audit into cells that run
/// apart. Two links never meet if they never do in any cell, and always if they do in every cell.
///
/// # Errors
/// Returns an error if a name does not exist, or as [`RangeProver::pair`] does.
pub fn audit_pair(
    checker: &mut Checker<JointTree>,
    names: [&str; 2],
    [low, high]: [&[f64]; 2],
    options: &RangeOptions,
) -> Result<LinkAudit, PlanError> {
    let cell = checker.cell();
    let of = |name: &str| cell.bodies().filter(|body| body.1 == name).map(|body| body.0).collect();
    let [a, b]: [Vec<CellBody>; 2] = names.map(of);
    for (ids, name) in [(&a, names[0]), (&b, names[1])] {
        if ids.is_empty() {
            let near = nearest_name(name, cell.bodies().map(|body| body.1));
            let name = name.to_owned();
            return Err(PlanError::Unnamed { name, near });
        }
    }
    let mut found = LinkAudit::new(names.map(str::to_owned));
    for (x, y) in a.iter().flat_map(|x| b.iter().map(move |y| (*x, *y))) {
        let began = Instant::now();
        let answer = RangeProver::new(options).pair(checker, x, y, low, high)?;
        found.add(answer, began.elapsed());
    }
    Ok(found)
}

/// A part of an audit: two names, and a part of the limits.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AuditCell {
    /// Names of both.
    pub names: [String; 2],
    /// Least and greatest value of each coordinate.
    pub range: [Vec<f64>; 2],
}

/// Divides an audit into cells for [`audit_pair`], at most `count` for each two names.
///
/// The cells of two names cover the limits up to full turns. A cell that its first bound decides is
/// not divided. The cells depend on robot and cell alone, so any number of machines may prove them.
///
/// # Errors
/// Returns an error if the world has an obstacle that moves and no time is set.
pub fn audit_cells(checker: &mut Checker<JointTree>, count: usize) -> Result<Vec<AuditCell>, PlanError> {
    let bounds = checker.space().bounds();
    let limits = [0, 1].map(|k| bounds.iter().map(|ends| ends[k]).collect::<Vec<f64>>());
    let first = RangeOptions::default().cells(1).samples(0);
    let mut names: Vec<[String; 2]> = Vec::new();
    for (_, pair) in pairs(checker) {
        if !names.contains(&pair) {
            names.push(pair);
        }
    }
    let mut cells = Vec::new();
    for names in names {
        let [a, b] = names.each_ref().map(String::as_str);
        let [low, high] = &limits;
        if audit_pair(checker, [a, b], [low, high], &first.cells(0))?.joints == 0 {
            continue;
        }
        let (mut waiting, mut decided) = (VecDeque::from([limits.clone()]), Vec::new());
        while waiting.len() + decided.len() < count {
            let Some(range) = waiting.pop_front() else { break };
            let [low, high] = &range;
            let found = audit_pair(checker, [a, b], [low, high], &first)?;
            match found.answers.iter().find(|answer| answer.open.len() == 2) {
                None => decided.push(range),
                Some(answer) => waiting.extend(answer.open.iter().map(|half| {
                    let mut range = range.clone();
                    for (k, &coordinate) in answer.coordinates.iter().enumerate() {
                        (range[0][coordinate], range[1][coordinate]) = (half.low[k], half.high[k]);
                    }
                    range
                })),
            }
        }
        decided.extend(waiting);
        cells.extend(decided.into_iter().map(|range| AuditCell {
            names: names.clone(),
            range,
        }));
    }
    Ok(cells)
}

/// Returns all pairs of bodies with their names.
fn pairs(checker: &Checker<JointTree>) -> Vec<(CellPair, [String; 2])> {
    let bodies: Vec<(CellBody, &str)> = checker.cell().bodies().collect();
    let mut pairs = Vec::new();
    for (k, a) in bodies.iter().enumerate() {
        for b in &bodies[k + 1..] {
            let is_rigid = match (a.0, b.0) {
                (CellBody::Robot(x), CellBody::Robot(y)) => checker.space().is_rigid(x, y),
                _ => false,
            };
            if let Some(pair) = CellPair::new(a.0, b.0).filter(|_| !is_rigid) {
                pairs.push((pair, [a.1.to_owned(), b.1.to_owned()]));
            }
        }
    }
    pairs
}

impl LinkAudit {
    fn new(names: [String; 2]) -> Self {
        Self {
            names,
            answers: Vec::new(),
            verdict: AuditVerdict::Never,
            joints: 0,
            lower: f64::INFINITY,
            upper: f64::INFINITY,
            at: Vec::new(),
            open: 0.0,
            cells: 0,
            time: Duration::ZERO,
        }
    }

    fn add(&mut self, answer: RangeAnswer, time: Duration) {
        if self.answers.is_empty() || answer.upper < self.upper {
            self.upper = answer.upper;
            self.at.clone_from(&answer.at);
        }
        if answer.lower < self.lower {
            self.lower = answer.lower;
        }
        if answer.open_share() > self.open {
            self.open = answer.open_share();
        }
        self.cells += answer.cells;
        self.time += time;
        self.answers.push(answer);
        let coordinates = self.answers.iter().flat_map(|answer| answer.coordinates.iter());
        self.joints = coordinates.collect::<BTreeSet<_>>().len();
        let has = |is: fn(&RangeVerdict) -> bool| self.answers.iter().any(|answer| is(&answer.verdict));
        self.verdict = if has(|v| matches!(v, RangeVerdict::Always)) {
            AuditVerdict::Always
        } else if has(|v| matches!(v, RangeVerdict::Both { .. })) {
            AuditVerdict::Both
        } else if has(|v| !matches!(v, RangeVerdict::Never)) {
            AuditVerdict::Open
        } else {
            AuditVerdict::Never
        };
    }

    /// Returns whether two bodies touch without depth, so that more cells do not decide the pair:
    /// see [`RangeAnswer::is_flush`].
    #[must_use]
    pub fn is_flush(&self) -> bool {
        self.answers.iter().any(RangeAnswer::is_flush)
    }

    /// Returns a configuration at which the pair is in contact, if one was found.
    #[must_use]
    pub fn contact(&self) -> Option<&[f64]> {
        let mut touching = self.answers.iter().filter_map(|answer| answer.witnesses[1].as_deref());
        touching.next()
    }
}

impl Srdf {
    /// Returns the pairs that an audit allows to exclude.
    ///
    /// The reason of a pair that never meets is `Proven`, of one that always meets `Always`. Other
    /// pairs keep the reason that `reason` gives them, unless it is `Never` or `Proven` and the pair
    /// can meet.
    #[must_use]
    pub fn from_audit(audit: &[LinkAudit], reason: &dyn Fn(&[String; 2]) -> Option<String>) -> Self {
        let excluded = audit.iter().filter_map(|one| {
            let old = reason(&one.names);
            let reason = match one.verdict {
                AuditVerdict::Never => "Proven".to_owned(),
                AuditVerdict::Always if old.as_deref() != Some("Adjacent") => "Always".to_owned(),
                AuditVerdict::Both => old.filter(|reason| !is_claim(reason))?,
                _ => old?,
            };
            let links = one.names.clone();
            Some(ExcludedPair { links, reason })
        });
        Self {
            excluded: excluded.collect(),
            ..Self::default()
        }
    }
}

/// Returns whether a reason says that a pair never meets.
pub(crate) fn is_claim(reason: &str) -> bool {
    reason == "Never" || reason == "Proven"
}

impl LinkAudit {
    /// Returns whether the pair can meet although a reason says that it never does.
    #[must_use]
    pub fn refutes(&self, reason: &str) -> bool {
        is_claim(reason) && self.contact().is_some()
    }
}
