//! Draws the columns, the sweep and the pairs of a small scene: `cargo run --example pencils -- pencils.svg`.
//!
//! Above: the columns seen from the side, shaded by how many bodies they list, and the pairs. Below: the busiest column,
//! its boxes in sorted order, each from start to end; pairs are joined by lines.

use lab::boxes::{Kind, Scene};
use lin_canny::broad::{Body, BodyId, BroadPhase, Pencil, PencilSweep, StoredBox};
use std::fmt::Write as _;

const SCALE: f32 = 9.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::new(Kind::Floor, 1200);
    let mut broad = PencilSweep::new();
    let ids = scene
        .boxes
        .iter()
        .map(|b| broad.insert(b, Body::moving()))
        .collect::<Result<Vec<_>, _>>()?;
    for _ in 0..20 {
        broad.step();
        scene.step();
        let batch: Vec<_> = ids.iter().copied().zip(scene.boxes.iter().copied()).collect();
        broad.set_boxes(&batch)?;
    }
    broad.step();
    let file = std::env::args().nth(1).unwrap_or_else(|| "pencils.svg".into());
    std::fs::write(&file, picture(&broad))?;
    println!(
        "{} bodies in {} columns, {} pairs: {file}",
        ids.len(),
        broad.pencils().count(),
        broad.pair_count()
    );
    Ok(())
}

fn picture(broad: &PencilSweep) -> String {
    let pencils: Vec<Pencil> = broad.pencils().collect();
    let boxes: Vec<(BodyId, StoredBox)> = broad
        .bodies()
        .filter_map(|id| Some((id, broad.stored_box(id)?)))
        .collect();
    let axis = pencils.first().map_or(0, |p| p.swept_axis);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut svg = String::new();
    let label = |k: usize| ["x", "y", "z"][k];

    // The picture shows the swept axis to the right and the first of the others upward.
    let of = |pick: &dyn Fn(&StoredBox) -> f32, least: bool| {
        let values = boxes.iter().map(|(_, b)| pick(b));
        if least {
            values.fold(f32::MAX, f32::min)
        } else {
            values.fold(f32::MIN, f32::max)
        }
    };
    let (left, right) = (of(&|b| b.lo[axis], true), of(&|b| b.hi[axis], false));
    let (low, high) = (of(&|b| b.lo[u], true), of(&|b| b.hi[u], false));
    let (wide, tall) = ((right - left) * SCALE, (high - low) * SCALE);
    let x = |value: f32| 20.0 + (value - left) * SCALE;
    let y = |value: f32| 50.0 + (high - value) * SCALE;

    let busiest = pencils.iter().map(|p| p.listed).max().unwrap_or(1) as f32;
    for p in &pencils {
        let (top, bottom) = (p.hi[0].min(high), p.lo[0].max(low));
        let shade = 250.0 - 60.0 * p.listed as f32 / busiest;
        let (height, width) = ((top - bottom).max(0.0) * SCALE, wide);
        let _ = writeln!(
            svg,
            r##"<rect x="20" y="{:.1}" width="{width:.1}" height="{height:.1}" fill="rgb({shade:.0},{shade:.0},255)" stroke="#88a" stroke-dasharray="4 3"/>"##,
            y(top)
        );
        // One at the border may be too narrow for its words.
        if height < 12.0 {
            continue;
        }
        let _ = writeln!(
            svg,
            r##"<text x="{:.1}" y="{:.1}" font-size="11" fill="#448">{} listed</text>"##,
            24.0 + wide,
            y(top) + 14.0,
            p.listed
        );
    }
    for (_, b) in &boxes {
        let (width, height) = ((b.hi[axis] - b.lo[axis]) * SCALE, (b.hi[u] - b.lo[u]) * SCALE);
        let _ = writeln!(
            svg,
            r##"<rect x="{:.1}" y="{:.1}" width="{width:.1}" height="{height:.1}" fill="#fff8" stroke="#333"/>"##,
            x(b.lo[axis]),
            y(b.hi[u])
        );
    }
    for pair in broad.pairs() {
        let at = |id: BodyId| {
            let b = broad.stored_box(id)?;
            Some((x(0.5 * (b.lo[axis] + b.hi[axis])), y(0.5 * (b.lo[u] + b.hi[u]))))
        };
        if let (Some((x1, y1)), Some((x2, y2))) = (at(pair.a), at(pair.b)) {
            let _ = writeln!(
                svg,
                r##"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="#d22" stroke-width="2"/>"##
            );
        }
    }
    let below = sweep(broad, &pencils, &boxes, (axis, u, v), 80.0 + tall, &x, &mut svg);
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{:.0}" height="{below:.0}" font-family="sans-serif">
<rect width="100%" height="100%" fill="white"/>
<text x="20" y="20" font-size="14">columns along {} (dashed, darker: more bodies); red: the {} pairs</text>
<text x="20" y="38" font-size="11" fill="#448">{} to the right, {} upward</text>
{svg}</svg>
"##,
        wide + 110.0,
        label(axis),
        broad.pair_count(),
        label(axis),
        label(u)
    )
}

/// The busiest column: its boxes as intervals in sorted order, with a bar for each entry a window looks at.
fn sweep(
    broad: &PencilSweep,
    pencils: &[Pencil],
    boxes: &[(BodyId, StoredBox)],
    (axis, u, v): (usize, usize, usize),
    top: f32,
    x: &dyn Fn(f32) -> f32,
    svg: &mut String,
) -> f32 {
    let Some(p) = pencils.iter().max_by_key(|p| p.listed) else {
        return top;
    };
    let touches = |b: &StoredBox| {
        let (lo, hi) = ([b.lo[u], b.lo[v]], [b.hi[u], b.hi[v]]);
        (0..2).all(|k| lo[k] < p.hi[k] && p.lo[k] <= hi[k])
    };
    let mut entries: Vec<_> = boxes.iter().filter(|(_, b)| touches(b)).collect();
    entries.sort_by(|(i, a), (j, b)| a.lo[axis].total_cmp(&b.lo[axis]).then(i.cmp(j)));
    let _ = writeln!(
        svg,
        r##"<text x="20" y="{:.1}" font-size="14">the sweep of the busiest column: its boxes by their start, from above</text>
<text x="20" y="{:.1}" font-size="11" fill="#448">each is compared with those that start before it ends (thin lines); red: a pair</text>"##,
        top,
        top + 18.0
    );
    let top = top + 34.0;
    for (row, (id, b)) in entries.iter().enumerate() {
        let y = top + 8.0 * row as f32;
        let (start, end) = (x(b.lo[axis]), x(b.hi[axis]));
        let _ = writeln!(
            svg,
            r##"<line x1="{start:.1}" y1="{y:.1}" x2="{end:.1}" y2="{y:.1}" stroke="#333" stroke-width="3"/>"##
        );
        for (below, (other, o)) in entries.iter().enumerate().skip(row + 1) {
            if o.lo[axis] > b.hi[axis] {
                break;
            }
            let color = if broad.pair(*id, *other).is_some() {
                "#d22"
            } else {
                "#bbb"
            };
            let (at, to) = (x(o.lo[axis]), top + 8.0 * below as f32);
            let _ = writeln!(
                svg,
                r##"<line x1="{at:.1}" y1="{y:.1}" x2="{at:.1}" y2="{to:.1}" stroke="{color}" stroke-width="1"/>"##
            );
        }
    }
    top + 8.0 * entries.len() as f32 + 20.0
}
