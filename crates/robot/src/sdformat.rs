//! Converts the SDFormat of a robot or world to a robot.

use crate::error::{FileError, FileErrorKind};
use crate::options::LoadOptions;
use crate::packages::Packages;
use crate::robot::Robot;
use crate::xml::Xml;

pub(crate) fn read(xml: &Xml, _packages: &Packages, _options: &LoadOptions) -> Result<Robot, FileError> {
    Err(xml.error(&xml.root(), FileErrorKind::Unsupported("SDFormat".into())))
}
