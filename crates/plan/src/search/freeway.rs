//! Freeways: curves of local maxima of the clearance within slices.

use std::vec::Vec;

use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::space::ConfigurationSpace;
use crate::search::ascent::{ClearConfiguration, Slice};

/// Clearance, in units of the shortest step, below which a freeway is closed and no bridge starts.
pub(crate) const CLOSED: f64 = 64.0;

/// Maximum number of steps of a trace in one direction.
const TRACE: usize = 256;

/// Step lengths by which the corrector may move a configuration; farther away is another maximum.
const HOP: f64 = 4.0;

/// The reason why a freeway ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FreewayEnd {
    /// The sweep coordinate reaches a bound.
    Bound,
    /// The clearance falls to the margin: the channel closes.
    Closed,
    /// The maximum ends, because it meets a saddle, or it moves faster than the sweep coordinate.
    Inflection,
    /// The step limit is reached, or the caller stopped the search.
    Budget,
}

/// One step of a trace.
enum Tried {
    Kept(ClearConfiguration),
    Lost(FreewayEnd),
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Follows the local maximum of the slices as the sweep coordinate increases (`sign` 1) or
    /// decreases (-1).
    ///
    /// Predicts along the secant through the last two configurations, and corrects by an ascent
    /// within the slice. A step that is not proven free is halved.
    pub(crate) fn trace(
        &mut self,
        start: &ClearConfiguration,
        coordinate: usize,
        sign: f64,
        slice: &Slice,
    ) -> Result<(Vec<ClearConfiguration>, FreewayEnd), PlanError> {
        let mut places: Vec<ClearConfiguration> = Vec::new();
        let mut way = start.distance.clamped(8.0 * slice.shortest, slice.longest);
        for _ in 0..TRACE {
            let here = places.last().unwrap_or(start);
            let before = match places.len() {
                0 => None,
                1 => Some(start),
                n => Some(&places[n - 2]),
            };
            let step = self.predicted(here, before, coordinate, sign * way);
            let ahead = self.space.moved(&here.q, &step);
            if ahead[coordinate] == here.q[coordinate] {
                return Ok((places, FreewayEnd::Bound));
            }
            match self.corrected(&here.q.clone(), ahead, way, slice)? {
                Tried::Kept(place) => {
                    way = (1.5 * way)
                        .smaller(slice.longest)
                        .smaller(4.0 * place.distance.larger(CLOSED * slice.shortest));
                    places.push(place);
                }
                Tried::Lost(end) => {
                    way *= 0.5;
                    if way < 8.0 * slice.shortest {
                        return Ok((places, end));
                    }
                }
            }
        }
        Ok((places, FreewayEnd::Budget))
    }

    /// Returns the step along the secant whose sweep component, as a length, is `way`.
    fn predicted(
        &self,
        here: &ClearConfiguration,
        before: Option<&ClearConfiguration>,
        coordinate: usize,
        way: f64,
    ) -> Vec<f64> {
        let scales = self.space.scales();
        let mut step = std::vec![0.0; self.space.degrees_of_freedom()];
        if let Some(before) = before {
            let past = self.space.difference(&before.q, &here.q);
            let along = past[coordinate] * scales[coordinate];
            let aside = past
                .iter()
                .zip(scales)
                .map(|(x, s)| (x * s).abs())
                .fold(0.0, f64::larger);
            // A secant perpendicular to the sweep coordinate is a bad prediction.
            if along * way > 0.0 && aside <= HOP * along.abs() {
                step = past.iter().map(|x| x * (way / along)).collect();
            }
        }
        step[coordinate] = way / scales[coordinate];
        step
    }

    /// Ascends in the next slice; fails if the ascent moves too far, ends in contact, or the
    /// segment is not proven free.
    fn corrected(&mut self, here: &[f64], ahead: Vec<f64>, way: f64, slice: &Slice) -> Result<Tried, PlanError> {
        let near = Slice {
            longest: way.larger(8.0 * slice.shortest),
            ..slice.clone()
        };
        let guess = ahead.clone();
        let mut passed = self.ascend(ahead, &near)?;
        let Some(place) = passed.pop() else {
            return Ok(Tried::Lost(FreewayEnd::Inflection));
        };
        Ok(if !(place.distance > self.cell.margin()) {
            Tried::Lost(FreewayEnd::Closed)
        } else if self.space.distance(&guess, &place.q) > HOP * way || !self.is_segment_free(here, &place.q)? {
            Tried::Lost(FreewayEnd::Inflection)
        } else {
            Tried::Kept(place)
        })
    }
}
