//! A scene without one of its effects.

use sutura_controller::effects::TABLE;
use sutura_shared::scene::{Body, Effect, Effects, Scene, Until};

/// The scene without `effect`, without what needs it, and without their parameters. A hand that would wait for what no longer comes goes on
/// when its time is over.
#[must_use]
pub fn without(scene: &Scene, effect: Effect) -> Scene {
    let mut scene = scene.clone();
    for row in TABLE.iter().filter(|row| row.needs == Some(effect)) {
        scene = without(&scene, row.effect);
    }
    scene.effects = Effects(scene.effects.0 & !(effect as u32));
    match effect {
        Effect::Gravity | Effect::Barrier => {}
        Effect::Stiffening | Effect::Tearing => {
            for tissue in &mut scene.tissues {
                match &mut tissue.body {
                    Body::Soft { curve, .. } if effect == Effect::Stiffening => curve.truncate(1),
                    Body::Soft { strength_n, .. } => *strength_n = 0.0,
                    Body::Fixed => {}
                }
            }
        }
        Effect::SpringDamping => scene.lattice.spring_damping_s = 0.0,
        Effect::Puncture => scene.stitch = None,
        Effect::ShaftFriction => {
            if let Some(stitch) = &mut scene.stitch {
                (stitch.friction_n_per_m, stitch.cutting_n) = (0.0, 0.0);
            }
        }
        Effect::Thread => scene.thread = None,
        Effect::ThreadContact => scene.thread.iter_mut().for_each(|thread| thread.penalty_n_per_m = 0.0),
        Effect::ThreadFriction => scene.thread.iter_mut().for_each(|thread| thread.friction = 0.0),
        Effect::ThreadBending => scene.thread.iter_mut().for_each(|thread| thread.bending_n_m2 = 0.0),
        Effect::Knot => scene.thread.iter_mut().for_each(|thread| thread.knot_hold_n = 0.0),
        Effect::WoundContact => scene.wound.iter_mut().for_each(|wound| wound.penalty_n_per_m = 0.0),
        Effect::Passivity => scene.output.passivity_n_s_per_m = 0.0,
        Effect::SkinTension => scene.stitch.iter_mut().for_each(|stitch| stitch.tension_gain = 0.0),
    }
    let effects = scene.effects;
    for step in scene.hand.iter_mut().flat_map(|hand| &mut hand.steps) {
        let comes = match step.until {
            Until::Punctured(_) => effects.has(Effect::Puncture),
            Until::Tension(_) => effects.has(Effect::Thread),
            Until::Elapsed | Until::Stage(_) => true,
        };
        if !comes {
            step.until = Until::Elapsed;
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use sutura_shared::check::Validate;

    #[test]
    fn whatever_is_left_out_the_rest_is_a_scene() {
        let plan = crate::scene::load(None).unwrap();
        let scene = crate::scene::build::build(&plan, crate::run::embedded::NODES_MAX)
            .unwrap()
            .scene;
        for effect in Effect::ALL {
            let rest = without(&scene, effect);
            assert_eq!(rest.validate(), Ok(()), "{}", effect.name());
            assert!(!rest.effects.has(effect));
            assert_eq!(without(&rest, effect), rest);
        }
        let none = Effect::ALL.iter().fold(scene, |scene, effect| without(&scene, *effect));
        assert_eq!((none.effects, none.validate()), (Effects::default(), Ok(())));
    }
}
