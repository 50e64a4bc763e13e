//! `derive(FmiEnum)`: the variants of an enum as items of an enumeration type.

use crate::doc::{first_paragraph, snake_case};
use crate::field::{collect, undescribed};
use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DataEnum, DeriveInput, Error, Expr, ExprLit, Fields, Lit, Result, Variant};

/// `impl FmiEnum` and `impl Port` for an enum.
pub fn derive(input: &DeriveInput) -> Result<TokenStream> {
    let Data::Enum(data) = &input.data else {
        return Err(Error::new_spanned(&input.ident, "`FmiEnum` is for an enum"));
    };
    let Some(first) = data.variants.first().map(|variant| &variant.ident) else {
        return Err(Error::new_spanned(&input.ident, "an enumeration has at least one item"));
    };
    let mut next = 1;
    let values = collect(data.variants.iter().map(|variant| {
        let value = value(variant, next)?;
        next = value.saturating_add(1);
        Ok(value)
    }))?;
    let (ident, name, description) = (&input.ident, input.ident.to_string(), first_paragraph(&input.attrs));
    check_descriptions(input, data)?;
    let variants: Vec<_> = data.variants.iter().map(|variant| &variant.ident).collect();
    let items = data.variants.iter().zip(&values).map(|(variant, value)| {
        let (item, description) = (snake_case(&variant.ident.to_string()), first_paragraph(&variant.attrs));
        quote!((#item, #value, #description))
    });
    Ok(quote! {
        #[automatically_derived]
        impl ::fmu::FmiEnum for #ident {
            const NAME: &'static str = #name;
            const DESCRIPTION: &'static str = #description;
            const ITEMS: &'static [(&'static str, i32, &'static str)] = &[#(#items),*];

            fn value(self) -> i32 {
                match self { #(Self::#variants => #values),* }
            }

            fn from_value(value: i32) -> ::core::option::Option<Self> {
                match value {
                    #(#values => ::core::option::Option::Some(Self::#variants),)*
                    _ => ::core::option::Option::None,
                }
            }
        }

        // SAFETY: the enum passes itself as a whole.
        #[automatically_derived]
        unsafe impl ::fmu::Port for #ident {
            type Start = Self;
            type Bound = ::fmu::NoBound;
            const TAKES_UNIT: bool = false;

            fn from_start(start: Self) -> Self {
                start
            }

            fn unset() -> Self {
                Self::#first
            }

            fn visit(&mut self, declaration: &::fmu::Declaration, visitor: &mut ::fmu::Visitor) {
                visitor.enumeration(self, declaration);
            }
        }
    })
}

/// Reports the enumeration and each item that has no doc comment.
fn check_descriptions(input: &DeriveInput, data: &DataEnum) -> Result<()> {
    let items = data.variants.iter().map(|variant| (&variant.ident, &variant.attrs));
    let all = std::iter::once((&input.ident, &input.attrs)).chain(items);
    let without = all.filter(|(_, attributes)| first_paragraph(attributes).is_empty());
    collect(without.map(|(ident, _)| Err::<(), _>(undescribed(ident)))).map(drop)
}

/// The value of a variant: its discriminant, or one more than the previous value.
fn value(variant: &Variant, next: i32) -> Result<i32> {
    if !matches!(variant.fields, Fields::Unit) {
        return Err(Error::new_spanned(variant, "an item of an enumeration has no fields"));
    }
    match &variant.discriminant {
        None => Ok(next),
        Some((_, Expr::Lit(ExprLit { lit: Lit::Int(value), .. }))) => value.base10_parse(),
        Some((_, other)) => Err(Error::new_spanned(other, "write the value of an item as a number")),
    }
}
