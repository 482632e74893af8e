//! Cases that need a whole scene: a small piece of the built-in one, with wound, needle and thread or a ball, or bone under the skin, and
//! where the case says so an arm with encoders in a hand.

mod arm;
mod circle;
mod device;
mod felt;
mod needle;
mod patch;
mod run;
mod thread;
mod wound;

use super::case::Case;

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let all = [needle::cases(), thread::cases(), wound::cases(), device::cases()];
    all.into_iter().flatten().collect()
}
