//! Feature `serde`: the complete state of a scene, so that a restored scene continues as if it was
//! never interrupted. All input is checked, so no text can produce a scene that panics. All answers
//! are proven again ([`reprove`](super::reprove)).

use alloc::collections::BTreeMap;
use alloc::string::String;
use alloc::vec::Vec;

use nalgebra::Isometry3;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use super::answers::{StoredAnswer, StoredContact};
use super::body::{Body, BodySolid, BodyTable};
use super::budget::Travel;
use super::check::census_of;
use super::filter::Excluded;
use super::motion::{Moving, Sweep, Ticks};
use super::pair_engine::{PairEngine, restored, stored};
use super::pair_table::{DetailTables, PairHeader, PairTable, PairTables};
use super::queries::{GROUPS, Group, PairQueries, Table};
use super::report::Report;
use super::{Event, PairImpact, Scene, Settings};
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::body::polyhedron::BoxHint;
use crate::broad::slots::Slots;
use crate::broad::{self, SweepAndPrune};
use crate::convex::tracker::Tracker;
use crate::convex::tracker::Workspace;
use crate::pair::outcome::{Distance, Outcome};
use crate::pair_tracker::StoredEngine;
use crate::pair_tracker::geometry::Geometry;

/// The values of one index in the tables of bodies.
#[derive(Serialize, Deserialize)]
struct SnapshotRow {
    generation: u32,
    /// `None` if the index has no body, not even one that is being removed.
    solid: Option<SolidRow>,
    pose: Isometry3<f64>,
    travel: Travel,
    hint: BoxHint,
    #[serde(rename = "housed")]
    proxy: broad::BodyId,
}

#[derive(Serialize, Deserialize)]
struct SolidRow {
    shape: usize,
    group: Group,
    fixed: bool,
    boxed: bool,
    user_data: u64,
}

/// Pairs of a table, row by row.
type PairRows<T, A> = Vec<(PairHeader, T, A)>;

/// The tables of one type of tracker.
#[derive(Serialize, Deserialize)]
struct TableRows<T> {
    predicates: PairRows<T, ()>,
    distances: PairRows<T, Distance>,
    features: PairRows<T, Outcome>,
    contacts: PairRows<T, StoredContact>,
}

/// The serialized form of a scene.
#[derive(Serialize, Deserialize)]
struct SceneSnapshot {
    settings: Settings,
    /// Distinct geometries, in the order of the bodies.
    shapes: Vec<Geometry>,
    rows: Vec<SnapshotRow>,
    free: Vec<u32>,
    leaving: Vec<u32>,
    #[serde(rename = "owners")]
    body_of_proxy: Vec<u32>,
    moving: Vec<Moving>,
    sweeps: Vec<(u32, Sweep)>,
    wide: Vec<u32>,
    ticks: Ticks,
    due: Vec<u32>,
    #[serde(default)]
    stale: Vec<u32>,
    step: u32,
    queries: Vec<(Group, Group, PairQueries)>,
    /// Growths by group; infinity is written as the largest number.
    growths: Vec<f64>,
    partners: [u32; GROUPS],
    broad: SweepAndPrune,
    /// Excluded pairs by the indices of the bodies, the lower index first.
    #[serde(rename = "ignored")]
    excluded: Vec<(u32, u32)>,
    polyhedra: TableRows<Tracker>,
    mixed: TableRows<StoredEngine>,
    /// Slots whose box event was sent.
    #[serde(rename = "told")]
    box_event_sent: Vec<u32>,
    events: Vec<Event>,
    impacts: Vec<PairImpact>,
    report: Report,
    replanned: u32,
    changed: bool,
    budget: bool,
    schedule: bool,
}

fn pair_rows<T: PairEngine, A: StoredAnswer, S>(
    pair_table: &PairTable<T, A>,
    stored: &impl Fn(&T) -> S,
) -> PairRows<S, A> {
    let pairs = pair_table
        .headers
        .iter()
        .zip(&pair_table.trackers)
        .zip(&pair_table.answers);
    let pair_row = |((header, tracker), answer): ((&PairHeader, &T), &A)| {
        // A scene that was read may keep an answer that it does not give before the next step.
        let answer = if header.state.measured || !header.state.known {
            answer.clone()
        } else {
            A::blank()
        };
        (*header, stored(tracker), answer)
    };
    pairs.map(pair_row).collect()
}

fn table_rows<T: PairEngine, S>(tables: &DetailTables<T>, stored: impl Fn(&T) -> S) -> TableRows<S> {
    TableRows {
        predicates: pair_rows(&tables.predicates, &stored),
        distances: pair_rows(&tables.distances, &stored),
        features: pair_rows(&tables.features, &stored),
        contacts: pair_rows(&tables.contacts, &stored),
    }
}

/// Rebuilds a table; `restore` returns `None` for a tracker that does not belong to the pair.
fn pair_table<S, T: PairEngine, A>(
    pair_rows: PairRows<S, A>,
    restore: &impl Fn(&PairHeader, S) -> Option<T>,
) -> Result<PairTable<T, A>, String> {
    let mut pair_table = PairTable::default();
    for (header, stored, answer) in pair_rows {
        let tracker = restore(&header, stored).ok_or("a tracker of the scene follows no pair of its kind")?;
        pair_table.headers.push(header);
        pair_table.trackers.push(tracker);
        pair_table.answers.push(answer);
    }
    Ok(pair_table)
}

fn detail_tables<S, T: PairEngine>(
    rows: TableRows<S>,
    restore: impl Fn(&PairHeader, S) -> Option<T>,
) -> Result<DetailTables<T>, String> {
    Ok(DetailTables {
        predicates: pair_table(rows.predicates, &restore)?,
        distances: pair_table(rows.distances, &restore)?,
        features: pair_table(rows.features, &restore)?,
        contacts: pair_table(rows.contacts, &restore)?,
    })
}

impl SceneSnapshot {
    fn of(scene: &Scene) -> Self {
        let bodies = &scene.bodies;
        let mut shapes = Vec::new();
        let mut known = BTreeMap::new();
        let mut number = |shape: &Geometry| {
            *known.entry(shape.address()).or_insert_with(|| {
                shapes.push(shape.clone());
                shapes.len() - 1
            })
        };
        let generations = bodies.slots.generations();
        let [free, leaving] = bodies.slots.vacancies().each(Vec::clone);
        let mut row = |i: usize| SnapshotRow {
            generation: generations[i],
            solid: bodies.solids[i].as_ref().map(|s| SolidRow {
                shape: number(&s.shape),
                group: s.group,
                fixed: s.fixed,
                boxed: s.boxed,
                user_data: s.user_data,
            }),
            pose: bodies.poses[i],
            travel: bodies.travels[i],
            hint: bodies.hints[i],
            proxy: bodies.proxies[i],
        };
        let rows = (0..generations.len()).map(&mut row).collect();
        let swept = bodies
            .swept
            .iter()
            .filter_map(|&i| Some((i, bodies.sweeps[i as usize]?)));
        Self {
            settings: scene.settings,
            shapes,
            rows,
            free,
            leaving,
            body_of_proxy: bodies.body_of_proxy.clone(),
            moving: bodies.moving.clone(),
            sweeps: swept.collect(),
            wide: bodies.wide.clone(),
            ticks: bodies.ticks,
            due: bodies.due.clone(),
            stale: bodies.stale.clone(),
            step: bodies.step,
            queries: scene.table.entries().collect(),
            growths: scene.growths.iter().map(|g| g.at_most(f64::MAX)).collect(),
            partners: scene.partners,
            broad: scene.broad.clone(),
            excluded: scene.excluded.iter().collect(),
            polyhedra: table_rows(&scene.pair_tables.polyhedra, Tracker::clone),
            mixed: table_rows(&scene.pair_tables.mixed, |pair| stored(pair)),
            box_event_sent: scene.pair_tables.slots_with_box_event().collect(),
            events: scene.events.clone(),
            impacts: scene.impacts.clone(),
            report: scene.report,
            replanned: scene.replanned,
            changed: scene.changed,
            budget: scene.budget,
            schedule: scene.schedule,
        }
    }

    fn restored(self) -> Result<Scene, String> {
        let mut table = Table::default();
        for (g, h, queries) in &self.queries {
            table.set_queries(*g, *h, *queries).map_err(|e| alloc::format!("{e}"))?;
        }
        let growth = |g: f64| if g == f64::MAX { f64::INFINITY } else { g };
        let growths: Vec<f64> = self.growths.into_iter().map(growth).collect();
        let growths: [f64; GROUPS] = growths.try_into().map_err(|_| "a scene has 32 groups")?;
        let shapes = self.shapes;
        let lists = [self.free, self.leaving, self.body_of_proxy, self.due, self.stale];
        let motions = (self.moving, self.sweeps, self.wide, self.ticks);
        let bodies = restored_bodies(self.rows, &shapes, lists, motions, self.step)?;
        let excluded = restored_filter(&self.excluded, &bodies)?;
        let slots = self.broad.pairs().map(|p| p.id.slot as usize + 1).max().unwrap_or(0);
        let shapes_of = |header: &PairHeader| {
            let shape = |i: u32| bodies.solids.get(i as usize)?.as_ref().map(|s| &s.shape);
            shape(header.a).zip(shape(header.b))
        };
        let polyhedra = detail_tables(self.polyhedra, |header, tracker: Tracker| {
            let (a, b) = shapes_of(header)?;
            Tracker::shapes(a, b).map(|_| tracker)
        })?;
        let mixed = detail_tables(self.mixed, |header, engine: StoredEngine| {
            let (a, b) = shapes_of(header)?;
            restored(engine, a, b)
        })?;
        let pair_tables = PairTables::restored(polyhedra, mixed, &self.box_event_sent, slots);
        let pair_tables = pair_tables.ok_or("two pairs of the scene sit in one seat")?;
        let census = census_of(&bodies, &table)?;
        let mut scene = Scene {
            bodies,
            census,
            table,
            broad: self.broad,
            pair_tables,
            excluded,
            events: self.events,
            impacts: self.impacts,
            report: self.report,
            fixed_left_out: 0,
            replanned: self.replanned,
            changed: self.changed,
            growths,
            partners: self.partners,
            budget: self.budget,
            schedule: self.schedule,
            settings: self.settings,
            batch: Vec::new(),
            workspace: Workspace::default(),
        };
        scene.check_tables()?;
        scene.fixed_left_out = scene.count_fixed_left_out();
        #[cfg(feature = "meshes")]
        let mut scene = scene.with_patches();
        scene.reprove();
        Ok(scene)
    }
}

/// Returns the list of excluded pairs, if every pair names two bodies.
fn restored_filter(pairs: &[(u32, u32)], bodies: &BodyTable) -> Result<Excluded, String> {
    let lives = |i: u32| bodies.slots.lives(i);
    let mut excluded = Excluded::default();
    for &(a, b) in pairs {
        if !(a < b && lives(a) && lives(b) && excluded.set(a, b, true)) {
            return Err("a pair that the scene excludes is not of two bodies".into());
        }
    }
    Ok(excluded)
}

/// Motions of the bodies, swept motions of the step being prepared, bodies with enlarged boxes, and
/// ticks.
type Motions = (Vec<Moving>, Vec<(u32, Sweep)>, Vec<u32>, Ticks);

/// Returns the tables of bodies, if every list names valid bodies.
fn restored_bodies(
    rows: Vec<SnapshotRow>,
    shapes: &[Geometry],
    [free, leaving, body_of_proxy, due, stale]: [Vec<u32>; 5],
    (moving, sweeps, wide, ticks): Motions,
    step: u32,
) -> Result<BodyTable, String> {
    let n = rows.len();
    let generations = rows.iter().map(|row| row.generation).collect();
    let slots = Slots::restored(generations, free, leaving);
    let slots = slots.ok_or("the lists of removed bodies contradict the scene")?;
    let known = |i: &u32| *i == u32::MAX || (*i as usize) < n;
    let here = |i: &u32| (*i as usize) < n;
    let swept: Vec<u32> = sweeps.iter().map(|(i, _)| *i).collect();
    let are_here = due.iter().chain(&stale).chain(&wide).chain(&swept).all(here);
    if !body_of_proxy.iter().all(known) || !are_here {
        return Err("a list of the scene names a body that is not there".into());
    }
    let mut table = alloc::vec![None; if sweeps.is_empty() { 0 } else { n }];
    for (i, sweep) in sweeps {
        table[i as usize] = Some(sweep);
    }
    let mut bodies = BodyTable {
        slots,
        body_of_proxy,
        moving,
        sweeps: table,
        swept,
        wide,
        ticks,
        due,
        stale,
        step,
        ..BodyTable::default()
    };
    for row in rows {
        let solid = match &row.solid {
            Some(s) => {
                let shape = shapes.get(s.shape).ok_or("a body of the scene has no shape")?;
                let mut body = Body::moving(shape.clone()).group(s.group).user_data(s.user_data);
                body.fixed = s.fixed;
                let mut solid = BodySolid::new(body).map_err(|e| alloc::format!("{e}"))?;
                solid.boxed = s.boxed;
                Some(solid)
            }
            None => None,
        };
        bodies.restore(solid, row.pose, row.travel, row.hint, row.proxy);
    }
    Ok(bodies)
}

impl Serialize for Scene {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        SceneSnapshot::of(self).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Scene {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        SceneSnapshot::deserialize(deserializer)?
            .restored()
            .map_err(D::Error::custom)
    }
}
