//! What the tool does to the tissue, and what the hand feels of it.
//!
//! The tool has no mass: with p its offset from where the hand wants it, δ the growth of p in this tick, u_i how far the points move
//! from their predicted places, and S_i the stiffness of what holds them on the tool,
//!
//! ```text
//!   F_i = f_i + S_i (δ − u_i)          on the points,
//!   0   = K p + (B/dt) δ + Σ F_i       on the tool; F = K p + (B/dt) δ on the hand.
//! ```
//!
//! δ is eliminated, and the points answer u with what is left: symmetric, positive semidefinite, and no stiffer together than K + B/dt.
//! What the arc bends away from its tangents within the tick is made good on the tool once the points are where they are.

use super::rub::{Shaft, rub, shafts};
use super::{Arc, Hole, Params, Passage, State, Touch};
use crate::coupling::{A, B, C, Coupling, D, POINTS};
use crate::event::Puncture;
use crate::lattice::Tissue;
use crate::math::{Mat3, Vec3};
use sutura_shared::scene::Site;

/// Stretch of the virtual coupling at which the tip leaves a surface [m]: above the encoders' 29 µm, so that their steps alone do not make
/// and break the contact.
const ADHESION: f32 = 4e-5;
/// Stiffness of what holds a point on the tool [N/m]: at 0.4 N across the needle it is 10 µm from the arc. Much stiffer than tissue, and not
/// so stiff that solvers which move one node after the other would lock.
const RIGID: f32 = 4e4;
/// The coupling's points by site.
const SLOTS: [usize; 4] = [A, B, C, D];

/// What the tool does to its points as the tissue's solver was given it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Holds {
    /// By site.
    pins: [Pin; 4],
    /// (K + B/dt + Σ S)⁻¹ [m/N]; `None` where nothing is held.
    yields: Option<Mat3>,
    /// −K p − Σ f [N].
    pull: Vec3,
}

/// The hold on one point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pin {
    /// f.
    force: Vec3,
    /// S.
    stiffness: Mat3,
}

impl Default for Pin {
    fn default() -> Self {
        Self {
            force: Vec3::zeros(),
            stiffness: Mat3::zeros(),
        }
    }
}

/// What the hand feels of the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    /// Force on the hand [N].
    pub force: Vec3,
    /// Constraint torque on the hand about the grasp point [N·m].
    pub torque: Vec3,
    /// A puncture in this tick.
    pub puncture: Option<Puncture>,
}

/// States the tool's hold on its points, and adds it to the coupling.
pub fn couple<const N: usize>(
    params: &Params,
    state: &mut State,
    arc: &Arc,
    tissue: &Tissue<N>,
    coupling: &mut Coupling,
) -> Holds {
    state.before = Some(arc.pose);
    let tool = arc.shifted(state.offset);
    let shafts = shafts(state, arc.length);
    let mut pins = [Pin::default(); 4];
    let mut stiffness = Mat3::zeros();
    let mut pull = -state.offset * params.stiffness;
    for (((pin, passage), shaft), slot) in pins.iter_mut().zip(&mut state.sites).zip(shafts).zip(SLOTS) {
        if let Some(point) = passage.point() {
            // The thread may hold it where the needle does not.
            coupling.kernels[slot] = point.kernel;
        }
        *pin = match passage {
            Passage::Ahead | Passage::Track(_) | Passage::Passed(_) => continue,
            Passage::Touch(touch) => press(touch, &tool, tissue),
            Passage::Hole(hole) => guide(params, hole, (&tool, shaft), tissue),
        };
        stiffness += pin.stiffness;
        pull -= pin.force;
    }
    if stiffness == Mat3::zeros() {
        state.offset = Vec3::zeros();
        return Holds::default();
    }
    let own = Mat3::identity() * (params.stiffness + params.rate);
    let yields = (own + stiffness).try_inverse().unwrap_or_default();
    for (pin, p) in pins.iter().zip(SLOTS) {
        coupling.force[p] += pin.force + pin.stiffness * (yields * pull);
        coupling.stiffness[p][p] += pin.stiffness;
        for (other, q) in pins.iter().zip(SLOTS) {
            coupling.stiffness[p][q] -= pin.stiffness * yields * other.stiffness;
        }
    }
    Holds {
        pins,
        yields: Some(yields),
        pull,
    }
}

/// The tip holds the point it presses on, along all three axes.
fn press<const N: usize>(touch: &Touch, tool: &Arc, tissue: &Tissue<N>) -> Pin {
    let (tip, _) = tool.tip();
    Pin {
        force: (tip - touch.point.predicted(tissue)) * RIGID,
        stiffness: Mat3::identity() * RIGID,
    }
}

/// The point is kept on the arc across t; along t the shaft rubs.
fn guide<const N: usize>(params: &Params, hole: &mut Hole, (tool, shaft): (&Arc, Shaft), tissue: &Tissue<N>) -> Pin {
    let place = hole.point.predicted(tissue);
    let near = tool.nearest(place);
    let along = near.tangent * near.tangent.transpose();
    let rub = rub(params, hole, near.from_tip, shaft);
    Pin {
        force: (near.point - place) * RIGID + near.tangent * rub.force,
        stiffness: (Mat3::identity() - along) * RIGID + along * rub.stiffness,
    }
}

/// Reads the forces after the tissue has moved by `moved` from the predicted places, and lets a surface give way at F0.
pub fn settle<const N: usize>(
    params: &Params,
    state: &mut State,
    arc: &Arc,
    (holds, moved): (&Holds, &[Vec3; POINTS]),
    tissue: &Tissue<N>,
) -> Grip {
    let Some(yields) = holds.yields else {
        return Grip::default();
    };
    let moved = SLOTS.map(|p| moved.get(p).copied().unwrap_or_default());
    let answers = holds.pins.iter().zip(&moved).map(|(pin, moved)| pin.stiffness * moved);
    let drawn = yields * (holds.pull + answers.sum::<Vec3>());
    let damper = drawn * params.rate;
    let mut grip = Grip {
        force: (state.offset + drawn) * params.stiffness + damper,
        ..Grip::default()
    };
    state.offset += drawn - yields * bent(state, arc, (holds, &moved, drawn), tissue);
    let tool = arc.shifted(state.offset);
    let sites = Site::ALL.into_iter().zip(&mut state.sites);
    for ((site, passage), (pin, moved)) in sites.zip(holds.pins.iter().zip(&moved)) {
        let force = pin.force + pin.stiffness * (drawn - moved);
        if let Some(point) = passage.point() {
            grip.torque -= (point.place(tissue) - tool.pose.position).cross(&force);
        }
        if let Passage::Touch(touch) = passage {
            // Without the damper, whose share would add the encoders' steps.
            let steady = force + pin.stiffness * (yields * damper);
            let (next, puncture) = give_way(params, (site, touch), (&tool, steady), tissue);
            *passage = next;
            grip.puncture = grip.puncture.or(puncture);
        }
    }
    grip
}

/// Force on the points that the linear answer to `drawn` leaves out, for the arc's curvature.
fn bent<const N: usize>(
    state: &State,
    arc: &Arc,
    (holds, moved, drawn): (&Holds, &[Vec3; 4], Vec3),
    tissue: &Tissue<N>,
) -> Vec3 {
    let tool = arc.shifted(state.offset + drawn);
    let of = |((passage, pin), moved): ((&Passage, &Pin), &Vec3)| {
        let Passage::Hole(hole) = passage else {
            return Vec3::zeros();
        };
        let place = hole.point.place(tissue);
        let near = tool.nearest(place);
        let linear = pin.force + pin.stiffness * (drawn - moved);
        (near.point - place) * RIGID - (linear - near.tangent * near.tangent.dot(&linear))
    };
    state.sites.iter().zip(&holds.pins).zip(moved).map(of).sum()
}

/// What becomes of a surface that the tip presses with `force`: it gives way at F0, and lets go of a tip that pulls.
fn give_way<const N: usize>(
    params: &Params,
    (site, touch): (Site, &Touch),
    (tool, force): (&Arc, Vec3),
    tissue: &Tissue<N>,
) -> (Passage, Option<Puncture>) {
    let (_, tangent) = tool.tip();
    let along = force.dot(&tangent);
    if let Some(f0) = touch.f0.filter(|f0| along >= *f0) {
        let puncture = Puncture {
            site,
            force: along,
            f0,
            depth: (touch.point.place(tissue) - touch.from).dot(&tangent),
        };
        let hole = Hole {
            point: touch.point,
            from_tip: 0.0,
            adhesion: 0.0,
            cut: 0.0,
        };
        (Passage::Hole(hole), Some(puncture))
    } else if along < -params.stiffness * ADHESION {
        (Passage::Ahead, None)
    } else {
        (Passage::Touch(*touch), None)
    }
}
