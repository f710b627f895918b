//! Promise: with the feature `tracing`, a subscriber receives events of solver fallbacks, spent
//! budgets and rejected input, and no others.
#![cfg(feature = "tracing")]

use std::fmt::{Debug, Write};
use std::sync::{Arc, Mutex};

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, Mesh, RelativePose, Tracker};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

#[derive(Clone, Default)]
struct Heard(Arc<Mutex<Vec<String>>>);

struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        write!(self.0, " {}={value:?}", field.name()).expect("text");
    }
}

impl Subscriber for Heard {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("lin_canny")
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, event: &Event<'_>) {
        let mut text = Text(event.metadata().level().to_string());
        event.record(&mut text);
        self.0.lock().expect("a lock").push(text.0);
    }

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// Returns the events that a subscriber receives while `call` runs.
fn heard(call: impl FnOnce()) -> Vec<String> {
    let heard = Heard::default();
    tracing::subscriber::with_default(heard.clone(), call);
    heard.0.lock().expect("a lock").clone()
}

#[test]
fn refused_input_is_heard() {
    let events = heard(|| {
        let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]].map(Point3::from);
        assert!(ConvexPolyhedron::from_points(&flat).is_err());
        assert!(ConvexPolyhedron::from_faces(&flat, &[[0, 1, 9]]).is_err());
        assert!(Mesh::new(&flat, &[[0, 1, 9]]).is_err());
        let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
        assert!(RelativePose::from_isometry(&nan).is_err());
    });
    for (event, words) in events.iter().zip(["a hull", "a body of faces", "a mesh", "a pose"]) {
        assert!(event.starts_with("WARN") && event.contains(words), "{event}");
    }
    assert_eq!(events.len(), 4, "{events:?}");
}

#[test]
fn a_solver_that_falls_back_is_heard_and_a_walk_is_not() {
    let cube = solids::cuboid(Vector3::repeat(0.5)).expect("a cube");
    let ask = |gap: f64| {
        let pose = RelativePose::from_isometry(&Isometry3::translation(1.0 + gap, 0.0, 0.0)).expect("a pose");
        heard(|| {
            Tracker::new().closest(&cube, &cube, &pose);
        })
    };
    assert_eq!(ask(0.5), Vec::<String>::new());
    let events = ask(0.0);
    assert!(events.len() == 1 && events[0].contains("exact"), "{events:?}");
}
