//! What a run costs from the command line to its files, beside a hand-written loop, real time and patience.
//!
//! `cargo bench -p orchestrator --bench whole_process` runs the built `lockstep` on chains of units of the export layer,
//! recording nothing and everything, in turn with the hand-written loop over the same units; then `first_flight`; then
//! the shortest run of its units.
#![expect(unsafe_code, reason = "the hand-written loop calls through raw function pointers, as it must")]
#![expect(clippy::print_stdout, reason = "this is what a benchmark is for")]

#[path = "../peer/mod.rs"]
#[expect(dead_code, reason = "shared with the other benchmark")]
mod peer;

use peer::table::{Table, alternate};
use peer::{Unit, packed};
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const UNITS: usize = 10;
const BLOCKS: usize = 9;
const FIRST_FLIGHT_S: f64 = 84.0;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let table = Table::begin("a step of a unit; a whole run, beside a loop by hand");
    for (ports, ticks) in [(1, 500_000), (30, 100_000)] {
        let unit = Unit::exported(ports)?;
        let script = folder.path().join(format!("chain_{ports}.scn"));
        fs::write(&script, chain(&packed(ports)?, ticks)?)?;
        let run = |arguments: &[&str]| lockstep(&script, folder.path(), arguments);
        for (what, arguments, limit) in [("nothing", &["--record", "none"][..], 1.25), ("everything", &[], 3.0)] {
            let name = format!("{UNITS} units, {ports} in and {ports} out, {what} recorded");
            let measure = || alternate(BLOCKS, || run(arguments), || unit.by_hand(UNITS, ticks));
            table.row(&name, Some(limit), || Ok(measure()?.each(UNITS as u64 * ticks)))?;
        }
    }
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let of = |peer_s: f64| move || Ok(Duration::from_secs_f64(peer_s));
    let table = Table::begin("\na run as a user sees it");
    let script = repository.join("scenarios/first_flight.scn");
    let run = |script: &Path| lockstep(script, &repository, &[]);
    let flight = || alternate(BLOCKS, || run(&script), of(FIRST_FLIGHT_S));
    table.row("first_flight, beside real time", Some(1.0 / 200.0), flight)?;
    let script = folder.path().join("start.scn");
    let units = ["trajectory", "wind", "quadcopter_controller", "quadcopter"];
    let instances: String = (0..).zip(units).map(|(i, unit)| format!("fmu u{i} = \"{unit}\"\n")).collect();
    fs::write(&script, format!("scenario \"Start\"\nstep 5 ms\nstop 5 ms\n{instances}record u3.height\n"))?;
    let start = || alternate(2 * BLOCKS, || run(&script), of(1.0));
    table.row("one tick of its four packed units, beside a second", Some(0.2), start)?;
    Ok(())
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

/// Runs a script from a folder; its results go away with the next run.
fn lockstep(script: &Path, from: &Path, arguments: &[&str]) -> Result<Duration, Box<dyn Error>> {
    let out: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("whole_process");
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
    // Without a claim, or with claims that hold.
    if run.status.success() { Ok(took) } else { Err(String::from_utf8_lossy(&run.stderr).into()) }
}
