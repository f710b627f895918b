//! Heuristics: thresholds and limits that steer work. Another value changes the time of a query, or
//! how often its bounds stay open, but never makes a bound wrong.
//!
//! Each constant names the costs it trades, and the measurement if there is one. "Not measured":
//! no number is on record. Bounds of errors are in [`tolerance`](crate::tolerance).

pub(crate) mod composite;
pub(crate) mod patch;

/// Bodies and their support vertices.
pub(crate) mod polyhedron {
    /// Faces of more edges are kept as rings too: bisection on a list for longer lists in memory.
    /// Also the number of edges of a face examined one by one, and the size of the arrays for small
    /// faces. Not measured.
    pub(crate) const LARGE: usize = 24;

    /// Fans of more edges are searched; up to here examining every edge is as cheap. Not measured.
    pub(crate) const MANY: usize = 128;

    /// Boxes of bodies of up to this many vertices are scanned in `f32`, and heights in `f64`;
    /// boxes of larger bodies are found by hill climbing from the extreme vertices of the last
    /// frame. Scanning takes linear time but has no branch to mispredict. Supports of the
    /// minimum-norm solver are scanned up to here too. Measured for these, in piles of overlapping
    /// bodies: a fifth to a third less time at 48 and 64 vertices, as much at 96, more at 128.
    pub(crate) const SCANNED: usize = 64;

    /// A support vertex without a hint is found by a scan on bodies of up to this many vertices: no
    /// branch to mispredict, for linear time.
    pub(crate) const SCAN: usize = 16;

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

/// The walk and its starts.
pub(crate) mod walk {
    /// Squared sine of the angle of two edges below which their closest points are the best of four
    /// projections of ends instead of a projection of the feet on the lines, whose rounding grows
    /// with the inverse of the sine. Not measured.
    pub(crate) const SKEW: f64 = 1.0 / (1u64 << 20) as f64;

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

/// Exact distances in closed form.
#[cfg(feature = "exact")]
pub(crate) mod solve {
    /// Edges of a vertex that are tested, at most; a pair with more is solved. Not measured.
    pub(crate) const FAN: usize = 32;
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
    /// [`ORIGIN_SHIFTS`](crate::tolerance::ORIGIN_SHIFTS): the perturbations well above the
    /// rounding of f64.
    pub(crate) const SHIFTS_PLAIN: usize = 3;

    /// Facets of a descent, at most: descents are short after small motions, and a surface is a
    /// better start for the others.
    pub(crate) const DESCENTS: usize = 12;

    /// Corners of a face over which a pyramid is tried first. Measured on a prism of 32 vertices
    /// that slides on another: 5 corners answer, in two thirds of the time of all 16.
    pub(crate) const CORNERS: usize = 5;

    /// Support points that one pyramid may take in beside its apex. Not measured.
    pub(crate) const SUPPORTS: u32 = 6;

    /// Fans of more edges end a descent. Not measured.
    pub(crate) const FAN: usize = 64;

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
    /// Corners of a face on a half-space that are contact candidates, at most: of more, every
    /// second, third and so on. Not measured.
    pub(crate) const SAMPLE: usize = 48;

    /// Vertices of a face boundary tried next to a hint before bisection takes over. Not measured.
    pub(crate) const MAX_LOCAL_STEPS: usize = 4;

    /// Rays are cast from a point of an overlap this many times the rounding of a position off the
    /// boundaries: nearer, rounding chooses the edges by which they leave. Narrower overlaps count
    /// as lines. Not measured.
    pub(crate) const INSIDE: f64 = 16.0;

    /// Depths of contacts of a flat round face count as equal within this times the radius of the
    /// smaller shape: contacts that stand still on a shape that trembles, for depth. Tilted by `t`,
    /// a rim is deepest between two of its eight named points by up to `0.08 t` radii more, so
    /// contacts stand still up to a tilt of 2e-4. Not measured.
    pub(crate) const ROUND: f64 = 1.0 / 65_536.0;
}

/// The choice of a start between queries.
pub(crate) mod tracker {
    /// Walks of so many steps were near their end at the start, and extrapolation of the features
    /// would gain nothing. Not measured.
    pub(crate) const STEADY: u32 = 3;

    /// Cost of a cold start, two cube-map look-ups and climbs, in steps of the walk. Measured of
    /// the walks: some five steps from the support vertices of round bodies, and from the last
    /// features `1 + 0.085 sqrt(n)` steps a degree turned. Measured of 4, 2 and 1 over five motions
    /// and thirteen shapes: 2 takes 5 to 16 % less time than 4 at random poses of small bodies, and
    /// at most 3 % more elsewhere (flat bodies at 5 degrees, more with 1).
    pub(crate) const CLIMBS: u32 = 2;

    /// Costs of a start of which the running mean is taken. Measured of 4, 8, 12, 16 and 24 over
    /// round and flat bodies of 8 to 512 vertices that turn by 0.5, 5 and 25 degrees or stand at
    /// random poses, with [`TRIALS`] and [`FADING`], in instructions: every family takes at most
    /// 2.5 % more than with the better of the two starts alone (4, without trials, 7.7 %).
    pub(crate) const SAMPLES: u16 = 12;

    /// The same of the first start after the other way. Measured with [`SAMPLES`]: 2 and 3 alike.
    pub(crate) const TRIALS: u16 = 2;

    /// Queries in which the mean of the way not taken fades to some third, so that this way is
    /// tried again. Means of less than this many thirty-seconds of a step, 8 steps, fade no
    /// further: ways as cheap differ little. Measured with [`SAMPLES`] of 128 and 256.
    pub(crate) const FADING: u16 = 256;

    /// Cost of the direction of two ellipsoids, in steps of the walk. Not measured.
    pub(crate) const ELLIPSOIDS: u32 = 2;
}

/// Looks ahead by a separating plane.
pub(crate) mod separation {
    /// Rounds in which the rest beyond the bound of a root is cut off and bounded again. The bound
    /// converges quadratically, so few rounds reach rounding. Not measured.
    pub(crate) const ROUNDS: u32 = 4;

    /// Reach of the first try of a plane over the root expected: more room for the bound against a
    /// wider remainder. Measured with [`TRIES`]: 1.2 planes a look.
    pub(crate) const AHEAD: f64 = 1.25;

    /// A plane that proved less than this part of the interval tried is tried again with twice the
    /// part proven: a longer step for another plane. Measured with [`TRIES`].
    pub(crate) const ENOUGH: f64 = 0.4;

    /// Tries of a plane, at most. Measured: 1.4 on average.
    pub(crate) const TRIES: u32 = 3;

    /// Cut of an interval whose bound is a little too large. Not measured.
    pub(crate) const CUT: f64 = 0.75;

    /// Excess of a bound, `2^24`, from which on an interval is cut deeper. Not measured.
    pub(crate) const CUT_FAR: f64 = (1u64 << 24) as f64;

    /// The deepest cut at a time, `2^-60`: 18 reach zero from an interval of one. Not measured.
    pub(crate) const CUT_MOST: f64 = 1.0 / (1u64 << 60) as f64;

    /// Gap, over the sum of both radii, beyond which a plane that does not turn is tried as well:
    /// wins up to 40 % of the steps measured for the time of a second plane.
    pub(crate) const FAR: f64 = 0.05;

    /// In a cast a plane keeps its normal if turns give no point more than this part of the
    /// velocity at which the pivots approach each other: the plane then proves three quarters of
    /// the way to contact and more, without support points.
    pub(crate) const FIXED_SHARE: f64 = 0.3;

    /// In a cast a plane turns with the features if the gap is less than this part of the sum of
    /// both radii, as its steps converge quadratically. Measured from 1e-4 to 0.4 on casts of hulls
    /// of 8 to 512 vertices: .001 to .005 take 9 to 18 % less time than planes that always turn.
    pub(crate) const FIXED_GAP: f64 = 0.002;

    /// Faces with longer boundaries are not divided into triangles for the guess of an overlap: the
    /// search takes linear time. Not measured.
    pub(crate) const RIM: usize = 64;

    /// The ball about the middle of the box replaces the ball about the origin if smaller by this
    /// factor: tighter, for an arm in every bound. Not measured.
    pub(crate) const SMALLER: f64 = 0.8;

    /// Support heights of bodies of up to this many vertices come from a scan: no proof of a climb,
    /// for linear time. Not measured.
    pub(crate) const FEW: usize = 24;

    /// A direction nearer than this to the normal of a face, as a 1-norm, takes the height of the
    /// plane of the face and a bound of the difference: no climb along a face, for a height a
    /// little too large. Not measured.
    pub(crate) const FLUSH: f64 = 1.0 / (1u64 << 40) as f64;
}

/// Casts.
pub(crate) mod impact {
    /// Looks of a cast, at most. Measured: 21 at most up to a turn, thousands if gears turn a
    /// hundred times a hair apart.
    pub(crate) const LOOKS: u32 = 20_000;

    /// Every so many looks a cast ends if its looks would have to be this times as many as the
    /// limit to come to the end at their pace: bodies that turn by 1e15 radians. Not measured.
    pub(crate) const PACE_LOOKS: u32 = 1024;
    pub(crate) const PACE: f64 = 50.0;

    /// Part of the tolerance at which looks aim as a gap, and the proof behind contact as a depth:
    /// a larger part makes the bracket wider, a smaller part the queries slower. Measured: brackets
    /// of 0.2 tolerances.
    pub(crate) const AIM: f64 = 0.3;

    /// Width of the bracket of a ray cast, over the size of the pair: above the rounding of a
    /// place, so that a short piece of the ray proves a crossing. Not measured.
    pub(crate) const RAY_WIDTH: f64 = 1.0 / (1u64 << 40) as f64;

    /// Pieces of a ray that are tried for a crossing, each twice as long as the one before. Not
    /// measured.
    pub(crate) const RAY_CROSSINGS: u32 = 8;

    /// Distance of the balls, over the sum of both radii, from which on a cast jumps by balls
    /// without a query. Not measured.
    pub(crate) const CLEAR: f64 = 0.1;

    /// A tolerance is at least this times the rounding of a distance: below, proofs fail. Not
    /// measured.
    pub(crate) const LEAST: f64 = 8.0;

    /// Factor of a tolerance whose overlap was not proven. Not measured.
    pub(crate) const SHRINK: f64 = 1.0 / 16.0;

    /// Doublings of the step behind contact if the tolerance cannot shrink. Not measured.
    pub(crate) const DOUBLINGS: u32 = 6;
}

/// Schedules.
pub(crate) mod schedule {
    /// Entries of the heap above four a pair at which the heap is rebuilt without stale entries.
    /// Not measured.
    pub(crate) const SPARE: usize = 64;
}

/// Looks ahead in scenes.
pub(crate) mod scene {
    /// Ticks that a look ahead may prove at most. Longer proofs save little: the rounding of as
    /// many ticks is part of each proof, and velocities seldom stay for longer. Not measured.
    pub(crate) const TICKS: u64 = 64;

    /// Bodies of one task: enough to be worth a task. Not measured.
    #[cfg(feature = "parallel")]
    pub(crate) const RUN: usize = 1024;

    /// Pairs of one task: fewer, as a query takes longer than a box. Not measured.
    #[cfg(feature = "parallel")]
    pub(crate) const PAIRS: usize = 128;

    /// Work of a query over the work of a box in the broad phase: with the default settings,
    /// threads are used from 625 queries a step on. A query takes 60 ns and more, a task some
    /// microseconds.
    #[cfg(feature = "parallel")]
    pub(crate) const QUERY_IN_BOXES: u64 = 32;
}

/// The broad phase.
pub(crate) mod broad {
    /// A move across columns longer than this part of the column width is a jump. Not measured.
    pub(crate) const LEAP: f32 = 0.25;

    /// All columns are swept if this many times the moved bodies exceed all bodies: the costs of a
    /// sweep and of repairs meet near 9 % of the bodies.
    pub(crate) const WORLD_SHARE: usize = 10;

    /// A column is swept whole if this many times its changed entries exceed its entries. Not
    /// measured.
    pub(crate) const COLUMN_SHARE: usize = 6;

    /// A column is swept whole if more bodies than this come into the column, leave the column or
    /// jump: each shifts the entries behind. Not measured.
    pub(crate) const MOST_PARTED: usize = 32;

    /// A column is swept whole after all if the windows of its changed entries hold this many times
    /// its entries. Not measured.
    pub(crate) const MOST_SCANNED: u64 = 4;

    /// Number of windows with hits to collect before the hits are tested. Not measured.
    pub(crate) const PENDING: usize = 32;

    /// Cost of an entry, of a window of eight tests, of a column that holds bodies and of an empty
    /// column, in nanoseconds as fitted to sweeps of 10,000 boxes; only the ratios matter.
    pub(crate) const ENTRY: f64 = 6.0;
    pub(crate) const WINDOW: f64 = 4.5;
    pub(crate) const COLUMN: f64 = 30.0;
    pub(crate) const EMPTY_COLUMN: f64 = 0.75;

    /// Number of bodies sampled to choose columns. Not measured.
    pub(crate) const SAMPLE: usize = 512;

    /// Largest average number of entries of a body; a grid that needs more is too fine. Not
    /// measured.
    pub(crate) const MOST_ENTRIES: usize = 6;

    /// Longest wait between two checks of the column width, in steps. Not measured.
    pub(crate) const PATIENCE: u32 = 1024;

    /// Columns are cut anew if a step compares this many times the entries, a body, of the step
    /// measured last: more than the windows of fast bodies are widened by, less than a fourfold
    /// density costs. Not measured.
    pub(crate) const SURGE: f64 = 3.0;

    /// A new column width must promise at most this part of the present cost. Not measured.
    pub(crate) const GAIN: f64 = 0.85;

    /// Number of consecutive indices that share a block of links, as a power of two: few enough
    /// that a block fits in the nearest cache. Not measured.
    pub(crate) const SHIFT: u32 = 6;

    /// Number of items prefetched at once. Not measured.
    pub(crate) const AHEAD: usize = 32;

    /// Tables of up to this many items stay in near caches from step to step and need no
    /// prefetching. Not measured.
    pub(crate) const NEAR: usize = 1 << 14;
}
