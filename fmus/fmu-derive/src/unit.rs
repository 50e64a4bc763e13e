//! `derive(Fmu)` for the struct of a unit and `derive(Group)` for a struct inside it.

use crate::attribute::Role;
use crate::doc::first_paragraph;
use crate::field::{Field, fields, undescribed};
use crate::{dependencies, generate};
use proc_macro2::TokenStream;
use quote::quote;
use syn::{DeriveInput, Error, Expr, LitStr, Result, meta::ParseNestedMeta};

/// `impl Ports` for a unit.
pub fn derive_fmu(input: &DeriveInput) -> Result<TokenStream> {
    let fields = fields(input)?;
    for field in &fields {
        if let Some(port) = field.port.as_ref().filter(|port| port.role == Role::Port) {
            let message = "`port` is for the fields of a group; a unit says `input`, `output`, `parameter` or `local`";
            return Err(Error::new(port.span, message));
        }
    }
    dependencies::check(&fields)?;
    let (name, [start, stop, step]) = settings(input)?;
    let (ident, description) = (&input.ident, first_paragraph(&input.attrs));
    if description.is_empty() {
        return Err(undescribed(ident));
    }
    let (starts, visits, checks) = (generate::starts(&fields), generate::visits(&fields), generate::checks(&fields));
    Ok(quote! {
        // SAFETY: only fields of the struct are visited, always the same ones in the same order.
        #[automatically_derived]
        unsafe impl ::fmu::Ports for #ident {
            const NAME: ::core::option::Option<&'static str> = #name;
            const DESCRIPTION: &'static str = #description;
            const EXPERIMENT: ::fmu::Experiment = ::fmu::Experiment { start: #start, stop: #stop, step: #step };

            fn at_start() -> Self {
                Self { #(#starts),* }
            }

            fn visit(&mut self, visitor: &mut ::fmu::Visitor) {
                let _ = &visitor;
                #(#visits)*
            }
        }
        #(#checks)*
    })
}

/// `impl Port` for a group.
pub fn derive_group(input: &DeriveInput) -> Result<TokenStream> {
    let fields = fields(input)?;
    let own_roles = own_roles(&fields)?;
    dependencies::check(&fields)?;
    let ident = &input.ident;
    let (starts, visits, checks) = (generate::starts(&fields), generate::visits(&fields), generate::checks(&fields));
    Ok(quote! {
        // SAFETY: only fields of the struct are visited, always the same ones in the same order.
        #[automatically_derived]
        unsafe impl ::fmu::Port for #ident {
            type Start = Self;
            type Bound = ::fmu::NoBound;
            const TAKES_UNIT: bool = false;
            const OWN_ROLES: bool = #own_roles;
            const STARTS_ITSELF: bool = true;

            fn from_start(start: Self) -> Self {
                start
            }

            fn unset() -> Self {
                Self { #(#starts),* }
            }

            fn visit(&mut self, declaration_of_group: &::fmu::Declaration, visitor: &mut ::fmu::Visitor) {
                let _ = (&declaration_of_group, &visitor);
                #(#visits)*
            }
        }
        #(#checks)*
    })
}

/// Whether the fields of a group declare their own roles; all do or none does.
fn own_roles(fields: &[Field]) -> Result<bool> {
    let mut ports = fields.iter().filter_map(|field| field.port.as_ref());
    let Some(first) = ports.next() else { return Ok(false) };
    let has_role = |role| role != Role::Port;
    match ports.find(|port| has_role(port.role) != has_role(first.role)) {
        None => Ok(has_role(first.role)),
        Some(other) => {
            let message = "either every field of a group says its role or each is a `port` that gets it from outside";
            Err(Error::new(other.span, message))
        }
    }
}

/// `#[fmu(name = "..", experiment(start = .., stop = .., step = ..))]`
fn settings(input: &DeriveInput) -> Result<(TokenStream, [TokenStream; 3])> {
    let none = || quote!(::core::option::Option::None);
    let (mut name, mut times) = (none(), [none(), none(), none()]);
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("fmu")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("name") {
                let text: LitStr = meta.value()?.parse()?;
                name = quote!(::core::option::Option::Some(#text));
                return Ok(());
            }
            if meta.path.is_ident("experiment") {
                return meta.parse_nested_meta(|time| experiment(&time, &mut times));
            }
            Err(meta.error("a unit says `name = \"..\"` and `experiment(start = .., stop = .., step = ..)`"))
        })?;
    }
    Ok((name, times))
}

fn experiment(time: &ParseNestedMeta, times: &mut [TokenStream; 3]) -> Result<()> {
    let index = ["start", "stop", "step"].iter().position(|word| time.path.is_ident(word));
    let Some(index) = index else { return Err(time.error("an experiment has `start`, `stop` and `step`, in seconds")) };
    let seconds: Expr = time.value()?.parse()?;
    times[index] = quote!(::core::option::Option::Some(#seconds));
    Ok(())
}
