//! Verdicts about paths of straight segments, splines, and tubes around segments.

use core::ops::ControlFlow;
use std::vec::Vec;

use crate::check::checker::Checker;
use crate::check::verdict::Verdict;
use crate::error::PlanError;
use crate::motion::curve::JointCurve;
use crate::motion::space::ConfigurationSpace;
use lin_canny::{EXTENT_MAX, Progress};

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the index of the first segment that is not free, with its verdict.
    ///
    /// If all segments are free, the verdict is free and has the contacts at the start of all
    /// segments. A path of one configuration counts as a segment without length.
    ///
    /// # Errors
    /// Returns an error if the path is empty or a configuration is invalid.
    pub fn certify_path(&mut self, path: &[Vec<f64>]) -> Result<(usize, Verdict), PlanError> {
        let found = self.certify_path_with_progress(path, &mut |_| ControlFlow::Continue(()))?;
        found.ok_or(PlanError::Empty)
    }

    /// Returns the verdict on a path as [`certify_path`](Self::certify_path) does, with a progress
    /// callback.
    ///
    /// The callback is called before each segment. If it stops the call, the result is `None`.
    ///
    /// # Errors
    /// Returns an error as [`certify_path`](Self::certify_path) does.
    pub fn certify_path_with_progress(
        &mut self,
        path: &[Vec<f64>],
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<(usize, Verdict)>, PlanError> {
        let last = path.len().checked_sub(1).ok_or(PlanError::Empty)?;
        self.first_not_free("segments", last.max(1), progress, |checker, k| {
            checker.certify(&path[k], &path[last.min(k + 1)])
        })
    }

    /// Returns the index of the first motion that is not free, with its verdict, or the verdict on
    /// all; `None` if the callback stops the call.
    fn first_not_free(
        &mut self,
        what: &'static str,
        count: usize,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
        mut certify: impl FnMut(&mut Self, usize) -> Result<Verdict, PlanError>,
    ) -> Result<Option<(usize, Verdict)>, PlanError> {
        let mut contacts = Vec::new();
        for k in 0..count {
            if progress(Progress::new(what, k, Some(count))).is_break() {
                return Ok(None);
            }
            match certify(self, k)? {
                Verdict::Free { start_contacts, .. } => contacts.extend(start_contacts),
                verdict => return Ok(Some((k, verdict))),
            }
        }
        let (clearance, start_contacts) = (self.pairs.least_kept, contacts);
        Ok(Some((
            0,
            Verdict::Free {
                clearance,
                start_contacts,
            },
        )))
    }

    /// Returns the verdict for a tube around a segment.
    ///
    /// The tube contains all motions that keep every point of the robot within `radius` of its
    /// position on the segment at the same time. Examples are a spline between the ends, and the
    /// segment with a tracking error. The margin of the checker holds inside the tube.
    ///
    /// `Blocked` and `Undecided` mean that a pair comes within the sum of margin and radius. A free
    /// motion may still exist in such a tube. For a pair of two robot bodies the radius counts
    /// twice, and so it does for all pairs of a robot with such pairs.
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid or `radius` is negative or not finite.
    pub fn certify_tube(&mut self, from: &[f64], to: &[f64], radius: f64) -> Result<Verdict, PlanError> {
        if !(0.0..=EXTENT_MAX).contains(&radius) {
            return Err(PlanError::Value {
                what: "radius",
                value: radius,
            });
        }
        let moving = if self.pairs.own.is_empty() { 1.0 } else { 2.0 };
        self.tube = moving * radius;
        let start_contact = self.start_contact_margin.take();
        let verdict = self.certify(from, to);
        self.start_contact_margin = start_contact;
        self.tube = 0.0;
        verdict
    }

    /// Returns the index of the first curve of a spline that is not free, with its verdict: see
    /// [`certify_path`](Self::certify_path).
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{Checker, Joint, JointCurve, JointTree, World};
    /// # let origin = Isometry3::identity();
    /// # let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// # let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// # let block = JointTree::serial(origin, rails, vec![2], 0.1)?;
    /// # let mut world = World::new();
    /// # world.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// # let post = solids::cuboid(Vector3::repeat(0.5))?;
    /// # world.obstacle("post", post, origin);
    /// # let mut checker = Checker::new(block, world)?;
    /// let path = [[-1.0, 0.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    /// let knots = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0];
    /// let spline = JointCurve::b_spline(&path, 2, &knots)?;
    /// assert_eq!(spline.len(), 3);
    /// assert!(checker.certify_spline(&spline)?.1.is_free());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if there is no curve, if a curve does not start where and when the one before
    /// ends ([`PlanError::CurveJump`], [`PlanError::CurveTime`]), or as [`certify_curve`](Self::certify_curve) does.
    pub fn certify_spline(&mut self, curves: &[JointCurve]) -> Result<(usize, Verdict), PlanError> {
        let found = self.certify_spline_with_progress(curves, &mut |_| ControlFlow::Continue(()))?;
        found.ok_or(PlanError::Empty)
    }

    /// Returns the verdict on a spline as [`certify_spline`](Self::certify_spline) does, with a
    /// progress callback.
    ///
    /// The callback is called before each curve. If it stops the call, the result is `None`.
    ///
    /// # Errors
    /// Returns an error as [`certify_spline`](Self::certify_spline) does.
    pub fn certify_spline_with_progress(
        &mut self,
        curves: &[JointCurve],
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<(usize, Verdict)>, PlanError> {
        if curves.is_empty() {
            return Err(PlanError::Empty);
        }
        for (k, pair) in curves.windows(2).enumerate() {
            let (end, start) = (pair[0].end(), pair[1].start());
            if let Some(coordinate) = end.iter().zip(&start).position(|(x, y)| x != y) {
                let index = k + 1;
                return Err(PlanError::CurveJump { index, coordinate });
            }
            if let (Some([_, end]), Some([start, _])) = (pair[0].times(), pair[1].times())
                && start != end
            {
                let index = k + 1;
                return Err(PlanError::CurveTime { index, start, end });
            }
        }
        self.first_not_free("curves", curves.len(), progress, |checker, k| {
            checker.certify_curve(&curves[k])
        })
    }
}
