//! Reads a receipt line by line and evaluates its evidence.

mod cell;
mod evidence;
mod legs;
mod start;
mod tell;

use std::cell::OnceCell;
use std::io::BufRead;

use dashu_int::IBig;

use crate::cover::Cover;
use crate::file::{EVIDENCE, Head, head, tail};
use crate::inside::Inside;
use crate::json::Json;
use crate::lines::Lines;
use crate::meet::Meet;
use crate::motion::Stage;
use crate::near::Near;
use crate::report::{Failure, Report, Unreadable, Verdict};
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

#[derive(Default)]
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
    inside: Inside,
    failure: Option<Failure>,
    /// The scenes differ in their bodies: no certificate can be evaluated.
    different: Option<String>,
    report: Report,
}

impl Check {
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
}
