//! The histogram and the map, as SVG.

use lin_canny_study::StudyError;
use plotters::prelude::*;

use super::tables::Tables;

const SIZE: (u32, u32) = (860, 420);

/// Draws the number of rows by clearance.
pub(super) fn histogram(tables: &Tables) -> Result<String, StudyError> {
    let most = tables.bars.iter().map(|b| b.1).fold(1.0, f64::max);
    let end = tables.greatest.max(tables.least + tables.width);
    drawn(SIZE, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(tables.least..end, 0.0..1.05 * most)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .x_desc("clearance, in the robot's unit of length; contact at and below 0")
            .y_desc("rows")
            .y_label_formatter(&|y| format!("{y:.0}"))
            .draw()?;
        chart.draw_series(tables.bars.iter().map(|&(start, count)| {
            let is_contact = start + 0.5 * tables.width <= 0.0;
            let colour = if is_contact {
                RGBColor(204, 51, 17)
            } else {
                RGBColor(0, 119, 187)
            };
            Rectangle::new([(start, 0.0), (start + tables.width, count)], colour.filled())
        }))?;
        Ok(())
    })
}

/// Draws the share of rows in contact, by two joints.
pub(super) fn map(tables: &Tables, names: [&str; 2], limits: [[f64; 2]; 2]) -> Result<String, StudyError> {
    let [[x0, x1], [y0, y1]] = limits;
    let cells = f64::from(Tables::CELLS);
    let (dx, dy) = ((x1 - x0) / cells, (y1 - y0) / cells);
    drawn((640, 560), |root| {
        let mut chart = ChartBuilder::on(root)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(x0..x1, y0..y1)?;
        chart.draw_series(tables.map.iter().map(|&(i, j, contacts)| {
            let (x, y) = (x0 + dx * f64::from(i), y0 + dy * f64::from(j));
            Rectangle::new([(x, y), (x + dx, y + dy)], shade(contacts).filled())
        }))?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(names[0])
            .y_desc(names[1])
            .draw()?;
        Ok(())
    })
}

/// Returns a colour from blue (no row in contact) over pale to red (all rows).
fn shade(contacts: f64) -> RGBColor {
    const ENDS: [[f64; 3]; 3] = [[0.0, 119.0, 187.0], [245.0, 245.0, 240.0], [204.0, 51.0, 17.0]];
    let place = 2.0 * contacts.clamp(0.0, 1.0);
    let (from, part) = if place < 1.0 { (0, place) } else { (1, place - 1.0) };
    let mix = |k: usize| (ENDS[from][k] + (ENDS[from + 1][k] - ENDS[from][k]) * part) as u8;
    RGBColor(mix(0), mix(1), mix(2))
}

type Drawing = Result<(), Box<dyn std::error::Error>>;
type Root<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn drawn(size: (u32, u32), draw: impl FnOnce(&Root<'_>) -> Drawing) -> Result<String, StudyError> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let failed = |e: String| StudyError::unfit("a chart", e);
        root.fill(&WHITE).map_err(|e| failed(e.to_string()))?;
        draw(&root).map_err(|e| failed(e.to_string()))?;
        root.present().map_err(|e| failed(e.to_string()))?;
    }
    Ok(svg)
}
