//! The outputs of a unit under test, and how two rows of them differ.

use super::inputs::handles;
use flatten::values::{ValueType, Values};
use fmi2::description::{Causality, ModelDescription, Variability};
use results::shortest_decimal;
use unit::board::Now;
use unit::failure::Failure;
use unit::instance::Instance;

/// What is compared: the outputs, or of a unit without outputs all other variables that may change.
#[derive(Debug)]
pub(super) struct Ports {
    reals: Vec<usize>,
    integers: Vec<usize>,
    booleans: Vec<usize>,
    texts: Vec<usize>,
    /// The names of all variables.
    names: Vec<String>,
}

impl Ports {
    pub fn of(description: &ModelDescription) -> Self {
        let variables = || description.variables.iter().enumerate();
        let has_outputs = variables().any(|(_, variable)| variable.causality == Causality::Output);
        let changes = |variability| matches!(variability, Variability::Discrete | Variability::Continuous);
        let of_type = |base| {
            let compared = variables().filter(|(_, variable)| {
                let role = if has_outputs { Causality::Output } else { Causality::Local };
                variable.causality == role && (has_outputs || changes(variable.variability))
            });
            compared.filter(|(_, variable)| ValueType::of(variable) == base).map(|(index, _)| index).collect()
        };
        Self {
            reals: of_type(ValueType::Real),
            integers: of_type(ValueType::Integer),
            booleans: of_type(ValueType::Boolean),
            texts: of_type(ValueType::Text),
            names: variables().map(|(_, variable)| variable.name.clone()).collect(),
        }
    }

    /// Reads a row.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn get(&self, instance: &mut Instance, now: &Now<'_>) -> Result<Values, Failure> {
        let mut row = Values {
            reals: vec![0.0; self.reals.len()],
            integers: vec![0; self.integers.len()],
            booleans: vec![0; self.booleans.len()],
            texts: vec![String::new(); self.texts.len()],
        };
        let [reals, integers, booleans, texts] = [&self.reals, &self.integers, &self.booleans, &self.texts]
            .map(|variables| handles(instance, variables.iter().copied()));
        instance.get_real(now, &reals, &mut row.reals)?;
        instance.get_integer(now, &integers, &mut row.integers)?;
        instance.get_boolean(now, &booleans, &mut row.booleans)?;
        instance.get_string(now, &texts, &mut row.texts)?;
        Ok(row)
    }

    /// The first variable that differs, as text: `y is 1.2, was 1.3`. Reals are compared bit by bit, but any two NaN are
    /// equal.
    pub fn difference(&self, is: &Values, was: &Values) -> Option<String> {
        let same_real = |a: &f64, b: &f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        let boolean = |value: &i32| if *value == 0 { "false" } else { "true" }.to_owned();
        let reals = first(&self.reals, &is.reals, &was.reals, same_real, |value| shortest_decimal(*value));
        let integers = first(&self.integers, &is.integers, &was.integers, i32::eq, i32::to_string);
        let booleans = first(&self.booleans, &is.booleans, &was.booleans, i32::eq, boolean);
        let texts = first(&self.texts, &is.texts, &was.texts, String::eq, |text| format!("{text:?}"));
        let found = [reals, integers, booleans, texts].into_iter().flatten().min_by_key(|(variable, ..)| *variable);
        found.map(|(variable, is, was)| format!("{} is {is}, was {was}", self.names[variable]))
    }
}

/// The first variable whose values differ, with both.
fn first<T>(
    variables: &[usize],
    is: &[T],
    was: &[T],
    same: impl Fn(&T, &T) -> bool,
    text: impl Fn(&T) -> String,
) -> Option<(usize, String, String)> {
    let mut pairs = variables.iter().zip(is.iter().zip(was));
    pairs.find(|(_, (is, was))| !same(is, was)).map(|(&variable, (is, was))| (variable, text(is), text(was)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_variable_that_differs_is_named_with_both_values() {
        let names = ["y", "mode", "x"].map(str::to_owned).to_vec();
        let ports = Ports { reals: vec![0, 2], integers: vec![1], booleans: vec![], texts: vec![], names };
        let row = |y, x, mode| Values { reals: vec![y, x], integers: vec![mode], ..Values::default() };
        let difference = |is, was| ports.difference(&is, &was);
        assert_eq!(difference(row(1.0, f64::NAN, 2), row(1.0, -f64::NAN, 2)), None);
        assert_eq!(difference(row(1.0, 0.5, 2), row(1.0, 1.3, 3)).as_deref(), Some("mode is 2, was 3"));
        assert_eq!(difference(row(1.0, 0.5, 2), row(1.0, 1.3, 2)).as_deref(), Some("x is 0.5, was 1.3"));
        assert_eq!(difference(row(-0.0, 0.5, 2), row(0.0, 0.5, 2)).as_deref(), Some("y is -0, was 0"));
    }
}
