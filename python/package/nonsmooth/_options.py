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
    "serious_fraction": _REAL,
    "good_fraction": _REAL,
    "weight_decrease": _REAL,
    "weight_increase": _REAL,
    "weight_range": _REAL,
    "attenuation_steps": _COUNT,
    "max_restarts": _COUNT,
    "restart_radius": _REAL,
    "max_failures": _COUNT,
    "composite_model": _FLAG,
    "curved_model": _FLAG,
}

#: Options with a form of their own.
SPECIAL = ("convex", "scaling", "accuracy", "exploration", "disp")

NAMES = (*PLAIN, *SPECIAL)


def read(options, accepts_accuracy):
    """The options as the engine takes them: JSON, scaling, whether a table is printed."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"options is {type(options).__name__}, expected a dict")
    known = {}
    for given, value in (options or {}).items():
        name = SCIPY_NAMES.get(given, given)
        if name not in NAMES:
            raise ValueError(_unknown(given))
        if name in known:
            raise ValueError(f"option {name!r} is given twice, once as {given!r}")
        known[name] = value
    # None stands for the default.
    known = {name: value for name, value in known.items() if value is not None}
    config = {name: _plain(name, known[name]) for name in PLAIN if name in known}
    config["convexity"] = "convex" if _flag("convex", known.get("convex", False)) else "unknown"
    config["accuracy"] = _accuracy(known.get("accuracy", "on_demand" if accepts_accuracy else "tightest"))
    config.update(_proposer("exploration", known.get("exploration", True)))
    return json.dumps(config), _scaling(known.get("scaling")), _flag("disp", known.get("disp", False))


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


def _proposer(name, value):
    if isinstance(value, dict):
        return {name: value}
    return {} if _flag(name, value) else {name: None}


def _scaling(value):
    if value is None:
        return None
    sizes = real(value, "option scaling")
    if sizes.ndim not in (1, 2):
        raise _wrong("scaling", value, "one size per variable, or a regular matrix")
    return sizes
