//! How long a unit is simulated, and in which steps.

use crate::cli::number_and_unit;
use crate::find::preparation::Refusal;
use fmi2::description::ModelDescription;
use results::shortest_decimal;
use results::table::seconds;

/// What nanoseconds can count, in seconds.
const MAX_S: f64 = 9e9;

/// Stop time and step in seconds: whole nanoseconds, and a whole number of steps.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct Experiment {
    pub stop_s: f64,
    pub step_s: f64,
    /// What differs from what was asked for.
    pub note: Option<String>,
}

impl Experiment {
    /// The user's options first, then those of the unit, then one second in steps of about a thousandth. A time that the user
    /// did not type is rounded, and so is a stop to a step that the user did not type.
    ///
    /// # Errors
    /// An option is no time of a run, or both options do not fit each other.
    pub fn new(stop_s: Option<f64>, step_s: Option<f64>, description: &ModelDescription) -> Result<Self, Refusal> {
        let own = description.default_experiment.unwrap_or_default();
        let usable = |time_s: f64| (1e-9..MAX_S).contains(&time_s);
        let own_stop_s = own.stop_time.map(|stop_s| stop_s - start_s(description)).filter(|&stop_s| usable(stop_s));
        let asked_stop_s = stop_s.or(own_stop_s).unwrap_or(1.0);
        let own_step_s = own.step_size.filter(|&step_s| usable(step_s));
        let asked_step_s = step_s.or(own_step_s).unwrap_or_else(|| about_a_thousandth(asked_stop_s));
        let step_ns = match step_s {
            Some(step_s) => typed_ns("--step", step_s)?,
            None => libm::rint(asked_step_s * 1e9).max(1.0),
        };
        let stop_ns = match stop_s {
            Some(stop_s) => typed_ns("--stop", stop_s)?,
            None => libm::rint(asked_stop_s * 1e9),
        };
        let grid_ns = libm::rint(stop_ns / step_ns).max(1.0) * step_ns;
        if let (Some(stop_s), Some(step_s), true) = (stop_s, step_s, grid_ns != stop_ns) {
            let (stop, step) = (shortest_decimal(stop_s), shortest_decimal(step_s));
            let message = format!("--stop {stop} s is no whole number of steps of --step {step} s");
            let near = format!("the nearest that is one: --stop {}", shortest_decimal(grid_ns / 1e9));
            return Err(Refusal::new(&message, Some(&near)));
        }
        let note = note([("step", asked_step_s, step_ns), ("stop", asked_stop_s, grid_ns)]);
        Ok(Self { stop_s: grid_ns / 1e9, step_s: step_ns / 1e9, note })
    }
}

/// The nanoseconds of an option's seconds.
fn typed_ns(option: &str, time_s: f64) -> Result<f64, Refusal> {
    let time = shortest_decimal(time_s);
    if time_s >= MAX_S {
        let help = "a time counts from the start and is at most 285 years";
        return Err(Refusal::new(&format!("{option} {time} s is not a time of a run"), Some(help)));
    }
    let nearest = libm::rint(time_s * 1e9);
    if nearest == 0.0 || differs(time_s, nearest) {
        let help = "times are counted in nanoseconds, for example 5ns";
        return Err(Refusal::new(&format!("{option} {time} s is not a whole number of nanoseconds"), Some(help)));
    }
    Ok(nearest)
}

/// Whether a time is another one by more than its text allows.
fn differs(time_s: f64, ns: f64) -> bool {
    (time_s * 1e9 - ns).abs() > 1e-3 + ns * 1e-15
}

fn note(times: [(&str, f64, f64); 2]) -> Option<String> {
    let changes = times.into_iter().filter(|&(_, asked_s, ns)| differs(asked_s, ns)).map(|(name, asked_s, ns)| {
        format!("{name} {} s instead of {} s", shortest_decimal(ns / 1e9), shortest_decimal(asked_s))
    });
    let changes: Vec<_> = changes.collect();
    let why = "a step is whole nanoseconds, and a run ends with a whole step";
    (!changes.is_empty()).then(|| format!("note: {}: {why}", changes.join(", ")))
}

/// When the unit would begin by itself; here every run begins at zero.
pub(super) fn start_s(description: &ModelDescription) -> f64 {
    description.default_experiment.and_then(|experiment| experiment.start_time).unwrap_or(0.0)
}

/// A power of ten, so that it divides what people write.
fn about_a_thousandth(duration_s: f64) -> f64 {
    libm::exp10(libm::rint(libm::log10(duration_s.max(1e-6))) - 3.0)
}

/// A time of the command line in seconds: `10s`, `7.5 ms`, `10`.
pub(in crate::cli) fn time(text: &str) -> Result<f64, String> {
    let expected = || "expected a time such as 10s, 7.5ms or 10".to_owned();
    let (value, unit) = number_and_unit(text).ok_or_else(expected)?;
    let unit = if unit.is_empty() { "s" } else { unit };
    let time_s = seconds(value, unit).ok_or_else(|| format!("`{unit}` is no unit of time; {}", expected()))?;
    if time_s > 0.0 { Ok(time_s) } else { Err("expected a time above zero".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi2::description::DefaultExperiment;

    #[test]
    fn times_are_read_with_or_without_a_unit() {
        let times =
            [("10s", 10.0), ("7.5 ms", 0.0075), ("10", 10.0), ("1e-3", 1e-3), ("2 min", 120.0), ("1e3us", 1e-3)];
        for (text, seconds) in times {
            assert_eq!(time(text), Ok(seconds), "{text}");
        }
        for text in ["", "s", "inf", "nan", "-1s", "0", "3 m", "1 2"] {
            assert!(time(text).is_err(), "{text}");
        }
    }

    fn experiment(stop_s: Option<f64>, step_s: Option<f64>, description: &ModelDescription) -> (f64, f64, String) {
        let experiment = Experiment::new(stop_s, step_s, description).unwrap_or_else(|refusal| panic!("{}", refusal.0));
        (experiment.stop_s, experiment.step_s, experiment.note.unwrap_or_default())
    }

    fn unit(start_time: Option<f64>, stop_time: f64, step_size: f64) -> ModelDescription {
        let (stop_time, step_size) = (Some(stop_time), Some(step_size));
        let own = DefaultExperiment { start_time, stop_time, step_size, ..DefaultExperiment::default() };
        ModelDescription { default_experiment: Some(own), ..ModelDescription::default() }
    }

    #[test]
    fn the_user_comes_before_the_unit_and_the_unit_before_one_second() {
        let silent = ModelDescription::default();
        let exact = |stop_s, step_s| (stop_s, step_s, String::new());
        assert_eq!(experiment(None, None, &silent), exact(1.0, 0.001));
        assert_eq!(experiment(Some(60.0), None, &silent), exact(60.0, 0.1));
        let own = unit(None, 5.0, 0.02);
        assert_eq!(experiment(None, None, &own), exact(5.0, 0.02));
        assert_eq!(experiment(Some(1.0), Some(0.1), &own), exact(1.0, 0.1));
        assert_eq!(experiment(None, None, &unit(Some(2.0), 5.0, 0.02)), exact(3.0, 0.02));
        assert_eq!(experiment(None, None, &unit(None, f64::NAN, -1.0)), exact(1.0, 0.001));
    }

    #[test]
    fn what_nobody_typed_is_rounded_with_a_note() {
        let why = ": a step is whole nanoseconds, and a run ends with a whole step";
        let sixtieth = unit(None, 10.0, 1.0 / 60.0);
        let note = "note: step 0.016666667 s instead of 0.016666666666666666 s, stop 10.0000002 s instead of 10 s";
        assert_eq!(experiment(None, None, &sixtieth), (10.000_000_2, 0.016_666_667, format!("{note}{why}")));
        assert_eq!(experiment(Some(10.0), None, &sixtieth).2, format!("{note}{why}"));
        let note = format!("note: stop 0.9 s instead of 1 s{why}");
        assert_eq!(experiment(None, None, &unit(None, 1.0, 0.3)), (0.9, 0.3, note));
        let (stop_s, step_s, _) = experiment(None, None, &unit(None, 0.1, 0.3));
        assert_eq!((stop_s, step_s), (0.3, 0.3));
    }

    #[test]
    fn an_option_that_does_not_fit_is_named() {
        let refusal = |stop_s, step_s| Experiment::new(stop_s, step_s, &ModelDescription::default()).unwrap_err().0;
        insta::assert_snapshot!(
            [
                refusal(Some(1.0), Some(0.3)),
                refusal(None, Some(1.5e-9)),
                refusal(Some(1e-12), None),
                refusal(Some(1e10), None),
            ].join("\n"),
            @r"
        error: --stop 1 s is no whole number of steps of --step 0.3 s
        help: the nearest that is one: --stop 0.9
        error: --step 1.5e-9 s is not a whole number of nanoseconds
        help: times are counted in nanoseconds, for example 5ns
        error: --stop 1e-12 s is not a whole number of nanoseconds
        help: times are counted in nanoseconds, for example 5ns
        error: --stop 10000000000 s is not a time of a run
        help: a time counts from the start and is at most 285 years
        "
        );
    }
}
