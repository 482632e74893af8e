//! A table of outcomes as a picture: a row for each case, a column for each setting, a coloured square for each outcome.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Error, FONT, INK, fonts};

/// What came of a case under a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every criterion holds.
    Passed,
    /// One does not.
    Failed,
    /// A formula refuses the setting.
    Refused,
    /// Not tried.
    Untried,
}

/// A table of outcomes.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// What is seen.
    pub title: String,
    /// Groups of columns: what they have in common, and their names.
    pub groups: Vec<(String, Vec<String>)>,
    /// Names of the rows, each with its outcomes by column.
    pub rows: Vec<(String, Vec<Outcome>)>,
}

/// Width of a column and height of a row [pixels].
const CELL: [i32; 2] = [64, 24];
/// Room for the rows' names, for title, groups and columns' names, and for the legend [pixels].
const LEFT: i32 = 330;
const TOP: i32 = 260;
const BOTTOM: i32 = 64;
/// Room at the edges and between groups [pixels].
const MARGIN: i32 = 24;

impl Outcome {
    const ALL: [(Self, &'static str); 3] = [
        (Self::Passed, "passed"),
        (Self::Failed, "failed"),
        (Self::Refused, "refused"),
    ];

    const fn colour(self) -> RGBColor {
        match self {
            Self::Passed => RGBColor(110, 180, 120),
            Self::Failed => RGBColor(205, 70, 60),
            Self::Refused => RGBColor(150, 150, 160),
            Self::Untried => WHITE,
        }
    }
}

/// Draws a table into a PNG or an SVG file, by the path's extension.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn matrix(path: &Path, matrix: &Matrix) -> Result<(), Error> {
    fonts()?;
    let size = size(matrix);
    if path.extension().is_some_and(|extension| extension == "svg") {
        draw(&SVGBackend::new(path, size).into_drawing_area(), matrix).map_err(|cause| Error::Draw(cause.to_string()))
    } else {
        draw(&BitMapBackend::new(path, size).into_drawing_area(), matrix)
            .map_err(|cause| Error::Draw(cause.to_string()))
    }
}

/// Width and height [pixels].
fn size(matrix: &Matrix) -> (u32, u32) {
    let columns: usize = matrix.groups.iter().map(|(_, names)| names.len()).sum();
    let [wide, high] = CELL;
    let width = LEFT + columns as i32 * wide + (matrix.groups.len() as i32 + 1) * MARGIN;
    // The title needs about 1,100 pixels.
    let height = TOP + matrix.rows.len() as i32 * high + BOTTOM;
    (width.max(1150) as u32, height as u32)
}

fn draw<B: DrawingBackend>(
    root: &DrawingArea<B, Shift>,
    matrix: &Matrix,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    root.fill(&WHITE)?;
    let text = |size: i32| (FONT, size).into_font().color(&INK);
    let [wide, high] = CELL;
    root.draw(&Text::new(matrix.title.clone(), (MARGIN, MARGIN), text(30)))?;
    let mut column = 0;
    for (group, (title, names)) in (1..).zip(&matrix.groups) {
        let begin = LEFT + group * MARGIN + column as i32 * wide;
        // Each on a line of its own: a group may be narrower than its title.
        root.draw(&Text::new(title.clone(), (begin, 2 * MARGIN + 24 * group), text(22)))?;
        for (n, name) in (0..).zip(names) {
            let left = begin + n * wide;
            let upright = text(18)
                .transform(FontTransform::Rotate270)
                .pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(name.clone(), (left + wide / 2, TOP - 10), upright))?;
            for (row, (_, outcomes)) in (0..).zip(&matrix.rows) {
                let outcome = outcomes.get(column).copied().unwrap_or(Outcome::Untried);
                let top = TOP + row * high;
                let corners = [(left + 1, top + 1), (left + wide - 1, top + high - 1)];
                root.draw(&Rectangle::new(corners, outcome.colour().filled()))?;
            }
            column += 1;
        }
    }
    let end = text(18).pos(Pos::new(HPos::Right, VPos::Center));
    for (row, (name, _)) in (0..).zip(&matrix.rows) {
        let middle = TOP + row * high + high / 2;
        root.draw(&Text::new(name.clone(), (LEFT + MARGIN - 10, middle), end.clone()))?;
    }
    let below = TOP + matrix.rows.len() as i32 * high + MARGIN;
    for (n, (outcome, name)) in (0..).zip(Outcome::ALL) {
        let left = LEFT + MARGIN + n * 150;
        root.draw(&Rectangle::new(
            [(left, below), (left + 22, below + 18)],
            outcome.colour().filled(),
        ))?;
        root.draw(&Text::new(name, (left + 30, below), text(18)))?;
    }
    root.present()
}
