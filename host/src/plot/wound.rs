//! The wound along its length: its width and the step between its edges, at the beginning and at the end.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use sutura_controller::wound::Edges;

use super::{Error, FONT, INK, SIZE, fonts};
use crate::run::log::Log;

const BEFORE: RGBColor = RGBColor(120, 165, 225);
const AFTER: RGBColor = RGBColor(222, 110, 20);

/// What a panel shows [m].
type Quantity = fn(&Edges) -> f32;

/// Draws into a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn draw(path: &Path, log: &Log) -> Result<(), Error> {
    fonts()?;
    let root = BitMapBackend::new(path, SIZE).into_drawing_area();
    whole(&root, log).map_err(|cause| Error::Draw(cause.to_string()))
}

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn whole<DB: DrawingBackend>(root: &DrawingArea<DB, Shift>, log: &Log) -> Drawn<DB> {
    root.fill(&WHITE)?;
    let title = "The wound along its length, before the first stitch and at the end";
    let root = root.margin(16, 0, 0, 0);
    let root = root.titled(title, (FONT, 34).into_font().color(&INK))?;
    let (above, below) = root.split_vertically((55).percent_height());
    let panels: [(&str, Quantity); 2] = [
        ("gap [mm]", |edges| edges.gap),
        ("step, right edge higher [mm]", |edges| edges.step),
    ];
    for (area, (name, of)) in [above, below].iter().zip(panels) {
        panel(area, name, log, of)?;
    }
    root.present()
}

fn panel<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, name: &str, log: &Log, of: Quantity) -> Drawn<DB> {
    let profiles = log.wound.all();
    let curve = |rows: &[(f32, Edges)]| -> Vec<(f64, f64)> {
        rows.iter()
            .map(|(along, edges)| (f64::from(*along) * 1e3, f64::from(of(edges)) * 1e3))
            .collect()
    };
    let curves: Vec<_> = [
        (profiles.first(), "before", BEFORE),
        (profiles.last(), "at the end", AFTER),
    ]
    .into_iter()
    .filter_map(|(profile, name, colour)| Some((curve(&profile?.rows), name, colour)))
    .collect();
    let span = |part: fn(&(f64, f64)) -> f64, room: f64| {
        let values = curves.iter().flat_map(|(points, ..)| points).map(part);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        low - room..high + room
    };
    let mut chart = ChartBuilder::on(area)
        .margin(24)
        .x_label_area_size(64)
        .y_label_area_size(110)
        .build_cartesian_2d(span(|at| at.0, 1.0), span(|at| at.1, 0.25))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(INK.mix(0.1))
        .x_desc("along the wound [mm]")
        .y_desc(name)
        .label_style((FONT, 24).into_font().color(&INK))
        .axis_desc_style((FONT, 26).into_font().color(&INK))
        .draw()?;
    for (points, name, colour) in curves {
        let line = colour.stroke_width(4);
        chart
            .draw_series(LineSeries::new(points.iter().copied(), line))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 36, y)], line));
        chart.draw_series(points.iter().map(|at| Circle::new(*at, 6, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::MiddleRight)
        .legend_area_size(48)
        .label_font((FONT, 24).into_font().color(&INK))
        .background_style(WHITE.mix(0.85))
        .border_style(INK.mix(0.3))
        .draw()
}
