//! From the grammar's pairs to expressions.

use pest::iterators::Pair;

use super::grammar::Rule;
use super::tree::{Walk, next, parts};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::{Comparator, ComparisonLink, Expression, ExpressionKind, Operator, TemporalWord, TimeSpan, Word};

fn bare(kind: ExpressionKind, span: Span) -> Expression {
    Expression { kind, span, parenthesised: false }
}

impl Walk<'_> {
    /// The expression of a pair of any rule from `expr` down to `atom`.
    pub(super) fn expression(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::expr => self.two(pair, ExpressionKind::Implies),
            Rule::or_ => self.several(pair, ExpressionKind::Or),
            Rule::and_ => self.several(pair, ExpressionKind::And),
            Rule::range => self.two(pair, ExpressionKind::Range),
            Rule::until => self.until(pair),
            Rule::not_ => self.not(pair),
            Rule::temporal => self.temporal(pair),
            Rule::compare => self.comparison(pair),
            Rule::sum | Rule::term => self.arithmetic(pair),
            Rule::unary => self.unary(pair),
            Rule::paren => {
                let inside = self.expression(next(&mut pair.into_inner()));
                Expression { kind: inside.kind, span, parenthesised: true }
            }
            Rule::quantity => self.quantity(pair),
            Rule::list => self.list(pair),
            Rule::call => {
                let mut parts = pair.into_inner();
                let function = self.word(&next(&mut parts));
                let arguments = parts.map(|argument| self.expression(argument)).collect();
                bare(ExpressionKind::Call { function, arguments }, span)
            }
            Rule::string => bare(ExpressionKind::Text(self.word(&pair).text), span),
            Rule::bool => bare(ExpressionKind::Boolean(pair.as_str() == "true"), span),
            Rule::path => bare(ExpressionKind::Path(self.path(pair)), span),
            other => unreachable!("scenario.pest lists no expression {other:?}"),
        }
    }

    /// One operand as it is, or two joined by a binary operator.
    fn two(
        &mut self,
        pair: Pair<'_, Rule>,
        join: impl FnOnce(Box<Expression>, Box<Expression>) -> ExpressionKind,
    ) -> Expression {
        let mut parts = parts(pair);
        let left = self.expression(next(&mut parts));
        let Some(right) = parts.next() else { return left };
        let right = self.expression(right);
        let span = left.span.to(right.span);
        bare(join(Box::new(left), Box::new(right)), span)
    }

    /// One operand as it is, or all of a chain.
    fn several(&mut self, pair: Pair<'_, Rule>, join: impl FnOnce(Vec<Expression>) -> ExpressionKind) -> Expression {
        let span = self.span(&pair);
        let mut parts = parts(pair);
        let first = self.expression(next(&mut parts));
        let mut operands = vec![first];
        operands.extend(parts.map(|operand| self.expression(operand)));
        match operands.pop() {
            Some(single) if operands.is_empty() => single,
            Some(last) => {
                operands.push(last);
                bare(join(operands), span)
            }
            None => unreachable!("a chain has a first operand"),
        }
    }

    fn until(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let whole = self.span(&pair);
        let mut parts = parts(pair).peekable();
        let left = self.expression(next(&mut parts));
        if parts.peek().is_none() {
            return left;
        }
        let span = parts.next_if(|part| part.as_rule() == Rule::span).map(|span| self.time_span(span));
        let right = self.expression(next(&mut parts));
        bare(ExpressionKind::Until { left: Box::new(left), span, right: Box::new(right) }, whole)
    }

    fn not(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let span = self.span(&pair);
        let operand = next(&mut parts(pair));
        let negated = operand.as_rule() == Rule::not_;
        let operand = self.expression(operand);
        if negated { bare(ExpressionKind::Not(Box::new(operand)), span) } else { operand }
    }

    fn temporal(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let whole = self.span(&pair);
        let mut parts = parts(pair).peekable();
        let first = next(&mut parts);
        let word_span = self.span(&first);
        let (word, span) = match first.as_rule() {
            Rule::HOLD => {
                let to = Box::new(self.expression(next(&mut parts)));
                (TemporalWord::Hold, Some(TimeSpan::Within { from: None, to }))
            }
            rule => {
                let word = match rule {
                    Rule::ALWAYS => TemporalWord::Always,
                    Rule::FINALLY => TemporalWord::Finally,
                    _ => TemporalWord::Eventually,
                };
                (word, parts.next_if(|part| part.as_rule() == Rule::span).map(|span| self.time_span(span)))
            }
        };
        let body = Box::new(self.expression(next(&mut parts)));
        bare(ExpressionKind::Temporal { word, word_span, span, body }, whole)
    }

    fn time_span(&mut self, pair: Pair<'_, Rule>) -> TimeSpan {
        let mut parts = pair.into_inner();
        let keyword = next(&mut parts).as_rule();
        let first = Box::new(self.expression(next(&mut parts)));
        match (keyword, parts.next()) {
            (Rule::AFTER, _) => TimeSpan::After(first),
            (_, None) => TimeSpan::Within { from: None, to: first },
            (_, Some(to)) => TimeSpan::Within { from: Some(first), to: Box::new(self.expression(to)) },
        }
    }

    fn comparison(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let span = self.span(&pair);
        let mut parts = pair.into_inner().peekable();
        let first = self.expression(next(&mut parts));
        let mut rest = Vec::new();
        while let Some(operator) = parts.next() {
            let operand = self.expression(next(&mut parts));
            let tolerance =
                parts.next_if(|part| part.as_rule() == Rule::tol).map(|_| self.expression(next(&mut parts)));
            let tolerance_time = parts.next_if(|part| part.as_rule() == Rule::tol_time);
            let tolerance_time = tolerance_time.map(|part| self.clause(part));
            let (operator, operator_span) = (comparator(operator.as_str()), self.span(&operator));
            rest.push(ComparisonLink { operator, operator_span, operand, tolerance, tolerance_time });
        }
        if rest.is_empty() {
            return first;
        }
        bare(ExpressionKind::Comparison { first: Box::new(first), rest }, span)
    }

    fn arithmetic(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let mut parts = pair.into_inner();
        let mut left = self.expression(next(&mut parts));
        while let Some(operator) = parts.next() {
            let operator = match operator.as_str() {
                "+" => Operator::Add,
                "-" => Operator::Subtract,
                "*" => Operator::Multiply,
                _ => Operator::Divide,
            };
            let right = self.expression(next(&mut parts));
            let span = left.span.to(right.span);
            left = bare(ExpressionKind::Arithmetic(operator, Box::new(left), Box::new(right)), span);
        }
        left
    }

    fn unary(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let first = next(&mut parts);
        if first.as_rule() == Rule::neg {
            let operand = self.expression(next(&mut parts));
            return bare(ExpressionKind::Negate(Box::new(operand)), span);
        }
        let operand = self.expression(first);
        let Some(word) = parts.next() else { return operand };
        let unit = self.word(&next(&mut parts));
        let operand = Box::new(operand);
        let kind = match word.as_rule() {
            Rule::IN => ExpressionKind::In(operand, unit),
            _ => ExpressionKind::As(operand, unit),
        };
        bare(kind, span)
    }

    fn quantity(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let written = next(&mut parts);
        let number = match written.as_str().parse::<f64>() {
            Ok(number) => number,
            Err(error) => unreachable!("scenario.pest lets no number `{}` through: {error}", written.as_str()),
        };
        if number.is_infinite() {
            let error = Diagnostic::error("E00", self.span(&written), "this number is too large");
            self.diagnostics.push(error.help("the largest is about 1.8e308"));
        }
        bare(ExpressionKind::Quantity { number, unit: self.unit(parts.next()) }, span)
    }

    fn list(&mut self, pair: Pair<'_, Rule>) -> Expression {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let (mut elements, mut copies) = (Vec::new(), None);
        for part in next(&mut parts).into_inner() {
            match part.as_rule() {
                Rule::copies => copies = Some(Box::new(self.expression(next(&mut part.into_inner())))),
                _ => elements.push(self.expression(part)),
            }
        }
        bare(ExpressionKind::List { elements, copies, unit: self.unit(parts.next()) }, span)
    }

    fn unit(&self, pair: Option<Pair<'_, Rule>>) -> Option<Word> {
        pair.map(|pair| self.word(&pair))
    }
}

fn comparator(written: &str) -> Comparator {
    match written {
        "<" => Comparator::Less,
        "<=" => Comparator::LessEqual,
        ">" => Comparator::Greater,
        ">=" => Comparator::GreaterEqual,
        "==" => Comparator::Equal,
        _ => Comparator::NotEqual,
    }
}
