"""A second implementation of the equations in Python, in the frames of the papers, gives the results of the units."""

import math

import fmpy
import numpy as np
import pytest

import closed_loop
import csv_record
import references
from transcription import quadcopter, wind

TOLERANCE = 1e-6


def agree(ours, theirs):
    """Asserts that all outputs agree at all rows, to an absolute tolerance for each unit of measure."""
    names = [name for name in theirs if name != "time"]
    assert set(names) == set(ours) - {"time"}
    worst = {name: np.max(np.abs(np.asarray(ours[name], float) - np.asarray(theirs[name], float))) for name in names}
    assert {name: error for name, error in worst.items() if not error < TOLERANCE} == {}


def simulated(archive, inputs, parameters):
    """Simulates the unit with the same inputs in FMPy; outputs at every communication point."""
    items = {n: archive.item(n, v) for n, v in parameters.items() if archive.variables[n].type == "Enumeration"}
    result = fmpy.simulate_fmu(
        str(archive.path), stop_time=inputs["time"][-1], output_interval=archive.step, start_values=parameters | items,
        input=csv_record.for_fmpy(references.typed(archive, inputs)), output=archive.names("output"),
    )
    return {name: result[name] for name in ["time", *archive.names("output")]}


def thinned(columns, rows):
    every = (len(columns["time"]) - 1) // (rows - 1)
    return {name: column[::every] for name, column in columns.items()}


def test_the_quadcopter_follows_its_equations_over_its_reference(archives):
    inputs, expected = references.read("quadcopter")
    ours = quadcopter.simulate(inputs, {}, archives["quadcopter"].step)
    agree(thinned(ours, len(expected["time"])), expected)


@pytest.mark.parametrize("parameters", [
    {"rotor_model": "paper", "ground_effect": False, "yaw0": 2.0, "position0.z": 30.0, "airborne": True},
    {"rotor_model": "kw2", "ground_turbulence": 0.0, "mass": 0.7, "velocity0.x": 1.0, "position0.z": 20.0},
    {"seed": 77, "stream": 9, "ground_turbulence": 0.2, "inertia.x": 9e-3, "drag_coefficient": 1.3},
], ids=["as the paper prints it", "thrust by speed alone", "another airframe"])
def test_the_quadcopter_follows_its_equations_with_other_parameters(archives, parameters):
    inputs = {name: column[:401] for name, column in references.read("quadcopter")[0].items()}
    archive = archives["quadcopter"]
    agree(quadcopter.simulate(inputs, parameters, archive.step), simulated(archive, inputs, parameters))


def test_the_quadcopter_follows_its_equations_in_a_closed_loop_with_all_effects(archives):
    """Turbulent wind, a rotor that loses thrust, ground turbulence, and a low flight with a hard landing."""
    values = closed_loop.FIRST_FLIGHT | {"path": {"height": 1.2, "speed": 6.0}, "air": {
        "mean.x": 2.0, "mean.y": 3.0, "turbulence": 6.0, "profile": "log", "seed": 5,
        "gust_count": 1, "gust[1].start": 4.0, "gust[1].duration": 3.0, "gust[1].amplitude": 4.0,
    }}

    def weak(t):
        return {"effectiveness[2]": 0.9 if 8.0 < t < 11.0 else 1.0, "effectiveness[4]": 0.3 if t > 18.0 else 1.0}

    ticks = 4000
    record = closed_loop.simulate(archives, ticks, values, weak)
    columns = {name.removeprefix("quad."): column for name, column in record.items() if name.startswith("quad.")}
    outputs = archives["quadcopter"].names("output")
    inputs = {"time": record["time"]} | {name: column for name, column in columns.items() if name not in outputs}
    assert columns["contact"].any() and not columns["contact"].all() and columns["height"].max() > 1.0
    agree(quadcopter.simulate(inputs, {}, closed_loop.seconds(1)), {name: columns[name] for name in outputs})


def test_the_wind_follows_its_equations_over_its_reference(archives):
    inputs, expected = references.read("wind")
    parameters = {"turbulence": references.WIND_AT_20_FT}
    agree(thinned(wind.simulate(inputs, parameters, archives["wind"].step), len(expected["time"])), expected)


@pytest.mark.parametrize("sample_time", [0.01, 0.025, 0.003])
def test_the_wind_follows_its_equations_with_profile_and_gusts(archives, sample_time):
    inputs = {name: column for name, column in references.read("wind")[0].items() if name != "turbulence"}
    parameters = {
        "turbulence": 9.0, "profile": "log", "roughness": 0.3, "sample_time": sample_time, "seed": 12, "stream": 3,
        "gust_count": 2, "gust[1].start": 1.0, "gust[1].duration": 4.0, "gust[1].amplitude": 5.0,
        "gust[1].direction": math.radians(130), "gust[2].start": 3.0, "gust[2].duration": 0.5,
        "gust[2].amplitude": -8.0, "gust[2].direction": 1.0, "gust[3].duration": 9.0, "gust[3].amplitude": 50.0,
    }
    archive = archives["wind"]
    agree(wind.simulate(inputs, parameters, archive.step), simulated(archive, inputs, parameters))


def test_a_small_mistake_in_an_equation_is_detected(archives):
    inputs, expected = references.read("wind")
    parameters = {"turbulence": references.WIND_AT_20_FT * (1 + 1e-5)}
    mistaken = thinned(wind.simulate(inputs, parameters, archives["wind"].step), len(expected["time"]))
    with pytest.raises(AssertionError):
        agree(mistaken, expected)
