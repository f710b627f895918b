//! The study: a robot, its cell, and a pool of checkers.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use lin_canny_plan::{Cell, Checker, Coordinate, JointTree};

use crate::error::StudyError;

/// Options of a study.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct StudyOptions {
    /// Required distance of all pairs for `is_free` and `certify`, in the robot's unit of length;
    /// `None` takes that of the cell, or else 0.
    pub margin: Option<f64>,
    /// Distance within which `certify` accepts a contact at the start of a segment
    /// ([`Checker::set_start_contact_margin`]); `None` accepts no contact.
    pub start_contact_margin: Option<f64>,
    /// Whether an invalid row gives NULL instead of an error.
    pub lenient: bool,
}

impl StudyOptions {
    /// Returns the options with another minimum distance.
    #[must_use]
    pub const fn margin(mut self, margin: f64) -> Self {
        self.margin = Some(margin);
        self
    }

    /// Returns the options that accept contacts at the start of a segment, or no contact.
    #[must_use]
    pub const fn start_contact_margin(mut self, margin: Option<f64>) -> Self {
        self.start_contact_margin = margin;
        self
    }

    /// Returns the options with NULL, or with an error, for an invalid row.
    #[must_use]
    pub const fn lenient(mut self, lenient: bool) -> Self {
        self.lenient = lenient;
        self
    }
}

/// A robot in its cell, loaded once per process, with a pool of checkers.
///
/// A batch of rows takes a checker from the pool and returns it. Before each row the checker drops
/// all cached state ([`Checker::reset`]), so the result depends on the row alone, bit for bit.
pub struct Study {
    options: StudyOptions,
    fingerprint: String,
    /// The checker whose forks answer.
    first: Checker<JointTree>,
    pool: Mutex<Vec<Checker<JointTree>>>,
    rows: AtomicU64,
}

impl Study {
    /// Returns the study of a robot and a cell.
    ///
    /// # Errors
    /// Returns an error if no checker can be made, or if a margin is negative or not finite.
    pub fn new(cell: Cell, options: StudyOptions) -> Result<Arc<Self>, StudyError> {
        let mut first = Checker::of_robots(cell)?;
        if let Some(margin) = options.margin {
            first.cell_mut().set_margin(margin)?;
        }
        first.set_start_contact_margin(options.start_contact_margin)?;
        Ok(Arc::new(Self {
            fingerprint: fingerprint(&first, options)?,
            options,
            first,
            pool: Mutex::default(),
            rows: AtomicU64::new(0),
        }))
    }

    /// Returns the coordinates of a configuration: the arguments of the functions, in order.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        self.first.cell().coordinates()
    }

    /// Returns the cell of every checker.
    #[must_use]
    pub fn cell(&self) -> &Cell {
        self.first.cell()
    }

    /// Returns the options.
    #[must_use]
    pub fn options(&self) -> StudyOptions {
        self.options
    }

    /// Returns the fingerprint of robot, cell and options: sixteen hexadecimal digits.
    ///
    /// Two studies with the same fingerprint return the same result for every row.
    #[must_use]
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Returns the number of rows measured in this process so far.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows.load(Ordering::Relaxed)
    }

    /// Calls a function with a checker from the pool, which is made if the pool is empty.
    ///
    /// # Errors
    /// Returns an error if no checker can be made.
    pub fn with_checker<R>(&self, ask: impl FnOnce(&mut Checker<JointTree>) -> R) -> Result<R, StudyError> {
        let waiting = self.pool.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut checker = match waiting {
            Some(checker) => checker,
            None => self.first.fork()?,
        };
        let answer = ask(&mut checker);
        self.pool.lock().unwrap_or_else(PoisonError::into_inner).push(checker);
        Ok(answer)
    }

    pub(crate) fn count(&self, rows: usize) {
        self.rows.fetch_add(rows as u64, Ordering::Relaxed);
    }
}

/// Version of fingerprints and of their inputs.
const FORMAT: &str = "lin-canny-study 4";

fn fingerprint(checker: &Checker<JointTree>, options: StudyOptions) -> Result<String, StudyError> {
    let mut hasher = blake3::Hasher::new();
    // The margin is in the cell.
    let options = StudyOptions {
        margin: None,
        ..options
    };
    // `Debug` writes every digit of a number.
    let space = format!("{FORMAT} {options:?} {:?}", checker.space());
    // No text contains this byte.
    hasher.update(space.as_bytes()).update(&[0xff]);
    // The whole cell: robots, bodies, frames, excluded pairs, margins and paddings.
    serde_json::to_writer(&mut hasher, checker.cell())?;
    Ok(hasher.finalize().to_hex()[..16].to_owned())
}
