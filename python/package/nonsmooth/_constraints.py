"""Bounds and linear constraints: scipy's objects and plain arrays become arrays for the engine."""

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint


def read(bounds, constraints, n):
    """The admissible set as arrays: box, rows, sides of the rows."""
    lower, upper = _box(bounds, n)
    rows, row_lower, row_upper = [np.zeros((0, n))], [np.zeros(0)], [np.zeros(0)]
    for constraint in _list(constraints):
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


def _side(value, n, what):
    """One side of n intervals; a single number stands for all."""
    side = np.asarray(value, dtype=float)
    if side.ndim > 1 or side.size not in (1, n):
        raise ValueError(f"{what} has shape {side.shape}, expected one number or {n}")
    return np.broadcast_to(side, (n,)).astype(float)


def _box(bounds, n):
    if bounds is None:
        return np.full(n, -np.inf), np.full(n, np.inf)
    if isinstance(bounds, Bounds):
        return _side(bounds.lb, n, "bounds.lb"), _side(bounds.ub, n, "bounds.ub")
    pairs = list(bounds)
    if len(pairs) != n or any(np.shape(pair) != (2,) for pair in pairs):
        raise ValueError(
            f"bounds must be scipy.optimize.Bounds or {n} pairs (lower, upper), one per variable; None leaves a side "
            f"open; found {len(pairs)} entries"
        )
    lower = [-np.inf if low is None else float(low) for low, _ in pairs]
    upper = [np.inf if high is None else float(high) for _, high in pairs]
    return np.array(lower), np.array(upper)


def _list(constraints):
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
    return matrix, _side(constraint.lb, m, "constraint.lb"), _side(constraint.ub, m, "constraint.ub")


def _refused(constraint):
    if isinstance(constraint, (NonlinearConstraint, dict)):
        return ValueError(
            "nonlinear constraints are not supported, and a dict {'type', 'fun'} cannot be seen to be linear: pass "
            "scipy.optimize.LinearConstraint(A, lb, ub) for A x, or add a penalty rho*max(0, g(x)) to the function"
        )
    return TypeError(
        f"a constraint is {type(constraint).__name__}, expected scipy.optimize.LinearConstraint or (A, lower, upper)"
    )
