use super::judge::{BOUNDLESS, LEFT, RISE, SECOND, judge};
use super::watch::{Felt, Moment, Trace};
use super::*;

const QUIET: Moment = Moment {
    energy_j: 0.0,
    rendered_n: 0.0,
    change_n: 0.0,
    may_change_n: 0.5,
    finite: true,
};

/// A run of 500 ticks of input and two seconds in which an energy of 1 J dies out as e^(−t/20 ms).
fn dying() -> Trace {
    let free = (0..2 * SECOND).map(|tick| Moment {
        energy_j: (-0.05 * tick as f64).exp(),
        ..QUIET
    });
    Trace {
        moments: std::iter::repeat_n(QUIET, 500).chain(free).collect(),
        input: 500,
        largest_n: 8.5,
        displacement_m: 1e-6,
        inverted: 0,
        peak_j: 0.0,
        felt: None,
    }
}

/// Changes a run; the verdict's words and its ratio.
fn judged(spoil: impl FnOnce(&mut Trace)) -> (String, f64) {
    let mut trace = dying();
    spoil(&mut trace);
    let verdict = judge(&trace, None);
    assert_eq!(verdict.passed, verdict.worst <= 1.0, "{verdict:?}");
    (verdict.why, verdict.worst)
}

#[test]
fn energy_that_dies_out_passes() {
    let (why, worst) = judged(|_| {});
    assert!(worst <= 1.0 && why.contains("from rest"), "{why}");
    assert!((worst - 0.02).abs() < 1e-9, "1 µm of 50: {worst}");
}

#[test]
fn the_judge_finds_energy_that_grows_or_stays() {
    let (why, worst) = judged(|trace| trace.moments[700].energy_j += 2.0 * RISE);
    assert!(why.contains("energy rises") && why.contains("200 ticks"), "{why}");
    // What it had lost in that tick counts too.
    assert!((1.9..=2.0).contains(&worst), "{worst}");
    let (why, worst) = judged(|trace| trace.moments[1700].energy_j = 3.0 * LEFT);
    assert!(worst > 1.0 && why.contains("energy"), "{why}");
    let (why, _) = judged(|trace| {
        trace
            .moments
            .iter_mut()
            .skip(500)
            .for_each(|moment| moment.energy_j = 1.0)
    });
    assert!(why.contains("left after a second"), "{why}");
    let grown = |trace: &mut Trace| {
        let growing = trace.moments.iter_mut().skip(500).enumerate();
        growing.for_each(|(tick, moment)| moment.energy_j = 1e-6 * (1e-2 * tick as f64).exp());
    };
    assert!(judged(grown).1 > 1.0);
}

#[test]
fn the_judge_finds_inverted_voxels_and_nodes_out_of_place() {
    let (why, worst) = judged(|trace| trace.inverted = 1);
    assert!(worst >= BOUNDLESS && why.contains("1 voxels end inverted"), "{why}");
    let (why, worst) = judged(|trace| trace.displacement_m = 1e-4);
    assert!((worst - 2.0).abs() < 1e-9 && why.contains("from rest"), "{why} {worst}");
    let (_, worst) = judged(|trace| trace.displacement_m = f64::NAN);
    assert!(worst >= BOUNDLESS);
}

#[test]
fn the_judge_finds_a_force_beyond_the_edge() {
    let (why, worst) = judged(|trace| trace.moments[100].change_n = 0.6);
    assert!((worst - 1.2).abs() < 1e-9 && why.contains("changes by 0.6"), "{why}");
    let (why, _) = judged(|trace| trace.moments[900].rendered_n = 9.0);
    assert!(why.contains("force of 9.000 N at tick 900"), "{why}");
    // What the edge keeps to by construction is not what comes nearest to failing.
    let (why, worst) = judged(|trace| trace.moments[100].change_n = 0.5);
    assert!(worst < 1.0 && why.contains("from rest"), "{why}");
}

#[test]
fn the_judge_finds_what_a_hand_must_not_feel() {
    let felt = |least_j, buzz_n| judged(|trace| trace.felt = Some(Felt { least_j, buzz_n }));
    let (why, worst) = felt(-2e-3, 0.01);
    assert!(why.contains("given 2.00e-3 J") && (worst - 2.0).abs() < 1e-9, "{why}");
    let (why, worst) = felt(1e-3, 0.1);
    assert!(why.contains("above 20 Hz") && (worst - 2.0).abs() < 1e-9, "{why}");
    assert!(felt(-0.5e-3, 0.02).1 <= 1.0);
}

/// What is left of a loaded run is small against its load, not against the little that the tool left behind.
#[test]
fn a_peak_from_before_counts() {
    let trickle = |peak_j| {
        let spoil = |trace: &mut Trace| {
            trace.peak_j = peak_j;
            let free = trace.moments.iter_mut().skip(500).enumerate();
            free.for_each(|(tick, moment)| moment.energy_j = 1e-9 * (tick % 2) as f64);
        };
        judged(spoil).1
    };
    assert!(trickle(0.0) > 1.0 && trickle(1e-3) <= 1.0);
}

#[test]
fn the_judge_finds_what_is_not_finite() {
    for spoil in [
        |moment: &mut Moment| moment.finite = false,
        |moment: &mut Moment| moment.energy_j = f64::NAN,
    ] {
        let (why, worst) = judged(|trace| spoil(&mut trace.moments[800]));
        assert!(worst >= BOUNDLESS, "{why}");
    }
}

/// Another equilibrium holds energy: what counts is what is above it, and how far its nodes are from where it is listed.
#[test]
fn a_listed_equilibrium_is_held_to() {
    let equilibrium = Equilibrium {
        displacement_m: 2e-3,
        reason: "a test",
    };
    let mut trace = dying();
    trace.moments.iter_mut().for_each(|moment| moment.energy_j += 5.0);
    for (displacement_m, passes) in [(2.04e-3, true), (2.06e-3, false), (0.0, false)] {
        trace.displacement_m = displacement_m;
        assert_eq!(judge(&trace, Some(&equilibrium)).passed, passes, "{displacement_m}");
    }
    assert!(!judge(&trace, None).passed);
}

/// The minute of tremor is in the full check.
#[test]
fn the_default_solver_and_law_pass_every_case() {
    let interrupted = AtomicBool::new(false);
    let mut cases = cases();
    if std::env::var_os("SUTURA_FULL").is_none() {
        cases.retain(|case| case.family() != "tremor");
    }
    let rows = work::all(&cases, &[Setting::DEFAULT], (Level::best(), &interrupted), |_, _| {}).unwrap();
    assert_eq!(rows.len(), cases.len());
    let failed: Vec<_> = rows.iter().filter(|row| !row.passed).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn a_case_is_found_by_its_name_and_its_family() {
    let count = |name| chosen(Some(name)).map(|cases| cases.len());
    assert_eq!(count("tool-teleported:down").ok(), Some(1));
    assert_eq!(count("tool-teleported").ok(), Some(3));
    let said = |name| count(name).unwrap_err().to_string();
    let families = said("tool");
    assert!(
        families.contains("tool-teleported, ") && !families.contains('\n'),
        "{families}"
    );
    let variants = said("tool-teleported:left");
    assert!(
        variants.contains("tool-teleported:up") && !variants.contains("tremor"),
        "{variants}"
    );
}
