//! Says what is proven and what was not looked at, or what failed first.

use std::collections::BTreeMap;

use super::Check;
use crate::Stop;
use crate::cover::Apart;
use crate::file::Head;
use crate::pairs::needed;
use crate::real::Real;
use crate::report::{Failure, Statement, Unreadable, Verdict};
use crate::scene::Scene;

impl Check {
    /// Keeps the first failure and counts the others.
    pub(super) fn note(&mut self, line: usize, evidence: bool, result: Result<(), Stop>) -> Result<(), Unreadable> {
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

    pub(super) fn verdict(mut self) -> Verdict {
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
        let ignored = self.scene.ignored.iter();
        let reasons = ignored.map(|(pair, why)| (*pair, self.scene.reasons[*why].as_str()));
        self.report.not_looked_at = grouped(&self.scene, reasons);
        let inside = "whether one is inside the other; their surfaces stay apart";
        let solids = self.inside.not_looked_at().map(|pair| (pair, inside));
        self.report.not_looked_at.extend(grouped(&self.scene, solids));
        for body in &self.scene.bodies {
            if let Some(larger) = body.larger {
                let (name, larger) = (&body.name, larger.shown());
                let text =
                    format!("how much larger {name} is than the body it stands for; by at most {larger}, it says");
                self.report.not_looked_at.push(text.into());
            }
            if let Some(repaired) = &body.repaired {
                let name = &body.name;
                let text = format!("the mesh of {name} before its repair; changed, it says: {repaired}");
                self.report.not_looked_at.push(text.into());
            }
        }
        if resting > 0 {
            let pairs = if resting == 1 { "pair" } else { "pairs" };
            let text = format!("{resting} {pairs} of bodies that both rest");
            self.report.not_looked_at.push(text.into());
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
        self.report.proven.push(text.into());
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
        self.report.proven.push(
            format!(
                "these are all pairs with a body that moves, but for those listed below; moving: {}; at rest: {}",
                names(true),
                names(false)
            )
            .into(),
        );
        let more = self.kept.iter().filter(|(_, keep)| keep.shown() > margin);
        let more: Vec<_> = more
            .map(|(pair, keep)| (*pair, format!("more than {} apart", keep.shown())))
            .collect();
        let more = more.iter().map(|(pair, text)| (*pair, text.as_str()));
        self.report.proven.extend(grouped(&self.scene, more));
    }
}

/// Returns a statement for each text, about its pairs, in the order of the first pairs.
fn grouped<'a>(scene: &Scene, pairs: impl Iterator<Item = ((usize, usize), &'a str)>) -> Vec<Statement> {
    let mut found: Vec<Statement> = Vec::new();
    let mut places = BTreeMap::new();
    for (pair, text) in pairs {
        let place = *places.entry(text).or_insert(found.len());
        if place == found.len() {
            found.push(text.to_owned().into());
        }
        found[place].pairs.push(scene.names(pair));
    }
    found
}
