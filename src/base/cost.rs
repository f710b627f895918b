//! The cost of accuracy: a page of measurements without code.
//!
//! One command measures every number here on your machine and, if you pass files, for your own
//! meshes:
//!
//! ```text
//! # half a minute: tables, pictures, --csv FILE
//! cargo run --release -p race --bin accuracy_cost
//! cargo run --release -p race --bin accuracy_cost -- --mesh A.obj --mesh B.stl
//! ```
//!
//! Errors are relative to exact arithmetic, in units of the pair size L ([front
//! page](crate#guarantees)). Bodies of up to 16 vertices are solved over the integers. For larger
//! bodies, exact arithmetic gives the bound that a direction proves and the distance of two points.
//! The error is then the distance of the result from the interval between the two (at most
//! `1e-16 L` wide). Numbers and pictures of this page are from the newest records in
//! `benches/record` (`*-accuracy.csv`, and `*-shapes.csv` for curved shapes): one core of a shared
//! AMD EPYC (Zen 5), default flags.
//!
//! # The levels
//!
//! Two random hulls in a sphere of radius 1; B orbits A and spins by half a degree per frame. Times
//! are in nanoseconds per query, from two world poses to the distance and both witness points:
//!
#![doc = include_str!("../../images/cost.md")]
//!
//! * **The walk has no accuracy to choose.** The walk ends on the closest features after one or two
//!   steps, exact up to rounding. It has no earlier state with bounds at which it could stop.
//!   Iterative solvers often offer a tolerance; for polytopes a tolerance saves nothing here.
//! * **The proof is cheap.** [`Tracker::closest`](crate::Tracker::closest) takes one to three
//!   nanoseconds more than the walk alone.
//! * **The last bit is expensive.** The row of [`closest_exact`](crate::Tracker) in this table is
//!   from an earlier version. Today it takes 0.6 to 1.7 µs, in the median six times as much as a
//!   certified query (`BENCHMARKS.md`). It takes more if the closest features are in doubt.
//!
//! A slower motion, 0.05 degrees per frame, and 512 vertices. Each engine and level is a point with
//! its spread (parry's `distance` caches nothing between frames):
//!
#![doc = include_str!("../../images/accuracy.svg")]
//!
//! # Motion
//!
//! The cost of a tracked query grows with the motion per frame. From ten degrees per frame on, a
//! query starts from support vertices instead.
//!
#![doc = include_str!("../../images/motion.svg")]
//!
//! # Finer shapes
//!
//! If a hull of n vertices replaces a sphere, the error is about `1/n` of the pair size. The cost
//! of the walk hardly depends on n: 100,000 vertices take about five times as long as 12.
//!
#![doc = include_str!("../../images/geometry.svg")]
//!
//! # Curved shapes
//!
//! A cylinder and an ellipsoid as curved shapes ([`Shape`](crate::Shape)), and replaced by hulls,
//! at half a degree per frame. A hull of a few hundred vertices is faster than the curved pair but
//! wrong in the third digit. Each further digit takes about ten times the vertices.
//!
#![doc = include_str!("../../images/curved.svg")]
//!
//! Coal 3.0.3 with its cached guess takes 770 to 1,130 ns on pairs of these kinds (tolerance 1e-6,
//! errors up to `5e-7 L`; AMD EPYC, 2026-11-20). This is about three times as long as a curved pair
//! here.
//!
//! # Cheaper queries
//!
//! A slow motion of two flat bodies, with every kind of query. An inner hull is the hull of a few
//! vertices, farthest points first. Let `a` and `b` be the greatest distances of a vertex of either
//! body from its inner hull, and `d` the signed distance of the inner hulls. Then the signed
//! distance of the bodies is between `d - (a + b)` and `d`. A tracked query hardly depends on the
//! number of vertices, so coarser shapes save memory more than time.
//!
#![doc = include_str!("../../images/asking.svg")]
//!
//! For an overlap, you may request only an upper bound of the depth
//! ([`Tracker::closest_with_local_depth`](crate::Tracker::closest_with_local_depth)). It costs
//! about three walks and avoids the slow frames of the search for the least depth. In 10 % to 50 %
//! of the frames it is larger than the depth (`BENCHMARKS.md`).
//!
//! # Near contact
//!
//! Boxes face on face, from a gap of a tenth of their size to a gap of `1e-16` of their size:
//!
#![doc = include_str!("../../images/contact-error.svg")]
//!
//! A line on the diagonal reports separated bodies as touching: an error of the whole gap. Here
//! this crate is slow. Below `1e-13 L` a certified outcome comes from double-double arithmetic and
//! takes about ten microseconds, an exact outcome about a hundred. parry's GJK ends in less than
//! one microsecond, with a wrong result.
//!
#![doc = include_str!("../../images/contact-time.svg")]
//!
//! The same in steps of one ulp, for an edge of a box in the plane of another box's face:
//!
#![doc = include_str!("../../images/ulps.svg")]
//!
//! The result of the walk alone has no bounds. At the rounding of coordinates the walk may report
//! an overlap as a distance of `1e-16`. The certificate exists to exclude such errors.
//!
//! # Time of impact
//!
//! A cast ([`impact`](crate::impact)) returns a bracket around the first contact, proven on both
//! sides. Each query proves a separating plane that rotates with the closest features, and the
//! planes converge quadratically: a tolerance of `1e-12` takes one or two queries more than a
//! tolerance of `0.1`. Conservative advancement steps by the distance over a bound of the speed, so
//! its cost grows with every digit:
//!
#![doc = include_str!("../../images/casts.svg")]
//!
//! # Compared with other engines
//!
//! Fourteen engines ran one workload in one run. Input: two world poses. Output: distance and
//! witnesses. The workload replays 2,000 frames, with pairs of hulls of n random points on a
//! sphere; flat bodies have proportions of 1:1:0.1. Times are in nanoseconds per query on an AMD
//! EPYC (Zen 4), 2026-11-20. The licences of V-Clip and PhysX forbid to ship them, so this
//! repository cannot reproduce their columns. This crate returns proven bounds; PhysX works in
//! `f32` and takes at most 255 vertices.
//!
//! | motion per frame | n | this crate | V-Clip 1.0 | SWIFT 1 | PhysX 5.6 | openGJK | MuJoCo 4 |
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
//! Where others win:
//!
//! - **V-Clip**: up to 512 vertices at 0.5 degrees, up to 128 at 5 degrees, 8 at 25 degrees, and
//!   boxes at random poses. Replayed frames train the branch predictor, which favours V-Clip's many
//!   small steps, and V-Clip gets rotation matrices where this crate gets quaternions. With frames
//!   that do not repeat, this crate takes 0.98 of V-Clip's time at n = 8 and 0.5 degrees, and 0.97
//!   at 25 degrees.
//! - **SWIFT**: round bodies of 128 and 512 vertices at 5 degrees, flat bodies from 32 vertices on
//!   at 5 degrees, and up to 32 vertices at 25 degrees.
//! - **Four engines**: random poses of flat bodies of eight vertices.
//! - **PhysX**: bodies of up to 32 vertices if each pair is met once in 256 queries, and depths of
//!   eight and 128 vertices. One PhysX depth in eighteen is wrong by more than `1e-4` of the depth.
//!
//! `BENCHMARKS.md` compares the current version of this crate with parry.
//!
//! # Cases this crate loses
//!
//! * Exact distances: for bodies of eight vertices, parry's f64 result is right to `1e-15 L` and
//!   four times as fast.
//! * The time of contacts below `1e-13 L` (see above).
//! * Random poses, for which no cached state helps: five times the time of a tracked query on round
//!   bodies of 512 vertices, nine times on flat bodies.
