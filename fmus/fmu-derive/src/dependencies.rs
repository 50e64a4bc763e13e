//! Checks that outputs depend only on ports that are not computed themselves.

use crate::attribute::Dependency;
use crate::field::{Field, collect};
use syn::ext::IdentExt;
use syn::{Error, Result};

/// Reports every mistake in the `depends` of these fields.
pub fn check(fields: &[Field]) -> Result<()> {
    let lists = fields.iter().filter_map(|field| field.port.as_ref());
    let all = lists.flat_map(|port| port.depends.iter().chain(&port.depends_at_start).flatten());
    collect(all.map(|dependency| check_one(fields, dependency))).map(drop)
}

fn check_one(fields: &[Field], dependency: &Dependency) -> Result<()> {
    let Some(first) = dependency.path.first() else { return Ok(()) };
    let name = first.unraw().to_string();
    let message = match fields.iter().find(|field| field.name() == name) {
        Some(field) if field.can_be_known() => return Ok(()),
        Some(field) if field.port.is_none() => {
            format!("`{name}` is hidden state; name the inputs and parameters on which the output depends")
        }
        Some(_) => format!("`{name}` is computed itself; name the inputs and parameters on which it depends"),
        None => {
            let known: Vec<_> = fields.iter().filter(|field| field.can_be_known()).map(Field::name).collect();
            match known.as_slice() {
                [] => format!("there is no port `{name}`; the unit has no inputs or parameters"),
                _ => format!("there is no port `{name}`; outputs can depend on {}", known.join(", ")),
            }
        }
    };
    Err(Error::new(first.span(), message))
}
