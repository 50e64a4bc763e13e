//! That no two windows touch one port at one time, as far as that is known before the run.

use std::collections::BTreeMap;

use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Port, Stage};
use crate::source::Span;

/// One port under one action.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    /// The port.
    pub port: Port,
    /// Where the action acts.
    pub stage: Stage,
    /// The tick at which the window opens.
    pub from: u64,
    /// The tick at which it closes; `None` if it stays.
    pub until: Option<u64>,
    /// The place of the action.
    pub span: Span,
    /// Index of the window in the script.
    pub window: usize,
    /// Index of the action among those of all windows.
    pub action: usize,
}

impl Scope<'_, '_> {
    /// Refuses two windows that are open at one time over one port, reported once for an action; `touches` are in the script's
    /// order.
    pub fn check_overlap(&self, touches: &[Touch]) {
        let mut by_port: BTreeMap<Port, Vec<Touch>> = BTreeMap::new();
        for touch in touches {
            by_port.entry(touch.port).or_default().push(*touch);
        }
        by_port.retain(|_, touches| may_clash(touches));
        let mut last_refused = None;
        for late in touches.iter().filter(|late| by_port.contains_key(&late.port)) {
            if last_refused == Some(late.action) {
                continue;
            }
            let mut before = by_port[&late.port].iter().take_while(|early| early.action < late.action);
            if let Some(early) = before.find(|early| clashes(early, late)) {
                last_refused = Some(late.action);
                self.report(self.overlap(early, late));
            }
        }
    }

    fn overlap(&self, early: &Touch, late: &Touch) -> Diagnostic {
        let name = self.port_name(late.port);
        let are_sets = (early.stage, late.stage) == (Stage::Set, Stage::Set);
        let (message, here) = match (are_sets, early.window == late.window) {
            (true, true) => (format!("one window sets `{name}` twice"), "set here too"),
            (true, false) => (format!("two windows set `{name}` at one time"), "set here too"),
            (false, false) => (format!("two windows act on `{name}` at one time"), "here too"),
            (false, true) => {
                (format!("one window has two faults of `{name}` that exclude each other"), "the other one")
            }
        };
        let error = Diagnostic::error("E35", late.span, message).label(early.span, here);
        if are_sets && early.window == late.window {
            error.help("leave one of them")
        } else if are_sets {
            error.help("let one end before the other begins, or set it in one place")
        } else if early.window == late.window {
            error
                .help("leave one of them: each window has one `bias`, one `noise`, one `loss` or `freeze`, one `delay`")
        } else {
            error.help("let one end before the other begins, or write both into one window")
        }
    }
}

/// Whether any two actions on one port may clash: whether one begins before another has ended, or with it.
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

/// What stays is no window: a later one replaces it, and a window over it returns to it. One window may act on a port at
/// several stages.
fn clashes(early: &Touch, late: &Touch) -> bool {
    if early.port != late.port {
        return false;
    }
    if early.window == late.window {
        return early.stage == late.stage;
    }
    match (early.until, late.until) {
        (Some(early_end), Some(late_end)) => early.from < late_end && late.from < early_end,
        (Some(end), None) => early.from <= late.from && late.from < end,
        (None, Some(end)) => late.from < early.from && early.from < end,
        (None, None) => false,
    }
}
