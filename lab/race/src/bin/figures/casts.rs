//! Draws the cost of an accurate cast: distance queries per hit against the tolerance.
//!
//! Queries are counted, not timed, so the picture is the same on every machine.

use lin_canny::ConvexPolyhedron;
use lin_canny::Tracker;
use lin_canny::impact::{Impact, Tolerance, cast};
use race::plot::Chart;
use truth::casts::{self, Advance, Throw};
use truth::rng::Rng;

use crate::Trouble;

/// Throws for each tolerance and rotation.
const THROWS: usize = 200;

/// Exponents of the tolerances, from the coarsest to the finest.
const POWERS: std::ops::RangeInclusive<i32> = 1..=12;

/// Step limit of conservative advancement.
const LIMIT: u32 = 20_000;

/// Returns the distance queries of a cast with a proven bracket; `None` unless the bodies meet.
fn proven([a, b]: [&ConvexPolyhedron; 2], throw: &Throw, tolerance: f64) -> Option<u32> {
    let [p, q] = throw.motions();
    let found = cast(
        &mut Tracker::new().pair(a, b),
        &p,
        &q,
        0.0..1.0,
        Tolerance::Distance(tolerance),
    )
    .ok()?;
    matches!(found.impact, Impact::Hit { .. }).then_some(found.queries)
}

/// Returns the distance queries of conservative advancement.
///
/// `None` unless the bodies come as near as the tolerance or the step limit is reached.
fn advanced(bodies: [&ConvexPolyhedron; 2], throw: &Throw, tolerance: f64) -> Option<u32> {
    let (found, queries) = casts::advance(bodies, throw, tolerance, LIMIT);
    matches!(found, Advance::Near(_) | Advance::Limit(_)).then_some(queries)
}

/// Returns the median number of queries per hit at each tolerance.
fn medians(turn: f64, queries: impl Fn([&ConvexPolyhedron; 2], &Throw, f64) -> Option<u32>) -> Vec<(f64, f64)> {
    let mut rng = Rng::new(1905);
    let [a, b] = [0; 2].map(|_| casts::body("sphere", 32, &mut rng));
    let throws: Vec<Throw> = (0..THROWS).map(|_| casts::aimed(&mut rng, (1.0, 1.0), turn)).collect();
    POWERS
        .filter_map(|power| {
            let tolerance = 10f64.powi(-power);
            let mut hits: Vec<u32> = throws.iter().filter_map(|t| queries([&a, &b], t, tolerance)).collect();
            hits.sort_unstable();
            Some((tolerance, f64::from(*hits.get(hits.len() / 2)?)))
        })
        .collect()
}

/// Draws queries per hit against the tolerance, for our cast and for conservative advancement.
fn chart() -> Chart {
    let mut chart = Chart::new("what the accuracy of a cast costs: round bodies of 32 vertices")
        .axes(
            "tolerance over the radius of the bodies",
            "distance queries a hit, median",
        )
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    for turn in [1.0, 6.0] {
        chart = chart
            .line(format!("ours, turns to {turn} rad"), medians(turn, proven))
            .line(format!("advancement, to {turn} rad"), medians(turn, advanced));
    }
    chart
}

/// Returns the picture as text.
pub(crate) fn picture() -> Result<String, Trouble> {
    crate::records::text(&chart())
}
