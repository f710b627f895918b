//! Samples configurations within the limits of the joints.

use std::ops::Range;
use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Float64Array, Int64Array, RecordBatch};
use datafusion::arrow::datatypes::{DataType, Field, Schema};
use lin_canny_robot::Coordinate;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::StudyError;
use crate::input::ID;

/// Sampling method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Source {
    /// The sequence of J. H. Halton, "On the efficiency of certain quasi-random sequences of points
    /// in evaluating multi-dimensional integrals" (1960), section 2: joint k uses the k-th prime as
    /// its base. It fills space more evenly than random numbers. With more than about ten joints,
    /// neighbouring primes are correlated for long, and random numbers are better.
    Halton,
    /// Independent, uniform numbers.
    Random {
        /// Random seed. The same seed gives the same configurations on every machine.
        seed: u64,
    },
}

/// A generator of configurations.
pub struct Sampler {
    coordinates: Vec<Coordinate>,
    primes: Vec<u64>,
    random: Option<ChaCha8Rng>,
}

impl Source {
    /// Returns the generator for joints, at its first configuration.
    #[must_use]
    pub fn begin(self, coordinates: &[Coordinate]) -> Sampler {
        Sampler {
            primes: primes(coordinates.len()),
            coordinates: coordinates.to_vec(),
            random: match self {
                Self::Halton => None,
                Self::Random { seed } => Some(ChaCha8Rng::seed_from_u64(seed)),
            },
        }
    }
}

impl Sampler {
    /// Returns rows with a column `id` and one column per joint.
    ///
    /// Random rows are always the next ones of the generator, for any ids.
    ///
    /// # Errors
    /// Returns an error if two joints have the same name.
    pub fn rows(&mut self, ids: Range<u64>) -> Result<RecordBatch, StudyError> {
        let count = (ids.end - ids.start) as usize;
        let mut columns = vec![Vec::with_capacity(count); self.coordinates.len()];
        for id in ids.clone() {
            for (k, column) in columns.iter_mut().enumerate() {
                let part = match &mut self.random {
                    Some(random) => random.random::<f64>(),
                    // The first point of the sequence is 1: the point 0 is the corner of all
                    // limits.
                    None => radical_inverse(self.primes[k], id + 1),
                };
                let [lower, upper] = self.coordinates[k].limits;
                // Rounding may pass the upper limit.
                column.push((lower + (upper - lower) * part).clamp(lower, upper));
            }
        }
        let number = |c: &Coordinate| Field::new(&c.name, DataType::Float64, false);
        let mut fields = vec![Field::new(ID, DataType::Int64, false)];
        fields.extend(self.coordinates.iter().map(number));
        let mut arrays: Vec<ArrayRef> = vec![Arc::new(Int64Array::from_iter_values(ids.map(|id| id as i64)))];
        arrays.extend(columns.into_iter().map(|c| Arc::new(Float64Array::from(c)) as ArrayRef));
        Ok(RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)?)
    }
}

/// Returns the radical inverse: the digits of a number, mirrored at the radix point.
fn radical_inverse(base: u64, mut number: u64) -> f64 {
    let (mut inverse, mut digit) = (0.0, 1.0 / base as f64);
    while number > 0 {
        inverse += digit * (number % base) as f64;
        digit /= base as f64;
        number /= base;
    }
    inverse
}

fn primes(count: usize) -> Vec<u64> {
    let mut primes: Vec<u64> = Vec::with_capacity(count);
    let mut number = 2;
    while primes.len() < count {
        if primes.iter().all(|p| number % p != 0) {
            primes.push(number);
        }
        number += 1;
    }
    primes
}
