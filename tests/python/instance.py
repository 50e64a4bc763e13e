"""Units called through FMPy's own fmi2 calls, with their variables by name."""

import fmpy
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

CALLS = {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean", "String": "String"}


class Archive:
    """An unpacked `.fmu` file."""

    def __init__(self, path, folder):
        self.path, self.name = path, path.stem
        self.folder = fmpy.extract(str(path), str(folder))
        self.description = fmpy.read_model_description(str(path))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        experiment = self.description.defaultExperiment
        self.step, self.stop = float(experiment.stepSize), float(experiment.stopTime)

    def names(self, causality):
        """Variables of a causality in the order of the description."""
        return [name for name, variable in self.variables.items() if variable.causality == causality]

    def group(self, prefix):
        """Members of a group: the part of the variable names after the group's name."""
        members = [name for name in self.variables if name.startswith((f"{prefix}.", f"{prefix}["))]
        return [name.removeprefix(prefix) for name in members or [prefix]]

    def item(self, name, text):
        """Number of an item of an enumeration."""
        items = self.variables[name].declaredType.items
        return next(int(item.value) for item in items if item.name == text)


class Instance:
    """A loaded unit; `messages` collects its log messages."""

    def __init__(self, archive, name="instance", logging=False):
        self.archive, self.messages = archive, []
        description = archive.description
        self.fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=archive.folder, instanceName=name,
            modelIdentifier=description.coSimulation.modelIdentifier,
        )
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(lambda *message: self.messages.append(message[-1].decode()))
        callbacks.allocateMemory = defaultCallbacks.allocateMemory
        callbacks.freeMemory = defaultCallbacks.freeMemory
        self.fmu.instantiate(callbacks=callbacks, loggingOn=logging)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()

    def initialize(self, values=(), start=0.0):
        """Initializes the instance for stepping, with values that hold from the start."""
        self.fmu.setupExperiment(startTime=start)
        self.set(dict(values))
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def by_type(self, names):
        kinds = {}
        for name in names:
            variable = self.archive.variables[name]
            kinds.setdefault(CALLS[variable.type], []).append((name, variable.valueReference))
        return kinds

    def set(self, values):
        """Sets variables; items of enumerations as text."""
        for kind, entries in self.by_type(values).items():
            numbers = [self.number(name, values[name]) for name, _ in entries]
            getattr(self.fmu, f"set{kind}")([reference for _, reference in entries], numbers)

    def number(self, name, value):
        variable = self.archive.variables[name]
        if variable.type == "Enumeration" and isinstance(value, str):
            return self.archive.item(name, value)
        return int(value) if variable.type in ("Integer", "Boolean", "Enumeration") else value

    def get(self, names):
        """Values of variables by name."""
        values = {}
        for kind, entries in self.by_type(names).items():
            numbers = getattr(self.fmu, f"get{kind}")([reference for _, reference in entries])
            values |= {name: number for (name, _), number in zip(entries, numbers)}
        return {name: values[name] for name in names}

    def outputs(self):
        """Values of all outputs, in the order of the description."""
        return tuple(self.get(self.archive.names("output")).values())

    def step(self, time, length):
        self.fmu.doStep(time, length)
