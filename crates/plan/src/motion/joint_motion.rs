//! The motions that a checker proves free: segments, paths, curves and splines, with tubes.

use std::vec::Vec;

use crate::error::PlanError;
use crate::motion::curve::JointCurve;
use crate::motion::tube::JointTube;
use lin_canny::EXTENT_MAX;

/// A motion: a segment, a path of segments, a curve of the coordinates, or a spline of curves, with
/// a tube around it if it has one.
///
/// A motion has one or more *pieces*: the segments of a path, or the curves of a spline. Verdicts
/// name the piece, and give times from 0 to 1 within it. A segment is the motion of its space between
/// two configurations, such as the shorter turn of a rotation. Spaces with rotations follow segments
/// and paths only.
///
/// ```
/// use lin_canny_plan::{JointCurve, JointMotion};
///
/// let path = JointMotion::path(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])?.with_tube(&[0.01, 0.02])?;
/// assert_eq!(path.pieces(), 2);
/// let curve = JointMotion::curve(&JointCurve::bezier(&[[0.0], [1.0], [1.0]])?);
/// assert_eq!(curve.pieces(), 1);
/// # Ok::<(), lin_canny_plan::PlanError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct JointMotion {
    pub(crate) pieces: Pieces,
    pub(crate) tube: Tube,
}

/// The pieces of a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Pieces {
    /// The segments between configurations, one at least, and the times on the clock at which the
    /// motion is at them; none if no obstacle moves.
    Path { rows: Vec<Vec<f64>>, times: Vec<f64> },
    /// Curves, each of which starts where and when the one before ends.
    Spline(Vec<JointCurve>),
}

/// How far a motion may deviate.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Tube {
    None,
    /// Each point of the robot by this distance.
    Radius(f64),
    /// Each coordinate by its entry.
    Joints(JointTube),
}

/// A piece of a motion.
pub(crate) enum PieceRef<'a> {
    Segment([&'a [f64]; 2]),
    Curve(&'a JointCurve),
}

impl JointMotion {
    /// Returns the segment between two configurations.
    #[must_use]
    pub fn segment(from: &[f64], to: &[f64]) -> Self {
        Self::of(Pieces::Path {
            rows: std::vec![from.into(), to.into()],
            times: Vec::new(),
        })
    }

    /// Returns a path of segments from each configuration to the next. A path of one configuration
    /// is a segment without length.
    ///
    /// # Errors
    /// Returns an error if there is no configuration ([`PlanError::Empty`]).
    pub fn path<P: AsRef<[f64]>>(rows: &[P]) -> Result<Self, PlanError> {
        let mut rows: Vec<Vec<f64>> = rows.iter().map(|row| row.as_ref().into()).collect();
        if rows.len() < 2 {
            rows.push(rows.first().ok_or(PlanError::Empty)?.clone());
        }
        let times = Vec::new();
        Ok(Self::of(Pieces::Path { rows, times }))
    }

    /// Returns the motion along a curve, at its times on the clock if it has them.
    #[must_use]
    pub fn curve(curve: &JointCurve) -> Self {
        Self::of(Pieces::Spline(std::vec![curve.clone()]))
    }

    /// Returns the motion along one curve after the other, such as those of
    /// [`JointCurve::b_spline`].
    ///
    /// # Errors
    /// Returns an error if there is no curve ([`PlanError::Empty`]), or if a curve does not start where
    /// and when the one before ends ([`PlanError::CurveJump`], [`PlanError::CurveTime`]).
    pub fn spline(curves: &[JointCurve]) -> Result<Self, PlanError> {
        if curves.is_empty() {
            return Err(PlanError::Empty);
        }
        for (k, pair) in curves.windows(2).enumerate() {
            let index = k + 1;
            let (end, start) = (pair[0].end(), pair[1].start());
            if let Some(coordinate) = end.iter().zip(&start).position(|(x, y)| x != y) {
                return Err(PlanError::CurveJump { index, coordinate });
            }
            if let (Some([_, end]), Some([start, _])) = (pair[0].times(), pair[1].times())
                && start != end
            {
                return Err(PlanError::CurveTime { index, start, end });
            }
        }
        Ok(Self::of(Pieces::Spline(curves.into())))
    }

    fn of(pieces: Pieces) -> Self {
        let tube = Tube::None;
        Self { pieces, tube }
    }

    /// Returns the motion with a tube of the coordinates around it: all motions whose coordinates
    /// deviate by at most the entries of `tube` at every time, for example by the tracking error of a
    /// controller. It replaces any other tube.
    ///
    /// The entries are numbers, or a curve of them along a motion of one piece: see [`JointTube`].
    ///
    /// # Errors
    /// Returns an error if an entry is negative or not finite, if the number of entries is not that
    /// of the coordinates, or if the entries are a curve and the motion has several pieces.
    pub fn with_tube(self, tube: impl Into<JointTube>) -> Result<Self, PlanError> {
        let tube: JointTube = tube.into();
        let (expected, found) = (self.coordinates(), tube.coordinates());
        if found != expected {
            return Err(PlanError::Length { expected, found });
        }
        if let Some(value) = tube.wrong_entry() {
            let what = "entry of a tube";
            return Err(PlanError::Value { what, value });
        }
        if tube.varies() && self.pieces() > 1 {
            let (what, value) = ("number of pieces with a tube along a curve", self.pieces() as f64);
            return Err(PlanError::Value { what, value });
        }
        let tube = if tube.is_zero() { Tube::None } else { Tube::Joints(tube) };
        Ok(Self { tube, ..self })
    }

    /// Returns the motion with a tube of points around it: all motions that keep every point of the
    /// robot within `radius` of its position at the same time. It replaces any other tube.
    ///
    /// Examples are a spline near a path, and a path with a tracking error. For a pair of two robot
    /// bodies the radius counts twice, and so it does for all pairs of a robot with such pairs.
    ///
    /// # Errors
    /// Returns an error if `radius` is negative or not finite.
    pub fn with_radius(self, radius: f64) -> Result<Self, PlanError> {
        if !(0.0..=EXTENT_MAX).contains(&radius) {
            let (what, value) = ("radius", radius);
            return Err(PlanError::Value { what, value });
        }
        let tube = if radius > 0.0 { Tube::Radius(radius) } else { Tube::None };
        Ok(Self { tube, ..self })
    }

    /// Returns the motion with times on a clock: those of each configuration of a path, or of the
    /// start of each curve and of the last end. They matter only among moving obstacles
    /// ([`Cell::add_moving_obstacle`](crate::Cell::add_moving_obstacle)).
    ///
    /// # Errors
    /// Returns an error if a time is not finite or not after the one before, or if there is not one
    /// more time than pieces.
    pub fn with_times(self, times: &[f64]) -> Result<Self, PlanError> {
        let (expected, found) = (self.pieces() + 1, times.len());
        if found != expected {
            let (what, value) = ("number of times of a motion", found as f64);
            return Err(PlanError::Value { what, value });
        }
        let pieces = match self.pieces {
            Pieces::Path { rows, .. } => {
                let what = "time of a motion";
                if let Some(&value) = times.iter().find(|t| !(t.abs() <= EXTENT_MAX)) {
                    return Err(PlanError::Value { what, value });
                }
                if let Some(ends) = times.windows(2).find(|ends| !(ends[1] > ends[0])) {
                    return Err(PlanError::Value { what, value: ends[1] });
                }
                let times = times.into();
                Pieces::Path { rows, times }
            }
            Pieces::Spline(curves) => {
                let each = curves.into_iter().zip(times.windows(2));
                let timed = each.map(|(curve, ends)| curve.with_times([ends[0], ends[1]]));
                Pieces::Spline(timed.collect::<Result<_, _>>()?)
            }
        };
        Ok(Self { pieces, ..self })
    }

    /// Returns the number of pieces, at least one.
    #[must_use]
    pub fn pieces(&self) -> usize {
        match &self.pieces {
            Pieces::Path { rows, .. } => rows.len() - 1,
            Pieces::Spline(curves) => curves.len(),
        }
    }

    /// Returns the number of coordinates of the first configuration.
    fn coordinates(&self) -> usize {
        match &self.pieces {
            Pieces::Path { rows, .. } => rows[0].len(),
            Pieces::Spline(curves) => curves[0].coordinates(),
        }
    }

    /// Returns the motion along one piece, with the tube around it; `None` if there is no such piece.
    #[must_use]
    pub fn piece(&self, k: usize) -> Option<Self> {
        let pieces = match &self.pieces {
            Pieces::Path { rows, times } => Pieces::Path {
                rows: rows.get(k..=k + 1)?.into(),
                times: times.get(k..=k + 1).unwrap_or_default().into(),
            },
            Pieces::Spline(curves) => Pieces::Spline(std::vec![curves.get(k)?.clone()]),
        };
        let tube = self.tube.clone();
        Some(Self { pieces, tube })
    }

    /// Returns a piece.
    pub(crate) fn piece_ref(&self, k: usize) -> PieceRef<'_> {
        match &self.pieces {
            Pieces::Path { rows, .. } => PieceRef::Segment([&rows[k], &rows[k + 1]]),
            Pieces::Spline(curves) => PieceRef::Curve(&curves[k]),
        }
    }

    /// Returns the times on the clock of the start and the end of a piece.
    pub(crate) fn times(&self, k: usize) -> Option<[f64; 2]> {
        match &self.pieces {
            Pieces::Path { times, .. } => (!times.is_empty()).then(|| [times[k], times[k + 1]]),
            Pieces::Spline(curves) => curves[k].times(),
        }
    }

    /// Returns the control points of a piece: those of its curve, or the ends of its segment.
    pub(crate) fn control_points(&self, k: usize) -> Vec<Vec<f64>> {
        match &self.pieces {
            Pieces::Path { rows, .. } => rows[k..k + 2].into(),
            Pieces::Spline(curves) => curves[k].control_points(),
        }
    }
}

impl From<&JointCurve> for JointMotion {
    fn from(curve: &JointCurve) -> Self {
        Self::curve(curve)
    }
}
