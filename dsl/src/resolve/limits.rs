//! Values that are known before the run, against the limits that the units' descriptions declare.

use super::fit::Meeting;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Drive, Port, RealExpression};

impl Scope<'_, '_> {
    /// Refuses a number that the description of its target does not allow.
    pub fn check_limits(&self, drive: &Drive, target: Port, at: Meeting<'_>) -> Option<()> {
        let value = match *drive {
            Drive::Real(RealExpression::Constant(value)) => value,
            Drive::Integer(value) => f64::from(value),
            _ => return Some(()),
        };
        let unit = self.known(target.instance);
        let limits = unit.limits_of(target.variable);
        if limits.allow(value) {
            return Some(());
        }
        let name = self.port_name(target);
        let measure = unit.unit_of(target.variable).map(|name| format!(" {name}")).unwrap_or_default();
        let message = format!("`{name}` cannot be {value}{measure}: its description says {limits}");
        self.refuse(Diagnostic::error("E38", at.source, message).help("write a value within these limits"))
    }
}
