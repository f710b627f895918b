//! Options and results of the search for a path.

use crate::check::verdict::CheckWork;
use crate::search::roadmap::Roadmap;
use crate::search::shorten::Path;

/// The name of a planner, such as that of an option of a tool.
///
/// The [crate](crate) explains both planners.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PlanMethod {
    /// Two trees of segments, from start and goal, that grow towards random configurations and
    /// towards each other (Kuffner and LaValle 2000; the default).
    #[default]
    RrtConnect,
    /// Freeways of largest clearance in slices (Canny and Lin 1993).
    Opportunistic,
}

impl PlanMethod {
    /// All methods.
    pub const ALL: [Self; 2] = [Self::RrtConnect, Self::Opportunistic];

    /// Returns the name: `rrt-connect` or `opportunistic`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RrtConnect => "rrt-connect",
            Self::Opportunistic => "opportunistic",
        }
    }

    /// Returns the method with a name, as [`name`](Self::name) returns it; `None` for any other.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// Budget and seed of a search. The search ends when the first budget is spent.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// Random seed (default 0). A new checker returns the same result for the same seed, and so
    /// does any checker after [`Checker::reset`](crate::Checker::reset).
    pub seed: u64,
    /// Maximum number of random slices of the opportunistic planner (default 10,000).
    pub slices: u64,
    /// Maximum number of samples of RRT-Connect (default 100,000).
    pub samples: u64,
    /// Maximum number of pair queries, checked between steps (default 1,000,000).
    ///
    /// A step is a freeway or a sample. The default takes seconds to tens of seconds, depending on
    /// the bodies. To stop by a clock, set all three budgets to `u64::MAX`
    /// ([`unlimited`](Self::unlimited)), and stop the search by
    /// [`RrtConnect::progress`](crate::RrtConnect::progress).
    pub queries: u64,
    /// Clearance at which an ascent ends, because more is no better. `None` is an eighth of the
    /// largest extent of the bounds.
    pub clearance_cap: Option<f64>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            slices: 10_000,
            samples: 100_000,
            queries: 1_000_000,
            clearance_cap: None,
        }
    }
}

impl PlanOptions {
    /// Sets the random seed.
    #[must_use]
    pub const fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Sets the maximum number of random slices.
    #[must_use]
    pub const fn slices(mut self, slices: u64) -> Self {
        self.slices = slices;
        self
    }

    /// Sets the maximum number of samples.
    #[must_use]
    pub const fn samples(mut self, samples: u64) -> Self {
        self.samples = samples;
        self
    }

    /// Removes the budgets of slices, samples and queries, for a search that a callback stops.
    #[must_use]
    pub const fn unlimited(self) -> Self {
        self.slices(u64::MAX).samples(u64::MAX).queries(u64::MAX)
    }

    /// Sets the maximum number of pair queries.
    #[must_use]
    pub const fn queries(mut self, queries: u64) -> Self {
        self.queries = queries;
        self
    }

    /// Sets the clearance at which an ascent ends.
    #[must_use]
    pub const fn clearance_cap(mut self, clearance_cap: f64) -> Self {
        self.clearance_cap = Some(clearance_cap);
        self
    }
}

/// Counts of the work of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlanWork {
    /// Number of random slices.
    pub slices: u64,
    /// Number of freeways traced, without bridges.
    pub freeways: u64,
    /// Number of bridges traced (freeways within slices).
    pub bridges: u64,
    /// Number of straight segments tried between components, and number proven free. The segment
    /// from start to goal, which every method tries first, is one of them.
    pub links: [u64; 2],
    /// Number of samples of RRT-Connect.
    pub samples: u64,
    /// Number of segments tried by RRT-Connect, and number proven free.
    pub extensions: [u64; 2],
    /// Counts of the checker.
    pub checks: CheckWork,
}

/// Result of a search.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Plan {
    /// The path from start to goal, with every segment proven free in the direction of travel.
    ///
    /// `None` if the budget ended first, or if a segment of the space is another motion in the
    /// opposite direction. `None` does not prove that there is no path.
    pub path: Option<Path>,
    /// The roadmap at the end of the search.
    pub roadmap: Roadmap,
    /// Counts of the work.
    pub work: PlanWork,
}
