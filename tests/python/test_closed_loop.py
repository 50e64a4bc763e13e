"""`lockstep run` and a loop that is connected by hand with FMPy agree in every column and step to the last bit."""

import numpy as np
import pytest

import closed_loop
import csv_record

TICKS = 16800


@pytest.fixture(scope="module")
def simulated(archives):
    """The whole flight A to H, simulated in Python."""
    return closed_loop.simulate(archives, TICKS)


def test_the_loop_connected_by_hand_tracks_the_setpoint_tilts_and_lands(simulated):
    error = [simulated[f"quad.state.position.{a}"] - simulated[f"path.setpoint.position.{a}"] for a in "xyz"]
    assert 0.2 < np.max(np.linalg.norm(error, axis=0)) < 0.8
    assert np.max(np.abs([simulated["quad.roll"], simulated["quad.pitch"]])) < np.radians(25)
    assert np.any(simulated["path.finished"] & (simulated["quad.height"] < 0.1))
    assert np.std(simulated["air.speed"]) > 0.1


def test_the_trace_of_a_run_equals_the_loop_connected_by_hand_bit_for_bit(run_scenario, simulated):
    run, folder = run_scenario("scenarios/first_flight.scn")
    assert run.returncode == 0, run.stderr
    trace = csv_record.read(folder / "trace.csv")
    assert csv_record.same_bits(trace["time"], simulated["time"])
    assert len(trace) > 40
    assert [name for name in trace if not csv_record.same_bits(trace[name], simulated[name])] == []
