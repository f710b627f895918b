//! Curved patches: thresholds that steer work.

/// Splits of nodes that one query may make by default. Two bicubic patches in general position
/// need some hundred, surfaces that touch along a curve any number.
pub(crate) const SPLITS: usize = 20_000;

/// Splits that a query may be allowed: two nodes each of 448 numbers at most are counted in 32
/// bits.
pub(crate) const MOST_SPLITS: usize = 1 << 22;

/// Steps of the minimum-norm solver on two nets before a pair is split instead. Not measured.
pub(crate) const STEPS: usize = 4;

/// Steps of Newton's method for two points. Quadratic once near; not measured.
pub(crate) const NEWTON: usize = 24;

/// Steps of Newton's method for the highest point of one node. Not measured.
pub(crate) const CLIMB: usize = 4;

/// Splits of one node in each direction: parameters stay multiples of `2^-48`.
pub(crate) const DEEPEST: u8 = 48;

/// A front is cut anew if it has grown to so many times its length. Not measured.
pub(crate) const GROWTH: usize = 4;

/// Numbers that a tracker keeps for the nets of split nodes, at most: 16 MB.
pub(crate) const KEPT: usize = 1 << 21;
