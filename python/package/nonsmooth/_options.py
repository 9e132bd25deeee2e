"""Options: names, types, defaults, and their form for the engine."""

import difflib
import json
import math
import numbers
from collections.abc import Mapping

import numpy as np

from ._numbers import real

#: Names under which scipy's methods know an option.
SCIPY_NAMES = {"tol": "tolerance", "maxfev": "max_evaluations", "maxfun": "max_evaluations", "maxiter": "max_iterations"}

#: What the engine counts up to.
_NO_LIMIT = 2**63 - 1

_REAL, _COUNT, _FLAG = "a number", "an integer", "True or False"

#: Type of every option that is passed on as it is. The engine checks the ranges.
PLAIN = {
    "tolerance": _REAL,
    "objective_scale": _REAL,
    "max_evaluations": _COUNT,
    "max_iterations": _COUNT,
    "max_seconds": _REAL,
    "first_step": _REAL,
    "bundle_size": _COUNT,
    "confirm": _FLAG,
}

#: Options with a form of their own.
SPECIAL = ("convex", "scaling", "x_scale", "accuracy", "disp")

NAMES = (*PLAIN, *SPECIAL)


def read(options, n, accepts_accuracy, tol=None, x_scale=None):
    """The options and keywords of a run of n variables as the engine takes them: JSON, scaling, whether a table is printed."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"options is {type(options).__name__}, expected a dict")
    given = [(f"option {name!r}", name, value) for name, value in (options or {}).items()]
    given += [("tol", "tol", tol), ("x_scale", "x_scale", x_scale)]
    known, places = {}, {}
    for place, name, value in given:
        canonical = SCIPY_NAMES.get(name, name)
        if canonical not in NAMES:
            raise ValueError(_unknown(name))
        # None stands for the default.
        if value is None:
            continue
        if canonical in known and not _same(known[canonical], value):
            raise ValueError(
                f"{canonical} is given twice with different values: {places[canonical]} = {known[canonical]!r}, {place} = {value!r}"
            )
        known[canonical], places[canonical] = value, place
    config = {name: _plain(name, known[name]) for name in PLAIN if name in known}
    config["convexity"] = "convex" if _flag("convex", known.get("convex", False)) else "unknown"
    config["accuracy"] = _accuracy(known.get("accuracy", "on_demand" if accepts_accuracy else "tightest"))
    return json.dumps(config), _scaling(known, n), _flag("disp", known.get("disp", False))


def _same(first, second):
    return np.array_equal(np.asarray(first, dtype=object), np.asarray(second, dtype=object))


def _unknown(name):
    near = difflib.get_close_matches(str(name), [*NAMES, *SCIPY_NAMES], n=1, cutoff=0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"unknown option {name!r}; {hint}allowed: {', '.join(sorted(NAMES))}"


def _wrong(name, value, expected):
    return TypeError(f"option {name} = {value!r} is not allowed; expected {expected}")


def _flag(name, value):
    if not isinstance(value, (bool, np.bool_)):
        raise _wrong(name, value, _FLAG)
    return bool(value)


def _plain(name, value):
    kind = PLAIN[name]
    if kind is _FLAG:
        return _flag(name, value)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise _wrong(name, value, kind)
    if kind is _COUNT:
        # 1e4 is what many write for a limit.
        if not math.isfinite(value) or int(value) != value or value < 0:
            raise _wrong(name, value, "an integer ≥ 0")
        return min(int(value), _NO_LIMIT)
    if not math.isfinite(value):
        raise _wrong(name, value, "a finite number")
    return float(value)


def _accuracy(value):
    if value in ("tightest", "on_demand") if isinstance(value, str) else False:
        return value if value == "tightest" else {"on_demand": {"tightest": 1e-12, "coarsest": 1e-2, "factor": 0.1}}
    if isinstance(value, (tuple, list)) and len(value) == 3:
        parts = real(value, "option accuracy").tolist()
        return {"on_demand": dict(zip(("tightest", "coarsest", "factor"), parts))}
    raise _wrong("accuracy", value, "'tightest', 'on_demand' or (tightest, coarsest, factor)")


def _scaling(known, n):
    """Sizes of the variables, a matrix, or none."""
    if "x_scale" in known:
        if "scaling" in known:
            raise ValueError("x_scale and the option scaling are both given: pass the sizes of the variables once")
        return _sizes(known["x_scale"], n)
    if "scaling" not in known:
        return None
    scaling = real(known["scaling"], "option scaling")
    if scaling.ndim not in (1, 2):
        raise _wrong("scaling", known["scaling"], "one size per variable, or a regular matrix")
    return scaling


def _sizes(value, n):
    """Typical sizes of n variables; a single number stands for all."""
    sizes = real(value, "x_scale")
    if sizes.shape not in ((), (n,)):
        raise ValueError(f"x_scale has shape {sizes.shape}, expected one number or {n}")
    if not (np.isfinite(sizes) & (sizes > 0)).all():
        raise ValueError(f"x_scale = {value!r} is not allowed; allowed: finite numbers > 0")
    return np.broadcast_to(sizes, (n,)).copy()
