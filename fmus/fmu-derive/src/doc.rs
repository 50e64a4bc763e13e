//! Doc comments as descriptions, and names in snake case.

use syn::{Attribute, Expr, ExprLit, Lit, Meta};

/// The first paragraph of a doc comment on one line.
pub fn first_paragraph(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(ExprLit { lit: Lit::Str(line), .. }) => Some(line.value()),
            _ => None,
        },
        _ => None,
    });
    let text: Vec<String> = lines.flat_map(|text| text.split('\n').map(str::to_owned).collect::<Vec<_>>()).collect();
    let words =
        text.iter().map(|line| line.trim()).skip_while(|line| line.is_empty()).take_while(|line| !line.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

/// `GroundEffect` as `ground_effect`.
pub fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for (index, letter) in name.char_indices() {
        if letter.is_uppercase() && index > 0 {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

#[test]
fn a_doc_comment_gives_its_first_paragraph() {
    let item: syn::ItemStruct = syn::parse_quote! {
        /// Rotor speed,
        /// counted from the front.
        ///
        /// More.
        struct X;
    };
    assert_eq!(first_paragraph(&item.attrs), "Rotor speed, counted from the front.");
}

#[test]
fn variants_become_snake_case() {
    assert_eq!(["Bemt", "Q1", "GroundEffect"].map(snake_case), ["bemt", "q1", "ground_effect"]);
}
