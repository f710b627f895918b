//! Evaluates a line about a cell of a range.

use super::Check;
use crate::Stop;
use crate::claim::radii;
use crate::file::Head;
use crate::half_space::Floor;
use crate::json::Json;
use crate::range::InCell;
use crate::real::Real;

impl Check {
    /// A plane over a cell of a range.
    pub(super) fn cell(&mut self, line: &Json) -> Result<(), Stop> {
        line.only(&["cell", "cut", "link", "normal", "keep"])?;
        let pair = self.scene.pair(line.get("cell")?)?;
        let Head::Range(cells) = &mut self.head else {
            return Ok(());
        };
        let ((cell, parts), keep) = cells.next(&self.scene, pair, line)?;
        let floor = Floor::of_pair(&self.scene, pair, true)?;
        let (link, normal) = match &floor {
            Some(floor) => {
                line.only(&["cell", "cut", "keep"])?;
                (0, floor.normal.clone())
            }
            None => {
                let normal = line.get("normal")?.reals::<3>()?;
                (line.get("link")?.whole()?, normal.map(Real::exact))
            }
        };
        if link > self.scene.joints.len() {
            return Stop::bad(format!("unknown link {link}"));
        }
        let middle = cell
            .iter()
            .map(|[low, high]| (0.5 * (low.shown() + high.shown())).to_string());
        let middle = middle.collect::<Vec<_>>().join(", ");
        self.keeps(pair, keep);
        let kept = keep.exact() + radii(&self.scene, pair, parts);
        let bodies = [pair.0, pair.1].map(|k| &self.scene.bodies[k]);
        let some = [bodies[0].of_parts(parts[0]), bodies[1].of_parts(parts[1])];
        self.inside.add(&self.scene, pair, some == [None, None]);
        let claim = InCell {
            pair,
            some,
            cell,
            link,
            normal,
            floor,
            kept,
        };
        if self.holds(&claim) {
            return Ok(());
        }
        Stop::fails(format!("{}, about [{middle}]", self.scene.names(pair)))
    }
}
