//! Who hangs and who has frozen: all workers of a run are looked at whenever any of them is waited for, so that of many that
//! went wrong together each is missed when the first is.

use crate::host::watchdog::Watchdog;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use unit::board::{Board, InCall};
use unit::failure::Cause;

/// A process that gives no sign of life for so long is frozen.
const SIGN_OF_LIFE: Duration = Duration::from_secs(2);

/// Looks after the workers of a run by their boards.
#[derive(Debug)]
pub struct HangMonitor {
    /// How long a call of a unit may take; `None` waits for ever, for whatever it is.
    patience: Option<Duration>,
    workers: Mutex<Vec<Watched>>,
}

#[derive(Debug)]
struct Watched {
    board: Arc<Board>,
    /// The call that it is in, or that it is in none.
    call: Watchdog<Option<InCall>>,
    /// How many signs of life it gave.
    life: Watchdog<u64>,
}

impl HangMonitor {
    /// Looks after the workers with these boards.
    #[must_use]
    pub fn new(boards: &[Arc<Board>], patience: Option<Duration>) -> Self {
        let watched = |board: &Arc<Board>| {
            let (call, life) = (Watchdog::new(patience.unwrap_or(Duration::MAX)), Watchdog::new(SIGN_OF_LIFE));
            Watched { board: Arc::clone(board), call, life }
        };
        Self { patience, workers: Mutex::new(boards.iter().map(watched).collect()) }
    }

    /// A worker that was doing nothing is told to do something.
    pub fn begin(&self, number: usize) {
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let Watched { call, life, .. } = &mut workers[number];
        (*call, *life) = (Watchdog::new(call.limit()), Watchdog::new(life.limit()));
    }

    /// Takes a look at all workers after a wait of so long, and says what is wrong with this one, which is waited for.
    pub fn look(&self, number: usize, waited: Duration) -> Option<Cause> {
        let limit_s = self.patience?.as_secs_f64();
        let mut workers = self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let mut wrong = None;
        for (at, Watched { board, call, life }) in workers.iter_mut().enumerate() {
            let in_call = board.note(0).read();
            let (hangs, is_frozen) = (call.expired(waited, Some(in_call)), life.expired(waited, Some(board.pulse())));
            if at == number && hangs {
                let silent = || Cause::Other(format!("its worker has not answered for {limit_s} s"));
                wrong = Some(in_call.map_or_else(silent, |_| Cause::Hung(limit_s)));
            } else if at == number && is_frozen {
                wrong = Some(Cause::Silent(SIGN_OF_LIFE.as_secs_f64()));
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

    const LOOK: Duration = Duration::from_millis(50);
    const LIMIT: Duration = Duration::from_millis(500);

    fn boards() -> [Arc<Board>; 2] {
        let layout = BoardLayout { notes: 1, columns: 0, claims: 0 };
        [0, 1].map(|_| Arc::new(Board::private(&layout).unwrap()))
    }

    /// After how many looks at a worker something is wrong with it, and what.
    fn looks(hang_monitor: &HangMonitor, number: usize, mut between: impl FnMut()) -> Option<(usize, Cause)> {
        (1..100).find_map(|look| {
            between();
            hang_monitor.look(number, LOOK).map(|cause| (look, cause))
        })
    }

    #[test]
    fn units_that_hang_together_are_missed_together() {
        let boards = boards();
        let hang_monitor = HangMonitor::new(&boards, Some(LIMIT));
        let notes = boards.each_ref().map(|board| board.note(0));
        let calls = notes.each_ref().map(|note| note.at(7, 0.007));
        calls.iter().enumerate().for_each(|(index, now)| now.enter(index, Doing::Call(Call::DoStep)));
        let beat = || boards.iter().for_each(|board| board.beat());
        assert_eq!(looks(&hang_monitor, 0, beat), Some((11, Cause::Hung(0.5))));
        assert_eq!(looks(&hang_monitor, 1, beat), Some((1, Cause::Hung(0.5))), "it was looked at all the while");
        hang_monitor.begin(1);
        assert_eq!(looks(&hang_monitor, 1, beat), Some((11, Cause::Hung(0.5))), "it was told to do something else");
    }

    #[test]
    fn processes_that_freeze_together_are_missed_together_and_one_that_lives_is_not() {
        let boards = boards();
        let hang_monitor = HangMonitor::new(&boards, Some(Duration::from_secs(60)));
        assert_eq!(looks(&hang_monitor, 0, || boards[1].beat()), Some((41, Cause::Silent(2.0))));
        assert_eq!(looks(&hang_monitor, 1, || boards[1].beat()), None);
        assert_eq!(looks(&hang_monitor, 1, || {}), Some((40, Cause::Silent(2.0))));
        assert_eq!(looks(&hang_monitor, 0, || {}), Some((1, Cause::Silent(2.0))));
    }

    #[test]
    fn a_worker_between_calls_that_gives_no_answer_is_missed_and_without_a_limit_nobody_is() {
        let boards = boards();
        let beat = || boards.iter().for_each(|board| board.beat());
        let cause = Cause::Other("its worker has not answered for 0.5 s".to_owned());
        assert_eq!(looks(&HangMonitor::new(&boards, Some(LIMIT)), 0, beat), Some((11, cause)));
        assert_eq!(looks(&HangMonitor::new(&boards, None), 0, || {}), None);
    }
}
