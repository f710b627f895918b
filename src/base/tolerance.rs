//! Bounds of rounding errors and limits of range. Each is a constant of this module with its
//! derivation next to it, in the source; this page states what they have in common. Thresholds that
//! only steer work change no answer, and are elsewhere.
//!
//! Derivations count relative roundings, as they are of normal numbers. Errors by underflow are
//! absolute, and fall under one of five cases:
//!
//! * **S, stored lengths** (the rule, if a derivation names no case). Bodies are stored with a
//!   radius of `2^-105` or more (`EXPONENT_FREE`), and pairs of L up to `NEAR`, possible for
//!   two points only, go to `solve::out_of_range`. A sum or product loses at most `2^-1075`, a
//!   product of three lengths at most `2^-1070`, the root of a sum of squares at most `2^-536`. The
//!   least error terms, `UNIT_DOUBLE_DOUBLE` times L, L^2 and L^3, are above `2^-402`, `2^-702` and
//!   `2^-1002`: far more, and each derivation has room for it. Translations are read in the
//!   caller's unit, which is at most `2^420` stored ones: translations lose less than `2^-652`, and
//!   L of bodies so small is `2^-105` or more.
//! * **P, poses**: products of coordinates of a quaternion lose at most `2^-1075` against a norm of
//!   one.
//! * **D, directions** of length one and edges, for signs: stored coordinates are multiples of
//!   `2^-357` (`FLUSH_EXPONENT`), directions are of length one or longer than `ON_BOUNDARY` times
//!   L. If the product of the direction's largest coordinate with the edge is not zero, it is above
//!   `2^-513`, and underflow of the remaining products is negligible; if the product is zero, the
//!   other two may be of any size, and underflow may leave either sign. Such a rise is certain
//!   above `LEAST_RISE` only.
//! * **G, guarded**: numbers of the caller of any size. Squares are guarded by `LEAST_SQUARE`, or
//!   numbers are scaled first.
//! * **U, the caller's unit**: bounds leave the stored unit in one function, `Draft::scale`, and
//!   are rounded outward there.
//!
//! # Degrees
//!
//! A product of `d` lengths is of degree `d`. Stored radii are from `2^-105` to `2^105`, so lengths
//! between points of two bodies that meet stay below `2^107`; lengths between bodies apart stay
//! below `2^301` (`FAR`). Each bound, with the largest product that a comparison with the bound
//! makes, and the cases above for the smallest:
//!
//! | bound | degree | largest product | smallest |
//! |---|---|---|---|
//! | heights along unit directions: `CERTIFICATE`, `AGREE`, `FOOT`, `DIRECTION`, `DIFFERENCE`, `PLATEAU` | 1, squares 2 | `2^602` | S |
//! | `EDGE_SIGN` | 2: a direction, up to `2^301`, and an edge | `2^409` | D |
//! | `STEEPER` | 5: the same, an axis that is a sum of products of two lengths, and an edge | `2^740`, of directions scaled to `2^400` in double-double `2^840` | D |
//! | `VOLUME` | 3 | `2^903` | S |
//! | weights of a triangle of a simplex | 4: three edges, one length between bodies | `2^630` | S |
//! | `ORIENTATION` | 3; the square of the height of a side as a quotient, 6 over 4 | `2^650` | S: a side that counts is higher than `2^-44 L`, and the root of the quotient is above `2^-150` |
//! | `SIDE_ERROR` and the exact predicates of the hull | 3, of one body | `2^324` | `FLUSH_EXPONENT` |
//! | `LEAST_SQUARE`, `ODOMETER`, `WAY`: scenes, in the caller's unit | 2 | `2^250` (`SCENE_REACH`) | G |
//! | curved pairs: squares of heights over triangles of their differences | 6, as lengths from `2^-140` to `2^140` (`SMALL_PAIR`) allow | `2^852` | S |
//! | squares of heights over triangles of a simplex, of polyhedra and of control nets | 6 over 4: two edges each, one length between bodies | `2^756` up to lengths of `2^160`, `2^1036` at `FAR` | a square that is not finite is no progress: the next solver, or the split of a net, answers |
//! | `PATH_GAP`, `PATH_AREA`, `PATH_VOLUME`: coordinates below one, directions up to `2^200` | 1, 2, 3 | `2^204` | directions are longer than `2^-200` (`PATH_DIRECTION`) |
//! | `BALLS`: casts | 4, of lengths and velocities scaled to less than 4 a coordinate | `2^8` | G: what is lost is far below `BALLS` |
//! | `PATCH_POINT` and the other bounds of points and heights of patches, of control points up to `2^200` (`PATCH_MAX`) | 1, squares 2; weights up to one and down to `2^-40` | `2^602` | S |
//! | normals of patches: products of two derivatives, up to `2^247` (42 R over the least weight), squared | 4 | `2^992` | a square that is not normal counts as no normal |
//! | `PATCH_SLOPE`: determinants of three derivatives | 3; entries of the inverse 2 over 3 | `2^744` | a determinant of zero proves nothing |
//!
//! A comparison of a higher degree is rearranged, as a quotient or a root, before it is made.
//!
//! # What is proved by machine
//!
//! The kernels are transcribed once more in `lab/proofs/src`, over any kind of number. With f64 a
//! transcription agrees with the crate bit for bit. With polynomials of errors in exact rationals
//! it yields a bound for all inputs: *proved*, below, next to what the constant, or a part of its
//! derivation, *allows*. With numbers that carry their own error it is attacked from below:
//! *found* is the largest error that a search of some seconds meets, far from the bound where
//! many roundings would have to conspire. All are in roundings of the format: `UNIT`,
//! `UNIT_SINGLE`, `UNIT_DOUBLE_DOUBLE` for rows in double-double, or the square of `UNIT`. The
//! package `proofs` compares all of it with the code; nothing but Rust is needed. Gappa proves
//! roots, quotients and chains of scalars once more where it is installed (`.ci/proofs`).
//!
//! * **Rows of `CERTIFICATE`** by feature pair, solver or kind of body are whole bounds of a
//!   distance: displaced bodies and what is computed of them, as a polynomial of both radii and the
//!   distance, which is compared with their sum, so that how the parts add up is proved too. The
//!   rows of polyhedra hold for pieces and triangles of meshes, which are placed and measured by
//!   the same kernels. Curved shapes are ellipsoids, cylinders, cones and polyhedra with them.
//!   What an error of a quaternion does to its matrix is proved by identities of polynomials.
//! * **Underflow**: the cases above are tests, kernel by kernel, as is the largest product of each
//!   row of the table of degrees, with the scale at which the largest of all leaves the range.
//! * **Prose** remains here: the parts of `DISPLACEMENT` stated "per" a length, and those of
//!   `BOXES` and `PLANE`, are each proved for one length alone, as they are linear in all; the sum
//!   of two numbers of twice the precision is right by the literature, as the table says; that a
//!   direction makes a gap a lower bound, and points of the bodies an upper one, is geometry.
//!
#![doc = include_str!("tolerance/proved.md")]

/// Unit roundoff of f64: the largest relative error of one rounded operation.
pub(crate) const UNIT: f64 = f64::EPSILON / 2.0;

/// Unit roundoff of f32.
pub(crate) const UNIT_SINGLE: f64 = f32::EPSILON as f64 / 2.0;

/// Bound of the relative error of one double-double operation: at most 10 UNIT^2 for sum and
/// product (Joldes, Muller, Popescu 2017, "Tight and rigorous error bounds for basic building
/// blocks of double-word arithmetic"; Muller and Rideau 2022, "Formalization of double-word
/// arithmetic", correct some of the proofs), 5 UNIT^2 for the quotient (derived at
/// `double_double`). Underflow: a low part below the least f64 is lost; case S.
pub(crate) const UNIT_DOUBLE_DOUBLE: f64 = 16.0 * UNIT * UNIT;

/// Largest deviation of the squared norm of a pose's quaternion from 1: the error that repeated
/// composition of f64 rotations accumulates over thousands of products. A relative pose divides by
/// the squared norm, so the value does not limit accuracy.
pub const POSE_UNIT: f64 = 1e-12;

/// The sum of the coordinates of the relative translation stays below this, so that neither a
/// distance nor an upper bound leaves f64: bodies themselves reach to 1e116 at most.
pub(crate) const REACH: f64 = f64::MAX * (1.0 - 1.0 / (1u64 << 40) as f64);

/// Pairs whose size L (in the stored units of the larger body) is beyond this are answered by their
/// separation alone: their radii are below the rounding of L, and cubes of lengths (determinants of
/// a simplex) would leave the range.
pub(crate) const FAR: f64 = f64::from_bits((1023 + 300) << 52);

/// Pairs whose size L is below this are answered by their separation alone, as beyond [`FAR`]; only
/// two points can be so close, as every body with an extent is stored at radius 2^-105 or more.
pub(crate) const NEAR: f64 = f64::from_bits((1023 - 300) << 52);

/// Noise of a difference of two posed points, in units of the pair's size L: each coordinate of a
/// posed point carries a few roundings of numbers up to L. A direction made from such a difference
/// leaves a vertex or a plane only if the descent exceeds this noise; a smaller descent is left to
/// the certificate. The sign of a direction's weight over the plane of a face at an edge is certain
/// above this times L and the edge: edge 1, cross product 2.5, dot product 3 and normal 1.1, 7.6.
pub(crate) const DIFFERENCE: f64 = 8.0 * UNIT;

/// Noise, times L, of a height along a direction of unit length that is not a difference of points
/// (a face normal, an edge turned by a pose). Not a matter of soundness.
pub(crate) const DIRECTION: f64 = 16.0 * UNIT;

/// A point over the plane of a face has its foot in the face if the point is inside every side
/// plane by more than this times L. For an edge `u` of the face boundary the side `(n x u) . (x -
/// to)`, over `|u|`, errs by `5.3 UNIT` (the stored normal 1.1, the edge 1, the cross product 3.2),
/// `UNIT` (the difference) and `3 UNIT` (the product), all times `|x - to| <= L`; the foot itself,
/// `x - n h`, by `2 UNIT L` within the plane, and by the tilt of the normal, 1.1. Sum: 12.4.
pub(crate) const FOOT: f64 = 16.0 * UNIT;

/// Witnesses closer than this times L are no ground for a direction; the more precise solvers take
/// over. A vector from an edge has a part of at most 11 UNIT L along the edge, so less than its
/// length, and is made right once more within the 9 UNIT that [`CERTIFICATE`] counts.
pub(crate) const ON_BOUNDARY: f64 = 16.0 * UNIT;

/// Two edges with a squared sine below this have their cross product orthogonalised once more
/// before use: the error perpendicular to the cross product is `UNIT / sine`.
pub(crate) const NEARLY_PARALLEL: f64 = 1.0 / 16.0;

/// Two edges with a squared sine below this are taken as parallel: the cross product is rounding
/// alone. Above, the cross product's own error, 2.5 UNIT, is less than a sixth of its length, and
/// it is made right to an edge within the 10 UNIT that [`CERTIFICATE`] counts.
pub(crate) const PARALLEL: f64 = 256.0 * UNIT * UNIT;

/// The walk's answer is accepted if witnesses and supporting planes agree within this times L: the
/// error of the distance, should the pair be wrong, is below `1e-14 L`, 90 UNIT. Measured on right
/// answers: at most 11 UNIT L by the supports, and some tens by the planes of two faces if the two
/// planes of a sharp edge are used instead.
pub(crate) const AGREE: f64 = 64.0 * UNIT;

/// A depth is proven if the height along the best normal and the nearest triangle agree within this
/// times L: the rounding of both is a few UNIT L each (see [`CERTIFICATE`]), the height of an edge
/// proven by the planes of two faces may be half of this tolerance above the edge, and the rest
/// must stay below `1e-14 L`, 90 UNIT.
pub(crate) const AGREE_DEPTH: f64 = 32.0 * UNIT;

/// Deepest points that are off their expected position by more than this times L are searched again
/// in double-double: well below the `1e-13 L` to which an answer is bounded.
pub(crate) const AGREE_WITNESS: f64 = 512.0 * UNIT;

/// Squared lengths from this to the inverse of this are normalised without scaling; a product of
/// two such squares, and the square of each coordinate that is not negligible, is far inside the
/// range of f64.
pub(crate) const SQUARE_MIN: f64 = 1e-200;

/// A triangle of the Minkowski difference that its support exceeds by less than this times L,
/// `2^-16`, may lie in the boundary: the normals of the bodies' features are tried. Not a matter of
/// soundness.
pub(crate) const ALMOST_FLAT: f64 = 1.0 / 65_536.0;

/// Noise of a position perpendicular to the normal of a contact, times L: a vertex in the body's
/// frame less the witness, 2 UNIT of each coordinate, two products with axes that are right within
/// [`DIRECTION`], and the witness itself within as much. The common region of two faces is closed:
/// vertices this far outside belong to the region. Not a matter of soundness.
pub(crate) const ACROSS: f64 = 64.0 * UNIT;

/// Twice the rounding of the height of a point along a direction of length one, times the distance
/// of the point from the origin: three products and two sums, each off by one UNIT at most of what
/// is less than 1.8 times that distance.
pub(crate) const CELL: f64 = 16.0 * UNIT;

/// Faces of a mesh nearer than this times its radius may be one plane; steers work alone.
pub(crate) const ONE_PLANE: f64 = 64.0 * UNIT;

/// Faces whose normals differ by less than this, `2^-46`, carry a contact as a single face: a flat
/// face whose vertices were rounded comes as several, with normals apart by a few UNIT times the
/// size of the face over the width of the parts. A point attributed to the wrong part is off by no
/// more than this times L.
pub(crate) const COPLANAR: f64 = 1.0 / (1u64 << 46) as f64;

/// A face carries no contact if the cosine of its angle to the normal is below this: heights over a
/// position err by the position's noise times the tangent, at most `64 ACROSS L`. Not a matter of
/// soundness.
pub(crate) const STEEP: f64 = 1.0 / 64.0;

/// The radius of the disc that a facet must contain to replace triangles below the target
/// (`depth::facet`) is raised by this factor. The products, quotient and roots err by 10 UNIT
/// relatively; the difference of squares by `3 UNIT r^2`, which is less than the `2 CERTIFICATE
/// UNIT L` taken off each height `p` adds to the difference.
pub(crate) const DISC: f64 = 1.0 + 1.0 / 1024.0;

/// A larger disc than this part of the height is not tried: a disc so large is no matter of faces
/// upon faces. The proof has room for a half.
pub(crate) const DISC_MOST: f64 = 1.0 / 4.0;

/// A contact of a manifold stays while the contact is no worse than this times its replacement. Not
/// a matter of soundness.
pub(crate) const STAY: f64 = 1.25;

/// If the origin lies on the boundary of the tetrahedron that a search for the depth would begin
/// with, the search begins about a point shifted by this many L: the search succeeds for depths of
/// more than twice as much, so the shifts shrink to the rounding of double-double. The least shifts
/// are tried on both sides: if the origin is nearer to the boundary than the shift, one of the two
/// points lies outside, and the direction to the boundary from this point gives a height below the
/// shift.
pub(crate) const ORIGIN_SHIFTS: [f64; 8] = [
    0.0,
    1.0 / (1u64 << 10) as f64,
    1.0 / (1u64 << 24) as f64,
    1.0 / (1u64 << 40) as f64,
    1.0 / (1u64 << 58) as f64,
    -1.0 / (1u64 << 58) as f64,
    1.0 / (1u128 << 80) as f64,
    -1.0 / (1u128 << 80) as f64,
];

/// The direction of the shift: off the planes and axes of lattices, and of length at most 1 (0.98).
pub(crate) const SHIFT_DIRECTION: [f64; 3] = [0.613, -0.365, 0.677];

/// Heights along a direction `n` that are within this times `|n|_1 L` of each other may be equal:
/// three roundings of each of two dot products and of the direction itself.
pub(crate) const PLATEAU: f64 = 16.0 * UNIT;

/// Error term of both bounds, in units of UNIT L, derived line by line (u = UNIT, norms are
/// Euclidean, `t` the relative translation; a cross product errs by `2.5 u |a| |b|`, a dot product
/// by `3 u |a| |b|`, a product with a rotation matrix by `4.5 u`). A pose as computed displaces the
/// bodies, 1 to 3, and the distance by no more; what is computed of bodies so placed, 4 to 6, comes
/// on top. The sums over all feature pairs and solvers are in the table of the module, by machine.
///
/// 1. The relative quaternion: four products a coordinate, 5 u as a vector. Perpendicular to the
///    quaternion such an error turns by twice as much; along the quaternion the error scales the
///    difference of matrix and identity, a matrix of norm 2, by twice as much: together at most
///    `5 u sqrt(4 + 16)`. The factor `2 (2 - |a|^2) (2 - |b|^2)` errs by 9 u, and counts twice.
/// 2. Its matrix: 10.7 u. With 1, a vertex of B is turned wrong by at most 51 u rB. (Other
///    constants that rest on these steps count 71 for it, 31 for step 3 and 6 for a product.)
/// 3. The relative translation: the difference of the translations, `u |t|`; the two cross products
///    and their sum, doubled by the factor; the factor, 4 u, and the product with it, of at most `2
///    |t|`; the last sum: together at most 30.1 u |t|. In B's frame, A is displaced by 51 u of rA
///    and |t|, and 30.1 u |t|.
/// 4. A vertex in the other frame: 4.5 u of its distance from the other origin and one sum, or a
///    difference before.
/// 5. A height along a direction: 3 u of each length, sums one. A vertex is lowest along the
///    direction as turned into its frame: 4.5 u of its radius, twice. Of two edges each extreme
///    perpendicular to the other (`FLANK`): `n` is off the right angle to both as computed by 10
///    u, as the sine is at least 1/4, or is made right within less; this counts by twice the
///    radius, and so do the edges' own errors, 1 u on A and 5.5 u on B. Of an edge paired with a
///    vertex, the direction is made right within 9 u and the edge errs by 1: twice the radius.
/// 6. The witnesses, made as `p + s u` with `s` in 0..1, or as a sum of vertices whose weights sum
///    to 1 within 3 u. The norm, 2.5 u; the inverse of one and products with it, up to 8.5 u.
///
/// Two edges are the worst pair, with 100.2 u L. In double-double the pose is a product of two
/// matrices, whose entries err each, and the translation turns the origins of the bodies, which are
/// added to L: 104.1 [`UNIT_DOUBLE_DOUBLE`]. Poses off unit length and the second order are counted
/// in.
pub(crate) const CERTIFICATE: f64 = 128.0;

/// Difference, in each coordinate, up to which the normals of two half-spaces count as opposite:
/// the matrix of the relative rotation errs by at most 51 UNIT (steps 1 and 2 of [`CERTIFICATE`]),
/// a product with it by 3, the two normals by 2 each, and the length by 2. Half-spaces whose
/// normals are opposite to less than this are measured as if they were.
pub(crate) const OPPOSITE: f64 = 64.0 * UNIT;

/// Error of the displacement of a body between two poses, in units of its radius `r`, of the
/// distance `|c|` of its ball's middle from its own origin, and of the distance of the origins
/// `|t|` at either pose (u = UNIT, errors as in [`CERTIFICATE`]): a rotation errs by `71 u` in
/// norm, so the Frobenius norm of the difference of two by `2 sqrt(3) 71 u`, over the root of 2
/// `174 u r`; the posed middle at each pose by `77 u |c| + 109 u |t|` at most; the norms and their
/// sum by 4 u of their value, at most `2 (r + |c|)` and both `|t|`. Together at most `182 u r + 162
/// u |c| + 113 u |t|`. Underflow: used only for sizes above [`NEAR`], whose share of the error is
/// above `2^-345`; roots lose less than `2^-536`.
pub(crate) const DISPLACEMENT: f64 = 256.0 * UNIT;

/// Largest difference, in units of the size of the pair, between a stored contact and one that is
/// computed again at the same pose: depths of curved shapes are known to `2^-19 L`. A larger one
/// means that a text is false, or that one of several equal answers was chosen; then contacts are
/// computed again, so the value steers work alone.
#[cfg(feature = "serde")]
pub(crate) const REPEATED: f64 = f64::from_bits((1023 - 16) << 52);

/// Square of the largest difference between the normals of two such contacts. It steers work alone.
#[cfg(feature = "serde")]
pub(crate) const REPEATED_NORMAL: f64 = f64::from_bits((1023 - 20) << 52);

/// Least extent (longest side of the bounding box) of a body, in the caller's unit: cubes of
/// lengths, as volumes are, stay above the least f64.
pub(crate) const EXTENT_MIN: f64 = 1e-100;

/// Least extent of a part of a body, of which no volume is computed: `2^-500`. The stored unit of a
/// part is the one of a body of extent [`EXTENT_MIN`], since `2^-525 < 2^-500` ([`EXPONENT_FREE`]),
/// and the square of such a length is a normal number.
pub(crate) const PART_EXTENT_MIN: f64 = f64::from_bits((1023 - 500) << 52);

/// Largest extent of a body: cubes of lengths stay finite.
pub const EXTENT_MAX: f64 = 1e100;

/// Largest coordinate of a vertex: no body of an extent up to [`EXTENT_MAX`] has a larger
/// coordinate and a neighbouring double within its extent; points have the equal limit.
pub(crate) const PLACE_MAX: f64 = 1e116;

/// Bodies are stored with a radius from `2^-105` to `2^105`, scaled by a multiple of `2^210` if
/// needed: most bodies are stored as given, and bodies of similar size share a unit.
pub(crate) const EXPONENT_FREE: i32 = 105;

/// Stored coordinates below `2^-200` of the radius become zero. Radii are at least `2^-105`, so the
/// last bit of any kept coordinate is worth `2^(-105 - 200 - 52)` or more and a product of three
/// differences `2^-1071`: above the least f64, `2^-1074`, hence the expansions of the orientation
/// predicates are exact.
pub(crate) const FLUSH_EXPONENT: i32 = 200;

/// If a cross product is below `2^-40` of the two products whose difference the cross product is,
/// double-double has lost too much and expansions take over. Above this limit the direction errs by
/// less than `3 * 2 * 16 UNIT^2 * 2^40 < UNIT / 64`.
pub(crate) const CROSS_CANCELLED: f64 = 1.0 / (1u64 << 40) as f64;

/// Largest distance between the stored and the true unit normal of a face: rounding moves a unit
/// vector by at most UNIT, the computation in double-double before by less than UNIT / 32
/// (`CROSS_CANCELLED` and a root).
pub(crate) const NORMAL_ERROR: f64 = 1.0625 * UNIT;

/// Faces given by the caller may leave their plane by this times the diagonal of the body's box:
/// the vertices of a polygon computed by a rotation and a shift err by a few UNIT each, and the
/// plane through three vertices, extrapolated, by some tens.
pub(crate) const PLANARITY: f64 = 64.0 * UNIT;

/// A point of the body exactly in the plane of a face satisfies `n . p >= offset - NEAR_PLANE
/// radius` in rounded arithmetic: `n . p` errs by 4 UNIT radius at most, the tilt of the stored
/// normal by 3 and the rounding up of the offset by 5.
pub(crate) const NEAR_PLANE: f64 = 16.0 * UNIT;

/// From beyond `2^60` radii a body's closest point depends on the direction only, to `2^-60` of its
/// size: below rounding.
pub(crate) const FAR_POINT: f64 = (1u64 << 60) as f64;

/// Error of a bound by two faces, in units of their weights `s (alpha + beta)` times the radius, to
/// first order: `m = alpha nL + beta nR` has two roundings a coordinate, 2 UNIT as a vector of
/// length at most `alpha + beta`; `s m` one more. Each of the two products of the sum of offsets
/// passes four roundings (weight, sum, `s`, and the sum of all). The rest `n - s m` is
/// perpendicular to `n`, so no longer than `s m`, and passes four: the difference, the sum with the
/// weights, the product with the radius and the sum of all. The two sums of its 1-norm cost
/// nothing: a rounded sum is no less than its largest term, so either the 1-norm is longer than the
/// length by what they lose, or the largest term is the length, up to `8 UNIT^2`. Sum: 11, and the
/// second order.
pub(crate) const EDGE_BOUND: f64 = 13.0 * UNIT;

/// A pivot of a small system below this times its diagonal may be rounding alone: products and sums
/// of up to four terms, and room. Not a matter of soundness.
pub(crate) const PIVOT: f64 = 4096.0 * UNIT;

/// Outward rounding of a box found by support climbs, in units of the radius and of the distance of
/// its middle: the matrix errs by at most 20 UNIT a row, a product with the matrix by 3 and the sum
/// by 1. Underflow: cases P and S in stored units; in the caller's, a box is rounded outward to
/// f32, whose least number is far above the loss.
pub(crate) const BOX: f64 = 32.0 * UNIT;

/// Outward rounding of a posed box about the box of a body, in units of the sum of the body's
/// farthest coordinates and of the distance of its middle: the matrix errs by at most 20 UNIT a
/// row, products and sums by 8. The rest is room: a box contains its body up to a rounding or two
/// of its corners, and a compound grows its box by what rotated pieces may be off
/// ([`PLACED_PIECE`]).
pub(crate) const BOX_TURNED: f64 = 64.0 * UNIT;

/// Outward rounding of a box found by a scan in f32, in units of the radius: one rounding of each
/// coordinate and of the matrix, three of their products and sums, of numbers whose absolute sum is
/// at most the radius.
pub(crate) const BOX_SCANNED: f64 = 8.0 / 16_777_216.0;

/// Columns of the broad phase: a mean box is taken for no smaller than this part of the world, so
/// that spreads in units of the mean box stay finite if all boxes are points. Costs time only.
pub(crate) const LEAST_MEAN: f64 = 1e-9;

/// Columns are no narrower than this: the quotient of the world and the width stays finite. Costs
/// time only.
pub(crate) const LEAST_WIDTH: f64 = 1e-30;

/// The search for a width starts at no less than this part of the world, for boxes that are points.
/// Costs time only.
pub(crate) const LEAST_START: f64 = 1e-6;

/// Relative excess of a step of an odometer. Poses may be off unit norm by [`POSE_UNIT`] in the
/// square, so rotations are farther apart than their quaternions by half as much, to first order;
/// the difference of two quaternions and the sums and roots of the difference err by some 8 UNIT,
/// far less. Underflow: case G.
pub(crate) const WAY: f64 = 2.0 * POSE_UNIT;

/// More than a sum of three squares, or a product of two numbers, can lose below the normal numbers
/// (2^-1072), by a factor of 2^82: added to squares of displacements before the root, so that no
/// displacement vanishes, and to the side of a comparison of squares that must not win by the loss.
/// Case G.
pub(crate) const LEAST_SQUARE: f64 = f64::MIN_POSITIVE * (1u64 << 32) as f64;

/// Error of the posed centre `q c + t` of a body's ball: less than this times `|c|_1 + |t|_1`. The
/// quaternion is divided by its length: 2.5 UNIT common to its coordinates, which turn and stretch
/// by up to four times as much, and the quotients one UNIT each, which count `sqrt 20` times (see
/// [`CERTIFICATE`], 1): 14.5 UNIT. The product of quaternion and vector, two cross products and
/// their sums, errs by 15.5 as a vector, and the last sum by 1: 31. No error if c is zero.
/// Underflow: c is the centre of a body, so of `1e-100` or more against a loss of `2^-1073`.
pub(crate) const CENTRE: f64 = 32.0 * UNIT;

/// A sum of odometers, or the sum at which a pair wakes, has a relative error below this: one
/// rounding for the sum of two odometers, one for a budget added, one for each later sum, and each
/// odometer is rounded up at every step ([`WAY`] covers the step, 4 UNIT the sum). Eight cover
/// them. Underflow: sums lose nothing, and each way is `2^-495` or more (case G).
pub(crate) const ODOMETER: f64 = 8.0 * UNIT;

/// Coordinates, radii and ranges of a scene stay below this, so that boxes grown by a range stay
/// below 1e38, the clamp of `f32` boxes, and no distance or odometer leaves f64.
pub(crate) const SCENE_REACH: f64 = 1e37;

/// Factor that rounds up a length made by a root of three squares, or a sum or product of two
/// numbers that are not negative: three squares and two sums err by 3 UNIT, half as much under the
/// root, and the root by one, a sum or product by one; this product adds one. Less than 4 in all.
pub(crate) const ROUND_UP: f64 = 1.0 + 4.0 * UNIT;

/// Factor that rounds down the distance of two centres before the radii are subtracted:
/// differences, squares, sums and root err by 3.5 UNIT, the guard against underflow by half of one,
/// this product and the subtraction after it by one each. Sum: 6.
pub(crate) const ROUND_DOWN: f64 = 1.0 - 8.0 * UNIT;

/// Factor that rounds up the largest distance of a vertex from a centre, and scales it: a
/// difference or a quotient by a scale errs by UNIT, three squares, two sums and a root by 2.5, the
/// scale and this product by one each. Sum: 5.5. The reach of a body in a scene, a distance of a
/// centre and a radius, errs by 2.5, their sum and the product by one each. Sum: 4.5.
pub(crate) const RADIUS_UP: f64 = 1.0 + 8.0 * UNIT;

/// Factor that rounds down the distance of two boxes, below which no body in them is nearer: a
/// difference errs by UNIT, squares, sums and root by 2.5, this product by one. Sum: 4.5.
pub(crate) const BOX_DISTANCE_DOWN: f64 = 1.0 - 8.0 * UNIT;

/// Factor of the distance `radius + |a|` in the offset of a plane: the stored normal is off by
/// [`NORMAL_ERROR`], raised by 4 units in the last place for the roundings of this distance, and
/// the product `n . a` in double-double errs by 4 [`UNIT_DOUBLE_DOUBLE`].
pub(crate) const PLANE_OFFSET: f64 = NORMAL_ERROR * (1.0 + f64::EPSILON * 4.0) + 4.0 * UNIT_DOUBLE_DOUBLE;

/// The length of an answer's normal differs from one by less than this: a normal is divided by its
/// length, which errs by 2.5 UNIT, the quotient and the length measured again by 3.5 more; a turn
/// into another frame and room make 16. A check in debug builds, no bound of an answer.
pub(crate) const UNIT_LENGTH: f64 = 16.0 * UNIT;

/// Witnesses placed in f64 agree with the bounds within this times the size of the pair with its
/// origins counted twice: [`CERTIFICATE`] UNIT for the bounds and for each of the placed witnesses,
/// and room for their rounding in the caller's coordinates, which may be far from the body. A check
/// in debug builds, no bound of an answer.
pub(crate) const WITNESS_CHECK: f64 = 1024.0 * UNIT;

/// Columns of the broad phase, in `f32`: a rounded sum of two bounds errs by less than this times
/// the magnitudes, which is four units in the last place.
pub(crate) const COLUMN_SUM: f32 = 4.0 * f32::EPSILON;

/// Columns of the broad phase, in `f32`: above the rounding of a difference of bounds, of a sum of
/// two moves and of the product with this factor itself, half a unit in the last place each.
pub(crate) const COLUMN_MOVE: f32 = 1.0 + 8.0 * f32::EPSILON;

/// Columns of the broad phase, in `f32`: a search along the swept axis begins and ends this much
/// farther out, times the magnitude of its bounds. The difference or sum that makes the end errs by
/// half a unit in the last place of numbers up to that magnitude and the longest box.
pub(crate) const COLUMN_SEARCH: f32 = 8.0 * f32::EPSILON;

/// Columns of the broad phase, in `f32`: the longest box and the farthest move, differences rounded
/// to half a unit in the last place, are raised by this factor before a search; 84 units, far more
/// than the difference and this product need.
pub(crate) const COLUMN_REACH: f32 = 1.000_01;
/// An inner tangent ball of an ellipsoid is taken this much smaller than its formula: `c^2 / (n .
/// s)` has three roundings and a dot that errs by 11 UNIT (see [`CERTIFICATE`]); the support point
/// lies off the surface by as much relative to itself, and the normal there off `n` by 8 UNIT
/// relative to each coordinate, which counts by its square.
pub(crate) const INNER: f64 = 1.0 - 64.0 * UNIT;

/// Bounds of a curved pair agree if apart by at most this times L before their error terms: the
/// largest measured violation of either bound is 3.6 UNIT L, and a direction in f64 closes the
/// bounds to a few UNIT L unless a core is flat or the direction is the direction of a rim.
pub(crate) const AGREE_CURVED: f64 = 16.0 * UNIT;

/// Witnesses of bodies apart are opposite each other if their vector is off the normal by at most
/// this times L, `2^-31`: bounds that agree leave the square root of twice [`AGREE_CURVED`] times
/// the distance. Not a matter of soundness.
pub(crate) const ASIDE: f64 = 1.0 / (1u64 << 31) as f64;

/// A depth of curved cores without a proof by inner balls is searched to this times L, `2^-20`, in
/// each bound.
pub(crate) const DEPTH_GOAL: f64 = 1.0 / (1u64 << 20) as f64;

/// The axis of B is at most this much farther off that of A than the matrix of the rotation says,
/// as a chord of the unit circle. The matrix is off a rotation by 19 UNIT, and turns a vertex of B
/// wrong by 71 UNIT rB and 31 UNIT |t| (see [`CERTIFICATE`]); the normals of edges are rounded by 4
/// UNIT, which counts by L; a height along a normal errs by 12 UNIT for the turned direction and by
/// 6 and 3 for products and sums. With 38 UNIT rB, twice the 19, these are at most 141 UNIT L;
/// twice this term, 64 UNIT rB, and [`CERTIFICATE`] are more.
pub(crate) const PARALLEL_AXES: f64 = 32.0 * UNIT;

/// A core smaller than this times the size of its pair, `2^-60`, is a point but for its radius.
pub(crate) const SPECK: f64 = 1.0 / (1u64 << 60) as f64;

/// Pairs of a size from this, `2^-140`, to its inverse are solved in the caller's unit; all further
/// pairs in their own unit. The square of a height over a triangle is of degree six: at `2^170` it
/// would be infinite.
pub(crate) const SMALL_PAIR: f64 = f64::from_bits((1023 - 140) << 52);

// Motions, impacts and compounds.

/// Error of the posed pivot of a body on a motion, twice (once at the start of a bound, once at the
/// end), in units of the 1-norms of the pivot's position at time zero, and of the displacements by
/// velocity and acceleration until then: `v t` has one rounding, `a t^2 / 2` three, their sums two,
/// the last difference one, and the velocity at a later time two more times the displacement: 6
/// UNIT.
pub(crate) const PLACED_CENTRE: f64 = 16.0 * UNIT;

/// Error of the posed pivot, twice, in units of the distance of the pivot from the body's own
/// origin: a product with a quaternion whose square is off 1 by 26 UNIT is off by twice as much,
/// and rounded by 24; the difference adds 1. Twice 77.
pub(crate) const PLACED_PIVOT: f64 = 192.0 * UNIT;

/// Error of the angle of a posed body on a motion, twice. The quaternion of a turn: sine and cosine
/// err by less than one in the last place, UNIT; the correction for the remainder of the half
/// angle, UNIT; the axis by 2 UNIT and its product by one: 5.4 UNIT as a vector. The product with
/// the first rotation: 4 UNIT a coordinate, 8 as a vector. An error of a quaternion turns by twice
/// as much: 27 UNIT. A normalised sum of two quaternions: 3 UNIT a coordinate of numbers up to one,
/// over a norm of at least `1 / sqrt 2`: 9 UNIT and, for the part of the way itself, one more: 20
/// UNIT.
pub(crate) const TURN: f64 = 64.0 * UNIT;

/// Deviation from one, as computed, of the squared norm of a quaternion that was divided by its
/// norm: the square errs by 4 UNIT, the root by half of that and UNIT, the quotient by UNIT: 8 of
/// the square, and 4 of the square taken again, and a little of second order.
pub(crate) const NORMALISED: f64 = 13.0 * UNIT;

/// Error of the coefficients of a plane's gap (`separation::plane`), times `(1 + q)^2` with q the
/// angle that a direction turns by as a shape sees it, in units of both reaches, the ways of the
/// pivots, the difference of the translations, and twice the distances of the pivots from the
/// origins (u = UNIT):
///
/// 1. Directions: derivatives are sums of at most three cross products, 8 u of `(|eta| + |w|)^2`,
///    and the control points two sums and products more: 12 u. Into the body: the matrix of one
///    quaternion 27 u (19 for its entries, 8 for the square of its norm), the product 6 u. Heights
///    over the arm of a pivot 3 u. Together 48 u of the reach.
/// 2. The pivots: a product with that matrix 33 u, two sums 2 u; the difference of the translations
///    u. Products with the normal and with its derivatives 9 u.
/// 3. Sums of at most five terms, and from square to cube, 8 u; the length of the normal, 3 u,
///    times the distance to keep.
///
/// Of a plane that keeps its normal (`separation::fixed_normal`), what turns give to points along
/// the normal errs by 9 u of itself: the length of the cross product 2.5 u beyond [`TILT`], the
/// reach 3 u, products and sums 3.5 u.
pub(crate) const PLANE: f64 = 64.0 * UNIT;

/// Error of the length of a cross product of a unit vector with another, in units of the length of
/// the other: the product errs by 2.5 UNIT, the difference of two rates by 1, the unit vector,
/// turned into the world, is longer than one by less than 4.
pub(crate) const TILT: f64 = 8.0 * UNIT;

/// Distance, in units of the pair size, by which a pair in contact at the start of a cast may come
/// closer: `2^-30`. It must exceed the rounding of a cast, about `PLANE`, by far, because a cast
/// proves no gap that is smaller than its rounding. It is less than any contact that matters.
pub(crate) const START_CONTACT: f64 = 1.0 / 1_073_741_824.0;

/// Error of the pose and of the pivot of a body whose frame is translated, in units of the 1-norms
/// of its translation, of its pivot and of the translation of the frame: the rotated vector errs by
/// 24 UNIT of the last, which is far shorter than the others, the sum of the translations by UNIT
/// twice (at the start and at the end of a bound), the pivot by UNIT.
pub(crate) const TRANSLATED: f64 = 32.0 * UNIT;

/// Error of the coefficients of a cubic that is cut four times: each cut is three rounds of two
/// products and a sum, 3 UNIT each, so 36 UNIT of the largest.
pub(crate) const BERNSTEIN: f64 = 64.0 * UNIT;

/// Relative error of a root: a position between two coefficients errs by at most 8 UNIT of itself,
/// a position composed of four parts by as much again; and a time composed of a start and such a
/// part of an interval, by less than the rest.
pub(crate) const ROOT: f64 = 32.0 * UNIT;

/// Error of the height of a polyhedron, in units of the 1-norm of the direction and of its radius:
/// the product with a vertex errs by 3 UNIT, the product with the centre of the ball by as much,
/// the difference by 1, the sum with this bound by 1; the ninth covers the second order.
pub(crate) const HEIGHT: f64 = 9.0 * UNIT;

/// Squares and products of the flight of two balls err by at most 10 UNIT of the squares of their
/// distance and of the sum of their radii; this much, `2^-40`, is counted to the square of the
/// radii, and settles the signs and the root that follow.
pub(crate) const BALLS: f64 = 1.0 / (1u64 << 40) as f64;

/// Relative reduction of a number of ticks, `2^-30`: a quotient errs by UNIT, and a clock that adds
/// up ticks by UNIT a tick, with fewer than `2^20` ticks in any useful bound.
pub(crate) const TICK: f64 = 1.0 / (1u64 << 30) as f64;

/// Increase of the half extents of a box of a compound before rounding up to f32, in units of the
/// tree's size (2 at most, counted in) and of the farthest coordinate over it: a vertex shifted to
/// the tree's origin errs by UNIT of that coordinate; its difference from the centre by UNIT; a
/// dual axis, of stored axes that are orthonormal within 8 UNIT_SINGLE, by 8 UNIT (a cross product
/// 3, a determinant 4, a quotient 1), and the product with it by 3: all of lengths up to 4. Sum:
/// below 4 (1 + 8 + 3) + 2.
pub(crate) const BOX_EXTENT: f64 = 64.0 * UNIT;

/// Error of the height of a vertex over the centre of a box that is fitted again, along an axis of
/// the box, in units of the farthest vertex's distance from the tree's origin, with v =
/// UNIT_SINGLE: the vertex is rounded, v of it; a sum of three products errs by 3 v of
/// the product of the lengths, and the axis is longer than one by 2 v. The centre, which three
/// heights put together, is at most sqrt 3 as far, and exact as stored: its height errs by 3 sqrt 3
/// v; the difference of both by 1 + sqrt 3. Sum: below 12 v.
pub(crate) const REFIT_HEIGHT: f64 = 16.0 * UNIT_SINGLE;

/// Largest deviation of the products of the axes of a box that is fitted again from those of
/// orthonormal vectors: axes are rounded once, or kept as the build left them, within 8
/// UNIT_SINGLE; the quotient by `1 - 24 UNIT_SINGLE` and roundings in double precision add far less
/// than a hundredth.
pub(crate) const BOX_SKEW: f64 = 9.0 * UNIT_SINGLE;

/// Error of a gap of two boxes of a compound in f32, in units of their pair's size L: the reaches
/// of both trees and the distance of their origins. With v = UNIT_SINGLE, `r` a box's reach, `h`
/// its half extents (`|h| <= sqrt(3) r`):
///
/// 1. The matrix and the shift are rounded once: 1.8 v of lengths of B, v of the shift. A product
///    with the matrix adds `3 sqrt(3)` v: axes of B err by 7 v, its centre by 7 v r; two sums more,
///    so the difference of the centres by 10 v L.
/// 2. Along the line of centres: the length errs by 10 v L and 4 v of itself; `h . |a . d|` by the
///    10 v of the difference, 3 of the product, 3 of the sum and 2 of the quotient, times `h` of A;
///    the same and 7 for the axes of B. The direction as rounded is longer than one by 4 v at most.
///    Sum: below 14 L + 18 sqrt(3) rA + 25 sqrt(3) rB, with rA + rB <= L: below 58 v L.
/// 3. Along an excess vector e: products of axes err by 10 v each, by `30 v` as a matrix; `e . d`
///    by 16 v L |e|; the box's own part by 7 v h for axes that are orthonormal within 2 v, and 4
///    more; the part of the other box by 33 v h; the root and the quotient by 5 v. Sum: below 16 L
///    + 11 sqrt(3) rA + 33 sqrt(3) rB + 5 L, below 79 v L.
/// 4. Along a direction c of any length, a cross product of axes or a direction known before: the
///    gap along it is a proof for any c, so only the arithmetic behind c counts, in units of
///    `|c|`. The height errs by 10 v L of the difference and 3 v L of its product. The reach of A
///    errs by 3 v of the sum of its half extents, at most 3 rA, and by 3 v of itself, at most
///    sqrt(3) rA; that of B by 7 v more for the axes. Two differences of terms up to sqrt(3) L err
///    by 4 v L, the root and the quotient by 5 v of as much, and the direction as rounded is longer
///    than one by 5 v. Sum: 31 L + 15 rA + 36 rB, below 67 v L.
/// 5. An entry of a front. Made: the placed centre errs by 10 v L, its product with n by 4 v L, the
///    base by 4 v L; a direction turned to the other body's frame by 7 v, which moves heights by 7
///    v L and makes the direction longer than one by as much. Tested: centre and product as before;
///    the turned directions err by 7 v each, their difference and its length, at most 2, by 8 v: 30
///    v r with the product by the radius; the sums by 4 v L. The radius is that of the smaller
///    node, at most L / 2. Sum: below 65 v L.
/// 6. An entry with a segment, of half length `|u| <= r`, and a radius up to r / 2: the product of
///    the difference, which errs by 16 v, with u, which errs by v of itself, errs by 24 v r in all,
///    the product with the radius by 15 v r, one sum more by 2 v L. Sum: 52 L + 39 r, below 72 v L.
///
/// 80 would do.
pub(crate) const BOXES: f64 = 96.0 * UNIT_SINGLE;

/// Error of a height of a point over the centre of a box of a compound in f32, in units of the
/// 1-norm of the point and of the radius R of the tree, with v = UNIT_SINGLE: the point q is
/// rounded, v |q|; its difference from the centre errs by v of |q| + R, the product with an axis by
/// 3 v of that, the difference from the half extent by 2 v. The box is made of its axes as stored,
/// which are orthonormal within `BOX_SKEW`: the two other axes add `9 v` of their half extents
/// each, and this one as much, 9 sqrt(3) v R in all. Sum: below 7 v |q| + 22 v R.
pub(crate) const POINT_BOX: f64 = 32.0 * UNIT_SINGLE;

/// What the squared distance of a point from a box of a compound in f32 loses, relative to itself:
/// a vector is longer than its heights along axes that are orthonormal within `BOX_SKEW` say by up
/// to 27 UNIT_SINGLE of the square; the sum of three squares errs by 4, the product with this bound
/// by 2.
pub(crate) const POINT_BOX_SQUARE: f64 = 48.0 * UNIT_SINGLE;

/// Error of the distance of a point from a foot on a triangle, and of the height of a corner over
/// the point along a direction, in units of the farthest corner's distance r from the point.
///
/// 1. Foot: the corner minus the point errs by UNIT r; a side, of two such, by UNIT of its length,
///    at most 2 r; with a weight clamped to 0..=1 of an edge, the product by 2 UNIT r and the sum
///    by UNIT r, so the foot by 6 UNIT r as a vector, after the corners. Two weights of an area add
///    up to one within 3 UNIT, 2 r each; the two products and sums err by 8 UNIT r more. The
///    length, of three squares, two sums and a root, errs by 3 UNIT of itself. Sum: below 14.
/// 2. Height: the product of a direction d and a corner errs by 3 UNIT |d| r, the corner by UNIT r,
///    the length of d by 3 UNIT and the quotient by one, of at most r. Sum: 8.
pub(crate) const POINT_HEIGHT: f64 = 16.0 * UNIT;

/// Error of the square of the distance from a point to the farthest corner of a box, and of lengths
/// made of it, in units of themselves. All terms are positive: a difference of coordinates errs by
/// UNIT of itself, the sums with half a side and its slack by 2 more, the square of that by 7, the
/// sum of three squares by 2. Sum: 9 with the first three doubled. A root halves the error and adds
/// one; a product of a radius with itself errs by one. Bodies are from 1e-100 to 1e100 large, and
/// sides halved 90 times above 1e-128: squares do not underflow.
pub(crate) const COVER: f64 = 16.0 * UNIT;

/// Displacement of the cells of a cover, in units of the largest coordinate of the body's box: the
/// root errs by 2 UNIT, and each of at most 90 halvings moves a centre by UNIT more.
pub(crate) const COVER_CELL: f64 = 128.0 * UNIT;

/// Error of the distance of a point from a ball or a box along the axes, in units of the sum of the
/// distance and the size: the difference of the places errs by UNIT of itself, the quotient by its
/// largest coordinate by one, three squares, two sums and a root by 3, the product with the largest
/// coordinate and the difference from the size by one each. Sum: 7.
pub(crate) const POINT_ELEMENT: f64 = 16.0 * UNIT;

/// Square of the sine of the angle of two axes up to which their cross product in f32 is mostly
/// rounding, 10 UNIT_SINGLE: below 128 UNIT_SINGLE. Not a matter of soundness: the bound along any
/// direction holds.
pub(crate) const PARALLEL_SIDES: f64 = (128.0 * UNIT_SINGLE) * (128.0 * UNIT_SINGLE);

/// Error of a height of a vertex of a compound along a unit axis, in units of the farthest
/// vertex's distance from the origin: a sum of three products errs by 3 UNIT, an axis longer than
/// one by 4 UNIT counts by as much. Twice that is the error of a point put together from its
/// heights along three axes that are normalised within 4 UNIT and perpendicular within 6.
pub(crate) const SLAB_HEIGHT: f64 = 12.0 * UNIT;

/// How far a vertex of a placed piece may be off its place, in units of its distance from the
/// origin of the piece plus the length of the translation. A quaternion that is divided by its norm
/// has a squared norm that differs from one by 8 UNIT (four squares and three sums, half of it by
/// the root, and the quotient), and by [`NORMALISED`], 13, as computed. One that does not differ by
/// more as computed is taken as it is, and differs by 17 UNIT. This turns and stretches the rotated
/// vector by up to twice that, 34 UNIT.
/// The vector is `v + 2 w (q x v) + 2 q x (q x v)`: a cross product errs by `2 sqrt(2)` UNIT of the
/// product of the lengths, so the first by 5.7 UNIT with the factor, the second, of a vector up to
/// `2 |v|`, by as much of itself and of the first one's error, the product with w by 2, and the
/// sums of terms up to `2 |v|` by 7: 26.1 UNIT. The translation adds UNIT of the sum. Sum: 61.1.
pub(crate) const PLACED_PIECE: f64 = 64.0 * UNIT;

/// Largest shortfall of a gap in f64 below the distance, in units of L, at which a pair of nodes or
/// triangles of a compound still passes: pairs in flush contact are all equally far, up to
/// rounding, and no pair could be skipped. With [`CERTIFICATE`] above and
/// below, the bounds are no wider than `512 + 2 * 128 = 768` UNIT L, less than `1e-13 L`, 900.
pub(crate) const SHORT_OF: f64 = 512.0 * UNIT;

/// Error of the position of a ball's middle by a pose of the caller, in units of the 1-norm of the
/// middle in the body's frame: a quaternion whose square is off one by [`POSE_UNIT`] puts it off by
/// twice as much, and is rounded by some thirty UNIT, far less than the rest.
pub(crate) const PLACED_BALL: f64 = 3.0 * POSE_UNIT;

/// Error of the part of a ray in a ball, in units of the radius and the absolute coordinates of the
/// ray's origin and of the ball's middle, whose own place is counted by [`PLACED_BALL`]: the
/// difference, the product with the direction, which is of unit length within 4 UNIT, the foot, its
/// length and the sums err by 34 UNIT together. The rate at which a ray sinks towards a half-space
/// errs by 63: the turned normal by 60 (see [`PLACED_PIECE`]), the product with the direction by 3.
/// A height of a point of the ray in a mesh's frame along a unit vector, minus that of a corner,
/// errs by 46: the place, a relative translation, by 31 (see [`CERTIFICATE`]), and by 4 of the
/// direction; products, the difference and the vector's length by the rest.
pub(crate) const RAY: f64 = 64.0 * UNIT;

/// Doubt of the gap of two sets of vertices on straight paths along a direction `n`, in units of
/// the sum of the magnitudes of n's coordinates, with coordinates below one (`continuous::paths`).
/// A coordinate at an instant errs by 3.5 UNIT: the difference from the first vertex by one, the
/// share of the time by a half, two products and their sum by two. A height adds 3 for product and
/// sums, as every term passes three roundings; two heights 13, their difference, up to two, 2 more,
/// and the product with the sum of magnitudes 3 of itself. Directions whose sum is below
/// [`PATH_DIRECTION`] are not used, so that underflow of products does not count.
pub(crate) const PATH_GAP: f64 = 24.0 * UNIT;

/// Least sum of the magnitudes of a direction that is used on straight paths, `2^-200`; the inverse
/// is the largest.
pub(crate) const PATH_DIRECTION: f64 = f64::from_bits((1023 - 200) << 52);

/// Doubt of six times the volume of four vertices on straight paths, coordinates below one, one
/// vertex the origin, and of the Bernstein coefficients of that cubic: six products of three
/// coordinates, each coordinate off by 4 UNIT (see [`PATH_GAP`]), 72 UNIT; a term passes two
/// products, a difference and two sums, 30 UNIT; the sum of three such volumes and their division
/// by three add 3 UNIT of six, 18. Sum: 120.
pub(crate) const PATH_VOLUME: f64 = 160.0 * UNIT;

/// Doubt of the Bernstein coefficients of `(u x v) . n`, with u and v differences of two vertices
/// on straight paths, coordinates below one, in units of the sum of the magnitudes of n's
/// coordinates: a difference, up to two, errs by 8 UNIT (see [`PATH_GAP`]) and its rounding by 2; a
/// product of two by 40 UNIT and 4; the difference of two products by 88 and 8; the mean of two
/// such by 8 more; products with n and sums by three roundings of eight, 24. Sum: 128.
pub(crate) const PATH_AREA: f64 = 160.0 * UNIT;

// Bézier and NURBS patches.
//
// Sums `sum of c_k w_k P_k` of a patch have factors `c_k` and weights `w_k` that are not negative.
// If each term errs by `e` of itself, the sum errs by at most `e R sum of c_k w_k`, with R the
// largest distance of a control point from the origin, and the denominator `sum of c_k w_k` by `e`
// of itself: after the division the point errs by `2 e R`, and one rounding. The ratio of the
// weights drops out. Underflow: coordinates and weights are limited (`PATCH_MAX`,
// `WEIGHT_RATIO`), case S.

/// Largest coordinate of a control point, `2^200`, and the limits of knots.
pub(crate) const PATCH_MAX: f64 = f64::from_bits((1023 + 200) << 52);

/// Weights of a patch are no smaller than this times the largest, `2^-40`.
pub(crate) const WEIGHT_RATIO: f64 = 1.0 / (1u64 << 40) as f64;

/// Error of a point at given parameters, times R. A step of de Casteljau, `(1 - t) a + t b`, has
/// three roundings a term, and a patch of degrees up to 7 has up to 14 steps: 42 UNIT, doubled by
/// the division: 84; the product of weight and coordinate, doubled, and the division: 3 more.
pub(crate) const PATCH_POINT: f64 = 96.0 * UNIT;

/// Error of a control point of a node, times R, besides [`NET_STEP`]: the product of weight and
/// coordinate, doubled, and the division 3 UNIT, and room.
pub(crate) const NET: f64 = 4.0 * UNIT;

/// Error of a control point of a node, times R, for each step of de Casteljau since the patch
/// itself: half of a sum has one rounding, doubled by the division.
pub(crate) const NET_STEP: f64 = 2.0 * UNIT;

/// Error of a control point of a part cut out of a patch over a box of parameters, times R and the
/// sum of the degrees: two cuts in each direction, each step `(1 - t) a + t b` with three roundings
/// a term, doubled by the division.
pub(crate) const NET_CUT: f64 = 12.0 * UNIT;

/// By how much the ends of such a box, between 0 and 1, may be off: a quotient of two of them is
/// rounded once, and the difference from one once.
pub(crate) const REGION: f64 = 4.0 * UNIT;

/// Error, times R, of a triangular patch as a tensor-product patch: raising the degree of a row has
/// four roundings a term (two quotients, a product, a sum), up to six times, doubled by the
/// division: 48 UNIT, and room.
pub(crate) const RAISED: f64 = 64.0 * UNIT;

/// Error, times R, of patches taken out of a NURBS surface: a step of de Boor's algorithm has five
/// roundings a term (two differences, a quotient, a product, a sum), with up to seven steps in each
/// direction 70 UNIT, doubled by the division, and room.
pub(crate) const KNOTS: f64 = 160.0 * UNIT;

/// Error, times R, of a point of a surface at given parameters, however its patches were given.
pub(crate) const SURFACE_POINT: f64 = PATCH_POINT + if RAISED > KNOTS { RAISED } else { KNOTS };

/// Error of the distance of a point from a convex shape, in units of the largest distance of the
/// shape's points from its origin, besides the shape's bounds and
/// [`CERTIFICATE`]: the relative rotation as a product of two quaternions,
/// eight roundings, normalised with eight more, twice as many for the turned vector, and room.
pub(crate) const SHAPE_POINT: f64 = 64.0 * UNIT;

/// Corners of two borders closer than this times the size of the surface are the same corner: both
/// err by [`KNOTS`] or [`RAISED`], and control points of one surface computed twice by some tens of
/// UNIT. Steers what is reported as closed, no bound.
pub(crate) const SEAM: f64 = 1024.0 * UNIT;

/// Error of a height over a node by its second derivatives, in UNIT times `(p + q)^2` times the
/// largest coefficient G. With `d = p + q` and UNIT G as the unit:
///
/// 1. Each second difference of coefficients has two roundings of numbers up to 3 G and 4 G, and
///    the two products with its factor one each of 4 G: 15 times the factor, at most 42 of degrees
///    7 and 1, so below `10 d^2`. This is added to each of the three bounds before use
///    ([`CURVATURE`]), so that their signs can be trusted.
/// 2. The value by de Casteljau: `3 d`. A first derivative: differences up to 2 G with one
///    rounding, `3 d` roundings each, times p or q: both together `6 d^2 + 2 d`.
/// 3. The sums of the three bounds, numbers up to `4 d^2 G`, have up to four roundings each:
///    `16 d^2`. The quotients, which may be larger, are rounded up; next to a first derivative they
///    matter only as far as they are no larger than that.
///
/// Together below `24 d^2 + 5 d`, and d is at least 2.
pub(crate) const TAYLOR: f64 = 32.0 * UNIT;

/// Step 1 of [`TAYLOR`].
pub(crate) const CURVATURE: f64 = 12.0 * UNIT;

/// Error of a coefficient of a height, `n . N - c w`, times R and the weight: the dot product three
/// UNIT, the product with c, at most R, two, and the difference two.
pub(crate) const COEFFICIENT: f64 = 8.0 * UNIT;

/// Error of a coefficient of a height above a bowl (`surface::bowl`), times the denominator's
/// coefficient, R and the distance of the point of contact from the origin. Where the gradient of
/// the quadratic part is at most one, that part is no larger than the height; a larger gradient
/// multiplies the error. A term of the numerator passes 50 roundings: two of the shift by the point
/// of contact, those of the products with directions, form, weight and binomials, and the sums of
/// up to 16 terms; one of the denominator passes 20, and the quotient adds one. The quadratic part
/// is half as large again. The orthogonality of the directions is off by six UNIT: 113 in all.
pub(crate) const BENT: f64 = 128.0 * UNIT;

/// Gradient of the quadratic part of a bowl over a node, at most: errors of points grow by one more
/// than that.
pub(crate) const SLOPE: f64 = 4.0;

/// Effect of the error of a pose on the heights of both bodies above a bowl: on each body twice,
/// by its points and by the point of contact, as gradients up to `1 + SLOPE` carry it.
pub(crate) const BENT_POSE: f64 = 4.0 * (1.0 + SLOPE);

/// A pair on a front claims its gap less this times the size L at each of the two poses: the claim
/// is a sum of heights of points of B's frame, [`CERTIFICATE`] UNIT L at each
/// pose, and the turn of a direction times the radius of a ball, 80 UNIT L at each pose.
pub(crate) const CARRIED: f64 = 256.0 * UNIT;

/// Intervals of two surfaces are not asked to be narrower than this times the size L, `2^-42`: the
/// errors of both bounds are about [`CERTIFICATE`] UNIT L each, those of points
/// 256 UNIT L at most, those of nodes split forty times as much, and those of second derivatives
/// some 1,000 UNIT times the size of a node.
pub(crate) const PATCH_LIMIT: f64 = 1.0 / (1u64 << 42) as f64;

/// Error of a first derivative of a patch, times its bound `3 d R omega` (`surface::crossing`): the
/// differences of control points and up to 14 steps of three roundings are 45 UNIT, each of
/// numerator and denominator and of the point that multiplies the derivative of the denominator,
/// times omega (counted in the bound); the turn into the other frame 80 UNIT. A product with the
/// inverse adds some UNIT. Room by a factor of two.
pub(crate) const PATCH_SLOPE: f64 = 512.0 * UNIT;

// Sums of products whose sign is certain.

/// The sign of `n . e` is certain above this times the sum of the absolute terms, and
/// `LEAST_RISE`: one rounding for each coordinate of `e` (a difference of stored points), one for
/// each product and two additions, to first order `(1 + 1 + 2) UNIT`; 8 leaves room for a direction
/// that is rounded itself, for the second order and for the rounding of the bound. Underflow: case
/// D.
pub(crate) const EDGE_SIGN: f64 = 8.0 * UNIT;

/// The sign of `(n . e) (m . f) - (n . f) (m . e)` is certain above this times the sum of the
/// products of the sums of the absolute terms: each dot errs by 5 UNIT as above, each product by
/// two dots and one rounding more, the difference by one: 12; 16 leaves room. Underflow: an error
/// of a rise is multiplied by another rise, so `LEAST_RISE` is multiplied by the sums too, and
/// added once for the products.
pub(crate) const STEEPER: f64 = 16.0 * UNIT;

/// A rise below this is certain of no sign (case D). An exact direction that is rounded to f64 may
/// be off by `2^-900` of its largest coordinate plus the roundings (`exact::integer::direction`).
/// An edge is shorter than `2^107`, so three coordinates put a rise off by less than `2^-790`, and
/// underflow of three products by `2^-1073`. A rise to which the largest coordinate of a direction
/// contributes has a bound above `2^-563`, so this guard decides nothing there.
pub(crate) const LEAST_RISE: f64 = f64::from_bits((1023 - 768) << 52);

/// Four signed volumes of vertices up to L prove the origin inside if each exceeds this times UNIT
/// L^3 (UNIT of the arithmetic): a determinant of three vectors up to L has an error of at most 14
/// UNIT L^3, and vertices displaced by the `CERTIFICATE` error of the pose change the determinant
/// by three times this error: 398 in all. For vertices of very different lengths less is enough.
/// Displaced by D, the determinant changes by D times the sum of the three products of two lengths,
/// three times D^2 L, and D^3; the rounding is below 14 UNIT L times any of the products. With D =
/// 128 UNIT L the total is below the sum of the products times 512 UNIT L and L (512 UNIT L)^2. A
/// displacement common to all three vertices, as the origins of the bodies add in double-double
/// (128 UNIT times the origins), changes the determinant by no more than the product of this
/// displacement with the triangle's normal `u x v`, whose own displacement is below twice D times
/// the edges and D.
pub(crate) const VOLUME: f64 = 512.0;

/// A triangle `w0 w1 w2` of the Minkowski difference is certainly counter-clockwise from outside if
/// every `n . w` exceeds this times `|e1| |e2| L`, `n = e1 x e2` rounded: the edges err by UNIT,
/// the cross product by 2.5 UNIT more, and the dot by 3. Taken off one `n . w`, with `|e1|^2 +
/// |e2|^2` for the product, this bound leaves less than the `n . w` of any vertex, and room for the
/// rounding of `|n|`.
pub(crate) const ORIENTATION: f64 = 16.0 * UNIT;

/// Whether a direction `v` of the other body's frame rises along a unit normal is uncertain below
/// this times `|v|_1`: the direction is turned by a matrix that errs by 71 UNIT (see
/// `CERTIFICATE`), by a product with the matrix that errs by 6 and two roundings; the product
/// with the normal adds 3: 82 in all. Underflow: case S, and a direction too short to decide is
/// uncertain.
#[cfg_attr(not(feature = "exact"), allow(dead_code, reason = "the filter of the exact rung"))]
pub(crate) const EXACT_FILTER: f64 = 128.0 * UNIT;

/// The signs of the weights of `n = u x w` over the faces adjacent to two edges, `w . n'` and `u' .
/// n'` for face normals `n'` and the edges turned by a pose, are certain above this times the
/// turned edge: then `n` falls, certainly, along the inward direction `n' x e` of each face, `e`
/// its edge. With norms of 1 for all four vectors:
///
/// 1. On A: `(u x w) . (n' x u) = -(w . n') (u . u)`. The edge, a rounded difference, errs by UNIT,
///    and `u . n'` is no more; the cross product by 2.5, and 4 if orthogonalised; the dot by 3 and
///    `n'` by `NORMAL_ERROR`. Sum: below 13.
/// 2. On B, whose inward direction is `n' x w` in its own frame: a matrix that errs by 71 (see
///    `CERTIFICATE`) turns a cross product into the cross product of the turned vectors within
///    213, and keeps the right angle between `w` and `n'` within 142; the turned edges err by 7
///    each; cross product and dot as on A. Sum: below 390.
///
/// A vertex paired with an edge has one frame and no matrix: the direction `d` from the edge to the
/// vertex and `u x d` for `w` leave `(2.5 + 3 + 1.1 + 1) UNIT |u| |d|`, below `DIFFERENCE L` times
/// the 1-norm of `u`.
///
/// The part of `n` along the edges themselves is rounding, times up to `2 r`; `CERTIFICATE`
/// counts this part.
pub(crate) const FLANK: f64 = 512.0 * UNIT;

/// Error of `n . (p - a)`, `n = (b - a) x (c - a)`, all rounded, relative to the sum over k of
/// `(|u_i v_j| + |u_j v_i|) |p_k - a_k|`, `u` and `v` the edges: each of the eight roundings a term
/// passes (two differences, product and difference in n; difference, product and two sums after)
/// adds UNIT to first order, so 8 UNIT; the ninth covers the second order. Underflow: the hull adds
/// the least normal number to its bound.
pub(crate) const SIDE_ERROR: f64 = 9.0 * UNIT;

/// The bound of the error of `n . (p - a)` in double-double over that in f64 (`SIDE_ERROR`):
/// differences are exact; two products and three sums, of 5 and 3 units `2^-106` each, add up to
/// less than 20 such units, and `9 UNIT` times this are 288.
pub(crate) const SIDE_FINE: f64 = 1.0 / (1u64 << 48) as f64;

/// Error of `n . g`, `|g_k| <= 2`, and of `n . a`, for the normal of a facet of a hull of a few
/// points (`polyhedron/build/cloud.rs`), rounded from corners that are rounded themselves, relative
/// to the sums `U + W` of magnitudes of two edges. Corners are below 2, so edges are off by 6 UNIT
/// a coordinate, normals by `6 (U + W) + 3 U W`, where `U W <= 3 (U + W)`; twice three of these and
/// the sum's own rounding make 114.
pub(crate) const CORE_ERROR: f64 = 512.0 * UNIT;

/// By how much a cell of the table of `polyhedron/build/cloud.rs` is wider than it says: the shares
/// of a point have 7 UNIT of rounding; `2^-40`.
pub(crate) const CORE_CELL: f64 = 1.0 / (1u64 << 40) as f64;

/// What is left of the bound of a cell: room for the roundings of the bound, of the sum of a point
/// and of the single precision in which the bound is stored, rounded down.
pub(crate) const CORE_REACH: f64 = 1.0 - 1.0 / (1u64 << 20) as f64;

/// A foot or a crossing computed from the normal of a triangle counts as the place inside the
/// triangle that has its weights if both are nearer than this times the lengths of the two edges
/// and of the difference from which they were computed, root of the sum of squares: at most 3 L.
/// Their distance from a point then differs by at most `24 UNIT L`, for which `CERTIFICATE` has
/// room: its rows of triangles are below 104 of 128. A foot that is farther off is not used.
pub(crate) const SAME_PLACE: f64 = 8.0 * UNIT;

/// Difference of the slants of two edges along one line, rounded: `s = (g . u)^2 / u^2` with `u` a
/// difference of points over the largest of its coordinates and `g` fixed, shorter than 3/4. The
/// coordinates of `u` are off by 2 UNIT of themselves, products and sums add 3: `g . u` is off by
/// `5 UNIT |g| |u|`, and `s` by `10 UNIT |g|^2 < 6 UNIT`. Square, norm and quotient add
/// `(1 + 7 + 1) UNIT s < 6 UNIT`. Two slants: 24 UNIT, and the second order. Nothing underflows: of
/// stored points, differences are above `2^-357` and their largest coordinates below `2^107`.
pub(crate) const SLANT: f64 = 32.0 * UNIT;

/// The distance of two features in closed form (`solve::closed_form`) errs by this times
/// `UNIT_DOUBLE_DOUBLE`, L, and for heights over a plane the lengths of the two edges over that of
/// their normal: by 57 for two vertices, most of it for the placing of one by both rotations, 69
/// at an edge, 66 over a face, and 166 for two edges, of which one is turned by both rotations.
#[cfg(feature = "exact")]
pub(crate) const CLOSED_FORM: f64 = 256.0;

/// A sign that proves features the closest is certain above this times the lengths: the direction
/// is rounded, turned by a matrix that errs by 71 (see `CERTIFICATE`), by a product with it (6),
/// and multiplied with an edge (4); or three vectors whose coordinates are rounded are multiplied
/// (10). Errors of the double-double direction itself are below `2^-17` UNIT, as `CLOSED_FORM`
/// leaves a distance only where its error is below a quarter of a unit in the last place.
#[cfg(feature = "exact")]
pub(crate) const CLEAR_SIGN: f64 = 128.0 * UNIT;

/// Error of a coordinate of an exact place that is rounded to f64 (`exact::place`), in units of the
/// largest coordinate: a bracket of at most four units in the last place, and its middle.
#[cfg(feature = "exact")]
pub(crate) const EXACT_PLACE: f64 = 8.0 * UNIT;

/// Error of `(b - a) x (p - a)` of plane coordinates, relative to the sum of the absolute products:
/// two differences, a product and the difference of two products are one rounding each, 4 UNIT; the
/// fifth covers the second order. Underflow: the caller adds the least normal number, as the
/// products of stored coordinates with a place that is no stored one may vanish. Products of stored
/// coordinates alone do not: they are multiples of `2^-714`.
#[cfg(any(feature = "exact", feature = "meshes"))]
pub(crate) const TURN_ERROR: f64 = 5.0 * UNIT;

/// Error of `d . ((a - p) x (b - a))` for a direction `d` and an edge from `a` to `b`, in units of
/// the 1-norms of `a - p` and `b - a`: the direction is turned by a matrix that errs by 71 UNIT and
/// a product with it that errs by 6 (see `CERTIFICATE`); two differences, a cross product (2.5) and
/// the product with the direction (3) add 8. Sum: 85. Underflow: the caller adds the least normal
/// number.
pub(crate) const RAY_SIDE: f64 = 128.0 * UNIT;

/// Error of `n . x` for the normal `n = u x v` of a triangle and the rounded difference `x` of two
/// places, in units of the 1-norms of `u`, `v` and `x`: by `SIDE_ERROR`, 9 UNIT for either of the
/// two products of each coordinate of `n`.
pub(crate) const RAY_PLANE: f64 = 32.0 * UNIT;

/// Factor that rounds up the error that a double-double carries along (`volume::arithmetic`). A
/// product has five roundings: two products of errors, two sums, and the sum with its own rounding;
/// a quotient has six. The larger number of a double-double stands for the whole, which is up to
/// UNIT larger, twice. Sum: 8; twice that for the second order.
#[cfg(feature = "meshes")]
pub(crate) const COUNTED: f64 = 1.0 + 16.0 * UNIT;

/// Error of a vertex that is placed in the frame of another body in double-double, in units of the
/// sum of its coordinates, of the coordinates of both stored origins, and of the difference of the
/// translations. An entry of a rotation has twelve operations on numbers up to 2, so it errs by
/// less than 24 UNIT_DOUBLE_DOUBLE; an entry of the product of two rotations by three times 49 and
/// two sums, 149; a coordinate of the vertex by three times as many sums, 152 times its length. The
/// origin of B, rotated once and shifted, and rotated again: 24 + 2 and 24 + 3, less. Sum with the
/// last sum: below 256. Underflow: case S.
#[cfg(feature = "meshes")]
pub(crate) const PLACED_VERTEX: f64 = 256.0 * UNIT_DOUBLE_DOUBLE;

/// Bound of what one term of a volume loses by underflow, in units of the cube of the largest
/// coordinate, or of one. Coordinates are multiples of `2^-357`, so products of up to three of
/// their differences lose nothing. A quotient below `2^-969` and its products lose at most
/// `2^-1074` each, times the cube; there are fewer than `2^10` operations in a term.
#[cfg(feature = "meshes")]
pub(crate) const LOST_TERM: f64 = f64::from_bits((1023 - 1000) << 52);
