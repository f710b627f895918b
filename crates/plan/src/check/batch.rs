//! The closest pairs at many configurations, as flat arrays.

use std::boxed::Box;
use std::vec::Vec;

use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::names::CellPair;

/// The closest pairs at many configurations: see [`Checker::nearest_batch`].
///
/// Row i has the entries `i * columns` to `i * columns + counts[i]`, the closest pair first. The
/// other entries of a row are empty: their distances are infinite, and all else is zero or `None`.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NearPairs {
    /// Number of entries of a row.
    pub columns: usize,
    /// Number of components of a gradient: the degrees of freedom.
    pub components: usize,
    /// Number of pairs of each row.
    pub counts: Vec<usize>,
    /// The pairs.
    pub pairs: Vec<Option<CellPair>>,
    /// Signed distances.
    pub distances: Vec<f64>,
    /// Lower bounds of the signed distances.
    pub lower: Vec<f64>,
    /// Upper bounds of the signed distances.
    pub upper: Vec<f64>,
    /// Signed distances less what the pairs must keep.
    pub excesses: Vec<f64>,
    /// Witness points on the first bodies, in the world.
    pub points_a: Vec<[f64; 3]>,
    /// Witness points on the second bodies, in the world.
    pub points_b: Vec<[f64; 3]>,
    /// Unit vectors from the first body to the second, in the world.
    pub normals: Vec<[f64; 3]>,
    /// Derivatives of the signed distances: `components` numbers for each entry.
    pub gradients: Vec<f64>,
}

impl NearPairs {
    fn with_rows(rows: usize, columns: usize, components: usize) -> Result<Self, PlanError> {
        let entries = rows.saturating_mul(columns);
        let numbers = entries.saturating_mul(components);
        Ok(Self {
            columns,
            components,
            counts: filled(0, rows)?,
            pairs: filled(None, entries)?,
            distances: filled(f64::INFINITY, entries)?,
            lower: filled(f64::INFINITY, entries)?,
            upper: filled(f64::INFINITY, entries)?,
            excesses: filled(f64::INFINITY, entries)?,
            points_a: filled([0.0; 3], entries)?,
            points_b: filled([0.0; 3], entries)?,
            normals: filled([0.0; 3], entries)?,
            gradients: filled(0.0, numbers)?,
        })
    }

    /// Appends the rows of another batch of the same columns and components.
    fn append(&mut self, other: Self) {
        self.counts.extend(other.counts);
        self.pairs.extend(other.pairs);
        self.distances.extend(other.distances);
        self.lower.extend(other.lower);
        self.upper.extend(other.upper);
        self.excesses.extend(other.excesses);
        self.points_a.extend(other.points_a);
        self.points_b.extend(other.points_b);
        self.normals.extend(other.normals);
        self.gradients.extend(other.gradients);
    }
}

/// Returns a list of equal entries, or an error if it does not fit into memory.
fn filled<T: Clone>(entry: T, count: usize) -> Result<Vec<T>, PlanError> {
    let mut all = Vec::new();
    all.try_reserve_exact(count).map_err(|_| PlanError::Value {
        what: "number of entries of a batch",
        value: count as f64,
    })?;
    all.resize(count, entry);
    Ok(all)
}

impl<C: ConfigurationSpace + Clone + Sync> Checker<C> {
    /// Returns the closest pairs at many configurations: in each row those of
    /// [`nearest`](Self::nearest), at most `columns`.
    ///
    /// `configurations` holds one configuration after another. The rows are shared among `threads`
    /// threads, at least one, or fewer if the system cannot start them. Each row has the bits that a
    /// new checker returns, for any number of threads and any state of this checker.
    ///
    /// ```
    /// # use lin_canny::nalgebra::Isometry3;
    /// # use lin_canny::Shape;
    /// # use lin_canny_plan::{Checker, TranslationSpace, Cell};
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("drone", Shape::ball(0.1)?);
    /// # cell.add_obstacle("mast", Shape::ball(0.1)?, Isometry3::identity())?;
    /// # let space = TranslationSpace::new([[-4.0, 4.0]; 3], Default::default(), 1)?;
    /// # let checker = Checker::new(space, cell)?;
    /// let near = checker.nearest_batch(&[1.0, 0.0, 0.0, 0.0, -2.0, 0.0], 1, f64::INFINITY, 2)?;
    /// assert_eq!(near.distances, [0.8, 1.8]);
    /// assert_eq!(near.gradients, [1.0, 0.0, 0.0, 0.0, -1.0, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns the error of the first configuration that is invalid ([`PlanError::Row`]), and an
    /// error if the count of numbers is not a multiple of that of a configuration, if `slack` is negative
    /// or NaN, or if rows times columns do not fit into memory.
    pub fn nearest_batch(
        &self,
        configurations: &[f64],
        columns: usize,
        slack: f64,
        threads: usize,
    ) -> Result<NearPairs, PlanError> {
        let length = self.space.coordinates();
        if length == 0 || !configurations.len().is_multiple_of(length) {
            return Err(PlanError::Length {
                expected: length,
                found: configurations.len(),
            });
        }
        let rows = configurations.len() / length;
        let share = rows.div_ceil(threads.clamp(1, rows.max(1))).max(1);
        let parts: Vec<Result<NearPairs, PlanError>> = std::thread::scope(|scope| {
            let work = |(k, part): (usize, &'_ [f64])| self.near_rows(part, k * share, columns, slack);
            let mut parts = configurations.chunks(share * length).enumerate();
            let first = parts.next();
            let others: Vec<_> = parts
                .map(|part| {
                    let thread = std::thread::Builder::new().spawn_scoped(scope, move || work(part));
                    thread.map_err(|_| part)
                })
                .collect();
            let first = first.map(work);
            let joined = others.into_iter().map(|thread| match thread {
                // A thread that panics passes its panic on.
                Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
                // The system has no thread left: this one does the work.
                Err(part) => work(part),
            });
            first.into_iter().chain(joined).collect()
        });
        let mut all = NearPairs::with_rows(0, columns, self.space.degrees_of_freedom())?;
        for part in parts {
            all.append(part?);
        }
        Ok(all)
    }

    /// Returns the rows of some configurations; `first` is the number of the first row.
    fn near_rows(
        &self,
        configurations: &[f64],
        first: usize,
        columns: usize,
        slack: f64,
    ) -> Result<NearPairs, PlanError> {
        let mut checker = self.fork()?;
        let (length, components) = (self.space.coordinates(), self.space.degrees_of_freedom());
        let mut all = NearPairs::with_rows(configurations.len() / length, columns, components)?;
        for (row, q) in configurations.chunks(length).enumerate() {
            checker.reset();
            let near = checker.nearest(q, slack).map_err(|error| PlanError::Row {
                row: first + row,
                error: Box::new(error),
            })?;
            all.counts[row] = near.len().min(columns);
            for (near, k) in near.iter().take(columns).zip(row * columns..) {
                all.pairs[k] = Some(near.pair);
                (all.distances[k], all.lower[k], all.upper[k]) = (near.distance, near.lower, near.upper);
                all.excesses[k] = near.excess;
                [all.points_a[k], all.points_b[k]] = near.witnesses.map(|p| p.coords.into());
                all.normals[k] = near.normal.into();
                all.gradients[k * components..(k + 1) * components].copy_from_slice(&near.gradient);
            }
        }
        Ok(all)
    }
}
