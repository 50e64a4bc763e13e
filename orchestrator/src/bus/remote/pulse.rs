//! Whether a process that gives signs of life has frozen.

use std::time::Duration;

/// A process that gives no sign of life for so long is frozen.
pub const SIGN_OF_LIFE: Duration = Duration::from_secs(2);

/// The last sign of life of a process, in the time that was waited for any process of its run: of many that froze together
/// each is missed as soon as the first is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pulse {
    /// How many signs of life there were.
    pub count: u64,
    /// How long had been waited when the last was seen, or when the process was last sent something.
    pub since: Duration,
}

impl Pulse {
    /// Whether there were no more signs of life than before for too long.
    pub fn is_frozen(&mut self, count: u64, waited: Duration) -> bool {
        if count != self.count {
            *self = Self { count, since: waited };
        }
        waited.saturating_sub(self.since) >= SIGN_OF_LIFE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn a_process_without_a_sign_of_life_is_frozen_after_two_seconds() {
        let mut pulse = Pulse { count: 7, since: 10 * SECOND };
        assert!(!pulse.is_frozen(7, 11 * SECOND));
        assert!(pulse.is_frozen(7, 12 * SECOND));
        assert!(!pulse.is_frozen(8, 12 * SECOND), "it beats");
        assert!(!pulse.is_frozen(8, 13 * SECOND) && pulse.is_frozen(8, 14 * SECOND));
    }

    #[test]
    fn a_process_that_froze_while_another_was_waited_for_is_missed_at_once_and_one_that_lives_is_not() {
        let ordered = Pulse { count: 7, since: 10 * SECOND };
        let (mut frozen, mut alive) = (ordered, ordered);
        assert!(frozen.is_frozen(7, 12 * SECOND));
        assert!(!alive.is_frozen(27, 12 * SECOND));
    }
}
