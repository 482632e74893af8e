//! What a decoder must not take.
#![allow(clippy::unwrap_used)] // A test may fail by unwrapping.

mod samples;

use sutura_shared::check::Validate;
use sutura_shared::codec::{self, DecodeError};
use sutura_shared::frame::{self, Decoder, FrameError, Header};
use sutura_shared::limits::{PAYLOAD_MAX, SCENE_MAX, WIRE_MAX};
use sutura_shared::message::*;
use sutura_shared::scene::*;

/// What a receiver of either side makes of a stream: per frame, why it is refused, or that it was taken.
fn receive(stream: &[u8]) -> Vec<Result<(), Refusal>> {
    let mut decoder = Decoder::new();
    let mut all = Vec::new();
    for byte in stream {
        if let Some(frame) = decoder.push(*byte) {
            all.push(frame.map_err(Refusal::Frame).and_then(|frame| {
                match (ToController::decode(&frame), ToHost::decode(&frame)) {
                    (Ok(_), _) | (_, Ok(_)) => Ok(()),
                    (Err(MessageError::Kind(_)), Err(error)) | (Err(error), _) => Err(Refusal::Message(error)),
                }
            }));
        }
    }
    all
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Refusal {
    Frame(FrameError),
    Message(MessageError),
}

#[test]
fn every_sample_comes_back() {
    let mut decoder = Decoder::new();
    let wire = &mut [0; WIRE_MAX];
    for message in samples::to_controller() {
        for byte in message.encode(samples::SESSION, samples::SEQ, wire).unwrap() {
            if let Some(frame) = decoder.push(*byte) {
                let frame = frame.unwrap();
                assert_eq!(
                    (frame.header.session, frame.header.seq),
                    (samples::SESSION, samples::SEQ)
                );
                assert_eq!(ToController::decode(&frame), Ok(message));
            }
        }
    }
    for message in samples::to_host() {
        for byte in message.encode(samples::SESSION, samples::SEQ, wire).unwrap() {
            if let Some(frame) = decoder.push(*byte) {
                assert_eq!(ToHost::decode(&frame.unwrap()).as_ref(), Ok(&message));
            }
        }
    }
    for scene in samples::scenes() {
        let bytes = &mut [0; SCENE_MAX];
        assert_eq!(codec::decode(codec::encode(&scene, bytes).unwrap()), Ok(scene));
    }
}

/// A cut frame, ended by the next one's delimiter, is refused as a frame; nothing of it is decoded.
#[test]
fn every_truncation_is_refused() {
    for frame in samples::frames() {
        for length in 1..frame.len() - 1 {
            let mut stream = frame[..length].to_vec();
            stream.push(0);
            let outcome = receive(&stream);
            assert!(outcome.len() <= 1, "{outcome:?}");
            assert!(
                outcome.iter().all(|it| matches!(it, Err(Refusal::Frame(_)))),
                "{outcome:?}"
            );
        }
    }
}

/// A flipped bit is the line's fault and reported as that, never as a bad message; and the frame after it is found.
#[test]
fn every_bit_flip_is_refused() {
    for frame in samples::frames() {
        for bit in 0..frame.len() * 8 {
            let mut stream = frame.clone();
            stream[bit / 8] ^= 1 << (bit % 8);
            // One delimiter more, for the flip that removes the last one.
            stream.push(0);
            stream.extend_from_slice(&frame);
            let outcome = receive(&stream);
            let (last, before) = outcome.split_last().unwrap();
            assert_eq!(*last, Ok(()), "bit {bit}");
            assert!(
                !before.is_empty() && before.iter().all(|it| matches!(it, Err(Refusal::Frame(_)))),
                "bit {bit}: {before:?}"
            );
        }
    }
}

/// The frame after noise of any length is found: a fixed linear congruential sequence (Knuth's MMIX constants).
#[test]
fn a_frame_is_found_after_noise() {
    let mut state = 1_u64;
    let frame = &samples::frames()[0];
    for length in [1, 2, 3, 100, 241, 242, 243, 1000, 65_536] {
        let mut stream: Vec<u8> = (0..length)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 56) as u8
            })
            .collect();
        stream.extend_from_slice(frame);
        let outcome = receive(&stream);
        let (last, before) = outcome.split_last().unwrap();
        assert_eq!(*last, Ok(()));
        assert!(before.iter().all(Result::is_err));
    }
}

#[test]
fn lengths_are_bounded() {
    assert_eq!(receive(&[0, 1, 1, 0]), [Err(Refusal::Frame(FrameError::TooShort))]);
    // Nine bytes stuff to eight zero bytes: a header of zeros and the CRC of nothing must not pass.
    assert_eq!(
        receive(&[0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0]),
        [Err(Refusal::Frame(FrameError::Crc))]
    );
    let mut long = vec![1; 1000];
    long.push(0);
    assert_eq!(receive(&long), [Err(Refusal::Frame(FrameError::TooLong))]);
    assert_eq!(
        receive(&[0, 200, 1, 2, 3, 4, 5, 6, 7, 8, 0]),
        [Err(Refusal::Frame(FrameError::Stuffing))]
    );
    let wire = &mut [0; WIRE_MAX];
    assert_eq!(
        frame::seal(Header::default(), &[7; PAYLOAD_MAX + 1], wire),
        Err(FrameError::TooLong)
    );
    // The longest payload, in its worst case for the stuffing, is the longest frame.
    assert_eq!(
        frame::seal(Header::default(), &[7; PAYLOAD_MAX], wire).unwrap().len(),
        WIRE_MAX
    );
    assert_eq!(receive(wire), [Err(Refusal::Message(MessageError::Kind(0)))]);
}

/// An intact frame with this payload.
fn refused(kind: u8, payload: &[u8]) -> Refusal {
    let header = Header {
        kind,
        ..Header::default()
    };
    receive(frame::seal(header, payload, &mut [0; WIRE_MAX]).unwrap())[0].unwrap_err()
}

#[test]
fn intact_frames_are_decoded_exactly() {
    let payload = |error| Refusal::Message(MessageError::Payload(error));
    assert_eq!(refused(0x77, &[1, 2, 3]), Refusal::Message(MessageError::Kind(0x77)));
    assert_eq!(refused(0x05, &[]), payload(DecodeError::Malformed));
    assert_eq!(refused(0x05, &[1, 0]), payload(DecodeError::Trailing));
    assert_eq!(refused(0x05, &[0x81, 0x00]), payload(DecodeError::NotCanonical));
    assert_eq!(refused(0x06, &[0]), payload(DecodeError::Trailing));
    // A chunk that says it is longer than it is, and an empty one.
    assert_eq!(refused(0x03, &[1, 0, 9, 1, 2]), payload(DecodeError::Malformed));
    assert!(matches!(
        refused(0x03, &[1, 0, 0]),
        Refusal::Message(MessageError::Payload(DecodeError::Invalid(_)))
    ));
    // Stage 8 of 0 to 7; a truth value of 2.
    let buffer = &mut [0; PAYLOAD_MAX];
    let bytes = codec::encode(&samples::telemetry(Stage::Done), buffer)
        .unwrap()
        .to_vec();
    let with = |index: usize, value| {
        let mut bytes = bytes.clone();
        bytes[index] = value;
        refused(0x85, &bytes)
    };
    assert_eq!(with(2, 8), payload(DecodeError::Malformed));
    assert_eq!(with(bytes.len() - 1, 2), payload(DecodeError::Malformed));
}

#[test]
fn floats_must_be_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let good = samples::telemetry(Stage::Drive);
        let puncture = PunctureEvent {
            site: Site::A,
            stitch: 1,
            tick: 1,
            force_n: bad,
            f0_n: 1.0,
            depth_m: 0.0,
        };
        for message in [
            ToHost::Telemetry(Telemetry {
                gap_m: [0.0, bad, 0.0],
                ..good
            }),
            ToHost::Telemetry(Telemetry { thread_n: bad, ..good }),
            ToHost::Telemetry(Telemetry {
                gap_mean_m: bad,
                ..good
            }),
            ToHost::Telemetry(Telemetry {
                position_m: [0.0, bad, 0.0],
                ..good
            }),
            ToHost::Telemetry(Telemetry {
                simulated_n: [0.0, 0.0, bad],
                ..good
            }),
            ToHost::Telemetry(Telemetry {
                rendered_n: [bad, 0.0, 0.0],
                ..good
            }),
            ToHost::Puncture(puncture),
        ] {
            let outcome = receive(message.encode(1, 1, &mut [0; WIRE_MAX]).unwrap());
            let invalid = matches!(
                outcome[0],
                Err(Refusal::Message(MessageError::Payload(DecodeError::Invalid(_))))
            );
            assert!(invalid, "{message:?}: {outcome:?}");
        }
    }
}

/// Every four bytes of a scene made a NaN, wherever they fall: never taken as they are.
#[test]
fn no_nan_gets_into_a_scene() {
    let buffer = &mut [0; SCENE_MAX];
    let bytes = codec::encode(&samples::full_scene(), buffer).unwrap().to_vec();
    for start in 0..bytes.len() - 3 {
        let mut bad = bytes.clone();
        bad[start..start + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        if let Ok(scene) = codec::decode::<Scene>(&bad) {
            assert!(!format!("{scene:?}").contains("NaN"), "at byte {start}");
        }
    }
}

fn field(change: impl FnOnce(&mut Scene)) -> &'static str {
    let mut scene = samples::full_scene();
    assert_eq!(scene.validate(), Ok(()));
    change(&mut scene);
    scene.validate().unwrap_err().field
}

fn curve(scene: &mut Scene) -> &mut heapless::Vec<Segment, SEGMENTS_MAX> {
    let Body::Soft { curve, .. } = &mut scene.tissues[1].body else {
        unreachable!()
    };
    curve
}

#[test]
fn scenes_name_the_value_that_is_wrong() {
    assert_eq!(field(|it| it.effects.0 |= 1 << 15), "effects");
    assert_eq!(field(|it| it.thread = None), "thread");
    assert_eq!(field(|it| it.wound = None), "effects");
    assert_eq!(field(|it| it.stitch = None), "stitch");
    assert_eq!(field(|it| it.effects.0 &= !(Effect::Thread as u32)), "thread");
    assert_eq!(field(|it| it.tool = Tool::Ball { radius_m: 0.005 }), "effects");
    assert_eq!(
        field(|it| it.solver = Solver::BePcg {
            iterations: 0,
            newton: 1
        }),
        "solver.iterations"
    );
    assert_eq!(
        field(|it| it.solver = Solver::Vbd { sweeps: 8, omega: 2.0 }),
        "solver.omega"
    );
    assert_eq!(
        field(|it| it.lattice.law = Law::Volume { poisson: 0.5 }),
        "lattice.law.poisson"
    );
    assert_eq!(field(|it| it.lattice.cells = [0, 1, 1]), "lattice.cells");
    assert_eq!(field(|it| it.lattice.cells = [u16::MAX; 3]), "lattice.cells");
    assert_eq!(field(|it| it.lattice.pitch_m = 0.0), "lattice.pitch_m");
    assert_eq!(
        field(|it| it.tool = Tool::Needle {
            radius_m: 0.01,
            length_m: 0.03,
            grasp_m: 0.031
        }),
        "tool.grasp_m"
    );
    assert_eq!(
        field(|it| it.stitch.as_mut().unwrap().tension_gain = -1.0),
        "stitch.tension_gain"
    );
    assert_eq!(field(|it| it.contact.kernel_m = 0.0029), "contact.kernel_m");
    assert_eq!(field(|it| curve(it)[0].from_strain = 0.1), "tissue.curve");
    assert_eq!(field(|it| curve(it).clear()), "tissue.curve");
    assert_eq!(field(|it| curve(it)[2].slope_pa = 1.0e6), "tissue.curve.slope_pa");
    assert_eq!(field(|it| curve(it)[2].from_strain = 0.3), "tissue.curve.from_strain");
    assert_eq!(field(|it| it.wound.as_mut().unwrap().faces = [9, 21]), "wound.faces");
    assert_eq!(field(|it| it.wound.as_mut().unwrap().faces = [9, 9]), "wound.faces");
    assert_eq!(field(|it| it.wound.as_mut().unwrap().rows = [3, 16]), "wound.rows");
    assert_eq!(field(|it| it.wound.as_mut().unwrap().floor = 7), "wound.floor");
    assert_eq!(
        field(|it| it.device.patch_from_device.quaternion[0] = 0.6),
        "device.patch_from_device"
    );
    assert_eq!(
        field(|it| it.hand.as_mut().unwrap().steps[0].ticks = 0),
        "hand.steps.ticks"
    );
}

#[test]
fn a_tremor_that_no_hand_has_names_its_field() {
    let tremor = |change: fn(&mut Tremor)| {
        let mut scene = samples::full_scene();
        change(scene.hand.as_mut().unwrap().tremor.as_mut().unwrap());
        scene.validate().unwrap_err().field
    };
    assert_eq!(tremor(|it| it.amplitude_m = -1e-4), "hand.tremor.amplitude_m");
    assert_eq!(tremor(|it| it.amplitude_m = 0.02), "hand.tremor.amplitude_m");
    assert_eq!(tremor(|it| it.amplitude_m = f32::NAN), "hand.tremor.amplitude_m");
    assert_eq!(tremor(|it| it.frequency_hz = f32::INFINITY), "hand.tremor.frequency_hz");
    assert_eq!(tremor(|it| it.frequency_hz = 101.0), "hand.tremor.frequency_hz");
    assert_eq!(tremor(|it| it.phases_rad[2] = f32::NAN), "hand.tremor.phases_rad");
}

#[test]
fn cells_belong_to_the_lattice() {
    let scene = samples::full_scene();
    let mut cells = vec![2; 20 * 15 * 6];
    assert_eq!(scene.validate_cells(&cells), Ok(()));
    assert!(scene.validate_cells(&cells[1..]).is_err());
    cells[7] = 3;
    assert!(scene.validate_cells(&cells).is_err());
}
