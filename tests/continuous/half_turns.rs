//! Half turns: a mesh over a frame rotates like `Steady::between` of its poses.

use lin_canny::Mesh;
use lin_canny::continuous::{self, MovingMesh};
use lin_canny::impact::{Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Unit, UnitQuaternion, Vector3};
use truth::forms::mesh;
use truth::rng::Rng;
use truth::soups;

/// Returns a quaternion as a pose, with a length that is off by rounding or by the accepted
/// tolerance.
fn turned(q: Quaternion<f64>, length: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Vector3::zeros().into(), Unit::new_unchecked(q * length))
}

/// A small body at the halfway position of the tip of a blade, or on the opposite side.
#[test]
fn a_mesh_turns_half_round_as_the_motion_of_its_poses_does() {
    let tip = Point3::new(1.0, 0.0, 0.0);
    let corners = [tip, Point3::new(0.8, 0.02, 0.0), Point3::new(0.8, 0.0, 0.02)];
    let blade = Mesh::new(&corners, &[[0, 1, 2]]).unwrap();
    let stone = mesh(&soups::rock(1, 3).map(|p| p.map(|x| 0.05 * x)));
    let still = MovingMesh::new(&stone, &stone).unwrap();
    let mut rng = Rng::new(71);
    let (mut exact, mut back) = (0, 0);
    for round in 0..400 {
        let first = UnitQuaternion::new_normalize(Quaternion::from(rng.quat())).into_inner();
        let across = (UnitQuaternion::new_unchecked(first) * tip)
            .coords
            .cross(&Vector3::from(rng.unit()));
        let axis = Unit::new_normalize(across).into_inner();
        // Exactly half a turn in `f64`, or off by some roundings.
        let beside = [0.0, 0.0, 1e-17, -1e-17, 1e-16, -1e-15][round % 6];
        let last = Quaternion::from_parts(beside, axis) * first;
        let lengths = [0, 1].map(|_| 1.0 + [0.0, 1e-16, 3e-13][round % 3] * rng.range(-1.0, 1.0));
        let (begin, end) = (turned(first, lengths[0]), turned(last, lengths[1]));
        let motion = Steady::between(&begin, &end, 1.0, Point3::origin()).unwrap();
        let middle = motion.pose(0.5) * tip;
        exact += usize::from(first.dot(&last) == 0.0);
        back += usize::from(first.dot(&last) < 0.0);
        let moving = MovingMesh::new(&blade, &blade)
            .unwrap()
            .with_poses(&begin, &end)
            .unwrap();
        for side in [1.0, -1.0] {
            let at = Isometry3::from_parts((middle.coords * side).into(), UnitQuaternion::identity());
            let still = still.clone().with_poses(&at, &at).unwrap();
            let impact = continuous::cast_meshes(&moving, &still, Tolerance::Time(1e-6))
                .unwrap()
                .impact;
            let is_hit = matches!(impact, Impact::Hit { safe, .. } if (0.4..0.5).contains(&safe));
            let is_right = if side > 0.0 { is_hit } else { impact == Impact::Miss };
            assert!(is_right, "{round}, side {side}: {impact:?}, {begin:?} {end:?}");
        }
    }
    assert!(exact > 20 && back > 50, "{exact} {back}");
}
