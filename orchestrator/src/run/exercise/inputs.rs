//! The inputs of a unit under test: its start values, to which a Real input adds a small wave, so that its state counts.

use fmi2::description::{Causality, Kind, ModelDescription, RealVariable, TypeKind, Variable};
use unit::board::Now;
use unit::failure::Failure;
use unit::handles::Handles;
use unit::instance::Instance;

/// The part of a start value by which an input varies.
const PART: f64 = 0.05;
/// The angle in radians that the wave advances in a step, that the waves of two inputs differ by, and those of two variations.
const ANGLES: [f64; 3] = [0.7, 1.0, 1.9];

/// The inputs of a unit, by type.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    reals: Vec<(usize, Wave)>,
    integers: (Vec<usize>, Vec<i32>),
    booleans: (Vec<usize>, Vec<i32>),
    texts: (Vec<usize>, Vec<String>),
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
                Kind::Real(real) => inputs.reals.push((index, wave(description, variable, real))),
                Kind::Integer { start: Some(start), .. } | Kind::Enumeration { start: Some(start), .. } => {
                    inputs.integers.0.push(index);
                    inputs.integers.1.push(*start);
                }
                Kind::Boolean { start: Some(start) } => {
                    inputs.booleans.0.push(index);
                    inputs.booleans.1.push(i32::from(*start));
                }
                Kind::String { start: Some(start) } => {
                    inputs.texts.0.push(index);
                    inputs.texts.1.push(start.clone());
                }
                _ => {}
            }
        }
        inputs
    }

    /// Sets all inputs of an instance for the step that begins at a tick.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn set(&self, instance: &mut Instance, now: &Now<'_>, variation: usize, tick: u64) -> Result<(), Failure> {
        let values: Vec<f64> =
            self.reals.iter().enumerate().map(|(nth, (_, wave))| wave.at(tick, nth, variation)).collect();
        let reals = handles(instance, self.reals.iter().map(|(variable, _)| *variable));
        let [integers, booleans, texts] =
            [&self.integers.0, &self.booleans.0, &self.texts.0].map(|of| handles(instance, of.iter().copied()));
        instance.set_real(now, &reals, &values)?;
        instance.set_integer(now, &integers, &self.integers.1)?;
        instance.set_boolean(now, &booleans, &self.booleans.1)?;
        instance.set_string(now, &texts, &self.texts.1)
    }
}

/// The handles of variables of the unit's own description.
pub(super) fn handles(instance: &Instance, variables: impl IntoIterator<Item = usize>) -> Handles {
    instance.handles(variables).unwrap_or_else(|| unreachable!("the variables are those of its description"))
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
    let declared = variable.declared_type.as_deref().and_then(|name| description.simple_type(name));
    let inherited = match declared.map(|declared| &declared.kind) {
        Some(TypeKind::Real(inherited)) => Some(inherited),
        _ => None,
    };
    let low = real.min.or(inherited.and_then(|real| real.min)).unwrap_or(f64::NEG_INFINITY);
    let high = real.max.or(inherited.and_then(|real| real.max)).unwrap_or(f64::INFINITY);
    let nominal = real.nominal.or(inherited.and_then(|real| real.nominal)).unwrap_or(1.0);
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
        let variable = crate::example::description().variables.swap_remove(0);
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
