"""Reference runs of the units: `python tests/python/references.py FMUS --write` writes their input and result records.

An input record has one row for each communication step, at the float that FMPy computes for its time, so that no
importer interpolates. Every nth row of the result is kept, including the last one; n is such that at most 501 are kept.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np

import csv_record
from instance import Archive, Instance

FMUS = Path(__file__).resolve().parents[2] / "fmus"
MOST_ROWS = 501
WIND_AT_20_FT = 3.0


def simulated(archive, inputs=None):
    """The unit's outputs as FMPy computes them at the step of its default experiment: columns by name."""
    result = fmpy.simulate_fmu(
        str(archive.path), stop_time=archive.stop, output_interval=archive.step, validate=True,
        input=None if inputs is None else csv_record.for_fmpy(typed(archive, inputs)),
        output=archive.names("output"),
    )
    ticks = len(result) - 1
    kept = next(n for n in range(1, ticks + 1) if ticks % n == 0 and ticks // n < MOST_ROWS)
    return {name: result[name][::kept] for name in ["time", *archive.names("output")]}


def typed(archive, inputs):
    """The columns of a record, converted to the types of the variables."""
    whole = ("Integer", "Boolean", "Enumeration")
    kinds = {name: int if name != "time" and archive.variables[name].type in whole else float for name in inputs}
    return {name: np.asarray(column).astype(kinds[name]) for name, column in inputs.items()}


def instants(archive):
    """Communication points as FMPy computes them."""
    return np.arange(round(archive.stop / archive.step) + 1) * archive.step


def rest_to_rest(t):
    """Position, velocity and acceleration of a move from 0 to 1 in unit time, held before and after."""
    t = np.clip(t, 0.0, 1.0)
    return (
        t**3 * (10 - 15 * t + 6 * t**2), 30 * t**2 * (1 - t) ** 2, 60 * t * (1 - t) * (1 - 2 * t),
    )


def setpoint(t):
    """A setpoint for ten seconds: up to 1.5 m in three seconds, then to the side and back while the heading turns."""
    rise, sink, along, across = (rest_to_rest(x) for x in (t / 3, (t - 7.5) / 2.5, (t - 2) / 4, (t - 4) / 5))
    columns = {}
    for order, name in enumerate(("position", "velocity", "acceleration")):
        moves = zip((rise, sink, along, across), (3, 2.5, 4, 5))
        up, down, forward, left = (part[order] / span**order for part, span in moves)
        columns |= {
            f"setpoint.{name}.x": 3 * forward - 1 * left, f"setpoint.{name}.y": 2 * left,
            f"setpoint.{name}.z": 1.5 * up - 1.2 * down,
        }
    return columns | {"setpoint.yaw": 0.8 * along[0] - 1.5 * across[0]}


def breeze(t):
    """Wind with varying speed, direction and vertical component."""
    return {"wind.x": 2.5 * np.sin(0.9 * t), "wind.y": 1.5 + np.cos(1.7 * t), "wind.z": 0.4 * np.sin(3.1 * t)}


def rounded(columns, digits):
    return {name: np.round(column, digits) for name, column in columns.items()}


def row(columns, k):
    return {name: column[k] for name, column in columns.items()}


def controlled_quadcopter(quadcopter, controller):
    """Inputs and states of a quadcopter under its controller, and the setpoints; one rotor is weaker for a second."""
    time = instants(quadcopter)
    given = rounded(breeze(time), 3) | {f"effectiveness[{i}]": np.ones(len(time)) for i in range(1, 5)}
    given["effectiveness[3]"] = np.round(1 - 0.06 * ((time > 5) & (time < 6)), 2)
    setpoints = rounded(setpoint(time), 6)
    members = quadcopter.group("state")
    commands, states = [], []
    with Instance(quadcopter, "quad") as quad, Instance(controller, "ctrl") as ctrl:
        quad.initialize(row(given, 0))
        ctrl.initialize()
        for k, now in enumerate(time):
            states.append(list(quad.get([f"state{member}" for member in members]).values()))
            seen = {f"state{member}": value for member, value in zip(members, states[-1])}
            ctrl.set(seen | row(setpoints, k))
            ctrl.step(now, controller.step)
            command = ctrl.get([f"rotor_speed[{i}]" for i in range(1, 5)])
            commands.append([round(value, 3) for value in command.values()])
            quad.set(dict(zip(command, commands[-1])) | row(given, k))
            quad.step(now, quadcopter.step)
    rotors = {f"rotor_speed[{i + 1}]": column for i, column in enumerate(np.array(commands).T)}
    motion = {f"state{member}": column for member, column in zip(members, np.array(states).T)}
    return {"time": time} | rotors | given, motion, setpoints


def inputs_of_quadcopter(archives):
    """Take-off from the ground, turning and drifting in a changing wind, one rotor weaker for a second."""
    return controlled_quadcopter(archives["quadcopter"], archives["quadcopter_controller"])[0]


def inputs_of_controller(archives):
    """The same motion as inputs of the controller, with an added oscillation and inputs that mode q2 does not use."""
    archive = archives["quadcopter_controller"]
    time = instants(archive)
    _, motion, setpoints = controlled_quadcopter(archives["quadcopter"], archive)
    near = {name: column[: len(time)] for name, column in (rounded(motion, 6) | setpoints).items()}
    near["state.position.x"] = np.round(near["state.position.x"] + 0.4 * np.sin(2 * time), 6)
    unused = {"contact": near["state.position.z"] <= 0, "wind_speed": np.round(2 + np.sin(time), 3)}
    healthy = {f"effectiveness[{i}]": np.ones(len(time)) for i in range(1, 5)}
    return {"time": time} | near | unused | healthy


def inputs_of_wind(archives):
    """A vehicle that climbs in a wind that turns; the tunable parameter `turbulence` is part of the record."""
    time = instants(archives["wind"])
    vehicle = {
        "vehicle.position.x": 2 * time, "vehicle.position.y": 3 * np.sin(0.5 * time),
        "vehicle.position.z": 0.3 * time**2, "vehicle.velocity.x": 0 * time + 2,
        "vehicle.velocity.y": 1.5 * np.cos(0.5 * time), "vehicle.velocity.z": 0.6 * time,
    }
    mean = {"mean.x": 4 * np.cos(0.3 * time), "mean.y": 4 * np.sin(0.3 * time), "mean.z": 0.1 * np.sin(time)}
    return {"time": time} | rounded(vehicle | mean, 4) | {"turbulence": 0 * time + WIND_AT_20_FT}


INPUTS = {
    "quadcopter": inputs_of_quadcopter,
    "quadcopter_controller": inputs_of_controller,
    "wind": inputs_of_wind,
}


def read(name):
    """Input record, None without inputs, and expected result of a unit of this repository."""
    inputs = FMUS / name / "reference_in.csv"
    return csv_record.read(inputs) if inputs.exists() else None, csv_record.read(FMUS / name / "reference.csv")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmus", type=Path, help="folder of packed units")
    parser.add_argument("--write", action="store_true", help="write the records; otherwise only say what would change")
    arguments = parser.parse_args()
    with TemporaryDirectory() as folder:
        paths = sorted(arguments.fmus.glob("*.fmu"))
        archives = {path.stem: Archive(path, Path(folder) / path.stem) for path in paths}
        for name, archive in archives.items():
            inputs = INPUTS[name](archives) if name in INPUTS else None
            texts = {"reference_in.csv": csv_record.text(typed(archive, inputs))} if inputs else {}
            texts["reference.csv"] = csv_record.text(simulated(archive, inputs))
            for file, text in texts.items():
                path = FMUS / name / file
                changed = not path.exists() or path.read_text() != text
                print(f"{path.relative_to(FMUS.parent)}: {'changed' if changed else 'as before'}, {len(text)} bytes")
                if changed and arguments.write:
                    path.write_text(text)


if __name__ == "__main__":
    main()
