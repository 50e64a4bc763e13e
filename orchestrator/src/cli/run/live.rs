//! `lockstep run --live`: where and how a run lets others watch.

use crate::bus::watch::{ANY_LOCAL_PORT, ListenError, Listening, Rate, Watch};
use crate::cli::exit_code::MORE_PROCESSES;
use crate::find::preparation::Refusal;
use crate::host::execution::ReadyRun;
use crate::run::prepared_run::PreparedRun;
use fmi2::printable;
use results::report::status;
use results::sink::Sink;
use unit::descriptors::{are_left, raise_limit};
use unit::process::{has_address_space, may_start};

/// What zenoh opens and the run after it. zenoh ends the program with a panic where it gets nothing.
const DESCRIPTORS: usize = 32;
/// What zenoh's threads map.
const ADDRESS_SPACE: usize = 512 << 20;
/// The threads that zenoh starts, and those that are started later for the run.
const THREADS: usize = 16;

/// What a run is told about those who watch.
#[derive(Debug, clap::Args)]
pub(super) struct Live {
    /// Lets others watch: shows recorded signals 50 times a second [default endpoint: a free port of this machine]
    #[arg(long, value_name = "ENDPOINT", num_args = 0..=1, require_equals = true, default_missing_value = ANY_LOCAL_PORT)]
    live: Option<String>,
    /// As --live, but shows every tick; rows that come too fast are left out, and counted
    #[arg(long)]
    live_every_tick: bool,
}

impl Live {
    /// Whether the run can be watched.
    pub fn is_on(&self) -> bool {
        self.live.is_some() || self.live_every_tick
    }

    /// Listens at the endpoint of the command line, if it has one.
    pub fn listen(&self) -> Result<Option<Listening>, Refusal> {
        let unnamed = self.live_every_tick.then_some(ANY_LOCAL_PORT);
        let Some(endpoint) = self.live.as_deref().or(unnamed) else { return Ok(None) };
        // Each client takes a descriptor, and so does each connection before it is known to be one.
        raise_limit();
        if !are_left(DESCRIPTORS) || !has_address_space(ADDRESS_SPACE) {
            let message = "too few file descriptors or too little address space are left for --live";
            return Err(Refusal::new(&message, Some("raise the limits (ulimit -n, ulimit -v)")));
        }
        if !may_start(THREADS) {
            return Err(Refusal::new(&"too few threads are left for --live", Some(MORE_PROCESSES)));
        }
        let listening = Listening::at(endpoint).map_err(|error| refusal(&error))?;
        if listening.is_open_to_others() {
            status(&format!(
                "warning: {} is open to other machines: anybody who reaches it can watch this run",
                listening.addresses().join(", ")
            ));
        }
        Ok(Some(listening))
    }

    /// Makes a run one that can be watched; how is printed when it begins.
    pub fn show(&self, listening: Option<Listening>, run: PreparedRun) -> Result<ReadyRun, Refusal> {
        let Some(listening) = listening else { return Ok(run.into()) };
        let rate = if self.live_every_tick { Rate::EveryTick } else { Rate::Sample };
        let addresses = listening.addresses().to_vec();
        let watch = Watch::new(listening, &run.spec, rate).map_err(|error| refusal(&error))?;
        let begin = move |board: &_| -> Box<dyn Sink> {
            status(&text(watch.run(), &addresses));
            Box::new(watch.on(board))
        };
        Ok(ReadyRun { run, live: Some(Box::new(begin)) })
    }
}

fn refusal(error: &ListenError) -> Refusal {
    Refusal::new(error, Some(error.help()))
}

/// The name and addresses of a run, and a command line that watches it.
fn text(run: &str, addresses: &[String]) -> String {
    let first = addresses.first().map_or(ANY_LOCAL_PORT, String::as_str);
    let settings = format!(r#"{{mode: \"client\", connect: {{endpoints: [\"{first}\"]}}}}"#);
    let connect = format!(r#"s = zenoh.open(zenoh.Config.from_json5("{settings}"))"#);
    let watch = format!(r#"w = s.declare_subscriber("lockstep/{run}/**")"#);
    let print = "[print(v.key_expr, v.payload.to_string()) for v in w]";
    format!(
        "live: run {run} at {}\nhelp: watch it with python3 -c {}",
        addresses.join(", "),
        printable::shell_word(format!("import zenoh; {connect}; {watch}; {print}"))
    )
}

#[test]
fn the_console_tells_name_and_addresses_and_a_line_to_paste() {
    insta::assert_snapshot!(text("0123456789abcdef", &["tcp/127.0.0.1:41234".to_owned()]));
}
