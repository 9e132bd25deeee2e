"""A user's script for `mypy --strict`, which .ci/python runs: the forms of calls that the stubs must admit. It is not executed."""

from pathlib import Path

import numpy as np
import scipy.optimize
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint

import nonsmooth
from nonsmooth.contact import SLIP, Scene

Array = NDArray[np.float64]


def fun(x: Array) -> tuple[float, Array]:
    r = x - np.array([1.0, 2.0])
    return float(np.abs(r).sum()), np.sign(r)


def value(x: Array) -> float:
    return fun(x)[0]


def slope(x: Array) -> Array:
    return fun(x)[1]


def outputs(x: Array) -> tuple[Array, Array]:
    return x, np.eye(2)


def told(xk: Array) -> None:
    print(xk)


def informed(intermediate_result: scipy.optimize.OptimizeResult) -> None:
    print(intermediate_result)


result: nonsmooth.Result = nonsmooth.minimize(fun, [5.0, -3.0], bounds=Bounds([0, 0], [9, 9]))
nonsmooth.minimize(fun, (5, -3), bounds=[(0, None), (None, 9)])
nonsmooth.minimize(fun, np.zeros(2), bounds=np.array([[0, 1], [0, 1]]), constraints=LinearConstraint([[1, 1]], 0, 2))
nonsmooth.minimize(fun, [5, -3], constraints=([[1, 1]], -np.inf, 2))
nonsmooth.minimize(fun, [5, -3], constraints=[LinearConstraint([[1, 1]], 0, 2), Bounds(0, 1)])
nonsmooth.minimize(fun, [5, -3], constraints=Bounds(0, 1), args=3.0)
ring = NonlinearConstraint(lambda x: x @ x, 1, 4, jac=lambda x: 2 * x)
kinked = nonsmooth.NonlinearConstraint(value, -np.inf, [3.0], slope, nonsmooth=True)
nonsmooth.minimize(fun, [5, -3], constraints=ring)
nonsmooth.minimize(fun, [5, -3], constraints=[kinked, LinearConstraint([[1, 1]], 0, 2)])
nonsmooth.minimize(lambda x: (*fun(x), [x @ x - 4], [2 * x]), [5, -3], constraint_kinds=["smooth"])
nonsmooth.minimize_composite("max", outputs, [1.0, 2.0], constraints=ring)
nonsmooth.minimize(value, [5, -3], jac=slope, callback=told, options={"convex": True, "maxfev": 30})
nonsmooth.minimize(fun, [5, -3], callback=informed, journal=Path("folder"), options=dict(tolerance=1e-5))
options = {"convex": True, "max_evaluations": np.int64(30)}
nonsmooth.minimize(fun, [5, -3], options=options)
nonsmooth.minimize_composite("max", outputs, [1.0, 2.0])
nonsmooth.minimize_composite(lambda c: (float(np.abs(c).sum()), np.sign(c)), outputs, [1.0, 2.0])
nonsmooth.minimize_composite("hinge", outputs, [1.0, 2.0], smooth=fun, weight=0.1, tol=1e-8, x_scale=2.0)
nonsmooth.minimize_composite("norm", outputs, [1.0, 2.0], groups=[1, 1])
nonsmooth.minimize(fun, [5, -3], tol=1e-8, x_scale=[1.0, 1e3])
scipy.optimize.minimize(fun, [5.0, -3.0], jac=True, method=nonsmooth.bundle_trust)
least: float = result.fun
point: Array = result.x
confirmed: bool = result.success
row_multipliers: list[Array] = result.multipliers
worst: float = result.constr_violation
if result.certificate is not None:
    multipliers: Array = result.certificate.multipliers
print(result.recheck().agrees, result.history[0]["value"], result.gap)
print(nonsmooth.taylor_test(fun, [1.0, 3.0]).right)
scene = Scene.from_toml("scene.toml", friction=0.3)
state = scene.evaluate()
print(state.theta, (state.status == SLIP).sum())
bounds, constraints = scene.constraints
nonsmooth.minimize(scene.fun, scene.start.ravel(), bounds=bounds, constraints=constraints)
scene.optimize(options={"max_evaluations": 3})
