//! Evidence that pairs stay apart: balls and planes that a checker accepts.
//!
//! The certificates of the library are proofs already. A checker has other bounds: it sees a motion
//! as polynomials over the whole interval of a certificate. So the writer computes the checker's
//! bounds in double precision first ([`taylor`](super::taylor)), and
//!
//! 1. takes one pair of balls for the whole time if that is enough,
//! 2. or else one plane that keeps its normal,
//! 3. or else the certificates of the library, each halved until the bound is tight enough. Balls
//!    that are too large for a checker, and proofs of another kind, become planes of the closest
//!    points.

use nalgebra::Vector3;

use super::groups::{Group, Groups, direction};
use super::number::{hex, hexes, rounded};
use super::scene::{Body, Scene};
use super::stated::Ellipsoid;
use super::taylor::{Moving, Step, TERMS, Taylor, constant, dot, heights, least, place, pose};
use crate::extremes::Extremes;
use crate::tolerance::RECEIPT;
use lin_canny::RelativePose;
use lin_canny::impact::Certificate;
use lin_canny::separation::Proof;

/// Greatest number of halvings of a certificate.
const HALVINGS: u32 = 24;

/// Bits of the components of planes, few first.
pub(super) const BITS: [u32; 3] = [8, 12, 20];

/// A body along a leg.
pub(super) struct Mover<'a> {
    pub(super) body: &'a Body,
    steps: Vec<Step>,
    /// The vertices, and the greatest absolute value of each coordinate.
    points: Vec<Vector3<f64>>,
    most: Vector3<f64>,
    /// The greatest distance of a vertex from the centre of the ball.
    reach: f64,
    pub(super) groups: Groups<'a>,
}

impl<'a> Mover<'a> {
    pub(super) fn all(scene: &'a Scene, rows: Option<&[Vec<f64>]>) -> Vec<Self> {
        let each = scene.bodies.iter().enumerate();
        each.map(|(k, body)| Self::new(body, scene.steps(k, rows))).collect()
    }

    fn new(body: &'a Body, steps: Vec<Step>) -> Self {
        let points: Vec<Vector3<f64>> = body.points.iter().map(|p| p.coords).collect();
        let centre = body.centre();
        let squares = points.iter().map(|p| (p - centre).norm_squared());
        let wider = body.ellipsoids.iter().map(Ellipsoid::radius).fold(0.0, f64::larger);
        Self {
            steps,
            reach: squares.fold(0.0, f64::larger).sqrt() + wider,
            most: points
                .iter()
                .fold(Vector3::zeros(), |most, p| most.zip_map(&p.abs(), f64::larger)),
            points,
            groups: Groups::new(body),
            body,
        }
    }
}

/// A piece of evidence of a pair from a time until another.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) from: f64,
    pub(super) until: f64,
    pub(super) proof: Proof,
    /// Cuts of the cell of parts at hand: which body, and the number of a part.
    pub(super) cuts: Vec<[usize; 2]>,
}

/// The evidence of a pair: one pair of balls for the whole time, or pieces in order of time.
pub(super) enum Evidence {
    Balls,
    Pieces(Vec<Piece>),
}

/// Why a pair has no evidence, and the time of which.
pub(super) struct Missing {
    pub(super) from: f64,
    pub(super) until: f64,
    pub(super) why: &'static str,
}

/// Two bodies that must keep a distance.
pub(super) struct PairJudge<'a> {
    pub(super) a: &'a Mover<'a>,
    pub(super) b: &'a Mover<'a>,
    pub(super) keep: f64,
    /// The size of the scene, by which rounding is measured.
    pub(super) size: f64,
}

impl PairJudge<'_> {
    /// Returns the evidence of the pair for an interval, given the library's certificates of it.
    pub(super) fn evidence(&self, span: [f64; 2], certificates: &[Certificate]) -> Result<Evidence, Missing> {
        if self.has_floor() {
            let mut pieces = Vec::new();
            let found = self.above_floor(span, HALVINGS, &mut pieces);
            // A plane of the whole body keeps the greatest radius from all its points.
            let has_radii = [self.a, self.b].iter().any(|mover| !mover.body.radii.is_empty());
            return match found {
                Err(_) if has_radii => Ok(Evidence::Pieces(self.by_parts(span)?)),
                found => found.map(|()| Evidence::Pieces(pieces)),
            };
        }
        match self.of_hulls(span, certificates) {
            Err(_) if self.has_parts() => Ok(Evidence::Pieces(self.by_parts(span)?)),
            found => found,
        }
    }

    fn of_hulls(&self, [from, until]: [f64; 2], certificates: &[Certificate]) -> Result<Evidence, Missing> {
        if self.by_balls(from, until) {
            return Ok(Evidence::Balls);
        }
        let middles = certificates
            .iter()
            .filter_map(|c| c.normal(0.5 * c.from + 0.5 * c.until));
        let known: Vec<Vector3<f64>> = middles.collect();
        let picked = [known.len() / 2, 0, known.len().saturating_sub(1)];
        let mut normals: Vec<Vector3<f64>> = picked.iter().filter_map(|k| known.get(*k).copied()).collect();
        normals.dedup();
        if normals.is_empty() {
            normals.extend(self.measured(0.5 * from + 0.5 * until));
        }
        for normal in normals {
            if let Some(proof) = self.plane(normal, Vector3::zeros(), from, until) {
                return Ok(Evidence::Pieces(vec![Piece::new([from, until], proof)]));
            }
        }
        let mut pieces = Vec::new();
        let mut at = from;
        for certificate in certificates {
            // The cast of a pair may go on after the interval, or start again.
            let end = certificate.until.smaller(until);
            let piece = Piece::new([at, end], proof_from(certificate, at));
            if piece.until > at || from == until && pieces.is_empty() {
                at = piece.until;
                self.halve(piece, HALVINGS, &mut pieces)?;
            }
        }
        if at < until || pieces.is_empty() {
            self.halve(Piece::new([at, until], Proof::Own), HALVINGS, &mut pieces)?;
        }
        Ok(Evidence::Pieces(pieces))
    }

    /// Returns the normal of a half-space of the pair, from A to B in the world, over an interval and at its start.
    fn floor(&self, from: f64, span: f64) -> Option<(Moving, Vector3<f64>)> {
        let of = |mover: &Mover<'_>, sign: f64| {
            let normal = mover.body.half?.0 * sign;
            let [tip, foot] = [normal, Vector3::zeros()].map(|point| place(&mover.steps, &point, from, span));
            let direction = core::array::from_fn(|k| tip[k].minus(&foot[k]));
            Some((direction, pose(&mover.steps, from).rotation * normal))
        };
        of(self.a, 1.0).or_else(|| of(self.b, -1.0))
    }

    fn has_floor(&self) -> bool {
        self.a.body.half.is_some() || self.b.body.half.is_some()
    }

    /// Appends planes of a half-space, halved until the bound is tight enough.
    fn above_floor(&self, [from, until]: [f64; 2], left: u32, pieces: &mut Vec<Piece>) -> Result<(), Missing> {
        let none = Vector3::zeros();
        if self.by_plane(None, &none, &none, [from, until], self.kept(self.keep)) {
            pieces.push(Piece::new([from, until], Proof::Own));
            return Ok(());
        }
        let middle = 0.5 * from + 0.5 * until;
        if left == 0 || !(from < middle && middle < until) {
            let why = "the half-space is not below by more than rounding";
            return Err(Missing { from, until, why });
        }
        self.above_floor([from, middle], left - 1, pieces)?;
        self.above_floor([middle, until], left - 1, pieces)
    }

    /// Appends evidence for a piece, halved if it is too long for the bounds of a checker.
    fn halve(&self, piece: Piece, left: u32, pieces: &mut Vec<Piece>) -> Result<(), Missing> {
        let Piece { from, until, proof, .. } = piece;
        let found = match proof {
            Proof::Balls => self.by_balls(from, until).then_some(Proof::Balls),
            Proof::Plane { normal, spin } => self.plane(normal, spin, from, until),
            Proof::Own => None,
        };
        let middle = 0.5 * from + 0.5 * until;
        let found = found.or_else(|| {
            let normal = self.measured(middle)?;
            self.plane(normal, Vector3::zeros(), from, until)
        });
        if let Some(proof) = found {
            pieces.push(Piece::new([from, until], proof));
            return Ok(());
        }
        if left == 0 || !(from < middle && middle < until) {
            let why = match self.measured(from).and(self.measured(until)) {
                Some(_) => "no plane separates them by more than rounding",
                None => "they are not separated at its start or end",
            };
            return Err(Missing { from, until, why });
        }
        let first = Piece::new([from, middle], proof);
        let proof = match proof {
            Proof::Plane { normal, spin } => Proof::Plane {
                normal: turned(&spin, middle - from) * normal,
                spin,
            },
            other => other,
        };
        let last = Piece::new([middle, until], proof);
        self.halve(first, left - 1, pieces)?;
        self.halve(last, left - 1, pieces)
    }

    /// Returns the direction between the closest points at a time, from A to B, in the world.
    fn measured(&self, time: f64) -> Option<Vector3<f64>> {
        let [x, y] = [self.a, self.b].map(|mover| mover.groups.get(mover.groups.all()));
        self.between([&*x?, &*y?], time)
    }

    /// Returns the direction between two groups of parts at a time.
    pub(super) fn between(&self, groups: [&Group; 2], time: f64) -> Option<Vector3<f64>> {
        if let Some((_, normal)) = self.floor(time, 0.0) {
            return Some(normal);
        }
        let [x, y] = [self.a, self.b].map(|mover| pose(&mover.steps, time));
        let relative = RelativePose::new(&x, &y).ok()?;
        Some(x.rotation * direction(groups, &relative)?.0)
    }

    /// Returns whether the balls stay apart, as a checker sees it.
    fn by_balls(&self, from: f64, until: f64) -> bool {
        let span = until - from;
        let [x, y] = [self.a, self.b].map(|mover| place(&mover.steps, &mover.body.centre(), from, span));
        let way: [_; 3] = core::array::from_fn(|k| y[k].minus(&x[k]));
        let square = dot(&way, &way);
        let reach = self.a.reach + self.b.reach + self.kept(self.keep) + RECEIPT * self.size;
        least(square.net()) - square.rest > reach * reach
    }

    fn kept(&self, keep: f64) -> f64 {
        keep + self.a.body.radius + self.b.body.radius
    }

    /// Returns a plane that a checker accepts, with as few bits as that takes.
    fn plane(&self, normal: Vector3<f64>, spin: Vector3<f64>, from: f64, until: f64) -> Option<Proof> {
        self.plane_between(None, normal, spin, from, until, self.keep)
    }

    /// Returns the same of two groups of parts, or of the bodies if there are none.
    pub(super) fn plane_between(
        &self,
        groups: Option<[&Group; 2]>,
        normal: Vector3<f64>,
        spin: Vector3<f64>,
        from: f64,
        until: f64,
        keep: f64,
    ) -> Option<Proof> {
        let kept = groups.map_or(self.kept(keep), |[x, y]| keep + x.radius + y.radius);
        let holds =
            |normal: &Vector3<f64>, spin: &Vector3<f64>| self.by_plane(groups, normal, spin, [from, until], kept);
        if !holds(&normal, &spin) {
            return None;
        }
        if self.has_floor() {
            return Some(Proof::Own);
        }
        for bits in BITS {
            let (normal, spin) = (rounded(&normal, bits), rounded(&spin, bits));
            if holds(&normal, &spin) {
                return Some(Proof::Plane { normal, spin });
            }
        }
        Some(Proof::Plane { normal, spin })
    }

    /// Returns whether a plane separates the bodies, as a checker sees it: that of the half-space if one is.
    fn by_plane(
        &self,
        groups: Option<[&Group; 2]>,
        normal: &Vector3<f64>,
        spin: &Vector3<f64>,
        [from, until]: [f64; 2],
        kept: f64,
    ) -> bool {
        let [a, b] = match groups {
            Some([x, y]) => [(&x.vertices, &x.ellipsoids), (&y.vertices, &y.ellipsoids)],
            None => [self.a, self.b].map(|mover| (&mover.points, &mover.body.ellipsoids)),
        };
        let span = until - from;
        let (mut direction, mut length) = (constant(normal), normal.norm());
        if let Some((turning, normal)) = self.floor(from, span) {
            (direction, length) = (turning, normal.norm());
        } else if *spin != Vector3::zeros() {
            let turn = Step::Turn {
                axis: *spin,
                angle: vec![0.0, 1.0],
            };
            direction = place(&[turn], normal, 0.0, span);
        }
        let [high, low] = [(self.a, a, 1.0), (self.b, b, -1.0)].map(|(mover, (points, ellipsoids), sign)| {
            let (m, o) = heights(&mover.steps, &direction, from, span);
            if let Some((_, offset)) = mover.body.half {
                // The normal is that of the half-space, towards the other body.
                return o.net().map(|height| offset + sign * height + o.rest);
            }
            let (nets, base) = (m.each_ref().map(|part| part.net()), o.net());
            let off = o.rest + (0..3).map(|k| m[k].rest * mover.most[k]).sum::<f64>();
            let wide: Vec<_> = ellipsoids.iter().map(|of| (of.at, half_heights(of, &m))).collect();
            core::array::from_fn(|k| {
                let slope = Vector3::new(nets[0][k], nets[1][k], nets[2][k]) * sign;
                let highest = points.iter().map(|p| slope.dot(p));
                let highest = highest.chain(wide.iter().map(|(p, half)| slope.dot(p) + half[k]));
                highest.fold(f64::NEG_INFINITY, f64::larger) + sign * base[k] + off
            })
        });
        let enough = (kept + RECEIPT * self.size) * length;
        high.iter().zip(low).all(|(high, low)| -low - high > enough)
    }
}

/// Returns Bernstein coefficients of a polynomial that is no less than the half height of an ellipsoid, as a
/// checker sees it: lemma 13 there.
fn half_heights(of: &Ellipsoid, m: &Moving) -> [f64; TERMS] {
    let squares = of.axes.iter().map(|axis| {
        let way = dot(m, &constant(axis));
        way.times(&way)
    });
    let square = squares.fold(Taylor::constant(0.0), |sum, square| sum.plus(&square));
    let net = square.net().map(|c| c + square.rest);
    let s = net.iter().copied().fold(f64::MIN_POSITIVE, f64::larger).sqrt();
    net.map(|c| (c + s * s) / (2.0 * s))
}

/// Returns the proof of a certificate from a later time on.
fn proof_from(certificate: &Certificate, from: f64) -> Proof {
    match (certificate.proof, certificate.normal(from)) {
        (Proof::Plane { spin, .. }, Some(normal)) if from != certificate.from => Proof::Plane { normal, spin },
        (proof, _) => proof,
    }
}

fn turned(spin: &Vector3<f64>, time: f64) -> nalgebra::UnitQuaternion<f64> {
    let velocity = lin_canny::Velocity::new(Vector3::zeros(), *spin);
    velocity.applied(&nalgebra::Isometry3::identity(), time).rotation
}

impl Piece {
    pub(super) fn new([from, until]: [f64; 2], proof: Proof) -> Self {
        Self {
            from,
            until,
            proof,
            cuts: Vec::new(),
        }
    }

    /// Returns the line of a piece; what equals the head is left out.
    pub(super) fn line(&self, [a, b]: [usize; 2], keep: f64, [from, until, margin]: [f64; 3]) -> String {
        let mut text = match self.proof {
            Proof::Plane { normal, spin } => {
                let spin = match spin == Vector3::zeros() {
                    true => String::new(),
                    false => format!(",\"spin\":{}", hexes(spin.as_slice())),
                };
                format!("{{\"plane\":[{a},{b}],\"normal\":{}{spin}", hexes(normal.as_slice()))
            }
            // Of a half-space, whose normal is known.
            Proof::Own => format!("{{\"plane\":[{a},{b}]"),
            _ => format!("{{\"balls\":[{a},[{b}]]"),
        };
        for (key, value, head) in [
            ("from", self.from, from),
            ("until", self.until, until),
            ("keep", keep, margin),
        ] {
            if value != head {
                text += &format!(",\"{key}\":\"{}\"", hex(value));
            }
        }
        if !self.cuts.is_empty() {
            let cuts: Vec<String> = self.cuts.iter().map(|[side, at]| format!("[{side},{at}]")).collect();
            text += &format!(",\"cut\":[{}]", cuts.join(","));
        }
        text + "}"
    }
}
