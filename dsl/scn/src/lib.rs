//! The text of scripts: from characters to a syntax tree, and from diagnostics to what people read. Names have no meaning
//! here; the crate `dsl` resolves them and offers these modules as its own.
#![forbid(unsafe_code)]

pub mod diagnostic;
pub mod format;
pub mod nearest;
pub mod parse;
pub mod source;
pub mod spelling;
pub mod syntax;
