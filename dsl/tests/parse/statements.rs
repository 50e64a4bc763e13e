//! Each statement and operator as a tree.

use dsl::source::Sources;
use dsl::syntax::{
    Action, Arrow, Comparator, Expression, ExpressionKind, Operator, Segment, StatementKind, TemporalWord, TimeSpan,
};

use super::{messages, only};

/// The value of a `let`.
fn value(written: &str) -> Expression {
    match only(&format!("let a = {written}")) {
        StatementKind::Let(binding) => binding.value,
        other => panic!("no let: {other:?}"),
    }
}

/// A quantity's number and unit.
fn quantity(expression: &Expression) -> (f64, Option<&str>) {
    match &expression.kind {
        ExpressionKind::Quantity { number, unit } => (*number, unit.as_ref().map(|unit| unit.text.as_str())),
        other => panic!("no quantity: {other:?}"),
    }
}

/// An expression with a pair of parentheses around each operation.
fn shape(expression: &Expression) -> String {
    let all = |parts: &[Expression], sign: &str| parts.iter().map(shape).collect::<Vec<_>>().join(sign);
    match &expression.kind {
        ExpressionKind::Quantity { number, unit } => {
            unit.as_ref().map_or(number.to_string(), |unit| format!("{number}_{}", unit.text))
        }
        ExpressionKind::Text(text) => format!("{text:?}"),
        ExpressionKind::Boolean(value) => value.to_string(),
        ExpressionKind::Path(path) => path.root.text.clone(),
        ExpressionKind::List { elements, unit, .. } => {
            format!("[{}]{}", all(elements, " "), unit.as_ref().map_or("", |unit| &unit.text))
        }
        ExpressionKind::Call { function, arguments } => format!("{}({})", function.text, all(arguments, " ")),
        ExpressionKind::Negate(of) => format!("(-{})", shape(of)),
        ExpressionKind::In(of, unit) => format!("({} in {})", shape(of), unit.text),
        ExpressionKind::As(of, unit) => format!("({} as {})", shape(of), unit.text),
        ExpressionKind::Arithmetic(operator, left, right) => {
            let sign = match operator {
                Operator::Add => '+',
                Operator::Subtract => '-',
                Operator::Multiply => '*',
                Operator::Divide => '/',
            };
            format!("({} {sign} {})", shape(left), shape(right))
        }
        ExpressionKind::Range(left, right) => format!("({}..{})", shape(left), shape(right)),
        ExpressionKind::Comparison { first, rest } => {
            let links = rest.iter().map(|link| {
                let tolerance = link.tolerance.as_ref().map_or(String::new(), |d| format!(" ± {}", shape(d)));
                format!(" {:?} {}{tolerance}", link.operator, shape(&link.operand))
            });
            format!("({}{})", shape(first), links.collect::<String>())
        }
        ExpressionKind::Not(of) => format!("(not {})", shape(of)),
        ExpressionKind::And(parts) => format!("({})", all(parts, " and ")),
        ExpressionKind::Or(parts) => format!("({})", all(parts, " or ")),
        ExpressionKind::Until { left, span, right } => {
            format!("({} until{} {})", shape(left), window(span.as_ref()), shape(right))
        }
        ExpressionKind::Implies(left, right) => format!("({} implies {})", shape(left), shape(right)),
        ExpressionKind::Temporal { word, span, body, .. } => {
            let word = match word {
                TemporalWord::Always => "always",
                TemporalWord::Eventually => "eventually",
                TemporalWord::Finally => "finally",
                TemporalWord::Hold => "hold",
            };
            format!("({word}{} {})", window(span.as_ref()), shape(body))
        }
    }
}

fn window(span: Option<&TimeSpan>) -> String {
    match span {
        None => String::new(),
        Some(TimeSpan::After(from)) => format!(" after {}", shape(from)),
        Some(TimeSpan::Within { from: None, to }) => format!(" within {}", shape(to)),
        Some(TimeSpan::Within { from: Some(from), to }) => format!(" within {}..{}", shape(from), shape(to)),
    }
}

#[test]
fn operators_bind_in_the_order_of_the_grammar() {
    let shapes = [
        ("a + b * c - d / e", "((a + (b * c)) - (d / e))"),
        ("-a * b", "((-a) * b)"),
        ("-5 m - -3 m", "(-5_m - -3_m)"),
        ("a in deg + b as V", "((a in deg) + (b as V))"),
        ("2 m/s * k", "(2_m/s * k)"),
        ("a..b + 1", "(a..(b + 1))"),
        ("0 m < x <= 5 m", "(0_m Less x LessEqual 5_m)"),
        ("x == 3 m ± 1 cm and y != 2", "((x Equal 3_m ± 1_cm) and (y NotEqual 2))"),
        ("x == 3 m +- 1 cm", "(x Equal 3_m ± 1_cm)"),
        ("not a and b or c", "(((not a) and b) or c)"),
        ("a or b until c implies d implies e", "(((a or b) until c) implies (d implies e))"),
        ("a until within 3 s b", "(a until within 3_s b)"),
        ("always a and eventually within 2..5 s b", "(always (a and (eventually within 2..5_s b)))"),
        ("(always a) and b", "((always a) and b)"),
        ("always after 2 s a", "(always after 2_s a)"),
        ("eventually within 85 s hold for 2 s a", "(eventually within 85_s (hold within 2_s a))"),
        ("eventually within (a + b) c", "(eventually within (a + b) c)"),
        ("max(a, b, ) + f()", "(max(a b) + f())"),
        ("[[1, 2], []] m", "[[1 2] []]m"),
        ("file(\"a.csv\")", "file(\"a.csv\")"),
        ("true and trueish", "(true and trueish)"),
    ];
    for (written, shown) in shapes {
        assert_eq!(shape(&value(written)), shown, "{written}");
    }
}

#[test]
fn quantities_keep_number_and_unit_as_written() {
    let quantities = [
        ("9.81 m/s^2", (9.81, Some("m/s^2"))),
        ("-5 °C", (-5.0, Some("°C"))),
        ("20 %", (20.0, Some("%"))),
        ("1e-3 kg*m²", (1e-3, Some("kg*m²"))),
        ("5 'N.m'", (5.0, Some("N.m"))),
        ("3 'in'", (3.0, Some("in"))),
        ("2E3", (2000.0, None)),
        ("5ms", (5.0, Some("ms"))),
    ];
    for (written, expected) in quantities {
        assert_eq!(quantity(&value(written)), expected, "{written}");
    }
}

#[test]
fn paths_pick_fields_members_and_elements() {
    let ExpressionKind::Path(path) = value("wing[1].body.'der(x)'.{x, y}[2, i].step").kind else { panic!("no path") };
    assert_eq!(path.root.text, "wing");
    let shown = path.tail.iter().map(|segment| match segment {
        Segment::Field(word) => word.text.clone(),
        Segment::Members(words, _) => words.iter().map(|word| word.text.as_str()).collect::<Vec<_>>().join("|"),
        Segment::Index(index, _) => format!("{} indices", index.len()),
        Segment::AllIndices(_) => "[*]".to_owned(),
        Segment::All(_) => ".*".to_owned(),
    });
    assert_eq!(shown.collect::<Vec<_>>(), ["1 indices", "body", "der(x)", "x|y", "2 indices", "step"]);
}

#[test]
fn the_frame_of_a_run_is_three_lines() {
    let StatementKind::Scenario(title) = only("scenario \"It's 'windy'\"") else { panic!("no scenario") };
    assert_eq!(title.text, "It's 'windy'");
    let StatementKind::Step(step) = only("step 5 ms") else { panic!("no step") };
    assert_eq!(quantity(&step), (5.0, Some("ms")));
    let StatementKind::Stop(stop) = only("stop 2 * 30 s") else { panic!("no stop") };
    assert_eq!(shape(&stop), "(2 * 30_s)");
    let StatementKind::StopWhen { condition, held } = only("stop when a and b held 2 s") else {
        panic!("no stop when")
    };
    assert_eq!((shape(&condition).as_str(), held.map(|held| shape(&held))), ("(a and b)", Some("2_s".to_owned())));
}

#[test]
fn fmu_and_use_carry_their_clauses() {
    let script = "fmu a[1] = \"quadcopter\" on edge[2] every 5 ms { mass = 1 kg, m[1, 2] = 3\n drag.x = 0.1 }";
    let StatementKind::Fmu(unit) = only(script) else { panic!("no fmu") };
    assert_eq!((unit.name.word.text.as_str(), unit.name.index.len()), ("a", 1));
    assert_eq!((unit.unit.text.as_str(), unit.on.len(), unit.every.len()), ("quadcopter", 1, 1));
    let keys: Vec<_> = unit.values.iter().map(|value| (value.key.root.text.as_str(), value.key.tail.len())).collect();
    assert_eq!(keys, [("mass", 0), ("m", 1), ("drag", 1)]);
    let StatementKind::Use(part) = only("use lead = \"uav.scn\" on far { }") else { panic!("no use") };
    assert_eq!((part.unit.text.as_str(), part.on.len(), part.values.len()), ("uav.scn", 1, 0));
}

#[test]
fn connections_keep_arrow_and_targets() {
    for (sign, expected) in [("->", Arrow::Held), ("=>", Arrow::Direct)] {
        let kind = only(&format!("a.x + 1 m {sign} b.u, c.v"));
        let StatementKind::Wire { source, arrow, targets, .. } = kind else { panic!("no connection") };
        assert_eq!((shape(&source).as_str(), arrow, targets.len()), ("(a + 1_m)", expected, 2));
    }
}

#[test]
fn windows_hold_actions() {
    let StatementKind::At(at) = only("at 30 s lasting 8 s { set a.b = 3 m,\n fault c.d: noise 1 m, freeze\n}") else {
        panic!("no at")
    };
    assert_eq!((at.held, at.lasting.is_some(), at.actions.len()), (None, true, 2));
    let Action::Fault { kinds, .. } = &at.actions[1] else { panic!("no fault") };
    let kinds: Vec<_> = kinds.iter().map(|(kind, operand)| (kind.text.as_str(), operand.is_some())).collect();
    assert_eq!(kinds, [("noise", true), ("freeze", false)]);
    let StatementKind::When(when) = only("when a > 3 held 2 s lasting 1 s { set b = 1 }") else { panic!("no when") };
    assert!(when.held.is_some() && when.lasting.is_some());
    let StatementKind::While(window) = only("while a < 3 { fault b: freeze, fault c: loss 5 %, }") else {
        panic!("no while")
    };
    assert_eq!(window.actions.len(), 2);
}

#[test]
fn for_record_and_sweep_hold_lists() {
    let StatementKind::For { variable, body, .. } =
        only("for i in 1..3 {\n let a = i\n for j in [1, 2] { a.b -> c.d }\n}")
    else {
        panic!("no for")
    };
    assert_eq!((variable.text.as_str(), body.len()), ("i", 2));
    let StatementKind::Record { signals, every } = only("record a.b, c.*,\n d[*].e every 20 ms") else {
        panic!("no record")
    };
    assert!(every.is_some());
    let ends = signals.iter().map(|path| matches!(path.tail.last(), Some(Segment::All(_))));
    assert_eq!(ends.collect::<Vec<_>>(), [false, true, false]);
    assert!(matches!(signals[2].tail[0], Segment::AllIndices(_)));
    let StatementKind::Sweep(axes) = only("sweep {\n  a in [1, 2] m\n  b ~ normal(0 m, 1 m), c in 1..3\n}") else {
        panic!("no sweep")
    };
    let axes: Vec<_> = axes.iter().map(|axis| (axis.name.text.as_str(), axis.drawn)).collect();
    assert_eq!(axes, [("a", false), ("b", true), ("c", false)]);
}

#[test]
fn every_comparison_has_its_own_operator() {
    let signs = [
        ("<", Comparator::Less),
        ("<=", Comparator::LessEqual),
        (">", Comparator::Greater),
        (">=", Comparator::GreaterEqual),
        ("==", Comparator::Equal),
        ("!=", Comparator::NotEqual),
    ];
    for (sign, expected) in signs {
        let ExpressionKind::Comparison { rest, .. } = value(&format!("a {sign} b")).kind else { panic!("{sign}") };
        assert_eq!(rest[0].operator, expected);
    }
}

#[test]
fn assignments_of_the_command_line_are_bindings() {
    let mut sources = Sources::default();
    let good = sources.add("--set", "gust = 6 m/s");
    let bad = sources.add("--set", "gust 6 m/s");
    let binding = dsl::parse::parse_assignment(&sources, good);
    assert_eq!(binding.map(|binding| (binding.name.text, shape(&binding.value))), Ok(("gust".into(), "6_m/s".into())));
    let errors = dsl::parse::parse_assignment(&sources, bad).err().unwrap_or_default();
    insta::assert_snapshot!(dsl::diagnostic::render(&sources, &errors, false));
}

#[test]
fn grammar_refuses_what_the_reference_does() {
    for script in ["a..b..c -> d", "let a = b in deg in rad", "at 3 s lasting 2 s", "let a = 5 m s", "let true = 3"] {
        assert_eq!(messages(script).len(), 1, "{script}");
    }
}

#[test]
fn a_text_holds_quotes_backslashes_and_line_breaks_by_escapes() {
    let text = |script: &str| match only(script) {
        StatementKind::Let(binding) => match binding.value.kind {
            ExpressionKind::Text(text) => text,
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    };
    assert_eq!(text(r#"let a = "say \"hi\" # -> \\ {"  # a comment"#), r#"say "hi" # -> \ {"#);
    assert_eq!(text(r#"let a = "one\ntwo\tthree""#), "one\ntwo\tthree");
    assert_eq!(text(r#"let a = "\\""#), "\\");
    assert_eq!(text(r#"let a = "\\n""#), "\\n");
}
