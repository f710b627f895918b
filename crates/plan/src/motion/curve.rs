//! Polynomial curves of the coordinates, as Bezier curves over the times 0 to 1.
//!
//! # Bounds
//!
//! A Bezier curve lies in the hull of its control points, and its derivatives are Bezier curves
//! whose control points are differences of those of the curve, the *hodographs*. De Casteljau's
//! algorithm returns the control points of a part of the curve. So the greatest absolute control
//! point of a part of a hodograph bounds the derivative on that part. Farin 2002, "Curves and
//! Surfaces for CAGD", chapters 4 and 5.
//!
//! Rounding errors grow with the degree: see `ARM_VALUE`, `CURVE_PART` and `CURVE_DIFFERENCE`.

use std::vec::Vec;

use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::tolerance::{ARM_VALUE, CONVERTED, CURVE_DIFFERENCE, CURVE_PART, STRAIGHT, STRAIGHT_ERROR};
use lin_canny::EXTENT_MAX;

/// Maximum degree of a curve.
pub(crate) const DEGREE_MAX: usize = 16;

/// Maximum number of halvings of a curve in the search of a value outside limits. Half a unit in
/// the last place of the time remains.
const HALVINGS: u32 = 53;

/// Number of nested parts of a span over which derivatives are bounded: all of it, its first half
/// and its first quarter. They save up to 37 % of the queries at degree 7.
pub(crate) const PARTS: usize = 3;

/// Control points of one coordinate, or of one of its hodographs.
type Row = [f64; DEGREE_MAX + 1];

/// A polynomial curve of all coordinates of a configuration, over the times 0 to 1.
///
/// The curve is a Bezier curve of any degree from 1 to 16. At time 0 it is at its first control
/// point, at time 1 at its last. A straight segment is a curve of degree 1. Splines are lists of
/// curves, each of which starts where the one before it ends.
///
/// Curves that are given in another form are converted. The conversion rounds, and the error is
/// part of the curve: [`Checker::certify`](crate::Checker::certify) then proves the
/// curve that was given.
///
/// ```
/// use lin_canny_plan::JointCurve;
///
/// // From rest to rest: the first two control points are equal, and the last two.
/// let points = [[0.0, 1.0], [0.0, 1.0], [1.0, 3.0], [1.0, 3.0]];
/// let curve = JointCurve::bezier(&points)?;
/// assert_eq!(curve.at(0.5), [0.5, 2.0]);
/// assert_eq!(curve.velocity(0.0), [0.0, 0.0]);
/// let same = JointCurve::cubic(points[0], points[3], [0.0; 2], [0.0; 2], 1.0)?;
/// assert_eq!(same.at(0.25), curve.at(0.25));
/// # Ok::<(), lin_canny_plan::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "StoredCurve", try_from = "StoredCurve"))]
pub struct JointCurve {
    coordinates: usize,
    degree: usize,
    /// For each coordinate the control points, and those of the first three hodographs.
    points: Vec<f64>,
    bounds: Vec<RowBounds>,
    /// Times on the clock of the start and the end.
    times: Option<[f64; 2]>,
}

/// Bounds of one coordinate over the whole curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RowBounds {
    /// Least and greatest control point.
    pub(crate) hull: [f64; 2],
    /// Greatest absolute control point of the curve and of the first three hodographs.
    pub(crate) most: [f64; 4],
    /// Upper bound of the distance of the curve that was given from these control points.
    pub(crate) error: f64,
}

/// A coordinate of a curve at a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveState {
    /// Value and first two derivatives.
    pub(crate) values: [f64; 3],
    /// For each nested part of the span, upper bounds of the first three derivatives.
    pub(crate) bounds: [[f64; 3]; PARTS],
}

/// Makes one round after the other of de Casteljau's algorithm in place: leaves the control points
/// of the part from `t` on, so the first is the value at `t`.
#[inline(always)]
fn later(row: &mut [f64], t: f64) {
    for last in (1..row.len()).rev() {
        for k in 0..last {
            row[k] += (row[k + 1] - row[k]) * t;
        }
    }
}

/// Leaves the control points of the part up to `t`.
#[inline(always)]
fn earlier(row: &mut [f64], t: f64) {
    for first in 1..row.len() {
        for k in (first..row.len()).rev() {
            row[k] = row[k - 1] + (row[k] - row[k - 1]) * t;
        }
    }
}

#[inline(always)]
fn value_at(row: &mut [f64], time: f64) -> f64 {
    later(row, time);
    row[0]
}

/// Returns the value at a time, and the greatest absolute control points of the part behind it, of
/// its first half and of its first quarter. The part is a fraction of what is left.
#[inline(always)]
fn part_of(row: &mut [f64], [time, part]: [f64; 2], used: usize) -> (f64, [f64; PARTS]) {
    let last = row[row.len() - 1];
    if time > 0.0 {
        later(row, time);
    }
    // The end is the last control point, without rounding.
    let value = if time == 1.0 { last } else { row[0] };
    if part < 1.0 {
        earlier(row, part);
    }
    let mut all = [most(row); PARTS];
    for bound in &mut all[1..used] {
        earlier(row, 0.5);
        *bound = most(row);
    }
    (value, all)
}

#[inline(always)]
fn most(row: &[f64]) -> f64 {
    row.iter().fold(0.0, |most, x| most.larger(x.abs()))
}

/// Constructors.
impl JointCurve {
    /// Returns the Bezier curve of these control points, each a configuration.
    ///
    /// One control point is a curve that stays there.
    ///
    /// # Errors
    /// Returns an error if there is no control point or more than 17, if they have different
    /// lengths, or if a number is out of range.
    pub fn bezier<P: AsRef<[f64]>>(points: &[P]) -> Result<Self, PlanError> {
        let first = points.first().ok_or(PlanError::Empty)?.as_ref();
        if points.len() > DEGREE_MAX + 1 {
            let (what, value) = ("degree of a curve", (points.len() - 1) as f64);
            return Err(PlanError::Value { what, value });
        }
        let coordinates = first.len();
        for point in points {
            let point = point.as_ref();
            if point.len() != coordinates {
                return Err(PlanError::Length {
                    expected: coordinates,
                    found: point.len(),
                });
            }
            if let Some(&value) = point.iter().find(|x| !(x.abs() <= EXTENT_MAX)) {
                let what = "coordinate of a control point";
                return Err(PlanError::Value { what, value });
            }
        }
        let degree = (points.len() - 1).max(1);
        let last = points.len() - 1;
        Ok(Self::of_rows(coordinates, degree, |c, j| {
            points[j.min(last)].as_ref()[c]
        }))
    }

    /// Returns the straight segment between two configurations of equal length.
    pub(crate) fn straight(from: &[f64], to: &[f64]) -> Self {
        Self::of_rows(from.len(), 1, |c, j| if j == 0 { from[c] } else { to[c] })
    }

    /// Returns the curve of control points, given by coordinate and number.
    fn of_rows(coordinates: usize, degree: usize, point: impl Fn(usize, usize) -> f64) -> Self {
        let mut points = Vec::with_capacity(coordinates * row_length(degree));
        let mut bounds = Vec::with_capacity(coordinates);
        for c in 0..coordinates {
            let mut row: Row = [0.0; DEGREE_MAX + 1];
            let mut of = RowBounds {
                hull: [f64::INFINITY, f64::NEG_INFINITY],
                most: [0.0; 4],
                error: 0.0,
            };
            for (j, x) in row.iter_mut().enumerate().take(degree + 1) {
                *x = point(c, j);
                of.hull = [of.hull[0].smaller(*x), of.hull[1].larger(*x)];
            }
            for order in 0..4.min(degree + 1) {
                let count = degree + 1 - order;
                points.extend(&row[..count]);
                of.most[order] = most(&row[..count]);
                for k in 0..count - 1 {
                    row[k] = (count - 1) as f64 * (row[k + 1] - row[k]);
                }
            }
            bounds.push(of);
        }
        Self {
            coordinates,
            degree,
            points,
            bounds,
            times: None,
        }
    }

    /// Returns the curve with times on a clock of its start and its end.
    ///
    /// They matter only among moving obstacles
    /// ([`Cell::add_moving_obstacle`](crate::Cell::add_moving_obstacle)).
    /// The times 0 to 1 of the curve, and of verdicts about it, stay.
    ///
    /// # Errors
    /// Returns an error if a time is not finite, or if the end is not after the start.
    pub fn with_times(self, times: [f64; 2]) -> Result<Self, PlanError> {
        let what = "time of a curve";
        if let Some(&value) = times.iter().find(|t| !(t.abs() <= EXTENT_MAX)) {
            return Err(PlanError::Value { what, value });
        }
        match times[1] > times[0] {
            true => Ok(Self {
                times: Some(times),
                ..self
            }),
            false => Err(PlanError::Value { what, value: times[1] }),
        }
    }

    /// Returns the curve of converted control points. Each is `terms` roundings of the sum of the
    /// absolute values of its terms off; `size` returns this sum for each coordinate.
    fn converted<P: AsRef<[f64]>>(points: &[P], terms: f64, size: impl Fn(usize) -> f64) -> Result<Self, PlanError> {
        let mut curve = Self::bezier(points)?;
        for (c, bounds) in curve.bounds.iter_mut().enumerate() {
            let size = size(c);
            if !(size <= EXTENT_MAX) {
                let (what, value) = ("term of a curve", size);
                return Err(PlanError::Value { what, value });
            }
            bounds.error = CONVERTED * terms * size;
        }
        Ok(curve)
    }

    /// Returns the curve of these control points, each coordinate of which deviates from the curve
    /// that was given by at most its error.
    #[cfg(feature = "serde")]
    pub(crate) fn with_errors(points: &[Vec<f64>], errors: &[f64]) -> Result<Self, PlanError> {
        let mut curve = Self::bezier(points)?;
        let (expected, found) = (curve.coordinates, errors.len());
        if found != expected {
            return Err(PlanError::Length { expected, found });
        }
        for (bounds, &error) in curve.bounds.iter_mut().zip(errors) {
            if !(0.0..=EXTENT_MAX).contains(&error) {
                let (what, value) = ("error of a curve", error);
                return Err(PlanError::Value { what, value });
            }
            bounds.error = error;
        }
        Ok(curve)
    }

    /// Returns the curve `c[0] + c[1] t + c[2] t^2 + ...`, each coefficient a configuration.
    ///
    /// # Errors
    /// Returns an error as [`bezier`](Self::bezier) does.
    pub fn power<P: AsRef<[f64]>>(coefficients: &[P]) -> Result<Self, PlanError> {
        // Checks lengths and numbers.
        let checked = Self::bezier(coefficients)?;
        let n = coefficients.len() - 1;
        let points: Vec<Vec<f64>> = (0..=n)
            .map(|j| {
                let of = |c: usize| {
                    // C(j, k) / C(n, k) is a product of j - i over n - i.
                    let mut weight = 1.0;
                    let mut sum = 0.0;
                    for (k, a) in coefficients.iter().enumerate().take(j + 1) {
                        sum += a.as_ref()[c] * weight;
                        weight *= (j - k) as f64 / (n.max(k + 1) - k) as f64;
                    }
                    sum
                };
                (0..checked.coordinates).map(of).collect()
            })
            .collect();
        let size = |c: usize| coefficients.iter().map(|a| a.as_ref()[c].abs()).sum();
        Self::converted(&points, 4.0 * (n + 1) as f64, size)
    }

    /// Returns the cubic curve between two configurations with these velocities at its ends.
    ///
    /// The curve takes `duration` for its times 0 to 1; velocities are in the unit of the duration.
    ///
    /// # Errors
    /// Returns an error if lengths differ, if a number is out of range, or if the duration is not
    /// positive.
    pub fn cubic<P: AsRef<[f64]>>(
        from: P,
        to: P,
        velocity_from: P,
        velocity_to: P,
        duration: f64,
    ) -> Result<Self, PlanError> {
        let zeros = std::vec![0.0; from.as_ref().len()];
        let [from, to, v, w] = [&from, &to, &velocity_from, &velocity_to].map(P::as_ref);
        check_duration(duration)?;
        check_lengths(&[from, to, v, w])?;
        let third = duration / 3.0;
        Self::hermite([from, to, v, w, &zeros, &zeros], duration, |c| {
            std::vec![from[c], from[c] + third * v[c], to[c] - third * w[c], to[c]]
        })
    }

    /// Returns the quintic curve between two configurations with these velocities and accelerations
    /// at its ends, each given for the start and for the end.
    ///
    /// The curve takes `duration` for its times 0 to 1; velocities and accelerations are in the
    /// unit of the duration.
    ///
    /// # Errors
    /// Returns an error if lengths differ, if a number is out of range, or if the duration is not
    /// positive.
    pub fn quintic<P: AsRef<[f64]>>(
        ends: [P; 2],
        velocities: [P; 2],
        accelerations: [P; 2],
        duration: f64,
    ) -> Result<Self, PlanError> {
        let [from, to] = ends.each_ref().map(P::as_ref);
        let [v, w] = velocities.each_ref().map(P::as_ref);
        let [a, b] = accelerations.each_ref().map(P::as_ref);
        check_duration(duration)?;
        check_lengths(&[from, to, v, w, a, b])?;
        let (fifth, square) = (duration / 5.0, duration * duration / 20.0);
        Self::hermite([from, to, v, w, a, b], duration, |c| {
            let [near, far] = [from[c] + 2.0 * fifth * v[c], to[c] - 2.0 * fifth * w[c]];
            std::vec![
                from[c],
                from[c] + fifth * v[c],
                near + square * a[c],
                far + square * b[c],
                to[c] - fifth * w[c],
                to[c],
            ]
        })
    }

    /// Returns the curve of the control points of each coordinate, from values, velocities and
    /// accelerations of both ends.
    fn hermite(ends: [&[f64]; 6], duration: f64, of: impl Fn(usize) -> Vec<f64>) -> Result<Self, PlanError> {
        let columns: Vec<Vec<f64>> = (0..ends[0].len()).map(of).collect();
        let count = columns.first().map_or(1, Vec::len);
        let points: Vec<Vec<f64>> = (0..count).map(|j| columns.iter().map(|x| x[j]).collect()).collect();
        Self::converted(&points, 8.0, |c| {
            let [p, q, v, w, a, b] = ends.map(|x| x[c].abs());
            p.larger(q) + duration * (v.larger(w) + duration * a.larger(b))
        })
    }

    /// Returns the curves of a B-spline, one for each knot interval that is not empty.
    ///
    /// `knots` are the knots with their multiplicities, in ascending order: as many as control
    /// points, plus the degree, plus one. The spline runs from the knot number `degree` to the
    /// knot of the same number from the end. Each curve starts at the end of the one before, bit
    /// for bit. Times of the curves run from 0 to 1 each, instead of the knot intervals that
    /// [`b_spline_times`](Self::b_spline_times) returns.
    ///
    /// # Errors
    /// Returns an error if the number of knots does not fit, if the knots descend or their interval
    /// is empty, or as [`bezier`](Self::bezier) does.
    pub fn b_spline<P: AsRef<[f64]>>(points: &[P], degree: usize, knots: &[f64]) -> Result<Vec<Self>, PlanError> {
        let times = Self::b_spline_times(points.len(), degree, knots)?;
        let coordinates = points.first().ok_or(PlanError::Empty)?.as_ref().len();
        for point in points {
            // Checks lengths and numbers.
            let checked = Self::bezier(core::slice::from_ref(point))?;
            if checked.coordinates != coordinates {
                return Err(PlanError::Length {
                    expected: coordinates,
                    found: checked.coordinates,
                });
            }
        }
        let mut curves: Vec<Self> = Vec::new();
        for times in times.windows(2) {
            // The last knot that is not after the start.
            let span = knots.partition_point(|u| *u <= times[0]) - 1;
            let near = &points[span - degree..=span];
            let mut rows: Vec<Vec<f64>> = (0..=degree)
                .map(|j| {
                    (0..coordinates)
                        .map(|c| blossom(near, c, &knots[span - degree..], times, j))
                        .collect()
                })
                .collect();
            if let Some(before) = curves.last() {
                rows[0] = before.end();
            }
            // The start is a value of the curve before.
            let size = |c: usize| points.iter().fold(0.0, |most, p| most.larger(p.as_ref()[c].abs()));
            curves.push(Self::converted(&rows, 8.0 * (degree + 1) as f64, size)?);
        }
        Ok(curves)
    }

    /// Returns the times at which the curves of a B-spline start and end: its knots, without
    /// repetitions.
    ///
    /// # Errors
    /// Returns an error if the number of knots does not fit or the knots descend, or if their
    /// interval is empty.
    pub fn b_spline_times(points: usize, degree: usize, knots: &[f64]) -> Result<Vec<f64>, PlanError> {
        let refused = |what, value| Err(PlanError::Value { what, value });
        if !(1..=DEGREE_MAX).contains(&degree) {
            return refused("degree of a curve", degree as f64);
        }
        if points <= degree || knots.len() != points + degree + 1 {
            return refused("number of knots", knots.len() as f64);
        }
        if let Some(&knot) = knots.iter().find(|u| !(u.abs() <= EXTENT_MAX)) {
            return refused("knot", knot);
        }
        if let Some(pair) = knots.windows(2).find(|u| u[0] > u[1]) {
            return refused("knot", pair[1]);
        }
        let mut times = knots[degree..=points].to_vec();
        let (first, last) = (times[0], times[times.len() - 1]);
        let inner = |knot: f64| knot > first && knot < last;
        // A knot that repeats more often is a jump.
        if let Some(run) = knots
            .windows(degree + 1)
            .find(|run| run[0] == run[degree] && inner(run[0]))
        {
            return refused("knot that repeats more often than the degree", run[0]);
        }
        times.dedup();
        match times.len() {
            1 => refused("knot", times[0]),
            _ => Ok(times),
        }
    }

    /// Returns the curves of a uniform B-spline of a degree: the knots are one apart, so the spline
    /// starts and ends near its first and last control points, not at them.
    ///
    /// # Errors
    /// Returns an error as [`b_spline`](Self::b_spline) does.
    pub fn uniform_b_spline<P: AsRef<[f64]>>(points: &[P], degree: usize) -> Result<Vec<Self>, PlanError> {
        let knots: Vec<f64> = (0..points.len() + degree + 1).map(|k| k as f64).collect();
        Self::b_spline(points, degree, &knots)
    }

    /// Returns the same curve, one degree higher.
    ///
    /// # Errors
    /// Returns an error if the curve has the maximum degree.
    pub fn elevated(&self) -> Result<Self, PlanError> {
        let next = (self.degree + 1) as f64;
        let points: Vec<Vec<f64>> = (0..=self.degree + 1)
            .map(|j| {
                let of = |c: usize| {
                    let row = self.row(c, 0);
                    let x = j as f64 / next;
                    match j {
                        0 => row[0],
                        _ if j > self.degree => row[self.degree],
                        _ => row[j] + (row[j - 1] - row[j]) * x,
                    }
                };
                (0..self.coordinates).map(of).collect()
            })
            .collect();
        let mut curve = Self::converted(&points, 8.0, |c| self.bounds[c].most[0])?;
        for (new, old) in curve.bounds.iter_mut().zip(&self.bounds) {
            new.error += old.error;
        }
        curve.times = self.times;
        Ok(curve)
    }
}

/// Returns the value of the blossom of a B-spline's polynomial at `j` times the end of an interval,
/// and otherwise its start. `knots` start with those of the first control point.
fn blossom<P: AsRef<[f64]>>(points: &[P], c: usize, knots: &[f64], times: &[f64], j: usize) -> f64 {
    let degree = points.len() - 1;
    let mut row: Vec<f64> = points.iter().map(|p| p.as_ref()[c]).collect();
    for round in 1..=degree {
        let time = if round <= j { times[1] } else { times[0] };
        for k in (round..=degree).rev() {
            let [from, until] = [knots[k], knots[k + degree + 1 - round]];
            row[k] = row[k - 1] + (row[k] - row[k - 1]) * ((time - from) / (until - from));
        }
    }
    row[degree]
}

fn check_duration(value: f64) -> Result<(), PlanError> {
    match value > 0.0 && value <= EXTENT_MAX {
        true => Ok(()),
        false => Err(PlanError::Value {
            what: "duration of a curve",
            value,
        }),
    }
}

fn check_lengths(rows: &[&[f64]]) -> Result<(), PlanError> {
    let expected = rows[0].len();
    match rows.iter().find(|row| row.len() != expected) {
        Some(row) => Err(PlanError::Length {
            expected,
            found: row.len(),
        }),
        None => Ok(()),
    }
}

/// Number of control points of a coordinate with its hodographs.
fn row_length(degree: usize) -> usize {
    (0..4.min(degree + 1)).map(|order| degree + 1 - order).sum()
}

/// Values and bounds.
impl JointCurve {
    /// Returns the number of coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// Returns the degree: the number of control points, less one.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Returns a control point.
    ///
    /// # Panics
    /// Panics if the index exceeds the degree.
    #[must_use]
    pub fn control_point(&self, index: usize) -> Vec<f64> {
        (0..self.coordinates).map(|c| self.row(c, 0)[index]).collect()
    }

    /// Returns the times on a clock of start and end: see [`with_times`](Self::with_times).
    #[must_use]
    pub fn times(&self) -> Option<[f64; 2]> {
        self.times
    }

    /// Returns the configuration at a time from 0 to 1.
    #[must_use]
    pub fn at(&self, time: f64) -> Vec<f64> {
        self.derivative(0, time)
    }

    /// Returns the first derivative at a time from 0 to 1.
    #[must_use]
    pub fn velocity(&self, time: f64) -> Vec<f64> {
        self.derivative(1, time)
    }

    /// Returns the second derivative at a time from 0 to 1.
    #[must_use]
    pub fn acceleration(&self, time: f64) -> Vec<f64> {
        self.derivative(2, time)
    }

    fn derivative(&self, order: usize, time: f64) -> Vec<f64> {
        (0..self.coordinates).map(|c| self.value(c, order, time)).collect()
    }

    /// Returns all control points.
    pub(crate) fn control_points(&self) -> Vec<Vec<f64>> {
        (0..=self.degree).map(|k| self.control_point(k)).collect()
    }

    /// Returns the first control point.
    pub(crate) fn start(&self) -> Vec<f64> {
        self.control_point(0)
    }

    /// Returns the last control point.
    pub(crate) fn end(&self) -> Vec<f64> {
        self.control_point(self.degree)
    }

    /// Returns the control points of a coordinate, or of its hodograph of this order.
    fn row(&self, c: usize, order: usize) -> &[f64] {
        if order > self.degree {
            return &[0.0];
        }
        let count = self.degree + 1;
        let from = c * row_length(self.degree) + (0..order).map(|k| count - k).sum::<usize>();
        &self.points[from..from + count - order]
    }

    pub(crate) fn bounds(&self, c: usize) -> &RowBounds {
        &self.bounds[c]
    }

    /// Returns the value of a coordinate, or its derivative of this order.
    ///
    /// A value is within the control points, as that of the curve is: rounding may exceed them.
    pub(crate) fn value(&self, c: usize, order: usize, time: f64) -> f64 {
        let points = self.row(c, order);
        let value = match *points {
            [only] => only,
            // The end is the last control point, without rounding.
            [.., last] if time == 1.0 => last,
            [from, to] => from + (to - from) * time,
            [a, b, c, d] => value_at(&mut [a, b, c, d], time),
            [a, b, c, d, e] => value_at(&mut [a, b, c, d, e], time),
            [a, b, c, d, e, f] => value_at(&mut [a, b, c, d, e, f], time),
            [a, b, c, d, e, f, g] => value_at(&mut [a, b, c, d, e, f, g], time),
            [a, b, c, d, e, f, g, h] => value_at(&mut [a, b, c, d, e, f, g, h], time),
            _ => {
                let mut row: Row = [0.0; DEGREE_MAX + 1];
                let row = &mut row[..points.len()];
                row.copy_from_slice(points);
                value_at(row, time)
            }
        };
        match order {
            0 => value.clamped(self.bounds[c].hull[0], self.bounds[c].hull[1]),
            _ => value,
        }
    }

    /// Returns the rounding error of a value of a coordinate, in units of its greatest control
    /// point.
    pub(crate) fn value_error(&self) -> f64 {
        ARM_VALUE * self.degree as f64
    }

    /// Returns a coordinate at a time: its value, its first two derivatives, and upper bounds of its
    /// first three derivatives over the first `used` nested parts of a span.
    pub(crate) fn state(&self, c: usize, time: f64, span: f64, used: usize) -> CurveState {
        let mut state = CurveState {
            values: [self.value(c, 0, time), 0.0, 0.0],
            bounds: [[0.0; 3]; PARTS],
        };
        let of = &self.bounds[c];
        let n = self.degree as f64;
        let until = (time + span).smaller(1.0);
        let part = if time < 1.0 { (until - time) / (1.0 - time) } else { 1.0 };
        let times = [time, if until < 1.0 { part } else { 1.0 }];
        for order in 1..4.min(self.degree + 1) {
            let powers = [0.0, 0.0, n, n * n][order];
            let error = CURVE_PART * n * of.most[order] + CURVE_DIFFERENCE * powers * of.most[1];
            let (value, most) = match *self.row(c, order) {
                [only] => (only, [only.abs(); PARTS]),
                [a, b] => part_of(&mut [a, b], times, used),
                [a, b, c] => part_of(&mut [a, b, c], times, used),
                [a, b, c, d] => part_of(&mut [a, b, c, d], times, used),
                [a, b, c, d, e] => part_of(&mut [a, b, c, d, e], times, used),
                ref points => {
                    let mut row: Row = [0.0; DEGREE_MAX + 1];
                    row[..points.len()].copy_from_slice(points);
                    part_of(&mut row[..points.len()], times, used)
                }
            };
            if order < 3 {
                state.values[order] = value;
            }
            for (bounds, most) in state.bounds[..used].iter_mut().zip(most) {
                bounds[order - 1] = most + error;
            }
        }
        state
    }

    /// Returns an upper bound of a coordinate at all times of a span.
    pub(crate) fn greatest(&self, c: usize, time: f64, span: f64) -> f64 {
        let of = &self.bounds[c];
        if of.hull[0] == of.hull[1] {
            return of.hull[1] + of.error;
        }
        let mut row: Row = [0.0; DEGREE_MAX + 1];
        let row = &mut row[..=self.degree];
        row.copy_from_slice(self.row(c, 0));
        let until = (time + span).smaller(1.0);
        if time < 1.0 {
            later(row, time);
            earlier(row, (until - time) / (1.0 - time));
        } else {
            row.fill(self.row(c, 0)[self.degree]);
        }
        let greatest = row.iter().copied().fold(f64::NEG_INFINITY, f64::larger);
        greatest + CURVE_PART * self.degree as f64 * of.most[0] + of.error
    }

    /// Returns the straight segment between the ends, if the curve stays on it up to rounding and does
    /// not pass the ends. The distance from it is part of the result, so a proof that the segment is
    /// free holds for the curve, although the times along both differ.
    ///
    /// The value at a time is an average of the control points. Each is a point of the segment and a
    /// distance, so the value is their averages.
    pub(crate) fn straightened(&self) -> Option<Self> {
        if self.degree == 1 {
            return None;
        }
        let n = self.degree;
        let step = |c: usize| self.row(c, 0)[n] - self.row(c, 0)[0];
        let longest = |a: usize, b: usize| if step(b).abs() > step(a).abs() { b } else { a };
        let along = (0..self.coordinates).reduce(longest)?;
        let (from, way) = (self.row(along, 0)[0], step(along));
        let part = |j: usize| match way == 0.0 {
            true => 0.0,
            false => ((self.row(along, 0)[j] - from) / way).clamped(0.0, 1.0),
        };
        let mut straight = Self::straight(&self.start(), &self.end());
        for (c, bounds) in straight.bounds.iter_mut().enumerate() {
            let row = self.row(c, 0);
            let off = (1..n).map(|j| (row[j] - (row[0] + step(c) * part(j))).abs());
            let of = &self.bounds[c];
            bounds.error = of.error + off.fold(0.0, f64::larger) + STRAIGHT_ERROR * of.most[0];
            if !(bounds.error <= STRAIGHT * of.most[0]) {
                return None;
            }
        }
        Some(straight)
    }

    /// Checks that a curve has as many coordinates as limits, and keeps them at all times.
    ///
    /// A value that exceeds a limit by the rounding of the curve alone is accepted.
    pub(crate) fn check(&self, limits: &[[f64; 2]]) -> Result<(), PlanError> {
        if limits.len() != self.coordinates {
            return Err(PlanError::Length {
                expected: limits.len(),
                found: self.coordinates,
            });
        }
        for (coordinate, &limits) in limits.iter().enumerate() {
            if let Some((time, value)) = self.outside(coordinate, limits) {
                return Err(PlanError::CurveLimit {
                    coordinate,
                    time,
                    value,
                });
            }
        }
        Ok(())
    }

    /// Returns a time and a value at which a coordinate is seen outside its limits.
    fn outside(&self, c: usize, [low, high]: [f64; 2]) -> Option<(f64, f64)> {
        let bounds = &self.bounds[c];
        let slack = 2.0 * self.value_error() * bounds.most[0] + bounds.error;
        self.beyond(c, 0, [low - slack, high + slack])
    }

    /// Returns whether a derivative of a coordinate, of order 1 or 2, is proven to be at most `limit`
    /// in absolute value at all times.
    ///
    /// A halving errs by 5 UNIT for each degree, and there are at most 53. A control point of the
    /// curve that was given is off by the error; a difference of two, times the degree, by `2 n`
    /// times as much.
    pub(crate) fn keeps(&self, c: usize, order: usize, limit: f64) -> bool {
        let (of, n) = (&self.bounds[c], self.degree as f64);
        let powers = [0.0, 1.0, 2.0 * n][order];
        let given = 2.0 * n * powers * of.error;
        let rounded = 8.0 * CURVE_PART * n * of.most[order] + CURVE_DIFFERENCE * powers * of.most[1];
        let most = limit - given - rounded;
        most >= 0.0 && self.beyond(c, order, [-most, most]).is_none()
    }

    /// Returns a time and a value at which a coordinate, or a derivative of it, is seen outside an
    /// interval.
    fn beyond(&self, c: usize, order: usize, [low, high]: [f64; 2]) -> Option<(f64, f64)> {
        let given = self.row(c, order);
        let is_inside = |x: &f64| *x >= low && *x <= high;
        if given.iter().all(is_inside) {
            return None;
        }
        let count = given.len();
        let mut row: Row = [0.0; DEGREE_MAX + 1];
        row[..count].copy_from_slice(given);
        // The parts to be searched, the earliest last.
        let mut parts = std::vec![(row, 0.0, 1.0, 0)];
        while let Some((mut row, from, until, halved)) = parts.pop() {
            let points = &mut row[..count];
            if halved == HALVINGS || points.iter().all(is_inside) {
                continue;
            }
            let middle = 0.5 * (from + until);
            for time in [from, middle, until] {
                let value = self.value(c, order, time);
                if !is_inside(&value) {
                    return Some((time, value));
                }
            }
            let mut second = row;
            later(&mut second[..count], 0.5);
            earlier(&mut row[..count], 0.5);
            parts.push((second, middle, until, halved + 1));
            parts.push((row, from, middle, halved + 1));
        }
        None
    }
}

/// A curve as it is stored: its control points, the error of each coordinate, and its times on a
/// clock.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "JointCurve")]
struct StoredCurve {
    points: Vec<Vec<f64>>,
    errors: Vec<f64>,
    #[serde(default)]
    times: Option<[f64; 2]>,
}

#[cfg(feature = "serde")]
impl From<JointCurve> for StoredCurve {
    fn from(curve: JointCurve) -> Self {
        Self {
            points: curve.control_points(),
            errors: (0..curve.coordinates()).map(|c| curve.bounds(c).error).collect(),
            times: curve.times(),
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCurve> for JointCurve {
    type Error = PlanError;

    fn try_from(stored: StoredCurve) -> Result<Self, PlanError> {
        let curve = Self::with_errors(&stored.points, &stored.errors)?;
        match stored.times {
            Some(times) => curve.with_times(times),
            None => Ok(curve),
        }
    }
}
