//! What units say of the experiments that they were made for, compared with the run of a script.

use std::collections::BTreeSet;

use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::duration;

/// Periods that differ by less are equal, in seconds: ticks are whole nanoseconds.
const ROUNDING_S: f64 = 1e-9;

impl Scope<'_, '_> {
    /// Warns of units whose experiment does not begin at zero, once for each unit, and of instances with a fixed step whose
    /// period, in ticks of `step_ns`, is another one.
    pub fn warn_of_other_experiments(&self, periods: &[u64], step_ns: u64) {
        let mut seen = BTreeSet::new();
        for (index, instance) in self.script.instances.iter().enumerate() {
            let Some(description) = self.description(index) else { continue };
            let Some(experiment) = description.default_experiment else { continue };
            let (name, unit) = (&instance.name, &instance.unit);
            let start_s = experiment.start_time.filter(|start_s| *start_s != 0.0 && start_s.is_finite());
            if let Some(start_s) = start_s.filter(|_| seen.insert(&unit.text)) {
                let message = format!(
                    "the DefaultExperiment of unit `{}` begins at {start_s} s, the run of a script at 0 s",
                    unit.text
                );
                let help = "make sure that it computes the right thing from 0 s on; `lockstep simulate` begins where a \
                            unit's experiment does";
                self.report(Diagnostic::warning("W07", unit.span, message).help(help));
            }
            let is_fixed = description
                .co_simulation
                .as_ref()
                .is_some_and(|unit| !unit.can_handle_variable_communication_step_size);
            let own_s = experiment.step_size.filter(|own_s| is_fixed && *own_s > 0.0 && own_s.is_finite());
            let period_ns = periods[index].saturating_mul(step_ns);
            if let Some(own_s) = own_s.filter(|own_s| (own_s - seconds(period_ns)).abs() > ROUNDING_S) {
                let message = format!(
                    "`{name}` takes steps of {own_s} s only, as canHandleVariableCommunicationStepSize is false, but here it \
                     takes steps of {}",
                    duration(period_ns)
                );
                let warning = Diagnostic::warning("W08", instance.word.span, message);
                self.report(warning.help(format!("write `every {own_s} s` or `step {own_s} s`")));
            }
        }
    }
}

fn seconds(ns: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "exact up to 104 days; beyond, rounded once")]
    let ns = ns as f64;
    ns / 1e9
}
