//! The link between the coordinator and one worker: a zenoh session at each end, one key there and one back.
//!
//! Callbacks only hand over what they got; whoever waits does so in a thread of its own. The link is one of low latency:
//! what is sent goes into the socket in the thread that sends it, so that nobody has to be woken for it. That has no limit
//! of time, so whatever the socket may have no room for goes by a thread of its own.

use super::pieces::{Joiner, cut};
use super::reasons::without_source_places;
use crate::watchdog::Watchdog;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::spawn;
use std::time::{Duration, Instant};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::{Sample, SampleKind};
use zenoh::{Config, Session, Wait};

/// The longest message; states of units are the longest.
pub const LONGEST_MESSAGE: usize = 64 << 20;
/// How long a lively end may be silent. Both ends are on this host: the socket of a dead one closes at once, and a run
/// that somebody suspends must go on afterwards, so this is longer than anybody's pause.
const LEASE_MS: u64 = 24 * 3600 * 1000;
/// A message that a socket has room for, whatever the other end does: the system gives it 208 kB, and a worker answers an
/// order before it gets the next.
const BUFFERED: usize = 128 << 10;
/// How long a coordinator waits for room towards a worker, which then is frozen. A worker waits as long as it takes: its
/// coordinator may be suspended, and if it is gone so is the link.
const PATIENCE: Duration = Duration::from_secs(4);
/// How often somebody who waits for room looks.
const LOOK: Duration = Duration::from_millis(50);
/// How long closing may take.
const FAREWELL: Duration = Duration::from_secs(1);
/// Said by a worker once orders reach it.
const READY: &str = "lockstep/alive/worker";

/// What the other end did.
#[derive(Debug)]
pub enum Heard {
    /// It sent a message.
    Message(Vec<u8>),
    /// It hears what is sent now.
    Ready,
    /// It is gone.
    Gone,
}

/// One end of a link.
#[derive(Debug)]
pub struct Link {
    session: Session,
    publisher: Arc<Publisher<'static>>,
    _subscriptions: Vec<Subscriber<()>>,
    heard: Receiver<Heard>,
}

impl Drop for Link {
    fn drop(&mut self) {
        close(&self.session);
    }
}

/// The worker's end before the coordinator called.
#[derive(Debug)]
pub struct Listening {
    session: Session,
    subscription: Subscriber<()>,
    /// Alive as long as this end is.
    _token: LivelinessToken,
    calls: Receiver<(String, Vec<u8>)>,
}

impl Link {
    /// Calls the worker that listens on a socket, once.
    ///
    /// # Errors
    /// What could not be done within this time.
    pub fn dial(socket: &Path, run: &str, patience: Duration) -> Result<Self, String> {
        let connect = format!(
            "connect: {{ endpoints: [{}], timeout_ms: {}, exit_on_failure: true, \
             retry: {{ period_init_ms: 5, period_max_ms: 50, period_increase_factor: 2 }} }}",
            endpoint(socket)?,
            patience.as_millis()
        );
        let session = open("client", &connect).map_err(|reason| format!("its worker cannot be reached: {reason}"))?;
        let (sender, heard) = channel();
        let replies = subscribe(&session, &format!("lockstep/{run}/done"), message_to(&sender));
        let ready = move |sample: Sample| {
            let heard = if sample.kind() == SampleKind::Put { Heard::Ready } else { Heard::Gone };
            // Nobody listens any more once the run is over.
            let _ = sender.send(heard);
        };
        let ready = session.liveliness().declare_subscriber(READY).history(true).callback(ready).wait().ok();
        let publisher = publish(&session, format!("lockstep/{run}/do"));
        match (replies, ready, publisher) {
            (Some(replies), Some(ready), Some(publisher)) => {
                let (publisher, subscriptions) = (Arc::new(publisher), vec![replies, ready]);
                Ok(Self { session, publisher, _subscriptions: subscriptions, heard })
            }
            _ => Err("its worker hung up".to_owned()),
        }
    }

    /// Sends a message, see [`put`].
    ///
    /// # Errors
    /// What kept it from being sent.
    pub fn send(&self, message: Vec<u8>) -> Result<(), String> {
        if message.len() <= BUFFERED {
            return put(&self.publisher, &message);
        }
        check_length(&message)?;
        let (publisher, (went, gone)) = (Arc::clone(&self.publisher), channel());
        // Nobody waits any more once patience was lost.
        spawn(move || cut(&message).try_for_each(|piece| went.send(put_piece(&publisher, piece))));
        let (mut patience, mut count) = (Watchdog::new(PATIENCE), 0);
        loop {
            let began = Instant::now();
            match gone.recv_timeout(LOOK) {
                Ok(went) => went?,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
                Err(RecvTimeoutError::Timeout) if patience.bites(began.elapsed(), Some(count)) => {
                    return Err("its worker takes no more of a long message".to_owned());
                }
                Err(RecvTimeoutError::Timeout) => continue,
            }
            count += 1;
        }
    }

    /// What the other end does, in order.
    #[must_use]
    pub fn heard(&self) -> &Receiver<Heard> {
        &self.heard
    }
}

impl Listening {
    /// Listens on a socket, and says so.
    ///
    /// # Errors
    /// What could not be done.
    pub fn on(socket: &Path) -> Result<Self, String> {
        let listen = format!("listen: {{ endpoints: [{}], exit_on_failure: true }}", endpoint(socket)?);
        let session =
            open("peer", &listen).map_err(|reason| format!("cannot listen on {}: {reason}", socket.display()))?;
        let (sender, calls) = channel();
        let call = joined(move |sample, message| {
            let _ = sender.send((sample.key_expr().to_string(), message));
        });
        let subscription = subscribe(&session, "lockstep/*/do", call);
        let token = session.liveliness().declare_token(READY).wait().ok();
        match (subscription, token) {
            (Some(subscription), Some(token)) => Ok(Self { session, subscription, _token: token, calls }),
            _ => Err(format!("cannot listen on {}", socket.display())),
        }
    }

    /// Waits for a message, and says which run it is of. Any time may pass: a coordinator may be suspended, and one that is
    /// gone closes standard input.
    ///
    /// # Errors
    /// None can come any more.
    pub fn next(&self) -> Result<(String, Vec<u8>), String> {
        self.calls.recv().map(named).map_err(|_| "the link is broken".to_owned())
    }

    /// The same, but not for longer than this.
    ///
    /// # Errors
    /// None came.
    #[cfg(test)]
    pub fn next_within(&self, patience: Duration) -> Result<(String, Vec<u8>), RecvTimeoutError> {
        self.calls.recv_timeout(patience).map(named)
    }

    /// The way back to the coordinator of a run.
    ///
    /// # Errors
    /// The link is broken.
    pub fn answer(&self, run: &str) -> Result<Publisher<'static>, String> {
        publish(&self.session, format!("lockstep/{run}/done")).ok_or_else(|| "the link is broken".to_owned())
    }

    /// Hangs up.
    pub fn close(self) {
        drop(self.subscription);
        close(&self.session);
    }
}

/// A message with the name of the run that its key tells.
fn named((key, message): (String, Vec<u8>)) -> (String, Vec<u8>) {
    let run = key.strip_prefix("lockstep/").and_then(|rest| rest.strip_suffix("/do")).unwrap_or_default();
    (run.to_owned(), message)
}

fn message_to(sender: &Sender<Heard>) -> impl Fn(Sample) + Send + Sync + 'static + use<> {
    let sender = sender.clone();
    joined(move |_, message| {
        // Nobody listens any more once the run is over.
        let _ = sender.send(Heard::Message(message));
    })
}

/// A callback that takes whole messages. Those of one link come in order and one after the other.
fn joined(take: impl Fn(&Sample, Vec<u8>) + Send + Sync + 'static) -> impl Fn(Sample) + Send + Sync + 'static {
    let joiner = Mutex::new(Joiner::default());
    move |sample| {
        let mut joiner = joiner.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(message) = joiner.add(&sample.payload().to_bytes(), LONGEST_MESSAGE) {
            take(&sample, message);
        }
    }
}

fn subscribe(
    session: &Session,
    key: &str,
    callback: impl Fn(Sample) + Send + Sync + 'static,
) -> Option<Subscriber<()>> {
    session.declare_subscriber(key.to_owned()).callback(callback).wait().ok()
}

/// Sends a message, if it is not too long, and waits for as long as there is no room for it.
///
/// # Errors
/// What kept it from being sent.
pub fn put(publisher: &Publisher<'static>, message: &[u8]) -> Result<(), String> {
    check_length(message)?;
    cut(message).try_for_each(|piece| put_piece(publisher, piece))
}

fn put_piece(publisher: &Publisher<'static>, piece: Vec<u8>) -> Result<(), String> {
    publisher.put(piece).wait().map_err(|_| "its worker hung up".to_owned())
}

fn check_length(message: &[u8]) -> Result<(), String> {
    if message.len() > LONGEST_MESSAGE {
        return Err(format!("a message of {} bytes is longer than {LONGEST_MESSAGE}", message.len()));
    }
    Ok(())
}

fn publish(session: &Session, key: String) -> Option<Publisher<'static>> {
    let publisher = session.declare_publisher(key).congestion_control(CongestionControl::Block);
    publisher.priority(Priority::RealTime).express(true).wait().ok()
}

/// A session that speaks to whom it is told to, and looks for nobody.
fn open(mode: &str, place: &str) -> Result<Session, String> {
    let text = format!(
        "{{ mode: \"{mode}\", {place}, scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }}, \
         timestamping: {{ enabled: false }}, transport: {{ unicast: {{ max_sessions: 1, lowlatency: true, \
         qos: {{ enabled: false }} }}, link: {{ tx: {{ lease: {LEASE_MS}, keep_alive: 4 }} }} }} }}"
    );
    match Config::from_json5(&text) {
        Ok(config) => zenoh::open(config).wait().map_err(|error| without_source_places(&error.to_string())),
        Err(error) => unreachable!("zenoh does not know its own settings: {error}"),
    }
}

/// A socket as zenoh names it.
///
/// # Errors
/// It has a name that no socket can have.
pub fn endpoint(socket: &Path) -> Result<String, String> {
    /// What the system takes for the path of a socket, with room for what zenoh appends for its lock.
    const LONGEST: usize = 100;
    let path = socket.to_str().filter(|path| path.len() <= LONGEST && !path.contains(['?', '#', ';', '=', '"', '\\']));
    let path = path.ok_or_else(|| {
        format!("{} cannot be the name of a socket; set TMPDIR to a folder with a short, plain name", socket.display())
    })?;
    Ok(format!("\"unixsock-stream/{path}\""))
}

/// Closes a session in a thread, so that nothing is waited for too long.
fn close(session: &Session) {
    let (done, closed) = channel();
    let session = session.clone();
    spawn(move || {
        let _ = session.close().wait();
        let _ = done.send(());
    });
    // One that does not close is left to the end of the process.
    let _ = closed.recv_timeout(FAREWELL);
}

#[test]
fn a_socket_has_a_plain_short_name() {
    assert_eq!(endpoint(Path::new("/tmp/a b/3.sock")), Ok("\"unixsock-stream//tmp/a b/3.sock\"".to_owned()));
    for path in ["/tmp/a#b/3.sock", &format!("/tmp/{}/3.sock", "x".repeat(100))] {
        assert!(endpoint(Path::new(path)).is_err_and(|said| said.contains("TMPDIR")), "{path}");
    }
}
