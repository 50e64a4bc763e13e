//! Rules for the root element, `CoSimulation`, log categories, default experiment and vendor annotations.

use super::Report;
use crate::description::{CoSimulation, DefaultExperiment, Named, Position};

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    let at = model.position;
    if model.fmi_version != "2.0" {
        report.error("2.2.1", at, format!("fmiVersion is \"{}\"; expected \"2.0\"", model.fmi_version));
    }
    if model.model_name.is_empty() {
        report.error("2.2.1", at, "the model has no modelName");
    }
    if model.guid.is_empty() {
        report.error("2.2.1", at, "the unit has no guid; importers compare it with the one in the library");
    }
    if let Some(date) = &model.generation_date_and_time
        && !is_date(date)
    {
        let message =
            format!("generationDateAndTime is \"{date}\"; expected a form like \"2024-05-31T23:59:59Z\", in UTC");
        report.warning("2.2.1", at, message);
    }
    if let Some(count) = &model.number_of_event_indicators
        && count.trim().parse::<u32>().is_err()
    {
        report.error("2.2.1", at, format!("numberOfEventIndicators is \"{count}\"; expected a count"));
    }
    match &model.co_simulation {
        Some(unit) => co_simulation(report, unit),
        None if model.model_exchange.is_some() => {
            report.warning("2.2.1", at, "the unit offers ModelExchange only; to be stepped it needs CoSimulation");
        }
        None => report.error("2.2.1", at, "neither CoSimulation nor ModelExchange is there; one is needed"),
    }
    if let Some(unit) = &model.model_exchange {
        interface(report, "3.3.1", "ModelExchange", (unit.position, &unit.model_identifier, &unit.source_files));
    }
    if model.variables.is_empty() {
        report.error("2.2.7", at, "there are no ModelVariables; at least one is needed");
    }
    let categories = model.log_categories.iter().map(|category| (category.name.as_str(), category.position));
    report.unique("2.2.4", "a log category", categories);
    report.unique_named("2.2.6", "a tool", &model.vendor_annotations);
    if let Some(experiment) = &model.default_experiment {
        default_experiment(report, experiment);
    }
}

fn co_simulation(report: &mut Report, unit: &CoSimulation) {
    let at = unit.position;
    interface(report, "4.3.1", "CoSimulation", (at, &unit.model_identifier, &unit.source_files));
    if unit.can_serialize_fmu_state && !unit.can_get_and_set_fmu_state {
        report.error(
            "4.3.1",
            at,
            "canSerializeFMUstate needs canGetAndSetFMUstate: what cannot be got cannot be serialized",
        );
    }
}

/// The attributes and source files that both kinds of interface have.
fn interface(report: &mut Report, rule: &'static str, kind: &str, unit: (Position, &str, &[Named])) {
    let (at, identifier, files) = unit;
    if identifier.is_empty() {
        report.error(rule, at, format!("{kind} has no modelIdentifier, the library's file name"));
    } else if !is_c_identifier(identifier) {
        let message =
            format!("modelIdentifier \"{identifier}\" is no C identifier: letters, digits and `_`, no digit first");
        report.error(rule, at, message);
    }
    let mut odd: Vec<&Named> = Vec::new();
    for file in files.iter().filter(|file| !file.name.is_empty()) {
        let name = &file.name;
        if name.starts_with('/') || name.contains(['\\', ':']) || name.split('/').any(|part| part == "..") {
            let message = format!("source file \"{name}\" is no path below `sources` with forward slashes");
            report.error(rule, file.position, message);
        } else if name.split('/').any(|part| matches!(part, "" | ".")) {
            odd.push(file);
        }
    }
    // One warning for all: generators that write such names write hundreds.
    if let [first, others @ ..] = odd.as_slice() {
        let others = if others.is_empty() { String::new() } else { format!(" (and {} more like it)", others.len()) };
        let message = format!(
            "source file \"{}\"{others}: some tools compare names and expect none of `./` and `//`",
            first.name
        );
        report.warning(rule, first.position, message);
    }
    report.unique_named(rule, "a source file", files);
}

fn default_experiment(report: &mut Report, experiment: &DefaultExperiment) {
    let at = experiment.position;
    let values = [
        ("startTime", experiment.start_time),
        ("stopTime", experiment.stop_time),
        ("tolerance", experiment.tolerance),
        ("stepSize", experiment.step_size),
    ];
    for (name, value) in values {
        match value {
            Some(value) if !value.is_finite() => {
                report.error("2.2.5", at, format!("{name} is {value}; expected a finite number"));
            }
            Some(value) if matches!(name, "tolerance" | "stepSize") && value <= 0.0 => {
                report.error("2.2.5", at, format!("{name} is {value}; expected more than 0"));
            }
            _ => {}
        }
    }
    let start = experiment.start_time.unwrap_or(0.0);
    let Some(stop) = experiment.stop_time else { return };
    if stop <= start {
        report.error("2.2.5", at, format!("stopTime {stop} is not after startTime {start}"));
    } else if experiment.step_size.is_some_and(|step| step > stop - start) {
        let step = experiment.step_size.unwrap_or_default();
        report.warning("2.2.5", at, format!("stepSize {step} is longer than the experiment from {start} to {stop}"));
    }
}

/// `YYYY-MM-DDThh:mm:ssZ`, each number in its range.
fn is_date(text: &str) -> bool {
    let number = |range: std::ops::Range<usize>| {
        text.get(range)
            .filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()))
            .and_then(|digits| digits.parse().ok())
    };
    let within = |range, low: u32, high: u32| number(range).is_some_and(|value: u32| (low..=high).contains(&value));
    let separators = [(4, b'-'), (7, b'-'), (10, b'T'), (13, b':'), (16, b':'), (19, b'Z')];
    text.len() == 20
        && separators.iter().all(|&(at, letter)| text.as_bytes()[at] == letter)
        && within(0..4, 0, 9999)
        && within(5..7, 1, 12)
        && within(8..10, 1, 31)
        && within(11..13, 0, 23)
        && within(14..16, 0, 59)
        && within(17..19, 0, 60)
}

fn is_c_identifier(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_')
        && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
}
