//! Names that a script declares and never uses.

use fmi2::description::Causality;

use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::Word;

impl Scope<'_, '_> {
    /// Warns of instances, `param`s and `let`s that nothing refers to.
    pub fn warn_of_unused_names(&self) {
        let script = &self.script;
        for instance in &script.instances {
            let variables = instance.description.iter().flat_map(|unit| &unit.variables);
            let mut ports = variables.filter(|it| matches!(it.causality, Causality::Input | Causality::Output));
            if ports.next().is_some() {
                self.warn_of_unused(
                    &instance.name,
                    instance.word,
                    "connect it, record or judge one of its ports, or drop the line",
                );
            }
        }
        for parameter in &script.parameters {
            let help = "write it where its value is meant to act, or drop the line";
            self.warn_of_unused(&parameter.part.name.text, &parameter.part.name, help);
        }
        let is_declared = |name: &str| self.look_up(name).is_some();
        for axis in script.axes().iter().filter(|axis| !is_declared(&axis.name.text)) {
            let help = "give it to a unit that draws random numbers, `{ seed = seed }`, or drop the axis";
            self.warn_of_unused(&axis.name.text, &axis.name, help);
        }
        for binding in &script.lets {
            self.warn_of_unused(&binding.part.name.text, &binding.part.name, "use it or drop the line");
        }
    }

    fn warn_of_unused(&self, name: &str, word: &Word, help: &str) {
        if !self.is_used(word.span) {
            let message = format!("`{name}` is not used");
            self.report(Diagnostic::warning("W06", word.span, message).help(help));
        }
    }

    /// Whether something refers to the name that is declared at a place.
    pub fn is_used(&self, declared: Span) -> bool {
        self.used.borrow().contains(&declared)
    }
}
