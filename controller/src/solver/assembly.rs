//! Linearisation of the backward Euler equation at x + u:
//! residual f(x + u) − m (u/dt − v)/dt − α m u/dt, and its spring operator.
//!
//! Lengths come from displacements: l² = L₀² + q with q = 2 R·δ + δ·δ, and l − L₀ = q/(l + L₀), which keeps the digits
//! that a difference of positions would lose. A spring's Jacobian is k_t d dᵀ + (T/l)(I − d dᵀ) with T/l cut off
//! at zero, so the operator stays positive definite under compression; the force is exact.

#![allow(
    clippy::needless_range_loop,
    reason = "lanes of several arrays advance together; an index says so best"
)]

use super::blocks::{BLOCK, Lane, window, window_mut};
use super::{Problem, Work, operator};
use crate::lattice::{CURVES, EDGES, Field, Tissue};
use crate::law::Breaks;
use crate::math::{DT, sqrt};

/// Geometry and load of one block of springs of one direction.
struct Springs {
    /// Rest length L₀ [m].
    rest_length: f32,
    /// Unit direction, x, y and z apart.
    direction: [Lane; 3],
    /// 1/l [1/m].
    inverse_length: Lane,
    /// (l − L₀)/L₀.
    strain: Lane,
    /// Tension over the rest length [N/m].
    tension: Lane,
    /// Slope of the tension [N/m].
    slope: Lane,
    /// First-slope stiffness [N/m].
    stiffness: Lane,
}

/// Fills residual, operator and inverse diagonal for the displacement `work.step` within the tick.
pub(super) fn linearise<const N: usize>(
    problem: &Problem<'_, N>,
    load: &Field<N>,
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) {
    begin(problem, load, tissue, work);
    add_springs(problem, work);
    if let Some(faces) = problem.faces {
        operator::meet(faces, work);
    }
    operator::load_points(problem.coupling, work);
    invert_diagonal(problem, work);
}

/// Elastic force of the springs on every node, held ones too [N]; no dashpots, no inertia.
pub fn elastic_force<'w, const N: usize>(
    problem: &Problem<'_, N>,
    tissue: &Tissue<N>,
    work: &'w mut Work<N>,
) -> &'w Field<N> {
    let fields = [&mut work.step, &mut work.residual];
    fields.into_iter().flatten().for_each(|c| c.fill(0.0));
    work.place.clone_from(&tissue.displacement);
    add_springs(problem, work);
    &work.residual
}

/// Forces, operator and diagonal of all springs, one direction after the other.
fn add_springs<const N: usize>(problem: &Problem<'_, N>, work: &mut Work<N>) {
    let lattice = problem.lattice;
    let shapes = lattice.rest().into_iter().zip(lattice.rest_lengths());
    for (direction, (offset, (rest, rest_length))) in lattice.offsets().into_iter().zip(shapes).enumerate() {
        for low in (0..lattice.len()).step_by(BLOCK) {
            let mut springs = measure(&work.place, [low, low + offset], rest, rest_length);
            follow_curves(problem, direction, low, &mut springs);
            emit(
                problem.material.spring_damping,
                work,
                direction,
                [low, low + offset],
                &springs,
            );
        }
    }
}

/// Inertia, damping and load; the diagonal collects in `inverse_diagonal`.
fn begin<const N: usize>(problem: &Problem<'_, N>, load: &Field<N>, tissue: &Tissue<N>, work: &mut Work<N>) {
    let n = problem.lattice.len();
    let inertia = 1.0 / (DT * DT);
    let drag = problem.material.mass_damping / DT;
    let then = tissue
        .displacement
        .iter()
        .zip(&tissue.velocity)
        .zip(load)
        .zip(&work.step);
    let out = work
        .place
        .iter_mut()
        .zip(&mut work.residual)
        .zip(&mut work.inverse_diagonal);
    for ((((x, v), f), u), ((place, residual), diagonal)) in then.zip(out) {
        for (place, (x, u)) in place.iter_mut().zip(x.iter().zip(u)).take(n) {
            *place = x + u;
        }
        let mass = &problem.lattice.mass;
        let rows = residual.iter_mut().zip(diagonal).zip(mass);
        for (((r, d), m), (u, (v, f))) in rows.zip(u.iter().zip(v.iter().zip(f))).take(n) {
            *r = f - m * (inertia * (u - DT * v) + drag * u);
            *d = m * (inertia + drag);
        }
    }
}

/// Direction, length and strain of the springs from nodes `near…` to nodes `far…`.
#[inline]
fn measure<const N: usize>(place: &Field<N>, [near, far]: [usize; 2], rest: [f32; 3], rest_length: f32) -> Springs {
    let [ax, ay, az] = place.each_ref().map(|p| window(p, near));
    let [bx, by, bz] = place.each_ref().map(|p| window(p, far));
    let mut springs = Springs {
        rest_length,
        direction: [[0.0; BLOCK]; 3],
        inverse_length: [0.0; BLOCK],
        strain: [0.0; BLOCK],
        tension: [0.0; BLOCK],
        slope: [0.0; BLOCK],
        stiffness: [0.0; BLOCK],
    };
    let [dx, dy, dz] = &mut springs.direction;
    let [rx, ry, rz] = rest;
    let (square, inverse_rest) = (rest_length * rest_length, 1.0 / rest_length);
    for l in 0..BLOCK {
        let (x, y, z) = (bx[l] - ax[l], by[l] - ay[l], bz[l] - az[l]);
        let q = 2.0 * (rx * x + ry * y + rz * z) + (x * x + y * y + z * z);
        // A spring of no length has no direction: the floor keeps it finite.
        let length = sqrt((square + q).max(1e-16));
        let inverse = 1.0 / length;
        dx[l] = (rx + x) * inverse;
        dy[l] = (ry + y) * inverse;
        dz[l] = (rz + z) * inverse;
        springs.inverse_length[l] = inverse;
        springs.strain[l] = q / (length + rest_length) * inverse_rest;
    }
    springs
}

/// Tension, slope and first-slope stiffness, summed over the curves that meet in a spring.
#[inline]
fn follow_curves<const N: usize>(problem: &Problem<'_, N>, direction: usize, low: usize, springs: &mut Springs) {
    let slots = if problem.material.stiffening { CURVES } else { 1 };
    let used = problem
        .material
        .curves
        .iter()
        .zip(&problem.lattice.stiffness)
        .take(slots);
    for (curve, stiffness) in used.filter(|(curve, _)| curve.young > 0.0) {
        let Some(k) = stiffness.get(direction).map(|k| window(k, low)) else {
            continue;
        };
        let straight = Breaks::default();
        let breaks = match (problem.material.stiffening, direction) {
            (false, _) => &straight,
            (true, 0..EDGES) => &curve.edge,
            (true, _) => &curve.diagonal,
        };
        for l in 0..BLOCK {
            springs.tension[l] += k[l] * springs.strain[l];
            springs.slope[l] += k[l];
            springs.stiffness[l] += k[l];
        }
        let used = |(_, rise): &(&f32, &f32)| rise.abs() > 0.0;
        for (at, rise) in breaks.strain.iter().zip(&breaks.rise).filter(used) {
            let away = if *at < 0.0 { -1.0 } else { 1.0 };
            for l in 0..BLOCK {
                let over = springs.strain[l] - at;
                let steeper = if over * away > 0.0 { k[l] * rise } else { 0.0 };
                springs.tension[l] += steeper * over;
                springs.slope[l] += steeper;
            }
        }
        let (at, gain) = breaks.lock;
        if gain > 0.0 {
            for l in 0..BLOCK {
                let under = (springs.strain[l] + at).min(0.0);
                let steeper = -k[l] * gain * under;
                springs.tension[l] += 0.5 * steeper * under;
                springs.slope[l] += steeper;
            }
        }
    }
}

/// Stores the operator of a block of springs and adds their forces and their diagonal at both ends.
#[inline]
fn emit<const N: usize>(
    damping: f32,
    work: &mut Work<N>,
    direction: usize,
    [near, far]: [usize; 2],
    springs: &Springs,
) {
    let mut force = springs.direction;
    let mut diagonal = [[0.0; BLOCK]; 3];
    let rate = damping / DT;
    let (Some(axial), Some(transverse)) = (work.axial.get_mut(direction), work.transverse.get_mut(direction)) else {
        return;
    };
    let (Some([gx, gy, gz]), Some(across)) = (blocks_mut(axial, near), window_mut(transverse, near)) else {
        return;
    };
    let [ux, uy, uz] = work.step.each_ref().map(|u| window(u, near));
    let [wx, wy, wz] = work.step.each_ref().map(|u| window(u, far));
    let [dx, dy, dz] = &springs.direction;
    let [fx, fy, fz] = &mut force;
    let [hx, hy, hz] = &mut diagonal;
    for l in 0..BLOCK {
        let viscous = rate * springs.stiffness[l];
        let stretch = dx[l] * (wx[l] - ux[l]) + dy[l] * (wy[l] - uy[l]) + dz[l] * (wz[l] - uz[l]);
        let tension = springs.tension[l] * springs.rest_length;
        let turn = tension.max(0.0) * springs.inverse_length[l];
        let along = sqrt((springs.slope[l] + viscous - turn).max(0.0));
        let pull = tension + viscous * stretch;
        (fx[l], fy[l], fz[l]) = (dx[l] * pull, dy[l] * pull, dz[l] * pull);
        (gx[l], gy[l], gz[l]) = (dx[l] * along, dy[l] * along, dz[l] * along);
        across[l] = turn;
        hx[l] = gx[l] * gx[l] + turn;
        hy[l] = gy[l] * gy[l] + turn;
        hz[l] = gz[l] * gz[l] + turn;
    }
    for (c, (force, diagonal)) in force.iter().zip(&diagonal).enumerate() {
        spread(work.residual.get_mut(c), [near, far], force, -1.0);
        spread(work.inverse_diagonal.get_mut(c), [near, far], diagonal, 1.0);
    }
}

/// Mutable windows of all three components.
fn blocks_mut<const N: usize>(field: &mut Field<N>, at: usize) -> Option<[&mut Lane; 3]> {
    let [x, y, z] = field;
    Some([window_mut(x, at)?, window_mut(y, at)?, window_mut(z, at)?])
}

/// Adds `values` at the near nodes and `far_sign` times them at the far nodes.
#[inline]
fn spread<const N: usize>(out: Option<&mut [f32; N]>, [near, far]: [usize; 2], values: &Lane, far_sign: f32) {
    let Some(out) = out else { return };
    if let Some(out) = window_mut(out, near) {
        out.iter_mut().zip(values).for_each(|(o, v)| *o += v);
    }
    if let Some(out) = window_mut(out, far) {
        out.iter_mut().zip(values).for_each(|(o, v)| *o += far_sign * v);
    }
}

/// Turns the collected diagonal into its inverse; zero at held and absent nodes, where the residual is cleared too.
fn invert_diagonal<const N: usize>(problem: &Problem<'_, N>, work: &mut Work<N>) {
    let n = problem.lattice.len();
    let free = &problem.lattice.free;
    for (diagonal, residual) in work.inverse_diagonal.iter_mut().zip(&mut work.residual) {
        for ((d, r), free) in diagonal.iter_mut().zip(residual).zip(free).take(n) {
            let inverse = if *free > 0.0 { 1.0 / *d } else { 0.0 };
            *d = inverse;
            *r *= free;
        }
    }
}
