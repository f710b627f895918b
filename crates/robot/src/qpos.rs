//! Configurations as MuJoCo states them.

use std::collections::HashMap;

use lin_canny::nalgebra::Quaternion;
use lin_canny_plan::{MotionKind, PlanError, RobotJoint};

use crate::robot::{QposJoint, Robot};
use crate::turn::{from_xyzw, roll_pitch_yaw, to_roll_pitch_yaw};

impl Robot {
    /// Returns the configuration of MuJoCo's `qpos`, for a robot of an MJCF file.
    ///
    /// A robot of another format has no values in `qpos`.
    ///
    /// The quaternions `w, x, y, z` of free and ball joints may have any length, and become the
    /// angles of `rpy`. Mocap bodies, which have no values in `qpos`, stay where the file draws them.
    /// Values of joints that follow another joint or are held have no effect. Limits are not checked.
    ///
    /// ```
    /// use lin_canny_robot::{LoadOptions, Packages, Robot};
    ///
    /// let text = "<mujoco><worldbody><body><joint name='j' type='ball'/><geom size='1'/></body></worldbody></mujoco>";
    /// let robot = Robot::parse(text, "ball.xml", &Packages::default(), &LoadOptions::default())?;
    /// let q = robot.configuration_of_qpos(&[0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()])?; // a quarter turn about z
    /// assert!((q[2] - 0.5 * std::f64::consts::PI).abs() < 1e-12); // the coordinate j/yaw
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the count is not that of the file, if a number is not finite, or if a
    /// quaternion is zero.
    pub fn configuration_of_qpos(&self, qpos: &[f64]) -> Result<Vec<f64>, PlanError> {
        let wrong = |what, value| Err(PlanError::Value { what, value });
        let joints = self.joints_of_qpos();
        let count: usize = joints.iter().map(|(_, joint)| width(joint)).sum();
        if qpos.len() != count {
            return wrong("number of values of qpos", qpos.len() as f64);
        }
        if let Some(&value) = qpos.iter().find(|x| !x.is_finite()) {
            return wrong("value of qpos", value);
        }
        let mut q = self.start.clone();
        let mut rest = qpos;
        for (_, joint) in joints {
            let (values, after) = rest.split_at(width(joint));
            rest = after;
            let Some(drive) = joint.drive.filter(|_| joint.mimics.is_none()) else {
                continue;
            };
            let mut place = drive.coordinate;
            let (position, turn) = values.split_at(if joint.kind == MotionKind::Ball {
                0
            } else {
                values.len().min(3)
            });
            q[place..place + position.len()].copy_from_slice(position);
            place += position.len();
            if let &[w, x, y, z] = turn {
                let Some(turn) = from_xyzw([x, y, z, w]) else {
                    return wrong("length of a quaternion of qpos", 0.0);
                };
                q[place..place + 3].copy_from_slice(&to_roll_pitch_yaw(&turn));
            }
        }
        Ok(q)
    }

    /// Returns MuJoCo's `qpos` of a configuration, for a robot of an MJCF file.
    ///
    /// It is the inverse of [`Robot::configuration_of_qpos`]: quaternions have length 1, and joints that follow
    /// another one or are held have the values that the equalities give them.
    ///
    /// # Errors
    /// Returns an error if the count is not that of the coordinates, or if a number is not finite.
    pub fn qpos_of_configuration(&self, configuration: &[f64]) -> Result<Vec<f64>, PlanError> {
        let wrong = |what, value| Err(PlanError::Value { what, value });
        if configuration.len() != self.coordinates().len() {
            return wrong("number of coordinates", configuration.len() as f64);
        }
        if let Some(&value) = configuration.iter().find(|x| !x.is_finite()) {
            return wrong("coordinate", value);
        }
        let mut qpos = Vec::new();
        for (at, joint) in self.joints_of_qpos() {
            let Some(drive) = joint.drive else {
                qpos.push(at.rest);
                continue;
            };
            let own = &configuration[drive.coordinate..];
            let angles = match joint.kind {
                MotionKind::Floating => {
                    qpos.extend(&own[..3]);
                    &own[3..6]
                }
                MotionKind::Ball => &own[..3],
                _ if joint.mimics.is_some() => {
                    qpos.push(drive.factor * own[0] + drive.offset + at.rest);
                    continue;
                }
                _ => {
                    qpos.push(own[0]);
                    continue;
                }
            };
            let turn: Quaternion<f64> = roll_pitch_yaw([angles[0], angles[1], angles[2]]).into_inner();
            qpos.extend([turn.w, turn.i, turn.j, turn.k]);
        }
        Ok(qpos)
    }

    fn joints_of_qpos(&self) -> Vec<(&QposJoint, &RobotJoint)> {
        let by_name: HashMap<&str, &RobotJoint> = self.joints().iter().map(|j| (j.name.as_str(), j)).collect();
        let found = self
            .qpos
            .iter()
            .filter_map(|at| Some((at, *by_name.get(at.name.as_str())?)));
        found.collect()
    }
}

/// Returns how many values a joint has.
fn width(joint: &RobotJoint) -> usize {
    match joint.kind {
        MotionKind::Floating => 7,
        MotionKind::Ball => 4,
        _ => 1,
    }
}
