//! Reads a receipt line by line and evaluates its evidence.

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::io::BufRead;

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::balls::Balls;
use crate::claim::{AtMoment, Claim};
use crate::cover::{Apart, Cover};
use crate::file::{EVIDENCE, Head, follows, head, tail};
use crate::json::Json;
use crate::lines::Lines;
use crate::meet::Meet;
use crate::motion::{Span, Stage};
use crate::near::Near;
use crate::pairs::needed;
use crate::plane::Plane;
use crate::range::InCell;
use crate::real::{Exact, Real};
use crate::report::{Failure, Report, StatedFile, Unreadable, Verdict};
use crate::scene::{Leg, Scene};
use crate::{Stop, depth, distance};

/// Checks a receipt, on another scene if there is one.
pub(crate) fn run(reader: impl BufRead, other: Option<(Scene, Vec<Leg>)>) -> Result<Verdict, Unreadable> {
    let mut lines = Lines::new(reader);
    let head = head(&mut lines)?;
    let mut stated = Scene::new();
    let first = loop {
        let text = lines.next()?.ok_or_else(|| lines.bad("the tail is missing"))?;
        let line = lines.whole(Json::parse(&text))?;
        if !lines.whole(stated.line(&line))? {
            break text;
        }
        lines.count();
    };
    lines.whole(stated.end())?;
    if let Head::Range(cells) = &head {
        lines.whole(cells.fits(&stated))?;
    }
    let mut check = Check::new(head, stated, other);
    check.start(lines.number);
    let mut text = Some(first);
    while let Some(now) = text {
        let line = lines.whole(Json::parse(&now))?;
        if line.kind() == "end" {
            let number = lines.number;
            let end = check.end_leg();
            check.note(number, false, end)?;
            let hash = if tail(&mut lines, &line)? {
                Ok(())
            } else {
                Stop::fails("the hash is not that of the lines")
            };
            check.note(number, false, hash)?;
            check.note(number, false, check.all_legs())?;
            return Ok(check.verdict());
        }
        lines.count();
        let evidence = EVIDENCE.contains(&line.kind());
        if !evidence && line.kind() != "leg" {
            return Err(lines.bad("unknown kind of a line, or a line out of order"));
        }
        check.report.certificates += usize::from(evidence);
        let result = check.line(&line);
        check.note(lines.number, evidence, result)?;
        text = lines.next()?;
    }
    Err(lines.bad("the tail is missing"))
}

fn vector(json: &Json) -> Result<Exact, Stop> {
    Ok(json.reals::<3>()?.map(Real::exact))
}

struct Check {
    head: Head,
    /// What is evaluated: the scene of the receipt, or the other one with the pairs ignored here.
    scene: Scene,
    legs: Option<Vec<Leg>>,
    narrow: Option<Stage<i128>>,
    wide: OnceCell<Option<Stage<IBig>>>,
    /// The last leg of the file, and how many there are.
    leg: Option<Leg>,
    count: usize,
    cover: Cover,
    /// Pairs with a solid whose hulls are apart at some time, and those of which a cell was cut.
    hulls_apart: BTreeSet<(usize, usize)>,
    cut: BTreeSet<(usize, usize)>,
    failure: Option<Failure>,
    /// The scenes differ in their bodies: no certificate can be evaluated.
    different: Option<String>,
    report: Report,
}

impl Check {
    fn new(head: Head, mut stated: Scene, other: Option<(Scene, Vec<Leg>)>) -> Self {
        let report = Report {
            files: stated
                .files
                .drain(..)
                .map(|(name, sha256)| StatedFile { name, sha256 })
                .collect(),
            ..Report::default()
        };
        let (mut scene, mut legs, mut different) = (stated, None, None);
        if let Some((mut new, new_legs)) = other {
            let same = scene
                .bodies
                .iter()
                .zip(&new.bodies)
                .take_while(|(x, y)| x.name == y.name)
                .count();
            if same != scene.bodies.len().max(new.bodies.len()) {
                different = Some(format!("another scene: body {same} is not the same"));
            }
            (new.ignored, new.reasons) = (std::mem::take(&mut scene.ignored), std::mem::take(&mut scene.reasons));
            (scene, legs) = (new, Some(new_legs));
        }
        let (narrow, wide) = (None, OnceCell::new());
        let (cover, leg) = (Cover::default(), None);
        Self {
            head,
            scene,
            legs,
            narrow,
            wide,
            leg,
            count: 0,
            cover,
            hulls_apart: BTreeSet::new(),
            cut: BTreeSet::new(),
            failure: None,
            different,
            report,
        }
    }

    fn start(&mut self, line: usize) {
        match self.different.clone() {
            Some(why) => self.failure = Some(Failure::new(line, None, true, why)),
            None => self.narrow = Stage::new(&self.scene, None),
        }
    }

    /// Keeps the first failure and counts the others.
    fn note(&mut self, line: usize, evidence: bool, result: Result<(), Stop>) -> Result<(), Unreadable> {
        let stale = self.legs.is_some();
        let text = match result {
            Ok(()) => return Ok(()),
            // On another scene a line may name what is not there.
            Err(Stop::Bad(why)) if !stale => return Err(Unreadable::Line { line, why }),
            Err(Stop::Bad(text) | Stop::Fails(text)) => text,
        };
        match &mut self.failure {
            Some(first) => first.more += 1,
            None => {
                let certificate = evidence.then_some(self.report.certificates);
                self.failure = Some(Failure::new(line, certificate, stale, text));
            }
        }
        Ok(())
    }

    fn line(&mut self, line: &Json) -> Result<(), Stop> {
        if line.kind() == "leg" {
            return self.start_leg(line);
        }
        if matches!(self.head, Head::Scene) {
            return Stop::bad("evidence in a scene");
        }
        if self.different.is_some() {
            return Ok(());
        }
        let is_range = matches!(self.head, Head::Range(_));
        if is_range != (line.kind() == "cell") {
            return Stop::bad("a claim about a range has cells alone, and no other claim has cells");
        }
        if self.scene.coordinates > 0 && self.count == 0 && !is_range {
            return Stop::bad("evidence before the first leg");
        }
        match (line.kind(), &self.head) {
            ("cell", _) => self.cell(line),
            ("outside", Head::Apart(apart)) => {
                let span = apart.span;
                self.outside(line, span)
            }
            ("plane" | "balls", Head::Apart(apart)) => {
                let apart = *apart;
                self.apart(line, &apart)
            }
            ("plane" | "balls" | "outside", _) => Stop::bad("this claim is of single lines"),
            (kind, _) => {
                let text = match kind {
                    "meet" => self.moment(&Meet::read(&self.scene, line)?)?,
                    "near" => self.moment(&Near::read(&self.scene, line)?)?,
                    "distance" => distance::check(&self.scene, line)?,
                    _ => depth::check(&self.scene, line)?,
                };
                self.report.proven.push(text + &self.of_leg());
                Ok(())
            }
        }
    }

    fn of_leg(&self) -> String {
        if self.count > 1 {
            format!(" of leg {}", self.count)
        } else {
            String::new()
        }
    }

    /// Returns the sentence of a claim that holds.
    fn moment(&mut self, claim: &impl AtMoment) -> Result<String, Stop> {
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
    fn apart(&mut self, line: &Json, apart: &Apart) -> Result<(), Stop> {
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
                let normal = vector(line.get("normal")?)?;
                let spin = line.find("spin").map(vector).transpose()?;
                (vec![self.scene.pair(line.get("plane")?)?], Some((normal, spin)), cuts)
            }
            _ => {
                line.only(&["balls", "from", "until", "keep"])?;
                (self.scene.star(line.get("balls")?)?, None, &[][..])
            }
        };
        if keep < apart.margin {
            let name = pairs.first().map_or(String::new(), |pair| self.scene.names(*pair));
            return Stop::fails(format!("{name}: keeps {}, less than the margin", keep.shown()));
        }
        let (keep, mut failed) = (keep.exact(), None);
        for pair in pairs {
            let parts = self.cover.next(&self.scene, apart, pair, span, cuts)?;
            let bodies = [pair.0, pair.1].map(|k| &self.scene.bodies[k]);
            let some = [bodies[0].of_parts(parts[0]), bodies[1].of_parts(parts[1])];
            let whole = plane.is_none() || some == [None, None];
            let solid = bodies[0].solid || bodies[1].solid;
            let holds = match plane.clone() {
                Some((normal, spin)) => self.holds(&Plane {
                    pair,
                    some,
                    span,
                    keep: keep.clone(),
                    normal,
                    spin,
                }),
                None => self.holds(&Balls {
                    pair,
                    span,
                    keep: keep.clone(),
                }),
            };
            if !holds && failed.is_none() {
                failed = Some(pair);
            }
            if solid {
                let list = if whole { &mut self.hulls_apart } else { &mut self.cut };
                list.insert(pair);
            }
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

    /// The hulls of two bodies are apart at a time: neither body is inside the other.
    fn outside(&mut self, line: &Json, span: Span) -> Result<(), Stop> {
        line.only(&["outside", "at", "normal"])?;
        let (pair, time) = (self.scene.pair(line.get("outside")?)?, line.get("at")?.real()?);
        self.scene.must_prove(pair)?;
        let plane = Plane {
            pair,
            some: [None, None],
            span: Span::at(time),
            keep: RBig::ZERO,
            normal: vector(line.get("normal")?)?,
            spin: None,
        };
        if !(span.from..=span.until).contains(&time) || !self.holds(&plane) {
            let name = self.scene.names(pair);
            return Stop::fails(format!("{name}: the hulls are not apart at t = {}", time.shown()));
        }
        self.hulls_apart.insert(pair);
        Ok(())
    }

    /// A plane over a cell of a range.
    fn cell(&mut self, line: &Json) -> Result<(), Stop> {
        line.only(&["cell", "cut", "link", "normal", "keep"])?;
        let pair = self.scene.pair(line.get("cell")?)?;
        let Head::Range(cells) = &mut self.head else {
            return Ok(());
        };
        let (cell, keep) = cells.next(&self.scene, pair, line)?;
        let (link, normal) = (line.get("link")?.whole()?, line.get("normal")?.reals::<3>()?);
        if link > self.scene.joints.len() || cell.len() < self.scene.coordinates {
            return Stop::bad(format!("unknown link {link}, or a coordinate without a range"));
        }
        let middle: Vec<f64> = cell
            .iter()
            .map(|[low, high]| 0.5 * (low.shown() + high.shown()))
            .collect();
        let (normal, keep) = (normal.map(Real::exact), keep.exact());
        let claim = InCell {
            pair,
            cell,
            link,
            normal,
            keep,
        };
        if self.holds(&claim) {
            return Ok(());
        }
        Stop::fails(format!("{}, about {middle:?}", self.scene.names(pair)))
    }

    /// Narrow integers first; wide ones where they do not suffice.
    fn holds(&mut self, claim: &impl Claim) -> bool {
        let narrow = self.narrow.as_ref().and_then(|stage| claim.holds(&self.scene, stage));
        if narrow == Some(true) {
            return true;
        }
        self.report.wide += 1;
        let leg = self.now();
        if leg.is_none() && self.scene.coordinates > 0 && !matches!(self.head, Head::Range(_)) {
            return false;
        }
        let wide = self.wide.get_or_init(|| Stage::new(&self.scene, leg));
        wide.as_ref()
            .and_then(|stage| claim.holds(&self.scene, stage))
            .unwrap_or(false)
    }

    /// Returns the leg that is evaluated.
    fn now(&self) -> Option<&Leg> {
        match &self.legs {
            Some(legs) => legs.get(self.count.checked_sub(1)?),
            None => self.leg.as_ref(),
        }
    }

    fn start_leg(&mut self, line: &Json) -> Result<(), Stop> {
        if self.count == 0 && self.report.certificates > 0 {
            return Stop::bad("evidence before the first leg");
        }
        if matches!(self.head, Head::Range(_)) {
            return Stop::bad("a leg in a claim about configurations");
        }
        let leg = Leg::read(line)?;
        if self.legs.is_none() {
            follows(&self.scene, self.leg.as_ref(), &leg)?;
        }
        let before = if self.count > 0 { self.end_leg() } else { Ok(()) };
        (self.leg, self.count, self.wide) = (Some(leg), self.count + 1, OnceCell::new());
        if let Head::Apart(apart) = &self.head {
            let (from, until) = (apart.span.from, apart.span.until);
            let whole = from == Real::ZERO && until == Real::ONE;
            if from < Real::ZERO || until > Real::ONE || self.count > 1 && !whole {
                return Stop::bad("the interval is not within a leg, or not all of each of several");
            }
        }
        let stage = self.narrow.take();
        let Some(now) = self.now() else {
            return Stop::fails("another scene: a leg is missing");
        };
        self.narrow = stage.and_then(|mut stage| stage.set(&self.scene.joints, now).map(|()| stage));
        before
    }

    fn all_legs(&self) -> Result<(), Stop> {
        match &self.legs {
            Some(legs) if legs.len() != self.count && self.different.is_none() => {
                Stop::fails(format!("another scene: {} legs, not {}", legs.len(), self.count))
            }
            _ => Ok(()),
        }
    }

    fn end_leg(&mut self) -> Result<(), Stop> {
        let cover = std::mem::take(&mut self.cover);
        match &mut self.head {
            Head::Apart(_) if self.different.is_none() => cover.end(&self.scene),
            Head::Range(cells) if self.different.is_none() => cells.end(&self.scene),
            _ => Ok(()),
        }
    }

    fn verdict(mut self) -> Verdict {
        match self.head.clone() {
            Head::Apart(Apart { span, margin }) => {
                let [from, until] = [span.from, span.until].map(Real::shown);
                let legs = if self.count > 1 {
                    format!(" of each of {} legs", self.count)
                } else {
                    String::new()
                };
                self.tell(margin, &format!("from t = {from} until t = {until}{legs}"));
            }
            Head::Range(cells) => {
                let each = cells
                    .range
                    .iter()
                    .map(|[low, high]| format!("[{}, {}]", low.shown(), high.shown()));
                let each: Vec<String> = each.collect();
                self.tell(cells.margin, &format!("at every configuration of {}", each.join(" x ")));
            }
            _ => {}
        }
        if self.report.proven.is_empty() {
            let text = "nothing is claimed".into();
            self.failure.get_or_insert(Failure::new(1, None, false, text));
        }
        match self.failure {
            Some(failure) => Verdict::Fails(failure),
            None => Verdict::Holds(self.report),
        }
    }

    /// Says what a claim of all pairs proves, and what it leaves out.
    fn tell(&mut self, margin: Real, when: &str) {
        let (proven, resting) = needed(&self.scene);
        if proven > 0 {
            self.tell_proven(margin.shown(), when, proven);
        }
        for (pair, why) in &self.scene.ignored {
            let text = format!("{}: {}", self.scene.names(*pair), self.scene.reasons[*why]);
            self.report.not_looked_at.push(text);
        }
        for pair in self.cut.difference(&self.hulls_apart) {
            let name = self.scene.names(*pair);
            let text = format!("{name}: whether one is inside the other; their surfaces stay apart");
            self.report.not_looked_at.push(text);
        }
        if resting > 0 {
            self.report
                .not_looked_at
                .push(format!("{resting} pairs of bodies that both rest"));
        }
    }

    /// Says that so many pairs stay apart, and of which bodies.
    fn tell_proven(&mut self, margin: f64, when: &str, proven: usize) {
        let stay = if proven == 1 {
            "pair of bodies stays"
        } else {
            "pairs of bodies stay"
        };
        let text = format!("{proven} {stay} more than {margin} apart {when}");
        self.report.proven.push(text);
        let names = |moves: bool| {
            let all: Vec<_> = self
                .scene
                .bodies
                .iter()
                .filter(|b| b.moves == moves)
                .map(|b| b.name.as_str())
                .collect();
            all.join(", ")
        };
        self.report.proven.push(format!(
            "these are all pairs with a body that moves, but for those listed below; moving: {}; at rest: {}",
            names(true),
            names(false)
        ));
    }
}
