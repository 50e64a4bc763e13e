//! To be written: syntax tree to scenario.
