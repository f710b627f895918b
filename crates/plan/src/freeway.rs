//! Freeways: curves of slice-local maxima of the clearance.

use std::vec::Vec;

use crate::ascent::{ClearConfiguration, Slice};
use crate::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::space::ConfigurationSpace;

/// Clearance, in units of the shortest step, below which a freeway has closed and no bridge begins.
/// Not measured.
pub(crate) const CLOSED: f64 = 64.0;

/// Steps of a trace of a freeway in one direction, at most. Not measured.
const TRACE: usize = 256;

/// Lengths of a step by which a corrector may move a place: farther is another maximum. Not
/// measured.
const HOP: f64 = 4.0;

/// The reason why a freeway ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreewayEnd {
    /// At a bound of the sweep coordinate.
    Bound,
    /// The clearance falls to the margin: the channel closes.
    Closed,
    /// The maximum is none in the next slices (the maximum meets a saddle), or leads away faster
    /// than the sweep coordinate.
    Inflection,
    /// The number of steps is used up, or the caller stopped the search.
    Budget,
}

/// One step of a trace.
enum Tried {
    Kept(ClearConfiguration),
    Lost(FreewayEnd),
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Follows the slice-local maximum from a place as the sweep coordinate goes up (`sign` 1) or
    /// down (-1). Predictor: the secant through the last two places; corrector: ascent within the
    /// slice. Every step is proven free; a step that is not is halved.
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

    /// Returns the step along the secant whose component of the sweep coordinate is `way`, as a
    /// length.
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
            // A secant across the sweep is a bad guess.
            if along * way > 0.0 && aside <= HOP * along.abs() {
                step = past.iter().map(|x| x * (way / along)).collect();
            }
        }
        step[coordinate] = way / scales[coordinate];
        step
    }

    /// Ascends in the slice ahead; lost if the ascent hops away, ends in contact, or the segment is
    /// not proven free.
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
        Ok(if !(place.distance > self.margin()) {
            Tried::Lost(FreewayEnd::Closed)
        } else if self.space.distance(&guess, &place.q) > HOP * way || !self.is_free(here, &place.q)? {
            Tried::Lost(FreewayEnd::Inflection)
        } else {
            Tried::Kept(place)
        })
    }
}
