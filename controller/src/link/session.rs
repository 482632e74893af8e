//! One host, one session: what each message does.

use super::staging::{Refusal, Staging};
use super::{LoadError, Plant, Received};
use crate::record::{Fault, Output};
use sutura_shared::frame::Frame;
use sutura_shared::limits::WIRE_MAX;
use sutura_shared::message::{
    Accepted, EndReason, Ended, Grant, Granted, Hello, MAGIC, MessageError, PunctureEvent, Reject, SceneCommit,
    Telemetry, ToController, ToHost, UploadError, UploadRejected, VERSION,
};

/// Where frames go.
type Sink<'s> = dyn FnMut(&[u8]) + 's;

pub(super) struct Session<'m, P> {
    plant: P,
    staging: Staging<'m>,
    received: Received,
    /// Number of the session, 0 before the first.
    number: u8,
    /// Sequence number of the next frame to the host.
    next: u16,
    /// Sequence number of the last frame from the host.
    last: u16,
    /// Upload that was refused, so that its other parts are not refused one by one.
    refused: Option<u8>,
    run: Option<Run>,
}

/// A scene that is loaded.
#[derive(Clone, Copy)]
struct Run {
    /// The last tick that was run.
    tick: u32,
    /// The last that may be run.
    until: u32,
    /// Whether the host knows that the grant is used up.
    said: bool,
}

impl<'m, P: Plant> Session<'m, P> {
    pub(super) const fn new(plant: P, staging: &'m mut [u8]) -> Self {
        Self {
            plant,
            staging: Staging::new(staging),
            received: Received {
                frames: 0,
                errors: 0,
                stale: 0,
                missing: 0,
            },
            number: 0,
            next: 0,
            last: 0,
            refused: None,
            run: None,
        }
    }

    pub(super) const fn plant(&self) -> &P {
        &self.plant
    }

    pub(super) const fn received(&self) -> Received {
        self.received
    }

    pub(super) const fn broken_frame(&mut self) {
        self.received.errors = self.received.errors.wrapping_add(1);
    }

    pub(super) const fn ready(&self) -> bool {
        match self.run {
            Some(run) => run.tick < run.until || !run.said,
            None => false,
        }
    }

    /// What an intact frame does.
    pub(super) fn take(&mut self, frame: &Frame<'_>, sink: &mut Sink<'_>) {
        self.received.frames = self.received.frames.wrapping_add(1);
        let message = match ToController::decode(frame) {
            Ok(message) => message,
            // A younger host may know more.
            Err(MessageError::Kind(_)) => return,
            Err(MessageError::Payload(_)) => return self.broken_frame(),
        };
        if let ToController::Hello(hello) = message {
            return self.hello(&hello, frame.header.seq, sink);
        }
        if !self.in_sequence(frame.header.session, frame.header.seq) {
            self.received.stale = self.received.stale.wrapping_add(1);
            return;
        }
        match message {
            ToController::Hello(_) => {}
            ToController::SceneBegin(begin) => {
                self.refused = None;
                let done = self.staging.begin(begin);
                self.answer(begin.transfer, done, sink);
            }
            ToController::SceneChunk(chunk) => {
                let done = self.staging.chunk(&chunk);
                self.answer(chunk.transfer, done, sink);
            }
            ToController::SceneCommit(commit) => self.commit(&commit, sink),
            ToController::Grant(grant) => self.grant(grant),
            ToController::Stop => self.end(EndReason::Stopped, sink),
        }
    }

    /// Runs a tick; or, where none is left, releases the device and says so.
    pub(super) fn step(&mut self, sink: &mut Sink<'_>) -> bool {
        let Some(mut run) = self.run.filter(|_| self.ready()) else {
            return false;
        };
        if run.tick >= run.until {
            self.run = Some(Run { said: true, ..run });
            self.plant.release();
            let state_hash = self.plant.state_hash();
            let tick = run.tick;
            self.send(&ToHost::Granted(Granted { tick, state_hash }), sink);
            return false;
        }
        let output = self.plant.tick();
        run.tick += 1;
        self.run = Some(run);
        self.send(&ToHost::Telemetry(telemetry(&output)), sink);
        if let Some(event) = puncture(&output) {
            self.send(&ToHost::Puncture(event), sink);
        }
        self.apply(sink);
        true
    }

    /// A hello, and its sequence number. One that is rejected leaves the session of another host as it was.
    fn hello(&mut self, hello: &Hello, seq: u16, sink: &mut Sink<'_>) {
        if !VERSION.speaks(hello.version) {
            let (mine, yours) = (VERSION, hello.version);
            return self.send(&ToHost::Reject(Reject { mine, yours }), sink);
        }
        if self.run.is_some() {
            self.end(EndReason::Replaced, sink);
        }
        self.staging.clear();
        self.refused = None;
        // From 1 to 255 and round again, so that a frame of the session before is known as such.
        self.number = self.number % u8::MAX + 1;
        self.next = 0;
        self.last = seq;
        let answer = Hello {
            magic: MAGIC,
            version: VERSION,
            nonce: hello.nonce,
        };
        self.send(&ToHost::Hello(answer), sink);
    }

    /// Whether the frame is of this session and newer than the last; counts what is missing between.
    const fn in_sequence(&mut self, session: u8, seq: u16) -> bool {
        let ahead = seq.wrapping_sub(self.last);
        if self.number == 0 || session != self.number || ahead == 0 || ahead > u16::MAX / 2 {
            return false;
        }
        self.last = seq;
        self.received.missing = self.received.missing.wrapping_add(ahead as u32 - 1);
        true
    }

    fn commit(&mut self, commit: &SceneCommit, sink: &mut Sink<'_>) {
        let tick = self.run.map_or(0, |run| run.tick);
        let done = match self.run {
            None if commit.apply_at_tick != 0 => Err((UploadError::Late, "apply_at_tick 0 where nothing runs")),
            _ => self.staging.commit(commit, tick),
        };
        self.answer(commit.transfer, done, sink);
        self.apply(sink);
    }

    /// Takes the upload that waits for this tick, if one does.
    fn apply(&mut self, sink: &mut Sink<'_>) {
        let Some(begin) = self.staging.due(self.run.map_or(0, |run| run.tick)) else {
            return;
        };
        let plant = &mut self.plant;
        let loaded = self.staging.scene(&begin).and_then(|(scene, cells)| {
            // From here on there is no way back to the scene before.
            self.run = None;
            plant.stop();
            plant
                .load(&scene, cells)
                .map_err(|LoadError(detail)| (UploadError::Build, detail))
        });
        let (transfer, hash) = (begin.transfer, begin.hash);
        match loaded {
            Err(refusal) => self.answer(transfer, Err(refusal), sink),
            Ok(loaded) => {
                self.staging.clear();
                self.run = Some(Run {
                    tick: 0,
                    until: 0,
                    said: true,
                });
                let (voxels, nodes) = (loaded.voxels, loaded.nodes);
                let accepted = Accepted {
                    transfer,
                    hash,
                    voxels,
                    nodes,
                };
                self.send(&ToHost::Accepted(accepted), sink);
            }
        }
    }

    /// A grant only grows; one that grants nothing new is answered again.
    const fn grant(&mut self, grant: Grant) {
        match &mut self.run {
            None => self.broken_frame(),
            Some(run) => {
                if grant.until_tick > run.until {
                    run.until = grant.until_tick;
                }
                run.said = false;
            }
        }
    }

    fn end(&mut self, reason: EndReason, sink: &mut Sink<'_>) {
        self.plant.stop();
        let tick = self.run.take().map_or(0, |run| run.tick);
        self.send(&ToHost::Ended(Ended { tick, reason }), sink);
    }

    /// Refuses an upload, once.
    fn answer(&mut self, transfer: u8, done: Result<(), Refusal>, sink: &mut Sink<'_>) {
        let Err((reason, detail)) = done else {
            return;
        };
        let offset = self.staging.offset();
        self.staging.clear();
        if self.refused.replace(transfer) != Some(transfer) {
            let detail = detail.try_into().unwrap_or_default();
            let rejected = UploadRejected {
                transfer,
                reason,
                offset,
                detail,
            };
            self.send(&ToHost::UploadRejected(rejected), sink);
        }
    }

    fn send(&mut self, message: &ToHost, sink: &mut Sink<'_>) {
        if let Ok(frame) = message.encode(self.number, self.next, &mut [0; WIRE_MAX]) {
            self.next = self.next.wrapping_add(1);
            sink(frame);
        }
    }
}

/// The tick's answer as the host gets it. What is not finite becomes zero and a fault: the host would refuse the frame and miss the tick.
pub(super) fn telemetry(output: &Output) -> Telemetry {
    let mut faults = output.faults;
    let mut finite = |x: f32| {
        faults = faults.with(Fault::State, !x.is_finite());
        if x.is_finite() { x } else { 0.0 }
    };
    Telemetry {
        tick: output.tick,
        stage: output.stage,
        stitch: output.stitch,
        position_m: <[f32; 3]>::from(output.position).map(&mut finite),
        simulated_n: <[f32; 3]>::from(output.simulated).map(&mut finite),
        rendered_n: <[f32; 3]>::from(output.rendered.get()).map(&mut finite),
        torque_n_m: <[f32; 3]>::from(output.torque).map(&mut finite),
        thread_n: finite(output.thread),
        gap_m: output.gap.map(&mut finite),
        gap_mean_m: finite(output.gap_mean),
        saturated: output.saturated,
        faults: faults.0,
    }
}

fn puncture(output: &Output) -> Option<PunctureEvent> {
    output.puncture.map(|puncture| PunctureEvent {
        site: puncture.site,
        stitch: output.stitch,
        tick: output.tick,
        force_n: puncture.force,
        f0_n: puncture.f0,
        depth_m: puncture.depth,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::Loaded;
    use sutura_shared::scene::Scene;

    /// Pushes while ticks run.
    #[derive(Default)]
    struct Motor {
        on: bool,
    }

    impl Plant for Motor {
        fn load(&mut self, _: &Scene, _: &[u8]) -> Result<Loaded, LoadError> {
            Ok(Loaded { voxels: 0, nodes: 0 })
        }

        fn tick(&mut self) -> Output {
            self.on = true;
            Output::idle()
        }

        fn state_hash(&self) -> u64 {
            0
        }

        fn release(&mut self) {
            self.on = false;
        }

        fn stop(&mut self) {
            self.on = false;
        }
    }

    /// A host that falls silent leaves no force behind: the device is released as soon as the grant is used up.
    #[test]
    fn without_a_grant_the_device_is_released() {
        let mut session = Session::new(Motor::default(), &mut []);
        session.run = Some(Run {
            tick: 0,
            until: 0,
            said: true,
        });
        for until_tick in [2, 3] {
            session.grant(Grant { until_tick });
            while session.run.is_some_and(|run| run.tick < run.until) {
                assert!(session.step(&mut |_| {}));
                assert!(session.plant.on);
            }
            assert!(session.ready());
            assert!(!session.step(&mut |_| {}));
            assert!(!session.plant.on && !session.ready());
        }
    }
}
