//! Reads a receipt line by line and evaluates its evidence.

mod cell;
mod evidence;
mod legs;
mod start;
mod tell;

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::io::BufRead;

use crate::cover::Cover;
use crate::file::{Head, after, start, tail};
use crate::inside::Inside;
use crate::int::Big;
use crate::json::Json;
use crate::lines::Lines;
use crate::meet::Meet;
use crate::motion::Stage;
use crate::near::Near;
use crate::real::Real;
use crate::report::{Failure, Report, Unreadable, Verdict};
use crate::scene::{Leg, Scene};
use crate::{Stop, distance, rules};

/// Checks a receipt, on another scene if there is one.
pub(crate) fn run(reader: impl BufRead, other: Option<(Scene, Vec<Leg>)>) -> Result<Verdict, Unreadable> {
    let mut lines = Lines::new(reader);
    let (head, stated, first) = start(&mut lines)?;
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
        let leg = lines.whole(check.after(&line))?;
        let evidence = leg.is_none();
        check.report.certificates += usize::from(evidence);
        let result = match leg {
            Some(leg) => check.start_leg(leg),
            None => check.line(&line),
        };
        check.note(lines.number, evidence, result)?;
        text = lines.next()?;
    }
    Err(lines.bad("the tail is missing"))
}

/// The bodies in wide integers, at both degrees.
#[derive(Default)]
struct Wide {
    same: OnceCell<Option<Stage<Big<4>>>>,
    higher: OnceCell<Option<Stage<Big<5>>>>,
}

#[derive(Default)]
struct Check {
    head: Head,
    /// What is evaluated: the scene of the receipt, or the other one with the pairs ignored here.
    scene: Scene,
    /// The scene of the receipt and the legs of the other one, if that is evaluated.
    stated: Option<Scene>,
    legs: Option<Vec<Leg>>,
    narrow: Option<Stage<i128>>,
    wide: Wide,
    /// The last leg of the file, and how many there are.
    leg: Option<Leg>,
    count: usize,
    cover: Cover,
    inside: Inside,
    /// What each pair keeps by all its evidence.
    kept: BTreeMap<(usize, usize), Real>,
    failure: Option<Failure>,
    /// The other scene has other bodies, or the claim cannot be about it: no certificate is evaluated.
    different: Option<String>,
    report: Report,
}

impl Check {
    /// Checks a line by the rules of its file; returns the leg that it states.
    fn after(&self, line: &Json) -> Result<Option<Leg>, Stop> {
        let stated = self.stated.as_ref().unwrap_or(&self.scene);
        after(&self.head, stated, self.count, self.leg.as_ref(), line)
    }

    fn line(&mut self, line: &Json) -> Result<(), Stop> {
        if self.different.is_some() {
            return Ok(());
        }
        if self.stated.is_some() {
            rules::of_line(&self.head, &self.scene, self.count, line.kind())?;
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
            (kind, _) => {
                let text = match kind {
                    "meet" => self.moment(&Meet::read(&self.scene, line)?)?,
                    "near" => self.moment(&Near::read(&self.scene, line)?)?,
                    _ => distance::check(&self.scene, line)?,
                };
                self.report.proven.push((text + &self.of_leg()).into());
                Ok(())
            }
        }
    }
}
