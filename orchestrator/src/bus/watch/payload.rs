//! The JSON payloads of a run's keys.
//!
//! A Real is the shortest decimal that reads back to the same bits. JSON has neither NaN nor infinities, so these are
//! texts, as in the trace.

use results::run_record::RunState;
use results::shortest_decimal;
use results::signals::SlotType;
use results::verdict::{ClaimInfo, JudgedClaim, Standing, Verdict};
use serde::{Serialize, Serializer};
use unit::time::seconds;

/// A recorded variable of an instance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Its name in its unit.
    pub name: String,
    /// Its column in rows.
    pub column: usize,
    /// How its slots are read.
    pub slot_type: SlotType,
}

/// The run and tick of a payload.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The run's name.
    pub run: &'a str,
    /// The tick.
    pub tick: u64,
    /// How long a tick is.
    pub step_ns: u64,
}

/// The values of an instance in a row.
#[must_use]
pub fn values(moment: Moment<'_>, variables: &[Variable], slots: &[u64]) -> Vec<u8> {
    let Moment { run, tick, step_ns } = moment;
    json(&ValuesJson { run, tick, time: seconds(tick, step_ns), values: RowValues { variables, slots } })
}

/// The state of a run and of its claims, with one standing for each claim.
#[must_use]
pub fn state(moment: Moment<'_>, state: RunState, claims: &[ClaimInfo], standings: &[Standing]) -> Vec<u8> {
    let Moment { run, tick, step_ns } = moment;
    let claims = claims.iter().zip(standings);
    let claims = claims.map(|(claim, at)| claim_json(claim, at, step_ns, state == RunState::Running)).collect();
    json(&StateJson { run, tick, time: seconds(tick, step_ns), state, claims })
}

/// A claim that is not decided yet has a margin so far, and no verdict. Reports show no margin of an undecided claim, hence
/// the substituted verdict.
fn claim_json<'a>(claim: &'a ClaimInfo, standing: &Standing, step_ns: u64, running: bool) -> ClaimJson<'a> {
    let open = running && !standing.verdict.is_decided();
    let verdict = if open { Verdict::Holds } else { standing.verdict };
    let JudgedClaim { verdict, margin, unit, .. } =
        JudgedClaim::new(claim, &Standing { verdict, ..*standing }, step_ns);
    ClaimJson { name: &claim.name, verdict: (!open).then_some(verdict), margin, unit }
}

#[derive(Serialize)]
struct ValuesJson<'a> {
    run: &'a str,
    tick: u64,
    time: f64,
    values: RowValues<'a>,
}

struct RowValues<'a> {
    variables: &'a [Variable],
    slots: &'a [u64],
}

#[derive(Serialize)]
struct StateJson<'a> {
    run: &'a str,
    tick: u64,
    time: f64,
    state: RunState,
    claims: Vec<ClaimJson<'a>>,
}

#[derive(Serialize)]
struct ClaimJson<'a> {
    name: &'a str,
    verdict: Option<Verdict>,
    margin: Option<f64>,
    unit: Option<String>,
}

impl Serialize for RowValues<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let value =
            |variable: &Variable| SlotValue { slot_type: variable.slot_type, slot: self.slots[variable.column] };
        serializer.collect_map(self.variables.iter().map(|variable| (&variable.name, value(variable))))
    }
}

struct SlotValue {
    slot_type: SlotType,
    slot: u64,
}

impl Serialize for SlotValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.slot_type {
            SlotType::Real => match f64::from_bits(self.slot) {
                value if value.is_finite() => serializer.serialize_f64(value),
                value => serializer.serialize_str(&shortest_decimal(value)),
            },
            SlotType::Integer => serializer.serialize_i32(self.slot as u32 as i32),
            SlotType::Boolean => serializer.serialize_bool(self.slot != 0),
        }
    }
}

fn json(value: &impl Serialize) -> Vec<u8> {
    match serde_json::to_vec(value) {
        Ok(text) => text,
        Err(error) => unreachable!("plain data with string keys always has a JSON text: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use results::verdict::{Limit, MarginUnit};

    /// The data of a claim for reports.
    fn claim_info(name: &str, text: &str, unit: Option<(&str, f64)>, limit: Option<(f64, bool)>) -> ClaimInfo {
        ClaimInfo {
            name: name.to_owned(),
            text: text.to_owned(),
            line: 34,
            unit: unit.map(|(name, factor)| MarginUnit { name: name.to_owned(), factor }),
            limit: limit.map(|(value, upper)| Limit { value, upper }),
            ..ClaimInfo::default()
        }
    }

    /// The standing of a claim.
    fn standing(verdict: Verdict, margin: f64, worst_tick: u64) -> Standing {
        Standing { verdict, margin, worst_tick, first_tick: worst_tick, part: 0 }
    }

    const MOMENT: Moment<'static> = Moment { run: "0123456789abcdef", tick: 1234, step_ns: 10_000_000 };

    fn variable(name: &str, column: usize, slot_type: SlotType) -> Variable {
        Variable { name: name.to_owned(), column, slot_type }
    }

    fn text(payload: Vec<u8>) -> String {
        String::from_utf8(payload).unwrap()
    }

    #[test]
    fn a_values_payload_has_run_tick_time_and_each_variable_by_its_own_name() {
        let variables = [
            variable("position.x", 3, SlotType::Real),
            variable("fallen", 0, SlotType::Boolean),
            variable("'say \"x\"'", 1, SlotType::Integer),
            variable("zero", 2, SlotType::Real),
        ];
        let slots = [1, i64::from(-7).cast_unsigned(), (-0.0_f64).to_bits(), 1.5_f64.to_bits()];
        insta::assert_snapshot!(text(values(MOMENT, &variables, &slots)));
    }

    #[test]
    fn numbers_that_json_does_not_have_are_texts_as_in_the_trace() {
        let variables = [0, 1, 2].map(|column| variable(&format!("v{column}"), column, SlotType::Real));
        let slots = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(f64::to_bits);
        let text = text(values(MOMENT, &variables, &slots));
        assert!(text.ends_with(r#""values":{"v0":"NaN","v1":"inf","v2":"-inf"}}"#), "{text}");
    }

    #[test]
    fn an_open_claim_has_a_margin_so_far_and_no_verdict_until_the_run_is_over() {
        let degree = std::f64::consts::PI / 180.0;
        let claims = [
            claim_info("tilts", "always quad.tilt < 35 deg", Some(("deg", degree)), Some((35.0, true))),
            claim_info("lands", "eventually quad.landed", None, None),
            claim_info("calm", "always air.speed < 3 m/s", Some(("m/s", 1.0)), Some((3.0, true))),
        ];
        let standings = [
            standing(Verdict::Undecided, 2.5 * degree, 7),
            standing(Verdict::Undecided, f64::NAN, 0),
            standing(Verdict::Fails, -0.25, 9),
        ];
        let payloads = [RunState::Running, RunState::Broken].map(|now| text(state(MOMENT, now, &claims, &standings)));
        insta::assert_snapshot!(payloads.join("\n"));
    }

    proptest::proptest! {
        #[test]
        fn every_real_reads_back_to_the_same_bits(bits: u64) {
            let text = text(values(MOMENT, &[variable("x", 0, SlotType::Real)], &[bits]));
            let read: serde_json::Value = serde_json::from_str(&text).unwrap();
            let (x, value) = (&read["values"]["x"], f64::from_bits(bits));
            let same = x.as_f64().map(f64::to_bits) == Some(bits);
            assert!(same || (!value.is_finite() && x.is_string()), "{text} for {value:e}");
        }
    }
}
