//! Promise: a scene reports what brute force over all pairs reports, on every frame.

mod assembly;
#[cfg(feature = "meshes")]
mod bending;
mod calls;
mod events;
mod impact_within;
mod lattice;
mod queries;
mod shapes;
mod surfaces;
mod threads;
mod time;

use lin_canny::scene::{BodyId, Change, Event, Group, PairQueries, Scene};
use std::collections::BTreeSet;

type Keys = BTreeSet<(BodyId, BodyId)>;

/// The default group of bodies.
const ALL: Group = Group::new(0).unwrap();
const NONE: PairQueries = PairQueries::none();

fn group(k: u8) -> Group {
    Group::new(k).expect("a group")
}

/// Returns the scene as read back from a file, if serialisation is enabled; otherwise a clone.
fn read_back(scene: &Scene) -> Scene {
    #[cfg(feature = "serde")]
    let read = serde_json::from_str(&serde_json::to_string(scene).unwrap()).unwrap();
    #[cfg(not(feature = "serde"))]
    let read = scene.clone();
    read
}

/// Pairs according to events, which must be new, in order and sufficient.
#[derive(Default)]
struct Replay {
    boxes: Keys,
    overlapping: Keys,
    within: Keys,
}

impl Replay {
    fn apply(&mut self, events: &[Event]) {
        assert!(events.is_sorted_by_key(|e| (e.a.index, e.b.index, e.change)));
        for e in events {
            assert!(e.a.index < e.b.index);
            let key = (e.a, e.b);
            let done = match e.change {
                Change::BoxesMet => self.boxes.insert(key),
                Change::BoxesParted => self.boxes.remove(&key),
                Change::OverlapBegan => self.overlapping.insert(key),
                Change::OverlapEnded => self.overlapping.remove(&key),
                Change::CameWithin => self.within.insert(key),
                _ => self.within.remove(&key),
            };
            assert!(done, "{e:?} twice");
        }
    }
}
