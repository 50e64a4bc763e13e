//! Generates code from fields: start values, declarations, and checks that need the types.

use crate::attribute::{Dependency, PortAttribute, Role};
use crate::field::Field;
use proc_macro2::TokenStream;
use quote::{quote, quote_spanned};
use syn::Expr;
use syn::spanned::Spanned;

/// `field: start value` for every field.
pub fn starts(fields: &[Field]) -> Vec<TokenStream> {
    let one = |field: &Field| {
        let (ident, ty) = (&field.ident, &field.ty);
        let Some(port) = &field.port else {
            return quote_spanned!(ty.span()=> #ident: ::core::default::Default::default());
        };
        match port.start.as_ref().or(port.exact.as_ref().and_then(Option::as_ref)) {
            Some(start) => quote_spanned!(start.span()=> #ident: <#ty as ::fmu::Port>::from_start(#start)),
            None => quote_spanned!(ty.span()=> #ident: <#ty as ::fmu::Port>::unset()),
        }
    };
    fields.iter().map(one).collect()
}

/// A visit of every port, in the order of the fields.
pub fn visits(fields: &[Field]) -> Vec<TokenStream> {
    let one = |field: &Field| {
        let port = field.port.as_ref()?;
        let (ident, name, declaration) = (&field.ident, field.name(), declaration(field, port));
        Some(quote! {
            let declaration = #declaration;
            visitor.field(#name, &declaration, &mut self.#ident);
        })
    };
    fields.iter().filter_map(one).collect()
}

fn declaration(field: &Field, port: &PortAttribute) -> TokenStream {
    let role = role(field, port);
    let description = match (port.role, field.description.as_str()) {
        (Role::Port, "") => quote!(declaration_of_group.description),
        (_, text) => quote!(#text),
    };
    let option = |text: &Option<syn::LitStr>| match text {
        Some(text) => quote!(::core::option::Option::Some(#text)),
        None => quote!(::core::option::Option::None),
    };
    let bound = |bound: &Option<Expr>| match bound {
        Some(bound) => {
            let ty = &field.ty;
            quote_spanned!(bound.span()=> ::core::option::Option::Some({
                let bound: <#ty as ::fmu::Port>::Bound = #bound;
                ::core::convert::Into::<f64>::into(bound)
            }))
        }
        None => quote!(::core::option::Option::None),
    };
    let (unit, display) = (option(&port.unit), option(&port.display));
    let (min, max, nominal) = (bound(&port.min), bound(&port.max), bound(&port.nominal));
    quote! {
        ::fmu::Declaration {
            role: #role, description: #description, unit: #unit, display: #display,
            min: #min, max: #max, nominal: #nominal,
        }
    }
}

fn role(field: &Field, port: &PortAttribute) -> TokenStream {
    let names = |list: &[Dependency]| {
        let names = list.iter().map(Dependency::name);
        quote!(visitor.full_names(&[#(#names),*]))
    };
    match (port.role, &port.exact) {
        (Role::Input, _) => quote!(::fmu::Role::Input),
        (Role::Parameter, _) => {
            let tunable = port.tunable;
            quote!(::fmu::Role::Parameter { tunable: #tunable })
        }
        (Role::Output, Some(_)) => quote!(::fmu::Role::ExactOutput),
        (Role::Output, None) => {
            let depends = port.depends.as_deref().unwrap_or_default();
            let depends_at_start = names(port.depends_at_start.as_deref().unwrap_or(depends));
            let depends = names(depends);
            let name = field.name();
            quote!(::fmu::Role::CalculatedOutput {
                field: visitor.full_name(#name), depends: #depends, depends_at_start: #depends_at_start,
            })
        }
        (Role::Local, Some(_)) => quote!(::fmu::Role::ExactLocal),
        (Role::Local | Role::Group, _) => quote!(::fmu::Role::CalculatedLocal),
        (Role::Port, _) => quote!(::core::clone::Clone::clone(&declaration_of_group.role)),
    }
}

/// Checks in the generated code that need the types: whether a unit is missing or superfluous, and whether roles and
/// start values are those of the field or of its type.
pub fn checks(fields: &[Field]) -> Vec<TokenStream> {
    let mut checks = Vec::new();
    for field in fields {
        let Some(port) = &field.port else { continue };
        let (ty, name) = (&field.ty, field.name());
        let mut check = |condition: TokenStream, message: String| {
            checks.push(quote_spanned!(ty.span()=> const _: () = assert!(#condition, #message);));
        };
        if port.role == Role::Group {
            check(
                quote!(<#ty as ::fmu::Port>::OWN_ROLES),
                format!("the fields of `{name}` say no roles: say `input`, `output`, `parameter` or `local` here"),
            );
            continue;
        }
        check(
            quote!(!<#ty as ::fmu::Port>::OWN_ROLES),
            format!("the fields of `{name}` say their roles themselves: say `group` here"),
        );
        match &port.unit {
            None => check(
                quote!(!<#ty as ::fmu::Port>::TAKES_UNIT),
                format!("`{name}` is a Real and needs `unit = \"..\"`; a plain number has the unit \"1\""),
            ),
            Some(_) => check(
                quote!(<#ty as ::fmu::Port>::TAKES_UNIT),
                format!("`{name}` takes no unit: only Reals have one, and the fields of a group say theirs"),
            ),
        }
        let start_is_missing = port.role == Role::Parameter && port.start.is_none() || matches!(port.exact, Some(None));
        if start_is_missing {
            let word = if port.role == Role::Parameter { "start" } else { "exact" };
            check(quote!(<#ty as ::fmu::Port>::STARTS_ITSELF), format!("`{name}` needs `{word} = ..`"));
        }
    }
    checks
}
