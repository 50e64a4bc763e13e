//! `lockstep worker --once`: a process that holds instances for one run and executes one order at a time.
//!
//! Orders arrive over a socket in the run's private folder, which only its user can enter, so no password is needed. The
//! coordinator holds the other end of the worker's standard input open. When that closes the coordinator has ended,
//! however it ended, and a thread of the worker ends the process even if a unit is inside a call.

mod log_buffer;
mod service;

use crate::bus::link::{LinkListener, put};
use crate::host::orphan::end_when_orphaned;
pub(super) use log_buffer::LogBuffer;
pub(super) use service::Service;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{sleep, spawn};
use std::time::Duration;
use unit::board::Board;

/// The time between two heartbeats on the board.
const HEARTBEAT_PERIOD: Duration = Duration::from_millis(100);

/// The place of a worker: the private folder of its run and its number there.
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
/// What prevented it from serving to the end.
pub fn serve(address: &Address) -> Result<(), String> {
    let board = Board::open(&address.board()).map_err(|error| format!("cannot open the worker's board: {error}"))?;
    let board = Arc::new(board);
    end_when_orphaned(Some(&address.home));
    start_heartbeat(Arc::clone(&board));
    let link = LinkListener::bind(&address.socket())?;
    let (run, mut message) = link.receive()?;
    let replies = link.reply_publisher(&run)?;
    let mut service = Service::new(Arc::clone(&board), LogBuffer::new(board));
    loop {
        put(&replies, &service.execute(&message)?)?;
        if service.is_over() {
            break;
        }
        (_, message) = link.receive()?;
    }
    drop(service);
    drop(replies);
    link.close();
    Ok(())
}

/// Counts up the board's pulse from a thread of its own, so that it goes on while a unit computes. Only a process that is
/// stopped as a whole has no heartbeat; that tells it from one in a long call.
fn start_heartbeat(board: Arc<Board>) {
    spawn(move || {
        loop {
            board.beat();
            sleep(HEARTBEAT_PERIOD);
        }
    });
}
