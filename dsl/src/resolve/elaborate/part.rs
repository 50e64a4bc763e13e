//! `use`: a file as a component, with values for its parameters.

use std::collections::BTreeMap;

use super::{Declares, Elaboration};
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::parts::Part;
use crate::resolve::frame::{FrameId, Placed};
use crate::resolve::script::{Declaration, RESERVED};
use crate::syntax::{self, Expression, StatementKind};

impl<'a> Elaboration<'a> {
    pub(super) fn part(&mut self, frame: FrameId, instance: &'a syntax::Instance) {
        let Some(Declares { frame: home, key, full }) = self.name(frame, &instance.name) else { return };
        let (name, place) = (&instance.name.word, instance.unit.span);
        self.check_hosts(instance);
        let part = match self.request.parts.get(place) {
            Some(Ok(part)) => part,
            Some(Err(problem)) => {
                let error = Diagnostic::error("E26", place, problem.message.clone());
                self.found.push(Diagnostic { help: problem.help.clone(), ..error });
                return self.refuse_name(home, name);
            }
            None => return self.refuse_name(home, name),
        };
        if self.open_parts.contains(&part.text) {
            let error = Diagnostic::error("E28", place, format!("the part {:?} uses itself", instance.unit.text));
            self.found.push(error.help("a part may use other parts only"));
            return self.refuse_name(home, name);
        }
        if !self.has_room(1, place) {
            return self.refuse_name(home, name);
        }
        let values = self.values(frame, instance, part);
        let inner = self.script.frames.add_part(&full, values);
        self.declare(home, key, name, Declaration::Part(inner, name), &RESERVED);
        self.open_parts.push(part.text);
        self.block(inner, &part.file.statements);
        self.open_parts.pop();
    }

    /// The values in the braces, by parameter.
    fn values(
        &mut self,
        frame: FrameId,
        instance: &'a syntax::Instance,
        part: &'a Part,
    ) -> BTreeMap<&'a str, Placed<&'a Expression>> {
        let parameters = || {
            part.file.statements.iter().filter_map(|statement| match &statement.kind {
                StatementKind::Param(binding) => Some(binding.name.text.as_str()),
                _ => None,
            })
        };
        let mut values: BTreeMap<&'a str, Placed<&'a Expression>> = BTreeMap::new();
        for syntax::Value { key, value } in &instance.values {
            let name = key.root.text.as_str();
            if !key.tail.is_empty() || !parameters().any(|parameter| parameter == name) {
                let message = format!("the part {:?} has no parameter `{name}`", instance.unit.text);
                let all: Vec<_> = parameters().collect();
                let help = match nearest(name, all.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None if all.is_empty() => "it has none: write `param … = …` in it".to_owned(),
                    None => format!("its parameters are {}", all.join(", ")),
                };
                self.found.push(Diagnostic::error("E01", key.span, message).help(help));
            } else if let Some(first) = values.insert(name, Placed { frame, part: value }) {
                let error = Diagnostic::error("E03", key.span, format!("`{name}` gets two values"));
                self.found.push(error.label(first.part.span, "the first").help("leave one of them"));
            }
        }
        values
    }
}
