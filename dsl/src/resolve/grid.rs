//! Times as ticks: what was written in seconds has to fall on the grid of `step`.

use super::fit::with_unit;
use super::meaning::{Measure, Real};
use super::scope::Scope;
use super::script::Declared;
use crate::diagnostic::Diagnostic;
use crate::scenario::duration;
use crate::source::Span;
use crate::syntax::Expression;
use fmi2::units::Dimension;

/// The grid of communication points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    /// The communication step in nanoseconds.
    pub step_ns: u64,
}

/// How far the grid has been computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    /// Not yet needed.
    NotYet,
    /// Needed while `step` itself is computed.
    InWork,
    /// Computed; `None` if the script has no usable `step`.
    Yes(Option<Grid>),
}

/// Whether a time may be zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Least {
    /// Zero is a time.
    Zero,
    /// A period or duration is longer than nothing.
    OneTick,
}

/// The dimension of time.
pub(super) const SECOND: Dimension = Dimension([0, 0, 1, 0, 0, 0, 0, 0]);

/// A time as written.
#[derive(Clone, Debug)]
struct Written {
    ns: u64,
    /// Name and nanoseconds of the unit it was written in.
    unit: Option<(String, f64)>,
}

impl Written {
    fn show(&self, ns: u64) -> String {
        match &self.unit {
            Some((name, unit_ns)) => format!("{} {name}", ns as f64 / unit_ns),
            None => duration(ns),
        }
    }
}

impl Scope<'_, '_> {
    /// The grid; `None` if the script has no usable `step`.
    pub fn grid(&self) -> Option<Grid> {
        let step = self.script.step?;
        match self.grid.get() {
            Known::Yes(grid) => grid,
            Known::InWork => {
                let error = Diagnostic::error("E28", step.span, "`step` depends on a time that counts in steps");
                self.refuse(error.help("write it as a number, for example `step 10 ms`"))
            }
            Known::NotYet => {
                self.grid.set(Known::InWork);
                let written = self.nanoseconds(step, Least::OneTick);
                let grid = written.map(|written| Grid { step_ns: written.ns });
                self.grid.set(Known::Yes(grid));
                grid
            }
        }
    }

    /// The tick at which the run ends.
    pub fn stop_tick(&self) -> Option<u64> {
        self.ticks(self.script.stop?, Least::OneTick)
    }

    /// The period of each instance in ticks; `None` if one of them is not usable.
    pub fn periods(&self) -> Option<Vec<u64>> {
        let period = |instance: &Declared<'_>| match instance.every {
            Some(every) => self.at(instance.frame).ticks(every, Least::OneTick),
            None => Some(1),
        };
        let periods: Vec<_> = self.script.instances.iter().map(period).collect();
        periods.into_iter().collect()
    }

    /// A time in ticks.
    pub fn ticks(&self, time: &Expression, least: Least) -> Option<u64> {
        let written = self.nanoseconds(time, least)?;
        self.on_grid(&written, least, time.span)
    }

    fn on_grid(&self, time: &Written, least: Least, span: Span) -> Option<u64> {
        let step_ns = self.grid()?.step_ns;
        if time.ns.is_multiple_of(step_ns) {
            return Some(time.ns / step_ns);
        }
        let below = time.ns / step_ns * step_ns;
        let finer = gcd(time.ns, step_ns);
        let mut neighbours = vec![time.show(below + step_ns), format!("`step {}`", duration(finer))];
        if below > 0 || least == Least::Zero {
            neighbours.insert(0, time.show(below));
        }
        let [first @ .., last] = neighbours.as_slice() else { unreachable!("there are two proposals at least") };
        let message = format!("{} does not fall on the {} grid", time.show(time.ns), duration(step_ns));
        let error = Diagnostic::error("E08", span, message).help(format!("{}, or {last}", first.join(", ")));
        self.refuse(match self.script.step {
            Some(step) => error.label(step.span, "the grid"),
            None => error,
        })
    }

    /// A span of time in seconds, which need not be on the grid.
    pub fn seconds(&self, time: &Expression) -> Option<f64> {
        let written = self.nanoseconds(time, Least::Zero)?;
        Some(written.ns as f64 / 1e9)
    }

    fn nanoseconds(&self, time: &Expression, least: Least) -> Option<Written> {
        let meaning = self.evaluate(time)?;
        let real = self.real(&meaning, time.span)?;
        self.real_nanoseconds(&real, least, time.span)
    }

    fn real_nanoseconds(&self, time: &Real, least: Least, span: Span) -> Option<Written> {
        if time.measure != Measure::Known(SECOND) {
            let what = format!("expected a time, found {}", self.described(time));
            let help = if time.measure == Measure::PLAIN && time.constant().is_some() {
                with_unit(&self.text(span), "s")
            } else {
                String::new()
            };
            let error = Diagnostic::error("E02", span, what);
            return self.refuse(if help.is_empty() { error } else { error.help(help) });
        }
        let Some(seconds) = time.constant() else {
            return self.refuse(self.must_be_known(span));
        };
        let ns = seconds * 1e9;
        let nearest = ns.round();
        let unit = time.unit.as_ref().map(|unit| (unit.unit.name.clone(), unit.unit.factor * 1e9));
        let text = self.text(span);
        let out_of_range =
            |message: String, help: &str| self.refuse(Diagnostic::error("E38", span, message).help(help));
        if !(0.0..9e18).contains(&nearest) {
            return out_of_range(
                format!("`{text}` is not a time of a run"),
                "a time counts from the start and is at most 285 years",
            );
        }
        if least == Least::OneTick && nearest == 0.0 {
            return out_of_range(format!("`{text}` is no time at all"), "this time has to be longer than zero");
        }
        if (ns - nearest).abs() > 1e-3 + ns * 1e-15 {
            let message = format!("`{text}` is not a whole number of nanoseconds");
            let near = format!("times are counted in nanoseconds, the nearest is `{nearest} ns`");
            return self.refuse(Diagnostic::error("E08", span, message).help(near));
        }
        Some(Written { ns: nearest as u64, unit })
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
