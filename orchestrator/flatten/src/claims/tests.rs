//! Claims judged online, compared with the definition of their operators evaluated on the whole trace.

use super::judge::Random;
use super::judged::{Decision, Join, Joined, Judged};
use super::{Claims, ClaimsMemory, Completeness};
use crate::expression::{Moment, Stack};
use crate::values::{Slot, ValueType, Values};
use dsl::scenario::{BooleanExpression, Claim, Formula, Gated, Margin, Port, RealExpression, TickWindow, Until};
use proptest::prelude::*;
use results::verdict::{Standing, Verdict};

/// The value of a formula at a tick, evaluated recursively on a whole trace as the language defines it.
fn defined(formula: &Formula, at: u64, trace: &[[f64; 2]], completeness: Completeness) -> Decision {
    let last = trace.len() as u64 - 1;
    let sample = |variable: usize| trace.get(usize::try_from(at).unwrap()).map(|sample| sample[variable]);
    let join = Join::of(formula);
    let mut joined = Joined::new(true);
    match formula {
        Formula::Margin(Margin { value: RealExpression::Signal(port), strict }) => {
            sample(port.variable).map(|value| Judged::margin(value, *strict, at))
        }
        Formula::Condition(BooleanExpression::Margin(Margin { value: RealExpression::Signal(port), .. })) => {
            sample(port.variable).map(|value| Judged::condition(value > 0.0, at))
        }
        Formula::And(parts) | Formula::Or(parts) => {
            for part in parts {
                joined.take(join, defined(part, at, trace, completeness));
            }
            joined.decision(join)
        }
        Formula::Always(window, body) | Formula::Eventually(window, body) => {
            let last_judgeable = last.checked_sub(horizon(body));
            let to = window.to.map(|to| at + to).or(last_judgeable);
            for tick in at + window.from..to.map_or(0, |to| to + 1) {
                joined.take(join, defined(body, tick, trace, completeness));
            }
            joined.complete = window.to.is_some() || completeness == Completeness::Complete;
            joined.decision(join)
        }
        _ => unreachable!(),
    }
}

/// How many ticks ahead of its own tick a formula needs samples.
fn horizon(formula: &Formula) -> u64 {
    match formula {
        Formula::And(parts) | Formula::Or(parts) => parts.iter().fold(0, |most, part| most.max(horizon(part))),
        Formula::Always(window, body) | Formula::Eventually(window, body) => {
            horizon(body) + window.to.unwrap_or(window.from)
        }
        _ => 0,
    }
}

fn claims_of(formula: &Formula, stop_tick: u64) -> Claims {
    Claims::new(&[Claim::of(formula.clone())], stop_tick, &mut |port| Slot {
        base: ValueType::Real,
        index: port.variable,
    })
}

fn take(claims: &Claims, memory: &mut ClaimsMemory, first_tick: u64, samples: &[[f64; 2]]) {
    for (tick, sample) in (first_tick..).zip(samples) {
        let outputs = Values { reals: sample.to_vec(), ..Values::default() };
        let moment = Moment { outputs: &outputs, time_s: 0.0, rises: &[], shared: &[] };
        claims.take(memory, tick, &moment, &mut Stack::default(), |_, _| {});
    }
}

fn end(claims: &Claims, memory: &mut ClaimsMemory, samples: u64, completeness: Completeness) -> Standing {
    let mut standing = Standing::UNKNOWN;
    claims.end(memory, samples.checked_sub(1), completeness, |_, last| standing = last);
    standing
}

/// The standing of a run that has ended and the one before it was known to end, and the claim that was lost meanwhile.
pub(super) fn judge(
    formula: &Formula,
    trace: &[[f64; 2]],
    stop_tick: u64,
    completeness: Completeness,
) -> (Standing, Standing, Option<usize>) {
    let claims = claims_of(formula, stop_tick);
    let mut memory = claims.memory();
    take(&claims, &mut memory, 0, trace);
    let (_, early) = claims.standings(&memory).next().unwrap();
    (end(&claims, &mut memory, trace.len() as u64, completeness), early, memory.lost())
}

fn signal(variable: usize) -> RealExpression {
    RealExpression::Signal(Port { instance: 0, variable })
}

fn above_zero(variable: usize, strict: bool) -> Formula {
    Formula::Margin(Margin { value: signal(variable), strict })
}

fn always(from: u64, to: Option<u64>, body: Formula) -> Formula {
    Formula::Always(TickWindow { from, to }, Box::new(body))
}

fn eventually(from: u64, to: Option<u64>, body: Formula) -> Formula {
    Formula::Eventually(TickWindow { from, to }, Box::new(body))
}

fn any_atom() -> impl Strategy<Value = Formula> {
    let condition =
        |variable| Formula::Condition(BooleanExpression::Margin(Margin { value: signal(variable), strict: true }));
    prop_oneof![
        (0..2_usize, any::<bool>()).prop_map(|(variable, strict)| above_zero(variable, strict)),
        (0..2_usize).prop_map(condition),
    ]
}

fn any_temporal(body: impl Strategy<Value = Formula>) -> impl Strategy<Value = Formula> {
    let to = prop::option::weighted(0.6, 0..4_u64);
    (any::<bool>(), 0..3_u64, to, body).prop_map(|(all, from, more, body)| {
        let to = more.map(|more| from + more);
        if all { always(from, to, body) } else { eventually(from, to, body) }
    })
}

fn any_junction(part: impl Strategy<Value = Formula>) -> impl Strategy<Value = Formula> {
    let parts = prop::collection::vec(part, 1..4);
    (any::<bool>(), parts).prop_map(|(all, parts)| if all { Formula::And(parts) } else { Formula::Or(parts) })
}

/// Formulas of any shape, and formulas in which a temporal operator is nested in another for certain.
fn any_formula() -> impl Strategy<Value = Formula> {
    let any_shape =
        any_atom().prop_recursive(4, 12, 3, |inner| prop_oneof![any_junction(inner.clone()), any_temporal(inner)]);
    let inner = any_junction(prop_oneof![any_atom(), any_temporal(prop_oneof![any_atom(), any_temporal(any_atom())])]);
    prop_oneof![any_shape, any_temporal(any_temporal(inner))]
}

/// Formulas with gates and `finally` too.
fn any_gated_formula() -> impl Strategy<Value = Formula> {
    any::<u64>().prop_map(|seed| random_formula(&mut Random(seed), 3))
}

/// Small whole numbers, so that margins are often equal or zero.
fn any_trace() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let value = || prop_oneof![20 => (-3..4_i32).prop_map(f64::from), 1 => Just(f64::NAN)];
    prop::collection::vec((value(), value()).prop_map(|(a, b)| [a, b]), 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_claim_gets_the_verdict_margin_and_tick_of_its_definition(
        formula in any_formula(), trace in any_trace(), complete: bool, more in 0..5_u64,
    ) {
        let completeness = if complete { Completeness::Complete } else { Completeness::CutOff };
        let (standing, early, lost) = judge(&formula, &trace, trace.len() as u64 - 1 + more, completeness);
        match defined(&formula, 0, &trace, completeness) {
            Some(value) => {
                let verdict = if value.holds() { Verdict::Holds } else { Verdict::Fails };
                prop_assert_eq!(standing.verdict, verdict);
                prop_assert_eq!((standing.margin, standing.worst_tick), (value.reported_margin(), value.tick));
            }
            None => prop_assert_eq!(standing.verdict, Verdict::Unjudged),
        }
        if early.verdict != Verdict::Undecided {
            prop_assert_eq!(early.verdict, standing.verdict, "a decided claim stays decided");
        }
        prop_assert_eq!(lost.is_some(), early.verdict == Verdict::Fails);
    }

    #[test]
    fn claims_that_continue_from_their_memory_are_judged_as_if_they_had_never_stopped(
        formula in any_gated_formula(), trace in any_trace(), cut in 1..12_usize, complete: bool, more in 0..5_u64,
    ) {
        let completeness = if complete { Completeness::Complete } else { Completeness::CutOff };
        let stop_tick = trace.len() as u64 - 1 + more;
        let (whole, _, lost) = judge(&formula, &trace, stop_tick, completeness);
        let (before, after) = trace.split_at(cut.min(trace.len()));
        let (claims, samples) = (claims_of(&formula, stop_tick), before.len() as u64);
        let mut saved = claims.memory();
        take(&claims, &mut saved, 0, before);
        let bytes = postcard::to_stdvec(&saved).unwrap();
        let mut continued = postcard::from_bytes(&bytes).unwrap();
        prop_assert!(claims.fits(&continued, samples));
        claims.reserve(&mut continued);
        prop_assert_eq!(&postcard::to_stdvec(&continued).unwrap(), &bytes);
        take(&claims, &mut continued, samples, after);
        prop_assert_eq!(continued.lost(), lost);
        prop_assert_eq!(end(&claims, &mut continued, trace.len() as u64, completeness), whole);
    }

    #[test]
    fn the_memory_of_other_claims_is_refused_or_causes_no_panic(
        formula in any_gated_formula(), other in any_gated_formula(), trace in any_trace(), samples in 1..12_u64,
    ) {
        let [claims, other] = [&formula, &other].map(|formula| claims_of(formula, 40));
        let mut memory = other.memory();
        take(&other, &mut memory, 0, &trace);
        if claims.fits(&memory, samples) {
            take(&claims, &mut memory, samples, &trace);
            let standing = end(&claims, &mut memory, samples + trace.len() as u64, Completeness::Complete);
            prop_assert_ne!(standing.verdict, Verdict::Undecided);
        }
    }

    #[test]
    fn a_verdict_of_a_run_that_was_cut_off_is_that_of_every_continuation(
        formula in any_gated_formula(), trace in any_trace(), rest in any_trace(),
    ) {
        // A gate may still open.
        let tested = |standing: Standing| match standing.verdict {
            Verdict::Untested => Verdict::Holds,
            verdict => verdict,
        };
        let cut = tested(judge(&formula, &trace, 40, Completeness::CutOff).0);
        let whole: Vec<_> = trace.iter().chain(&rest).copied().collect();
        let later = tested(judge(&formula, &whole, 40, Completeness::CutOff).0);
        if cut != Verdict::Unjudged {
            prop_assert_eq!(cut, later);
        }
    }
}

/// How many comparisons and conditions a formula has.
pub(super) fn atoms_of(formula: &Formula) -> u32 {
    match formula {
        Formula::Margin(_) | Formula::Condition(_) => 1,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().map(atoms_of).sum(),
        Formula::Always(_, body) | Formula::Eventually(_, body) | Formula::Finally(body) => atoms_of(body),
        Formula::Gated(Gated { gate, body, .. }) | Formula::Until(Until { gate, body, .. }) => {
            atoms_of(gate) + atoms_of(body)
        }
    }
}

/// A formula of any shape, at most so deep.
pub(super) fn random_formula(random: &mut Random, depth: u32) -> Formula {
    let variable = usize::try_from(random.below(2)).unwrap_or(0);
    let kind = if depth == 0 { random.below(2) } else { random.below(12) };
    let inner = |random: &mut Random| random_formula(random, depth.saturating_sub(1));
    let window = |random: &mut Random| {
        let from = random.below(3);
        let to = (random.below(5) < 3).then(|| from + random.below(4));
        TickWindow { from, to }
    };
    match kind {
        0 => above_zero(variable, random.below(2) == 0),
        1 => Formula::Condition(BooleanExpression::Margin(Margin { value: signal(variable), strict: true })),
        2 => Formula::And(vec![inner(random), inner(random)]),
        3 => Formula::Or(vec![inner(random), inner(random)]),
        4 | 5 => Formula::Always(window(random), Box::new(inner(random))),
        6 | 7 => Formula::Eventually(window(random), Box::new(inner(random))),
        8 | 9 => {
            let (any, gate, body) = (random.below(3) > 0, Box::new(inner(random)), Box::new(inner(random)));
            Formula::Gated(Gated { any, gate, body })
        }
        10 => {
            let (any, window) = (random.below(3) > 0, window(random));
            let (gate, body) = (Box::new(inner(random)), Box::new(inner(random)));
            Formula::Until(Until { any, window, body, gate })
        }
        _ => Formula::Finally(Box::new(random_formula(random, 0))),
    }
}

fn standing_of(formula: &Formula, values: &[f64], completeness: Completeness) -> (Verdict, f64, u64) {
    let trace: Vec<_> = values.iter().map(|&value| [value, 0.0]).collect();
    let standing = judge(formula, &trace, 100, completeness).0;
    (standing.verdict, standing.margin, standing.worst_tick)
}

#[test]
fn a_window_that_begins_later_is_left_out_where_it_is_empty() {
    let inner = |body| always(2, None, body);
    let claim = always(0, None, inner(above_zero(0, true)));
    assert_eq!(standing_of(&claim, &[-3.0, -1.0, 2.0, 1.0], Completeness::Complete), (Verdict::Holds, 1.0, 3));
    assert_eq!(standing_of(&claim, &[3.0, 1.0, 2.0, -1.0], Completeness::Complete), (Verdict::Fails, -1.0, 3));
}

#[test]
fn a_sample_costs_a_few_steps_on_average_also_where_it_decides_long_windows() {
    // The inner window fails once, in the middle of the run, and is decided late and backwards.
    let inner = Formula::Or(vec![above_zero(0, true), eventually(0, Some(2000), above_zero(1, true))]);
    let claim = always(0, Some(4000), eventually(0, Some(1000), always(0, Some(2000), inner)));
    let trace: Vec<_> = (0..6000).map(|tick| [if tick == 2500 { -1.0 } else { 1.0 }, -1.0]).collect();
    let steps = super::early::steps_of(|| _ = judge(&claim, &trace, 8000, Completeness::Complete));
    assert!((1..4 * 6000).contains(&steps), "{steps}");
}

#[test]
fn always_reports_its_smallest_margin_and_its_tick() {
    let claim = always(0, None, above_zero(0, true));
    assert_eq!(standing_of(&claim, &[3.0, 1.0, 2.0, 1.0], Completeness::Complete), (Verdict::Holds, 1.0, 1));
    assert_eq!(standing_of(&claim, &[3.0, 0.0, 2.0], Completeness::Complete), (Verdict::Fails, 0.0, 1));
    assert_eq!(standing_of(&claim, &[3.0, 1.0], Completeness::CutOff), (Verdict::Unjudged, 1.0, 1));
    assert_eq!(standing_of(&claim, &[3.0, -1.0], Completeness::CutOff), (Verdict::Fails, -1.0, 1));
}

#[test]
fn the_last_ticks_whose_window_is_incomplete_are_left_out() {
    let claim = always(0, None, eventually(0, Some(2), above_zero(0, true)));
    let recovers = [1.0, -1.0, -1.0, 1.0, -1.0, -1.0];
    assert_eq!(standing_of(&claim, &recovers, Completeness::Complete), (Verdict::Holds, 1.0, 0));
    assert_eq!(standing_of(&claim, &[1.0, -1.0, -1.0, -2.0], Completeness::Complete), (Verdict::Fails, -1.0, 1));
    assert_eq!(standing_of(&claim, &[1.0, -1.0], Completeness::Complete).0, Verdict::Unjudged);
}

#[test]
fn a_window_cut_short_is_judged_if_its_samples_decide_it() {
    let reach = eventually(0, Some(9), above_zero(0, true));
    assert_eq!(standing_of(&reach, &[-1.0, 2.0, 1.0], Completeness::Complete), (Verdict::Holds, 2.0, 1));
    assert_eq!(standing_of(&reach, &[-1.0, -2.0], Completeness::Complete).0, Verdict::Unjudged);
    let stay = always(0, Some(9), above_zero(0, true));
    assert_eq!(standing_of(&stay, &[1.0, -2.0], Completeness::Complete), (Verdict::Fails, -2.0, 1));
    assert_eq!(standing_of(&stay, &[1.0, 2.0], Completeness::Complete).0, Verdict::Unjudged);
}

#[test]
fn an_unbounded_operator_whose_range_is_empty_is_unjudged() {
    let late = always(5, None, above_zero(0, true));
    assert_eq!(standing_of(&late, &[1.0; 5], Completeness::Complete).0, Verdict::Unjudged);
    assert_eq!(standing_of(&late, &[1.0; 6], Completeness::Complete), (Verdict::Holds, 1.0, 5));
}

#[test]
fn not_a_number_fails_at_its_sample_only() {
    let [always, eventually] = [always(0, None, above_zero(0, true)), eventually(0, None, above_zero(0, true))];
    let values = [1.0, f64::NAN, 2.0];
    assert_eq!(standing_of(&always, &values, Completeness::Complete), (Verdict::Fails, f64::NEG_INFINITY, 1));
    assert_eq!(standing_of(&eventually, &values, Completeness::Complete), (Verdict::Holds, 2.0, 2));
}

#[test]
fn a_run_too_long_for_memory_can_begin() {
    let nested = always(0, None, eventually(0, None, above_zero(0, true)));
    let (standing, ..) = judge(&nested, &[[1.0, 0.0]], u64::MAX, Completeness::Complete);
    assert_eq!(standing.verdict, Verdict::Holds);
}

#[test]
fn a_run_without_a_sample_leaves_every_claim_unjudged() {
    let (standing, ..) = judge(&above_zero(0, true), &[], 10, Completeness::CutOff);
    assert_eq!(standing.verdict, Verdict::Unjudged);
}

/// The verdict and margin of a run that came to its own end, for the samples of both signals.
fn outcome(formula: &Formula, a: &[f64], b: &[f64]) -> (Verdict, f64) {
    let trace: Vec<_> = a.iter().zip(b).map(|(&a, &b)| [a, b]).collect();
    let standing = judge(formula, &trace, 100, Completeness::Complete).0;
    (standing.verdict, standing.margin)
}

fn implies(gate: Formula, body: Formula) -> Formula {
    Formula::Gated(Gated { any: true, gate: Box::new(gate), body: Box::new(body) })
}

fn until(to: Option<u64>, body: Formula, gate: Formula) -> Formula {
    let window = TickWindow { from: 0, to };
    Formula::Until(Until { any: true, window, body: Box::new(body), gate: Box::new(gate) })
}

/// A name, a claim, the values of `a` and `b`, and the verdict with its margin.
type Example<'e> = (&'e str, &'e Formula, &'e [f64], &'e [f64], (Verdict, f64));

#[test]
fn gates_until_and_finally_by_their_smallest_examples() {
    use Verdict::{Fails, Holds, Unjudged, Untested};
    const INFINITY: f64 = f64::INFINITY;
    let [a, b, a_fails] = [above_zero(0, true), above_zero(1, true), negated_above_zero(0)];
    // a > 0 implies b > 0, whose gate is stored as not a > 0.
    let gated = always(0, None, implies(a_fails.clone(), b.clone()));
    let late = always(0, None, implies(a_fails, eventually(0, Some(2), b.clone())));
    let [waits, waits_for_2] = [None, Some(2)].map(|to| until(to, a.clone(), b.clone()));
    let last = Formula::Finally(Box::new(a));
    let table: [Example<'_>; 13] = [
        ("open twice", &gated, &[1.0, -1.0, 2.0], &[5.0, -9.0, 3.0], (Holds, 3.0)),
        ("open and violated", &gated, &[1.0, -1.0, 2.0], &[5.0, -9.0, -3.0], (Fails, -3.0)),
        ("never open", &gated, &[-1.0, -1.0], &[5.0, -9.0], (Untested, INFINITY)),
        ("open in the last ticks only", &late, &[-1.0, -1.0, -1.0, 1.0], &[-1.0; 4], (Untested, INFINITY)),
        ("answered late enough", &late, &[1.0, -1.0, -1.0, -1.0], &[-1.0, -1.0, 4.0, -1.0], (Holds, 4.0)),
        ("it comes", &waits, &[3.0, 2.0, -5.0], &[-1.0, -1.0, 1.0], (Holds, 2.0)),
        ("it comes too late for a", &waits, &[3.0, -2.0, 5.0], &[-1.0, -1.0, 1.0], (Fails, -2.0)),
        ("it never comes", &waits, &[3.0, 2.0, 5.0], &[-1.0; 3], (Fails, -INFINITY)),
        ("it is there at once", &waits, &[-3.0, 2.0], &[1.0, 1.0], (Untested, INFINITY)),
        ("it comes after its window", &waits_for_2, &[3.0; 4], &[-1.0, -1.0, -1.0, 1.0], (Fails, -INFINITY)),
        ("its window is cut short", &waits_for_2, &[3.0; 2], &[-1.0; 2], (Unjudged, 3.0)),
        ("its window is cut short and a failed", &waits_for_2, &[3.0, -4.0], &[-1.0; 2], (Fails, -4.0)),
        ("at the last sample", &last, &[-3.0, -4.0, 7.0], &[0.0; 3], (Holds, 7.0)),
    ];
    for (name, formula, a, b, expected) in table {
        assert_eq!(outcome(formula, a, b), expected, "{name}");
    }
    let cut = judge(&last, &[[1.0, 0.0]], 100, Completeness::CutOff).0;
    assert_eq!((cut.verdict, cut.margin), (Unjudged, 1.0));
}

/// `not x > 0`
fn negated_above_zero(variable: usize) -> Formula {
    let value = RealExpression::Negate(Box::new(signal(variable)));
    Formula::Margin(Margin { value, strict: false })
}
