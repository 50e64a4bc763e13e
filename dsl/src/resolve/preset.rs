//! The braces of an `fmu` line, and what instances lack at the start.

use std::collections::BTreeMap;

use fmi2::description::{Causality, Kind};

use super::assign::Role;
use super::fit::{Fitted, Meeting};
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::{BooleanExpression, Drive, Preset, RealExpression, Value};
use crate::source::Span;
use crate::syntax;

impl Scope<'_, '_> {
    /// The presets of each instance.
    pub fn presets(&self) -> Vec<Vec<Preset>> {
        (0..self.script.instances.len()).map(|instance| self.presets_of(instance)).collect()
    }

    fn presets_of(&self, instance: usize) -> Vec<Preset> {
        let mut seen: BTreeMap<usize, Span> = BTreeMap::new();
        let mut presets = Vec::new();
        for value in self.script.instances[instance].values {
            let Some(assigned) = self.preset(instance, value) else { continue };
            let twice = assigned.iter().find_map(|preset| seen.get(&preset.variable));
            if let Some(&first) = twice {
                let message = format!("`{}` gets two start values", self.text(value.key.span));
                let error = Diagnostic::error("E03", value.key.span, message).label(first, "the first");
                self.report(error.help("leave one of them"));
                continue;
            }
            seen.extend(assigned.iter().map(|preset| (preset.variable, value.key.span)));
            presets.extend(assigned);
        }
        presets
    }

    fn preset(&self, instance: usize, value: &syntax::Value) -> Option<Vec<Preset>> {
        let scope = self.at(self.script.instances[instance].frame);
        let at = Meeting { source: value.value.span, target: value.key.span, arrow: None };
        let tail = std::iter::once(syntax::Segment::Field(value.key.root.clone())).chain(value.key.tail.clone());
        let signal = scope.walk(instance, String::new(), &tail.collect::<Vec<_>>(), &value.key);
        let meaning = scope.evaluate_for(&value.value, signal.as_ref());
        let signal = self.touchable(Role::Preset, signal?, at);
        let (meaning, signal) = (meaning?, signal?);
        if !meaning.is_constant() {
            return self.refuse(self.must_be_known(value.value.span));
        }
        let assigned = self.assigned_ports(&meaning, &signal, at)?;
        Some(
            assigned
                .into_iter()
                .map(|(port, fitted)| Preset { variable: port.variable, value: constant(fitted) })
                .collect(),
        )
    }

    /// Warns of instances that draw the same random numbers.
    pub fn warn_of_equal_noise(&self, presets: &[Vec<Preset>]) {
        let instances = &self.script.instances;
        let mut first_of: BTreeMap<(usize, String), usize> = BTreeMap::new();
        for (later, declared) in instances.iter().enumerate() {
            let Some(noise) = self.noise(later, presets) else { continue };
            let twin = *first_of.entry((declared.unit_index, format!("{noise:?}"))).or_insert(later);
            if twin != later {
                let (first, second) = (&instances[twin], declared);
                let message = format!("`{}` and `{}` draw the same random numbers", first.name, second.name);
                let warning = Diagnostic::warning("W03", second.word.span, message)
                    .label(first.word.span, "same seed and stream");
                self.report(warning.help("give one of them another `stream`"));
            }
        }
    }

    /// Seed and stream of an instance, as far as its unit has them.
    fn noise(&self, instance: usize, presets: &[Vec<Preset>]) -> Option<[Option<Value>; 2]> {
        let description = self.description(instance)?;
        let value = |name: &str| {
            let variable = description.variable(name)?;
            let declared = &description.variables[variable];
            let preset = presets[instance].iter().find(|preset| preset.variable == variable);
            let start = match declared.kind {
                Kind::Integer { start, .. } => start.map(Value::Integer),
                Kind::Real(ref real) => real.start.map(Value::Real),
                _ => None,
            };
            (declared.causality == Causality::Parameter).then(|| preset.map(|preset| preset.value.clone()).or(start))?
        };
        let seed = value("seed")?;
        Some([Some(seed), value("stream")])
    }
}

/// A value that is known, out of what a run would compute.
fn constant(fitted: Fitted) -> Value {
    match fitted {
        Fitted::File(file) => Value::File(file),
        Fitted::Drive(Drive::Real(RealExpression::Constant(value))) => Value::Real(value),
        Fitted::Drive(Drive::Integer(value)) => Value::Integer(value),
        Fitted::Drive(Drive::Boolean(BooleanExpression::Constant(value))) => Value::Boolean(value),
        Fitted::Drive(Drive::String(text)) => Value::String(text),
        Fitted::Drive(other) => unreachable!("a value that is known before the run reads no signal: {other:?}"),
    }
}
