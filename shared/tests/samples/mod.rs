//! One of every message, and a scene for every variant a scene can hold.
#![allow(dead_code, clippy::unwrap_used)] // Each test binary uses its part; a test may fail by unwrapping.

use heapless::{String, Vec};
use sutura_shared::limits::WIRE_MAX;
use sutura_shared::message::*;
use sutura_shared::scene::*;

/// Session and sequence number of every sample frame: no byte is zero or equal to another.
pub(crate) const SESSION: u8 = 0x5a;
pub(crate) const SEQ: u16 = 0x1234;

pub(crate) fn to_controller() -> std::vec::Vec<ToController<'static>> {
    vec![
        ToController::Hello(hello()),
        ToController::SceneBegin(SceneBegin {
            transfer: 7,
            scene_len: 300,
            cells_len: 8192,
            hash: 0x0123_4567_89ab_cdef,
        }),
        ToController::SceneChunk(SceneChunk {
            transfer: 7,
            offset: 224,
            data: &[0, 1, 2, 0, 255],
        }),
        ToController::SceneCommit(SceneCommit {
            transfer: 7,
            hash: 0x0123_4567_89ab_cdef,
            apply_at_tick: 1000,
        }),
        ToController::Grant(Grant { until_tick: 70_000 }),
        ToController::Stop,
    ]
}

/// The hash is a sample, not this build's: the golden file's hash cannot stand in the golden file.
pub(crate) fn hello() -> Hello {
    Hello {
        magic: MAGIC,
        version: Version {
            major: 1,
            minor: 2,
            schema_hash: 0xfedc_ba98_7654_3210,
        },
        nonce: 0xdead_beef,
    }
}

pub(crate) fn to_host() -> std::vec::Vec<ToHost> {
    let mut all = vec![
        ToHost::Hello(hello()),
        ToHost::Reject(Reject {
            mine: hello().version,
            yours: Version {
                major: 2,
                minor: 0,
                schema_hash: 3,
            },
        }),
        ToHost::Accepted(Accepted {
            transfer: 7,
            hash: 0x0123_4567_89ab_cdef,
            voxels: 1501,
            nodes: 2002,
        }),
        ToHost::Puncture(PunctureEvent {
            site: Site::D,
            stitch: 2,
            tick: 4321,
            force_n: 0.96,
            f0_n: 0.95,
            depth_m: 0.004,
        }),
        ToHost::Granted(Granted {
            tick: 100,
            state_hash: 0x0123_4567_89ab_cdef,
        }),
    ];
    all.extend(Stage::ALL.map(|stage| ToHost::Telemetry(telemetry(stage))));
    all.extend([EndReason::Stopped, EndReason::Replaced].map(|reason| ToHost::Ended(Ended { tick: 9, reason })));
    all.extend(upload_errors().map(|reason| {
        ToHost::UploadRejected(UploadRejected {
            transfer: 7,
            reason,
            offset: 448,
            detail: String::try_from("lattice.pitch_m").unwrap(),
        })
    }));
    all
}

pub(crate) fn upload_errors() -> [UploadError; 8] {
    use UploadError::*;
    [TooLong, Transfer, Order, Hash, Late, Encoding, Value, Build]
}

pub(crate) fn telemetry(stage: Stage) -> Telemetry {
    Telemetry {
        tick: 12_345,
        stage,
        stitch: 3,
        faults: 5,
        position_m: [0.001, -0.002, 0.003],
        simulated_n: [0.5, -0.25, 0.125],
        rendered_n: [1.5, -1.25, 1.125],
        torque_n_m: [0.001, -0.002, 0.003],
        thread_n: 0.75,
        gap_m: [0.004, 0.003, -0.002],
        gap_mean_m: -0.001,
        saturated: true,
    }
}

pub(crate) fn pose(x: f32) -> Pose {
    Pose {
        position_m: [x, 0.25, -0.5],
        quaternion: [0.5, -0.5, 0.5, 0.5],
    }
}

/// A scene in which every optional part is there, valid.
pub(crate) fn full_scene() -> Scene {
    Scene {
        effects: Effect::ALL.into_iter().fold(Effects::default(), Effects::with),
        solver: Solver::BePcg {
            iterations: 20,
            newton: 2,
        },
        lattice: Lattice {
            cells: [20, 15, 6],
            pitch_m: 0.002,
            origin_m: [-0.02, -0.015, -0.012],
            law: Law::Isotropic,
            assembly: Assembly::PerVoxel,
            damping_per_s: 50.0,
            spring_damping_s: 0.001,
        },
        tissues: tissues(),
        tool: Tool::Needle {
            radius_m: 0.0095,
            length_m: 0.03,
            grasp_m: 0.01,
        },
        contact: Contact {
            coupling_n_per_m: 800.0,
            coupling_n_s_per_m: 2.0,
            kernel_m: 0.003,
        },
        stitch: Some(stitch()),
        thread: Some(thread()),
        wound: Some(Wound {
            faces: [9, 11],
            rows: [3, 12],
            floor: 2,
            penalty_n_per_m: 1000.0,
        }),
        output: Output {
            scale: 1.0,
            slew_n: 0.5,
            passivity_n_s_per_m: 10.0,
        },
        device: Device {
            profile: Profile::Premium15,
            patch_from_device: pose(0.5),
        },
        hand: Some(hand()),
    }
}

fn stitch() -> Stitch {
    Stitch {
        count: 3,
        spacing_m: 0.006,
        a_m: [-0.006, 0.001],
        f0_n: [0.95, 0.25, 0.5, 0.9],
        under_m: 0.002,
        friction_n_per_m: 20.0,
        cutting_n: 0.2,
        tension_gain: 2.0,
    }
}

fn thread() -> Thread {
    Thread {
        nodes: 60,
        link_m: 0.005,
        axial_n: 75.0,
        mass_kg_per_m: 1e-4,
        damping_per_s: 30.0,
        penalty_n_per_m: 500.0,
        friction: 0.25,
        knot_hold_n: 18.0,
        bending_n_m2: 2e-7,
    }
}

/// Bone under a skin of three segments.
fn tissues() -> Vec<Tissue, TISSUES_MAX> {
    let tissue = |body| Tissue {
        density_kg_m3: 1100.0,
        body,
    };
    let segment = |from_strain, slope_pa| Segment { from_strain, slope_pa };
    Vec::from_slice(&[
        tissue(Body::Fixed),
        tissue(Body::Soft {
            curve: Vec::from_slice(&[segment(0.0, 281e3), segment(0.3, 1.7e6), segment(0.6, 3.66e6)]).unwrap(),
            sheet: 0.75,
            strength_n: 20.0,
        }),
    ])
    .unwrap()
}

/// A script of every motion and every reason to end one.
fn hand() -> Hand {
    let step = |motion, until| Step {
        motion,
        ticks: 1500,
        until,
        button: matches!(until, Until::Stage(_)),
    };
    let steps = [
        step(Motion::Line { to: pose(0.125) }, Until::Elapsed),
        step(
            Motion::Steady {
                to: pose(0.0625),
                speed_m_per_s: 0.008,
            },
            Until::Punctured(Site::A),
        ),
        step(
            Motion::Turn {
                centre_m: [0.01, 0.02, 0.03],
                axis: [0.0, 1.0, 0.0],
                angle_rad: -1.5,
            },
            Until::Punctured(Site::D),
        ),
        step(Motion::Hold, Until::Tension(1.25)),
        step(Motion::Hold, Until::Stage(Stage::Done)),
    ];
    Hand {
        mass_kg: 0.2,
        damping_n_s_per_m: 5.0,
        stiffness_n_per_m: 400.0,
        tremor: Some(Tremor {
            amplitude_m: 1e-4,
            frequency_hz: 10.0,
            phases_rad: [0.5, 1.0, 1.5],
        }),
        start: pose(0.75),
        steps: Vec::from_slice(&steps).unwrap(),
    }
}

/// Scenes that hold what [`full_scene`] does not.
pub(crate) fn scenes() -> std::vec::Vec<Scene> {
    let full = full_scene();
    let mut all = vec![full.clone()];
    all.extend(
        [Law::Axial, Law::Paper, Law::Volume { poisson: 0.45 }].map(|law| Scene {
            lattice: Lattice {
                law,
                ..full.lattice.clone()
            },
            ..full.clone()
        }),
    );
    all.push(Scene {
        lattice: Lattice {
            assembly: Assembly::EveryEdge,
            ..full.lattice.clone()
        },
        ..full.clone()
    });
    all.extend(
        [
            Solver::Explicit { substeps: 5 },
            Solver::BeChebyshev { iterations: 15 },
            Solver::Vbd { sweeps: 8, omega: 1.5 },
        ]
        .map(|solver| Scene { solver, ..full.clone() }),
    );
    all.extend(
        [Profile::Premium30, Profile::Touch, Profile::Desktop].map(|profile| Scene {
            device: Device { profile, ..full.device },
            ..full.clone()
        }),
    );
    all.push(Scene {
        effects: Effects::default().with(Effect::Gravity),
        tool: Tool::Ball { radius_m: 0.005 },
        stitch: None,
        thread: None,
        wound: None,
        hand: None,
        ..full
    });
    all
}

/// The frame of every sample message.
pub(crate) fn frames() -> std::vec::Vec<std::vec::Vec<u8>> {
    let wire = &mut [0; WIRE_MAX];
    let mut all = std::vec::Vec::new();
    for message in to_controller() {
        all.push(message.encode(SESSION, SEQ, wire).unwrap().to_vec());
    }
    for message in to_host() {
        all.push(message.encode(SESSION, SEQ, wire).unwrap().to_vec());
    }
    all
}
