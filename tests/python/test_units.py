"""Tests of every unit of this repository with FMPy."""

import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import fmpy.validation
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import csv_record
import references
from instance import Instance

TICKS = 400
HELD = {"trajectory": ["setpoint.yaw"]}  # the heading of the flight A to H is along x


def rows(instance, inputs, first, last):
    """Outputs after each step from one tick to another."""
    archive, outputs = instance.archive, []
    for k in range(first, last):
        if inputs:
            instance.set(references.row(inputs, k))
        instance.step(k * archive.step, archive.step)
        outputs.append(instance.outputs())
    return outputs


def inputs_of(archive):
    """The unit's input record without its times."""
    inputs, _ = references.read(archive.name)
    return inputs and {name: column for name, column in inputs.items() if name != "time"}


def begin(instance, inputs):
    """Initializes an instance at the first row of its input record."""
    return instance.initialize(references.row(inputs, 0) if inputs else {})


def run(archive):
    """Outputs of a new instance over the first ticks of the unit's input record."""
    inputs = inputs_of(archive)
    with Instance(archive) as instance:
        begin(instance, inputs)
        return [instance.outputs(), *rows(instance, inputs, 0, TICKS)]


def test_validation_finds_nothing(unit):
    assert fmpy.validation.validate_fmu(str(unit.path)) == []
    command = subprocess.run(
        [sys.executable, "-m", "fmpy", "validate", unit.path], capture_output=True, text=True, timeout=60
    )
    assert (command.returncode, command.stdout.strip(), command.stderr) == (0, "No problems found.", "")


def test_every_real_has_a_unit_of_measure(unit):
    reals = [variable for variable in unit.description.modelVariables if variable.type == "Real"]
    defined = {definition.name for definition in unit.description.unitDefinitions}
    assert reals and [variable.name for variable in reals if variable.unit not in defined] == []


def test_an_input_record_covers_every_input_at_every_communication_point(unit):
    inputs, _ = references.read(unit.name)
    assert (inputs is not None) == bool(unit.names("input"))
    if inputs:
        assert set(unit.names("input")) <= set(inputs)
        assert csv_record.same_bits(inputs["time"], references.instants(unit))


def test_fmpy_reproduces_the_reference_bit_for_bit(unit):
    inputs, expected = references.read(unit.name)
    seen = references.simulated(unit, inputs)
    assert list(seen) == list(expected) == ["time", *unit.names("output")]
    assert [name for name in seen if not csv_record.same_bits(seen[name], expected[name])] == []


def test_the_reference_exercises_every_output(unit):
    _, expected = references.read(unit.name)
    assert [name for name, column in expected.items() if np.ptp(column) == 0] == HELD.get(unit.name, [])


def test_lockstep_simulate_reproduces_the_reference_bit_for_bit(unit, lockstep, tmp_path):
    """Uses the same rows; FMPy computes time as k * step, which is not always the nearest float to the decimal time."""
    inputs, expected = references.read(unit.name)
    command = ["simulate", unit.path, "--out", tmp_path / "run"]
    if inputs:
        record = tmp_path / "inputs.csv"
        record.write_text(csv_record.text(inputs | {"time": np.round(inputs["time"], 9)}))
        command += ["--input", record]
    simulated = lockstep(*command)
    assert simulated.returncode == 0, simulated.stderr
    trace = csv_record.read(tmp_path / "run/trace.csv")
    every = (len(trace["time"]) - 1) // (len(expected["time"]) - 1)
    seen = {name: trace[name][::every] for name in expected}
    assert csv_record.same_bits(seen.pop("time"), np.round(expected["time"], 9))
    assert [name for name in seen if not csv_record.same_bits(seen[name], expected[name])] == []


def test_a_restored_state_continues_bit_for_bit(unit):
    inputs, half = inputs_of(unit), TICKS // 2
    with Instance(unit) as instance:
        begin(instance, inputs)
        rows(instance, inputs, 0, half)
        state = instance.fmu.getFMUstate()
        first = rows(instance, inputs, half, TICKS)
        instance.fmu.setFMUstate(state)
        assert rows(instance, inputs, half, TICKS) == first
        instance.fmu.freeFMUstate(state)
    assert first == run(unit)[half + 1 :]


def test_a_serialized_state_continues_in_another_instance(unit):
    inputs, half = inputs_of(unit), TICKS // 2
    with Instance(unit, "one") as one, Instance(unit, "other") as other:
        begin(one, inputs)
        rows(one, inputs, 0, half)
        state = one.fmu.getFMUstate()
        written = one.fmu.serializeFMUstate(state)
        one.fmu.freeFMUstate(state)
        first = rows(one, inputs, half, TICKS)
        for instance in (one, other):
            state = instance.fmu.deSerializeFMUstate(written)
            instance.fmu.setFMUstate(state)
            assert instance.fmu.serializeFMUstate(state) == written
            instance.fmu.freeFMUstate(state)
            assert rows(instance, inputs, half, TICKS) == first


def test_a_unit_runs_twice_in_one_process(unit):
    assert run(unit) == run(unit)


def test_instances_in_threads_are_independent(unit, monkeypatch, root):
    monkeypatch.chdir(root)  # FMPy changes the working directory while it loads: threads may leave it changed
    alone = run(unit)
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(lambda _: run(unit), range(8))) == [alone] * 8


def test_instances_in_one_thread_are_independent(unit):
    inputs, alone = inputs_of(unit), run(unit)
    with Instance(unit, "one") as one, Instance(unit, "other") as other:
        for instance in (one, other):
            begin(instance, inputs)
        late = rows(one, inputs, 0, TICKS // 2)
        for k in range(TICKS // 2):
            late += rows(one, inputs, TICKS // 2 + k, TICKS // 2 + k + 1)
            assert rows(other, inputs, k, k + 1) == alone[k + 1 : k + 2]
    assert late == alone[1:]


def test_a_reset_instance_runs_like_a_new_one(unit):
    inputs, new = inputs_of(unit), run(unit)
    with Instance(unit) as instance:
        begin(instance, inputs)
        rows(instance, inputs, 0, TICKS)
        instance.fmu.reset()
        begin(instance, inputs)
        assert [instance.outputs(), *rows(instance, inputs, 0, TICKS)] == new


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused_by_name_and_the_old_one_stays(unit, value):
    name = next(n for n in unit.names("input") or unit.names("parameter") if unit.variables[n].type == "Real")
    with Instance(unit) as instance:
        instance.set({name: 0.25})
        with pytest.raises(FMICallException):
            instance.set({name: value})
        assert instance.get([name]) == {name: 0.25}
        assert any(name in message for message in instance.messages)


def test_an_undeclared_variable_is_an_error_with_a_message(unit):
    with Instance(unit) as instance:
        for call, values in [("Real", [0.0]), ("Integer", [0]), ("Boolean", [0]), ("String", ["a"])]:
            said = len(instance.messages)
            with pytest.raises(FMICallException):
                getattr(instance.fmu, f"set{call}")([4_000_000_000], values)
            with pytest.raises(FMICallException):
                getattr(instance.fmu, f"get{call}")([4_000_000_000])
            assert len(instance.messages) >= said + 2
