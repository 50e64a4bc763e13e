"""Draws random claims that fit into a run, and random traces to judge them by."""

import random

import numpy as np

from claim import (
    Window, always, chain, comparison, discrete, eventually, extreme, finally_, gated, hold_for, junction, near,
    negation, rises, until,
)

OPERATORS = {
    "and", "or", "not", "implies", "hold for", "finally", "rises", "chain", "±", "max", "min", "discrete ==",
    "discrete !=",
    *(word + window for word in ("always", "eventually", "until") for window in ("", " within", " between", " after")),
}
SPREAD = 2.0


def trace(seed, ticks, grain):
    """Columns u, y and z: noise, a walk and an oscillation in some order; multiples of `grain`, if there is one."""
    draw = np.random.default_rng(seed)
    time = np.arange(ticks + 1.0)
    noise = draw.normal(0, SPREAD, ticks + 1)
    walk = np.cumsum(draw.normal(0, SPREAD / 3, ticks + 1))
    oscillation = 1.5 * SPREAD * np.sin(time * draw.uniform(0.1, 1) + draw.uniform(0, 6))
    columns = dict(zip(draw.permutation(["u", "y", "z"]).tolist(), (noise, walk, oscillation)))
    if grain:
        columns = {name: np.round(column / grain) * grain for name, column in columns.items()}
    return {"time": time} | columns


class Generator:
    """Draws claims; constants are multiples of `grain`, if there is one, so that margins of 0 occur.

    Claims of runs that end earlier have no `until after`: where its range is empty, the
    language says unjudged, but Lockstep says failed if φ failed before.
    """

    def __init__(self, seed, ticks, grain, ends_early=False):
        self.random, self.ticks, self.grain, self.ends_early = random.Random(seed), ticks, grain, ends_early

    def claim(self):
        """A claim as a whole, with one operator at least."""
        if self.random.random() < 0.04:
            return finally_(self.state(2))
        depth = self.random.choice([1, 2, 2, 3])
        if self.random.random() < 0.7:
            return self.temporal(depth, self.ticks)
        return self.composed(depth, self.ticks)

    def formula(self, depth, room):
        """A claim whose horizon is at most `room` ticks."""
        return self.atom() if depth == 0 or self.random.random() < 0.1 else self.composed(depth, room)

    def composed(self, depth, room):
        draws = [self.temporal, self.until, self.gated, self.junction, self.negation]
        return self.random.choices(draws, [8, 3, 3, 4, 2])[0](depth - 1, room)

    def negation(self, depth, room):
        return negation(self.formula(depth, room))

    def junction(self, depth, room):
        parts = [self.formula(depth, room) for _ in range(self.random.choice([2, 2, 3]))]
        return junction(self.random.choice(["and", "or"]), parts)

    def gated(self, depth, room):
        is_final = self.random.random() < 0.1
        gate = finally_(self.state(1)) if is_final else self.formula(max(depth - 1, 0), room)
        return gated(gate, self.formula(depth, room))

    def temporal(self, depth, room):
        if self.random.random() < 0.15 and room > 0:
            duration = self.length(room)
            return hold_for(duration, self.formula(depth, room - duration), self.ticks)
        window, inside = self.window(room)
        return self.random.choice([always, eventually])(window, self.formula(depth, inside), self.ticks)

    def until(self, depth, room):
        window, inside = self.window(room, may_skip=not self.ends_early)
        gate = self.event() if self.random.random() < 0.7 else self.formula(max(depth - 1, 0), inside)
        return until(window, self.formula(depth, inside), gate, self.ticks)

    def window(self, room, may_skip=True):
        """A window, and the room that it leaves for its body; `may_skip` allows `after`."""
        kind = self.random.choice(["all", "within", "between", "after"])
        if room == 0 or kind == "all" or (kind == "after" and not may_skip):
            return Window(), room
        since, to = sorted((self.length(room), self.length(room)))
        if kind == "after":
            return Window(since), room - since
        return Window(since if kind == "between" else 0, to), room - to

    def length(self, room):
        return self.random.randint(1, max(1, room // self.random.choice([1, 2, 4, 8])))

    def state(self, depth):
        """A claim about one sample."""
        if depth == 0 or self.random.random() < 0.4:
            return self.atom()
        parts = [self.state(depth - 1) for _ in range(2)]
        return junction(self.random.choice(["and", "or"]), parts) if self.random.random() < 0.8 else negation(parts[0])

    def event(self):
        """A comparison that seldom holds."""
        limit = abs(float(self.constant())) + SPREAD / 2
        sign, limit = self.random.choice([(">", limit), (">=", limit), ("<", -limit), ("<=", -limit)])
        return comparison(self.random.choice("xyz"), sign, limit)

    def constant(self):
        value = self.random.gauss(0, SPREAD)
        return repr(round(value / self.grain) * self.grain if self.grain else value)

    def value(self):
        one, other = self.random.sample(["x", "y", "z"], 2)
        computed = [f"abs({one})", f"({one} - {other})", f"({one} * {other})", f"(2 * {one} + {other})"]
        return self.random.choice([one, one, one, *computed])

    def atom(self):
        sign, kind = self.random.choice(["<", "<=", ">", ">="]), self.random.random()
        if kind < 0.03:
            return discrete(self.random.choice(["==", "!="]), self.random.randint(0, self.ticks))
        if kind < 0.05:
            return rises(comparison(self.value(), sign, self.constant()))
        if kind < 0.15:
            return near(self.value(), self.constant(), repr(abs(float(self.constant()))))
        if kind < 0.20:
            low, high = sorted((self.constant(), self.constant()), key=float)
            return chain(low, self.random.choice(["<", "<="]), self.value(), self.random.choice(["<", "<="]), high)
        if kind < 0.25:
            return extreme(self.random.choice(["max", "min"]), [self.value(), self.value()], sign, self.constant())
        if kind < 0.30:
            return comparison("n", sign, self.random.randint(0, self.ticks))
        return comparison(self.value(), sign, self.random.choice([self.constant(), self.constant(), *"xyz"]))
