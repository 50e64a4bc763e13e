//! The progress of a run, as a line of text for people and as JSON for programs.

use super::number::{duration, short};
use crate::shortest_decimal;
use crate::verdict::{JudgedClaim, Verdict};
use serde::Serialize;

/// The progress of a run at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Simulated seconds reached.
    pub time_s: f64,
    /// Simulated seconds at which the run ends.
    pub stop_s: f64,
    /// Simulated seconds at which the run began; zero unless it continues.
    pub from_s: f64,
    /// Seconds since the run began.
    pub wall_s: f64,
    /// The claims that have a standing already.
    pub claims: Vec<JudgedClaim>,
}

impl Progress {
    /// The completed fraction, from 0 to 1.
    #[must_use]
    pub fn part(&self) -> f64 {
        if self.stop_s > 0.0 { self.time_s / self.stop_s } else { 1.0 }
    }

    fn speed(&self) -> f64 {
        if self.wall_s > 0.0 { (self.time_s - self.from_s) / self.wall_s } else { 0.0 }
    }

    fn left_s(&self) -> Option<f64> {
        let done_s = self.time_s - self.from_s;
        (done_s > 0.0).then(|| self.wall_s * (self.stop_s - self.time_s) / done_s)
    }

    /// The claim that is nearest to failing, relative to its limit; one that failed comes first.
    #[must_use]
    pub fn tightest(&self) -> Option<&JudgedClaim> {
        let judged = self.claims.iter().filter(|claim| claim.margin.is_some() || claim.verdict == Verdict::Fails);
        judged.min_by(|a, b| tightness(a).total_cmp(&tightness(b)))
    }

    /// The line for people.
    #[must_use]
    pub fn line(&self) -> String {
        let (time, stop) = (decimals_like(self.time_s, self.stop_s), shortest_decimal(self.stop_s));
        let mut line = format!("{time} s of {stop} s  {}x", short(self.speed()));
        if let Some(left_s) = self.left_s().filter(|&left_s| left_s >= 1.0) {
            line.push_str(&format!("  {} left", duration(left_s)));
        }
        if let Some(claim) = self.tightest() {
            line.push_str(&format!("  {}", claim_text(claim)));
        }
        line
    }

    /// The line for programs, as JSON.
    #[must_use]
    pub fn json(&self) -> String {
        let tightest = self.tightest();
        let line = ProgressJson {
            time_s: self.time_s,
            stop_s: self.stop_s,
            wall_s: self.wall_s,
            speed: self.speed(),
            left_s: self.left_s(),
            tightest: tightest.map(|claim| claim.name.as_str()),
            margin: tightest.and_then(|claim| claim.margin),
            unit: tightest.and_then(|claim| claim.unit.as_deref()),
        };
        match serde_json::to_string(&line) {
            Ok(text) => text,
            Err(error) => unreachable!("plain data always has a JSON text: {error}"),
        }
    }
}

#[derive(Serialize)]
struct ProgressJson<'a> {
    time_s: f64,
    stop_s: f64,
    wall_s: f64,
    speed: f64,
    left_s: Option<f64>,
    tightest: Option<&'a str>,
    margin: Option<f64>,
    unit: Option<&'a str>,
}

fn tightness(claim: &JudgedClaim) -> f64 {
    let margin = claim.margin.unwrap_or(f64::NEG_INFINITY);
    match claim.limit {
        Some(limit) if limit != 0.0 => margin / limit.abs(),
        _ => margin,
    }
}

fn claim_text(claim: &JudgedClaim) -> String {
    let failed = if claim.verdict == Verdict::Fails { " FAILED" } else { "" };
    let unit = claim.unit.as_ref().map_or_else(String::new, |unit| format!(" {unit}"));
    match claim.margin {
        Some(margin) => format!("{}{failed} {}{unit}", claim.name, short(margin)),
        None => format!("{}{failed}", claim.name),
    }
}

/// As many decimals as a line can change its width by: tenths for long runs, hundredths for short ones.
fn decimals_like(time_s: f64, stop_s: f64) -> String {
    if stop_s < 10.0 { format!("{time_s:.2}") } else { format!("{time_s:.1}") }
}

/// Decides when a line is due that is not overwritten by the next: at each tenth of the run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tenths {
    reported: u32,
}

impl Tenths {
    /// The tenth that was reached since the last call, in percent; of several, the last.
    pub fn due(&mut self, part: f64) -> Option<u32> {
        let reached = ((part * 10.0 + 1e-9).floor() as u32).min(10);
        (reached > self.reported).then(|| {
            self.reported = reached;
            reached * 10
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::tests::{claim, standing};

    fn progress() -> Progress {
        let judged = |name: &str, unit: (&str, f64), limit: (f64, bool), margin: f64| {
            let verdict = if margin < 0.0 { Verdict::Fails } else { Verdict::Holds };
            JudgedClaim::new(&claim(name, "", Some(unit), Some(limit)), &standing(verdict, margin, 5), 10_000_000)
        };
        let claims =
            vec![judged("tilt", ("deg", 0.0175), (35.0, true), 0.0525), judged("clear", ("m", 1.0), (0.8, false), 1.3)];
        Progress { time_s: 22.5, stop_s: 90.0, from_s: 0.0, wall_s: 1.5, claims }
    }

    #[test]
    fn the_line_has_time_speed_remaining_time_and_the_tightest_claim() {
        assert_eq!(progress().line(), "22.5 s of 90 s  15x  4.5 s left  tilt 3 deg");
    }

    #[test]
    fn margins_of_different_units_are_compared_by_their_limits() {
        // 3 deg of 35 deg is nearer to the limit than 1.3 m of 0.8 m, though the number is larger.
        assert_eq!(progress().tightest().map(|claim| claim.name.as_str()), Some("tilt"));
    }

    #[test]
    fn a_claim_that_failed_comes_first() {
        let mut progress = progress();
        progress.claims[1].margin = Some(-0.1);
        progress.claims[1].verdict = Verdict::Fails;
        assert!(progress.line().ends_with("clear FAILED -0.1 m"), "{}", progress.line());
    }

    #[test]
    fn the_json_line_has_the_same_values() {
        insta::assert_snapshot!(progress().json());
    }

    #[test]
    fn each_tenth_is_reported_once() {
        let mut tenths = Tenths::default();
        let due: Vec<_> = [0.0, 0.05, 0.1, 0.15, 0.39, 1.0, 1.0].map(|part| tenths.due(part)).into();
        assert_eq!(due, [None, None, Some(10), None, Some(30), Some(100), None]);
    }
}
