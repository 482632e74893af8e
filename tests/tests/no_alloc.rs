//! Neither the controller nor the wire allocates, shown by an allocator that counts. A test binary of its own, since an allocator serves a whole program.

/// The system's allocator with a count beside it.
#[allow(unsafe_code)]
mod counting {
    use std::alloc::{GlobalAlloc, Layout, System};
    use std::cell::Cell;

    thread_local! {
        /// Calls to the allocator on this thread since the count was last reset; the test runner's other threads have their own.
        static CALLS: Cell<u64> = const { Cell::new(0) };
    }

    struct Counting;

    #[global_allocator]
    static ALLOCATOR: Counting = Counting;

    fn count() {
        // A thread that ends frees memory after its counter is gone; nobody reads that count.
        CALLS.try_with(|calls| calls.set(calls.get() + 1)).ok();
    }

    // SAFETY: every call goes to the system's allocator as it came.
    unsafe impl GlobalAlloc for Counting {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            count();
            unsafe { System.alloc(layout) }
        }

        unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
            count();
            unsafe { System.alloc_zeroed(layout) }
        }

        unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
            count();
            unsafe { System.realloc(block, layout, size) }
        }

        unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
            count();
            unsafe { System.dealloc(block, layout) }
        }
    }

    /// How often `work` calls the allocator, to free memory too.
    pub(crate) fn calls_during(work: impl FnOnce()) -> u64 {
        CALLS.set(0);
        work();
        CALLS.get()
    }
}

use counting::calls_during;
use std::cell::RefCell;
use std::hint::black_box;
use std::time::Duration;
use sutura::link::{Link, Transport};
use sutura::run::embedded::PcRig;
use sutura_controller::lanes::Level;
use sutura_controller::link::Server;
use sutura_shared::frame::Decoder;
use sutura_shared::limits::{STAGING_MAX, WIRE_MAX};
use sutura_shared::message::{Grant, Telemetry, ToController, ToHost};
use sutura_shared::scene::{Effect, Effects, Stage};
use sutura_tests::scenario;

/// Twelve seconds of the simulated hand: the whole stitch.
const TICKS: u32 = 12_000;

#[test]
fn the_counter_counts() {
    assert_eq!(calls_during(|| drop(black_box(Box::new(1)))), 2);
    assert_eq!(calls_during(|| drop(black_box(vec![0_u8; 8]))), 2);
    let mut grows = Vec::with_capacity(1);
    assert_eq!(calls_during(|| grows.extend_from_slice(black_box(&[1, 2, 3]))), 1);
    assert_eq!(calls_during(|| _ = black_box([1_u8; 64])), 0);
}

#[test]
fn messages_cross_the_wire_without_allocating() {
    let sent = ToHost::Telemetry(Telemetry {
        tick: 1,
        stage: Stage::Drive,
        stitch: 1,
        faults: 0,
        position_m: [0.1, 0.2, 0.3],
        simulated_n: [0.4, 0.5, 0.6],
        rendered_n: [0.7, 0.8, 0.9],
        torque_n_m: [0.0; 3],
        thread_n: 1.0,
        gap_m: [1.1; 3],
        gap_mean_m: 1.2,
        saturated: true,
    });
    let mut wire = [0; WIRE_MAX];
    let mut decoder = Decoder::new();
    let mut arrived = 0;
    let calls = calls_during(|| {
        for _ in 0..TICKS {
            let bytes = black_box(&sent).encode(1, 2, &mut wire).unwrap_or_default();
            for byte in bytes {
                if let Some(Ok(frame)) = decoder.push(*byte) {
                    arrived += u32::from(ToHost::decode(&frame).as_ref() == Ok(&sent));
                }
            }
        }
    });
    assert_eq!((arrived, calls), (TICKS, 0));
}

/// The host's end of a line to a controller in the same thread.
struct Direct<'s, 'm> {
    server: &'s RefCell<Server<'m, PcRig<'m>>>,
    answers: Vec<u8>,
}

impl Transport for Direct<'_, '_> {
    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        let answers = &mut self.answers;
        self.server
            .borrow_mut()
            .receive(bytes, &mut |frame| answers.extend_from_slice(frame));
        Ok(())
    }

    fn receive(&mut self, _: Duration, into: &mut Vec<u8>) -> std::io::Result<()> {
        into.append(&mut self.answers);
        Ok(())
    }
}

/// The first session, and a place in its sequence after the upload.
const SESSION: u8 = 1;
const AFTER_UPLOAD: u16 = 1000;
/// Ticks of one grant.
const GRANT: u32 = 100;

/// What a host saw of a stitch, without keeping it.
#[derive(Debug, Default, PartialEq)]
struct Seen {
    ticks: u32,
    punctures: u32,
    grants: u32,
    faults: u32,
    done: bool,
}

impl Seen {
    fn note(&mut self, message: &ToHost) {
        match message {
            ToHost::Telemetry(tick) => {
                self.ticks += 1;
                self.faults |= tick.faults;
                self.done = tick.stage == Stage::Done;
            }
            ToHost::Puncture(_) => self.punctures += 1,
            ToHost::Granted(_) => self.grants += 1,
            _ => {}
        }
    }
}

/// Grants, ticks and telemetry of the whole built-in stitch, every effect on: those that it does not call for, too.
#[test]
fn a_stitch_is_sewn_without_allocating() {
    let mut built = scenario::built(None).unwrap();
    let all = Effect::ALL.into_iter();
    built.scene.effects = all.fold(built.scene.effects, Effects::with);
    let mut memory = scenario::memory();
    let mut staging = vec![0; STAGING_MAX];
    let server = RefCell::new(Server::new(PcRig::new(&mut memory, Level::best()), &mut staging));
    let line = Direct {
        server: &server,
        answers: Vec::new(),
    };
    Link::connect(line).unwrap().upload(&built.scene, &built.cells).unwrap();
    let mut server = server.borrow_mut();
    let (mut decoder, mut wire, mut seen) = (Decoder::new(), [0; WIRE_MAX], Seen::default());
    let calls = calls_during(|| {
        let mut hear = |bytes: &[u8]| {
            for byte in bytes {
                if let Some(Ok(frame)) = decoder.push(*byte) {
                    ToHost::decode(&frame).iter().for_each(|message| seen.note(message));
                }
            }
        };
        for grant in 1..=TICKS / GRANT {
            let message = ToController::Grant(Grant {
                until_tick: grant * GRANT,
            });
            let bytes = message
                .encode(SESSION, AFTER_UPLOAD + grant as u16, &mut wire)
                .unwrap_or_default();
            server.receive(bytes, &mut hear);
            while server.ready() {
                server.step(&mut hear);
            }
        }
    });
    let expected = Seen {
        ticks: TICKS,
        punctures: 4,
        grants: TICKS / GRANT,
        faults: 0,
        done: true,
    };
    assert_eq!((seen, calls), (expected, 0));
}
