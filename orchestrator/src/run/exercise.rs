//! A test of a unit by running it: each takes the place of a run in a stepping process, and compares every row with that
//! of a run in which nothing special happened.
//!
//! Rows, states and differences pass between the processes of one unit's tests as files in the private folder.

mod inputs;
mod row;

use super::board_observer;
use super::instantiate::{Instantiator, NewInstance, enter_initialization, set_up};
use crate::run::message::{Finish, Message, Reason};
use crate::run::run_spec::RunSpec;
use crate::run::worker::Instantiated;
use flatten::values::Values;
use fmi2::printable;
use inputs::Inputs;
use results::shortest_decimal;
use row::Ports;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use unit::board::{Board, Now};
use unit::failure::Failure;
use unit::instance::{Instance, StepResult};
use unit::time::seconds;

/// What a stepping process does with a unit. The first instance of the scenario gets the inputs of variation 0, the second
/// one those of variation 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Exercise {
    /// Runs one instance with the inputs of this variation and leaves its rows.
    Record(usize),
    /// Runs once more.
    Repeat,
    /// In the middle keeps the state in memory, goes on to the end, returns to the state and goes on once more.
    Return,
    /// The same with a serialized state.
    Restore,
    /// In the middle serializes the state and leaves it.
    Leave,
    /// Restores the state that another process left, and goes on.
    Continue,
    /// Runs to the end, resets the unit, and runs again.
    Reset,
    /// Runs two instances side by side.
    Together,
}

/// The rows of a run in which nothing special happened.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Recorded {
    /// The outputs after initialization and after each step.
    rows: Vec<Values>,
    /// Whether the unit ended the run itself.
    terminated: bool,
}

/// The file of the rows of a variation.
fn rows_file(home: &Path, variation: usize) -> PathBuf {
    home.join(format!("rows{variation}"))
}

fn state_file(home: &Path) -> PathBuf {
    home.join("state")
}

fn difference_file(home: &Path) -> PathBuf {
    home.join("difference")
}

/// Takes the difference that a test found, if it found one.
#[must_use]
pub fn take_difference(home: &Path) -> Option<String> {
    let file = difference_file(home);
    let found = std::fs::read_to_string(&file).ok();
    // Left over it would be taken for that of the next test.
    std::fs::remove_file(&file).ok();
    found
}

/// Does an exercise. What it finds is in a file before a unit is freed, so that a crash in the freeing cannot hide it.
pub fn perform(spec: &RunSpec, board: &Arc<Board>, exercise: Exercise) {
    let mut made = Vec::new();
    let report = |message| board_observer::message(board, &message);
    let mut bench = match Bench::new(spec, board, exercise) {
        Ok(bench) => bench,
        Err(text) => return report(Message::Broken(Failure::between_calls(0.0, text))),
    };
    let ended = bench.perform(exercise, &mut made).and_then(|()| bench.terminate(&mut made));
    let finish = Message::Finished(Finish { last_tick: bench.tick, reason: Reason::StopTime });
    report(match ended {
        Ok(()) => finish,
        Err(Stop::Broken(failure)) => Message::Broken(failure),
        Err(Stop::Differs(text)) => match std::fs::write(difference_file(&bench.home), text) {
            Ok(()) => finish,
            Err(error) => Message::Broken(Failure::between_calls(0.0, format!("cannot leave a result: {error}"))),
        },
    });
}

/// Why an exercise ends early.
enum Stop {
    Broken(Failure),
    /// A row is not that of the recorded run.
    Differs(String),
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Broken(failure)
    }
}

/// What an exercise works with.
struct Bench<'a> {
    spec: &'a RunSpec,
    board: &'a Board,
    instantiator: Instantiator<'a>,
    home: PathBuf,
    ports: Ports,
    inputs: Inputs,
    /// The recorded rows of each variation; none while they are recorded.
    recorded: Vec<Recorded>,
    /// The tick at which a run ends.
    stop_tick: u64,
    /// The tick that was reached.
    tick: u64,
    /// For each instance whether it ended the run with its last step.
    terminated: Vec<bool>,
    /// What has happened to the unit so far, for messages.
    after: &'static str,
}

impl<'a> Bench<'a> {
    fn new(spec: &'a RunSpec, board: &'a Arc<Board>, exercise: Exercise) -> Result<Self, String> {
        let home = spec.board.parent().unwrap_or(Path::new(".")).to_path_buf();
        let recorded = match exercise {
            Exercise::Record(_) => Vec::new(),
            Exercise::Together => vec![read(&rows_file(&home, 0))?, read(&rows_file(&home, 1))?],
            _ => vec![read(&rows_file(&home, 0))?],
        };
        let last_tick = |run: &Recorded| run.rows.len().saturating_sub(1) as u64;
        let description = &spec.unit(0).description;
        Ok(Self {
            instantiator: Instantiator {
                units: &spec.units,
                folder: &spec.folder,
                note: board.note(0),
                start_tick: 0,
                step_ns: spec.scenario.step_ns,
                sink: board_observer::sink(board),
            },
            ports: Ports::of(description),
            inputs: Inputs::of(description),
            stop_tick: recorded.iter().map(last_tick).min().unwrap_or(spec.scenario.stop_tick),
            tick: 0,
            terminated: vec![false; 2],
            after: "",
            spec,
            board,
            home,
            recorded,
        })
    }

    fn perform(&mut self, exercise: Exercise, made: &mut Vec<Instantiated>) -> Result<(), Stop> {
        let middle = self.stop_tick / 2;
        self.make(made, if exercise == Exercise::Together { 2 } else { 1 })?;
        match exercise {
            Exercise::Record(variation) => self.record(made, variation),
            Exercise::Repeat => self.run(made),
            Exercise::Together => {
                self.after = "beside another instance: ";
                self.run(made)
            }
            Exercise::Return => self.run_twice_from(made, middle, Instance::keep, |instance, now, kept| {
                instance.return_to(now, &kept)?;
                instance.forget(now, kept)
            }),
            Exercise::Restore => {
                self.run_twice_from(made, middle, Instance::save, |instance, now, state| instance.restore(now, &state))
            }
            Exercise::Leave => self.leave(made, middle),
            Exercise::Continue => self.continue_from(made, middle),
            Exercise::Reset => {
                self.run(made)?;
                self.reset(made)?;
                self.after = "after fmi2Reset: ";
                self.run(made)
            }
        }
    }

    /// Makes the first instances of the scenario and enters initialization.
    fn make(&self, made: &mut Vec<Instantiated>, count: usize) -> Result<(), Failure> {
        let instances =
            self.spec.scenario.instances.iter().enumerate().take(count).map(|(index, instance)| NewInstance {
                index,
                name: &instance.name,
                unit: instance.unit,
                presets: &instance.presets,
                log_calls: false,
            });
        self.instantiator.make(instances, made)?;
        enter_initialization(made, &self.instantiator.note, 0, self.instantiator.step_ns)
    }

    fn now(&self) -> Now<'_> {
        self.instantiator.note.at(self.tick, seconds(self.tick, self.spec.scenario.step_ns))
    }

    /// From initialization to the end, each row compared.
    fn run(&mut self, made: &mut [Instantiated]) -> Result<(), Stop> {
        self.initialize(made)?;
        self.go_on(made, self.stop_tick)
    }

    /// Leaves initialization; the rows at tick 0 are compared.
    fn initialize(&mut self, made: &mut [Instantiated]) -> Result<(), Stop> {
        self.tick = 0;
        for (variation, unit) in made.iter_mut().enumerate() {
            self.inputs.set(&mut unit.instance, &self.now(), variation, 0)?;
            unit.instance.exit_initialization_mode(&self.now())?;
        }
        self.terminated.fill(false);
        self.compare(made)
    }

    /// Steps up to a tick; each row is compared.
    fn go_on(&mut self, made: &mut [Instantiated], to: u64) -> Result<(), Stop> {
        while self.tick < to {
            self.step(made, 0)?;
            self.compare(made)?;
        }
        Ok(())
    }

    /// One step of each instance.
    fn step(&mut self, made: &mut [Instantiated], first_variation: usize) -> Result<(), Stop> {
        let step_s = seconds(1, self.spec.scenario.step_ns);
        for (index, unit) in made.iter_mut().enumerate() {
            self.inputs.set(&mut unit.instance, &self.now(), first_variation + index, self.tick)?;
        }
        for (index, unit) in made.iter_mut().enumerate() {
            let stepped = unit.instance.do_step_that_may_be_undone(&self.now(), step_s)?;
            self.terminated[index] = matches!(stepped, StepResult::Terminated { .. });
        }
        self.tick += 1;
        self.board.set_tick(self.tick);
        Ok(())
    }

    /// Compares the outputs of all instances with the recorded ones of this tick.
    fn compare(&self, made: &mut [Instantiated]) -> Result<(), Stop> {
        for (variation, unit) in made.iter_mut().enumerate() {
            let row = self.ports.get(&mut unit.instance, &self.now())?;
            let recorded = &self.recorded[variation];
            let was = recorded.rows.get(self.tick as usize);
            let is_last = self.tick + 1 == recorded.rows.len() as u64;
            let ending = match (self.terminated[variation], recorded.terminated && is_last) {
                (true, false) => Some("it ends the run, which it did not before".to_owned()),
                (false, true) => Some("it goes on, but ended the run before".to_owned()),
                _ => None,
            };
            if let Some(difference) = was.and_then(|was| self.ports.difference(&row, was)).or(ending) {
                let time = shortest_decimal(seconds(self.tick, self.spec.scenario.step_ns));
                return Err(Stop::Differs(format!("{}{difference}, at {time} s", self.after)));
            }
        }
        Ok(())
    }

    fn record(&mut self, made: &mut [Instantiated], variation: usize) -> Result<(), Stop> {
        let unit = &mut made[..1];
        self.inputs.set(&mut unit[0].instance, &self.now(), variation, 0)?;
        unit[0].instance.exit_initialization_mode(&self.now())?;
        let mut recorded = Recorded::default();
        recorded.rows.push(self.ports.get(&mut unit[0].instance, &self.now())?);
        while self.tick < self.stop_tick && !recorded.terminated {
            self.step(unit, variation)?;
            recorded.terminated = self.terminated[0];
            recorded.rows.push(self.ports.get(&mut unit[0].instance, &self.now())?);
        }
        self.write(&rows_file(&self.home, variation), &recorded)
    }

    /// Saves the state in the middle, runs to the end, restores the state, and runs to the end once more.
    fn run_twice_from<S>(
        &mut self,
        made: &mut [Instantiated],
        middle: u64,
        save: impl Fn(&mut Instance, &Now<'_>) -> Result<S, Failure>,
        restore: impl Fn(&mut Instance, &Now<'_>, S) -> Result<(), Failure>,
    ) -> Result<(), Stop> {
        self.initialize(made)?;
        self.go_on(made, middle)?;
        let state = save(&mut made[0].instance, &self.now())?;
        self.after = "after the state was saved: ";
        self.go_on(made, self.stop_tick)?;
        restore(&mut made[0].instance, &self.now(), state)?;
        self.after = "after the state was restored: ";
        self.tick = middle;
        self.go_on(made, self.stop_tick)
    }

    fn leave(&mut self, made: &mut [Instantiated], middle: u64) -> Result<(), Stop> {
        self.initialize(made)?;
        self.go_on(made, middle)?;
        let state = made[0].instance.save(&self.now())?;
        self.write(&state_file(&self.home), &state)
    }

    fn continue_from(&mut self, made: &mut [Instantiated], middle: u64) -> Result<(), Stop> {
        let state: Vec<u8> = read(&state_file(&self.home)).map_err(|text| Failure::between_calls(0.0, text))?;
        self.initialize(made)?;
        self.tick = middle;
        made[0].instance.restore(&self.now(), &state)?;
        self.after = "after the state was restored: ";
        self.go_on(made, self.stop_tick)
    }

    /// Resets the instance and takes it to initialization again.
    fn reset(&mut self, made: &mut [Instantiated]) -> Result<(), Stop> {
        made[0].instance.reset(&self.now())?;
        self.tick = 0;
        set_up(&mut made[0], &self.instantiator.note, 0, self.instantiator.step_ns)?;
        Ok(enter_initialization(made, &self.instantiator.note, 0, self.instantiator.step_ns)?)
    }

    /// Terminates and frees the instances, which is part of each test.
    fn terminate(&self, made: &mut Vec<Instantiated>) -> Result<(), Stop> {
        for unit in made.iter_mut() {
            unit.instance.terminate(&self.now())?;
        }
        made.clear();
        Ok(())
    }

    fn write(&self, file: &Path, content: &impl Serialize) -> Result<(), Stop> {
        let failed = |error: &dyn std::fmt::Display| {
            Stop::Broken(Failure::between_calls(0.0, format!("cannot write {}: {error}", printable::path(file))))
        };
        let bytes = postcard::to_stdvec(content).map_err(|error| failed(&error))?;
        std::fs::write(file, bytes).map_err(|error| failed(&error))
    }
}

fn read<T: DeserializeOwned>(file: &Path) -> Result<T, String> {
    let bytes = std::fs::read(file).map_err(|error| format!("cannot read {}: {error}", printable::path(file)))?;
    postcard::from_bytes(&bytes).map_err(|error| format!("cannot read {}: {error}", printable::path(file)))
}
