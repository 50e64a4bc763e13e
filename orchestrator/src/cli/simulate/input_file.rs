//! Inputs over time, read from a file of comma-separated values.

use dsl::scenario::Curve;
use fmi2::description::{Causality, Kind, ModelDescription, Variability, Variable};
use std::fmt;

/// For each driven variable its curve, in the order of the unit's variables.
pub(super) type Curves = Vec<(usize, Curve)>;

/// What is wrong with the file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wrong {
    line: usize,
    column: usize,
    message: String,
    pub help: Option<String>,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.line, self.column, self.message)
    }
}

/// A piece between commas: its column, from 1, and its text without quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Cell {
    line: usize,
    column: usize,
    text: String,
}

impl Cell {
    fn wrong(&self, message: String) -> Wrong {
        Wrong { line: self.line, column: self.column, message, help: None }
    }
}

/// Reads the file's text: a header line with the time first and names of inputs or tunable parameters behind it, then a
/// row for each point in time. Two rows of one time are a jump.
///
/// # Errors
/// The first thing that is wrong, with its line and column.
pub(super) fn read(text: &str, description: &ModelDescription) -> Result<Curves, Wrong> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let Some((index, header)) = lines.next() else {
        return Err(Wrong { line: 1, column: 1, message: "the file is empty".to_owned(), help: None });
    };
    let header = cells(header, index + 1);
    let variables = variables(&header[1..], description)?;
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (index, line) in lines {
        let cells = cells(line, index + 1);
        let row = row(&cells, &header, &variables, description)?;
        if let Some(before) = rows.last().filter(|before| row[0] < before[0]) {
            return Err(cells[0].wrong(format!("time {} comes after {}; it must not fall", row[0], before[0])));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(header[0].wrong("the file has names, but no rows".to_owned()));
    }
    let curve = |(column, &variable): (usize, &usize)| {
        let rows = rows.iter().map(|row| (row[0], row[column + 1])).collect();
        (variable, Curve { rows, held: is_held(&description.variables[variable]) })
    };
    let mut curves: Curves = variables.iter().enumerate().map(curve).collect();
    curves.sort_by_key(|(variable, _)| *variable);
    Ok(curves)
}

/// The cells of a line; a quoted cell may hold commas, and a doubled quote stands for one.
fn cells(line: &str, number: usize) -> Vec<Cell> {
    let mut cells = vec![Cell { line: number, column: 1, text: String::new() }];
    let mut quoted = false;
    let mut letters = line.chars().enumerate().peekable();
    while let Some((at, letter)) = letters.next() {
        let last = cells.len() - 1;
        match letter {
            '"' if quoted && letters.next_if(|(_, next)| *next == '"').is_some() => cells[last].text.push('"'),
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(Cell { line: number, column: at + 2, text: String::new() }),
            ' ' | '\t' if !quoted && cells[last].text.is_empty() => cells[last].column += 1,
            letter => cells[last].text.push(letter),
        }
    }
    for cell in &mut cells {
        cell.text = cell.text.trim().to_owned();
    }
    cells
}

/// The variables that the header names.
fn variables(header: &[Cell], description: &ModelDescription) -> Result<Vec<usize>, Wrong> {
    let mut variables = Vec::new();
    for cell in header {
        let Some(variable) = description.variable(&cell.text) else { return Err(unknown(cell, description)) };
        let declared = &description.variables[variable];
        if !may_be_driven(declared) {
            let message = format!("`{}` is neither an input nor tunable: {}", cell.text, declared.causality.name());
            return Err(cell.wrong(message));
        }
        if matches!(declared.kind, Kind::String { .. }) {
            return Err(
                cell.wrong(format!("`{}` takes texts; only numbers and Booleans can follow a table", cell.text))
            );
        }
        if variables.contains(&variable) {
            return Err(cell.wrong(format!("`{}` has a column already", cell.text)));
        }
        variables.push(variable);
    }
    Ok(variables)
}

fn unknown(cell: &Cell, description: &ModelDescription) -> Wrong {
    let names = || description.variables.iter().filter(|variable| may_be_driven(variable)).map(|v| v.name.as_str());
    let help = match dsl::nearest::nearest(&cell.text, names()) {
        Some(near) => Some(format!("did you mean `{near}`?")),
        None if names().next().is_none() => Some("the unit has no inputs".to_owned()),
        None => Some(format!("columns can be {}", names().collect::<Vec<_>>().join(", "))),
    };
    Wrong { help, ..cell.wrong(format!("the unit has no variable `{}`", cell.text)) }
}

fn may_be_driven(variable: &Variable) -> bool {
    let tunable = variable.causality == Causality::Parameter && variable.variability == Variability::Tunable;
    variable.causality == Causality::Input || tunable
}

/// Whether values stand until the next row, as for everything that is not continuous.
fn is_held(variable: &Variable) -> bool {
    !matches!(variable.kind, Kind::Real(_)) || variable.variability != Variability::Continuous
}

/// The numbers of a row, the time first.
fn row(
    cells: &[Cell],
    header: &[Cell],
    variables: &[usize],
    description: &ModelDescription,
) -> Result<Vec<f64>, Wrong> {
    if cells.len() != header.len() {
        let place = cells.get(header.len()).unwrap_or(&cells[cells.len() - 1]);
        return Err(place.wrong(format!("expected {} values as in the header, found {}", header.len(), cells.len())));
    }
    let mut row = vec![number(&cells[0], "a time in seconds")?];
    for (cell, &variable) in cells[1..].iter().zip(variables) {
        row.push(value(cell, &description.variables[variable])?);
    }
    Ok(row)
}

fn value(cell: &Cell, variable: &Variable) -> Result<f64, Wrong> {
    let name = &variable.name;
    match variable.kind {
        Kind::Boolean { .. } => match cell.text.as_str() {
            "true" | "True" => Ok(1.0),
            "false" | "False" => Ok(0.0),
            text => {
                let value = text.parse().ok().filter(|value| [0.0, 1.0].contains(value));
                value.ok_or_else(|| cell.wrong(format!("`{text}` is no Boolean, 0 or 1, which `{name}` takes")))
            }
        },
        Kind::Integer { .. } | Kind::Enumeration { .. } => {
            let value = number(cell, "a whole number")?;
            let is_whole = value == libm::rint(value) && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value);
            let error = || cell.wrong(format!("`{}` is no whole number of 32 bits, which `{name}` takes", cell.text));
            if is_whole { Ok(value) } else { Err(error()) }
        }
        Kind::Real(_) | Kind::String { .. } => number(cell, "a number"),
    }
}

fn number(cell: &Cell, what: &str) -> Result<f64, Wrong> {
    let parsed = cell.text.parse().ok().filter(|value: &f64| value.is_finite());
    parsed.ok_or_else(|| cell.wrong(format!("`{}` is not {what}", cell.text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::simulate::alone::tests::tank;

    fn wrong(text: &str) -> String {
        let wrong = read(text, &tank()).unwrap_err();
        let help = wrong.help.as_ref().map_or(String::new(), |help| format!("\n  help: {help}"));
        format!("in.csv:{wrong}{help}\n")
    }

    #[test]
    fn reals_are_interpolated_and_everything_else_is_held() {
        let text = "\u{feff}time,\"open\",inflow,gain\r\n0,true,1.5,1\r\n\r\n2,0,2.5,3\r\n";
        let curves = read(text, &tank()).unwrap();
        let read: Vec<_> = curves.iter().map(|(variable, curve)| (*variable, curve.held, curve.rows.clone())).collect();
        let expected = [
            (1, false, vec![(0.0, 1.5), (2.0, 2.5)]),
            (3, true, vec![(0.0, 1.0), (2.0, 0.0)]),
            (6, true, vec![(0.0, 1.0), (2.0, 3.0)]),
        ];
        assert_eq!(read, expected);
    }

    proptest::proptest! {
        #[test]
        fn whatever_a_file_holds_is_curves_or_an_error_with_a_place(
            text in "(time,inflow\n|t,open,mode\n)?([0-9.,\"\r\n te\\PC]{0,80}|([0-9],[0-9.]{1,4}\n){0,5})"
        ) {
            let lines = text.lines().count().max(1);
            match read(&text, &tank()) {
                Ok(curves) => proptest::prop_assert!(curves.iter().all(|(_, curve)| !curve.rows.is_empty())),
                Err(wrong) => proptest::prop_assert!((1..=lines).contains(&wrong.line) && wrong.column > 0),
            }
        }
    }

    #[test]
    fn a_quoted_name_may_hold_commas_and_quotes() {
        let read: Vec<_> =
            cells("time, \"m[1,2]\" ,\"say \"\"x\"\"\"", 1).into_iter().map(|c| (c.column, c.text)).collect();
        assert_eq!(read, [(1, "time".into()), (7, "m[1,2]".into()), (17, "say \"x\"".into())]);
    }

    #[test]
    fn whatever_is_wrong_has_its_line_and_column() {
        let texts = [
            "",
            "time,inflow\n",
            "time,inflwo\n0,1\n",
            "time,unheard_of\n0,1\n",
            "time,level\n0,1\n",
            "time,inflow,inflow\n0,1,1\n",
            "time,inflow\n0,1\n1\n",
            "time,inflow\n0,1,2\n",
            "time,inflow\n0,one\n",
            "time,inflow\n0,nan\n",
            "time,inflow\nnever,1\n",
            "time,inflow\n1,1\n0.5,1\n",
            "time,inflow,mode\n0,1,1.5\n",
            "time,open\n0,2\n",
        ];
        insta::assert_snapshot!(texts.map(wrong).concat());
    }
}
