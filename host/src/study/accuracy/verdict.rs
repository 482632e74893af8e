//! What the rows of one lattice say: every setting at its worst, which of them nothing beats, and the cheapest that is accurate enough.

use serde::Serialize;

use super::case::Dial;
use super::report::Row;

/// Force errors below which a setting is looked for.
pub const WANTED: [f64; 2] = [0.01, 0.001];

/// A setting on some cases, at its worst.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// The solver, `explicit` with multiples of its smallest stable count.
    pub setting: String,
    /// The solver's name alone.
    #[serde(skip)]
    pub solver: &'static str,
    /// Longest median of a tick [µs].
    pub us_median: f64,
    /// The same over the C kernel's; none without it.
    pub limit_ratio: Option<f64>,
    /// Most instructions of a tick; none where they were not counted.
    pub instructions: Option<u64>,
    /// Largest solver error, root mean square of the force.
    pub solver_error: f64,
    /// Largest total error, root mean square of the force.
    pub total_error: f64,
    /// Largest solver error of the force at any tick.
    pub force_error_max: f64,
    /// Largest solver error of the shape.
    pub shape_error: f64,
}

impl Setting {
    /// Its price in a picture: over the C kernel's, or [µs] without it.
    #[must_use]
    pub fn price(&self) -> f64 {
        self.limit_ratio.unwrap_or(self.us_median)
    }

    /// Takes the worse of both.
    fn worsen(&mut self, row: &Row) {
        let worse = |worst: &mut f64, now: Option<f64>| *worst = worst.max(now.unwrap_or(f64::INFINITY));
        worse(&mut self.us_median, Some(row.us_median));
        worse(&mut self.solver_error, row.solver_error);
        worse(&mut self.total_error, row.total_error);
        worse(&mut self.force_error_max, row.force_error_max);
        worse(&mut self.shape_error, row.shape_error);
        self.limit_ratio = self.limit_ratio.zip(row.limit_ratio).map(|(a, b)| a.max(b));
        self.instructions = self.instructions.zip(row.instructions).map(|(a, b)| a.max(b));
    }
}

/// The settings that have a finite row in each of `cases` cases, in the order of the rows.
#[must_use]
pub fn settings<'a>(rows: impl Iterator<Item = &'a Row>, cases: usize) -> Vec<Setting> {
    let mut found: Vec<(Dial, usize, Setting)> = Vec::new();
    for row in rows.filter(|row| row.finite) {
        match found.iter_mut().find(|(dial, ..)| *dial == row.dial) {
            Some((_, count, setting)) => {
                *count += 1;
                setting.worsen(row);
            }
            None => {
                let mut setting = Setting {
                    setting: row.dial.to_string(),
                    solver: row.dial.solver(),
                    us_median: row.us_median,
                    limit_ratio: row.limit_ratio,
                    instructions: row.instructions,
                    solver_error: 0.0,
                    total_error: 0.0,
                    force_error_max: 0.0,
                    shape_error: 0.0,
                };
                setting.worsen(row);
                found.push((row.dial, 1, setting));
            }
        }
    }
    let everywhere = found.into_iter().filter(|(_, count, _)| *count == cases);
    everywhere.map(|(.., setting)| setting).collect()
}

/// The Pareto front of points of price and error: those that no other point beats in one without being worse in the other; the cheapest
/// first.
#[must_use]
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<_> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ((price, error), (other, its)) = (points[a], points[b]);
        price.total_cmp(&other).then(error.total_cmp(&its))
    });
    let mut least = f64::INFINITY;
    order.retain(|&at| {
        let (_, error) = points[at];
        let better = error < least;
        least = least.min(error);
        better
    });
    order
}

/// The cheapest of the settings whose error is below `wanted`.
#[must_use]
pub fn cheapest(settings: &[Setting], error: fn(&Setting) -> f64, wanted: f64) -> Option<&Setting> {
    let accurate = settings.iter().filter(|setting| error(setting) < wanted);
    accurate.min_by(|a, b| a.us_median.total_cmp(&b.us_median))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition: a point is on the front where no other is at least as cheap and as accurate and one of both strictly.
    #[test]
    fn the_front_is_what_nothing_beats() {
        let points: Vec<_> = (1..50_u32)
            .map(|n| (f64::from(n * 37 % 23), f64::from(n * 29 % 31)))
            .collect();
        let beaten = |(x, y): (f64, f64)| points.iter().any(|&(a, b)| a <= x && b <= y && (a < x || b < y));
        let front = front(&points);
        let prices: Vec<_> = front.iter().map(|&at| points[at].0).collect();
        assert!(prices.is_sorted() && front.len() > 1);
        for point in &points {
            let on = front.iter().any(|&at| points[at] == *point);
            assert_eq!(on, !beaten(*point), "{point:?}");
        }
        assert!(super::front(&[]).is_empty());
    }
}
