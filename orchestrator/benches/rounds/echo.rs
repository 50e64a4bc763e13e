//! Processes that send back what they receive, over raw sockets and over zenoh.

use std::error::Error;
use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::mpsc::{Receiver, channel};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use zenoh::bytes::ZBytes;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Config, Session, Wait};

/// Blocking sockets.
pub const RAW: &str = "raw";
/// zenoh with one put and one callback for each direction.
pub const BARE: &str = "bare";
/// The longest piece of a message; zenoh's low-latency transport does not split messages itself.
const PIECE: usize = 40 << 10;

/// The connection to one process.
enum Connection {
    Raw(UnixStream),
    Bare { _session: Session, to: Publisher<'static>, _from: Subscriber<()>, received: Receiver<ZBytes> },
}

/// Child processes that send back what they receive.
pub struct Echoes {
    children: Vec<Child>,
    connections: Vec<Connection>,
    message: Vec<u8>,
    buffer: Vec<u8>,
    _home: TempDir,
}

impl Echoes {
    /// Starts so many processes, for messages of so many bytes.
    pub fn start(kind: &str, count: usize, bytes: usize) -> Result<Self, Box<dyn Error>> {
        let home = tempfile::tempdir()?;
        let place = |number: usize| -> PathBuf { home.path().join(format!("{number}.sock")) };
        let program = std::env::current_exe()?;
        let length = bytes.to_string();
        let start = |number| Command::new(&program).args(["echo", kind, &length]).arg(place(number)).spawn();
        let children = (0..count).map(start).collect::<Result<_, _>>()?;
        let connect = |number| {
            while !place(number).exists() {
                sleep(Duration::from_millis(1));
            }
            sleep(Duration::from_millis(50));
            if kind == RAW {
                UnixStream::connect(place(number)).map(Connection::Raw).map_err(Into::into)
            } else {
                connect_zenoh(&place(number))
            }
        };
        let connections = (0..count).map(connect).collect::<Result<_, Box<dyn Error>>>()?;
        Ok(Self { children, connections, message: vec![7; bytes], buffer: vec![0; bytes], _home: home })
    }

    /// Measures so many rounds: a message to each process, then one from each.
    pub fn block(&mut self, rounds: u64) -> Result<Duration, Box<dyn Error>> {
        let begun = Instant::now();
        for _ in 0..rounds {
            for connection in &mut self.connections {
                match connection {
                    Connection::Raw(stream) => stream.write_all(&self.message)?,
                    Connection::Bare { to, .. } => put(to, &self.message)?,
                }
            }
            for connection in &mut self.connections {
                match connection {
                    Connection::Raw(stream) => stream.read_exact(&mut self.buffer)?,
                    Connection::Bare { received, .. } => join(&received.recv()?, received, &mut self.buffer)?,
                }
            }
        }
        Ok(begun.elapsed())
    }
}

impl Drop for Echoes {
    fn drop(&mut self) {
        for child in &mut self.children {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Sends back messages of so many bytes that arrive at a socket, each when it is complete, until the benchmark disconnects
/// or kills this process.
pub fn serve(kind: &str, bytes: usize, place: &Path) -> Result<(), Box<dyn Error>> {
    if kind == RAW {
        let (mut stream, _) = UnixListener::bind(place)?.accept()?;
        let mut message = vec![0; bytes];
        while stream.read_exact(&mut message).is_ok() {
            stream.write_all(&message)?;
        }
        return Ok(());
    }
    let session = open("peer", "listen", place)?;
    let (sender, received) = channel();
    let _from = subscribe(&session, "echo/do", sender)?;
    let to = publish(&session, "echo/done")?;
    let mut message = vec![0; bytes];
    loop {
        // Before the rounds, single bytes probe whether the subscription is in effect.
        let first = received.recv()?;
        if first.len() == 1 {
            to.put(first).wait().map_err(|error| error.to_string())?;
        } else {
            join(&first, &received, &mut message)?;
            put(&to, &message)?;
        }
    }
}

/// Waits for the remaining pieces of a message.
fn join(first: &ZBytes, received: &Receiver<ZBytes>, message: &mut [u8]) -> Result<(), Box<dyn Error>> {
    let mut filled = 0;
    let mut add = |piece: &ZBytes| {
        message[filled..filled + piece.len()].copy_from_slice(&piece.to_bytes());
        filled += piece.len();
        filled < message.len()
    };
    let mut is_more = add(first);
    while is_more {
        is_more = add(&received.recv()?);
    }
    Ok(())
}

/// Sends a message in pieces that the transport accepts.
fn put(to: &Publisher<'static>, message: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut pieces = message.chunks(PIECE);
    Ok(pieces.try_for_each(|piece| to.put(piece).wait()).map_err(|error| error.to_string())?)
}

fn connect_zenoh(place: &Path) -> Result<Connection, Box<dyn Error>> {
    let session = open("client", "connect", place)?;
    let (sender, received) = channel();
    let from = subscribe(&session, "echo/done", sender)?;
    let to = publish(&session, "echo/do")?;
    // A put without a subscriber succeeds and is lost. So it is repeated until it comes back; further echoes are discarded.
    while received.recv_timeout(Duration::from_millis(100)).is_err() {
        to.put([1]).wait().map_err(|error| error.to_string())?;
    }
    while received.recv_timeout(Duration::from_millis(200)).is_ok() {}
    Ok(Connection::Bare { _session: session, to, _from: from, received })
}

fn open(mode: &str, direction: &str, place: &Path) -> Result<Session, Box<dyn Error>> {
    let text = format!(
        "{{ mode: \"{mode}\", {direction}: {{ endpoints: [\"unixsock-stream/{}\"] }}, timestamping: {{ enabled: false }}, \
         scouting: {{ multicast: {{ enabled: false }}, gossip: {{ enabled: false }} }}, \
         transport: {{ unicast: {{ max_sessions: 1, lowlatency: true, qos: {{ enabled: false }} }} }} }}",
        place.display()
    );
    let config = Config::from_json5(&text).map_err(|error| error.to_string())?;
    Ok(zenoh::open(config).wait().map_err(|error| error.to_string())?)
}

fn publish(session: &Session, key: &'static str) -> Result<Publisher<'static>, Box<dyn Error>> {
    let publisher = session.declare_publisher(key).congestion_control(CongestionControl::Block);
    let publisher = publisher.priority(Priority::RealTime).express(true).wait();
    Ok(publisher.map_err(|error| error.to_string())?)
}

fn subscribe(
    session: &Session,
    key: &'static str,
    to: std::sync::mpsc::Sender<ZBytes>,
) -> Result<Subscriber<()>, Box<dyn Error>> {
    let callback = move |sample: zenoh::sample::Sample| {
        let _ = to.send(sample.payload().clone());
    };
    Ok(session.declare_subscriber(key).callback(callback).wait().map_err(|error| error.to_string())?)
}
