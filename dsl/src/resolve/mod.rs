//! Resolves a syntax tree to a scenario: names, types, units of measure, times and claims, checked against the units'
//! descriptions. Next on the walk: `scenario.rs`.
//!
//! One pass finds all errors of a script, and none is a consequence of another: a part without meaning is `None`, and what
//! depends on it reports nothing. The passes, in order: `elaborate` sorts the statements of loops
//! and parts into `script`, `parameter` fixes the parameters, `grid` the times, then come `preset`, `wire`, `event` and `claim` over
//! `expression`, and at last `wave`, `initial` and `column` over the connections.
//!
//! | code | what is wrong |
//! |------|---------------|
//! | E01 | no such name: script name, variable, function, parameter of `--set` |
//! | E02 | dimensions differ |
//! | E03 | an input with two drivers, a start value given twice |
//! | E04 | an output as a target, an input as a source |
//! | E05 | a variable that cannot be set there: its causality or variability forbids it |
//! | E06 | `=>` in a circle |
//! | E07 | `=>` between periods of which neither divides the other; `=>` without a unit or with `rises` on its left |
//! | E08 | a time off the grid of `step` |
//! | E09 | a claim that looks past the end of the run, or asks for a running value before its first time |
//! | E10 | margins of different dimensions in one claim |
//! | E11 | not a unit of measure, or a name of the script too |
//! | E12 | a temporal word over `and`, `or`, `implies` or `until` without parentheses |
//! | E21 | types do not agree |
//! | E22 | shapes do not agree: members, counts, indices |
//! | E23 | a group of several units of measure in a computation |
//! | E24 | a name declared twice, or reserved |
//! | E25 | a statement or clause that is missing or repeated; a case without a sweep |
//! | E26 | a unit that was not found or cannot be used |
//! | E27 | a value that must be known before the run; values of an axis that depend on a swept parameter |
//! | E28 | names defined by each other |
//! | E29 | a comparison that cannot be read: `==` of reals without `±`, a chain that changes direction |
//! | E30 | a temporal word outside claims, `finally` inside of another word, a running value for a unit |
//! | E31 | a function with the wrong arguments; a distribution outside of a sweep, or none behind `~` |
//! | E32 | a temperature scale with an offset in a sum, product or tolerance; a difference instead of a point on a scale |
//! | E33 | a unit of measure with two meanings, `in` or `as` where they do not fit |
//! | E34 | no such item of an enumeration |
//! | E35 | two windows over one port |
//! | E36 | initial values that wait for each other |
//! | E37 | a value of `--set` or of an axis of another kind than the parameter's; a parameter that is set and swept |
//! | E38 | a number out of range |
//! | E39 | a value that is too large or too deeply nested to be meant; more cases than can be counted |
//! | E40 | a file that a unit cannot be given, or a table that cannot be read |
//! | E45 | a fault that does not exist, lacks its value, or acts on no connection |
//! | W01 | a value is passed to a variable that declares no unit, or one that its description does not define |
//! | W02 | inputs without driver and without a value in the script |
//! | W03 | two instances of one unit draw the same random numbers |
//! | W04 | a window that opens after the end of the run |
//! | W05 | a unit that needs another program |
//! | W06 | an instance, `param`, `let` or swept `seed` that is not used |
//! | W07 | a unit whose experiment begins at another time than the run of a script |
//! | W08 | a unit with a fixed step that takes other steps |

use crate::diagnostic::Diagnostic;
use crate::loader::Loader;
use crate::parse::with_stack;
use crate::parts::Parts;
use crate::scenario::{Instance, Scenario};
use crate::source::{Sources, Span};
use crate::syntax::{Binding, File};

mod arithmetic;
mod assign;
mod claim;
mod column;
mod comparison;
mod condition;
mod curve;
mod elaborate;

mod event;
mod experiment;
mod expression;
mod fault;
mod findings;
mod fit;
mod frame;
mod function;
mod grid;
mod initial;
mod library;
mod limits;
mod literal;
mod meaning;
mod measure;
mod overlap;
mod parameter;
mod path;
mod preset;
mod range;
mod reads;
mod real;
mod running;
mod scale;
mod scope;
mod script;
mod share;
mod signal;
mod stars;
mod sweep;
mod temporal;
mod undeclared;
mod undriven;
mod unit;
mod unit_name;
mod unused;
mod wave;
mod wire;

use scope::{Scope, Shared};

/// What there is to resolve.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// All texts that spans point into.
    pub sources: &'a Sources,
    /// The script.
    pub file: &'a File,
    /// The parts that the script uses.
    pub parts: &'a Parts,
    /// Loads the units and files that the script names.
    pub loader: &'a dyn Loader,
    /// Assignments of the command line, in order; a later one counts.
    pub settings: &'a [Binding],
    /// The case of the sweep that gives parameters their values; `None` for their own values.
    pub case: Option<AskedCase>,
    /// Whether each instance will have a process of its own.
    pub isolated: bool,
}

/// A case that the command line asks for.
#[derive(Clone, Copy, Debug)]
pub struct AskedCase {
    /// Its number, from 0.
    pub number: u64,
    /// Where the number is written.
    pub place: Span,
}

/// The result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Resolved {
    /// The scenario; `None` if and only if an error is among the diagnostics.
    pub scenario: Option<Scenario>,
    /// Errors and warnings in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
}

/// Resolves a script to a scenario, or returns everything that is wrong with it.
#[must_use]
pub fn resolve(request: &Request<'_>) -> Resolved {
    let resolved = with_stack(0, || {
        let shared = Shared::new(*request);
        let scenario = scenario(shared.top());
        shared.top().requirements_of_libraries();
        let failed = shared.failed();
        let (diagnostics, conditions) = shared.finish();
        let mut scenario = scenario.filter(|_| !failed).map(|scenario| Scenario { conditions, ..scenario });
        if let Some(scenario) = &mut scenario {
            shared.of_bindings(|meanings| share::share(scenario, meanings));
        }
        assert!(failed || scenario.is_some(), "a script without an error has a meaning");
        Resolved { scenario, diagnostics }
    });
    resolved.unwrap_or_else(|error| Resolved { scenario: None, diagnostics: vec![error] })
}

/// Every pass runs even after errors, so that all errors are reported at once.
fn scenario(scope: Scope<'_, '_>) -> Option<Scenario> {
    let parameters = scope.parameters();
    scope.evaluate_lets();
    let grid = scope.grid();
    let stop_tick = scope.stop_tick();
    let presets = scope.presets();
    let periods = scope.periods();
    let connections = scope.connections(periods.as_deref());
    let events = scope.events(stop_tick);
    let stop_when = scope.stop_when();
    let seed = scope.fault_seed(&events);
    let claims = scope.claims(stop_tick);
    let columns = scope.columns(&connections, &claims);
    let waves = scope.waves(&connections);
    if scope.failed() {
        return None;
    }
    scope.warn_of_unused_names();
    scope.warn_of_undriven_inputs(&connections, &presets, &events);
    scope.warn_of_equal_noise(&presets);
    let initialization = scope.initialization(&connections, &presets)?;
    let (grid, periods, waves) = (grid?, periods?, waves?);
    scope.warn_of_other_experiments(&periods, grid.step_ns);
    let units = scope.script.units_by_index();
    let instances =
        scope.script.instances.iter().zip(presets).enumerate().map(|(index, (instance, presets))| Instance {
            name: instance.name.clone(),
            unit: instance.unit_index,
            every: periods[index],
            wave: waves[index],
            presets,
        });
    Some(Scenario {
        title: scope.script.title?.text.clone(),
        step_ns: grid.step_ns,
        start_tick: 0,
        stop_tick: stop_tick?,
        parameters,
        sweep: scope.script.cases,
        units,
        instances: instances.collect(),
        initialization,
        connections: connections.into_iter().map(|wired| wired.connection).collect(),
        events,
        stop_when,
        seed: seed?,
        conditions: Vec::new(),
        shared: Vec::new(),
        claims,
        columns,
    })
}
