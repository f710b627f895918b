//! Head and tail of a receipt, and the scene and legs of another one.

use std::io::BufRead;

use crate::Stop;
use crate::cells::Cells;
use crate::cover::Apart;
use crate::json::Json;
use crate::lines::Lines;
use crate::report::Unreadable;
use crate::rules;
use crate::scene::{Leg, Scene, hash};

/// What the head claims.
#[derive(Clone, Default)]
pub(crate) enum Head {
    Apart(Apart),
    Range(Cells),
    Lines,
    #[default]
    Scene,
}

/// Lines of evidence, but for legs.
pub(crate) const EVIDENCE: [&str; 7] = ["plane", "balls", "outside", "cell", "meet", "near", "distance"];

impl Head {
    fn read(line: &Json) -> Result<Self, Stop> {
        if line.kind() != "receipt" || *line.get("receipt")? != Json::Whole(1) {
            return Stop::bad("not a receipt of version 1");
        }
        let claim = line.get("claim")?.text()?;
        line.only(match claim {
            "apart" => &["receipt", "claim", "from", "until", "margin"],
            "range" => &["receipt", "claim", "range", "margin"],
            _ => &["receipt", "claim"],
        })?;
        match claim {
            "apart" => Ok(Self::Apart(Apart::read(line)?)),
            "range" => Ok(Self::Range(Cells::read(line)?)),
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
pub(crate) fn tail<R: BufRead>(lines: &mut Lines<R>, line: &Json) -> Result<bool, Unreadable> {
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

/// Reads head and scene, by the rules; returns the first line after them, too.
pub(crate) fn start<R: BufRead>(lines: &mut Lines<R>) -> Result<(Head, Scene, String), Unreadable> {
    let (head, mut scene) = (head(lines)?, Scene::new());
    loop {
        let text = lines.next()?.ok_or_else(|| lines.bad("the tail is missing"))?;
        let line = lines.whole(Json::parse(&text))?;
        if !lines.whole(scene.line(&line))? {
            lines.whole(rules::of_scene(&head, &scene))?;
            return Ok((head, scene, text));
        }
        lines.count();
    }
}

/// Checks a line after the scene by the rules, after some legs; returns the leg that it states.
pub(crate) fn after(
    head: &Head,
    scene: &Scene,
    legs: usize,
    before: Option<&Leg>,
    line: &Json,
) -> Result<Option<Leg>, Stop> {
    match line.kind() {
        "leg" => {
            let leg = Leg::read(line)?;
            rules::of_leg(head, scene, before, &leg)?;
            Ok(Some(leg))
        }
        kind if EVIDENCE.contains(&kind) => rules::of_line(head, scene, legs, kind).map(|()| None),
        _ => Stop::bad("unknown kind of a line, or a line out of order"),
    }
}

/// Reads scene and legs of a receipt; its evidence is not evaluated.
pub(crate) fn scene(reader: impl BufRead) -> Result<(Scene, Vec<Leg>), Unreadable> {
    let mut lines = Lines::new(reader);
    let (head, scene, first) = start(&mut lines)?;
    let (mut legs, mut text) = (Vec::new(), Some(first));
    while let Some(now) = text {
        let line = lines.whole(Json::parse(&now))?;
        if line.kind() == "end" {
            return match tail(&mut lines, &line)? {
                true => Ok((scene, legs)),
                false => Err(lines.bad("the hash is not that of the lines")),
            };
        }
        legs.extend(lines.whole(after(&head, &scene, legs.len(), legs.last(), &line))?);
        lines.count();
        text = lines.next()?;
    }
    Err(lines.bad("the tail is missing"))
}
