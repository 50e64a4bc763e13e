"""`lockstep run` and a loop that is wired by hand over FMPy agree in every column, at every step, to the last bit."""

import numpy as np
import pytest

import closed_loop
import csv_record

TICKS = 16800


@pytest.fixture(scope="module")
def flight(archives):
    """The whole flight A to H in Python."""
    return closed_loop.fly(archives, TICKS)


def test_the_flight_wired_by_hand_tracks_tilts_and_lands(flight):
    error = [flight[f"quad.state.position.{a}"] - flight[f"path.setpoint.position.{a}"] for a in "xyz"]
    assert 0.2 < np.max(np.linalg.norm(error, axis=0)) < 0.8
    assert np.max(np.abs([flight["quad.roll"], flight["quad.pitch"]])) < np.radians(25)
    assert np.any(flight["path.finished"] & (flight["quad.height"] < 0.1))
    assert np.std(flight["air.speed"]) > 0.1


def test_the_trace_of_a_run_is_the_flight_wired_by_hand_bit_for_bit(fly, flight):
    run, folder = fly("scenarios/first_flight.scn")
    assert run.returncode == 0, run.stderr
    trace = csv_record.read(folder / "trace.csv")
    assert csv_record.same_bits(trace["time"], flight["time"])
    assert len(trace) > 40
    assert [name for name in trace if not csv_record.same_bits(trace[name], flight[name])] == []
