//! Bodies that are queried through a stand-in: compounds with pieces of all sizes, and meshes that
//! share a history.
//!
//! Compounds are queried against every kind of body and judged piece by piece. One tracker
//! alternates between meshes that are clones of one mesh or have the same shape; these are judged
//! by all pairs of triangles.
//!
//! The test `meshes` and the instrument `soak` share this module.

mod draw;
mod pieces;
mod turns;

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Counts of the results; if a count is zero, its ingredient was not tested.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mix {
    /// Pairs with a compound.
    pub pairs: u64,
    /// Poses judged.
    pub poses: u64,
    /// Pieces drawn: points, segments, polygons, specks, needles, plates, solids.
    pub pieces: [u64; 7],
    /// Pairs by the kind of the other body: hull, rounded, curved, mesh, compound, surface.
    pub beside: [u64; 6],
    /// Pairs whose pieces have random poses.
    pub placed: u64,
    /// Poses at which the closest piece is not a solid.
    pub thin_is_closest: u64,
    /// Poses at a distance of less than `1e-8` of the size.
    pub close: u64,
    /// Poses at which the bodies overlap.
    pub overlapping: u64,
    /// Poses judged by exact arithmetic.
    pub exact: u64,
    /// Casts, and hits.
    pub casts: [u64; 2],
    /// Steps of a scene.
    pub steps: u64,
    /// Bodies of a scene that were given the index of a removed body.
    pub reused: u64,
    /// Families of meshes, and their judged queries.
    pub families: [u64; 2],
    /// Trees rebuilt, automatically and by a call.
    pub trees: [u64; 2],
    /// Families with a mesh that has another numbering.
    pub numbered: u64,
}

impl Mix {
    /// Adds the counts of other pairs.
    pub fn add(&mut self, o: &Self) {
        let lists = [
            (&mut self.pieces[..], &o.pieces[..]),
            (&mut self.beside, &o.beside),
            (&mut self.casts, &o.casts),
            (&mut self.families, &o.families),
            (&mut self.trees, &o.trees),
        ];
        for (mine, theirs) in lists {
            mine.iter_mut().zip(theirs).for_each(|(x, y)| *x += y);
        }
        self.pairs += o.pairs;
        self.poses += o.poses;
        self.placed += o.placed;
        self.thin_is_closest += o.thin_is_closest;
        self.close += o.close;
        self.overlapping += o.overlapping;
        self.exact += o.exact;
        self.steps += o.steps;
        self.reused += o.reused;
        self.numbered += o.numbered;
    }
}

/// Plays a pair or a family of meshes.
///
/// # Errors
/// Returns the first wrong answer, or a panic.
pub fn play(seed: u64) -> Result<Mix, String> {
    let played = catch_unwind(AssertUnwindSafe(|| match seed % 8 {
        0 => turns::family(seed),
        _ => pieces::pair(seed),
    }));
    played.unwrap_or_else(|_| Err("a panic".to_owned()))
}
