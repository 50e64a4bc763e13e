//! How long a unit is simulated, and in which steps.

use fmi2::description::{DefaultExperiment, ModelDescription};

/// Stop time and step in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Experiment {
    pub stop_s: f64,
    pub step_s: f64,
}

impl Experiment {
    /// What the user says, then what the unit says, then one second in steps of about a thousandth.
    pub fn new(stop_s: Option<f64>, step_s: Option<f64>, description: &ModelDescription) -> Self {
        let DefaultExperiment { stop_time, step_size, .. } = description.default_experiment.unwrap_or_default();
        let stop_s = stop_s.or(stop_time.map(|stop_s| stop_s - start_s(description))).unwrap_or(1.0);
        Self { stop_s, step_s: step_s.or(step_size).unwrap_or_else(|| about_a_thousandth(stop_s)) }
    }
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
pub(super) fn time(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let digits = text.char_indices().map(|(at, _)| at).chain([text.len()]).rev();
    let split = digits.map(|at| text.split_at(at)).find_map(|(number, unit)| {
        let number = number.trim_end();
        let value =
            number.parse::<f64>().ok().filter(|_| number.ends_with(|c: char| c.is_ascii_digit() || c == '.'))?;
        Some((value, unit.trim()))
    });
    let expected = || "expected a time such as 10s, 7.5ms or 10".to_owned();
    let (value, unit) = split.ok_or_else(expected)?;
    // Divided, not multiplied: 1 ms is the number nearest to 0.001.
    let seconds = match unit {
        "" | "s" => value,
        "ms" => value / 1e3,
        "us" => value / 1e6,
        "ns" => value / 1e9,
        "min" => value * 60.0,
        "h" => value * 3600.0,
        _ => return Err(format!("`{unit}` is no unit of time; {}", expected())),
    };
    if seconds > 0.0 { Ok(seconds) } else { Err("expected a time above zero".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn the_user_comes_before_the_unit_and_the_unit_before_one_second() {
        let mut description = ModelDescription::default();
        assert_eq!(Experiment::new(None, None, &description), Experiment { stop_s: 1.0, step_s: 0.001 });
        assert_eq!(Experiment::new(Some(60.0), None, &description).step_s, 0.1);
        let own = DefaultExperiment { stop_time: Some(5.0), step_size: Some(0.02), ..DefaultExperiment::default() };
        description.default_experiment = Some(own);
        assert_eq!(Experiment::new(None, None, &description), Experiment { stop_s: 5.0, step_s: 0.02 });
        assert_eq!(Experiment::new(Some(1.0), Some(0.1), &description), Experiment { stop_s: 1.0, step_s: 0.1 });
        description.default_experiment = Some(DefaultExperiment { start_time: Some(2.0), ..own });
        assert_eq!(Experiment::new(None, None, &description).stop_s, 3.0);
    }
}
