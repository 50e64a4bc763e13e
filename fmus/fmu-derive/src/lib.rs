//! The derive macros of crate `fmu`, which documents them: `Fmu`, `Group` and `FmiEnum`.
#![forbid(unsafe_code)]

mod attribute;
mod dependencies;
mod doc;
mod enumeration;
mod field;
mod generate;
mod limits;
mod stand_in;
mod unit;

use proc_macro::TokenStream;
use syn::{DeriveInput, parse_macro_input};

/// The ports of a unit: `input`, `output`, `parameter`, `local` or `group` declares the role of a field; a field
/// without any is hidden state.
#[proc_macro_derive(Fmu, attributes(fmu, input, output, parameter, local, group, port))]
pub fn derive_fmu(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input as DeriveInput), unit::derive_fmu, stand_in::ports)
}

/// A group of ports: either every field is marked `port` and the whole group gets its role where it is used, or the
/// fields declare their own roles.
#[proc_macro_derive(Group, attributes(input, output, parameter, local, group, port))]
pub fn derive_group(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input as DeriveInput), unit::derive_group, stand_in::port)
}

/// An enumeration type: items are the variants in snake case, values count from 1 unless the variants have
/// discriminants.
#[proc_macro_derive(FmiEnum)]
pub fn derive_enum(input: TokenStream) -> TokenStream {
    expand(parse_macro_input!(input as DeriveInput), enumeration::derive, stand_in::enumeration)
}

/// The derived code; or the errors, with an implementation that stands in for it, so that they are not followed by those of
/// every place that needs one.
fn expand(
    input: DeriveInput,
    derive: fn(&DeriveInput) -> syn::Result<proc_macro2::TokenStream>,
    stand_in: fn(&DeriveInput) -> proc_macro2::TokenStream,
) -> TokenStream {
    derive(&input)
        .unwrap_or_else(|error| {
            let mut tokens = error.to_compile_error();
            tokens.extend(stand_in(&input));
            tokens
        })
        .into()
}
