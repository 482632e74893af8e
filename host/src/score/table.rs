//! What is scored: every row's unit, threshold and source, and what it counts in the total.

use serde::Serialize;

/// A value that a publication gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Threshold {
    /// No more than this.
    AtMost(f64),
    /// From the first to the second.
    Within([f64; 2]),
    /// This, without a word on how near is near enough.
    Ideal(f64),
}

impl Threshold {
    /// Whether a value meets it; nothing where that has not been published.
    #[must_use]
    pub fn met(self, value: f64) -> Option<bool> {
        match self {
            Self::AtMost(most) => Some(value <= most),
            Self::Within([least, most]) => Some((least..=most).contains(&value)),
            Self::Ideal(_) => None,
        }
    }
}

/// How far a value misses what is best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Miss {
    /// By itself: less is better, either side of zero.
    Size,
    /// By what it lacks of the best that is possible.
    BelowBest,
    /// By its distance from a range.
    Outside([f64; 2]),
}

/// What a row counts in the total: a miss of `half` leaves half of `weight`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) kind: Kind,
    pub(super) weight: f64,
    /// A scale of this score and no threshold; where a published value tells good from bad it is that.
    pub(super) half: f64,
    pub(super) miss: Miss,
    pub(super) reason: &'static str,
}

/// One kind of row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) threshold: Option<Threshold>,
    pub(super) source: &'static str,
}

const fn kind(name: &'static str, unit: &'static str, threshold: Option<Threshold>, source: &'static str) -> Kind {
    Kind {
        name,
        unit,
        threshold,
        source,
    }
}

/// Largest force of experts on a suture task, and of novices [N].
pub(super) const EXPERT_N: f64 = 2.6;
pub(super) const NOVICE_N: f64 = 4.7;
/// Force from which something is touched [N].
pub(super) const TOUCHED_N: f64 = 0.01;

const PERPENDICULAR: &str = "90° to the surface is taught (checklist of 2021, BMC Medical Education, doi 10.1186/s12909-021-02590-2); no published \
                             threshold for the distance from it; angles tell experts from novices (Kazemi 2010)";
/// What is taught as a bite [mm].
const BITE_MM: [f64; 2] = [3.0, 5.0];

const BITE: &str = "3 to 5 mm from the wound's edge is standard teaching (trial NCT04870008)";
const HOREMAN: &str = "Horeman 2010, doi 10.1007/s00464-010-1096-9";
const GAP: &str = "gap error of at most 1 mm: FLS proficiency levels (tassl.org/fls.asp)";
const NONE: &str = "no published threshold";

pub(super) const ENTRY_ANGLE: Kind = kind("entry angle", "°", Some(Threshold::Ideal(90.0)), PERPENDICULAR);
pub(super) const EXIT_ANGLE: Kind = kind("exit angle", "°", Some(Threshold::Ideal(90.0)), PERPENDICULAR);
pub(super) const BITE_IN: Kind = kind("bite at the entry", "mm", Some(Threshold::Within(BITE_MM)), BITE);
pub(super) const BITE_OUT: Kind = kind("bite at the exit", "mm", Some(Threshold::Within(BITE_MM)), BITE);
pub(super) const ASYMMETRY: Kind = kind(
    "difference of the bites",
    "mm",
    None,
    "equal on both sides is taught (Medscape); no published threshold",
);
pub(super) const DEPTH: Kind = kind(
    "depth",
    "mm",
    None,
    "about as deep as the bite is wide is taught; no published threshold",
);
pub(super) const SPACING: Kind = kind(
    "spacing",
    "mm",
    None,
    "5 mm in fascia (Deerenberg 2015, the STITCH trial); no published threshold for skin",
);
pub(super) const SPACING_SPREAD: Kind = kind("spread of the spacing over its mean", "1", None, NONE);
pub(super) const ARC: Kind = kind(
    "tip off the needle's arc, RMS",
    "mm",
    None,
    "to follow the curve is taught; no published threshold",
);
pub(super) const ARC_MOST: Kind = kind("tip off the needle's arc, most", "mm", None, NONE);
pub(super) const SIDE: Kind = kind(
    "side load on the needle, mean",
    "N",
    None,
    "tells attendings from residents (doi 10.3389/fmed.2022.897219); no published threshold",
);
pub(super) const SIDE_MOST: Kind = kind("side load on the needle, peak", "N", None, NONE);
pub(super) const EXTRA: Kind = kind(
    "punctures beyond those needed",
    "1",
    None,
    "repeated bites are counted as errors (Van Sickle); no published threshold",
);
pub(super) const PEAK: Kind = kind("peak force", "N", Some(Threshold::AtMost(EXPERT_N)), HOREMAN);
pub(super) const MEAN: Kind = kind("mean force while touching", "N", Some(Threshold::AtMost(0.9)), HOREMAN);
pub(super) const ABOVE_EXPERT: Kind = kind(
    "time above 2.6 N, the experts' maximum",
    "s",
    Some(Threshold::AtMost(0.0)),
    HOREMAN,
);
pub(super) const ABOVE_NOVICE: Kind = kind(
    "time above 4.7 N, the novices' maximum",
    "s",
    Some(Threshold::AtMost(0.0)),
    HOREMAN,
);
pub(super) const ROUGHNESS: Kind = kind(
    "change of force while touching, RMS",
    "N/s",
    None,
    "smoothness of force tells skill (EMBC 2024, PMID 40039007); no published threshold",
);
pub(super) const STAGE_PEAK: Kind = kind("peak force", "N", None, NONE);
pub(super) const STAGE_MEAN: Kind = kind("mean force", "N", None, NONE);
pub(super) const STAGE_IMPULSE: Kind = kind("impulse of force", "N·s", None, NONE);
pub(super) const STAGE_ROUGHNESS: Kind = kind("change of force, RMS", "N/s", None, NONE);
pub(super) const THREAD_PEAK: Kind = kind(
    "peak tension of the thread",
    "N",
    Some(Threshold::AtMost(4.04)),
    "a 3-0 thread tears a model of skin at 4.04 N (Potter 2025)",
);
pub(super) const TENSION_HELD: Kind = kind(
    "tension held before the knot",
    "N",
    None,
    "3 N falling to 1 N in fascia (Horeman 2013, PMC3871579); no published threshold for skin",
);
pub(super) const TENSION_LEFT: Kind = kind("tension left in the stitch", "N", None, NONE);
pub(super) const GAP_LOADED: Kind = kind(
    "residual gap under the hand's pull",
    "mm",
    Some(Threshold::Within([-1.0, 1.0])),
    GAP,
);
pub(super) const GAP_LEFT: Kind = kind("residual gap", "mm", Some(Threshold::Within([-1.0, 1.0])), GAP);
pub(super) const STEP: Kind = kind(
    "step between the edges",
    "mm",
    None,
    "level edges are taught (Medscape); no published threshold",
);
pub(super) const CLOSING: Kind = kind(
    "force that holds the wound closed",
    "N",
    None,
    "0.5 to 1.5 N computed, peaks of 1.1 to 3.2 N measured (Capek 2012); no published threshold",
);
pub(super) const TORN: Kind = kind(
    "tissue cut by the thread",
    "mm",
    None,
    "the size of tears tells experts from novices (Kazemi 2010); no published threshold",
);
pub(super) const THREAD_USED: Kind = kind(
    "thread in the stitch over the wound's length",
    "1",
    None,
    "at least 4 in continuous closure of fascia (Millbourn 2009); no published threshold for single stitches",
);
pub(super) const PATH: Kind = kind(
    "path of the hand",
    "m",
    None,
    "says little alone (doi 10.1089/lap.2022.0313); no published threshold",
);
pub(super) const TIME: Kind = kind(
    "time",
    "s",
    Some(Threshold::AtMost(112.0)),
    "an intracorporeal stitch in 112 s: FLS proficiency levels (tassl.org/fls.asp)",
);

const fn mark(kind: Kind, weight: f64, half: f64, miss: Miss, reason: &'static str) -> Mark {
    Mark {
        kind,
        weight,
        half,
        miss,
        reason,
    }
}

const TAUGHT: &str = "taught first, and tells experts from novices";
const CHECKLIST: &str = "scored by itself in checklists";
const HARM: &str = "what harms tissue";
const PURPOSE: &str = "what the stitch is for";
const DETAIL: &str = "part of what is scored beside it";
const LITTLE: &str = "says little alone (R = 0.35 with experts' ratings, time and path together)";

/// What counts. 3: what a stitch is for, and what separates experts from novices; 2: what harms or is scored by itself; 1: the rest.
pub(super) const MARKS: [Mark; 19] = [
    mark(ENTRY_ANGLE, 3.0, 15.0, Miss::BelowBest, TAUGHT),
    mark(EXIT_ANGLE, 3.0, 15.0, Miss::BelowBest, TAUGHT),
    mark(BITE_IN, 2.0, 1.0, Miss::Outside(BITE_MM), CHECKLIST),
    mark(BITE_OUT, 2.0, 1.0, Miss::Outside(BITE_MM), CHECKLIST),
    mark(ASYMMETRY, 2.0, 1.0, Miss::Size, CHECKLIST),
    mark(SPACING_SPREAD, 1.0, 0.2, Miss::Size, DETAIL),
    mark(ARC, 2.0, 1.0, Miss::Size, HARM),
    mark(SIDE, 2.0, 0.5, Miss::Size, HARM),
    mark(EXTRA, 1.0, 1.0, Miss::Size, CHECKLIST),
    mark(PEAK, 2.0, EXPERT_N, Miss::Size, HARM),
    mark(MEAN, 1.0, 0.9, Miss::Size, DETAIL),
    mark(ABOVE_EXPERT, 2.0, 1.0, Miss::Size, HARM),
    mark(ABOVE_NOVICE, 2.0, 0.5, Miss::Size, HARM),
    mark(ROUGHNESS, 1.0, 20.0, Miss::Size, "tells skill beside peak and range"),
    mark(THREAD_PEAK, 2.0, 4.04, Miss::Size, HARM),
    mark(TORN, 2.0, 1.0, Miss::Size, HARM),
    mark(GAP_LEFT, 3.0, 1.0, Miss::Size, PURPOSE),
    mark(PATH, 1.0, 1.0, Miss::Size, LITTLE),
    mark(TIME, 1.0, 112.0, Miss::Size, LITTLE),
];
