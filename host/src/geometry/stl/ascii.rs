//! The text form, line by line, keywords in any case.

use super::{Fault, Place, Soup, Warning};
use crate::geometry::Vec3;

/// What some editors put before text.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Where in the grammar the reader stands, and what it has to report in the end.
#[derive(Default)]
struct Reader {
    corners: Vec<[Vec3; 3]>,
    solids: usize,
    in_solid: bool,
    /// Corners of the facet at hand.
    facet: Option<Vec<Vec3>>,
    non_finite: Lines,
    not_three: Lines,
    unknown: Lines,
    unknown_word: String,
    no_endsolid: Lines,
}

/// How many lines, and the first.
#[derive(Default)]
struct Lines {
    count: usize,
    first: usize,
}

impl Lines {
    fn add(&mut self, line: usize) {
        if self.count == 0 {
            self.first = line;
        }
        self.count += 1;
    }
}

pub(super) fn parse(bytes: &[u8]) -> Result<Soup, Fault> {
    let marked = bytes.starts_with(BYTE_ORDER_MARK);
    let text = String::from_utf8_lossy(bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes));
    // Files of old Macintosh programs end lines with a carriage return alone.
    let newline = if text.contains('\n') { '\n' } else { '\r' };
    let mut reader = Reader::default();
    let mut last = 0;
    for (index, line) in text.trim_end().split(newline).enumerate() {
        last = index + 1;
        let mut words = line.split_whitespace();
        if let Some(word) = words.next() {
            reader.line(last, word, words)?;
        }
    }
    if reader.facet.is_some() {
        return Err(Fault::EndInFacet { line: last });
    }
    reader.end_solid(last);
    let warnings = marked
        .then_some(Warning::ByteOrderMark)
        .into_iter()
        .chain(reader.warnings())
        .collect();
    Ok(Soup {
        corners: reader.corners,
        solids: reader.solids,
        warnings,
        end: Place::Line(last),
    })
}

impl Reader {
    fn line<'a>(&mut self, line: usize, word: &str, rest: impl Iterator<Item = &'a str>) -> Result<(), Fault> {
        let misplaced = |expected| {
            Err(Fault::Misplaced {
                line,
                word: shown(word),
                expected,
            })
        };
        let keyword = word.to_ascii_lowercase();
        match (keyword.as_str(), &mut self.facet) {
            ("outer" | "endloop", _) => {}
            ("solid" | "facet" | "endsolid", Some(_)) => {
                return misplaced("inside a facet; `endfacet` must come first");
            }
            ("vertex" | "endfacet", None) => {
                return misplaced("outside of a facet; `facet` must come first");
            }
            ("solid", None) => {
                self.end_solid(line);
                self.in_solid = true;
                self.solids += 1;
            }
            ("endsolid", None) => self.in_solid = false,
            ("facet", None) => self.facet = Some(Vec::with_capacity(3)),
            ("vertex", Some(facet)) => match point(rest) {
                Some(point) => facet.push(point),
                None => return misplaced("needs three numbers"),
            },
            ("endfacet", Some(_)) => self.end_facet(line),
            _ => {
                if self.unknown.count == 0 {
                    self.unknown_word = shown(word);
                }
                self.unknown.add(line);
            }
        }
        Ok(())
    }

    fn end_facet(&mut self, line: usize) {
        let facet = self.facet.take().unwrap_or_default();
        if facet.len() != 3 {
            self.not_three.add(line);
        }
        if let Some(&corners) = facet.first_chunk() {
            if corners.iter().flatten().all(|c| c.is_finite()) {
                self.corners.push(corners);
            } else {
                self.non_finite.add(line);
            }
        }
    }

    /// Counts the solid at hand as one without `endsolid`, if one is at hand.
    fn end_solid(&mut self, line: usize) {
        if self.in_solid {
            self.no_endsolid.add(line);
        }
    }

    fn warnings(&mut self) -> impl Iterator<Item = Warning> + use<> {
        let some = |lines: &Lines, warning: Warning| (lines.count > 0).then_some(warning);
        let Self {
            non_finite,
            not_three,
            unknown,
            no_endsolid,
            ..
        } = self;
        let word = std::mem::take(&mut self.unknown_word);
        [
            some(
                not_three,
                Warning::Corners {
                    count: not_three.count,
                    line: not_three.first,
                },
            ),
            some(
                non_finite,
                Warning::NonFinite {
                    count: non_finite.count,
                    first: Place::Line(non_finite.first),
                },
            ),
            some(
                unknown,
                Warning::UnknownLines {
                    count: unknown.count,
                    line: unknown.first,
                    word,
                },
            ),
            some(
                no_endsolid,
                Warning::NoEndsolid {
                    count: no_endsolid.count,
                    line: no_endsolid.first,
                },
            ),
        ]
        .into_iter()
        .flatten()
    }
}

fn point<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<Vec3> {
    let mut number = || words.next().and_then(number);
    Some(Vec3::new(number()?, number()?, number()?))
}

/// A number; the ways in which C libraries print what is no number become NaN, so that only that facet is lost.
fn number(word: &str) -> Option<f64> {
    let odd = || {
        ["nan", "inf", "#"]
            .iter()
            .any(|mark| word.to_ascii_lowercase().contains(mark))
            .then_some(f64::NAN)
    };
    word.parse().ok().or_else(odd)
}

/// A word as a message shows it: short, and on one line.
fn shown(word: &str) -> String {
    const LIMIT: usize = 24;
    let mut shown: String = word.chars().filter(|c| !c.is_control()).take(LIMIT).collect();
    if word.chars().count() > LIMIT {
        shown.push('…');
    }
    shown
}
