//! Balls that contain the links of a robot, and balls inside them, as URDF and JSON.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use lin_canny::cover::{Ball, BallCover, CoverError, CoverGoal, cover_inside, cover_outside};
use lin_canny::nalgebra::Isometry3;
use roxmltree::Node;
use serde_json::{Map, Value, json};

use crate::error::{FileError, FileErrorKind};
use crate::robot::Robot;
use crate::xml::Xml;
use crate::xml_text::XmlText;
use lin_canny_plan::LinkBody;

/// Error of a centre that is placed in the frame of its link, in units of the two distances that
/// add up: the squared norm of a rotation errs by 1e-12, and the rest is rounding.
const PLACED: f64 = 2e-12;

/// The balls of a link, in the frame of the link.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct LinkCover {
    /// Name of the link.
    pub link: String,
    /// Balls whose union contains all bodies of the link. No ball sticks out of its body by more
    /// than the gap.
    pub outside: BallCover,
    /// Balls that are each inside a body of the link; `None` if no body has an inside. No point of
    /// a body with an inside is farther from the balls than the gap.
    pub inside: Option<BallCover>,
}

/// Error of the cover of a link: the link, the body of the link, and the reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("link {link:?}, body {body}: {reason}")]
#[non_exhaustive]
pub struct LinkCoverError {
    /// Name of the link.
    pub link: String,
    /// Index of the body in [`RobotLink::bodies`](crate::RobotLink::bodies).
    pub body: usize,
    /// The reason.
    pub reason: CoverError,
}

/// Returns balls around and inside the links of a robot, for planners that know only spheres.
///
/// Each body of a link (each collision element) is covered by itself: `goal` is that of a body, and
/// `inner` the largest number of balls inside a body. The result has a row for each link with
/// bodies, in the order of [`Robot::links`]. Bodies are those of the robot: the hull of a mesh, or
/// its triangles with [`MeshUse::Mesh`](crate::MeshUse::Mesh).
///
/// A planner that keeps the outer balls free keeps the robot free, and one whose inner ball meets
/// an obstacle is in collision. Both are proven, rounding included: see [`lin_canny::cover`].
///
/// ```
/// use lin_canny::cover::CoverGoal;
/// use lin_canny_robot::{Packages, Robot, cover_links};
///
/// let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/gripper.urdf");
/// let robot = Robot::load(urdf, &Packages::default())?;
/// for cover in cover_links(&robot, CoverGoal::Balls(4), 2)? {
///     assert!(cover.outside.gap < 0.2, "{}", cover.link);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// Returns an error if a goal is out of range or not reached, or if a link has a half-space. The
/// error names the link and the body.
pub fn cover_links(robot: &Robot, goal: CoverGoal, inner: usize) -> Result<Vec<LinkCover>, LinkCoverError> {
    let mut covers = Vec::new();
    for link in robot.links() {
        let (mut outside, mut inside) = (None, None);
        for (k, body) in link.bodies.iter().enumerate() {
            let wrong = |reason: CoverError| LinkCoverError {
                link: link.name.clone(),
                body: k,
                reason,
            };
            let found = cover_outside(&body.geometry, goal).map_err(wrong)?;
            merge(&mut outside, placed(found, body, 1.0));
            match cover_inside(&body.geometry, inner) {
                Err(CoverError::NoInside { .. }) => {}
                found => merge(&mut inside, placed(found.map_err(wrong)?, body, -1.0)),
            }
        }
        covers.extend(outside.map(|outside| LinkCover {
            link: link.name.clone(),
            outside,
            inside,
        }));
    }
    Ok(covers)
}

/// Adds the balls of a further body.
fn merge(all: &mut Option<BallCover>, more: BallCover) {
    match all {
        Some(all) => {
            all.balls.extend(more.balls);
            all.gap = larger(all.gap, more.gap);
        }
        None => *all = Some(more),
    }
}

/// Returns the larger of two numbers, with the same bits on every target.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Returns balls in the frame of the link. Radii grow (`side` is 1) or shrink (-1) by the error of
/// the centres.
fn placed(mut cover: BallCover, body: &LinkBody, side: f64) -> BallCover {
    let pose: &Isometry3<f64> = &body.origin;
    let mut most = 0.0f64;
    for ball in &mut cover.balls {
        let error = PLACED * (ball.center.coords.norm() + pose.translation.vector.norm());
        most = larger(most, error);
        *ball = Ball {
            center: pose * ball.center,
            radius: larger(ball.radius + side * error, 0.0),
        };
    }
    cover.balls.retain(|ball| side > 0.0 || ball.radius > 0.0);
    cover.gap += 2.0 * most;
    cover
}

/// Returns the text of a URDF file with spheres instead of the collision elements of the links.
///
/// All the rest of the file stays as it is: joints, visuals, comments. A link without a row in
/// `covers` keeps its elements. The spheres are the outer balls, so `covers` must be that of all
/// elements: of a robot without [`skipped`](Robot::skipped) meshes.
///
/// # Errors
///
/// Returns an error if the file cannot be read, is not a URDF, or declares entities.
pub fn urdf_of_balls(path: impl AsRef<Path>, covers: &[LinkCover]) -> Result<String, FileError> {
    edited(path.as_ref(), |link, element, k| {
        let cover = covers.iter().find(|cover| cover.link == link)?;
        let text = if k == 0 {
            spheres(&cover.outside.balls)
        } else {
            String::new()
        };
        Some((element.range(), text))
    })
}

/// Returns the text of a URDF file with changes of its collision elements.
///
/// `edit` returns a range of the text and its replacement for an element of a link, by the name of
/// the link and the number of the element.
pub(crate) fn edited(
    path: &Path,
    edit: impl Fn(&str, &Node<'_, '_>, usize) -> Option<(Range<usize>, String)>,
) -> Result<String, FileError> {
    let text = FileError::read(path)?;
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let parsed = XmlText::new(text);
    let xml = Xml::parse(path, &parsed)?;
    if xml.root().tag_name().name() != "robot" {
        return Err(xml.unknown_root("robot"));
    }
    if text.contains("<!ENTITY") {
        let what = FileErrorKind::Unsupported("a document type with entities".into());
        return Err(FileError::new(path, None, "", what));
    }
    // The text is written as UTF-8, whatever the declaration says.
    let mut done = match text.split_once("?>") {
        Some((declaration, _)) if declaration.starts_with("<?xml") => declaration.len() + 2,
        _ => 0,
    };
    let mut out = String::from("<?xml version=\"1.0\"?>");
    for link in xml.root().children().filter(|node| node.has_tag_name("link")) {
        let name = link.attribute("name").unwrap_or_default();
        let elements = link.children().filter(|node| node.has_tag_name("collision"));
        for (k, element) in elements.enumerate() {
            if let Some((range, text_of)) = edit(name, &element, k) {
                let range = parsed.in_file(range);
                out.push_str(text.get(done..range.start).unwrap_or_default());
                out.push_str(&text_of);
                done = range.end;
            }
        }
    }
    out.push_str(text.get(done..).unwrap_or_default());
    Ok(out)
}

/// Returns the collision elements of balls.
fn spheres(balls: &[Ball]) -> String {
    let mut out = String::new();
    for (k, Ball { center, radius }) in balls.iter().enumerate() {
        let line = if k == 0 { "" } else { "\n    " };
        let _ = write!(
            out,
            "{line}<collision><origin xyz=\"{} {} {}\"/><geometry><sphere radius=\"{radius}\"/></geometry></collision>",
            center.x, center.y, center.z
        );
    }
    out
}

/// Returns balls of links as JSON: the outer ones in the form of cuRobo's `collision_spheres`.
///
/// The object has `collision_spheres` and `inner_spheres`: for each link a list of objects with
/// `center` and `radius`, in the frame of the link; and `gaps` and `inner_gaps`: a length for each
/// link. JSON is YAML as well.
#[must_use]
pub fn json_of_balls(robot: &Robot, covers: &[LinkCover]) -> String {
    let list = |balls: &[Ball]| -> Value {
        let one = |ball: &Ball| json!({"center": ball.center.coords.as_slice(), "radius": ball.radius});
        balls.iter().map(one).collect()
    };
    let by_link = |of: &dyn Fn(&LinkCover) -> Option<Value>| -> Map<String, Value> {
        let pairs = covers.iter().filter_map(|cover| Some((cover.link.clone(), of(cover)?)));
        pairs.collect()
    };
    let inner = |cover: &LinkCover| cover.inside.clone();
    let all = json!({
        "robot": robot.name(),
        "collision_spheres": by_link(&|cover| Some(list(&cover.outside.balls))),
        "gaps": by_link(&|cover| Some(json!(cover.outside.gap))),
        "inner_spheres": by_link(&|cover| Some(list(&inner(cover)?.balls))),
        "inner_gaps": by_link(&|cover| Some(json!(inner(cover)?.gap))),
    });
    format!("{all:#}\n")
}
