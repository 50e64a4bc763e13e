//! `verdict.json`: the verdicts on the claims, each with the margin by which the claim held or failed.

use crate::comparison::Comparison;
use crate::events::WindowChange;
use crate::run_record::{Case, Parameter};
use serde::Serialize;
use unit::time::seconds;

/// The verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[repr(u8)]
pub enum Verdict {
    /// The samples so far do not decide it.
    #[serde(rename = "unjudged")]
    Undecided = 0,
    /// It holds, whatever comes later.
    #[serde(rename = "ok")]
    Holds = 1,
    /// It fails, whatever comes later.
    #[serde(rename = "failed")]
    Fails = 2,
    /// The run ended before it was decided.
    #[serde(rename = "unjudged")]
    Unjudged = 3,
    /// It holds, but a gate of it never opened, or an `until` ended at once.
    #[serde(rename = "untested")]
    Untested = 4,
}

impl Verdict {
    /// The verdict with this number, or `None` if no verdict has it.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        let all = [Self::Undecided, Self::Holds, Self::Fails, Self::Unjudged, Self::Untested];
        all.into_iter().find(|&verdict| verdict as u8 == number)
    }

    /// Whether the claim holds or fails.
    #[must_use]
    pub fn is_decided(self) -> bool {
        matches!(self, Self::Holds | Self::Fails | Self::Untested)
    }
}

/// A claim's verdict with the margin over the samples so far.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// The verdict.
    pub verdict: Verdict,
    /// The margin in SI units; infinite for conditions, NaN as long as no sample counted.
    pub margin: f64,
    /// The tick of the sample that the margin comes from.
    pub worst_tick: u64,
    /// The tick of the first sample that fails.
    pub first_tick: u64,
    /// The index in [`ClaimInfo::parts`] of the part that the margin comes from; of an untested claim that in
    /// [`ClaimInfo::gates`] of what did not happen.
    pub part: u32,
}

impl Standing {
    /// A claim of which no sample is known.
    pub const UNKNOWN: Self =
        Self { verdict: Verdict::Undecided, margin: f64::NAN, worst_tick: 0, first_tick: 0, part: 0 };
}

impl PartialEq for Standing {
    fn eq(&self, other: &Self) -> bool {
        let key = |of: &Self| (of.verdict, of.margin.to_bits(), of.worst_tick, of.first_tick, of.part);
        key(self) == key(other)
    }
}

/// The properties of a claim that reports show besides its standing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClaimInfo {
    /// The name.
    pub name: String,
    /// The claim as written, on one line.
    pub text: String,
    /// The file of the `assert`, if that is a part.
    pub part_file: Option<String>,
    /// Line of the `assert` in its file, from 1.
    pub line: usize,
    /// The unit in which margins are shown; `None` where all margins are infinite.
    pub unit: Option<MarginUnit>,
    /// For a claim about one comparison with a constant: its limit.
    pub limit: Option<Limit>,
    /// Its comparisons and conditions.
    pub parts: Vec<ClaimPart>,
    /// For each gate the sentence that says that it never opened.
    pub gates: Vec<String>,
}

/// A comparison or condition of a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClaimPart {
    /// As written; empty where it has no text of its own.
    pub text: String,
    /// The temporal words around it with their windows, as written.
    pub window: String,
    /// The signals that it reads.
    pub signals: Vec<String>,
}

/// The unit of a margin: a difference, so without offset.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginUnit {
    /// The name as the script writes it; empty for plain numbers.
    pub name: String,
    /// SI value of one.
    pub factor: f64,
}

/// The constant side of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The constant, in [`MarginUnit`].
    pub value: f64,
    /// Whether values must stay below it; the value seen is `value - margin`, else `value + margin`.
    pub upper: bool,
}

/// The content of `verdict.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerdictFile {
    /// The title in the `scenario` line.
    pub scenario: String,
    /// The script's file name.
    pub script: String,
    /// The parameters with their values in this run.
    pub parameters: Vec<Parameter>,
    /// The case of the script's sweep, if one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<Case>,
    /// Simulated seconds reached.
    pub time_s: f64,
    /// Why the run ended.
    pub end: String,
    /// The claims in the script's order.
    pub claims: Vec<JudgedClaim>,
    /// The windows that opened and closed, in order; left out where the script has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<WindowChange>,
}

/// One claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedClaim {
    /// The name.
    pub name: String,
    /// The verdict on it.
    pub verdict: Verdict,
    /// The distance from failing, negative if it failed, in `unit`; `None` where the margin is not finite.
    pub margin: Option<f64>,
    /// The unit of `margin`, `limit` and `seen`; `None` for plain numbers.
    pub unit: Option<String>,
    /// The worst time in seconds.
    pub at_s: Option<f64>,
    /// Of a failed claim: the time of the first sample that fails.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_s: Option<f64>,
    /// The part of the claim that the margin comes from, an index as in [`Comparison::part`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<usize>,
    /// The claim as written.
    pub claim: String,
    /// The file that it is in, if that is a part of the script.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Its line in the file.
    pub line: usize,
    /// The constant that the claim compares with.
    pub limit: Option<f64>,
    /// What was seen at the worst time.
    pub seen: Option<f64>,
    /// Of a failed claim: which part failed, in which window, when first and when worst, by which signals.
    pub because: Option<String>,
    /// Of an untested claim: what did not happen.
    pub untested: Option<String>,
    /// The signals that it reads, in the order of its parts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub signals: Vec<String>,
    /// What it compares with which limits, as far as that is recorded.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub comparisons: Vec<Comparison>,
}

/// The number of claims with each verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Claims that hold.
    pub ok: usize,
    /// Claims that fail.
    pub failed: usize,
    /// Claims that could not be decided.
    pub unjudged: usize,
    /// Claims that hold and were not tested.
    pub untested: usize,
}

impl VerdictFile {
    /// The text of the file.
    #[must_use]
    pub fn json(&self) -> String {
        super::json_text(self)
    }

    /// The number of claims with each verdict.
    #[must_use]
    pub fn count(&self) -> Count {
        let mut count = Count::default();
        for claim in &self.claims {
            match claim.verdict {
                Verdict::Holds => count.ok += 1,
                Verdict::Fails => count.failed += 1,
                Verdict::Undecided | Verdict::Unjudged => count.unjudged += 1,
                Verdict::Untested => count.untested += 1,
            }
        }
        count
    }
}

impl JudgedClaim {
    /// The claim with its standing, in its own unit.
    #[must_use]
    pub fn new(claim: &ClaimInfo, standing: &Standing, step_ns: u64) -> Self {
        // A verdict that is known before its margin has no time either.
        let judged = standing.verdict.is_decided() && !standing.margin.is_nan();
        let part = usize::try_from(standing.part).unwrap_or(usize::MAX);
        let factor = claim.unit.as_ref().map_or(1.0, |unit| unit.factor);
        // Adding zero removes the sign of a negative zero; the verdict shows whether zero is enough.
        let margin = (judged && standing.margin.is_finite()).then_some(standing.margin / factor + 0.0);
        let limit = claim.limit.map(|limit| limit.value);
        let seen = claim.limit.zip(margin).map(
            |(limit, margin)| {
                if limit.upper { limit.value - margin } else { limit.value + margin }
            },
        );
        Self {
            name: claim.name.clone(),
            verdict: standing.verdict,
            margin,
            unit: claim.unit.as_ref().filter(|unit| !unit.name.is_empty()).map(|unit| unit.name.clone()),
            at_s: judged.then(|| seconds(standing.worst_tick, step_ns)),
            first_s: (judged && standing.verdict == Verdict::Fails).then(|| seconds(standing.first_tick, step_ns)),
            part: claim.parts.get(part).filter(|_| judged && standing.verdict != Verdict::Untested).map(|_| part),
            claim: claim.text.clone(),
            file: claim.part_file.clone(),
            line: claim.line,
            limit,
            seen,
            because: (judged && standing.verdict == Verdict::Fails)
                .then(|| because(claim, standing, step_ns))
                .flatten(),
            untested: claim.gates.get(part).filter(|_| standing.verdict == Verdict::Untested).cloned(),
            signals: signals(claim),
            comparisons: Vec::new(),
        }
    }

    /// The same with what it compares.
    #[must_use]
    pub fn comparing(self, comparisons: Vec<Comparison>) -> Self {
        Self { comparisons, ..self }
    }
}

/// The signals of all parts, each once.
fn signals(claim: &ClaimInfo) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in claim.parts.iter().flat_map(|part| &part.signals) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// Which part of a failed claim failed, in which window, when first and when worst, by which signals.
fn because(claim: &ClaimInfo, standing: &Standing, step_ns: u64) -> Option<String> {
    let part = claim.parts.get(usize::try_from(standing.part).ok()?)?;
    let mut text = if part.text.is_empty() { part.signals.join(", ") } else { format!("`{}`", part.text) };
    if !part.window.is_empty() {
        text += &format!(" in `{}`", part.window);
    }
    let [first, worst] = [standing.first_tick, standing.worst_tick].map(|tick| seconds(tick, step_ns));
    text += &if first < worst {
        format!(" failed first at {first} s, worst at {worst} s")
    } else {
        format!(" failed at {worst} s")
    };
    if !part.text.is_empty() && !part.signals.is_empty() {
        text += &format!(", by {}", part.signals.join(", "));
    }
    Some(text)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn parameters() -> Vec<Parameter> {
        let parameter =
            |name: &str, value: &str, set| Parameter { name: name.to_owned(), value: value.to_owned(), set };
        vec![parameter("gust", "4 m/s", true), parameter("seed", "1", false)]
    }

    pub(crate) fn claim(name: &str, text: &str, unit: Option<(&str, f64)>, limit: Option<(f64, bool)>) -> ClaimInfo {
        ClaimInfo {
            name: name.to_owned(),
            text: text.to_owned(),
            line: 34,
            unit: unit.map(|(name, factor)| MarginUnit { name: name.to_owned(), factor }),
            limit: limit.map(|(value, upper)| Limit { value, upper }),
            ..ClaimInfo::default()
        }
    }

    pub(crate) fn standing(verdict: Verdict, margin: f64, worst_tick: u64) -> Standing {
        Standing { verdict, margin, worst_tick, first_tick: worst_tick, part: 0 }
    }

    #[test]
    fn a_margin_is_given_in_the_claims_own_unit_with_the_value_seen() {
        let degree = std::f64::consts::PI / 180.0;
        let tilt = claim("tilt", "always quad.tilt < 35 deg", Some(("deg", degree)), Some((35.0, true)));
        let judged = JudgedClaim::new(&tilt, &standing(Verdict::Fails, -2.5 * degree, 3188), 10_000_000);
        assert_eq!((judged.margin, judged.seen, judged.at_s), (Some(-2.5), Some(37.5), Some(31.88)));
        let clear = claim("clear", "always world.clearance > 0.75 m", Some(("m", 1.0)), Some((0.75, false)));
        let judged = JudgedClaim::new(&clear, &standing(Verdict::Holds, 1.25, 0), 10_000_000);
        assert_eq!((judged.margin, judged.seen), (Some(1.25), Some(2.0)));
    }

    #[test]
    fn an_infinite_margin_is_none_and_an_unjudged_claim_has_neither_margin_nor_time() {
        let landed = claim("landed", "eventually quad.landed", None, None);
        let held = JudgedClaim::new(&landed, &standing(Verdict::Holds, f64::INFINITY, 7), 1_000_000);
        assert_eq!((held.margin, held.at_s), (None, Some(0.007)));
        let open = JudgedClaim::new(&landed, &standing(Verdict::Unjudged, 3.0, 7), 1_000_000);
        assert_eq!((open.margin, open.at_s), (None, None));
    }

    #[test]
    fn the_file_has_parameters_end_and_every_claim() {
        let claims = [
            (
                claim("clear", "always world.clearance > 0.5 m", Some(("m", 1.0)), Some((0.5, false))),
                standing(Verdict::Holds, 0.25, 10),
            ),
            (claim("landed", "eventually quad.landed", None, None), standing(Verdict::Undecided, 0.0, 0)),
        ];
        let verdict = VerdictFile {
            scenario: "Quadcopter flies".to_owned(),
            script: "quad.scn".to_owned(),
            parameters: parameters(),
            case: None,
            time_s: 4.2,
            end: "`quad` terminated".to_owned(),
            claims: claims.iter().map(|(claim, standing)| JudgedClaim::new(claim, standing, 10_000_000)).collect(),
            events: Vec::new(),
        };
        assert_eq!(verdict.count(), Count { ok: 1, unjudged: 1, ..Count::default() });
        insta::assert_snapshot!(verdict.json());
    }
}
