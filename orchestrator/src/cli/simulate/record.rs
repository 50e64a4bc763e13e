//! Which variables are recorded when a unit runs alone.

use super::column_name::{column_name, variable_of};
use crate::find::preparation::Refusal;
use dsl::nearest::nearest;
use dsl::scenario::{Column, Port};
use fmi2::description::{BaseType, Causality, ModelDescription, Variable};
use results::report::invocation::program;

/// What is recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Recorded {
    /// The columns; `None` if there is to be no trace.
    pub columns: Option<Vec<Column>>,
    /// What the user did not ask for in so many words.
    pub note: Option<String>,
}

/// The columns that `--record` means: `all`, `none`, or names and patterns in the order in which they are written. Without
/// it: outputs, inputs and the tunable parameters that a table drives; of a unit without outputs and inputs its local
/// variables, or else its parameters.
///
/// # Errors
/// A name that the unit does not have, a pattern that fits nothing, or only Strings, which a trace cannot hold.
pub(super) fn recorded(
    arguments: &[String],
    description: &ModelDescription,
    driven: &[usize],
) -> Result<Recorded, Refusal> {
    let everything = || -> Vec<usize> { (0..description.variables.len()).collect() };
    let (chosen, note) = match all_names(arguments).as_slice() {
        ["none"] => return Ok(Recorded { columns: None, note: None }),
        ["all"] => (everything(), without_texts(&everything(), description)),
        [] => by_default(description, driven),
        names => (by_name(names, description)?, None),
    };
    let numbers = chosen.into_iter().filter(|&variable| !is_text(&description.variables[variable]));
    let column = |variable: usize| {
        let name = column_name(&description.variables[variable].name, description);
        Column::of_port(name, Port { instance: 0, variable })
    };
    Ok(Recorded { columns: Some(numbers.map(column).collect()), note })
}

/// Whether `--record` asks for no trace.
pub(super) fn is_none(arguments: &[String]) -> bool {
    all_names(arguments) == ["none"]
}

fn all_names(arguments: &[String]) -> Vec<&str> {
    arguments.iter().flat_map(|argument| names(argument)).collect()
}

fn is_text(variable: &Variable) -> bool {
    variable.base_type() == BaseType::String
}

/// The names between commas; those in brackets, parentheses or quotes belong to a name, as in `m[1,2]`.
fn names(argument: &str) -> Vec<&str> {
    let (mut depth, mut quote, mut from) = (0_usize, None, 0);
    let mut names = Vec::new();
    for (at, letter) in argument.char_indices() {
        match (letter, quote) {
            (letter, Some(open)) if letter == open => quote = None,
            (_, Some(_)) => {}
            ('\'' | '"', None) => quote = Some(letter),
            ('[' | '(', None) => depth += 1,
            (']' | ')', None) => depth = depth.saturating_sub(1),
            (',', None) if depth == 0 => {
                names.push(&argument[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    names.push(&argument[from..]);
    names.into_iter().map(str::trim).filter(|name| !name.is_empty()).collect()
}

fn by_name(names: &[&str], description: &ModelDescription) -> Result<Vec<usize>, Refusal> {
    let mut chosen = Vec::new();
    for name in names {
        let found = named(name, description);
        if !found.is_empty() && found.iter().all(|&variable| is_text(&description.variables[variable])) {
            let message = format!("--record {name}: only Strings have this name, and a trace holds numbers");
            return Err(Refusal::new(&message, None));
        }
        if found.is_empty() {
            let all = || description.variables.iter().map(|variable| variable.name.as_str());
            let near = nearest(name, all()).map(|near| format!("did you mean `{near}`?"));
            let help =
                near.unwrap_or_else(|| format!("the unit's variables: {} describe, with its name or path", program()));
            let what =
                if name.contains('*') { "no variable fits this pattern" } else { "the unit has no such variable" };
            return Err(Refusal::new(&format!("--record {name}: {what}"), Some(&help)));
        }
        let new: Vec<_> = found.into_iter().filter(|variable| !chosen.contains(variable)).collect();
        chosen.extend(new);
    }
    Ok(chosen)
}

/// The variable of a name, the members of a group or array, or what fits a pattern.
fn named(name: &str, description: &ModelDescription) -> Vec<usize> {
    if let Some(variable) = variable_of(name, description).or_else(|| description.variable(name)) {
        return vec![variable];
    }
    let is_member = |rest: &str| rest.starts_with(['.', '[']);
    let fits = |other: &str| fits(name, other) || other.strip_prefix(name).is_some_and(is_member);
    let variables = description.variables.iter().enumerate();
    variables.filter(|(_, variable)| fits(&variable.name)).map(|(index, _)| index).collect()
}

/// Whether a pattern fits a name: a `*` stands for any letters.
fn fits(pattern: &str, name: &str) -> bool {
    let Some((head, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(mut name) = name.strip_prefix(head) else { return false };
    let mut pieces: Vec<_> = rest.split('*').collect();
    let tail = pieces.pop().unwrap_or_default();
    for piece in pieces {
        let Some(at) = name.find(piece) else { return false };
        name = &name[at + piece.len()..];
    }
    name.ends_with(tail)
}

fn by_default(description: &ModelDescription, driven: &[usize]) -> (Vec<usize>, Option<String>) {
    let of = |causalities: &[Causality]| -> Vec<usize> {
        let variables = description.variables.iter().enumerate();
        let numbers = variables.filter(|(_, variable)| causalities.contains(&variable.causality) && !is_text(variable));
        numbers.map(|(index, _)| index).collect()
    };
    let mut ports = of(&[Causality::Output]);
    ports.extend(of(&[Causality::Input]));
    let mut note = None;
    if ports.is_empty() {
        let parameters = [Causality::Parameter, Causality::CalculatedParameter];
        let (others, what) = match of(&[Causality::Local]) {
            locals if locals.is_empty() => (of(&parameters), "parameters"),
            locals => (locals, "local variables"),
        };
        ports = others;
        note = Some(match ports.len() {
            0 => "note: the unit has no variables that are numbers: only the time is recorded".to_owned(),
            count => {
                format!("note: the unit has no inputs and outputs that are numbers: its {count} {what} are recorded")
            }
        });
    }
    let others: Vec<_> = driven.iter().copied().filter(|variable| !ports.contains(variable)).collect();
    ports.extend(others);
    (ports, note)
}

/// What to say if some of these are Strings.
fn without_texts(variables: &[usize], description: &ModelDescription) -> Option<String> {
    let texts = match variables.iter().filter(|&&variable| is_text(&description.variables[variable])).count() {
        0 => return None,
        1 => "1 String is".to_owned(),
        count => format!("{count} Strings are"),
    };
    Some(format!("note: {texts} not recorded: a trace holds numbers"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::simulate::alone::tests::tank;

    fn of(arguments: &[&str], driven: &[usize]) -> Result<(Vec<String>, String), String> {
        let arguments: Vec<_> = arguments.iter().map(|&argument| argument.to_owned()).collect();
        let Recorded { columns, note } = recorded(&arguments, &tank(), driven).map_err(|refusal| refusal.0)?;
        Ok((columns.into_iter().flatten().map(|column| column.name).collect(), note.unwrap_or_default()))
    }

    fn names(arguments: &[&str]) -> Vec<String> {
        of(arguments, &[]).unwrap_or_else(|error| panic!("{error}")).0
    }

    #[test]
    fn outputs_inputs_and_driven_parameters_are_recorded_unless_names_are_given() {
        assert_eq!(names(&[]), ["level", "inflow", "mode", "open", "depth", "rise", "water"]);
        assert_eq!(of(&[], &[1, 6]).unwrap().0[7..], ["gain"]);
        assert_eq!(names(&["gain,level", "area", "gain"]), ["gain", "level", "area"]);
        assert_eq!(names(&["*e*"]), ["area", "mode", "open", "level", "depth", "rise", "water"]);
        assert_eq!(names(&["in*w, *n"]), ["inflow", "open", "gain"]);
        let (all, note) = of(&["all"], &[]).unwrap();
        assert_eq!((all.len(), note.as_str()), (9, "note: 1 String is not recorded: a trace holds numbers"));
        let none = ["none,".to_owned()];
        assert_eq!((is_none(&none), recorded(&none, &tank(), &[])), (true, Ok(Recorded::default())));
    }

    #[test]
    fn a_unit_without_inputs_and_outputs_leaves_its_local_variables_or_its_parameters() {
        let mut description = tank();
        for variable in &mut description.variables[1..] {
            variable.causality = Causality::Parameter;
        }
        let of = |description: &ModelDescription| {
            let recorded = recorded(&[], description, &[]).unwrap_or_else(|refusal| panic!("{}", refusal.0));
            let names: Vec<_> = recorded.columns.into_iter().flatten().map(|column| column.name).collect();
            (names.join(" "), recorded.note.unwrap_or_default())
        };
        let (names, note) = of(&description);
        assert!(
            names.starts_with("area inflow mode") && note.ends_with("its 9 parameters are recorded"),
            "{names} {note}"
        );
        description.variables[4].causality = Causality::Local;
        assert_eq!(of(&description).0, "level");
    }

    #[test]
    fn names_may_hold_commas_and_a_group_or_array_has_its_members() {
        assert_eq!(super::names("m[1,2], der(a,b),'x,y',z"), ["m[1,2]", "der(a,b)", "'x,y'", "z"]);
        let mut description = tank();
        description.variables[0].name = "m[1,2]".to_owned();
        description.variables[4].name = "m[1,3]".to_owned();
        description.variables[1].name = "m.x".to_owned();
        assert_eq!(by_name(&["m[1,3]", "m"], &description), Ok(vec![4, 0, 1]));
    }

    #[test]
    fn a_name_that_the_unit_does_not_have_is_refused() {
        let refusal = |name: &str| of(&[name], &[]).unwrap_err();
        assert!(
            refusal("levle").contains("--record levle: the unit has no such variable\nhelp: did you mean `level`?")
        );
        assert!(refusal("level,x*").contains("--record x*: no variable fits this pattern"));
        assert!(refusal("label").contains("--record label: only Strings have this name"));
    }
}
