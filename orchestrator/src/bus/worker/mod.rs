//! `lockstep worker --once`: a process that holds instances for one run and does what it is told, one order at a time.
//!
//! It takes orders from whoever started it: over a socket in that run's private folder, which nobody else may enter. When
//! its standard input closes its coordinator is gone, and so is the process, whatever a unit is doing.

mod log_buffer;
mod service;

use crate::bus::link::{Listening, put};
use crate::host::orphan::end_when_orphaned;
pub(super) use log_buffer::LogBuffer;
pub(super) use service::Service;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{sleep, spawn};
use std::time::Duration;
use unit::board::Board;

/// How often this process says that it lives.
const BEAT: Duration = Duration::from_millis(100);

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
    end_when_orphaned(Some(&address.home));
    live(Arc::clone(&board));
    let line = Listening::on(&address.socket())?;
    let (run, mut message) = line.next()?;
    let answers = line.answer(&run)?;
    let mut service = Service::new(Arc::clone(&board), LogBuffer::new(board));
    loop {
        put(&answers, &service.answer(&message)?)?;
        if service.is_over() {
            break;
        }
        (_, message) = line.next()?;
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
