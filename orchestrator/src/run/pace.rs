//! `--pace`: a run that keeps no more than pace with the wall clock, so that one can watch it.
//!
//! It waits between two ticks, where no unit is called and no value computed: how fast it runs changes nothing else.

use std::thread::sleep;
use std::time::{Duration, Instant};
use unit::time::seconds;

/// A wait looks this often whether the run is to end.
const LONGEST_NAP: Duration = Duration::from_millis(20);

/// Simulated seconds for each second of the wall clock, counted from the first tick.
#[derive(Debug)]
pub struct Pace {
    pace: f64,
    step_ns: u64,
    /// When, and at which tick.
    began: Option<(Instant, u64)>,
}

impl Pace {
    /// A pace above zero.
    pub fn new(pace: f64, step_ns: u64) -> Self {
        Self { pace, step_ns, began: None }
    }

    /// Waits until a tick is due, or until the run is to end.
    pub fn wait_for(&mut self, tick: u64, to_end: impl Fn() -> bool) {
        let (began, first_tick) = *self.began.get_or_insert_with(|| (Instant::now(), tick));
        let time_s = seconds(tick - first_tick, self.step_ns);
        while let Some(ahead) = ahead(time_s, self.pace, began.elapsed())
            && !to_end()
        {
            sleep(ahead.min(LONGEST_NAP));
        }
    }
}

/// By how much a simulated time is ahead of the wall clock; `None` if it is due. Who fell behind catches up.
fn ahead(time_s: f64, pace: f64, wall: Duration) -> Option<Duration> {
    // A time beyond what a clock can count never comes.
    let due = Duration::try_from_secs_f64(time_s / pace).unwrap_or(Duration::MAX);
    due.checked_sub(wall).filter(|ahead| !ahead.is_zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn a_tick_is_due_when_the_wall_clock_has_come_as_far_as_the_pace_says() {
        assert_eq!(ahead(3.0, 1.0, SECOND), Some(2 * SECOND));
        assert_eq!(ahead(3.0, 2.0, SECOND), Some(SECOND / 2));
        assert_eq!(ahead(3.0, 0.5, SECOND), Some(5 * SECOND));
        assert_eq!(ahead(3.0, 3.0, SECOND), None);
    }

    #[test]
    fn who_fell_behind_does_not_wait() {
        assert_eq!(ahead(3.0, 1.0, 60 * SECOND), None);
        assert_eq!(ahead(0.0, 1.0, Duration::ZERO), None);
    }

    #[test]
    fn the_slowest_pace_waits_without_end() {
        assert_eq!(ahead(1.0, f64::MIN_POSITIVE, SECOND), Some(Duration::MAX - SECOND));
    }

    #[test]
    fn a_wait_ends_when_the_run_is_to_end() {
        let looks = std::cell::Cell::new(0);
        let mut pace = Pace::new(1e-9, 1_000_000);
        pace.wait_for(7, || unreachable!("the first tick is due at once, also where a run continues"));
        pace.wait_for(8, || looks.replace(looks.get() + 1) == 2);
        assert_eq!(looks.get(), 3);
    }
}
