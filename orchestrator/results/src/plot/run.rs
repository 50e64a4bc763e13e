//! What a picture shows of a run: its table, and what its folder says of claims and windows.

use crate::comparison::Comparison;
use crate::run_folder::{EVENTS_CSV, PARTIAL, VERDICT_JSON};
use crate::run_record::Parameter;
use crate::table::{Table, TableError};
use fmi2::printable;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A run as pictures need it.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// The name of its folder or file.
    pub name: String,
    /// The title of its scenario; empty where it is a table alone.
    pub title: String,
    /// The parameters that the command line set, as it says them.
    pub set: Vec<String>,
    /// Why it ended; empty where that is not known.
    pub end: String,
    /// What was recorded.
    pub table: Table,
    pub(super) claims: Vec<Claim>,
    pub(super) windows: Vec<Window>,
}

/// What `verdict.json` says of a claim.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub(super) struct Claim {
    pub name: String,
    pub verdict: String,
    pub at_s: Option<f64>,
    pub first_s: Option<f64>,
    pub part: Option<usize>,
    pub signals: Vec<String>,
    pub comparisons: Vec<Comparison>,
}

/// A window of the script, open from one time to another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Window {
    pub from_s: f64,
    pub to_s: Option<f64>,
    pub text: String,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Verdict {
    scenario: String,
    end: String,
    parameters: Vec<Parameter>,
    claims: Vec<Claim>,
    events: Vec<Change>,
}

/// A window that opened or closed.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct Change {
    time_s: f64,
    change: String,
    statement: String,
    condition: String,
    trigger: String,
    does: Vec<String>,
}

impl Run {
    /// Reads a run's folder, or a table over time alone. What the folder lacks, or another version wrote otherwise, is not
    /// drawn.
    ///
    /// # Errors
    /// There is no table, or it cannot be read.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let table = Table::read(path)?;
        let name = printable::line(&path.file_name().unwrap_or(path.as_os_str()).to_string_lossy());
        let text = path.is_dir().then(|| fs::read_to_string(path.join(VERDICT_JSON)).ok()).flatten();
        let verdict: Verdict = text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        let changes = if verdict.events.is_empty() { changes(path) } else { verdict.events };
        Ok(Self {
            name,
            title: printable::line(&verdict.scenario),
            set: verdict
                .parameters
                .iter()
                .filter(|it| it.set)
                .map(|it| format!("{} = {}", it.name, it.value))
                .collect(),
            end: printable::line(&verdict.end),
            table,
            claims: verdict.claims,
            windows: windows(&changes),
        })
    }

    /// Whether a column, a group or a claim has this name, or each of several with commas between them.
    #[must_use]
    pub fn has(&self, names: &str) -> bool {
        names
            .split(',')
            .all(|name| !self.members(name).is_empty() || self.claims.iter().any(|claim| claim.name == name))
    }

    /// All names that can be drawn: columns, then claims.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let claims = self.claims.iter().map(|claim| claim.name.as_str());
        self.table.names().chain(claims).map(str::to_owned).collect()
    }

    /// The groups that columns stand in, each once.
    #[must_use]
    pub fn groups(&self) -> Vec<String> {
        let ends =
            |name: &str| name.match_indices(['.', '[']).map(|(end, _)| name[..end].to_owned()).collect::<Vec<_>>();
        let groups: BTreeSet<_> = self.table.names().flat_map(ends).collect();
        groups.into_iter().collect()
    }

    /// Keeps the rows between two times, both included; returns whether any are left.
    pub(super) fn keep(&mut self, from_s: Option<f64>, to_s: Option<f64>) -> bool {
        let is_kept = |time: &f64| from_s.is_none_or(|from| *time >= from) && to_s.is_none_or(|to| *time <= to);
        let kept: Vec<_> = self.table.time_s().iter().map(is_kept).collect();
        for column in &mut self.table.columns {
            let mut rows = kept.iter();
            column.values.retain(|_| rows.next().copied().unwrap_or(false));
        }
        kept.contains(&true)
    }
}

/// The rows of `events.csv`, whole or partial.
fn changes(folder: &Path) -> Vec<Change> {
    let whole = fs::read_to_string(folder.join(EVENTS_CSV));
    let Ok(text) = whole.or_else(|_| fs::read_to_string(folder.join(format!("{EVENTS_CSV}{PARTIAL}")))) else {
        return Vec::new();
    };
    let row = |line: &str| {
        let mut cells = line.splitn(5, ',').skip(1);
        let time_s = cells.next()?.parse().ok()?;
        let [change, statement, condition] =
            [cells.next()?, cells.next()?, cells.next()?].map(|cell| cell.trim_matches('"').replace("\"\"", "\""));
        Some(Change { time_s, change, statement, condition, ..Change::default() })
    };
    text.lines().skip(1).filter_map(row).collect()
}

/// Pairs of opened and closed, in the order in which they opened.
fn windows(changes: &[Change]) -> Vec<Window> {
    let mut windows = Vec::new();
    for (index, opened) in changes.iter().enumerate().filter(|(_, change)| change.change == "opened") {
        let is_same =
            |change: &&Change| (&change.statement, &change.condition) == (&opened.statement, &opened.condition);
        let next = changes[index + 1..].iter().find(is_same);
        let to_s = next.map(|change| change.time_s);
        let head = format!("{} {}", opened.trigger, opened.condition);
        let place = if opened.trigger.is_empty() { format!(" ({})", opened.statement) } else { String::new() };
        let does = if opened.does.is_empty() { String::new() } else { format!(": {}", opened.does.join(", ")) };
        let text = printable::line(&format!("{}{place}{does}", head.trim()));
        windows.push(Window { from_s: opened.time_s, to_s, text });
    }
    windows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_tells_claims_and_windows_besides_its_table() {
        let home = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(home.path().join(name), text).unwrap();
        write("trace.csv", "time,a.x\n0,1\n1,2\n2,3\n");
        let events = "tick,time,change,statement,condition\n1,1,opened,a.scn:7,\"max(a.x, 3 m) > 2 m\"\n";
        write("events.csv.partial", &format!("{events}2,2,closed,a.scn:7,\"max(a.x, 3 m) > 2 m\"\n"));
        let run = Run::read(home.path()).unwrap();
        let text = "max(a.x, 3 m) > 2 m (a.scn:7)".to_owned();
        assert_eq!(run.windows, [Window { from_s: 1.0, to_s: Some(2.0), text }]);
        assert!(run.claims.is_empty() && run.title.is_empty());
        let verdict = r#"{"scenario": "A ramp", "end": "stop time", "claims": [{"name": "low", "verdict": "ok",
            "margin": null, "signals": ["a.x"], "comparisons": [{"part": 0, "quantity": {"column": "a.x"}, "unit": null,
            "low": null, "high": 5.0, "from_s": 0.0, "to_s": null}]}],
            "events": [{"time_s": 1.0, "change": "opened", "statement": "a.scn:7", "condition": "1 s", "trigger": "at",
            "does": ["set", "bias"]}]}"#;
        write("verdict.json", verdict);
        let mut run = Run::read(home.path()).unwrap();
        assert_eq!((run.title.as_str(), run.claims[0].comparisons[0].high), ("A ramp", Some(5.0)));
        assert_eq!(run.windows, [Window { from_s: 1.0, to_s: None, text: "at 1 s: set, bias".to_owned() }]);
        assert!(run.keep(Some(0.5), Some(1.5)));
        assert_eq!(run.table.time_s(), [1.0]);
        assert!(!run.keep(Some(7.0), None));
    }
}
