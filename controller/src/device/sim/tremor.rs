//! The tremor of the hand: a sine of the tick count along each axis.

use crate::math::{DT, Vec3};
use sutura_shared::scene::Tremor;

/// How far the tremor takes the hand's target from where the script has it, patch frame [m].
#[must_use]
pub fn offset(tremor: &Tremor, tick: u32) -> Vec3 {
    let angle = core::f32::consts::TAU * (tremor.frequency_hz * DT * tick as f32);
    Vec3::from(tremor.phases_rad.map(|phase| libm::sinf(angle + phase))) * tremor.amplitude_m
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of amplitude A has the root mean square A/√2 over whole periods, and passes zero upwards once in each.
    #[test]
    fn a_second_has_the_frequency_and_the_root_mean_square() {
        let tremor = Tremor {
            amplitude_m: 1e-4,
            frequency_hz: 9.0,
            phases_rad: [0.3, -1.0, 2.0],
        };
        let places: std::vec::Vec<Vec3> = (0..=1000).map(|tick| offset(&tremor, tick)).collect();
        for axis in 0..3 {
            let square: f32 = places[..1000].iter().map(|place| place[axis] * place[axis]).sum();
            let rms = libm::sqrtf(square / 1000.0);
            assert!((rms - 1e-4 * core::f32::consts::FRAC_1_SQRT_2).abs() < 1e-8, "{rms}");
            let up = places
                .windows(2)
                .filter(|pair| pair[0][axis] < 0.0 && pair[1][axis] >= 0.0);
            assert_eq!(up.count(), 9);
        }
    }

    #[test]
    fn it_begins_at_its_phases() {
        let half = core::f32::consts::FRAC_PI_2;
        let tremor = Tremor {
            amplitude_m: 2e-4,
            frequency_hz: 10.0,
            phases_rad: [0.0, half, -half],
        };
        let place = offset(&tremor, 0) - Vec3::new(0.0, 2e-4, -2e-4);
        assert!(place.abs().max() < 1e-10, "{place}");
    }
}
