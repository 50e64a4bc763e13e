//! `verdict.json`: the claims and how they came out, each with the margin by which it held or failed.

use crate::message::Reason;
use crate::wiring::seconds;
use dsl::scenario::{Claim, Parameter, Scenario};
use serde::Serialize;

/// How a claim came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Judgement {
    /// It held.
    Ok,
    /// It did not.
    Failed,
    /// The run ended before it could be decided.
    Unjudged,
}

/// What the loop found out about a claim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// How it came out.
    pub judgement: Judgement,
    /// The margin in SI; infinite where the claim has none.
    pub margin: f64,
    /// The tick at which the margin was smallest, or largest for an `eventually`.
    pub worst_tick: u64,
}

/// The content of `verdict.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// The words of the `scenario` line.
    pub scenario: String,
    /// The script's file name.
    pub script: String,
    /// The parameters with their values in this run.
    pub parameters: Vec<Parameter>,
    /// Simulated seconds reached.
    pub time_s: f64,
    /// Why the run ended.
    pub end: String,
    /// The claims in the script's order.
    pub claims: Vec<JudgedClaim>,
}

/// One claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JudgedClaim {
    /// The name.
    pub name: String,
    /// How it came out.
    pub verdict: Judgement,
    /// How far it was from failing, or below zero how far it failed, in `unit`; `None` where that is no number.
    pub margin: Option<f64>,
    /// The unit of `margin`, `limit` and `seen`; `None` for plain numbers.
    pub unit: Option<String>,
    /// The worst time in seconds.
    pub at_s: Option<f64>,
    /// The claim as written.
    pub claim: String,
    /// Its line in the script.
    pub line: usize,
    /// The constant that the claim compares with.
    pub limit: Option<f64>,
    /// What was seen at the worst time.
    pub seen: Option<f64>,
}

/// How many claims came out how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Held.
    pub ok: usize,
    /// Did not.
    pub failed: usize,
    /// Could not be decided.
    pub unjudged: usize,
}

impl Verdict {
    /// Puts together what the script claims and what the loop found, one finding for each claim.
    #[must_use]
    pub fn new(scenario: &Scenario, script: &str, last_tick: u64, end: String, findings: &[Finding]) -> Self {
        assert_eq!(scenario.claims.len(), findings.len(), "each claim has a finding");
        let claims = scenario.claims.iter().zip(findings);
        Self {
            scenario: scenario.title.clone(),
            script: script.to_owned(),
            parameters: scenario.parameters.clone(),
            time_s: seconds(last_tick, scenario.step_ns),
            end,
            claims: claims.map(|(claim, finding)| JudgedClaim::new(claim, finding, scenario.step_ns)).collect(),
        }
    }

    /// The text of the file.
    #[must_use]
    pub fn json(&self) -> String {
        super::json_text(self)
    }

    /// How many claims came out how.
    #[must_use]
    pub fn count(&self) -> Count {
        let mut count = Count::default();
        for claim in &self.claims {
            match claim.verdict {
                Judgement::Ok => count.ok += 1,
                Judgement::Failed => count.failed += 1,
                Judgement::Unjudged => count.unjudged += 1,
            }
        }
        count
    }
}

impl JudgedClaim {
    /// The claim with a finding, in its own unit.
    #[must_use]
    pub fn new(claim: &Claim, finding: &Finding, step_ns: u64) -> Self {
        let judged = finding.judgement != Judgement::Unjudged;
        let factor = claim.unit.as_ref().map_or(1.0, |unit| unit.factor);
        // Adding zero takes the sign off a margin of zero; the verdict tells whether zero is enough.
        let margin = (judged && finding.margin.is_finite()).then_some(finding.margin / factor + 0.0);
        let limit = claim.limit.map(|limit| limit.value);
        let seen = claim.limit.zip(margin).map(
            |(limit, margin)| {
                if limit.upper { limit.value - margin } else { limit.value + margin }
            },
        );
        Self {
            name: claim.name.clone(),
            verdict: finding.judgement,
            margin,
            unit: claim.unit.as_ref().filter(|unit| !unit.name.is_empty()).map(|unit| unit.name.clone()),
            at_s: judged.then(|| seconds(finding.worst_tick, step_ns)),
            claim: claim.text.clone(),
            line: claim.line,
            limit,
            seen,
        }
    }
}

/// Why a run ended, in words.
#[must_use]
pub fn reason_text(reason: &Reason, scenario: &Scenario) -> String {
    match reason {
        Reason::StopTime => "stop time".to_owned(),
        Reason::Terminated(instance) => format!("`{}` terminated", scenario.instances[*instance].name),
        Reason::ClaimLost(claim) => format!("claim `{}` lost", scenario.claims[*claim].name),
        Reason::Interrupted => "interrupted".to_owned(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use dsl::scenario::{BooleanExpression, Formula, Instance, Limit, MarginUnit};

    pub(crate) fn scenario() -> Scenario {
        let parameter =
            |name: &str, value: &str, set| Parameter { name: name.to_owned(), value: value.to_owned(), set };
        Scenario {
            title: "Quadcopter flies".to_owned(),
            step_ns: 10_000_000,
            stop_tick: 9000,
            parameters: vec![parameter("gust", "4 m/s", true), parameter("seed", "1", false)],
            instances: vec![Instance {
                name: "quad".to_owned(),
                unit: "quadcopter".to_owned(),
                every: 1,
                wave: 0,
                presets: vec![],
            }],
            initialization: vec![],
            connections: vec![],
            events: vec![],
            conditions: vec![],
            claims: vec![],
            columns: vec![],
        }
    }

    pub(crate) fn claim(name: &str, text: &str, unit: Option<(&str, f64)>, limit: Option<(f64, bool)>) -> Claim {
        Claim {
            name: name.to_owned(),
            text: text.to_owned(),
            line: 34,
            formula: Formula::Condition(BooleanExpression::Constant(true)),
            unit: unit.map(|(name, factor)| MarginUnit { name: name.to_owned(), factor }),
            limit: limit.map(|(value, upper)| Limit { value, upper }),
        }
    }

    pub(crate) fn finding(judgement: Judgement, margin: f64, worst_tick: u64) -> Finding {
        Finding { judgement, margin, worst_tick }
    }

    #[test]
    fn a_margin_is_told_in_the_claims_own_unit_with_what_was_seen() {
        let degree = std::f64::consts::PI / 180.0;
        let tilt = claim("tilt", "always quad.tilt < 35 deg", Some(("deg", degree)), Some((35.0, true)));
        let judged = JudgedClaim::new(&tilt, &finding(Judgement::Failed, -2.5 * degree, 3188), 10_000_000);
        assert_eq!((judged.margin, judged.seen, judged.at_s), (Some(-2.5), Some(37.5), Some(31.88)));
        let clear = claim("clear", "always world.clearance > 0.75 m", Some(("m", 1.0)), Some((0.75, false)));
        let judged = JudgedClaim::new(&clear, &finding(Judgement::Ok, 1.25, 0), 10_000_000);
        assert_eq!((judged.margin, judged.seen), (Some(1.25), Some(2.0)));
    }

    #[test]
    fn an_infinite_margin_is_none_and_an_unjudged_claim_has_neither_margin_nor_time() {
        let landed = claim("landed", "eventually quad.landed", None, None);
        let held = JudgedClaim::new(&landed, &finding(Judgement::Ok, f64::INFINITY, 7), 1_000_000);
        assert_eq!((held.margin, held.at_s), (None, Some(0.007)));
        let open = JudgedClaim::new(&landed, &finding(Judgement::Unjudged, 3.0, 7), 1_000_000);
        assert_eq!((open.margin, open.at_s), (None, None));
    }

    #[test]
    fn the_file_tells_parameters_end_and_every_claim() {
        let mut scenario = scenario();
        scenario.claims = vec![
            claim("clear", "always world.clearance > 0.5 m", Some(("m", 1.0)), Some((0.5, false))),
            claim("landed", "eventually quad.landed", None, None),
        ];
        let findings = [finding(Judgement::Ok, 0.25, 10), finding(Judgement::Unjudged, 0.0, 0)];
        let end = reason_text(&Reason::Terminated(0), &scenario);
        let verdict = Verdict::new(&scenario, "quad.scn", 420, end, &findings);
        assert_eq!(verdict.count(), Count { ok: 1, failed: 0, unjudged: 1 });
        insta::assert_snapshot!(verdict.json());
    }
}
