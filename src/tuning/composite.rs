//! Meshes and bodies of pieces: thresholds that steer work.

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
