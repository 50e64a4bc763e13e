"""A second implementation of the unit `quadcopter`, in the frame of Geng & Chulin (2016): x forward, y up, z right.

State vector: x y z, vx vy vz (earth), q0 q1 q2 q3 (body to earth), wx wy wz (body), w1..w4 (right, front, left, rear).
"""

import math

import numpy as np

from .chance import Generator
from .record import held_input, instants, with_start_values

LONGEST_INNER_STEP = 0.0025
SPIN = np.array([1.0, -1.0, 1.0, -1.0])

START_VALUES = {
    "position0.x": 0.0, "position0.y": 0.0, "position0.z": 0.0,
    "velocity0.x": 0.0, "velocity0.y": 0.0, "velocity0.z": 0.0,
    "yaw0": 0.0, "airborne": False,
    "mass": 0.65, "arm": 0.23, "hub_height": 0.05,
    "inertia.x": 7.5e-3, "inertia.y": 7.5e-3, "inertia.z": 1.3e-2,
    "thrust_coefficient": 3.13e-5, "torque_coefficient": 7.5e-7, "rotor_inertia": 6e-5,
    "rotor_radius": 0.15, "rotor_solidity": 0.167, "lift_slope": 5.7, "motor_time_constant": 0.05,
    "rotor_speed_min": 40.0, "rotor_speed_max": 340.0,
    "air_density": 1.225, "gravity": 9.81,
    "body_area": 0.015, "disc_area_fraction": 0.15, "drag_coefficient": 1.0,
    "rotor_model": "bemt", "ground_effect": True, "ground_turbulence": 0.05, "sample_time": 0.01,
    "seed": 1, "stream": 4,
}


def from_port(v):
    """World or body vector from a port's axes (z up) to the paper's (y up)."""
    return np.array([v[0], v[2], -v[1]])


def to_port(v):
    """Inverse of `from_port`."""
    return np.array([v[0], -v[2], v[1]])


def rotation(q):
    """Body to earth from a quaternion; homogeneous, because its length is not exactly 1 within an integration step."""
    a, b, c, d = q
    return np.array([
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ])


def angles(R):
    """Yaw, pitch, roll from eq. 10 with -cos(theta) sin(gamma) in row 2, column 3."""
    psi = math.atan2(-R[2, 0], R[0, 0])
    theta = math.asin(max(-1.0, min(1.0, R[1, 0])))
    gamma = math.atan2(-R[1, 2], R[1, 1])
    return psi, theta, gamma


def quaternion(psi, theta, gamma):
    """Ry(psi) Rz(theta) Rx(gamma) as a quaternion."""
    def product(p, q):
        return np.array([
            p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
            p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
            p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
        ])

    about_y = np.array([math.cos(psi / 2), 0.0, math.sin(psi / 2), 0.0])
    about_z = np.array([math.cos(theta / 2), 0.0, 0.0, math.sin(theta / 2)])
    about_x = np.array([math.cos(gamma / 2), math.sin(gamma / 2), 0.0, 0.0])
    return product(product(about_y, about_z), about_x)


class Plant:
    """The right-hand side, eqs. 1 to 14 with their corrections."""

    def __init__(self, p):
        self.p = p
        self.A = math.pi * p["rotor_radius"] ** 2
        h, l = p["hub_height"], p["arm"]
        self.hubs = np.array([[0.0, h, l], [l, h, 0.0], [0.0, h, -l], [-l, h, 0.0]])
        self.K = p["rotor_solidity"] * p["lift_slope"] / 2
        C_T = p["thrust_coefficient"] / (p["air_density"] * self.A * p["rotor_radius"] ** 2)
        self.inflow = math.sqrt(C_T / 2)
        self.theta_e = 3 * (C_T / self.K + self.inflow / 2)

    def rotor(self, w, V_h, V_c):
        """Thrust without ground effect, induced velocity; arrays over the rotors."""
        p = self.p
        P_ii = p["thrust_coefficient"] * w**2
        w_d = np.sqrt(P_ii / (2 * p["air_density"] * self.A))
        if p["rotor_model"] == "kw2":
            return P_ii, w_d
        if p["rotor_model"] == "paper":
            g = w_d + 1e-9
            return P_ii * np.sqrt((V_h / g) ** 2 + (1 + V_c / g) ** 2), w_d
        rho_A = p["air_density"] * self.A
        OR = np.maximum(w, 1.0) * p["rotor_radius"]
        q = rho_A * OR**2
        mu2 = (V_h / OR) ** 2
        V_m = np.maximum(V_c, 0.0)

        def T(v):
            return q * self.K * (self.theta_e * (1 / 3 + mu2 / 2) - (V_c + v) / (2 * OR))

        v_i = self.inflow * OR
        for _ in range(6):
            U = np.sqrt(V_h**2 + (V_m + v_i) ** 2) + 1e-9
            f = 2 * rho_A * v_i * U - T(v_i)
            df = 2 * rho_A * (U + v_i * (V_m + v_i) / U) + q * self.K / (2 * OR)
            v_i = np.maximum(v_i - f / df, 0.0)
        return np.maximum(T(v_i), 0.0), v_i

    def thrusts(self, x, wind, effectiveness, fluctuation):
        """P_i of eq. 5, ground effect as a factor."""
        p = self.p
        R = rotation(x[6:10])
        air = (R.T @ (x[3:6] - wind)) + np.cross(x[10:13], self.hubs)
        T, v_i = self.rotor(x[13:17], np.hypot(air[:, 0], air[:, 2]), air[:, 1])
        if p["ground_effect"]:
            h = x[1] + self.hubs @ R[1]
            clear = np.maximum(h, p["rotor_radius"] / 2)
            advance = np.linalg.norm(x[3:6]) / np.maximum(v_i, 0.1)
            r_g = 1 / (1 - (p["rotor_radius"] / (4 * clear)) ** 2 / (1 + advance**2))
            T = T * np.where(h >= 2.0, 1.0, np.minimum(r_g, 4 / 3))
        if x[1] < 1.0:
            T = T * (1 + fluctuation * (1 - x[1]))
        return effectiveness * T

    def derivative(self, x, command, wind, effectiveness, fluctuation):
        p = self.p
        R = rotation(x[6:10])
        wx, wy, wz = x[10:13]
        w = x[13:17]
        P = self.thrusts(x, wind, effectiveness, fluctuation)

        cos_eta = R[1, 1]
        sin_eta = math.sqrt(max(0.0, 1 - cos_eta**2))
        discs = 4 * p["disc_area_fraction"] * self.A
        side, top = discs * sin_eta + p["body_area"], discs * abs(cos_eta) + p["body_area"]
        V = x[3:6] - wind
        f = 0.5 * p["air_density"] * p["drag_coefficient"] * np.array([side, top, side]) * V * np.abs(V)
        force = R @ np.array([0.0, P.sum(), 0.0]) - f - np.array([0.0, p["mass"] * p["gravity"], 0.0])

        w_dot = (np.clip(command, p["rotor_speed_min"], p["rotor_speed_max"]) - w) / p["motor_time_constant"]
        J, l = p["rotor_inertia"], p["arm"]
        W_s = SPIN @ w
        M_x = (P[2] - P[0]) * l + J * wz * W_s
        M_z = (P[1] - P[3]) * l - J * wx * W_s
        M_y = -SPIN @ (effectiveness * p["torque_coefficient"] * w**2 + J * w_dot)
        I_x, I_y, I_z = p["inertia.x"], p["inertia.z"], p["inertia.y"]  # the port's yaw axis z is y here
        rate_dot = [
            (wy * wz * (I_y - I_z) + M_x) / I_x,
            (wx * wz * (I_z - I_x) + M_y) / I_y,
            (wx * wy * (I_x - I_y) + M_z) / I_z,
        ]
        a, b, c, d = x[6:10]
        q_dot = 0.5 * np.array([
            -b * wx - c * wy - d * wz,
            a * wx + c * wz - d * wy,
            a * wy + d * wx - b * wz,
            a * wz + b * wy - c * wx,
        ])
        return np.concatenate([x[3:6], force / p["mass"], q_dot, rate_dot, w_dot])

    def inner_step(self, x, h, *held):
        k1 = self.derivative(x, *held)
        k2 = self.derivative(x + h / 2 * k1, *held)
        k3 = self.derivative(x + h / 2 * k2, *held)
        k4 = self.derivative(x + h * k3, *held)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        x[6:10] /= np.linalg.norm(x[6:10])
        if x[1] < 0:
            friction, level = 0.9 ** (h / 0.0025), 0.98 ** (h / 0.0025)
            x[1] = 0.0
            x[[3, 5]] *= friction
            x[4] = max(x[4], 0.0)
            x[10:13] *= friction
            psi, theta, gamma = angles(rotation(x[6:10]))
            x[6:10] = quaternion(psi, level * theta, level * gamma)
        return x


def start(p):
    """First state vector."""
    speed = p["rotor_speed_min"]
    if p["airborne"]:
        speed = math.sqrt(p["mass"] * p["gravity"] / (4 * p["thrust_coefficient"]))
    position = from_port([p[f"position0.{a}"] for a in "xyz"])
    velocity = from_port([p[f"velocity0.{a}"] for a in "xyz"])
    return np.concatenate([position, velocity, quaternion(p["yaw0"], 0.0, 0.0), np.zeros(3), np.full(4, speed)])


def outputs(x, thrust):
    """The unit's outputs for a state vector."""
    psi, theta, gamma = angles(rotation(x[6:10]))
    position, velocity, rate = to_port(x[0:3]), to_port(x[3:6]), to_port(x[10:13])
    row = {f"state.position.{a}": position[i] for i, a in enumerate("xyz")}
    row |= {f"state.attitude.{a}": v for a, v in zip("wxyz", [x[6], *to_port(x[7:10])])}
    row |= {f"state.velocity.{a}": velocity[i] for i, a in enumerate("xyz")}
    row |= {f"state.rate.{a}": rate[i] for i, a in enumerate("xyz")}
    row |= {"roll": gamma, "pitch": -theta, "yaw": psi}
    row |= {f"rotor.speed[{i + 1}]": x[13 + i] for i in range(4)}
    return row | {"thrust": thrust, "height": x[1], "contact": bool(x[1] <= 0)}


def simulate(inputs, parameters, step):
    """Outputs, by port name, at `time` = first row of the inputs + k * step; inputs are held over each step."""
    p = with_start_values(START_VALUES, parameters)
    plant = Plant(p)
    time = instants(inputs, step)
    command = np.stack([held_input(inputs, f"rotor_speed[{i}]", 0.0, time) for i in range(1, 5)], axis=1)
    effectiveness = np.stack([held_input(inputs, f"effectiveness[{i}]", 1.0, time) for i in range(1, 5)], axis=1)
    wind = np.stack([held_input(inputs, f"wind.{a}", 0.0, time) for a in "xyz"], axis=1)
    count = max(1, math.ceil(step / LONGEST_INNER_STEP - 1e-9))
    h = step / count

    sigma, generator = p["ground_turbulence"], Generator(p["seed"], p["stream"])
    kept = math.exp(-p["sample_time"] / 0.05)
    n = np.array([generator.normal() for _ in range(4)])

    def due(t):
        return math.floor(t / p["sample_time"] + 1e-9)

    x = start(p)
    rows = []
    for k in range(len(time)):
        held = None
        for part in range(count if k else 0):
            held = (command[k - 1], from_port(wind[k - 1]), effectiveness[k - 1])
            x = plant.inner_step(x, h, *held, sigma * n)
            begin = time[k - 1] + part * h
            for _ in range(due(begin + h) - due(begin)):
                n = kept * n + math.sqrt(1 - kept**2) * np.array([generator.normal() for _ in range(4)])
        _, air, healthy = held or (None, from_port(wind[0]), effectiveness[0])
        rows.append(outputs(x, plant.thrusts(x, air, healthy, sigma * n).sum()))
    return {"time": time} | {name: np.array([row[name] for row in rows]) for name in rows[0]}
