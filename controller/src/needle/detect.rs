//! Where the tip meets a surface, by geometry alone.

use super::passage::{Hole, Passage, Point, Touch, Track};
use super::{Arc, Params, State};
use crate::lattice::{Lattice, Tissue};
use crate::math::{Vec3, length};
use crate::surface::{height, kernel_among, strain};
use crate::wound::{Faces, Side};
use sutura_shared::scene::Site;

/// How far beside the opening of a track the needle still finds it [m]: about as wide as a needle's body.
const MOUTH: f32 = 1e-3;

/// What the tool meets.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a, const N: usize> {
    /// The patch.
    pub lattice: &'a Lattice<N>,
    /// Its state.
    pub tissue: &'a Tissue<N>,
    /// The faces of its wound.
    pub faces: Option<&'a Faces>,
}

/// Moves all sites by geometry: the tip meets a surface or an open track, the needle's ends pass the constraint points.
pub fn detect<const N: usize>(params: &Params, state: &mut State, arc: &Arc, body: &Body<'_, N>) {
    let arc = &arc.shifted(state.offset);
    let reached = reached(params, state, arc, body);
    for ((site, passage), reached) in Site::ALL.into_iter().zip(&mut state.sites).zip(reached) {
        *passage = match *passage {
            Passage::Ahead if reached => meet(params, site, arc, body),
            Passage::Track(track) if reached => enter(params, (site, track), arc, body),
            other => other.slid(arc, body.tissue),
        };
    }
}

/// Whether the tip is at the surface of each site, on its way from the site before.
fn reached<const N: usize>(params: &Params, state: &State, arc: &Arc, body: &Body<'_, N>) -> [bool; 4] {
    let (tip, tangent) = arc.tip();
    let [a, b, c, _] = &state.sites;
    let skin = height(body.lattice, body.tissue, tip);
    let wall = |side| body.faces?.wall(side, (body.lattice, body.tissue), tip);
    let far = body
        .faces
        .is_none_or(|faces| faces.side(body.lattice, tip) == Side::Right);
    // In the wound, between b and c, there is no skin to come out of.
    let in_tissue = a.is_through() && b.is_through() == c.is_through();
    [
        skin.is_some_and(|z| tip.z < z),
        a.is_through() && tangent.x > 0.0 && wall(Side::Left).is_some_and(|x| tip.x > x - params.under),
        b.is_through() && wall(Side::Right).is_some_and(|x| tip.x > x),
        in_tissue && far && tangent.z > 0.0 && skin.is_some_and(|z| tip.z > z - params.under),
    ]
}

/// The tip presses on a surface that is whole.
fn meet<const N: usize>(params: &Params, site: Site, arc: &Arc, body: &Body<'_, N>) -> Passage {
    let (tip, _) = arc.tip();
    let columns = body.faces.map_or(0..=u32::MAX, |faces| {
        faces.columns(match site {
            Site::A | Site::D => faces.side(body.lattice, tip),
            Site::B => Side::Left,
            Site::C => Side::Right,
        })
    });
    let kernel = kernel_among(body.lattice, body.tissue, (tip, params.kernel), &columns);
    if kernel.is_empty() {
        return Passage::Ahead;
    }
    Passage::Touch(Touch {
        point: Point::new(kernel, tip, body.tissue),
        from: tip,
        f0: f0(params, site, tip, body),
    })
}

/// F0 of a site as tense as its skin is when the tip meets it.
fn f0<const N: usize>(params: &Params, site: Site, tip: Vec3, body: &Body<'_, N>) -> Option<f32> {
    let [a, b, c, d] = params.f0?;
    let tense = || {
        let strain = strain(body.lattice, body.tissue, tip).unwrap_or(0.0);
        1.0 + params.tension_gain * strain.max(0.0)
    };
    Some(match site {
        Site::A => a * tense(),
        Site::B => b,
        Site::C => c,
        Site::D => d * tense(),
    })
}

/// The needle comes back to a track: through its opening without force, beside it through what is whole.
fn enter<const N: usize>(params: &Params, (site, track): (Site, Track), arc: &Arc, body: &Body<'_, N>) -> Passage {
    let opening = track.point.place(body.tissue);
    let near = arc.nearest(opening);
    if length(near.point - opening) > MOUTH || near.from_tip < -2.0 * MOUTH {
        meet(params, site, arc, body)
    } else if near.from_tip < 0.0 {
        Passage::Track(track)
    } else {
        Passage::Hole(Hole {
            point: track.point,
            from_tip: near.from_tip,
            adhesion: near.from_tip,
            cut: track.cut,
        })
    }
}
