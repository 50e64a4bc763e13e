//! From the grammar's pairs to statements.

use pest::iterators::{Pair, Pairs};

use super::grammar::Rule;
use super::lines;
use super::wording::{KEYWORDS, Use};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::{
    Action, Arrow, Axis, Binding, Expression, Instance, Name, Path, Segment, Statement, StatementKind, Value, Window,
    Word,
};

/// A walk over the pairs of one text.
pub(super) struct Walk<'a> {
    source: &'a str,
    text: u32,
    /// The byte of `source` at which the matched text begins.
    from: usize,
    /// Errors that the grammar cannot express.
    pub diagnostics: Vec<Diagnostic>,
}

/// The pairs inside a pair, without the keywords that only give it structure.
pub(super) fn parts(pair: Pair<'_, Rule>) -> impl Iterator<Item = Pair<'_, Rule>> {
    pair.into_inner().filter(|part| !is_structure(part.as_rule()))
}

/// Whether a rule is a keyword that only shows where a part begins; of other keywords the tree needs to know which it is.
fn is_structure(rule: Rule) -> bool {
    let usage = KEYWORDS.iter().find(|keyword| keyword.rule == rule).map(|keyword| keyword.usage);
    match usage {
        Some(Use::Statement | Use::Action | Use::Joint) => true,
        Some(Use::Clause) => !matches!(rule, Rule::WITHIN | Rule::AFTER),
        Some(Use::Prefix) => rule == Rule::NOT,
        Some(Use::Conversion | Use::Value) => false,
        None => rule == Rule::EOI,
    }
}

/// The only pair, which the grammar guarantees.
pub(super) fn only(mut pairs: Pairs<'_, Rule>) -> Pair<'_, Rule> {
    next(&mut pairs)
}

/// The next pair, which the grammar guarantees.
pub(super) fn next<'i>(pairs: &mut impl Iterator<Item = Pair<'i, Rule>>) -> Pair<'i, Rule> {
    match pairs.next() {
        Some(pair) => pair,
        None => unreachable!("scenario.pest promises another part here"),
    }
}

impl<'a> Walk<'a> {
    /// A walk over the pairs of what `source` became.
    pub fn new(source: &'a str, text: u32) -> Self {
        Self { source, text, from: 0, diagnostics: Vec::new() }
    }

    /// The place of a pair, without the blanks that pest adds at its end.
    pub fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let start = self.from + pair.as_span().start();
        lines::span(self.text, start, start + pair.as_str().trim_end().len())
    }

    /// A pair that is one word, without quotes.
    pub fn word(&self, pair: &Pair<'_, Rule>) -> Word {
        let text = pair.as_str();
        let unquoted = |quote| text.strip_prefix(quote)?.strip_suffix(quote);
        let bare = match unquoted('"') {
            Some(escaped) => unescaped(escaped),
            None => unquoted('\'').unwrap_or(text).to_owned(),
        };
        Word { text: bare, span: self.span(pair) }
    }

    /// The statements of a text that was matched from a byte of the source on.
    pub fn statements_from(&mut self, from: usize, pair: Pair<'_, Rule>) -> Vec<Statement> {
        self.from = from;
        self.statements(pair)
    }

    /// The statements of a file or block.
    fn statements(&mut self, pair: Pair<'_, Rule>) -> Vec<Statement> {
        parts(pair).map(|statement| self.statement(statement)).collect()
    }

    fn statement(&mut self, pair: Pair<'_, Rule>) -> Statement {
        let span = self.span(&pair);
        Statement { documentation: self.documentation(self.from + pair.as_span().start()), kind: self.kind(pair), span }
    }

    /// The comment lines right above a line.
    fn documentation(&self, statement: usize) -> Option<Span> {
        let line = lines::line_start(self.source, statement);
        if !self.source[line..statement].trim().is_empty() {
            return None;
        }
        let mut found: Option<Span> = None;
        let mut below = line;
        while let Some(above) = lines::without_line_break(&self.source[..below]) {
            let start = lines::line_start(self.source, above.len());
            let comment = above[start..].trim_start_matches([' ', '\t']);
            if !comment.starts_with('#') {
                break;
            }
            let span = lines::span(self.text, above.len() - comment.len(), above.len());
            found = Some(found.map_or(span, |below| below.to(span)));
            below = start;
        }
        found
    }

    fn kind(&mut self, pair: Pair<'_, Rule>) -> StatementKind {
        let rule = pair.as_rule();
        if let Rule::param | Rule::let_ = rule {
            let binding = self.binding(pair);
            return if rule == Rule::param { StatementKind::Param(binding) } else { StatementKind::Let(binding) };
        }
        if let Rule::at | Rule::when | Rule::while_ = rule {
            let window = self.window(pair);
            return match rule {
                Rule::at => StatementKind::At(window),
                Rule::when => StatementKind::When(window),
                _ => StatementKind::While(window),
            };
        }
        let mut parts = parts(pair);
        match rule {
            Rule::scenario => StatementKind::Scenario(self.word(&next(&mut parts))),
            Rule::step => StatementKind::Step(self.expression(next(&mut parts))),
            Rule::stop => self.stop(parts),
            Rule::fmu => StatementKind::Fmu(self.instance(parts)),
            Rule::use_ => StatementKind::Use(self.instance(parts)),
            Rule::for_ => {
                let variable = self.word(&next(&mut parts));
                let range = parts.find(|part| part.as_rule() == Rule::expr).map(|range| self.expression(range));
                let Some(range) = range else { unreachable!("scenario.pest promises a range in `for`") };
                StatementKind::For { variable, range, body: self.statements(next(&mut parts)) }
            }
            Rule::assert => {
                let name = self.name(next(&mut parts));
                StatementKind::Assert { name, claim: self.expression(next(&mut parts)) }
            }
            Rule::record => {
                let (mut signals, mut every) = (Vec::new(), None);
                for part in parts {
                    match part.as_rule() {
                        Rule::glob => signals.push(self.path(part)),
                        _ => every = Some(self.clause(part)),
                    }
                }
                StatementKind::Record { signals, every }
            }
            Rule::sweep => StatementKind::Sweep(parts.map(|axis| self.axis(axis)).collect()),
            Rule::wire => self.wire(parts),
            other => unreachable!("scenario.pest lists no statement {other:?}"),
        }
    }

    fn stop<'i>(&mut self, mut parts: impl Iterator<Item = Pair<'i, Rule>>) -> StatementKind {
        let first = next(&mut parts);
        if first.as_rule() == Rule::sum {
            return StatementKind::Stop(self.expression(first));
        }
        let condition = self.expression(first);
        StatementKind::StopWhen { condition, held: parts.next().map(|held| self.clause(held)) }
    }

    /// `name = value`
    pub fn binding(&mut self, pair: Pair<'_, Rule>) -> Binding {
        let mut parts = parts(pair);
        let name = self.word(&next(&mut parts));
        Binding { name, value: self.expression(next(&mut parts)) }
    }

    fn instance<'i>(&mut self, mut parts: impl Iterator<Item = Pair<'i, Rule>>) -> Instance {
        let name = self.name(next(&mut parts));
        let unit = self.word(&next(&mut parts));
        let mut instance = Instance { name, unit, on: Vec::new(), every: Vec::new(), values: Vec::new() };
        for part in parts {
            match part.as_rule() {
                Rule::on => instance.on.push(self.name(only_part(part))),
                Rule::every => instance.every.push(self.clause(part)),
                _ => instance.values = part.into_inner().map(|value| self.value(value)).collect(),
            }
        }
        instance
    }

    /// `key = value`
    pub fn value(&mut self, pair: Pair<'_, Rule>) -> Value {
        let mut parts = pair.into_inner();
        let key = self.path(next(&mut parts));
        Value { key, value: self.expression(next(&mut parts)) }
    }

    fn wire<'i>(&mut self, mut parts: impl Iterator<Item = Pair<'i, Rule>>) -> StatementKind {
        let source = self.expression(next(&mut parts));
        let written = next(&mut parts);
        let arrow = if written.as_str() == "->" { Arrow::Held } else { Arrow::Direct };
        let arrow_span = self.span(&written);
        StatementKind::Wire { source, arrow, arrow_span, targets: parts.map(|target| self.path(target)).collect() }
    }

    fn window(&mut self, pair: Pair<'_, Rule>) -> Window {
        let mut parts = parts(pair);
        let trigger = self.expression(next(&mut parts));
        let mut window = Window { trigger, held: None, lasting: None, actions: Vec::new() };
        for part in parts {
            match part.as_rule() {
                Rule::held => window.held = Some(self.clause(part)),
                Rule::lasting => window.lasting = Some(self.clause(part)),
                _ => window.actions = part.into_inner().map(|action| self.action(action)).collect(),
            }
        }
        window
    }

    fn action(&mut self, pair: Pair<'_, Rule>) -> Action {
        let (rule, span) = (pair.as_rule(), self.span(&pair));
        let mut parts = parts(pair);
        let target = self.path(next(&mut parts));
        if rule == Rule::set {
            return Action::Set { target, value: self.expression(next(&mut parts)), span };
        }
        let kinds = parts.map(|kind| {
            let mut parts = kind.into_inner();
            (self.word(&next(&mut parts)), parts.next().map(|operand| self.expression(operand)))
        });
        Action::Fault { target, kinds: kinds.collect(), span }
    }

    fn axis(&mut self, pair: Pair<'_, Rule>) -> Axis {
        let mut parts = pair.into_inner();
        let name = self.word(&next(&mut parts));
        let drawn = next(&mut parts).as_rule() == Rule::draw;
        Axis { name, drawn, values: self.expression(next(&mut parts)) }
    }

    /// The operand of a clause, which stands behind its keyword: of `every`, `held`, `lasting`, or `within` behind `± d`.
    pub(super) fn clause(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let Some(operand) = pair.into_inner().last() else { unreachable!("a clause has an operand") };
        self.expression(operand)
    }

    /// A declared name.
    fn name(&mut self, pair: Pair<'_, Rule>) -> Name {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let word = self.word(&next(&mut parts));
        let index = parts.next().map(|index| self.indices(index)).unwrap_or_default();
        Name { word, index, span }
    }

    fn indices(&mut self, pair: Pair<'_, Rule>) -> Vec<Expression> {
        let (stars, index): (Vec<_>, Vec<_>) = pair.into_inner().partition(|part| part.as_rule() == Rule::star);
        for star in stars {
            let message = "`*` is a whole index, as in `record a[*]`, and declares no name";
            self.diagnostics.push(Diagnostic::error("E22", self.span(&star), message).help("write a number"));
        }
        index.into_iter().map(|part| self.expression(part)).collect()
    }

    /// A path, key or glob.
    pub fn path(&mut self, pair: Pair<'_, Rule>) -> Path {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let root = self.word(&next(&mut parts));
        Path { root, tail: parts.map(|part| self.segment(part)).collect(), span }
    }

    fn segment(&mut self, pair: Pair<'_, Rule>) -> Segment {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::field => Segment::Field(self.word(&pair)),
            Rule::group => Segment::Members(pair.into_inner().map(|field| self.word(&field)).collect(), span),
            Rule::star => Segment::All(span),
            _ if pair.clone().into_inner().all(|part| part.as_rule() == Rule::star) => Segment::AllIndices(span),
            _ => Segment::Index(self.indices(pair), span),
        }
    }
}

/// A text without its escapes.
fn unescaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        plain.push(match letter {
            '\\' => match letters.next() {
                Some('n') => '\n',
                Some('t') => '\t',
                Some(escaped) => escaped,
                None => '\\',
            },
            letter => letter,
        });
    }
    plain
}

fn only_part(pair: Pair<'_, Rule>) -> Pair<'_, Rule> {
    next(&mut parts(pair))
}
