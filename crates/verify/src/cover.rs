//! Certificates that cover an interval of time, for every pair that is not ignored.
//!
//! **Lemma 8.** Closed intervals, each of which starts where the one before ends, cover
//! everything from the start of the first to the end of the last. The list of pairs is made here,
//! from the bodies: every pair with a body that moves and that no line ignores. A file cannot
//! leave one out.

use std::collections::BTreeMap;

use crate::Stop;
use crate::json::Json;
use crate::motion::Span;
use crate::real::Real;
use crate::scene::Scene;

/// The claim that pairs stay apart, from the head of a receipt.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    pub(crate) span: Span,
    pub(crate) margin: Real,
}

impl Apart {
    pub(crate) fn read(head: &Json) -> Result<Self, Stop> {
        let [from, until, margin] = [
            head.get("from")?.real()?,
            head.get("until")?.real()?,
            head.get("margin")?.real()?,
        ];
        if margin < Real::ZERO || from > until {
            return Stop::bad("the margin is negative, or the interval ends before its start");
        }
        Ok(Self {
            span: Span { from, until },
            margin,
        })
    }
}

/// What is proven of one leg.
#[derive(Default)]
pub(crate) struct Cover {
    until: BTreeMap<(usize, usize), Real>,
}

impl Cover {
    /// Returns the interval of a certificate and what it keeps, if that is what is missing.
    pub(crate) fn next(
        &self,
        scene: &Scene,
        apart: &Apart,
        pairs: &[(usize, usize)],
        line: &Json,
    ) -> Result<(Span, Real), Stop> {
        let real = |key, default| line.find(key).map_or(Ok(default), Json::real);
        let span = Span {
            from: real("from", apart.span.from)?,
            until: real("until", apart.span.until)?,
        };
        let keep = real("keep", apart.margin)?;
        for pair in pairs {
            let name = || scene.names(*pair);
            if scene.ignored.contains_key(pair) || !(scene.bodies[pair.0].moves || scene.bodies[pair.1].moves) {
                return Stop::fails(format!("{}: a proof of a pair that is ignored or rests", name()));
            }
            let start = *self.until.get(pair).unwrap_or(&apart.span.from);
            if span.from != start || span.until < start || span.until > apart.span.until {
                let (name, from, until) = (name(), span.from.shown(), start.shown());
                return Stop::fails(format!("{name}: a proof from t = {from}, after one until t = {until}"));
            }
        }
        if keep < apart.margin {
            let name = pairs.first().map_or(String::new(), |pair| scene.names(*pair));
            return Stop::fails(format!("{name}: keeps {}, less than the margin", keep.shown()));
        }
        Ok((span, keep))
    }

    /// Adds a proof of a pair.
    pub(crate) fn add(&mut self, pair: (usize, usize), until: Real) {
        self.until.insert(pair, until);
    }

    /// Checks that all pairs are proven up to the end.
    pub(crate) fn end(&self, scene: &Scene, apart: &Apart) -> Result<(), Stop> {
        if let Some((pair, until)) = self.until.iter().find(|x| *x.1 != apart.span.until) {
            return Stop::fails(format!(
                "{} is proven until t = {} only",
                scene.names(*pair),
                until.shown()
            ));
        }
        if self.until.len() == needed(scene).0 {
            return Ok(());
        }
        missing(scene, |pair| self.until.contains_key(pair))
    }
}

/// Names the first pair that is neither ignored nor proven.
pub(crate) fn missing(scene: &Scene, proven: impl Fn(&(usize, usize)) -> bool) -> Result<(), Stop> {
    // Pairs of two bodies that rest are never visited: a file has many legs for few bytes.
    let every: Vec<usize> = (0..scene.bodies.len()).collect();
    let movers: Vec<usize> = every.iter().copied().filter(|k| scene.bodies[*k].moves).collect();
    let all = every.iter().flat_map(|a| {
        let others = if scene.bodies[*a].moves { &every } else { &movers };
        let first = others.partition_point(|b| b <= a);
        others[first..].iter().map(move |b| (*a, *b))
    });
    let mut missing = all.filter(|pair| !scene.ignored.contains_key(pair) && !proven(pair));
    missing
        .next()
        .map_or(Ok(()), |pair| Stop::fails(format!("no proof of {}", scene.names(pair))))
}

/// Returns the number of pairs to prove, and of pairs that rest and are not ignored.
pub(crate) fn needed(scene: &Scene) -> (usize, usize) {
    let pairs = |n: usize| n * n.saturating_sub(1) / 2;
    let rest = |pair: &(usize, usize)| !scene.bodies[pair.0].moves && !scene.bodies[pair.1].moves;
    let resting = pairs(scene.bodies.iter().filter(|b| !b.moves).count());
    let ignored_resting = scene.ignored.keys().filter(|pair| rest(pair)).count();
    let ignored = scene.ignored.len() - ignored_resting;
    (pairs(scene.bodies.len()) - resting - ignored, resting - ignored_resting)
}
