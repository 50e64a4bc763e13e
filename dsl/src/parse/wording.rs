//! The words of the language and a model line for each statement.

/// A word that begins a statement or an action, what users call the statement, and how one looks.
pub(super) struct Model {
    /// The word; empty for a connection.
    pub word: &'static str,
    /// With its article.
    pub called: &'static str,
    /// One or two lines that are right.
    pub example: &'static str,
}

/// All statements; [`statement_words`] leaves out the connection.
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

/// The words that statements begin with.
pub(super) fn statement_words() -> impl Iterator<Item = &'static str> {
    STATEMENTS.iter().map(|model| model.word).filter(|word| !word.is_empty())
}

/// Whether a word begins a statement.
pub(super) fn is_statement_word(word: &str) -> bool {
    statement_words().any(|candidate| candidate == word)
}

/// Whether a word belongs to the language and so cannot be a name.
pub(super) fn is_reserved(word: &str) -> bool {
    const OTHERS: [&str; 20] = [
        "set",
        "fault",
        "on",
        "every",
        "in",
        "as",
        "and",
        "or",
        "not",
        "implies",
        "until",
        "always",
        "eventually",
        "hold",
        "held",
        "lasting",
        "within",
        "after",
        "true",
        "false",
    ];
    is_statement_word(word) || OTHERS.contains(&word)
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
    let words: Vec<_> = rule.split('"').skip(1).step_by(2).collect();
    assert_eq!(words.len(), 34);
    assert!(words.iter().all(|word| is_reserved(word)), "{words:?}");
    assert!(statement_words().all(|word| words.contains(&word)));
    assert!(!is_reserved("time"));
}
