"""Units of other tools: one that `pythonfmu` writes during the test, one in C that the system's compiler builds."""

import ctypes.util
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import fmpy
import fmpy.validation
import numpy as np
import pytest

import csv_record
import foreign

STEP_S = 0.125  # exact in binary, so that every importer passes the same bits

RAMP_PY = """\
from pythonfmu import Fmi2Causality, Fmi2Slave, Integer, Real


class Ramp(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.rate, self.level, self.steps = 1.0, 0.5, 0
        self.register_variable(Real("rate", causality=Fmi2Causality.input))
        self.register_variable(Real("level", causality=Fmi2Causality.output))
        self.register_variable(Integer("steps", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.level += self.rate * step_size
        self.steps += 1
        return True
"""

RAMP_SCN = """\
scenario "A ramp in Python"
step 125 ms
stop 2 s
fmu ramp = "Ramp.fmu"
time / 0.7 s -> ramp.rate
assert rises: eventually ramp.level > 3
record ramp.level, ramp.steps
"""

PROBE_SCN = """\
scenario "A unit in C"
step 125 ms
stop 2 s
fmu probe = "foreign.fmu" { gain = 1.5, label = "100 % done", enabled = false }
time / 0.7 s -> probe.u
assert follows: eventually probe.y > 1
record probe.y, probe.count
"""


@pytest.fixture(scope="module")
def ramp(tmp_path_factory):
    """A folder with `Ramp.fmu` and a scenario that runs it."""
    folder = tmp_path_factory.mktemp("ramp")
    (folder / "ramp.py").write_text(RAMP_PY)
    (folder / "ramp.scn").write_text(RAMP_SCN)
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", "ramp.py", "-d", "."]
    subprocess.run(command, cwd=folder, check=True, timeout=60, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def probe(tmp_path_factory, root):
    """A folder with `foreign.fmu` from `tests/foreign` and a scenario that runs it."""
    folder = tmp_path_factory.mktemp("probe")
    foreign.pack(root, folder)
    (folder / "probe.scn").write_text(PROBE_SCN)
    return folder


@pytest.fixture(scope="module")
def libpython():
    """Environment with libpython in LD_PRELOAD, because units of `pythonfmu` use it without linking it."""
    named = [sysconfig.get_config_var(name) for name in ("INSTSONAME", "LDLIBRARY")]
    folders = [sysconfig.get_config_var(name) for name in ("LIBDIR", "LIBPL")]
    places = [Path(folder) / name for folder in folders if folder for name in named if name and ".so" in name]
    found = next((str(place) for place in places if place.exists()), None)
    found = found or ctypes.util.find_library(f"python{sysconfig.get_python_version()}")
    if not found:
        version = sysconfig.get_python_version()
        pytest.fail(f"libpython{version}.so is missing: on Debian and Ubuntu `apt-get install libpython{version}`")
    print(f"preloading {found} for a unit of pythonfmu")
    return {"LD_PRELOAD": found, "PYTHONHOME": sys.base_prefix}


def in_fmpy(archive, outputs, input_name, logger=None, **start_values):
    """Simulates the unit in FMPy with the ramp input of the scenarios."""
    time = np.arange(17) * STEP_S
    inputs = csv_record.for_fmpy({"time": time, input_name: time / 0.7})
    return fmpy.simulate_fmu(
        str(archive), validate=False, stop_time=2.0, output_interval=STEP_S, input=inputs, output=outputs,
        start_values=start_values, logger=logger,
    )


def differing(trace, instance, result):
    """Columns of a trace that differ from FMPy's result in any bit."""
    names = [name for name in result.dtype.names if name != "time"]
    assert set(trace) == {"time", *(f"{instance}.{name}" for name in names)}
    return [name for name in names if not csv_record.same_bits(trace[f"{instance}.{name}"], result[name])]


def test_a_unit_that_misses_libpython_is_refused_with_the_name_of_the_symbol(run_scenario, ramp):
    run, _ = run_scenario(ramp / "ramp.scn")
    assert run.returncode == 3
    assert re.search("Ramp.so needs the symbol `_?Py[A-Za-z_]+`", run.stderr), run.stderr


def test_check_names_the_rules_that_a_unit_of_pythonfmu_breaks(lockstep, ramp):
    check = lockstep("check", ramp / "Ramp.fmu")
    assert check.returncode == 2
    said = check.stdout + check.stderr
    assert "`steps`" in said and "continuous" in said
    assert "InitialUnknowns" in said


def test_a_run_warns_of_broken_rules_continues_and_gives_the_numbers_of_fmpy(run_scenario, ramp, libpython):
    run, folder = run_scenario(ramp / "ramp.scn", environment=libpython)
    assert run.returncode == 0, run.stderr
    assert "warning: unit `Ramp.fmu`" in run.stderr
    result = in_fmpy(ramp / "Ramp.fmu", ["level", "steps"], "rate")
    assert result["steps"][-1] == 16
    assert differing(csv_record.read(folder / "trace.csv"), "ramp", result) == []


def test_a_unit_in_c_breaks_no_rule(lockstep, probe):
    assert fmpy.validation.validate_fmu(str(probe / "foreign.fmu")) == []
    check = lockstep("check", probe / "foreign.fmu")
    assert check.returncode == 0, check.stderr


def test_a_unit_in_c_gives_the_same_numbers_and_log_messages_in_fmpy_and_in_a_run(run_scenario, probe):
    run, folder = run_scenario(probe / "probe.scn")
    assert run.returncode == 0, run.stderr
    said = []
    result = in_fmpy(
        probe / "foreign.fmu", ["y", "count"], "u", gain=1.5, label="100 % done",
        logger=lambda _, who, status, category, text: said.append(text.decode()),
    )
    assert result["y"][-1] > 1 and result["count"][-1] == 16
    assert differing(csv_record.read(folder / "trace.csv"), "probe", result) == []
    last = said[-1]
    assert last.startswith("done after 16 steps: 1 2 3 4 5 6 7 8 ") and last.endswith("| 100 % done")
    lines = [line for line in run.stderr.splitlines() if last in line]
    assert len(lines) == 1 and "probe" in lines[0] and "2 s" in lines[0]
