//! Motions of a robot among obstacles.

/// Width at which the bracket of a contact ends, in units of the sum of both radii: free
/// segments that come nearer than this need more looks. Not measured.
pub(crate) const CONTACT: f64 = 1.0 / (1u64 << 20) as f64;

/// Places of a segment measured before its clearance is proven. Not measured.
pub(crate) const SAMPLES: u32 = 8;

/// How often the clearance to be proven is lowered along a segment before nothing is said. Not
/// measured.
pub(crate) const LOWERED: u32 = 1000;

/// Steps of an ascent, at most. Not measured.
pub(crate) const ASCENT: usize = 96;

/// Gain of a step, over the length of the trust region, below which the clearance is taken for
/// stationary. Not measured.
pub(crate) const FLAT: f64 = 1.0 / 256.0;

/// Part of the expected gain that a step must bring. Not measured.
pub(crate) const GOOD: f64 = 1.0 / 8.0;

/// Pairs that count at one place, at most: as many bounds determine a maximum in six dimensions
/// twice over. Not measured.
pub(crate) const PLANES: usize = 12;

/// Exchanges between two weights in the search for a step, at most: of random models with six
/// planes 2 % are not at their maximum to a thousandth after 64, 0.2 % after 256.
pub(crate) const EXCHANGES: usize = 256;

/// Clearance, in units of the shortest step, below which a freeway has closed and no bridge
/// begins. Not measured.
pub(crate) const CLOSED: f64 = 64.0;

/// Steps of a trace of a freeway in one direction, at most. Not measured.
pub(crate) const TRACE: usize = 256;

/// Lengths of a step by which a corrector may move a place: farther is another maximum. Not
/// measured.
pub(crate) const HOP: f64 = 4.0;

/// The longest and the shortest step of an ascent or a trace, in units of the largest extent of
/// the bounds. Not measured.
pub(crate) const LONGEST: f64 = 1.0 / 16.0;
pub(crate) const SHORTEST: f64 = 1.0 / 32_768.0;

/// Random nodes of which the nearest begins a feeler or is its link. Not measured. There is one
/// feeler a slice: with 16 a plank of 0.2 through holes of 0.6, 0.4 and 0.3 took 0.20, 0.24 and
/// 0.53 s on average over 60 seeds, with 4 0.11, 0.17 and 0.30, with 1 0.08, 0.15 and 0.20.
pub(crate) const FEW: usize = 64;

/// Cosine of gradients that count as opposite. Not measured.
pub(crate) const OPPOSITE: f64 = 0.25;

/// Part of the way to a contact that is left out. Not measured.
pub(crate) const SHORT: f64 = 1.0 / 64.0;

/// Clearances within which a place of a freeway counts as known. Not measured.
pub(crate) const KNOWN: f64 = 1.0;

/// Components to which straight segments from one node are tried, at most. Not measured.
pub(crate) const LINKS: usize = 4;

/// Nodes of a component among which the nearest is looked for, at most: over all nodes the
/// search for the nearest took two thirds of the time at 40,000 nodes, and a plank of 0.2
/// through holes of 0.6, 0.4 and 0.3, 20 seeds each, was found in 0.30, 0.59 and 1.4 s on
/// average, against 0.19, 0.31 and 0.64 s.
pub(crate) const MANY: usize = 1024;

/// Places of a freeway from which links are tried, less one. Not measured.
pub(crate) const TRIES_A_FREEWAY: usize = 4;

/// Dimensions by which slices of slices may lose. Not measured.
pub(crate) const DEPTH: usize = 1;

/// Factor by which the distance is enlarged within which the last clearance was found, if no
/// obstacle is as near any more; if none is within that, all are asked. Not measured.
pub(crate) const ENLARGED: f64 = 4.0;

/// Pairs that were hit lately and come first at the next configuration; of these the first few are
/// asked before any box is looked at. Not measured.
pub(crate) const HITS: usize = 16;
pub(crate) const HITS_FIRST: usize = 2;

/// Part of the whole segment below which no swept box is cut shorter: so there are at most 128.
/// Not measured.
pub(crate) const SWEPT: f64 = 1.0 / 64.0;

/// Radians by which the joints that two links share turn, beyond which the pair is looked at from
/// the last link that carries both. Not measured.
pub(crate) const TURNED: f64 = 1.0;
