"""Wu, Shen and Cao 2018, section 5, with one scipy solve_ivp call per held segment of 1/32 s.

Prints the seconds per segment. Argument: simulated seconds.
"""

import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

INERTIA = np.array([[147, 6.5, 6], [6.5, 158, 5.5], [6, 5.5, 137]])
INVERSE = np.linalg.inv(INERTIA)
NATURAL_FREQUENCY = 8 / 100
GAIN = 2 * NATURAL_FREQUENCY * np.linalg.norm(INERTIA, 2)
WEIGHT = NATURAL_FREQUENCY
SAMPLE = 1 / 32


def disturbance(t):
    s, c = np.sin(0.005 * t), np.cos(0.005 * t)
    return np.array([1 + 2 * s, -1 - 5 * c, 2 - 4 * c]) * 1e-4


def slope(t, x, u):
    w, q0, q = x[:3], x[3], x[4:]
    rate = INVERSE @ (u + disturbance(t) - np.cross(w, INERTIA @ w))
    return np.concatenate([rate, [-0.5 * q @ w], 0.5 * (q0 * w + np.cross(q, w))])


def main(duration):
    x = np.array([0, 0, 0, 0.9981, 0.0416, 0.0453, 0.0416])
    x[3:] /= np.linalg.norm(x[3:])
    sent, u = None, np.zeros(3)
    segments = round(duration / SAMPLE)
    start = time.perf_counter()
    for index in range(segments):
        t = index * SAMPLE
        s = x[:3] + WEIGHT * x[4:]
        if sent is None or np.linalg.norm(sent - s) >= 0.5 * np.linalg.norm(s) + 1e-6:
            sent, u = s, np.clip(-GAIN * s, -0.2, 0.2)
        x = solve_ivp(slope, (t, t + SAMPLE), x, args=(u,), rtol=1e-9, atol=1e-12).y[:, -1]
        x[3:] /= np.linalg.norm(x[3:])
    print((time.perf_counter() - start) / segments)


if __name__ == "__main__":
    main(float(sys.argv[1]))
