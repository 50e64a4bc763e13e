//! The link between the coordinator and one worker: a zenoh session at each end, one key there and one back.
//!
//! Callbacks only hand over what they got; whoever waits does so in a thread of its own. The link is one of low latency:
//! what is sent goes into the socket in the thread that sends it, so that nobody has to be woken for it. That has no limit
//! of time, so what the socket towards a worker may have no room for goes by a thread of its own. A worker waits for room
//! as long as it takes: its coordinator may be suspended, and if it is gone so is the link.

mod pieces;
mod reasons;
mod run_name;

pub use reasons::without_source_places;
pub use run_name::run_name;

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
/// How long a lively end may be silent. Both ends are on this host: the socket of a dead one closes at once, and a run
/// that somebody suspends must go on afterwards, so this is longer than anybody's pause.
const LEASE_MS: u64 = 24 * 3600 * 1000;
/// A message that the socket towards a worker has room for, whatever the worker does, as it has answered all before: Linux
/// gives a socket 208 kB, unless `net.core.wmem_default` is lowered.
const BUFFERED: usize = 128 << 10;
/// How often somebody who waits for room looks around.
const LOOK: Duration = Duration::from_millis(50);
/// How long closing may take.
const FAREWELL: Duration = Duration::from_secs(1);
/// Said by a worker once orders reach it.
const READY: &str = "lockstep/alive/worker";

/// What the other end did.
#[derive(Debug)]
pub enum LinkEvent {
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
    events: Receiver<LinkEvent>,
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
    pub fn connect(socket: &Path, run: &str, patience: Duration) -> Result<Self, String> {
        let connect = format!(
            "connect: {{ endpoints: [{}], timeout_ms: {}, exit_on_failure: true, \
             retry: {{ period_init_ms: 5, period_max_ms: 50, period_increase_factor: 2 }} }}",
            endpoint(socket)?,
            patience.as_millis()
        );
        let session = open("client", &connect).map_err(|reason| format!("its worker cannot be reached: {reason}"))?;
        let (sender, events) = channel();
        let replies = subscribe(&session, &format!("lockstep/{run}/done"), message_to(&sender));
        let ready = move |sample: Sample| {
            let heard = if sample.kind() == SampleKind::Put { LinkEvent::Ready } else { LinkEvent::Gone };
            // Nobody listens any more once the run is over.
            let _ = sender.send(heard);
        };
        let ready = session.liveliness().declare_subscriber(READY).history(true).callback(ready).wait().ok();
        let publisher = publish(&session, format!("lockstep/{run}/do"));
        match (replies, ready, publisher) {
            (Some(replies), Some(ready), Some(publisher)) => {
                let (publisher, subscriptions) = (Arc::new(publisher), vec![replies, ready]);
                Ok(Self { session, publisher, _subscriptions: subscriptions, events })
            }
            _ => Err("its worker hung up".to_owned()),
        }
    }

    /// Sends a message. Each time that there was no room for a long one for a while, `look` is told how long that was; it
    /// may say why nobody should wait any longer.
    ///
    /// # Errors
    /// The message is too long, or what `look` said. That the other end is gone shows in what is heard only.
    pub fn send(&self, message: Vec<u8>, look: impl FnMut(Duration) -> Option<Cause>) -> Result<(), Cause> {
        if message.len() <= BUFFERED {
            return put(&self.publisher, &message).map_err(Cause::Other);
        }
        self.send_aside(message, look)
    }

    /// The same by a thread of its own, however short the message: for a worker that may not have taken those before.
    ///
    /// # Errors
    /// As for [`Link::send`], or the system gives no thread.
    pub fn send_aside(&self, message: Vec<u8>, mut look: impl FnMut(Duration) -> Option<Cause>) -> Result<(), Cause> {
        let (publisher, (done, result)) = (Arc::clone(&self.publisher), channel());
        // Nobody waits any more for a worker that was given up.
        let send = move || done.send(put(&publisher, &message)).unwrap_or_default();
        let sending = Builder::new().name("send".to_owned()).spawn(send);
        sending.map_err(|error| Cause::Other(format!("cannot start a thread to send a message: {error}")))?;
        loop {
            let began = Instant::now();
            match result.recv_timeout(LOOK) {
                Ok(result) => return result.map_err(Cause::Other),
                Err(RecvTimeoutError::Disconnected) => return Err(Cause::Other("the link is broken".to_owned())),
                Err(RecvTimeoutError::Timeout) => look(began.elapsed()).map_or(Ok(()), Err)?,
            }
        }
    }

    /// What the other end does, in order.
    #[must_use]
    pub fn events(&self) -> &Receiver<LinkEvent> {
        &self.events
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

fn message_to(sender: &Sender<LinkEvent>) -> impl Fn(Sample) + Send + Sync + 'static + use<> {
    let sender = sender.clone();
    joined(move |_, message| {
        // Nobody listens any more once the run is over.
        let _ = sender.send(LinkEvent::Message(message));
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

/// Sends a message, and waits for as long as there is no room for it.
///
/// # Errors
/// The message is too long. A link that is broken may swallow it without a word.
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

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: &[u8] = b"short";

    fn long() -> Vec<u8> {
        (0..1 << 20).map(|at| (at % 251) as u8).collect()
    }

    /// What keeps the other end there.
    type Peer = (Session, Subscriber<()>, LivelinessToken, tempfile::TempDir);

    /// A link to an end that hears nothing as long as the gate is closed, and what it hears.
    fn linked(gate: &Arc<Mutex<()>>) -> (Link, Receiver<Vec<u8>>, Peer) {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("0.sock");
        let peer = open("peer", &format!("listen: {{ endpoints: [{}] }}", endpoint(&socket).unwrap())).unwrap();
        let (sender, heard) = channel();
        let hear = joined(move |_, message| sender.send(message).unwrap_or_default());
        let gate = Arc::clone(gate);
        let callback = move |sample| {
            drop(gate.lock());
            hear(sample);
        };
        let subscription = subscribe(&peer, "lockstep/*/do", callback).unwrap();
        let token = peer.liveliness().declare_token(READY).wait().unwrap();
        let link = Link::connect(&socket, "run", Duration::from_secs(5)).unwrap();
        assert!(matches!(link.events().recv(), Ok(LinkEvent::Ready)));
        (link, heard, (peer, subscription, token, folder))
    }

    #[test]
    fn messages_long_and_short_arrive_whole_and_in_order() {
        let (link, heard, _peer) = linked(&Arc::default());
        for message in [long(), SHORT.to_vec(), long()] {
            link.send(message, |_| None).unwrap();
        }
        assert!([long(), SHORT.to_vec(), long()] == [(); 3].map(|()| heard.recv().unwrap()));
    }

    #[test]
    fn who_takes_nothing_is_waited_for_until_somebody_says_why_not_to_wait() {
        let gate = Arc::<Mutex<()>>::default();
        let (link, heard, _peer) = linked(&gate);
        let closed = gate.lock().unwrap();
        link.send(SHORT.to_vec(), |_| None).unwrap();
        let mut looks = 0;
        let sent = link.send(long(), |_| {
            looks += 1;
            (looks == 4).then_some(Cause::Silent(2.0))
        });
        assert_eq!((sent, looks), (Err(Cause::Silent(2.0)), 4));
        let one = link.send_aside(SHORT.to_vec(), |_| Some(Cause::Silent(1.0)));
        assert_eq!(one, Err(Cause::Silent(1.0)), "nor does a short one get past it");
        assert!(heard.try_recv().is_err());
        drop(closed);
        assert_eq!(heard.recv().unwrap(), SHORT);
    }
}

#[test]
fn a_socket_has_a_plain_short_name() {
    assert_eq!(endpoint(Path::new("/tmp/a b/3.sock")), Ok("\"unixsock-stream//tmp/a b/3.sock\"".to_owned()));
    for path in ["/tmp/a#b/3.sock", &format!("/tmp/{}/3.sock", "x".repeat(100))] {
        assert!(endpoint(Path::new(path)).is_err_and(|said| said.contains("TMPDIR")), "{path}");
    }
}
