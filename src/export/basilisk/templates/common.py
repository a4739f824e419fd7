"""A spacecraft attitude controller for the Basilisk astrodynamics simulator, in one file.

Units are SI units and radians. Attitude errors are unit quaternions in Hamilton's convention: they turn
the desired frame into the body frame, and q' = q (0, omega) / 2 with omega in body axes.
"""
@about@
import hashlib
import math
import os
import sys
from pathlib import Path

import numba as nb
import numpy as np
from Basilisk.architecture import messaging
from Basilisk.architecture.numbaModel import NumbaModel

@tables@


def source_field():
    """Name of a field of the memory that is never used. Compiled code is kept on disk under the names and types
    of the memory's fields, not under the numbers above: a name made of this file's text makes every edit
    compile anew, and so does the module's name, which compiled code depends on."""
    name = __name__ if __name__ in sys.modules else os.urandom(8).hex()
    return "source_" + hashlib.sha256(name.encode() + Path(__file__).read_bytes()).hexdigest()[:16]


SOURCE_FIELD = source_field()

# How a sample ended.
HELD, SILENT, SENT = 0, 1, 2


# Vectors are tuples of three numbers; sums are in the order of the indices.


@nb.njit
def add(a, b):
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@nb.njit
def subtract(a, b):
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@nb.njit
def scale(a, factor):
    """The vector a times a number."""
    return (a[0] * factor, a[1] * factor, a[2] * factor)


@nb.njit
def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@nb.njit
def cross(a, b):
    """Cross product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@nb.njit
def times(matrix, a):
    """Matrix (3 x 3) times vector."""
    return (
        matrix[0, 0] * a[0] + matrix[0, 1] * a[1] + matrix[0, 2] * a[2],
        matrix[1, 0] * a[0] + matrix[1, 1] * a[1] + matrix[1, 2] * a[2],
        matrix[2, 0] * a[0] + matrix[2, 1] * a[1] + matrix[2, 2] * a[2],
    )


@nb.njit
def all_finite(values):
    """Whether every number is finite."""
    for value in values:
        if not math.isfinite(value):
            return False
    return True


@nb.njit
def saturate(value, limit):
    """A torque (N m) within its limit either way."""
    if value > limit:
        return limit
    if value < -limit:
        return -limit
    return value


@nb.njit
def sign(value):
    """-1, 0 or 1."""
    if value > 0.0:
        return 1.0
    if value < 0.0:
        return -1.0
    return 0.0


@nb.njit
def quaternion_of_mrp(sigma):
    """Unit quaternion (q0, q1, q2, q3) of modified Rodrigues parameters. Its scalar part is negative
    where their norm is above 1."""
    square = sigma[0] * sigma[0] + sigma[1] * sigma[1] + sigma[2] * sigma[2]
    below = 1.0 + square
    return (
        (1.0 - square) / below,
        2.0 * sigma[0] / below,
        2.0 * sigma[1] / below,
        2.0 * sigma[2] / below,
    )


@nb.njit
def error_quaternion(desired, attitude):
    """The conjugate of the desired quaternion times that of the attitude."""
    d0, d1, d2, d3 = desired[0], desired[1], desired[2], desired[3]
    q0, q1, q2, q3 = attitude
    return (
        d0 * q0 + (d1 * q1 + d2 * q2 + d3 * q3),
        d0 * q1 - d1 * q0 - (d2 * q3 - d3 * q2),
        d0 * q2 - d2 * q0 - (d3 * q1 - d1 * q3),
        d0 * q3 - d3 * q0 - (d1 * q2 - d2 * q1),
    )


@nb.njit
def negated(q):
    """The other quaternion of the same attitude."""
    return (-q[0], -q[1], -q[2], -q[3])


@nb.njit
def vector_part(q):
    """The vector part of a quaternion."""
    return (q[1], q[2], q[3])


@nb.njit
def shortest(q):
    """The quaternion of the same attitude with a scalar part that is not negative."""
    if q[0] < 0.0:
        return negated(q)
    return q


@nb.njit
def normalised(q):
    """The quaternion scaled to unit norm."""
    norm = math.sqrt(q[0] * q[0] + (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]))
    return (q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm)


@nb.njit
def quaternion_slope(q, rate):
    """Time derivative (1/s) of the quaternion at a rate in body axes (rad/s)."""
    vector = vector_part(q)
    slope = scale(add(scale(rate, q[0]), cross(vector, rate)), 0.5)
    return (-0.5 * dot(vector, rate), slope[0], slope[1], slope[2])


@nb.njit
def continuing(memory, q):
    """Of the two quaternions of an attitude, the one closer to that of the last sample. Modified
    Rodrigues parameters jump to their shadow set at a half turn; this undoes the jump of the sign."""
    if memory.samples_used == 0:
        return q
    last = memory.last_error
    along = last[0] * q[0] + (last[1] * q[1] + last[2] * q[2] + last[3] * q[3])
    if along < 0.0:
        return negated(q)
    return q


@nb.njit
def positive_side(known, scalar, half_width):
    """Sign of a scalar part with hysteresis, 1 or -1; `known` is the last one, 0 before the first."""
    if known == 0:
        positive = scalar >= 0.0
    elif known > 0:
        positive = scalar >= -half_width
    else:
        positive = scalar > half_width
    return 1 if positive else -1
