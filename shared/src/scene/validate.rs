//! Ranges of a scene: wide enough for any tissue and tool one can hold in a hand, narrow enough that no coefficient overflows.

use super::{
    Body, Device, Effect, Hand, KERNEL_PITCHES, Lattice, Motion, Output, Pose, STITCHES_MAX, Scene, Stitch, Thread,
    Tissue, Tool, Tremor, Until, Wound,
};
use crate::check::{Invalid, Validate, finite, require};
use crate::limits::{CELLS_MAX, THREAD_NODES_MAX};
use core::ops::RangeInclusive;

/// A range and how it reads.
type Range = (RangeInclusive<f32>, &'static str);

const PLACE_M: Range = (-100.0..=100.0, "-100 to 100 m");
const SIZE_M: Range = (1e-5..=0.5, "1e-5 to 0.5 m");
const STIFFNESS: Range = (0.0..=1e7, "0 to 1e7 N/m");
const DAMPING: Range = (0.0..=1e4, "0 to 1e4 N s/m");
const RATE: Range = (0.0..=1e5, "0 to 1e5 1/s");
const FORCE: Range = (0.0..=1e3, "0 to 1e3 N");
/// How far a unit vector's square may be from 1: some roundings of f32.
const UNIT: f32 = 1e-4;

fn within(value: f32, (range, expected): &Range, field: &'static str) -> Result<(), Invalid> {
    require(range.contains(&value), field, expected)
}

fn all_within(values: &[f32], range: &Range, field: &'static str) -> Result<(), Invalid> {
    values.iter().try_for_each(|value| within(*value, range, field))
}

fn unit(vector: &[f32], field: &'static str) -> Result<(), Invalid> {
    let square: f32 = vector.iter().map(|x| x * x).sum();
    require((square - 1.0).abs() <= UNIT, field, "unit length")
}

impl Scene {
    /// Checks the cells that come with the scene: one byte for each of the lattice's, none above the number of tissues.
    ///
    /// # Errors
    /// [`Invalid`] with the field `cells`.
    pub fn validate_cells(&self, cells: &[u8]) -> Result<(), Invalid> {
        let tissues = self.tissues.len();
        require(
            cells.len() == self.lattice.count(),
            "cells",
            "one byte for each cell of the lattice",
        )?;
        require(
            cells.iter().all(|cell| usize::from(*cell) <= tissues),
            "cells",
            "0 or 1 + a tissue's index",
        )
    }

    /// Each part is there exactly if its effect is on, and each effect has what it needs.
    fn validate_effects(&self) -> Result<(), Invalid> {
        let on = |effect| self.effects.has(effect);
        let implies = |a: bool, b: bool, expected| require(!a || b, "effects", expected);
        let known = Effect::ALL.iter().fold(0, |bits, effect| bits | *effect as u32);
        require(self.effects.0 & !known == 0, "effects", "known effects only")?;
        require(
            on(Effect::Puncture) == self.stitch.is_some(),
            "stitch",
            "a stitch if and only if effect puncture is on",
        )?;
        require(
            on(Effect::Thread) == self.thread.is_some(),
            "thread",
            "a thread if and only if effect thread is on",
        )?;
        implies(
            on(Effect::WoundContact),
            self.wound.is_some(),
            "a wound for wound-contact",
        )?;
        implies(
            on(Effect::Puncture),
            matches!(self.tool, Tool::Needle { .. }),
            "a needle for puncture",
        )?;
        let needs = [
            (Effect::ShaftFriction, Effect::Puncture, "puncture for shaft-friction"),
            (Effect::SkinTension, Effect::Puncture, "puncture for skin-tension"),
            (Effect::ThreadContact, Effect::Thread, "thread for thread-contact"),
            (Effect::ThreadFriction, Effect::Thread, "thread for thread-friction"),
            (Effect::Knot, Effect::Thread, "thread for knot"),
            (Effect::ThreadBending, Effect::Thread, "thread for thread-bending"),
            (Effect::Tearing, Effect::Thread, "thread for tearing"),
        ];
        needs
            .into_iter()
            .try_for_each(|(effect, needed, expected)| implies(on(effect), on(needed), expected))?;
        let waits = |test: fn(&Until) -> bool| {
            self.hand
                .iter()
                .flat_map(|hand| &hand.steps)
                .any(|step| test(&step.until))
        };
        implies(
            waits(|until| matches!(until, Until::Punctured(_))),
            on(Effect::Puncture),
            "puncture for a hand that waits for it",
        )?;
        implies(
            waits(|until| matches!(until, Until::Tension(_))),
            on(Effect::Thread),
            "thread for a hand that waits for tension",
        )
    }
}

impl Validate for Scene {
    fn validate(&self) -> Result<(), Invalid> {
        self.validate_effects()?;
        self.solver.validate()?;
        self.lattice.validate()?;
        require(!self.tissues.is_empty(), "tissues", "at least one")?;
        self.tissues.iter().try_for_each(Tissue::validate)?;
        self.tool.validate()?;
        let contact = &self.contact;
        within(contact.coupling_n_per_m, &STIFFNESS, "contact.coupling_n_per_m")?;
        within(contact.coupling_n_s_per_m, &DAMPING, "contact.coupling_n_s_per_m")?;
        within(contact.kernel_m, &SIZE_M, "contact.kernel_m")?;
        // A hair of room, for a kernel that was written in pitches and rounded.
        let [least, most] = KERNEL_PITCHES;
        let pitches = contact.kernel_m / self.lattice.pitch_m;
        require(
            (0.999_99 * least..=1.000_01 * most).contains(&pitches),
            "contact.kernel_m",
            "1.5 to 3.5 pitches",
        )?;
        self.stitch.iter().try_for_each(Stitch::validate)?;
        self.thread.iter().try_for_each(Thread::validate)?;
        self.wound.iter().try_for_each(|wound| wound.validate(&self.lattice))?;
        self.output.validate()?;
        self.device.validate()?;
        self.hand.iter().try_for_each(Hand::validate)
    }
}

impl Lattice {
    /// Number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.cells.iter().fold(1, |count, cells| count * usize::from(*cells))
    }

    fn validate(&self) -> Result<(), Invalid> {
        // Each extent first: on a 32-bit target the product of three u16 may wrap.
        let extents = self.cells.iter().all(|cells| (1..=256).contains(cells));
        require(
            extents && self.count() <= CELLS_MAX,
            "lattice.cells",
            "1 to 8192 cells, at most 256 a side",
        )?;
        within(self.pitch_m, &(1e-5..=0.1, "1e-5 to 0.1 m"), "lattice.pitch_m")?;
        all_within(&self.origin_m, &PLACE_M, "lattice.origin_m")?;
        self.law.validate()?;
        within(self.damping_per_s, &RATE, "lattice.damping_per_s")?;
        within(
            self.spring_damping_s,
            &(0.0..=10.0, "0 to 10 s"),
            "lattice.spring_damping_s",
        )
    }
}

impl Tissue {
    fn validate(&self) -> Result<(), Invalid> {
        within(
            self.density_kg_m3,
            &(1.0..=1e5, "1 to 1e5 kg/m3"),
            "tissue.density_kg_m3",
        )?;
        let Body::Soft {
            curve,
            sheet,
            strength_n,
        } = &self.body
        else {
            return Ok(());
        };
        require(
            curve.first().is_some_and(|segment| segment.from_strain.abs() <= 0.0),
            "tissue.curve",
            "a first segment from strain 0",
        )?;
        for segment in curve {
            within(
                segment.from_strain,
                &(0.0..=100.0, "0 to 100"),
                "tissue.curve.from_strain",
            )?;
            within(segment.slope_pa, &(1.0..=1e10, "1 to 1e10 Pa"), "tissue.curve.slope_pa")?;
        }
        let steps = || curve.iter().zip(curve.iter().skip(1));
        require(
            steps().all(|(a, b)| a.from_strain < b.from_strain),
            "tissue.curve.from_strain",
            "rising strains",
        )?;
        require(
            steps().all(|(a, b)| a.slope_pa <= b.slope_pa),
            "tissue.curve.slope_pa",
            "slopes that do not decrease",
        )?;
        within(*sheet, &(1e-3..=2.0, "1e-3 to 2"), "tissue.sheet")?;
        within(*strength_n, &(0.0..=1e4, "0 to 1e4 N"), "tissue.strength_n")
    }
}

impl Tool {
    fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Ball { radius_m } => within(*radius_m, &SIZE_M, "tool.radius_m"),
            Self::Needle {
                radius_m,
                length_m,
                grasp_m,
            } => {
                within(*radius_m, &SIZE_M, "tool.radius_m")?;
                within(*length_m, &SIZE_M, "tool.length_m")?;
                require(
                    (0.0..=*length_m).contains(grasp_m),
                    "tool.grasp_m",
                    "0 to the needle's length",
                )?;
                require(
                    *length_m < core::f32::consts::TAU * radius_m,
                    "tool.length_m",
                    "less than a full circle",
                )
            }
        }
    }
}

impl Stitch {
    fn validate(&self) -> Result<(), Invalid> {
        all_within(&self.a_m, &PLACE_M, "stitch.a_m")?;
        require(
            (1..=STITCHES_MAX).contains(&usize::from(self.count)),
            "stitch.count",
            "1 to 3",
        )?;
        within(self.spacing_m, &(0.0..=0.5, "0 to 0.5 m"), "stitch.spacing_m")?;
        all_within(&self.f0_n, &(1e-3..=1e3, "1e-3 to 1e3 N"), "stitch.f0_n")?;
        within(self.under_m, &(0.0..=0.5, "0 to 0.5 m"), "stitch.under_m")?;
        within(
            self.friction_n_per_m,
            &(0.0..=1e5, "0 to 1e5 N/m"),
            "stitch.friction_n_per_m",
        )?;
        within(self.cutting_n, &FORCE, "stitch.cutting_n")?;
        within(self.tension_gain, &(0.0..=1e3, "0 to 1000"), "stitch.tension_gain")
    }
}

impl Thread {
    fn validate(&self) -> Result<(), Invalid> {
        require(
            (2..=THREAD_NODES_MAX).contains(&self.nodes),
            "thread.nodes",
            "2 to 1024",
        )?;
        within(self.link_m, &SIZE_M, "thread.link_m")?;
        within(self.axial_n, &(1e-3..=1e6, "1e-3 to 1e6 N"), "thread.axial_n")?;
        within(
            self.mass_kg_per_m,
            &(1e-7..=1.0, "1e-7 to 1 kg/m"),
            "thread.mass_kg_per_m",
        )?;
        within(self.damping_per_s, &RATE, "thread.damping_per_s")?;
        within(self.penalty_n_per_m, &STIFFNESS, "thread.penalty_n_per_m")?;
        within(self.friction, &(0.0..=10.0, "0 to 10"), "thread.friction")?;
        within(self.knot_hold_n, &FORCE, "thread.knot_hold_n")?;
        within(
            self.bending_n_m2,
            &(0.0..=1e-3, "0 to 1e-3 N m2"),
            "thread.bending_n_m2",
        )
    }
}

impl Wound {
    fn validate(&self, lattice: &Lattice) -> Result<(), Invalid> {
        // One node more than cells along each axis, so an index up to the number of cells is in bounds.
        let [x, y, z] = lattice.cells;
        let [left, right] = self.faces;
        let [first, last] = self.rows;
        require(
            left < right && right <= x,
            "wound.faces",
            "two node columns of the lattice, left before right",
        )?;
        require(
            first <= last && last <= y,
            "wound.rows",
            "two node rows of the lattice, in order",
        )?;
        require(self.floor <= z, "wound.floor", "a node layer of the lattice")?;
        within(self.penalty_n_per_m, &STIFFNESS, "wound.penalty_n_per_m")
    }
}

impl Output {
    fn validate(&self) -> Result<(), Invalid> {
        within(self.scale, &(1e-3..=100.0, "1e-3 to 100"), "output.scale")?;
        within(self.slew_n, &(1e-4..=0.5, "1e-4 to 0.5 N a tick"), "output.slew_n")?;
        within(self.passivity_n_s_per_m, &DAMPING, "output.passivity_n_s_per_m")
    }
}

impl Device {
    fn validate(&self) -> Result<(), Invalid> {
        self.patch_from_device.validate("device.patch_from_device")
    }
}

impl Pose {
    fn validate(&self, field: &'static str) -> Result<(), Invalid> {
        all_within(&self.position_m, &PLACE_M, field)?;
        unit(&self.quaternion, field)
    }
}

impl Hand {
    fn validate(&self) -> Result<(), Invalid> {
        within(self.mass_kg, &(1e-3..=100.0, "1e-3 to 100 kg"), "hand.mass_kg")?;
        within(self.damping_n_s_per_m, &DAMPING, "hand.damping_n_s_per_m")?;
        within(self.stiffness_n_per_m, &STIFFNESS, "hand.stiffness_n_per_m")?;
        self.tremor.iter().try_for_each(Tremor::validate)?;
        self.start.validate("hand.start")?;
        self.steps.iter().try_for_each(|step| {
            require(
                (1..=10_000_000).contains(&step.ticks),
                "hand.steps.ticks",
                "1 to 10,000,000",
            )?;
            if let Until::Tension(tension) = step.until {
                within(tension, &FORCE, "hand.steps.until.tension")?;
            }
            step.motion.validate()
        })
    }
}

impl Tremor {
    fn validate(&self) -> Result<(), Invalid> {
        within(
            self.amplitude_m,
            &(0.0..=0.01, "0 to 0.01 m"),
            "hand.tremor.amplitude_m",
        )?;
        within(
            self.frequency_hz,
            &(0.0..=100.0, "0 to 100 Hz"),
            "hand.tremor.frequency_hz",
        )?;
        all_within(
            &self.phases_rad,
            &(-100.0..=100.0, "-100 to 100 rad"),
            "hand.tremor.phases_rad",
        )
    }
}

impl Motion {
    fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Line { to } => to.validate("hand.steps.to"),
            Self::Steady { to, speed_m_per_s } => {
                within(
                    *speed_m_per_s,
                    &(1e-4..=10.0, "1e-4 to 10 m/s"),
                    "hand.steps.speed_m_per_s",
                )?;
                to.validate("hand.steps.to")
            }
            Self::Turn {
                centre_m,
                axis,
                angle_rad,
            } => {
                all_within(centre_m, &PLACE_M, "hand.steps.centre_m")?;
                finite(axis, "hand.steps.axis")?;
                unit(axis, "hand.steps.axis")?;
                within(*angle_rad, &(-100.0..=100.0, "-100 to 100 rad"), "hand.steps.angle_rad")
            }
            Self::Hold => Ok(()),
        }
    }
}
