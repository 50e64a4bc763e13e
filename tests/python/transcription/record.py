"""Reads input records for the transcriptions, and completes parameters by their start values."""

import numpy as np


def held_input(inputs, name, start, instants):
    """Value of an input at the start of each step: linear between the rows of the record, `start` if it has none."""
    if name not in inputs:
        return np.full(len(instants), float(start))
    return np.interp(instants, np.asarray(inputs["time"], float), np.asarray(inputs[name], float))


def instants(inputs, step):
    """Communication points from the first row of the record to its last, as tick times step."""
    time = np.asarray(inputs["time"], float)
    ticks = int(np.floor((time[-1] - time[0]) / step + 1e-9))
    return time[0] + np.arange(ticks + 1) * step


def with_start_values(start_values, parameters):
    """Parameters completed by start values; an unknown name is an error."""
    unknown = sorted(set(parameters) - set(start_values))
    if unknown:
        raise KeyError(f"no such parameter: {', '.join(unknown)}")
    return {**start_values, **parameters}
