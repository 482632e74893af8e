//! Cases on plain blocks of tissue: one or two tissues, no wound, and a ball tip where there is a tool.

mod matter;
mod patch;
mod start;
mod tool;

use super::case::Case;

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    [matter::cases(), tool::cases(), start::cases()]
        .into_iter()
        .flatten()
        .collect()
}
