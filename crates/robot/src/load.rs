//! The functions that pick the reader of a file, of robots, cells and trajectories.

use std::path::Path;

use lin_canny::GeometryKind;

use crate::cell::CellFile;
use crate::error::{FileError, FileErrorKind};
use crate::geometry::Solid;
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::Robot;
use crate::trajectory::Trajectory;
use crate::xml::Xml;
use crate::xml_text::XmlText;
use crate::{message, mjcf, sdformat, urdf, yaml};
use lin_canny_plan::{Coordinate, MotionKind};

impl Robot {
    /// Returns the robot of a file; meshes are replaced by their hulls. The root element decides
    /// the format: URDF (`robot`) or MJCF (`mujoco`).
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is not a valid robot. The error names the
    /// file, the line and the element.
    pub fn load(path: impl AsRef<Path>, packages: &Packages) -> Result<Self, FileError> {
        Self::load_with(path, packages, &LoadOptions::default())
    }

    /// Returns the robot of a file, with options.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_with(path: impl AsRef<Path>, packages: &Packages, options: &LoadOptions) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, packages, options)
    }

    /// Returns the robot of the text of a file. Errors name the file `path`, and relative mesh
    /// paths are relative to its folder.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(
        text: &str,
        path: impl AsRef<Path>,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        let text = XmlText::new(text);
        let xml = Xml::parse(path, &text)?;
        let infinite = options.clone().plane_extent(f64::INFINITY);
        let mut robot = match xml.root().tag_name().name() {
            "robot" => urdf::read(&xml, packages, options),
            "mujoco" => mjcf::read(&xml, &infinite),
            "sdf" => sdformat::read(&xml, packages, &infinite),
            _ => Err(xml.unknown_root("robot, mujoco or sdf")),
        }?;
        robot.skipped.splice(0..0, xml.skipped());
        robot.bound_planes(options.plane_extent, path)?;
        Ok(robot)
    }

    /// Replaces the half-spaces of links that a joint moves by boxes: a body that moves is bounded.
    fn bound_planes(&mut self, extent: f64, path: &Path) -> Result<(), FileError> {
        let mut is_at_rest = vec![true; self.model.links.len()];
        for (k, joint) in self.model.joints.iter().enumerate() {
            is_at_rest[k + 1] = is_at_rest[joint.parent] && joint.kind == MotionKind::Fixed;
        }
        let moving = self
            .model
            .links
            .iter_mut()
            .zip(is_at_rest)
            .filter(|(_, is_at_rest)| !is_at_rest);
        for (link, _) in moving {
            for body in &mut link.bodies {
                if body.geometry.kind() == GeometryKind::HalfSpace {
                    let bounded = Solid::HalfSpace { extent }.geometry();
                    let element = || format!("link {:?}", link.name);
                    body.geometry = bounded.map_err(|reason| FileError::new(path, None, element(), reason))?;
                }
            }
        }
        Ok(())
    }
}

impl CellFile {
    /// Returns the cell of a JSON or SDFormat file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or a body is invalid. The error names the line
    /// or the body.
    pub fn load(path: impl AsRef<Path>, packages: &Packages, options: &LoadOptions) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, packages, options)
    }

    /// Returns the cell of a JSON or SDFormat text. Errors name the file `path`, and mesh paths are
    /// relative to its folder.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(
        text: &str,
        path: impl AsRef<Path>,
        packages: &Packages,
        options: &LoadOptions,
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
            let text = XmlText::new(text);
            let xml = Xml::parse(path, &text)?;
            let (obstacles, mut skipped) = sdformat::obstacles(&xml, packages, options)?;
            skipped.extend(xml.skipped());
            return Ok(Self {
                file: path.into(),
                obstacles,
                skipped,
                ..Self::default()
            });
        }
        Self::from_json(text, path, packages, options)
    }
}

impl Trajectory {
    /// Returns a trajectory with times, and optionally velocities, accelerations and tubes.
    ///
    /// The extension of the file decides its format:
    ///
    /// * `csv`: the columns of [`load`](Self::load) with `time`. Joint `elbow` has the optional
    ///   columns `elbow.velocity` and `elbow.acceleration`. All joints have velocities if one has,
    ///   and likewise accelerations, which need velocities. A joint may have a column `elbow.tube`:
    ///   how much it may deviate from the motion, at least 0, linear between the rows.
    /// * `json`, `yaml` or `yml`: a message `JointTrajectory` of ROS 1 or 2, alone or as the
    ///   `joint_trajectory` of another message. Names may be in any order. Of YAML, everything but
    ///   anchors, aliases, tags and complex keys is read.
    ///
    /// A coordinate that the file does not name has its value of `rest`, as in
    /// [`load_with_rest`](Self::load_with_rest), and stays there.
    ///
    /// # Errors
    /// As [`load`](Self::load), or if there are no times. The error names the line of a CSV file,
    /// or the number of the point, counted from 1.
    pub fn load_timed(
        path: impl AsRef<Path>,
        coordinates: &[Coordinate],
        rest: &[Option<f64>],
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse_timed(&FileError::read(path)?, path, coordinates, rest)
    }

    /// Returns the trajectory of a text, as [`load_timed`](Self::load_timed) does. The extension of
    /// `path` decides the format; errors name it.
    ///
    /// # Errors
    /// As [`load_timed`](Self::load_timed).
    pub fn parse_timed(
        text: &str,
        path: impl AsRef<Path>,
        coordinates: &[Coordinate],
        rest: &[Option<f64>],
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        let malformed = |line, text| FileError::new(path, line, "", FileErrorKind::Malformed(text));
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("csv") => Self::read(text, path, coordinates, rest, true),
            Some("json") => {
                let value = serde_json::from_str(text).map_err(|e| malformed(Some(e.line() as u32), e.to_string()))?;
                message::read(&value, path, coordinates, rest)
            }
            Some("yaml" | "yml") => {
                let value = yaml::parse(text).map_err(|(line, reason)| malformed(Some(line), reason))?;
                message::read(&value, path, coordinates, rest)
            }
            _ => Err(malformed(
                None,
                "extension of a trajectory is unknown (expected csv, json, yaml or yml)".into(),
            )),
        }
    }
}
