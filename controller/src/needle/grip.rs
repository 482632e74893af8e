//! What the tool does to the tissue, and what the hand feels of it.

use super::{Arc, Hole, Params, Passage, Point, State, Touch};
use crate::coupling::{Coupling, LEFT, POINTS, RIGHT};
use crate::event::Puncture;
use crate::lattice::Tissue;
use crate::math::{Mat3, Pose, Vec3};
use sutura_shared::scene::Site;

/// Stretch of the virtual coupling at which the tip leaves the skin [m]: above the encoders' 29 µm, so that their steps alone
/// do not make and break the contact.
const ADHESION: f32 = 4e-5;

/// Forces of the tool on its two points as the tissue's solver was given them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Holds {
    /// Left and right.
    sites: [Hold; 2],
}

/// The tool's hold on one point: F(u) = force − stiffness · u with u from the predicted place.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hold {
    force: Vec3,
    stiffness: Mat3,
}

impl Default for Hold {
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
    let before = state.before.unwrap_or(arc.pose);
    let shafts = shafts(state, arc);
    // The tip cuts until it meets the far side's skin from below.
    let cuts = [matches!(state.right, Passage::Ahead), false];
    let mut holds = Holds::default();
    let sites = [&mut state.left, &mut state.right]
        .into_iter()
        .zip(shafts.into_iter().zip(cuts));
    for ((hold, (site, rubs)), slot) in holds.sites.iter_mut().zip(sites).zip([LEFT, RIGHT]) {
        *hold = match site {
            Passage::Ahead | Passage::Passed(_) => Hold::default(),
            Passage::Touch(touch) => press(params, touch, arc.tip().0, tissue),
            Passage::Hole(hole) => guide(params, hole, (arc, rubs), &before, tissue),
        };
        if let Some(point) = site.point() {
            coupling.kernels[slot] = point.kernel;
        }
        coupling.force[slot] += hold.force;
        coupling.stiffness[slot][slot] += hold.stiffness;
    }
    state.before = Some(arc.pose);
    holds
}

/// Length of shaft that rubs at each site [m]: from the left site to the right one, or to the needle's end.
fn shafts(state: &State, arc: &Arc) -> [f32; 2] {
    let depth = |site: &Passage| match site {
        Passage::Hole(hole) => Some(hole.from_tip),
        _ => None,
    };
    match (depth(&state.left), depth(&state.right)) {
        (Some(left), Some(right)) => [(left - right).max(0.0), 0.0],
        (Some(left), None) => [left, 0.0],
        (None, Some(right)) => [0.0, arc.length - right],
        (None, None) => [0.0; 2],
    }
}

/// A spring K_c and a damper B_c between the tip and the tissue point, all three axes.
fn press<const N: usize>(params: &Params, touch: &mut Touch, tip: Vec3, tissue: &Tissue<N>) -> Hold {
    let way = tip - touch.tip;
    touch.tip = tip;
    pull(params, (tip, way), Mat3::identity(), (&touch.point, tissue))
}

/// A is kept on the arc across t; along t the shaft adheres until friction gives way (Hayward & Armstrong 2000).
fn guide<const N: usize>(
    params: &Params,
    hole: &mut Hole,
    (arc, (shaft, cuts)): (&Arc, (f32, bool)),
    before: &Pose,
    tissue: &Tissue<N>,
) -> Hold {
    let near = arc.nearest(hole.point.predicted(tissue));
    let along = near.tangent * near.tangent.transpose();
    let way = near.point - before.point(arc.pose.inverse().point(near.point));
    let across = Mat3::identity() - along;
    let mut hold = pull(params, (near.point, way), across, (&hole.point, tissue));
    let [per_length, cutting] = params.friction;
    let advancing = cuts && near.from_tip > hole.adhesion;
    let limit = per_length * shaft + if advancing { cutting } else { 0.0 };
    if limit > 0.0 {
        let reach = limit / params.stiffness;
        let strain = near.from_tip - hole.adhesion;
        let held = strain.max(-reach).min(reach);
        hole.adhesion = near.from_tip - held;
        hold.force += near.tangent * (params.stiffness * held);
        if held.to_bits() == strain.to_bits() {
            hold.stiffness += along * params.stiffness;
        }
    }
    hold
}

/// A spring K_c and a damper B_c between a `place` on the tool, which has come there by its `way` in this tick, and a tissue point.
fn pull<const N: usize>(
    params: &Params,
    (place, way): (Vec3, Vec3),
    across: Mat3,
    (point, tissue): (&Point, &Tissue<N>),
) -> Hold {
    let predicted = point.predicted(tissue);
    let motion = way - (predicted - point.place(tissue));
    Hold {
        force: across * ((place - predicted) * params.stiffness + motion * params.rate),
        stiffness: across * (params.stiffness + params.rate),
    }
}

/// Reads the forces after the tissue has moved by `moved` from the predicted places, and lets the skin give way at F0.
pub fn settle<const N: usize>(
    params: &Params,
    state: &mut State,
    arc: &Arc,
    (holds, moved): (&Holds, &[Vec3; POINTS]),
    tissue: &Tissue<N>,
) -> Grip {
    let mut grip = Grip::default();
    let names = [(Site::Left, LEFT), (Site::Right, RIGHT)];
    let sites = [&mut state.left, &mut state.right].into_iter().zip(names).enumerate();
    for ((n, (site, (name, slot))), hold) in sites.zip(&holds.sites) {
        let force = hold.force - hold.stiffness * moved[slot];
        if let Some(point) = site.point() {
            grip.force -= force;
            grip.torque -= (point.place(tissue) - arc.pose.position).cross(&force);
        }
        if let Passage::Touch(touch) = site {
            let place = touch.point.place(tissue);
            let (tip, tangent) = arc.tip();
            // The coupling's spring alone: its damper would add the encoders' steps.
            let along = (tip - place).dot(&tangent) * params.stiffness;
            let f0 = params.f0.map(|f0| f0[n]);
            if let Some(f0) = f0.filter(|f0| along >= *f0) {
                let depth = (place - touch.from).dot(&tangent);
                grip.puncture = Some(Puncture {
                    site: name,
                    force: along,
                    f0,
                    depth,
                });
                *site = Passage::Hole(Hole {
                    point: touch.point,
                    from_tip: 0.0,
                    adhesion: 0.0,
                });
            } else if along < -params.stiffness * ADHESION {
                *site = Passage::Ahead;
            }
        }
    }
    grip
}
