//! The worst row as a picture, and the worst rows as a recording.

use std::path::Path;
use std::sync::Arc;

use lin_canny::GeometryKind;
use lin_canny_plan::WorldId;
use lin_canny_study::robot::RobotRecorder;
use lin_canny_study::{Study, StudyError};
use truth::arm::draw::{Picture, outline};

use super::tables::{Tables, WorstRow};

/// Draws the robot in its cell at a row, with the closest points joined.
pub(super) fn picture(study: &Arc<Study>, row: &WorstRow) -> Result<String, StudyError> {
    study.with_checker(|checker| {
        let unfit = |e: String| StudyError::unfit("the picture", e);
        let near = checker.clearance(&row.configuration)?;
        let near = near.ok_or_else(|| unfit("no pair".into()))?;
        let world = checker.world();
        let (mut shapes, mut poses) = (Vec::new(), Vec::new());
        for (id, _) in world.bodies() {
            // A half-space has no outline.
            let Some(geometry) = world.geometry(id).filter(|g| g.kind() != GeometryKind::HalfSpace) else {
                continue;
            };
            let shape = outline(geometry).map_err(|e| unfit(e.to_string()))?;
            shapes.push((shape, !matches!(id, WorldId::Obstacle(_))));
            poses.push(checker.pose(id, &row.configuration)?);
        }
        let picture = Picture {
            caption: format!("{} – {}: {:.6}", row.pair[0], row.pair[1], row.distance),
            bodies: shapes.iter().map(|(shape, is_robot)| (shape, *is_robot)).collect(),
            poses,
            points: near.witnesses,
            cloud: Vec::new(),
        };
        Ok(picture.alone())
    })?
}

/// Records a frame for each of the worst rows.
pub(super) fn record(study: &Arc<Study>, tables: &Tables, file: &Path) -> Result<(), StudyError> {
    let Some(first) = tables.worst.first() else {
        return Err(StudyError::unfit(file.display(), "no row to record"));
    };
    study.with_checker(|checker| {
        let mut film = RobotRecorder::create(file, checker, &first.configuration)?;
        for (k, row) in tables.worst.iter().enumerate() {
            let Some(near) = checker.clearance(&row.configuration)? else {
                continue;
            };
            let place = row
                .id
                .as_ref()
                .map_or(format!("worst {}", k + 1), |id| format!("row {id}"));
            film.frame(checker, &row.configuration, &place, &near)?;
        }
        Ok(film.finish()?)
    })?
}
