//! Running values: what a run knows of all samples of a signal so far.

use super::RealExpression;
use serde::{Deserialize, Serialize};

/// A running value of an expression. Before its first sample there is no value, which is NaN.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Running {
    /// What it sums up.
    pub kind: RunningKind,
    /// The samples, in SI; for a count or a duration 1 where the condition holds, else 0.
    pub of: Box<RealExpression>,
    /// The tick of the first sample that counts.
    pub from_tick: u64,
    /// The communication step in seconds.
    pub step_s: f64,
}

/// The running values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunningKind {
    /// By trapezoids, in the unit of the samples times seconds.
    Integral,
    /// The integral over the elapsed time; at the first sample that sample.
    Average,
    /// The square root of the average of the squares.
    Rms,
    /// The largest sample; NaN if one is.
    Highest,
    /// The smallest sample; NaN if one is.
    Lowest,
    /// The change since the sample before, for each second; 0 at the first.
    Slope,
    /// How often the condition became true; before the first sample it counts as false.
    Count,
    /// Step × number of samples before this one at which the condition held.
    Duration,
}

/// What a running value remembers of earlier samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunningMemory {
    /// The sum, extreme or number so far.
    so_far: f64,
    /// The sample before.
    last: f64,
}

impl Running {
    /// Takes the sample of a tick, of which none is left out, and returns the value there.
    pub fn take(&self, memory: &mut RunningMemory, tick: u64, sample: f64) -> f64 {
        let Some(count) = tick.checked_sub(self.from_tick) else { return f64::NAN };
        let RunningMemory { so_far, last } = *memory;
        let is_first = count == 0;
        let elapsed_s = count as f64 * self.step_s;
        let integral = |last: f64, sample: f64| {
            if is_first { 0.0 } else { so_far + (last + sample) / 2.0 * self.step_s }
        };
        let square = sample * sample;
        let (so_far, last, value) = match self.kind {
            RunningKind::Integral => {
                let sum = integral(last, sample);
                (sum, sample, sum)
            }
            RunningKind::Average => {
                let sum = integral(last, sample);
                (sum, sample, if is_first { sample } else { sum / elapsed_s })
            }
            RunningKind::Rms => {
                let sum = integral(last, square);
                (sum, square, if is_first { square } else { sum / elapsed_s }.sqrt())
            }
            RunningKind::Highest => {
                let best = if is_first { sample } else { super::larger(so_far, sample) };
                (best, sample, best)
            }
            RunningKind::Lowest => {
                let best = if is_first { sample } else { super::smaller(so_far, sample) };
                (best, sample, best)
            }
            RunningKind::Slope => (0.0, sample, if is_first { 0.0 } else { (sample - last) / self.step_s }),
            RunningKind::Count => {
                let rises = sample != 0.0 && (is_first || last == 0.0);
                let number = if is_first { 0.0 } else { so_far } + f64::from(u8::from(rises));
                (number, sample, number)
            }
            RunningKind::Duration => {
                let samples = if is_first { 0.0 } else { so_far };
                // In nanoseconds, so that three steps of 0.1 s are 0.3 s.
                (samples + sample, sample, samples * (self.step_s * 1e9).round() / 1e9)
            }
        };
        *memory = RunningMemory { so_far, last };
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values over these samples with a step of half a second, from the tick `from_tick` on.
    fn values(kind: RunningKind, from_tick: u64, samples: &[f64]) -> Vec<f64> {
        let running = Running { kind, of: Box::new(RealExpression::Time), from_tick, step_s: 0.5 };
        let mut memory = RunningMemory::default();
        (0..).zip(samples).map(|(tick, &sample)| running.take(&mut memory, tick, sample)).collect()
    }

    #[test]
    fn each_running_value_follows_its_definition() {
        use RunningKind::{Average, Count, Duration, Highest, Integral, Lowest, Rms, Slope};
        let samples = [2.0, 4.0, 0.0, -4.0];
        let table: [(RunningKind, [f64; 4]); 6] = [
            (Integral, [0.0, 1.5, 2.5, 1.5]),
            (Average, [2.0, 3.0, 2.5, 1.0]),
            (Rms, [2.0, 10.0_f64.sqrt(), 9.0_f64.sqrt(), (26.0_f64 / 3.0).sqrt()]),
            (Highest, [2.0, 4.0, 4.0, 4.0]),
            (Lowest, [2.0, 2.0, 0.0, -4.0]),
            (Slope, [0.0, 4.0, -8.0, -8.0]),
        ];
        for (kind, expected) in table {
            assert_eq!(values(kind, 0, &samples), expected, "{kind:?}");
        }
        let holds = [1.0, 1.0, 0.0, 1.0, 1.0];
        assert_eq!(values(Count, 0, &holds), [1.0, 1.0, 1.0, 2.0, 2.0]);
        assert_eq!(values(Duration, 0, &holds), [0.0, 0.5, 1.0, 1.0, 1.5]);
    }

    #[test]
    fn before_its_first_sample_there_is_no_value_and_nothing_counts() {
        for kind in [RunningKind::Highest, RunningKind::Average, RunningKind::Rms] {
            let values = values(kind, 2, &[9.0, 9.0, 1.0, 1.0]);
            assert!(values[0].is_nan() && values[1].is_nan());
            assert_eq!(values[2..], [1.0, 1.0], "{kind:?}");
        }
        assert_eq!(values(RunningKind::Count, 1, &[1.0, 1.0, 0.0, 1.0])[1..], [1.0, 1.0, 2.0]);
        assert_eq!(values(RunningKind::Slope, 1, &[1.0, 5.0, 6.0])[1..], [0.0, 2.0]);
    }

    #[test]
    fn not_a_number_stays_in_an_extreme() {
        assert!(values(RunningKind::Highest, 0, &[1.0, f64::NAN, 2.0])[2].is_nan());
    }
}
