//! Samples configurations within the limits of the joints.

use std::iter;
use std::ops::Range;
use std::sync::Arc;

use datafusion::arrow::array::{ArrayRef, Float64Array, Int64Array, RecordBatch};
use lin_canny_robot::Coordinate;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::StudyError;
use crate::input::ID;

/// A generator of configurations.
pub struct Sampler {
    coordinates: Vec<Coordinate>,
    primes: Vec<u64>,
    random: Option<ChaCha8Rng>,
}

impl Sampler {
    /// Returns the sequence of J. H. Halton, "On the efficiency of certain quasi-random sequences of points
    /// in evaluating multi-dimensional integrals" (1960), section 2: joint k uses the k-th prime as its base.
    ///
    /// It fills space more evenly than random numbers. With more than about ten joints, neighbouring primes
    /// are correlated for long, and random numbers are better.
    #[must_use]
    pub fn halton(coordinates: &[Coordinate]) -> Self {
        Self {
            primes: primes(coordinates.len()),
            coordinates: coordinates.to_vec(),
            random: None,
        }
    }

    /// Returns independent, uniform numbers. The same seed gives the same configurations on every machine.
    #[must_use]
    pub fn random(coordinates: &[Coordinate], seed: u64) -> Self {
        Self {
            random: Some(ChaCha8Rng::seed_from_u64(seed)),
            ..Self::halton(coordinates)
        }
    }

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
        let ids: ArrayRef = Arc::new(Int64Array::from_iter_values(ids.map(|id| id as i64)));
        let numbers = columns.into_iter().map(|c| Arc::new(Float64Array::from(c)) as ArrayRef);
        let names = self.coordinates.iter().map(|c| c.name.as_str());
        Ok(RecordBatch::try_from_iter(
            iter::once((ID, ids)).chain(names.zip(numbers)),
        )?)
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
