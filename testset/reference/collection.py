"""How a constrained problem is written down. Indices count from zero."""

import math

import numpy as np

INF = math.inf
SMOOTH, EIGENVALUE = [], []


def add(name, start, objective, constraints, lower=-INF, upper=INF, linear=(), known=None):
    """objective: x -> (outer, pieces); constraints: x -> list of (kind, outer, pieces); linear: numbers of linear ones;
    known: the optimal value, as it is published or in closed form."""
    n = len(start)
    SMOOTH.append(
        {
            "name": name,
            "n": n,
            "start": np.array(start, float),
            "lower": np.broadcast_to(np.array(lower, float), n).copy(),
            "upper": np.broadcast_to(np.array(upper, float), n).copy(),
            "objective": objective,
            "constraints": constraints,
            "linear": set(linear),
            "known": known,
        }
    )


def le(*values):
    return [("smooth", "identity", [v]) for v in values]


def eq(*values):
    return [("equality", "identity", [v]) for v in values]


def plain(f):
    return lambda x: ("identity", [f(x)])


def largest(f):
    return lambda x: ("maximum", f(x))


def items(x, n):
    return [x[i] for i in range(n)]


def squares(x, n, center=0.0):
    return sum((x[i] - center) ** 2 for i in range(n))


def add_eigenvalue(name, start, cost, matrices, lower=-INF, upper=INF, known=None):
    n = len(start)
    EIGENVALUE.append(
        {
            "name": name,
            "n": n,
            "start": np.array(start, float),
            "lower": np.broadcast_to(np.array(lower, float), n).copy(),
            "upper": np.broadcast_to(np.array(upper, float), n).copy(),
            "cost": np.array(cost, float),
            "matrices": [(np.array(a0, float), np.array(a, float)) for a0, a in matrices],
            "known": known,
        }
    )
