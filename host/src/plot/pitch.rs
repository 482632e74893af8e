//! Error over pitch, both axes logarithmic, a curve for each case.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::{Error, FONT, INK, SIZE, fonts};

/// One case.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// For the legend.
    pub name: String,
    /// Pitch [mm] and error [%].
    pub points: Vec<(f64, f64)>,
}

const COLOURS: [RGBColor; 4] = [
    RGBColor(30, 120, 200),
    RGBColor(222, 110, 20),
    RGBColor(235, 190, 140),
    RGBColor(30, 140, 70),
];
/// Room beyond the points, as factors of pitch and error.
const ROOM: (f64, f64) = (1.12, 1.8);

/// Draws into a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn png(path: &Path, curves: &[Curve]) -> Result<(), Error> {
    draw(&BitMapBackend::new(path, SIZE).into_drawing_area(), curves)
}

/// Draws into an SVG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn svg(path: &Path, curves: &[Curve]) -> Result<(), Error> {
    draw(&SVGBackend::new(path, SIZE).into_drawing_area(), curves)
}

type Area<DB> = DrawingArea<DB, Shift>;
type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn draw<DB: DrawingBackend>(root: &Area<DB>, curves: &[Curve]) -> Result<(), Error> {
    fonts()?;
    whole(root, curves).map_err(|cause| Error::Draw(cause.to_string()))
}

fn whole<DB: DrawingBackend>(root: &Area<DB>, curves: &[Curve]) -> Drawn<DB> {
    root.fill(&WHITE)?;
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let range = |of: fn(&(f64, f64)) -> f64, room: f64| {
        // A logarithmic axis has no number where it has no power of ten.
        let least = points().map(of).fold(1.0, f64::min);
        let most = points().map(of).fold(1.0, f64::max);
        (least / room..most * room).log_scale()
    };
    let mut chart = ChartBuilder::on(root)
        .caption(
            "Error of the force against closed forms: the same bodies and tools at several pitches",
            (FONT, 34).into_font().color(&INK),
        )
        .margin(24)
        .x_label_area_size(64)
        .y_label_area_size(120)
        .build_cartesian_2d(range(|at| at.0, ROOM.0), range(|at| at.1, ROOM.1))?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(INK.mix(0.08))
        .x_desc("pitch [mm]")
        .y_desc("error of the force [%]")
        .x_label_formatter(&|value| plain(*value))
        .y_label_formatter(&|value| plain(*value))
        .label_style((FONT, 24).into_font().color(&INK))
        .axis_desc_style((FONT, 28).into_font().color(&INK))
        .draw()?;
    for (curve, colour) in curves.iter().zip(COLOURS) {
        let line = colour.stroke_width(4);
        chart
            .draw_series(LineSeries::new(curve.points.iter().copied(), line))?
            .label(&curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 36, y)], line));
        let dots = curve.points.iter().map(|at| Circle::new(*at, 8, colour.filled()));
        chart.draw_series(dots)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .margin(24)
        .legend_area_size(48)
        .label_font((FONT, 24).into_font().color(&INK))
        .background_style(WHITE.mix(0.85))
        .border_style(INK.mix(0.3))
        .draw()?;
    root.present()
}

/// A number as people write it.
fn plain(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_pictures_are_drawn() {
        let curve = |name: &str, order: i32| Curve {
            name: name.to_owned(),
            points: [4.0_f64, 2.0, 1.0].map(|pitch| (pitch, pitch.powi(order))).to_vec(),
        };
        let curves = [curve("one", 1), curve("two", 2)];
        let folder = tempfile::tempdir().unwrap();
        let [bitmap, vectors] = ["a.png", "a.svg"].map(|name| folder.path().join(name));
        png(&bitmap, &curves).unwrap();
        svg(&vectors, &curves).unwrap();
        let bitmap = std::fs::read(bitmap).unwrap();
        assert_eq!(
            [&bitmap[16..20], &bitmap[20..24]],
            [SIZE.0.to_be_bytes(), SIZE.1.to_be_bytes()]
        );
        let vectors = std::fs::read_to_string(vectors).unwrap();
        assert!(vectors.contains("two") && vectors.contains("pitch [mm]"));
    }
}
