#!/usr/bin/env python3
"""Checks the proof of a law with a trigger on the command in exact rational arithmetic, with Python's standard library only.

    check_command_design.py DESIGN.json...

Written from the book ("A trigger on the command"), not from the program: the functional's derivative is put together
term by term over the signals x, x', x(t_k), e, p, tau. Exit status as of check_design.py, whose exact arithmetic it uses.
"""
import itertools
import json
import sys
from fractions import Fraction as Q

from check_design import both, cross, diagonal, exp_above, eye, lin, mat, mul, positive_definite, stack, t, zeros

MATRICES = ("lyapunov", "integral_weight", "state_multiplier", "rate_multiplier", "free_state", "free_sample",
            "annihilator_state", "annihilator_rate")


def stages(design):
    """(prefix, certificate, rate box, q0_min, phi) of each certificate."""
    model = design["model"]
    exact, specs = model["plant"]["exact"], model["specs"]
    if model.get("imperfections") or exact.get("inertia_uncertainty"):
        raise ValueError("imperfections and uncertain inertias are not known here")
    last = specs["command_trigger"].get("final")
    if (last is None) != (design.get("hand_over") is None):
        raise ValueError("a second certificate stands exactly where the model has specs.command_trigger.final")
    yield "", design["certificate"], exact["rate_rad_s"], exact["q0_min"], specs["phi_per_s"]
    if last:
        own = design["hand_over"]["certificate"]
        yield "final set ", own, last["rate_rad_s"], last["q0_min"], last["phi_per_s"]


def vertices(inertia, rate, q0_min):
    """A of diag(J, I) x' = A x + [I; 0] (u + tau), and [w^x, 0], at the corners of the box."""
    for *signs, q0 in itertools.product((-1, 1), (-1, 1), (-1, 1), (q0_min, Q(1))):
        spin = mat(cross([sign * bound for sign, bound in zip(signs, rate)]))
        half = lin((Q(-1, 2), spin))
        a = stack([[lin((-1, mul(spin, inertia))), zeros(3, 3)], [diagonal([q0 / 2] * 3), half]])
        yield a, stack([[spin, zeros(3, 3)]])


def signals(saturates):
    """Each signal as the rows that pick it out of (x, x', x(t_k), e, p, tau); without p where nothing saturates."""
    sizes = [6, 6, 6, 3, 3 if saturates else 0, 3]
    whole, start = eye(sum(sizes)), 0
    for size in sizes:
        yield whole[start:start + size]
        start += size


def decrease(law, cert, phi, hbar, vertex):
    """Minus the two matrices of one vertex: r = 1, and r = 2 with the rows of the integral."""
    inertia, gain, relative, _ = law
    (a, spin), theta = vertex, Q(cert["within_limit"])
    u, y, q1, q2, l1, l2, r1, r2 = (mat(cert[key]) for key in MATRICES)
    x, rate, xk, e, p, tau = signals(theta != 1)
    m, c, xi = (Q(cert[key]) for key in ("command_weight", "command_split", "xi"))
    descriptor = stack([[inertia, zeros(3, 3)], [zeros(3, 3), eye(3)]])
    b = stack([[eye(3)], [zeros(3, 3)]])
    command = lin((1, mul(gain, xk)), (1, e))
    pushed = lin((1, command), (1, tau)) if theta == 1 else lin((1, command), (-1, p), (1, tau))
    motion = lin((1, mul(a, x)), (1, mul(b, pushed)), (-1, mul(descriptor, rate)))

    def product(left, right):
        return both(mul(t(left), right))

    def square(rows, weight):
        return mul(t(rows), lin((weight, rows)))

    path = lin((1, mul(t(l1), x)), (1, mul(t(l2), xk)))
    terms = [
        (1, product(mul(u, x), rate)),
        (phi, mul(t(x), mul(u, x))),
        (1, product(lin((1, mul(t(q1), x)), (1, mul(t(q2), rate))), motion)),
        (1, product(lin((1, mul(t(r1), x)), (1, mul(t(r2), rate))), mul(spin, x))),
        (1, product(path, lin((1, x), (-1, xk)))),
        (1, square(mul(gain, xk), (1 + c) * m * relative**2)),
        (1, square(e, -m)),
        (1, square(tau, -xi)),
    ]
    if theta != 1:
        sector = diagonal([Q(weight) for weight in cert["sector_weight"]])
        terms.append((-1, product(mul(sector, p), lin((1, p), (theta - 1, command)))))
    common = lin(*terms)
    first = lin((-1, common), (-hbar, mul(t(rate), mul(y, rate))))
    k = hbar * exp_above(phi * hbar)
    beside = lin((-k, t(path)))
    return first, stack([[lin((-1, common)), beside], [t(beside), lin((k, y))]])


def conditions(design):
    """Pairs of a name and a matrix that must be positive definite."""
    exact, specs = design["model"]["plant"]["exact"], design["model"]["specs"]
    trigger = design["controller"]["trigger"]["command"]
    relative, absolute = Q(trigger["relative"]), Q(trigger["absolute_nm"])
    inertia, gain = mat(exact["inertia_kg_m2"]), mat(design["controller"]["gain"])
    limits = [Q(limit) for limit in exact["torque_limit_nm"]]
    law, hbar, found = (inertia, gain, relative, absolute), Q(specs["hbar_s"]), []
    yield "inertia positive", inertia
    for prefix, cert, rate, q0_min, phi in stages(design):
        rate, q0_min, phi = [Q(bound) for bound in rate], Q(q0_min), Q(phi)
        u, theta = mat(cert["lyapunov"]), Q(cert["within_limit"])
        m, c, xi = (Q(cert[key]) for key in ("command_weight", "command_split", "xi"))
        reached = (xi * Q(exact["disturbance_bound_nm"]) ** 2 + m * (1 + 1 / c) * absolute**2) / phi
        found.append((u, reached, theta))
        yield prefix + "lyapunov positive", u
        yield prefix + "integral weight positive", mat(cert["integral_weight"])
        for number in (theta, m, c, xi, *(Q(weight) for weight in cert["sector_weight"])):
            yield prefix + "number positive", [[number]]
        for i, vertex in enumerate(vertices(inertia, rate, q0_min), 1):
            for r, matrix in enumerate(decrease(law, cert, phi, hbar, vertex), 1):
                yield f"{prefix}decrease r={r} vertex {i}", matrix
        yield prefix + "supply below the set", [[1 - reached]]
        sides = [([eye(6)[i]], rate[i] ** 2) for i in range(3)] + [(eye(6)[3:], 1 - q0_min**2)]
        sides += [([[theta * entry for entry in gain[s]]], limits[s] ** 2) for s in range(3)]
        yield from ((prefix + "inside", inside(u, rows, bound)) for rows, bound in sides)
        radius = Q(cert["certified_vector_part"])
        yield prefix + "certified attitudes", lin((1, eye(3)), (-radius**2, [row[3:] for row in u[3:]]))
        for key, first in (("rate_rad_s", 0), ("vector_part", 3)):
            part = diagonal([reached if first <= i < first + 3 else Q(0) for i in range(6)])
            yield f"{prefix}final {key}", lin((Q(cert["final_bounds"][key]) ** 2, u), (-1, part))
    for state in specs.get("must_contain") or []:
        x = mat([state])
        yield "must contain", [[1 - mul(mul(x, found[0][0]), t(x))[0][0]]]
    if len(found) == 2:
        (first, reached, _), (last, _, theta), level = *found, Q(design["hand_over"]["level"])
        yield "hand-over level reached", [[level - reached]]
        yield "hand-over set contained", lin((1, first), (-level, last))
        for limit in limits:
            room = (limit / theta - absolute) / (1 + relative)
            yield "held command, room", [[room]]
            yield "held command within limit", inside(first, gain, room**2 / level)


def inside(u, rows, bound_squared):
    """Positive definite where |rows x|^2 < bound_squared wherever x'Ux <= 1."""
    return stack([[lin((bound_squared, u)), t(rows)], [rows, eye(len(rows))]])


def judge(path):
    """Checks one file, prints the outcome and returns its exit status."""
    try:
        with open(path, encoding="utf-8") as file:
            design = json.load(file)
        checked, failed = 0, []
        for name, matrix in conditions(design):
            checked += 1
            failed += [] if positive_definite(matrix) else [name]
    except (OSError, LookupError, TypeError, ValueError) as error:
        print(f"{path}: cannot be judged: {error!r}")
        return 1
    print(f"{path}: {checked} conditions, {'PROVED' if not failed else 'NOT PROVED: ' + ', '.join(failed[:5])}")
    return 2 if failed else 0


if __name__ == "__main__":
    sys.exit(max(judge(path) for path in sys.argv[1:]) if sys.argv[1:] else __doc__)
