//! Reads a receipt line by line and evaluates its evidence.

use std::cell::OnceCell;
use std::io::BufRead;

use dashu_int::IBig;

use crate::balls::Balls;
use crate::claim::Claim;
use crate::cover::{Apart, Cover, needed};
use crate::json::Json;
use crate::lines::Lines;
use crate::meet::Meet;
use crate::motion::Stage;
use crate::near::Near;
use crate::plane::Plane;
use crate::real::Real;
use crate::report::{Failure, Report, StatedFile, Unreadable, Verdict};
use crate::scene::{Leg, Scene, hash};
use crate::{Stop, depth, distance};

/// What the head claims.
#[derive(Clone, Copy)]
enum Head {
    Apart(Apart),
    Lines,
    Scene,
}

/// Lines of evidence, but for legs.
const EVIDENCE: [&str; 6] = ["plane", "balls", "meet", "near", "distance", "depth"];

impl Head {
    fn read(line: &Json) -> Result<Self, Stop> {
        if line.kind() != "receipt" || *line.get("receipt")? != Json::Whole(1) {
            return Stop::bad("not a receipt of version 1");
        }
        let claim = line.get("claim")?.text()?;
        line.only(&["receipt", "claim", "from", "until", "margin"][..if claim == "apart" { 5 } else { 2 }])?;
        match claim {
            "apart" => Ok(Self::Apart(Apart::read(line)?)),
            "lines" => Ok(Self::Lines),
            "scene" => Ok(Self::Scene),
            _ => Stop::bad("unknown claim"),
        }
    }
}

/// Reads the first line.
fn head<R: BufRead>(lines: &mut Lines<R>) -> Result<Head, Unreadable> {
    let text = lines.next()?.ok_or_else(|| lines.bad("the file is empty"))?;
    let head = lines.whole(Json::parse(&text).and_then(|line| Head::read(&line)))?;
    lines.count();
    Ok(head)
}

/// Checks the tail; returns whether its hash is that of the lines.
fn tail<R: BufRead>(lines: &mut Lines<R>, line: &Json) -> Result<bool, Unreadable> {
    let read = || {
        line.only(&["end", "sha256"])?;
        Ok((line.get("end")?.whole()?, hash(line.get("sha256")?)?))
    };
    let (count, stated) = lines.whole(read())?;
    if count != lines.number - 1 {
        return Err(lines.bad(format!("the tail counts {count} lines, not {}", lines.number - 1)));
    }
    let truth = stated == lines.hash();
    match lines.next()? {
        Some(_) => Err(lines.bad("a line after the tail")),
        None => Ok(truth),
    }
}

/// Reads scene and legs of a receipt; its evidence is not evaluated.
pub(crate) fn scene(reader: impl BufRead) -> Result<(Scene, Vec<Leg>), Unreadable> {
    let mut lines = Lines::new(reader);
    head(&mut lines)?;
    let (mut scene, mut legs, mut started) = (Scene::new(), Vec::new(), false);
    while let Some(text) = lines.next()? {
        let line = lines.whole(Json::parse(&text))?;
        if line.kind() == "end" {
            lines.whole(scene.end())?;
            return match tail(&mut lines, &line)? {
                true => Ok((scene, legs)),
                false => Err(lines.bad("the hash is not that of the lines")),
            };
        }
        let stated = !started && lines.whole(scene.line(&line))?;
        started |= !stated;
        if line.kind() == "leg" {
            let leg = lines.whole(Leg::read(&line).and_then(|leg| follows(&scene, legs.last(), &leg).map(|()| leg)))?;
            legs.push(leg);
        } else if !stated && !EVIDENCE.contains(&line.kind()) {
            return Err(lines.bad("unknown kind of a line, or a line of the scene after evidence"));
        }
        lines.count();
    }
    Err(lines.bad("the tail is missing"))
}

/// Checks that a leg drives the joints and starts where the one before ends.
fn follows(scene: &Scene, before: Option<&Leg>, leg: &Leg) -> Result<(), Stop> {
    if scene.coordinates == 0 || leg.0[0].len() < scene.coordinates {
        return Stop::bad("a leg without a coordinate for each joint, or without joints");
    }
    match before.is_none_or(|before| before.0.last() == leg.0.first()) {
        true => Ok(()),
        false => Stop::bad("a leg does not start where the one before ends"),
    }
}

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
        check.report.certificates += usize::from(evidence);
        let result = check.line(&line);
        check.note(lines.number, evidence, result)?;
        text = lines.next()?;
    }
    Err(lines.bad("the tail is missing"))
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
            failure: None,
            different,
            report,
        }
    }

    fn start(&mut self, line: usize) {
        if let Some(why) = self.different.clone() {
            self.failure = Some(Failure {
                line,
                certificate: None,
                more: 0,
                stale: true,
                text: why,
            });
        } else {
            self.narrow = Stage::new(&self.scene, None);
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
                self.failure = Some(Failure {
                    line,
                    certificate,
                    more: 0,
                    stale,
                    text,
                });
            }
        }
        Ok(())
    }

    fn line(&mut self, line: &Json) -> Result<(), Stop> {
        if line.kind() == "leg" {
            return self.start_leg(line);
        }
        if !EVIDENCE.contains(&line.kind()) || matches!(self.head, Head::Scene) {
            return Stop::bad("unknown kind of a line, a line out of order, or evidence in a scene");
        }
        if self.different.is_some() {
            return Ok(());
        }
        if self.scene.coordinates > 0 && self.count == 0 {
            return Stop::bad("evidence before the first leg");
        }
        match (line.kind(), self.head) {
            ("plane" | "balls", Head::Apart(apart)) => self.apart(line, &apart),
            ("plane" | "balls", _) => Stop::bad("this claim is of single lines"),
            ("meet", _) => {
                let meet = Meet::read(&self.scene, line)?;
                let rests = meet.moment.time.is_none();
                let holds = if rests {
                    meet.at_rest(&self.scene)?
                } else {
                    self.holds(&meet)
                };
                let text = meet.moment.text(&self.scene, "and");
                self.say(holds, format!("{text} share a point"), "no common point")
            }
            ("near", _) => {
                let near = Near::read(&self.scene, line)?;
                let rests = near.moment.time.is_none();
                let holds = if rests {
                    near.at_rest(&self.scene)?
                } else {
                    self.holds(&near)
                };
                let text = near.moment.text(&self.scene, "and");
                self.say(
                    holds,
                    format!("{text} are at most {} apart", near.within.shown()),
                    "not so near",
                )
            }
            ("distance", _) => {
                let (moment, [lower, upper]) = distance::check(&self.scene, line)?;
                let text = moment.text(&self.scene, "and");
                let (lower, upper) = (lower.shown(), upper.shown());
                self.say(
                    true,
                    format!("{text} are at least {lower:?} and at most {upper:?} apart"),
                    "",
                )
            }
            _ => {
                let (moment, [lower, upper]) = depth::check(&self.scene, line)?;
                let text = moment.text(&self.scene, "and");
                let side = |x: Option<Real>, what| {
                    x.map_or(format!("{what} side not looked at"), |x| {
                        format!("{what} {:?}", x.shown())
                    })
                };
                let (lower, upper) = (side(lower, "at least"), side(upper, "at most"));
                self.say(true, format!("the depth of {text} is: {lower}, {upper}"), "")
            }
        }
    }

    fn say(&mut self, holds: bool, text: String, why: &str) -> Result<(), Stop> {
        if !holds {
            return Stop::fails(format!("{text}: {why} is seen"));
        }
        let leg = if self.count > 1 {
            format!(" of leg {}", self.count)
        } else {
            String::new()
        };
        self.report.proven.push(text + &leg);
        Ok(())
    }

    /// A certificate of pairs that stay apart.
    fn apart(&mut self, line: &Json, apart: &Apart) -> Result<(), Stop> {
        let plane = line.kind() == "plane";
        let pairs = if plane {
            line.only(&["plane", "normal", "spin", "from", "until", "keep"])?;
            vec![self.scene.pair(line.get("plane")?)?]
        } else {
            line.only(&["balls", "from", "until", "keep"])?;
            self.scene.star(line.get("balls")?)?
        };
        let (span, keep) = self.cover.next(&self.scene, apart, &pairs, line)?;
        let vector = |json: &Json| Ok::<_, Stop>(json.reals::<3>()?.map(Real::exact));
        let (mut normal, mut spin) = (crate::real::zero(), None);
        if plane {
            normal = vector(line.get("normal")?)?;
            spin = line.find("spin").map(vector).transpose()?;
        }
        let mut failed = None;
        for pair in pairs {
            let holds = if plane {
                let (normal, spin) = (normal.clone(), spin.clone());
                self.holds(&Plane {
                    pair,
                    span,
                    keep: keep.exact(),
                    normal,
                    spin,
                })
            } else {
                self.holds(&Balls {
                    pair,
                    span,
                    keep: keep.exact(),
                })
            };
            if !holds && failed.is_none() {
                failed = Some(pair);
            }
            // The interval counts even so: later certificates are judged by themselves.
            self.cover.add(pair, span.until);
        }
        match failed {
            None => Ok(()),
            Some(pair) => {
                let leg = if self.count > 1 {
                    format!(" of leg {}", self.count)
                } else {
                    String::new()
                };
                Stop::fails(format!("{}, at t = {}{leg}", self.scene.names(pair), span.from.shown()))
            }
        }
    }

    /// Narrow integers first; wide ones where they do not suffice.
    fn holds(&mut self, claim: &impl Claim) -> bool {
        let narrow = self.narrow.as_ref().and_then(|stage| claim.holds(&self.scene, stage));
        if narrow == Some(true) {
            return true;
        }
        self.report.wide += 1;
        let leg = self.now();
        if leg.is_none() && self.scene.coordinates > 0 {
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
        let leg = Leg::read(line)?;
        if self.legs.is_none() {
            follows(&self.scene, self.leg.as_ref(), &leg)?;
        }
        let before = if self.count > 0 { self.end_leg() } else { Ok(()) };
        (self.leg, self.count, self.wide) = (Some(leg), self.count + 1, OnceCell::new());
        if let Head::Apart(apart) = self.head {
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
        match self.head {
            Head::Apart(apart) if self.different.is_none() => cover.end(&self.scene, &apart),
            _ => Ok(()),
        }
    }

    fn verdict(mut self) -> Verdict {
        if let Head::Apart(apart) = self.head {
            self.tell(&apart);
        }
        if self.report.proven.is_empty() {
            let text = "nothing is claimed".into();
            self.failure.get_or_insert(Failure {
                line: 1,
                certificate: None,
                more: 0,
                stale: false,
                text,
            });
        }
        match self.failure {
            Some(failure) => Verdict::Fails(failure),
            None => Verdict::Holds(self.report),
        }
    }

    /// Says what a claim of all pairs proves, and what it leaves out.
    fn tell(&mut self, apart: &Apart) {
        let (proven, resting) = needed(&self.scene);
        if proven == 0 {
            return;
        }
        let [from, until, margin] = [apart.span.from, apart.span.until, apart.margin].map(Real::shown);
        let stay = if proven == 1 {
            "pair of bodies stays"
        } else {
            "pairs of bodies stay"
        };
        let legs = if self.count > 1 {
            format!(" of each of {} legs", self.count)
        } else {
            String::new()
        };
        let text = format!("{proven} {stay} more than {margin} apart from t = {from} until t = {until}{legs}");
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
        for (pair, why) in &self.scene.ignored {
            let text = format!("{}: {}", self.scene.names(*pair), self.scene.reasons[*why]);
            self.report.not_looked_at.push(text);
        }
        if resting > 0 {
            self.report
                .not_looked_at
                .push(format!("{resting} pairs of bodies that both rest"));
        }
    }
}
