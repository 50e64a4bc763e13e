//! Awaiting the answers of a worker, and telling what became of one that gives none.

use super::{Asked, Remote, START_DEADLINE};
use crate::bus::link::{Heard, Link};
use crate::bus::wire::open_request::{Aside, Speaker};
use crate::bus::wire::{Blocks, Header, Incoming, Malformed};
use crate::flatten::wiring::Member;
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
const LAST_BREATH: Duration = Duration::from_secs(1);

impl Remote<'_> {
    /// Calls the process until it answers.
    pub(super) fn call(&mut self, run: &str) -> Result<(), Failure> {
        self.await_socket()?;
        let socket = self.way.address.socket();
        let mut refused = String::new();
        for _ in 0..DIALS {
            match Link::dial(&socket, run, DIAL) {
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
        while !is_there(&self.way.address.socket()) {
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
                Ok(Heard::Ready) => return Ok(()),
                Ok(Heard::Gone) | Err(RecvTimeoutError::Disconnected) => return Err(self.died(0).failure),
                Ok(Heard::Message(_)) | Err(RecvTimeoutError::Timeout) => {}
            }
            self.is_expected(&mut patience, began.elapsed())?;
        }
    }

    /// Whether the process lives.
    fn must_live(&mut self) -> Result<(), Failure> {
        let number = self.way.address.number;
        if self.way.fleet.is_abandoned() || self.way.fleet.ended(number).is_some() {
            return Err(self.died(0).failure);
        }
        Ok(())
    }

    /// Whether the process may still come up, `since` after the last look.
    fn is_expected(&mut self, patience: &mut Watchdog<()>, since: Duration) -> Result<(), Failure> {
        self.must_live()?;
        if patience.bites(since, Some(())) {
            let text = format!("its worker did not come up within {} s", START_DEADLINE.as_secs());
            return Err(self.give_up(0, Cause::Other(text)).failure);
        }
        Ok(())
    }

    fn listen(&self, patience: Duration) -> Result<Heard, RecvTimeoutError> {
        let Some(link) = &self.link else { return Err(RecvTimeoutError::Disconnected) };
        if self.way.fleet.has_room() {
            let began = Instant::now();
            while began.elapsed() < ATTENTION {
                match link.heard().try_recv() {
                    Err(TryRecvError::Empty) => yield_now(),
                    heard => return heard.map_err(|_| RecvTimeoutError::Disconnected),
                }
            }
        }
        link.heard().recv_timeout(patience)
    }

    /// Awaits the reply to an order and tells what it says besides; `take` takes the values of its blocks.
    ///
    /// # Errors
    /// What the worker says went wrong, or what became of it.
    pub(super) fn answer(
        &mut self,
        asked: Asked,
        take: impl FnOnce(&[(usize, Member)], &mut Blocks<'_>) -> Result<(), Malformed>,
    ) -> Result<Aside, Lost> {
        let message = self.hear(asked.header)?;
        let said = self.understand(asked.header, &message, take);
        let aside = said.map_err(|reason| self.give_up(asked.header.tick, Cause::Other(reason)))?;
        match aside.lost {
            Some(lost) => Err(lost),
            None => Ok(aside),
        }
    }

    /// Awaits the reply to a step whose result nobody wants any more.
    pub(super) fn overrun(&mut self, asked: Asked) -> Result<(), Lost> {
        let message = self.hear(asked.header)?;
        let aside = Incoming::read(&message).ok().and_then(|message| Aside::read(message.aside));
        if let Some(aside) = aside.filter(|aside| aside.is_of(|index| self.holds(index))) {
            aside.said.into_iter().for_each(|said| (self.sink)(said));
        }
        Ok(())
    }

    fn understand(
        &self,
        order: Header,
        message: &[u8],
        take: impl FnOnce(&[(usize, Member)], &mut Blocks<'_>) -> Result<(), Malformed>,
    ) -> Result<Aside, String> {
        let told = |malformed: Malformed| format!("its worker answered with {malformed}");
        let Incoming { header, mut blocks, aside } = Incoming::read(message).map_err(told)?;
        self.fits(order, header)?;
        if order.kind == crate::bus::wire::Kind::Hello {
            let speaker: Speaker = serde_json::from_slice(aside).map_err(|_| told(Malformed::Aside))?;
            return Speaker::this().agrees_with(&speaker).map(|()| Aside::default());
        }
        let mut aside = Aside::read(aside).ok_or_else(|| told(Malformed::Aside))?;
        if !aside.is_of(|index| self.holds(index)) {
            return Err("its worker spoke for others".to_owned());
        }
        std::mem::take(&mut aside.said).into_iter().for_each(|said| (self.sink)(said));
        if aside.lost.is_some() {
            return Ok(aside);
        }
        if header.schema != self.schema {
            return Err("its worker has another layout of values: the unit is not the one that was checked".to_owned());
        }
        take(&self.members, &mut blocks).map_err(told)?;
        blocks.end().map_err(told)?;
        Ok(aside)
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
        self.members.iter().any(|(index, _)| *index == instance)
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
                Ok(Heard::Message(message)) => match sequence_of(&message) {
                    Some(sequence) if self.is_awaited(sequence) => drop(self.early.insert(sequence, message)),
                    Some(sequence) if sequence != order.sequence => {
                        let text = format!("its worker answered order {sequence}, expected {}", order.sequence);
                        return Err(self.give_up(order.tick, Cause::Other(text)));
                    }
                    // What is no message at all is told as what it is.
                    _ => return Ok(message),
                },
                Ok(Heard::Gone) | Err(RecvTimeoutError::Disconnected) => return Err(self.died(order.tick)),
                Ok(Heard::Ready) => {}
                Err(RecvTimeoutError::Timeout) if self.way.fleet.ended(self.way.address.number).is_some() => {
                    return Err(self.died(order.tick));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Some(cause) = self.way.vigil.look(self.way.address.number, began.elapsed()) {
                return Err(self.give_up(order.tick, cause));
            }
        }
    }

    fn is_awaited(&self, sequence: u64) -> bool {
        self.under_way.values().any(|asked| asked.header.sequence == sequence)
    }

    /// The process is gone, or about to be: how it ended, and what its units said last.
    fn died(&mut self, tick: u64) -> Lost {
        let pulse = self.way.board.pulse();
        let cause = match self.way.fleet.ends_within(self.way.address.number, LAST_BREATH) {
            Some(status) => cause_of_death(status),
            None if self.way.board.pulse() == pulse => Cause::Silent(LAST_BREATH.as_secs_f64()),
            None => Cause::Other("its worker hung up".to_owned()),
        };
        self.give_up(tick, cause)
    }

    /// Ends the process for this cause; nothing can be asked any more.
    pub(super) fn give_up(&mut self, tick: u64, cause: Cause) -> Lost {
        self.way.fleet.kill(self.way.address.number);
        // Opened anew, to read on where the process itself had read to.
        if let Ok(board) = Board::open(&self.way.address.board()) {
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
