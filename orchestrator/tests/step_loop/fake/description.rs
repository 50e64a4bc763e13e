//! What fake units say of themselves.

use fmi2::description::{Causality, Kind, ModelDescription, RealAttributes, RealVariable, Variability, Variable};

pub fn description() -> ModelDescription {
    let variable = |(reference, (name, causality, start)): (u32, (&str, Causality, Option<f64>))| Variable {
        position: Default::default(),
        name: name.to_owned(),
        value_reference: reference,
        description: None,
        causality,
        variability: Variability::Continuous,
        initial: None,
        can_handle_multiple_set_per_time_instant: None,
        annotations: Vec::new(),
        declared_type: None,
        kind: Kind::Real(RealVariable { start, attributes: RealAttributes::default(), ..RealVariable::default() }),
    };
    let inputs = [("u", Causality::Input, Some(0.5)), ("v", Causality::Input, Some(0.25))];
    let variables = [inputs[0], inputs[1], ("p", Causality::Parameter, Some(7.0)), ("y", Causality::Output, None)];
    ModelDescription { variables: (0..).zip(variables).map(variable).collect(), ..ModelDescription::default() }
}
