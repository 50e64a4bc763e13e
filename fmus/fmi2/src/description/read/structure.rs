//! Reads `ModelStructure`.

use super::element::{Element, from_one};
use crate::description::{DependencyKind, ModelStructure, Unknown};

const RULE: &str = "2.2.8";

pub(super) fn model_structure(element: &Element) -> ModelStructure {
    let mut structure = ModelStructure { position: element.position(), ..ModelStructure::default() };
    for child in element.children() {
        let list = match child.name() {
            "Outputs" => &mut structure.outputs,
            "Derivatives" => &mut structure.derivatives,
            "InitialUnknowns" => &mut structure.initial_unknowns,
            _ => {
                child.unknown(RULE, "ModelStructure");
                continue;
            }
        };
        list.extend(child.items(RULE, "Unknown", unknown));
    }
    structure
}

fn unknown(element: &Element) -> Option<Unknown> {
    element.expect_attributes(RULE, &["index", "dependencies", "dependenciesKind"]);
    if element.attribute("index").is_none() {
        element.missing(RULE, "index");
    }
    let kinds: Vec<_> = DependencyKind::ALL.iter().map(|kind| kind.name()).collect();
    let expected = format!("one of {}", kinds.join(", "));
    let kind = |word: &str| DependencyKind::ALL.into_iter().find(|kind| kind.name() == word);
    Some(Unknown {
        position: element.position(),
        index: from_one(element.number(RULE, "index")?),
        dependencies: element
            .list(RULE, "dependencies", "an index, counted from 1", |word| word.parse().ok().map(from_one)),
        dependencies_kind: element.list(RULE, "dependenciesKind", &expected, kind),
    })
}
