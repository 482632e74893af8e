//! Tear-through: a thread that pulls harder than the tissue bears cuts its way, as a wire cuts cheese.
//!
//! A puncture is a material point. Where the thread's pull F along the skin is above the tissue's strength S, the point moves through the
//! material in the direction of the pull with
//!
//! ```text
//!   v = (F − S)·φ,
//! ```
//!
//! a viscoplastic yield (Perzyna 1966): in the end the pull is S at most. The puncture goes no further than the wound's edge, where the thread
//! stays hooked: that it comes off there is not simulated.

use crate::math::{Vec3, length};
use crate::needle::{Body, Point};
use crate::surface::kernel_among;
use crate::wound::Side;
use sutura_shared::scene::{self, Effect, Scene};

/// Fluidity φ [m/(s·N)], our choice: a newton too much cuts 10 mm in a second, faster than a hand tightens a stitch.
const FLUIDITY: f32 = 0.01;
/// Fastest that a puncture is cut [m/s].
const FASTEST: f32 = 0.1;

/// Coefficients; immutable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Pull along the skin that the tissue bears S [N].
    pub strength: f32,
    /// Radius of a puncture's kernel [m].
    pub kernel: f32,
}

impl Params {
    /// Those of the tissue under the skin where the scene's first stitch begins; nothing without effect `tearing`.
    #[must_use]
    pub fn new(scene: &Scene, cells: &[u8]) -> Option<Self> {
        let stitch = scene.stitch.filter(|_| scene.effects.has(Effect::Tearing))?;
        let ([cx, cy, _], [x, y]) = (scene.lattice.cells.map(usize::from), stitch.a_m);
        let [ox, oy, _] = scene.lattice.origin_m;
        let [i, j] = [x - ox, y - oy].map(|along| (along / scene.lattice.pitch_m).max(0.0) as usize);
        let column = cells.iter().skip(j * cx + i).step_by((cx * cy).max(1));
        let mut tissues = column.filter_map(|cell| scene.tissues.get(usize::from(*cell).checked_sub(1)?));
        match tissues.next_back()?.body {
            scene::Body::Soft { strength_n, .. } => Some(Self {
                strength: strength_n,
                kernel: scene.contact.kernel_m,
            }),
            scene::Body::Fixed => None,
        }
    }

    /// Pull beyond the tissue's strength [N]; not more than zero where it holds.
    fn overload(self, pull: Vec3) -> f32 {
        length(Vec3::new(pull.x, pull.y, 0.0)) - self.strength
    }
}

/// Lets `point` cut its way under `pull` [N] for a time [s]; returns how far it has come [m].
pub fn advance<const N: usize>(
    params: &Params,
    point: &mut Point,
    (pull, time): (Vec3, f32),
    body: &Body<'_, N>,
) -> f32 {
    let far = (params.overload(pull) * FLUIDITY).min(FASTEST) * time;
    let along = Vec3::new(pull.x, pull.y, 0.0);
    let load = length(along);
    if far <= 0.0 || load <= 0.0 {
        return 0.0;
    }
    let side = body.faces.map(|faces| faces.side(body.lattice, point.rest));
    let columns = body.faces.zip(side).map(|(faces, side)| faces.columns(side));
    let place = point.place(body.tissue) + along * (far / load);
    let near = (place, params.kernel);
    let kernel = kernel_among(body.lattice, body.tissue, near, &columns.unwrap_or(0..=u32::MAX));
    if kernel.is_empty() {
        return 0.0;
    }
    let cut = Point::new(kernel, place, body.tissue);
    let beyond = body.faces.zip(side).is_some_and(|(faces, side)| match side {
        Side::Left => cut.rest.x > faces.face(body.lattice, side),
        Side::Right => cut.rest.x < faces.face(body.lattice, side),
    });
    if beyond {
        return 0.0;
    }
    *point = cut;
    far
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Lattice, Tissue};
    use crate::wound::{Faces, faces};
    use bytemuck::Zeroable;
    use sutura_shared::scene::Wound;

    const N: usize = 1024;
    const PARAMS: Params = Params {
        strength: 3.0,
        kernel: 3.5e-3,
    };

    /// Nine columns by five rows in three layers 2 mm apart, cut between the fourth column, at x = −2 mm, and the sixth.
    fn block() -> (Box<Lattice<N>>, Box<Tissue<N>>, Faces) {
        let (mut lattice, tissue) = (Box::new(Lattice::<N>::zeroed()), Box::new(Tissue::<N>::zeroed()));
        (lattice.nodes, lattice.pitch, lattice.origin) = ([9, 5, 3], 2e-3, [-8e-3, -4e-3, -4e-3]);
        lattice.mass.fill(1.0);
        lattice.free.fill(1.0);
        let wound = Wound {
            faces: [3, 5],
            rows: [0, 4],
            floor: 0,
            penalty_n_per_m: 1.0,
        };
        let faces = faces(&wound, None, &lattice).unwrap();
        (lattice, tissue, faces)
    }

    /// Where a puncture at (−5, 0, 0) mm is after so many ticks under `pull`, and how far it was cut [m].
    fn cut(pull: Vec3, ticks: usize) -> (Vec3, f32) {
        let (lattice, tissue, faces) = block();
        let body = Body {
            lattice: &*lattice,
            tissue: &*tissue,
            faces: Some(&faces),
        };
        let place = Vec3::new(-5e-3, 0.0, 0.0);
        let kernel = kernel_among(&lattice, &tissue, (place, PARAMS.kernel), &(0..=3));
        let mut point = Point::new(kernel, place, &tissue);
        let torn = (0..ticks)
            .map(|_| advance(&PARAMS, &mut point, (pull, 1e-3), &body))
            .sum();
        (point.place(&tissue), torn)
    }

    /// v = (F − S)·φ: 5 N along the skin cut tissue that bears 3 N at 20 mm/s, 2 mm in 100 ms, in their own direction; what pulls out of the
    /// skin has no part in it.
    #[test]
    fn a_puncture_moves_as_fast_as_the_pull_is_above_the_strength() {
        let (place, torn) = cut(Vec3::new(3.0, 4.0, 7.0), 100);
        let expected = Vec3::new(-5e-3 + 1.2e-3, 1.6e-3, 0.0);
        assert!(
            (place - expected).norm() < 1e-6 && (torn - 2e-3).abs() < 1e-6,
            "{place} {torn}"
        );
    }

    #[test]
    fn tissue_holds_what_it_bears() {
        let (place, torn) = cut(Vec3::new(-2.99, 0.0, 50.0), 1000);
        assert!(torn <= 0.0 && (place.x + 5e-3).abs() < 1e-9, "{place} {torn}");
    }

    /// The face of the wound is 3 mm away, and 0.1 mm are cut in a millisecond at most.
    #[test]
    fn a_puncture_stops_at_the_wound() {
        let (place, torn) = cut(Vec3::new(40.0, 0.0, 0.0), 1000);
        assert!(
            (2.9e-3..3.001e-3).contains(&torn) && place.x < -1.999e-3,
            "{place} {torn}"
        );
        let (_, torn) = cut(Vec3::new(40.0, 0.0, 0.0), 10);
        assert!((torn - 1e-3).abs() < 1e-6, "{torn}");
    }
}
