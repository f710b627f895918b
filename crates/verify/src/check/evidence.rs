//! Evaluates lines of evidence.

use std::cell::OnceCell;

use super::Check;
use crate::Stop;
use crate::balls::Balls;
use crate::claim::{AtMoment, Claim, radii};
use crate::cover::Apart;
use crate::file::Head;
use crate::half_space::{self, Floor};
use crate::inside::Inside;
use crate::int::Int;
use crate::json::Json;
use crate::motion::{Span, Stage};
use crate::plane::Plane;
use crate::real::{Exact, Real};
use crate::scene::{Leg, Scene};

fn vector(json: &Json) -> Result<Exact, Stop> {
    Ok(json.reals::<3>()?.map(Real::exact))
}

impl Check {
    /// Returns the sentence of a claim that holds.
    pub(super) fn moment(&mut self, claim: &impl AtMoment) -> Result<String, Stop> {
        let rests = claim.moment().time.is_none();
        let holds = if rests {
            claim.at_rest(&self.scene)?
        } else {
            self.holds(claim)
        };
        let text = claim.says(&self.scene);
        if holds {
            Ok(text)
        } else {
            Stop::fails(format!("{text}: this is not seen"))
        }
    }

    /// A certificate of pairs that stay apart.
    pub(super) fn apart(&mut self, line: &Json, apart: &Apart) -> Result<(), Stop> {
        let real = |key, default| line.find(key).map_or(Ok(default), Json::real);
        let span = Span {
            from: real("from", apart.span.from)?,
            until: real("until", apart.span.until)?,
        };
        let keep = real("keep", apart.margin)?;
        let (pairs, plane, cuts) = match line.kind() {
            "plane" => {
                line.only(&["plane", "normal", "spin", "from", "until", "keep", "cut"])?;
                let cuts = line.find("cut").map_or(Ok(&[][..]), Json::array)?;
                let pair = self.scene.pair(line.get("plane")?)?;
                let floor = Floor::of_pair(&self.scene, pair, false)?;
                if floor.is_some() {
                    line.only(&["plane", "from", "until", "keep", "cut"])?;
                }
                let normal = match &floor {
                    Some(floor) => floor.normal.clone(),
                    None => vector(line.get("normal")?)?,
                };
                let spin = line.find("spin").map(vector).transpose()?;
                (vec![pair], Some((normal, spin, floor)), cuts)
            }
            _ => {
                line.only(&["balls", "from", "until", "keep"])?;
                let pairs = self.scene.star(line.get("balls")?)?;
                pairs
                    .iter()
                    .try_for_each(|pair| half_space::refuse(&self.scene, *pair))?;
                (pairs, None, &[][..])
            }
        };
        if keep < apart.margin {
            let name = pairs.first().map_or(String::new(), |pair| self.scene.names(*pair));
            return Stop::fails(format!("{name}: keeps {}, less than the margin", keep.shown()));
        }
        for pair in &pairs {
            self.keeps(*pair, keep);
        }
        let (keep, mut failed) = (keep.exact(), None);
        for pair in pairs {
            let parts = self.cover.next(&self.scene, apart, pair, span, cuts)?;
            let bodies = [pair.0, pair.1].map(|k| &self.scene.bodies[k]);
            let some = [bodies[0].of_parts(parts[0]), bodies[1].of_parts(parts[1])];
            let kept = &keep + radii(&self.scene, pair, parts);
            let whole = plane.is_none() || some == [None, None];
            let holds = match plane.clone() {
                Some((normal, spin, floor)) => self.holds(&Plane {
                    pair,
                    some,
                    span,
                    kept,
                    normal,
                    spin,
                    floor,
                }),
                None => self.holds(&Balls { pair, span, kept }),
            };
            if !holds && failed.is_none() {
                failed = Some(pair);
            }
            self.inside.add(&self.scene, pair, whole);
            // The interval counts even so: later certificates are judged by themselves.
            self.cover.add(apart, pair, span.until);
        }
        match failed {
            None => Ok(()),
            Some(pair) => {
                let (names, from) = (self.scene.names(pair), span.from.shown());
                Stop::fails(format!("{names}, at t = {from}{}", self.of_leg()))
            }
        }
    }

    /// Notes what a pair keeps by a line.
    pub(super) fn keeps(&mut self, pair: (usize, usize), keep: Real) {
        let known = self.kept.entry(pair).or_insert(keep);
        if keep < *known {
            *known = keep;
        }
    }

    /// The hulls of two bodies are apart at a time.
    pub(super) fn outside(&mut self, line: &Json, whole: Span) -> Result<(), Stop> {
        let plane = Inside::read(&self.scene, whole, line)?;
        if !self.holds(&plane) {
            let name = self.scene.names(plane.pair);
            return Stop::fails(format!("{name}: the hulls are not apart"));
        }
        self.inside.add(&self.scene, plane.pair, true);
        Ok(())
    }

    /// Narrow integers first; wide ones where they do not suffice.
    pub(super) fn holds(&mut self, claim: &impl Claim) -> bool {
        let narrow = self.narrow.as_ref().and_then(|stage| claim.holds(&self.scene, stage));
        if narrow == Some(true) {
            return true;
        }
        self.report.wide += 1;
        let leg = self.now();
        if leg.is_none() && self.scene.coordinates > 0 && !matches!(self.head, Head::Range(_)) {
            return false;
        }
        seen(claim, &self.scene, leg, &self.wide.same) || seen(claim, &self.scene, leg, &self.wide.higher)
    }
}

/// Returns whether a claim is seen to hold on a stage, which is made once.
fn seen<I: Int>(claim: &impl Claim, scene: &Scene, leg: Option<&Leg>, stage: &OnceCell<Option<Stage<I>>>) -> bool {
    let stage = stage.get_or_init(|| Stage::new(scene, leg)).as_ref();
    stage.and_then(|stage| claim.holds(scene, stage)) == Some(true)
}
