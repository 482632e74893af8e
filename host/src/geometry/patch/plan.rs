//! The block in whole cells: symmetric about the wound, with the wound's columns counted.

use super::{Block, PatchError, RISE_MM_MAX, Warning};
use crate::geometry::Vec3;
use crate::geometry::grid::{Grid, round_up};

/// The block in whole cells.
pub(super) struct Plan {
    pub(super) pitch: f64,
    /// Cells along x and y.
    pub(super) across: [usize; 2],
    /// Layers below z = 0.
    pub(super) below: usize,
    /// Most layers above z = 0.
    pub(super) above_max: usize,
    /// Cells of the wound along x, y and down from z = 0.
    wound: [usize; 3],
}

impl Plan {
    pub(super) fn of(block: &Block) -> Result<(Self, Vec<Warning>), PatchError> {
        let pitch = block.pitch_mm;
        let wound_mm = block.wound.map_or([0.0; 3], |w| [w.width_mm, w.length_mm, w.depth_mm]);
        let asked = [
            ("pitch", pitch),
            ("patch width", block.size_mm[0]),
            ("patch length", block.size_mm[1]),
            ("patch depth", block.size_mm[2]),
        ];
        let wound_asked = ["wound width", "wound length", "wound depth"].into_iter().zip(wound_mm);
        for (what, value) in asked
            .into_iter()
            .chain(wound_asked.clone().filter(|_| block.wound.is_some()))
        {
            if !(value.is_finite() && value > 0.0) {
                return Err(PatchError::Length { what, value });
            }
        }
        // Refuses a pitch that would overflow the counts below.
        Grid::covering([Vec3::zeros(), Vec3::from(block.size_mm)], pitch)?;
        let whole = |length: f64| ((length / pitch).round() as usize).max(1);
        let [nx, ny, below] = block.size_mm.map(whole);
        let mut plan = Self {
            pitch,
            across: [nx, ny],
            below,
            above_max: (RISE_MM_MAX / pitch).ceil() as usize,
            wound: [0; 3],
        };
        if block.wound.is_some() {
            plan.wound = wound_mm.map(whole);
            // The middle of the wound is the middle of the block: both even or both odd.
            for (cells, wound) in plan.across.iter_mut().zip(&plan.wound) {
                *cells = (*cells).max(*wound);
                *cells += (*cells - wound) % 2;
            }
            plan.wound[2] = plan.wound[2].min(below);
        }
        let warnings = wound_asked
            .zip(plan.wound)
            .map(|((what, asked_mm), cells)| Warning::Rounded { what, asked_mm, got_mm: cells as f64 * pitch })
            .filter(|warning| matches!(warning, Warning::Rounded { asked_mm, got_mm, .. } if (asked_mm - got_mm).abs() > 1e-6))
            .collect();
        Ok((plan, warnings))
    }

    /// The cells with some layers above z = 0.
    pub(super) fn grid(&self, above: usize) -> Grid {
        let [nx, ny] = self.across;
        let origin = Vec3::new(nx as f64 / -2.0, ny as f64 / -2.0, -(self.below as f64)) * self.pitch;
        Grid {
            origin,
            pitch: self.pitch,
            cells: [nx, ny, self.below + above],
        }
    }

    pub(super) fn check_capacity(&self, grid: &Grid, block: &Block) -> Result<(), PatchError> {
        let nodes = grid.cells.map(|n| n + 1);
        let (count, nodes_max) = (nodes.iter().product(), block.nodes_max);
        if count <= nodes_max {
            return Ok(());
        }
        // Counts shrink a little less than with the cube of the pitch, because of the last node of each row and of rounding.
        let needed = |pitch: f64| {
            let finer = |n: usize| (n as f64 * self.pitch / pitch).ceil() as usize + 2;
            grid.cells.map(finer).iter().product::<usize>()
        };
        let mut fits_mm = round_up(self.pitch * (count as f64 / nodes_max.max(1) as f64).cbrt());
        let largest = block.size_mm.iter().copied().fold(0.0, f64::max);
        while needed(fits_mm) > nodes_max && fits_mm < largest {
            fits_mm = round_up(fits_mm * 1.01);
        }
        Err(PatchError::TooManyNodes {
            nodes,
            count,
            nodes_max,
            fits_mm,
        })
    }

    /// Whether a column is in the wound, or within `rim` cells of it.
    pub(super) fn is_wound(&self, column: [usize; 2], rim: usize) -> bool {
        (0..2).all(|axis| {
            let first = (self.across[axis] - self.wound[axis]) / 2;
            (first.saturating_sub(rim)..first + self.wound[axis] + rim).contains(&column[axis])
        })
    }

    pub(super) fn remove_wound(&self, cells: &mut [u8], grid: &Grid) -> usize {
        let [nx, ny, nz] = grid.cells;
        let mut removed = 0;
        for k in self.below - self.wound[2]..nz {
            for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
                let cell = &mut cells[grid.index([i, j, k])];
                if self.wound[2] > 0 && self.is_wound([i, j], 0) && *cell != 0 {
                    *cell = 0;
                    removed += 1;
                }
            }
        }
        removed
    }
}
