//! Units made of closures, behind the worker's trait, and a builder of scripts.

mod description;
mod seen;

pub use description::description;

use dsl::scenario::{
    Column, Connection, Drive, Event, Formula, InitialStep, Instance, Port, RealExpression, Scenario, Set, TickWindow,
    Unit,
};
use flatten::values::Values;
use flatten::wiring::{Change, InstancePorts, Plan, VariableSlot};
use fmi2::calls::Call;
use orchestrator::run::message::Finish;
use orchestrator::run::run_options::RunOptions;
use orchestrator::run::step_loop::{Checkpoint, StepLoop};
use orchestrator::run::worker::{Lost, Order, Reply, Shutdown, Terminated, Ticket, Worker};
use results::verdict::{Standing, Verdict};
use seen::Seen;
use std::cell::RefCell;
use std::rc::Rc;
use unit::failure::{Cause, Doing, Failure};

/// Variables of every fake unit.
pub const U: usize = 0;
pub const V: usize = 1;
pub const P: usize = 2;
pub const Y: usize = 3;

/// What a step does.
pub struct Step {
    pub u: f64,
    pub p: f64,
    pub tick: u64,
    /// How many steps there were before this one.
    pub before: u32,
}

pub enum Answer {
    Value(f64),
    Terminated { y: f64, last_successful_time_s: f64 },
    Error,
}

pub struct Fake {
    every: u64,
    wave: usize,
    behaviour: Box<dyn FnMut(&Step) -> Answer>,
}

pub fn unit(every: u64, wave: usize, mut y: impl FnMut(&Step) -> f64 + 'static) -> Fake {
    Fake { every, wave, behaviour: Box::new(move |step| Answer::Value(y(step))) }
}

pub fn answering(every: u64, wave: usize, behaviour: impl FnMut(&Step) -> Answer + 'static) -> Fake {
    Fake { every, wave, behaviour: Box::new(behaviour) }
}

/// A unit whose y counts its steps.
pub fn counter(every: u64, wave: usize) -> Fake {
    unit(every, wave, |step| f64::from(step.before + 1))
}

/// A unit whose y is the u of its last step.
pub fn repeater(every: u64, wave: usize) -> Fake {
    unit(every, wave, |step| step.u)
}

pub fn port(instance: usize, variable: usize) -> Port {
    Port { instance, variable }
}

pub fn signal(instance: usize) -> RealExpression {
    RealExpression::Signal(port(instance, Y))
}

/// A script over fake units; steps take a second, the run ends at tick 6 and the ports of the columns are recorded.
pub struct Script {
    pub scenario: Scenario,
    pub worker_of: Vec<usize>,
    pub fail_fast: bool,
    pub stop_requested_at: Option<u64>,
    pub units: Vec<Fake>,
    /// The ticks at which the run is saved.
    pub saves: Vec<u64>,
    /// Where the run continues.
    pub from: Option<Checkpoint>,
}

pub struct Ran {
    pub result: Result<Finish, Failure>,
    /// For each row its values.
    pub rows: Vec<Vec<f64>>,
    pub verdicts: Vec<Verdict>,
    pub standings: Vec<Standing>,
    pub checkpoints: Vec<Checkpoint>,
    /// The windows that opened and closed.
    pub changes: Vec<Change>,
    /// The calls of the workers, in order.
    pub asked: Vec<String>,
}

impl Ran {
    pub fn column(&self, column: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[column]).collect()
    }
}

impl Script {
    pub fn new(units: Vec<Fake>) -> Self {
        let instance = |(index, unit): (usize, &Fake)| Instance {
            name: char::from(b'a' + u8::try_from(index).unwrap()).to_string(),
            unit: 0,
            every: unit.every,
            wave: unit.wave,
            presets: Vec::new(),
        };
        let scenario = Scenario {
            title: String::new(),
            step_ns: 1_000_000_000,
            start_tick: 0,
            stop_tick: 6,
            parameters: Vec::new(),
            sweep: None,
            units: vec![Unit { name: String::new() }],
            instances: units.iter().enumerate().map(instance).collect(),
            initialization: Vec::new(),
            connections: Vec::new(),
            events: Vec::new(),
            stop_when: None,
            seed: 0,
            conditions: Vec::new(),
            shared: Vec::new(),
            claims: Vec::new(),
            columns: Vec::new(),
        };
        let (worker_of, saves) = (vec![0; units.len()], Vec::new());
        Self { scenario, worker_of, fail_fast: false, stop_requested_at: None, units, saves, from: None }
    }

    pub fn connect(mut self, from: usize, to: usize, direct: bool) -> Self {
        let source = Drive::Copy(port(from, Y));
        self.scenario.connections.push(Connection { target: port(to, U), source, direct });
        self
    }

    pub fn compute(mut self, source: RealExpression, to: Port, direct: bool) -> Self {
        self.scenario.connections.push(Connection { target: to, source: Drive::Real(source), direct });
        self
    }

    pub fn at(mut self, from: u64, until: Option<u64>, target: Port, value: RealExpression) -> Self {
        let set = Set { target, value: Drive::Real(value) };
        self.scenario.events.push(Event::at(from, until.map(|until| until - from), vec![set]));
        self
    }

    pub fn initially(mut self, step: InitialStep) -> Self {
        self.scenario.initialization.push(step);
        self
    }

    pub fn record(mut self, ports: &[(usize, usize)]) -> Self {
        let column = |&(instance, variable)| Column::of_port("", port(instance, variable));
        self.scenario.columns.extend(ports.iter().map(column));
        self
    }

    pub fn always(mut self, body: Formula) -> Self {
        let formula = Formula::Always(TickWindow { from: 0, to: None }, Box::new(body));
        self.scenario.claims.push(dsl::scenario::Claim::of(formula));
        self
    }

    pub fn on_workers(mut self, worker_of: &[usize]) -> Self {
        self.worker_of = worker_of.to_vec();
        self
    }

    pub fn run(self) -> Ran {
        let description = description();
        let descriptions = vec![&description; self.units.len()];
        let plan = Plan::new(&self.scenario, &descriptions, &self.worker_of);
        let asked = Rc::new(RefCell::new(Vec::new()));
        let units: Vec<_> = self.units.into_iter().map(|unit| Rc::new(RefCell::new(unit))).collect();
        let worker = |index| -> Box<dyn Worker> {
            Box::new(FakeWorker::new(index, &plan, &self.worker_of, &units, Rc::clone(&asked)))
        };
        let workers = (0..=self.worker_of.iter().copied().max().unwrap_or(0)).map(worker).collect();
        let mut seen = Seen {
            columns: self.scenario.columns.len(),
            rows: Vec::new(),
            first_row: self.from.as_ref().map_or(0, |checkpoint| checkpoint.tick + 1),
            standings: Vec::new(),
            tick: 0,
            stop_at: self.stop_requested_at,
            saves: self.saves,
            checkpoints: Vec::new(),
            changes: Vec::new(),
        };
        seen.standings.resize(self.scenario.claims.len(), None);
        let options = RunOptions { fail_fast: self.fail_fast, record: true, ..RunOptions::default() };
        let result = StepLoop::new(plan, workers, options, &mut seen).run(self.from.as_ref());
        let standings: Vec<_> = seen.standings.into_iter().flatten().collect();
        let verdicts = standings.iter().map(|standing| standing.verdict).collect();
        let asked = asked.borrow().clone();
        Ran {
            result,
            rows: seen.rows,
            verdicts,
            standings,
            checkpoints: seen.checkpoints,
            changes: seen.changes,
            asked,
        }
    }
}

/// Computes at the order and passes results at the reply, as a worker in another process does.
struct FakeWorker {
    index: usize,
    plan: Vec<(Vec<usize>, u64)>,
    ports: Vec<InstancePorts>,
    units: Vec<Rc<RefCell<Fake>>>,
    mine: Vec<usize>,
    steps: Vec<u32>,
    results: Vec<f64>,
    lost: Vec<Option<Lost>>,
    terminated: Vec<Vec<Terminated>>,
    initial: Vec<f64>,
    asked: Rc<RefCell<Vec<String>>>,
}

impl FakeWorker {
    fn new(
        index: usize,
        plan: &Plan,
        worker_of: &[usize],
        units: &[Rc<RefCell<Fake>>],
        asked: Rc<RefCell<Vec<String>>>,
    ) -> Self {
        let count = units.len();
        Self {
            index,
            plan: plan.groups.iter().map(|group| (group.instances.clone(), group.every)).collect(),
            ports: plan.ports.clone(),
            units: units.to_vec(),
            mine: (0..count).filter(|&instance| worker_of[instance] == index).collect(),
            steps: vec![0; count],
            results: vec![0.0; count],
            lost: vec![None; plan.groups.len()],
            terminated: vec![Vec::new(); plan.groups.len()],
            initial: vec![0.0; count],
            asked,
        }
    }

    fn input(&self, instance: usize, variable: usize, inputs: &Values, otherwise: f64) -> f64 {
        let span = &self.ports[instance].inputs.reals;
        let position = span.variables.iter().position(|&has| has == variable);
        position.map_or(otherwise, |position| inputs.reals[span.start + position])
    }

    fn show(&self, instance: usize, y: f64, outputs: &mut Values) {
        let span = &self.ports[instance].outputs.reals;
        for (at, &variable) in span.range().zip(&span.variables) {
            assert_eq!(variable, Y);
            outputs.reals[at] = y;
        }
    }
}

impl Worker for FakeWorker {
    fn set_initial(&mut self, instance: usize, slots: &[VariableSlot], inputs: &Values) -> Result<(), Lost> {
        assert!(self.mine.contains(&instance));
        for variable in slots {
            // Initially y is u, so that initialization can be followed along connections.
            self.initial[instance] = inputs.reals[variable.slot.index];
        }
        Ok(())
    }

    fn get_initial(&mut self, instance: usize, slots: &[VariableSlot], outputs: &mut Values) -> Result<(), Lost> {
        for VariableSlot { slot, variable } in slots {
            outputs.reals[slot.index] = if *variable == P { 7.0 } else { self.initial[instance] + 1.0 };
        }
        Ok(())
    }

    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost> {
        self.mine.iter().for_each(|&instance| self.show(instance, self.initial[instance], outputs));
        Ok(())
    }

    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost> {
        self.asked.borrow_mut().push(format!("{} order {}", order.tick, self.index));
        for instance in self.plan[order.group].0.clone() {
            assert!(self.mine.contains(&instance));
            let step = Step {
                u: self.input(instance, U, order.inputs, 0.0),
                p: self.input(instance, P, order.inputs, 7.0),
                tick: order.tick,
                before: self.steps[instance],
            };
            self.steps[instance] += 1;
            let answer = (self.units[instance].borrow_mut().behaviour)(&step);
            match answer {
                Answer::Value(y) => self.results[instance] = y,
                Answer::Terminated { y, last_successful_time_s } => {
                    self.results[instance] = y;
                    self.terminated[order.group].push(Terminated { instance, last_successful_time_s });
                }
                Answer::Error => {
                    let failure = Failure {
                        instance: Some(instance.to_string()),
                        doing: Doing::Call(Call::DoStep),
                        time_s: Some(order.tick as f64),
                        cause: Cause::Status(3),
                    };
                    self.lost[order.group].get_or_insert(Lost { instance, failure });
                }
            }
        }
        Ok(Ticket { group: order.group })
    }

    fn reply(&mut self, ticket: Ticket, due_tick: u64, outputs: &mut Values) -> Result<Reply, Lost> {
        self.asked.borrow_mut().push(format!("{due_tick} reply {}", self.index));
        if let Some(lost) = self.lost[ticket.group].take() {
            return Err(lost);
        }
        for &instance in &self.plan[ticket.group].0 {
            self.show(instance, self.results[instance], outputs);
        }
        Ok(Reply { terminated: std::mem::take(&mut self.terminated[ticket.group]) })
    }

    fn save(&mut self, _: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost> {
        let state = |&instance: &usize| (self.steps[instance], self.results[instance]);
        Ok(self.mine.iter().map(|instance| (*instance, postcard::to_stdvec(&state(instance)).unwrap())).collect())
    }

    fn restore(&mut self, _: u64, states: &[(usize, &[u8])]) -> Result<(), Lost> {
        assert!(states.iter().map(|(instance, _)| instance).eq(&self.mine));
        for &(instance, state) in states {
            let cause = Cause::Other("no state of mine".to_owned());
            let doing = Doing::Call(Call::DeSerializeFmuState);
            let failure = || Failure { instance: Some(instance.to_string()), doing, time_s: None, cause };
            let read = postcard::from_bytes(state).map_err(|_| Lost { instance, failure: failure() })?;
            (self.steps[instance], self.results[instance]) = read;
        }
        Ok(())
    }

    fn finish(&mut self, _: u64, _: Shutdown) -> Result<(), Lost> {
        Ok(())
    }
}
