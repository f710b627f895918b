//! Receipts: proofs in a file that anybody can check without this library.
//!
//! A verdict "free" rests on planes and balls that exist in memory for a moment. A [`Receipt`]
//! writes them down: the bodies, how they move, the pairs that were not checked, and one piece of
//! evidence for each pair and interval of time. A checker evaluates the evidence in exact
//! arithmetic and never searches: the crate `lin-canny-verify`, or the Python script
//! `crates/verify/verify.py`.
//!
//! ```
//! use lin_canny::nalgebra::{Isometry3, Vector3};
//! use lin_canny::polyhedron::solids;
//! use lin_canny_plan::receipt::Receipt;
//! use lin_canny_plan::{Checker, Joint, JointMotion, JointTree, Cell};
//!
//! // Two links in the plane, and a post.
//! let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
//! let turn = |x: f64| Joint::revolute(at(x), Vector3::z_axis(), [-3.0, 3.0]);
//! let joints = vec![turn(0.0), turn(1.0)];
//! let arm = JointTree::serial(at(0.0), joints, vec![1, 2], 1.0)?;
//! let rod = solids::cuboid(Vector3::new(0.4, 0.05, 0.05))?;
//! let rod = rod.transformed(&at(0.5))?;
//! let mut cell = Cell::new();
//! cell.robot_body("upper arm", rod.clone());
//! cell.robot_body("fore arm", rod);
//! let post = solids::cuboid(Vector3::new(0.1, 0.1, 1.0))?;
//! cell.add_obstacle("post", post, at(2.2))?;
//! let mut checker = Checker::new(arm, cell)?;
//!
//! let receipt = Receipt::motion(&mut checker, &JointMotion::segment(&[0.8, 0.2], &[0.5, 1.4]))?;
//! let text = receipt.to_string();
//! let head = r#"{"receipt":1,"claim":"apart","from":"0x0p0","until":"0x1p0""#;
//! assert!(text.starts_with(head));
//! assert_eq!(text.lines().filter(|l| l.starts_with("{\"body\"")).count(), 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What has a receipt
//!
//! | answer | writer | the receipt proves |
//! |---|---|---|
//! | [`Verdict::Free`](crate::Verdict::Free) of a motion | [`Receipt::motion`], [`certified`](Receipt::certified) | every pair that is not ignored keeps more than the margin, at all times |
//! | [`Verdict::Blocked`](crate::Verdict::Blocked) of a motion of one piece | [`Receipt::motion`] | the same up to `free_until`, and that the pair meets, or is within what it must keep, at `contact_at` |
//! | [`RangeAnswer`](crate::RangeAnswer)s that pairs never meet | [`Receipt::range`] | these pairs keep more than the margin at every configuration of the range |
//! | a cast of two bodies | [`Receipt::cast`] | a miss, or apart up to `safe` and a contact at `hit` |
//! | the distance of two bodies | [`Receipt::outcome`] | its lower and its upper bound |
//! | an overlap of two bodies | [`Receipt::outcome`] | that they share a point |
//!
//! [`Receipt::scene`] writes bodies and a path without a proof. A checker evaluates an older
//! receipt on it, and says whether the proof still holds after an obstacle has moved.
//!
//! # What has no receipt
//!
//! * Depths, and distances from half-spaces.
//! * Contacts and distances of cylinders, cones, ellipsoids, compounds with such a piece and Bézier surfaces: no
//!   points of their surfaces are stated.
//! * Ranges of joint values in which a half-space moves.
//! * A mesh that holds another body inside, without contact of their surfaces.
//! * Tubes of the coordinates, and motions with bounds of unknown accelerations ([`Steady::with_acceleration_bounds`]).
//! * Undecided answers.
//!
//! Each of these is an error that names the body, the pair or the motion.
//!
//! # What a receipt says, and what it does not
//!
//! * It proves something about the bodies and motions that it states, to the last bit. It does not
//!   say whether they are those of a real robot: a controller that is off by a tenth of a degree
//!   runs another motion.
//! * The motion is that over the real numbers. Poses that
//!   [`SegmentMotion::pose`](crate::SegmentMotion::pose) rounds differ from it by some units in the
//!   last place.
//! * Joints and rotations are those of the space, which are normalised.
//! * A mesh is stated as its triangles, and a closed one as a solid. A receipt proves that surfaces
//!   stay apart. It proves that no body is inside the other if the hulls are apart at one time; or
//!   else a checker says that it did not look at this. A distance is that of the surfaces.
//!   Of a mesh that [`Mesh::repaired`](lin_canny::Mesh::repaired) has changed, it states the result and says what was changed.
//! * A Bézier surface (feature `surfaces`) is stated as triangles with a radius that contain it. The receipt says by how much they are
//!   larger, at most. They are refined until the evidence holds: to a radius of 1/16,384 of the size.
//! * A piece of a compound is stated by its vertices and semi-axes in the frame of the body, which are rounded.
//! * Pairs that are excluded, that keep their relative pose, or whose contact at the start was accepted
//!   are listed with the reason. Pairs of two bodies that rest are not looked at, except for a contact.
//!
//! The writer makes the evidence from the certificates of the library. A checker sees a motion as
//! polynomials, so the writer halves intervals that are too long for it, and rounds normals to few
//! bits while they prove the same. It writes one pair of balls or one plane for the whole time if
//! that is enough. The writer decides this in double precision. If it errs, a checker rejects the
//! receipt; it never accepts a wrong one.
//!
//! [`Steady::with_acceleration_bounds`]: lin_canny::motion::Steady::with_acceleration_bounds

mod cells;
mod contact;
mod distance;
mod error;
mod evidence;
mod groups;
mod number;
mod obstacles;
mod pair;
mod range;
mod scene;
mod segment;
mod sha256;
mod stated;
#[cfg(feature = "surfaces")]
mod surface;
mod taylor;

use core::fmt;
use std::io;

pub use error::ReceiptError;

use evidence::{Evidence, Mover, PairJudge, Piece};
use lin_canny::impact::Certificate;
use number::hex;
use scene::{Scene, grouped, list, plain};
use sha256::sha256;

/// A proof as a text of lines: see the [module](crate::receipt).
///
/// [`Display`](fmt::Display) and [`write`](Self::write) give the text.
#[derive(Clone, Debug)]
pub struct Receipt {
    claim: Claim,
    files: Vec<[String; 2]>,
    scene: Scene,
    legs: Vec<Leg>,
}

/// What a receipt claims.
#[derive(Clone, Debug)]
enum Claim {
    /// All pairs keep more than the margin from a time until another.
    Apart { span: [f64; 2], margin: f64 },
    /// All pairs keep more than the margin at all configurations of a range.
    Range { range: Vec<[f64; 2]>, margin: f64 },
    /// What the lines say.
    Lines,
    /// Nothing: the scene and the motion alone.
    Scene,
}

/// A segment or a curve of the joints, and its evidence.
#[derive(Clone, Debug, Default)]
struct Leg {
    /// The control points; none if no joint is driven.
    rows: Option<Vec<Vec<f64>>>,
    evidence: Vec<String>,
}

impl Receipt {
    /// Adds the name and the hash of a file from which bodies were made; a checker prints both.
    pub fn add_file(&mut self, name: &str, content: &[u8]) {
        self.files.push([plain(name), sha256(content)]);
    }

    /// Sets the reasons of the pairs that are not looked at: `why` gets the names of both bodies.
    ///
    /// If it returns `None`, the reason stays: the pair is excluded, or keeps its relative pose.
    pub fn set_reasons(&mut self, why: impl Fn([&str; 2]) -> Option<String>) {
        for ignored in &mut self.scene.ignored {
            let names = ignored.pair.map(|k| self.scene.bodies[k].name.as_str());
            if let Some(reason) = why(names).filter(|reason| !reason.is_empty()) {
                ignored.why = reason;
            }
        }
    }

    /// Returns the number of pieces of evidence.
    #[must_use]
    pub fn certificates(&self) -> usize {
        self.legs.iter().map(|leg| leg.evidence.len()).sum()
    }

    /// Writes the text.
    ///
    /// # Errors
    /// Returns the error of the writer.
    pub fn write(&self, mut to: impl io::Write) -> io::Result<()> {
        to.write_all(self.to_string().as_bytes())
    }

    fn head(&self) -> String {
        match &self.claim {
            Claim::Apart {
                span: [from, until],
                margin,
            } => {
                let [from, until, margin] = [*from, *until, *margin].map(hex);
                format!(
                    "{{\"receipt\":1,\"claim\":\"apart\",\"from\":\"{from}\",\"until\":\"{until}\",\"margin\":\"{margin}\"}}"
                )
            }
            Claim::Range { range, margin } => {
                let range: Vec<String> = range.iter().map(|ends| number::hexes(ends)).collect();
                let (range, margin) = (range.join(","), hex(*margin));
                format!("{{\"receipt\":1,\"claim\":\"range\",\"range\":[{range}],\"margin\":\"{margin}\"}}")
            }
            Claim::Lines => "{\"receipt\":1,\"claim\":\"lines\"}".into(),
            Claim::Scene => "{\"receipt\":1,\"claim\":\"scene\"}".into(),
        }
    }
}

impl fmt::Display for Receipt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lines = vec![self.head()];
        let files = self.files.iter();
        lines.extend(files.map(|[name, hash]| format!("{{\"file\":\"{name}\",\"sha256\":\"{hash}\"}}")));
        lines.extend(self.scene.lines());
        for leg in &self.legs {
            if let Some(rows) = &leg.rows {
                let rows: Vec<String> = rows.iter().map(|row| number::hexes(row)).collect();
                lines.push(format!("{{\"leg\":[{}]}}", rows.join(",")));
            }
            lines.extend(leg.evidence.iter().cloned());
        }
        let count = lines.len();
        let text: String = lines.into_iter().flat_map(|line| [line, "\n".into()]).collect();
        f.write_str(&text)?;
        writeln!(f, "{{\"end\":{count},\"sha256\":\"{}\"}}", sha256(text.as_bytes()))
    }
}

/// A pair that must have evidence: its bodies, what it must keep, and the library's certificates.
struct Wanted<'a> {
    pair: [usize; 2],
    keep: f64,
    certificates: &'a [Certificate],
}

/// Returns the lines of evidence that pairs stay apart along a leg.
fn apart(
    scene: &Scene,
    rows: Option<&[Vec<f64>]>,
    [from, until]: [f64; 2],
    margin: f64,
    wanted: &[Wanted<'_>],
) -> Result<Vec<String>, ReceiptError> {
    let movers = Mover::all(scene, rows);
    let size = scene.size();
    let (mut lines, mut balls) = (Vec::new(), std::collections::BTreeMap::<u64, Vec<[usize; 2]>>::new());
    for Wanted {
        pair,
        keep,
        certificates,
    } in wanted
    {
        let [a, b] = pair.map(|k| &movers[k]);
        let keep = *keep;
        let judge = PairJudge { a, b, keep, size };
        match judge.evidence([from, until], certificates) {
            Ok(Evidence::Balls) => balls.entry(keep.to_bits()).or_default().push(*pair),
            Ok(Evidence::Pieces(pieces)) => {
                let line = |piece: &Piece| piece.line(*pair, keep, [from, until, margin]);
                lines.extend(pieces.iter().map(line));
                let is_solid = a.body.is_solid || b.body.is_solid;
                let is_whole = |piece: &Piece| piece.until > piece.from && piece.cuts.is_empty();
                if is_solid && !pieces.first().is_some_and(is_whole) {
                    lines.extend(judge.outside([from, until]).map(|(time, normal)| {
                        let (normal, [a, b]) = (number::hexes(normal.as_slice()), pair);
                        format!("{{\"outside\":[{a},{b}],\"at\":\"{}\",\"normal\":{normal}}}", hex(time))
                    }));
                }
            }
            Err(missing) => {
                return Err(ReceiptError::Pair {
                    a: a.body.name.clone(),
                    b: b.body.name.clone(),
                    from: missing.from,
                    until: missing.until,
                    why: missing.why,
                });
            }
        }
    }
    let mut all = Vec::new();
    for (keep, pairs) in balls {
        let keep = f64::from_bits(keep);
        let more = match keep == margin {
            true => String::new(),
            false => format!(",\"keep\":\"{}\"", hex(keep)),
        };
        for (a, others) in grouped(pairs) {
            all.push(format!("{{\"balls\":[{a},{}]{more}}}", list(&others)));
        }
    }
    all.extend(lines);
    Ok(all)
}
