"""A second implementation of the unit `wind`: steady wind, Dryden turbulence by its exact discretisation, gusts."""

import math

import numpy as np

from .chance import Generator
from .record import held_input, instants, with_start_values

START_VALUES = {
    "profile": "uniform", "roughness": 0.0457, "turbulence": 0.0, "sample_time": 0.01, "gust_count": 0,
    "seed": 1, "stream": 0,
    **{f"gust[{i}].{name}": 0.0 for i in range(1, 9) for name in ("start", "duration", "amplitude", "direction")},
}
FOOT = 0.3048


def scales(height, w20):
    """(L, sigma) of u and v, (L, sigma) of w."""
    h = min(max(height / FOOT, 10.0), 1000.0)
    base = 0.177 + 0.000823 * h
    sigma_w = 0.1 * w20
    return (h / base**1.2 * FOOT, sigma_w / base**0.4), (h * FOOT, sigma_w)


def steady(p, mean, height):
    """Steady wind at a height."""
    if p["profile"] == "uniform":
        return mean
    h = min(max(height, 1.0), 300.0)
    return mean * math.log(h / p["roughness"]) / math.log(6.096 / p["roughness"])


def gusts(p, t):
    """Sum of the (1 - cos) gusts at a time."""
    total = np.zeros(3)
    for i in range(1, int(p["gust_count"]) + 1):
        t0, T, A, direction = (p[f"gust[{i}].{name}"] for name in ("start", "duration", "amplitude", "direction"))
        if t0 < t < t0 + T:
            speed = 0.5 * A * (1 - math.cos(2 * math.pi * (t - t0) / T))
            total += speed * np.array([math.cos(direction), math.sin(direction), 0.0])
    return total


def second_order(y, r, generator):
    """One step of the filter of v or w, as a matrix exponential with its noise covariance."""
    a = math.exp(-r)
    if r < 0.05:
        q12, q22 = r**2 / 2 - 2 * r**3 / 3 + r**4 / 2, r**3 / 3 - r**4 / 2 + 2 * r**5 / 5
    else:
        q12, q22 = 0.25 - (r / 2 + 0.25) * a**2, 0.25 - (r**2 / 2 + r / 2 + 0.25) * a**2
    transition = np.array([[a, 0.0], [r * a, a]])
    return transition @ y + noise(np.array([[(1 - a**2) / 2, q12], [q12, q22]]), generator)


def noise(covariance, generator):
    """Two correlated normals."""
    return np.linalg.cholesky(covariance) @ np.array([generator.normal(), generator.normal()])


class Turbulence:
    """u, v, w along, left of and above the mean wind."""

    def __init__(self, seed, stream, height, w20):
        self.generator = Generator(seed, stream)
        stationary = np.array([[0.5, 0.25], [0.25, 0.25]])
        (_, sigma_u), (_, sigma_w) = scales(height, w20)
        self.u = sigma_u * self.generator.normal()
        self.v = noise(stationary, self.generator)
        self.w = noise(stationary, self.generator)
        self.hold(sigma_u, sigma_w)

    def hold(self, sigma_u, sigma_w):
        shape = np.array([math.sqrt(3), 1 - math.sqrt(3)])
        self.sample = np.array([self.u, sigma_u * (shape @ self.v), sigma_w * (shape @ self.w)])

    def advance(self, height, w20, passed):
        (L_u, sigma_u), (L_w, sigma_w) = scales(height, w20)
        a = math.exp(-passed / L_u)
        self.u = a * self.u + sigma_u * math.sqrt(1 - a**2) * self.generator.normal()
        self.v = second_order(self.v, passed / L_u, self.generator)
        self.w = second_order(self.w, passed / L_w, self.generator)
        self.hold(sigma_u, sigma_w)


def total(p, turbulence, mean, height, t):
    """Wind at the vehicle."""
    chi = math.atan2(mean[1], mean[0]) if math.hypot(mean[0], mean[1]) > 0 else 0.0
    c, s = math.cos(chi), math.sin(chi)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return steady(p, mean, height) + turned @ turbulence.sample + gusts(p, t)


def simulate(inputs, parameters, step):
    """Outputs, by port name, at `time` = first row of the inputs + k * step; inputs are held over each step."""
    p = with_start_values(START_VALUES, parameters)
    time = instants(inputs, step)
    mean = np.stack([held_input(inputs, f"mean.{a}", 0.0, time) for a in "xyz"], axis=1)
    velocity = np.stack([held_input(inputs, f"vehicle.velocity.{a}", 0.0, time) for a in "xyz"], axis=1)
    height = held_input(inputs, "vehicle.position.z", 0.0, time)

    turbulence = Turbulence(p["seed"], p["stream"], height[0], p["turbulence"])
    winds, drawn = [total(p, turbulence, mean[0], height[0], time[0])], 0
    for k in range(1, len(time)):
        held = k - 1
        passing = max(np.linalg.norm(steady(p, mean[held], height[held]) - velocity[held]), 1.0)
        due = math.floor(time[k] / p["sample_time"] + 1e-9)
        for _ in range(due - drawn):
            turbulence.advance(height[held], p["turbulence"], passing * p["sample_time"])
        drawn = due
        winds.append(total(p, turbulence, mean[held], height[held], time[k]))
    winds = np.array(winds)
    result = {f"velocity.{a}": winds[:, i] for i, a in enumerate("xyz")}
    return {"time": time, **result, "speed": np.linalg.norm(winds, axis=1)}
