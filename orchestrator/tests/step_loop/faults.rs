//! Faults of connections, seen through fake units.

use crate::checkpoints::fits;
use crate::events::set;
use crate::fake::{P, Script, U, V, Y, counter, port, repeater, signal, unit};
use crate::{TIME, number};
use dsl::scenario::{Action, Fault, FaultKind, Port, RealExpression, Trigger};

fn fault(targets: &[Port], kind: FaultKind) -> Vec<Action> {
    vec![Action::Fault(Fault { targets: targets.to_vec(), kind })]
}

fn at(tick: u64, lasting: u64) -> (Trigger, Option<u64>) {
    (Trigger::At(tick), Some(lasting))
}

/// A counter drives u of a repeater and, with a delay of nothing, v.
fn connected(direct: bool) -> Script {
    let script = Script::new(vec![counter(1, 0), repeater(1, usize::from(direct))]).connect(0, 1, direct);
    let mut script = script.compute(signal(0), port(1, V), direct).record(&[(1, U), (1, V)]);
    script.scenario.seed = 1;
    script
}

fn with(script: Script, (trigger, lasting): (Trigger, Option<u64>), actions: Vec<Action>) -> [Vec<f64>; 2] {
    let ran = script.event(trigger, lasting, actions).run();
    assert!(ran.result.is_ok(), "{:?}", ran.result);
    [ran.column(0), ran.column(1)]
}

const UP: [f64; 7] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0];

#[test]
fn each_fault_acts_in_its_window_and_undoes_itself() {
    let u = [port(1, U)];
    let table = [
        (FaultKind::Bias(vec![number(10.0)]), [0.0, 1.0, 12.0, 13.0, 4.0, 5.0, 5.0]),
        (FaultKind::Bias(vec![TIME]), [0.0, 1.0, 4.0, 6.0, 4.0, 5.0, 5.0]),
        (FaultKind::Noise(vec![number(0.0)]), UP),
        (FaultKind::Freeze, [0.0, 1.0, 1.0, 1.0, 4.0, 5.0, 5.0]),
        (FaultKind::Loss(number(1.0)), [0.0, 1.0, 1.0, 1.0, 4.0, 5.0, 5.0]),
        (FaultKind::Loss(number(0.0)), UP),
        // It reaches back into values that were there before the window, and to the initial value before the start.
        (FaultKind::Delay(1), [0.0, 1.0, 1.0, 2.0, 4.0, 5.0, 5.0]),
        (FaultKind::Delay(3), [0.0, 1.0, 0.5, 0.0, 4.0, 5.0, 5.0]),
        (FaultKind::Delay(100), [0.0, 1.0, 0.5, 0.5, 4.0, 5.0, 5.0]),
    ];
    for (kind, expected) in table {
        let [faulty, other] = with(connected(false), at(2, 2), fault(&u, kind.clone()));
        assert_eq!(faulty, expected, "{kind:?}");
        assert_eq!(other, UP, "{kind:?}");
    }
    let table = [
        (FaultKind::Bias(vec![number(10.0)]), [1.0, 2.0, 13.0, 14.0, 5.0, 6.0, 6.0]),
        (FaultKind::Freeze, [1.0, 2.0, 2.0, 2.0, 5.0, 6.0, 6.0]),
        (FaultKind::Delay(1), [1.0, 2.0, 2.0, 3.0, 5.0, 6.0, 6.0]),
    ];
    for (kind, expected) in table {
        assert_eq!(with(connected(true), at(2, 2), fault(&u, kind.clone()))[0], expected, "=> {kind:?}");
    }
}

#[test]
fn a_fault_that_opens_at_the_start_holds_the_initial_value() {
    let [frozen, _] = with(connected(false), at(0, 2), fault(&[port(1, U)], FaultKind::Freeze));
    assert_eq!(frozen, [0.5, 0.5, 2.0, 3.0, 4.0, 5.0, 5.0]);
}

#[test]
fn the_chain_is_set_then_bias_then_freeze_then_delay() {
    let u = [port(1, U)];
    let both = |first: Vec<Action>, second: Vec<Action>| [first, second].concat();
    let bias = || fault(&u, FaultKind::Bias(vec![number(10.0)]));
    // Whatever their order in the window.
    for actions in [both(set(1, U, -1.0), bias()), both(bias(), set(1, U, -1.0))] {
        assert_eq!(with(connected(false), at(2, 2), actions)[0], [0.0, 1.0, 9.0, 9.0, 4.0, 5.0, 5.0]);
    }
    let frozen = both(fault(&u, FaultKind::Freeze), bias());
    assert_eq!(with(connected(false), at(2, 2), frozen)[0], [0.0, 1.0, 1.0, 1.0, 4.0, 5.0, 5.0]);
    let delayed = both(fault(&u, FaultKind::Delay(1)), bias());
    assert_eq!(with(connected(false), at(2, 3), delayed)[0], [0.0, 1.0, 1.0, 12.0, 13.0, 5.0, 5.0]);
    let late_ice = both(fault(&u, FaultKind::Delay(1)), fault(&u, FaultKind::Freeze));
    assert_eq!(with(connected(false), at(2, 3), late_ice)[0], [0.0, 1.0, 1.0, 1.0, 1.0, 5.0, 5.0]);
}

#[test]
fn a_slow_input_holds_and_delays_its_own_samples() {
    let script = || Script::new(vec![counter(1, 0), repeater(2, 0)]).connect(0, 1, false).record(&[(1, U)]);
    let run = |kind| script().event(Trigger::At(2), Some(3), fault(&[port(1, U)], kind)).run().column(0);
    assert_eq!(run(FaultKind::Freeze), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(run(FaultKind::Delay(2)), [0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0]);
    assert_eq!(run(FaultKind::Delay(3)), [0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0], "up to the next sample");
}

#[test]
fn loss_makes_one_draw_for_its_path_and_noise_one_for_each_element() {
    let both = [port(1, U), port(1, V)];
    let mut script = connected(false);
    script.scenario.stop_tick = 400;
    let [u, v] = with(script, at(0, 400), fault(&both, FaultKind::Loss(number(0.25))));
    assert!(u[1..] == v[1..], "both are lost together");
    let lost = (1..400).filter(|&tick| u[tick] == u[tick - 1]).count();
    assert!((70..130).contains(&lost), "{lost}");
    let mut script = connected(false);
    script.scenario.stop_tick = 400;
    let [u, v] = with(script, at(0, 400), fault(&both, FaultKind::Noise(vec![number(2.0), number(0.5)])));
    let error = |values: &[f64]| (0..400).map(|tick| values[tick] - tick as f64).collect::<Vec<_>>();
    let deviation = |errors: &[f64]| (errors.iter().map(|error| error * error).sum::<f64>() / 400.0).sqrt();
    let (u, v) = (error(&u), error(&v));
    assert!((deviation(&u) - 2.0).abs() < 0.2 && (deviation(&v) - 0.5).abs() < 0.05);
    let correlation = u.iter().zip(&v).map(|(u, v)| u * v).sum::<f64>() / 400.0;
    assert!(correlation.abs() < 0.15, "{correlation}");
}

#[test]
fn random_numbers_depend_on_seed_port_ordinal_and_tick_alone() {
    let noise = || fault(&[port(1, U)], FaultKind::Noise(vec![number(1.0)]));
    let mut script = connected(false);
    script.scenario.seed = 42;
    let first = with(script, at(0, 6), noise())[0].clone();
    let expected = [0.20861291656480072, 1.5251300358284368, 1.368258248140024];
    assert_eq!(first[..3], expected, "equal bits everywhere");
    let mut later = connected(false).event(Trigger::At(0), Some(1), fault(&[port(1, V)], FaultKind::Loss(number(0.5))));
    later.scenario.seed = 42;
    assert_eq!(with(later, at(1, 5), noise())[0][1..], first[1..], "faults of other ports and windows change nothing");
    let mut second = connected(false).event(Trigger::At(0), Some(1), noise());
    second.scenario.seed = 42;
    assert_ne!(with(second, at(1, 5), noise())[0][1], first[1], "a second fault of a port has draws of its own");
    assert_ne!(with(connected(false), at(0, 6), noise())[0][0], first[0], "another seed");
}

#[test]
fn a_lasting_fault_is_replaced_and_a_window_over_it_returns_to_it() {
    let bias = |value| fault(&[port(1, U)], FaultKind::Bias(vec![number(value)]));
    let script = connected(false).event(Trigger::At(1), None, bias(10.0)).event(Trigger::At(4), None, bias(20.0));
    let ran = script.in_ticks(&[2], bias(30.0)).run();
    assert_eq!(ran.column(0), [0.0, 11.0, 32.0, 13.0, 24.0, 25.0, 25.0]);
}

/// Windows of all kinds over all kinds of faults, on fast and slow inputs of both arrows.
pub fn faulty(ticks: u64) -> Script {
    let slow = unit(3, 1, |step| step.u + step.p);
    let script = Script::new(vec![counter(1, 0), repeater(1, 1), slow, repeater(2, 0)]);
    let script = script.connect(0, 1, true).connect(1, 2, true).connect(0, 3, false);
    let mut script = script.compute(signal(2), port(3, V), false).compute(RealExpression::Time, port(1, V), false);
    script.scenario.stop_tick = ticks;
    script.scenario.seed = 5;
    let u_of = |instance| [port(instance, U)];
    let script = script.event(Trigger::At(2), Some(9), fault(&u_of(1), FaultKind::Delay(4)));
    let script = script.in_ticks(&[3, 4, 5, 6, 7, 10], fault(&u_of(2), FaultKind::Freeze));
    let both = [port(3, U), port(3, V)];
    let script = script.when(&[1, 2, 3, 8, 9, 10], 1, Some(5), fault(&both, FaultKind::Loss(number(0.5))));
    let script = script.event(Trigger::At(4), None, fault(&[port(1, V)], FaultKind::Noise(vec![number(1.0)])));
    let script = script.in_ticks(&[5, 9], set(2, P, 3.0)).when(&[3, 7], 0, None, set(2, P, 4.0));
    script.record(&[(0, Y), (1, U), (1, V), (2, U), (2, P), (2, Y), (3, U), (3, V), (3, Y)])
}

#[test]
fn a_run_with_faults_continues_from_each_of_its_ticks_as_if_it_had_never_stopped() {
    const TICKS: u64 = 16;
    let whole = faulty(TICKS).saving(0..TICKS).run();
    assert!(whole.result.is_ok(), "{:?}", whole.result);
    let apart = faulty(TICKS).on_workers(&[0, 1, 2, 3]).saving(0..TICKS).run();
    assert_eq!((&whole.rows, &whole.changes), (&apart.rows, &apart.changes));
    let bytes = |ran: &crate::fake::Ran| postcard::to_stdvec(&ran.checkpoints).unwrap();
    assert!(bytes(&whole) == bytes(&apart), "other workers save the same bytes");
    for checkpoint in &whole.checkpoints {
        let continued = faulty(TICKS).from(checkpoint).run();
        let behind = usize::try_from(checkpoint.tick + 1).unwrap();
        assert_eq!(continued.rows, whole.rows[behind..], "rows behind {}", checkpoint.tick);
        assert_eq!(continued.changes, whole.changes, "events, continued behind {}", checkpoint.tick);
    }
    assert!(whole.changes.len() > 10, "{:?}", whole.changes);
}

#[test]
fn a_checkpoint_of_other_windows_or_faults_fits_no_run() {
    let checkpoint = faulty(16).saving([8]).run().checkpoints.remove(0);
    assert!(fits(&checkpoint, &faulty(16)));
    let changed: [fn(&mut Script); 3] = [
        |script| drop(script.scenario.events.pop()),
        |script| script.scenario.events[0].actions = fault(&[port(1, U)], FaultKind::Delay(5)),
        |script| script.scenario.events[0].actions = fault(&[port(1, U)], FaultKind::Freeze),
    ];
    for (index, change) in changed.into_iter().enumerate() {
        let mut script = faulty(16);
        change(&mut script);
        assert!(!fits(&checkpoint, &script), "{index}");
    }
}
