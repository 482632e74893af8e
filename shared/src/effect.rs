//! Effects: what a scene may or may not call for, each named once.

use serde::{Deserialize, Serialize};

/// What a scene may call for. The discriminant is the effect's bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u32)]
pub enum Effect {
    /// The thread's weight.
    Gravity = 1 << 0,
    /// Stress–strain curves of several segments, and diagonals that lock where a voxel loses volume; without it each tissue keeps
    /// its first slope.
    Stiffening = 1 << 1,
    /// Dashpots along the springs.
    SpringDamping = 1 << 2,
    /// The needle may pass through the skin at F0; without it the tool only presses.
    Puncture = 1 << 3,
    /// Friction of the shaft in the tissue.
    ShaftFriction = 1 << 4,
    /// The suture thread.
    Thread = 1 << 5,
    /// The thread lies on the tissue's outer surface.
    ThreadContact = 1 << 6,
    /// The wound's faces cannot pass through each other.
    WoundContact = 1 << 7,
    /// Time-domain passivity control at the output edge.
    Passivity = 1 << 8,
    /// A barrier against voxels turned inside out, for laws of springs alone; law `volume` has it in any case.
    Barrier = 1 << 9,
    /// Skin under tension is harder to puncture.
    SkinTension = 1 << 10,
    /// Friction of the thread at its punctures.
    ThreadFriction = 1 << 11,
    /// The thread is tied at the end; without it nothing holds it when it is let go.
    Knot = 1 << 12,
    /// The thread resists bending, and being pushed.
    ThreadBending = 1 << 13,
    /// A thread that pulls harder than the tissue bears cuts its way through it.
    Tearing = 1 << 14,
}

impl Effect {
    /// Every effect, in the order of its bit.
    pub const ALL: [Self; 15] = [
        Self::Gravity,
        Self::Stiffening,
        Self::SpringDamping,
        Self::Puncture,
        Self::ShaftFriction,
        Self::Thread,
        Self::ThreadContact,
        Self::WoundContact,
        Self::Passivity,
        Self::Barrier,
        Self::SkinTension,
        Self::ThreadFriction,
        Self::Knot,
        Self::ThreadBending,
        Self::Tearing,
    ];

    /// The name a scene file uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::Stiffening => "stiffening",
            Self::SpringDamping => "spring-damping",
            Self::Puncture => "puncture",
            Self::ShaftFriction => "shaft-friction",
            Self::Thread => "thread",
            Self::ThreadContact => "thread-contact",
            Self::WoundContact => "wound-contact",
            Self::Passivity => "passivity",
            Self::Barrier => "barrier",
            Self::SkinTension => "skin-tension",
            Self::ThreadFriction => "thread-friction",
            Self::Knot => "knot",
            Self::ThreadBending => "thread-bending",
            Self::Tearing => "tearing",
        }
    }
}

/// A set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effects(pub u32);

impl Effects {
    /// Whether `effect` is on.
    #[must_use]
    pub const fn has(self, effect: Effect) -> bool {
        self.0 & effect as u32 != 0
    }

    /// The set with `effect` on.
    #[must_use]
    pub const fn with(self, effect: Effect) -> Self {
        Self(self.0 | effect as u32)
    }
}
