//! Bodies that other bodies stand in for: compounds of pieces of every measure beside every kind of body, judged piece by piece;
//! and meshes of one lineage or of one shape, which one tracker follows in turn, judged by all pairs of triangles.
//!
//! The test `meshes` and the instrument `soak` share this.

mod draw;
mod pieces;
mod turns;

use std::panic::{AssertUnwindSafe, catch_unwind};

/// What came of some pairs; a mix that lacks an ingredient tests nothing.
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
    /// Pairs with placed pieces.
    pub placed: u64,
    /// Poses at which a piece other than a solid is the closest.
    pub thin_is_closest: u64,
    /// Poses apart by less than `1e-8` of the size.
    pub close: u64,
    /// Poses at which the bodies overlap.
    pub overlapping: u64,
    /// Poses judged in exact arithmetic.
    pub exact: u64,
    /// Casts, and those that hit.
    pub casts: [u64; 2],
    /// Steps of a scene.
    pub steps: u64,
    /// Bodies of a scene that were given the place of a removed one.
    pub reused: u64,
    /// Families of meshes, and the queries of them that were judged.
    pub families: [u64; 2],
    /// Trees made anew, by themselves and by call.
    pub trees: [u64; 2],
    /// Families with a mesh that is numbered otherwise.
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
/// The first answer that is wrong, or a panic.
pub fn play(seed: u64) -> Result<Mix, String> {
    let played = catch_unwind(AssertUnwindSafe(|| match seed % 8 {
        0 => turns::family(seed),
        _ => pieces::pair(seed),
    }));
    played.unwrap_or_else(|_| Err("a panic".to_owned()))
}
