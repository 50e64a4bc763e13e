//! `at` windows: what they set, and that no two touch one port.

use std::collections::BTreeMap;

use super::assign::Role;
use super::fit::{Fitted, Meeting};
use super::frame::Placed;
use super::grid::Least;
use super::scope::Scope;
use super::script::not_yet;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Event, Port, Set};
use crate::source::Span;
use crate::syntax::{Action, Expression, Path, Window};

/// One port under one `set`.
#[derive(Clone, Copy)]
struct Touch {
    port: Port,
    from: u64,
    until: Option<u64>,
    span: Span,
    /// Index of the window in the script.
    window: usize,
    /// Index of the `set` among those of all windows.
    set: usize,
}

impl Scope<'_, '_> {
    /// The windows in the script's order.
    pub fn events(&self, stop_tick: Option<u64>) -> Vec<Event> {
        let mut touches: Vec<Touch> = Vec::new();
        let mut events = Vec::new();
        let mut sets_before = 0;
        for (index, &Placed { frame, part: window }) in self.script.windows.iter().enumerate() {
            let scope = self.at(frame);
            let times = scope.times(window, stop_tick);
            let mut sets = Vec::new();
            for action in &window.actions {
                match action {
                    Action::Fault { span, .. } => self.report(not_yet(*span, "`fault`")),
                    Action::Set { target, value, .. } => {
                        let assigned = scope.set(target, value);
                        if let Some((from, until)) = times {
                            let (span, window, set) = (target.span, index, sets_before);
                            let touch = |set_: &Set| Touch { port: set_.target, from, until, span, window, set };
                            touches.extend(assigned.iter().map(touch));
                        }
                        sets_before += 1;
                        sets.extend(assigned);
                    }
                }
            }
            if let Some((from, until)) = times {
                events.push(Event::at(from, until.map(|until| until - from), sets));
            }
        }
        self.check_overlap(&touches);
        events
    }

    fn times(&self, window: &Window, stop_tick: Option<u64>) -> Option<(u64, Option<u64>)> {
        let from = self.ticks(&window.trigger, Least::Zero);
        let lasting = match &window.lasting {
            Some(lasting) => self.ticks(lasting, Least::OneTick).map(Some),
            None => Some(None),
        };
        let (from, lasting) = (from?, lasting?);
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
        Some((from, lasting.map(|ticks| from.saturating_add(ticks))))
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

    /// Refuses two windows that are open at one time over one port, reported once for a `set`; `touches` are in the script's
    /// order.
    fn check_overlap(&self, touches: &[Touch]) {
        let mut by_port: BTreeMap<Port, Vec<Touch>> = BTreeMap::new();
        for touch in touches {
            by_port.entry(touch.port).or_default().push(*touch);
        }
        by_port.retain(|_, touches| may_clash(touches));
        let mut last_refused = None;
        for late in touches.iter().filter(|late| by_port.contains_key(&late.port)) {
            if last_refused == Some(late.set) {
                continue;
            }
            let mut before = by_port[&late.port].iter().take_while(|early| early.set < late.set);
            if let Some(early) = before.find(|early| clashes(early, late)) {
                last_refused = Some(late.set);
                let message = format!("two windows set `{}` at one time", self.port_name(late.port));
                let error = Diagnostic::error("E35", late.span, message).label(early.span, "set here too");
                self.report(error.help("let one end before the other begins, or set it in one place"));
            }
        }
    }
}

/// Whether any two `set`s of one port may clash: whether one opens before another has ended, or with it.
fn may_clash(touches: &[Touch]) -> bool {
    let mut in_time: Vec<_> = touches.iter().map(|touch| (touch.from, touch.until)).collect();
    in_time.sort_unstable();
    let mut last_end = 0;
    in_time.iter().enumerate().any(|(at, (from, until))| {
        let ended = last_end;
        last_end = last_end.max(until.unwrap_or_default());
        at > 0 && (*from < ended || in_time[at - 1].0 == *from)
    })
}

/// A `set` that stays is no window: a later one replaces it, and a window over it returns to it.
fn clashes(early: &Touch, late: &Touch) -> bool {
    if early.port != late.port {
        return false;
    }
    if early.window == late.window {
        return true;
    }
    match (early.until, late.until) {
        (Some(early_end), Some(late_end)) => early.from < late_end && late.from < early_end,
        (Some(end), None) => early.from <= late.from && late.from < end,
        (None, Some(end)) => late.from < early.from && early.from < end,
        (None, None) => false,
    }
}
