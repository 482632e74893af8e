//! The studies as the program runs them: what needs the program itself.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::sync::atomic::AtomicBool;

use sutura::study::accuracy::case::{Dial, Matrix};
use sutura::study::accuracy::{self, Error, Request};
use sutura::study::path::Path;
use sutura::study::{callgrind, poke};
use sutura_controller::lanes::Level;

fn request(out: &std::path::Path) -> Request {
    Request {
        matrix: Matrix {
            lattices: vec![[4, 4, 3]],
            young_pa: vec![1e5],
            paths: vec![Path::Tap],
            dials: [1, 2].map(|times| Dial::Explicit { times }).into(),
            counted: 48,
        },
        statics: None,
        level: Level::best(),
        limit_source: out.join("no-kernel.c"),
        program: Some(env!("CARGO_BIN_EXE_sutura").into()),
        out: out.to_owned(),
    }
}

/// Substeps are all that an explicit tick consists of: twice as many take twice the instructions, less what a tick does once.
#[test]
fn instructions_of_a_tick_grow_with_its_substeps() {
    if let Err(missing) = callgrind::present() {
        eprintln!("skipped: instructions of a tick: {missing}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let report = accuracy::run(&request(folder.path()), &AtomicBool::new(false), &|_| {}).unwrap();
    let counts: Vec<_> = report.rows.iter().map(|row| row.instructions.unwrap() as f64).collect();
    for pair in counts.chunks(2) {
        let ratio = pair[1] / pair[0];
        assert!((1.6..=2.0).contains(&ratio), "{ratio}");
    }
}

#[test]
fn an_interrupted_study_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let error = accuracy::run(&request(&out), &AtomicBool::new(true), &|_| {}).unwrap_err();
    assert!(matches!(error, Error::Poke(poke::Error::Interrupted)) && error.exit_code() == 130);
    assert!(!out.exists());
}
