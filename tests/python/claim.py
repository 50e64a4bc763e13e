"""A claim as text of a script and as formula of rtamt, over the signals x, y, z and the count n; a tick takes 1 s."""

import contextlib
import dataclasses
import math
from collections.abc import Callable

import numpy as np


class Formula:
    """What a formula refers to besides x, y, z and n: signals that are +inf where something holds, else -inf.

    Conditions are such signals where Lockstep judges true or false: in gates, and for discrete values. If `boolean`,
    all comparisons are, and the formula gives the verdict, also where the margin is 0. If `ends_early`, what samples
    after the end of the run would decide is replaced: `granted` makes it hold, `denied` makes it fail, and the other
    way round where holding makes the claim fail.
    """

    def __init__(self, boolean, ends_early):
        self.boolean, self.ends_early, self.positive = boolean, ends_early, True
        self.conditions, self.places = {}, set()

    def condition(self, text):
        """A condition in Python, as part of the formula."""
        name = self.conditions.setdefault(text, f"condition{len(self.conditions)}")
        return self.known(f"({name} >= 0)", 0)

    def place(self, name, ticks=0):
        """`leaves`: the run goes on for so many ticks; `granted` and `denied`: it does not; `end`: the last sample."""
        self.places.add((name, ticks))
        return f"({name}{ticks} >= 0)"

    def known(self, text, ticks):
        """The text, which the samples up to so many ticks later decide."""
        if not self.ends_early:
            return text
        replacement = self.place("granted" if self.positive else "denied", ticks)
        return f"((({text}) and {self.place('leaves', ticks)}) or {replacement})"

    @contextlib.contextmanager
    def negated(self):
        """Parts that are written inside make the claim fail where they hold."""
        self.positive = not self.positive
        yield
        self.positive = not self.positive

    def names(self):
        """Names of the signals."""
        return [*self.conditions.values(), *(f"{name}{ticks}" for name, ticks in self.places)]

    def signals(self, trace, samples, grants):
        """The signals by name, over a trace of which so many samples are of the run; `grants` what is not known."""
        k = np.arange(len(trace["x"]))

        def holds(name, ticks):
            has = k < samples - ticks
            return {
                "leaves": has, "end": k == samples - 1, "granted": ~has & grants, "denied": ~has & (not grants),
            }[name]

        columns = {"abs": abs} | {name: np.asarray(column) for name, column in trace.items()}
        found = {name: eval(text, columns) for text, name in self.conditions.items()}
        found |= {f"{name}{ticks}": holds(name, ticks) for name, ticks in self.places}
        return {name: np.where(value, math.inf, -math.inf).tolist() for name, value in found.items()}


@dataclasses.dataclass(frozen=True)
class Claim:
    """Text in a script, horizon in ticks, what writes it into a formula (as a gate or not), and the operators in it."""

    script: str
    horizon: int
    write: Callable[[Formula, bool], str]
    operators: frozenset = frozenset()


def composed(operator, script, horizon, write, *parts):
    return Claim(script, horizon, write, frozenset({operator}).union(*(part.operators for part in parts)))


def comparison(left, sign, right):
    """The text is the same in a script, in a formula and in Python."""
    text = f"{left} {sign} {right}"

    def write(formula, is_gate):
        return formula.condition(text) if is_gate or formula.boolean else formula.known(text, 0)

    return Claim(text, 0, write)


def chain(low, first, middle, second, high):
    claim = junction("and", [comparison(low, first, middle), comparison(middle, second, high)])
    return Claim(f"{low} {first} {middle} {second} {high}", 0, claim.write, frozenset({"chain"}))


def near(left, right, tolerance):
    claim = comparison(f"abs({left} - ({right}))", "<=", tolerance)
    return Claim(f"{left} == {right} ± {tolerance}", 0, claim.write, frozenset({"±"}))


def extreme(function, values, sign, limit):
    """A comparison of `max` or `min`, which rtamt does not have: `max(a, b) < c` is `a < c and b < c`."""
    joins_all = (function == "max") == (sign in ("<", "<="))
    claim = junction("and" if joins_all else "or", [comparison(value, sign, limit) for value in values])
    return Claim(f"{function}({', '.join(values)}) {sign} {limit}", 0, claim.write, frozenset({function}))


def discrete(sign, number):
    text = f"n {sign} {number}"
    return Claim(text, 0, lambda formula, _: formula.condition(text), frozenset({f"discrete {sign}"}))


def rises(condition):
    def write(formula, _):
        return formula.known(f"rise({condition.write(formula, True)})", 0)

    return composed("rises", f"rises({condition.script})", 0, write, condition)


def negation(claim):
    def write(formula, is_gate):
        with formula.negated():
            return f"not ({claim.write(formula, is_gate)})"

    return composed("not", f"not ({claim.script})", claim.horizon, write, claim)


def junction(operator, parts):
    def write(formula, is_gate):
        text, *others = (part.write(formula, is_gate) for part in parts)
        for other in others:
            text = f"({text}) {operator} ({other})"
        return text

    script = f" {operator} ".join(f"({part.script})" for part in parts)
    return composed(operator, script, max(part.horizon for part in parts), write, *parts)


def gated(gate, claim):
    def write(formula, is_gate):
        with formula.negated():
            opens = gate.write(formula, True)
        return f"({opens}) implies ({claim.write(formula, is_gate)})"

    script = f"({gate.script}) implies ({claim.script})"
    return composed("implies", script, max(gate.horizon, claim.horizon), write, gate, claim)


@dataclasses.dataclass(frozen=True)
class Window:
    """A window in ticks from now on; without `to` it ends where its body, too, is known."""

    since: int = 0
    to: int | None = None

    def script(self):
        if self.to is None:
            return f" after {self.since} s" if self.since else ""
        return f" within {self.to} s" if self.since == 0 else f" within {self.since}..{self.to} s"

    def name(self):
        """The word in the script."""
        return "" if self == Window() else " after" if self.to is None else " within" if self.since == 0 else " between"

    def is_cut(self, formula, body):
        """Whether the trace goes on after the window."""
        return self.to is None and (body > 0 or formula.ends_early)

    def written(self, formula, write, ticks, body):
        """`write` writes the operator with this window in rtamt, which cuts a window at the end of the trace."""
        text = write("" if self == Window() else f"[{self.since}:{self.to or ticks}]")
        return text if self.to else formula.known(text, self.since + body)

    def horizon(self, body):
        return (self.since if self.to is None else self.to) + body


def always(window, claim, ticks):
    return temporal("always", "implies", window, claim, ticks)


def eventually(window, claim, ticks):
    return temporal("eventually", "and", window, claim, ticks)


def hold_for(duration, claim, ticks):
    same = always(Window(0, duration), claim, ticks)
    return composed("hold for", f"hold for {duration} s ({claim.script})", same.horizon, same.write, claim)


def temporal(word, where_it_leaves, window, claim, ticks):
    """`where_it_leaves` joins what does not count behind the window with the claim."""

    def write(formula, is_gate):
        body = claim.write(formula, is_gate)
        if window.is_cut(formula, claim.horizon):
            body = f"{formula.place('leaves', claim.horizon)} {where_it_leaves} ({body})"
        return window.written(formula, lambda interval: f"{word}{interval} ({body})", ticks, claim.horizon)

    script = f"{word}{window.script()} ({claim.script})"
    return composed(f"{word}{window.name()}", script, window.horizon(claim.horizon), write, claim)


def until(window, claim, gate, ticks):
    """rtamt takes the largest margin over all ends; with a gate of +inf and -inf that of the first."""
    body = max(claim.horizon, gate.horizon)

    def write(formula, is_gate):
        before, comes = claim.write(formula, is_gate), gate.write(formula, True)
        if window.is_cut(formula, body):
            comes = f"{formula.place('leaves', body)} and ({comes})"
        return window.written(formula, lambda interval: f"({before}) until{interval} ({comes})", ticks, body)

    script = f"({claim.script}) until{window.script()} ({gate.script})"
    return composed(f"until{window.name()}", script, window.horizon(body), write, claim, gate)


def finally_(claim):
    def write(formula, is_gate):
        return f"always ({formula.place('end')} implies ({claim.write(formula, is_gate)}))"

    return composed("finally", f"finally ({claim.script})", 0, write, claim)
