//! Curved patches: thresholds that steer work.

/// Splits of nodes that one query may make by default. Two bicubic patches in general position
/// need some hundred, surfaces that are level along a curve any number: see [`FIRST_LOOK`].
pub(crate) const SPLITS: usize = 20_000;

/// Splits after which a search first looks how far apart its bounds are; at twice as many it asks
/// whether they approach each other fast enough for its budget. Of 2,500 random pairs one in a
/// thousand needs more than 1,848 splits.
pub(crate) const FIRST_LOOK: usize = 1_024;

/// A search goes on if it is expected to need at most so many times its budget: the speed of its
/// bounds is seen only roughly. Pairs that are level along a curve need some twenty times the
/// usual budget for an interval of 1e-9.
pub(crate) const LENIENT: usize = 4;

/// Splits that a query may be allowed: two nodes each of 448 numbers at most are counted in 32
/// bits.
pub(crate) const MOST_SPLITS: usize = 1 << 22;

/// Steps of the minimum-norm solver on two nets before a pair is split instead. Not measured.
pub(crate) const STEPS: usize = 4;

/// Steps of Newton's method for two points. Quadratic once near; not measured.
pub(crate) const NEWTON: usize = 24;

/// The way, in parameters, over which the turn of a shape's normal is taken as its curvature. Not
/// measured.
pub(crate) const PROBE: f64 = 1.0 / 65_536.0;

/// How far back a point is from which the direction to a close shape is seen without the rounding
/// of a short line, as a part of the size. Not measured.
pub(crate) const BACK: f64 = 1.0 / 256.0;

/// Width of a measure over time, as a part of the distance: a look of conservative advancement goes
/// so much less far. Not measured.
pub(crate) const MEASURED: f64 = 1.0 / 4.0;

/// Width of a distance of surfaces in a scene, as a part of both radii. Not measured.
pub(crate) const SCENE_WIDTH: f64 = 1.0 / (1u64 << 30) as f64;

/// A look over time that would go less far by more than this part is measured again, narrower. Not
/// measured.
pub(crate) const NARROWER: f64 = 1.0 / 2.0;

/// A look ahead gives up if its bound proves less than this part of the distance left: the search
/// for a narrower one has met its limit, and each further look would cost as much for less.
/// Measured: no cast of the tests ends so.
pub(crate) const HOPE: f64 = 0.125;

/// Dampings, each eight times the one before, of a step of a point towards a shape.
pub(crate) const DAMPINGS: usize = 10;

/// Steps of Newton's method for the highest point of one node. Not measured.
pub(crate) const CLIMB: usize = 4;

/// Splits of one node in each direction: parameters stay multiples of `2^-48`.
pub(crate) const DEEPEST: u8 = 48;

/// A front is cut anew if it has grown to so many times its length. Not measured.
pub(crate) const GROWTH: usize = 4;

/// Numbers that a tracker keeps for the nets of split nodes, at most: 16 MB.
pub(crate) const KEPT: usize = 1 << 21;

/// The surroundings of the closest points are tried to be proven at once where a pair of nodes is
/// at most so many times as large. Not measured.
pub(crate) const SMALL: f64 = 4.0;

/// How far the first region reaches, as a part of the radius of the smaller surface. Not measured.
pub(crate) const BEGINNING: f64 = 0.25;

/// A region that was proven is this much larger in the next frame. Not measured.
pub(crate) const GROWING: f64 = 1.05;

/// A region that was not proven is tried so much smaller. Not measured.
pub(crate) const SHRINKING: f64 = 0.5;

/// Regions tried in one search. Not measured.
pub(crate) const TRIES: usize = 5;

/// After so many pairs split the search is taken to be stuck at a local minimum, as where bodies
/// cross: then two points are looked for below every 32nd pair, wherever its middle is. A search
/// for points costs as much as some six splits.
pub(crate) const IMPATIENT: usize = 128;

/// See [`IMPATIENT`].
pub(crate) const PATIENCE: usize = 32;

/// How far a bowl stays from the curvature of a surface in directions in which the other falls away
/// from its border, as a part of the curvature. Not measured.
pub(crate) const MARGIN: f64 = 1.0 / 4.0;

/// Sine of the angle of two borders below which a bowl bends alike along both. Not measured.
pub(crate) const CROSSING: f64 = 1.0 / 4.0;
