"""Records of signals over time as CSV: `time` first, bare names, shortest decimals that read back to the same bits."""

import csv

import numpy as np


def read(path):
    """Columns by name, as floats."""
    with open(path, newline="") as file:
        names, *rows = csv.reader(file)
    return {name: np.array([float(row[i]) for row in rows]) for i, name in enumerate(names)}


def text(columns):
    """Text of the file for columns by name; Booleans as 0 and 1."""
    rows = zip(*([shortest(value) for value in np.asarray(column).tolist()] for column in columns.values()))
    lines = [",".join(f'"{name}"' if "," in name else name for name in columns), *(",".join(row) for row in rows)]
    return "\n".join(lines) + "\n"


def shortest(value):
    return str(int(value)) if isinstance(value, bool) else repr(value).removesuffix(".0")


def for_fmpy(columns):
    """The structured array that FMPy takes as input."""
    kinds = [(name, np.asarray(column).dtype) for name, column in columns.items()]
    return np.array(list(zip(*columns.values())), dtype=kinds)


def same_bits(a, b):
    """Whether two columns have the same numbers to the last bit."""
    return np.asarray(a, float).tobytes() == np.asarray(b, float).tobytes()
