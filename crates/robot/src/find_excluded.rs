//! Finds link pairs that always or never collide, from random configurations.

use std::ops::ControlFlow;

use lin_canny::nalgebra::Isometry3;
use lin_canny::{PairTracker, Progress, QueryOptions, RelativePose};
use lin_canny_plan::{Cell, CellBody, ConfigurationSpace, PlanError};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::srdf::{ExcludedPair, Srdf};

/// Reason why a link pair may be excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum ExcludeReason {
    /// One joint connects the links.
    Adjacent,
    /// The links overlapped at every configuration.
    Always,
    /// The links overlapped at no configuration. This is not a proof: see [`audit`](crate::audit()).
    Never,
}

impl std::fmt::Display for ExcludeReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Adjacent => "Adjacent",
            Self::Always => "Always",
            Self::Never => "Never",
        })
    }
}

/// Two links, and how often they overlapped.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LinkPairCount {
    /// Names of both links.
    pub links: [String; 2],
    /// Number of configurations at which the links overlapped or touched.
    pub overlaps: u64,
    /// Number of configurations at which the links were within rounding error of contact.
    pub undecided: u64,
    /// Number of all configurations.
    pub samples: u64,
    /// Reason why the pair may be excluded; `None` if it must be checked.
    pub reason: Option<ExcludeReason>,
}

/// The tracked pairs of bodies of two links.
struct Counted {
    links: [String; 2],
    bodies: Vec<(usize, usize, PairTracker)>,
    overlaps: u64,
    undecided: u64,
}

/// Counts how often each two links overlap at random configurations, uniform within the limits.
///
/// Pairs of links that keep their relative pose are not counted. Obstacles are not counted either,
/// because a link that always collides with an obstacle is an error of the cell. `progress` is
/// called after each configuration and may end the count early.
///
/// # Errors
/// Returns an error if a number of a robot is out of range.
pub fn find_excluded(
    cell: &Cell,
    samples: u64,
    seed: u64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<LinkPairCount>, PlanError> {
    let space = cell.space()?;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut counted = pairs(cell, &space);
    let (mut poses, mut done) = (Vec::new(), 0);
    while done < samples {
        let q = space.sample(&mut || random.random::<f64>());
        space.place(&q, &mut poses);
        for pair in &mut counted {
            pair.count(cell, &poses)?;
        }
        done += 1;
        let state = Progress::new("configurations", done as usize, usize::try_from(samples).ok());
        if progress(state).is_break() {
            break;
        }
    }
    Ok(counted.into_iter().map(|pair| pair.judged(cell, done)).collect())
}

fn pairs(cell: &Cell, space: &impl ConfigurationSpace) -> Vec<Counted> {
    let bodies: Vec<_> = cell.robot_bodies().collect();
    let mut counted: Vec<Counted> = Vec::new();
    for b in 0..bodies.len() {
        for a in (0..b).filter(|&a| !space.is_rigid(a, b)) {
            let links = [a, b].map(|k| bodies[k].0.to_owned());
            let known = counted.iter_mut().find(|pair| pair.links == links);
            let entry = (a, b, PairTracker::new());
            match known {
                Some(pair) => pair.bodies.push(entry),
                None => counted.push(Counted {
                    links,
                    bodies: vec![entry],
                    overlaps: 0,
                    undecided: 0,
                }),
            }
        }
    }
    counted
}

impl Counted {
    fn count(&mut self, cell: &Cell, poses: &[Isometry3<f64>]) -> Result<(), PlanError> {
        let shape = |k: usize| {
            cell.geometry(CellBody::Robot(k))
                .ok_or(PlanError::NoBody(CellBody::Robot(k)))
        };
        let mut is_undecided = false;
        for (a, b, tracker) in &mut self.bodies {
            let pose = RelativePose::new(&poses[*a], &poses[*b])?;
            match tracker.decide_within(shape(*a)?, shape(*b)?, &pose, 0.0, &QueryOptions::default()) {
                lin_canny::Decision::Yes => {
                    self.overlaps += 1;
                    return Ok(());
                }
                lin_canny::Decision::No => {}
                _ => is_undecided = true,
            }
        }
        self.undecided += u64::from(is_undecided);
        Ok(())
    }

    fn judged(self, cell: &Cell, samples: u64) -> LinkPairCount {
        let [a, b] = &self.links;
        let mut adjacent = cell.adjacent().iter();
        let reason = if adjacent.any(|pair| (&pair[0], &pair[1]) == (a, b) || (&pair[1], &pair[0]) == (a, b)) {
            Some(ExcludeReason::Adjacent)
        } else if samples > 0 && self.overlaps == samples {
            Some(ExcludeReason::Always)
        } else if samples > 0 && self.overlaps + self.undecided == 0 {
            Some(ExcludeReason::Never)
        } else {
            None
        };
        LinkPairCount {
            links: self.links,
            overlaps: self.overlaps,
            undecided: self.undecided,
            samples,
            reason,
        }
    }
}

impl Srdf {
    /// Returns the pairs that these counts allow to exclude: see [`find_excluded`].
    #[must_use]
    pub fn from_counts(counts: &[LinkPairCount]) -> Self {
        let excluded = counts.iter().filter_map(|pair| {
            let reason = pair.reason?.to_string();
            let links = pair.links.clone();
            Some(ExcludedPair { links, reason })
        });
        Self {
            excluded: excluded.collect(),
            ..Self::default()
        }
    }
}
