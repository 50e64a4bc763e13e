//! To be written: text to syntax tree.
