//! Error over time of the solvers for one scene, both axes logarithmic: a line for each family, the budget, and what was chosen.

use std::path::Path;

use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Error, FONT, INK, SIZE, fonts};

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What is seen.
    pub title: String,
    /// Name of each family, and its settings as time [µs] and error [%], the cheapest first.
    pub families: Vec<(String, Vec<(f64, f64)>)>,
    /// The budget [µs].
    pub budget_us: f64,
    /// Name, time and error of the chosen setting.
    pub chosen: (String, (f64, f64)),
}

/// Least and largest error that are drawn [%].
const ERRORS: [f64; 2] = [1e-4, 100.0];
/// Error below which no better one is looked for [%].
const ENOUGH: f64 = 100.0 * crate::study::budget::ENOUGH;
const COLOURS: [RGBColor; 7] = [
    RGBColor(240, 180, 110),
    RGBColor(222, 110, 20),
    RGBColor(150, 60, 10),
    RGBColor(150, 90, 190),
    RGBColor(30, 140, 70),
    RGBColor(30, 120, 200),
    RGBColor(120, 110, 60),
];

/// Draws into a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn png(path: &Path, picture: &Picture) -> Result<(), Error> {
    fonts()?;
    let root = BitMapBackend::new(path, SIZE).into_drawing_area();
    draw(&root, picture).map_err(|cause| Error::Draw(cause.to_string()))
}

type Area<DB> = DrawingArea<DB, plotters::coord::Shift>;
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn draw<DB: DrawingBackend>(root: &Area<DB>, picture: &Picture) -> Drawn<DB> {
    root.fill(&WHITE)?;
    let [times, errors] = ranges(picture);
    let mut chart = ChartBuilder::on(root)
        .caption(&picture.title, (FONT, 34).into_font().color(&INK))
        .margin(24)
        .x_label_area_size(64)
        .y_label_area_size(110)
        .build_cartesian_2d((times[0]..times[1]).log_scale(), (errors[0]..errors[1]).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(INK.mix(0.1))
        .x_desc("CPU time of a whole tick, median [µs]")
        .y_desc("error of the force [%]")
        .x_label_formatter(&|value| plain(*value))
        .y_label_formatter(&|value| plain(*value))
        .label_style((FONT, 24).into_font().color(&INK))
        .axis_desc_style((FONT, 28).into_font().color(&INK))
        .draw()?;
    marks(&mut chart, picture.budget_us, [times, errors])?;
    for ((name, points), colour) in picture.families.iter().zip(COLOURS.into_iter().cycle()) {
        let style = colour.stroke_width(3);
        let seen: Vec<_> = points
            .iter()
            .copied()
            .filter(|(_, error)| *error >= ERRORS[0])
            .collect();
        chart.draw_series(LineSeries::new(seen.iter().copied(), style))?;
        chart
            .draw_series(seen.iter().map(|at| Circle::new(*at, 6, colour.filled())))?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 18, y), 6, colour.filled()));
    }
    let (name, at) = &picture.chosen;
    let at = (at.0, at.1.max(errors[0]));
    // Nothing is both cheaper and more accurate, so there is room on that side.
    let style = label(HPos::Right, VPos::Top);
    chart.draw_series([Circle::new(at, 13, INK.stroke_width(3))])?;
    chart.draw_series([EmptyElement::at(at) + Text::new(name.clone(), (-16, 10), style)])?;
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .margin(20)
        .legend_area_size(48)
        .label_font((FONT, 24).into_font().color(&INK))
        .background_style(WHITE.mix(0.85))
        .border_style(INK.mix(0.3))
        .draw()?;
    root.present()
}

/// The budget upright, and the error that is enough across.
fn marks<DB: DrawingBackend>(chart: &mut Chart<'_, DB>, budget_us: f64, [times, errors]: [[f64; 2]; 2]) -> Drawn<DB> {
    let line = INK.mix(0.7).stroke_width(2);
    let upright = [(budget_us, errors[0]), (budget_us, errors[1])];
    let across = [(times[0], ENOUGH), (times[1], ENOUGH)];
    chart.draw_series([PathElement::new(upright, line), PathElement::new(across, line)])?;
    let budget = format!("{budget_us} µs ");
    let enough = format!(" {ENOUGH} %: no better one is looked for");
    chart.draw_series([
        Text::new(budget, (budget_us, errors[0] * 1.05), label(HPos::Right, VPos::Bottom)),
        Text::new(enough, (times[0], ENOUGH), label(HPos::Left, VPos::Bottom)),
    ])?;
    Ok(())
}

/// Text whose place is at one side and end of it.
fn label(side: HPos, end: VPos) -> TextStyle<'static> {
    (FONT, 24).into_font().color(&INK).pos(Pos::new(side, end))
}

/// Least and largest time and error, with room for names.
fn ranges(picture: &Picture) -> [[f64; 2]; 2] {
    let points = || picture.families.iter().flat_map(|(_, points)| points);
    let mut times = [picture.budget_us, picture.budget_us];
    let mut errors = [ENOUGH, ENOUGH];
    for (time, error) in points() {
        times = [times[0].min(*time), times[1].max(*time)];
        let error = error.clamp(ERRORS[0], ERRORS[1]);
        errors = [errors[0].min(error), errors[1].max(error)];
    }
    [[times[0] / 1.6, times[1] * 1.8], [errors[0] / 2.0, errors[1] * 1.5]]
}

/// A number as people write it.
fn plain(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_is_drawn_in_its_size() {
        let picture = Picture {
            title: "Error against time".into(),
            families: vec![
                (
                    "be-pcg, 1 Newton step".into(),
                    vec![(100.0, 20.0), (200.0, 2.0), (300.0, 1.5)],
                ),
                ("vbd".into(), vec![(400.0, 0.0), (600.0, 1e-9)]),
            ],
            budget_us: 500.0,
            chosen: ("be-pcg:30:1".into(), (300.0, 1.5)),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        png(&path, &picture).unwrap();
        let file = std::fs::read(path).unwrap();
        assert_eq!(
            [&file[16..20], &file[20..24]],
            [SIZE.0.to_be_bytes(), SIZE.1.to_be_bytes()]
        );
    }
}
