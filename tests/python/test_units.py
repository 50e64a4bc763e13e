"""Tests of every unit of this repository with FMPy."""

import ctypes
import gc
import math
import re
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
DISCARD = 2
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
        with pytest.raises(FMICallException) as refusal:
            instance.set({name: value})
        assert refusal.value.status == DISCARD
        assert instance.get([name]) == {name: 0.25}
        assert any(name in message for message in instance.messages)
        instance.initialize()
        instance.step(0.0, unit.step)


def test_unloading_a_unit_leaves_no_memory(unit):
    """200 cycles as a parameter study in FMPy makes; without the unit's own part a cycle of FMPy leaves nothing either."""
    def cycles(number):
        for _ in range(number):
            with Instance(unit) as instance:
                instance.initialize()
                instance.step(0.0, unit.step)
        gc.collect()

    cycles(20)
    before = heap_in_use()
    cycles(200)
    assert heap_in_use() - before < 200 * 200, "bytes after 200 cycles"


def heap_in_use():
    """Bytes that the C library's allocator has given out, by glibc's `mallinfo2`."""
    names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()
    information = type("mallinfo2", (ctypes.Structure,), {"_fields_": [(name, ctypes.c_size_t) for name in names]})
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = information
    found = mallinfo2()
    return found.uordblks + found.hblkhd


def test_a_unit_says_who_made_it_and_when(unit):
    description = unit.description
    assert (description.author, description.license) == ("The Lockstep developers", "MIT OR Apache-2.0")
    assert description.copyright == "Copyright The Lockstep developers"
    assert description.generationDateAndTime == "1980-01-01T00:00:00Z"


def test_thrust_follows_the_effectiveness_of_the_rotors_between_steps(archives):
    with Instance(archives["quadcopter"]) as quad:
        quad.initialize({"airborne": True})
        quad.step(0.0, 0.005)
        before = quad.get(["thrust", "state.position.z"])
        quad.set({f"effectiveness[{rotor}]": 0.0 for rotor in range(1, 5)})
        assert before["thrust"] > 1.0
        assert quad.get(["thrust", "state.position.z"]) == {"thrust": 0.0, "state.position.z": before["state.position.z"]}


def test_the_wind_follows_its_mean_between_steps(archives):
    with Instance(archives["wind"]) as wind:
        wind.initialize({"mean.x": 3.0})
        wind.step(0.0, 0.01)
        wind.set({"mean.x": 5.0, "mean.y": 12.0})
        assert wind.get(["speed"]) == {"speed": 13.0}


def test_turbulence_at_the_ground_is_the_same_at_every_communication_step(archives):
    """The inner steps of 2.5 ms are the same too, so that all bits are."""
    def flight(step):
        with Instance(archives["quadcopter"]) as quad:
            quad.initialize({"seed": 7, "ground_turbulence": 0.3} | {f"rotor_speed[{rotor}]": 250.0 for rotor in range(1, 5)})
            for k in range(round(0.4 / step)):
                quad.step(k * step, step)
            return quad.get(archives["quadcopter"].names("output"))

    flights = [flight(step) for step in (0.0025, 0.005, 0.01, 0.02, 0.1)]
    assert flights[0]["height"] > 0.0
    assert flights[1:] == flights[:1] * 4


def test_a_state_that_is_not_finite_ends_with_a_fault_that_names_it(archives):
    with Instance(archives["quadcopter"]) as quad:
        quad.initialize({"airborne": True, "position0.z": 50.0})
        quad.set({"wind.x": 1e5})
        with pytest.raises(FMICallException):
            for k in range(1000):
                quad.step(k * 0.005, 0.005)
        said = quad.messages[-1]
        assert re.search(r"the state cannot be computed: number \d of the [a-z ]+ became (NaN|inf|-inf)$", said), said


def test_events_are_logged_where_they_are_wanted(archives):
    with Instance(archives["quadcopter"], logging=True) as quad:
        quad.initialize({f"rotor_speed[{rotor}]": 300.0 for rotor in range(1, 5)})
        for k in range(200):
            quad.step(k * 0.005, 0.005)
        assert sum("leaves the ground at" in message for message in quad.messages) == 1, quad.messages
    with Instance(archives["trajectory"], logging=True) as flight:
        flight.initialize()
        flight.step(0.0, 13.0)
        assert flight.messages == ["leg 2 begins at 13 s"]


def test_an_undeclared_variable_is_an_error_with_a_message(unit):
    with Instance(unit) as instance:
        for call, values in [("Real", [0.0]), ("Integer", [0]), ("Boolean", [0]), ("String", ["a"])]:
            said = len(instance.messages)
            with pytest.raises(FMICallException):
                getattr(instance.fmu, f"set{call}")([4_000_000_000], values)
            with pytest.raises(FMICallException):
                getattr(instance.fmu, f"get{call}")([4_000_000_000])
            assert len(instance.messages) >= said + 2
