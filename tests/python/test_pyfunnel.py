"""Comparisons with a reference curve have the results of pyfunnel and of a direct computation.

pyfunnel lays rectangles of half width w and half height d around the reference and reports by how much samples lie
outside their hull. That hull reaches from the least to the largest value of the reference within w, d further on both
sides. As the reference is continuous, a sample is in it exactly where Lockstep's margin, d minus the least distance
within w, is not negative; outside, the error is the negative margin. pyfunnel wants a reference that begins and ends
with the samples.
"""

import dataclasses
import json

import numpy as np
import pyfunnel
import pytest

import csv_record
import foreign

STOP_S = 60
REFERENCES = 20
# pyfunnel computes with a w of 1e-10 s and more, so that its error may be less by that much times the slope.
ROUNDING = 1e-9

SCRIPT = """\
scenario "Comparisons with references"
step 1 s
stop {stop} s
fmu probe = "foreign.fmu" {{ gain = 1 }}
curve("driven.csv", "u") -> probe.u
let x = probe.y as '1'
{claims}
record x
"""


@dataclasses.dataclass
class Reference:
    """A reference with its tolerances: w in s, d in the unit of the values."""

    time: np.ndarray
    values: np.ndarray
    w: float
    d: float = 0.0

    def claim(self, file, begins):
        """The claim in a script; the reference begins it or stands on the right."""
        sides = ["x", f'curve("{file}", "c")']
        within = f" within {self.w!r} s" if self.w else ""
        return f"always {' == '.join(reversed(sides) if begins else sides)} ± {self.d!r}{within}"

    def margins(self, time, x):
        """Margins at the samples: a continuous curve takes all values between its least and its largest one.

        A line has its extremes at its ends, so the rows and the two ends of the time within w are enough.
        """
        margins = []
        for now, value in zip(time, x):
            rows = self.values[np.abs(self.time - now) < self.w]
            ends = np.interp([now - self.w, now + self.w], self.time, self.values)
            near = np.concatenate([rows, ends])
            margins.append(self.d - max(0.0, value - near.max(), near.min() - value))
        return np.array(margins)

    def errors(self, time, x, folder):
        """By how much pyfunnel finds the samples outside."""
        status = pyfunnel.compareAndReport(
            self.time, self.values, time, x, outputDirectory=str(folder / "funnel"), atolx=self.w, atoly=self.d,
        )
        assert status == 0
        errors = csv_record.read(folder / "funnel/errors.csv")
        assert np.array_equal(errors["x"], time)
        return errors["y"]


def smooth(draw):
    """A function of time that is 0 at 0: a sum of three oscillations."""
    amplitudes, rates, phases = draw.uniform(0.2, 1, 3), draw.uniform(0.1, 1.2, 3), draw.uniform(0, 6, 3)

    def value(time):
        shape = np.sin(np.multiply.outer(time, rates) + phases) - np.sin(phases)
        return shape @ amplitudes

    return value


def close_reference(draw, function, widest_s, begin, end):
    """A reference that is shifted a little against the samples; d is a little more or less than it takes to hold."""
    rows = int(draw.integers(20, 300))
    inner = draw.uniform(begin, end, rows) if draw.random() < 0.5 else np.linspace(begin, end, rows)
    inner = np.unique(np.round(inner, 3))
    time = np.concatenate([[begin], inner[(inner > begin) & (inner < end)], [end]])
    w = round(draw.uniform(0.05, 1) * widest_s, 6)
    values = function(time + draw.uniform(-1.2, 1.2) * max(w, 0.2)) + draw.normal(0, 0.05)
    reference = Reference(time, values, w)
    samples = np.arange(STOP_S + 1.0)
    needed = -np.min(reference.margins(samples, function(samples)))
    factor = 1 + draw.choice([-1, 1]) * 10 ** draw.uniform(-5, 0)
    return dataclasses.replace(reference, d=float(max(needed * factor, 1e-3)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory, root):
    """A folder with the unit `foreign.fmu`."""
    folder = tmp_path_factory.mktemp("references")
    foreign.pack(root, folder)
    return folder


def judged(lockstep, folder, function, references):
    """Runs the claims of the references; returns what Lockstep says of them and the recorded samples."""
    time = np.arange(STOP_S + 1.0)
    (folder / "driven.csv").write_text(csv_record.text({"time": time, "u": function(time + 1)}))
    claims = []
    for number, reference in enumerate(references):
        file = f"reference{number}.csv"
        (folder / file).write_text(csv_record.text({"time": reference.time, "c [1]": reference.values}))
        claims.append(f"assert c{number}: {reference.claim(file, begins=number % 2 == 1)}")
    (folder / "claims.scn").write_text(SCRIPT.format(stop=STOP_S, claims="\n".join(claims)))
    run = lockstep("run", folder / "claims.scn", "--json", "--out", folder / "run", "--format", "csv")
    assert run.returncode in (0, 1), run.stderr
    record = csv_record.read(folder / "run/trace.csv")
    assert np.allclose(record["x"], function(time), rtol=0, atol=1e-12)
    return json.loads(run.stdout)["claims"], record["time"], record["x"]


def deviations(claims, references, time, x):
    """Numbers of the claims that are judged otherwise than by the direct computation, or at another time."""
    found = []
    for number, (claim, reference) in enumerate(zip(claims, references, strict=True)):
        margins = reference.margins(time, x)
        worst, at = margins.min(), margins[time == claim["at_s"]]
        same_margin = np.allclose([claim["margin"], *at], worst, rtol=ROUNDING, atol=ROUNDING)
        if not same_margin or (claim["verdict"] == "ok") != (worst >= 0):
            found.append(number)
    return found


@pytest.mark.parametrize("widest_s", [0, 3], ids=["without a tolerance of time", "with a tolerance of time"])
def test_a_smooth_reference_is_judged_as_by_pyfunnel_and_by_a_direct_computation(lockstep, folder, widest_s):
    lost = []
    for seed in range(20):
        draw = np.random.default_rng(seed)
        function = smooth(draw)
        references = [close_reference(draw, function, widest_s, 0.0, STOP_S) for _ in range(REFERENCES)]
        claims, time, x = judged(lockstep, folder, function, references)
        assert deviations(claims, references, time, x) == []
        for claim, reference in zip(claims, references):
            error = reference.errors(time, x, folder).max()
            assert np.isclose(error, max(0.0, -claim["margin"]), rtol=0, atol=ROUNDING)
            assert abs(claim["margin"]) > ROUNDING, "too near the border for pyfunnel to tell"
            assert (claim["verdict"] == "ok") == (error == 0)
            lost.append(claim["verdict"] == "failed")
    assert len(lost) == 400 and 0.4 < np.mean(lost) < 0.6


@pytest.mark.parametrize("widest_s", [0, 3], ids=["without a tolerance of time", "with a tolerance of time"])
@pytest.mark.parametrize("begin, end", [(7.3, 48.6), (-5.0, 70.0)], ids=["shorter than the run", "longer than the run"])
def test_the_ends_of_a_reference_are_held(lockstep, folder, begin, end, widest_s):
    draw = np.random.default_rng(1)
    function = smooth(draw)
    references = [close_reference(draw, function, widest_s, begin, end) for _ in range(REFERENCES)]
    claims, time, x = judged(lockstep, folder, function, references)
    assert deviations(claims, references, time, x) == []


def test_pyfunnel_and_the_direct_computation_agree_with_a_tolerance_of_time(tmp_path):
    time = np.arange(STOP_S + 1.0)
    for seed in range(400):
        draw = np.random.default_rng(seed)
        function = smooth(draw)
        reference = close_reference(draw, function, 3, 0.0, STOP_S)
        errors, margins = reference.errors(time, function(time), tmp_path), reference.margins(time, function(time))
        assert np.allclose(errors, np.maximum(0, -margins), rtol=0, atol=ROUNDING)


def test_a_changed_row_of_a_reference_is_a_deviation_and_an_error_in_pyfunnel(lockstep, folder):
    draw = np.random.default_rng(2)
    function = smooth(draw)
    references = [close_reference(draw, function, 0, 0.0, STOP_S) for _ in range(REFERENCES)]
    claims, time, x = judged(lockstep, folder, function, references)
    number = next(number for number, claim in enumerate(claims) if claim["verdict"] == "ok")
    values = references[number].values.copy()
    row = len(values) // 2
    values[max(row - 20, 0) : row + 20] += 2 * references[number].d
    changed = [*references[:number], dataclasses.replace(references[number], values=values), *references[number + 1 :]]
    assert deviations(claims, changed, time, x) == [number]
    assert changed[number].errors(time, x, folder).max() > 0
