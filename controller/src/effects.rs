//! The table of effects: what each simulates, where in the tick, with what memory, and by which keys of a scene file.
//!
//! The names and bits stand in [`sutura_shared::scene::Effect`], the behaviour in the modules below; here is what the two have to do with each
//! other. The host checks scene files against it, prints it as a run's manifest and measures along it. The tick does not read it, so an image
//! without a host carries none of its text.

use core::mem::size_of;

use crate::coupling::PUNCTURES;
use crate::lattice::{CURVES, DIRECTIONS};
use crate::law::Breaks;
use crate::math::Vec3;
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
    }
}

/// Every effect, in the order of [`Effect::ALL`].
pub const TABLE: [Row; 13] = [
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
        keys: &[key::BITE, key::F0, key::UNDER],
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
        simulates: "the suture thread, from the needle through site d to site a",
        parts: &[Part::Thread, Part::Deform, Part::Force],
        state: "places and velocities of its nodes, their elimination, the point that holds its tail",
        bytes: size_of::<thread::State>() + size_of::<thread::Work>() + size_of::<Point>() - LYING - RUBBING,
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
];

/// Numbers of a voxel: its barrier, the slopes of its volume along three mean edges, its pressure.
const BARRIER_FIELDS: usize = 1 + 3 * 3 + 1;

/// The ground under each node of a thread, and the node's force on it.
const LYING: usize = NODES_MAX * (size_of::<Option<Touch>>() + size_of::<Vec3>());

/// How a thread holds at each puncture.
const RUBBING: usize = PUNCTURES * size_of::<Grip>();

/// The keys of all effects. Defaults are those of the built-in scene: a 3-0 nylon thread, a stitch with an SH needle through skin.
pub mod key {
    use crate::effects::Key;
    use sutura_shared::scene::Effect;

    /// Strains between the slopes of a stress–strain curve; none for a curve of one slope.
    pub const BREAKS: Key = key(Effect::Stiffening, "tissue.breaks_percent", "%", [0.1, 500.0], &[]);
    /// Time constant of the dashpots.
    pub const SPRING_DAMPING: Key = key(
        Effect::SpringDamping,
        "patch.spring_damping_ms",
        "ms",
        [0.01, 100.0],
        &[1.0],
    );
    /// From the wound's edge to a puncture; what the needle reaches and the patch holds narrows it.
    pub const BITE: Key = key(Effect::Puncture, "stitch.bite_mm", "mm", [0.5, 500.0], &[4.0]);
    /// Puncture force by site. a: reverse-cutting PS-2 on abdominal skin (Maloney); d: 0.7 of it, the second of the two peaks that Frick 2001
    /// found. b and c are our choice: what lies under the skin gives way at a third of that, with the same ratio of exit to entry.
    pub const F0: Key = key(
        Effect::Puncture,
        "stitch.f0_n",
        "N",
        [0.05, 20.0],
        &[0.95, 0.21, 0.3, 0.665],
    );
    /// Growth of F0 with the skin's strain. That it grows is Frick's finding (2001, tensions of 0.98 to 4.9 N); by how much is our choice.
    pub const TENSION_GAIN: Key = key(Effect::SkinTension, "stitch.tension_gain", "1", [0.0, 100.0], &[2.0]);
    /// Distance from a surface at which the tip, coming from inside, begins to lift it.
    pub const UNDER: Key = key(Effect::Puncture, "stitch.under_mm", "mm", [0.1, 20.0], &[0.5]);
    /// Friction per length of shaft in the tissue.
    pub const FRICTION: Key = key(
        Effect::ShaftFriction,
        "stitch.friction_n_per_mm",
        "N/mm",
        [0.0, 1.0],
        &[0.02],
    );
    /// Force of the cutting tip.
    pub const CUTTING: Key = key(Effect::ShaftFriction, "stitch.cutting_n", "N", [0.0, 5.0], &[0.2]);
    /// Length of the thread; two links at least, and no more than the controller holds.
    pub const LENGTH: Key = key(Effect::Thread, "thread.length_mm", "mm", [4.0, 5100.0], &[115.0]);
    /// Length of one link; an eyelet has room for one node at a time.
    pub const LINK: Key = key(Effect::Thread, "thread.link_mm", "mm", [2.0, 20.0], &[5.0]);
    /// Axial stiffness EA.
    pub const AXIAL: Key = key(Effect::Thread, "thread.axial_n", "N", [0.1, 1000.0], &[76.0]);
    /// Mass per length.
    pub const MASS: Key = key(Effect::Thread, "thread.mass_mg_per_m", "mg/m", [1.0, 1e4], &[43.0]);
    /// Damping over mass.
    pub const DAMPING: Key = key(Effect::Thread, "thread.damping_per_s", "1/s", [0.0, 1000.0], &[20.0]);
    /// Speed of the sewing hand while the thread is slack.
    pub const PULL: Key = key(
        Effect::Thread,
        "operator.sew.pull_mm_per_s",
        "mm/s",
        [1.0, 500.0],
        &[70.0],
    );
    /// Speed of the sewing hand while the thread is taut.
    pub const TIGHTEN: Key = key(
        Effect::Thread,
        "operator.sew.tighten_mm_per_s",
        "mm/s",
        [0.5, 100.0],
        &[12.0],
    );
    /// Tension at which the sewing hand lays the knot.
    pub const TENSION: Key = key(Effect::Thread, "operator.sew.tension_n", "N", [0.05, 10.0], &[1.3]);
    /// Penalty stiffness of the skin under the thread, k of Lian & Chen Eq. 8.
    pub const THREAD_PENALTY: Key = key(
        Effect::ThreadContact,
        "thread.penalty_n_per_m",
        "N/m",
        [1.0, 1e5],
        &[200.0],
    );
    /// Coefficient of friction between thread and tissue: 0.1 to 0.3, braided thread at the high end. The tensions are within 3 % of the
    /// capstan's law at slides of up to 4 mm/s; at 20 mm/s they are 3 to 17 % above it.
    pub const THREAD_FRICTION: Key = key(Effect::ThreadFriction, "thread.friction", "", [0.0, 2.0], &[0.2]);
    /// What the knot holds: above what 3-0 polypropylene breaks at where it is knotted, 18.9 N (Naleway et al. 2015).
    pub const KNOT_HOLD: Key = key(Effect::Knot, "thread.knot_hold_n", "N", [0.01, 100.0], &[20.0]);
    /// Contact stiffness of a pair of facing nodes.
    pub const WOUND_PENALTY: Key = key(
        Effect::WoundContact,
        "wound.penalty_n_per_m",
        "N/m",
        [1.0, 1e5],
        &[8000.0],
    );
    /// Cap of the passivity damping.
    pub const PASSIVITY: Key = key(
        Effect::Passivity,
        "output.passivity_n_s_per_m",
        "N s/m",
        [0.1, 50.0],
        &[5.0],
    );

    const fn key(
        effect: Effect,
        name: &'static str,
        unit: &'static str,
        range: [f64; 2],
        default: &'static [f64],
    ) -> Key {
        Key {
            effect,
            name,
            unit,
            range,
            default,
        }
    }
}

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
