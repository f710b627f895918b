//! Head and tail of a receipt, and the scene and legs of another one.

use std::io::BufRead;

use crate::Stop;
use crate::cells::Cells;
use crate::cover::Apart;
use crate::json::Json;
use crate::lines::Lines;
use crate::report::Unreadable;
use crate::scene::{Leg, Motion, Scene, hash};

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
pub(crate) const EVIDENCE: [&str; 8] = ["plane", "balls", "outside", "cell", "meet", "near", "distance", "depth"];

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
pub(crate) fn head<R: BufRead>(lines: &mut Lines<R>) -> Result<Head, Unreadable> {
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
pub(crate) fn follows(scene: &Scene, before: Option<&Leg>, leg: &Leg) -> Result<(), Stop> {
    if scene.coordinates == 0 || leg.0[0].len() < scene.coordinates {
        return Stop::bad("a leg without a coordinate for each joint, or without joints");
    }
    let Some(before) = before else { return Ok(()) };
    if before.0.last() != leg.0.first() {
        return Stop::bad("a leg does not start where the one before ends");
    }
    // Its time would start again with the leg, and the body would jump back.
    if scene.bodies.iter().any(|b| matches!(b.motion, Motion::Steady(_))) {
        return Stop::bad("several legs, and a body that is steady");
    }
    Ok(())
}
