//! The cost of accuracy: a page of measurements, no code.
//!
//! Every number here is measured by a single command, on your machine and, if you pass files, for
//! your own meshes:
//!
//! ```text
//! # half a minute: tables, pictures, --csv FILE
//! cargo run --release -p race --bin accuracy_cost
//! cargo run --release -p race --bin accuracy_cost -- --mesh A.obj --mesh B.stl
//! ```
//!
//! Errors are relative to exact arithmetic, in units of the size L of the pair ([front
//! page](crate#guarantees)). Bodies of up to 16 vertices are solved over the integers; for larger
//! bodies, exact arithmetic gives the bound proven by a direction and the distance of two points,
//! and the error of an answer is its distance from the interval between the two (at most `1e-16 L`
//! wide). Numbers and pictures of this page are from the newest records in `benches/record`
//! (`*-accuracy.csv`, and `*-shapes.csv` for curved shapes): a core of a shared AMD EPYC (Zen 5),
//! default flags.
//!
//! # The levels
//!
//! Two random hulls in a sphere of radius 1, B orbiting A and spinning by half a degree a frame;
//! nanoseconds a query, from two world poses to distance and both witness points:
//!
#![doc = include_str!("../../images/cost.md")]
//!
//! * **The walk has no accuracy to choose.** The walk ends on the closest features after a step or
//!   two, exact up to rounding, and has no earlier state with bounds to stop at. An iterative
//!   solver is often sold with a tolerance; on polytopes a tolerance buys nothing here.
//! * **The proof is cheap.** [`Tracker::closest`](crate::Tracker::closest) takes one to three
//!   nanoseconds more than the walk alone.
//! * **The last bit is expensive.** The row of [`closest_exact`](crate::Tracker) in this table is
//!   of an earlier version. Today it takes 0.6 to 1.7 microseconds, six times a certified answer in
//!   the median (`BENCHMARKS.md`), and more if the closest features are in doubt.
//!
//! A slower motion, 0.05 degrees a frame, and 512 vertices, each engine and level a point with its
//! spread (parry's `distance` caches nothing between frames):
//!
#![doc = include_str!("../../images/accuracy.svg")]
//!
//! # Motion
//!
//! The cost of a tracked query grows with the motion of a frame; from ten degrees per frame on, a
//! query starts from support vertices instead.
//!
#![doc = include_str!("../../images/motion.svg")]
//!
//! # Finer shapes
//!
//! Replacing a sphere by a hull of n vertices costs an error of some `1/n` of the pair's size. The
//! walk hardly depends on n: 100,000 vertices take some five times as long as 12.
//!
#![doc = include_str!("../../images/geometry.svg")]
//!
//! # Curved shapes
//!
//! A cylinder and an ellipsoid as themselves ([`Shape`](crate::Shape)), and replaced by hulls, half
//! a degree a frame. A hull of a few hundred vertices is faster than the curved pair and wrong in
//! the third digit; each further digit takes some ten times the vertices.
//!
#![doc = include_str!("../../images/curved.svg")]
//!
//! Coal 3.0.3 with its cached guess takes 770 to 1,130 ns on pairs of these kinds (tolerance 1e-6,
//! errors up to `5e-7 L`; AMD EPYC, 2026-11-20), some three times as long as a curved pair here.
//!
//! # Asking less
//!
//! A slow motion of two flat bodies, with every query. An inner hull is the hull of a few vertices,
//! farthest points first; with `a` and `b` the greatest distances of a vertex of either body from
//! its inner hull and `d` the signed distance of the inner hulls, the signed distance of the bodies
//! is between `d - (a + b)` and `d`. As a tracked query hardly depends on the number of vertices,
//! coarser shapes save memory more than time.
//!
#![doc = include_str!("../../images/asking.svg")]
//!
//! Of an overlap, the depth may be asked for as an upper bound alone
//! ([`Tracker::closest_with_local_depth`](crate::Tracker::closest_with_local_depth)): about three
//! walks, without the slow frames of the search for the least depth, and deeper than the depth in
//! every tenth to every second frame (`BENCHMARKS.md`).
//!
//! # Near contact
//!
//! Boxes face on face, from a tenth of their size apart to `1e-16` of their size:
//!
#![doc = include_str!("../../images/contact-error.svg")]
//!
//! A line on the diagonal reports separated bodies as touching: an error of the whole gap. Here
//! this crate is slow: below `1e-13 L` a certified answer comes from double-double arithmetic and
//! takes some ten microseconds, an exact answer a hundred, while parry's GJK finishes, wrong, in
//! less than one.
//!
#![doc = include_str!("../../images/contact-time.svg")]
//!
//! And ulp by ulp, an edge of a box in the plane of another box's face:
//!
#![doc = include_str!("../../images/ulps.svg")]
//!
//! The result of the walk alone has no bounds, and at the rounding of coordinates the walk may
//! report an overlap as a distance of `1e-16`; the certificate exists to exclude such errors.
//!
//! # Time of impact
//!
//! A cast ([`impact`](crate::impact)) returns a bracket about the first contact, proven on both
//! sides. Each query proves a separating plane that turns with the closest features, and the planes
//! converge quadratically: a tolerance of `1e-12` takes one or two queries more than one of `0.1`.
//! Conservative advancement, which steps by the distance over a bound of the speed, pays for every
//! digit:
//!
#![doc = include_str!("../../images/casts.svg")]
//!
//! # Beside other engines
//!
//! Fourteen engines on one workload in one run: two world poses in, distance and witnesses out,
//! 2,000 frames replayed, pairs of hulls of n random points on a sphere, flat ones of 1:1:0.1;
//! nanoseconds a query on an AMD EPYC (Zen 4), 2026-11-20. Licences forbid to ship V-Clip and
//! PhysX, so this repository cannot reproduce their columns. This crate returns proven bounds;
//! PhysX works in `f32` and takes at most 255 vertices.
//!
//! | motion a frame | n | this crate | V-Clip 1.0 | SWIFT 1 | PhysX 5.6 | openGJK | MuJoCo 4 |
//! |---|---:|---:|---:|---:|---:|---:|---:|
//! | 0.5 degrees | 8 | 71 | 61 | 91 | 97 | 257 | 726 |
//! | | 32 | 74 | 68 | 97 | 143 | 672 | 1049 |
//! | | 128 | 78 | 69 | 98 | 141 | 2003 | 1235 |
//! | | 512 | 90 | 84 | 113 | | 8700 | 1518 |
//! | | 2048 | 119 | 119 | 136 | | 38486 | 1728 |
//! | | 8192 | 140 | 146 | 159 | | 169746 | 2065 |
//! | 5 degrees | 8 | 90 | 74 | 102 | 127 | 308 | 757 |
//! | | 32 | 112 | 90 | 116 | 262 | 726 | 1233 |
//! | | 128 | 163 | 123 | 148 | 578 | 2145 | 1426 |
//! | | 512 | 313 | 342 | 260 | | 8755 | 1605 |
//! | | 2048 | 383 | 1078 | 796 | | 38150 | 1829 |
//! | | 8192 | 453 | 2214 | 1436 | | 170233 | 2158 |
//! | 5 degrees, flat | 8 | 90 | 76 | 104 | 125 | 314 | 822 |
//! | | 32 | 118 | 88 | 115 | 297 | 821 | 1660 |
//! | | 128 | 175 | 130 | 150 | 675 | 2414 | 2191 |
//! | | 512 | 404 | 410 | 312 | | 9769 | 3114 |
//! | | 2048 | 792 | 994 | 664 | | 45723 | 4899 |
//! | | 8192 | 1214 | 1687 | 1148 | | 205782 | 8042 |
//! | 25 degrees | 8 | 157 | 110 | 135 | 227 | 319 | 759 |
//! | | 32 | 335 | 339 | 309 | 666 | 732 | 1274 |
//! | | 128 | 365 | 651 | 566 | 1131 | 2164 | 1436 |
//! | | 512 | 365 | 1258 | 986 | | 8744 | 1606 |
//! | | 2048 | 394 | 3513 | 2503 | | 37981 | 1863 |
//! | | 8192 | 451 | 5576 | 3541 | | 171102 | 2201 |
//! | random pose | 8 | 272 | 315 | 302 | 307 | 273 | 668 |
//! | | 32 | 273 | 712 | 595 | 663 | 654 | 1074 |
//! | | 128 | 303 | 1335 | 1007 | 1039 | 1945 | 1161 |
//! | | 512 | 339 | 2718 | 1815 | | 7918 | 1307 |
//! | | 2048 | 357 | 6404 | 4031 | | 34255 | 1517 |
//! | | 8192 | 469 | 19769 | 8511 | | 152367 | 1846 |
//! | random, flat | 8 | 391 | 321 | 335 | 326 | 300 | 752 |
//! | | 32 | 502 | 766 | 677 | 751 | 733 | 1462 |
//! | | 128 | 644 | 1457 | 1185 | 1285 | 2233 | 2000 |
//! | | 512 | 850 | 3208 | 2208 | | 9074 | 2792 |
//! | random, boxes | 8 | 210 | 133 | 248 | 279 | 251 | 601 |
//! | 256 pairs in turn | 8 | 180 | 219 | | 109 | | |
//! | | 32 | 194 | 281 | | 150 | | |
//! | | 128 | 184 | 378 | | 254 | | |
//! | | 512 | 377 | 699 | | | | |
//! | depth, shallow | 8 | 306 | | | 277 | | 849 |
//! | | 32 | 418 | | | 531 | | 1484 |
//! | | 128 | 902 | | | 845 | | 2263 |
//! | | 512 | 1629 | | | | | 3420 |
//! | | 2048 | 3384 | | | | | 5681 |
//! | | 8192 | 5062 | | | | | 10589 |
//!
//! Where others win: V-Clip up to 512 vertices at 0.5 degrees, up to 128 at 5, at 8 at 25 degrees,
//! and on boxes at random poses (replayed frames train the branch predictor, which favours its many
//! small steps, and V-Clip is given rotation matrices, this crate quaternions; with frames that do
//! not repeat, this crate takes 0.98 of V-Clip's time at n = 8 and 0.5 degrees, 0.97 at 25
//! degrees); SWIFT at 5 degrees, on round bodies of 128 and 512 vertices and on flat ones from 32
//! on, and on up to 32 at 25 degrees; four engines at random poses of flat bodies of eight
//! vertices; PhysX on bodies of up to 32 vertices where each pair is met once in 256 queries, and
//! on depths of eight and 128 vertices. One depth of PhysX in eighteen is wrong by more than `1e-4`
//! of the depth.
//!
//! This crate beside parry now: `BENCHMARKS.md`.
//!
//! # Cases this crate loses
//!
//! * Exact distances: parry's f64 answer for bodies of eight vertices is right to `1e-15 L` and
//!   four times as fast.
//! * Contact below `1e-13 L`, in time (above).
//! * Random poses, for which no cached state helps: five times a tracked query on round bodies of
//!   512 vertices, nine times on flat bodies.
