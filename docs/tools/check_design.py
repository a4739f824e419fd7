#!/usr/bin/env python3
"""Checks a Steadfast design file in exact rational arithmetic, with Python's standard library only.

    check_design.py [--every N] DESIGN.json...

With --every N only each N-th vertex of the decrease condition is decided, for a quick look at a large file.
Written from the book ("The derivation", 'What "proved" means', "Local rules", "Uncertain inertia"), not from the
program. Every number of the file is a double, hence a rational; every condition is a symmetric rational matrix that
must be positive definite, decided by Bareiss' fraction-free elimination (all leading minors positive). Nothing is
rounded. Exit status: 0 every condition of every file holds, 2 some condition does not, 1 the file cannot be judged.
"""
import argparse
import itertools
import json
import sys
from fractions import Fraction as Q
from math import lcm


# ---- matrices: lists of rows of Fractions ------------------------------------------------------------------------
def mat(rows):
    return [[Q(entry) for entry in row] for row in rows]


def zeros(rows, columns):
    return [[Q(0)] * columns for _ in range(rows)]


def diagonal(entries):
    return [[entry if i == j else Q(0) for j in range(len(entries))] for i, entry in enumerate(entries)]


def eye(n):
    return diagonal([Q(1)] * n)


def t(a):
    return [list(column) for column in zip(*a)]


def mul(a, b):
    columns = t(b)
    return [[sum(x * y for x, y in zip(row, column) if x and y) for column in columns] for row in a]


def lin(*terms):
    """The sum of factor times matrix over the pairs given."""
    rows, columns = len(terms[0][1]), len(terms[0][1][0])
    return [[sum(c * a[i][j] for c, a in terms) for j in range(columns)] for i in range(rows)]


def both(a):
    return lin((1, a), (1, t(a)))


def positive_definite(a):
    """Whether the symmetric rational matrix is positive definite: Sylvester's criterion, minors by Bareiss."""
    if any(a[i][j] != a[j][i] for i in range(len(a)) for j in range(i)):
        raise ValueError("a matrix is not symmetric")
    # Scaling rows and columns by the same positive numbers changes nothing and keeps the integers short.
    powers = [2 ** round(row[i].denominator.bit_length() / 2) if row[i] < 1 else 1 for i, row in enumerate(a)]
    a = [[entry * powers[i] * powers[j] for j, entry in enumerate(row)] for i, row in enumerate(a)]
    common = lcm(*(entry.denominator for row in a for entry in row))
    a = [[int(entry * common) for entry in row] for row in a]
    n, last = len(a), 1
    for k in range(n):
        if a[k][k] <= 0:
            return False
        for i in range(k + 1, n):
            for j in range(i, n):
                a[i][j] = a[j][i] = (a[i][j] * a[k][k] - a[i][k] * a[k][j]) // last
        last = a[k][k]
    return True


def exp_above(x):
    """A rational not below e^x, x >= 0: Taylor's sum, and a geometric series above its remainder."""
    halvings = max(0, (x.numerator // x.denominator).bit_length() + 1)
    y, term, total = x / 2**halvings, Q(1), Q(1)
    for k in range(1, 25):
        term = term * y / k
        total += term
    above = total + 2 * term
    for _ in range(halvings):
        above = above * above
        above = Q(-((-above.numerator * 2**200) // above.denominator), 2**200)
    return above


# ---- the plant: E dx = A x + B (u - p) + Bw tau at every vertex, output C, limits, box ----------------------------
def cross(w):
    return [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]


def stack(blocks):
    return [sum((list(part) for part in parts), []) for row in blocks for parts in zip(*row)]


def inertias(exact):
    """The inertia, its half-widths and the corners of its set."""
    nominal = mat(exact["inertia_kg_m2"])
    given = exact.get("inertia_uncertainty") or {}
    part = [Q(given.get(key, 0)) for key in ("diagonal_percent", "off_diagonal_percent", "off_diagonal_kg_m2")]
    width = [[abs(nominal[i][j]) * (part[0] if i == j else part[1]) / 100 + (0 if i == j else part[2])
              for j in range(3)] for i in range(3)]
    places = [(i, j) for i in range(3) for j in range(i, 3) if width[i][j]]
    corners = []
    for signs in itertools.product((-1, 1), repeat=len(places)):
        corner = [list(row) for row in nominal]
        for sign, (i, j) in zip(signs, places):
            corner[i][j] = corner[j][i] = nominal[i][j] + sign * width[i][j]
        corners.append(corner)
    return nominal, width, corners


def rigid_body(exact, rate, q0_min, objective):
    weights = exact.get("output_weights") or {"rate_s": 0 if objective == "pointing" else 1, "attitude": 1}
    output = diagonal([Q(weights["rate_s"])] * 3 + [Q(weights["attitude"])] * 3)
    rate, q0_min = [Q(w) for w in rate], Q(q0_min)
    nominal, width, corners = inertias(exact)
    form = mat(exact.get("gyroscopic_form_kg_m2") or zeros(3, 3))
    vertices = []
    for j in corners:
        for *signs, q0 in itertools.product((-1, 1), (-1, 1), (-1, 1), (q0_min, Q(1))):
            w = cross([sign * bound for sign, bound in zip(signs, rate)])
            half = lin((Q(-1, 2), mat(w)))
            a = stack([[lin((1, mul(form, mat(w))), (-1, mul(mat(w), j))), zeros(3, 3)], [diagonal([q0 / 2] * 3), half]])
            vertices.append((stack([[j, zeros(3, 3)], [zeros(3, 3), eye(3)]]), a))
    b = stack([[eye(3)], [zeros(3, 3)]])
    box = [([eye(6)[i]], rate[i] ** 2) for i in range(3)] + [(eye(6)[3:], 1 - q0_min**2)]
    inertia = [lin((1, nominal), (-1, [[s[i] * width[i][j] * s[j] for j in range(3)] for i in range(3)]))
               for s in itertools.product((1,), (-1, 1), (-1, 1))]
    return {"vertices": vertices, "B": b, "Bw": b, "C": output, "box": box, "inertia": inertia,
            "limit": exact["torque_limit_nm"], "tau": exact["disturbance_bound_nm"]}


def given_matrices(data, state_matrices, box):
    n = len(state_matrices[0])
    b = mat(data["input_matrix"])
    own = data.get("disturbance_matrix")
    output = data.get("output_matrix")
    return {"vertices": [(eye(n), mat(a)) for a in state_matrices], "B": b, "Bw": mat(own) if own else b,
            "C": mat(output) if output else eye(n), "box": box, "inertia": [],
            "limit": data["input_limit"], "tau": data["disturbance_bound"]}


def plant_of(model, large):
    kind, data = next(iter(model["plant"].items()))
    if kind == "exact":
        source = model["specs"]["outer"] if large else data
        objective = model["specs"].get("objective")
        return rigid_body(data, source["rate_rad_s"], source["q0_min"], None if large else objective)
    if kind == "vertices":
        box = [([[Q(x) for x in side["row"]]], Q(side["bound"]) ** 2) for side in data.get("box") or []]
        return given_matrices(data, data["state_matrices"], box)
    if kind == "rules" and "linear" in data["system"]:
        bounds = data["state_bounds"]
        box = [([eye(len(bounds))[i]], Q(bound) ** 2) for i, bound in enumerate(bounds)]
        return given_matrices(data["system"]["linear"], [rule["state_matrix"] for rule in data["rules"]], box)
    raise ValueError(f"plants of the kind '{kind}' with frozen spacecraft rules are not known here")


# ---- the conditions ----------------------------------------------------------------------------------------------
def decrease(plant, vertex, r, cert, gain, weight, specs):
    """Minus the matrix of (18) in the coordinates [x; dx; xk; e; p; tau] (and the row of the integral for r = 2)."""
    (e, a), b, bw = vertex, plant["B"], plant["Bw"]
    u, y, qt, l1, l2 = (mat(cert[key]) for key in
                        ("lyapunov", "integral_weight", "multiplier", "free_state", "free_sample"))
    f, nn, m = mat(gain[0]), mat(gain[1]), diagonal([Q(x) for x in cert["sector_weight"]])
    e1, e2, e3 = (Q(x) for x in specs.get("eps") or (1, 1, 1))
    phi, hbar, nu, xi = Q(specs["phi"]), Q(specs["hbar_s"]), Q(specs["nu"]), Q(cert["xi"])
    qa, qe, qb, qw = mul(qt, a), mul(qt, e), mul(qt, b), mul(qt, bw)
    qbf, nm, w = mul(qb, f), mul(t(nn), m), mat(weight)
    n, inputs, d = len(a), len(m), len(bw[0])
    sizes = [n, n, n, n, inputs, d] + ([n] if r == 2 else [])
    start = [sum(sizes[:i]) for i in range(len(sizes))]
    out = zeros(sum(sizes), sum(sizes))

    def put(row, column, block):
        for i, entries in enumerate(block):
            for j, entry in enumerate(entries):
                out[start[row] + i][start[column] + j] = -entry
                out[start[column] + j][start[row] + i] = -entry

    put(0, 0, lin((e1, both(qa)), (phi, u), (1, both(l1))))
    put(0, 1, lin((1, u), (-e1, qe), (e2, t(qa))))
    put(0, 2, lin((e1, qbf), (e3, t(qa)), (-1, l1), (1, t(l2))))
    for row, eps in ((0, e1), (1, e2)):
        put(row, 3, lin((-eps, qbf)))
        put(row, 4, lin((-eps, qb)))
        put(row, 5, lin((eps, qw)))
    put(1, 1, lin((-e2, both(qe)), (hbar if r == 1 else 0, y)))
    put(1, 2, lin((-e3, t(qe)), (e2, qbf)))
    put(2, 2, lin((-1, both(l2)), (nu, w), (e3, both(qbf))))
    put(2, 3, lin((-e3, qbf), (-nu, w)))
    put(2, 4, lin((-e3, qb), (1, nm)))
    put(2, 5, lin((e3, qw)))
    put(3, 3, lin((nu - 1, w)))
    put(3, 4, lin((-1, nm)))
    put(4, 4, lin((-2, m)))
    put(5, 5, diagonal([-xi] * d))
    if r == 2:
        k = hbar * exp_above(phi * hbar)
        put(0, 6, lin((k, l1)))
        put(2, 6, lin((k, l2)))
        put(6, 6, lin((-k, y)))
    return out


def conditions(design, large, every=1):
    """Pairs of a name and a matrix that must be positive definite, for one of the certificates."""
    model, specs = design["model"], dict(design["model"]["specs"])
    specs["phi"] = specs["outer"]["phi_per_s"] if large else specs["phi_per_s"]
    must = (specs["outer"] if large else specs).get("must_contain") or []
    cert = design["outer"]["certificate"] if large else design["certificate"]
    multiple = Q(design["outer"]["trigger_multiple"]) if large else Q(1)
    if cert.get("mismatch"):
        raise ValueError("scheduled gains under a mismatch bound are not known here")
    further = ("measurement", "gain_error_weight", "first_torque")
    if model.get("imperfections") or design["controller"].get("trigger_floor") or any(map(cert.get, further)):
        raise ValueError("imperfections of the loop and a trigger floor are not known here")
    plant = plant_of(model, large)
    u, c = mat(cert["lyapunov"]), plant["C"]
    phi, xi, gamma = Q(specs["phi"]), Q(cert["xi"]), Q(cert["gamma"])
    level = max(Q(1), xi * Q(plant["tau"]) ** 2 / phi)
    weight = lin((multiple, mat(design["controller"]["trigger_weight"])))
    gains = list(zip(design["controller"]["gains"], cert["anti_windup"]))
    if len(gains) != len(design["controller"]["gains"]):
        raise ValueError("there must be one anti-windup matrix for each gain")

    def inside(rows, bound_squared):
        return stack([[lin((bound_squared / level, u)), t(rows)], [rows, eye(len(rows))]])

    yield from (("inertia positive", j) for j in plant["inertia"])
    yield "lyapunov positive", u
    yield "integral weight positive", mat(cert["integral_weight"])
    yield "trigger weight positive", weight
    yield from (("sector weight", [[Q(x)]]) for x in cert["sector_weight"])
    for gain in gains:
        for r in (1, 2):
            for i, vertex in list(enumerate(plant["vertices"], 1))[::every]:
                yield f"decrease r={r} vertex {i}", decrease(plant, vertex, r, cert, gain, weight, specs)
        difference = lin((1, mat(gain[0])), (-1, mat(gain[1])))
        for s, limit in enumerate(plant["limit"]):
            yield f"anti-windup input {s + 1}", inside([difference[s]], Q(limit) ** 2)
    yield "peak gain", stack([[lin((phi, u)), t(c)], [c, lin((gamma, eye(len(c))))]])
    yield "gain bound above disturbance weight", [[gamma - xi]]
    yield "disturbance weight positive", [[xi]]
    yield "guaranteed gain", lin((Q(cert["guaranteed_gain"]) ** 2 / xi * phi, u), (-1, mul(t(c), c)))
    yield from (("box", inside(rows, bound)) for rows, bound in plant["box"])
    for k, state in enumerate(must, 1):
        x = [[Q(entry) for entry in state]]
        yield f"must contain state {k}", [[1 - mul(mul(x, u), t(x))[0][0]]]
    if cert.get("certified_vector_part") is not None:
        s = Q(cert["certified_vector_part"])
        yield "certified attitudes", lin((1, eye(3)), (-s * s, [row[3:] for row in u[3:]]))
    for key, part in (("rate_rad_s", eye(6)[:3]), ("vector_part", eye(6)[3:])):
        bound = Q((cert.get("final_bounds") or {}).get(key, 0))
        if bound:
            yield f"final bound {key}", lin((bound**2, u), (-xi * Q(plant["tau"]) ** 2 / phi, mul(t(part), part)))


def hand_over(design):
    """Pairs as above: every state of the large set comes to x'Ux <= level, and under the first certificate there."""
    own, small, model = design["outer"]["hand_over"], design["certificate"], design["model"]
    large, level, nu = design["outer"]["certificate"], Q(own["level"]), Q(model["specs"]["nu"])
    u, weight = mat(large["lyapunov"]), mat(design["controller"]["trigger_weight"])
    plant = plant_of(model, False)
    yield "level reached", [[level - Q(large["xi"]) * Q(plant["tau"]) ** 2 / Q(model["specs"]["outer"]["phi_per_s"])]]
    yield "set contained", lin((1, u), (-level, mat(small["lyapunov"])))
    pairs = [(lin((1, mat(f)), (-1, mat(n))), s) for f, n in zip(design["controller"]["gains"], small["anti_windup"])
             for s in range(len(plant["limit"]))]
    if len(pairs) != len(own["held_state"]):
        raise ValueError("there must be one pair of weights for each input of each gain")
    for (difference, s), held in zip(pairs, own["held_state"]):
        a, b, row = Q(held["state_weight"]), Q(held["trigger_weight"]), [difference[s]]
        coupled = lin((-b, weight))
        yield "held state", stack([[lin((a, u), (b, weight)), coupled, t(zeros(1, len(u)))],
                                   [coupled, lin((b * (1 - nu), weight)), t(row)],
                                   [zeros(1, len(u)), row, eye(1)]])
        yield "held state weights", diagonal([a, b])
        yield "held state within limit", [[Q(plant["limit"][s]) ** 2 - a * level]]


def judge(path, every):
    """Checks one file, prints the outcome and returns its exit status."""
    try:
        with open(path, encoding="utf-8") as file:
            design = json.load(file)
        checked, failed = 0, []
        for large in [False] + [True] * ("outer" in design):
            for name, matrix in conditions(design, large, every):
                checked += 1
                if not positive_definite(matrix):
                    failed.append(("outer " if large else "") + name)
        for name, matrix in hand_over(design) if design.get("outer", {}).get("hand_over") else ():
            checked += 1
            if not positive_definite(matrix):
                failed.append("hand-over " + name)
    except (OSError, LookupError, TypeError, ValueError) as error:
        print(f"{path}: cannot be judged: {error!r}")
        return 1
    part = "" if every == 1 else f" (every {every}-th vertex)"
    print(f"{path}: {checked} conditions{part}, {'PROVED' if not failed else 'NOT PROVED: ' + ', '.join(failed[:5])}")
    return 2 if failed else 0


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--every", type=int, default=1, metavar="N")
    parser.add_argument("designs", nargs="+")
    options = parser.parse_args(arguments)
    status = 0
    for path in options.designs:
        status = max(status, judge(path, options.every))
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
