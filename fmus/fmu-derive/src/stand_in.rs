//! Implementations beside compile errors: they keep the compiler from reporting each place that needs the real one.

use proc_macro2::TokenStream;
use quote::quote;
use syn::DeriveInput;

/// `impl Ports` for a unit with mistakes.
pub fn ports(input: &DeriveInput) -> TokenStream {
    let (ident, (generics, arguments, conditions)) = (&input.ident, input.generics.split_for_impl());
    quote! {
        // SAFETY: it visits nothing, and the program does not compile.
        #[automatically_derived]
        unsafe impl #generics ::fmu::Ports for #ident #arguments #conditions {
            const NAME: ::core::option::Option<&'static str> = ::core::option::Option::None;
            const DESCRIPTION: &'static str = "";
            const EXPERIMENT: ::fmu::Experiment = ::fmu::Experiment {
                start: ::core::option::Option::None, stop: ::core::option::Option::None, step: ::core::option::Option::None,
            };
            fn at_start() -> Self { loop {} }
            fn visit(&mut self, _: &mut ::fmu::Visitor) {}
        }
    }
}

/// `impl Port` for a group or enumeration with mistakes.
pub fn port(input: &DeriveInput) -> TokenStream {
    let (ident, (generics, arguments, conditions)) = (&input.ident, input.generics.split_for_impl());
    quote! {
        // SAFETY: it visits nothing, and the program does not compile.
        #[automatically_derived]
        unsafe impl #generics ::fmu::Port for #ident #arguments #conditions {
            type Start = Self;
            type Bound = ::fmu::NoBound;
            const TAKES_UNIT: bool = false;
            const STARTS_ITSELF: bool = true;
            fn from_start(start: Self) -> Self { start }
            fn unset() -> Self { loop {} }
            fn visit(&mut self, _: &::fmu::Declaration, _: &mut ::fmu::Visitor) {}
        }
    }
}

/// `impl FmiEnum` and `impl Port` for an enumeration with mistakes.
pub fn enumeration(input: &DeriveInput) -> TokenStream {
    let (ident, (generics, arguments, conditions)) = (&input.ident, input.generics.split_for_impl());
    let port = port(input);
    quote! {
        #[automatically_derived]
        impl #generics ::fmu::FmiEnum for #ident #arguments #conditions {
            const NAME: &'static str = "";
            const DESCRIPTION: &'static str = "";
            const ITEMS: &'static [(&'static str, i32, &'static str)] = &[];
            fn value(self) -> i32 { loop {} }
            fn from_value(_: i32) -> ::core::option::Option<Self> { ::core::option::Option::None }
        }
        #port
    }
}
