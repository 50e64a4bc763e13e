//! The resolver's calls of its loader.

use std::sync::{Arc, Mutex};

use fmi2::description::ModelDescription;

use super::fixtures::{Memory, flight};
use dsl::loader::{Loader, Problem, Table};
use dsl::parse::parse;
use dsl::parts::Parts;
use dsl::resolve::{Request, resolve};
use dsl::source::{Source, Sources};

/// Loads from memory and records each call.
#[derive(Default)]
struct Noting(Mutex<Vec<String>>);

impl Noting {
    fn note(&self, what: &str, from: &Source, name: &str) {
        self.0.lock().expect("no test panics here").push(format!("{what} {name} for {}", from.name));
    }
}

impl Loader for Noting {
    fn unit(&self, from: &Source, name: &str) -> Result<Arc<ModelDescription>, Problem> {
        self.note("unit", from, name);
        Memory.unit(from, name)
    }

    fn text(&self, from: &Source, path: &str) -> Result<Source, Problem> {
        self.note("text", from, path);
        Memory.text(from, path)
    }

    fn file(&self, from: &Source, path: &str) -> Result<(), Problem> {
        self.note("file", from, path);
        Memory.file(from, path)
    }

    fn table(&self, from: &Source, path: &str) -> Result<Table, Problem> {
        self.note("table", from, path);
        Memory.table(from, path)
    }
}

fn calls(script: &str) -> Vec<String> {
    let mut sources = Sources::default();
    let text = sources.add("scenarios/test.scn", script);
    let parsed = parse(&sources, text);
    let loader = Noting::default();
    let resolved = resolve(&Request {
        sources: &sources,
        file: &parsed.file,
        parts: &Parts::default(),
        loader: &loader,
        settings: &[],
        case: None,
        isolated: false,
    });
    assert!(!resolved.diagnostics.is_empty(), "nothing is connected");
    loader.0.into_inner().expect("no test panics here")
}

#[test]
fn a_unit_is_loaded_once_in_the_order_of_the_script() {
    let script = flight("fmu second = \"quadcopter\"\nfmu third = \"glider\"\nfmu fourth = \"glider\"");
    assert_eq!(
        calls(&script),
        ["wind", "quadcopter", "quadcopter_controller", "glider"]
            .map(|name| format!("unit {name} for scenarios/test.scn"))
    );
}

#[test]
fn a_table_is_loaded_once() {
    let script = flight("let u = curve(\"in.csv\", \"u\")\nlet v = curve(\"in.csv\", \"place\")");
    let calls = calls(&script);
    assert_eq!(calls.iter().filter(|call| call.starts_with("table in.csv")).count(), 1, "{calls:?}");
    let from = Source::new("test.scn", "");
    assert_eq!(Memory.text(&from, "part.scn").map(|part| part.name), Ok("part.scn".to_owned()));
    assert_eq!(Memory.table(&from, "in.csv").map(|table| table.columns.len()), Ok(6));
}
