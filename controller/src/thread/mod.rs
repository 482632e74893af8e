//! The suture thread: mass elements on stiff springs (Lian & Chen §3.2–3.4, Figs 13–16), behaviour beside needle and tissue.
//!
//! m_i ẍ_i + c_i ẋ_i + ΣF_i = ΣP_i (Eq. 7) is advanced by backward Euler. A link pulls with EA (l/l₀ − 1) and never pushes, unless effect
//! `thread-bending` makes the thread a beam; P is weight and the penalty of the tissue's surface (Eq. 8). N₀ hangs on the needle's swage,
//! N₍ₙ₋₁₎ is held by the tissue where the stitch begins, and between them the thread runs through an eyelet at every puncture that the
//! needle has passed (Fig. 16).
//!
//! A link is a hundred times stiffer than the skin it is tied to, so the two are never advanced in turn. [`condense`] eliminates
//! every node of the block-banded system onto the points of the tissue, exactly; the tissue's solve carries that small
//! block; [`settle`] substitutes back. The operation count is that of the nodes and eyelets there are.
//!
//! ```text
//! condense   predict → {links, elimination, the points' own answer, eyelets}×7 → links, elimination → force and stiffness at the points
//! settle     back-substitution → velocities → eyelets → Pull
//! ```

mod adhere;
mod answer;
mod bend;
mod chain;
mod config;
mod contact;
mod course;
mod factor;
mod friction;
mod front;
mod knot;
mod link;
mod pull;
mod solve;
mod state;
mod sweep;
#[cfg(test)]
mod tests;
mod work;

pub use config::{ConfigError, Params, build};
pub use contact::{Ground, Touch};
pub use course::{Course, Eyelet};
pub use friction::Grip;
pub use front::Condensed;
pub use pull::{Pull, eq11};
pub use solve::{condense, settle};
pub use state::{NODES_MAX, Place, State};
pub use work::{Ends, Work};
