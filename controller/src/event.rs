//! What can happen in a tick: a puncture, faults.

use sutura_shared::scene::Site;

/// One puncture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Puncture {
    /// Where.
    pub site: Site,
    /// Force along the needle at which the skin gave way [N].
    pub force: f32,
    /// The scene's F0 [N].
    pub f0: f32,
    /// How far the skin had been pushed along the needle [m].
    pub depth: f32,
}

/// Faults of a run, a set: a fault stands until the next scene is loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(pub u32);

/// One fault. The discriminant is its bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Fault {
    /// The device gave a pose that is not finite.
    Pose = 1 << 0,
    /// The force was not finite.
    Force = 1 << 1,
    /// A tissue or thread position was not finite.
    State = 1 << 2,
}

impl Fault {
    /// Every fault in the order of its bit.
    pub const ALL: [Self; 3] = [Self::Pose, Self::Force, Self::State];

    /// The name in tables and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose-not-finite",
            Self::Force => "force-not-finite",
            Self::State => "state-not-finite",
        }
    }
}

impl Faults {
    /// Whether `fault` is in the set.
    #[must_use]
    pub const fn has(self, fault: Fault) -> bool {
        self.0 & fault as u32 != 0
    }

    /// The set with `fault` in it where `present`.
    #[must_use]
    pub const fn with(self, fault: Fault, present: bool) -> Self {
        if present { Self(self.0 | fault as u32) } else { self }
    }

    /// Whether nothing is wrong.
    #[must_use]
    pub const fn none(self) -> bool {
        self.0 == 0
    }
}
