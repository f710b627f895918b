//! Configurations in a tube of joints at which a pair is closer than it must be.

use std::vec::Vec;

use crate::check::checker::Checker;
use crate::check::clearance::NearPair;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::joint_motion::{JointMotion, PieceRef, Tube};
use crate::motion::space::ConfigurationSpace;
use crate::names::CellPair;

/// Number of times after the first at which a contact is searched for.
const TIMES: u32 = 64;

/// Number of pairs that are tried, and of corners of the tube for each.
const PAIRS: usize = 8;
const CORNERS: usize = 4;

/// Pairs are tried if they are closer than this many times what the tube moves to first order.
const HOPE: f64 = 2.0;

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns a time of a piece of a motion, and a configuration of its tube of joints at this time at
    /// which a pair is closer than it must be, if one is found.
    ///
    /// [`certify`](Self::certify) compares distances on the motion with a bound, so a tube that is not
    /// free need not contain a contact. This call searches for one: at `from`, such as
    /// [`Verdict::free_until`](crate::Verdict::free_until), and at 64 later times, at corners of the
    /// tube against the gradients of the distances. Deviations are cut at the bounds of the
    /// coordinates. The predicate of [`is_free_at`](Self::is_free_at) decides about what is
    /// returned. `None` proves nothing. Of a motion without a tube of joints, the configurations of the
    /// motion itself are tried.
    ///
    /// ```
    /// # use lin_canny::nalgebra::{Isometry3, Vector3};
    /// # use lin_canny::polyhedron::solids;
    /// # use lin_canny_plan::{Checker, Joint, JointCurve, JointMotion, JointTree, Cell};
    /// # let origin = Isometry3::identity();
    /// # let rail = |axis| Joint::prismatic(origin, axis, [-2.0, 2.0]);
    /// # let rails = vec![rail(Vector3::x_axis()), rail(Vector3::y_axis())];
    /// # let block = JointTree::serial(origin, rails, vec![2], 0.1)?;
    /// # let mut cell = Cell::new();
    /// # cell.robot_body("block", solids::cuboid(Vector3::repeat(0.1))?);
    /// # let post = solids::cuboid(Vector3::repeat(0.5))?;
    /// # cell.add_obstacle("post", post, origin)?;
    /// # let mut checker = Checker::new(block, cell)?;
    /// // The lowest point of this parabola is 0.1 above contact.
    /// let curve = JointCurve::bezier(&[[-1.0, 1.6], [0.0, -0.2], [1.0, 1.6]])?;
    /// let motion = JointMotion::curve(&curve).with_tube(&[0.0, 0.11])?;
    /// let verdict = checker.certify(&motion)?;
    /// assert!(!verdict.is_free());
    /// let found = checker.tube_contact(&motion, 0, verdict.free_until())?;
    /// let (t, q) = found.ok_or("no contact")?;
    /// assert!(!checker.is_free_at(&q)? && q[0] == curve.at(t)[0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error as [`certify`](Self::certify) does, if there is no such piece, or if `from` is
    /// not between 0 and 1.
    pub fn tube_contact(
        &mut self,
        motion: &JointMotion,
        piece: usize,
        from: f64,
    ) -> Result<Option<(f64, Vec<f64>)>, PlanError> {
        if piece >= motion.pieces() {
            let (what, value) = ("index of a piece", piece as f64);
            return Err(PlanError::Value { what, value });
        }
        self.along(motion, piece)?;
        self.check_tube(motion, piece)?;
        if !(0.0..=1.0).contains(&from) {
            let (what, value) = ("time of a piece", from);
            return Err(PlanError::Value { what, value });
        }
        let before = self.time;
        let mut found = Ok(None);
        for k in 0..=TIMES {
            let time = (from + (1.0 - from) * (f64::from(k) / f64::from(TIMES))).at_most(1.0);
            found = self.tube_contact_at(motion, piece, time);
            if !matches!(found, Ok(None)) {
                break;
            }
        }
        self.time = before;
        if let Some(time) = before {
            self.place_moving(time)?;
        }
        found
    }

    fn tube_contact_at(
        &mut self,
        motion: &JointMotion,
        piece: usize,
        time: f64,
    ) -> Result<Option<(f64, Vec<f64>)>, PlanError> {
        if let Some([start, end]) = motion.times(piece) {
            self.set_time((start + (end - start) * time).clamped(start, end))?;
        }
        let q = match motion.piece_ref(piece) {
            PieceRef::Segment([from, to]) => self.space.between(from, to, time),
            PieceRef::Curve(curve) => curve.at(time),
        };
        let tube = match &motion.tube {
            Tube::Joints(tube) => tube.at(time),
            _ => std::vec![0.0; q.len()],
        };
        let found = self.contact_about(&q, &tube)?;
        Ok(found.map(|q| (time, q)))
    }

    /// Searches for a contact at configurations that deviate from `q` by at most the entries of
    /// `tube`.
    fn contact_about(&mut self, q: &[f64], tube: &[f64]) -> Result<Option<Vec<f64>>, PlanError> {
        let bounds = self.space.bounds();
        let ends = q.iter().zip(tube).zip(bounds).map(|((&x, e), [low, high])| {
            // The curve may exceed its bounds by rounding.
            [(x - e).clamped(*low, *high), (x + e).clamped(*low, *high)]
        });
        let ends: Vec<[f64; 2]> = ends.collect();
        let middle: Vec<f64> = q
            .iter()
            .zip(bounds)
            .map(|(x, [low, high])| x.clamped(*low, *high))
            .collect();
        if !self.is_free_at(&middle)? {
            return Ok(Some(middle));
        }
        let mut pairs: Vec<(f64, CellPair, Vec<f64>)> = Vec::new();
        for near in self.nearest(&middle, f64::INFINITY)? {
            let moved: f64 = near.gradient.iter().zip(tube).map(|(g, e)| g.abs() * e).sum();
            if near.excess <= HOPE * moved {
                pairs.push((near.excess - moved, near.pair, corner(&near, &middle, &ends)));
            }
        }
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for (_, pair, mut at) in pairs.into_iter().take(PAIRS) {
            for _ in 0..CORNERS {
                if !self.is_free_at(&at)? {
                    return Ok(Some(at));
                }
                let all = self.nearest(&at, f64::INFINITY)?;
                let next = all
                    .iter()
                    .find(|near| near.pair == pair)
                    .map(|near| corner(near, &at, &ends));
                match next.filter(|next| *next != at) {
                    Some(next) => at = next,
                    None => break,
                }
            }
        }
        Ok(None)
    }
}

/// Returns the corner of a box of configurations at which a pair is nearest, to first order about
/// `q`.
fn corner(near: &NearPair, q: &[f64], ends: &[[f64; 2]]) -> Vec<f64> {
    let each = near.gradient.iter().zip(q).zip(ends);
    let of = |((slope, x), [low, high]): ((&f64, &f64), &[f64; 2])| match () {
        () if *slope > 0.0 => *low,
        () if *slope < 0.0 => *high,
        () => *x,
    };
    each.map(of).collect()
}
