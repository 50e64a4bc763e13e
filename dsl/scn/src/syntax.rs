//! What was written: a tree with spans, before any name means anything. Next on the walk: `resolve/`.

use crate::source::Span;

/// A text with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The text, without quotes.
    pub text: String,
    /// Its place, quotes included.
    pub span: Span,
}

/// A whole file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// The statements, in the file's order.
    pub statements: Vec<Statement>,
}

/// One statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// What it says.
    pub kind: StatementKind,
    /// From its first to its last character.
    pub span: Span,
    /// The comment lines right above it.
    pub documentation: Option<Span>,
}

/// The sixteen statements and the connection.
#[derive(Clone, Debug, PartialEq)]
pub enum StatementKind {
    /// `scenario "title"`
    Scenario(Word),
    /// `step 5 ms`
    Step(Expression),
    /// `stop 60 s`
    Stop(Expression),
    /// `stop when c held 2 s`
    StopWhen {
        /// The condition.
        condition: Expression,
        /// `held`
        held: Option<Expression>,
    },
    /// `param name = value`
    Param(Binding),
    /// `let name = value`
    Let(Binding),
    /// `fmu name = "unit" every P { … }`
    Fmu(Instance),
    /// `use name = "part.scn" on host { … }`
    Use(Instance),
    /// `for i in 1..3 { … }`
    For {
        /// The counter.
        variable: Word,
        /// What it runs through.
        range: Expression,
        /// The statements of a round.
        body: Vec<Statement>,
    },
    /// `at t lasting d { … }`
    At(Window),
    /// `when c held h lasting d { … }`
    When(Window),
    /// `while c { … }`
    While(Window),
    /// `assert name: claim`
    Assert {
        /// The claim's name.
        name: Name,
        /// The claim.
        claim: Expression,
    },
    /// `record a.b, c.* every 20 ms`
    Record {
        /// What to record.
        signals: Vec<Path>,
        /// How often.
        every: Option<Expression>,
    },
    /// `sweep { … }`
    Sweep(Vec<Axis>),
    /// `a.y -> b.u, c.u`
    Wire {
        /// The left side.
        source: Expression,
        /// Which arrow.
        arrow: Arrow,
        /// The place of the arrow.
        arrow_span: Span,
        /// The right sides.
        targets: Vec<Path>,
    },
}

/// `name = value` of `param` and `let`.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// The name.
    pub name: Word,
    /// The value.
    pub value: Expression,
}

/// The right-hand parts of `fmu` and `use`; repeated clauses are kept for the resolver to refuse.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The name in the script.
    pub name: Name,
    /// What is instantiated: a unit's name or path, or a part's path.
    pub unit: Word,
    /// `on host`
    pub on: Vec<Name>,
    /// `every 50 ms`
    pub every: Vec<Expression>,
    /// `{ key = value, … }`
    pub values: Vec<Value>,
}

/// `key = value` in the braces of an instance.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// A variable, group or array of the unit.
    pub key: Path,
    /// Its value.
    pub value: Expression,
}

/// `at`, `when` or `while` with its actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// The time of `at`, the condition of `when` and `while`.
    pub trigger: Expression,
    /// `held`
    pub held: Option<Expression>,
    /// `lasting`
    pub lasting: Option<Expression>,
    /// What happens.
    pub actions: Vec<Action>,
}

/// One action in braces.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// `set port = value`
    Set {
        /// Which port.
        target: Path,
        /// The value, tracked while the window is open.
        value: Expression,
        /// From `set` to the end of the value.
        span: Span,
    },
    /// `fault port: kind, kind`
    Fault {
        /// Which port.
        target: Path,
        /// The kinds with their operands.
        kinds: Vec<(Word, Option<Expression>)>,
        /// From `fault` to the end.
        span: Span,
    },
}

/// One axis of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The parameter.
    pub name: Word,
    /// `~` instead of `in`.
    pub drawn: bool,
    /// The range, list or distribution.
    pub values: Expression,
}

/// `->` or `=>`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arrow {
    /// `->`: the value of the source when the step began.
    Held,
    /// `=>`: the source steps first.
    Direct,
}

/// A declared name with an optional index, `wing[1]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The name.
    pub word: Word,
    /// The index.
    pub index: Vec<Expression>,
    /// The whole.
    pub span: Span,
}

/// `wing[1].body.state.{x, y}`.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The first name.
    pub root: Word,
    /// What follows.
    pub tail: Vec<Segment>,
    /// The whole.
    pub span: Span,
}

/// A part of a path.
#[derive(Clone, Debug, PartialEq)]
pub enum Segment {
    /// `.name` or `.'odd name'`
    Field(Word),
    /// `.{x, y}`
    Members(Vec<Word>, Span),
    /// `[1, 2]`
    Index(Vec<Expression>, Span),
    /// `[*]`
    AllIndices(Span),
    /// `.*`
    All(Span),
}

/// An expression, condition or claim with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// What it is.
    pub kind: ExpressionKind,
    /// From its first to its last character.
    pub span: Span,
    /// Whether it has parentheses of its own.
    pub parenthesised: bool,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionKind {
    /// `9.81 m/s^2`
    Quantity {
        /// The number as written.
        number: f64,
        /// The unit as written, quotes dropped.
        unit: Option<Word>,
    },
    /// `"text"`
    Text(String),
    /// `true`, `false`
    Boolean(bool),
    /// `a.b[1]`
    Path(Path),
    /// `[1, 2, 3] m`, `[2 m; 3]`
    List {
        /// The elements.
        elements: Vec<Expression>,
        /// How many times the one element counts.
        copies: Option<Box<Expression>>,
        /// The unit of all of them.
        unit: Option<Word>,
    },
    /// `max(a, b)`
    Call {
        /// The function.
        function: Word,
        /// Its arguments.
        arguments: Vec<Expression>,
    },
    /// `-x`
    Negate(Box<Expression>),
    /// `x in deg`
    In(Box<Expression>, Word),
    /// `x as V`
    As(Box<Expression>, Word),
    /// `a + b`, `a - b`, `a * b`, `a / b`
    Arithmetic(Operator, Box<Expression>, Box<Expression>),
    /// `a..b`
    Range(Box<Expression>, Box<Expression>),
    /// `a < b < c`, `a == b ± d`
    Comparison {
        /// The leftmost operand.
        first: Box<Expression>,
        /// What follows.
        rest: Vec<ComparisonLink>,
    },
    /// `not a`
    Not(Box<Expression>),
    /// `a and b and c`
    And(Vec<Expression>),
    /// `a or b or c`
    Or(Vec<Expression>),
    /// `a until within 3 s b`
    Until {
        /// What holds until then.
        left: Box<Expression>,
        /// `within`, `after`
        span: Option<TimeSpan>,
        /// What must come.
        right: Box<Expression>,
    },
    /// `g implies φ`
    Implies(Box<Expression>, Box<Expression>),
    /// `always …`, `eventually …`, `finally …`, `hold for d …`
    Temporal {
        /// The keyword.
        word: TemporalWord,
        /// The place of the word.
        word_span: Span,
        /// The window; for `hold for d` it is `within d`.
        span: Option<TimeSpan>,
        /// The body.
        body: Box<Expression>,
    },
}

/// One comparison of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonLink {
    /// The operator.
    pub operator: Comparator,
    /// Its place.
    pub operator_span: Span,
    /// The right operand.
    pub operand: Expression,
    /// `± d`
    pub tolerance: Option<Expression>,
    /// `within w` behind `± d`
    pub tolerance_time: Option<Expression>,
}

/// The arithmetic operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
}

/// The comparison operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparator {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

/// The temporal words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TemporalWord {
    /// `always`
    Always,
    /// `eventually`
    Eventually,
    /// `finally`
    Finally,
    /// `hold for`
    Hold,
}

/// `within b`, `within a..b`, `after a`.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeSpan {
    /// `within [from..]to`
    Within {
        /// The near end, 0 unless written.
        from: Option<Box<Expression>>,
        /// The far end.
        to: Box<Expression>,
    },
    /// `after a`
    After(Box<Expression>),
}
