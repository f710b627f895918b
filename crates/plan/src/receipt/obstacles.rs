//! Moving obstacles in a receipt: each is carried by its chain of joints.
//!
//! Between two rows of its [`TimedPoses`] an obstacle shifts along a straight line and turns about one axis, both in
//! proportion to time. So three sliding joints carry it, then one turning joint for each row that turns it, the last
//! of them first, then the rotation of its first pose. Their coordinates follow those of the robot. A piece of the
//! motion is cut at the times of the rows, so that along each leg every coordinate is linear in time: the checkers
//! need no form of their own. What is rounded is the statement: control points of cut curves, the coordinates at the
//! cuts, and the product of the rotations.

use nalgebra::{Isometry3, Translation3, Unit, Vector3};

use super::scene::{Scene, Way};
use crate::extremes::Extremes;
use crate::motion::joint::{Drive, JointKind, TreeJoint};
use crate::motion::joint_motion::JointMotion;
use crate::motion::timed_poses::TimedPoses;

/// The obstacles that move, and the coordinates that drive them.
#[derive(Default)]
pub(super) struct Obstacles<'a> {
    all: Vec<Carried<'a>>,
}

/// An obstacle and the rows that turn it.
struct Carried<'a> {
    poses: &'a TimedPoses,
    turns: Vec<[f64; 2]>,
}

impl<'a> Obstacles<'a> {
    /// Adds the joints of an obstacle that moves between two times, and returns how it moves.
    pub(super) fn carry(
        &mut self,
        scene: &mut Scene,
        poses: &'a TimedPoses,
        [begin, end]: [f64; 2],
        robot: usize,
    ) -> Way {
        let first = robot + self.all.iter().map(|one| 3 + one.turns.len()).sum::<usize>();
        let turning = poses.turns([begin, end]);
        let mut link = 0;
        let mut joint = |kind, axis: Vector3<f64>, coordinate| {
            // The base of the robot comes before all joints.
            let origin = if link == 0 {
                scene.base().inverse()
            } else {
                Isometry3::identity()
            };
            let (axis, length) = Unit::new_and_get(axis);
            let drive = Drive {
                coordinate,
                factor: length,
                offset: 0.0,
            };
            let joint = TreeJoint {
                parent: link,
                kind,
                origin,
                axis,
                drive: Some(drive),
            };
            link = scene.add_joint(joint);
        };
        for k in 0..3 {
            joint(JointKind::Prismatic, Vector3::ith(k, 1.0), first + k);
        }
        for (k, (_, turn)) in turning.iter().enumerate().rev() {
            joint(JointKind::Revolute, *turn, first + 3 + k);
        }
        let turns = turning.into_iter().map(|(times, _)| times).collect();
        self.all.push(Carried { poses, turns });
        let start = poses.rotation_before(begin);
        Way::Link(link, Some(Isometry3::from_parts(Translation3::identity(), start)))
    }

    /// Returns the legs of a piece of the motion: the part of its time from 0 to 1, and the control points.
    pub(super) fn legs(&self, motion: &JointMotion, piece: usize) -> Vec<([f64; 2], Vec<Vec<f64>>)> {
        let mut rows = motion.control_points(piece);
        let Some([begin, end]) = motion.times(piece).filter(|_| !self.all.is_empty()) else {
            return vec![([0.0, 1.0], rows)];
        };
        let times = self.all.iter().flat_map(|one| one.poses.times()).copied();
        let mut cuts: Vec<f64> = times.filter(|t| begin < *t && *t < end).collect();
        cuts.sort_unstable_by(f64::total_cmp);
        cuts.dedup();
        cuts.push(end);
        let (mut legs, mut at) = (Vec::new(), begin);
        for cut in cuts {
            let mut leg = match cut < end {
                true => split(&mut rows, (cut - at) / (end - at)),
                false => std::mem::take(&mut rows),
            };
            let [from, to] = [at, cut].map(|time| self.coordinates(time));
            let last = (leg.len() - 1).max(1) as f64;
            for (k, row) in leg.iter_mut().enumerate() {
                let part = k as f64 / last;
                row.extend(
                    from.iter()
                        .zip(&to)
                        .map(|(x, y)| if part < 1.0 { x + (y - x) * part } else { *y }),
                );
            }
            let part = |time: f64| {
                if time < end {
                    (time - begin) / (end - begin)
                } else {
                    1.0
                }
            };
            legs.push(([at, cut].map(part), leg));
            at = cut;
        }
        legs
    }

    /// Returns the coordinates of all obstacles at a time.
    fn coordinates(&self, time: f64) -> Vec<f64> {
        let of = |one: &Carried<'_>| {
            let place = one.poses.at(time).map_or(Vector3::zeros(), |at| at.translation.vector);
            let turned = |[from, to]: &[f64; 2]| ((time - from) / (to - from)).larger(0.0).smaller(1.0);
            place
                .iter()
                .copied()
                .chain(one.turns.iter().map(turned))
                .collect::<Vec<f64>>()
        };
        self.all.iter().flat_map(of).collect()
    }
}

/// Cuts off the part of a Bezier curve before a parameter, by de Casteljau's algorithm, and leaves the rest.
fn split(rows: &mut [Vec<f64>], at: f64) -> Vec<Vec<f64>> {
    let mut before = vec![rows[0].clone()];
    for left in (1..rows.len()).rev() {
        for k in 0..left {
            let (row, next) = (&rows[k], &rows[k + 1]);
            rows[k] = row.iter().zip(next).map(|(x, y)| x + (y - x) * at).collect();
        }
        before.push(rows[0].clone());
    }
    before
}

#[cfg(test)]
mod tests {
    use super::super::scene::Body;
    use super::super::taylor::pose;
    use super::*;
    use crate::motion::curve::JointCurve;
    use lin_canny::Geometry;
    use lin_canny::nalgebra::{Translation3, UnitQuaternion};
    use lin_canny::polyhedron::solids;
    use truth::rng::Rng;

    /// The poses that a receipt states are those of the obstacles at the same times on the clock, and the coordinates of
    /// the robot those of its motion.
    #[test]
    fn stated_poses_are_those_of_the_obstacles() {
        let mut rng = Rng::new(3);
        let die = Geometry::from(solids::cuboid(Vector3::repeat(0.5)).expect("a box"));
        for _ in 0..100 {
            let any = |rng: &mut Rng| {
                let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
                Isometry3::from_parts(Translation3::from(Vector3::from(rng.unit())), turn)
            };
            let timed = |rng: &mut Rng| {
                let mut times = vec![-rng.uniform()];
                let mut poses = vec![any(rng)];
                while times[times.len() - 1] < 2.0 {
                    times.push(times[times.len() - 1] + rng.range(0.05, 1.0));
                    let next = any(rng);
                    poses.push(if rng.chance(0.2) { poses[poses.len() - 1] } else { next });
                }
                TimedPoses::new(&times, &poses).expect("timed poses")
            };
            let all = [timed(&mut rng), timed(&mut rng)];
            let points: Vec<[f64; 2]> = (0..1 + rng.below(4)).map(|_| [rng.uniform(), rng.uniform()]).collect();
            let curves: Vec<JointCurve> = [[0.0, 1.0], [1.0, 2.0]]
                .map(|ends| {
                    JointCurve::bezier(&points)
                        .and_then(|curve| curve.with_times(ends))
                        .expect("a curve")
                })
                .into();
            let (mut scene, mut obstacles) = (Scene::default(), Obstacles::default());
            for poses in &all {
                let way = obstacles.carry(&mut scene, poses, [0.0, 2.0], 2);
                scene.bodies.push(Body::new("die", &die, way, 0).expect("a body"));
            }
            for (piece, curve) in curves.iter().enumerate() {
                let mut end = 0.0;
                for ([from, until], rows) in obstacles.legs(&JointMotion::curve(curve), 0) {
                    assert!(from == end && until > from);
                    end = until;
                    let s = rng.uniform();
                    let part = from + (until - from) * s;
                    for (body, poses) in all.iter().enumerate() {
                        let want = poses.at(piece as f64 + part).expect("a pose");
                        let stated = pose(&scene.steps(body, Some(&rows)), s);
                        let off = (stated.inverse() * want).to_homogeneous() - Isometry3::identity().to_homogeneous();
                        assert!(off.amax() < 1e-13, "{off}");
                    }
                    let robot: Vec<Vec<f64>> = rows.iter().map(|row| row[..2].to_vec()).collect();
                    let now = JointCurve::bezier(&robot).expect("a curve").at(s);
                    let off = now.iter().zip(curve.at(part)).map(|(x, y)| (x - y).abs());
                    assert!(off.fold(0.0, f64::larger) < 1e-14);
                }
                assert!(end == 1.0);
            }
        }
    }
}
