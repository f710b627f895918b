//! The values of options: one parser for each quantity. A value that it refuses is a wrong argument.

use std::path::PathBuf;
use std::time::Duration;

use lin_canny::nalgebra::{Isometry3, Translation3, UnitQuaternion};

/// Returns a length, an angle or another finite number, at least 0.
pub fn not_negative(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().map_err(|e| e.to_string())?;
    let value = Some(value).filter(|x| (0.0..f64::INFINITY).contains(x));
    value.ok_or("expected a finite number, at least 0".into())
}

/// Returns the time of a number of seconds.
pub fn duration(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().map_err(|e| e.to_string())?;
    Duration::try_from_secs_f64(seconds).map_err(|e| e.to_string())
}

/// Returns a share of a quantity, below 1.
pub fn share(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().map_err(|e| e.to_string())?;
    let value = Some(value).filter(|x| (0.0..1.0).contains(x));
    value.ok_or("expected a number from 0 to below 1".into())
}

/// Returns a name and a number, such as `post=0.01`.
pub fn named_number(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.rsplit_once('=').ok_or("expected a name, = and a number")?;
    Ok((name.into(), not_negative(value)?))
}

/// Returns a name and a finite number.
pub fn joint_value(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.rsplit_once('=').ok_or("expected a joint, = and a number")?;
    let value = value.parse().ok().filter(|x: &f64| x.is_finite());
    Ok((name.into(), value.ok_or("expected a finite number")?))
}

/// Returns a link and a file.
pub fn attachment(text: &str) -> Result<(String, PathBuf), String> {
    let (link, file) = text.split_once('=').ok_or("expected LINK=FILE.json")?;
    Ok((link.into(), file.into()))
}

/// Returns a prefix of names and a file.
pub fn prefixed_file(text: &str) -> Result<(String, PathBuf), String> {
    let (prefix, file) = text.split_once('=').ok_or("expected PREFIX=FILE")?;
    match prefix {
        "" => Err("the prefix is empty".into()),
        _ => Ok((prefix.into(), file.into())),
    }
}

/// Returns a prefix of names and a pose.
pub fn prefixed_pose(text: &str) -> Result<(String, Isometry3<f64>), String> {
    let (prefix, pose) = text.split_once('=').ok_or("expected PREFIX=X,Y,Z[,ROLL,PITCH,YAW]")?;
    let numbers = pose
        .split(',')
        .map(|x| x.trim().parse::<f64>().map_err(|e| format!("{x:?}: {e}")));
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let [x, y, z, ref rpy @ ..] = numbers[..] else {
        return Err(format!("{} numbers (expected 3 or 6)", numbers.len()));
    };
    let [roll, pitch, yaw] = match *rpy {
        [] => [0.0; 3],
        [roll, pitch, yaw] => [roll, pitch, yaw],
        _ => return Err(format!("{} numbers (expected 3 or 6)", numbers.len())),
    };
    if let Some(number) = numbers.iter().find(|x| !x.is_finite()) {
        return Err(format!("number is not finite: {number}"));
    }
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok((prefix.into(), Isometry3::from_parts(Translation3::new(x, y, z), turn)))
}

/// Returns two names.
pub fn name_pair(text: &str) -> Result<[String; 2], String> {
    let (a, b) = text
        .split_once(',')
        .ok_or("expected two names with a comma between them")?;
    Ok([a.into(), b.into()])
}

/// A limit of all joints, or of one.
pub type Limit = (Option<String>, f64);

/// Returns a limit of all joints, or of one.
pub fn limit(text: &str) -> Result<Limit, String> {
    match text.rsplit_once('=') {
        Some((name, value)) => Ok((Some(name.into()), not_negative(value)?)),
        None => Ok((None, not_negative(text)?)),
    }
}

/// Returns a file that a cover is written to.
pub fn cover_file(name: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(name);
    match file.extension().and_then(|e| e.to_str()) {
        Some("urdf" | "json") => Ok(file),
        _ => Err("expected a name that ends with .urdf or .json".into()),
    }
}
