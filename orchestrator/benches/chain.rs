//! What the step loop costs beside a hand-written loop through the same function pointers.
//!
//! `cargo bench -p orchestrator --bench chain` builds trivial units with the system's `cc`, chains them by `->` and steps
//! the chain by both loops in turn, nothing recorded. The hand-written loop makes one set, one step and one get for each
//! unit and tick on plain arrays. Reported are the medians of nanoseconds for one step of one unit, and their ratio.
#![expect(unsafe_code, reason = "the hand-written loop calls through raw function pointers, as it must")]
#![expect(clippy::print_stdout, reason = "this is what a benchmark is for")]

use dsl::scenario::{Connection, Drive, Instance as Planned, Port, Scenario};
use fmi2::description::{
    Causality, CoSimulation, Kind, ModelDescription, RealAttributes, RealVariable, Variability, Variable,
};
use orchestrator::claims::{Claims, Standing};
use orchestrator::step_loop::{StepLoop, Wishes, Witness};
use orchestrator::unit::board::{Board, BoardLayout};
use orchestrator::unit::instance::{Instance, Moment, Setting};
use orchestrator::unit::library::Library;
use orchestrator::wiring::{Wiring, seconds};
use orchestrator::worker::{InProcess, Seating, Worker};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

const STEP_NS: u64 = 1_000_000;
const START: Moment = Moment { tick: 0, time_s: 0.0 };
const BLOCKS: usize = 15;
/// Steps of units in one block.
const BLOCK_STEPS: u64 = 1_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    println!("{:>6} {:>6} {:>14} {:>14} {:>6}", "units", "ports", "by hand ns", "step loop ns", "ratio");
    for (units, ports) in [(10, 1), (10, 30), (100, 1), (1000, 1), (1000, 30)] {
        let bench = Bench::new(units, ports)?;
        let ticks = BLOCK_STEPS / units as u64;
        let [mut by_hand, mut by_loop] = [Vec::new(), Vec::new()];
        for _ in 0..BLOCKS {
            by_hand.push(bench.by_hand(ticks)?);
            by_loop.push(bench.by_loop(ticks)?);
        }
        let per_step = |durations: &mut Vec<Duration>| {
            durations.sort();
            durations[durations.len() / 2].as_secs_f64() * 1e9 / (ticks * units as u64) as f64
        };
        let (by_hand, by_loop) = (per_step(&mut by_hand), per_step(&mut by_loop));
        println!("{units:>6} {ports:>6} {by_hand:>14.1} {by_loop:>14.1} {:>6.2}", by_loop / by_hand);
    }
    Ok(())
}

struct Bench {
    ports: usize,
    units: usize,
    description: ModelDescription,
    library: Arc<Library>,
    board: Board,
    _folder: tempfile::TempDir,
}

impl Bench {
    fn new(units: usize, ports: usize) -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let binaries =
            folder.path().join("binaries").join(if cfg!(target_arch = "x86_64") { "linux64" } else { "aarch64-linux" });
        fs::create_dir_all(&binaries)?;
        compile(ports, &binaries.join(format!("chain{ports}.so")))?;
        let board = Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 })?;
        let description = description(ports);
        let library = Library::load(folder.path(), &description, &board.note(0), 0)
            .map_err(|error| format!("loading the unit of the benchmark: {error}"))?;
        Ok(Self { ports, units, description, library: Arc::new(library), board, _folder: folder })
    }

    fn instances(&self) -> Result<Vec<Instance>, Box<dyn Error>> {
        let make = |index: usize| {
            let setting =
                Setting { name: "unit", index, note: self.board.note(0), sink: Arc::new(|_| {}), logging_on: false };
            let mut instance = Instance::instantiate(&self.library, setting)?;
            instance.setup_experiment(START)?;
            instance.enter_initialization_mode(START)?;
            Ok(instance)
        };
        (0..self.units)
            .map(make)
            .collect::<Result<_, orchestrator::failure::Failure>>()
            .map_err(|failure| format!("making the units of the benchmark: {failure:?}").into())
    }

    fn by_hand(&self, ticks: u64) -> Result<Duration, Box<dyn Error>> {
        let mut instances = self.instances()?;
        for instance in &mut instances {
            instance.exit_initialization_mode(START).map_err(|failure| format!("{failure:?}"))?;
        }
        let functions = *self.library.functions();
        let components: Vec<_> = instances.iter().map(Instance::component).collect();
        let count = self.ports;
        let [inputs, outputs] = [0, count].map(|from| (from as u32..(from + count) as u32).collect::<Vec<_>>());
        let mut input_values = vec![0.0; self.units * count];
        let mut output_values = vec![0.0; self.units * count];
        let mut failed = 0;
        let begun = Instant::now();
        for tick in 0..ticks {
            let time_s = seconds(tick, STEP_NS);
            let links = (self.units - 1) * count;
            input_values[count..].copy_from_slice(&output_values[..links]);
            for (index, &component) in components.iter().enumerate() {
                let at = index * count;
                let (set, get) = (&input_values[at..at + count], &mut output_values[at..at + count]);
                // SAFETY: the component is the library's, and each slice has `count` elements.
                unsafe {
                    failed |= (functions.set_real)(component, inputs.as_ptr(), count, set.as_ptr());
                    failed |= (functions.do_step)(component, time_s, 1e-3, 1);
                    failed |= (functions.get_real)(component, outputs.as_ptr(), count, get.as_mut_ptr());
                }
            }
        }
        let took = begun.elapsed();
        assert_eq!(failed, 0, "no call of the hand-written loop fails");
        Ok(took)
    }

    fn by_loop(&self, ticks: u64) -> Result<Duration, Box<dyn Error>> {
        let scenario = self.scenario(ticks);
        let wiring = Wiring::new(&scenario, &vec![&self.description; self.units], &vec![0; self.units]);
        let claims = Claims::new(&[], ticks, &mut |port| wiring.place(port));
        let seatings = self.instances()?.into_iter().enumerate();
        let seatings = seatings.map(|(index, instance)| Seating { index, instance }).collect();
        let worker: Box<dyn Worker> = Box::new(InProcess::new(&wiring, seatings));
        let witness = Nobody { board: &self.board };
        let mut run = StepLoop::new(wiring, claims, vec![worker], Wishes::default(), witness);
        let begun = Instant::now();
        let finish = run.run();
        let took = begun.elapsed();
        assert_eq!(finish.map(|finish| finish.last_tick), Ok(ticks), "the run of the benchmark is complete");
        Ok(took)
    }

    fn scenario(&self, ticks: u64) -> Scenario {
        let instance = |index| Planned {
            name: format!("unit{index}"),
            unit: "chain".to_owned(),
            every: 1,
            wave: 0,
            presets: Vec::new(),
        };
        let link = |target: usize| {
            (0..self.ports).map(move |port| Connection {
                target: Port { instance: target, variable: port },
                source: Drive::Copy(Port { instance: target - 1, variable: self.ports + port }),
                direct: false,
            })
        };
        Scenario {
            title: "A chain".to_owned(),
            step_ns: STEP_NS,
            stop_tick: ticks,
            parameters: Vec::new(),
            instances: (0..self.units).map(instance).collect(),
            initialization: Vec::new(),
            connections: (1..self.units).flat_map(link).collect(),
            events: Vec::new(),
            rises: Vec::new(),
            claims: Vec::new(),
            columns: Vec::new(),
        }
    }
}

/// As in a run, the tick and the wish to stop stand on a board; nothing is recorded.
struct Nobody<'a> {
    board: &'a Board,
}

impl Witness for Nobody<'_> {
    fn reached(&mut self, tick: u64) {
        self.board.set_tick(tick);
    }
    fn stop_requested(&self) -> bool {
        self.board.stop_requested()
    }
    fn row(&mut self, _: u64, _: &[u64]) {}
    fn claim(&mut self, _: usize, _: Standing) {}
}

fn compile(ports: usize, library: &Path) -> Result<(), Box<dyn Error>> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/chain/unit.c");
    let status = Command::new("cc")
        .args(["-O2", "-shared", "-fPIC", "-fvisibility=hidden"])
        .arg(format!("-DPORTS={ports}"))
        .arg("-o")
        .arg(library)
        .arg(source)
        .status()?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("cc could not build the unit of the benchmark: {status}").into())
    }
}

fn description(ports: usize) -> ModelDescription {
    let variable = |reference: usize| Variable {
        position: Default::default(),
        name: format!("{}[{}]", if reference < ports { "u" } else { "y" }, reference % ports + 1),
        value_reference: reference as u32,
        description: None,
        causality: if reference < ports { Causality::Input } else { Causality::Output },
        variability: Variability::Continuous,
        initial: None,
        declared_type: None,
        kind: Kind::Real(RealVariable {
            start: (reference < ports).then_some(0.0),
            attributes: RealAttributes::default(),
            ..RealVariable::default()
        }),
    };
    ModelDescription {
        co_simulation: Some(CoSimulation { model_identifier: format!("chain{ports}"), ..CoSimulation::default() }),
        variables: (0..2 * ports).map(variable).collect(),
        ..ModelDescription::default()
    }
}
