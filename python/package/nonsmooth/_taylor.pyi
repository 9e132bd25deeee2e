from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from numpy.typing import ArrayLike

@dataclass(frozen=True)
class TaylorTest:
    right: bool
    directional_derivative: float
    fitted_slope: float | None
    best_derivative_error: float
    table: str

def taylor_test(
    fun: Callable[..., Any],
    x: ArrayLike,
    jac: Literal[True] | Callable[..., ArrayLike] = True,
    args: Any = (),
    direction: ArrayLike | None = None,
    seed: int = 1,
    disp: bool = True,
) -> TaylorTest: ...
