//! Claims: formulas with margins.

use super::{BooleanExpression, Margin};
use serde::{Deserialize, Serialize};

/// An `assert`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// The name.
    pub name: String,
    /// The claim as written, on one line.
    pub text: String,
    /// The file of the `assert`, without its folders, if that is a part.
    pub part_file: Option<String>,
    /// Line of the `assert` in its file, from 1.
    pub line: usize,
    /// What must hold at tick 0.
    pub formula: Formula,
    /// The unit in which margins are shown; `None` where all margins are infinite.
    pub unit: Option<MarginUnit>,
    /// For a claim about one comparison with a constant: its limit.
    pub limit: Option<Limit>,
    /// What reports say of the atoms of the formula, from left to right, those of a gate before those of its body.
    pub parts: Vec<ClaimPart>,
    /// For each gate of the formula the sentence that says that it never opened; inner gates before outer ones.
    pub gates: Vec<String>,
}

impl Claim {
    /// A claim of which nothing but its meaning is known.
    #[must_use]
    pub fn of(formula: Formula) -> Self {
        let (name, text, line) = (String::new(), String::new(), 1);
        Self {
            name,
            text,
            part_file: None,
            line,
            formula,
            unit: None,
            limit: None,
            parts: Vec::new(),
            gates: Vec::new(),
        }
    }
}

/// A comparison or condition of a claim, as reports show it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClaimPart {
    /// As written; empty where it has no text of its own.
    pub text: String,
    /// The temporal words around it with their windows, as written.
    pub window: String,
    /// The signals that it reads.
    pub signals: Vec<String>,
}

/// The unit of a margin: a difference, so without offset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MarginUnit {
    /// The name as the script writes it; empty for plain numbers.
    pub name: String,
    /// SI value of one.
    pub factor: f64,
}

/// The constant side of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// The constant, in [`MarginUnit`].
    pub value: f64,
    /// Whether values must stay below it; what was seen is `value - margin`, else `value + margin`.
    pub upper: bool,
}

/// A claim's meaning in negation normal form: `not` is in atoms only, so that not-a-number fails under it too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Formula {
    /// A comparison with a margin.
    Margin(Margin),
    /// A condition with margin ±∞.
    Condition(BooleanExpression),
    /// All hold; the margin is the smallest.
    And(Vec<Formula>),
    /// One holds; the margin is the largest.
    Or(Vec<Formula>),
    /// Holds at every tick of the window; the margin is the smallest.
    Always(TickWindow, Box<Formula>),
    /// Holds at some tick of the window; the margin is the largest.
    Eventually(TickWindow, Box<Formula>),
    /// `implies`, or its negation.
    Gated(Gated),
    /// `until`, or its negation.
    Until(Until),
    /// Its value at the last tick of the run, at whatever tick it is asked for; a formula without temporal words.
    Finally(Box<Formula>),
}

/// `g implies φ` or its negation: a condition, judged true or false, decides whether `body` counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gated {
    /// Joined as `gate or body`, else as `gate and body`.
    pub any: bool,
    /// `not g` if joined by `or`, else `g`; its margin is ±∞.
    pub gate: Box<Formula>,
    /// `φ`, or `not φ`
    pub body: Box<Formula>,
}

/// `φ until g` or its negation. The value is joined over the ticks u of the window: that of `gate` at u, joined the other
/// way with those of `body` from now to the tick before u.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Until {
    /// Whether one tick suffices; else it is a negation, with `body` and `gate` negated.
    pub any: bool,
    /// When the gate may come.
    pub window: TickWindow,
    /// `φ`
    pub body: Box<Formula>,
    /// `g`; its margin is ±∞.
    pub gate: Box<Formula>,
}

/// Ticks from now on, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TickWindow {
    /// The first.
    pub from: u64,
    /// The last; `None` reaches to the last tick at which the body can be judged.
    pub to: Option<u64>,
}
