//! Awaiting the answers of a worker, and telling what became of one that gives none.

use super::{PendingOrder, Remote, START_DEADLINE};
use crate::bus::link::{Link, LinkEvent};
use crate::bus::wire::open_request::{Handshake, ReplyExtras};
use crate::bus::wire::{Blocks, Header, Incoming, Malformed};
use crate::flatten::wiring::InstancePorts;
use crate::host::supervise::cause_of_death;
use crate::host::watchdog::Watchdog;
use crate::run::message::Message;
use crate::run::worker::Lost;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, TryRecvError};
use std::thread::{sleep, yield_now};
use std::time::{Duration, Instant};
use unit::board::Board;
use unit::failure::{Cause, Failure};

/// How long one attempt to reach a process may take, and how many there are: between two it is seen whether it lives.
const DIAL: Duration = Duration::from_secs(2);
const DIALS: usize = 15;
/// How long somebody who waits stays awake for an answer, where the run leaves a processor free: to be woken takes longer
/// than most answers.
const ATTENTION: Duration = Duration::from_micros(300);
/// How often somebody who waits looks around.
const LOOK: Duration = Duration::from_millis(50);
/// How often somebody who waits for a process to come up looks.
const LOOK_AT_START: Duration = Duration::from_millis(2);
/// How long a process whose link is gone may take to end.
const EXIT_AFTER_LINK_LOSS: Duration = Duration::from_secs(1);

impl Remote<'_> {
    /// Calls the process until it answers.
    pub(super) fn call(&mut self, run: &str) -> Result<(), Failure> {
        self.await_socket()?;
        let socket = self.handle.address.socket();
        let mut refused = String::new();
        for _ in 0..DIALS {
            match Link::connect(&socket, run, DIAL) {
                Ok(link) => {
                    self.link = Some(link);
                    return self.await_ready();
                }
                Err(reason) => refused = reason,
            }
            self.must_live()?;
        }
        Err(self.give_up(0, Cause::Other(refused)).failure)
    }

    /// Waits until the process listens.
    fn await_socket(&mut self) -> Result<(), Failure> {
        let mut patience = Watchdog::new(START_DEADLINE);
        let mut looked = Instant::now();
        while !is_there(&self.handle.address.socket()) {
            self.is_expected(&mut patience, looked.elapsed())?;
            looked = Instant::now();
            sleep(LOOK_AT_START);
        }
        Ok(())
    }

    /// Waits until orders reach the process.
    fn await_ready(&mut self) -> Result<(), Failure> {
        let mut patience = Watchdog::new(START_DEADLINE);
        loop {
            let began = Instant::now();
            match self.listen(LOOK) {
                Ok(LinkEvent::Ready) => return Ok(()),
                Ok(LinkEvent::Gone) | Err(RecvTimeoutError::Disconnected) => return Err(self.died(0).failure),
                Ok(LinkEvent::Message(_)) | Err(RecvTimeoutError::Timeout) => {}
            }
            self.is_expected(&mut patience, began.elapsed())?;
        }
    }

    /// Whether the process lives.
    fn must_live(&mut self) -> Result<(), Failure> {
        let number = self.handle.address.number;
        if self.handle.processes.were_killed() || self.handle.processes.ended(number).is_some() {
            return Err(self.died(0).failure);
        }
        Ok(())
    }

    /// Whether the process may still come up, `since` after the last look.
    fn is_expected(&mut self, patience: &mut Watchdog<()>, since: Duration) -> Result<(), Failure> {
        self.must_live()?;
        if patience.expired(since, Some(())) {
            let text = format!("its worker did not come up within {} s", START_DEADLINE.as_secs());
            return Err(self.give_up(0, Cause::Other(text)).failure);
        }
        Ok(())
    }

    fn listen(&self, patience: Duration) -> Result<LinkEvent, RecvTimeoutError> {
        let Some(link) = &self.link else { return Err(RecvTimeoutError::Disconnected) };
        if self.handle.processes.has_room() {
            let began = Instant::now();
            while began.elapsed() < ATTENTION {
                match link.events().try_recv() {
                    Err(TryRecvError::Empty) => yield_now(),
                    event => return event.map_err(|_| RecvTimeoutError::Disconnected),
                }
            }
        }
        link.events().recv_timeout(patience)
    }

    /// Awaits the reply to an order and tells what it says besides; `take` takes the values of its blocks.
    ///
    /// # Errors
    /// What the worker says went wrong, or what became of it.
    pub(super) fn answer(
        &mut self,
        pending: PendingOrder,
        take: impl FnOnce(&[(usize, InstancePorts)], &mut Blocks<'_>) -> Result<(), Malformed>,
    ) -> Result<ReplyExtras, Lost> {
        let message = self.hear(pending.header)?;
        let said = self.understand(pending.header, &message, take);
        let extras = said.map_err(|reason| self.give_up(pending.header.tick, Cause::Other(reason)))?;
        match extras.lost {
            Some(lost) => Err(lost),
            None => Ok(extras),
        }
    }

    /// Awaits the reply to a step whose result nobody wants any more.
    pub(super) fn overrun(&mut self, pending: PendingOrder) -> Result<(), Lost> {
        let message = self.hear(pending.header)?;
        let extras = Incoming::read(&message).ok().and_then(|message| ReplyExtras::read(message.extras));
        if let Some(extras) = extras.filter(|extras| extras.is_of(|index| self.holds(index))) {
            extras.said.into_iter().for_each(|said| (self.sink)(said));
        }
        Ok(())
    }

    fn understand(
        &self,
        order: Header,
        message: &[u8],
        take: impl FnOnce(&[(usize, InstancePorts)], &mut Blocks<'_>) -> Result<(), Malformed>,
    ) -> Result<ReplyExtras, String> {
        let told = |malformed: Malformed| format!("its worker answered with {malformed}");
        let Incoming { header, mut blocks, extras } = Incoming::read(message).map_err(told)?;
        self.fits(order, header)?;
        if order.kind == crate::bus::wire::Kind::Hello {
            let speaker: Handshake = serde_json::from_slice(extras).map_err(|_| told(Malformed::ReplyExtras))?;
            return Handshake::this().agrees_with(&speaker).map(|()| ReplyExtras::default());
        }
        let mut extras = ReplyExtras::read(extras).ok_or_else(|| told(Malformed::ReplyExtras))?;
        if !extras.is_of(|index| self.holds(index)) {
            return Err("its worker spoke for others".to_owned());
        }
        std::mem::take(&mut extras.said).into_iter().for_each(|said| (self.sink)(said));
        if extras.lost.is_some() {
            return Ok(extras);
        }
        if header.schema != self.schema {
            return Err("its worker has another layout of values: the unit is not the one that was checked".to_owned());
        }
        take(&self.ports, &mut blocks).map_err(told)?;
        blocks.end().map_err(told)?;
        Ok(extras)
    }

    /// Whether a reply repeats what its order said.
    fn fits(&self, order: Header, reply: Header) -> Result<(), String> {
        let differ = |what: &str, found: u64, expected: u64| {
            Err(format!("its worker answered for {what} {found}, expected {expected}"))
        };
        if order.kind.reply() != Some(reply.kind) {
            return Err(format!("its worker answered {:?} to {:?}", reply.kind, order.kind));
        }
        if reply.tick != order.tick {
            return differ("tick", reply.tick, order.tick);
        }
        if reply.group != order.group {
            return differ("group", reply.group.into(), order.group.into());
        }
        Ok(())
    }

    fn holds(&self, instance: usize) -> bool {
        self.ports.iter().any(|(index, _)| *index == instance)
    }

    /// Waits for the reply to an order.
    fn hear(&mut self, order: Header) -> Result<Vec<u8>, Lost> {
        if let Some(dead) = &self.dead {
            return Err(dead.clone());
        }
        if let Some(early) = self.early.remove(&order.sequence) {
            return Ok(early);
        }
        loop {
            let began = Instant::now();
            match self.listen(LOOK) {
                Ok(LinkEvent::Message(message)) => match sequence_of(&message) {
                    Some(sequence) if self.is_awaited(sequence) => drop(self.early.insert(sequence, message)),
                    Some(sequence) if sequence != order.sequence => {
                        let text = format!("its worker answered order {sequence}, expected {}", order.sequence);
                        return Err(self.give_up(order.tick, Cause::Other(text)));
                    }
                    // What is no message at all is told as what it is.
                    _ => return Ok(message),
                },
                Ok(LinkEvent::Gone) | Err(RecvTimeoutError::Disconnected) => return Err(self.died(order.tick)),
                Ok(LinkEvent::Ready) => {}
                Err(RecvTimeoutError::Timeout) if self.handle.processes.ended(self.handle.address.number).is_some() => {
                    return Err(self.died(order.tick));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Some(cause) = self.handle.hang_monitor.look(self.handle.address.number, began.elapsed()) {
                return Err(self.give_up(order.tick, cause));
            }
        }
    }

    fn is_awaited(&self, sequence: u64) -> bool {
        self.under_way.values().any(|pending| pending.header.sequence == sequence)
    }

    /// The process is gone, or about to be: how it ended, and what its units said last.
    fn died(&mut self, tick: u64) -> Lost {
        let pulse = self.handle.board.pulse();
        let cause = match self.handle.processes.ends_within(self.handle.address.number, EXIT_AFTER_LINK_LOSS) {
            Some(status) => cause_of_death(status),
            None if self.handle.board.pulse() == pulse => Cause::Silent(EXIT_AFTER_LINK_LOSS.as_secs_f64()),
            None => Cause::Other("its worker hung up".to_owned()),
        };
        self.give_up(tick, cause)
    }

    /// Ends the process for this cause; nothing can be pending any more.
    pub(super) fn give_up(&mut self, tick: u64, cause: Cause) -> Lost {
        self.handle.processes.kill(self.handle.address.number);
        // Opened anew, to read on where the process itself had read to.
        if let Ok(board) = Board::open(&self.handle.address.board()) {
            board.pop_messages(|bytes| {
                if let Ok(told @ (Message::Log(_) | Message::Calls(_))) = postcard::from_bytes(bytes) {
                    (self.sink)(told);
                }
            });
        }
        let lost = self.lost(tick, cause);
        self.dead = Some(lost.clone());
        lost
    }
}

fn sequence_of(message: &[u8]) -> Option<u64> {
    Incoming::read(message).ok().map(|message| message.header.sequence)
}

/// Whether a socket is there.
fn is_there(socket: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    socket.symlink_metadata().is_ok_and(|file| file.file_type().is_socket())
}
