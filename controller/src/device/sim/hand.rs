//! The hand on the stylus: a mass that moves with the tip, pulled to a moving target by a spring and a damper.

use super::dynamics::Load;
use crate::math::Vec3;

/// A hand (0.1–0.5 kg, 2–10 N·s/m, 100–800 N/m); all zero is no hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Params {
    /// Mass m [kg].
    pub mass: f32,
    /// Damping b [N·s/m].
    pub damping: f32,
    /// Stiffness k [N/m].
    pub stiffness: f32,
}

/// A moving point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Where it is [m].
    pub position: Vec3,
    /// How it moves [m/s].
    pub velocity: Vec3,
}

/// What the hand does to the tip over one implicit step of `dt` [s]; `target` is at the step's end.
///
/// m (v⁺ − v)/dt = k (x_t − x − dt v⁺) + b (v_t − v⁺) + F, gathered as (m + dt b + dt² k)(v⁺ − v)/dt = force + F.
#[must_use]
pub fn grip(params: &Params, target: &Point, tip: &Point, dt: f32) -> Load {
    let stretch = target.position - tip.position - tip.velocity * dt;
    Load {
        torque: Vec3::zeros(),
        force: stretch * params.stiffness + (target.velocity - tip.velocity) * params.damping,
        mass: params.mass + dt * (params.damping + dt * params.stiffness),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_released_hand_swings_as_a_damped_oscillator() {
        // m ẍ + b ẋ + k x = 0: half a period π/ω_d later the swing is −exp(−ζ ω π/ω_d) of the start.
        let params = Params {
            mass: 0.2,
            damping: 2.0,
            stiffness: 400.0,
        };
        let (decay, omega2) = (5.0_f64, 2000.0_f64);
        let half = core::f64::consts::PI / (omega2 - decay * decay).sqrt();
        let dt = 1e-5_f32;
        let mut tip = Point {
            position: Vec3::new(0.01, 0.0, 0.0),
            velocity: Vec3::zeros(),
        };
        for _ in 0..(half / f64::from(dt)).round() as usize {
            let load = grip(&params, &Point::default(), &tip, dt);
            tip.velocity += load.force * (dt / load.mass);
            tip.position += tip.velocity * dt;
        }
        let expected = -0.01 * (-decay * half).exp();
        assert!(
            (f64::from(tip.position.x) - expected).abs() < 1e-5,
            "{tip:?} {expected}"
        );
    }
}
