//! Start values that are written as numbers are compared with limits that are.

use crate::attribute::PortAttribute;
use syn::spanned::Spanned;
use syn::{Error, Expr, ExprLit, ExprRepeat, ExprUnary, Lit, Result, UnOp};

/// Reports a number of the start value that lies outside `min` and `max`. What is not written as a number is checked by the
/// tests that every unit has.
pub fn check(port: &PortAttribute) -> Result<()> {
    let limit = |limit: &Option<Expr>| limit.as_ref().and_then(number);
    let (min, max) = (limit(&port.min), limit(&port.max));
    if let (Some(min), Some(max), Some(written)) = (min, max, &port.max)
        && min > max
    {
        return Err(Error::new(written.span(), format!("`max` is below `min`, which is {min}")));
    }
    let start = port.start.as_ref().or(port.exact.as_ref().and_then(Option::as_ref));
    for (value, expression) in start.map(numbers).unwrap_or_default() {
        let message = match (min, max) {
            (Some(min), _) if value < min => format!("the start value {value} is below `min`, which is {min}"),
            (_, Some(max)) if value > max => format!("the start value {value} is above `max`, which is {max}"),
            _ => continue,
        };
        return Err(Error::new(expression.span(), message));
    }
    Ok(())
}

/// The numbers in a start value: itself, or those of an array.
fn numbers(start: &Expr) -> Vec<(f64, &Expr)> {
    match start {
        Expr::Array(array) => array.elems.iter().flat_map(numbers).collect(),
        Expr::Repeat(ExprRepeat { expr, .. }) => numbers(expr),
        _ => number(start).map(|number| (number, start)).into_iter().collect(),
    }
}

fn number(expression: &Expr) -> Option<f64> {
    match expression {
        Expr::Unary(ExprUnary { op: UnOp::Neg(_), expr, .. }) => number(expr).map(|number| -number),
        Expr::Lit(ExprLit { lit: Lit::Float(float), .. }) => float.base10_parse().ok(),
        Expr::Lit(ExprLit { lit: Lit::Int(integer), .. }) => integer.base10_parse().ok(),
        _ => None,
    }
}

#[test]
fn numbers_are_found_in_signs_and_arrays() {
    let values = |text: &str| -> Vec<f64> {
        let start: Expr = syn::parse_str(text).expect("an expression");
        numbers(&start).into_iter().map(|(value, _)| value).collect()
    };
    assert_eq!(values("-1.5"), [-1.5]);
    assert_eq!(values("[[1, -2], [3, 4]]"), [1.0, -2.0, 3.0, 4.0]);
    assert_eq!(values("[7.0; 3]"), [7.0]);
    assert!(values("airframe().mass_kg").is_empty());
}
