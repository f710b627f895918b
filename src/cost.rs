//! What accuracy costs: a page, no code.
//!
//! Everything here is measured by one command, on your machine and, if you name them, for your own meshes:
//!
//! ```text
//! cargo run --release --example accuracy_cost                             # half a minute: tables, pictures, --csv FILE
//! cargo run --release --example accuracy_cost -- --mesh A.obj --mesh B.stl
//! ```
//!
//! Errors are against exact arithmetic, and over the size L of the pair (both radii and the distance of the origins). Bodies up to
//! 16 vertices are solved over the integers; for larger ones exact arithmetic says what a direction proves and how far apart two
//! points are, and an answer is wrong by what it lies outside of the two (they leave at most `1e-16 L` open). Numbers and
//! pictures of this page are those of the newest `benches/record/*-accuracy.csv`: one core of a shared AMD EPYC (Zen 5), default flags.
//!
//! # The levels
//!
//! Two random hulls in a sphere of radius 1, B orbiting A and spinning by half a degree a frame; nanoseconds a query, two world poses in,
//! distance and both witness points out:
//!
#![doc = include_str!("../images/cost.md")]
//!
//! * **The walk has no accuracy to choose.** It ends on the closest features after a look or two, exact up to rounding, and has
//!   nothing with bounds to stop at before. An iterative solver is often sold with a tolerance; on polytopes it buys nothing here.
//! * **The proof is cheap.** [`Tracker::closest`](crate::Tracker::closest) takes one to three nanoseconds more than the walk's word.
//! * **The last bit is dear**: [`closest_exact`](crate::Tracker) takes microseconds, some hundred times a certified answer.
//!
//! A slower motion, 0.05 degrees a frame, and 512 vertices, each engine and level a point with its spread (parry's `distance` keeps nothing
//! between frames):
//!
#![doc = include_str!("../images/accuracy.svg")]
//!
//! # Motion
//!
//! What a frame moves is what a tracked query pays for; from ten degrees per frame on, a query starts from support vertices instead.
//!
#![doc = include_str!("../images/motion.svg")]
//!
//! # Finer shapes
//!
//! A sphere replaced by a hull of n vertices is wrong by some `1/n` of the pair's size. The walk hardly cares how many there are:
//! it takes some five times as long for 100,000 as for 12.
//!
#![doc = include_str!("../images/geometry.svg")]
//!
//! # Asking less
//!
//! One slow motion of two flat bodies, every question. An inner hull is that of a few vertices, farthest points first; with `a` and `b`
//! the farthest that a vertex of either body lies from its inner hull, the signed distance of the bodies is that of their inner
//! hulls or up to `a + b` less. As a tracked query hardly depends on the number of vertices, coarser shapes save memory more
//! than time.
//!
#![doc = include_str!("../images/asking.svg")]
//!
//! # Near contact
//!
//! Boxes face on face, from a tenth of their size apart to `1e-16` of it:
//!
#![doc = include_str!("../images/contact-error.svg")]
//!
//! A line on the diagonal says "touching" of bodies that are apart: an error of the whole gap. Here is also where this crate is
//! slow: below `1e-13 L` a certified answer comes from double-double arithmetic and takes some ten microseconds, an exact one a hundred,
//! while parry's GJK is done, and wrong, in less than one.
//!
#![doc = include_str!("../images/contact-time.svg")]
//!
//! And ulp by ulp, an edge of a box in the plane of another's face:
//!
#![doc = include_str!("../images/ulps.svg")]
//!
//! The walk's word has no bounds, and at the rounding of coordinates it may call an overlap a distance of `1e-16`; that is what
//! the certificate is for.
//!
//! # Where this crate loses
//!
//! * Exact distances: parry's f64 answer for bodies of eight vertices is right to `1e-15 L` and eight times as fast.
//! * Contact below `1e-13 L`, in time (above).
//! * Random poses, where nothing is kept that helps: five times a tracked query on round bodies of 512 vertices, nine times on
//!   flat ones.
