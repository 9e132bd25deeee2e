"""Contact scenes: 3D contact with Coulomb friction as an objective. Units: N, mm, MPa."""

import json
import math
import os
from dataclasses import dataclass

import numpy as np

from . import _options
from ._engine import OutsideDomain
from ._minimize import drive, journal_of, told
from ._numbers import real

try:
    from ._engine import ContactScene as _ContactScene
except ImportError as error:
    raise ImportError("this wheel of nonsmooth was built without the feature `contact`") from error

#: Meaning of the entries of `Evaluation.status`.
OPEN, STICK, SLIP = 0, 1, 2


@dataclass(frozen=True)
class Evaluation:
    """Objective and contact state at a shape.

    Attributes
    ----------
    theta : float
        The objective of the scene, in `unit`.
    gradient : ndarray, shape of the control points
        One Clarke subgradient with respect to the heights, unit of theta per mm. Where `weakly_active` counts no node,
        it is the gradient.
    pressures : ndarray, one entry per contact node
        Contact pressures, MPa; first index along x1, second along x2.
    gaps : ndarray, one entry per contact node
        Distance to the counter surface, mm; 0 in contact.
    status : ndarray of int8, one entry per contact node
        `OPEN`, `STICK` or `SLIP`. Without friction, nodes in contact that are free to slide slip.
    total_force : float
        Sum of the normal forces, N.
    error_bound : float
        Estimate of the error of theta that the residual of the state causes.
    residual : float
        Largest relative residual of equilibrium and contact law.
    weakly_active : dict
        How close the state is to a kink.
    unit : str
        Unit of theta.
    root : float
        p where theta is the p-th root of a pressure norm, because the norm may be no double; else 1.
    norm_in_mpa : float or None
        For a pressure norm, its p-th root in MPa: with ``weight = "area"`` the power mean of the pressures over the area, with
        ``"nodes"`` the root of their sum. None for other objectives.
    warnings : list of str
        What is implausible about the state, as the command ``evaluate`` says it: each begins with a code that does not change, such as
        ``"large-strain: "``.
    """

    theta: float
    gradient: np.ndarray
    pressures: np.ndarray
    gaps: np.ndarray
    status: np.ndarray
    total_force: float
    error_bound: float
    residual: float
    weakly_active: dict
    unit: str
    root: float
    norm_in_mpa: float | None
    warnings: list


class Scene:
    """A contact shape optimization problem.

    Parameters
    ----------
    **fields
        The fields of a scene file, nested sections as dicts: ``Scene(name="punch", size=[10, 10], friction=0.3,
        lower={...}, ...)``. The page docs/scenes.md of the repository lists them; a bad one is named with what is
        allowed. Mandatory are those that have no default there.

    Examples
    --------
    >>> scene = Scene(
    ...     name="block", size=[10.0, 10.0], friction=0.2, mesh={"bricks": [2, 2, 2], "subdomains": [1, 1, 1]},
    ...     lower={"material": {"young_modulus": 1e5, "poisson_ratio": 0.3},
    ...            "loads": [{"face": "bottom", "traction": [0.0, 0.0, 100.0]}],
    ...            "supports": [{"face": "x1-min", "held": ["u1", "u2"]}]},
    ...     counter_surface={"form": "plane", "height": 10.5},
    ...     surface={"control_points": [4, 4], "start": {"form": "plane", "height": 10.0}},
    ...     admissible={"minimum_height": 5.0, "slope": 1.0, "volume": [500.0, 1500.0]})
    >>> round(scene.evaluate().total_force)  # 100 MPa on 10 mm x 10 mm
    10000
    """

    def __init__(self, **fields):
        self._open(None, fields)

    def _open(self, path, fields):
        """The engine's scene, and what it is made of, for copies in other processes."""
        self._made_of = path, json.dumps(_plain(fields, ""))
        self._scene = _ContactScene(*self._made_of)

    def __reduce__(self):
        return _again, self._made_of

    @classmethod
    def from_toml(cls, path, **fields):
        """The scene of a file, with fields changed: ``Scene.from_toml("hertz.toml", friction=0.5, mesh={"bricks": [6, 6, 6]})``.

        Parameters
        ----------
        path : path
            The scene file. Files that it names lie beside it.
        **fields
            Fields that differ from the file, as for `Scene`.

        Returns
        -------
        Scene
            The scene.
        """
        path = os.path.abspath(os.fsdecode(path))
        os.stat(path)  # FileNotFoundError
        scene = cls.__new__(cls)
        scene._open(path, fields)
        return scene

    @property
    def name(self):
        """Name of the scene."""
        return self._scene.name

    @property
    def start(self):
        """Control heights at the start, mm; shape of the control points."""
        return self._scene.start

    @property
    def constraints(self):
        """Admissible heights, flattened: ``(bounds, constraint)`` as scipy's objects, for `nonsmooth.minimize`."""
        from scipy.optimize import Bounds, LinearConstraint

        _check_process()
        arrays = self._scene.constraints()
        rows = LinearConstraint(arrays["rows"], arrays["row_lower"], arrays["row_upper"])
        return Bounds(arrays["lower"], arrays["upper"]), rows

    def to_toml(self):
        """The scene as a complete commented file."""
        return self._scene.toml()

    def evaluate(self, heights=None):
        """Solve the contact problem of a shape, and check what it means. An interrupt takes effect between its steps.

        Parameters
        ----------
        heights : array_like, optional
            Control heights, mm, in the shape of the control points or flattened; by default the start.

        Returns
        -------
        Evaluation
            Objective and contact state.

        Raises
        ------
        OutsideDomain
            Heights or slopes outside the admissible set, which the commands refuse too, and bodies that are inverted. The volume
            may be any.
        """
        found = self._solved(heights, True)
        return Evaluation(
            theta=found["value"],
            gradient=found["gradient"],
            pressures=found["pressures"],
            gaps=found["gaps"],
            status=found["status"].astype(np.int8),
            total_force=found["total_force"],
            error_bound=found["error_bound"],
            residual=found["residual"],
            weakly_active=json.loads(found["weakly_active"]),
            unit=found["unit"],
            root=found["root"],
            norm_in_mpa=found["norm_in_mpa"],
            warnings=found["warnings"],
        )

    def fun(self, heights):
        """Theta and one subgradient, flattened: a function for `nonsmooth.minimize`.

        A shape without a solution raises `nonsmooth.OutsideDomain`, which shortens the step.

        Parameters
        ----------
        heights : array_like
            Control heights, mm, flattened or in the shape of the control points.

        Returns
        -------
        tuple of float and ndarray
            Theta and its subgradient.
        """
        try:
            found = self._solved(heights, False)
        except RuntimeError as error:
            raise OutsideDomain(str(error)) from error
        return found["value"], found["gradient"].ravel()

    def _solved(self, heights, checks):
        """The engine's answer at a shape."""
        _check_process()
        return self._scene.evaluate(self._flat(heights, "heights"), checks)

    def optimize(self, start=None, options=None, callback=None, *, journal=None, resume=None):
        """Minimise theta over the admissible heights, with the Jacobian of all pressures where theta is a function of them.

        Parameters
        ----------
        start : array_like, optional
            Control heights to begin with; by default those of the scene.
        options, callback, journal, resume : optional
            As for `nonsmooth.minimize`. By default, ``max_evaluations``, ``tolerance`` and the limits are those of the
            scene, first step and scaling those of the command ``contact3d optimize``.

        Returns
        -------
        Result
            ``x`` holds the control heights in row-major order, flattened. ``warnings`` holds those of the optimizer and those about
            the final shape, with codes as in `Evaluation`.
        """
        _check_process()
        start = self._flat(start, "start")
        given = self._scene.options()
        own = {_options.SCIPY_NAMES.get(name, name): value for name, value in (options or {}).items()}
        config, scaling, disp = _options.read({**json.loads(given), **own}, start.size, False)
        nothing = np.zeros(0)
        unused = {"lower": nothing, "upper": nothing, "rows": np.zeros((0, 0)), "row_lower": nothing, "row_upper": nothing}
        setup = {
            "fun": None,
            "jac_apart": False,
            "takes_accuracy": False,
            "outer": None,
            "smooth": None,
            "x0": start,
            "constraints": unused,
            "nonlinear": None,
            "options": config,
            "scaling": scaling,
            "callback": told(callback),
            "disp": disp,
            "journal": journal_of(journal, resume, self.to_toml()),
        }
        return drive(self._scene.optimize, setup)

    def _flat(self, heights, what):
        """Control heights in row-major order; by default those of the start."""
        if heights is None:
            return self.start.ravel()
        heights = real(heights, what)
        shape = tuple(self._scene.control_points)
        if heights.shape not in (shape, (shape[0] * shape[1],)):
            raise ValueError(
                f"{what} has {heights.size} entries, expected {shape[0] * shape[1]}"
                if heights.ndim == 1
                else f"{what} has shape {heights.shape}, expected {shape} or flattened ({shape[0] * shape[1]},)"
            )
        return heights.ravel()

    def __repr__(self):
        return f"<Scene {self.name!r}>"


def _again(path, fields):
    """A scene in another process."""
    scene = Scene.__new__(Scene)
    scene._open(path, json.loads(fields))
    return scene


def _plain(value, path):
    """A field as JSON has it; `path` names it in messages."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, dict):
        return {name: _plain(entry, f"{path}.{name}" if path else str(name)) for name, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry, f"{path}[{index}]") for index, entry in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{path} = {value} is not allowed; allowed: finite numbers")
    if not isinstance(value, (bool, int, float, str)):
        raise TypeError(f"{path} is {type(value).__name__}, expected numbers, text, lists and dicts; leave out a field for its default")
    return value


#: The process in which scenes are solved.
_process = None


def _check_process():
    """Refuses to solve scenes in a process that was forked from one that did: the threads of the solver are not there."""
    global _process
    if _process is None:
        _process = os.getpid()
    if _process != os.getpid():
        raise RuntimeError(
            "contact scenes were solved before this process was forked, and the threads that solve them were not copied: start "
            "processes by multiprocessing.get_context('spawn')"
        )
