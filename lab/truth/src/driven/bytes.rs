//! Bodies, poses and queries from arbitrary bytes: every query runs, and nothing may panic, hang or
//! return NaN.
//!
//! The test `files`, the target `bytes` of `fuzz/` and the instrument `soak` share this module.

use super::Bytes;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use lin_canny::{ContactState, ConvexPolyhedron, Outcome, RelativePose, Tracker};

crate::tally! {
    /// Counts of the results.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Tally {
        /// Bodies built and rejected.
        pub bodies: [u32; 2],
        /// Poses built and rejected.
        pub poses: [u32; 2],
        /// Queries by contact state: separated, touching, overlapping, undecided.
        pub classes: [u32; 4],
    }
}

impl Bytes<'_> {
    /// Returns any `f64`: small whole numbers (so that points coincide and faces are flat), their
    /// products with powers of two, or arbitrary bits.
    fn number(&mut self) -> f64 {
        let kind = self.byte();
        let whole = f64::from(self.byte() as i8);
        match kind % 8 {
            0..4 => whole.rem_euclid(5.0) - 2.0,
            4 => whole * 2f64.powi(i32::from(self.byte() as i8)),
            5 => whole + 2f64.powi(-40 - i32::from(self.byte() % 16)),
            6 => whole / 7.0,
            _ => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| self.byte()))),
        }
    }

    fn points(&mut self) -> Vec<Point3<f64>> {
        let n = self.byte() % 16;
        (0..n)
            .map(|_| Point3::new(self.number(), self.number(), self.number()))
            .collect()
    }

    fn body(&mut self) -> Option<ConvexPolyhedron> {
        let kind = self.byte();
        let points = self.points();
        let at = |i: usize| points.get(i).copied().unwrap_or_else(Point3::origin);
        match kind % 8 {
            0 => ConvexPolyhedron::point(at(0)).ok(),
            1 => ConvexPolyhedron::segment(at(0), at(1)).ok(),
            2 => ConvexPolyhedron::polygon(&points).ok(),
            3 => {
                let face = |bytes: &mut Self| (0..bytes.byte() % 6).map(|_| u32::from(bytes.byte() % 18)).collect();
                let faces: Vec<Vec<u32>> = (0..self.byte() % 12).map(|_| face(self)).collect();
                ConvexPolyhedron::from_faces(&points, &faces).ok()
            }
            _ => ConvexPolyhedron::from_points(&points).ok(),
        }
    }

    fn isometry(&mut self) -> Isometry3<f64> {
        let turned = self.byte();
        let q = Quaternion::new(self.number(), self.number(), self.number(), self.number());
        let q = match turned % 4 {
            0 => UnitQuaternion::new_unchecked(q),
            1 | 2 if q.norm() > 1e-100 && q.norm() < 1e100 => UnitQuaternion::new_normalize(q),
            _ => UnitQuaternion::identity(),
        };
        Isometry3::from_parts(Translation3::new(self.number(), self.number(), self.number()), q)
    }
}

/// Builds bodies and poses from the bytes and runs every query on them.
pub fn drive(bytes: &[u8]) -> Tally {
    let mut bytes = Bytes(bytes);
    let mut tally = Tally::default();
    let bodies: Vec<_> = (0..3).map(|_| bytes.body()).collect();
    for body in &bodies {
        tally.bodies[usize::from(body.is_none())] += 1;
        assert_eq!(body.as_ref().map_or(Ok(()), ConvexPolyhedron::check), Ok(()));
    }
    let bodies: Vec<_> = bodies.into_iter().flatten().collect();
    // One tracker for all pairs: its cached features rarely belong to the pair.
    let mut stray = Tracker::new();
    for (a, b) in bodies.iter().flat_map(|a| bodies.iter().map(move |b| (a, b))) {
        let pose = RelativePose::new(&bytes.isometry(), &bytes.isometry());
        tally.poses[usize::from(pose.is_err())] += 1;
        if let Ok(pose) = pose {
            let state = query(a, b, &pose, &mut stray, bytes.number());
            tally.classes[state as usize] += 1;
        }
    }
    tally
}

/// Runs every query on a pair and returns its contact state.
pub fn query(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    stray: &mut Tracker,
    d: f64,
) -> ContactState {
    let p = stray.propose(a, b, pose);
    assert!(!p.distance.is_some_and(f64::is_nan), "{p:?}");
    let local = stray.clone().closest_with_local_depth(a, b, pose);
    let hinted =
        Tracker::with_previous(p.features, ContactState::Overlapping, a, b).closest_with_local_depth(a, b, pose);
    let warm = stray.closest(a, b, pose);
    let cold = Tracker::new().closest(a, b, pose);
    let swapped = Tracker::new().closest(b, a, &pose.swapped());
    let exact = stray.closest_exact(a, b, pose);
    for o in [&warm, &cold, &swapped, &exact, &local, &hinted] {
        sane(o);
        assert_eq!(o.state, exact.state, "{o:?} {exact:?}");
        assert!(o.lower <= exact.upper && exact.lower <= o.upper, "{o:?} {exact:?}");
    }
    assert_ne!(exact.state, ContactState::Undecided, "{exact:?}");
    assert_eq!(stray.intersects(a, b, pose), exact.state != ContactState::Separated);
    let within = stray.within(a, b, pose, d);
    assert!(within == Tracker::new().within(a, b, pose, d) && (d >= 0.0 || !within));
    assert_eq!(stray.distance(a, b, pose).state, exact.state);
    assert_eq!(stray.check(), Ok(()));
    exact.state
}

/// Asserts that an outcome has no NaN and keeps its promises.
fn sane(o: &Outcome) {
    assert!(o.lower <= o.distance, "{o:?}");
    assert!(o.distance <= o.upper, "{o:?}");
    assert!(o.distance.is_finite(), "{o:?}");
    let numbers = o.point_on_a.iter().chain(o.point_on_b.iter()).chain(o.normal.iter());
    assert!(numbers.copied().all(f64::is_finite), "{o:?}");
    assert!((o.normal.norm() - 1.0).abs() < 1e-14, "{o:?}");
}
