from collections.abc import Callable, Sequence
from typing import Any

import scipy.optimize
from numpy import float64
from numpy.typing import ArrayLike, NDArray

KINDS: dict[str, str]

class NonlinearConstraint(scipy.optimize.NonlinearConstraint):
    nonsmooth: bool
    def __init__(
        self,
        fun: Callable[[NDArray[float64]], ArrayLike],
        lb: ArrayLike,
        ub: ArrayLike,
        jac: Callable[[NDArray[float64]], Any],
        *,
        nonsmooth: bool = False,
    ) -> None: ...

def is_nonlinear(constraint: Any) -> bool: ...

class Nonlinear:
    def __init__(self, constraints: Sequence[tuple[int, Any]], kinds: Sequence[str], start: NDArray[float64]) -> None: ...
    def __bool__(self) -> bool: ...
    @property
    def kinds(self) -> list[str]: ...
    @property
    def setup(self) -> dict[str, Any] | None: ...
    def identity(self, name: str) -> str: ...
    @property
    def sides(self) -> list[tuple[Any, ...]]: ...
    def found(self, reports: list[dict[str, Any]]) -> dict[str, Any]: ...
