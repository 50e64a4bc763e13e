//! A unit under test: access to its variables by index in the description, and to its steps without the C interface.

use super::moves::others;
use crate::body::Body;
use crate::library::{Library, Unit};
use crate::model::{Context, Fault, Outcome};
use crate::step::{Step, Time};
use crate::visitor::Value;
use fmi2::description::{Causality, Kind, ModelDescription, Variable};

/// Step length if the unit declares none, in seconds.
const STEP_S: f64 = 0.01;
/// Stop time if the unit declares none, in seconds.
const STOP_S: f64 = 10.0;

/// A unit that is set, stepped and read by a test.
pub(super) struct Subject {
    pub(super) step_s: f64,
    pub(super) stop_s: f64,
    body: Body,
}

impl Subject {
    pub(super) fn new(library: &'static Library) -> Self {
        let body = Body::new(library);
        let experiment = body.described().description.default_experiment.unwrap_or_default();
        let (step_s, stop_s) = (experiment.step_size.unwrap_or(STEP_S), experiment.stop_time.unwrap_or(STOP_S));
        Self { step_s, stop_s, body }
    }

    pub(super) fn description(&self) -> &ModelDescription {
        &self.body.described().description
    }

    pub(super) fn variables(&self, wanted: impl Fn(&Variable) -> bool) -> Vec<usize> {
        let indexed = self.description().variables.iter().enumerate();
        indexed.filter(|(_, variable)| wanted(variable)).map(|(index, _)| index).collect()
    }

    pub(super) fn outputs(&self) -> Vec<usize> {
        self.variables(|variable| variable.causality == Causality::Output)
    }

    pub(super) fn name(&self, variable: usize) -> &str {
        &self.description().variables[variable].name
    }

    pub(super) fn get(&self, variable: usize) -> Value {
        let variable = &self.description().variables[variable];
        let slot = variable.value_reference as usize;
        match variable.kind {
            Kind::Real(_) => Value::Real(self.body.real(slot)),
            Kind::Integer { .. } | Kind::Enumeration { .. } => Value::Integer(self.body.integer(slot)),
            Kind::Boolean { .. } => Value::Boolean(self.body.boolean(slot)),
            Kind::String { .. } => Value::String(self.body.string(slot).to_owned()),
        }
    }

    pub(super) fn set(&mut self, variable: usize, value: &Value) {
        let slot = self.description().variables[variable].value_reference as usize;
        match value {
            Value::Real(value) => self.body.set_real(slot, *value),
            Value::Integer(value) => self.body.set_integer(slot, *value),
            Value::Boolean(value) => self.body.set_boolean(slot, *value),
            Value::String(value) => self.body.set_string(slot, value),
        }
    }

    pub(super) fn init(&mut self, start_s: f64) -> Result<(), Fault> {
        self.body.init(&mut Context { start_s, ..Context::default() })
    }

    pub(super) fn step(&mut self, start_s: f64, length_s: f64) -> Result<(), Fault> {
        let step = Step::new(Time::from_s(start_s), Time::from_s(length_s));
        let outcome = self.body.unit_mut().step(step, &mut Context::default())?;
        self.body.outputs(match outcome {
            Outcome::Done => step.end_s(),
            Outcome::AcceptedUntil(time_s) | Outcome::Terminated(time_s) => time_s,
        })
    }

    pub(super) fn compute_outputs(&mut self, time_s: f64) -> Result<(), Fault> {
        self.body.outputs(time_s)
    }

    /// Values other than the present one that a variable may have.
    pub(super) fn others(&self, variable: usize) -> Vec<Value> {
        others(self.description(), variable, &self.get(variable))
    }

    pub(super) fn save(&self) -> Box<dyn Unit> {
        self.body.unit().duplicate()
    }

    pub(super) fn restore(&mut self, saved: &dyn Unit) {
        self.body.unit_mut().copy_from(saved);
    }

    pub(super) fn bytes(&self) -> Result<Vec<u8>, postcard::Error> {
        self.body.unit().to_bytes()
    }

    pub(super) fn read_bytes(&mut self, bytes: &[u8]) -> Result<(), postcard::Error> {
        let unit = self.body.unit().read_from(bytes)?;
        self.restore(&*unit);
        Ok(())
    }
}
