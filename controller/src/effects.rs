//! The table of effects: what each simulates, where in the tick, with what memory, and by which keys of a scene file.
//!
//! The names and bits stand in [`sutura_shared::scene::Effect`], the behaviour in the modules below; here is what the two have to do with each
//! other. The host checks scene files against it, prints it as a run's manifest and measures along it. The tick does not read it, so an image
//! without a host carries none of its text.

pub mod key;

use core::mem::size_of;

use crate::coupling::{D, PUNCTURES};
use crate::lattice::{CURVES, DIRECTIONS};
use crate::law::Breaks;
use crate::math::{Mat3, Vec3};
use crate::needle::{Passage, Point};
use crate::thread::{self, Grip, NODES_MAX, Touch};
use crate::wound::PAIRS_MAX;
use sutura_shared::scene::Effect;

/// A part of the tick, in its order; see [`crate::tick`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The device's pose in the patch.
    Sense,
    /// Where the tool meets the tissue.
    Contact,
    /// The thread, condensed onto the points that hold it.
    Thread,
    /// The tissue's own step.
    Deform,
    /// What the hand feels.
    Force,
    /// The output edge.
    Safety,
}

impl Part {
    /// The name in tables, files and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sense => "sense",
            Self::Contact => "contact",
            Self::Thread => "thread",
            Self::Deform => "deform",
            Self::Force => "force",
            Self::Safety => "safety",
        }
    }
}

/// A key of a scene file that an effect has for its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The effect, without which the key may not stand.
    pub effect: Effect,
    /// Section and key.
    pub name: &'static str,
    /// Its unit, as the name has it.
    pub unit: &'static str,
    /// Least and greatest value; what else the scene holds may narrow it.
    pub range: [f64; 2],
    /// What stands for a key that is left out: a number, as many as the key lists, or no number at all.
    pub default: &'static [f64],
}

/// One effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Which.
    pub effect: Effect,
    /// What is simulated.
    pub simulates: &'static str,
    /// Where in the tick it works.
    pub parts: &'static [Part],
    /// What it has to remember, or to hold ready.
    pub state: &'static str,
    /// Memory for it alone, apart from what grows with the patch [bytes]. It is set aside whether the effect is on or off.
    pub bytes: usize,
    /// The same for each node of the patch [bytes].
    pub bytes_per_node: usize,
    /// The effect without which it changes nothing.
    pub needs: Option<Effect>,
    /// Sections of a scene file without which it has nothing to work on.
    pub asks: &'static [&'static str],
    /// The section of a scene file that may not stand without it.
    pub section: Option<&'static str>,
    /// Its keys.
    pub keys: &'static [Key],
}

impl Row {
    /// Memory for it on a patch of `nodes` [bytes].
    #[must_use]
    pub const fn bytes_on(&self, nodes: usize) -> usize {
        self.bytes + self.bytes_per_node * nodes
    }
}

/// The row of `effect`.
#[must_use]
pub const fn row(effect: Effect) -> &'static Row {
    let [
        gravity,
        stiffening,
        spring_damping,
        puncture,
        shaft_friction,
        thread,
        thread_contact,
        wound_contact,
        passivity,
        barrier,
        skin_tension,
        thread_friction,
        knot,
        thread_bending,
        tearing,
    ] = &TABLE;
    match effect {
        Effect::Gravity => gravity,
        Effect::Stiffening => stiffening,
        Effect::SpringDamping => spring_damping,
        Effect::Puncture => puncture,
        Effect::ShaftFriction => shaft_friction,
        Effect::Thread => thread,
        Effect::ThreadContact => thread_contact,
        Effect::WoundContact => wound_contact,
        Effect::Passivity => passivity,
        Effect::Barrier => barrier,
        Effect::SkinTension => skin_tension,
        Effect::ThreadFriction => thread_friction,
        Effect::Knot => knot,
        Effect::ThreadBending => thread_bending,
        Effect::Tearing => tearing,
    }
}

/// Every effect, in the order of [`Effect::ALL`].
pub const TABLE: [Row; 15] = [
    Row {
        effect: Effect::Gravity,
        simulates: "the thread's weight",
        parts: &[Part::Thread],
        state: "none",
        bytes: 0,
        bytes_per_node: 0,
        needs: Some(Effect::Thread),
        asks: &[],
        section: None,
        keys: &[],
    },
    Row {
        effect: Effect::Stiffening,
        simulates: "stress-strain curves of several slopes, and diagonals that lock where a voxel loses volume",
        parts: &[Part::Deform],
        state: "breakpoints of the curves; springs of the second curve and of those after it",
        bytes: CURVES * 2 * size_of::<Breaks>(),
        bytes_per_node: (CURVES - 1) * DIRECTIONS * size_of::<f32>(),
        needs: None,
        asks: &[],
        section: None,
        keys: &[key::BREAKS],
    },
    Row {
        effect: Effect::SpringDamping,
        simulates: "dashpots along the springs",
        parts: &[Part::Deform],
        state: "none",
        bytes: 0,
        bytes_per_node: 0,
        needs: None,
        asks: &[],
        section: None,
        keys: &[key::SPRING_DAMPING],
    },
    Row {
        effect: Effect::Puncture,
        simulates: "the needle passes skin and wound faces at F0, from site a to site d",
        parts: &[Part::Contact, Part::Deform, Part::Force],
        state: "how far the sites b to d are passed",
        bytes: 3 * size_of::<Passage>(),
        bytes_per_node: 0,
        needs: None,
        asks: &["needle"],
        section: Some("stitch"),
        keys: &[key::BITE, key::STITCHES, key::SPACING, key::F0, key::UNDER],
    },
    Row {
        effect: Effect::ShaftFriction,
        simulates: "friction of the needle's shaft in the tissue, and the force of its cutting tip",
        parts: &[Part::Contact, Part::Force],
        state: "where the shaft adheres and how far the tip has cut, at every site",
        bytes: 8 * size_of::<f32>(),
        bytes_per_node: 0,
        needs: Some(Effect::Puncture),
        asks: &[],
        section: None,
        keys: &[key::FRICTION, key::CUTTING],
    },
    Row {
        effect: Effect::Thread,
        simulates: "the suture thread, from the needle through every puncture that it has left to the tail",
        parts: &[Part::Thread, Part::Deform, Part::Force],
        state: "places and velocities of its nodes, their elimination, the points that hold it in earlier stitches",
        bytes: size_of::<thread::State>() + size_of::<thread::Work>() + (1 + PUNCTURES - D) * size_of::<Point>()
            - LYING
            - RUBBING
            - BENDING,
        bytes_per_node: 0,
        needs: Some(Effect::Puncture),
        asks: &[],
        section: Some("thread"),
        keys: &[
            key::LENGTH,
            key::LINK,
            key::AXIAL,
            key::MASS,
            key::DAMPING,
            key::PULL,
            key::TIGHTEN,
            key::TENSION,
        ],
    },
    Row {
        effect: Effect::ThreadContact,
        simulates: "the thread lies on the skin and weighs on it",
        parts: &[Part::Thread, Part::Deform],
        state: "the ground under each of its nodes and what it bears; loads on the patch",
        bytes: LYING,
        bytes_per_node: size_of::<Vec3>(),
        needs: Some(Effect::Thread),
        asks: &[],
        section: None,
        keys: &[key::THREAD_PENALTY],
    },
    Row {
        effect: Effect::WoundContact,
        simulates: "the faces of the wound do not pass through each other",
        parts: &[Part::Deform],
        state: "pairs of facing nodes and which of them meet",
        bytes: PAIRS_MAX * (size_of::<u16>() + size_of::<f32>()),
        bytes_per_node: 0,
        needs: None,
        asks: &["wound"],
        section: None,
        keys: &[key::WOUND_PENALTY],
    },
    Row {
        effect: Effect::Passivity,
        simulates: "damping at the output edge where the rendered force would give out energy",
        parts: &[Part::Safety],
        state: "energy that the rendering has absorbed, the tip's last place",
        bytes: size_of::<f32>() + size_of::<Option<Vec3>>(),
        bytes_per_node: 0,
        needs: None,
        asks: &[],
        section: None,
        keys: &[key::PASSIVITY],
    },
    Row {
        effect: Effect::Barrier,
        simulates: "voxels that are pressed flat push back, and none stays inside out",
        parts: &[Part::Deform],
        state: "the barrier of each voxel, and its part of the operator",
        bytes: 0,
        bytes_per_node: BARRIER_FIELDS * size_of::<f32>(),
        needs: None,
        asks: &[],
        section: None,
        keys: &[],
    },
    Row {
        effect: Effect::SkinTension,
        simulates: "skin under tension is harder to puncture",
        parts: &[Part::Contact],
        state: "none",
        bytes: 0,
        bytes_per_node: 0,
        needs: Some(Effect::Puncture),
        asks: &[],
        section: None,
        keys: &[key::TENSION_GAIN],
    },
    Row {
        effect: Effect::ThreadFriction,
        simulates: "Coulomb friction of the thread at every puncture that it runs through, right while it slides slowly",
        parts: &[Part::Thread],
        state: "where the thread adheres, and its drag, at every puncture",
        bytes: RUBBING,
        bytes_per_node: 0,
        needs: Some(Effect::Thread),
        asks: &[],
        section: None,
        keys: &[key::THREAD_FRICTION],
    },
    Row {
        effect: Effect::Knot,
        simulates: "a knot that holds the thread at the last puncture, up to a limit",
        parts: &[Part::Thread],
        state: "rest lengths on both sides of the knot",
        bytes: size_of::<Option<[f32; 2]>>(),
        bytes_per_node: 0,
        needs: Some(Effect::Thread),
        asks: &[],
        section: None,
        keys: &[key::KNOT_HOLD],
    },
    Row {
        effect: Effect::ThreadBending,
        simulates: "the thread resists bending and being pushed, and leaves the needle along its arc",
        parts: &[Part::Thread],
        state: "how each of its nodes moves with the one after the next",
        bytes: BENDING,
        bytes_per_node: 0,
        needs: Some(Effect::Thread),
        asks: &[],
        section: None,
        keys: &[key::BENDING],
    },
    Row {
        effect: Effect::Tearing,
        simulates: "a thread that pulls harder than the tissue bears cuts its way, as far as the wound's edge",
        parts: &[Part::Force],
        state: "how far it has cut",
        bytes: size_of::<f32>(),
        bytes_per_node: 0,
        needs: Some(Effect::Thread),
        asks: &[],
        section: None,
        keys: &[key::STRENGTH],
    },
];

/// Numbers of a voxel: its barrier, the slopes of its volume along three mean edges, its pressure.
const BARRIER_FIELDS: usize = 1 + 3 * 3 + 1;

/// The ground under each node of a thread, and the node's force on it.
const LYING: usize = NODES_MAX * (size_of::<Option<Touch>>() + size_of::<Vec3>());

/// How a thread holds at each puncture.
const RUBBING: usize = PUNCTURES * size_of::<Grip>();

/// What a thread that bends keeps of its elimination.
const BENDING: usize = NODES_MAX * size_of::<Mat3>();

/// Every effect has its row, once and in order; a row's keys are its own, and their defaults are in range.
const _: () = {
    let mut rows: &[Row] = &TABLE;
    let mut all: &[Effect] = &Effect::ALL;
    while let ([row, other_rows @ ..], [effect, others @ ..]) = (rows, all) {
        assert!(
            row.effect as u32 == *effect as u32,
            "the rows stand in the order of Effect::ALL"
        );
        let mut keys = row.keys;
        while let [key, other_keys @ ..] = keys {
            assert!(
                key.effect as u32 == row.effect as u32,
                "a key belongs to its row's effect"
            );
            let [low, high] = key.range;
            let mut default = key.default;
            while let [value, more @ ..] = default {
                assert!(low <= *value && *value <= high, "a default lies in its key's range");
                default = more;
            }
            keys = other_keys;
        }
        (rows, all) = (other_rows, others);
    }
    assert!(rows.is_empty() && all.is_empty(), "as many rows as effects");
};
