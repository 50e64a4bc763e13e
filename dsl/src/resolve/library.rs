//! What the libraries of units require of the process that loads them.

use std::collections::BTreeMap;

use super::scope::Scope;
use crate::diagnostic::Diagnostic;

impl Scope<'_, '_> {
    /// Warns of a unit that needs another program, and refuses a second instance where a process can hold only one.
    pub fn requirements_of_libraries(&self) {
        let mut first_of = BTreeMap::new();
        for instance in &self.script.instances {
            let library = instance.description.as_ref().and_then(|description| description.co_simulation.as_ref());
            let Some(library) = library else { continue };
            let (name, span) = (&instance.unit.text, instance.unit.span);
            let first = *first_of.entry(instance.unit_index).or_insert(span);
            if first != span {
                if library.can_be_instantiated_only_once_per_process {
                    let message =
                        format!("unit `{name}` can be instantiated only once per process, and a run is one process");
                    self.report(Diagnostic::error("E26", span, message).label(first, "the first"));
                }
            } else if library.needs_execution_tool {
                let message = format!("unit `{name}` says that it needs another program to run");
                let warning = Diagnostic::warning("W05", span, message);
                self.report(warning.help("make sure that the program it was exported from is installed"));
            }
        }
    }
}
