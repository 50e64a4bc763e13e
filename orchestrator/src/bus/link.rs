//! The link between the coordinator and one worker: a zenoh session at each end, one key there and one back.
//!
//! Callbacks only hand over what they got; whoever waits does so in a thread of its own.

use super::reasons::without_source_places;
use std::fmt::Write;
use std::path::Path;
#[cfg(test)]
use std::sync::mpsc::RecvTimeoutError;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use zenoh::bytes::ZBytes;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::{Sample, SampleKind};
use zenoh::{Config, Session, Wait};

/// The longest message; states of units are the longest. A longer one would disappear without a word.
pub const LONGEST_MESSAGE: usize = 64 << 20;
/// How long a lively end may be silent. Both ends are on this host: the socket of a dead one closes at once, and a run
/// that somebody suspends must go on afterwards, so this is longer than anybody's pause.
const LEASE_MS: u64 = 24 * 3600 * 1000;
/// How long a coordinator waits for room in the buffers towards a worker, which then is frozen.
const COORDINATOR_PATIENCE_US: u64 = 4_000_000;
/// How long a worker waits for room towards its coordinator, which may be suspended; if it is gone the link is too.
const WORKER_PATIENCE_US: u64 = LEASE_MS * 1000;
/// How long closing may take.
const FAREWELL: Duration = Duration::from_secs(1);
/// Said by a worker once orders reach it.
const READY: &str = "lockstep/alive/worker";

/// What the other end did.
#[derive(Debug)]
pub enum Heard {
    /// It sent a message.
    Message(ZBytes),
    /// It hears what is sent now.
    Ready,
    /// It is gone.
    Gone,
}

/// One end of a link.
#[derive(Debug)]
pub struct Link {
    session: Session,
    publisher: Publisher<'static>,
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
    calls: Receiver<(String, ZBytes)>,
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
        let session = open("client", &connect, COORDINATOR_PATIENCE_US)
            .map_err(|reason| format!("its worker cannot be reached: {reason}"))?;
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
                Ok(Self { session, publisher, _subscriptions: vec![replies, ready], heard })
            }
            _ => Err("its worker hung up".to_owned()),
        }
    }

    /// Sends a message, see [`put`].
    ///
    /// # Errors
    /// What kept it from being sent.
    pub fn send(&self, message: Vec<u8>) -> Result<(), String> {
        put(&self.publisher, message)
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
        let session = open("peer", &listen, WORKER_PATIENCE_US)
            .map_err(|reason| format!("cannot listen on {}: {reason}", socket.display()))?;
        let (sender, calls) = channel();
        let call = move |sample: Sample| {
            let _ = sender.send((sample.key_expr().to_string(), sample.payload().clone()));
        };
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
    pub fn next(&self) -> Result<(String, ZBytes), String> {
        self.calls.recv().map(named).map_err(|_| "the link is broken".to_owned())
    }

    /// The same, but not for longer than this.
    ///
    /// # Errors
    /// None came.
    #[cfg(test)]
    pub fn next_within(&self, patience: Duration) -> Result<(String, ZBytes), RecvTimeoutError> {
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
fn named((key, message): (String, ZBytes)) -> (String, ZBytes) {
    let run = key.strip_prefix("lockstep/").and_then(|rest| rest.strip_suffix("/do")).unwrap_or_default();
    (run.to_owned(), message)
}

fn message_to(sender: &Sender<Heard>) -> impl Fn(Sample) + Send + Sync + 'static + use<> {
    let sender = sender.clone();
    move |sample| {
        let _ = sender.send(Heard::Message(sample.payload().clone()));
    }
}

fn subscribe(
    session: &Session,
    key: &str,
    callback: impl Fn(Sample) + Send + Sync + 'static,
) -> Option<Subscriber<()>> {
    session.declare_subscriber(key.to_owned()).callback(callback).wait().ok()
}

/// Sends a message, if it is not too long.
///
/// # Errors
/// What kept it from being sent.
pub fn put(publisher: &Publisher<'static>, message: Vec<u8>) -> Result<(), String> {
    if message.len() > LONGEST_MESSAGE {
        return Err(format!("a message of {} bytes is longer than {LONGEST_MESSAGE}", message.len()));
    }
    publisher.put(message).wait().map_err(|_| "its worker hung up".to_owned())
}

fn publish(session: &Session, key: String) -> Option<Publisher<'static>> {
    let publisher = session.declare_publisher(key).congestion_control(CongestionControl::Block);
    publisher.priority(Priority::RealTime).express(true).wait().ok()
}

/// A session that speaks to whom it is told to, and looks for nobody.
fn open(mode: &str, place: &str, patience_us: u64) -> Result<Session, String> {
    let mut text = format!("{{ mode: \"{mode}\", {place}, ");
    let _ = write!(
        text,
        "scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }}, \
         timestamping: {{ enabled: false }}, transport: {{ unicast: {{ max_sessions: 1 }}, \
         link: {{ tx: {{ lease: {LEASE_MS}, keep_alive: 4, queue: {{ congestion_control: {{ block: \
         {{ wait_before_close: {patience_us} }} }} }} }}, rx: {{ max_message_size: {} }} }} }} }}",
        LONGEST_MESSAGE + 1024
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
    std::thread::spawn(move || {
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
