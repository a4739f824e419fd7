"""Solves an SDPA sparse file with cvxpy and Clarabel: min c'y, sum y_i F_i - F_0 >= 0 by blocks."""
import sys

import cvxpy as cp
import numpy as np
import scipy.sparse as sp

lines = [line for line in open(sys.argv[1]) if not line.startswith('"')]
unknowns = int(lines[0])
sides = [int(word) for word in lines[2].split()]
cost = np.array([float(word) for word in lines[3].split()])
entries = [([], [], []) for _ in sides]
constants = [np.zeros((side, side)) for side in sides]
for line in lines[4:]:
    matrix, block, row, column, value = line.split()
    matrix, block, row, column = int(matrix), int(block) - 1, int(row) - 1, int(column) - 1
    for r, c in {(row, column), (column, row)}:
        if matrix == 0:
            constants[block][r, c] = float(value)
        else:
            rows, columns, values = entries[block]
            rows.append(c * sides[block] + r)
            columns.append(matrix - 1)
            values.append(float(value))
y = cp.Variable(unknowns)
constraints = []
for side, constant, (rows, columns, values) in zip(sides, constants, entries):
    coefficients = sp.csc_matrix((values, (rows, columns)), shape=(side * side, unknowns))
    matrix = cp.reshape(coefficients @ y, (side, side), order="F") - constant
    constraints.append(matrix >> 0)
problem = cp.Problem(cp.Minimize(cost @ y), constraints)
problem.solve(solver=cp.CLARABEL)
print("objective", problem.value, problem.status)
