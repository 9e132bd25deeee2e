from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any

from numpy import float64, int8, int64
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint

from ._minimize import _Options
from ._result import Result

OPEN: int
STICK: int
SLIP: int

@dataclass(frozen=True)
class Evaluation:
    theta: float
    gradient: NDArray[float64]
    contact_nodes: NDArray[int64]
    contact_bodies: NDArray[int64]
    contacts: NDArray[int64]
    pressures: NDArray[float64]
    gaps: NDArray[float64]
    status: NDArray[int8]
    areas: NDArray[float64]
    normals: NDArray[float64]
    tractions: NDArray[float64]
    positions: NDArray[float64]
    displacements: NDArray[float64]
    stresses: NDArray[float64]
    von_mises: NDArray[float64]
    bodies: dict[str, dict[str, NDArray[float64]]]
    total_force: float
    error_bound: float
    residual: float
    weakly_active: dict[str, Any]
    unit: str
    root: float
    norm_in_mpa: float | None
    warnings: list[str]
    cases: dict[str, dict[str, Any]]
    limits: list[dict[str, Any]]
    reports: list[dict[str, Any]]
    def plot(self, values: str = "pressures", ax: Any = None) -> Any: ...

class Page:
    html: str
    def __init__(self, page: str) -> None: ...
    def _repr_html_(self) -> str: ...
    def save(self, path: str | PathLike[str]) -> None: ...

def from_meshio(
    mesh: Any, faces: Mapping[str, Callable[[NDArray[float64]], ArrayLike]] | None = None
) -> tuple[NDArray[float64], NDArray[int64], dict[str, NDArray[int64]]]: ...
def new_scene(mesh: str | PathLike[str]) -> str: ...

class Scene:
    def __init__(self, **fields: Any) -> None: ...
    @classmethod
    def from_toml(cls, path: str | PathLike[str], **fields: Any) -> Scene: ...
    @classmethod
    def from_mesh(
        cls,
        nodes: ArrayLike,
        cells: ArrayLike,
        faces: Mapping[str, ArrayLike],
        path: str | PathLike[str] | None = None,
        **fields: Any,
    ) -> Scene: ...
    @property
    def name(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def start(self) -> NDArray[float64]: ...
    @property
    def constraints(self) -> tuple[Bounds, list[LinearConstraint | NonlinearConstraint]]: ...
    def to_toml(self) -> str: ...
    def show(self, controls: ArrayLike | None = None) -> Page: ...
    def evaluate(self, controls: ArrayLike | None = None) -> Evaluation: ...
    def fun(self, controls: ArrayLike) -> tuple[float, NDArray[float64]]: ...
    def optimize(
        self,
        start: ArrayLike | None = None,
        options: _Options | Mapping[str, Any] | None = None,
        callback: Callable[..., Any] | None = None,
        *,
        journal: str | PathLike[str] | None = None,
        resume: str | PathLike[str] | None = None,
    ) -> Result: ...
