//! Measures whole runs from the command line to the files, in comparison with a hand-written loop and with real time.
//!
//! `cargo bench -p orchestrator --bench whole_process` runs the built `lockstep`:
//! - on chains of units of the export layer, recording nothing and everything, in turn with the hand-written loop over the
//!   same units, which writes nothing or the same numbers; the cost of that writing to the loop is measured too;
//! - on `first_flight`, in one process and with a process for each instance, and on the shortest runs;
//! - for the memory of a worker;
//! - with `--live`, without and with a subscriber, in comparison with the same run without `--live`. The subscriber is a
//!   Python program in `.venv`, which `tests/run` makes.
#![expect(unsafe_code, reason = "the hand-written loop calls through raw function pointers, as it must")]
#![expect(clippy::print_stdout, reason = "this is what a benchmark is for")]

#[path = "../peer/mod.rs"]
#[expect(dead_code, reason = "shared with the other benchmark")]
mod peer;

use peer::table::{Table, alternate};
use peer::{Unit, packed};
use std::cell::RefCell;
use std::error::Error;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const UNITS: usize = 10;
const BLOCKS: usize = 9;
const FIRST_FLIGHT_S: f64 = 84.0;

type Took = Result<Duration, Box<dyn Error>>;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let table = Table::begin("a step of a unit; a whole run, beside a loop by hand");
    let one =
        Chains { ports: 1, unrecorded: 2_000_000, recorded: 500_000, limit: Some(3.0), limit_beside_writing: None };
    chains(&table, folder.path(), &one)?;
    // 540 numbers a tick, half of them new: their text alone takes longer than three loops that do not write.
    let many =
        Chains { ports: 30, unrecorded: 500_000, recorded: 50_000, limit: None, limit_beside_writing: Some(1.8) };
    chains(&table, folder.path(), &many)?;
    let table = Table::begin("\na run as a user sees it");
    user_runs(&table, folder.path())?;
    let table = Table::begin("\na run that can be watched, beside one that cannot");
    watched(&table, folder.path())
}

/// Chains of units that are measured.
struct Chains {
    /// Inputs, and outputs, of each unit.
    ports: usize,
    /// Ticks of a run without a trace.
    unrecorded: u64,
    /// Ticks of a run with one.
    recorded: u64,
    /// How many times as long as the loop by hand a run may take that records everything.
    limit: Option<f64>,
    /// The same beside a loop that writes the numbers too.
    limit_beside_writing: Option<f64>,
}

fn chains(table: &Table, folder: &Path, chains: &Chains) -> Result<(), Box<dyn Error>> {
    let &Chains { ports, unrecorded, recorded, limit, limit_beside_writing } = chains;
    let (archive, unit) = (packed(ports)?, Unit::exported(ports)?);
    let run = |ticks, arguments: &[&str]| {
        let script = folder.join(format!("chain_{ports}_{ticks}.scn"));
        fs::write(&script, chain(&archive, ticks)?)?;
        lockstep(&script, folder, arguments)
    };
    let row = |what: &str, limit, ticks, run: &dyn Fn() -> Took, by_hand: &dyn Fn() -> Took| {
        let name = format!("{UNITS} units, {ports} in and {ports} out, {what}");
        table.row(&name, limit, || Ok(alternate(BLOCKS, run, by_hand)?.each(UNITS as u64 * ticks)))
    };
    let nothing = || run(unrecorded, &["--record", "none"]);
    row("nothing recorded", Some(1.25), unrecorded, &nothing, &|| unit.by_hand(UNITS, unrecorded))?;
    let everything = || run(recorded, &[]);
    row("everything recorded", limit, recorded, &everything, &|| unit.by_hand(UNITS, recorded))?;
    let writes = || by_hand_recorded(&unit, recorded, &folder.join("by_hand.csv"));
    row("everything recorded, beside one that writes", limit_beside_writing, recorded, &everything, &writes)?;
    let by_hand = || unit.by_hand(UNITS, recorded);
    row("by hand with writing, beside without", None, recorded, &writes, &by_hand)?;
    Ok(())
}

/// The hand-written loop writes the numbers that `lockstep run` writes: time, and both ends of all connections. The two ends
/// are equal, so it formats each number once: the least possible work.
fn by_hand_recorded(unit: &Unit, ticks: u64, trace: &Path) -> Took {
    let mut out = BufWriter::with_capacity(1 << 18, File::create(trace)?);
    let links = (UNITS - 1) * unit.inputs.len();
    let mut text = Vec::new();
    unit.by_hand_with(UNITS, ticks, |time_s, outputs| {
        let mut digits = zmij::Buffer::new();
        out.write_all(digits.format(time_s).as_bytes())?;
        text.clear();
        for value in &outputs[..links] {
            text.push(b',');
            text.extend_from_slice(digits.format(*value).as_bytes());
        }
        out.write_all(&text)?;
        out.write_all(&text)?;
        out.write_all(b"\n")
    })
}

/// Measures runs as a user waits for them.
fn user_runs(table: &Table, folder: &Path) -> Result<(), Box<dyn Error>> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let run = |script: &Path| lockstep(script, &repository, &[]);
    let of = |peer_s: f64| move || Ok(Duration::from_secs_f64(peer_s));
    let flight = repository.join("scenarios/first_flight.scn");
    let measure = || alternate(BLOCKS, || run(&flight), of(FIRST_FLIGHT_S));
    table.row("first_flight, beside real time", Some(1.0 / 200.0), measure)?;
    let isolated = |script: &Path| lockstep(script, &repository, &["--isolate"]);
    let measure = || alternate(BLOCKS, || isolated(&flight), of(FIRST_FLIGHT_S));
    table.row("first_flight --isolate, beside real time", Some(1.0 / 5.0), measure)?;
    let script = folder.join("start.scn");
    let starting = |count| {
        let units = ["trajectory", "wind", "quadcopter_controller", "quadcopter"].into_iter().cycle();
        let instances: String = (0..count).zip(units).map(|(i, unit)| format!("fmu u{i} = \"{unit}\"\n")).collect();
        fs::write(&script, format!("scenario \"Start\"\nstep 5 ms\nstop 5 ms\n{instances}record u0.leg\n"))
    };
    starting(4)?;
    let measure = || alternate(2 * BLOCKS, || run(&script), of(1.0));
    table.row("one tick of its four packed units, beside a second", Some(0.2), measure)?;
    for count in [5, 50] {
        starting(count)?;
        let name = format!("one tick of {count} units --isolate, beside a second");
        table.row(&name, None, || alternate(BLOCKS, || isolated(&script), of(1.0)))?;
    }
    println!(
        "\nmemory of a worker of first_flight, with the quadcopter: {}",
        memory_of_a_worker(&flight, &repository)?
    );
    Ok(())
}

/// The memory of the last worker of a run: all of its pages, and those that it shares with no other process.
fn memory_of_a_worker(script: &Path, from: &Path) -> Result<String, Box<dyn Error>> {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("whole_process");
    let mut run = Command::new(env!("CARGO_BIN_EXE_lockstep"))
        .arg("run")
        .arg(script)
        .args(["--isolate", "--pace", "1", "--out"])
        .arg(out)
        .current_dir(from)
        .stderr(Stdio::null())
        .spawn()?;
    sleep(Duration::from_secs(3));
    let children = fs::read_to_string(format!("/proc/{0}/task/{0}/children", run.id()))?;
    let rollup =
        children.split_whitespace().last().map(|worker| fs::read_to_string(format!("/proc/{worker}/smaps_rollup")));
    run.kill()?;
    run.wait()?;
    let rollup = rollup.ok_or("the run has no workers")??;
    let megabytes = |key: &str| -> f64 {
        let lines =
            rollup.lines().filter_map(|line| line.strip_prefix(key)?.split_whitespace().next()?.parse::<f64>().ok());
        lines.sum::<f64>() / 1024.0
    };
    let own = megabytes("Private_Clean:") + megabytes("Private_Dirty:");
    Ok(format!("{:.1} MB resident, {own:.1} MB its own", megabytes("Rss:")))
}

/// Measures the cost of live values, where a tick is a few calls and where it is a round of messages anyway.
fn watched(table: &Table, folder: &Path) -> Result<(), Box<dyn Error>> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let script = folder.join("long_flight.scn");
    let flight = fs::read_to_string(repository.join("scenarios/first_flight.scn"))?;
    for (suffix, placement, stop) in [("", None, "stop 840 s"), (", --isolate", Some("--isolate"), "stop 84 s")] {
        fs::write(&script, flight.replace("stop 84 s", stop))?;
        let with = |option: Option<&str>| {
            let arguments: Vec<_> = placement.into_iter().chain(option).collect();
            lockstep(&script, &repository, &arguments)
        };
        let without_subscriber = || alternate(BLOCKS, || with(Some("--live")), || with(None));
        table.row(&format!("nobody watches{suffix}"), Some(1.05), without_subscriber)?;
        let endpoint = format!("unixsock-stream/{}", folder.join("watch.sock").display());
        let option = format!("--live={endpoint}");
        let with_subscriber = || {
            let watcher = RefCell::new(Watcher::start(&repository, &endpoint)?);
            let run = || {
                let took = with(Some(&option))?;
                watcher.borrow_mut().await_run()?;
                Ok(took)
            };
            alternate(BLOCKS, run, || with(None))
        };
        table.row(&format!("one watches{suffix}"), Some(1.35), with_subscriber)?;
    }
    Ok(())
}

/// A process that subscribes to each run at an endpoint; killed when dropped.
struct Watcher {
    process: Child,
    runs: BufReader<ChildStdout>,
}

impl Watcher {
    fn start(repository: &Path, endpoint: &str) -> Result<Self, Box<dyn Error>> {
        let python = repository.join(".venv/bin/python");
        let program = repository.join("orchestrator/benches/whole_process/watcher.py");
        let mut command = Command::new(&python);
        let mut process = command
            .arg(program)
            .arg(endpoint)
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("cannot start {}, which tests/run makes: {error}", python.display()))?;
        let runs = process.stdout.take().ok_or("its standard output is a pipe")?;
        Ok(Self { process, runs: BufReader::new(runs) })
    }

    /// Waits until it has received a message of a new run.
    fn await_run(&mut self) -> Result<(), Box<dyn Error>> {
        let read = self.runs.read_line(&mut String::new())?;
        if read == 0 { Err("the one who watches is gone".into()) } else { Ok(()) }
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A chain in which every value changes in every step.
fn chain(unit: &Path, ticks: u64) -> Result<String, Box<dyn Error>> {
    let mut script = format!("scenario \"A chain\"\nstep 1 ms\nstop {ticks} ms\n");
    for i in 0..UNITS {
        writeln!(script, "fmu u{i} = \"{}\"", unit.display())?;
    }
    for i in 1..UNITS {
        writeln!(script, "u{}.taken -> u{i}.given", i - 1)?;
    }
    Ok(script)
}

/// Runs a script from a folder; its results are removed before the next run begins.
fn lockstep(script: &Path, from: &Path, arguments: &[&str]) -> Took {
    let out: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("whole_process");
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    let begun = Instant::now();
    let run = Command::new(env!("CARGO_BIN_EXE_lockstep"))
        .arg("run")
        .arg(script)
        .args(arguments)
        .arg("--out")
        .arg(out)
        .current_dir(from)
        .stdin(Stdio::null())
        .output()?;
    let took = begun.elapsed();
    // The exit code is 0 if all claims hold or there are none.
    if run.status.success() { Ok(took) } else { Err(String::from_utf8_lossy(&run.stderr).into()) }
}
