//! The keys of all effects. Defaults are those of the built-in scene: a 3-0 nylon thread, a stitch with an SH needle through skin.

use crate::effects::Key;
use sutura_shared::scene::{Effect, STITCHES_MAX};

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
/// How many stitches the thread sews, one if none are named; more than one need effect `thread`.
pub const STITCHES: Key = key(Effect::Puncture, "stitch.stitches", "", [1.0, STITCHES_MAX as f64], &[]);
/// From one stitch to the next along the wound; several stitches need it.
pub const SPACING: Key = key(Effect::Puncture, "stitch.spacing_mm", "mm", [1.0, 100.0], &[]);
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
/// Length of one link.
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
/// Bending stiffness EI: E π d⁴/64 of a solid thread, 230 of nylon 3-0 (d = 0.22 mm, E = 2 GPa), 82 of nylon 4-0, 460 of polypropylene 3-0; of a
/// braid a tenth to a hundredth.
pub const BENDING: Key = key(
    Effect::ThreadBending,
    "thread.bending_nn_m2",
    "nN m2",
    [0.1, 1e4],
    &[230.0],
);
/// Pull of a thread along the skin at which it cuts through: dermis bears 20 N and more, a model of skin 3.3 to 4.1 N (Potter 2025).
pub const STRENGTH: Key = key(Effect::Tearing, "tissue.strength_n", "N", [0.01, 1000.0], &[20.0]);
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

const fn key(effect: Effect, name: &'static str, unit: &'static str, range: [f64; 2], default: &'static [f64]) -> Key {
    Key {
        effect,
        name,
        unit,
        range,
        default,
    }
}
