//! Which pairs of geoms MuJoCo checks: bits, excluded bodies, explicit pairs, adjacent bodies.

use std::collections::{HashMap, HashSet};

use super::bodies::Model;
use crate::error::{FileError, FileErrorKind, Place, Skipped};
use crate::robot::Robot;
use crate::xml::check_excluded;
use lin_canny_plan::nearest_name as nearest;

/// Sets the adjacent and the excluded pairs of a robot, whose root element is at a place.
pub(super) fn set(robot: &mut Robot, model: &Model, adjacent: bool, place: &Place) -> Result<(), FileError> {
    let links: HashMap<&str, usize> = robot
        .model
        .links
        .iter()
        .enumerate()
        .map(|(k, l)| (l.name.as_str(), k))
        .collect();
    // The index of the first body of each link, and for each body of the robot its geom.
    let mut first = Vec::new();
    let mut count = 0;
    for link in &robot.model.links {
        first.push(count);
        count += link.bodies.len();
    }
    let mut geom_of = vec![0; count];
    let mut body_of = HashMap::new();
    for (k, geom) in model.geoms.iter().enumerate() {
        let body = first[links[model.links[geom.link].name.as_str()]] + geom.body;
        geom_of[body] = k;
        if let Some(name) = &geom.name {
            body_of.insert(name.as_str(), body);
        }
    }
    let mut checked = HashSet::new();
    for (attached, pair) in model.contacts(|contacts| &contacts.pairs) {
        let end = |field: &str| {
            let name = attached.name(pair.needed(field)?);
            match body_of.get(name.as_str()) {
                None if attached.is_whole() => Err(pair.error(FileErrorKind::Unknown {
                    kind: "geom",
                    near: nearest(&name, body_of.keys().copied()),
                    name,
                })),
                body => Ok(body.copied()),
            }
        };
        let [Some(a), Some(b)] = [end("geom1")?, end("geom2")?] else {
            continue;
        };
        let is_rigid = [a, b].map(|body| model.groups[model.geoms[geom_of[body]].link]);
        if is_rigid[0] == is_rigid[1] {
            let what = "a pair of geoms that never move relative to each other".into();
            robot
                .skipped
                .push(Skipped::from(pair.error(FileErrorKind::Unsupported(what))));
        }
        checked.insert([a.min(b), a.max(b)]);
    }
    let mut apart = HashSet::new();
    for (attached, exclude) in model.contacts(|contacts| &contacts.excludes) {
        let end = |field: &str| {
            let name = match exclude.needed(field)? {
                "world" => "world".into(),
                name => attached.name(name),
            };
            match model.bodies.get(&name) {
                None if attached.is_whole() => Err(exclude.error(FileErrorKind::Unknown {
                    kind: "body",
                    near: nearest(&name, model.bodies.keys().map(String::as_str)),
                    name,
                })),
                link => Ok(link.copied()),
            }
        };
        let [Some(a), Some(b)] = [end("body1")?, end("body2")?] else {
            continue;
        };
        apart.insert([a.min(b), a.max(b)]);
    }
    let above = |group: usize| model.groups_above[group];
    let too_many = |pairs: usize| check_excluded(count, pairs).map_err(|reason| place.error(reason));
    // The links of the robot with bodies.
    let with_bodies: Vec<usize> = (0..first.len())
        .filter(|&k| !robot.model.links[k].bodies.is_empty())
        .collect();
    for (k, &x) in with_bodies.iter().enumerate() {
        for &y in &with_bodies[k + 1..] {
            let [one, other] = [x, y].map(|link| model.geoms[geom_of[first[link]]].link);
            let [p, q] = [one, other].map(|link| model.groups[link]);
            if p == q {
                continue;
            }
            let [xs, ys] = [x, y].map(|link| first[link]..first[link] + robot.model.links[link].bodies.len());
            // Of two bodies without joints above them, MuJoCo checks explicit pairs alone.
            let is_still = |group: usize| group == 0 || model.mocap.contains_key(&group);
            let is_apart =
                is_still(p) && is_still(q) || !apart.is_empty() && apart.contains(&[one.min(other), one.max(other)]);
            for a in xs {
                for b in ys.clone() {
                    let [one, other] = [a, b].map(|body| &model.geoms[geom_of[body]]);
                    let do_meet = one.kind & other.with != 0 || other.kind & one.with != 0;
                    if (!do_meet || is_apart) && !checked.contains(&[a, b]) {
                        robot.model.excluded.push([a, b]);
                    }
                }
                too_many(robot.model.excluded.len())?;
            }
            if adjacent && (above(p) == Some(q) && q != 0 || above(q) == Some(p) && p != 0) {
                robot.model.adjacent.push([x, y]);
            }
        }
    }
    // An explicit pair of adjacent links is checked, and the other pairs of these links are not.
    let link_of = |body: usize| links[model.links[model.geoms[geom_of[body]].link].name.as_str()];
    for &[a, b] in &checked {
        let pair = [link_of(a).min(link_of(b)), link_of(a).max(link_of(b))];
        let Ok(at) = robot.model.adjacent.binary_search(&pair) else {
            continue;
        };
        robot.model.adjacent.remove(at);
        for a in first[pair[0]]..first[pair[0]] + robot.model.links[pair[0]].bodies.len() {
            for b in first[pair[1]]..first[pair[1]] + robot.model.links[pair[1]].bodies.len() {
                let bodies = [a.min(b), a.max(b)];
                if !checked.contains(&bodies) {
                    robot.model.excluded.push(bodies);
                }
            }
            too_many(robot.model.excluded.len())?;
        }
    }
    robot.model.excluded.sort_unstable();
    robot.model.excluded.dedup();
    Ok(())
}
