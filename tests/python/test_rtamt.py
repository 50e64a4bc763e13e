"""Claims have the verdicts and margins that rtamt, an independent judge of temporal logic, computes from the trace.

Both compute with the same operations on the same numbers, so margins are equal to the last bit. Gates are +inf or -inf
in rtamt, which makes its `implies` and `until` those of Lockstep. Left out are running values and vectors, which rtamt
does not have, texts, and what `random_claims.Generator` names.
"""

import collections
import json
import math
import sys
import warnings

import numpy as np
import pytest

import csv_record
import foreign
from claim import Formula
from random_claims import OPERATORS, Generator, trace

if sys.version_info >= (3, 13):
    pytest.skip("rtamt 0.4.10 is for Python before 3.13", allow_module_level=True)
with warnings.catch_warnings(action="ignore"):
    import rtamt

SCRIPT = """\
scenario "Random claims"
step 1 s
stop {ticks} s
{end}
fmu probe = "foreign.fmu" {{ gain = 1 }}
curve("driven.csv", "u") -> probe.u
let x = probe.y as '1'
let y = curve("driven.csv", "y")
let z = curve("driven.csv", "z")
let n = probe.count
{claims}
record x, y, z, n
"""
HOLDS = {"ok": True, "untested": True, "failed": False, "unjudged": None}

Answer = collections.namedtuple("Answer", "holds margin")


class Judge:
    """What rtamt says of a claim; its formulas are read once, the one for verdicts only when a margin does not tell."""

    def __init__(self, claim, ends_early=False):
        self.claim, self.ends_early = claim, ends_early
        self.specifications = {}

    def value(self, boolean, columns, samples, grants):
        """The value at the first sample."""
        if boolean not in self.specifications:
            formula, specification = Formula(boolean, self.ends_early), rtamt.StlDiscreteTimeSpecification()
            specification.spec = self.claim.write(formula, False)
            for name in ["x", "y", "z", "n", *formula.names()]:
                specification.declare_var(name, "float")
            specification.parse()
            self.specifications[boolean] = formula, specification
        formula, specification = self.specifications[boolean]
        return specification.evaluate(columns | formula.signals(columns, samples, grants))[0][1]

    def answer(self, columns, samples, grants):
        """Verdict and margin, if what the samples leave open is granted or not."""
        margin = self.value(False, columns, samples, grants)
        return Answer((margin or self.value(True, columns, samples, grants)) > 0, margin)

    def of_whole(self, columns):
        return self.answer(columns, len(columns["time"]), grants=False)

    def of_part(self, columns, ticks):
        """A run that ended before its stop time: what it leaves open is denied, then granted; equal verdicts decide."""
        samples = len(columns["time"])
        longer = {name: column + [0.0] * (ticks + 1 - samples) for name, column in columns.items()}
        longer["time"] = list(range(ticks + 1))
        worst = self.answer(longer, samples, grants=False)
        if worst.holds:
            return worst
        best = self.answer(longer, samples, grants=True)
        return Answer(None, None) if best.holds else best


def answers(verdicts):
    """What Lockstep says of the claims in `verdict.json`; an infinite margin is not a number there."""
    for claim in verdicts["claims"]:
        holds, margin = HOLDS[claim["verdict"]], claim["margin"]
        if holds is None:
            yield Answer(None, None)
        else:
            yield Answer(holds, (math.inf if holds else -math.inf) if margin is None else margin)


def differences(claims, ours, theirs):
    """Claims that are judged differently, with both answers."""
    return [
        f"{claim.script}: {one}, rtamt {other}"
        for claim, one, other in zip(claims, ours, theirs, strict=True) if one != other
    ]


class Run:
    """A run of a script with the claims over driven columns: the answers of Lockstep and the recorded columns."""

    def __init__(self, lockstep, folder, claims, driven, end=""):
        (folder / "driven.csv").write_text(csv_record.text(
            {name if name == "time" else f"{name} [1]": column for name, column in driven.items()}
        ))
        lines = "\n".join(f"assert c{number}: {claim.script}" for number, claim in enumerate(claims))
        text = SCRIPT.format(ticks=len(driven["time"]) - 1, end=end, claims=lines)
        (folder / "claims.scn").write_text(text)
        run = lockstep("run", folder / "claims.scn", "--json", "--out", folder / "run", "--format", "csv")
        assert run.returncode in (0, 1, 4), run.stderr
        self.answers = list(answers(json.loads(run.stdout)))
        record = csv_record.read(folder / "run/trace.csv")
        assert csv_record.same_bits(record["y"], driven["y"][: len(record["y"])])
        assert np.allclose(record["x"][1:], driven["u"][: len(record["x"]) - 1], rtol=0, atol=1e-12)
        self.columns = {name: column.tolist() for name, column in record.items()}


@pytest.fixture(scope="module")
def folder(tmp_path_factory, root):
    """A folder with the unit `foreign.fmu`."""
    folder = tmp_path_factory.mktemp("claims")
    foreign.pack(root, folder)
    return folder


def shares(results):
    """Shares of answers that hold, that are finite, and that are 0."""
    margins = np.array([answer.margin for answer in results if answer.margin is not None])
    holding = sum(answer.holds is True for answer in results)
    return holding / len(results), np.isfinite(margins).sum() / len(results), (margins == 0).sum() / len(results)


def test_ten_thousand_random_claims_have_the_verdicts_and_margins_of_rtamt(lockstep, folder):
    found, results, operators = [], [], set()
    for script in range(25):
        ticks, grain = 19 + script // 2, 0.5 if script % 2 else None
        generator = Generator(script, ticks, grain)
        claims = [generator.claim() for _ in range(100)]
        judges = [Judge(claim) for claim in claims]
        for number in range(4):
            run = Run(lockstep, folder, claims, trace(4 * script + number, ticks, grain))
            found += differences(claims, run.answers, (judge.of_whole(run.columns) for judge in judges))
            results += run.answers
        operators = operators.union(*(claim.operators for claim in claims))
    assert found == []
    assert len(results) == 10_000 and operators == OPERATORS
    holding, finite, zero = shares(results)
    assert 0.3 < holding < 0.7 and finite > 0.6 and zero > 0.01


def test_claims_of_runs_that_end_early_have_the_verdicts_and_margins_of_rtamt_or_are_unjudged(lockstep, folder):
    found, results = [], []
    for script in range(20):
        ticks, grain = 8 + script // 2, 0.5 if script % 2 else None
        generator = Generator(1000 + script, ticks, grain, ends_early=True)
        claims = [generator.claim() for _ in range(50)]
        end = f"stop when n >= {ticks - 1 - script % 5}"
        run = Run(lockstep, folder, claims, trace(1000 + script, ticks, grain), end)
        assert len(run.columns["time"]) == ticks - script % 5
        found += differences(claims, run.answers, (Judge(claim, True).of_part(run.columns, ticks) for claim in claims))
        results += run.answers
    assert found == []
    holding, finite, _ = shares(results)
    unjudged = sum(answer.holds is None for answer in results) / len(results)
    assert 0.2 < holding < 0.7 and finite > 0.6 and unjudged > 0.03


@pytest.fixture(scope="module")
def sample(folder):
    """A hundred claims, and the columns to drive a run with."""
    generator = Generator(7, 30, None)
    return [generator.claim() for _ in range(100)], trace(7, 30, None)


def test_a_changed_margin_and_a_changed_verdict_are_differences(lockstep, folder, sample):
    claims, driven = sample
    run = Run(lockstep, folder, claims, driven)
    theirs = [Judge(claim).of_whole(run.columns) for claim in claims]
    assert differences(claims, run.answers, theirs) == []
    finite = next(number for number, answer in enumerate(run.answers) if math.isfinite(answer.margin))
    holds, margin = run.answers[finite]
    for planted in (Answer(holds, margin * (1 + 1e-9)), Answer(not holds, margin)):
        changed = [*run.answers[:finite], planted, *run.answers[finite + 1 :]]
        assert len(differences(claims, changed, theirs)) == 1


def test_a_changed_sample_changes_margins_of_rtamt(lockstep, folder, sample):
    claims, driven = sample
    run = Run(lockstep, folder, claims, driven)
    changed = {name: list(column) for name, column in run.columns.items()}
    changed["y"][0] += 1e-6
    assert differences(claims, run.answers, [Judge(claim).of_whole(changed) for claim in claims]) != []
