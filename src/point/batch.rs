//! Many points: in an order in which neighbours follow each other, and on several threads.
//!
//! Each answer is a function of its point alone. So order and threads change no bit.

use alloc::vec::Vec;

use nalgebra::Point3;
#[cfg(feature = "parallel")]
use rayon::prelude::*;

use super::{PointError, PointMemory, PointQuery, check};
use crate::base::num::sort::arrange;
#[cfg(feature = "meshes")]
use crate::nonconvex::{mesh::Mesh, tree::morton};
use crate::pair::outcome::Distance;
use crate::pair::point::PointOutcome;

/// Number of points that are put in order at once.
const BLOCK: usize = 1 << 18;

/// Number of points per triangle from which a batch tests whether the surface meets itself.
///
/// The test takes 3.3 us a triangle, the side of a point near the surface without it 0.4 us more.
#[cfg(feature = "meshes")]
const PREPARED: usize = 16;

/// Number of points of one task.
#[cfg(feature = "parallel")]
const RUN: usize = 512;

impl PointQuery<'_> {
    /// Returns the closest point and the signed distance of each point, in the order given.
    ///
    /// The results are those of [`closest_point`](Self::closest_point). For meshes, compounds and
    /// clouds the points are visited in Morton order, so that neighbours follow each other. With
    /// the feature `parallel` the call uses several threads; the bits do not depend on their
    /// number.
    ///
    /// ```
    /// use lin_canny::nalgebra::Point3;
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Mesh, PointQuery};
    ///
    /// let ball = Mesh::from_convex(&solids::icosahedron(1.0)?)?;
    /// let line: Vec<_> = (0..100)
    ///     .map(|k| Point3::new(0.03 * f64::from(k), 0.0, 0.0))
    ///     .collect();
    /// let query = PointQuery::new(&ball);
    /// let found = query.closest_points(&line)?;
    /// assert!(found.iter().all(|f| f.lower <= f.distance));
    /// assert_eq!(query.contains_each(&line)?.iter().filter(|x| **x).count(), 29);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns an error with the index of the first point that is not finite or out of range.
    pub fn closest_points(&self, points: &[Point3<f64>]) -> Result<Vec<PointOutcome>, PointError> {
        self.each(points, |query, p, memory| query.ask(p, memory))
    }

    /// Returns the signed distance of each point with its bounds, in the order given.
    ///
    /// See [`closest_points`](Self::closest_points).
    ///
    /// # Errors
    ///
    /// Returns an error with the index of the first point that is not finite or out of range.
    pub fn signed_distances(&self, points: &[Point3<f64>]) -> Result<Vec<Distance>, PointError> {
        self.each(points, |query, p, memory| Distance::from(&query.ask(p, memory)))
    }

    /// Returns for each point whether the geometry contains it, in the order given.
    ///
    /// See [`contains`](Self::contains) and [`closest_points`](Self::closest_points).
    ///
    /// # Errors
    ///
    /// Returns an error with the index of the first point that is not finite or out of range.
    pub fn contains_each(&self, points: &[Point3<f64>]) -> Result<Vec<bool>, PointError> {
        check_all(points)?;
        // The side alone comes from the winding number, for which nothing is prepared.
        Ok(self.answers(points, |query, p, memory| query.holds(p, memory)))
    }

    /// Returns the winding number of each point, in the order given; `None` on the surface.
    ///
    /// See [`winding_number`](Self::winding_number) and [`closest_points`](Self::closest_points).
    ///
    /// # Errors
    ///
    /// Returns an error if the geometry is neither a polyhedron nor a closed mesh, or the index of
    /// the first point that is not finite or out of range.
    pub fn winding_numbers(&self, points: &[Point3<f64>]) -> Result<Vec<Option<i32>>, PointError> {
        check_all(points)?;
        self.check_winding()?;
        Ok(self.answers(points, |query, p, _| query.winding(p)))
    }

    /// Answers each point, in the order given.
    fn each<T: Send>(
        &self,
        points: &[Point3<f64>],
        answer: impl Fn(&Self, &Point3<f64>, &mut PointMemory) -> T + Sync,
    ) -> Result<Vec<T>, PointError> {
        check_all(points)?;
        let prepared = self.if_worth_preparing(points.len());
        Ok(prepared.as_ref().unwrap_or(self).answers(points, answer))
    }

    /// Answers each point that is in range, in the order given.
    pub(super) fn answers<T: Send>(
        &self,
        points: &[Point3<f64>],
        answer: impl Fn(&Self, &Point3<f64>, &mut PointMemory) -> T + Sync,
    ) -> Vec<T> {
        let mut all = Vec::with_capacity(points.len());
        for block in points.chunks(BLOCK) {
            let order = self.order(block);
            let run = |part: &[u32]| -> Vec<T> {
                let mut memory = PointMemory::default();
                part.iter()
                    .map(|&k| answer(self, &block[k as usize], &mut memory))
                    .collect()
            };
            #[cfg(feature = "parallel")]
            let mut found: Vec<T> = order.par_chunks(RUN).flat_map_iter(run).collect();
            #[cfg(not(feature = "parallel"))]
            let mut found = run(&order);
            let mut places = alloc::vec![0; order.len()];
            order.iter().enumerate().for_each(|(at, &k)| places[k as usize] = at);
            arrange(&mut found, &mut places);
            all.append(&mut found);
        }
        all
    }

    /// Returns the queries, [`prepared`](Self::prepared) if so many points are worth it.
    ///
    /// A batch does this for its own points. Use the method to pass many points in several batches.
    #[must_use]
    pub fn prepared_for(self, count: usize) -> Self {
        if self.is_worth_preparing(count) {
            self.prepared()
        } else {
            self
        }
    }

    /// Returns the prepared queries if so many points are worth it.
    pub(super) fn if_worth_preparing(&self, count: usize) -> Option<Self> {
        self.is_worth_preparing(count).then(|| self.clone().prepared())
    }

    /// Returns whether so many points are worth the work of [`prepared`](Self::prepared).
    #[cfg(feature = "meshes")]
    fn is_worth_preparing(&self, count: usize) -> bool {
        let is_many = |mesh: &Mesh| mesh.is_solid() && count / PREPARED >= mesh.triangle_count();
        self.surface.is_none() && self.geometry.mesh().is_some_and(is_many)
    }

    #[cfg(not(feature = "meshes"))]
    fn is_worth_preparing(&self, _: usize) -> bool {
        false
    }

    /// Returns an order of points in which neighbours follow each other.
    fn order(&self, points: &[Point3<f64>]) -> Vec<u32> {
        #[cfg(feature = "meshes")]
        if !self.geometry.kind().is_convex() {
            let places: Vec<[f64; 3]> = points.iter().map(|p| (*p).into()).collect();
            return morton::order(&places);
        }
        (0..points.len() as u32).collect()
    }
}

/// Returns an error for the first point that is out of range.
fn check_all(points: &[Point3<f64>]) -> Result<(), PointError> {
    (0..).zip(points).try_for_each(|(index, p)| check(index, p))
}
