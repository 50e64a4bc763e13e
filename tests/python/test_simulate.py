"""`lockstep simulate` with input rows farther apart than steps gives the same bits as FMPy's simulate_fmu."""

import fmpy
import numpy as np

import csv_record
import references

STEP = 1 / 128  # a whole number of nanoseconds and of binary digits: both tools compute the same instants
STOP = 2.0


JUMP = 0.75  # at a communication point, where FMPy needs no step of its own for it


def table(unit):
    """Every twentieth row of the unit's input record, continuous inputs only; they jump once."""
    inputs, _ = references.read(unit.name)
    continuous = [name for name in inputs or {} if name != "time" and unit.variables[name].variability == "continuous"]
    if not continuous:
        return {"time": np.zeros(1)}
    rows = {name: np.array(inputs[name][:300:20]) for name in ["time", *continuous]}
    at = np.argmax(rows["time"] > JUMP)
    rows["time"][at] = JUMP
    return {name: np.insert(column, at, column[at] if name == "time" else 0.0) for name, column in rows.items()}


def test_between_rows_inputs_are_interpolated_as_in_fmpy(unit, lockstep, tmp_path):
    inputs, outputs = table(unit), unit.names("output")
    path = tmp_path / "in.csv"
    path.write_text(csv_record.text(inputs))
    run = lockstep(
        "simulate", unit.path, "--stop", f"{STOP}s", "--step", "7.8125ms", "--input", path, "--out", tmp_path / "run",
        "--output", tmp_path / "out.csv",
    )
    assert run.returncode == 0, run.stderr
    ours = csv_record.read(tmp_path / "out.csv")
    theirs = fmpy.simulate_fmu(
        str(unit.path), stop_time=STOP, output_interval=STEP, input=csv_record.for_fmpy(inputs), output=outputs,
    )
    moving = {name for name in unit.names("input") if np.ptp(ours[name]) > 0}
    assert len(inputs) == 1 or moving >= set(list(inputs)[1:3]), "the table drives nothing"
    assert [name for name in ["time", *outputs] if not csv_record.same_bits(ours[name], theirs[name])] == []


def test_a_bare_value_is_in_the_variables_own_unit_as_in_fmpy(archives, lockstep, tmp_path):
    unit = archives["wind"]
    run = lockstep(
        "simulate", unit.path, "--stop", "1s", "--step", "7.8125ms", "--out", tmp_path / "run",
        "--set", "turbulence = 4", "--set", "seed = 11", "--set", "vehicle.position.z = 12 ft",
    )
    assert run.returncode == 0, run.stderr
    ours = csv_record.read(tmp_path / "run" / "trace.csv")
    theirs = fmpy.simulate_fmu(
        str(unit.path), stop_time=1.0, output_interval=STEP, output=unit.names("output"),
        start_values={"turbulence": 4.0, "seed": 11, "vehicle.position.z": 12 * 0.3048},
    )
    assert [name for name in unit.names("output") if not csv_record.same_bits(ours[name], theirs[name])] == []
    assert np.ptp(ours["speed"]) > 0
