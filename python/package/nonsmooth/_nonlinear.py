"""Nonlinear constraints: scipy's objects, and constraints that come with the function, as rows c <= 0 and c = 0 for the engine."""

import json

import numpy as np
import scipy.optimize

from ._constraints import side
from ._engine import OutsideDomain
from ._numbers import real

#: Kinds that a user names, and the engine's names of them.
KINDS = {"smooth": "smooth", "nonsmooth": "nonsmooth", "equality": "smooth_equality"}

_NO_NONSMOOTH_EQUALITY = (
    "a nonsmooth constraint cannot be an equality: next to a kink, no linearization can be satisfied on both sides. Pass c <= 0, "
    "or a smooth function of which both sides are known"
)


class NonlinearConstraint(scipy.optimize.NonlinearConstraint):
    """``lb <= fun(x) <= ub`` with a function that may have kinks: scipy's class, with the Jacobian required.

    Parameters
    ----------
    fun : callable
        ``fun(x)`` returns m values, or a number.
    lb, ub : array_like
        Sides of the m values, or one number for all; infinity leaves a side open, equal sides make an equality.
    jac : callable
        ``jac(x)`` returns the m × n matrix of derivatives, or n entries for m = 1. Where ``fun`` has a kink, any of its
        subgradients is right.
    nonsmooth : bool
        Whether ``fun`` has kinks. Equalities cannot be nonsmooth.
    """

    def __init__(self, fun, lb, ub, jac, *, nonsmooth=False):
        super().__init__(fun, lb, ub, jac=jac)
        self.nonsmooth = nonsmooth


def is_nonlinear(constraint):
    """Whether an object has the attributes of scipy's nonlinear constraints."""
    return all(hasattr(constraint, name) for name in ("fun", "lb", "ub", "jac"))


class Nonlinear:
    """All nonlinear constraints of a run.

    The engine numbers their rows through: first those that the function returns, then those of the objects.
    """

    def __init__(self, constraints, kinds, start):
        """``constraints``: pairs of the position in the user's list and the object; ``start``: a point within the bounds."""
        kinds = _kinds(kinds)
        self._apart = [_Apart(place, constraint, start) for place, constraint in constraints]
        self._rows = [_Rows.returned(kinds)] if kinds else []
        self._returned = len(kinds)
        self._rows += [constraint.rows for constraint in self._apart]

    def __bool__(self):
        return bool(self._rows)

    @property
    def kinds(self):
        """The engine's names of the kinds, one per row."""
        return [kind for rows in self._rows for kind in rows.kinds]

    @property
    def setup(self):
        """What the engine is told, none where no row is left."""
        kinds = self.kinds
        if not kinds:
            return None
        return {"kinds": json.dumps(kinds), "returned": self._returned, "apart": self._evaluate if self._apart else None}

    def identity(self, name):
        """What a journal is to know the run by."""
        counts = [f"{self.kinds.count(kind)} {kind}" for kind in KINDS.values() if kind in self.kinds]
        return f"{name} with constraints: {', '.join(counts)}" if counts else name

    @property
    def sides(self):
        """Which components are bounded by which sides."""
        return [(rows.index, rows.sign, rows.sides, rows.kinds) for rows in self._rows]

    def _evaluate(self, x):
        found = [constraint(x.copy()) for constraint in self._apart]
        return np.concatenate([values for values, _ in found]), np.vstack([jacobian for _, jacobian in found])

    def found(self, reports):
        """Values, largest violation and multipliers in the user's terms, from the engine's reports of the rows."""
        values = np.array([report["value"] for report in reports])
        multipliers = np.array([report["multiplier"] for report in reports])
        equal = np.array([report["kind"] == "smooth_equality" for report in reports], dtype=bool)
        violation = np.where(equal, np.abs(values), values).max(initial=0.0)
        ends = np.cumsum([rows.count for rows in self._rows])[:-1] if self._rows else []
        pairs = list(zip(self._rows, np.split(values, ends), np.split(multipliers, ends)))
        return {
            "constr": [rows.values(part) for rows, part, _ in pairs],
            "constr_violation": float(violation),
            "multipliers": [rows.multipliers(part) for rows, _, part in pairs],
        }


class _Rows:
    """Rows of the engine: ``sign * (c[index] - side)``, for m components c of a constraint."""

    def __init__(self, size, index, sign, sides, kinds):
        self.size, self.index, self.sign, self.sides, self.kinds = size, index, sign, sides, kinds

    @classmethod
    def returned(cls, kinds):
        m = len(kinds)
        return cls(m, np.arange(m), np.ones(m), np.zeros(m), [KINDS[kind] for kind in kinds])

    @classmethod
    def between(cls, lower, upper, kind):
        equal = lower == upper
        parts = [
            (equal, 1.0, lower, "smooth_equality"),
            (np.isfinite(upper) & ~equal, 1.0, upper, kind),
            (np.isfinite(lower) & ~equal, -1.0, lower, kind),
        ]
        index = [np.flatnonzero(chosen) for chosen, *_ in parts]
        sign = [np.full(chosen.sum(), sign) for chosen, sign, *_ in parts]
        sides = [sides[chosen] for chosen, _, sides, _ in parts]
        kinds = [kind for chosen, _, _, kind in parts for _ in range(chosen.sum())]
        return cls(lower.size, np.concatenate(index), np.concatenate(sign), np.concatenate(sides), kinds)

    @property
    def count(self):
        return len(self.kinds)

    def of(self, values, jacobian):
        return self.sign * (values[self.index] - self.sides), self.sign[:, None] * jacobian[self.index]

    def values(self, rows):
        values = np.full(self.size, np.nan)
        values[self.index] = self.sides + self.sign * rows
        return values

    def multipliers(self, rows):
        multipliers = np.zeros(self.size)
        np.add.at(multipliers, self.index, self.sign * rows)
        return multipliers


class _Apart:
    """A constraint with a function of its own; ``place`` is its position in the user's list."""

    def __init__(self, place, constraint, start):
        self._name = f"constraints[{place}]"
        self._fun, self._jac = constraint.fun, constraint.jac
        self._check(constraint)
        lower, upper = (real(value, f"{self._name}.{name}") for name, value in (("lb", constraint.lb), ("ub", constraint.ub)))
        self._known = None
        # Two numbers as sides fit any number of components: the function has to say it.
        size = max(lower.size, upper.size) if lower.ndim or upper.ndim else self._probe(start)
        lower, upper = side(lower, size, f"{self._name}.lb"), side(upper, size, f"{self._name}.ub")
        for which, wrong in ((f"lb = {np.inf}", lower == np.inf), (f"ub = {-np.inf}", upper == -np.inf), ("lb > ub", lower > upper)):
            if wrong.any():
                raise ValueError(f"{self._name}: component {np.flatnonzero(wrong)[0]} has {which}, which no point satisfies")
        nonsmooth = bool(getattr(constraint, "nonsmooth", False))
        if nonsmooth and (lower == upper).any():
            component = np.flatnonzero(lower == upper)[0]
            raise ValueError(f"{self._name}: component {component} has lb = ub, but {_NO_NONSMOOTH_EQUALITY}")
        self.rows = _Rows.between(lower, upper, "nonsmooth" if nonsmooth else "smooth")

    def _check(self, constraint):
        if not callable(self._fun):
            raise TypeError(f"{self._name}: fun is {type(self._fun).__name__}, expected a function")
        if not callable(self._jac):
            raise ValueError(
                f"{self._name}: jac = {self._jac!r} is not allowed: pass a function that returns the (m, n) Jacobian. scipy's "
                "finite differences, '2-point' by default, are no subgradients, and each would cost further evaluations"
            )
        if np.any(getattr(constraint, "keep_feasible", False)):
            raise ValueError(
                f"{self._name}: keep_feasible = True cannot be promised: points that are evaluated may violate nonlinear "
                "constraints. They never violate bounds and linear constraints"
            )

    def _probe(self, start):
        self._known = (start.copy(), self._fun(start.copy()))
        return np.atleast_1d(real(self._known[1], f"what {self._name}.fun returns")).size

    def _values(self, x):
        known, self._known = self._known, None
        return known[1] if known is not None and np.array_equal(known[0], x) else self._fun(x.copy())

    def __call__(self, x):
        values = np.atleast_1d(real(self._values(x), f"what {self._name}.fun returns"))
        if values.shape != (self.rows.size,):
            raise ValueError(f"{self._name}.fun returns values of shape {values.shape}, expected {(self.rows.size,)}")
        jacobian = self._jac(x)
        jacobian = real(jacobian.toarray() if hasattr(jacobian, "toarray") else jacobian, f"what {self._name}.jac returns")
        expected = (values.size, x.size)
        if jacobian.ndim < 2 and 1 in expected and jacobian.size == max(expected):
            jacobian = jacobian.reshape(expected)
        if jacobian.shape != expected:
            raise ValueError(
                f"{self._name}.jac returns an array of shape {jacobian.shape}, expected {expected} (components, variables)"
            )
        values, jacobian = self.rows.of(values, jacobian)
        self._check_finite("fun", values)
        self._check_finite("jac", jacobian)
        return values, jacobian

    def _check_finite(self, what, rows):
        wrong = ~np.isfinite(rows)
        if wrong.any():
            row = np.flatnonzero(wrong.reshape(len(rows), -1).any(axis=1))[0]
            raise OutsideDomain(f"{self._name}.{what} has an entry in component {self.rows.index[row]} that is not finite")


def _kinds(kinds):
    """The kinds of constraints that the function returns."""
    allowed = ", ".join(repr(kind) for kind in KINDS)
    if isinstance(kinds, str) or not np.iterable(kinds):
        raise TypeError(f"constraint_kinds = {kinds!r} is not allowed; expected a list of {allowed}")
    kinds = list(kinds)
    for place, kind in enumerate(kinds):
        if not isinstance(kind, str) or kind not in KINDS:
            hint = f"; {_NO_NONSMOOTH_EQUALITY}" if str(kind) == "nonsmooth_equality" else ""
            raise ValueError(f"constraint_kinds[{place}] = {kind!r} is unknown; allowed: {allowed}{hint}")
    return kinds
