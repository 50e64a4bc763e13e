//! What is to be run: the script, the units that it names, and all that is checked before the first unit is instantiated.

pub mod catalogue;
pub mod preparation;
pub mod script;
