//! `lockstep worker --once`: a process that holds instances for one run and does what it is told, one order at a time.
//!
//! It takes orders from whoever started it: over a socket in that run's private folder, which nobody else may enter. When
//! its standard input closes its coordinator is gone, and so is the process, whatever a unit is doing.

mod service;
mod spoken;

use super::link::Listening;
use crate::unit::board::Board;
use crate::unit::exit;
pub(super) use service::Service;
pub(super) use spoken::Spoken;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{sleep, spawn};
use std::time::Duration;

/// How often this process says that it lives.
const BEAT: Duration = Duration::from_millis(100);
/// Somebody who started a worker calls it within this time.
const CALL_DEADLINE: Duration = Duration::from_secs(60);
/// Between two orders any time may pass: the coordinator may be suspended, and if it is gone standard input tells.
const ANY_TIME: Duration = Duration::from_secs(u64::MAX / 2);

/// Where a worker is: in the private folder of a run, by number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// The run's private folder.
    pub home: PathBuf,
    /// The worker's number.
    pub number: usize,
}

impl Address {
    /// The socket on which it listens.
    #[must_use]
    pub fn socket(&self) -> PathBuf {
        self.home.join(format!("{}.sock", self.number))
    }

    /// The file of its board.
    #[must_use]
    pub fn board(&self) -> PathBuf {
        self.home.join(format!("{}.board", self.number))
    }
}

/// Serves one run.
///
/// # Errors
/// What kept it from serving to the end.
pub fn serve(address: &Address) -> Result<(), String> {
    let board = Board::open(&address.board()).map_err(|error| format!("cannot open the worker's board: {error}"))?;
    let board = Arc::new(board);
    end_with_coordinator(&address.home);
    live(Arc::clone(&board));
    let line = Listening::on(&address.socket())?;
    let (run, call) = line.next(CALL_DEADLINE)?;
    let answers = line.answer(&run)?;
    let mut service = Service::new(Arc::clone(&board), Spoken::new(board));
    let mut message = call;
    while let Some(answer) = service.answer(&message.to_bytes())? {
        super::link::put(&answers, answer)?;
        if service.is_over() {
            break;
        }
        message = line.next(ANY_TIME)?.1;
    }
    drop(service);
    drop(answers);
    line.close();
    Ok(())
}

/// Says every now and then that this process lives: one that is stopped does not.
fn live(board: Arc<Board>) {
    spawn(move || {
        loop {
            board.beat();
            sleep(BEAT);
        }
    });
}

/// Ends this process when its standard input closes, and takes away what the run would have taken away.
fn end_with_coordinator(home: &Path) {
    let home = home.to_owned();
    spawn(move || {
        // Whatever else comes is of no interest; neither is why it ends.
        io::copy(&mut io::stdin(), &mut io::sink()).ok();
        crate::preparation::remove_home(&home);
        exit::at_once(1);
    });
}
