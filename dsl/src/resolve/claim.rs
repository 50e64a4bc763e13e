//! `assert`: what must hold, how far it looks ahead, and what its margin is measured in.

use std::collections::BTreeSet;

use super::condition::{Bound, Condition, Until, opposite};
use super::frame::Placed;
use super::meaning::Measure;
use super::scope::Scope;
use super::script::ClaimLine;
use super::temporal::total;
use crate::diagnostic::Diagnostic;
use crate::scenario::{self, BooleanExpression, Claim, ClaimPart, Formula, Gated, Limit, Margin, duration};
use crate::source::Span;
use crate::syntax::TemporalWord;

use super::measure::quantity;
use super::real;
use super::running::{latest_start, latest_start_of};

/// The most steps of which a claim keeps values; more would not fit into memory with the run.
const MOST_STEPS_AHEAD: u64 = 10_000_000;

impl Scope<'_, '_> {
    /// The claims in the script's order.
    pub fn claims(&self, stop_tick: Option<u64>) -> Vec<Claim> {
        let claim = |claim: &Placed<ClaimLine<'_>>| self.at(claim.frame).claim(&claim.part, stop_tick);
        self.script.claims.iter().filter_map(claim).collect()
    }

    fn claim(&self, line: &ClaimLine<'_>, stop_tick: Option<u64>) -> Option<Claim> {
        let ClaimLine { name, span, claim } = line;
        let condition = self.condition(claim)?;
        let mut bounds = Vec::new();
        condition.collect_bounds(false, &mut bounds);
        self.check_dimensions(&bounds);
        let windows = condition.reach();
        if stop_tick.is_some_and(|stop| total(&windows) > stop) {
            self.report(self.too_long((name, *span), &windows));
        } else if total(&windows) > MOST_STEPS_AHEAD {
            self.report(too_far((name, *span), total(&windows)));
        }
        self.check_starts((name, *span), &condition, (0, stop_tick.unwrap_or(u64::MAX)));
        let limit = match bounds.as_slice() {
            [(bound, negated)] => bound.limit.map(|limit| Limit { upper: limit.upper != *negated, ..limit }),
            _ => None,
        };
        let (mut parts, mut gates) = (Vec::new(), Vec::new());
        self.describe(&condition, "", (&mut parts, &mut gates));
        // A gate counts where the run is long enough for what it opens.
        let judged = stop_tick.map_or(0, |stop| stop.saturating_sub(total(&windows)));
        if let (1.., Some(grid)) = (total(&windows), self.grid()) {
            let until =
                format!(", up to {}, the last time that is judged", duration(judged.saturating_mul(grid.step_ns)));
            gates.iter_mut().for_each(|gate| gate.push_str(&until));
        }
        Some(Claim {
            name: name.clone(),
            text: self.text(claim.span),
            part_file: self.script.frames.is_in_part(self.frame()).then(|| self.file_name(*span).to_owned()),
            line: self.line(*span),
            formula: condition.formula(false),
            unit: bounds.first().map(|(bound, _)| bound.unit.clone()),
            limit,
            parts,
            gates,
        })
    }

    /// That no running value is asked for before its first time, by a condition that is asked for from a tick on.
    fn check_starts(&self, name: (&str, Span), condition: &Condition, (from, stop): (u64, u64)) {
        let start = match condition {
            Condition::Plain(plain, _) => latest_start_of(plain),
            Condition::Bound(bound) => latest_start(&bound.margin.value),
            Condition::Not(of) => return self.check_starts(name, of, (from, stop)),
            Condition::And(parts) | Condition::Or(parts) => {
                return parts.iter().for_each(|part| self.check_starts(name, part, (from, stop)));
            }
            Condition::Temporal(claim) => {
                let is_last = claim.word == TemporalWord::Finally;
                let from = if is_last { stop } else { from.saturating_add(claim.window.from) };
                return self.check_starts(name, &claim.body, (from, stop));
            }
            Condition::Implies { gate, then, .. } => {
                return [gate, then].into_iter().for_each(|part| self.check_starts(name, part, (from, stop)));
            }
            Condition::Until(until) => {
                self.check_starts(name, &until.body, (from, stop));
                return self.check_starts(name, &until.gate, (from.saturating_add(until.window.from), stop));
            }
        };
        let Some((start, _)) = start.filter(|(start, _)| *start > from) else { return };
        let step_ns = self.grid().map_or(0, |grid| grid.step_ns);
        let is_too_late = start > stop;
        let [from, start] = [from, start].map(|tick| duration(tick.saturating_mul(step_ns)));
        let (claim, span) = name;
        let message = format!("`{claim}` asks from {from} on for a running value whose samples count from {start} on");
        let error = Diagnostic::error("E09", span, message);
        self.report(if is_too_late {
            error.help(format!("give it an earlier first time, or write `stop {start}`"))
        } else {
            error.help(format!("ask for it at the end, `finally …`, or later: `always after {start} …`"))
        });
    }

    /// What reports say of the atoms and gates of a condition, in the order in which formulas have them.
    fn describe(&self, condition: &Condition, window: &str, into: (&mut Vec<ClaimPart>, &mut Vec<String>)) {
        let (parts, gates) = into;
        let within = |head: Span| format!("{window} {}", self.text(head)).trim().to_owned();
        match condition {
            Condition::Plain(..) | Condition::Bound(_) => {
                let mut ports = BTreeSet::new();
                self.of_formula(&condition.formula(false), &mut ports);
                let span = match condition {
                    Condition::Bound(bound) => Some(bound.span),
                    Condition::Plain(_, span) => *span,
                    _ => None,
                };
                let text = span.map_or_else(String::new, |span| self.text(span));
                let signals = ports.into_iter().map(|port| self.port_name(port)).collect();
                parts.push(ClaimPart { text, window: window.to_owned(), signals });
            }
            Condition::Not(of) => self.describe(of, window, (parts, gates)),
            Condition::And(all) | Condition::Or(all) => {
                all.iter().for_each(|part| self.describe(part, window, (parts, gates)));
            }
            Condition::Temporal(claim) => self.describe(&claim.body, &within(claim.head), (parts, gates)),
            Condition::Implies { gate, gate_span, then } => {
                self.describe(gate, window, (parts, gates));
                self.describe(then, window, (parts, gates));
                gates.push(format!("{} never happened", self.text(*gate_span)));
            }
            Condition::Until(until) => {
                let window = within(until.head);
                self.describe(&until.gate, &window, (parts, gates));
                self.describe(&until.body, &window, (parts, gates));
                gates.push(format!("`until` ended at once: {}", self.text(until.gate_span)));
            }
        }
    }

    fn check_dimensions(&self, bounds: &[(&Bound, bool)]) {
        let Some(((first, _), rest)) = bounds.split_first() else { return };
        let agrees = |bound: &Bound| match (first.measure, bound.measure) {
            (Measure::Known(left), Measure::Known(right)) => left.without_angle() == right.without_angle(),
            (left, right) => left == right,
        };
        let Some((other, _)) = rest.iter().find(|(bound, _)| !agrees(bound)) else { return };
        let shown = |bound: &Bound| match bound.measure {
            _ if !bound.unit.name.is_empty() => bound.unit.name.clone(),
            Measure::Known(dimension) => quantity(dimension),
            Measure::Undeclared => "no unit".to_owned(),
        };
        let message = format!("this claim would mix a margin in {} with a margin in {}", shown(first), shown(other));
        let error = Diagnostic::error("E10", first.span, message).saying(format!("margin in {}", shown(first)));
        let error = error.label(other.span, format!("margin in {}", shown(other)));
        let advice = match (&first.scaled, &other.scaled) {
            (Some(left), Some(right)) => format!("make two asserts, or compare plain numbers: `{left}` and `{right}`"),
            _ => "make two asserts, or compare plain numbers".to_owned(),
        };
        self.report(error.help(advice));
    }

    fn too_long(&self, (name, span): (&str, Span), windows: &[(u64, &str)]) -> Diagnostic {
        let step_ns = self.grid().map_or(0, |grid| grid.step_ns);
        let shown = |ticks: u64| duration(ticks.saturating_mul(step_ns));
        let parts: Vec<_> = windows.iter().map(|(ticks, word)| format!("{} {word}", shown(*ticks))).collect();
        let sum = if parts.len() > 1 { format!(" ({})", parts.join(" + ")) } else { String::new() };
        let ahead = shown(total(windows));
        let stop = self.script.stop.map_or(Span::default(), |stop| stop.span);
        let message = format!("`{name}` looks {ahead} ahead{sum}, the run ends at {}", self.text(stop));
        let error = Diagnostic::error("E09", span, message).label(stop, "the end");
        error.help(format!("shorten the claim or write `stop {ahead}`"))
    }
}

fn too_far((name, span): (&str, Span), steps: u64) -> Diagnostic {
    let message = format!("`{name}` looks {steps} steps ahead, and at most {MOST_STEPS_AHEAD} are kept");
    Diagnostic::error("E39", span, message).help("shorten the claim, or write a longer `step`")
}

impl Condition {
    /// All comparisons of reals outside gates, each with whether it is under an odd number of `not`.
    fn collect_bounds<'c>(&'c self, negated: bool, bounds: &mut Vec<(&'c Bound, bool)>) {
        match self {
            Self::Plain(..) => {}
            Self::Bound(bound) => bounds.push((bound, negated)),
            Self::Not(of) => of.collect_bounds(!negated, bounds),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.collect_bounds(negated, bounds)),
            Self::Temporal(claim) => claim.body.collect_bounds(negated, bounds),
            Self::Implies { then, .. } => then.collect_bounds(negated, bounds),
            Self::Until(until) => until.body.collect_bounds(negated, bounds),
        }
    }

    /// The formula, with negations moved inward to the comparisons.
    fn formula(&self, negated: bool) -> Formula {
        let all = |parts: &[Self]| parts.iter().map(|part| part.formula(negated)).collect();
        match self {
            Self::Plain(condition, _) if negated => Formula::Condition(denied(condition)),
            Self::Plain(condition, _) => Formula::Condition(condition.clone()),
            Self::Bound(Bound { margin, .. }) if negated => {
                Formula::Margin(Margin { value: real::negate(margin.value.clone()), strict: !margin.strict })
            }
            Self::Bound(Bound { margin, .. }) => Formula::Margin(margin.clone()),
            Self::Not(of) => of.formula(!negated),
            Self::And(parts) if negated => Formula::Or(all(parts)),
            Self::And(parts) => Formula::And(all(parts)),
            Self::Or(parts) if negated => Formula::And(all(parts)),
            Self::Or(parts) => Formula::Or(all(parts)),
            Self::Implies { gate, then, .. } => {
                let (gate, body) = (Box::new(gate.formula(!negated)), Box::new(then.formula(negated)));
                Formula::Gated(Gated { any: !negated, gate, body })
            }
            Self::Until(Until { window, body, gate, .. }) => {
                let (body, gate) = (Box::new(body.formula(negated)), Box::new(gate.formula(negated)));
                Formula::Until(scenario::Until { any: !negated, window: *window, body, gate })
            }
            Self::Temporal(claim) => {
                let body = Box::new(claim.body.formula(negated));
                if claim.word == TemporalWord::Finally {
                    return Formula::Finally(body);
                }
                if (claim.word == TemporalWord::Eventually) == negated {
                    Formula::Always(claim.window, body)
                } else {
                    Formula::Eventually(claim.window, body)
                }
            }
        }
    }
}

/// `not condition`, where two negations are none.
fn denied(condition: &BooleanExpression) -> BooleanExpression {
    match condition {
        BooleanExpression::Not(of) => (**of).clone(),
        other => opposite(other.clone()),
    }
}
