//! A block of cubic cells in space, x fastest.

use super::Vec3;

/// Most cells a grid may have: one byte each, half a gigabyte.
pub const CELLS_MAX: usize = 1 << 29;

/// Part of a cell by which an extent may exceed a whole number of cells without needing one more.
const WHOLE: f64 = 1e-6;

/// Where cells lie: cell (i, j, k) has its centre at `origin + (i + ½, j + ½, k + ½)·pitch`.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Corner of cell (0, 0, 0) with the smallest coordinates [mm].
    pub origin: Vec3,
    /// Edge of a cell [mm], positive.
    pub pitch: f64,
    /// Cells along x, y and z.
    pub cells: [usize; 3],
}

/// Why there is no such grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// A length that is no length.
    #[error("pitch {pitch} mm is not a positive number")]
    Pitch {
        /// The pitch asked for [mm].
        pitch: f64,
    },
    /// More cells than [`CELLS_MAX`].
    #[error("pitch {pitch} mm gives {cells:.3e} cells, at most {CELLS_MAX} are possible: use {fits} mm or more")]
    TooLarge {
        /// The pitch asked for [mm].
        pitch: f64,
        /// The cells it would give.
        cells: f64,
        /// A pitch that is possible [mm].
        fits: f64,
    },
}

impl Grid {
    /// The grid of a box: its origin at the smallest corner, with as many cells as cover it, at least one each way.
    ///
    /// # Errors
    /// The pitch is no positive number, or the cells would be too many.
    pub fn covering([low, high]: [Vec3; 2], pitch: f64) -> Result<Self, GridError> {
        if !(pitch.is_finite() && pitch > 0.0) {
            return Err(GridError::Pitch { pitch });
        }
        let counts = (high - low).map(|extent| cells_along(extent, pitch));
        let cells = counts.product();
        if cells > CELLS_MAX as f64 {
            return Err(GridError::TooLarge {
                pitch,
                cells,
                fits: round_up(pitch * (cells / CELLS_MAX as f64).cbrt()),
            });
        }
        Ok(Self {
            origin: low,
            pitch,
            cells: [counts.x as usize, counts.y as usize, counts.z as usize],
        })
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.iter().product()
    }

    /// Whether there is no cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Centre of a cell [mm].
    #[must_use]
    pub fn centre(&self, [i, j, k]: [usize; 3]) -> Vec3 {
        self.origin + Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * self.pitch
    }

    /// Place of a cell in an array with x fastest.
    #[must_use]
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.cells[0] * (j + self.cells[1] * k)
    }

    /// How many cell centres along `axis` lie below a coordinate [mm], from 0 to all of them.
    #[must_use]
    pub fn centres_below(&self, axis: usize, coordinate: f64) -> usize {
        // A float to integer cast saturates, so that far outside becomes none or all.
        (((coordinate - self.origin[axis]) / self.pitch - 0.5).ceil() as usize).min(self.cells[axis])
    }
}

fn cells_along(extent: f64, pitch: f64) -> f64 {
    let quotient = extent / pitch;
    let whole = quotient.round();
    let cells = if (quotient - whole).abs() < WHOLE {
        whole
    } else {
        quotient.ceil()
    };
    cells.max(1.0)
}

/// The next larger number with two digits.
#[must_use]
pub fn round_up(length: f64) -> f64 {
    let digit = 10_f64.powf(length.log10().floor() - 1.0);
    let tens = (length / digit).ceil();
    // Dividing by a whole power of ten prints without a tail of digits.
    if digit < 1.0 {
        tens / (1.0 / digit).round()
    } else {
        tens * digit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_box_and_nearly_whole_quotients_are_whole() {
        let grid = |extent, pitch| Grid::covering([Vec3::zeros(), extent], pitch).unwrap().cells;
        assert_eq!(grid(Vec3::new(10.0, 10.0 + 1e-7, 10.1), 1.0), [10, 10, 11]);
        assert_eq!(grid(Vec3::new(0.3, 0.0, 0.05), 0.1), [3, 1, 1]);
    }

    #[test]
    fn centres_below_counts_centres() {
        let grid = Grid {
            origin: Vec3::new(-1.0, 0.0, 0.0),
            pitch: 0.5,
            cells: [4, 4, 4],
        };
        // Centres along x: -0.75, -0.25, 0.25, 0.75.
        for (x, below) in [
            (-9.0, 0),
            (-0.75, 0),
            (-0.74, 1),
            (0.0, 2),
            (0.75, 3),
            (0.76, 4),
            (1e300, 4),
        ] {
            assert_eq!(grid.centres_below(0, x), below, "x = {x}");
        }
    }

    #[test]
    fn too_many_cells_are_refused_with_a_pitch_that_is_not() {
        let bounds = [Vec3::zeros(), Vec3::repeat(1000.0)];
        let Err(GridError::TooLarge { cells, fits, .. }) = Grid::covering(bounds, 0.01) else {
            panic!("accepted")
        };
        assert!((cells - 1e15).abs() < 1.0);
        assert!(Grid::covering(bounds, fits).is_ok() && fits < 1.5);
        for pitch in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Grid::covering(bounds, pitch), Err(GridError::Pitch { .. })));
        }
    }

    #[test]
    fn rounding_up_keeps_two_digits() {
        for (length, rounded) in [(1.2301, 1.3), (0.0451, 0.046), (123.0, 130.0), (2.0, 2.0)] {
            assert!((round_up(length) - rounded).abs() < 1e-12, "{length}");
        }
    }
}
