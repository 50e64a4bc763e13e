//! The words of the language and a model line for each statement.

use super::grammar::Rule;

/// A word that begins a statement or an action, what users call the statement, and how one looks.
pub(super) struct Model {
    /// The word; empty for a connection.
    pub word: &'static str,
    /// With its article.
    pub called: &'static str,
    /// One or two lines that are right.
    pub example: &'static str,
}

/// All statements in the order of [`KEYWORDS`], and the connection, which begins with no word.
pub(super) const STATEMENTS: [Model; 15] = [
    model("scenario", "a scenario line", "`scenario \"A quadcopter in wind\"`"),
    model("step", "a step line", "`step 5 ms`"),
    model("stop", "a stop line", "`stop 60 s` or `stop when quad.landed`"),
    model("param", "a param line", "`param gust = 4 m/s`"),
    model("let", "a let line", "`let goal = [60, 20, 3] m`"),
    model("fmu", "an fmu line", "`fmu quad = \"quadcopter\" every 5 ms { mass = 1.6 kg }`"),
    model("use", "a use line", "`use lead = \"uav.scn\" { start = [0, 0, 30] m }`"),
    model("for", "a for block", "`for i in 1..3 { … }`"),
    model("at", "an at block", "`at 30 s lasting 8 s { set wind.mean = [8, 2, 0] m/s }`"),
    model("when", "a when block", "`when quad.landed held 2 s { set ctrl.armed = false }`"),
    model("while", "a while block", "`while world.clearance < 3 m { fault eye.scan: freeze }`"),
    model("assert", "an assert line", "`assert clear: always world.clearance > 0.8 m`"),
    model("record", "a record line", "`record quad.state, wind.* every 20 ms`"),
    model("sweep", "a sweep", "`sweep { seed in 1..25 }`"),
    model("", "a connection", "`quad.state -> ctrl.state`"),
];

/// The actions of `at`, `when` and `while`.
pub(super) const ACTIONS: [Model; 2] = [
    model("set", "a set", "`set wind.mean = [8, 2, 0] m/s`"),
    model("fault", "a fault", "`fault eye.scan: noise 10 cm, loss 5 %`"),
];

const fn model(word: &'static str, called: &'static str, example: &'static str) -> Model {
    Model { word, called, example }
}

/// What a word of the language is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// It begins a statement.
    Statement,
    /// It begins an action.
    Action,
    /// It begins a clause of a statement.
    Clause,
    /// It joins two conditions, and may begin the line after the first.
    Joint,
    /// A prefix operator on a condition.
    Prefix,
    /// Between a value and a unit of measure; `in` also before a range.
    Conversion,
    /// It is a value.
    Value,
}

/// A word of the language.
pub(super) struct Keyword {
    /// The word.
    pub word: &'static str,
    /// Its rule in the grammar; a value has that of all values.
    pub rule: Rule,
    /// What it is for.
    pub usage: Use,
}

const fn keyword(word: &'static str, rule: Rule, usage: Use) -> Keyword {
    Keyword { word, rule, usage }
}

/// All words of the language, which cannot be names. The rule `word` of the grammar lists them too, which a test checks.
pub(super) const KEYWORDS: [Keyword; 35] = [
    keyword("scenario", Rule::SCENARIO, Use::Statement),
    keyword("step", Rule::STEP, Use::Statement),
    keyword("stop", Rule::STOP, Use::Statement),
    keyword("param", Rule::PARAM, Use::Statement),
    keyword("let", Rule::LET, Use::Statement),
    keyword("fmu", Rule::FMU, Use::Statement),
    keyword("use", Rule::USE, Use::Statement),
    keyword("for", Rule::FOR, Use::Statement),
    keyword("at", Rule::AT, Use::Statement),
    keyword("when", Rule::WHEN, Use::Statement),
    keyword("while", Rule::WHILE, Use::Statement),
    keyword("assert", Rule::ASSERT, Use::Statement),
    keyword("record", Rule::RECORD, Use::Statement),
    keyword("sweep", Rule::SWEEP, Use::Statement),
    keyword("set", Rule::SET, Use::Action),
    keyword("fault", Rule::FAULT, Use::Action),
    keyword("held", Rule::HELD, Use::Clause),
    keyword("lasting", Rule::LASTING, Use::Clause),
    keyword("on", Rule::ON, Use::Clause),
    keyword("every", Rule::EVERY, Use::Clause),
    keyword("within", Rule::WITHIN, Use::Clause),
    keyword("after", Rule::AFTER, Use::Clause),
    keyword("always", Rule::ALWAYS, Use::Prefix),
    keyword("eventually", Rule::EVENTUALLY, Use::Prefix),
    keyword("finally", Rule::FINALLY, Use::Prefix),
    keyword("hold", Rule::HOLD, Use::Prefix),
    keyword("not", Rule::NOT, Use::Prefix),
    keyword("in", Rule::IN, Use::Conversion),
    keyword("as", Rule::AS, Use::Conversion),
    keyword("and", Rule::AND, Use::Joint),
    keyword("or", Rule::OR, Use::Joint),
    keyword("implies", Rule::IMPLIES, Use::Joint),
    keyword("until", Rule::UNTIL, Use::Joint),
    keyword("true", Rule::bool, Use::Value),
    keyword("false", Rule::bool, Use::Value),
];

/// The words of these uses.
pub(super) fn words(of: &[Use]) -> impl Iterator<Item = &'static str> {
    KEYWORDS.iter().filter(move |keyword| of.contains(&keyword.usage)).map(|keyword| keyword.word)
}

/// What a word of the language is for; `None` for any other word.
pub(super) fn usage(word: &str) -> Option<Use> {
    KEYWORDS.iter().find(|keyword| keyword.word == word).map(|keyword| keyword.usage)
}

/// The words that statements begin with.
pub(super) fn statement_words() -> impl Iterator<Item = &'static str> {
    words(&[Use::Statement])
}

/// Whether a word begins a statement.
pub(super) fn is_statement_word(word: &str) -> bool {
    usage(word) == Some(Use::Statement)
}

/// Whether a word belongs to the language and so cannot be a name.
pub(super) fn is_reserved(word: &str) -> bool {
    usage(word).is_some()
}

/// The model of the statement or action that a word begins; that of a connection for any other word.
pub(super) fn model_of(word: &str) -> &'static Model {
    let connection = &STATEMENTS[STATEMENTS.len() - 1];
    STATEMENTS.iter().chain(&ACTIONS).find(|model| model.word == word).unwrap_or(connection)
}

#[test]
fn the_reserved_words_are_those_of_the_grammar() {
    let grammar = include_str!("../scenario.pest");
    let rule =
        grammar.split_once("\nword = @{").and_then(|(_, rest)| rest.split_once('}')).map_or("", |(rule, _)| rule);
    let mut words: Vec<_> = rule.split('"').skip(1).step_by(2).collect();
    let mut known: Vec<_> = KEYWORDS.iter().map(|keyword| keyword.word).collect();
    known.sort_unstable();
    words.sort_unstable();
    assert_eq!(words, known);
    assert!(!is_reserved("time"));
}

#[test]
fn every_statement_and_action_has_a_model_line() {
    let models = |models: &[Model]| models.iter().map(|model| model.word).collect::<Vec<_>>();
    assert_eq!(models(&STATEMENTS[..STATEMENTS.len() - 1]), statement_words().collect::<Vec<_>>());
    assert_eq!(models(&ACTIONS), words(&[Use::Action]).collect::<Vec<_>>());
}

#[test]
fn the_rule_of_a_word_has_its_name() {
    for Keyword { word, rule, .. } in KEYWORDS.iter().filter(|keyword| keyword.usage != Use::Value) {
        assert_eq!(format!("{rule:?}"), word.to_uppercase());
    }
}
