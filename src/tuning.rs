//! Heuristics: thresholds and limits that steer work. Another value changes the time of a query, or
//! how often its bounds stay open, but never makes a bound wrong.
//!
//! Each constant names the costs it trades, and the measurement if there is one. "Not measured":
//! neither a comment nor `benches/record` holds a number, and the value may be changed for a better
//! one. Bounds of errors are in [`tolerance`](crate::tolerance).

/// Bodies and their support vertices.
pub(crate) mod polyhedron {
    /// Faces of more edges are kept as rings too: bisection on a list for longer lists in memory.
    /// Also the number of edges of a face examined one by one, and the size of the arrays for small
    /// faces. Not measured.
    pub(crate) const LARGE: usize = 24;

    /// Fans of more edges are searched; up to here examining every edge is as cheap. Not measured.
    pub(crate) const MANY: usize = 128;

    /// Boxes of bodies of up to this many vertices are scanned in `f32`, boxes of larger bodies
    /// found by hill climbing from the extreme vertices of the last frame. Scanning takes linear
    /// time but has no branch to mispredict. Not measured.
    pub(crate) const SCANNED: usize = 64;

    /// The cube map takes no body as flatter than this: finer cells about the axis of a flat body
    /// for coarser cells about its rim. Not measured.
    pub(crate) const FLATTEST: f64 = 1.0 / 1024.0;

    /// Steps of a climb between two searches for a large face or fan to jump over: long climbs
    /// become short, short climbs never pay for the search. Not measured.
    pub(crate) const LEAP: u32 = 4;

    /// A body is flat or long if the product of its squared half axes is below this part of the
    /// product for a ball with an equal sum of squares, as for 3:3:1. Starts of flat bodies come
    /// from their ellipsoids, which cost more than the line of centres. Not measured.
    pub(crate) const FLAT: f64 = 0.32;

    /// On bodies of so few vertices every walk is short, and no start from ellipsoids pays. Not
    /// measured.
    pub(crate) const FEW: usize = 12;
}

/// Support vertices of the Minkowski difference.
pub(crate) mod pair {
    /// Bodies of up to this many vertices are climbed from the hint, larger bodies from the better
    /// of the hint and the cube map: one more look-up for a shorter climb. Not measured.
    pub(crate) const SMALL: usize = 64;
}

/// The walk and its starts.
pub(crate) mod walk {
    /// Jumps to a far face (vertex-face from behind) in a walk, at most. Jumps are not monotone; a
    /// larger number keeps walks alive that another solver ends sooner. Not measured.
    pub(crate) const JUMPS: u32 = 3;

    /// Steps before the guard against cycles begins: most walks end before and never pay for the
    /// guard. Not measured.
    pub(crate) const FREE: u32 = 8;

    /// Newton jumps a walk may try. Not measured.
    pub(crate) const NEWTON_JUMPS: u32 = 12;

    /// Most steps of a walk on bodies with long face boundaries or large fans, which Newton jumps
    /// pass: a longer walk is lost and goes to the other solvers. Not measured.
    pub(crate) const LONGEST: u32 = 128;

    /// Steps before the first Newton jump along a long face boundary or round a large fan: a jump
    /// costs several steps, and most walks have ended by then. Not measured.
    pub(crate) const FIRST_NEWTON_JUMP: u32 = 4;

    /// Rounds of the fixed-point equation for the touching ellipsoids: a better first direction for
    /// the time of a round. Not measured.
    pub(crate) const ROUNDS: usize = 6;

    /// Curves are fitted over one part in this many of their ring to each side, an arc of about
    /// three degrees: smooth over small edges, and short. Not measured.
    pub(crate) const SPAN: usize = 256;

    /// Newton steps of one jump. Not measured.
    pub(crate) const STEPS: usize = 3;

    /// Relative amount that makes non-positive second derivatives positive: safer steps for slower
    /// convergence. Not measured.
    pub(crate) const DAMPING: f64 = 1.0 / 1024.0;

    /// A Newton step shorter than this is the last: the next step would be as short as its square.
    /// Not measured.
    pub(crate) const CLOSE: f64 = 1.0 / 8.0;

    /// How often a jump that leads no closer is cut to a quarter before it is dropped. Not
    /// measured.
    pub(crate) const TRIES: u32 = 3;

    /// Bisections for the point at which a curve leaves a face. Not measured.
    pub(crate) const BISECTIONS: u32 = 8;

    /// How far a parabola is followed, in lengths of its fit: longer jumps for worse extrapolation.
    /// Not measured.
    pub(crate) const REACH: f64 = 12.0;
}

/// The minimum-norm solver (GJK).
pub(crate) mod minimum {
    /// Support points of one solve, at most. Measured: right answers took at most 24, and some 90
    /// if nearly parallel faces of 32,768 vertices lie boundary over boundary.
    pub(crate) const SUPPORTS: u32 = 256;
}

/// Penetration depth.
pub(crate) mod depth {
    /// Triangles of a surface that is kept between queries, at most: their numbers fit a byte.
    /// Larger surfaces are built again, as their memory costs more than the time saved. Not
    /// measured.
    pub(crate) const MAX_TRIANGLES: usize = 256;

    /// Triangles that a kept surface may gain, beside the number at its build, before the surface
    /// is built again: an old surface carries triangles that bound nothing. Not measured.
    pub(crate) const GAIN: usize = 24;

    /// Points up to which a resumed surface works on a small array, which costs less to clear. Not
    /// measured.
    pub(crate) const FEW_POINTS: usize = 34;

    /// Up to so many weak triangles are taken for facets next to the last deepest facet, and tried
    /// before the surface grows. Not measured.
    pub(crate) const FEW_TRIANGLES: usize = 2;

    /// Surfaces of up to this many points are scanned for a point, hardly slower than hashing.
    /// Equal to [`MAX_TRIANGLES`], the size for which trackers reserve memory, so that queries
    /// allocate nothing.
    pub(crate) const SCANNED: usize = MAX_TRIANGLES;

    /// Points that may come twice before a surface counts as folded and the next arithmetic takes
    /// over. Not measured.
    pub(crate) const REPEATS: u32 = 16;

    /// Number of perturbations worth a search in f64, the first of
    /// [`SHIFTS`](crate::tolerance::SHIFTS): the perturbations well above the rounding of f64.
    pub(crate) const SHIFTS_PLAIN: usize = 3;

    /// Exchanges of a vertex on the way to the facet over the axis, at most. Not measured.
    pub(crate) const MAX_EXCHANGES: usize = 48;

    /// Faces of up to this many edges are tried edge by edge for the features of a depth, the
    /// product of two such numbers in all. Not measured.
    pub(crate) const SMALL: usize = 8;

    /// Pairs of edges that the exact enumeration of all facets tests, at most: 2048 edges of each
    /// body. Beyond, bounds stay open.
    #[cfg(feature = "exact")]
    pub(crate) const MAX_EDGE_PAIRS: usize = 1 << 22;

    /// Pairs that the exact enumeration of all facets measures, at most. Beyond, bounds stay open.
    #[cfg(feature = "exact")]
    pub(crate) const MAX_MEASURED: usize = 1 << 16;

    /// Tests of a vertex in double-double by the enumeration of all facets, at most. Measured: some
    /// hundred milliseconds. Beyond, bounds stay open.
    #[cfg(feature = "exact")]
    pub(crate) const MAX_EVALUATIONS: usize = 1 << 22;
}

/// Contact manifolds.
pub(crate) mod contact {
    /// Vertices of a face boundary tried next to a hint before bisection takes over. Not measured.
    pub(crate) const MAX_LOCAL_STEPS: usize = 4;
}

/// The choice of a start between queries.
pub(crate) mod tracker {
    /// Walks of so many steps were near their end at the start, and extrapolation of the features
    /// would gain nothing. Not measured.
    pub(crate) const STEADY: u32 = 3;

    /// Cost of a cold start, two cube-map look-ups and climbs, in steps of the walk. Measured of
    /// the walks: some five steps from the support vertices of round bodies, and from the last
    /// features `1 + 0.085 sqrt(n)` steps a degree turned; the cost itself was not measured.
    pub(crate) const CLIMBS: u32 = 4;

    /// Cost of the direction of two ellipsoids, in steps of the walk. Not measured.
    pub(crate) const ELLIPSOIDS: u32 = 2;
}

/// Meshes and bodies of pieces.
pub(crate) mod composite {
    /// Motions up to this, as the norm of the difference of rotations and as a part of L, are worth
    /// a front: some 2.4 degrees. At 2 degrees a frame a front and a new search cost about the
    /// same.
    pub(crate) const NEAR: f64 = 1.0 / 24.0;

    /// Motions beyond this begin anew: above some 5 degrees the pair that was closest is a bad
    /// start, which costs up to five times the bounds.
    pub(crate) const JUMP: f64 = 1.0 / 12.0;

    /// A front is cut anew if it has grown to so many times its length: splits are never undone. A
    /// cut costs thousands of bounds, a long front a test for each entry. Rocks of 20k triangles at
    /// 0.5 degrees a frame: 313, 284 and 274 bounds a query with 2, 3 and 5.
    pub(crate) const GROWTH: usize = 3;

    /// Fronts of more entries than this are given up if the directions of over half of them fail.
    /// Plates in flush contact have some 30 entries, half of which only double precision can prove.
    pub(crate) const FEW_ENTRIES: usize = 64;

    /// Nodes of fewer items have no slab: their corners are looked at one by one.
    pub(crate) const SLAB_ITEMS: usize = 32;

    /// Trackers of pairs of pieces that are kept for each entry of the front; more are forgotten.
    /// Not measured.
    pub(crate) const TRACKERS: usize = 4;

    /// Pairs taken off the stack at once: both halves of each make eight, the width of the kernel.
    pub(crate) const AT_ONCE: usize = 4;

    /// Items of a node that are few enough to be looked at one by one in double precision. Not
    /// measured.
    pub(crate) const FEW_ITEMS: u32 = 64;

    /// A node thinner than this part of the tree's size gets a slab: about as thin as single
    /// precision can say.
    pub(crate) const SLAB: f64 = 1.0 / 131_072.0;

    /// Below a node with a slab, only nodes thinner by this factor get a slab of their own: memory
    /// for the ties that only they prove.
    pub(crate) const THINNER: f64 = 1.0 / 16.0;

    /// A leaf of several triangles is no thicker than this part of its length: coarse bodies have
    /// thin leaves of one triangle, fine bodies save two thirds of the boxes.
    pub(crate) const THIN: f64 = 1.0 / 16.0;

    /// A cut of a node leaves at least one part in this many on each side, so that the depth is a
    /// logarithm.
    pub(crate) const LOPSIDED: usize = 8;

    /// Middles whose heights differ by less than this part of the tree's size are level: the
    /// rounding of single precision.
    pub(crate) const LEVEL: f32 = 8.0 * f32::EPSILON;

    /// From so few triangles on a node's axes are found by corners, not by middles: a few middles
    /// have no spread of their own.
    pub(crate) const FEW_CORNERS: usize = 16;

    /// Segments tried for a winding number. A first zero is rare already, and the ends are in
    /// general position against anything made of round numbers.
    pub(crate) const SEGMENTS: usize = 24;

    /// Pairs of triangles in contact that are looked at for inner points. Not measured.
    pub(crate) const TOUCHES: usize = 128;

    /// Triangles nearer than this part of L take the direction of a face or of two edges if one
    /// proves as much as the direction of the witnesses: two more gaps for directions that prove
    /// flush neighbours. Plates of 3,000 triangles at a gap of 1e-3: 300 bounds a query without.
    pub(crate) const SHARP: f64 = 1.0 / 256.0;

    /// The depth of a flat patch for contacts, in its radius: deeper overlaps for a hull that
    /// leaves thin walls. Not measured.
    pub(crate) const DEPTH: f64 = 0.25;

    /// Most planes of a patch for contacts: larger patches for a build in time that grows with
    /// their square. Not measured.
    pub(crate) const PLANES: usize = 256;
}
