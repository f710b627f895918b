//! Bodies that are queried through a converted copy: compounds with pieces of all sizes, and meshes that
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

crate::tally! {
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
}

/// Plays a pair or a family of meshes.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    match seed % 8 {
        0 => turns::family(seed),
        _ => pieces::pair(seed),
    }
}
