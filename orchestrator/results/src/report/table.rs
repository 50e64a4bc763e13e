//! The table of claims at the end of a run.

use super::number::{beside, duration, short};
use crate::run_record::{Case, Parameter, RunState};
use crate::shortest_decimal;
use crate::verdict::{JudgedClaim, Verdict, VerdictFile};
use fmi2::printable;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What the table contains besides the claims.
#[derive(Clone, Copy, Debug)]
pub struct Heading<'a> {
    /// The script as the user named it.
    pub script: &'a str,
    /// How the run ended.
    pub state: RunState,
    /// The simulated seconds at which the run began; zero unless it continued.
    pub from_s: f64,
    /// The simulated seconds that the script asks for.
    pub stop_s: f64,
    /// How long it took.
    pub wall_s: f64,
    /// Whether claims that were not tested count as failed.
    pub strict: bool,
}

/// The report of a run: heading, a line for each claim, how many failed and the line that replays it.
#[must_use]
pub fn report(heading: &Heading, verdict: &VerdictFile, replay: &str) -> String {
    let mut text = heading_line(heading, verdict);
    text.push_str(&claim_lines(heading.script, &verdict.claims));
    text.push_str(&count_line(heading.strict, verdict, replay));
    text
}

/// The lines that name the next commands of a program: the run's folder, its plot, the comparison with another run.
#[must_use]
pub fn next_lines(program: &str, folder: &Path, recorded: bool) -> String {
    let folder = printable::shell_word(folder);
    if !recorded {
        return format!("{folder}\n");
    }
    format!("{folder}\n  {program} plot {folder}\n  {program} diff {folder} OTHER\n")
}

/// The command of a program that repeats a run: the script with the case of its sweep and what the command line set.
#[must_use]
pub fn replay_command(
    program: &str,
    script: &Path,
    case: Option<Case>,
    parameters: &[Parameter],
    units: &[PathBuf],
) -> String {
    let mut line = format!("{program} run {}", printable::shell_word(script));
    if let Some(Case { number, draw_seed }) = case {
        let _ = write!(line, " --case {number}");
        let _ = draw_seed.map_or(Ok(()), |seed| write!(line, " --set 'seed = {seed}'"));
    }
    for parameter in parameters.iter().filter(|parameter| parameter.set) {
        let setting = format!("{} = {}", parameter.name, parameter.value);
        let _ = write!(line, " --set {}", printable::shell_word(setting));
    }
    for folder in units {
        let _ = write!(line, " --units {}", printable::shell_word(folder));
    }
    line
}

/// The first line of a report: how far the run came, how fast, with which parameters.
#[must_use]
pub fn heading_line(heading: &Heading, verdict: &VerdictFile) -> String {
    let (reached, stop) = (shortest_decimal(verdict.time_s), shortest_decimal(heading.stop_s));
    let how_far = match heading.state {
        RunState::Finished if verdict.time_s < heading.stop_s => format!("{reached} s of {stop} s, {},", verdict.end),
        RunState::Finished | RunState::Running => format!("{reached} s"),
        RunState::Broken => format!("broke at {reached} s of {stop} s,"),
        RunState::Interrupted => format!("interrupted at {reached} s of {stop} s,"),
    };
    let how_far =
        if heading.from_s > 0.0 { format!("{} s to {how_far}", shortest_decimal(heading.from_s)) } else { how_far };
    let simulated_s = verdict.time_s - heading.from_s;
    let speed = if heading.wall_s > 0.0 { short(simulated_s / heading.wall_s) } else { "inf".to_owned() };
    let parameters = parameters_line(&verdict.parameters);
    let line = format!("{}  {how_far} in {} ({speed}x)  {parameters}", heading.script, duration(heading.wall_s));
    line.trim_end().to_owned() + "\n"
}

/// The seed first, then the others as declared.
fn parameters_line(parameters: &[Parameter]) -> String {
    let is_seed = |parameter: &&Parameter| parameter.name == "seed";
    let seed = parameters.iter().filter(is_seed);
    let others = parameters.iter().filter(|parameter| !is_seed(parameter));
    let texts: Vec<_> = seed.chain(others).map(|parameter| format!("{} {}", parameter.name, parameter.value)).collect();
    texts.join(", ")
}

fn claim_lines(script: &str, claims: &[JudgedClaim]) -> String {
    let rows: Vec<[String; 4]> = claims.iter().map(|claim| cells(script, claim)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths = [width(0), width(1), width(2)];
    let mut text = String::new();
    for ([verdict, name, margin, detail], claim) in rows.iter().zip(claims) {
        let [verdict_width, name_width, margin_width] = widths;
        let line = format!("  {verdict:verdict_width$}  {name:name_width$}  {margin:margin_width$}  {detail}");
        text.push_str(line.trim_end());
        text.push('\n');
        for reason in reasons(claim) {
            let _ = writeln!(text, "  {:verdict_width$}  {reason}", "");
        }
    }
    text
}

/// Below a failed claim: its text, unless it stands beside it, and which part of it failed, when first and when worst.
fn reasons(claim: &JudgedClaim) -> Vec<String> {
    let Some(because) = &claim.because else { return Vec::new() };
    let stands_beside = claim.limit.is_none() || claim.seen.is_none();
    let text = (!stands_beside).then(|| shortened(&claim.claim));
    // A claim of one part would stand here twice.
    let failed = because.find(" failed ").map(|at| because.split_at(at));
    let because = match failed {
        Some((part, failed)) if claim.claim == in_order(part) => failed.trim_start().to_owned(),
        _ => format!("because {because}"),
    };
    text.into_iter().chain([shortened(&because)]).collect()
}

/// "`part` in `window`" as a claim has it, the window first.
fn in_order(part: &str) -> String {
    let unquoted = |text: &str| text.trim_matches('`').to_owned();
    match part.split_once("` in `") {
        Some((part, window)) => format!("{} {}", unquoted(window), unquoted(part)),
        None => unquoted(part),
    }
}

/// The longest text of a claim in the table, in characters.
const LONGEST_TEXT: usize = 120;

/// A text as it fits into the table.
fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST_TEXT) {
        None => text.to_owned(),
        Some(_) => text.chars().take(LONGEST_TEXT - 1).chain(['…']).collect(),
    }
}

fn cells(script: &str, claim: &JudgedClaim) -> [String; 4] {
    let (written, file) = (shortened(&claim.claim), claim.file.as_deref().unwrap_or(script));
    let (verdict, detail) = match claim.verdict {
        Verdict::Holds => ("ok", written),
        Verdict::Untested => {
            let why = shortened(claim.untested.as_ref().unwrap_or(&claim.claim));
            return ["untested".to_owned(), claim.name.clone(), String::new(), why];
        }
        Verdict::Fails => ("FAILED", format!("{file}:{}  {}", claim.line, value_seen(claim))),
        Verdict::Undecided | Verdict::Unjudged => ("unjudged", format!("{file}:{}  {written}", claim.line)),
    };
    [verdict.to_owned(), claim.name.clone(), margin(claim), detail]
}

fn value_seen(claim: &JudgedClaim) -> String {
    let (Some(limit), Some(seen), Some(margin)) = (claim.limit, claim.seen, claim.margin) else {
        return shortened(&claim.claim);
    };
    let unit = unit_suffix(claim);
    format!("limit {}{unit}, seen {}{unit}", shortest_decimal(limit), beside(seen, margin))
}

/// The margin with a column for its sign, so that digits are aligned.
fn margin(claim: &JudgedClaim) -> String {
    let Some(at_s) = claim.at_s else { return " - the run ended before".to_owned() };
    let at = shortest_decimal(at_s);
    match claim.margin {
        Some(margin) if margin < 0.0 => format!("{}{} at {at} s", short(margin), unit_suffix(claim)),
        Some(margin) => format!(" {}{} at {at} s", short(margin), unit_suffix(claim)),
        None => format!(" - at {at} s"),
    }
}

fn unit_suffix(claim: &JudgedClaim) -> String {
    claim.unit.as_ref().map_or_else(String::new, |unit| format!(" {unit}"))
}

fn count_line(strict: bool, verdict: &VerdictFile, replay: &str) -> String {
    let (count, all) = (verdict.count(), verdict.claims.len());
    if all == 0 {
        return "No claims in this script: nothing was judged.\n".to_owned();
    }
    let untested = if strict { count.untested } else { 0 };
    let counts = [
        (count.failed, "failed"),
        (count.unjudged, "could not be judged"),
        (untested, "not tested, which --strict counts as failed"),
    ];
    let mut lost = counts.into_iter().filter(|(number, _)| *number > 0);
    let Some((number, what)) = lost.next() else { return holding_line(count.untested, all) };
    let first = format!("{number} of {all} claims {what}");
    let summary = lost.fold(first, |text, (number, what)| format!("{text}, {number} {what}"));
    let strict = if untested > 0 { " --strict" } else { "" };
    format!("{summary}.  {replay}{strict} replays it\n")
}

fn holding_line(untested: usize, all: usize) -> String {
    match (untested, all) {
        (0, 1) => "The claim holds.\n".to_owned(),
        (0, _) => format!("All {all} claims hold.\n"),
        (_, 1) => "The claim was not tested.\n".to_owned(),
        (_, _) if untested == all => format!("None of {all} claims was tested.\n"),
        _ => format!("All {all} claims hold, {untested} of them untested.\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::tests::{claim, parameters, standing};
    use crate::verdict::{ClaimInfo, Standing};

    const DEGREE: f64 = std::f64::consts::PI / 180.0;

    fn report_of(heading: Heading, time_s: f64, end: &str, judged: &[(ClaimInfo, Standing)]) -> String {
        let claims = judged.iter().map(|(claim, standing)| JudgedClaim::new(claim, standing, 10_000_000));
        let verdict = VerdictFile {
            scenario: "Quadcopter flies".to_owned(),
            script: "quad.scn".to_owned(),
            parameters: parameters(),
            case: None,
            time_s,
            end: end.to_owned(),
            claims: claims.collect(),
            events: Vec::new(),
        };
        let replay = replay_command("lockstep", Path::new(heading.script), None, &verdict.parameters, &[]);
        report(&heading, &verdict, &replay) + &next_lines("lockstep", Path::new("runs/quad"), true)
    }

    fn heading(state: RunState) -> Heading<'static> {
        Heading { script: "scenarios/quad.scn", state, from_s: 0.0, stop_s: 90.0, wall_s: 6.2, strict: false }
    }

    #[test]
    fn a_report_aligns_margins_and_gives_the_line_of_a_failed_claim() {
        let judged = vec![
            (
                claim("clear", "always world.clearance > 0.8 m", Some(("m", 1.0)), Some((0.8, false))),
                standing(Verdict::Holds, 1.3149, 4235),
            ),
            (
                claim("arrive", "eventually within 85 s hold for 2 s there", Some(("m", 1.0)), None),
                standing(Verdict::Holds, 0.12, 7102),
            ),
            (
                claim("tilt", "always quad.tilt < 35 deg", Some(("deg", DEGREE)), Some((35.0, true))),
                standing(Verdict::Fails, -2.4 * DEGREE, 3188),
            ),
            (claim("landed", "eventually quad.landed", None, None), standing(Verdict::Holds, f64::INFINITY, 8000)),
            (
                claim("ratio", "always quad.a / quad.b < 2", Some(("", 1.0)), Some((2.0, true))),
                standing(Verdict::Fails, -1e-7, 1),
            ),
        ];
        insta::assert_snapshot!(report_of(heading(RunState::Finished), 90.0, "stop time", &judged));
    }

    #[test]
    fn the_report_of_a_run_that_ended_early_gives_the_reason() {
        let landed = claim("landed", "eventually quad.landed", None, None);
        let judged = [(landed, standing(Verdict::Unjudged, 0.0, 0))];
        let texts = [
            report_of(heading(RunState::Broken), 12.34, "stop time", &judged),
            report_of(heading(RunState::Interrupted), 12.34, "interrupted", &judged),
            report_of(heading(RunState::Finished), 12.34, "`quad` terminated", &judged),
        ];
        insta::assert_snapshot!(texts.join("\n"));
    }

    #[test]
    fn the_last_line_counts_failed_and_unjudged_claims() {
        let make_with = |strict: bool, verdicts: &[Verdict]| {
            let judged = verdicts.iter().map(|&verdict| (claim("a", "b", None, None), standing(verdict, 0.0, 0)));
            let heading = Heading { strict, ..heading(RunState::Finished) };
            let text = report_of(heading, 90.0, "stop time", &judged.collect::<Vec<_>>());
            text.lines().nth(verdicts.len() + 1).map(str::to_owned).unwrap_or_default()
        };
        let make = |verdicts: &[Verdict]| make_with(false, verdicts);
        let replay = "lockstep run scenarios/quad.scn --set 'gust = 4 m/s' replays it";
        let strict = replay.replace(" replays", " --strict replays");
        use Verdict::{Fails, Holds, Unjudged, Untested};
        assert_eq!(make(&[]), "No claims in this script: nothing was judged.");
        assert_eq!(make(&[Holds]), "The claim holds.");
        assert_eq!(make(&[Holds, Holds]), "All 2 claims hold.");
        assert_eq!(make(&[Holds, Untested]), "All 2 claims hold, 1 of them untested.");
        assert_eq!(
            make_with(true, &[Holds, Untested]),
            format!("1 of 2 claims not tested, which --strict counts as failed.  {strict}")
        );
        let both = "1 of 2 claims failed, 1 not tested, which --strict counts as failed.";
        assert_eq!(make_with(true, &[Fails, Untested]), format!("{both}  {strict}"));
        assert_eq!(make(&[Holds, Unjudged]), format!("1 of 2 claims could not be judged.  {replay}"));
        assert_eq!(make(&[Fails, Holds]), format!("1 of 2 claims failed.  {replay}"));
        assert_eq!(make(&[Fails, Unjudged]), format!("1 of 2 claims failed, 1 could not be judged.  {replay}"));
    }

    #[test]
    fn a_replay_command_is_quoted_for_the_shell() {
        let parameter = |value: &str| Parameter { name: "load".to_owned(), value: value.to_owned(), set: true };
        let (script, set, units) = (Path::new("my runs/a.scn"), [parameter("5 'N.m'")], ["units".into()]);
        let line = replay_command("lockstep", script, None, &set, &units);
        assert_eq!(line, r#"lockstep run 'my runs/a.scn' --set 'load = 5 '\''N.m'\''' --units units"#);
        let case = Case { number: 7, draw_seed: None };
        assert_eq!(replay_command("lockstep", Path::new("a.scn"), Some(case), &[], &[]), "lockstep run a.scn --case 7");
        let case = Case { number: 7, draw_seed: Some(3) };
        let line = replay_command("lockstep", Path::new("a.scn"), Some(case), &[], &[]);
        assert_eq!(line, "lockstep run a.scn --case 7 --set 'seed = 3'");
    }
}
