//! `curve("in.csv", "u")`: values over time out of a file.

use std::rc::Rc;
use std::sync::Arc;

use super::meaning::{Meaning, Measure, Real, Text};
use super::measure::unit_name;
use super::real;
use super::scale::Scale;
use super::scope::{Scope, SiCurve};
use crate::diagnostic::Diagnostic;
use crate::loader::{Table, TableColumn};
use crate::nearest::nearest;
use crate::scenario::{Curve, RealExpression};
use crate::source::Span;
use crate::syntax::Expression;

/// A table that was read, with the curve of each of its columns; `None` if it cannot be read, which was reported.
pub(super) type Loaded = Option<Rc<(Table, Vec<Arc<Curve>>)>>;

impl Scope<'_, '_> {
    /// A column by its name, or the columns of a group as a list.
    pub fn curve(&self, arguments: &[Expression], span: Span) -> Option<Meaning> {
        let [path, column] = arguments else {
            let message = format!("`curve` takes a file and a column, found {}", arguments.len());
            return self.refuse(Diagnostic::error("E31", span, message).help("for example `curve(\"in.csv\", \"u\")`"));
        };
        let (path_text, name) = (self.text_of(path), self.text_of(column));
        let (path_text, name) = (path_text?, name?);
        let loaded = self.table(&path_text, path.span)?;
        let (table, curves) = &*loaded;
        let all = || table.columns.iter().zip(curves);
        if let Some((found, curve)) = all().find(|(found, _)| found.name == name) {
            return self.column_meaning(found, curve, column.span).map(Meaning::Real);
        }
        let is_member =
            |found: &TableColumn| found.name.strip_prefix(&name).is_some_and(|rest| rest.starts_with(['.', '[']));
        let members: Vec<_> = all().filter(|(found, _)| is_member(found)).collect();
        if members.is_empty() {
            let message = format!("the file {path_text:?} has no column `{name}`");
            let names = || table.columns.iter().map(|found| found.name.as_str());
            let help = match nearest(&name, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("its columns are {}", names().collect::<Vec<_>>().join(", ")),
            };
            return self.refuse(Diagnostic::error("E01", column.span, message).help(help));
        }
        let meaning = |(found, curve): (&TableColumn, &Arc<Curve>)| {
            self.column_meaning(found, curve, column.span).map(|value| Rc::new(Meaning::Real(value)))
        };
        Some(Meaning::List(members.into_iter().map(meaning).collect::<Option<_>>()?))
    }

    /// A text that is written in the script.
    fn text_of(&self, expression: &Expression) -> Option<String> {
        match &*self.evaluate(expression)? {
            Meaning::Text(Text::Literal(text)) => Some(text.clone()),
            other => {
                let message = format!("`curve` takes file and column as texts, found {}", other.kind());
                let error = Diagnostic::error("E31", expression.span, message);
                self.refuse(error.help("for example `curve(\"in.csv\", \"u\")`"))
            }
        }
    }

    /// The table of a file, which is read once.
    fn table(&self, path: &str, span: Span) -> Loaded {
        let key = (span.text, path.to_owned());
        if let Some(known) = self.tables.borrow().get(&key) {
            return known.clone();
        }
        let loaded = match self.request.loader.table(self.request.sources.of(span), path) {
            Ok(table) => {
                let curve = |column: &TableColumn| {
                    let rows = table.time_s.iter().copied().zip(column.values.iter().copied()).collect();
                    Arc::new(Curve { rows, held: column.held })
                };
                let curves = table.columns.iter().map(curve).collect();
                Some(Rc::new((table, curves)))
            }
            Err(problem) => {
                let error = Diagnostic::error("E40", span, problem.message);
                self.report(Diagnostic { help: problem.help, ..error });
                None
            }
        };
        self.tables.borrow_mut().insert(key, loaded.clone());
        loaded
    }

    fn column_meaning(&self, column: &TableColumn, curve: &Arc<Curve>, span: Span) -> Option<Real> {
        let value = RealExpression::Curve(Arc::clone(curve));
        let Some(unit) = &column.unit else {
            return Some(Real::computed(value, Measure::Undeclared, None));
        };
        let base = self.unit_of_table(unit, span)?;
        let name = Some(unit_name(unit, base, true));
        Some(Real::computed(real::to_si(value, base), Measure::Known(base.dimension), name).on(Scale::of(base)))
    }

    /// A curve with its values in SI; each is converted once.
    pub fn si_curve(&self, value: &RealExpression) -> Option<Arc<Curve>> {
        let (of, factor, offset, divides) = match value {
            RealExpression::Curve(curve) => return Some(Arc::clone(curve)),
            RealExpression::Affine { of, factor, offset } => (of, *factor, *offset, false),
            RealExpression::InverseAffine { of, factor, offset } => (of, *factor, *offset, true),
            _ => return None,
        };
        let RealExpression::Curve(curve) = &**of else { return None };
        let (factor_bits, offset_bits) = (factor.to_bits(), offset.to_bits());
        let key = SiCurve { of: Arc::as_ptr(curve) as usize, factor_bits, offset_bits, divides };
        let si = |value: f64| if divides { (value - offset) / factor } else { factor * value + offset };
        let convert = || {
            let rows = curve.rows.iter().map(|(time_s, value)| (*time_s, si(*value))).collect();
            Arc::new(Curve { rows, held: curve.held })
        };
        Some(Arc::clone(self.si_curves.borrow_mut().entry(key).or_insert_with(convert)))
    }
}
