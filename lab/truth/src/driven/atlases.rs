//! Stored atlases from arbitrary bytes: valid ones that are changed, and trees of boxes that are
//! drawn.
//!
//! The test `driven` and the target `atlases` of `fuzz/` share this module.

use std::ops::ControlFlow;
use std::sync::LazyLock;

use lin_canny_plan::{Atlas, AtlasBox, AtlasOptions, AtlasVerdict, Checker, JointTree, PlanError};
use serde_json::{Value, json};

use super::{Bytes, readers};
use crate::arm::chain::chain;

/// Joints of the arm whose atlases are changed.
const JOINTS: usize = 2;

/// Numbers of boxes of the atlases that are changed.
const SIZES: [u64; 4] = [0, 1, 12, 90];

/// Most changes of an atlas.
const CHANGES: usize = 6;

/// Most boxes that are looked at.
const BOXES: usize = 40;

/// Codes of boxes that are not halved: free, in contact, not searched, stuck.
const CODES: [i64; 4] = [-1, -2, -3, -4];

/// Atlases of the arm among posts, as JSON.
static SEEDS: LazyLock<Vec<Value>> = LazyLock::new(|| {
    let mut arm = arm();
    let seeds = SIZES.map(|boxes| arm.free_boxes(&AtlasOptions::default().boxes(boxes)));
    let json = |atlas: Result<Atlas, PlanError>| serde_json::to_value(atlas.expect("an atlas")).expect("JSON");
    seeds.map(json).into()
});

fn arm() -> Checker<JointTree> {
    let (space, world) = chain(JOINTS, [-3.0, 3.0]).expect("an arm");
    Checker::new(space, world).expect("a world")
}

/// Counts of the results.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Atlases read and rejected.
    pub read: [u32; 2],
    /// Atlases that were read, and belong to the arm.
    pub owned: u32,
    /// Boxes whose configurations were looked up.
    pub boxes: u32,
}

impl Tally {
    /// Adds the counts of another.
    pub fn add(&mut self, other: &Self) {
        self.read = [0, 1].map(|k| self.read[k] + other.read[k]);
        self.owned += other.owned;
        self.boxes += other.boxes;
    }
}

/// Makes the text of an atlas from the bytes and reads it.
///
/// # Panics
/// Panics if what was read is not written and read again as it was, if a lookup contradicts the
/// boxes, if a search cannot go on, or if time or memory are out of bounds.
pub fn drive(bytes: &[u8]) -> Tally {
    let (mut bytes, mut tally) = (Bytes(bytes), Tally::default());
    LazyLock::force(&SEEDS);
    let kind = bytes.byte();
    let mut value = SEEDS[usize::from(kind / 2) % SIZES.len()].clone();
    if kind.is_multiple_of(2) {
        drawn(&mut value, &mut bytes);
    }
    for _ in 0..CHANGES {
        if bytes.0.is_empty() {
            break;
        }
        change(&mut value, &mut bytes);
    }
    let mut text = value.to_string().into_bytes();
    // Few texts have letters that do not fit.
    if bytes.byte() % 16 == 1 {
        let at = usize::from(u16::from_le_bytes([bytes.byte(), bytes.byte()])) % text.len();
        text[at] = bytes.byte();
    }
    let text = String::from_utf8_lossy(&text);
    let Some(atlas) = readers::again::<Atlas>(&text) else {
        tally.read[1] += 1;
        return tally;
    };
    tally.read[0] += 1;
    tally.boxes += judge(&atlas);
    let mut arm = arm();
    if arm.set_atlas(atlas.clone()).is_ok() {
        tally.owned += 1;
        let options = AtlasOptions::default().boxes(5);
        let more = arm.resume_boxes(&atlas, &options, &mut |_| ControlFlow::Continue(()));
        let more = more.expect("the atlas of the arm");
        assert!(more.searched() >= atlas.searched());
        judge(&more);
    }
    tally
}

/// Checks that lookups say what the boxes say; returns the number of boxes.
///
/// # Panics
/// Panics if they do not, or if the shares are no shares.
pub(super) fn judge(atlas: &Atlas) -> u32 {
    let written = serde_json::to_string(atlas).expect("an atlas is written");
    assert!(serde_json::from_str::<Atlas>(&written).is_ok_and(|read| read == *atlas));
    let shares = atlas.shares();
    let all = [shares.free, shares.contact, shares.left];
    assert!(all.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
    let [low, high] = atlas.range();
    let boxes: Vec<AtlasBox> = atlas.boxes().take(BOXES).collect();
    for one in &boxes {
        let ends = || one.low.iter().zip(&one.high);
        assert!(ends().all(|(x, y)| x <= y), "{one:?}");
        assert!(one.low.iter().zip(low).all(|(x, y)| x >= y) && one.high.iter().zip(high).all(|(x, y)| x <= y));
        let middle: Vec<f64> = ends().map(|(x, y)| 0.5 * x + 0.5 * y).collect();
        // A point on a face belongs to other boxes as well.
        if ends().zip(&middle).all(|((x, y), m)| x < m && m < y) {
            assert_eq!(atlas.verdict_at(&middle), one.verdict, "{one:?}");
            assert_eq!(atlas.verdict_along(&middle, &middle), one.verdict, "{one:?}");
        }
        let along = atlas.verdict_along(&one.low, &one.high);
        if one.verdict == Some(AtlasVerdict::Free) {
            assert_ne!(atlas.verdict_at(&one.low), None, "{one:?}");
            assert_ne!(atlas.verdict_at(&one.high), None, "{one:?}");
        }
        if along == Some(AtlasVerdict::Free) {
            assert_eq!(atlas.verdict_at(&one.low), along, "{one:?}");
            assert_eq!(atlas.verdict_at(&one.high), along, "{one:?}");
        }
    }
    for pair in boxes.windows(2) {
        let _ = atlas.verdict_along(&pair[0].low, &pair[1].high);
    }
    boxes.len() as u32
}

/// Draws limits and a tree of boxes that fit each other, mostly.
fn drawn(value: &mut Value, bytes: &mut Bytes<'_>) {
    let count = usize::from(bytes.byte() % 5);
    if count > 0 {
        let ends = |bytes: &mut Bytes<'_>| {
            let (x, y) = (bytes.limit(), bytes.limit());
            if x <= y { [x, y] } else { [y, x] }
        };
        let limits: Vec<[f64; 2]> = (0..count).map(|_| ends(bytes)).collect();
        value["low"] = limits.iter().map(|ends| ends[0]).collect();
        value["high"] = limits.iter().map(|ends| ends[1]).collect();
    }
    let coordinates = if count > 0 { count } else { JOINTS };
    let (mut codes, mut open) = (Vec::<i64>::new(), 1_usize);
    for _ in 0..bytes.byte() {
        if codes.len() == open {
            break;
        }
        let code = match bytes.byte() {
            draw @ 0..100 => i64::from(draw) % coordinates as i64,
            draw => [-1, -2, -4][usize::from(draw) % 3],
        };
        open += if code >= 0 { 2 } else { 0 };
        codes.push(code);
    }
    let next = codes.len();
    codes.resize(open, CODES[2]);
    let sets = match next {
        0 => 1,
        _ => (open - 1) / 2 - (next - 1) / 2,
    };
    let all = value["waiting"][0].clone();
    let all = if all.is_null() { json!([1]) } else { all };
    value["boxes"] = codes.into();
    value["waiting"] = vec![all; sets].into();
}

/// Changes a field.
fn change(value: &mut Value, bytes: &mut Bytes<'_>) {
    let (kind, at, with) = (bytes.byte(), usize::from(bytes.byte()), bytes.byte());
    let list = |value: &mut Value, name: &str| value[name].as_array_mut().map(std::mem::take).unwrap_or_default();
    match kind % 16 {
        0..3 => replace(value, "boxes", at, json!(CODES[usize::from(with) % 4])),
        3 => replace(value, "boxes", at, json!(with as i8)),
        4 => {
            let mut boxes = list(value, "boxes");
            boxes.insert(at.min(boxes.len()), json!(with as i8));
            value["boxes"] = boxes.into();
        }
        5 => {
            let mut boxes = list(value, "boxes");
            boxes.truncate(at);
            value["boxes"] = boxes.into();
        }
        6 => replace(value, "low", at, json!(bytes.limit())),
        7 => replace(value, "high", at, json!(bytes.limit())),
        8 => replace(value, "waiting", at, json!([1_u64 << (with % 64)])),
        9 => {
            let mut sets = list(value, "waiting");
            sets.insert(at.min(sets.len()), json!([with]));
            value["waiting"] = sets.into();
        }
        10 => {
            let mut sets = list(value, "waiting");
            sets.truncate(at % 4);
            value["waiting"] = sets.into();
        }
        11 => {
            let mut pairs = list(value, "pairs");
            if !pairs.is_empty() {
                let (from, to) = (at % pairs.len(), usize::from(with) % pairs.len());
                match with % 3 {
                    0 => pairs.swap(from, to),
                    1 => drop(pairs.remove(from)),
                    _ => pairs[from].get_mut(1).map_or((), |second| *second = json!(with)),
                }
            }
            value["pairs"] = pairs.into();
        }
        12 => value["version"] = json!(with),
        13 => value["proofs"] = [json!(u64::MAX), json!(with), json!(-1), json!(0.5)][at % 4].clone(),
        14 => {
            if let Some(fields) = value.as_object_mut() {
                let name = fields.keys().nth(at % fields.len().max(1)).cloned();
                name.and_then(|name| fields.remove(&name));
            }
        }
        _ => replace(
            value,
            ["low", "high", "boxes", "waiting", "pairs"][at % 5],
            usize::from(with),
            Value::Null,
        ),
    }
}

/// Replaces an entry of a list.
fn replace(value: &mut Value, name: &str, at: usize, with: Value) {
    if let Some(list) = value[name].as_array_mut()
        && !list.is_empty()
    {
        let at = at % list.len();
        list[at] = with;
    }
}

impl Bytes<'_> {
    /// Returns the limit of a coordinate: a small number, mostly, or one at an end of the range.
    fn limit(&mut self) -> f64 {
        let whole = f64::from(self.byte() as i8) / 16.0;
        match self.byte() % 16 {
            0 => f64::MAX.copysign(whole),
            1 => f64::from_bits(u64::from(self.byte())).copysign(whole),
            2 => whole * 1e300,
            3 => (1.0 + whole).next_up(),
            4 => f64::MIN_POSITIVE * whole,
            _ => whole,
        }
    }
}
