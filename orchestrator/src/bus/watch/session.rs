//! The zenoh session that clients connect to: they can subscribe and query, but not publish.

use crate::bus::link::without_source_places;
use std::fmt;
use std::net::SocketAddr;
use zenoh::config::Config;
use zenoh::{Session, Wait};

/// The default endpoint: any free port, reachable from this machine only.
pub const ANY_LOCAL_PORT: &str = "tcp/127.0.0.1:0";

/// No scouting, and no port but the requested one. Clients may subscribe and query. What they publish or declare besides is
/// rejected, so that it reaches neither the run nor other clients. zenoh admits or denies a subscription as a whole, and a
/// client may subscribe to more than `lockstep/**`; hence `**` for ingress, while egress is limited to `lockstep/**`.
///
/// The limits of `transport` keep clients from using up memory and descriptors: a message is put together before the rules
/// act on it, and a connection takes a descriptor before its client has sent anything.
const SETTINGS: &str = r#"{
    mode: "peer",
    connect: { endpoints: [] },
    listen: { endpoints: [ENDPOINT], timeout_ms: 0, exit_on_failure: true },
    scouting: { multicast: { enabled: false }, gossip: { enabled: false } },
    timestamping: { enabled: false },
    transport: {
        unicast: { max_sessions: SESSIONS, accept_pending: SESSIONS, accept_timeout: 3000 },
        link: { rx: { max_message_size: MESSAGE_BYTES } },
    },
    access_control: {
        enabled: true,
        default_permission: "deny",
        rules: [
            { id: "in", permission: "allow", flows: ["ingress"], key_exprs: ["**"],
              messages: ["declare_subscriber", "query", "liveliness_query"] },
            { id: "out", permission: "allow", flows: ["egress"], key_exprs: ["lockstep/**"],
              messages: ["put", "reply", "declare_queryable"] },
        ],
        subjects: [{ id: "anyone" }],
        policies: [{ rules: ["in", "out"], subjects: ["anyone"] }],
    },
}"#;

/// How many clients can be connected at a time.
const SESSIONS: usize = 100;
/// The longest message that a client can send, which is a query.
const MESSAGE_BYTES: usize = 8 << 10;

/// Why a session cannot listen at an endpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListenError {
    /// The endpoint as the user named it.
    pub endpoint: String,
    /// The error of the system or of zenoh.
    pub cause: String,
}

impl ListenError {
    pub(super) fn new(endpoint: &str, error: &zenoh::Error) -> Self {
        Self { endpoint: endpoint.to_owned(), cause: without_source_places(&error.to_string()) }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        "an endpoint is tcp/ADDRESS:PORT or unixsock-stream/PATH; --live alone takes a free port of this machine"
    }
}

impl fmt::Display for ListenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot listen at {} for those who watch: {}", self.endpoint, self.cause)
    }
}

impl std::error::Error for ListenError {}

/// A session that listens.
#[derive(Debug)]
pub struct Listening {
    pub(super) session: Session,
    endpoint: String,
    addresses: Vec<String>,
}

impl Listening {
    /// Listens at an endpoint.
    ///
    /// # Errors
    /// The endpoint is invalid, in use or forbidden.
    pub fn at(endpoint: &str) -> Result<Self, ListenError> {
        let refused = |error| ListenError::new(endpoint, &error);
        let quoted = serde_json::Value::from(endpoint).to_string();
        let settings = SETTINGS.replace("SESSIONS", &SESSIONS.to_string());
        let settings = settings.replace("MESSAGE_BYTES", &MESSAGE_BYTES.to_string()).replace("ENDPOINT", &quoted);
        let settings = Config::from_json5(&settings).map_err(refused)?;
        let session = zenoh::open(settings).wait().map_err(refused)?;
        let locators = session.info().locators().wait();
        let mut addresses: Vec<_> = locators.iter().map(ToString::to_string).collect();
        if addresses.is_empty() {
            addresses.push(endpoint.to_owned());
        }
        Ok(Self { session, endpoint: endpoint.to_owned(), addresses })
    }

    /// The endpoint as the user named it.
    #[must_use]
    pub fn endpoint(&self) -> &str {
        &self.endpoint
    }

    /// The addresses at which it can be reached.
    #[must_use]
    pub fn addresses(&self) -> &[String] {
        &self.addresses
    }

    /// Whether it can be reached from other machines.
    #[must_use]
    pub fn is_open_to_others(&self) -> bool {
        !self.addresses.iter().all(|address| is_local(address))
    }
}

fn is_local(address: &str) -> bool {
    match address.split_once('/') {
        Some(("unixsock-stream", _)) => true,
        Some((_, place)) => place.parse().is_ok_and(|place: SocketAddr| place.ip().is_loopback()),
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_an_unusable_endpoint_has_no_source_locations() {
        let taken = Listening::at(ANY_LOCAL_PORT).unwrap();
        let endpoints = [taken.addresses()[0].as_str(), "tcp/127.0.0.1", "nonsense", "tls/127.0.0.1:0"];
        for endpoint in endpoints {
            let error = Listening::at(endpoint).unwrap_err();
            let text = error.to_string();
            assert!(text.starts_with(&format!("cannot listen at {endpoint} for those who watch: ")), "{text}");
            assert!(!text.contains(".rs") && text.len() > 50, "{text}");
        }
    }

    #[test]
    fn the_address_of_the_default_endpoint_has_a_port_and_is_local() {
        let listening = Listening::at(ANY_LOCAL_PORT).unwrap();
        let [address] = listening.addresses() else { panic!("{:?}", listening.addresses()) };
        assert!(address.starts_with("tcp/127.0.0.1:") && address != ANY_LOCAL_PORT, "{address}");
        assert!(!listening.is_open_to_others());
    }

    #[test]
    fn only_loopback_addresses_and_unix_sockets_are_local() {
        for address in ["tcp/127.0.0.1:7447", "tcp/[::1]:7447", "unixsock-stream//tmp/a.sock"] {
            assert!(is_local(address), "{address}");
        }
        for address in ["tcp/0.0.0.0:7447", "tcp/[::]:7447", "tcp/192.168.1.2:7447", "tcp/host.example:7447"] {
            assert!(!is_local(address), "{address}");
        }
    }
}
