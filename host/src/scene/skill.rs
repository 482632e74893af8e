//! Skills of scripted hands: how far what a person does lies from what the script says.
//!
//! A person is a skill and a seed. Each quantity is drawn once, evenly within its range, before the hand begins, and all skills draw in the
//! same order: a seed is the luck of a day, a skill is what it acts on. Nothing here looks at the tissue.

use std::f64::consts::{PI, SQRT_2};

use serde::{Serialize, Serializer};
use sutura_shared::scene::Tremor;

/// Physiological tremor [Hz] (Novak & Newell 2017, doi 10.1016/j.neulet.2017.01.034).
const TREMOR_HZ: Range = about(10.0, 2.0);

/// The skills that `--operator` may name, from the best on.
///
/// Which quantities there are follows what is scored by itself in checklists, or tells experts from novices in studies (the card of [`crate::score`]
/// names them). Sourced: the pull, for a novice's largest force on a suture task is 1.8 times an expert's (Horeman 2010: 4.7 N beside 2.6 N);
/// the tremor, 0.03 mm in a finger at rest and four to five times as much with the arm held out (Growdon 2000), 0.05 mm root mean square in
/// surgeons who hold still (Riviere 1997). All other numbers are our choice.
pub const SKILLS: [Skill; 3] = [
    Skill {
        name: "expert",
        flatter_deg: about(0.0, 1.0),
        bite_mm: about(0.0, 0.2),
        centre_mm: about(0.0, 0.15),
        pace: about(1.0, 0.1),
        pull: about(1.0, 0.05),
        tremor_mm: about(0.04, 0.01),
    },
    Skill {
        name: "novice",
        flatter_deg: about(9.0, 3.0),
        bite_mm: about(-0.5, 0.4),
        centre_mm: about(0.0, 0.5),
        pace: about(0.7, 0.15),
        pull: about(1.7, 0.15),
        tremor_mm: about(0.08, 0.02),
    },
    Skill {
        name: "clumsy",
        flatter_deg: about(13.0, 3.0),
        bite_mm: about(-0.6, 0.5),
        centre_mm: about(0.0, 1.0),
        pace: about(1.3, 0.2),
        pull: about(2.2, 0.2),
        tremor_mm: about(0.13, 0.02),
    },
];

/// What hands of one skill have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skill {
    /// Its name.
    pub name: &'static str,
    /// By how much the needle meets the skin flatter than its circle would [°].
    pub flatter_deg: Range,
    /// By how much each bite is longer than the scene's [mm].
    pub bite_mm: Range,
    /// How far the turning centre is off that of the needle's circle, along x and along z [mm].
    pub centre_mm: Range,
    /// Every speed over the script's.
    pub pace: Range,
    /// The tension at which the knot is laid over the script's.
    pub pull: Range,
    /// Root mean square of the tremor along each axis [mm].
    pub tremor_mm: Range,
}

/// Numbers up to `spread` to either side of `mean`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The middle.
    pub mean: f64,
    /// From there to either end.
    pub spread: f64,
}

const fn about(mean: f64, spread: f64) -> Range {
    Range { mean, spread }
}

/// Whose hand it is; in JSON `operator` and `seed`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Person {
    /// What the hand can do.
    #[serde(rename = "operator", serialize_with = "name")]
    pub skill: &'static Skill,
    /// What distinguishes it from others of this skill.
    pub seed: u32,
}

fn name<S: Serializer>(skill: &&Skill, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(skill.name)
}

/// What one hand does otherwise than the script.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manner {
    /// By how much the needle meets the skin flatter than its circle would [rad].
    pub flatter_rad: f64,
    /// By how much the bites at entry and exit are longer [m].
    pub bites_m: [f64; 2],
    /// The turning centre from that of the needle's circle, along x and z [m].
    pub centre_m: [f64; 2],
    /// Every speed over the script's.
    pub pace: f64,
    /// The tension at which the knot is laid over the script's.
    pub pull: f64,
    /// The tremor.
    pub tremor: Option<Tremor>,
}

impl Manner {
    /// Nothing.
    pub const SCRIPT: Self = Self {
        flatter_rad: 0.0,
        bites_m: [0.0; 2],
        centre_m: [0.0; 2],
        pace: 1.0,
        pull: 1.0,
        tremor: None,
    };
}

impl Skill {
    /// The skill of this name.
    ///
    /// # Errors
    /// [`NoSkill`].
    pub fn named(name: &str) -> Result<&'static Self, NoSkill> {
        SKILLS.iter().find(|skill| skill.name == name).ok_or(NoSkill)
    }
}

/// There is no skill of this name; one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there are {}", SKILLS.map(|skill| skill.name).join(", "))]
pub struct NoSkill;

impl Person {
    /// What this hand does otherwise than the script.
    #[must_use]
    pub fn manner(&self) -> Manner {
        let mut draws = Draws(self.seed.into());
        let mut draw = |range: Range| range.mean + range.spread * draws.next();
        let skill = self.skill;
        Manner {
            flatter_rad: draw(skill.flatter_deg).to_radians(),
            bites_m: [skill.bite_mm; 2].map(|range| draw(range) * 1e-3),
            centre_m: [skill.centre_mm; 2].map(|range| draw(range) * 1e-3),
            pace: draw(skill.pace),
            pull: draw(skill.pull),
            tremor: Some(Tremor {
                amplitude_m: (draw(skill.tremor_mm) * 1e-3 * SQRT_2) as f32,
                frequency_hz: draw(TREMOR_HZ) as f32,
                phases_rad: [about(0.0, PI); 3].map(|range| draw(range) as f32),
            }),
        }
    }
}

/// Even draws: SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2660193.2660195).
struct Draws(u64);

impl Draws {
    /// 64 bits.
    const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from −1 up to, but not including, 1: a double holds 53 of the bits.
    const fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The generator's first numbers from 1234567, as its authors' C code prints them.
    #[test]
    fn draws_are_split_mix() {
        let mut draws = Draws(1_234_567);
        for expected in [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ] {
            assert_eq!(draws.bits(), expected);
        }
    }

    /// Even within [−1, 1): mean 0 and variance 1/3, which 4,000 draws meet within four standard errors, 4·√(1/3/4000) and 4·√(4/45/4000).
    #[test]
    fn draws_are_even() {
        let mut draws = Draws(7);
        let drawn: Vec<f64> = (0..4000).map(|_| draws.next()).collect();
        assert!(drawn.iter().all(|x| (-1.0..1.0).contains(x)));
        let mean = drawn.iter().sum::<f64>() / 4000.0;
        let square = drawn.iter().map(|x| x * x).sum::<f64>() / 4000.0;
        assert!(
            mean.abs() < 0.037 && (square - 1.0 / 3.0).abs() < 0.019,
            "{mean} {square}"
        );
    }

    #[test]
    fn a_hand_keeps_to_its_skill_and_repeats_by_its_seed() {
        for skill in &SKILLS {
            for seed in 0..100 {
                let person = Person { skill, seed };
                let manner = person.manner();
                assert_eq!(manner, person.manner());
                assert_ne!(manner, Person { skill, seed: seed + 1 }.manner());
                let within =
                    |value: f64, range: Range| (value - range.mean).abs() <= range.spread * (1.0 + 1e-6) + 1e-12;
                assert!(within(manner.flatter_rad.to_degrees(), skill.flatter_deg));
                assert!(manner.bites_m.iter().all(|bite| within(bite * 1e3, skill.bite_mm)));
                assert!(manner.centre_m.iter().all(|way| within(way * 1e3, skill.centre_mm)));
                assert!(within(manner.pace, skill.pace) && within(manner.pull, skill.pull));
                let tremor = manner.tremor.unwrap();
                assert!(within(f64::from(tremor.amplitude_m) * 1e3 / SQRT_2, skill.tremor_mm));
                assert!(within(f64::from(tremor.frequency_hz), TREMOR_HZ));
            }
        }
    }

    #[test]
    fn an_unknown_skill_names_those_that_there_are() {
        for skill in &SKILLS {
            assert_eq!(Skill::named(skill.name), Ok(skill));
        }
        let line = Skill::named("master").unwrap_err().to_string();
        assert_eq!(line, "there are expert, novice, clumsy");
    }
}
