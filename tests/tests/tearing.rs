//! A thread that pulls harder than the tissue bears cuts its way, in the built-in stitch.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use sutura::run::embedded::PcRig;
use sutura::scene::build::Built;
use sutura_controller::lanes::Level;
use sutura_controller::link::Plant as _;
use sutura_controller::record::Output;
use sutura_shared::scene::{Body, Effect, Stage};
use sutura_tests::scenario;

/// Longest run [ticks].
const TICKS_MAX: usize = 15_000;

/// The built-in stitch in tissue of this strength [N].
fn stitch(strength_n: f32) -> Built {
    let mut built = scenario::built(None).unwrap();
    built.scene.effects = built.scene.effects.with(Effect::Tearing);
    for tissue in &mut built.scene.tissues {
        if let Body::Soft {
            strength_n: strength, ..
        } = &mut tissue.body
        {
            *strength = strength_n;
        }
    }
    built
}

/// Sews until so many ticks after the knot; `see` is shown every tick.
fn sew(built: &Built, after: usize, mut see: impl FnMut(&PcRig<'_>, &Output)) {
    let mut memory = scenario::memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    let mut done = 0;
    for _ in 0..TICKS_MAX {
        let output = rig.tick();
        see(&rig, &output);
        done += usize::from(output.stage == Stage::Done);
        if done > after {
            return;
        }
    }
    unreachable!("the stitch is not done");
}

/// Tissue yields until it bears the pull: the stitch ends with the tissue's strength, where it would have held 1.45 N.
#[test]
fn what_is_left_of_the_pull_is_the_tissues_strength() {
    let (mut torn, mut closing, mut faults) = (Vec::new(), 0.0, 0);
    sew(&stitch(1.2), 3000, |rig, output| {
        torn.push(rig.controller().torn());
        [closing, ..] = rig.controller().closing();
        faults |= output.faults.0;
    });
    assert_eq!(faults, 0);
    assert!(torn.windows(2).all(|pair| pair[0] <= pair[1]), "a tear does not heal");
    let torn_mm = torn.last().unwrap() * 1e3;
    println!("{torn_mm:.3} mm are cut, {closing:.3} N are left");
    assert!((0.2..4.0).contains(&torn_mm), "{torn_mm} mm");
    assert!((closing / 1.2 - 1.0).abs() < 0.02, "{closing} N");
}

/// Tissue that bears the pull is as it was without the effect, bit by bit.
#[test]
fn tissue_that_bears_the_pull_is_not_cut() {
    let mut base = Vec::new();
    sew(&scenario::built(None).unwrap(), 100, |_, output| base.push(*output));
    let mut outputs = base.iter();
    sew(&stitch(20.0), 100, |rig, output| {
        assert_eq!(Some(output), outputs.next());
        assert!(rig.controller().torn() <= 0.0);
    });
}
