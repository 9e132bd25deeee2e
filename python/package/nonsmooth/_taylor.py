"""The Taylor test: does the subgradient predict the change of the function?"""

import json
from dataclasses import dataclass

import numpy as np

from . import _engine
from ._minimize import _joined, takes_accuracy
from ._numbers import real

#: A relative error of the best difference quotient below this, or remainders that fall this fast, show a right subgradient.
_RIGHT_ERROR, _RIGHT_SLOPE = 1e-5, 1.7


@dataclass(frozen=True)
class TaylorTest:
    """What `taylor_test` found.

    Attributes
    ----------
    right : bool
        Whether the subgradient predicts the function along the direction.
    directional_derivative : float
        Subgradient times direction.
    fitted_slope : float or None
        How fast the remainder falls with the step: 2 for a right subgradient, 1 for a wrong one; None where rounding
        hides it, as for a linear function.
    best_derivative_error : float
        Smallest relative error of the difference quotients.
    table : str
        Steps and remainders.
    """

    right: bool
    directional_derivative: float
    fitted_slope: "float | None"
    best_derivative_error: float
    table: str

    def __str__(self):
        verdict = "right" if self.right else "WRONG, unless x lies on a kink: try another x"
        return f"{self.table}subgradient: {verdict}"


def taylor_test(fun, x, jac=True, args=(), direction=None, seed=1, disp=True):
    """Test a subgradient against differences of values, print the table, and say right or wrong.

    Parameters
    ----------
    fun : callable
        As for `minimize`.
    x : array_like
        A point where the function is smooth, which nearly every point is.
    jac, args : optional
        As for `minimize`.
    direction : array_like, optional
        Direction of the test; by default a random one that `seed` determines.
    seed : int
        Seed of the random direction, at least 0.
    disp : bool
        Whether the table is printed.

    Returns
    -------
    TaylorTest
        The verdict ``right`` and its numbers.

    Examples
    --------
    >>> import nonsmooth
    >>> nonsmooth.taylor_test(lambda x: (x @ x, 2 * x), [1.0, -3.0], disp=False).right
    True
    >>> nonsmooth.taylor_test(lambda x: (x @ x, 3 * x), [1.0, -3.0], disp=False).right
    False
    """
    joined = _joined(fun, jac, args)
    x = np.atleast_1d(real(x, "x"))
    if direction is not None:
        direction = real(direction, "direction")
        if not direction.any():
            raise ValueError("direction is zero, expected one along which the function is tested")
    numbers, table = _engine.taylor_test(joined, x, direction, seed, takes_accuracy(fun), jac is not True)
    numbers = json.loads(numbers)
    slope, error = numbers["fitted_slope"], numbers["best_derivative_error"]
    if error is None:
        raise ValueError("fun is not finite at x or next to it, so that there is nothing to compare")
    right = error <= _RIGHT_ERROR or (slope is not None and slope >= _RIGHT_SLOPE)
    test = TaylorTest(right, numbers["directional_derivative"], slope, error, table)
    if disp:
        print(test)
    return test
