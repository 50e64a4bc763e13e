//! The hand-written loop over units of almost no cost, with which the benchmarks compare.

mod make;
pub mod table;

pub use make::packed;

use dsl::scenario::{Connection, Drive, Instance as Planned, Port, Scenario};
use fmi2::description::{Causality, ModelDescription};
use std::error::Error;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use unit::archive::unpack;
use unit::board::{Board, BoardLayout};
use unit::failure::Failure;
use unit::instance::{Instance, Setting};
use unit::library::Library;
use unit::time::seconds;

/// The communication step of all benchmarks.
pub const STEP_NS: u64 = 1_000_000;

/// The unit's name in scenarios.
pub const UNIT: &str = "linked";
/// The folder of the unpacked unit.
const UNPACKED: &str = "unit";

/// A unit with as many Real inputs as outputs.
pub struct Unit {
    pub description: ModelDescription,
    pub library: Arc<Library>,
    /// Indices of variables.
    pub inputs: Vec<usize>,
    pub outputs: Vec<usize>,
    pub board: Board,
    folder: TempDir,
}

impl Unit {
    /// A unit in C, of the least possible cost.
    pub fn in_c(ports: usize) -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let description = make::in_c(ports, &folder.path().join(UNPACKED))?;
        Self::load(folder, description)
    }

    /// A unit made by the export layer.
    pub fn exported(ports: usize) -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let unpacked = unpack(&packed(ports)?, &folder.path().join(UNPACKED))?;
        Self::load(folder, unpacked.description)
    }

    fn load(folder: TempDir, description: ModelDescription) -> Result<Self, Box<dyn Error>> {
        let board = Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 })?;
        let library = Library::load(&folder.path().join(UNPACKED), &description, &board.note(0), 0)?;
        let with = |causality| {
            let variables = description.variables.iter().enumerate();
            variables.filter(move |(_, variable)| variable.causality == causality).map(|(index, _)| index).collect()
        };
        let (inputs, outputs) = (with(Causality::Input), with(Causality::Output));
        Ok(Self { inputs, outputs, description, library: Arc::new(library), board, folder })
    }

    /// The folder of the unpacked unit.
    pub fn folder(&self) -> PathBuf {
        self.folder.path().join(UNPACKED)
    }

    /// So many instances in initialization mode.
    pub fn instances(&self, count: usize) -> Result<Vec<Instance>, Box<dyn Error>> {
        let note = self.board.note(0);
        let make = |index: usize| {
            let sink = Arc::new(|_| {});
            let setting = Setting { name: "unit", index, note: note.clone(), sink, logging_on: false, calls: None };
            let mut instance = Instance::instantiate(&self.library, setting)?;
            instance.setup_experiment(&note.at(0, 0.0))?;
            instance.enter_initialization_mode(&note.at(0, 0.0))?;
            Ok(instance)
        };
        (0..count).map(make).collect::<Result<_, Failure>>().map_err(to_error)
    }

    /// So many instances for so many ticks, all outputs of a source linked to all inputs of its target by `->`.
    pub fn linked(&self, count: usize, ticks: u64, links: impl Iterator<Item = (usize, usize)>) -> Scenario {
        let instance =
            |index| Planned { name: format!("unit{index}"), unit: 0, every: 1, wave: 0, presets: Vec::new() };
        let link = |(source, target): (usize, usize)| {
            self.inputs.iter().zip(&self.outputs).map(move |(&input, &output)| Connection {
                target: Port { instance: target, variable: input },
                source: Drive::Copy(Port { instance: source, variable: output }),
                direct: false,
            })
        };
        Scenario {
            title: "Linked".to_owned(),
            step_ns: STEP_NS,
            start_tick: 0,
            stop_tick: ticks,
            parameters: Vec::new(),
            sweep: None,
            units: vec![dsl::scenario::Unit { name: UNIT.to_owned() }],
            instances: (0..count).map(instance).collect(),
            initialization: Vec::new(),
            connections: links.flat_map(link).collect(),
            events: Vec::new(),
            stop_when: None,
            seed: 0,
            conditions: Vec::new(),
            shared: Vec::new(),
            claims: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Steps a chain by one set, one step and one get for each unit and tick, on plain arrays.
    pub fn by_hand(&self, units: usize, ticks: u64) -> Result<Duration, Box<dyn Error>> {
        self.by_hand_with(units, ticks, |_, _| Ok(()))
    }

    /// The same; `visit` gets time and outputs of each tick.
    pub fn by_hand_with(
        &self,
        units: usize,
        ticks: u64,
        mut visit: impl FnMut(f64, &[f64]) -> io::Result<()>,
    ) -> Result<Duration, Box<dyn Error>> {
        let mut instances = self.instances(units)?;
        let note = self.board.note(0);
        for instance in &mut instances {
            instance.exit_initialization_mode(&note.at(0, 0.0)).map_err(to_error)?;
        }
        let functions = *self.library.functions();
        let components: Vec<_> = instances.iter().map(Instance::component).collect();
        let references = |variables: &[usize]| -> Vec<u32> {
            variables.iter().map(|&variable| self.description.variables[variable].value_reference).collect()
        };
        let (inputs, outputs) = (references(&self.inputs), references(&self.outputs));
        let count = inputs.len();
        let mut input_values = vec![0.0; units * count];
        let mut output_values = vec![0.0; units * count];
        let mut failed = 0;
        let begun = Instant::now();
        for tick in 0..ticks {
            let time_s = seconds(tick, STEP_NS);
            let links = (units - 1) * count;
            input_values[count..].copy_from_slice(&output_values[..links]);
            visit(time_s, &output_values)?;
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
}

/// Converts a failure into an error that ends the benchmark.
pub fn to_error(failure: Failure) -> Box<dyn Error> {
    failure.to_string().into()
}
