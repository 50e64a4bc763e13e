//! Runs that are saved and continued, seen through fake units.

use crate::fake::{
    Answer, Fake, P, Ran, Script, Step, U, V, Y, answering, counter, description, port, repeater, signal, unit,
};
use crate::{TIME, number};
use dsl::scenario::{
    Action, BooleanExpression, Fault, FaultKind, Formula, Gated, Margin, RealExpression, Running, RunningKind,
    TickWindow, Until,
};
use orchestrator::run::message::Reason;
use orchestrator::run::step_loop::Checkpoint;
use unit::failure::Cause;

impl Script {
    pub fn saving(mut self, ticks: impl IntoIterator<Item = u64>) -> Self {
        self.saves = ticks.into_iter().collect();
        self
    }

    pub fn from(mut self, checkpoint: &Checkpoint) -> Self {
        assert!(fits(checkpoint, &self));
        // As it is read from a file.
        self.from = Some(postcard::from_bytes(&postcard::to_stdvec(checkpoint).unwrap()).unwrap());
        self
    }
}

/// Whether a run of a script can continue from a checkpoint, as it is read from a file.
pub fn fits(checkpoint: &Checkpoint, script: &Script) -> bool {
    let bytes = postcard::to_stdvec(checkpoint).unwrap();
    Checkpoint::read(&bytes, &script.scenario, &vec![&description(); script.units.len()]).is_ok()
}

fn above(value: RealExpression, limit: f64) -> Formula {
    let value = RealExpression::Subtract(Box::new(value), Box::new(number(limit)));
    Formula::Margin(Margin { value, strict: false })
}

fn within(to: u64, body: Formula) -> Formula {
    Formula::Eventually(TickWindow { from: 0, to: Some(to) }, Box::new(body))
}

/// Periods of 1, 2, 3 and 6 ticks, both arrows, windows that are open across saves, a rise, and claims of all kinds.
pub fn everything(ticks: u64) -> Script {
    let sum = RealExpression::Add(Box::new(signal(0)), Box::new(signal(2)));
    let slow = unit(6, 1, |step| step.u + step.p + f64::from(step.before));
    let script = Script::new(vec![counter(1, 0), repeater(2, 1), counter(3, 0), repeater(1, 2), slow]);
    let script = script.connect(0, 1, true).compute(sum, port(3, U), false).compute(signal(1), port(3, V), true);
    let script = script.connect(2, 4, true).at(4, Some(9), port(3, U), signal(0)).at(7, None, port(4, P), TIME);
    let mut script = script.at(2, Some(3), port(0, P), number(1.0));
    script.scenario.stop_tick = ticks;
    let rises = BooleanExpression::Margin(Margin { value: signal(1), strict: true });
    script.scenario.conditions = vec![dsl::scenario::Condition { is: rises, held_ticks: 0 }];
    let late = Fault { targets: vec![port(1, U)], kind: FaultKind::Delay(3) };
    let mut script = script.in_ticks(&[3, 4, 5, 6, 7, 8], vec![Action::Fault(late)]);
    let risen = Formula::Condition(BooleanExpression::Rises(0));
    let unbounded = Formula::Eventually(TickWindow { from: 0, to: None }, Box::new(above(signal(4), 9.0)));
    let (kind, of) = (RunningKind::Average, Box::new(signal(2)));
    script.scenario.shared = vec![RealExpression::Running(Running { kind, of, from_tick: 1, step_s: 0.1 })];
    let (body, gate) = (Box::new(above(signal(0), 0.0)), Box::new(above(signal(1), 3.0)));
    let until = Until { any: true, window: TickWindow { from: 1, to: Some(4) }, body, gate };
    let script = script.always(Formula::Until(until)).always(unbounded).always(within(3, risen));
    let average = within(5, above(RealExpression::Shared(0), 2.0));
    let (gate, body) = (Box::new(above(signal(0), 5.0)), Box::new(average));
    let script = script.always(Formula::Gated(Gated { any: true, gate, body }));
    script.record(&[(0, Y), (1, U), (1, Y), (2, Y), (3, U), (3, V), (3, Y), (4, U), (4, Y), (4, P)])
}

fn continues(whole: &Ran, continued: &Ran, tick: u64) {
    let behind = usize::try_from(tick + 1).unwrap();
    assert_eq!(continued.rows, whole.rows[behind..], "rows behind {tick}");
    assert_eq!(continued.result, whole.result, "the end, continued behind {tick}");
    assert_eq!(continued.standings, whole.standings, "claims, continued behind {tick}");
}

#[test]
fn a_run_continues_from_each_of_its_ticks_as_if_it_had_never_stopped() {
    const TICKS: u64 = 15;
    let whole = everything(TICKS).run();
    assert_eq!(whole.standings.len(), 4);
    let saved = everything(TICKS).saving(0..TICKS).run();
    assert_eq!((&saved.rows, &saved.result, &saved.standings), (&whole.rows, &whole.result, &whole.standings));
    for checkpoint in &saved.checkpoints {
        continues(&whole, &everything(TICKS).from(checkpoint).run(), checkpoint.tick);
    }
    assert_eq!(saved.checkpoints.len() as u64, TICKS);
}

#[test]
fn a_run_continues_in_other_workers_and_saves_the_same_bytes_there() {
    const TICKS: u64 = 15;
    let whole = everything(TICKS).saving(0..TICKS).run();
    let apart = everything(TICKS).on_workers(&[0, 1, 2, 3, 4]).saving(0..TICKS).run();
    for (together, apart) in whole.checkpoints.iter().zip(&apart.checkpoints) {
        let [bytes, same] = [together, apart].map(|checkpoint| postcard::to_stdvec(checkpoint).unwrap());
        assert_eq!(bytes, same, "saved at {}", together.tick);
        continues(&whole, &everything(TICKS).on_workers(&[1, 0, 1, 2, 0]).from(apart).run(), apart.tick);
        let later = everything(TICKS).on_workers(&[0, 0, 1, 1, 1]).from(apart).saving(0..TICKS).run();
        let [last, again] = [&whole, &later].map(|ran| postcard::to_stdvec(&ran.checkpoints.last()).unwrap());
        assert!(apart.tick + 1 == TICKS || last == again, "saved at {} and later", apart.tick);
    }
}

#[test]
fn a_unit_that_is_done_within_a_slow_step_ends_the_continued_run_too() {
    for last_successful_time_s in [6.0, 4.5] {
        let script = || {
            let done = move |_: &_| Answer::Terminated { y: 9.0, last_successful_time_s };
            let mut script = Script::new(vec![answering(6, 0, done), counter(1, 0)]).record(&[(0, Y), (1, Y)]);
            script.scenario.stop_tick = 9;
            script
        };
        let whole = script().saving([2]).run();
        let reason = whole.result.as_ref().map(|finish| &finish.reason);
        assert_eq!(reason, Ok(&Reason::Terminated(0)));
        continues(&whole, &script().from(&whole.checkpoints[0]).run(), 2);
    }
}

/// A unit that saves how many steps it has done and forgets something else from a tick on.
fn forgetful(from: u64) -> Fake {
    let mut steps_here = 0.0;
    let y = move |step: &Step| {
        steps_here += 1.0;
        if step.tick >= from { steps_here } else { 0.0 }
    };
    unit(1, 0, y)
}

#[test]
fn a_unit_that_does_not_come_back_as_it_was_saved_breaks_the_run() {
    let script = |from| {
        let follower = repeater(1, 1);
        let mut script = Script::new(vec![follower, forgetful(from)]).connect(1, 0, true).record(&[(0, Y), (1, Y)]);
        script.scenario.stop_tick = 20;
        script
    };
    // The step under way when the run was saved is part of the checkpoint.
    for (from, at) in [(0, 7.0), (9, 10.0)] {
        let saved = script(from).saving([5]).run();
        let continued = script(from).from(&saved.checkpoints[0]).run();
        let failure = continued.result.unwrap_err();
        assert_eq!(
            (failure.instance.as_deref(), failure.time_s),
            (Some("b"), Some(at)),
            "the source, not its follower"
        );
        let text = failure.to_string();
        assert!(text.starts_with("`b` did not come back as it was saved: y is "), "{text}");
        assert_eq!(continued.rows.len() as f64, at - 6.0, "no row with wrong values is recorded");
    }
}

#[test]
fn a_checkpoint_keeps_rows_until_the_run_ends_and_twice_the_longest_period() {
    let rows = |stop, every| {
        let mut script = Script::new(vec![counter(1, 0), counter(every, 0)]).record(&[(0, Y)]);
        script.scenario.stop_tick = stop;
        let saved = script.saving([5]).run();
        let bytes = postcard::to_stdvec(&saved.checkpoints).unwrap().len();
        (saved.checkpoints.len(), bytes)
    };
    let [short, long, slow] = [rows(8, 1), rows(40, 1), rows(60, 20)];
    assert_eq!([short.0, long.0, slow.0], [1; 3], "a checkpoint is replaced by that with rows");
    assert!(short.1 < long.1 && long.1 < slow.1, "{short:?} {long:?} {slow:?}");
}

#[test]
fn a_step_that_is_lost_leaves_no_checkpoint_and_breaks_the_run_when_it_is_due() {
    let script = || Script::new(vec![answering(4, 0, |_| Answer::Error), counter(1, 0)]).record(&[(0, Y), (1, Y)]);
    let (whole, saved) = (script().run(), script().saving([1, 2]).run());
    assert_eq!((saved.rows.len(), saved.checkpoints.len()), (4, 0));
    assert_eq!(saved.rows, whole.rows);
    let failure = saved.result.unwrap_err();
    assert_eq!(failure.cause, Cause::Status(3));
    assert_eq!(whole.result, Err(failure));
}

#[test]
fn a_checkpoint_of_another_shape_fits_no_run() {
    let checkpoint = everything(15).saving([4]).run().checkpoints.remove(0);
    let fits = |script: Script| fits(&checkpoint, &script);
    assert!(fits(everything(15)));
    assert!(!fits(everything(4)), "it is over");
    assert!(!fits(everything(15).always(above(signal(0), 0.0))), "a claim more");
    assert!(!fits(everything(15).connect(3, 0, false)), "an input more");
    let mut otherwise = everything(15);
    otherwise.scenario.conditions.clear();
    otherwise.scenario.claims.remove(2);
    assert!(!fits(otherwise), "a rise less");
    let mut direct = everything(15);
    direct.scenario.connections.iter_mut().for_each(|arrow| arrow.direct = false);
    assert!(!fits(direct), "other steps are under way");
    assert!(!fits(Script::new(vec![counter(1, 0)])), "instances less");
}
