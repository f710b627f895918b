//! Any sequence of calls: no panic, both structures agree, and the pairs are those of brute force.

use lab::boxes::brute_force;
use lin_canny::broad::*;
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Call {
    Insert(Aabb, Body),
    InsertUnbounded(Aabb),
    Remove(usize),
    Set(usize, Aabb),
    Batch(Vec<(usize, Aabb)>),
    Groups(usize, Groups),
    Step,
}

/// Numbers that meet each other often, and those that break things.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        20 => (-40..40_i32).prop_map(|v| f64::from(v) * 0.25),
        5 => -10.0..10.0,
        1 => prop_oneof![
            Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(1e300), Just(-1e300), Just(1e30),
            Just(-0.0), Just(5e-324), Just(-1e-60), Just(3.4e38), Just(1e7)
        ],
    ]
}

fn any_box() -> impl Strategy<Value = Aabb> {
    let point = || (number(), number(), number()).prop_map(|(x, y, z)| Point3::new(x, y, z));
    prop_oneof![
        1 => (point(), point()).prop_map(|(a, b)| Aabb::new(a, b)),
        8 => (point(), 0.0..3.0, 0.0..3.0, 0.0..3.0).prop_map(|(p, x, y, z)| Aabb::new(p, p + Vector3::new(x, y, z))),
        1 => (point(), 0.0..100.0, 0.0..100.0).prop_map(|(p, y, z)| Aabb::new(p, p + Vector3::new(0.0, y, z))),
    ]
}

fn groups() -> impl Strategy<Value = Groups> {
    (0..4_u32, 0..4_u32).prop_map(|(member_of, pairs_with)| Groups { member_of, pairs_with })
}

fn body() -> impl Strategy<Value = Body> {
    (
        any::<bool>(),
        groups(),
        0..3_u8,
        prop_oneof![Just(0.0), 0.0..1.0, Just(f64::NAN)],
    )
        .prop_map(|(fixed, groups, kind, margin)| {
            let body = if fixed { Body::fixed() } else { Body::moving() };
            match kind {
                0 => body.groups(groups),
                1 => body.margin(margin).lookahead(2.0),
                _ => body,
            }
        })
}

fn call() -> impl Strategy<Value = Call> {
    let which = 0..60_usize;
    prop_oneof![
        6 => (any_box(), body()).prop_map(|(b, o)| Call::Insert(b, o)),
        1 => any_box().prop_map(Call::InsertUnbounded),
        2 => which.clone().prop_map(Call::Remove),
        6 => (which.clone(), any_box()).prop_map(|(k, b)| Call::Set(k, b)),
        1 => prop::collection::vec((which.clone(), any_box()), 0..20).prop_map(Call::Batch),
        1 => (which, groups()).prop_map(|(k, g)| Call::Groups(k, g)),
        4 => Just(Call::Step),
    ]
}

struct Fed {
    pencils: PencilSweep,
    axes: SortedAxes,
    ids: Vec<BodyId>,
}

impl Fed {
    fn id(&self, k: usize) -> BodyId {
        self.ids.get(k % self.ids.len().max(1)).copied().unwrap_or(BodyId {
            index: k as u32,
            generation: 1,
        })
    }

    fn run(&mut self, call: Call) {
        let (pencils, axes) = (&mut self.pencils, &mut self.axes);
        match call {
            Call::Insert(aabb, body) => {
                let id = pencils.insert(&aabb, body);
                assert_eq!(axes.insert(&aabb, body), id);
                self.ids.extend(id.ok());
            }
            Call::InsertUnbounded(aabb) => {
                let id = pencils.insert_unbounded(&aabb, Body::moving());
                assert_eq!(axes.insert_unbounded(&aabb, Body::moving()), id);
                self.ids.extend(id.ok());
            }
            Call::Remove(k) => {
                let id = self.id(k);
                assert_eq!(self.pencils.remove(id), self.axes.remove(id));
            }
            Call::Set(k, aabb) => {
                let id = self.id(k);
                let before = self.pencils.stored_box(id);
                let done = self.pencils.set_box(id, &aabb);
                assert_eq!(self.axes.set_box(id, &aabb), done);
                match done {
                    Err(_) => assert_eq!(self.pencils.stored_box(id), before),
                    Ok(()) => {
                        let given = StoredBox::outward(&aabb, &Point3::origin());
                        assert!(self.pencils.stored_box(id).unwrap().contains(&given));
                    }
                }
            }
            Call::Batch(batch) => {
                let batch: Vec<_> = batch.into_iter().map(|(k, aabb)| (self.id(k), aabb)).collect();
                assert_eq!(self.pencils.set_boxes(&batch), self.axes.set_boxes(&batch));
            }
            Call::Groups(k, groups) => {
                let id = self.id(k);
                assert_eq!(self.pencils.set_groups(id, groups), self.axes.set_groups(id, groups));
            }
            Call::Step => self.step(),
        }
    }

    fn step(&mut self) {
        let events = self.pencils.step();
        assert_eq!(self.axes.step(), events);
        assert!(self.pencils.pairs().eq(self.axes.pairs()));
        let ids: Vec<BodyId> = self.pencils.bodies().collect();
        let boxes: Vec<StoredBox> = ids.iter().map(|id| self.pencils.stored_box(*id).unwrap()).collect();
        let may = |a: BodyId, b: BodyId| {
            let [a, b] = [a, b].map(|id| self.pencils.body(id).unwrap());
            !(a.fixed && b.fixed) && a.groups.meet(b.groups)
        };
        let all = brute_force(&boxes, StoredBox::overlaps);
        let mut expected: Vec<_> = all
            .into_iter()
            .map(|(a, b)| (ids[a as usize], ids[b as usize]))
            .collect();
        expected.retain(|&(a, b)| may(a, b));
        let mut present: Vec<_> = self.pencils.pairs().map(|p| (p.a, p.b)).collect();
        present.sort_unstable();
        assert_eq!(present, expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
    #[test]
    fn any_calls(calls in prop::collection::vec(call(), 1..200)) {
        let mut both = Fed { pencils: PencilSweep::new(), axes: SortedAxes::new(), ids: Vec::new() };
        calls.into_iter().for_each(|call| both.run(call));
        both.step();
    }
}
