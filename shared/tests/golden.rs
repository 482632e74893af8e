//! The golden file holds every message and every variant of a scene, by field name and by byte; the schema hash is the file's.
//!
//! A type that changes breaks this test. Then, knowingly: `SUTURA_BLESS=1 cargo test -p sutura-shared --test golden`, and both sides of a wire
//! built apart from each other refuse each other by name.
#![allow(clippy::unwrap_used)] // A test may fail by unwrapping.

mod samples;

use core::fmt::Write;
use sutura_shared::codec;
use sutura_shared::hash::Fnv1a;
use sutura_shared::limits::{SCENE_MAX, WIRE_MAX};
use sutura_shared::message::{Grant, ToController, VERSION};
use sutura_shared::scene::{Body, SEGMENTS_MAX, STEPS_MAX, Step, TISSUES_MAX, Tissue, Until};

fn line(text: &mut String, name: &dyn core::fmt::Debug, bytes: &[u8]) {
    write!(text, "{name:?}\n ").unwrap();
    for byte in bytes {
        write!(text, " {byte:02x}").unwrap();
    }
    text.push('\n');
}

fn golden() -> String {
    let mut text = String::new();
    let wire = &mut [0; WIRE_MAX];
    for message in samples::to_controller() {
        line(
            &mut text,
            &message,
            message.encode(samples::SESSION, samples::SEQ, wire).unwrap(),
        );
    }
    for message in samples::to_host() {
        line(
            &mut text,
            &message,
            message.encode(samples::SESSION, samples::SEQ, wire).unwrap(),
        );
    }
    for scene in samples::scenes() {
        line(&mut text, &scene, codec::encode(&scene, &mut [0; SCENE_MAX]).unwrap());
    }
    text
}

#[test]
fn golden_file_is_what_this_build_sends() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/golden.txt");
    if std::env::var_os("SUTURA_BLESS").is_some() {
        std::fs::write(path, golden()).unwrap();
    }
    let file = std::fs::read_to_string(path).unwrap();
    for (kept, now) in file.lines().zip(golden().lines()) {
        assert_eq!(kept, now, "the wire changed: see the head of this test");
    }
    assert_eq!(file, golden());
}

#[test]
fn schema_hash_is_the_golden_files() {
    assert_eq!(
        VERSION.schema_hash,
        Fnv1a::new().bytes(include_bytes!("../src/golden.txt")).get()
    );
}

/// Frames put together by hand from the description: `Stop` and a grant of 300 (varint AC 02), with the CRC-32C of body bytes
/// by the bitwise definition (reflected polynomial 0x82F63B78, start and end with all ones; iSCSI, RFC 3720 B.4).
#[test]
fn frames_follow_their_description() {
    for (kind, payload) in [(6_u8, &[][..]), (5, &[0xac, 0x02])] {
        let mut body = vec![kind, 3, 2, 1];
        body.extend_from_slice(payload);
        let crc = body.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0x82f6_3b78 * (crc & 1)))
        });
        body.extend_from_slice(&(!crc).to_le_bytes());
        assert!(
            body.iter().all(|byte| *byte != 0),
            "the stuffing below is for bodies without zeros"
        );
        let mut expected = vec![0, body.len() as u8 + 1];
        expected.extend_from_slice(&body);
        expected.push(0);
        let message = match kind {
            6 => ToController::Stop,
            _ => ToController::Grant(Grant { until_tick: 300 }),
        };
        assert_eq!(message.encode(3, 0x0102, &mut [0; WIRE_MAX]).unwrap(), expected);
    }
}

#[test]
fn largest_scene_fits() {
    let mut scene = samples::full_scene();
    let Body::Soft { curve, .. } = &scene.tissues[1].body else {
        unreachable!()
    };
    let segment = curve[0];
    let soft = Tissue {
        body: Body::Soft {
            curve: core::iter::repeat_n(segment, SEGMENTS_MAX).collect(),
            sheet: 1.0,
            strength_n: 20.0,
        },
        ..scene.tissues[0]
    };
    scene.tissues = core::iter::repeat_n(soft, TISSUES_MAX).collect();
    let hand = scene.hand.as_mut().unwrap();
    let step = Step {
        ticks: u32::MAX,
        until: Until::Tension(1.0),
        ..hand.steps[0]
    };
    hand.steps = core::iter::repeat_n(step, STEPS_MAX).collect();
    assert!(codec::encode(&scene, &mut [0; SCENE_MAX]).is_some());
}
