//! Draws the columns, the sweep and the pairs of a small scene.
//!
//! `cargo run --release -p race --example columns` draws two pictures, one above the other:
//!
//! - Above: the columns seen from the side, shaded by the number of bodies they list, and the
//!   pairs.
//! - Below: the busiest column, with its boxes in sorted order, each from start to end. Lines join
//!   the boxes of a pair.

use clap::Parser;
use lin_canny::broad::{BodyId, BodyOptions, ColumnBounds, StoredBox, SweepAndPrune};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use truth::boxes::{Kind, Scene};
use truth::command::{file, write};

const SCALE: f32 = 9.0;

/// Draw the columns of the broad phase, the sweep of the busiest column and the pairs of a small
/// scene
#[derive(Parser)]
struct Options {
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/columns.svg", value_parser = file("svg"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(|o: &Options| run(&o.out))
}

fn run(out: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = Scene::new(Kind::Floor, 1200);
    let mut broad = SweepAndPrune::new();
    let ids = scene
        .boxes
        .iter()
        .map(|b| broad.insert(b, BodyOptions::moving()))
        .collect::<Result<Vec<_>, _>>()?;
    for _ in 0..20 {
        broad.step();
        scene.step();
        let batch: Vec<_> = ids.iter().copied().zip(scene.boxes.iter().copied()).collect();
        broad.set_boxes(&batch)?;
    }
    broad.step();
    write(out, &picture(&broad))?;
    println!(
        "{} bodies in {} columns, {} pairs: {}",
        ids.len(),
        broad.columns().count(),
        broad.pair_count(),
        out.display()
    );
    Ok(())
}

fn picture(broad: &SweepAndPrune) -> String {
    let view = View::new(broad);
    let mut svg = String::new();
    view.columns(&mut svg);
    view.bodies(&mut svg);
    view.pairs(&mut svg);
    let below = view.sweep(80.0 + view.tall(), &mut svg);
    let label = |k: usize| ["x", "y", "z"][k];
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{:.0}" height="{below:.0}" font-family="sans-serif">
<rect width="100%" height="100%" fill="white"/>
<text x="20" y="20" font-size="14">columns along {} (dashed, darker: more bodies); red: the {} pairs</text>
<text x="20" y="38" font-size="11" fill="#448">{} to the right, {} upward</text>
{svg}</svg>
"##,
        view.wide() + 110.0,
        label(view.axis),
        broad.pair_count(),
        label(view.axis),
        label(view.up)
    )
}

/// A broad phase seen from the side: the swept axis to the right, the next axis upward.
struct View<'a> {
    broad: &'a SweepAndPrune,
    columns: Vec<ColumnBounds>,
    boxes: Vec<(BodyId, StoredBox)>,
    axis: usize,
    up: usize,
    /// Least and greatest coordinates of the boxes, along both axes.
    across: [f32; 2],
    height: [f32; 2],
}

impl<'a> View<'a> {
    fn new(broad: &'a SweepAndPrune) -> Self {
        let columns: Vec<ColumnBounds> = broad.columns().collect();
        let stored = broad.bodies().filter_map(|id| Some((id, broad.stored_box(id)?)));
        let boxes: Vec<(BodyId, StoredBox)> = stored.collect();
        let axis = columns.first().map_or(0, |p| p.swept_axis);
        let up = (axis + 1) % 3;
        let span = |k: usize| {
            let least = boxes.iter().map(|(_, b)| b.lo[k]).fold(f32::MAX, f32::min);
            let most = boxes.iter().map(|(_, b)| b.hi[k]).fold(f32::MIN, f32::max);
            [least, most]
        };
        Self {
            broad,
            axis,
            up,
            across: span(axis),
            height: span(up),
            columns,
            boxes,
        }
    }

    fn wide(&self) -> f32 {
        (self.across[1] - self.across[0]) * SCALE
    }

    fn tall(&self) -> f32 {
        (self.height[1] - self.height[0]) * SCALE
    }

    fn x(&self, value: f32) -> f32 {
        20.0 + (value - self.across[0]) * SCALE
    }

    fn y(&self, value: f32) -> f32 {
        50.0 + (self.height[1] - value) * SCALE
    }

    fn columns(&self, svg: &mut String) {
        let busiest = self.columns.iter().map(|p| p.listed).max().unwrap_or(1) as f32;
        for p in &self.columns {
            let (top, bottom) = (p.hi[0].min(self.height[1]), p.lo[0].max(self.height[0]));
            let shade = 250.0 - 60.0 * p.listed as f32 / busiest;
            let (height, width) = ((top - bottom).max(0.0) * SCALE, self.wide());
            let _ = writeln!(
                svg,
                r##"<rect x="20" y="{:.1}" width="{width:.1}" height="{height:.1}" fill="rgb({shade:.0},{shade:.0},255)" stroke="#88a" stroke-dasharray="4 3"/>"##,
                self.y(top)
            );
            // A column at the border may be too narrow for its label.
            if height < 12.0 {
                continue;
            }
            let _ = writeln!(
                svg,
                r##"<text x="{:.1}" y="{:.1}" font-size="11" fill="#448">{} listed</text>"##,
                24.0 + width,
                self.y(top) + 14.0,
                p.listed
            );
        }
    }

    fn bodies(&self, svg: &mut String) {
        for (_, b) in &self.boxes {
            let size = |k: usize| (b.hi[k] - b.lo[k]) * SCALE;
            let _ = writeln!(
                svg,
                r##"<rect x="{:.1}" y="{:.1}" width="{:.1}" height="{:.1}" fill="#fff8" stroke="#333"/>"##,
                self.x(b.lo[self.axis]),
                self.y(b.hi[self.up]),
                size(self.axis),
                size(self.up)
            );
        }
    }

    fn pairs(&self, svg: &mut String) {
        let middle = |b: &StoredBox, k: usize| 0.5 * (b.lo[k] + b.hi[k]);
        for pair in self.broad.pairs() {
            let at = |id: BodyId| {
                let b = self.broad.stored_box(id)?;
                Some((self.x(middle(&b, self.axis)), self.y(middle(&b, self.up))))
            };
            if let (Some((x1, y1)), Some((x2, y2))) = (at(pair.a), at(pair.b)) {
                let _ = writeln!(
                    svg,
                    r##"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="#d22" stroke-width="2"/>"##
                );
            }
        }
    }

    /// Draws the busiest column: its boxes as intervals in sorted order, with a bar for each entry
    /// that the sweep compares. Returns the y coordinate of its lower end.
    fn sweep(&self, top: f32, svg: &mut String) -> f32 {
        let Some(p) = self.columns.iter().max_by_key(|p| p.listed) else {
            return top;
        };
        let across = [self.up, (self.axis + 2) % 3];
        let touches = |b: &StoredBox| (0..2).all(|k| b.lo[across[k]] < p.hi[k] && p.lo[k] <= b.hi[across[k]]);
        let mut entries: Vec<_> = self.boxes.iter().filter(|(_, b)| touches(b)).collect();
        entries.sort_by(|(i, a), (j, b)| a.lo[self.axis].total_cmp(&b.lo[self.axis]).then(i.cmp(j)));
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
            let (start, end) = (self.x(b.lo[self.axis]), self.x(b.hi[self.axis]));
            let _ = writeln!(
                svg,
                r##"<line x1="{start:.1}" y1="{y:.1}" x2="{end:.1}" y2="{y:.1}" stroke="#333" stroke-width="3"/>"##
            );
            let window = entries.iter().enumerate().skip(row + 1);
            for (below, (other, o)) in window.take_while(|(_, (_, o))| o.lo[self.axis] <= b.hi[self.axis]) {
                let is_pair = self.broad.pair(*id, *other).is_some();
                let color = if is_pair { "#d22" } else { "#bbb" };
                let (at, to) = (self.x(o.lo[self.axis]), top + 8.0 * below as f32);
                let _ = writeln!(
                    svg,
                    r##"<line x1="{at:.1}" y1="{y:.1}" x2="{at:.1}" y2="{to:.1}" stroke="{color}" stroke-width="1"/>"##
                );
            }
        }
        top + 8.0 * entries.len() as f32 + 20.0
    }
}
