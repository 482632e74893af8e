//! Whether the simulated arm can follow the hand's script: links and stops let its tip be at every place on the way.

use nalgebra::Rotation3;
use sutura_controller::device::sim::kinematics::{inverse, within_stops};
use sutura_controller::math::{Pose, Vec3};
use sutura_shared::scene::{Hand, Motion};

use super::operator::{Operator, Place, leaves_enough, patch_from_device};
use super::plan::Plan;

/// Places that are looked at on the way of one step.
const PLACES: u16 = 32;

/// Refuses a scene whose script leads out of the arm's reach.
///
/// # Errors
/// Which key to change, and to what where that is known.
pub fn check(plan: &Plan, places: &[Place]) -> Result<(), Error> {
    let reaches = |places: &[Place]| reaches(&plan.operator.hand(plan.hand, places));
    let enough = leaves_enough(places);
    if enough && reaches(places) {
        return Ok(());
    }
    let link_m = plan.thread.map_or(0.0, |thread| f64::from(thread.link_m));
    let with_links = |links: u16| {
        let thread_m = f64::from(links) * link_m;
        let with = |place: &Place| Place { thread_m, ..*place };
        places.iter().map(with).collect::<Vec<_>>()
    };
    let links = plan.thread.map_or(0, |thread| thread.nodes - 1);
    if !enough {
        let longer = (links..=u16::MAX).find(|links| leaves_enough(&with_links(*links)));
        return Err(Error::Short {
            length_mm: f64::from(links) * link_m * 1e3,
            stitches: places.len(),
            least_mm: (f64::from(longer.unwrap_or(u16::MAX)) * link_m * 1e3).ceil(),
        });
    }
    match (1..links).rev().find(|links| reaches(&with_links(*links))) {
        Some(fits) => Err(Error::Thread {
            length_mm: f64::from(links) * link_m * 1e3,
            most_mm: (f64::from(fits) * link_m * 1e3 + 1e-3).floor(),
        }),
        None => Err(Error::Tool {
            section: match plan.operator {
                Operator::Sew(_) => "[needle]",
                Operator::Touch(_) => "[operator.touch]",
            },
        }),
    }
}

/// Whether the tip can be at the start and all along every step, each of which begins where the one before it would end.
fn reaches(hand: &Hand) -> bool {
    let device_from_patch = Pose::from(patch_from_device(hand)).inverse();
    let mut here = Vec3::from(hand.start.position_m);
    let mut way = vec![here];
    for step in &hand.steps {
        let from = here;
        let at = |part: f32| match step.motion {
            Motion::Line { to } | Motion::Steady { to, .. } => from + (Vec3::from(to.position_m) - from) * part,
            Motion::Turn {
                centre_m,
                axis,
                angle_rad,
            } => {
                let centre = Vec3::from(centre_m);
                centre + Rotation3::new(Vec3::from(axis) * (angle_rad * part)) * (from - centre)
            }
            Motion::Hold => from,
        };
        way.extend((1..=PLACES).map(|place| at(f32::from(place) / f32::from(PLACES))));
        here = at(1.0);
    }
    way.into_iter()
        .all(|place| inverse(device_from_patch.point(place)).is_some_and(within_stops))
}

/// What takes the hand too far; one line each.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The thread is pulled taut too far away.
    #[error(
        "thread.length_mm = {length_mm:.0} is out of range: the simulated arm cannot pull it taut; at most {most_mm} is right here"
    )]
    Thread {
        /// As the scene says [mm].
        length_mm: f64,
        /// What the arm can do [mm].
        most_mm: f64,
    },
    /// There is not thread enough for all stitches.
    #[error(
        "thread.length_mm = {length_mm:.0} is too short for {stitches} stitches: at least {least_mm} is right here"
    )]
    Short {
        /// As the scene says [mm].
        length_mm: f64,
        /// How many are to be sewn.
        stitches: usize,
        /// What they need [mm].
        least_mm: f64,
    },
    /// The tool is moved too far by itself.
    #[error("{section}: the hand's script leads out of the simulated arm's reach; smaller lengths are right")]
    Tool {
        /// Section of the scene.
        section: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::build::build;
    use sutura_shared::scene::{self, Step, Until};

    fn pose(x: f32) -> scene::Pose {
        scene::Pose {
            position_m: [x, 0.0, 0.0],
            quaternion: [1.0, 0.0, 0.0, 0.0],
        }
    }

    /// The device's origin is amid the places. There the tip is l1 before the turret's axis and l2 below the shoulder, so at the distance w to either side
    /// the law of cosines puts the links at right angles less asin(w²/2 l1 l2), and their stop at −55° allows w² ≤ 2 l1 l2 sin 55°: 244.7 mm.
    #[test]
    fn the_arm_reaches_as_far_as_its_links() {
        for (half, reached) in [(0.244, true), (0.246, false)] {
            let hand = Hand {
                mass_kg: 0.2,
                damping_n_s_per_m: 5.0,
                stiffness_n_per_m: 400.0,
                tremor: None,
                start: pose(-half),
                steps: [Step {
                    motion: Motion::Line { to: pose(half) },
                    ticks: 1000,
                    until: Until::Elapsed,
                    button: false,
                }]
                .into_iter()
                .collect(),
            };
            assert_eq!(reaches(&hand), reached, "{half}");
        }
    }

    #[test]
    fn a_thread_that_is_too_long_is_refused_with_a_length_that_fits() {
        let with_length = |length_mm: f32| {
            let mut plan = crate::scene::load(None).unwrap();
            let thread = plan.thread.as_mut().unwrap();
            thread.nodes = 61;
            thread.link_m = length_mm * 1e-3 / 60.0;
            build(&plan, 24 * 24 * 12).map(|_| ())
        };
        let error = with_length(300.0).unwrap_err();
        let crate::scene::build::Error::Reach(Error::Thread { most_mm, .. }) = error else {
            panic!("{error}")
        };
        assert!(
            error.to_string().starts_with("thread.length_mm = 300 is out of range"),
            "{error}"
        );
        assert!((115.0..300.0).contains(&most_mm), "{most_mm}");
        with_length(most_mm as f32).unwrap();
    }
}
