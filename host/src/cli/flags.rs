//! What the flags of several commands have in common.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use sutura_controller::lanes::Level;
use sutura_controller::math::TICK_HZ;
use sutura_shared::scene::Law;

/// Poisson's ratio of the law `isotropic`: whoever names it beside that law says nothing new.
const ISOTROPIC_POISSON: f32 = 0.25;

/// Flags that do not go together; one line.
#[derive(Debug)]
pub(crate) struct BadFlag(pub(crate) String);

impl Display for BadFlag {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadFlag {}

/// The law of `--law` and `--poisson`.
pub(crate) fn law(name: &str, poisson: Option<f32>) -> Result<Law, BadFlag> {
    let law = Law::named(name, None);
    let own = |poisson: &f32| law == Ok(Law::Isotropic) && (poisson - ISOTROPIC_POISSON).abs() < 1e-6;
    Law::named(name, poisson.filter(|poisson| !own(poisson))).map_err(|error| BadFlag(format!("--law {name}: {error}")))
}

/// The instructions that `--simd` pins: one of those this processor has, by name.
pub(crate) fn simd(text: &str) -> Result<Level, String> {
    Level::all().find(|level| level.name() == text).ok_or_else(|| {
        let names: Vec<_> = Level::all().map(Level::name).collect();
        format!("this processor has {}", names.join(", "))
    })
}

/// The ticks from frame to frame of `--fps`.
pub(crate) fn every(text: &str) -> Result<u32, String> {
    let fps = text
        .parse()
        .ok()
        .filter(|fps| (1..=TICK_HZ).contains(fps) && TICK_HZ.is_multiple_of(*fps));
    fps.map(|fps: u32| TICK_HZ / fps)
        .ok_or_else(|| format!("a divisor of {TICK_HZ} is needed, such as 10, 20, 25 or 50"))
}

/// Three counts with `BETWEEN` between them.
pub(crate) fn triple<const BETWEEN: char>(text: &str) -> Result<[u32; 3], String> {
    let parts: Result<Vec<u32>, _> = text.split(BETWEEN).map(u32::from_str).collect();
    parts
        .ok()
        .and_then(|parts| parts.try_into().ok())
        .ok_or_else(|| format!("three counts are needed, such as 8{BETWEEN}8{BETWEEN}4"))
}

/// A number within `LEAST` and `MOST` thousandths.
pub(crate) fn within<const LEAST: i64, const MOST: i64>(text: &str) -> Result<f64, String> {
    let [least, most] = [LEAST, MOST].map(|thousandths| thousandths as f64 * 1e-3);
    text.parse()
        .ok()
        .filter(|number| (least..=most).contains(number))
        .ok_or_else(|| format!("a number from {least} to {most} is needed"))
}
