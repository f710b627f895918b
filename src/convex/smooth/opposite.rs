//! Witnesses of an overlap: the points at which the cores touch when B has been moved out.
//!
//! The depth is the length of the shortest translation that parts the cores, and the translation
//! leads along the normal. Moved by the depth and a gap `g` more, the cores are apart, and their
//! closest points `a` and `b` are found as those of any pair. At the pose given, `b - a` is the
//! normal times the signed distance, up to `s - g` along the normal and to `s` times the sine
//! between both normals across, where `s` is the distance of the moved cores: `g` itself if the
//! normal is that of a local minimum of the depth.
//!
//! ```text
//!      A        B             A         B moved
//!    ____________           _____
//!   |     |b  a| |         |    a|<-g->|b
//!   |_____|____|_|         |_____|
//! ```
//!
//! Points of balls or of facets that prove the depth are no witnesses: equally deep ones may lie
//! on different sides of a core.

use super::best::ProvenBounds;
use super::depth;
use super::layers::search;
use super::posed::{PosedCores, add};
use crate::base::num::scalar::scaled;
use crate::body::shape::Support;
use crate::pair::outcome::Solver;
use crate::pair::transform::Transform;

/// Gap to which the cores are moved apart, times L: small against the cores, and large against the
/// rounding of the normal between the moved cores. A heuristic.
const GAP: f64 = 1.0 / (1u64 << 20) as f64;

/// Distances of the moved cores that exceed the gap by less than this times L are the gap itself.
/// Not a matter of soundness.
const NEAR: f64 = 1.0 / (1u64 << 34) as f64;

/// Directions that are tried: a heuristic.
const TRIES: u32 = 16;

/// Returns the closest points of the cores, with B moved out along the best direction. If the moved
/// cores are further apart than the gap, the direction between them is less deep: the local minimum
/// of the depth from there is the next direction.
#[inline(never)]
pub(super) fn witnesses<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    deep: &mut ProvenBounds<f64>,
) -> ProvenBounds<f64> {
    let gap = GAP * posed.size;
    let mut found = moved_apart(posed, deep, gap);
    for _ in 1..TRIES {
        if found.upper - gap <= NEAR * posed.size {
            break;
        }
        let before = deep.lower;
        depth::local(posed, found.n, &found.set, deep);
        if deep.lower <= before {
            break;
        }
        found = moved_apart(posed, deep, gap);
    }
    found
}

/// Returns the closest points of the cores, with B moved out along the best direction to a gap.
fn moved_apart<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    deep: &mut ProvenBounds<f64>,
    gap: f64,
) -> ProvenBounds<f64> {
    let out = scaled(&deep.n, gap - deep.lower);
    let moved = PosedCores {
        frame: Transform {
            translation: add(&posed.frame.translation, &out),
            ..posed.frame
        },
        ..*posed
    };
    let mut found = ProvenBounds::new();
    (found.n, found.set) = (deep.n, deep.set);
    search(&moved, true, &mut found, &mut Solver::default(), |_, _| false);
    deep.evaluations += found.evaluations;
    found
}
