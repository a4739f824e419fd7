"""Replays a run of a spacecraft under a design from its files alone: python3 replay.py SCENARIO DESIGN TRAJECTORY.

Only the sampling instants are taken from the trajectory (its column sample). Everything else is computed here: the
plant by the method of Dormand and Prince of order 5 with steps of at most 0.01 s, the trigger and the law from the
design's numbers. Prints the largest differences of the attitude, the rate and the torque at any row, and the rows at
which a message was sent by one of the two only. Needs the standard library only.
"""

import csv
import json
import math
import sys

scenario, design = (json.load(open(path)) for path in sys.argv[1:3])
rows = list(csv.DictReader(open(sys.argv[3])))
body = scenario["system"]["rigid_body"]
J = body["inertia_kg_m2"]


def solve3(m, b):
    """Cramer's rule."""
    det = lambda a: (
        a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
        - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
        + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
    )
    d = det(m)
    return [det([[b[r] if c == k else m[r][c] for c in range(3)] for r in range(3)]) / d for k in range(3)]


INVERSE = list(zip(*(solve3(J, [1.0 if r == k else 0.0 for r in range(3)]) for k in range(3))))


def times(m, v):
    return [sum(a * b for a, b in zip(row, v)) for row in m]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def disturbance(t):
    file = body["disturbance"]
    value = list(file["bias_nm"])
    for wave in file["sines"]:
        s, c = math.sin(wave["frequency_rad_s"] * t), math.cos(wave["frequency_rad_s"] * t)
        for axis in range(3):
            value[axis] += wave["sine_nm"][axis] * s + wave["cosine_nm"][axis] * c
    return value


def slope(t, x, u):
    w, q0, q = x[:3], x[3], x[4:]
    gyroscopic = cross(w, times(J, w))
    d = disturbance(t)
    torque = [u[k] + d[k] - gyroscopic[k] for k in range(3)]
    turn = cross(q, w)
    rate = [0.5 * (q0 * w[k] + turn[k]) for k in range(3)]
    return times(INVERSE, torque) + [-0.5 * sum(a * b for a, b in zip(q, w))] + rate


NODES = [0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1]
STAGES = [
    [],
    [1 / 5],
    [3 / 40, 9 / 40],
    [44 / 45, -56 / 15, 32 / 9],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
]
WEIGHTS = [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]


def integrate(t, until, x, u):
    count = max(1, math.ceil((until - t) / 0.01 - 1e-9))
    h = (until - t) / count
    for index in range(count):
        at = t + index * h
        slopes = []
        for node, stage in zip(NODES, STAGES):
            y = [v + h * sum(a * k[i] for a, k in zip(stage, slopes)) for i, v in enumerate(x)]
            slopes.append(slope(at + node * h, y, u))
        x = [v + h * sum(b * k[i] for b, k in zip(WEIGHTS, slopes)) for i, v in enumerate(x)]
    norm = math.sqrt(sum(v * v for v in x[3:]))
    return x[:3] + [v / norm for v in x[3:]]


gain = design["controller"]["gains"][0]
weight = design["controller"]["trigger_weight"]
nu = design["model"]["specs"]["nu"]
limit = design["model"]["plant"]["exact"]["torque_limit_nm"]
size = lambda v: sum(a * b for a, b in zip(v, times(weight, v)))

start = body["initial_attitude"]["axis_angle"]
length = math.sqrt(sum(a * a for a in start["axis"]))
half = 0.5 * math.radians(start["angle_deg"])
x = list(body["initial_rate_rad_s"]) + [math.cos(half)] + [math.sin(half) * a / length for a in start["axis"]]
t, u, sent_state = 0.0, [0.0, 0.0, 0.0], None
attitude = rate = torque = 0.0
wrong, samples, messages = 0, 0, 0
for row in rows:
    until = float(row["time_s"])
    if until > t:
        x, t = integrate(t, until, x, u), until
    sent = False
    if row["sample"] == "1":
        samples += 1
        sign = -1.0 if x[3] < 0 else 1.0
        state = x[:3] + [sign * v for v in x[4:]]
        difference = [a - b for a, b in zip(state, sent_state or state)]
        sent = sent_state is None or size(difference) >= nu * size(sent_state)
        if sent:
            sent_state = state
            u = [max(-m, min(m, v)) for m, v in zip(limit, times(gain, state))]
    messages += sent
    wrong += sent != (row["sent"] == "1")
    names = ["error_q0_scalar", "error_q1", "error_q2", "error_q3"]
    attitude = max([attitude] + [abs(float(row[n]) - v) for n, v in zip(names, x[3:])])
    rate = max([rate] + [abs(float(row[f"rate_{k + 1}_rad_s"]) - x[k]) for k in range(3)])
    if row is not rows[-1]:
        torque = max([torque] + [abs(float(row[f"torque_{k + 1}_nm"]) - u[k]) for k in range(3)])
print(json.dumps(dict(attitude=attitude, rate=rate, torque=torque, wrong=wrong, samples=samples, messages=messages)))
