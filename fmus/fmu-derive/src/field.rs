//! The fields of a struct with their attributes.

use crate::attribute::{PortAttribute, Role};
use crate::doc::first_paragraph;
use syn::ext::IdentExt;
use syn::{Data, DeriveInput, Error, Fields, Ident, Result, Type};

/// A field of a unit or group.
pub struct Field {
    pub ident: Ident,
    pub ty: Type,
    pub description: String,
    /// `None` for hidden state.
    pub port: Option<PortAttribute>,
}

impl Field {
    pub fn name(&self) -> String {
        self.ident.unraw().to_string()
    }

    /// Whether an output may depend on it.
    pub fn can_be_known(&self) -> bool {
        self.port.as_ref().is_some_and(|port| match port.role {
            Role::Input | Role::Parameter | Role::Group => true,
            Role::Output | Role::Local => port.exact.is_some(),
            Role::Port => false,
        })
    }
}

/// The fields of a struct, or all mistakes in their attributes at once.
pub fn fields(input: &DeriveInput) -> Result<Vec<Field>> {
    if !input.generics.params.is_empty() {
        return Err(Error::new_spanned(&input.generics, "a unit or group has no generic parameters"));
    }
    let named = match &input.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => fields.named.iter().collect(),
            Fields::Unit => Vec::new(),
            Fields::Unnamed(fields) => return Err(Error::new_spanned(fields, "ports need names: use named fields")),
        },
        _ => return Err(Error::new_spanned(&input.ident, "a unit or group is a struct")),
    };
    let parsed = named.into_iter().map(|field| {
        let Some(ident) = field.ident.clone() else { return Err(Error::new_spanned(field, "ports need names")) };
        let description = first_paragraph(&field.attrs);
        let port = PortAttribute::of_field(&field.attrs)?;
        // A group's fields have descriptions of their own; a `port` without one gets that of the group.
        let described = port.as_ref().is_none_or(|port| matches!(port.role, Role::Group | Role::Port));
        if description.is_empty() && !described {
            return Err(undescribed(&ident));
        }
        Ok(Field { ident, ty: field.ty.clone(), description, port })
    });
    collect(parsed)
}

/// That something which other tools show has no description.
pub fn undescribed(ident: &Ident) -> Error {
    let message =
        format!("`{}` needs a doc comment, `/// ..`: it becomes the description that other tools show", ident.unraw());
    Error::new(ident.span(), message)
}

/// All values, or all errors in one.
pub fn collect<T>(results: impl Iterator<Item = Result<T>>) -> Result<Vec<T>> {
    let (mut values, mut errors): (Vec<T>, Option<Error>) = (Vec::new(), None);
    for result in results {
        match (result, &mut errors) {
            (Ok(value), _) => values.push(value),
            (Err(error), Some(errors)) => errors.combine(error),
            (Err(error), None) => errors = Some(error),
        }
    }
    errors.map_or(Ok(values), Err)
}
