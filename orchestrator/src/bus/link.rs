//! The link between the coordinator and one worker: a zenoh session at each end, one key there and one back.
//!
//! Callbacks run in zenoh's threads, which must not block; they only pass messages to a channel, and the receiver waits
//! there in its own thread.
//!
//! The sessions use zenoh's low-latency transport: the sending thread itself writes to the socket. No sender thread has
//! to be woken, which would take longer than the message itself. This transport has two limits that this module works
//! around:
//! - It does not split messages: the receiver closes the link at one that is longer than its buffer. Hence [`pieces`].
//! - A write blocks without a time limit while the socket is full. The coordinator must notice a worker that is stopped
//!   or hangs, so it sends what may not fit from a separate thread and checks the worker meanwhile.
//!
//! A worker's write may block for any time: its coordinator may be suspended, and a coordinator that ends closes the link.

mod pieces;
mod reasons;
mod run_name;

pub use reasons::without_source_places;
pub use run_name::run_name;

use fmi2::printable;
use pieces::{Joiner, cut};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, spawn};
use std::time::{Duration, Instant};
use unit::failure::Cause;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::sample::{Sample, SampleKind};
use zenoh::{Config, Session, Wait};

/// The longest message; states of units are the longest.
pub const LONGEST_MESSAGE: usize = 64 << 20;
/// zenoh closes a link on which nothing arrives for so long. The lease is not needed to detect a dead end: both ends are
/// on this host, where the socket of a dead process closes at once. A suspended run (Ctrl-Z) sends nothing either and must
/// continue after `fg`, so the lease is longer than any pause of a user.
const LEASE_MS: u64 = 24 * 3600 * 1000;
/// The longest message that is written in the caller's thread. Such a write does not block even if the worker has stopped
/// reading: the worker has answered all earlier orders, so the socket's buffer is empty, and Linux gives it 208 kB unless
/// `net.core.wmem_default` is lowered.
const DIRECT_SEND_LIMIT: usize = 128 << 10;
/// The time between two checks of a worker whose socket is full.
const CHECK_PERIOD: Duration = Duration::from_millis(50);
/// How long closing a session may take.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);
/// The liveliness token that a worker declares after its subscription: the coordinator sees the token only when orders
/// reach the worker. zenoh drops a message to a key without a subscriber, so nothing is sent before.
const READY_KEY: &str = "lockstep/alive/worker";

/// What the other end did.
#[derive(Debug)]
pub enum LinkEvent {
    /// It sent a message.
    Message(Vec<u8>),
    /// It receives what is sent from now on.
    Ready,
    /// It closed the link, or its process ended.
    Gone,
}

/// One end of a link.
#[derive(Debug)]
pub struct Link {
    session: Session,
    publisher: Arc<Publisher<'static>>,
    _subscriptions: Vec<Subscriber<()>>,
    events: Receiver<LinkEvent>,
}

impl Drop for Link {
    fn drop(&mut self) {
        close(&self.session);
    }
}

/// The worker's end: it receives orders of the coordinator that connects to its socket.
#[derive(Debug)]
pub struct LinkListener {
    session: Session,
    subscription: Subscriber<()>,
    /// Withdrawn when dropped, which the coordinator receives as [`LinkEvent::Gone`].
    _token: LivelinessToken,
    orders: Receiver<(String, Vec<u8>)>,
}

impl Link {
    /// Connects to the worker that listens on a socket, in one attempt.
    ///
    /// # Errors
    /// There is no connection within this time.
    pub fn connect(socket: &Path, run: &str, timeout: Duration) -> Result<Self, String> {
        let connect = format!(
            "connect: {{ endpoints: [{}], timeout_ms: {}, exit_on_failure: true, \
             retry: {{ period_init_ms: 5, period_max_ms: 50, period_increase_factor: 2 }} }}",
            endpoint(socket)?,
            timeout.as_millis()
        );
        let session = open("client", &connect).map_err(|reason| format!("its worker cannot be reached: {reason}"))?;
        let (sender, events) = channel();
        let replies = subscribe(&session, &format!("lockstep/{run}/done"), message_to(&sender));
        let ready = move |sample: Sample| {
            let event = if sample.kind() == SampleKind::Put { LinkEvent::Ready } else { LinkEvent::Gone };
            // The channel has no receiver any more once the run is over.
            let _ = sender.send(event);
        };
        let ready = session.liveliness().declare_subscriber(READY_KEY).history(true).callback(ready).wait().ok();
        let publisher = publish(&session, format!("lockstep/{run}/do"));
        match (replies, ready, publisher) {
            (Some(replies), Some(ready), Some(publisher)) => {
                let (publisher, subscriptions) = (Arc::new(publisher), vec![replies, ready]);
                Ok(Self { session, publisher, _subscriptions: subscriptions, events })
            }
            _ => Err("its worker hung up".to_owned()),
        }
    }

    /// Sends a message. While a long one does not fit into the socket, `check` is called with the time since its last call;
    /// it may return the cause why waiting is pointless.
    ///
    /// # Errors
    /// The message is too long, or what `check` returned. That the other end is gone is no error here: it is reported as
    /// [`LinkEvent::Gone`].
    pub fn send(&self, message: Vec<u8>, check: impl FnMut(Duration) -> Option<Cause>) -> Result<(), Cause> {
        if message.len() <= DIRECT_SEND_LIMIT {
            return put(&self.publisher, &message).map_err(Cause::Other);
        }
        self.send_in_thread(message, check)
    }

    /// The same in a separate thread, however short the message: for a worker that may not have read the earlier ones, so
    /// that even a short write can block.
    ///
    /// # Errors
    /// As for [`Link::send`], or the system gives no thread.
    pub fn send_in_thread(
        &self,
        message: Vec<u8>,
        mut check: impl FnMut(Duration) -> Option<Cause>,
    ) -> Result<(), Cause> {
        let (publisher, (done, result)) = (Arc::clone(&self.publisher), channel());
        // The channel has no receiver any more if waiting was given up; the thread then ends with the link.
        let send = move || done.send(put(&publisher, &message)).unwrap_or_default();
        let sending = Builder::new().name("send".to_owned()).spawn(send);
        sending.map_err(|error| Cause::Other(format!("cannot start a thread to send a message: {error}")))?;
        loop {
            let began = Instant::now();
            match result.recv_timeout(CHECK_PERIOD) {
                Ok(result) => return result.map_err(Cause::Other),
                Err(RecvTimeoutError::Disconnected) => return Err(Cause::Other("the link is broken".to_owned())),
                Err(RecvTimeoutError::Timeout) => check(began.elapsed()).map_or(Ok(()), Err)?,
            }
        }
    }

    /// The events of the other end, in order.
    #[must_use]
    pub fn events(&self) -> &Receiver<LinkEvent> {
        &self.events
    }
}

impl LinkListener {
    /// Listens on a socket and declares that orders are received.
    ///
    /// # Errors
    /// The socket cannot be made.
    pub fn bind(socket: &Path) -> Result<Self, String> {
        let listen = format!("listen: {{ endpoints: [{}], exit_on_failure: true }}", endpoint(socket)?);
        let session = open("peer", &listen)
            .map_err(|reason| format!("cannot listen on {}: {reason}", printable::path(socket)))?;
        let (sender, orders) = channel();
        let receive = joined(move |sample, message| {
            let _ = sender.send((sample.key_expr().to_string(), message));
        });
        let subscription = subscribe(&session, "lockstep/*/do", receive);
        let token = session.liveliness().declare_token(READY_KEY).wait().ok();
        match (subscription, token) {
            (Some(subscription), Some(token)) => Ok(Self { session, subscription, _token: token, orders }),
            _ => Err(format!("cannot listen on {}", printable::path(socket))),
        }
    }

    /// Waits for a message and returns it after the name of its run. There is no time limit: a coordinator may be suspended,
    /// and the end of one closes this process's standard input, which ends the process.
    ///
    /// # Errors
    /// None can come any more.
    pub fn receive(&self) -> Result<(String, Vec<u8>), String> {
        self.orders.recv().map(with_run_name).map_err(|_| "the link is broken".to_owned())
    }

    /// The same with a time limit.
    ///
    /// # Errors
    /// None came.
    #[cfg(test)]
    pub fn receive_within(&self, timeout: Duration) -> Result<(String, Vec<u8>), RecvTimeoutError> {
        self.orders.recv_timeout(timeout).map(with_run_name)
    }

    /// The publisher of replies to the coordinator of a run.
    ///
    /// # Errors
    /// The link is broken.
    pub fn reply_publisher(&self, run: &str) -> Result<Publisher<'static>, String> {
        publish(&self.session, format!("lockstep/{run}/done")).ok_or_else(|| "the link is broken".to_owned())
    }

    /// Closes the link.
    pub fn close(self) {
        drop(self.subscription);
        close(&self.session);
    }
}

/// Replaces a message's key by the name of the run in it.
fn with_run_name((key, message): (String, Vec<u8>)) -> (String, Vec<u8>) {
    let run = key.strip_prefix("lockstep/").and_then(|rest| rest.strip_suffix("/do")).unwrap_or_default();
    (run.to_owned(), message)
}

fn message_to(sender: &Sender<LinkEvent>) -> impl Fn(Sample) + Send + Sync + 'static + use<> {
    let sender = sender.clone();
    joined(move |_, message| {
        // The channel has no receiver any more once the run is over.
        let _ = sender.send(LinkEvent::Message(message));
    })
}

/// A callback that joins pieces and passes whole messages on. One joiner is enough: a link has one sender, and zenoh
/// delivers its pieces in order.
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

/// Sends a message; blocks as long as the socket has no room for it.
///
/// # Errors
/// The message is too long. A broken link may drop the message without an error.
pub fn put(publisher: &Publisher<'static>, message: &[u8]) -> Result<(), String> {
    if message.len() > LONGEST_MESSAGE {
        return Err(format!("a message of {} bytes is longer than {LONGEST_MESSAGE}", message.len()));
    }
    cut(message).try_for_each(|piece| publisher.put(piece).wait()).map_err(|_| "the link is broken".to_owned())
}

fn publish(session: &Session, key: String) -> Option<Publisher<'static>> {
    let publisher = session.declare_publisher(key).congestion_control(CongestionControl::Block);
    publisher.priority(Priority::RealTime).express(true).wait().ok()
}

/// A session with this one endpoint: it discovers no other sessions, and so two runs can never meet.
///
/// The low-latency transport excludes quality of service (priorities), which needs zenoh's queues.
fn open(mode: &str, endpoint: &str) -> Result<Session, String> {
    let text = format!(
        "{{ mode: \"{mode}\", {endpoint}, scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }}, \
         timestamping: {{ enabled: false }}, transport: {{ unicast: {{ max_sessions: 1, lowlatency: true, \
         qos: {{ enabled: false }} }}, link: {{ tx: {{ lease: {LEASE_MS}, keep_alive: 4 }} }} }} }}"
    );
    match Config::from_json5(&text) {
        Ok(config) => zenoh::open(config).wait().map_err(|error| without_source_places(&error.to_string())),
        Err(error) => unreachable!("zenoh does not know its own settings: {error}"),
    }
}

/// The endpoint of a socket in zenoh's notation.
///
/// # Errors
/// The path is too long for a socket, or has a character with a meaning in that notation.
pub fn endpoint(socket: &Path) -> Result<String, String> {
    /// The system's limit for the path of a socket (108 bytes), less what zenoh appends for its lock file.
    const LONGEST: usize = 100;
    let path = socket.to_str().filter(|path| path.len() <= LONGEST && !path.contains(['?', '#', ';', '=', '"', '\\']));
    let path = path.filter(|path| !path.contains(char::is_control));
    let path = path.ok_or_else(|| {
        format!(
            "{} cannot be the name of a socket; set TMPDIR to a folder with a short, plain name",
            printable::path(socket)
        )
    })?;
    Ok(format!("\"unixsock-stream/{path}\""))
}

/// Closes a session in a thread, as closing has no time limit: a write to a worker that does not read may still block.
fn close(session: &Session) {
    let (done, closed) = channel();
    let session = session.clone();
    spawn(move || {
        let _ = session.close().wait();
        let _ = done.send(());
    });
    // A session that does not close in time is left open until the process ends.
    let _ = closed.recv_timeout(CLOSE_TIMEOUT);
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: &[u8] = b"short";

    fn long() -> Vec<u8> {
        (0..1 << 20).map(|at| (at % 251) as u8).collect()
    }

    /// The other end exists as long as these values.
    type Peer = (Session, Subscriber<()>, LivelinessToken, tempfile::TempDir);

    /// A link to an end that receives nothing while the gate is locked, and the messages that it receives.
    fn connected_pair(gate: &Arc<Mutex<()>>) -> (Link, Receiver<Vec<u8>>, Peer) {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("0.sock");
        let peer = open("peer", &format!("listen: {{ endpoints: [{}] }}", endpoint(&socket).unwrap())).unwrap();
        let (sender, received) = channel();
        let receive = joined(move |_, message| sender.send(message).unwrap_or_default());
        let gate = Arc::clone(gate);
        let callback = move |sample| {
            drop(gate.lock());
            receive(sample);
        };
        let subscription = subscribe(&peer, "lockstep/*/do", callback).unwrap();
        let token = peer.liveliness().declare_token(READY_KEY).wait().unwrap();
        let link = Link::connect(&socket, "run", Duration::from_secs(5)).unwrap();
        assert!(matches!(link.events().recv(), Ok(LinkEvent::Ready)));
        (link, received, (peer, subscription, token, folder))
    }

    #[test]
    fn messages_long_and_short_arrive_whole_and_in_order() {
        let (link, received, _peer) = connected_pair(&Arc::default());
        for message in [long(), SHORT.to_vec(), long()] {
            link.send(message, |_| None).unwrap();
        }
        assert!([long(), SHORT.to_vec(), long()] == [(); 3].map(|()| received.recv().unwrap()));
    }

    #[test]
    fn sending_to_an_end_that_reads_nothing_waits_until_the_check_returns_a_cause() {
        let gate = Arc::<Mutex<()>>::default();
        let (link, received, _peer) = connected_pair(&gate);
        let closed = gate.lock().unwrap();
        link.send(SHORT.to_vec(), |_| None).unwrap();
        let mut checks = 0;
        let sent = link.send(long(), |_| {
            checks += 1;
            (checks == 4).then_some(Cause::Silent(2.0))
        });
        assert_eq!((sent, checks), (Err(Cause::Silent(2.0)), 4));
        let short = link.send_in_thread(SHORT.to_vec(), |_| Some(Cause::Silent(1.0)));
        assert_eq!(short, Err(Cause::Silent(1.0)), "a short message does not overtake it");
        assert!(received.try_recv().is_err());
        drop(closed);
        assert_eq!(received.recv().unwrap(), SHORT);
    }
}

#[test]
fn the_path_of_a_socket_is_short_and_without_special_characters() {
    assert_eq!(endpoint(Path::new("/tmp/a b/3.sock")), Ok("\"unixsock-stream//tmp/a b/3.sock\"".to_owned()));
    for path in ["/tmp/a#b/3.sock", "/tmp/a\nb/3.sock", &format!("/tmp/{}/3.sock", "x".repeat(100))] {
        assert!(endpoint(Path::new(path)).is_err_and(|message| message.contains("TMPDIR")), "{path}");
    }
}
