//! What the text of a cell, or a number of a Parquet file, means in a column of some type.

use std::collections::BTreeMap;

/// What a column takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CellType {
    /// Numbers and Booleans: nothing says which.
    Any,
    /// Numbers.
    Real,
    /// Whole numbers of 32 bits.
    Integer,
    /// `true` and `false` in any case, 1 and 0.
    Boolean,
    /// Values of items, or their names.
    Enumeration(BTreeMap<i32, String>),
}

impl CellType {
    /// The number that a text stands for in a column of this name.
    ///
    /// # Errors
    /// Why it stands for none.
    pub(super) fn of_text(&self, text: &str, column: &str) -> Result<f64, String> {
        let number = text.parse::<f64>().ok();
        if let Some(value) = self.item(text) {
            return match number {
                Some(number) if number != f64::from(value) => {
                    Err(format!("`{text}` is the name of the item with the value {value}, and a number"))
                }
                _ => Ok(f64::from(value)),
            };
        }
        match (self, number) {
            (_, Some(number)) => self.of_number(number, text, column),
            (Self::Any | Self::Boolean, None) if text.eq_ignore_ascii_case("true") => Ok(1.0),
            (Self::Any | Self::Boolean, None) if text.eq_ignore_ascii_case("false") => Ok(0.0),
            _ => Err(self.no_number(text, column)),
        }
    }

    /// Checks a number, which is written as `text`.
    ///
    /// # Errors
    /// The column cannot take it.
    pub(super) fn of_number(&self, number: f64, text: &str, column: &str) -> Result<f64, String> {
        let is_whole = number.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&number);
        match self {
            Self::Integer | Self::Enumeration(_) if !is_whole => {
                Err(format!("`{text}` is no whole number of 32 bits, which `{column}` takes"))
            }
            Self::Boolean if ![0.0, 1.0].contains(&number) => Err(self.no_number(text, column)),
            _ => Ok(number),
        }
    }

    fn item(&self, text: &str) -> Option<i32> {
        let Self::Enumeration(items) = self else { return None };
        items.iter().find(|(_, name)| *name == text).map(|(value, _)| *value)
    }

    fn no_number(&self, text: &str, column: &str) -> String {
        let is_word = ["true", "false"].iter().any(|word| text.eq_ignore_ascii_case(word));
        let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        let with_comma = text.trim_start_matches(['-', '+']).split_once(',');
        match self {
            _ if text.is_empty() => format!("the cell is empty, and `{column}` needs a value in each row"),
            _ if with_comma
                .is_some_and(|(whole, rest)| is_digits(whole) && rest.starts_with(|c: char| c.is_ascii_digit())) =>
            {
                format!("`{text}` has a comma; a number is written with a point, `{}`", text.replace(',', "."))
            }
            Self::Boolean => format!("`{text}` is no Boolean (true, false, 0 or 1), which `{column}` takes"),
            Self::Enumeration(items) => {
                let items: Vec<_> = items.values().map(String::as_str).collect();
                format!("`{text}` is neither a number nor an item of `{column}`: {}", items.join(", "))
            }
            Self::Real | Self::Integer if is_word => format!("`{text}` is a Boolean, and `{column}` takes numbers"),
            _ => format!("`{text}` is not a number"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_means_a_number_a_boolean_or_an_item_as_its_column_takes_them() {
        let mode = CellType::Enumeration([(1, "Fill".to_owned()), (2, "Drain".to_owned()), (3, "4".to_owned())].into());
        for (cell_type, text, meaning) in [
            (&CellType::Any, "TRUE", Ok(1.0)),
            (&CellType::Any, "1e3", Ok(1000.0)),
            (&CellType::Boolean, "False", Ok(0.0)),
            (&CellType::Boolean, "1", Ok(1.0)),
            (&CellType::Integer, "-7", Ok(-7.0)),
            (&mode, "Drain", Ok(2.0)),
            (&mode, "2", Ok(2.0)),
            (&mode, "4", Err("`4` is the name of the item with the value 3, and a number")),
            (&mode, "drain", Err("`drain` is neither a number nor an item of `c`: Fill, Drain, 4")),
            (&CellType::Any, "Drain", Err("`Drain` is not a number")),
            (&CellType::Real, "TRUE", Err("`TRUE` is a Boolean, and `c` takes numbers")),
            (&CellType::Real, "-0,5", Err("`-0,5` has a comma; a number is written with a point, `-0.5`")),
            (&CellType::Real, "", Err("the cell is empty, and `c` needs a value in each row")),
            (&CellType::Boolean, "yes", Err("`yes` is no Boolean (true, false, 0 or 1), which `c` takes")),
            (&CellType::Integer, "1.5", Err("`1.5` is no whole number of 32 bits, which `c` takes")),
        ] {
            assert_eq!(cell_type.of_text(text, "c"), meaning.map_err(str::to_owned), "{text}");
        }
    }
}
