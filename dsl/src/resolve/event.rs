//! `at`, `when`, `while` and `stop when`: what opens and closes windows, and what happens in them.

use super::assign::Role;
use super::fit::{Fitted, Meeting};
use super::frame::{FrameId, Placed};
use super::grid::Least;
use super::overlap::Touch;
use super::scope::Scope;
use super::script::Opens;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Action, Condition, Event, Set, StopWhen, Trigger};
use crate::source::Span;
use crate::syntax::{self, Expression, Path, StatementKind, Window};

/// When a window opens, and for how many ticks.
type Timing = (Trigger, Option<u64>);

impl Scope<'_, '_> {
    /// The windows in the script's order.
    pub fn events(&self, stop_tick: Option<u64>) -> Vec<Event> {
        let (mut touches, mut events, mut actions_before) = (Vec::new(), Vec::new(), 0);
        for (index, &Placed { frame, part: (opens, window) }) in self.script.windows.iter().enumerate() {
            let scope = self.at(frame);
            let timing = scope.timing(opens, window, stop_tick);
            let (mut actions, mut own_touches) = (Vec::new(), Vec::new());
            // When a condition opens windows is known in the run only; here such a window can clash with itself.
            let (from, until) = match timing {
                Some((Trigger::At(from), lasting)) => (from, lasting.map(|ticks| from.saturating_add(ticks))),
                _ => (0, None),
            };
            for (span, made) in window.actions.iter().flat_map(|action| scope.actions(action)) {
                let touch = |action: &Action, port| Touch {
                    port,
                    stage: action.stage(),
                    from,
                    until,
                    span,
                    window: index,
                    action: actions_before,
                };
                own_touches.extend(
                    made.iter().flat_map(|action| action.targets().iter().map(move |&port| touch(action, port))),
                );
                actions_before += 1;
                actions.extend(made);
            }
            let Some((trigger, lasting)) = timing else { continue };
            match trigger {
                Trigger::At(_) => touches.extend(own_touches),
                Trigger::When(_) | Trigger::While(_) => self.check_overlap(&own_touches),
            }
            let (statement, condition) = (scope.statement(window.trigger.span), scope.window_text(window));
            events.push(Event { trigger, lasting, actions, statement, condition });
        }
        self.check_overlap(&touches);
        events
    }

    /// `stop when`
    pub fn stop_when(&self) -> Option<StopWhen> {
        let StatementKind::StopWhen { condition, held } = &self.script.stop_when?.kind else { return None };
        let slot = self.at(FrameId::SCRIPT).followed(condition, held.as_ref())?;
        Some(StopWhen { condition: slot, text: self.with_held(condition, held.as_ref()) })
    }

    /// What one action of the script does, with the place that errors point to; each kind of a `fault` is by itself.
    fn actions(&self, action: &syntax::Action) -> Vec<(Span, Vec<Action>)> {
        match action {
            syntax::Action::Set { target, value, .. } => {
                vec![(target.span, self.set(target, value).into_iter().map(Action::Set).collect())]
            }
            syntax::Action::Fault { target, kinds, .. } => {
                let faults = self.faults(target, kinds).into_iter();
                faults.map(|(span, fault)| (span, vec![Action::Fault(fault)])).collect()
            }
        }
    }

    fn timing(&self, opens: Opens, window: &Window, stop_tick: Option<u64>) -> Option<Timing> {
        let trigger = match opens {
            Opens::At => self.opening(window, stop_tick).map(Trigger::At),
            Opens::When => self.followed(&window.trigger, window.held.as_ref()).map(Trigger::When),
            Opens::While => self.followed(&window.trigger, window.held.as_ref()).map(Trigger::While),
        };
        let lasting = match &window.lasting {
            Some(lasting) => self.ticks(lasting, Least::OneTick).map(Some),
            None => Some(None),
        };
        Some((trigger?, lasting?))
    }

    /// The slot of a condition that must have held for a time.
    fn followed(&self, condition: &Expression, held: Option<&Expression>) -> Option<usize> {
        let held_ticks = match held {
            Some(held) => self.ticks(held, Least::OneTick),
            None => Some(0),
        };
        let is = self.condition(condition).and_then(|meant| self.momentary(&meant, condition.span));
        Some(self.condition_slot(Condition { is: is?, held_ticks: held_ticks? }))
    }

    fn opening(&self, window: &Window, stop_tick: Option<u64>) -> Option<u64> {
        let from = self.ticks(&window.trigger, Least::Zero)?;
        if let Some(stop) = stop_tick.filter(|&stop| from >= stop) {
            let at = self.text(window.trigger.span);
            let when = if from == stop { "opens when the run ends" } else { "opens after the run has ended" };
            let warning = Diagnostic::warning("W04", window.trigger.span, format!("what happens at {at} {when}"));
            let warning = match self.script.stop {
                Some(stop) => warning.label(stop.span, "the end"),
                None => warning,
            };
            self.report(warning.help("nothing will come of it: choose an earlier time or a later `stop`"));
        }
        Some(from)
    }

    fn set(&self, target: &Path, value: &Expression) -> Vec<Set> {
        let at = Meeting { source: value.span, target: target.span, arrow: None };
        let signal = self.signal(target);
        let meaning = self.evaluate_for(value, signal.as_ref());
        let signal = signal.and_then(|signal| self.touchable(Role::Set, signal, at));
        let assigned = match (meaning, signal) {
            (Some(meaning), Some(signal)) => self.assigned_ports(&meaning, &signal, at),
            _ => None,
        };
        let mut sets = Vec::new();
        for (target, fitted) in assigned.unwrap_or_default() {
            let Fitted::Drive(value) = fitted else {
                let error = Diagnostic::error("E21", at.source, "a file is given to a unit before the run");
                self.report(error.help("write it in the braces of the fmu line"));
                return Vec::new();
            };
            sets.push(Set { target, value });
        }
        sets
    }

    /// File and line, and which part or round it is: `uav.scn:12 of wing[1]`, `a.scn:7 of [2]`.
    fn statement(&self, span: Span) -> String {
        let place = format!("{}:{}", self.file_name(span), self.line(span));
        let block = self.script.frames.full_name(self.frame(), "");
        if block.is_empty() { place } else { format!("{place} of {}", block.trim_end_matches('.')) }
    }

    fn window_text(&self, window: &Window) -> String {
        self.with_held(&window.trigger, window.held.as_ref())
    }

    fn with_held(&self, condition: &Expression, held: Option<&Expression>) -> String {
        let text = self.text(condition.span);
        held.map_or(text.clone(), |held| format!("{text} held {}", self.text(held.span)))
    }
}
