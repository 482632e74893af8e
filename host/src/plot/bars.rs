//! Bars of several quantities side by side, a row for each name, each quantity on a logarithmic scale of its own.

use std::ops::Range;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Error, FONT, INK, SIZE, fonts};

/// One quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What it is, with its unit.
    pub title: &'static str,
    /// A value for each name; none where there is none.
    pub values: Vec<Option<f64>>,
}

const COLOURS: [RGBColor; 3] = [RGBColor(222, 110, 20), RGBColor(120, 165, 225), RGBColor(30, 140, 70)];
/// Widest span of a scale: what is smaller by more than this counts as nothing.
const DECADES: f64 = 1e5;
/// Width of the column of names [pixels].
const NAMES: i32 = 360;
/// Most letters of a line in it, beyond the name.
const LETTERS: usize = 34;
/// Height of such a line [pixels].
const LINE: f64 = 21.0;
/// Height of the title and of the scales' labels [pixels].
const EDGES: [i32; 2] = [90, 90];

/// Draws a PNG file, or an SVG file where the path ends so.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn bars(path: &Path, title: &str, names: &[String], panels: &[Panel]) -> Result<(), Error> {
    fonts()?;
    let drawn = match path.extension() {
        Some(kind) if kind == "svg" => {
            let root = SVGBackend::new(path, SIZE).into_drawing_area();
            draw(&root, title, names, panels).map_err(|cause| cause.to_string())
        }
        _ => {
            let root = BitMapBackend::new(path, SIZE).into_drawing_area();
            draw(&root, title, names, panels).map_err(|cause| cause.to_string())
        }
    };
    drawn.map_err(Error::Draw)
}

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

fn draw<B: DrawingBackend>(root: &DrawingArea<B, Shift>, title: &str, names: &[String], panels: &[Panel]) -> Drawn<B> {
    root.fill(&WHITE)?;
    let [top, bottom] = EDGES;
    let (width, height) = (SIZE.0 as i32, SIZE.1 as i32);
    root.draw(&Text::new(title, (24, 24), (FONT, 34).into_font().color(&INK)))?;
    let row = f64::from(height - top - bottom) / names.len().max(1) as f64;
    for (i, name) in names.iter().enumerate() {
        let lines = lines(name);
        let first = f64::from(top) + row * (i as f64 + 0.5) - LINE * (lines.len() - 1) as f64 / 2.0;
        for (line, text) in lines.iter().enumerate() {
            let style = (FONT, if line == 0 { 23 } else { 18 })
                .into_font()
                .color(&INK)
                .pos(Pos::new(HPos::Right, VPos::Center));
            let middle = first + LINE * line as f64;
            root.draw(&Text::new(text.as_str(), (NAMES - 14, middle as i32), style))?;
        }
    }
    let each = (width - NAMES) / panels.len().max(1) as i32;
    for (i, (panel, colour)) in panels.iter().zip(COLOURS.iter().cycle()).enumerate() {
        let left = NAMES + each * i as i32;
        let area = root.clone().shrink((left, top), (each - 20, height - top));
        column(&area, panel, *colour)?;
    }
    root.present()
}

/// A name, and in further lines what it says in brackets.
fn lines(name: &str) -> Vec<String> {
    let (name, more) = name.split_once(" (").unwrap_or((name, ""));
    let mut further: Vec<String> = Vec::new();
    for word in more.trim_end_matches(')').split_whitespace() {
        match further.last_mut().filter(|line| line.len() + word.len() < LETTERS) {
            Some(line) => *line = format!("{line} {word}"),
            None => further.push(word.to_owned()),
        }
    }
    [vec![name.to_owned()], further].concat()
}

fn column<B: DrawingBackend>(area: &DrawingArea<B, Shift>, panel: &Panel, colour: RGBColor) -> Drawn<B> {
    let scale = scale(&panel.values);
    let (low, high) = (scale.start, scale.end);
    let rows = panel.values.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .x_label_area_size(EDGES[1])
        .build_cartesian_2d((low..high).log_scale(), rows..0.0)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .light_line_style(TRANSPARENT)
        .x_desc(panel.title)
        .x_labels(5)
        .x_label_formatter(&|value| label(*value, low))
        .label_style((FONT, 20).into_font().color(&INK))
        .axis_desc_style((FONT, 24).into_font().color(&INK))
        .draw()?;
    let style = (FONT, 20)
        .into_font()
        .color(&INK)
        .pos(Pos::new(HPos::Left, VPos::Center));
    for (i, value) in panel.values.iter().enumerate() {
        let (from, to, middle) = (i as f64 + 0.2, i as f64 + 0.8, i as f64 + 0.5);
        let end = value.unwrap_or(0.0).clamp(low, high);
        if end > low {
            chart.draw_series([Rectangle::new([(low, from), (end, to)], colour.filled())])?;
        }
        let text = value.map_or_else(|| " not measured".to_owned(), |value| format!(" {}", short(value)));
        chart.draw_series([Text::new(text, (end, middle), style.clone())])?;
    }
    Ok(())
}

/// A tick's number; none at the panel's left edge, where it would reach into the panel before.
fn label(value: f64, low: f64) -> String {
    if value < 1.5 * low {
        String::new()
    } else {
        format!("{value}")
    }
}

/// From a power of ten below the least value that counts to one with room for a number beyond the greatest.
fn scale(values: &[Option<f64>]) -> Range<f64> {
    let present = || values.iter().flatten().copied().filter(|value| *value > 0.0);
    let most = present().fold(f64::MIN_POSITIVE, f64::max);
    if most <= f64::MIN_POSITIVE {
        return 0.1..10.0;
    }
    let least = present().filter(|value| *value >= most / DECADES).fold(most, f64::min);
    let power = |value: f64| 10_f64.powf(value);
    power((least.log10() - 0.3).floor())..power(most.log10() + 0.28 * (most / least).log10().max(2.0))
}

/// Three digits, or what is left of them.
fn short(value: f64) -> String {
    let digits = (2.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (1234.5, "1234"),
            (12.345, "12.3"),
            (0.001_234_5, "0.00123"),
            (-0.5, "-0.5"),
        ];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_scale_holds_all_that_counts() {
        let values = [Some(200.0), Some(3.0), Some(1e-9), Some(-1.0), None];
        let scale = scale(&values);
        assert!(
            scale.start <= 3.0 && scale.start > 0.1 && scale.end > 200.0,
            "{scale:?}"
        );
    }

    #[test]
    fn both_kinds_of_picture_are_drawn() {
        let names = ["one (with another)".to_owned(), "two".to_owned()];
        let panels = [Panel {
            title: "price [things]",
            values: vec![Some(3.0), None],
        }];
        let folder = tempfile::tempdir().unwrap();
        for kind in ["png", "svg"] {
            let path = folder.path().join("bars").with_extension(kind);
            bars(&path, "A title", &names, &panels).unwrap();
            assert!(std::fs::metadata(&path).unwrap().len() > 1000, "{kind}");
        }
        let svg = std::fs::read_to_string(folder.path().join("bars.svg")).unwrap();
        for text in ["A title", "with another", "price [things]", "not measured"] {
            assert!(svg.contains(text), "{text}");
        }
    }
}
