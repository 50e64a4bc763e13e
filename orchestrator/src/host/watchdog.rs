//! Detects what stays the same for too long, measured in time during which the observing process itself ran.
//!
//! Of a gap in which the observing process was suspended only little counts: the observed one may have been suspended too.

use std::time::Duration;

/// The most that one look can count, however long ago the last one was.
const LONGEST_LOOK: Duration = Duration::from_millis(100);

/// Counts the time that the same call has been in progress, or anything else has stayed the same.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog<T> {
    limit: Duration,
    still: Duration,
    call: Option<T>,
}

impl<T: PartialEq> Watchdog<T> {
    /// Expires at this limit.
    #[must_use]
    pub fn new(limit: Duration) -> Self {
        Self { limit, still: Duration::ZERO, call: None }
    }

    /// The limit.
    #[must_use]
    pub fn limit(&self) -> Duration {
        self.limit
    }

    /// Takes a look, `since` after the last one, at the call in progress, if one is; says whether it has been the same for
    /// as long as it may.
    pub fn expired(&mut self, since: Duration, call: Option<T>) -> bool {
        if call.is_none() || call != self.call {
            self.call = call;
            self.still = Duration::ZERO;
            return false;
        }
        self.still += since.min(LONGEST_LOOK);
        self.still >= self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOOK: Duration = Duration::from_millis(50);

    fn looks_until_it_expires(
        watchdog: &mut Watchdog<u64>,
        since: Duration,
        call: impl Fn(usize) -> Option<u64>,
    ) -> Option<usize> {
        (0..1000).find(|&look| watchdog.expired(since, call(look)))
    }

    #[test]
    fn a_call_that_stays_the_same_for_the_limit_is_too_long() {
        let mut watchdog = Watchdog::new(Duration::from_secs(1));
        assert_eq!(looks_until_it_expires(&mut watchdog, LOOK, |_| Some(7)), Some(20));
    }

    #[test]
    fn a_new_call_starts_the_count_again() {
        let mut watchdog = Watchdog::new(Duration::from_secs(1));
        assert_eq!(looks_until_it_expires(&mut watchdog, LOOK, |look| Some(look as u64 / 19)), None);
    }

    #[test]
    fn time_between_calls_does_not_count() {
        let mut watchdog = Watchdog::new(Duration::from_secs(1));
        assert_eq!(looks_until_it_expires(&mut watchdog, LOOK, |_| None), None);
    }

    #[test]
    fn an_hour_of_suspension_counts_as_one_look() {
        let mut watchdog = Watchdog::new(Duration::from_secs(1));
        assert!(!watchdog.expired(LOOK, Some(7)) && !watchdog.expired(Duration::from_secs(3600), Some(7)));
        assert_eq!(looks_until_it_expires(&mut watchdog, LOOK, |_| Some(7)), Some(17));
    }
}
