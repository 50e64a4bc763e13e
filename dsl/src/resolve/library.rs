//! What the libraries of units require of the process that loads them.

use std::collections::BTreeMap;

use super::scope::Scope;
use crate::diagnostic::Diagnostic;

impl Scope<'_, '_> {
    /// Warns of a unit that needs another program, and refuses a second instance where a process can hold only one. Two
    /// files of the same unit, which name the same library, are one unit here.
    pub fn requirements_of_libraries(&self) {
        let mut first_of = BTreeMap::new();
        for (index, instance) in self.script.instances.iter().enumerate() {
            let Some(description) = instance.description.as_ref() else { continue };
            let Some(library) = description.co_simulation.as_ref() else { continue };
            let (name, span) = (&instance.unit.text, instance.unit.span);
            let (first, first_span) =
                *first_of.entry((&description.guid, &library.model_identifier)).or_insert((index, span));
            if first != index {
                if library.can_be_instantiated_only_once_per_process && !self.request.isolated {
                    let message =
                        format!("unit `{name}` can be instantiated only once per process, and this run is one process");
                    let error = Diagnostic::error("E26", span, message).label(first_span, "the first");
                    self.report(error.help("give each instance a process of its own: `--isolate`"));
                }
            } else if library.needs_execution_tool {
                let message = format!("unit `{name}` says that it needs another program to run");
                let warning = Diagnostic::warning("W05", span, message);
                self.report(warning.help("make sure that the program it was exported from is installed"));
            }
        }
    }
}
