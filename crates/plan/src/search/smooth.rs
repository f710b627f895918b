//! Smooth motions along paths of straight segments, within limits and proven free.
//!
//! # Method
//!
//! 1. A blend rounds each corner: a Bezier curve whose control points are on both segments and at
//!    the corner. It is as small as full speed allows, and takes at most 3/8 of a segment.
//! 2. A blend that is not proven free is halved, a bounded number of times. Then the motion stops
//!    at the corner, so it stays on the segments.
//! 3. The speed along each segment is a trapezoid within the limits of all coordinates.
//! 4. All pieces are cubic or quintic curves between rows of positions, velocities and
//!    accelerations, as controllers interpolate them. Each of these curves is proven free, and
//!    proven to keep all limits, the rounding of the rows included.
//!
//! Bobrow, Dubowsky and Gibson 1985 find the fastest motion along a path; this is a simple one.

use core::ops::ControlFlow;
use std::vec::Vec;

use lin_canny::{EXTENT_MAX, Progress};

use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::curve::JointCurve;
use crate::motion::joint_motion::JointMotion;
use crate::motion::space::ConfigurationSpace;
use crate::search::shorten::Path;
use crate::search::speeds::{Corner, Leg, Limits, Piece, RESERVE, Rows};

/// Steps that are shorter than this, in units of the greatest coordinate, are left out: they are
/// rounding.
const NO_STEP: f64 = 64.0 * f64::EPSILON;

/// Number of rounds in which blends are proven again after their rows were rounded. After them, the
/// motion stops at all corners.
const ROUNDS: u32 = 4;

/// Number of times that a motion is slowed down by half to keep limits in spite of rounding.
const HALVINGS: u32 = 64;

/// Factor by which limits shrink, more than products round.
const LESS: f64 = 1.0 - 8.0 * f64::EPSILON;

/// Greatest limit; its inverse is the least.
const LIMIT_MAX: f64 = EXTENT_MAX * EXTENT_MAX;

/// Limits and shape of a smooth motion: see [`Smoother`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SmoothOptions {
    /// Greatest absolute velocity of each coordinate. Infinity is no limit.
    pub velocity: Vec<f64>,
    /// Greatest absolute acceleration of each coordinate.
    pub acceleration: Vec<f64>,
    /// Whether accelerations are continuous as well (default false).
    pub continuous_acceleration: bool,
    /// Greatest distance of the motion from a corner of the path, in any coordinate (default
    /// infinity). With 0 the motion follows the path, and stops at each corner.
    pub deviation: f64,
    /// Number of times that a blend which is not proven free is halved (default 8).
    pub halvings: u32,
}

impl SmoothOptions {
    /// Returns the options with these limits of velocity and acceleration, one of each coordinate.
    #[must_use]
    pub fn new(velocity: impl Into<Vec<f64>>, acceleration: impl Into<Vec<f64>>) -> Self {
        Self {
            velocity: velocity.into(),
            acceleration: acceleration.into(),
            continuous_acceleration: false,
            deviation: f64::INFINITY,
            halvings: 8,
        }
    }

    /// Sets the limits of velocity, one of each coordinate.
    #[must_use]
    pub fn velocity(mut self, velocity: impl Into<Vec<f64>>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets the limits of acceleration, one of each coordinate.
    #[must_use]
    pub fn acceleration(mut self, acceleration: impl Into<Vec<f64>>) -> Self {
        self.acceleration = acceleration.into();
        self
    }

    /// Sets whether accelerations are continuous.
    #[must_use]
    pub const fn continuous_acceleration(mut self, is_continuous: bool) -> Self {
        self.continuous_acceleration = is_continuous;
        self
    }

    /// Sets the greatest distance from a corner, in any coordinate.
    #[must_use]
    pub const fn deviation(mut self, deviation: f64) -> Self {
        self.deviation = deviation;
        self
    }

    /// Sets the number of times that a blend is halved.
    #[must_use]
    pub const fn halvings(mut self, halvings: u32) -> Self {
        self.halvings = halvings;
        self
    }

    fn check(&self, coordinates: usize) -> Result<(), PlanError> {
        for (what, limits, most) in [
            ("velocity", &self.velocity, f64::INFINITY),
            ("acceleration", &self.acceleration, LIMIT_MAX),
        ] {
            let (expected, found) = (coordinates, limits.len());
            if found != expected {
                return Err(PlanError::Length { expected, found });
            }
            let is_limit = |x: &f64| *x >= 1.0 / LIMIT_MAX && *x <= most;
            if let Some(coordinate) = limits.iter().position(|x| !is_limit(x)) {
                let value = limits[coordinate];
                return Err(PlanError::Limit {
                    what,
                    coordinate,
                    value,
                });
            }
        }
        if !(self.deviation >= 0.0) {
            let (what, value) = ("deviation", self.deviation);
            return Err(PlanError::Value { what, value });
        }
        Ok(())
    }
}

/// A motion from rest to rest along a path, as rows and as curves.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SmoothPath {
    /// The time of each row, from 0.
    pub times: Vec<f64>,
    /// The configuration of each row. Angles do not jump by full turns.
    pub positions: Path,
    /// The velocity of each row.
    pub velocities: Vec<Vec<f64>>,
    /// The acceleration of each row; empty unless accelerations are continuous.
    pub accelerations: Vec<Vec<f64>>,
    /// The curve from each row to the next: cubic, or quintic if there are accelerations.
    pub curves: Vec<JointCurve>,
    /// Indices of the inner configurations of the path at which the motion stops.
    pub stops: Vec<usize>,
}

impl SmoothPath {
    /// Returns the time from the start to the end.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or_default()
    }
}

/// Makes smooth motions along paths.
pub struct Smoother<'a> {
    options: SmoothOptions,
    progress: Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>,
}

impl<'a> Smoother<'a> {
    /// Returns a smoother with these options.
    #[must_use]
    pub fn new(options: &SmoothOptions) -> Self {
        Self {
            options: options.clone(),
            progress: None,
        }
    }

    /// Sets the progress callback, which is called before each blend and each piece.
    #[must_use]
    pub fn progress(mut self, progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Returns a smooth motion along a path, from rest to rest, proven free and within limits.
    ///
    /// Corners are rounded; velocities are continuous, and accelerations by choice. Speeds rise and
    /// fall as trapezoids. A corner whose blend is not proven free gets a smaller one. After
    /// [`halvings`](SmoothOptions::halvings) the motion stops there, without leaving the path. The
    /// motion is not the fastest one.
    ///
    /// Units of time are those of the limits. Every curve is proven free as it is returned, and
    /// proven to keep the limits. A path without length is one row and no curve. Steps of the path
    /// that are mere rounding are left out.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// use lin_canny_plan::{Checker, Joint, JointMotion, JointTree, SmoothOptions, Smoother, Cell};
    ///
    /// // A block on two rails, x and y, goes around a post.
    /// let origin = Isometry3::identity();
    /// let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// let block = JointTree::serial(origin, rails, vec![2], 0.1)?;
    /// let mut cell = Cell::new();
    /// cell.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// let post = solids::cuboid(Vector3::repeat(0.5))?;
    /// cell.add_obstacle("post", post, origin)?;
    /// let mut checker = Checker::new(block, cell)?;
    ///
    /// let path = [[-1.0, 0.0], [-1.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    /// let path = path.map(Vec::from);
    /// let options = SmoothOptions::new([1.0, 1.0], [4.0, 4.0]);
    /// let smooth = Smoother::new(&options).smooth(&mut checker, &path)?;
    /// assert!(smooth.stops.is_empty());
    /// // The path has the length 4, so it takes 4 s at full speed.
    /// assert!(smooth.duration() > 4.0 && smooth.duration() < 4.5);
    /// assert!(checker.certify(&JointMotion::spline(&smooth.curves)?)?.is_free());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error in these cases:
    ///
    /// - The path is empty, or a configuration is invalid.
    /// - A limit is not positive ([`PlanError::Limit`]).
    /// - A segment is not proven free ([`PlanError::Unproven`]).
    /// - A coordinate belongs to a rotation in space ([`PlanError::CurveDegree`]).
    /// - The callback stops the call ([`PlanError::Stopped`]).
    pub fn smooth<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        path: &[Vec<f64>],
    ) -> Result<SmoothPath, PlanError> {
        let mut unwatched = |_| ControlFlow::Continue(());
        let progress = self.progress.unwrap_or(&mut unwatched);
        let found = checker.smoothed(path, &self.options, progress)?;
        found.ok_or(PlanError::Stopped)
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns a smooth motion; `None` if the callback stops the call.
    fn smoothed(
        &mut self,
        path: &[Vec<f64>],
        options: &SmoothOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<SmoothPath>, PlanError> {
        let mut limits = self.limits(options)?;
        let (mut points, indices) = self.distinct_points(path)?;
        limits.lower_velocities(&points);
        let legs: Vec<Leg> = points
            .windows(2)
            .zip(&indices[1..])
            .map(|(ends, index)| Leg::new(index - 1, ends[0].clone(), ends[1].clone(), &limits))
            .collect();
        if legs.is_empty() {
            return self.still(points.swap_remove(0), options).map(Some);
        }
        limits.set_shortest(&legs);
        let Some(mut corners) = self.blends(&legs, &limits, options, progress)? else {
            return Ok(None);
        };
        let mut round = 0;
        loop {
            let Some((motion, failed)) = self.pieces(&legs, &corners, &limits, options, progress)? else {
                return Ok(None);
            };
            if failed.is_empty() {
                let stops = (1..legs.len()).filter(|k| corners[*k].reach == 0.0);
                let stops = stops.map(|k| indices[k]).collect();
                return Ok(Some(SmoothPath { stops, ..motion }));
            }
            // The rounded rows may be in contact where the blend is not.
            round += 1;
            for (k, corner) in corners.iter_mut().enumerate() {
                if round == ROUNDS || failed.contains(&k) {
                    *corner = Corner::STOP;
                }
            }
        }
    }

    /// Returns the motion along a path without length.
    fn still(&mut self, q: Vec<f64>, options: &SmoothOptions) -> Result<SmoothPath, PlanError> {
        if !self.is_segment_free(&q, &q)? {
            return Err(PlanError::Unproven { segment: 0 });
        }
        let zeros = std::vec![0.0; q.len()];
        let accelerations = match options.continuous_acceleration {
            false => Vec::new(),
            true => std::vec![zeros.clone()],
        };
        Ok(SmoothPath {
            times: std::vec![0.0],
            positions: std::vec![q],
            velocities: std::vec![zeros],
            accelerations,
            curves: Vec::new(),
            stops: Vec::new(),
        })
    }

    /// Returns the limits, less what is left for rounding.
    fn limits(&self, options: &SmoothOptions) -> Result<Limits, PlanError> {
        let coordinates = self.space.coordinates();
        options.check(coordinates)?;
        if coordinates != self.space.degrees_of_freedom() {
            let (coordinate, degree) = (self.space.bounds().len(), 2);
            return Err(PlanError::CurveDegree { coordinate, degree });
        }
        let less = |limits: &[f64]| limits.iter().map(|x| x * (1.0 - RESERVE)).collect();
        Ok(Limits {
            velocity: less(&options.velocity),
            acceleration: less(&options.acceleration),
            peak: if options.continuous_acceleration { 1.5 } else { 1.0 },
            shortest: 0.0,
        })
    }

    /// Returns the configurations of a path without repetitions and without jumps by full turns,
    /// and the index of each.
    fn distinct_points(&self, path: &[Vec<f64>]) -> Result<(Path, Vec<usize>), PlanError> {
        let first = path.first().ok_or(PlanError::Empty)?;
        for q in path {
            self.space.check(q)?;
        }
        let mut shift = std::vec![0.0; first.len()];
        let (mut points, mut indices): (Path, _) = (std::vec![first.clone()], std::vec![0]);
        let mut largest = first.iter().fold(0.0, |most: f64, x| most.larger(x.abs()));
        for (k, ends) in path.windows(2).enumerate() {
            let step = self.space.difference(&ends[0], &ends[1]);
            for (shift, ((x, y), step)) in shift.iter_mut().zip(ends[0].iter().zip(&ends[1]).zip(&step)) {
                *shift += step - (y - x);
            }
            let point: Vec<f64> = ends[1].iter().zip(&shift).map(|(x, shift)| x + shift).collect();
            largest = point.iter().fold(largest, |most, x| most.larger(x.abs()));
            points.push(point);
            indices.push(k + 1);
        }
        let least = (NO_STEP * largest).larger(f64::MIN_POSITIVE);
        let is_step = |p: &[f64], q: &[f64]| p.iter().zip(q).any(|(x, y)| (x - y).abs() > least);
        let mut kept: Path = Vec::new();
        let mut of_kept: Vec<usize> = Vec::new();
        let last = points.len() - 1;
        for (point, index) in points.into_iter().zip(indices) {
            if index == last {
                // The end is exact, so it takes the place of points that are the same.
                while kept.len() > 1 && kept.last().is_some_and(|p| !is_step(p, &point)) {
                    kept.pop();
                    of_kept.pop();
                }
            }
            if kept.last().is_none_or(|p| is_step(p, &point)) {
                kept.push(point);
                of_kept.push(index);
            }
        }
        Ok((kept, of_kept))
    }

    /// Returns the corners of the legs, each with a blend that is proven free, or a stop.
    fn blends(
        &mut self,
        legs: &[Leg],
        limits: &Limits,
        options: &SmoothOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<Vec<Corner>>, PlanError> {
        let mut corners = std::vec![Corner::STOP; legs.len() + 1];
        for k in 1..legs.len() {
            if progress(Progress::new("blends", k - 1, Some(legs.len() - 1))).is_break() {
                return Ok(None);
            }
            let pair = [&legs[k - 1], &legs[k]];
            let mut corner = Corner::new(pair, limits, options.deviation);
            for _ in 0..=options.halvings {
                if !(corner.reach > 0.0) || self.is_curve_free(&blend(pair, corner.reach, options)?)? {
                    corners[k] = corner;
                    break;
                }
                corner.reach *= 0.5;
            }
        }
        Ok(Some(corners))
    }

    fn is_curve_free(&mut self, curve: &JointCurve) -> Result<bool, PlanError> {
        self.is_free(&JointMotion::curve(curve))
    }

    /// Returns the motion with these corners, and the corners whose blends are not proven free.
    fn pieces(
        &mut self,
        legs: &[Leg],
        corners: &[Corner],
        limits: &Limits,
        options: &SmoothOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<(SmoothPath, Vec<usize>)>, PlanError> {
        let mut rows = Rows::new(legs, corners, limits);
        let mut curves = curves(&rows, options)?;
        let mut halved = 0;
        while let Some((what, coordinate)) = exceeded(&curves, &rows.times, options) {
            if halved == HALVINGS {
                let value = match what {
                    "velocity" => options.velocity[coordinate],
                    _ => options.acceleration[coordinate],
                };
                return Err(PlanError::Limit {
                    what,
                    coordinate,
                    value,
                });
            }
            halved += 1;
            rows.slow_down();
            curves = self::curves(&rows, options)?;
        }
        let mut failed = Vec::new();
        for (k, (curve, piece)) in curves.iter().zip(&rows.pieces).enumerate() {
            if progress(Progress::new("pieces", k, Some(curves.len()))).is_break() {
                return Ok(None);
            }
            if self.is_curve_free(curve)? {
                continue;
            }
            match *piece {
                Piece::Blend(corner) => failed.push(corner),
                Piece::Leg(leg) => {
                    let segment = legs[leg].segment;
                    return Err(PlanError::Unproven { segment });
                }
            }
        }
        let motion = SmoothPath {
            accelerations: accelerations(&rows, options),
            times: rows.times,
            positions: rows.positions,
            velocities: rows.velocities,
            curves,
            stops: Vec::new(),
        };
        Ok(Some((motion, failed)))
    }
}

/// Returns the accelerations of the rows: velocities start and end to change without a jump.
fn accelerations(rows: &Rows, options: &SmoothOptions) -> Vec<Vec<f64>> {
    match options.continuous_acceleration {
        false => Vec::new(),
        true => rows.velocities.iter().map(|v| std::vec![0.0; v.len()]).collect(),
    }
}

/// Returns the curve from each row to the next.
fn curves(rows: &Rows, options: &SmoothOptions) -> Result<Vec<JointCurve>, PlanError> {
    let accelerations = accelerations(rows, options);
    let each = (0..rows.pieces.len()).map(|k| {
        let duration = rows.times[k + 1] - rows.times[k];
        let [q, v] = [&rows.positions, &rows.velocities].map(|of| [&of[k], &of[k + 1]]);
        match accelerations.get(k..k + 2) {
            None => JointCurve::cubic(q[0], q[1], v[0], v[1], duration),
            Some(a) => JointCurve::quintic(q, v, [&a[0], &a[1]], duration),
        }
    });
    each.collect()
}

/// Returns a limit that is not proven to be kept, and its coordinate.
fn exceeded(curves: &[JointCurve], times: &[f64], options: &SmoothOptions) -> Option<(&'static str, usize)> {
    let mut each = curves.iter().zip(times.windows(2));
    each.find_map(|(curve, times)| {
        let duration = times[1] - times[0];
        let mut each = options.velocity.iter().zip(&options.acceleration).enumerate();
        each.find_map(|(c, (velocity, acceleration))| {
            let most = [velocity * duration, acceleration * duration * duration];
            let mut each = ["velocity", "acceleration"].into_iter().zip(most).zip(1..);
            let broken = each.find(|((_, most), order)| !curve.keeps(c, *order, most * LESS));
            broken.map(|((what, _), _)| (what, c))
        })
    })
}

/// Returns the curve of a blend between two legs.
fn blend([one, other]: [&Leg; 2], reach: f64, options: &SmoothOptions) -> Result<JointCurve, PlanError> {
    let at = |part: f64| [one.at(one.length - part * reach), other.at(part * reach)];
    let [from, to] = at(1.0);
    match options.continuous_acceleration {
        false => JointCurve::bezier(&[&from, &one.to, &to]),
        true => {
            let [near, far] = at(0.5);
            JointCurve::bezier(&[&from, &near, &one.to, &far, &to])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use crate::motion::joint::Joint;
    use crate::motion::tree::JointTree;
    use lin_canny::polyhedron::solids;
    use nalgebra::{Isometry3, Vector3};

    /// A block on two rails, far from a post.
    fn block() -> Checker<JointTree> {
        let origin = Isometry3::identity();
        let rail = |axis| Joint::prismatic(origin, axis, [-9.0, 9.0]);
        let rails = std::vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
        let arm = JointTree::serial(origin, rails, std::vec![2], 0.1).expect("an arm");
        let cube = |half: f64| solids::cuboid(Vector3::repeat(half)).expect("a box");
        let mut cell = Cell::new();
        cell.robot_body("block", cube(0.1));
        cell.add_obstacle("post", cube(0.1), Isometry3::translation(5.0, 5.0, 0.0))
            .expect("an obstacle");
        Checker::new(arm, cell).expect("a cell")
    }

    /// Legs and corners that are planned for limits which are larger than those of the options.
    fn planned(checker: &Checker<JointTree>, faster: f64) -> (Vec<Leg>, Vec<Corner>, Limits) {
        let lax = SmoothOptions::new([faster; 2], [4.0 * faster; 2]);
        let mut limits = checker.limits(&lax).expect("limits");
        let path = [[-1.0, 0.0], [0.0, 1.0], [1.0, 0.5]].map(Vec::from);
        let legs: Vec<Leg> = (0..2)
            .map(|k| Leg::new(k, path[k].clone(), path[k + 1].clone(), &limits))
            .collect();
        limits.set_shortest(&legs);
        let middle = Corner::new([&legs[0], &legs[1]], &limits, f64::INFINITY);
        (legs, std::vec![Corner::STOP, middle, Corner::STOP], limits)
    }

    #[test]
    fn a_motion_that_is_too_fast_is_slowed_down_on_the_same_curve() {
        for is_smooth in [false, true] {
            let options = SmoothOptions::new([1.0; 2], [4.0; 2]).continuous_acceleration(is_smooth);
            for (faster, halvings) in [(0.5, 0), (1.5, 1), (3.5, 2), (100.0, 7)] {
                let mut checker = block();
                let (legs, corners, limits) = planned(&checker, faster);
                let mut rows = Rows::new(&legs, &corners, &limits);
                let before = curves(&rows, &options).expect("curves");
                let mut count = 0;
                while exceeded(&curves(&rows, &options).expect("curves"), &rows.times, &options).is_some() {
                    rows.slow_down();
                    count += 1;
                }
                // Twice the time is a half of the velocities and a quarter of the accelerations.
                assert!(count <= halvings && (count > 0) == (halvings > 0), "{faster}: {count}");
                if !is_smooth {
                    // The product of velocity and duration does not change, so the curves have the
                    // same bits.
                    assert_eq!(curves(&rows, &options).expect("curves"), before);
                }
                let go = &mut |_| ControlFlow::Continue(());
                let found = checker
                    .pieces(&legs, &corners, &limits, &options, go)
                    .expect("a motion");
                let (motion, failed) = found.expect("not stopped");
                assert!(failed.is_empty());
                assert_eq!((&motion.times, &motion.velocities), (&rows.times, &rows.velocities));
                assert_eq!(exceeded(&motion.curves, &motion.times, &options), None);
            }
        }
    }

    #[test]
    fn a_limit_that_no_motion_keeps_is_an_error() {
        let mut checker = block();
        let (legs, corners, limits) = planned(&checker, 1.0);
        let options = SmoothOptions::new([1.0, 1e-30], [4.0; 2]);
        let go = &mut |_| ControlFlow::Continue(());
        let found = checker.pieces(&legs, &corners, &limits, &options, go);
        let (what, coordinate, value) = ("velocity", 1, 1e-30);
        let expected = PlanError::Limit {
            what,
            coordinate,
            value,
        };
        assert_eq!(found.map(|_| ()), Err(expected));
    }
}
