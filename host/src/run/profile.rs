//! The wound along its length: how its edges stand, row by row, ten times a second and at the end.

use std::io::{self, Write};

use sutura_controller::wound::Edges;

/// Ticks from one profile to the next.
const EVERY: usize = 100;

/// The profiles that are kept, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profiles(Vec<Profile>);

/// The wound after one tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Number of the tick, from 1.
    pub tick: usize,
    /// Place along the wound at rest [m], and how the edges stand there.
    pub rows: Vec<(f32, Edges)>,
}

impl Profiles {
    /// Takes the wound after `tick`: every hundredth is kept, and the last.
    pub fn see(&mut self, tick: usize, rows: Vec<(f32, Edges)>) {
        self.0.pop_if(|last| last.tick > 1 && !last.tick.is_multiple_of(EVERY));
        self.0.push(Profile { tick, rows });
    }

    /// The profiles.
    #[must_use]
    pub fn all(&self) -> &[Profile] {
        &self.0
    }

    /// Writes `tick,y_mm,gap_mm,step_mm`.
    ///
    /// # Errors
    /// The file system refuses.
    pub fn table(&self, file: &mut impl Write) -> io::Result<()> {
        writeln!(file, "tick,y_mm,gap_mm,step_mm")?;
        for Profile { tick, rows } in &self.0 {
            for (along, Edges { gap, step }) in rows {
                writeln!(file, "{tick},{},{},{}", along * 1e3, gap * 1e3, step * 1e3)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_every_hundredth_and_the_last_are_kept() {
        let mut profiles = Profiles::default();
        for tick in 1..=342 {
            profiles.see(tick, vec![(0.002, Edges { gap: 0.004, step: 0.0 })]);
        }
        let ticks: Vec<_> = profiles.all().iter().map(|profile| profile.tick).collect();
        assert_eq!(ticks, [1, 100, 200, 300, 342]);
        let mut text = Vec::new();
        profiles.table(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert!(text.ends_with("342,2,4,0\n"), "{text}");
    }
}
