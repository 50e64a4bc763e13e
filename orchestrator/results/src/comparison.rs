//! What a claim compares with which limits, written so that a program can compute it from the columns of the trace.

use serde::{Deserialize, Serialize};

/// One comparison of a claim: a quantity that must stay between limits, or come between them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The comparison as written; empty where it has no text of its own.
    #[serde(default)]
    pub text: String,
    /// Its index among the parts of the claim; several comparisons may stem from one part.
    pub part: usize,
    /// What is compared, in `unit`.
    pub quantity: Quantity,
    /// Whether the quantity is the margin of the comparison, because no side of that is a constant.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_margin: bool,
    /// The unit of the quantity and its limits; of a column alone, and of plain numbers, `None`: it is the column's own.
    pub unit: Option<String>,
    /// The lower limit.
    pub low: Option<f64>,
    /// The upper limit.
    pub high: Option<f64>,
    /// Whether one sample within the limits is enough, as below `eventually`; then a margin is that of the best sample.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub once: bool,
    /// The first simulated second at which it counts.
    pub from_s: f64,
    /// The last; `None` is the end of the run.
    pub to_s: Option<f64>,
}

/// A number at each row of the trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Quantity {
    /// The same number throughout.
    Constant(f64),
    /// The value of a column, in the column's unit.
    Column {
        /// Its name.
        column: String,
    },
    /// A function of other quantities.
    Call {
        /// Which.
        call: Operation,
        /// Its arguments.
        of: Vec<Quantity>,
    },
}

/// The functions of quantities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Operation {
    /// The simulated time in seconds, without arguments.
    Time,
    /// The first minus the second.
    Subtract,
    /// The product.
    Multiply,
    /// The first over the second.
    Divide,
    /// The magnitude of one argument.
    Abs,
    /// The smallest argument.
    Min,
    /// The largest argument.
    Max,
    /// The sum.
    Sum,
    /// The sum over the count.
    Mean,
    /// The square root.
    Sqrt,
    /// The exponential.
    Exp,
    /// The natural logarithm.
    Log,
    /// The largest integer not above.
    Floor,
    /// The sine.
    Sin,
    /// The cosine.
    Cos,
    /// The tangent.
    Tan,
    /// The angle of (y, x).
    Atan2,
    /// The Euclidean length of the arguments.
    Norm,
}

impl Quantity {
    /// A function of other quantities.
    #[must_use]
    pub fn call(call: Operation, of: Vec<Self>) -> Self {
        Self::Call { call, of }
    }

    /// The names of the columns that it is computed from, in order, each once.
    #[must_use]
    pub fn columns(&self) -> Vec<&str> {
        let mut names = Vec::new();
        self.visit(&mut |name| {
            if !names.contains(&name) {
                names.push(name);
            }
        });
        names
    }

    fn visit<'q>(&'q self, visit: &mut impl FnMut(&'q str)) {
        match self {
            Self::Constant(_) => {}
            Self::Column { column } => visit(column),
            Self::Call { of, .. } => of.iter().for_each(|argument| argument.visit(visit)),
        }
    }

    /// Its value, where `column` gives the value of a column; not a number where one is missing.
    pub fn value(&self, time_s: f64, column: &impl Fn(&str) -> f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Column { column: name } => column(name),
            Self::Call { call, of } => {
                let arguments: Vec<_> = of.iter().map(|argument| argument.value(time_s, column)).collect();
                call.apply(time_s, &arguments)
            }
        }
    }
}

impl Operation {
    fn apply(self, time_s: f64, arguments: &[f64]) -> f64 {
        let argument = |index: usize| arguments.get(index).copied().unwrap_or(f64::NAN);
        let sum = || arguments.iter().sum::<f64>();
        // Not a number is no smallest and no largest value.
        let pick = |better: fn(f64, f64) -> f64| {
            let joined = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { better(a, b) };
            arguments.iter().copied().reduce(joined).unwrap_or(f64::NAN)
        };
        match self {
            Self::Time => time_s,
            Self::Subtract => argument(0) - argument(1),
            Self::Multiply => arguments.iter().product(),
            Self::Divide => argument(0) / argument(1),
            Self::Abs => argument(0).abs(),
            Self::Min => pick(f64::min),
            Self::Max => pick(f64::max),
            Self::Sum => sum(),
            Self::Mean => sum() / arguments.len() as f64,
            Self::Sqrt => argument(0).sqrt(),
            Self::Exp => libm::exp(argument(0)),
            Self::Log => libm::log(argument(0)),
            Self::Floor => argument(0).floor(),
            Self::Sin => libm::sin(argument(0)),
            Self::Cos => libm::cos(argument(0)),
            Self::Tan => libm::tan(argument(0)),
            Self::Atan2 => libm::atan2(argument(0), argument(1)),
            Self::Norm => arguments.iter().map(|x| x * x).sum::<f64>().sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str) -> Quantity {
        Quantity::Column { column: name.to_owned() }
    }

    #[test]
    fn a_quantity_is_computed_from_columns_and_names_each_once() {
        let difference = Quantity::call(Operation::Subtract, vec![column("a.x"), column("b.x")]);
        let norm = Quantity::call(Operation::Norm, vec![difference, Quantity::Constant(4.0), column("a.x")]);
        assert_eq!(norm.columns(), ["a.x", "b.x"]);
        assert_eq!(norm.value(0.0, &|name| if name == "a.x" { 0.0 } else { 3.0 }), 5.0);
        assert!(norm.value(0.0, &|_| f64::NAN).is_nan());
        let smallest = Quantity::call(Operation::Min, vec![Quantity::Constant(1.0), column("a.x")]);
        assert!(smallest.value(0.0, &|_| f64::NAN).is_nan());
    }

    #[test]
    fn a_quantity_reads_back_from_its_json() {
        let quantity = Quantity::call(Operation::Max, vec![column("a"), Quantity::Constant(0.5)]);
        let json = serde_json::to_string(&quantity).unwrap();
        assert_eq!(json, r#"{"call":"max","of":[{"column":"a"},0.5]}"#);
        assert_eq!(serde_json::from_str::<Quantity>(&json).unwrap(), quantity);
    }
}
