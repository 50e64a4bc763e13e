"""The closed loop of `scenarios/first_flight.scn`, connected by hand with FMPy's own fmi2 calls."""

import math
from contextlib import ExitStack

import numpy as np

from instance import Instance

STEP_NS = 5_000_000
FIRST_FLIGHT = {
    "path": {},
    "air": {"mean.x": 0.0, "mean.y": 3.5, "mean.z": 0.0, "turbulence": 3.5, "seed": 1},
    "ctrl": {"tilt_max": math.radians(25.0)},
    "quad": {"seed": 1},
}
UNITS = {"path": "trajectory", "air": "wind", "ctrl": "quadcopter_controller", "quad": "quadcopter"}


def seconds(tick):
    """Time of a tick, computed from whole nanoseconds."""
    return tick * STEP_NS / 1e9


class Loop:
    """The four instances and the last outputs of each."""

    def __init__(self, archives, values, disturbance, stack):
        self.archives = {name: archives[unit] for name, unit in UNITS.items()}
        self.disturbance = disturbance
        self.units = {name: stack.enter_context(Instance(a, name)) for name, a in self.archives.items()}
        for name, unit in self.units.items():
            unit.fmu.setupExperiment(startTime=0.0)
            unit.set(values.get(name, {}))
        self.outputs, self.inputs = {}, {name: {} for name in UNITS}

    def gather(self, name):
        self.outputs[name] = self.units[name].get(self.archives[name].names("output"))

    def drive(self, name, values):
        self.units[name].set(values)
        self.inputs[name] |= values

    def carry(self, source, prefix, target, port):
        """Copies the last outputs of a source to a group of inputs, for the members that the group has."""
        members = self.archives[target].group(port)
        self.drive(target, {f"{port}{m}": self.outputs[source][f"{prefix}{m}"] for m in members})

    def initialize(self):
        """Initializes in the order of the declared dependencies: path, ctrl and quad's states, then air."""
        for unit in self.units.values():
            unit.fmu.enterInitializationMode()
        self.drive("quad", self.disturbance(0.0))
        for name in ("path", "ctrl", "quad"):
            self.gather(name)
        self.carry("quad", "state", "air", "vehicle")
        self.gather("air")
        self.carry_held()
        self.carry("ctrl", "rotor_speed", "quad", "rotor_speed")
        for name, unit in self.units.items():
            self.gather(name)
            unit.fmu.exitInitializationMode()

    def carry_held(self):
        """Copies the values of the connections written `->`."""
        self.carry("quad", "state", "ctrl", "state")
        self.carry("quad", "state", "air", "vehicle")
        self.carry("quad", "contact", "ctrl", "contact")
        self.carry("path", "setpoint", "ctrl", "setpoint")
        self.carry("air", "velocity", "quad", "wind")
        self.carry("air", "speed", "ctrl", "wind_speed")

    def step(self, tick):
        """Makes one step of all units, the controller before the quadcopter: `ctrl.rotor_speed => quad.rotor_speed`."""
        self.carry_held()
        self.drive("quad", self.disturbance(seconds(tick)))
        for name in ("path", "air", "ctrl"):
            self.units[name].step(seconds(tick), seconds(1))
        self.gather("ctrl")
        self.carry("ctrl", "rotor_speed", "quad", "rotor_speed")
        self.units["quad"].step(seconds(tick), seconds(1))
        for name in ("path", "air", "quad"):
            self.gather(name)


def named(values):
    """Values by `instance.port`."""
    return {f"{name}.{port}": value for name, ports in values.items() for port, value in ports.items()}


def simulate(archives, ticks, values=FIRST_FLIGHT, disturbance=lambda _: {}):
    """Outputs at each tick and the inputs applied from it on, by `instance.port`; `disturbance(t)` drives quad."""
    with ExitStack() as stack:
        loop = Loop(archives, values, disturbance, stack)
        loop.initialize()
        rows = []
        for tick in range(ticks):
            shown = named(loop.outputs)
            loop.step(tick)
            rows.append({"time": seconds(tick), **shown, **named(loop.inputs)})
        rows.append({"time": seconds(ticks), **named(loop.outputs), **named(loop.inputs)})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
