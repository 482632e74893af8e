//! Host and controller, each behind its frames, with a plant of one mass on a spring.

use super::*;
use sutura_controller::hash::Hasher;
use sutura_controller::link::{LoadError, Loaded, Plant};
use sutura_controller::math::{DT, Vec3};
use sutura_controller::record::{Faults, Output};
use sutura_controller::safety::LimitedForce;
use sutura_shared::scene::*;

/// x'' = −k x of unit mass from x = 1 m, by the symplectic Euler scheme.
#[derive(Default)]
struct Spring {
    tick: u32,
    stiffness: f32,
    x: f32,
    v: f32,
    stopped: bool,
}

impl Plant for Spring {
    fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<Loaded, LoadError> {
        let Tool::Ball { radius_m } = scene.tool else {
            return Err(LoadError("tool: a ball"));
        };
        *self = Self {
            stiffness: radius_m * 1000.0,
            x: 1.0,
            ..Self::default()
        };
        let voxels = cells.iter().filter(|cell| **cell != 0).count() as u32;
        Ok(Loaded { voxels, nodes: 8 })
    }

    fn tick(&mut self) -> Output {
        assert!(!self.stopped);
        self.tick += 1;
        self.v -= self.stiffness * self.x * DT;
        self.x += self.v * DT;
        Output {
            tick: self.tick,
            stage: Stage::Approach,
            stitch: 1,
            faults: Faults::default(),
            simulated: Vec3::zeros(),
            rendered: LimitedForce::default(),
            torque: Vec3::zeros(),
            position: Vec3::new(self.x, self.v, 0.0),
            thread: 0.0,
            gap: [0.0; 3],
            gap_mean: 0.0,
            saturated: false,
            puncture: None,
        }
    }

    fn state_hash(&self) -> u64 {
        let mut hash = Hasher::default();
        hash.word(self.tick);
        hash.vector(Vec3::new(self.x, self.v, 0.0));
        hash.get()
    }

    fn release(&mut self) {}

    fn stop(&mut self) {
        self.stopped = true;
    }
}

fn scene(radius_m: f32) -> Scene {
    let identity = Pose {
        position_m: [0.0; 3],
        quaternion: [1.0, 0.0, 0.0, 0.0],
    };
    Scene {
        effects: Effects::default(),
        solver: Solver::BePcg {
            iterations: 10,
            newton: 1,
        },
        lattice: Lattice {
            cells: [20, 15, 6],
            pitch_m: 0.002,
            origin_m: [0.0; 3],
            law: Law::Isotropic,
            assembly: Assembly::PerVoxel,
            damping_per_s: 50.0,
            spring_damping_s: 0.0,
        },
        tissues: heapless::Vec::from_slice(&[Tissue {
            density_kg_m3: 1000.0,
            body: Body::Fixed,
        }])
        .unwrap(),
        tool: Tool::Ball { radius_m },
        contact: Contact {
            coupling_n_per_m: 500.0,
            coupling_n_s_per_m: 1.0,
            kernel_m: 0.003,
        },
        stitch: None,
        thread: None,
        wound: None,
        output: sutura_shared::scene::Output {
            scale: 1.0,
            slew_n: 0.5,
            passivity_n_s_per_m: 0.0,
        },
        device: Device {
            profile: Profile::Premium15,
            patch_from_device: identity,
        },
        hand: None,
    }
}

const CELLS: [u8; 1800] = [1; 1800];

/// What a host does with a controller, and how that ran.
fn with_controller<A>(pace: Pace, act: impl FnOnce(&mut Link<ChannelTransport>) -> A) -> (A, Ran) {
    let (ours, theirs) = channel(256);
    let controller = std::thread::spawn(move || run_controller(theirs, Spring::default(), pace));
    let mut link = Link::connect(ours).unwrap();
    let result = act(&mut link);
    assert_eq!(link.counts().errors, 0);
    drop(link);
    let ran = controller.join().unwrap();
    assert_eq!(
        (ran.received.errors, ran.received.missing, ran.received.stale),
        (0, 0, 0)
    );
    (result, ran)
}

/// The scheme above, written out: positions after each tick.
fn expected(stiffness: f32, ticks: usize) -> Vec<f32> {
    let (mut x, mut v) = (1.0_f32, 0.0_f32);
    (0..ticks)
        .map(|_| {
            v -= stiffness * x * DT;
            x += v * DT;
            x
        })
        .collect()
}

#[test]
fn every_tick_arrives_once_and_in_order() {
    for pace in [Pace::Free, Pace::Realtime] {
        let ticks = 777;
        let ((places, (last, _)), ran) = with_controller(pace, |link| {
            let accepted = link.upload(&scene(0.005), &CELLS).unwrap();
            assert_eq!((accepted.voxels, accepted.nodes), (1800, 8));
            let mut places = Vec::new();
            let end = link.run(ticks, |message| {
                if let ToHost::Telemetry(telemetry) = message {
                    assert_eq!(telemetry.tick as usize, places.len() + 1);
                    places.push(telemetry.position_m[0]);
                }
                ControlFlow::Continue(())
            });
            (places, end.unwrap())
        });
        assert_eq!(last, ticks);
        assert_eq!(ran.tick_ns.len(), ticks as usize);
        let bits = |places: &[f32]| places.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&places), bits(&expected(0.005 * 1000.0, ticks as usize)));
    }
}

/// How fast the host reads and the controller runs decides nothing, not even where a run ends that is broken off on the way.
#[test]
fn a_run_ends_the_same_at_any_speed() {
    let broken_off_at = |at: u32, pace: Pace, slow: bool| {
        with_controller(pace, |link| {
            link.upload(&scene(0.005), &CELLS).unwrap();
            link.run(100_000, |message| match message {
                ToHost::Telemetry(telemetry) => {
                    if slow && telemetry.tick % 64 == 0 {
                        std::thread::sleep(Duration::from_millis(3));
                    }
                    if telemetry.tick == at {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                }
                _ => ControlFlow::Continue(()),
            })
            .unwrap()
        })
        .0
    };
    let end = broken_off_at(450, Pace::Free, false);
    assert_eq!(end.0, 600);
    assert_eq!(broken_off_at(450, Pace::Free, true), end);
    assert_eq!(broken_off_at(450, Pace::Realtime, false), end);
}

#[test]
fn refusals_say_why_and_the_link_goes_on() {
    with_controller(Pace::Free, |link| {
        let refused = |link: &mut Link<_>, scene: &Scene, cells: &[u8]| match link.upload(scene, cells) {
            Err(LinkError::Refused { reason, detail, .. }) => (reason, detail),
            other => panic!("{other:?}"),
        };
        let mut bad = scene(0.005);
        bad.lattice.pitch_m = f32::NAN;
        assert_eq!(
            refused(link, &bad, &CELLS),
            (UploadError::Value, "lattice.pitch_m".into())
        );
        assert_eq!(
            refused(link, &scene(0.005), &CELLS[1..]),
            (UploadError::Value, "cells".into())
        );
        assert_eq!(
            refused(link, &scene(0.005), &[2; 1800]),
            (UploadError::Value, "cells".into())
        );
        let needle = Scene {
            tool: Tool::Needle {
                radius_m: 0.01,
                length_m: 0.03,
                grasp_m: 0.01,
            },
            ..scene(0.005)
        };
        assert_eq!(
            refused(link, &needle, &CELLS),
            (UploadError::Build, "tool: a ball".into())
        );
        assert!(matches!(
            link.upload(&scene(0.005), &[1; 8193]),
            Err(LinkError::TooLong { .. })
        ));
        link.upload(&scene(0.005), &CELLS).unwrap();
        assert_eq!(link.run(10, |_| ControlFlow::Continue(())).unwrap().0, 10);
        // A new scene is tick 0 again only where it may be: tick 0 is in the past now.
        assert_eq!(refused(link, &scene(0.005), &CELLS).0, UploadError::Late);
        assert_eq!(link.stop().unwrap(), 10);
        link.upload(&scene(0.005), &CELLS).unwrap();
        assert_eq!(link.run(5, |_| ControlFlow::Continue(())).unwrap().0, 5);
    });
}

#[test]
fn a_controller_that_is_gone_is_an_error() {
    let (ours, theirs) = channel(4);
    drop(theirs);
    assert!(matches!(Link::connect(ours), Err(LinkError::Io(_))));
}

/// A controller built from other sources: named as such.
#[test]
fn another_version_is_named() {
    let (ours, mut theirs) = channel(4);
    let old = Version { major: 0, ..VERSION };
    let reject = ToHost::Reject(sutura_shared::message::Reject {
        mine: old,
        yours: VERSION,
    });
    theirs.send(reject.encode(0, 0, &mut [0; WIRE_MAX]).unwrap()).unwrap();
    let error = Link::connect(ours).unwrap_err();
    assert!(error.to_string().contains("speaks version 0.0 (schema"), "{error}");
}
