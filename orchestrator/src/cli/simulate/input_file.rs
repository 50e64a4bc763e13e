//! Inputs over time, read from a table.

use super::column_name::variable_of;
use dsl::scenario::Curve;
use fmi2::description::{Causality, Kind, ModelDescription, TypeKind, Variability, Variable};
use fmi2::units::{BaseUnit, Conversion, parse};
use results::table::{CellType, Heading, TableError, TableFile};
use std::path::Path;

/// For each driven variable its curve, in the order of the unit's variables.
pub(super) type Curves = Vec<(usize, Curve)>;

/// A column behind the time.
struct Driven {
    /// Index into the unit's variables.
    variable: usize,
    /// From the unit of measure of the column to that of the variable.
    conversion: Conversion,
}

/// Reads the table in these bytes of a file: the time first and inputs or tunable parameters behind it, then a row for each
/// point in time. Two rows of one time are a jump.
///
/// # Errors
/// The first thing that is wrong, with its line and column.
pub(super) fn read(path: &Path, bytes: Vec<u8>, description: &ModelDescription) -> Result<Curves, TableError> {
    let mut file = TableFile::of_bytes(path, bytes)?;
    let driven = driven(&file, description)?;
    let types: Vec<_> = driven.iter().map(|driven| cell_type(driven.variable, description)).collect();
    let no_rows = file.wrong_heading(0, "the file has names, but no rows".to_owned());
    let columns = file.read(&types, false)?;
    let numbers: Vec<Vec<f64>> = columns.into_iter().map(|column| column.into_iter().flatten().collect()).collect();
    let Some((time_s, values)) = numbers.split_first().filter(|(time_s, _)| !time_s.is_empty()) else {
        return Err(no_rows);
    };
    let curve = |(index, driven): (usize, &Driven)| {
        let values = time_s.iter().zip(&values[index]);
        let rows: Vec<_> = values.map(|(&time_s, &value)| (time_s, driven.conversion.apply(value))).collect();
        let variable = &description.variables[driven.variable];
        let limits = description.limits_of(variable);
        if let Some((time_s, _)) = rows.iter().find(|(_, value)| !value.is_finite()) {
            let message =
                format!("`{}` is too large for a number at {time_s} s, in its own unit of measure", variable.name);
            return Err(file.wrong_heading(index + 1, message));
        }
        if let Some((time_s, value)) = rows.iter().find(|(_, value)| !limits.allow(*value)) {
            let message = format!("`{}` cannot be {value} at {time_s} s: its description says {limits}", variable.name);
            return Err(file.wrong_heading(index + 1, message));
        }
        Ok((driven.variable, Curve { rows, held: is_held(variable) }))
    };
    let mut curves: Curves = driven.iter().enumerate().map(curve).collect::<Result<_, _>>()?;
    curves.sort_by_key(|(variable, _)| *variable);
    Ok(curves)
}

/// What the columns behind the time drive.
fn driven(file: &TableFile, description: &ModelDescription) -> Result<Vec<Driven>, TableError> {
    let mut all: Vec<Driven> = Vec::new();
    for (index, heading) in file.headings().iter().enumerate().skip(1) {
        let wrong = |(message, help): (String, Option<String>)| file.wrong_heading(index, message).help(help);
        let (variable, unit) = named(heading, description).map_err(wrong)?;
        let declared = &description.variables[variable];
        let name = &declared.name;
        if !may_be_driven(declared) {
            let message = format!("`{name}` is neither an input nor tunable: {}", declared.causality.name());
            return Err(file.wrong_heading(index, message));
        }
        if matches!(declared.kind, Kind::String { .. }) {
            let message = format!("`{name}` takes texts; only numbers and Booleans can follow a table");
            return Err(file.wrong_heading(index, message));
        }
        if all.iter().any(|driven| driven.variable == variable) {
            return Err(file.wrong_heading(index, format!("`{name}` has a column already")));
        }
        let conversion = unit.map_or(Ok(Conversion::IDENTITY), |unit| conversion(unit, declared, description));
        all.push(Driven { variable, conversion: conversion.map_err(wrong)? });
    }
    Ok(all)
}

/// A message and a remedy.
type Refused = (String, Option<String>);

/// The variable that a heading names, and the unit of measure behind its name.
fn named<'a>(heading: &'a Heading, description: &ModelDescription) -> Result<(usize, Option<&'a str>), Refused> {
    if let Some(variable) = variable_of(&heading.text, description) {
        return Ok((variable, None));
    }
    let (name, unit) = heading.with_unit().map_or((heading.text.as_str(), None), |(name, unit)| (name, Some(unit)));
    let variable = variable_of(name, description);
    variable.map(|variable| (variable, unit)).ok_or_else(|| unknown(name, description))
}

fn unknown(name: &str, description: &ModelDescription) -> Refused {
    let names = || description.variables.iter().filter(|variable| may_be_driven(variable)).map(|v| v.name.as_str());
    let help = match dsl::nearest::nearest(name, names()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if names().next().is_none() => "the unit has no inputs".to_owned(),
        None => format!("columns can be {}", names().collect::<Vec<_>>().join(", ")),
    };
    (format!("the unit has no variable `{name}`"), Some(help))
}

/// From a unit of measure, by the definition of the unit's description or else the built-in one, to the variable's.
fn conversion(unit: &str, variable: &Variable, description: &ModelDescription) -> Result<Conversion, Refused> {
    let name = &variable.name;
    let Some(own) = description.unit_of(variable) else {
        let help = format!("write `{name}` without a unit of measure");
        return Err((format!("`{name}` declares no unit of measure that `{unit}` could be converted to"), Some(help)));
    };
    if own == unit {
        return Ok(Conversion::IDENTITY);
    }
    let defined = |name: &str| description.unit(name).and_then(|definition| definition.base);
    let from = defined(unit).map_or_else(|| parse(unit), Ok).map_err(|unknown| (unknown.to_string(), None))?;
    let to = defined(own);
    let help = Some(format!("write `{name} [{own}]`"));
    let Some(to) = to else {
        return Err((format!("`{unit}` cannot be converted to `{own}`, which the unit does not define"), help));
    };
    let without_offset = |unit: BaseUnit| BaseUnit { offset: 0.0, ..unit };
    let (from, to) =
        if is_relative(variable, description) { (without_offset(from), without_offset(to)) } else { (from, to) };
    let mismatch = || (format!("`{unit}` cannot be converted to `{own}`, the unit of measure of `{name}`"), help);
    from.conversion_to(&to).ok_or_else(mismatch)
}

/// Whether values are differences, to which the offset of a scale such as degC does not apply.
fn is_relative(variable: &Variable, description: &ModelDescription) -> bool {
    let Kind::Real(own) = &variable.kind else { return false };
    let declared = || description.simple_type(variable.declared_type.as_deref()?);
    let inherited = || match &declared()?.kind {
        TypeKind::Real(real) => real.relative_quantity,
        _ => None,
    };
    own.relative_quantity.or_else(inherited).unwrap_or(false)
}

fn may_be_driven(variable: &Variable) -> bool {
    let tunable = variable.causality == Causality::Parameter && variable.variability == Variability::Tunable;
    variable.causality == Causality::Input || tunable
}

/// Whether values stand until the next row, as for everything that is not continuous.
fn is_held(variable: &Variable) -> bool {
    !matches!(variable.kind, Kind::Real(_)) || variable.variability != Variability::Continuous
}

fn cell_type(variable: usize, description: &ModelDescription) -> CellType {
    let variable = &description.variables[variable];
    match variable.kind {
        Kind::Boolean { .. } => CellType::Boolean,
        Kind::Integer { .. } => CellType::Integer,
        Kind::Enumeration { .. } => {
            let items = description.items_of(variable).iter();
            CellType::Enumeration(items.map(|item| (item.value, item.name.clone())).collect())
        }
        Kind::Real(_) | Kind::String { .. } => CellType::Real,
    }
}

#[cfg(test)]
mod tests {
    use super::{Curves, Path, TableError};
    use crate::cli::simulate::alone::tests::tank;

    fn read(text: &str) -> Result<Curves, TableError> {
        super::read(Path::new("in.csv"), text.as_bytes().to_vec(), &tank())
    }

    fn wrong(text: &str) -> String {
        let wrong = read(text).unwrap_err();
        let help = wrong.help.as_ref().map_or(String::new(), |help| format!("\n  help: {help}"));
        format!("{wrong}{help}\n")
    }

    /// A variable, whether its values are held, and times with values.
    type Read = (usize, bool, Vec<(f64, f64)>);

    fn rows(text: &str) -> Vec<Read> {
        let curves = read(text).unwrap_or_else(|error| panic!("{error}"));
        curves.into_iter().map(|(variable, curve)| (variable, curve.held, curve.rows)).collect()
    }

    #[test]
    fn reals_are_interpolated_and_everything_else_is_held() {
        let text = "\u{feff}time,\"open\",inflow,gain\r\n0,true,1.5,1\r\n\r\n2,0,2.5,3\r\n";
        let expected = [
            (1, false, vec![(0.0, 1.5), (2.0, 2.5)]),
            (3, true, vec![(0.0, 1.0), (2.0, 0.0)]),
            (6, true, vec![(0.0, 1.0), (2.0, 3.0)]),
        ];
        assert_eq!(rows(text), expected);
    }

    #[test]
    fn a_table_of_a_spreadsheet_means_what_it_shows() {
        let expected = [
            (1, false, vec![(0.0, 1.5), (0.2, 2.5)]),
            (2, true, vec![(0.0, 2.0), (0.2, 1.0)]),
            (3, true, vec![(0.0, 1.0), (0.2, 0.0)]),
        ];
        let text =
            "\u{feff}# made by hand\nTime [ms];mode;open;inflow\r\n0;Drain;TRUE;1.5\r\n200;1;False;2.5\r\n;;;\r\n";
        assert_eq!(rows(text), expected);
    }

    #[test]
    fn a_column_with_a_unit_of_measure_is_converted_to_that_of_its_variable() {
        assert_eq!(rows("time,depth [cm]\n0,150\n"), [(7, false, vec![(0.0, 1.5)])]);
        assert_eq!(rows("time,depth [m]\n0,1.5\n"), [(7, false, vec![(0.0, 1.5)])]);
        assert_eq!(rows("time,rise [degC]\n0,10\n"), [(8, false, vec![(0.0, 10.0)])]);
        assert_eq!(rows("time,water [degC]\n0,10\n"), [(9, false, vec![(0.0, 283.15)])]);
    }

    proptest::proptest! {
        #[test]
        fn whatever_a_file_holds_is_curves_or_an_error(
            text in "(time,inflow\n|t,open,mode\n)?([0-9.,\"\r\n te\\PC]{0,80}|([0-9],[0-9.]{1,4}\n){0,5})"
        ) {
            if let Ok(curves) = read(&text) {
                proptest::prop_assert!(curves.iter().all(|(_, curve)| !curve.rows.is_empty()));
            }
        }
    }

    #[test]
    fn whatever_is_wrong_has_its_line_and_column() {
        let texts = [
            "",
            "time,inflow\n",
            "inflow,open\n0,1\n",
            "time [m],open\n0,1\n",
            "time,inflow [m3/s]\n0,1\n",
            "time,depth [kg]\n0,1\n",
            "time,depth [fathom]\n0,1\n",
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
            "time;inflow\n0;0,5\n",
            "time,inflow\n0,TRUE\n",
            "time,inflow,mode\n0,1,Spill\n",
            "time,inflow,open\n0,,1\n",
            "time,inflow,mode\n0,1,2\n1,1,3\n",
            "time,depth [km]\n0,1e308\n",
        ];
        insta::assert_snapshot!(texts.map(wrong).concat());
    }
}
