//! What the server does with frames that are late, doubled, lost, foreign or early.

use super::*;
use crate::math::Vec3;
use std::vec::Vec;
use sutura_shared::limits::WIRE_MAX;
use sutura_shared::message::*;

/// Counts ticks; its telemetry is not finite.
#[derive(Default)]
struct Counter {
    stops: u32,
}

impl Plant for Counter {
    fn load(&mut self, _: &Scene, _: &[u8]) -> Result<Loaded, LoadError> {
        Err(LoadError("nothing"))
    }

    fn tick(&mut self) -> Output {
        Output {
            simulated: Vec3::new(f32::NAN, 1.0, 2.0),
            ..Output::idle()
        }
    }

    fn state_hash(&self) -> u64 {
        0
    }

    fn release(&mut self) {}

    fn stop(&mut self) {
        self.stops += 1;
    }
}

fn hello(version: Version) -> ToController<'static> {
    ToController::Hello(Hello {
        magic: MAGIC,
        version,
        nonce: 9,
    })
}

/// What the server answers to one frame: sessions and messages.
fn say(server: &mut Server<'_, Counter>, message: &ToController<'_>, session: u8, seq: u16) -> Vec<(u8, ToHost)> {
    let mut answers = Vec::new();
    let wire = &mut [0; WIRE_MAX];
    let mut sink = |bytes: &[u8]| {
        let mut decoder = Decoder::new();
        for byte in bytes {
            if let Some(frame) = decoder.push(*byte) {
                let frame = frame.unwrap();
                answers.push((frame.header.session, ToHost::decode(&frame).unwrap()));
            }
        }
    };
    server.receive(message.encode(session, seq, wire).unwrap(), &mut sink);
    answers
}

#[test]
fn another_version_is_rejected_by_name() {
    let staging = &mut [0; 1000];
    let mut server = Server::new(Counter::default(), staging);
    for yours in [
        Version { major: 2, ..VERSION },
        Version {
            schema_hash: 1,
            ..VERSION
        },
    ] {
        let mine = VERSION;
        let rejected = ToHost::Reject(Reject { mine, yours });
        assert_eq!(say(&mut server, &hello(yours), 0, 0), [(0, rejected)]);
    }
    let younger = Version { minor: 9, ..VERSION };
    assert!(matches!(
        say(&mut server, &hello(younger), 0, 0)[..],
        [(1, ToHost::Hello(_))]
    ));
}

/// The sequence numbers of a host that is sent away have nothing to do with those of the host that is served.
#[test]
fn a_rejected_hello_leaves_the_session_as_it_was() {
    let staging = &mut [0; 1000];
    let mut server = Server::new(Counter::default(), staging);
    say(&mut server, &hello(VERSION), 0, 0);
    let foreign = hello(Version { major: 2, ..VERSION });
    assert!(matches!(
        say(&mut server, &foreign, 0, 100)[..],
        [(1, ToHost::Reject(_))]
    ));
    assert!(matches!(
        say(&mut server, &ToController::Stop, 1, 1)[..],
        [(1, ToHost::Ended(_))]
    ));
    assert_eq!((server.received().stale, server.received().missing), (0, 0));
}

#[test]
fn frames_out_of_turn_do_nothing() {
    let staging = &mut [0; 1000];
    let mut server = Server::new(Counter::default(), staging);
    // Before a hello.
    assert_eq!(say(&mut server, &ToController::Stop, 0, 1), []);
    assert_eq!(say(&mut server, &hello(VERSION), 0, u16::MAX - 1).len(), 1);
    // Of another session; doubled; then two missing across the wrap of the counter.
    assert_eq!(say(&mut server, &ToController::Stop, 2, u16::MAX), []);
    assert_eq!(say(&mut server, &ToController::Stop, 1, u16::MAX - 1), []);
    assert_eq!((server.received().stale, server.plant().stops), (3, 0));
    let ended = ToHost::Ended(Ended {
        tick: 0,
        reason: EndReason::Stopped,
    });
    assert_eq!(say(&mut server, &ToController::Stop, 1, 1), [(1, ended)]);
    assert_eq!((server.received().missing, server.plant().stops), (2, 1));
    // A grant without a scene.
    say(&mut server, &ToController::Grant(Grant { until_tick: 5 }), 1, 2);
    assert_eq!((server.received().errors, server.ready()), (1, false));
    assert!(!server.step(&mut |_| {}));
    // A hello gives another session; the old one's frames are foreign now.
    assert_eq!(say(&mut server, &hello(VERSION), 0, 0)[0].0, 2);
    assert_eq!(say(&mut server, &ToController::Stop, 1, 1), []);
}

#[test]
fn an_upload_comes_in_order_and_whole() {
    let staging = &mut [0; 1000];
    let mut server = Server::new(Counter::default(), staging);
    say(&mut server, &hello(VERSION), 0, 0);
    let begin = |transfer, cells_len| {
        ToController::SceneBegin(SceneBegin {
            transfer,
            scene_len: 4,
            cells_len,
            hash: 1,
        })
    };
    let chunk = |transfer, offset| {
        let data = &[1, 2];
        ToController::SceneChunk(SceneChunk { transfer, offset, data })
    };
    let commit = |transfer| {
        let (hash, apply_at_tick) = (1, 0);
        ToController::SceneCommit(SceneCommit {
            transfer,
            hash,
            apply_at_tick,
        })
    };
    let mut seq = 0;
    let mut outcome = |message| {
        seq += 1;
        match &say(&mut server, &message, 1, seq)[..] {
            [] => None,
            [(1, ToHost::UploadRejected(rejected))] => Some((rejected.reason, rejected.offset)),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(outcome(chunk(1, 0)), Some((UploadError::Transfer, 0)));
    assert_eq!(outcome(begin(2, 997)), Some((UploadError::TooLong, 0)));
    assert_eq!(outcome(begin(3, 2)), None);
    assert_eq!(outcome(chunk(3, 0)), None);
    // A gap; the parts after it are not refused again.
    assert_eq!(outcome(chunk(3, 4)), Some((UploadError::Order, 2)));
    assert_eq!(outcome(chunk(3, 2)), None);
    assert_eq!(outcome(begin(4, 2)), None);
    assert_eq!(outcome(chunk(4, 0)), None);
    assert_eq!(outcome(commit(4)), Some((UploadError::Order, 2)));
    assert_eq!(outcome(begin(5, 2)), None);
    assert_eq!(
        (outcome(chunk(5, 0)), outcome(chunk(5, 2)), outcome(chunk(5, 4))),
        (None, None, None)
    );
    assert_eq!(outcome(commit(5)), Some((UploadError::Hash, 6)));
}

/// A frame the host would refuse is never sent: numbers that are none become zero, and a fault.
#[test]
fn telemetry_is_finite() {
    let sent = session::telemetry(&Counter::default().tick());
    assert_eq!(
        sent.simulated_n.map(f32::to_bits),
        [0.0_f32, 1.0, 2.0].map(f32::to_bits)
    );
    assert_eq!(sent.faults, crate::record::Fault::State as u32);
}
