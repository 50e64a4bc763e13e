//! A judge of claims for tests: it evaluates the definitions of the language on a whole trace and shares no code with the
//! judge of a run.

use super::Completeness;
use super::tests::{atoms_of, judge, random_formula};
use dsl::scenario::{BooleanExpression, Formula, Gated, Margin, RealExpression, TickWindow, Until};
use results::verdict::Verdict;

/// What is known of a value: its margin, and whether it holds; zero holds or fails.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Known {
    margin: f64,
    holds: bool,
}

/// A trace and how its run ended.
struct Run<'a> {
    trace: &'a [[f64; 2]],
    complete: bool,
}

fn sign(holds: bool) -> Known {
    Known { margin: if holds { f64::INFINITY } else { f64::NEG_INFINITY }, holds }
}

/// The smaller or larger of some values, of which those that are not known may be anything: it is known if they cannot
/// change whether it holds.
fn joined(all: bool, values: &[Option<Known>]) -> Option<Known> {
    let key = |known: &Known| (known.margin, known.holds);
    let known = values.iter().flatten().copied();
    let by = |a: &Known, b: &Known| key(a).partial_cmp(&key(b)).expect("margins are numbers");
    let extreme = if all { known.min_by(by) } else { known.max_by(by) }?;
    (values.iter().all(Option::is_some) || extreme.holds != all).then_some(extreme)
}

impl Run<'_> {
    fn last(&self) -> i64 {
        self.trace.len() as i64 - 1
    }

    fn value_of(&self, expression: &RealExpression, at: i64) -> Option<f64> {
        let sample = self.trace.get(usize::try_from(at).ok()?)?;
        match expression {
            RealExpression::Signal(port) => Some(sample[port.variable]),
            _ => unreachable!(),
        }
    }

    /// The value at a tick, `None` if the samples do not determine it.
    fn at(&self, formula: &Formula, t: i64) -> Option<Known> {
        match formula {
            Formula::Margin(Margin { value, strict }) => self.value_of(value, t).map(|x| match x {
                x if x.is_nan() => sign(false),
                x => Known { margin: x, holds: if *strict { x > 0.0 } else { x >= 0.0 } },
            }),
            Formula::Condition(BooleanExpression::Margin(Margin { value, .. })) => {
                self.value_of(value, t).map(|x| sign(x > 0.0))
            }
            Formula::Condition(_) => unreachable!(),
            Formula::And(parts) => joined(true, &parts.iter().map(|part| self.at(part, t)).collect::<Vec<_>>()),
            Formula::Or(parts) => joined(false, &parts.iter().map(|part| self.at(part, t)).collect::<Vec<_>>()),
            Formula::Always(window, body) => self.over(true, *window, body, t),
            Formula::Eventually(window, body) => self.over(false, *window, body, t),
            Formula::Gated(Gated { any, gate, body }) => {
                let gate = self.at(gate, t).map(|gate| sign(gate.holds));
                joined(!any, &[self.at(body, t), gate])
            }
            Formula::Until(until) => self.until(until, t),
            // What is asked for after the end of the run is not known.
            Formula::Finally(body) if self.complete && t <= self.last() => self.at(body, self.last()),
            Formula::Finally(_) => None,
        }
    }

    fn over(&self, all: bool, window: TickWindow, body: &Formula, t: i64) -> Option<Known> {
        let from = t + window.from as i64;
        let to = window.to.map_or(self.last() - horizon(body), |to| t + to as i64);
        let mut values: Vec<_> = (from..=to).map(|u| self.at(body, u)).collect();
        if window.to.is_none() && !self.complete {
            values.push(None);
        }
        joined(all, &values)
    }

    fn until(&self, Until { any, window, body, gate }: &Until, t: i64) -> Option<Known> {
        let judgeable = self.last() - horizon(body).max(horizon(gate));
        let from = t + window.from as i64;
        let to = window.to.map_or(judgeable, |to| t + to as i64);
        let known = |u: i64| if window.to.is_none() && u > judgeable { None } else { self.at(body, u) };
        let ended = |u: i64, gate: Option<Known>| {
            let before = (t..u).map(known).chain([gate]);
            joined(*any, &before.collect::<Vec<_>>())
        };
        let gate_at = |u: i64| self.at(gate, u).map(|gate| sign(gate.holds));
        let mut values: Vec<_> = (from..=to).map(|u| ended(u, gate_at(u))).collect();
        if window.to.is_none() && (from > to || !self.complete) {
            // g may come later.
            values.push(ended(from.max(to + 1), None));
        }
        joined(!any, &values)
    }
}

/// How many ticks a formula looks ahead.
fn horizon(formula: &Formula) -> i64 {
    match formula {
        Formula::Margin(_) | Formula::Condition(_) | Formula::Finally(_) => 0,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().map(horizon).max().unwrap_or(0),
        Formula::Always(window, body) | Formula::Eventually(window, body) => {
            window.to.unwrap_or(window.from) as i64 + horizon(body)
        }
        Formula::Gated(Gated { gate, body, .. }) => horizon(gate).max(horizon(body)),
        Formula::Until(Until { window, gate, body, .. }) => {
            window.to.unwrap_or(window.from) as i64 + horizon(gate).max(horizon(body))
        }
    }
}

/// Numbers that look random and are the same in each test run (SplitMix64).
pub(super) struct Random(pub u64);

impl Random {
    pub(super) fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % end
    }
}

#[test]
fn a_hundred_thousand_random_claims_get_margins_by_definition_and_verdicts_as_early_as_they_are_determined() {
    let mut random = Random(1);
    let mut verdicts = [0_usize; 5];
    for case in 0..100_000 {
        let formula = random_formula(&mut random, 3);
        let length = 1 + random.below(11);
        let mut value = || match random.below(21) {
            0 => f64::NAN,
            _ => random.below(7) as f64 - 3.0,
        };
        let trace: Vec<_> = (0..length).map(|_| [value(), value()]).collect();
        let complete = random.below(2) == 0;
        let completeness = if complete { Completeness::Complete } else { Completeness::CutOff };
        let (judged, early, _) = judge(&formula, &trace, length - 1 + random.below(4), completeness);
        let defined = Run { trace: &trace, complete }.at(&formula, 0);
        let verdict = match judged.verdict {
            Verdict::Untested => Verdict::Holds,
            other => other,
        };
        let shown = || format!("case {case}: {formula:?}\n{trace:?} {complete} {judged:?} {defined:?}");
        match defined {
            Some(Known { margin, holds }) => {
                assert_eq!(verdict == Verdict::Holds, holds, "{}", shown());
                assert!(verdict.is_decided() && judged.margin.to_bits() == (margin + 0.0).to_bits(), "{}", shown());
                assert!(judged.part < atoms_of(&formula) && judged.worst_tick < length, "{}", shown());
            }
            None => assert_eq!(verdict, Verdict::Unjudged, "{}", shown()),
        }
        // Before the run ends the verdict is known as soon as the samples determine it.
        let known = Run { trace: &trace, complete: false }.at(&formula, 0);
        let at_last = match early.verdict {
            Verdict::Undecided => None,
            decided => Some(decided == Verdict::Holds),
        };
        assert_eq!(at_last, known.map(|known| known.holds), "{}\nearly {early:?}", shown());
        verdicts[judged.verdict as usize] += 1;
    }
    let enough = verdicts.iter().enumerate().all(|(verdict, &count)| verdict == 0 || count > 2_000);
    assert!(enough, "each verdict is tested: {verdicts:?}");
}
