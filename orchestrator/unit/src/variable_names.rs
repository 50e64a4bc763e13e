//! Names of variables by value reference, for log messages: a unit may write `#r12#` for its Real variable 12.

use fmi2::description::{BaseType, ModelDescription};

/// The names of a unit's variables, sorted by type and value reference.
#[derive(Debug, Default)]
pub struct VariableNames {
    sorted: Vec<(BaseType, u32, String)>,
}

impl VariableNames {
    /// Collects the names. If several variables share a reference, the first in the file is used.
    #[must_use]
    pub fn of(description: &ModelDescription) -> Self {
        let variables = description.variables.iter();
        let mut sorted: Vec<_> = variables.map(|v| (v.base_type(), v.value_reference, v.name.clone())).collect();
        sorted.sort_by_key(|&(base_type, reference, _)| (base_type, reference));
        sorted.dedup_by_key(|&mut (base_type, reference, _)| (base_type, reference));
        Self { sorted }
    }

    /// The name of the variable of this type and value reference.
    #[must_use]
    pub fn get(&self, base_type: BaseType, reference: u32) -> Option<&str> {
        let key = (base_type, reference);
        let at = self.sorted.binary_search_by_key(&key, |&(base_type, reference, _)| (base_type, reference)).ok()?;
        Some(&self.sorted[at].2)
    }

    /// Replaces `#r12#`, `#i3#`, `#b0#` and `#s7#` by names, and `##` by `#`, as the standard defines. Anything else
    /// stays. What follows the first `enough` bytes is left out.
    #[must_use]
    pub fn expand(&self, text: &str, enough: usize) -> String {
        let mut expanded = String::with_capacity(text.len());
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('#') {
            expanded.push_str(before);
            if expanded.len() > enough {
                return expanded;
            }
            if let Some(after) = after.strip_prefix('#') {
                expanded.push('#');
                rest = after;
            } else if let Some((name, after)) = self.reference(after) {
                expanded.push_str(name);
                rest = after;
            } else {
                expanded.push('#');
                rest = after;
            }
        }
        expanded + rest
    }

    /// The name for `r12#…`, and the text after it.
    fn reference<'a>(&self, text: &'a str) -> Option<(&str, &'a str)> {
        let (reference, after) = text.split_once('#')?;
        let base_type = match reference.chars().next()? {
            'r' => BaseType::Real,
            'i' => BaseType::Integer,
            'b' => BaseType::Boolean,
            's' => BaseType::String,
            _ => return None,
        };
        Some((self.get(base_type, reference[1..].parse().ok()?)?, after))
    }
}

#[test]
fn references_become_names_and_doubled_signs_become_one() {
    let names = VariableNames {
        sorted: vec![(BaseType::Real, 12, "tank.level".into()), (BaseType::Integer, 12, "count".into())],
    };
    for (text, expanded) in [
        ("#r12# above #i12#", "tank.level above count"),
        ("##r12## costs 3 #", "#r12# costs 3 #"),
        ("#r13# #x1# #r# ##", "#r13# #x1# #r# #"),
        ("#é# #r+12# #r12", "#é# tank.level #r12"),
        ("", ""),
    ] {
        assert_eq!(names.expand(text, 100), expanded);
    }
    assert!(names.expand(&"#r12#".repeat(1000), 100).len() < 120);
}
