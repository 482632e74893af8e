//! Error over price of many solvers, one panel for each lattice, both axes logarithmic; what nothing beats is joined and named.

use std::path::Path;

use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Error, FONT, INK, fonts};

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What is seen.
    pub title: String,
    /// Quantity and unit of the price.
    pub price: &'static str,
    /// One for each lattice.
    pub panels: Vec<Panel>,
}

/// One lattice; places are price and error [%].
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Which lattice.
    pub title: String,
    /// Every case: its solver's name, and where.
    pub dots: Vec<(&'static str, (f64, f64))>,
    /// Every setting at its worst.
    pub points: Vec<Point>,
    /// Which points nothing beats, the cheapest first.
    pub front: Vec<usize>,
}

/// A setting at its worst.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Its solver's name.
    pub solver: &'static str,
    /// Its own.
    pub name: String,
    /// Price and error [%].
    pub at: (f64, f64),
}

/// Width of the picture, height of a row of panels and of the head above them [pixels].
const WIDTH: u32 = 1800;
const ROW: u32 = 720;
const HEAD: u32 = 150;
const COLUMNS: usize = 2;
/// Largest error that is drawn [%].
const MOST: f64 = 100.0;
/// Least error that is drawn [%].
const LEAST: f64 = 1e-4;
/// What a hand can just tell apart [%]: Jones and Hunter 1990, Tan et al. 1994; and what is safely below it.
const JND: [f64; 2] = [7.0, 10.0];
const UNFELT: f64 = 1.0;
/// Room for names at the left of and below the points, as factors.
const ROOM: [f64; 2] = [6.0, 4.0];
const SMALL: u32 = 20;
const BAND: RGBColor = RGBColor(226, 226, 229);
const LINE: ShapeStyle = ShapeStyle {
    color: RGBAColor(50, 50, 60, 0.8),
    filled: false,
    stroke_width: 2,
};
const SOLVERS: [(&str, RGBColor); 6] = [
    ("explicit", RGBColor(30, 120, 200)),
    ("be-pcg", RGBColor(222, 110, 20)),
    ("be-chebyshev", RGBColor(150, 90, 190)),
    ("vbd", RGBColor(30, 140, 70)),
    ("xpbd", RGBColor(200, 50, 90)),
    ("pd", RGBColor(120, 110, 60)),
];

/// Draws into a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn png(path: &Path, picture: &Picture) -> Result<(), Error> {
    draw(&BitMapBackend::new(path, size(picture)).into_drawing_area(), picture)
}

/// Draws into an SVG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn svg(path: &Path, picture: &Picture) -> Result<(), Error> {
    draw(&SVGBackend::new(path, size(picture)).into_drawing_area(), picture)
}

type Area<DB> = DrawingArea<DB, Shift>;
type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn rows(picture: &Picture) -> usize {
    picture.panels.len().div_ceil(COLUMNS)
}

fn size(picture: &Picture) -> (u32, u32) {
    (WIDTH, HEAD + ROW * rows(picture) as u32)
}

fn draw<DB: DrawingBackend>(root: &Area<DB>, picture: &Picture) -> Result<(), Error> {
    fonts()?;
    whole(root, picture).map_err(|cause| Error::Draw(cause.to_string()))
}

fn whole<DB: DrawingBackend>(root: &Area<DB>, picture: &Picture) -> Drawn<DB> {
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(HEAD);
    let title = (FONT, 34).into_font().color(&INK);
    head.draw_text(&picture.title, &title.pos(Pos::new(HPos::Left, VPos::Top)), (28, 18))?;
    legend(&head)?;
    let range = range(picture);
    let areas = body.split_evenly((rows(picture), COLUMNS));
    for (area, panel) in areas.iter().zip(&picture.panels) {
        draw_panel(area, picture.price, panel, range)?;
    }
    root.present()
}

/// The solvers' colours, in one line.
fn legend<DB: DrawingBackend>(head: &Area<DB>) -> Drawn<DB> {
    let style = (FONT, 24)
        .into_font()
        .color(&INK)
        .pos(Pos::new(HPos::Left, VPos::Center));
    let mut x = 40;
    for (name, colour) in SOLVERS {
        head.draw(&Circle::new((x, 82), 8, colour.filled()))?;
        head.draw_text(name, &style, (x + 16, 82))?;
        x += 60 + head.estimate_text_size(name, &style)?.0 as i32;
    }
    let rest = "large: a setting at its worst over all cases; small: one case; joined: what no setting beats";
    head.draw_text(rest, &style, (x + 10, 82))?;
    let [low, high] = JND;
    head.draw(&Rectangle::new([(32, 112), (88, 132)], BAND.filled()))?;
    head.draw_text(
        &format!("what a hand can just tell, {low} to {high} %"),
        &style,
        (100, 122),
    )?;
    head.draw(&PathElement::new([(532, 122), (588, 122)], LINE))?;
    head.draw_text(&format!("{UNFELT} %: below what a hand can tell"), &style, (600, 122))
}

/// Price and error of everything that is drawn, with room: least and largest.
fn range(picture: &Picture) -> [(f64, f64); 2] {
    let points = picture.panels.iter().flat_map(|panel| {
        let dots = panel.dots.iter().map(|(_, at)| *at);
        dots.chain(panel.points.iter().map(|point| point.at))
    });
    let mut range = [(f64::INFINITY, f64::INFINITY), (UNFELT, UNFELT)];
    for at in points.filter(|at| seen(*at)) {
        let [least, most] = &mut range;
        *least = (least.0.min(at.0), least.1.min(at.1));
        *most = (most.0.max(at.0), most.1.max(at.1));
    }
    let [least, most] = range;
    let least = (least.0.min(most.0) / ROOM[0], least.1.min(UNFELT) / ROOM[1]);
    [least, (most.0 * 1.5, MOST)]
}

/// Whether a place is drawn.
fn seen((price, error): (f64, f64)) -> bool {
    price > 0.0 && (LEAST..=MOST).contains(&error)
}

fn draw_panel<DB: DrawingBackend>(
    area: &Area<DB>,
    price: &str,
    panel: &Panel,
    [least, most]: [(f64, f64); 2],
) -> Drawn<DB> {
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FONT, 28).into_font().color(&INK))
        .margin(20)
        .x_label_area_size(58)
        .y_label_area_size(96)
        .build_cartesian_2d((least.0..most.0).log_scale(), (least.1..most.1).log_scale())?;
    let band = Rectangle::new([(least.0, JND[0]), (most.0, JND[1])], BAND.filled());
    chart.draw_series([band])?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(INK.mix(0.08))
        .x_desc(price)
        .y_desc("total error of the force [%]")
        .x_label_formatter(&|value| plain(*value))
        .y_label_formatter(&|value| plain(*value))
        .label_style((FONT, 22).into_font().color(&INK))
        .axis_desc_style((FONT, 24).into_font().color(&INK))
        .draw()?;
    let unfelt = PathElement::new([(least.0, UNFELT), (most.0, UNFELT)], LINE);
    chart.draw_series([unfelt])?;
    for &(solver, at) in panel.dots.iter().filter(|(_, at)| seen(*at)) {
        chart.draw_series([Circle::new(at, 3, colour(solver).mix(0.45).filled())])?;
    }
    let front = panel.front.iter().filter_map(|&at| panel.points.get(at));
    let front: Vec<_> = front.filter(|point| seen(point.at)).collect();
    chart.draw_series([PathElement::new(
        front.iter().map(|point| point.at).collect::<Vec<_>>(),
        INK.mix(0.6).stroke_width(3),
    )])?;
    for point in panel.points.iter().filter(|point| seen(point.at)) {
        chart.draw_series([Circle::new(point.at, 8, colour(point.solver).filled())])?;
    }
    names(&mut chart, area, &front)
}

/// The front's names, left of and below their points, where no point of the front is.
fn names<DB: DrawingBackend>(chart: &mut Chart<'_, DB>, area: &Area<DB>, front: &[&Point]) -> Drawn<DB> {
    let style = (FONT, SMALL)
        .into_font()
        .color(&INK)
        .pos(Pos::new(HPos::Right, VPos::Top));
    let mut boxes = Vec::new();
    for point in front {
        let (width, height) = area.estimate_text_size(&point.name, &style)?;
        boxes.push((chart.backend_coord(&point.at), [width as i32 + 4, height as i32 + 3]));
    }
    let (_, line) = chart.backend_coord(&(1.0, UNFELT));
    for (point, ((from, size), corner)) in front.iter().zip(boxes.iter().zip(place(&boxes, line))) {
        let to = (corner.0 - from.0, corner.1 - from.1);
        let paper = Rectangle::new(
            [(to.0 - size[0], to.1), (to.0, to.1 + size[1])],
            WHITE.mix(0.8).filled(),
        );
        let line = PathElement::new([(0, 0), (to.0, to.1 + 2)], INK.mix(0.4).stroke_width(1));
        let name = Text::new(point.name.clone(), (to.0 - 2, to.1), style.clone());
        chart.draw_series([EmptyElement::at(point.at) + paper + line + name])?;
    }
    Ok(())
}

/// Upper right corners of names, given their points from left to right, each further down, and the size of each name [pixels]: left of and below the
/// point, and below the level `line` and every name before where they are in the way.
fn place(points: &[((i32, i32), [i32; 2])], line: i32) -> Vec<(i32, i32)> {
    const AWAY: (i32, i32) = (12, 8);
    const WIDE: i32 = 1 << 20;
    let mut placed: Vec<((i32, i32), [i32; 2])> = vec![((WIDE, line - 2), [2 * WIDE, 5])];
    for &((x, y), size) in points {
        let (right, mut top) = (x - AWAY.0, y + AWAY.1);
        for &((its_right, its_top), [its_width, its_height]) in &placed {
            let beside = right < its_right - its_width || its_right < right - size[0];
            let apart = top + size[1] <= its_top || its_top + its_height <= top;
            if !beside && !apart {
                top = its_top + its_height;
            }
        }
        placed.push(((right, top), size));
    }
    placed.into_iter().skip(1).map(|(corner, _)| corner).collect()
}

fn colour(solver: &str) -> RGBColor {
    let known = SOLVERS.iter().find(|(name, _)| *name == solver);
    known.map_or(INK, |(_, colour)| *colour)
}

/// A power of ten as people write it.
fn plain(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apart([a, b]: [((i32, i32), [i32; 2]); 2]) -> bool {
        let of = |((right, top), [width, height]): ((i32, i32), [i32; 2])| (right - width, right, top, top + height);
        let (a, b) = (of(a), of(b));
        a.1 <= b.0 || b.1 <= a.0 || a.3 <= b.2 || b.3 <= a.2
    }

    #[test]
    fn names_never_cover_each_other() {
        // A front that is steep, then flat: points a few pixels apart in one direction.
        let steep = (0..8).map(|n| ((400 + 3 * n, 100 + 40 * n), [120, 18]));
        let flat = (0..8).map(|n| ((440 + 40 * n, 400 + 3 * n), [120, 18]));
        let points: Vec<_> = steep.chain(flat).collect();
        let corners = place(&points, 120);
        let boxes: Vec<_> = corners
            .iter()
            .zip(&points)
            .map(|(corner, (_, size))| (*corner, *size))
            .collect();
        for (count, a) in boxes.iter().enumerate() {
            let ((_, top), [_, height]) = *a;
            assert!(top > 120 || top + height < 120, "{a:?} lies on the line");
            for b in &boxes[..count] {
                assert!(apart([*a, *b]), "{a:?} {b:?}");
            }
            for (at, _) in &points {
                assert!(apart([*a, (*at, [1, 1])]), "{a:?} {at:?}");
            }
        }
    }

    #[test]
    fn both_pictures_are_drawn() {
        let point = |solver, at| Point {
            solver,
            name: format!("{solver}:9"),
            at,
        };
        let panel = Panel {
            title: "8x8x4 nodes".into(),
            dots: vec![("vbd", (3.0, 0.5)), ("xpbd", (30.0, 1e9)), ("pd", (1.0, 0.0))],
            points: vec![
                point("be-pcg", (1.0, 2.0)),
                point("vbd", (4.0, 0.02)),
                point("xpbd", (9.0, 300.0)),
            ],
            front: vec![0, 1],
        };
        let picture = Picture {
            title: "Error against time".into(),
            price: "CPU time",
            panels: vec![panel.clone(), panel.clone(), panel],
        };
        let folder = tempfile::tempdir().unwrap();
        let [bitmap, vectors] = ["a.png", "a.svg"].map(|name| folder.path().join(name));
        png(&bitmap, &picture).unwrap();
        svg(&vectors, &picture).unwrap();
        let bitmap = std::fs::read(bitmap).unwrap();
        let (width, height) = size(&picture);
        assert_eq!(
            [&bitmap[16..20], &bitmap[20..24]],
            [width.to_be_bytes(), height.to_be_bytes()]
        );
        let vectors = std::fs::read_to_string(vectors).unwrap();
        assert_eq!(vectors.matches("vbd:9").count(), 3);
    }
}
