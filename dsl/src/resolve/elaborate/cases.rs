//! `sweep`: the axes of a script, and the parameters of the case that the command line asks for.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::Elaboration;
use crate::diagnostic::Diagnostic;
use crate::random::Draws;
use crate::resolve::frame::FrameId;
use crate::resolve::meaning::Meaning;
use crate::resolve::sweep::Values;
use crate::scenario::{Case, Sweep};
use crate::source::Span;
use crate::syntax::Axis;

/// The most cases that a sweep may have: their number stays exact as a floating-point number.
const MOST_CASES: u64 = 1 << 53;

/// The values of the swept parameters in one case.
pub(in crate::resolve) type CaseValues<'a> = BTreeMap<&'a str, Rc<Meaning>>;

impl<'a> Elaboration<'a> {
    /// Checks the sweep, and returns the values of the case that is asked for; `None` if none is, or something is wrong.
    pub(super) fn sweep(&mut self) -> Option<CaseValues<'a>> {
        let case = self.request.case;
        let Some(statement) = self.script.sweep else {
            if let Some(case) = case {
                let error = Diagnostic::error("E25", case.place, "this script has no `sweep`, so it has no cases");
                self.found.push(error.help("leave `--case` out"));
            }
            return None;
        };
        let errors = self.found.len();
        let axes = self.axes();
        let counts = axes.iter().filter_map(|(_, values)| values.count());
        let cases = counts.clone().try_fold(1, u64::checked_mul).filter(|cases| *cases <= MOST_CASES);
        let is_whole = self.found.len() == errors;
        if is_whole && counts.clone().next().is_none() {
            let error = Diagnostic::error("E25", statement.span, "a sweep of draws alone has a single case");
            self.found.push(error.help("add an axis that counts the cases, for example `seed in 1..200`"));
        }
        let Some(cases) = cases else {
            let error = Diagnostic::error("E39", statement.span, "this sweep has more cases than can be counted");
            self.found.push(error.help("the cases are all combinations of the values after `in`: give fewer values"));
            return None;
        };
        if self.found.len() > errors {
            return None;
        }
        self.script.cases = Some(Sweep { cases, case: None });
        let draws = axes.iter().any(|(_, values)| values.count().is_none());
        if draws && !axes.iter().any(|(axis, _)| axis.name.text == "seed") {
            let used = self.with_scope(FrameId::SCRIPT, |scope| scope.place_of_seed());
            self.used.extend(used);
        }
        let case = case?;
        if case.number >= cases {
            let message = format!("the sweep of this script has {cases} cases, from 0 to {}", cases - 1);
            self.found.push(Diagnostic::error("E38", case.place, message).help("choose one of them"));
            return None;
        }
        self.refuse_set_axes(&axes, draws);
        if self.found.len() > errors {
            return None;
        }
        let seed = if draws { self.with_scope(FrameId::SCRIPT, |scope| scope.whole_seed("draws"))? } else { 0 };
        let sets_seed = || self.request.settings.iter().any(|setting| setting.name.text == "seed");
        let sweeps_seed = || axes.iter().any(|(axis, _)| axis.name.text == "seed");
        let draw_seed = Some(seed).filter(|_| draws && sweeps_seed() && sets_seed());
        self.script.cases = Some(Sweep { cases, case: Some(Case { number: case.number, draw_seed }) });
        Some(values_of(case.number, cases, &axes, seed))
    }

    /// The axes whose values are known.
    fn axes(&mut self) -> Vec<(&'a Axis, Values)> {
        let places = self.places_of_axes();
        let mut first_of = BTreeMap::new();
        let mut known = Vec::new();
        for axis in self.script.axes() {
            if let Some(first) = first_of.insert(axis.name.text.as_str(), axis.name.span) {
                let error = Diagnostic::error("E24", axis.name.span, format!("`{}` has two axes", axis.name.text));
                self.found.push(error.label(first, "the first").help("write all its values in one list"));
                continue;
            }
            let others = std::mem::take(&mut self.used);
            let values = self.with_scope(FrameId::SCRIPT, |scope| scope.axis_values(axis));
            let used = std::mem::replace(&mut self.used, others);
            let swept = used.iter().find_map(|place| places.get(place).copied());
            self.used.extend(used);
            if let Some(swept) = swept {
                let name = axis.name.text.as_str();
                let message = if swept == name {
                    format!("the values of `{name}` depend on `{name}` itself")
                } else {
                    format!("the values of `{name}` depend on `{swept}`, which is swept")
                };
                let error = Diagnostic::error("E27", axis.values.span, message);
                self.found.push(error.help("write numbers, or names of what is the same in all cases"));
                continue;
            }
            if let Some(values) = values
                && self.with_scope(FrameId::SCRIPT, |scope| scope.fit_parameter(axis, &values))
            {
                known.push((axis, values));
            }
        }
        known
    }

    /// Whether rounds of loops, indices or names depend on a swept parameter.
    pub(super) fn shape_is_swept(&self) -> bool {
        let places = self.places_of_axes();
        self.used.iter().any(|place| places.contains_key(place))
    }

    /// The swept parameters, by the places under which their uses are noted.
    fn places_of_axes(&self) -> BTreeMap<Span, &'a str> {
        let place = |axis: &'a Axis| {
            let declared = self.script.frames.look_up(FrameId::SCRIPT, &axis.name.text);
            (declared.map_or(axis.name.span, |found| found.part.span()), axis.name.text.as_str())
        };
        self.script.axes().iter().map(place).collect()
    }

    /// Refuses a setting of the command line for a parameter that the case gives a value. That of `seed` is the seed of
    /// the draws, if there are any.
    fn refuse_set_axes(&mut self, axes: &[(&'a Axis, Values)], draws: bool) {
        for setting in self.request.settings {
            let name = setting.name.text.as_str();
            if !(draws && name == "seed") && axes.iter().any(|(axis, _)| axis.name.text == name) {
                let message = format!("`{name}` is swept, and the case gives it a value");
                let error = Diagnostic::error("E37", setting.name.span, message);
                self.found.push(error.help("leave out `--set` of this parameter, or `--case`"));
            }
        }
    }
}

/// The parameters of a case: of the axes that count, the first is the slowest.
fn values_of<'a>(case: u64, cases: u64, axes: &[(&'a Axis, Values)], seed: i64) -> CaseValues<'a> {
    let mut rest = cases;
    let value = |(axis, values): &(&'a Axis, Values)| {
        let count = values.count().unwrap_or(1);
        rest /= count;
        let name = axis.name.text.as_str();
        (name, values.of_case(case / rest % count, case, Draws::new(seed, name, 0)))
    };
    axes.iter().map(value).collect()
}
