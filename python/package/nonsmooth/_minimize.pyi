from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypedDict, type_check_only

from numpy import float64
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint

from ._nonlinear import Nonlinear
from ._result import Result

@type_check_only
class _Options(TypedDict, total=False):
    tolerance: float
    tol: float
    max_evaluations: int
    maxfev: int
    maxfun: int
    max_iterations: int
    maxiter: int
    max_seconds: float | None
    convex: bool
    first_step: float | None
    objective_scale: float | None
    x_scale: ArrayLike | None
    scaling: ArrayLike | None
    accuracy: Literal["tightest", "on_demand"] | tuple[float, float, float]
    bundle_size: int | None
    confirm: bool
    disp: bool

_Path = str | PathLike[str]
_Constraints = LinearConstraint | NonlinearConstraint | Bounds | Sequence[Any]
_Kind = Literal["smooth", "nonsmooth", "equality"]
_Bounds = Bounds | Sequence[tuple[float | None, float | None]] | NDArray[float64]

def minimize(
    fun: Callable[..., Any],
    x0: ArrayLike,
    jac: Literal[True] | Callable[..., ArrayLike] = True,
    args: Any = (),
    bounds: _Bounds | None = None,
    constraints: _Constraints | None = (),
    options: _Options | Mapping[str, Any] | None = None,
    callback: Callable[..., Any] | None = None,
    *,
    tol: float | None = None,
    x_scale: ArrayLike | None = None,
    constraint_kinds: Sequence[_Kind] = (),
    journal: _Path | None = None,
    resume: _Path | None = None,
) -> Result: ...
def minimize_composite(
    outer: Literal["max", "l1", "hinge", "power", "norm"] | Callable[[NDArray[float64]], tuple[float, ArrayLike]],
    fun: Callable[..., Any],
    x0: ArrayLike,
    args: Any = (),
    bounds: _Bounds | None = None,
    constraints: _Constraints | None = (),
    options: _Options | Mapping[str, Any] | None = None,
    callback: Callable[..., Any] | None = None,
    *,
    exponent: float = 2.0,
    groups: Sequence[int] | None = None,
    smooth: Callable[..., tuple[Any, ArrayLike]] | None = None,
    weight: float = 1.0,
    tol: float | None = None,
    x_scale: ArrayLike | None = None,
    constraint_kinds: Sequence[_Kind] = (),
    journal: _Path | None = None,
    resume: _Path | None = None,
) -> Result: ...
# scipy's stubs ask for their own type of the start, and for a type of the result that is not scipy.optimize.OptimizeResult.
def bundle_trust(
    fun: Callable[..., Any],
    x0: Any,
    args: Any = (),
    jac: Literal[True] | Callable[..., ArrayLike] | None = None,
    hess: None = None,
    hessp: None = None,
    bounds: _Bounds | None = None,
    constraints: _Constraints | None = (),
    callback: Callable[..., Any] | None = None,
    **options: Any,
) -> Any: ...
def takes_accuracy(fun: Callable[..., Any]) -> bool: ...
def told(callback: Callable[..., Any] | None) -> Callable[..., bool] | None: ...
def journal_of(
    journal: _Path | None, resume: _Path | None, identity: str, has_runs: bool = False
) -> tuple[str, str] | None: ...
def drive(
    run: Callable[..., Any], setup: dict[str, Any], outer: dict[str, Any] | None = None, nonlinear: Nonlinear | None = None
) -> Result: ...

OUTER: tuple[str, ...]
