//! How long a unit is simulated, and in which steps.

use crate::cli::number_and_unit;
use crate::find::preparation::Refusal;
use fmi2::description::ModelDescription;
use results::shortest_decimal;
use results::table::seconds;

/// What nanoseconds can count, in seconds.
const MAX_S: f64 = 9e9;

/// What the user asked for, in seconds.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::cli) struct Asked {
    pub start_s: Option<f64>,
    pub stop_s: Option<f64>,
    pub step_s: Option<f64>,
}

/// Start, stop and step: whole nanoseconds, start and stop a whole number of steps.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct Experiment {
    pub start_tick: u64,
    pub stop_s: f64,
    pub step_s: f64,
    /// What differs from what was asked for or from what the unit is made for, a line for each.
    pub notes: Vec<String>,
}

impl Experiment {
    /// The user's options first, then those of the unit, then one second from 0 s on in steps of about a thousandth. A time
    /// that the user did not type is rounded, and so are start and stop to a step that the user did not type.
    ///
    /// # Errors
    /// An option is no time of a run, or options do not fit each other.
    pub fn new(asked: Asked, description: &ModelDescription) -> Result<Self, Refusal> {
        let own = description.default_experiment.unwrap_or_default();
        let own_start_s = own.start_time.filter(|start_s| (0.0..MAX_S).contains(start_s));
        let start_s = asked.start_s.or(own_start_s).unwrap_or(0.0);
        let usable = |time_s: f64| (1e-9..MAX_S).contains(&time_s);
        let own_stop_s = own.stop_time.filter(|&stop_s| usable(stop_s) && usable(stop_s - start_s));
        let stop_s = asked.stop_s.or(own_stop_s).unwrap_or(start_s + 1.0);
        if stop_s <= start_s {
            return Err(never_begins(stop_s, start_s, asked.start_s.is_some()));
        }
        let own_step_s = own.step_size.filter(|&step_s| usable(step_s));
        let step_s = asked.step_s.or(own_step_s).unwrap_or_else(|| about_a_thousandth(stop_s - start_s));
        let step_ns = whole_ns("--step", asked.step_s, step_s)?.max(1.0);
        let start_ns = whole_ns("--start", asked.start_s.filter(|&start_s| start_s > 0.0), start_s)?;
        let stop_ns = whole_ns("--stop", asked.stop_s, stop_s)?;
        let start_tick = libm::rint(start_ns / step_ns);
        let grid_start_ns = start_tick * step_ns;
        let grid_stop_ns = grid_start_ns + libm::rint((stop_ns - grid_start_ns) / step_ns).max(1.0) * step_ns;
        asked.fits("--start", asked.start_s, start_ns, grid_start_ns)?;
        asked.fits("--stop", asked.stop_s, stop_ns, grid_stop_ns)?;
        let times = [("step", step_s, step_ns), ("start", start_s, grid_start_ns), ("stop", stop_s, grid_stop_ns)];
        let earlier = own.start_time.filter(|_| asked.start_s.is_none() && own_start_s.is_none());
        let earlier = earlier.map(|own_s| {
            format!("warning: the unit's DefaultExperiment begins at {} s, this run at 0 s", shortest_decimal(own_s))
        });
        let fixed_s = own_step_s.filter(|own_s| is_fixed(description) && (own_s - step_ns / 1e9).abs() > 1e-9);
        let other_step = fixed_s.map(|own_s| other_step(own_s, step_ns / 1e9));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number from 0 to 9e18")]
        let start_tick = start_tick as u64;
        let notes = note(times).into_iter().chain(earlier).chain(other_step).collect();
        Ok(Self { start_tick, stop_s: grid_stop_ns / 1e9, step_s: step_ns / 1e9, notes })
    }
}

impl Asked {
    /// Refuses a typed time that is no whole number of typed steps.
    fn fits(&self, option: &str, asked_s: Option<f64>, ns: f64, grid_ns: f64) -> Result<(), Refusal> {
        let (Some(asked_s), Some(step_s), true) = (asked_s, self.step_s, grid_ns != ns) else { return Ok(()) };
        let (asked, step) = (shortest_decimal(asked_s), shortest_decimal(step_s));
        let message = format!("{option} {asked} s is no whole number of steps of --step {step} s");
        let near = format!("the nearest that is one: {option} {}", shortest_decimal(grid_ns / 1e9));
        Err(Refusal::new(&message, Some(&near)))
    }
}

/// The refusal of a stop that is not after the start.
fn never_begins(stop_s: f64, start_s: f64, typed: bool) -> Refusal {
    let (stop, start) = (shortest_decimal(stop_s), shortest_decimal(start_s));
    let of = if typed { "" } else { ", where the unit's DefaultExperiment begins" };
    let message = format!("--stop {stop} s is not after the start at {start} s{of}");
    Refusal::new(&message, Some("--stop is a point in time, not a duration; --start sets another start"))
}

fn is_fixed(description: &ModelDescription) -> bool {
    let offers = description.co_simulation.as_ref();
    offers.is_some_and(|offers| !offers.can_handle_variable_communication_step_size)
}

fn other_step(own_s: f64, step_s: f64) -> String {
    let (own, step) = (shortest_decimal(own_s), shortest_decimal(step_s));
    format!(
        "warning: the unit takes steps of {own} s only, as canHandleVariableCommunicationStepSize is false, but here it takes \
         steps of {step} s"
    )
}

/// Whole nanoseconds: those of an option exactly, others rounded.
fn whole_ns(option: &str, typed_s: Option<f64>, time_s: f64) -> Result<f64, Refusal> {
    typed_s.map_or_else(|| Ok(libm::rint(time_s * 1e9)), |typed_s| typed_ns(option, typed_s))
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

fn note(times: [(&str, f64, f64); 3]) -> Option<String> {
    let changes = times.into_iter().filter(|&(_, asked_s, ns)| differs(asked_s, ns)).map(|(name, asked_s, ns)| {
        format!("{name} {} s instead of {} s", shortest_decimal(ns / 1e9), shortest_decimal(asked_s))
    });
    let changes: Vec<_> = changes.collect();
    let why = "a step is whole nanoseconds, and a run begins and ends with a whole step";
    (!changes.is_empty()).then(|| format!("note: {}: {why}", changes.join(", ")))
}

/// A power of ten, so that it divides what people write.
fn about_a_thousandth(duration_s: f64) -> f64 {
    libm::exp10(libm::rint(libm::log10(duration_s.max(1e-6))) - 3.0)
}

/// A time of the command line above zero, in seconds: `10s`, `7.5 ms`, `10`.
pub(in crate::cli) fn time(text: &str) -> Result<f64, String> {
    let time_s = start(text)?;
    if time_s > 0.0 { Ok(time_s) } else { Err("expected a time above zero".to_owned()) }
}

/// A time of the command line, which may be zero.
pub(in crate::cli) fn start(text: &str) -> Result<f64, String> {
    let expected = || "expected a time such as 10s, 7.5ms or 10".to_owned();
    let (value, unit) = number_and_unit(text).ok_or_else(expected)?;
    let unit = if unit.is_empty() { "s" } else { unit };
    let time_s = seconds(value, unit).ok_or_else(|| format!("`{unit}` is no unit of time; {}", expected()))?;
    if time_s >= 0.0 { Ok(time_s) } else { Err("expected a time that is not negative".to_owned()) }
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
        let asked = Asked { start_s: None, stop_s, step_s };
        let experiment = Experiment::new(asked, description).unwrap_or_else(|refusal| panic!("{}", refusal.0));
        (experiment.stop_s, experiment.step_s, experiment.notes.concat())
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
        assert_eq!(experiment(None, None, &unit(None, f64::NAN, -1.0)), exact(1.0, 0.001));
    }

    #[test]
    fn what_nobody_typed_is_rounded_with_a_note() {
        let why = ": a step is whole nanoseconds, and a run begins and ends with a whole step";
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
    fn a_run_begins_where_the_user_or_the_unit_says() {
        let times = |start_s, stop_s, step_s, description: &ModelDescription| {
            let made = Experiment::new(Asked { start_s, stop_s, step_s }, description);
            let made = made.unwrap_or_else(|refusal| panic!("{}", refusal.0));
            (made.start_tick, made.stop_s, made.step_s, made.notes.concat())
        };
        let exact = |start_tick, stop_s, step_s| (start_tick, stop_s, step_s, String::new());
        let own = unit(Some(20.0), 30.0, 0.5);
        assert_eq!(times(None, None, None, &own), exact(40, 30.0, 0.5));
        assert_eq!(times(Some(0.0), None, None, &own), exact(0, 30.0, 0.5));
        assert_eq!(times(Some(25.0), None, None, &own), exact(50, 30.0, 0.5));
        assert_eq!(times(Some(40.0), None, None, &own), exact(80, 41.0, 0.5));
        assert_eq!(times(Some(20.0), None, None, &ModelDescription::default()), exact(20_000, 21.0, 0.001));
        let (tick, stop_s, _, note) = times(None, None, None, &unit(Some(0.05), 1.0, 0.1));
        assert_eq!((tick, stop_s), (0, 1.0));
        assert!(note.starts_with("note: start 0 s instead of 0.05 s: "), "{note}");
        let (tick, _, _, note) = times(None, None, None, &unit(Some(-10.0), 1.0, 0.1));
        assert_eq!(
            (tick, note.as_str()),
            (0, "warning: the unit's DefaultExperiment begins at -10 s, this run at 0 s")
        );
    }

    #[test]
    fn a_unit_with_a_fixed_step_is_warned_of_at_another_step() {
        let mut fixed = unit(None, 1.0, 0.1);
        fixed.co_simulation = Some(fmi2::description::CoSimulation::default());
        assert_eq!(experiment(None, None, &fixed).2, "");
        let warning = experiment(None, Some(0.05), &fixed).2;
        assert!(warning.starts_with("warning: the unit takes steps of 0.1 s only"), "{warning}");
        assert!(warning.ends_with("but here it takes steps of 0.05 s"), "{warning}");
    }

    #[test]
    fn a_stop_that_is_not_after_the_start_is_refused() {
        let own = unit(Some(20.0), 30.0, 0.5);
        let refusal = |start_s, stop_s, step_s| Experiment::new(Asked { start_s, stop_s, step_s }, &own).unwrap_err().0;
        let texts =
            [refusal(None, Some(10.0), None), refusal(Some(3.0), Some(3.0), None), refusal(Some(0.7), None, Some(0.5))];
        insta::assert_snapshot!(texts.join("\n"), @r"
        error: --stop 10 s is not after the start at 20 s, where the unit's DefaultExperiment begins
        help: --stop is a point in time, not a duration; --start sets another start
        error: --stop 3 s is not after the start at 3 s
        help: --stop is a point in time, not a duration; --start sets another start
        error: --start 0.7 s is no whole number of steps of --step 0.5 s
        help: the nearest that is one: --start 0.5
        ");
    }

    #[test]
    fn an_option_that_does_not_fit_is_named() {
        let refusal = |stop_s, step_s| {
            let asked = Asked { start_s: None, stop_s, step_s };
            Experiment::new(asked, &ModelDescription::default()).unwrap_err().0
        };
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
