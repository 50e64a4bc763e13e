//! The outputs of a unit under test, and how two rows of them differ.

use crate::run::start_values::value_text;
use crate::run::worker::scattered::get_slots;
use flatten::values::{ValueType, Values};
use flatten::wiring::VariableSlot;
use fmi2::description::{Causality, ModelDescription, Variability, Variable};
use unit::board::Now;
use unit::failure::Failure;
use unit::instance::Instance;

/// What is compared: the outputs, or of a unit without outputs all other variables that may change.
#[derive(Debug)]
pub(super) struct Ports {
    /// In the order of the description.
    slots: Vec<VariableSlot>,
    /// A row before it is read.
    empty: Values,
    /// The names of all variables.
    names: Vec<String>,
}

impl Ports {
    pub fn of(description: &ModelDescription) -> Self {
        let variables = || description.variables.iter().enumerate();
        let has_outputs = variables().any(|(_, variable)| variable.causality == Causality::Output);
        let changes = |variability| matches!(variability, Variability::Discrete | Variability::Continuous);
        let is_compared = |variable: &Variable| {
            let role = if has_outputs { Causality::Output } else { Causality::Local };
            variable.causality == role && (has_outputs || changes(variable.variability))
        };
        let mut empty = Values::default();
        let slots = variables()
            .filter(|(_, variable)| is_compared(variable))
            .map(|(index, variable)| VariableSlot { slot: empty.add(ValueType::of(variable)), variable: index })
            .collect();
        Self { slots, empty, names: variables().map(|(_, variable)| variable.name.clone()).collect() }
    }

    /// Reads a row.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn get(&self, instance: &mut Instance, now: &Now<'_>) -> Result<Values, Failure> {
        let mut row = self.empty.clone();
        get_slots(instance, now, &self.slots, &mut row)?;
        Ok(row)
    }

    /// The first variable that differs, as text: `y is 1.2, was 1.3`.
    pub fn difference(&self, is: &Values, was: &Values) -> Option<String> {
        let VariableSlot { slot, variable } = *self.slots.iter().find(|port| !is.is_same(was, port.slot))?;
        Some(format!("{} is {}, was {}", self.names[variable], value_text(is, slot), value_text(was, slot)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_variable_that_differs_is_named_with_both_values() {
        let mut empty = Values::default();
        let types = [ValueType::Real, ValueType::Integer, ValueType::Real];
        let slots = (0..).zip(types).map(|(variable, base)| VariableSlot { slot: empty.add(base), variable }).collect();
        let ports = Ports { slots, empty, names: ["y", "mode", "x"].map(str::to_owned).to_vec() };
        let row = |y, x, mode| Values { reals: vec![y, x], integers: vec![mode], ..Values::default() };
        let difference = |is, was| ports.difference(&is, &was);
        assert_eq!(difference(row(1.0, f64::NAN, 2), row(1.0, -f64::NAN, 2)), None);
        assert_eq!(difference(row(1.0, 0.5, 2), row(1.0, 1.3, 3)).as_deref(), Some("mode is 2, was 3"));
        assert_eq!(difference(row(1.0, 0.5, 2), row(1.0, 1.3, 2)).as_deref(), Some("x is 0.5, was 1.3"));
        assert_eq!(difference(row(-0.0, 0.5, 2), row(0.0, 0.5, 2)).as_deref(), Some("y is -0, was 0"));
    }
}
