//! Sets and reads variables of an instance whose values are not contiguous, with one call for each type.

use flatten::values::{ValueType, Values};
use flatten::wiring::VariableSlot;
use unit::board::Now;
use unit::failure::Failure;
use unit::handles::Handles;
use unit::instance::Instance;

/// Sets these variables to the values of their slots.
pub(crate) fn set_slots(
    instance: &mut Instance,
    now: &Now<'_>,
    slots: &[VariableSlot],
    values: &Values,
) -> Result<(), Failure> {
    let [reals, integers, booleans, texts] = by_type(slots);
    let [real, integer, boolean, text] =
        [&reals, &integers, &booleans, &texts].map(|of_type| handles(instance, &of_type.variables));
    instance.set_real(now, &real, &reals.out_of(&values.reals))?;
    instance.set_integer(now, &integer, &integers.out_of(&values.integers))?;
    instance.set_boolean(now, &boolean, &booleans.out_of(&values.booleans))?;
    instance.set_string(now, &text, &texts.out_of(&values.texts))
}

/// Reads these variables into their slots.
pub(crate) fn get_slots(
    instance: &mut Instance,
    now: &Now<'_>,
    slots: &[VariableSlot],
    values: &mut Values,
) -> Result<(), Failure> {
    let [reals, integers, booleans, texts] = by_type(slots);
    let [real, integer, boolean, text] =
        [&reals, &integers, &booleans, &texts].map(|of_type| handles(instance, &of_type.variables));
    reals.fetch(&mut values.reals, |to| instance.get_real(now, &real, to))?;
    integers.fetch(&mut values.integers, |to| instance.get_integer(now, &integer, to))?;
    booleans.fetch(&mut values.booleans, |to| instance.get_boolean(now, &boolean, to))?;
    texts.fetch(&mut values.texts, |to| instance.get_string(now, &text, to))
}

/// The handles of variables that were taken from the unit's description.
pub(super) fn handles(instance: &Instance, variables: &[usize]) -> Handles {
    let handles = instance.handles(variables.iter().copied());
    handles.unwrap_or_else(|| unreachable!("`{}` has no such variables: {variables:?}", instance.name()))
}

/// Variables of one type whose values are not contiguous.
struct Scattered {
    variables: Vec<usize>,
    at: Vec<usize>,
}

fn by_type(slots: &[VariableSlot]) -> [Scattered; 4] {
    [ValueType::Real, ValueType::Integer, ValueType::Boolean, ValueType::Text].map(|base| {
        let of_type = slots.iter().filter(|variable| variable.slot.base == base);
        let (variables, at) = of_type.map(|variable| (variable.variable, variable.slot.index)).unzip();
        Scattered { variables, at }
    })
}

impl Scattered {
    fn out_of<T: Clone>(&self, values: &[T]) -> Vec<T> {
        self.at.iter().map(|&at| values[at].clone()).collect()
    }

    fn fetch<T: Clone>(
        &self,
        values: &mut [T],
        get: impl FnOnce(&mut [T]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut got = self.out_of(values);
        get(&mut got)?;
        for (&at, value) in self.at.iter().zip(got) {
            values[at] = value;
        }
        Ok(())
    }
}

#[test]
fn variables_are_read_by_type_and_their_values_stored_in_their_slots() {
    use flatten::values::Slot;
    let slot = |base, index, variable| VariableSlot { slot: Slot { base, index }, variable };
    let (real, integer) = (ValueType::Real, ValueType::Integer);
    let [reals, integers, booleans, texts] = by_type(&[slot(real, 3, 30), slot(integer, 0, 31), slot(real, 1, 10)]);
    assert_eq!((reals.variables.as_slice(), integers.variables.as_slice()), ([30, 10].as_slice(), [31].as_slice()));
    assert!(booleans.variables.is_empty() && texts.variables.is_empty());
    let mut values = [0.0, 1.0, 2.0, 3.0];
    assert_eq!(reals.out_of(&values), [3.0, 1.0]);
    let answered = reals.fetch(&mut values, |to| {
        to.copy_from_slice(&[30.0, 10.0]);
        Ok(())
    });
    assert_eq!((answered, values), (Ok(()), [0.0, 10.0, 2.0, 30.0]));
}
