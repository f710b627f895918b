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
pub(crate) trait Cell: Clone {
    type End: Copy + PartialOrd;

    /// Reads where an axis is cut.
    fn read(json: &Json) -> Result<Self::End, Stop>;

    fn axis(&mut self, number: usize) -> Option<&mut [Self::End; 2]>;
}

/// Cuts the cell at hand, at `[[axis, where], ...]`, each strictly inside.
pub(crate) fn cut<C: Cell>(waiting: &mut Vec<C>, cuts: &[Json], name: impl Fn() -> String) -> Result<(), Stop> {
    let outside = || Stop::Fails(format!("{}: a cut outside its cell", name()));
    for cut in cuts {
        let [axis, at] = cut.list::<2>()?;
        let (axis, at) = (axis.whole()?, C::read(at)?);
        let upper = waiting.last_mut().ok_or_else(outside)?;
        let mut lower = upper.clone();
        match (upper.axis(axis), lower.axis(axis)) {
            (Some(above), Some(below)) if above[0] < at && at < above[1] => (above[0], below[1]) = (at, at),
            _ => return Err(outside()),
        }
        waiting.push(lower);
        if waiting.len() > WAITING {
            return Stop::bad(format!("more than {WAITING} cells wait"));
        }
    }
    Ok(())
}
