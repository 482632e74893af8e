//! A solver that is named, or left to the clock: `auto:<µs>` stands where a solver's name would.

use std::fmt::{self, Display, Formatter};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Budgets for a tick of one millisecond [µs].
pub const BUDGET_US: RangeInclusive<u16> = 1..=1000;

/// What was asked for: this one, or the most accurate within a budget on the machine at hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting<T> {
    /// This one.
    Fixed(T),
    /// Whichever [`crate::study::budget`] finds.
    Auto {
        /// CPU time that a tick may take [µs]; within [`BUDGET_US`].
        budget_us: u16,
    },
}

impl<T: FromStr> FromStr for Setting<T> {
    type Err = NoSetting<T::Err>;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let budget = |us: &str| us.parse().ok().filter(|us| BUDGET_US.contains(us));
        match text.split_once(':').unwrap_or((text, "")) {
            ("auto", us) => Ok(Self::Auto {
                budget_us: budget(us).ok_or(NoSetting::Budget)?,
            }),
            _ => text.parse().map(Self::Fixed).map_err(NoSetting::Fixed),
        }
    }
}

impl<T: Display> Display for Setting<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(value) => value.fmt(f),
            Self::Auto { budget_us } => write!(f, "auto:{budget_us}"),
        }
    }
}

/// Why a text is no setting; one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoSetting<E> {
    /// Neither `auto` nor a name.
    #[error("{0}; or auto:<µs>, the most accurate within that time, such as auto:500")]
    Fixed(E),
    /// No budget, or none that a tick has.
    #[error("auto:<µs> takes a whole number from {} to {}, such as auto:500", BUDGET_US.start(), BUDGET_US.end())]
    Budget,
}

#[cfg(test)]
mod tests {
    use super::*;
    use sutura_shared::scene::Solver;

    #[test]
    fn a_budget_or_a_solver_is_read() {
        for text in ["auto:1", "auto:500", "auto:1000", "be-pcg:10:1"] {
            assert_eq!(text.parse::<Setting<Solver>>().unwrap().to_string(), text);
        }
        for text in [
            "auto",
            "auto:",
            "auto:0",
            "auto:1001",
            "auto:-5",
            "auto:5.5",
            "auto:1:1",
            "auto:99999",
        ] {
            assert_eq!(text.parse::<Setting<Solver>>(), Err(NoSetting::Budget), "{text}");
        }
        let line = "automatic".parse::<Setting<Solver>>().unwrap_err().to_string();
        assert!(
            line.contains("be-pcg[:iterations[:newton]]") && line.contains("auto:500"),
            "{line}"
        );
    }
}
