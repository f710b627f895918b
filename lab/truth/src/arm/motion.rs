//! Motion of the arm: the built-in arm carries a part from bin to bin, any other robot swings its
//! joints.

use std::f64::consts::{PI, TAU};

/// Path of the tip of the gripper, in metres: home, into the left bin, over the fence into the
/// right bin, behind the post, home.
const WAY: [[f64; 3]; 11] = [
    [0.45, 0.0, 0.50],
    [0.55, -0.38, 0.30],
    [0.55, -0.38, 0.08],
    [0.55, -0.38, 0.30],
    [0.58, 0.0, 0.36],
    [0.55, 0.38, 0.30],
    [0.55, 0.38, 0.08],
    [0.55, 0.38, 0.30],
    [0.26, 0.56, 0.40],
    [0.36, 0.25, 0.55],
    [0.45, 0.0, 0.50],
];

/// Lengths of the built-in arm: height of the joint `lift`, and distances from there to `elbow`,
/// from there to `bend`, and from there to the tip of the gripper.
const LENGTHS: [f64; 4] = [0.32, 0.45, 0.55, 0.235];

/// Returns the joints of the built-in arm at a time from 0 to 1.
pub fn carry(time: f64) -> Vec<f64> {
    let last = WAY.len() - 1;
    let along = (time.clamp(0.0, 1.0) * last as f64).min(last as f64 - 1e-9);
    let k = along as usize;
    // Slow at both ends of every segment.
    let part = 0.5 - 0.5 * ((along - k as f64) * PI).cos();
    let tip = [0, 1, 2].map(|i| WAY[k][i] + (WAY[k + 1][i] - WAY[k][i]) * part);
    joints(tip)
}

/// Returns the joints that bring the tip to a position with the gripper pointing down: two links in
/// a vertical plane (law of cosines).
fn joints([x, y, z]: [f64; 3]) -> Vec<f64> {
    let [shoulder, upper, fore, hand] = LENGTHS;
    let (out, up) = (x.hypot(y), z + hand - shoulder);
    let cosine = (out * out + up * up - upper * upper - fore * fore) / (2.0 * upper * fore);
    let elbow = cosine.clamp(-1.0, 1.0).acos();
    let lift = out.atan2(up) - (fore * elbow.sin()).atan2(upper + fore * elbow.cos());
    vec![y.atan2(x), lift, elbow, 0.0, PI - lift - elbow, 0.0]
}

/// Returns the joints of any robot: each swings about the middle of its limits through a third of
/// them, at one of three rates.
pub fn swing(limits: &[[f64; 2]], time: f64) -> Vec<f64> {
    let each = limits.iter().zip(1u32..);
    each.map(|([low, high], k)| {
        let phase = TAU * time * f64::from(k % 3 + 1);
        0.5 * (low + high) + 0.5 * (high - low) / 3.0 * phase.sin()
    })
    .collect()
}
