from dataclasses import dataclass
from typing import Any

from numpy import float64
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult

from ._engine import Certificate, RunOutcome
from ._nonlinear import Nonlinear

STATUS: dict[str, int]

class History(list[dict[str, Any]]): ...

@dataclass(frozen=True)
class Recheck:
    aggregate_norm: float
    aggregate_error: float
    multiplier_defect: float
    violation: float
    open_side_multiplier: float
    composite_difference: float | None
    agrees: bool
    def confirms(self, norm_tolerance: float, error_tolerance: float) -> bool: ...

class Result(OptimizeResult):
    x: NDArray[float64]
    fun: float
    jac: NDArray[float64] | None
    success: bool
    status: int
    reason: str
    message: str
    nit: int
    nfev: int
    njev: int
    gap: float | None
    constr: list[NDArray[float64]]
    constr_violation: float
    multipliers: list[NDArray[float64]]
    penalty: float | None
    certificate: Certificate | None
    history: History
    counts: dict[str, Any]
    largest_violation: float
    start_value: float
    seconds: float
    warnings: list[str]
    limits: list[dict[str, Any]]
    runs: list[dict[str, Any]]
    def recheck(self) -> Recheck: ...
    def __dir__(self) -> list[str]: ...

def build(outcome: RunOutcome, outer: dict[str, Any] | None = None, nonlinear: Nonlinear | None = None) -> Result: ...
