//! Connects to a worker, awaits its replies, and finds the cause when a reply does not come.

use super::{PendingOrder, Remote, START_DEADLINE};
use crate::bus::link::{Link, LinkEvent};
use crate::bus::wire::open_request::{Handshake, ReplyExtras};
use crate::bus::wire::{Blocks, Header, Incoming, Malformed};
use crate::host::supervise::cause_of_death;
use crate::host::watchdog::Watchdog;
use crate::run::message::Message;
use crate::run::worker::Lost;
use flatten::wiring::InstancePorts;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, TryRecvError};
use std::thread::{sleep, yield_now};
use std::time::{Duration, Instant};
use unit::board::Board;
use unit::failure::{Cause, Failure};
use unit::process::LONGEST_STOP;

/// The limit of one attempt to connect, and the number of attempts. Attempts are short because an attempt cannot be
/// interrupted: between two it is checked whether the process still runs.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
const CONNECT_ATTEMPTS: usize = 15;
/// How long the coordinator polls for a reply before it blocks, if the workers leave a processor free: to wake a blocked
/// thread takes longer than most steps.
const POLL_TIME: Duration = Duration::from_micros(300);
/// The time between two checks of the workers while a reply is awaited.
const CHECK_PERIOD: Duration = Duration::from_millis(50);
/// The time between two checks whether a starting process listens.
const CHECK_PERIOD_AT_START: Duration = Duration::from_millis(2);
/// How long a process whose link closed may take to end. Its exit status names the cause, but the system reports it a
/// little later than the closed socket.
const EXIT_AFTER_LINK_LOSS: Duration = Duration::from_secs(1);

/// A process that starts: how long it takes, and how long it has been stopped.
struct Start {
    deadline: Watchdog<()>,
    stopped: Watchdog<()>,
}

impl Start {
    fn new() -> Self {
        Self { deadline: Watchdog::new(START_DEADLINE), stopped: Watchdog::new(LONGEST_STOP) }
    }
}

impl Remote<'_> {
    /// Connects to the process, with several attempts.
    pub(super) fn establish_link(&mut self, run: &str) -> Result<(), Failure> {
        self.await_socket()?;
        let socket = self.handle.address.socket();
        let mut refused = String::new();
        for _ in 0..CONNECT_ATTEMPTS {
            match Link::connect(&socket, run, CONNECT_TIMEOUT) {
                Ok(link) => {
                    self.link = Some(link);
                    return self.await_ready();
                }
                Err(reason) => refused = reason,
            }
            self.check_process()?;
            if self.is_stopped() {
                return Err(self.give_up(0, Cause::Stopped(CONNECT_TIMEOUT.as_secs_f64())).failure);
            }
        }
        Err(self.give_up(0, Cause::Other(refused)).failure)
    }

    /// Whether the process is stopped. One that has no time limit may be, by a debugger.
    fn is_stopped(&self) -> bool {
        self.spec.options.step_timeout.is_some() && self.handle.processes.is_stopped(self.handle.address.number)
    }

    /// Waits until the process has made its socket.
    fn await_socket(&mut self) -> Result<(), Failure> {
        let mut start = Start::new();
        let mut checked = Instant::now();
        while !is_socket(&self.handle.address.socket()) {
            self.check_start(&mut start, checked.elapsed())?;
            checked = Instant::now();
            sleep(CHECK_PERIOD_AT_START);
        }
        Ok(())
    }

    /// Waits until the process receives orders.
    fn await_ready(&mut self) -> Result<(), Failure> {
        let mut start = Start::new();
        loop {
            let began = Instant::now();
            match self.next_event(CHECK_PERIOD) {
                Ok(LinkEvent::Ready) => return Ok(()),
                Ok(LinkEvent::Gone) | Err(RecvTimeoutError::Disconnected) => return Err(self.died(0).failure),
                Ok(LinkEvent::Message(_)) | Err(RecvTimeoutError::Timeout) => {}
            }
            self.check_start(&mut start, began.elapsed())?;
        }
    }

    /// Returns the failure of a process that has ended or was killed.
    fn check_process(&mut self) -> Result<(), Failure> {
        let number = self.handle.address.number;
        if self.handle.processes.were_killed() || self.handle.processes.ended(number).is_some() {
            return Err(self.died(0).failure);
        }
        Ok(())
    }

    /// Returns a failure if the process has ended, is stopped or is late, `since` after the last check.
    fn check_start(&mut self, start: &mut Start, since: Duration) -> Result<(), Failure> {
        self.check_process()?;
        if start.stopped.expired(since, self.is_stopped().then_some(())) {
            return Err(self.give_up(0, Cause::Stopped(LONGEST_STOP.as_secs_f64())).failure);
        }
        if start.deadline.expired(since, Some(())) {
            let text = format!("its worker did not come up within {} s", START_DEADLINE.as_secs());
            return Err(self.give_up(0, Cause::Other(text)).failure);
        }
        Ok(())
    }

    /// Waits for the next event of the link.
    fn next_event(&self, timeout: Duration) -> Result<LinkEvent, RecvTimeoutError> {
        let Some(link) = &self.link else { return Err(RecvTimeoutError::Disconnected) };
        if self.handle.processes.have_processors_left() {
            let began = Instant::now();
            while began.elapsed() < POLL_TIME {
                match link.events().try_recv() {
                    Err(TryRecvError::Empty) => yield_now(),
                    event => return event.map_err(|_| RecvTimeoutError::Disconnected),
                }
            }
        }
        link.events().recv_timeout(timeout)
    }

    /// Awaits the reply to an order, passes its messages on and returns its other extras; `read_blocks` reads its blocks.
    ///
    /// # Errors
    /// The failure in the reply, or that of the worker.
    pub(super) fn await_reply(
        &mut self,
        pending: PendingOrder,
        read_blocks: impl FnOnce(&[(usize, InstancePorts)], &mut Blocks<'_>) -> Result<(), Malformed>,
    ) -> Result<ReplyExtras, Lost> {
        let message = self.receive(pending.header)?;
        let decoded = self.decode_reply(pending.header, &message, read_blocks);
        let extras = decoded.map_err(|reason| self.give_up(pending.header.tick, Cause::Other(reason)))?;
        match extras.lost {
            Some(lost) => Err(lost),
            None => Ok(extras),
        }
    }

    /// Awaits the reply to a step whose result is no longer needed, and passes its messages on.
    pub(super) fn drain(&mut self, pending: PendingOrder) -> Result<(), Lost> {
        let message = self.receive(pending.header)?;
        let extras = Incoming::read(&message).ok().and_then(|message| ReplyExtras::read(message.extras));
        if let Some(extras) = extras.filter(|extras| extras.is_limited_to(|index| self.holds(index))) {
            extras.messages.into_iter().for_each(|message| (self.sink)(message));
        }
        Ok(())
    }

    /// Checks and decodes a reply, and passes its messages on.
    fn decode_reply(
        &self,
        order: Header,
        message: &[u8],
        read_blocks: impl FnOnce(&[(usize, InstancePorts)], &mut Blocks<'_>) -> Result<(), Malformed>,
    ) -> Result<ReplyExtras, String> {
        let text = |malformed: Malformed| format!("its worker answered with {malformed}");
        let Incoming { header, mut blocks, extras } = Incoming::read(message).map_err(text)?;
        self.check_header(order, header)?;
        if order.kind == crate::bus::wire::Kind::Hello {
            let worker: Handshake = serde_json::from_slice(extras).map_err(|_| text(Malformed::ReplyExtras))?;
            return Handshake::this().agrees_with(&worker).map(|()| ReplyExtras::default());
        }
        let mut extras = ReplyExtras::read(extras).ok_or_else(|| text(Malformed::ReplyExtras))?;
        if !extras.is_limited_to(|index| self.holds(index)) {
            return Err("its worker spoke for others".to_owned());
        }
        std::mem::take(&mut extras.messages).into_iter().for_each(|message| (self.sink)(message));
        if extras.lost.is_some() {
            return Ok(extras);
        }
        if header.schema != self.schema {
            return Err("its worker has another layout of values: the unit is not the one that was checked".to_owned());
        }
        read_blocks(&self.ports, &mut blocks).map_err(text)?;
        blocks.end().map_err(text)?;
        Ok(extras)
    }

    /// Checks that a reply is that to this order: of its kind, tick and group. Its number was checked on arrival.
    fn check_header(&self, order: Header, reply: Header) -> Result<(), String> {
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

    /// Waits for the reply to an order. The worker replies in the sequence of its orders, but the loop may await them in
    /// another one; replies to other pending orders are stored until then.
    fn receive(&mut self, order: Header) -> Result<Vec<u8>, Lost> {
        if let Some(dead) = &self.dead {
            return Err(dead.clone());
        }
        if let Some(early) = self.early.remove(&order.sequence) {
            return Ok(early);
        }
        loop {
            let began = Instant::now();
            match self.next_event(CHECK_PERIOD) {
                Ok(LinkEvent::Message(_)) if self.handle.board.note(0).copied().is_some() => {
                    return Err(self.give_up(order.tick, Cause::Copied));
                }
                Ok(LinkEvent::Message(message)) => {
                    self.count_reply();
                    match sequence_of(&message) {
                        Some(sequence) if self.is_pending(sequence) => drop(self.early.insert(sequence, message)),
                        Some(sequence) if sequence != order.sequence => {
                            let text = format!("its worker answered order {sequence}, expected {}", order.sequence);
                            return Err(self.give_up(order.tick, Cause::Other(text)));
                        }
                        // Also an invalid message, whose defect is reported when it is decoded.
                        _ => return Ok(message),
                    }
                }
                Ok(LinkEvent::Gone) | Err(RecvTimeoutError::Disconnected) => return Err(self.died(order.tick)),
                Ok(LinkEvent::Ready) => {}
                Err(RecvTimeoutError::Timeout) if self.handle.processes.ended(self.handle.address.number).is_some() => {
                    return Err(self.died(order.tick));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Some(cause) = self.handle.hang_monitor.check(self.handle.address.number, began.elapsed()) {
                return Err(self.give_up(order.tick, cause));
            }
        }
    }

    /// Counts a reply. If there are more orders, the worker begins the next one, whose time starts now.
    fn count_reply(&mut self) {
        self.replies += 1;
        if self.replies < self.orders {
            self.handle.hang_monitor.restart(self.handle.address.number);
        }
    }

    fn is_pending(&self, sequence: u64) -> bool {
        self.under_way.values().any(|pending| pending.header.sequence == sequence)
    }

    /// The failure of a process whose link closed or that has ended. A process that does not end although its link closed
    /// is either stopped, if its heartbeat has stopped too, or has closed the link itself.
    fn died(&mut self, tick: u64) -> Lost {
        let pulse = self.handle.board.pulse();
        let cause = match self.handle.processes.ends_within(self.handle.address.number, EXIT_AFTER_LINK_LOSS) {
            Some(status) => cause_of_death(status),
            None if self.handle.board.pulse() == pulse => Cause::Silent(EXIT_AFTER_LINK_LOSS.as_secs_f64()),
            None => Cause::Other("its worker hung up".to_owned()),
        };
        self.give_up(tick, cause)
    }

    /// Kills the process for this cause, and passes on the messages that are left on its board.
    pub(super) fn give_up(&mut self, tick: u64, cause: Cause) -> Lost {
        self.handle.processes.kill(self.handle.address.number);
        // The worker itself reads its board's ring, for its replies. A new view starts where the worker stopped reading; the
        // present one would start where this process began.
        if let Ok(board) = Board::open(&self.handle.address.board()) {
            board.pop_messages(|bytes| {
                if let Ok(message @ (Message::Log(_) | Message::Calls(_))) = postcard::from_bytes(bytes) {
                    (self.sink)(message);
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

/// Whether there is a socket at this path.
fn is_socket(socket: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    socket.symlink_metadata().is_ok_and(|file| file.file_type().is_socket())
}
