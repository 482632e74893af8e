//! Needles by their makers' names, and what one can sew.

use sutura_shared::scene::Tool;

/// Length of needle that the jaws of a driver take [mm], our choice: as much must stay out of the skin before a when the tip is through, and
/// as much of the tip beyond d for the next grasp.
pub const JAWS_MM: f64 = 1.5;
/// Half the distance of the punctures over the needle's radius, at most: beyond it the needle meets the skin too flat.
const WIDEST: f64 = 0.95;

/// A needle of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Part of a circle.
    pub arc_of_circle: f64,
    /// From tip to swage along the arc [mm].
    pub length_mm: f64,
}

/// The needles that a scene may name, from the shortest on.
pub const KINDS: [Kind; 6] = [
    kind("P-3", 0.375, 13.0),
    kind("FS-2", 0.375, 19.0),
    kind("PS-2", 0.375, 19.0),
    kind("FS-1", 0.375, 24.0),
    kind("SH", 0.5, 26.0),
    kind("CT-1", 0.5, 36.0),
];

const fn kind(name: &'static str, arc_of_circle: f64, length_mm: f64) -> Kind {
    Kind {
        name,
        arc_of_circle,
        length_mm,
    }
}

/// A needle in its driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Needle {
    /// Radius of the arc [mm].
    pub radius_mm: f64,
    /// Arc length from the driver to the tip [mm].
    pub ahead_mm: f64,
}

impl Needle {
    /// That of a scene; none for a ball.
    #[must_use]
    pub fn of(tool: &Tool) -> Option<Self> {
        match *tool {
            Tool::Needle {
                radius_m,
                length_m,
                grasp_m,
            } => Some(Self {
                radius_mm: f64::from(radius_m) * 1e3,
                ahead_mm: f64::from(length_m - grasp_m) * 1e3,
            }),
            Tool::Ball { .. } => None,
        }
    }

    /// A needle of the catalogue, held at this part of its length from the swage.
    fn named(kind: &Kind, grasp: f64) -> Self {
        Self {
            radius_mm: kind.length_mm / (kind.arc_of_circle * std::f64::consts::TAU),
            ahead_mm: kind.length_mm * (1.0 - grasp),
        }
    }

    /// Arc between punctures at a distance of twice `half_mm`, and both jaws [mm].
    #[must_use]
    pub fn needed_mm(&self, half_mm: f64) -> f64 {
        2.0 * self.radius_mm * (half_mm / self.radius_mm).min(1.0).asin() + 2.0 * JAWS_MM
    }

    /// Half the largest distance of punctures that it can make [mm].
    #[must_use]
    pub fn widest_mm(&self) -> f64 {
        let turn = (self.ahead_mm - 2.0 * JAWS_MM).max(0.0) / (2.0 * self.radius_mm);
        self.radius_mm * turn.min(std::f64::consts::FRAC_PI_2).sin().min(WIDEST)
    }

    /// How deep it goes below the skin between such punctures [mm].
    #[must_use]
    pub fn depth_mm(&self, half_mm: f64) -> f64 {
        self.radius_mm - (self.radius_mm * self.radius_mm - half_mm * half_mm).max(0.0).sqrt()
    }
}

/// The shortest needle of the catalogue that can make such punctures within `depth_mm` of tissue, held at this part of its length.
#[must_use]
pub fn that_can(half_mm: f64, depth_mm: f64, grasp: f64) -> Option<&'static str> {
    let can = |kind: &&Kind| {
        let needle = Needle::named(kind, grasp);
        half_mm <= needle.widest_mm() && needle.depth_mm(half_mm) <= depth_mm
    };
    KINDS.iter().find(can).map(|kind| kind.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Radii and chords as catalogues have them: FS-2 8.06 and 14.9 mm, P-3 5.52 and 10.2, FS-1 10.2 and 18.8, SH 8.28 and 16.6, CT-1 11.5 and 22.9.
    #[test]
    fn needles_have_their_radii_and_chords() {
        let catalogue = [
            ("P-3", 5.52, 10.2),
            ("FS-2", 8.06, 14.9),
            ("PS-2", 8.06, 14.9),
            ("FS-1", 10.2, 18.8),
            ("SH", 8.28, 16.6),
            ("CT-1", 11.5, 22.9),
        ];
        for (kind, (name, radius, chord)) in KINDS.iter().zip(catalogue) {
            let radius_mm = Needle::named(kind, 1.0 / 3.0).radius_mm;
            let chord_mm = 2.0 * radius_mm * (std::f64::consts::PI * kind.arc_of_circle).sin();
            assert_eq!(kind.name, name);
            assert!(
                (radius_mm / radius - 1.0).abs() < 5e-3 && (chord_mm / chord - 1.0).abs() < 5e-3,
                "{name}"
            );
        }
    }

    /// A half circle of 26 mm has R = 8.276 mm. Held at a third it has 17.33 mm ahead, of which 14.33 mm may be inside: a turn of 2·0.866, so half a
    /// distance of 8.276·sin 0.866 = 6.304 mm.
    #[test]
    fn the_widest_stitch_leaves_both_jaws() {
        let needle = Needle::named(&KINDS[4], 1.0 / 3.0);
        assert!((needle.widest_mm() - 6.304).abs() < 1e-3, "{}", needle.widest_mm());
        assert!((needle.needed_mm(needle.widest_mm()) - needle.ahead_mm).abs() < 1e-9);
    }

    #[test]
    fn the_shortest_needle_that_can_is_named() {
        // At 6 mm an FS-1 goes 1.95 mm deep and a CT-1 1.70 mm: R − √(R² − 36).
        for (half, depth, grasp, expected) in [
            (3.0, 10.0, 1.0 / 3.0, Some("FS-2")),
            (6.0, 10.0, 1.0 / 3.0, Some("FS-1")),
            (6.0, 1.9, 1.0 / 3.0, Some("CT-1")),
            (6.0, 1.6, 1.0 / 3.0, None),
            (8.5, 10.0, 1.0 / 3.0, Some("CT-1")),
            (11.0, 10.0, 1.0 / 3.0, None),
        ] {
            assert_eq!(that_can(half, depth, grasp), expected, "{half} {depth}");
        }
    }
}
