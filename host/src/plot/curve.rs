//! A stress–strain curve as a picture: asked as a line, measured as points on it (Lian & Chen Fig. 3).

use std::path::Path;

use plotters::prelude::*;

use super::{Error, FONT, INK, SIZE, fonts};

const ASKED: RGBColor = RGBColor(120, 165, 225);
const MEASURED: RGBColor = RGBColor(222, 110, 20);

/// Draws nominal stress [kPa] over nominal strain [%] into a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn stress_strain(path: &Path, title: &str, asked: &[(f64, f64)], measured: &[(f64, f64)]) -> Result<(), Error> {
    fonts()?;
    let fault = |cause: DrawingAreaErrorKind<_>| Error::Draw(cause.to_string());
    let root = BitMapBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(fault)?;
    let span = |of: fn(&(f64, f64)) -> f64| {
        let values = asked.iter().chain(measured).map(of);
        let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let room = 0.05 * (high - low);
        low - room..high + room
    };
    let mut chart = ChartBuilder::on(&root)
        .caption(title, (FONT, 34).into_font().color(&INK))
        .margin(24)
        .x_label_area_size(64)
        .y_label_area_size(120)
        .build_cartesian_2d(span(|p| p.0), span(|p| p.1))
        .map_err(fault)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("strain [%]")
        .y_desc("nominal stress [kPa]")
        .label_style((FONT, 24).into_font().color(&INK))
        .axis_desc_style((FONT, 28).into_font().color(&INK))
        .draw()
        .map_err(fault)?;
    let line = ASKED.stroke_width(6);
    chart
        .draw_series(LineSeries::new(asked.iter().copied(), line))
        .map_err(fault)?
        .label("asked")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 36, y)], line));
    let dots = measured.iter().map(|at| Circle::new(*at, 6, MEASURED.filled()));
    chart
        .draw_series(dots)
        .map_err(fault)?
        .label("measured")
        .legend(|(x, y)| Circle::new((x + 18, y), 6, MEASURED.filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .legend_area_size(48)
        .label_font((FONT, 24).into_font().color(&INK))
        .background_style(WHITE.mix(0.85))
        .border_style(INK.mix(0.3))
        .draw()
        .map_err(fault)?;
    root.present().map_err(fault)
}
