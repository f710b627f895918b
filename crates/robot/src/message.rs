//! Messages `JointTrajectory` of ROS.

use std::path::Path;

use serde_json::{Map, Value};

use crate::error::{FileError, FileErrorKind};
use crate::trajectory::{Trajectory, check_complete, check_limits, check_time, coordinate};
use lin_canny_plan::Coordinate;

/// The fields of a message and of its points; effort is not read.
const FIELDS: &[&str] = &["header", "joint_names", "points"];
const POINT: &[&str] = &["positions", "velocities", "accelerations", "effort", "time_from_start"];

/// Messages around a trajectory: `RobotTrajectory`, `DisplayTrajectory`, goals of an action.
const OUTER: [&str; 3] = ["joint_trajectory", "trajectory", "goal"];

/// Returns the trajectory of a message.
pub(crate) fn read(
    value: &Value,
    path: &Path,
    coordinates: &[Coordinate],
    rest: &[Option<f64>],
) -> Result<Trajectory, FileError> {
    let fail = |element: String, reason| FileError::new(path, None, element, reason);
    let message = trajectory(value).ok_or_else(|| fail(String::new(), missing("joint_names")))?;
    check_fields(message, FIELDS).map_err(|reason| fail(String::new(), reason))?;
    let names = strings(message.get("joint_names")).map_err(|reason| fail("joint_names".into(), reason))?;
    let mut joints = Vec::new();
    for name in names {
        let title = || format!("joint {name:?}");
        let joint = coordinate(name, coordinates).map_err(|reason| fail(title(), reason))?;
        if joints.contains(&joint) {
            return Err(fail(title(), FileErrorKind::Repeated));
        }
        joints.push(joint);
    }
    check_complete(
        coordinates,
        rest,
        |k| joints.contains(&k),
        |name| format!("joint {name:?}"),
    )
    .map_err(|reason| fail(String::new(), reason))?;
    let mut resting: Vec<f64> = rest.iter().map(|value| value.unwrap_or_default()).collect();
    resting.resize(coordinates.len(), 0.0);

    let mut found = Trajectory::default();
    let mut times = Vec::new();
    let points = message.get("points").and_then(Value::as_array);
    for (k, point) in points
        .ok_or_else(|| fail(String::new(), missing("points")))?
        .iter()
        .enumerate()
    {
        let wrong = |what: &str, reason| fail(format!("point {}{what}", k + 1), reason);
        let point = point.as_object().ok_or_else(|| wrong("", missing("positions")))?;
        check_fields(point, POINT).map_err(|reason| wrong("", reason))?;
        let time = seconds(point.get("time_from_start")).map_err(|reason| wrong("", reason))?;
        check_time(times.last(), time).map_err(|reason| wrong("", reason))?;
        times.push(time);
        let list = |field: &str, is_needed: bool| match numbers(point.get(field), field) {
            Ok(list) if list.len() == joints.len() || (list.is_empty() && !is_needed) => Ok(list),
            Ok(list) => {
                let (count, expected) = (list.len(), joints.len());
                let reason = format!("wrong number of {field}: {count} (expected {expected})");
                Err(wrong("", FileErrorKind::Malformed(reason)))
            }
            Err(reason) => Err(wrong("", reason)),
        };
        let mut row = resting.clone();
        for (value, &joint) in list("positions", true)?.into_iter().zip(&joints) {
            check_limits(&coordinates[joint], value).map_err(|reason| wrong("", reason))?;
            row[joint] = value;
        }
        let mut derivatives = Vec::new();
        for field in ["velocities", "accelerations"] {
            let values = list(field, false)?;
            // Joints that the message does not name rest.
            let mut all = vec![
                0.0;
                if values.is_empty() && !joints.is_empty() {
                    0
                } else {
                    row.len()
                }
            ];
            for (value, &joint) in values.into_iter().zip(&joints) {
                all[joint] = value;
            }
            derivatives.push(all);
        }
        let accelerations = derivatives.pop().unwrap_or_default();
        let velocities = derivatives.pop().unwrap_or_default();
        if velocities.is_empty() && !accelerations.is_empty() {
            return Err(wrong("", missing("velocities")));
        }
        found.rows.push(row);
        found.velocities.push(velocities);
        found.accelerations.push(accelerations);
        found.tube.push(Vec::new());
        found.lines.push(k as u32 + 1);
    }
    if found.rows.is_empty() {
        return Err(fail(String::new(), missing("a point")));
    }
    found.times = Some(times);
    Ok(found)
}

/// Returns the trajectory in a message, or in a message around it.
fn trajectory(value: &Value) -> Option<&Map<String, Value>> {
    let mut at = value;
    for _ in 0..=OUTER.len() {
        let fields = at.as_object()?;
        if fields.contains_key("joint_names") {
            return Some(fields);
        }
        at = OUTER.iter().find_map(|name| fields.get(*name))?;
        // Some messages hold a list of trajectories, often of one.
        if let Some([only]) = at.as_array().map(Vec::as_slice) {
            at = only;
        }
    }
    None
}

fn missing(what: &str) -> FileErrorKind {
    FileErrorKind::Missing(what.into())
}

fn check_fields(fields: &Map<String, Value>, expected: &'static [&'static str]) -> Result<(), FileErrorKind> {
    match fields.keys().find(|name| !expected.contains(&name.as_str())) {
        Some(name) => Err(FileErrorKind::UnknownPart {
            what: "field",
            name: name.clone(),
            expected,
        }),
        None => Ok(()),
    }
}

fn strings(value: Option<&Value>) -> Result<Vec<&str>, FileErrorKind> {
    let list = value
        .and_then(Value::as_array)
        .ok_or_else(|| missing("a list of names"))?;
    let names = list.iter().map(Value::as_str);
    names.collect::<Option<_>>().ok_or_else(|| missing("a name"))
}

fn numbers(value: Option<&Value>, field: &str) -> Result<Vec<f64>, FileErrorKind> {
    let empty = Vec::new();
    let list = match value {
        None | Some(Value::Null) => &empty,
        Some(Value::Array(list)) => list,
        Some(other) => return Err(no_number(field, other)),
    };
    let number = |x: &Value| x.as_f64().filter(|x| x.is_finite()).ok_or_else(|| no_number(field, x));
    list.iter().map(number).collect()
}

fn no_number(field: &str, value: &Value) -> FileErrorKind {
    FileErrorKind::Number {
        field: field.into(),
        count: 1,
        text: value.to_string(),
    }
}

/// Returns a duration in seconds: a number, or the seconds and nanoseconds of ROS 1 or 2.
fn seconds(value: Option<&Value>) -> Result<f64, FileErrorKind> {
    let field = "time_from_start";
    let value = value.ok_or_else(|| missing(field))?;
    let part = |names: [&str; 2]| {
        let found = names.iter().find_map(|name| value.get(*name));
        found.map_or(Ok(0.0), |x| x.as_f64().ok_or_else(|| no_number(field, x)))
    };
    match value {
        Value::Object(fields) if !fields.is_empty() => Ok(part(["sec", "secs"])? + 1e-9 * part(["nanosec", "nsecs"])?),
        _ => value
            .as_f64()
            .filter(|x| x.is_finite())
            .ok_or_else(|| no_number(field, value)),
    }
}
