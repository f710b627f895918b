//! Every constant of the crate, each with its derivation.

/// Unit roundoff of f64: the largest relative error of one rounded operation.
pub const UNIT: f64 = f64::EPSILON / 2.0;

/// Bound of the relative error of one double-double operation (Joldes, Muller, Popescu 2017, "Tight and rigorous error
/// bounds for basic building blocks of double-word arithmetic": at most 15 UNIT^2 for the division used here, 10 UNIT^2
/// and less for the others).
pub const UNIT_DOUBLE_DOUBLE: f64 = 16.0 * UNIT * UNIT;

/// The sign of `n . e` is certain above this times the sum of the absolute terms: one rounding for each coordinate of
/// `e` (a difference of stored points), one for each product and two additions, to first order `(1 + 1 + 2) UNIT`; 8
/// leaves room for a direction that is rounded itself, for the second order and for the rounding of the bound.
pub const EDGE_SIGN: f64 = 8.0 * UNIT;

/// The sign of `(n . e) (m . f) - (n . f) (m . e)` is certain above this times the sum of the products of the sums of the absolute terms:
/// each dot errs by 5 UNIT as above, each product by two of them and one more, the difference by one: 12; 16 leaves room.
pub const STEEPER: f64 = 16.0 * UNIT;

/// How far the squared norm of a pose's quaternion may be off 1: what repeated composition of f64 rotations
/// accumulates over thousands of products. Placement divides by the squared norm, so the value does not limit accuracy.
pub const POSE_UNIT: f64 = 1e-12;

/// The sum of the coordinates of the relative translation stays below this, so that no distance leaves f64, nor its
/// upper bound: bodies themselves reach to 1e116 at most.
pub const REACH: f64 = f64::MAX * (1.0 - 1.0 / (1u64 << 40) as f64);

/// Pairs whose size L (in the stored units of the larger body) is beyond this are answered by their separation alone:
/// their radii are below the rounding of L, and cubes of lengths (determinants of a simplex) would leave the range.
pub const FAR: f64 = f64::from_bits((1023 + 300) << 52);

/// The same at the small end; only two points can be so close, as every other body is stored at radius 2^-105 or more.
pub const NEAR: f64 = f64::from_bits((1023 - 300) << 52);

/// Noise of a difference of two placed points, in units of the pair's size L: each coordinate of a placed point carries
/// a few roundings of numbers up to L. A direction made from such a difference leaves a vertex or a plane only where
/// more than this says so; what it hides is left to the certificate. Not a matter of soundness.
pub const DIFFERENCE: f64 = 8.0 * UNIT;

/// The same for a direction of unit length that is no difference of points (a face normal, an edge turned by a pose).
pub const DIRECTION: f64 = 16.0 * UNIT;

/// A point over the plane of a face has its foot in the face where it is inside every side plane by more than this times
/// L. For an edge `u` of the rim the side `(n x u) . (x - to)`, over `|u|`, errs by `5.1 UNIT` (the stored normal 1.1, the
/// edge 1, the cross product 3), `UNIT` (the difference) and `3 UNIT` (the product), all times `|x - to| <= L`; the foot
/// itself, `x - n h`, by `4 UNIT L` within the plane. Sum: 13.1.
pub const FOOT: f64 = 16.0 * UNIT;

/// Witnesses closer than this times L are no ground for a direction; the finer layers take over. Not a matter of
/// soundness.
pub const ON_BOUNDARY: f64 = 16.0 * UNIT;

/// Two edges with a squared sine below this have their cross product orthogonalised once more before use: its error
/// across is `UNIT / sine`.
pub const NEARLY_PARALLEL: f64 = 1.0 / 16.0;

/// Two edges with a squared sine below this are taken as parallel: their cross product is rounding alone.
pub const PARALLEL: f64 = 256.0 * UNIT * UNIT;

/// The walk's answer stands where witnesses and supporting planes agree within this times L: the error of its distance, should the
/// pair be a wrong one, is below `1e-14 L`, 90 UNIT. Measured on right answers: at most 11 UNIT L by the supports, and some tens by
/// the planes of two faces where those of a sharp edge stand in.
pub const AGREE: f64 = 64.0 * UNIT;

/// Four signed volumes of corners up to L prove the origin inside when each exceeds this times UNIT L^3 (UNIT of the
/// arithmetic): a determinant of three vectors up to L has an error of at most 14 UNIT L^3, and corners displaced by
/// the [`CERTIFICATE`] error of placement change it by three times that: 398 in all. Of corners of very different lengths less is
/// enough. Displaced by D, the determinant changes by D times the sum of the three products of two lengths, three
/// times D^2 L, and D^3; its rounding is below 14 UNIT L times any of the products. With D = 128 UNIT L all this is below the sum of
/// the products times 512 UNIT L and L (512 UNIT L)^2. A displacement that all three share, as the origins of the bodies
/// add one in double-double (128 UNIT times those), changes it by no more than its product with the triangle's normal
/// `u x v`, whose own displacement is below twice D times the edges and D.
pub const VOLUME: f64 = 512.0;

/// A depth is proven where the height along the best normal and the nearest triangle agree within this times L: the
/// rounding of both is a few UNIT L each (see [`CERTIFICATE`]), what the planes of two faces prove of the height of an edge may be
/// half of it above the edge, and what is left must stay below `1e-14 L`, 90 UNIT.
pub const AGREE_DEPTH: f64 = 32.0 * UNIT;

/// Deepest points that are off the place they should be by more than this times L are looked for again in double-double: well below the
/// `1e-13 L` to which an answer is bounded.
pub const AGREE_WITNESS: f64 = 512.0 * UNIT;

/// A triangle `w0 w1 w2` of the Minkowski difference is counter-clockwise from outside, certainly, where every `n . w` exceeds this
/// times `|e1| |e2| L`, `n = e1 x e2` rounded: the edges err by UNIT, the cross product by 2.5 UNIT more, and the dot by 3. Taken off
/// one `n . w`, with `|e1|^2 + |e2|^2` for the product, it leaves less than any corner has, and room for the rounding of `|n|`.
pub const ORIENTATION: f64 = 16.0 * UNIT;

/// Squared lengths from this to its inverse are normalised as they are; a product of two of them, and each coordinate's square
/// that counts beside the others, is far inside the range of f64.
pub(crate) const SQUARE_MIN: f64 = 1e-200;

/// A triangle of the Minkowski difference that its support exceeds by less than this times L, `2^-16`, may lie in the border:
/// the normals of the bodies' features are tried. Not a matter of soundness.
pub const ALMOST_FLAT: f64 = 1.0 / 65_536.0;

/// Noise of a place across the normal of a contact, times L: a vertex in its frame less the witness, 2 UNIT of each coordinate, two
/// products with axes that are right within [`DIRECTION`], and the witness itself within as much. What two faces share is
/// closed: corners this far outside belong to it. Not a matter of soundness.
pub const ACROSS: f64 = 64.0 * UNIT;

/// Faces whose normals differ by less than this, `2^-46`, bear a contact as one: a flat face whose corners were rounded
/// comes as several, with normals a few UNIT times its size over their width apart. A point taken for one of the other is off by no
/// more than this times L.
pub const COPLANAR: f64 = 1.0 / (1u64 << 46) as f64;

/// A face bears no contact where the cosine of its angle to the normal is below this: heights over a place are the place's noise times
/// the tangent, at most `64 ACROSS L`. Not a matter of soundness.
pub const STEEP: f64 = 1.0 / 64.0;

/// The radius of the disc that a facet must hold to stand in for weak triangles (`penetration::cover`) is raised by this factor. Its
/// products, quotient and roots err by 10 UNIT relatively; the difference of squares by `3 UNIT r^2`, which is less than the
/// `2 CERTIFICATE UNIT L` taken off each height `p` adds to it.
pub(crate) const DISC: f64 = 1.0 + 1.0 / 1024.0;

/// A larger disc than this part of the height is not tried: no matter of faces upon faces. The proof has room for a half.
pub(crate) const DISC_MOST: f64 = 1.0 / 4.0;

/// What a manifold holds already stays while it is no worse than this times what would come in its place. Not a matter of
/// soundness.
pub const STAY: f64 = 1.25;

/// Where the origin lies on the border of the tetrahedron that a search for the depth would begin with, it begins about a
/// point this many L beside it: the search succeeds for depths of more than twice as much, so the shifts shrink to the
/// rounding of double-double. The least are tried on both sides: where the origin is nearer to the border than that, one of them
/// lies outside, and the direction to the border from there gives a height below the shift.
pub const SHIFTS: [f64; 8] = [
    0.0,
    1.0 / (1u64 << 10) as f64,
    1.0 / (1u64 << 24) as f64,
    1.0 / (1u64 << 40) as f64,
    1.0 / (1u64 << 58) as f64,
    -1.0 / (1u64 << 58) as f64,
    1.0 / (1u128 << 80) as f64,
    -1.0 / (1u128 << 80) as f64,
];

/// The direction of the shift: off the planes and axes of lattices, and no longer than one (0.98).
pub const ASIDE: [f64; 3] = [0.613, -0.365, 0.677];

/// Heights along a direction `n` that are within this times `|n|_1 L` of each other may be the same: three roundings of each of two dot
/// products and of the direction itself.
pub const PLATEAU: f64 = 16.0 * UNIT;

/// Error term of both bounds, in units of UNIT L, derived line by line (u = UNIT, norms are Euclidean, `t` the relative
/// translation; a cross product errs by `2.5 u |a| |b|`, a product with a rotation matrix by `6 u`):
///
/// 1. The relative quaternion: four products a coordinate, error at most 4 u each, 8 u as a vector. Across itself such
///    an error turns by twice as much; along itself it scales what the matrix adds to the identity, a matrix of norm 2,
///    by twice as much: together at most `8 u sqrt(4 + 16)`, 36 u. The squared norms of both poses err by 4 u each and
///    scale it too: 16 u.
/// 2. Its matrix: 5 u relative to the absolute sums of its entries, whose Frobenius norm is below 3.8, and the last
///    rounding of each entry: 19 u wherever the factor's own roundings, 3 u, are counted in. With 1, a vertex of B is
///    turned wrong by at most 71 u rB.
/// 3. The relative translation: the difference of the translations, `u |t|`; the two cross products and their sum, 6.5 u,
///    doubled; the factor `2 / |q|^2`, 6 u, doubled; the last sum: together at most 28 u |t|.
/// 4. A vertex of B in A's frame: 71 u rB + 28 u |t|, and 6 u rB for the product. A vertex of A in B's: 71 u and 6 u of
///    `|t| + rA`, the difference from the translation and its own error, 29 u |t|: 77 u rA + 106 u |t|. Sums: u L.
/// 5. A direction taken into the other frame: 6 u, which may put another vertex lowest: 12 u of that body's radius.
///    Heights along a direction: 3 u of rA, rB and |t|, once more where the highest of several is taken; their sums, 2 u L.
///    Of two edges each extreme across the other (`FLANK`): no direction is taken into another frame and no highest of several,
///    but `n` is off their right angle by `3.5 u / sine` on A, where the sine is at least 1/4 or the angle is made right (6 u),
///    and by 6 u more on B, for the turned edge: 28 u of rA, 40 u of rB. Of an edge beside a vertex, the direction is made right
///    within 8 u: 17 u of its body's radius.
/// 6. The witnesses, made as `p + s u` with `s` in 0..1, or as a sum of corners whose weights sum to one within 4 u: 8 u
///    of rA and of rB, in the upper bound instead of 5. The norm, or that of a normal: 3 u L.
///
/// Sum, with u L counted for every summand: at most 77 + 12 + 6 + 6 = 101 u for the radius of the body that is placed,
/// 106 + 3 + 6 = 115 u for |t|, 40 u for the other radius; for two edges 77 + 40 + 3 + 6 = 126 u, 115 u and 68 u. Second-order terms are below 1 u. In double-double the same
/// holds with two matrices of 40 for one, 16 for their product, and 2 times 46 for the translation with the origins of the
/// bodies added to L; its sums and products err by 10 UNIT^2 at most, so all is below 100 [`UNIT_DOUBLE_DOUBLE`]. The
/// largest violation of the bounds without their term that was ever seen is 11 u L.
pub const CERTIFICATE: f64 = 128.0;

/// Error of the displacement of a body between two poses, in units of its radius `r`, of the distance `|c|` of its ball's
/// middle from its own origin, and of that of the origins `|t|` at either pose (u = UNIT, errors as in [`CERTIFICATE`]): a
/// rotation errs by `71 u` in norm, so the Frobenius norm of the difference of two by `2 sqrt(3) 71 u`, over the root of 2
/// `174 u r`; the placed middle at each pose by `77 u |c| + 106 u |t|` at most; the norms and their sum by 4 u of what they
/// come to, at most `2 (r + |c|)` and both `|t|`. Together at most `182 u r + 162 u |c| + 110 u |t|`.
pub const DISPLACEMENT: f64 = 256.0 * UNIT;

/// Least extent (longest side of the bounding box) of a body, in the caller's unit: cubes of lengths, as volumes are,
/// stay above the least f64.
pub const EXTENT_MIN: f64 = 1e-100;

/// Largest extent of a body: cubes of lengths stay finite.
pub const EXTENT_MAX: f64 = 1e100;

/// Largest coordinate of a vertex: no body of an extent up to [`EXTENT_MAX`] has a larger one and a neighbouring double
/// within its extent; a point is held to the same.
pub const PLACE_MAX: f64 = 1e116;

/// Bodies are stored with a radius from `2^-105` to `2^105`, scaled by a multiple of `2^210` where they need it: most are
/// as given, and bodies of like size share a unit.
pub(crate) const EXPONENT_FREE: i32 = 105;

/// Stored coordinates below `2^-200` of the radius become zero. Radii are at least `2^-105`, so the last bit of any kept
/// coordinate is worth `2^(-105 - 200 - 52)` or more and a product of three differences `2^-1071`: above the least
/// f64, `2^-1074`, hence the expansions of the orientation predicates are exact.
pub(crate) const FLUSH_EXPONENT: i32 = 200;

/// Error of `n . (p - a)`, `n = (b - a) x (c - a)`, all rounded, relative to the sum over k of
/// `(|u_i v_j| + |u_j v_i|) |p_k - a_k|`, `u` and `v` the edges: each of the eight roundings a term passes (two
/// differences, product and difference in n; difference, product and two sums after) adds UNIT to first order, so 8
/// UNIT; the ninth covers the second order.
pub(crate) const SIDE_ERROR: f64 = 9.0 * UNIT;

/// Where a cross product is below `2^-40` of the products it is the difference of, double-double has lost too much
/// and expansions take over. Above it the direction errs by less than `3 * 2 * 16 UNIT^2 * 2^40 < UNIT / 64`.
pub(crate) const CROSS_CANCELLED: f64 = 1.0 / (1u64 << 40) as f64;

/// Largest distance between the stored and the true unit normal of a face: rounding a unit vector moves it by at most
/// UNIT, the computation in double-double before by less than UNIT / 32 (`CROSS_CANCELLED` and a root).
pub(crate) const NORMAL_ERROR: f64 = 1.0625 * UNIT;

/// Faces given by the caller may leave their plane by this times the diagonal of the body's box: the corners of a polygon
/// computed by a rotation and a shift err by a few UNIT each, and the plane through three of them, extrapolated, by
/// some tens.
pub const PLANARITY: f64 = 64.0 * UNIT;

/// A point of the body exactly in the plane of a face satisfies `n . p >= offset - NEAR_PLANE radius` in rounded
/// arithmetic: `n . p` errs by 4 UNIT radius at most, the tilt of the stored normal by 3 and the rounding up of the
/// offset by 5.
pub(crate) const NEAR_PLANE: f64 = 16.0 * UNIT;

/// Whether a direction `v` of the other body's frame rises along a unit normal is uncertain below this times `|v|_1`: it is turned by a
/// matrix of error 40 UNIT (see [`CERTIFICATE`]) and rounded twice; the product adds 3 UNIT.
pub const EXACT_FILTER: f64 = 128.0 * UNIT;

/// From beyond `2^60` radii a body's closest point depends on the direction only, to `2^-60` of its size: below
/// rounding.
pub(crate) const FAR_POINT: f64 = (1u64 << 60) as f64;

/// Error of a bound by two faces, in units of their weights times the radius: `m = alpha nL + beta nR` has two
/// roundings a coordinate relative to `alpha + beta` (3.5 UNIT as a vector), `s m` one more, and the weighted sum of the
/// offsets three, each at most the radius.
pub const EDGE_BOUND: f64 = 8.0 * UNIT;

/// The signs of the weights of `n = u x w` over the faces beside two edges, `w . n'` and `u' . n'` for face normals `n'` and the edges
/// turned by a pose, are certain above this times the turned edge: then `n` falls, certainly, along the inward direction `n' x e` of each
/// face, `e` its edge. With norms of one for all four vectors:
///
/// 1. On A: `(u x w) . (n' x u) = -(w . n') (u . u)`. The edge, a rounded difference, errs by UNIT, which makes `u . n'` no
///    more; the cross product by 2.5, and 4 where it is orthogonalised; the dot by 3 and `n'` by `NORMAL_ERROR`. Sum: below 13.
/// 2. On B, whose inward direction is `n' x w` in its own frame: a matrix that errs by 71 (see [`CERTIFICATE`]) turns a cross product
///    into that of the turned vectors within 213, and keeps the right angle between `w` and `n'` within 142; the turned edges err by 7
///    each; cross product and dot as on A. Sum: below 390.
///
/// A vertex beside an edge has one frame and no matrix: the direction `d` from the edge to it and `u x d` for `w` leave
/// `(2.5 + 3 + 1.1 + 1) UNIT |u| |d|`, below `DIFFERENCE L` times the 1-norm of `u`.
///
/// What `n` has along the edges themselves is rounding, times up to `2 r`; [`CERTIFICATE`] counts it.
pub(crate) const FLANK: f64 = 512.0 * UNIT;

/// A pivot of a small system below this times its diagonal may be rounding alone: products and sums of up to four terms, and room.
/// Not a matter of soundness.
pub(crate) const PIVOT: f64 = 4096.0 * UNIT;

/// How far a box is rounded outward when it is climbed to, in units of the radius and of the distance of its middle: the
/// matrix errs by at most 20 UNIT a row, a product with it by 3 and the sum by one.
pub const BOX: f64 = 32.0 * UNIT;

/// The same when it is scanned in f32, in units of the radius: one rounding of each coordinate and of the matrix, three
/// of their products and sums, of numbers whose absolute sum is at most the radius.
pub const BOX_SCANNED: f64 = 8.0 / 16_777_216.0;

/// Columns of the broad phase: a mean box is taken for no smaller than this part of the world, so that spreads in units
/// of it stay finite where all boxes are points. Costs time only.
pub const LEAST_MEAN: f64 = 1e-9;

/// Columns are no narrower than this: the world over it stays finite. Costs time only.
pub const LEAST_WIDTH: f64 = 1e-30;

/// The search for a width starts at no less than this part of the world, for boxes that are points. Costs time only.
pub const LEAST_START: f64 = 1e-6;

/// A step of an odometer is taken this much too large, relatively. Poses may be off unit norm by [`POSE_UNIT`] in the square, so
/// rotations are farther apart than their quaternions by half as much, to first order; the difference of two quaternions and the
/// sums and roots on it err by some 8 UNIT, far less.
pub const WAY: f64 = 2.0 * POSE_UNIT;

/// Added to squares of displacements before the root, so that none vanishes: a part of a square below the least f64 is lost.
pub const LEAST_SQUARE: f64 = f64::MIN_POSITIVE * (1u64 << 32) as f64;

/// The placed centre of a body's ball, `R c + t`, errs by less than this times `|c|_1 + |t|_1`: the matrix by 20 UNIT an entry (see
/// [`BOX`]), the product and the sum by 4 more. Nothing where c is zero.
pub const CENTRE: f64 = 32.0 * UNIT;

/// A sum of odometers, or the sum at which a pair wakes, is off by less than this times itself: one rounding for the sum of two,
/// one for a budget added, one for each later sum, and each odometer is rounded up at every step ([`WAY`] covers the
/// step, 4 UNIT the sum). Eight cover them.
pub const ODOMETER: f64 = 8.0 * UNIT;

/// Coordinates, radii and ranges of a scene stay below this, so that boxes grown by a range stay below 1e38, where `f32` boxes
/// are clamped, and no distance or odometer leaves f64.
pub const SCENE_REACH: f64 = 1e37;

/// An inner tangent ball of an ellipsoid is taken this much smaller than its formula: `c^2 / (n . s)` has three roundings and a dot
/// that errs by 11 UNIT (see [`CERTIFICATE`]); the support point lies off the surface by as much relative to itself, and the normal
/// there off `n` by 8 UNIT relative to each coordinate, which counts by its square.
pub const INNER: f64 = 1.0 - 64.0 * UNIT;

/// Bounds of a curved pair agree where they are within this times L before their error terms: the largest violation of either
/// that was measured is 3.6 UNIT L, and a direction in f64 closes them to a few UNIT L unless a core is flat or the direction is that of a rim.
pub const AGREE_CURVED: f64 = 16.0 * UNIT;

/// What a product of shares on a superquadric is taken for at least: where it vanishes the surface is flat or a tip. Not a matter of
/// soundness.
pub(crate) const TIP: f64 = 1e-60;

/// `ln 2` less its nearest f64.
pub(crate) const LN2_REST: f64 = 2.319_046_813_846_299_6e-17;

/// The depth of curved cores that no inner balls prove is looked for to this times L, `2^-20`, in each bound.
pub const DEPTH_GOAL: f64 = 1.0 / (1u64 << 20) as f64;

/// A core smaller than this times the size of its pair, `2^-60`, is a point but for its radius.
pub(crate) const SPECK: f64 = 1.0 / (1u64 << 60) as f64;

/// Pairs of a size from this, `2^-200`, to its inverse are solved in the caller's unit; others in their own.
pub(crate) const SMALL_PAIR: f64 = f64::from_bits((1023 - 200) << 52);
