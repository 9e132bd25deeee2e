"""Bounds and linear constraints: scipy's objects and plain arrays become arrays for the engine."""

import numpy as np
from scipy.optimize import Bounds, LinearConstraint

from ._numbers import real


def read(bounds, constraints, n):
    """The admissible set as arrays, from bounds and a list of linear constraints: box, rows, sides of the rows."""
    lower, upper = _box(bounds, n)
    rows, row_lower, row_upper = [np.zeros((0, n))], [np.zeros(0)], [np.zeros(0)]
    for constraint in constraints:
        if isinstance(constraint, Bounds):
            low, high = _box(constraint, n)
            lower, upper = np.maximum(lower, low), np.minimum(upper, high)
            continue
        matrix, low, high = _rows(constraint, n)
        rows.append(matrix)
        row_lower.append(low)
        row_upper.append(high)
    return {
        "lower": lower,
        "upper": upper,
        "rows": np.ascontiguousarray(np.vstack(rows)),
        "row_lower": np.concatenate(row_lower),
        "row_upper": np.concatenate(row_upper),
    }


def side(value, n, what):
    """One side of n intervals; a single number stands for all."""
    given = real(value, what)
    if given.ndim > 1 or given.size not in (1, n):
        raise ValueError(f"{what} has shape {given.shape}, expected one number or {n}")
    if np.isnan(given).any():
        raise ValueError(f"{what} has entries that are NaN; infinity leaves a side open")
    return np.broadcast_to(given, (n,)).astype(float)


def _box(bounds, n):
    if bounds is None:
        return np.full(n, -np.inf), np.full(n, np.inf)
    if isinstance(bounds, Bounds):
        return side(bounds.lb, n, "bounds.lb"), side(bounds.ub, n, "bounds.ub")
    expected = f"bounds must be scipy.optimize.Bounds or {n} pairs (lower, upper), one per variable; None leaves a side open"
    if not np.iterable(bounds):
        raise TypeError(f"{expected}; found {type(bounds).__name__}")
    pairs = list(bounds)
    for index, pair in enumerate(pairs):
        if np.shape(pair) != (2,):
            raise ValueError(f"{expected}; entry {index} is {pair!r}")
    if len(pairs) != n:
        raise ValueError(f"{expected}; found {len(pairs)} pairs")
    lower = [-np.inf if low is None else low for low, _ in pairs]
    upper = [np.inf if high is None else high for _, high in pairs]
    return side(lower, n, "the lower bound"), side(upper, n, "the upper bound")


def listed(constraints):
    """One constraint or several as a list."""
    if constraints is None:
        return []
    if isinstance(constraints, (list, tuple)):
        # (A, lower, upper) as plain arrays, as LinearConstraint(*...) takes them.
        if len(constraints) in (2, 3) and _is_matrix(constraints[0]):
            return [LinearConstraint(*constraints)]
        return list(constraints)
    return [constraints]


def _is_matrix(value):
    return hasattr(value, "toarray") or (isinstance(value, (list, np.ndarray)) and np.ndim(value) >= 1)


def _rows(constraint, n):
    if isinstance(constraint, (list, tuple)) and len(constraint) in (2, 3) and _is_matrix(constraint[0]):
        constraint = LinearConstraint(*constraint)
    if not isinstance(constraint, LinearConstraint):
        raise _refused(constraint)
    matrix = constraint.A.toarray() if hasattr(constraint.A, "toarray") else np.asarray(constraint.A, dtype=float)
    matrix = np.atleast_2d(matrix).astype(float)
    if matrix.ndim != 2 or matrix.shape[1] != n:
        raise ValueError(f"the matrix of a linear constraint has shape {matrix.shape}, expected {n} columns")
    m = matrix.shape[0]
    return matrix, side(constraint.lb, m, "constraint.lb"), side(constraint.ub, m, "constraint.ub")


def _refused(constraint):
    if isinstance(constraint, dict):
        return ValueError(
            "a constraint is a dict {'type', 'fun'}, which does not say what it is: pass scipy.optimize.LinearConstraint(A, lb, ub) "
            "for A x, or scipy.optimize.NonlinearConstraint(fun, lb, ub, jac)"
        )
    return TypeError(
        f"a constraint is {type(constraint).__name__}, expected scipy.optimize.LinearConstraint, scipy.optimize.NonlinearConstraint "
        "or (A, lower, upper), where A is a list of rows, an array or a sparse matrix, not a tuple"
    )
