//! The names of columns when a unit runs alone: those of its variables, but for one that is called `time` like the first
//! column of every trace. It is quoted, in each format, in tables of inputs and for `--record`.

use fmi2::description::ModelDescription;

/// The name of the column of the time.
const TIME: &str = "time";

/// The name of a variable's column.
pub(super) fn column_name(variable: &str, description: &ModelDescription) -> String {
    let mut name = variable.to_owned();
    if variable == TIME {
        // A unit may have a variable whose name has the quotes.
        while name == TIME || description.variable(&name).is_some() {
            name = format!("'{name}'");
        }
    }
    name
}

/// The variable whose column has this name.
pub(super) fn variable_of(column: &str, description: &ModelDescription) -> Option<usize> {
    let called_time = || description.variable(TIME).filter(|_| column_name(TIME, description) == column);
    if column == TIME { None } else { description.variable(column).or_else(called_time) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_called_time_has_a_quoted_column_that_no_other_one_has() {
        let variables = |names: &[&str]| {
            let variables: String = names
                .iter()
                .zip(0..)
                .map(|(name, number)| {
                    format!(r#"<ScalarVariable name="{name}" valueReference="{number}"><Real/></ScalarVariable>"#)
                })
                .collect();
            let text = format!(
                r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/>
                <ModelVariables>{variables}</ModelVariables><ModelStructure/></fmiModelDescription>"#
            );
            fmi2::description::read::read(text.as_bytes()).unwrap().0
        };
        let one = variables(&["y", "time"]);
        assert_eq!(["y", "time"].map(|name| column_name(name, &one)), ["y", "'time'"]);
        assert_eq!(["y", "'time'", "time", "z"].map(|name| variable_of(name, &one)), [Some(0), Some(1), None, None]);
        let two = variables(&["'time'", "time"]);
        assert_eq!(["'time'", "time"].map(|name| column_name(name, &two)), ["'time'", "''time''"]);
        assert_eq!(["'time'", "''time''"].map(|name| variable_of(name, &two)), [Some(0), Some(1)]);
    }
}
