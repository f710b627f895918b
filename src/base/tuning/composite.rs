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

/// If the pairs that were closest are farther apart than so many times the last distance, a new
/// pair is looked for before the front is proven again: with a distance that is too large a front
/// is split in vain. Bodies that slide on each other leave a pair every few frames.
pub(crate) const STALE: f64 = 4.0;

/// Fronts of more entries than this are given up if the directions of over half of them fail.
/// Plates in flush contact have some 30 entries, half of which only double precision can prove.
/// Fronts of no more are never cut.
pub(crate) const FEW_ENTRIES: usize = 64;

/// Nodes of fewer items have no slab: their corners are looked at one by one.
pub(crate) const SLAB_ITEMS: usize = 32;

/// Most entries of a front, of 64 bytes each: 2 MB, twice that while vectors grow. A longer front
/// is dropped. Linked rings of 100,000 triangles at the middle of each other's hole have some
/// 30,000.
pub(crate) const MOST_ENTRIES: usize = 1 << 15;

/// Entries of a front that are tested in the time of one bound of boxes; and how many such bounds a
/// pair of leaves and a pair of triangles take: by profiles of tumbling gears, roughly.
pub(crate) const ENTRY_WORK: u64 = 16;
pub(crate) const LEAF_WORK: u64 = 4;
pub(crate) const MEASURE_WORK: u64 = 8;

/// Most searches between a front that did not pay and the next one that is tried. Not measured.
pub(crate) const LONGEST_WAIT: u32 = 63;

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

/// From so many triangles on, a leaf of several need not be thin if it is compact, its middle axis
/// at least this part of its longest. A terrain of a million triangles as rough as they are long
/// takes 75 bytes a triangle instead of 154, 355 meshes of robots 88 instead of 95, the largest
/// mean of one 112 instead of 143; a knot of 20,000 is a fifth faster. Tori of 1,280 are twice as
/// slow: forty pairs of triangles that only boxes of their own prove are measured instead of five.
/// Slivers, which are not compact, make a gear of 20,000 a seventh slower.
pub(crate) const MANY_ITEMS: usize = 2048;
pub(crate) const COMPACT: f64 = 0.5;

/// A cut of a node leaves at least one part in this many on each side, so that the depth is a
/// logarithm.
pub(crate) const LOPSIDED: usize = 8;

/// Boxes so many times as long as wide are long: directions across their lengths are tried.
pub(crate) const LONG_BOX: f32 = 4.0;

/// A cut that leaves a part longer than this part of the node is compared with cuts along the other
/// axes. Shafts of 1,000 sides that cross at 10 degrees: 8,700 bounds a query without the direction
/// across both lengths and without the comparison, 190 with both.
pub(crate) const HARDLY: f64 = 0.95;

/// A cut along another axis must leave less than this part of the area that the first leaves. Not
/// measured.
pub(crate) const ACROSS: f64 = 0.8;

/// Items that reach farther from their middles than so many standard deviations of the node are
/// long: a cut may hardly shorten the parts. Not measured.
pub(crate) const LONG: f64 = 0.5;

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

/// Pairs measured in contact after which a search looks for inner points that the bodies share.
/// Bodies in one place have more contacts than triangles, and hardly a pair that crosses for
/// certain: of 280 queries of such bodies the longest measured 649 pairs with the look, 58,000
/// without.
pub(crate) const CROWD: u32 = 128;

/// Triangles of a solid whose middles are asked on which side of another surface they are, if the
/// vertices asked first all lie within rounding of it. Not measured.
pub(crate) const MIDDLES: usize = 256;

/// Planes that are tried to part two solids in contact. Not measured.
pub(crate) const PARTINGS: usize = 8;

/// Cosine of the angle of two normals that count as one among these planes. Not measured.
pub(crate) const SAME_NORMAL: f64 = 1.0 - 1.0 / (1u64 << 40) as f64;

/// Pairs of boxes and winding numbers after which bodies in contact that no plane parts are no
/// longer searched for common inner points. Not measured.
pub(crate) const MEETING_BOXES: usize = 16_384;
pub(crate) const LOOKS: u64 = 1024;

/// Triangles nearer than this part of L take the direction of a face or of two edges if one
/// proves as much as the direction of the witnesses: two more gaps for directions that prove
/// flush neighbours. Plates of 3,000 triangles at a gap of 1e-3: 300 bounds a query without.
pub(crate) const SHARP: f64 = 1.0 / 256.0;

/// The depth of the hull of a patch that does not go round a body, in its radius. Overlaps deeper
/// than half of it take the normal of a face instead of the hull's, at the price of one gap for
/// each face. Not measured.
pub(crate) const DEPTH: f64 = 0.25;

/// Most planes of a patch for contacts: larger patches for a build in time that grows with their
/// square. Not measured.
pub(crate) const PLANES: usize = 1024;

/// The hulls of patches of so many triangles are built with the patches, those of smaller ones
/// when a body comes near: a hull takes kilobytes, most patches of scanned meshes have three to six
/// triangles. Not measured.
pub(crate) const MANY_TRIANGLES: usize = 12;

/// Sine of the largest angle between a contact's normal and the normals of the mesh at the point:
/// witnesses 1e-9 apart have a direction right to 1e-7.
pub(crate) const CONE: f64 = 1.0 / 1_048_576.0;

/// Sine of the largest angle between the normals of contacts that are reduced together. Not
/// measured.
pub(crate) const ALIKE: f64 = 1.0 / 64.0;

/// Faces that are tried for a contact whose normal the mesh does not have. Not measured.
pub(crate) const FACES_TRIED: usize = 6;

/// The part of an edge beyond which a contact beside a vertex is looked for: a millionth. Corners
/// in 8,400 poses in valleys have the same contacts with 1e-9, 1e-6 and 1e-3, in 13.3, 12.2 and
/// 10.4 s of a build for tests.
pub(crate) const SHORT_EDGE: f64 = 1.0 / 1_048_576.0;

/// Pieces that are cut off a face, one after the other, to find the part that none covers. Not
/// measured.
pub(crate) const COVERS: usize = 4;

/// How far from a point that another piece covers a place of the same face is looked for that is
/// not covered, in the slack of the point: faces that meet at less than one part in this many of a
/// radian are one. Not measured.
pub(crate) const BESIDE_END: f64 = 64.0;

/// Bisections of the place along an edge at which a body begins to bear a contact: to 1e-9 of the
/// place. Corners in 8,400 poses in valleys have the same contacts, right to 1e-9, with 20, 30, 40
/// and 52, in 4.2, 6.2, 8.7 and 11.8 s of a build for tests.
pub(crate) const EDGE_HALVINGS: usize = 30;

/// Steps back along a translation that parts two bodies, to the place of their last contact. Each
/// takes the gap that is left, so few do unless the bodies slide past each other. Not measured.
pub(crate) const WAY_BACK: usize = 64;

/// Pairs of nodes that a look ahead splits at most. Not measured.
pub(crate) const AHEAD_PAIRS: usize = 2048;

/// Parts of a node that are few enough to be looked at one by one in a look ahead. Not measured.
pub(crate) const AHEAD_ITEMS: u32 = 8;

/// Horizons over which the second order of a look ahead is bounded, each a half of the last or
/// less. Not measured.
pub(crate) const HORIZONS: usize = 6;

/// Vertices of a mesh that are looked at for a lower bound of the depth. Not measured.
pub(crate) const DEEP_POINTS: usize = 2048;

/// Middles of stretches of edges that are looked at for a start of the depth. Not measured.
pub(crate) const DEEP_STRETCHES: usize = 128;

/// Pairs of leaves in which edges that cross the other mesh are sought. A pin in a slot has some
/// tens; meshes in one place have one for each pair of neighbours. Not measured.
pub(crate) const CROSSED_LEAVES: usize = 1 << 14;

/// Steps to the point of a piece that is deepest in a mesh. One finds the deepest point of a ball;
/// more turn with the faces of the mesh. Not measured.
pub(crate) const SINKS: usize = 4;

/// Bounds of a depth whose difference is below this part of the upper one are left as they are.
pub(crate) const TIGHT: f64 = 1.0 / 1_048_576.0;

/// Width to each side of the convex part of a body that proves a depth, in the depth. In 372
/// overlaps of bars, Ls, gears, tori, rocks and screws the bounds are the same with 1 to 16; with
/// 0.5 lower bounds of bars are 0.90 of the upper ones instead of 1.
pub(crate) const CELL_REACH: f64 = 4.0;

/// Most planes of a convex part; with more the part is made half as wide. In the same overlaps the
/// bounds are the same with 32 and with 512.
pub(crate) const CELL_PLANES: usize = 128;

/// Widths tried for a convex part. In the same overlaps the bounds are the same with one.
pub(crate) const CELL_HALVINGS: usize = 4;

/// Moves by the deepest overlap in a search for a translation that parts two bodies. Of 24 overlaps
/// of Ls the ratio of lower and upper bound is 0.78 at 10 % with 4, 0.83 with 12 and 32; of gears
/// 0.63 and 0.67.
pub(crate) const PUSHES: usize = 12;

/// Bisections of the length of a translation that parts two bodies: a thousandth of the length. Of
/// 24 overlaps of Ls the ratio of lower and upper bound is 0.78 at 10 % with 6, 0.83 with 10 and
/// 16; of gears 0.61, 0.67 and 0.67.
pub(crate) const HALVINGS: usize = 10;

/// Distances of points from pieces are measured by planes alone if that leaves less than this part
/// of the resolution open. Not measured.
pub(crate) const GAP: f64 = 1.0 / 64.0;

/// Faces whose depths differ by less than this part count as equally deep. Not measured.
pub(crate) const NEARLY: f64 = 1.0 / 64.0;

/// By which factor a translation that should part two bodies is longer: rounding shall not keep
/// them in contact.
pub(crate) const BEYOND: f64 = 1.0 + 1.0 / 1_073_741_824.0;

/// The last states of a mesh whose vertices are replaced by which a tracker recognises the mesh: a
/// tracker that has missed more replacements begins anew. Not measured.
pub(crate) const STATES: usize = 16;

/// A tree gets another origin and unit if a vertex is farther from the origin than this along an
/// axis, or half the diagonal of the box shorter than this, in units of the tree; a tree has a half
/// diagonal between one and two when it is made. Two bits of single precision are lost at most.
pub(crate) const GROWN: f64 = 4.0;
pub(crate) const SHRUNK: f64 = 0.5;

/// Nodes of up to so many items have the axes of the largest node above them that has no more.
pub(crate) const GROUP: usize = 16;

/// The upper part of a tree is made anew if so many times as many of its boxes hold points of the
/// surface as when it was made. Sheets of 20,000 triangles that are rolled up thrice in 100 frames
/// have 2,790 bounds a query instead of 3,670 (a whole new tree 1,570), ones that are folded thrice
/// 1,630 instead of 2,080 (1,060) on the way, tori twisted by half a turn 3,070 instead of 3,670
/// (2,050). Crumpled ones gain nothing and lose up to a fifth.
pub(crate) const LOOSE: f64 = 1.25;

/// The upper part of a tree is what is above nodes of so many items.
pub(crate) const LOWER_PART: u32 = 64;

/// How far beyond a box a point is still held, in units of the tree, which is one or two in size.
/// With 0.03 and 0.1 boxes of the size of the reach hide what is too many.
pub(crate) const SURFACE_REACH: f32 = 1.0 / 128.0;

/// Items whose middles are counted. Not measured.
pub(crate) const SURFACE_SAMPLES: usize = 512;

/// Boxes are counted again once the longest moves of a vertex since the last count add up to this,
/// in units of the tree: a count takes a tenth of a refit of 100,000 triangles.
pub(crate) const COUNT_PATH: f64 = 1.0 / 16.0;

/// The upper part of a tree is made anew after so many replacements of all vertices at the
/// earliest, in the time of some ten of them.
pub(crate) const REBUILD_WORK: usize = 16;

/// Triangles of a node among which three vertices far from each other are looked for. Not measured.
pub(crate) const FAR_SAMPLES: usize = 128;

/// Least width of an interval of time in which a first contact of vertices on straight paths is
/// looked for before exact arithmetic decides. Not measured.
pub(crate) const PATH_WIDTH: f64 = 1.0 / (1u64 << 20) as f64;

/// Most intervals of time tried for one pair of a vertex and a face or of two edges.
/// Not measured.
pub(crate) const PATH_INTERVALS: u32 = 128;

/// Most intervals of time tried for a pair of triangles as a whole, before its vertices, edges and
/// faces are tried pair by pair. Not measured.
pub(crate) const TRIANGLE_INTERVALS: u32 = 12;

/// Bits beyond which an integer of an exact decision of vertices on straight paths counts as wide.
/// Of coordinates that differ by less than twenty magnitudes none is.
#[cfg(feature = "exact")]
pub(crate) const WIDE: usize = 1024;

/// Most products of words of wide integers in the exact decisions of one call, which then ends as
/// unknown.
#[cfg(feature = "exact")]
pub(crate) const WIDE_WORK: u64 = 100_000_000;

/// A frame of meshes that rotate is searched in so many steps that the sagitta of a step is at most
/// this part of the radius of the smaller mesh, but in no more steps than the other number. Not
/// measured.
pub(crate) const ARC_PART: f64 = 1.0 / 1024.0;
pub(crate) const ARC_STEPS: f64 = 64.0;

/// Most intervals of time tried for a pair of triangles of meshes that rotate. Not measured.
pub(crate) const ARC_INTERVALS: u32 = 1024;

/// Most rounds in which the interval about the zero of a volume is narrowed. Not measured.
pub(crate) const PATH_ROUNDS: u32 = 32;

/// Most claims of a front of a mesh against itself, for each of its triangles; a longer front is
/// dropped. Not measured.
pub(crate) const SELF_CLAIMS: usize = 64;

/// A front of a mesh against itself is begun anew if so many times its claims have failed since it
/// was begun: what a claim has lost while vertices moved is not won back. A sheet of 20,000
/// triangles, folded thrice, whose layers move by a quarter of their distance a frame: 8.2 ms a
/// frame with 1, 7.0 with 4.
pub(crate) const SELF_FAILED: usize = 4;
