//! The inputs of a unit under test: its start values, to which a Real input adds a small wave, so that its state counts.

use crate::run::worker::scattered::set_slots;
use flatten::values::{ValueType, Values, start_value};
use flatten::wiring::VariableSlot;
use fmi2::description::{Causality, Kind, Limits, ModelDescription, RealVariable, TypeKind, Variable};
use unit::board::Now;
use unit::failure::Failure;
use unit::instance::Instance;

/// The part of a start value by which an input varies.
const PART: f64 = 0.05;
/// The angle in radians that the wave advances in a step, that the waves of two inputs differ by, and those of two variations.
const ANGLES: [f64; 3] = [0.7, 1.0, 1.9];

/// The inputs of a unit.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    slots: Vec<VariableSlot>,
    /// Their start values.
    values: Values,
    /// In the order of the Reals of `values`.
    waves: Vec<Wave>,
}

/// A wave between two values, in the variable's own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    from: f64,
    to: f64,
}

impl Inputs {
    /// The inputs that have a start value, and all Real ones.
    pub fn of(description: &ModelDescription) -> Self {
        let mut inputs = Self::default();
        let variables = description.variables.iter().enumerate();
        for (index, variable) in variables.filter(|(_, variable)| variable.causality == Causality::Input) {
            match &variable.kind {
                Kind::Real(real) => inputs.waves.push(wave(description, variable, real)),
                _ if variable.has_start() => {}
                _ => continue,
            }
            let slot = inputs.values.add(ValueType::of(variable));
            inputs.values.store(slot, &start_value(variable));
            inputs.slots.push(VariableSlot { slot, variable: index });
        }
        inputs
    }

    /// Sets all inputs of an instance for the step that begins at a tick.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn set(&self, instance: &mut Instance, now: &Now<'_>, variation: usize, tick: u64) -> Result<(), Failure> {
        let reals = self.waves.iter().enumerate().map(|(nth, wave)| wave.at(tick, nth, variation)).collect();
        set_slots(instance, now, &self.slots, &Values { reals, ..self.values.clone() })
    }
}

impl Wave {
    fn at(self, tick: u64, input: usize, variation: usize) -> f64 {
        let [step, between_inputs, between_variations] = ANGLES;
        // The remainder keeps the angle exact enough for any length of a run.
        let angle =
            (tick % 100_000) as f64 * step + input as f64 * between_inputs + variation as f64 * between_variations;
        self.from + (self.to - self.from) * (0.5 + 0.5 * libm::sin(angle))
    }
}

/// A wave on the side of the start value where the limits leave room.
fn wave(description: &ModelDescription, variable: &Variable, real: &RealVariable) -> Wave {
    let Limits { min, max, .. } = description.limits_of(variable);
    let (low, high) = (min.unwrap_or(f64::NEG_INFINITY), max.unwrap_or(f64::INFINITY));
    let declared = variable.declared_type.as_deref().and_then(|name| description.simple_type(name));
    let inherited = match declared.map(|declared| &declared.kind) {
        Some(TypeKind::Real(inherited)) => inherited.nominal,
        _ => None,
    };
    let nominal = real.nominal.or(inherited).unwrap_or(1.0);
    let from = real.start.unwrap_or(0.0);
    let size = PART * if from == 0.0 { nominal } else { from.abs() };
    let to = if from + size <= high { from + size } else { (from - size).max(low) };
    Wave { from, to }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi2::description::RealAttributes;

    fn wave_of(start: Option<f64>, min: Option<f64>, max: Option<f64>, nominal: Option<f64>) -> (f64, f64) {
        let attributes = RealAttributes { min, max, nominal, ..RealAttributes::default() };
        let real = RealVariable { start, attributes, ..RealVariable::default() };
        let mut variable = crate::example::description().variables.swap_remove(0);
        variable.kind = Kind::Real(real.clone());
        let Wave { from, to } = wave(&ModelDescription::default(), &variable, &real);
        (from, to)
    }

    #[test]
    fn a_real_input_varies_a_little_from_its_start_and_stays_within_its_limits() {
        assert_eq!(wave_of(None, None, None, None), (0.0, 0.05));
        assert_eq!(wave_of(Some(-20.0), None, None, None), (-20.0, -19.0));
        assert_eq!(wave_of(Some(0.0), None, None, Some(100.0)), (0.0, 5.0));
        assert_eq!(wave_of(Some(20.0), Some(0.0), Some(20.0), None), (20.0, 19.0));
        assert_eq!(wave_of(Some(20.0), Some(20.0), Some(20.0), None), (20.0, 20.0));
        let wave = Wave { from: 1.0, to: 2.0 };
        let values: Vec<_> = (0..50).map(|tick| wave.at(tick, 0, 0)).collect();
        assert!(values.iter().all(|value| (1.0..=2.0).contains(value)), "{values:?}");
        assert!(values.windows(2).all(|pair| pair[0] != pair[1]), "{values:?}");
        assert_ne!(wave.at(3, 0, 0), wave.at(3, 1, 0));
        assert_ne!(wave.at(3, 0, 0), wave.at(3, 0, 1));
    }
}
