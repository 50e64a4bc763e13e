//! Claims about windows of time.

use super::condition::{Condition, Temporal, Until};
use super::grid::Least;
use super::scope::Scope;
use crate::diagnostic::{Diagnostic, Edit};
use crate::scenario::TickWindow;
use crate::source::Span;
use crate::syntax::{Expression, ExpressionKind, TemporalWord, TimeSpan};

impl Scope<'_, '_> {
    /// `always`, `eventually` and `hold for` with their window and body.
    pub fn temporal(
        &self,
        word: TemporalWord,
        word_span: Span,
        window: Option<&TimeSpan>,
        body: &Expression,
    ) -> Option<Temporal> {
        let body_meaning = self.condition(body);
        let window = match window {
            Some(window) => self.window(window),
            None => Some(TickWindow { from: 0, to: None }),
        };
        if let Some(joint) = loose_joint(body) {
            return self.refuse(self.wants_parentheses(word, word_span, body, joint));
        }
        let body_meaning = body_meaning?;
        if word == TemporalWord::Finally {
            if let Err(inner) = body_meaning.boolean() {
                let message = "`finally` asks for the last sample, where no window of time is left";
                let error = Diagnostic::error("E30", inner, message).label(word_span, "at the last sample");
                return self.refuse(error.help("a claim about the end without `finally`: `eventually always …`"));
            }
        } else {
            self.refuse_finally(&body_meaning)?;
        }
        let head = Span { end: body.span.start, ..word_span };
        Some(Temporal { word, span: word_span, head, window: window?, body: Box::new(body_meaning) })
    }

    /// `φ until g` with its window.
    pub fn until(&self, body: &Expression, window: Option<&TimeSpan>, gate: &Expression, span: Span) -> Option<Until> {
        let (gate_span, head) = (gate.span, Span { start: body.span.end, end: gate.span.start, ..span });
        let (body, gate) = (self.condition(body), self.condition(gate));
        let window = match window {
            Some(window) => self.window(window),
            None => Some(TickWindow { from: 0, to: None }),
        };
        let (body, gate) = (body?, gate?);
        self.refuse_finally(&body)?;
        Some(Until { span, head, gate_span, window: window?, body: Box::new(body), gate: Box::new(gate) })
    }

    /// Refuses `finally` in what is judged at several ticks, other than in a gate.
    fn refuse_finally(&self, body: &Condition) -> Option<()> {
        let Some(span) = body.ungated_finally() else { return Some(()) };
        let message = "`finally` stands at the top of a claim or in a gate";
        self.refuse(
            Diagnostic::error("E30", span, message).help("make an `assert` of its own: `assert end: finally …`"),
        )
    }

    fn window(&self, window: &TimeSpan) -> Option<TickWindow> {
        match window {
            TimeSpan::After(from) => Some(TickWindow { from: self.ticks(from, Least::Zero)?, to: None }),
            TimeSpan::Within { from: None, to } => Some(TickWindow { from: 0, to: Some(self.ticks(to, Least::Zero)?) }),
            TimeSpan::Within { from: Some(from), to } => {
                let (near, far) = (self.ticks(&in_unit_of(from, to), Least::Zero), self.ticks(to, Least::Zero));
                let (near, far) = (near?, far?);
                if near <= far {
                    return Some(TickWindow { from: near, to: Some(far) });
                }
                let span = from.span.to(to.span);
                let message = format!("the window `{}` ends before it begins", self.text(span));
                self.refuse(Diagnostic::error("E38", span, message).help("write the near end first"))
            }
        }
    }

    fn wants_parentheses(&self, word: TemporalWord, span: Span, body: &Expression, joint: &str) -> Diagnostic {
        let name = match word {
            TemporalWord::Always => "always",
            TemporalWord::Eventually => "eventually",
            TemporalWord::Finally => "finally",
            TemporalWord::Hold => "hold",
        };
        let head_span = Span { end: body.span.start, ..span };
        let (head, inside) = (self.text(head_span), self.text(body.span));
        let first = match &body.kind {
            ExpressionKind::And(parts) | ExpressionKind::Or(parts) => parts.first(),
            ExpressionKind::Implies(first, _) | ExpressionKind::Until { left: first, .. } => Some(&**first),
            _ => None,
        };
        let apart = first.map_or_else(String::new, |first| {
            let rest = Span { start: first.span.end, ..body.span };
            format!(", or `({head} {}) {}`", self.text(first.span), self.text(rest))
        });
        let message = format!("`{name}` reaches to the end of the line, over the `{joint}`");
        let error = Diagnostic::error("E12", span, message).label(body.span, "all of this");
        let together = [Edit::before(body.span, "("), Edit::after(body.span, ")")];
        let error = error.help(format!("write `{head} ({inside})`{apart}"));
        let error = error.fix(format!("write `{head} ({inside})`"), together);
        match first {
            Some(first) => {
                let whole = Span { end: first.span.end, ..span };
                error
                    .fix(format!("write `({})`", self.text(whole)), [Edit::before(whole, "("), Edit::after(whole, ")")])
            }
            None => error,
        }
    }
}

/// The operator at the top of a body without parentheses.
fn loose_joint(body: &Expression) -> Option<&'static str> {
    let joint = match body.kind {
        ExpressionKind::And(_) => "and",
        ExpressionKind::Or(_) => "or",
        ExpressionKind::Until { .. } => "until",
        ExpressionKind::Implies(..) => "implies",
        _ => return None,
    };
    (!body.parenthesised).then_some(joint)
}

/// In `2..5 s` the unit after the far end applies to both.
fn in_unit_of(near: &Expression, far: &Expression) -> Expression {
    let mut near = near.clone();
    if let (ExpressionKind::Quantity { unit: unit @ None, .. }, ExpressionKind::Quantity { unit: Some(name), .. }) =
        (&mut near.kind, &far.kind)
    {
        *unit = Some(name.clone());
    }
    near
}

impl Condition {
    /// The place of a `finally` that is in no gate.
    fn ungated_finally(&self) -> Option<Span> {
        match self {
            Self::Plain(..) | Self::Bound(_) => None,
            Self::Not(of) => of.ungated_finally(),
            Self::And(parts) | Self::Or(parts) => parts.iter().find_map(Self::ungated_finally),
            Self::Temporal(claim) if claim.word == TemporalWord::Finally => Some(claim.span),
            Self::Temporal(claim) => claim.body.ungated_finally(),
            Self::Implies { then, .. } => then.ungated_finally(),
            Self::Until(until) => until.body.ungated_finally(),
        }
    }

    /// The windows, from the outside in, that reach furthest ahead: their ticks and the keyword of each.
    pub fn reach(&self) -> Vec<(u64, &'static str)> {
        match self {
            Self::Plain(..) | Self::Bound(_) => Vec::new(),
            Self::Not(of) => of.reach(),
            Self::And(parts) | Self::Or(parts) => furthest(parts.iter().map(Self::reach)),
            Self::Implies { gate, then, .. } => furthest([gate.reach(), then.reach()]),
            Self::Until(Until { window, body, gate, .. }) => {
                let own = match *window {
                    TickWindow { to: Some(to), .. } => Some((to, "until")),
                    TickWindow { from: 0, to: None } => None,
                    TickWindow { from, to: None } => Some((from, "after")),
                };
                own.into_iter().chain(furthest([body.reach(), gate.reach()])).collect()
            }
            Self::Temporal(claim) => {
                let own = match (claim.window, claim.word) {
                    (TickWindow { to: Some(to), .. }, TemporalWord::Hold) => Some((to, "hold")),
                    (TickWindow { to: Some(to), .. }, _) => Some((to, "within")),
                    (TickWindow { from: 0, to: None }, _) => None,
                    (TickWindow { from, to: None }, _) => Some((from, "after")),
                };
                own.into_iter().chain(claim.body.reach()).collect()
            }
        }
    }
}

/// The windows that reach furthest.
fn furthest(all: impl IntoIterator<Item = Vec<(u64, &'static str)>>) -> Vec<(u64, &'static str)> {
    all.into_iter().max_by_key(|windows| total(windows)).unwrap_or_default()
}

/// The ticks of all windows together.
pub(super) fn total(windows: &[(u64, &str)]) -> u64 {
    windows.iter().fold(0, |sum, (ticks, _)| sum.saturating_add(*ticks))
}
