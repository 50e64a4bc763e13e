"""Results of `lockstep run`, `check` and `diff` for the scripts of `scenarios/`."""

import json
import re

import pytest

FAILURES = {
    ("first_flight.scn", "tracks"): "mean = 25 m/s",
    ("first_flight.scn", "tilts"): "mean = 25 m/s",
    ("first_flight.scn", "lands"): "turbulence = 80 m/s",
    ("breeze.scn", "arrives"): "speed = 4 m/s",
    ("breeze.scn", "flyable"): "gustiness = 12 m/s",
}

FIVE_MISTAKES = """\
scenario "Five mistakes of meaning"
step 5 ms
stop 10 s

fmu air  = "wind"
fmu path = "trajectory"
fmu quad = "quadcopter" { mas = 1 kg }

path.setpoint.position -> air.mean
air.velocty            -> quad.wind

at 5.0123 s { set air.turbulence = 2 m/s }

assert calm: always air.speed < 3 m
"""


def verdicts(folder):
    """Claims of a run by name."""
    return {claim["name"]: claim for claim in json.loads((folder / "verdict.json").read_text())["claims"]}


def claims_of(scenario):
    return re.findall(r"^assert (\w+):", scenario.read_text(), re.MULTILINE)


def test_every_claim_of_every_scenario_has_a_setting_under_which_it_fails(root):
    claims = {(path.name, claim) for path in root.glob("scenarios/*.scn") for claim in claims_of(path)}
    assert claims == set(FAILURES)


@pytest.mark.parametrize("scenario, claim", FAILURES)
def test_a_claim_fails_under_its_setting(run_scenario, scenario, claim):
    setting = FAILURES[scenario, claim]
    run, folder = run_scenario(f"scenarios/{scenario}", "--set", setting)
    assert run.returncode == 1, run.stderr
    assert verdicts(folder)[claim]["verdict"] == "failed"


def test_the_claims_of_every_scenario_hold(run_scenario, root):
    for scenario in sorted(root.glob("scenarios/*.scn")):
        run, folder = run_scenario(scenario, name=scenario.stem)
        assert run.returncode == 0, run.stderr
        assert all(claim["verdict"] == "ok" for claim in verdicts(folder).values())


def test_a_storm_fails_a_claim_which_is_reported_with_margin_and_time(run_scenario):
    run, _ = run_scenario("scenarios/first_flight.scn", "--set", "mean = 25 m/s")
    assert run.returncode == 1
    assert re.search(r"FAILED +tracks +-\d+(\.\d+)? m at \d+(\.\d+)? s", run.stdout), run.stdout


def test_five_semantic_errors_are_all_reported_with_position_and_help(lockstep, packed, tmp_path):
    script = tmp_path / "five.scn"
    script.write_text(FIVE_MISTAKES)
    for command in (["check", script, "--units", packed], ["run", script, "--units", packed]):
        result = lockstep(*command)
        assert result.returncode == 2
        errors = re.split(r"^error", result.stdout + result.stderr, flags=re.MULTILINE)[1:]
        places = sorted(int(re.search(r"five\.scn:(\d+):\d+", error).group(1)) for error in errors)
        assert places == [7, 9, 10, 12, 14]
        assert all("help: " in error for error in errors), errors


def test_two_runs_give_the_same_bytes_and_diff_reports_it(run_scenario, lockstep):
    (_, one), (_, other) = (run_scenario("scenarios/first_flight.scn", name=name) for name in ("one", "other"))
    for file in ("trace.csv", "trace.parquet", "signals.json", "verdict.json"):
        assert (one / file).read_bytes() == (other / file).read_bytes()
    diff = lockstep("diff", one, other)
    assert diff.returncode == 0, diff.stdout


def test_diff_names_the_first_difference_of_two_runs(run_scenario, lockstep):
    _, calm = run_scenario("scenarios/first_flight.scn", name="calm")
    _, windy = run_scenario("scenarios/first_flight.scn", "--set", "mean = 4 m/s", name="windy")
    diff = lockstep("diff", calm, windy)
    assert diff.returncode == 1
    assert "first difference at 0 s (row 0) in quad.thrust" in diff.stdout, diff.stdout
