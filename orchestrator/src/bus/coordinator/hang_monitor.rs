//! Detects workers that hang in a call and workers whose process is stopped.
//!
//! All workers are checked whenever the coordinator waits for any of them. If only the awaited one were checked, several
//! workers that hang at the same time would each take the whole time limit, one after the other.

use crate::host::watchdog::Watchdog;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use unit::board::{Board, InCall};
use unit::failure::Cause;

/// A process without a heartbeat for so long is stopped: 20 periods of the worker's heartbeat.
const HEARTBEAT_TIMEOUT: Duration = Duration::from_secs(2);

/// Checks the workers of a run by their boards.
#[derive(Debug)]
pub struct HangMonitor {
    /// The limit of a call of a unit. `None` waits without limit, also for a stopped process: a debugger stops it.
    step_timeout: Option<Duration>,
    workers: Mutex<Vec<MonitoredWorker>>,
}

#[derive(Debug)]
struct MonitoredWorker {
    board: Arc<Board>,
    /// Expires if this stays the same. `None` (in no call) is a state like a call: a worker whose reply is awaited may not
    /// remain in it either.
    call: Watchdog<Option<InCall>>,
    /// Expires if the count of heartbeats stays the same.
    heartbeat: Watchdog<u64>,
}

impl HangMonitor {
    /// Monitors the workers with these boards.
    #[must_use]
    pub fn new(boards: &[Arc<Board>], step_timeout: Option<Duration>) -> Self {
        let monitored = |board: &Arc<Board>| {
            let (call, heartbeat) =
                (Watchdog::new(step_timeout.unwrap_or(Duration::MAX)), Watchdog::new(HEARTBEAT_TIMEOUT));
            MonitoredWorker { board: Arc::clone(board), call, heartbeat }
        };
        Self { step_timeout, workers: Mutex::new(boards.iter().map(monitored).collect()) }
    }

    /// Restarts the time of a worker: it begins an order. The time in which it had none does not count.
    pub fn restart(&self, number: usize) {
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let MonitoredWorker { call, heartbeat, .. } = &mut workers[number];
        (*call, *heartbeat) = (Watchdog::new(call.limit()), Watchdog::new(heartbeat.limit()));
    }

    /// Checks all workers after a wait of so long; returns what is wrong with this one, whose reply is awaited.
    pub fn check(&self, number: usize, waited: Duration) -> Option<Cause> {
        let limit_s = self.step_timeout?.as_secs_f64();
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let mut wrong = None;
        for (at, MonitoredWorker { board, call, heartbeat }) in workers.iter_mut().enumerate() {
            let in_call = board.note(0).read();
            let (hangs, is_stopped) =
                (call.expired(waited, Some(in_call)), heartbeat.expired(waited, Some(board.pulse())));
            if at == number && hangs {
                let no_reply = || Cause::Other(format!("its worker has not answered for {limit_s} s"));
                wrong = Some(in_call.map_or_else(no_reply, |_| Cause::Hung(limit_s)));
            } else if at == number && is_stopped {
                wrong = Some(Cause::Silent(HEARTBEAT_TIMEOUT.as_secs_f64()));
            }
        }
        wrong
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi2::calls::Call;
    use unit::board::BoardLayout;
    use unit::failure::Doing;

    const PERIOD: Duration = Duration::from_millis(50);
    const LIMIT: Duration = Duration::from_millis(500);

    fn boards() -> [Arc<Board>; 2] {
        let layout = BoardLayout { notes: 1, columns: 0, claims: 0 };
        [0, 1].map(|_| Arc::new(Board::private(&layout).unwrap()))
    }

    /// The number of the check that finds a worker's defect, and the cause.
    fn first_finding(hang_monitor: &HangMonitor, number: usize, mut between: impl FnMut()) -> Option<(usize, Cause)> {
        (1..100).find_map(|number_of_check| {
            between();
            hang_monitor.check(number, PERIOD).map(|cause| (number_of_check, cause))
        })
    }

    #[test]
    fn units_that_hang_at_the_same_time_are_detected_at_the_same_time() {
        let boards = boards();
        let hang_monitor = HangMonitor::new(&boards, Some(LIMIT));
        let notes = boards.each_ref().map(|board| board.note(0));
        let calls = notes.each_ref().map(|note| note.at(7, 0.007));
        calls.iter().enumerate().for_each(|(index, now)| now.call(index, Doing::Call(Call::DoStep), || ()));
        let beat = || boards.iter().for_each(|board| board.beat());
        assert_eq!(first_finding(&hang_monitor, 0, beat), Some((11, Cause::Hung(0.5))));
        assert_eq!(first_finding(&hang_monitor, 1, beat), Some((1, Cause::Hung(0.5))), "it was checked all the time");
        hang_monitor.restart(1);
        assert_eq!(first_finding(&hang_monitor, 1, beat), Some((11, Cause::Hung(0.5))), "it got a new order");
    }

    #[test]
    fn processes_that_stop_together_are_detected_together_and_a_running_one_is_not() {
        let boards = boards();
        let hang_monitor = HangMonitor::new(&boards, Some(Duration::from_secs(60)));
        assert_eq!(first_finding(&hang_monitor, 0, || boards[1].beat()), Some((41, Cause::Silent(2.0))));
        assert_eq!(first_finding(&hang_monitor, 1, || boards[1].beat()), None);
        assert_eq!(first_finding(&hang_monitor, 1, || {}), Some((40, Cause::Silent(2.0))));
        assert_eq!(first_finding(&hang_monitor, 0, || {}), Some((1, Cause::Silent(2.0))));
    }

    #[test]
    fn a_worker_in_no_call_that_does_not_reply_is_detected_unless_there_is_no_limit() {
        let boards = boards();
        let beat = || boards.iter().for_each(|board| board.beat());
        let cause = Cause::Other("its worker has not answered for 0.5 s".to_owned());
        assert_eq!(first_finding(&HangMonitor::new(&boards, Some(LIMIT)), 0, beat), Some((11, cause)));
        assert_eq!(first_finding(&HangMonitor::new(&boards, None), 0, || {}), None);
    }
}
