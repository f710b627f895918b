//! Cells that are cut, each into two that together are the cell: of a range, or of the parts of two
//! bodies.
//!
//! The cells that wait are a stack, of which the last one is at hand. A cut divides the cell at hand:
//! the lower part is at hand next, the upper one waits.

use crate::Stop;
use crate::json::Json;

/// Most cells that wait.
const WAITING: usize = 4096;

/// A range along each of several axes.
pub(crate) trait Cell: Sized {
    /// Returns the lower and the upper part, or `None` if the cut is not strictly inside.
    fn halves(&self, axis: usize, at: &Json) -> Result<Option<[Self; 2]>, Stop>;
}

/// Cuts one of several ranges.
pub(crate) fn halves<E, R>(ranges: &R, axis: usize, at: E) -> Option<[R; 2]>
where
    E: Copy + PartialOrd,
    R: Clone + AsMut<[[E; 2]]>,
{
    let mut both = [ranges.clone(), ranges.clone()];
    let [below, above] = both.each_mut().map(|half| half.as_mut().get_mut(axis));
    let (below, above) = below.zip(above)?;
    let inside = below[0] < at && at < below[1];
    (below[1], above[0]) = (at, at);
    inside.then_some(both)
}

/// Cuts the cell at hand, at `[[axis, where], ...]`, each strictly inside.
pub(crate) fn cut<C: Cell>(waiting: &mut Vec<C>, cuts: &[Json], name: impl Fn() -> String) -> Result<(), Stop> {
    let outside = || Stop::Fails(format!("{}: a cut outside its cell", name()));
    for cut in cuts {
        let [axis, at] = cut.list::<2>()?;
        let cell = waiting.last().ok_or_else(outside)?;
        let [lower, upper] = cell.halves(axis.whole()?, at)?.ok_or_else(outside)?;
        waiting.pop();
        waiting.extend([upper, lower]);
        if waiting.len() > WAITING {
            return Stop::bad(format!("more than {WAITING} cells wait"));
        }
    }
    Ok(())
}
