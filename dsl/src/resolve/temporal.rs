//! Claims about windows of time.

use super::grid::Least;
use super::meaning::{Condition, Temporal};
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
        Some(Temporal { word, span: word_span, window: window?, body: Box::new(body_meaning?) })
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
            TemporalWord::Hold => "hold",
        };
        let head_span = Span { end: body.span.start, ..span };
        let (head, inside) = (self.text(head_span), self.text(body.span));
        let parts = match &body.kind {
            ExpressionKind::And(parts) | ExpressionKind::Or(parts) => parts.as_slice(),
            _ => &[],
        };
        let apart: Vec<_> = parts.iter().map(|part| format!("({head} {})", self.text(part.span))).collect();
        let apart = match apart.as_slice() {
            [first, ..] => {
                let rest =
                    parts[1..].iter().map(|part| self.text(part.span)).collect::<Vec<_>>().join(&format!(" {joint} "));
                format!(", or `{first} {joint} {rest}`")
            }
            [] => String::new(),
        };
        let message = format!("`{name}` reaches to the end of the line, over the `{joint}`");
        let error = Diagnostic::error("E12", span, message).label(body.span, "all of this");
        let together = [Edit::before(body.span, "("), Edit::after(body.span, ")")];
        let error = error.help(format!("write `{head} ({inside})`{apart}"));
        let error = error.fix(format!("write `{head} ({inside})`"), together);
        match parts.first() {
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
    /// The windows, from the outside in, that reach furthest ahead: their ticks and the keyword of each.
    pub fn reach(&self) -> Vec<(u64, &'static str)> {
        match self {
            Self::Plain(_) | Self::Bound(_) => Vec::new(),
            Self::Not(of) => of.reach(),
            Self::And(parts) | Self::Or(parts) => {
                parts.iter().map(Self::reach).max_by_key(|windows| total(windows)).unwrap_or_default()
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

/// The ticks of all windows together.
pub(super) fn total(windows: &[(u64, &str)]) -> u64 {
    windows.iter().fold(0, |sum, (ticks, _)| sum.saturating_add(*ticks))
}
