//! Rotations by angles, with sine and cosine of `libm`.
//!
//! The functions of the C library differ between targets in the last bit.

use lin_canny::nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};

/// Returns the rotation about an axis by an angle in radians.
pub(crate) fn about(axis: &Unit<Vector3<f64>>, angle: f64) -> UnitQuaternion<f64> {
    let (sine, cosine) = libm::sincos(0.5 * angle);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, axis.into_inner() * sine))
}

/// Returns the rotation by roll about x, then pitch about y, then yaw about z, in radians.
///
/// The axes are those of the frame around it, which do not turn. Ball and floating joints have these
/// three angles as coordinates.
#[must_use]
pub fn roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> UnitQuaternion<f64> {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|angle| libm::sincos(0.5 * angle));
    UnitQuaternion::new_unchecked(Quaternion::new(
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ))
}

/// Returns the rotation of a quaternion `x, y, z, w` of any length.
///
/// Returns `None` for a quaternion that is zero or not finite.
pub(crate) fn from_xyzw(xyzw: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    Some(Unit::new_normalize(Quaternion::from(moderate(xyzw)?)))
}

/// Returns roll, pitch and yaw of a rotation, in radians: the inverse of [`roll_pitch_yaw`].
///
/// Roll and yaw are within half a turn each way, pitch within a quarter turn. At a pitch of a
/// quarter turn, where roll and yaw are not unique, their rotation still is.
#[must_use]
pub fn to_roll_pitch_yaw(turn: &UnitQuaternion<f64>) -> [f64; 3] {
    let m = turn.to_rotation_matrix().into_inner();
    let yaw = libm::atan2(m[(1, 0)], m[(0, 0)]);
    let (sine, cosine) = libm::sincos(yaw);
    // The first two rows without the yaw.
    let x = m.row(0) * cosine + m.row(1) * sine;
    let y = m.row(1) * cosine - m.row(0) * sine;
    [libm::atan2(-y[2], y[1]), libm::atan2(-m[(2, 0)], x[0]), yaw]
}

/// Returns the direction of a vector of any length.
///
/// Returns `None` for a vector that is zero or not finite.
pub(crate) fn direction(xyz: [f64; 3]) -> Option<Unit<Vector3<f64>>> {
    Some(Unit::new_normalize(Vector3::from(moderate(xyz)?)))
}

/// Returns numbers in these proportions whose squares neither overflow nor underflow.
fn moderate<const N: usize>(numbers: [f64; N]) -> Option<[f64; N]> {
    let largest = numbers
        .iter()
        .fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most });
    let is_finite = numbers.iter().all(|x| x.is_finite());
    match largest {
        0.0 => None,
        _ if !is_finite => None,
        1e-100..=1e100 => Some(numbers),
        _ => Some(numbers.map(|x| x / largest)),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use lin_canny_plan::turn_from_z;

    use super::*;

    #[test]
    fn rotations_are_those_of_nalgebra_up_to_rounding() {
        for k in 0..500 {
            let f = f64::from(k);
            let axis = Unit::new_normalize(Vector3::new((f * 1.1).sin(), (f * 0.7).cos(), (f * 0.3).sin()));
            let angle = 0.037 * f - 9.0;
            let near =
                |p: UnitQuaternion<f64>, q: UnitQuaternion<f64>| (p.into_inner() - q.into_inner()).norm() < 1e-15;
            assert!(near(about(&axis, angle), UnitQuaternion::from_axis_angle(&axis, angle)));
            let [roll, pitch, yaw] = [angle, 0.3 * angle, 1.7 - angle];
            let expected = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            assert!(near(roll_pitch_yaw([roll, pitch, yaw]), expected));
            let back = roll_pitch_yaw(to_roll_pitch_yaw(&expected));
            assert!(back.angle_to(&expected) < 1e-12);
            let quarter = if k % 2 == 0 { 0.5 } else { -0.5 } * PI;
            for off in [0.0, 1e-15, 1e-9, 1e-5] {
                let steep = roll_pitch_yaw([roll, quarter + off, yaw]);
                assert!(
                    roll_pitch_yaw(to_roll_pitch_yaw(&steep)).angle_to(&steep) < 1e-12,
                    "{off}"
                );
            }
            assert!((turn_from_z(&axis) * Vector3::z() - axis.into_inner()).norm() < 1e-15);
        }
    }

    #[test]
    fn quaternions_and_directions_of_every_length_are_normalised() {
        let near = |x: f64, y: f64| (x - y).abs() < 1e-15;
        let half = 0.5f64.sqrt();
        for length in [5e-324, 1e-200, 1e-90, 1e-3, 1.0, 7.0, 1e90, 1e200, f64::MAX] {
            let q = from_xyzw([0.0, 0.0, length, -length]).expect("a rotation");
            assert!(near(q.k, half) && near(q.w, -half) && q.i == 0.0, "{length:e}: {q}");
            let d = direction([length, 0.0, -length]).expect("a direction");
            assert!(near(d.x, half) && near(d.z, -half) && d.y == 0.0, "{length:e}: {d:?}");
        }
        for wrong in [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for k in 0..4 {
                let mut xyzw = [0.0; 4];
                xyzw[k] = wrong;
                assert_eq!(from_xyzw(xyzw), None);
                if wrong != 0.0 {
                    xyzw[(k + 1) % 4] = 1.0;
                    assert_eq!(from_xyzw(xyzw), None);
                    assert_eq!(direction([1.0, 2.0, wrong]), None);
                }
            }
        }
        assert_eq!(direction([0.0; 3]), None);
    }

    #[test]
    fn the_opposite_of_z_is_reached_by_half_a_turn() {
        for x in [0.0, 1e-300, 1e-17, 1e-12, 1e-6] {
            let to = Unit::new_normalize(Vector3::new(x, 0.0, -1.0));
            assert!(
                (turn_from_z(&to) * Vector3::z() - to.into_inner()).norm() < 1e-15,
                "{x:e}"
            );
        }
        assert_eq!(turn_from_z(&Vector3::z_axis()), UnitQuaternion::identity());
    }

    /// The bits of these rotations affect every result for a robot. They are the same on every
    /// target.
    #[test]
    fn rotations_have_the_bits_written_here() {
        let bits = |q: UnitQuaternion<f64>| <[f64; 4]>::from(q.coords).map(f64::to_bits);
        let axis = Unit::new_unchecked(Vector3::new(0.6, -0.64, 0.48));
        let found = [
            bits(about(&Vector3::z_axis(), 2.0 * 0.852_414_288_181_566_1)),
            bits(about(&axis, 1.234_567_890_123)),
            bits(roll_pitch_yaw([0.1, -2.2, 3.3])),
            bits(roll_pitch_yaw([1.5, 0.704, -0.917])),
            bits(turn_from_z(&axis)),
        ];
        assert_eq!(found, PINNED, "{found:x?}");
    }

    const PINNED: [[u64; 4]; 5] = [
        [
            0x0000_0000_0000_0000,
            0x0000_0000_0000_0000,
            0x3fe8_1786_306e_3aaf,
            0x3fe5_0fb5_1d4d_8bb0,
        ],
        [
            0x3fd6_3a0e_783f_66ff,
            0xbfd7_b564_c487_e555,
            0x3fd1_c80b_9365_ebff,
            0x3fea_1832_1921_b0a6,
        ],
        [
            0x3fec_5617_f29f_6a86,
            0x3fb7_d070_781c_1989,
            0x3fdc_ad6b_f7b5_2a91,
            0xbfb4_8b04_8bf9_7521,
        ],
        [
            0x3fe5_eeea_13c7_d1ba,
            0xbfad_2cf2_e1a8_10ec,
            0xbfe0_78ad_9fe9_ba6f,
            0x3fe0_613f_0d91_7f52,
        ],
        [
            0x3fd7_ceb9_6550_443b,
            0x3fd6_51cd_cefb_3ff6,
            0x8000_0000_0000_0000,
            0x3feb_8706_5d24_cee3,
        ],
    ];
}
