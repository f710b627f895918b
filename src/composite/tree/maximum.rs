//! The greatest value of a function over triangles, between bounds.

use alloc::collections::BinaryHeap;

use crate::base::notice::Watch;
use crate::base::num::Ranked;
use crate::base::num::extremes::Extremes;
use crate::composite::meet::triangle::Triangle;

/// Triangles that are halved at most; a tenth of a second and more. Not measured.
const HALVED: usize = 1 << 16;

/// What is less than this part of the resolution above the greatest value found is not looked at
/// more closely. Not measured.
const ENOUGH: f64 = 1.0 / 16.0;

/// A triangle, ranked by the negative of an upper bound over the triangle.
type Open = Ranked<(), Triangle>;

/// Brackets the greatest value over triangles of a function with non-negative values. `judge`
/// returns the value at some point of a triangle, or less, and an upper bound over the triangle,
/// which tends to the value as the triangle shrinks. Bounds below its second argument are as good
/// as any: the greatest value found so far and a little more.
///
/// Triangles are halved, that with the greatest bound first (branch and bound: Land and Doig 1960),
/// until no bound exceeds the greatest value found by more than `resolution`. The watch counts
/// triangles looked at; what is returned to a caller who stops it is of no use.
pub(in crate::composite) fn greatest(
    triangles: impl Iterator<Item = Triangle>,
    resolution: f64,
    watch: &mut Watch<'_>,
    mut judge: impl FnMut(&Triangle, f64) -> (f64, f64),
) -> (f64, f64) {
    let (mut lower, mut settled, mut open, mut done) = (0.0f64, 0.0f64, BinaryHeap::new(), 0);
    let mut examine = |corners: Triangle, open: &mut BinaryHeap<Open>| {
        let (value, upper) = judge(&corners, lower + ENOUGH * resolution);
        lower = lower.larger(value);
        if upper > lower + resolution {
            open.push(Ranked {
                rank: -upper,
                key: (),
                item: corners,
            });
        } else {
            settled = settled.larger(upper);
        }
        lower
    };
    let mut reached = 0.0;
    for corners in triangles {
        reached = examine(corners, &mut open);
        done += 1;
        if !watch.done(done) {
            return (lower, f64::INFINITY);
        }
    }
    for halved in 0..HALVED {
        let widest = open.peek().filter(|t| -t.rank > reached + resolution);
        let Some(widest) = widest.filter(|_| watch.done(done + halved)) else {
            break;
        };
        let halves = halves(&widest.item);
        open.pop();
        for half in halves {
            reached = examine(half, &mut open);
        }
    }
    (
        lower,
        open.peek().map_or(0.0, |t| -t.rank).larger(settled).larger(lower),
    )
}

/// Returns the two halves of a triangle, cut at the middle of the longest side.
fn halves([a, b, c]: &Triangle) -> [Triangle; 2] {
    let ends = [(a, b, c), (b, c, a), (c, a, b)];
    let long = |(p, q, _): (&nalgebra::Vector3<f64>, &nalgebra::Vector3<f64>, _)| (q - p).norm_squared();
    let longest = ends.into_iter().reduce(|x, y| {
        if long((y.0, y.1, y.2)) > long((x.0, x.1, x.2)) {
            y
        } else {
            x
        }
    });
    let (a, b, c) = longest.unwrap_or((a, b, c));
    let middle = (a + b) * 0.5;
    [[*a, middle, *c], [middle, *b, *c]]
}
