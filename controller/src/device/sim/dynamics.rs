//! Dynamics of the Premium 1.5: M(q) q̈ + C(q, q̇) q̇ + N(q) = τ (Çavuşoğlu, Feygin & Tendick, Presence 11(6), 2002).
//!
//! One step is semi-implicit Euler: viscous friction and the load at the tip implicit, Coulomb friction and the joints' stops as
//! impulses that bring a joint exactly to rest (projected Gauss–Seidel), so a sticking arm sticks.

use super::kinematics::{LOWER, Posture, STOPS, UPPER};
use crate::math::{Mat3, Vec3};

/// Standard gravity [m/s²].
pub const GRAVITY: f32 = 9.806_65;
/// Coulomb friction of each joint [N·m].
pub const COULOMB: f32 = 0.01;
/// Viscous friction of each joint [N·m·s/rad].
pub const VISCOUS: f32 = 5e-4;
/// Motor turns to one turn of each joint.
pub const RATIOS: [f32; 3] = [13.3, 11.2, 11.2];
/// Peak torque of one motor (Maxon 118743) [N·m].
pub const MOTOR_PEAK: f32 = 0.129;

/// A rigid part: mass [kg] and principal moments xx, yy, zz [kg·m²].
struct Part {
    mass: f32,
    inertia: [f32; 3],
}

const A: Part = part(0.0202, [0.4864e-4, 0.001_843e-4, 0.4864e-4]);
const C: Part = part(0.0249, [0.959e-4, 0.959e-4, 0.0051e-4]);
const BE: Part = part(0.2359, [11.09e-4, 10.06e-4, 0.591e-4]);
const DF: Part = part(0.1906, [7.11e-4, 0.629e-4, 6.246e-4]);
const BASE_YY: f32 = 11.87e-4;
const L3: f32 = 0.0325;
const L5: f32 = -0.0368;
const L6: f32 = 0.0527;

const fn part(mass: f32, inertia: [f32; 3]) -> Part {
    Part { mass, inertia }
}

// M11 = M_TURRET + M_UPPER cos 2q2 + M_LOWER cos 2q3 + 2 M_CROSS cos q2 sin q3.
const M_TURRET: f32 = (4.0 * (A.inertia[1] + A.inertia[2] + 2.0 * BASE_YY + BE.inertia[1] + BE.inertia[2])
    + 4.0 * (C.inertia[1] + C.inertia[2] + DF.inertia[1] + DF.inertia[2])
    + UPPER * UPPER * (4.0 * A.mass + C.mass)
    + LOWER * LOWER * A.mass
    + 4.0 * L3 * L3 * C.mass)
    / 8.0;
const M_UPPER: f32 = (4.0 * (BE.inertia[1] - BE.inertia[2] + C.inertia[1] - C.inertia[2])
    + UPPER * UPPER * (4.0 * A.mass + C.mass))
    / 8.0;
const M_LOWER: f32 = (4.0 * (A.inertia[1] - A.inertia[2] + DF.inertia[1] - DF.inertia[2])
    - LOWER * LOWER * A.mass
    - 4.0 * L3 * L3 * C.mass)
    / 8.0;
const M_CROSS: f32 = UPPER * (LOWER * A.mass + L3 * C.mass) / 2.0;
const M22: f32 = (4.0 * (BE.inertia[0] + C.inertia[0] + UPPER * UPPER * A.mass) + UPPER * UPPER * C.mass) / 4.0;
const M33: f32 = (4.0 * (A.inertia[0] + DF.inertia[0]) + LOWER * LOWER * A.mass + 4.0 * L3 * L3 * C.mass) / 4.0;
/// First moments of weight about q2 and q3 [kg·m].
const WEIGHT_UPPER: f32 = (2.0 * UPPER * A.mass + 2.0 * L5 * BE.mass + UPPER * C.mass) / 2.0;
const WEIGHT_LOWER: f32 = (LOWER * A.mass + 2.0 * L3 * C.mass - 2.0 * L6 * DF.mass) / 2.0;

/// Inertia M(q) [kg·m²].
#[must_use]
pub fn inertia(posture: &Posture) -> Mat3 {
    let ([_, s2, s3], [_, c2, c3]) = (posture.s, posture.c);
    let m11 = M_TURRET + M_UPPER * (c2 * c2 - s2 * s2) + M_LOWER * (c3 * c3 - s3 * s3) + 2.0 * M_CROSS * c2 * s3;
    let m23 = -M_CROSS * (s2 * c3 - c2 * s3);
    Mat3::new(m11, 0.0, 0.0, 0.0, M22, m23, 0.0, m23, M33)
}

/// C(q, q̇) from the Christoffel symbols of M [N·m·s/rad]; Ṁ − 2C is skew.
#[must_use]
pub fn coriolis(posture: &Posture, rate: Vec3) -> Mat3 {
    let ([_, s2, s3], [_, c2, c3]) = (posture.s, posture.c);
    // Half the slopes of M11 along q2 and q3, and the slope of M23 along q3.
    let upper = -2.0 * M_UPPER * s2 * c2 - M_CROSS * s2 * s3;
    let lower = -2.0 * M_LOWER * s3 * c3 + M_CROSS * c2 * c3;
    let cross = M_CROSS * (c2 * c3 + s2 * s3);
    Mat3::new(
        upper * rate.y + lower * rate.z,
        upper * rate.x,
        lower * rate.x,
        -upper * rate.x,
        0.0,
        cross * rate.z,
        -lower * rate.x,
        -cross * rate.y,
        0.0,
    )
}

/// N(q): torque that holds the arm's weight [N·m].
#[must_use]
pub fn weight(posture: &Posture) -> Vec3 {
    let [_, c2, _] = posture.c;
    let [_, _, s3] = posture.s;
    Vec3::new(0.0, GRAVITY * WEIGHT_UPPER * c2, GRAVITY * WEIGHT_LOWER * s3)
}

/// Joint torques that push with `force` [N] at the tip, τ = Jᵀ F, as far as the motors go.
#[must_use]
pub fn motor_torque(posture: &Posture, force: Vec3) -> Vec3 {
    let peak = Vec3::from(RATIOS) * MOTOR_PEAK;
    (posture.jacobian().transpose() * force).zip_map(&peak, |torque, peak| torque.max(-peak).min(peak))
}

/// The arm's motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Joint angles q [rad].
    pub angle: Vec3,
    /// Joint rates q̇ [rad/s].
    pub rate: Vec3,
}

/// What acts on the arm during one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Torque of the motors [N·m].
    pub torque: Vec3,
    /// Force at the tip [N].
    pub force: Vec3,
    /// Mass that moves with the tip [kg].
    pub mass: f32,
}

/// Advances the arm by `dt` [s]; `posture` is the arm at the step's start.
pub fn step(state: &mut State, posture: &Posture, load: &Load, dt: f32) {
    let jacobian = posture.jacobian();
    let transposed = jacobian.transpose();
    let matrix = inertia(posture) + transposed * jacobian * load.mass + Mat3::identity() * (VISCOUS * dt);
    let at_tip = load.force - posture.convective(state.rate) * load.mass;
    let torque = load.torque + transposed * at_tip
        - coriolis(posture, state.rate) * state.rate
        - weight(posture)
        - state.rate * VISCOUS;
    let response = inverse(&matrix);
    let free = state.rate + response * torque * dt;
    state.rate = held(free, state.angle, &response, dt);
    state.angle += state.rate * dt;
}

/// Joint rates after Coulomb friction and the stops have acted on the rates `free` [rad/s].
fn held(free: Vec3, angle: Vec3, response: &Mat3, dt: f32) -> Vec3 {
    // The load at the tip couples the joints weakly; four sweeps leave less than the friction's own uncertainty.
    const SWEEPS: usize = 4;
    // Returning at once would shoot a joint out of its stop for every rounding it lay beyond [1/s].
    const RETURN: f32 = 20.0;
    let rows = STOPS.map(|stop| {
        let direction = Vec3::from(stop.direction);
        let answer = response * direction;
        let [from, to] = stop.range.map(|end| end - direction.dot(&angle));
        // Within its range a joint may come up to the stop in this step; beyond it, it is led back slowly.
        let range = [(from / dt).min(from * RETURN), (to / dt).max(to * RETURN)];
        (direction, answer, direction.dot(&answer), range)
    });
    // Only joints rub; the fourth stop is between two links.
    let friction = [COULOMB * dt, COULOMB * dt, COULOMB * dt, 0.0];
    let mut impulses = [(0.0_f32, 0.0_f32); STOPS.len()];
    let mut rate = free;
    for _ in 0..SWEEPS {
        for ((row, most), (rub, stop)) in rows.iter().zip(friction).zip(&mut impulses) {
            let (direction, answer, compliance, [from, to]) = row;
            let wanted = (*rub - direction.dot(&rate) / compliance).max(-most).min(most);
            rate += answer * (wanted - *rub);
            *rub = wanted;
            let unstopped = direction.dot(&rate) - compliance * *stop;
            let wanted = (unstopped.max(*from).min(*to) - unstopped) / compliance;
            rate += answer * (wanted - *stop);
            *stop = wanted;
        }
    }
    rate
}

/// Inverse of a positive definite matrix, by cofactors.
fn inverse(m: &Mat3) -> Mat3 {
    let [a, b, c] = [m.column(0), m.column(1), m.column(2)].map(Vec3::from);
    let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
    Mat3::from_columns(&[bc, ca, ab]).transpose() / a.dot(&bc)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::length;

    const POSTURES: [[f32; 3]; 5] = [
        [0.0, 0.0, 0.0],
        [0.3, 0.4, 0.2],
        [-0.5, 0.2, 0.6],
        [1.0, -0.6, -0.3],
        [0.2, 1.0, 0.7],
    ];
    const RATES: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.7, -1.3, 0.4], [-2.0, 0.5, 1.9]];

    fn kinetic(state: &State) -> f32 {
        0.5 * state.rate.dot(&(inertia(&Posture::at(state.angle)) * state.rate))
    }

    #[test]
    fn the_neutral_pose_weighs_what_was_published() {
        // Computed from the published parameters: 77.3, 52.5, 32.2 g along x, y, z, and N2 = −16.3 mN·m.
        let posture = Posture::at(Vec3::zeros());
        let back = inverse(&posture.jacobian());
        let apparent = back.transpose() * inertia(&posture) * back;
        for (i, grams) in [77.3, 52.5, 32.2].into_iter().enumerate() {
            assert!((apparent[(i, i)] * 1e3 - grams).abs() < 0.06, "{apparent}");
        }
        assert!((weight(&posture).y * 1e3 + 16.3).abs() < 0.06);
    }

    #[test]
    fn the_rate_of_m_less_twice_c_is_skew() {
        for (q, rate) in POSTURES.iter().flat_map(|q| RATES.iter().map(move |r| (q, r))) {
            let (q, rate) = (Vec3::from(*q), Vec3::from(*rate));
            let h = 2e-3;
            let slope = (inertia(&Posture::at(q + rate * h)) - inertia(&Posture::at(q - rate * h))) / (2.0 * h);
            let skew = slope - coriolis(&Posture::at(q), rate) * 2.0;
            // Truncation h²/6 · |rate|³ · 8 M and rounding ε M / h are both below 1e-6.
            assert!((skew + skew.transpose()).abs().max() < 2e-6, "{q} {rate} {skew}");
        }
    }

    #[test]
    fn a_free_arm_keeps_its_energy() {
        // Runge–Kutta of fourth order on M q̈ = −C q̇: its own error at 1 ms is below rounding.
        let slope = |s: &State| {
            let posture = Posture::at(s.angle);
            State {
                angle: s.rate,
                rate: inverse(&inertia(&posture)) * -(coriolis(&posture, s.rate) * s.rate),
            }
        };
        let along = |s: &State, d: &State, h: f32| State {
            angle: s.angle + d.angle * h,
            rate: s.rate + d.rate * h,
        };
        for rate in RATES {
            let h = 1e-3;
            let mut state = State {
                angle: Vec3::new(0.1, 0.2, 0.1),
                rate: Vec3::from(rate),
            };
            let before = kinetic(&state);
            for _ in 0..500 {
                let a = slope(&state);
                let b = slope(&along(&state, &a, h / 2.0));
                let c = slope(&along(&state, &b, h / 2.0));
                let d = slope(&along(&state, &c, h));
                let mean = State {
                    angle: (a.angle + (b.angle + c.angle) * 2.0 + d.angle) / 6.0,
                    rate: (a.rate + (b.rate + c.rate) * 2.0 + d.rate) / 6.0,
                };
                state = along(&state, &mean, h);
            }
            assert!((kinetic(&state) / before - 1.0).abs() < 2e-5);
        }
    }

    #[test]
    fn friction_and_stops_only_take_energy() {
        // The motors carry the weight. A step may add no more than C's explicit half, first order in dt, and
        // 10 nJ of a joint's return from beyond its stop.
        for (q, rate) in POSTURES.iter().flat_map(|q| RATES.iter().map(move |r| (q, r))) {
            let mut state = State {
                angle: Vec3::from(*q),
                rate: Vec3::from(*rate) * 4.0,
            };
            for _ in 0..20_000 {
                let posture = Posture::at(state.angle);
                let before = kinetic(&state);
                let load = Load {
                    torque: weight(&posture),
                    ..Load::default()
                };
                step(&mut state, &posture, &load, 1e-4);
                assert!(kinetic(&state) <= before * 1.001 + 1e-8, "{q:?} {state:?}");
            }
            assert!(
                length(state.rate) < 2e-3,
                "at rest, or on its way back to a stop: {state:?}"
            );
            let [from, to] = [-91.0_f32, 91.0].map(f32::to_radians);
            assert!((from..to).contains(&state.angle.x));
        }
    }

    #[test]
    fn a_torque_below_the_coulomb_torque_moves_nothing() {
        for mass in [0.0, 0.2] {
            let mut state = State {
                angle: Vec3::new(0.3, 0.4, 0.2),
                rate: Vec3::zeros(),
            };
            let before = state.angle;
            for _ in 0..10_000 {
                let posture = Posture::at(state.angle);
                let push = Vec3::new(0.9, -0.9, 0.9) * COULOMB;
                let load = Load {
                    torque: weight(&posture) + push,
                    force: Vec3::zeros(),
                    mass,
                };
                step(&mut state, &posture, &load, 1e-4);
            }
            assert!(length(state.angle - before) < 1e-5, "{mass} {state:?}");
        }
    }

    #[test]
    fn the_motors_stop_at_their_peak() {
        // 0.129 N·m × 13.3 over l1 = 7.98 N along x at the neutral pose.
        let posture = Posture::at(Vec3::zeros());
        let torque = motor_torque(&posture, Vec3::new(100.0, 0.0, 0.0));
        assert!((torque.x / UPPER - 7.980).abs() < 1e-2);
        let small = Vec3::new(1.0, -2.0, 3.0);
        assert!(length(motor_torque(&posture, small) - posture.jacobian().transpose() * small) < 1e-7);
    }
}
