"""Contact scenes: 3D contact with Coulomb friction as an objective. Units: N, mm, MPa."""

import hashlib
import html
import json
import math
import os
from dataclasses import dataclass

import numpy as np

from . import _options
from ._engine import OutsideDomain
from ._meshes import from_meshio
from ._minimize import drive, journal_of, told
from ._numbers import real

try:
    from ._engine import ContactScene as _ContactScene
    from ._engine import new_scene as _new_scene
except ImportError as error:
    raise ImportError("this wheel of nonsmooth was built without the feature `contact`") from error

#: Meaning of the entries of `Evaluation.status`.
OPEN, STICK, SLIP = 0, 1, 2


@dataclass(frozen=True)
class Evaluation:
    """Objective and contact state at a shape.

    Arrays over the contact nodes of a block have its columns of nodes along x1 and x2 as their first two axes, with NaN or −1 where
    supports hold a node; those of a mesh and of several contacts have one axis. Arrays over nodes and cells are those of the body
    whose shape is optimized, of several the first one; `bodies` has those of all.

    Attributes
    ----------
    theta : float
        The objective of the scene, in `unit`.
    gradient : ndarray, shape of the controls
        One Clarke subgradient with respect to the controls, unit of theta per mm. Where `weakly_active` counts no node,
        it is the gradient.
    contact_nodes : ndarray of int64, one entry per contact node
        Numbers of the contact nodes, places in the `positions` of their bodies.
    contact_bodies : ndarray of int64, one entry per contact node
        Bodies of the contact nodes, by their places in the scene.
    contacts : ndarray of int64, one entry per contact node
        Contacts of the contact nodes, by their places in the scene.
    pressures : ndarray, one entry per contact node
        Contact pressures, MPa.
    gaps : ndarray, one entry per contact node
        Distance to what lies opposite, mm; 0 in contact.
    status : ndarray of int8, one entry per contact node
        `OPEN`, `STICK` or `SLIP`. Without friction, nodes in contact that are free to slide slip.
    areas : ndarray, one entry per contact node
        Areas that pressures and tractions act on, mm².
    normals : ndarray, three components per contact node
        Unit normals from the body into what it touches.
    tractions : ndarray, three components per contact node
        What the body exerts on what it touches, MPa: pressure along the normal, and friction. Times `areas`, they are forces.
    positions : ndarray, (nodes, 3)
        Positions of the nodes before loading, mm.
    displacements : ndarray, (nodes, 3)
        Displacements of the nodes, mm.
    stresses : ndarray, (cells, 6)
        Stresses at the centres of the cells, MPa; components 11, 22, 33, 12, 23, 13.
    von_mises : ndarray, (cells,)
        Von Mises stresses there, MPa.
    bodies : dict of str to dict
        ``positions``, ``displacements``, ``stresses`` and ``von_mises`` of all bodies by their names: ``"lower"`` and ``"upper"`` of
        blocks, ``"body"`` of a mesh, or those of a list.
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
    cases : dict of str to dict
        The states of all load cases by their names, "" for a scene without cases: the arrays and numbers above but theta and gradient,
        and ``weighted_value``, the measure of the case times its weight. The arrays above are those of the worst case.
    limits : list of dict
        The limits: ``quantity``, ``case``, the bound as ``at_most``, ``at_least`` or ``equal_to``, the ``value``, and by how much it is
        beyond the bound, ``violation``.
    reports : list of dict
        What the scene reports: ``quantity``, ``label``, ``case``, ``unit`` and the ``value``.
    """

    theta: float
    gradient: np.ndarray
    contact_nodes: np.ndarray
    contact_bodies: np.ndarray
    contacts: np.ndarray
    pressures: np.ndarray
    gaps: np.ndarray
    status: np.ndarray
    areas: np.ndarray
    normals: np.ndarray
    tractions: np.ndarray
    positions: np.ndarray
    displacements: np.ndarray
    stresses: np.ndarray
    von_mises: np.ndarray
    bodies: dict
    total_force: float
    error_bound: float
    residual: float
    weakly_active: dict
    unit: str
    root: float
    norm_in_mpa: float | None
    warnings: list
    cases: dict
    limits: list
    reports: list

    def plot(self, values="pressures", ax=None):
        """Draw values over the contact nodes, seen along their mean normal, with matplotlib.

        Parameters
        ----------
        values : str, optional
            An attribute with one number per contact node: ``"pressures"``, ``"gaps"``, ``"status"`` or ``"areas"``.
        ax : matplotlib Axes, optional
            Where to draw; by default new axes.

        Returns
        -------
        matplotlib Axes
            The axes, lengths in mm.
        """
        allowed = ("pressures", "gaps", "status", "areas")
        if values not in allowed:
            raise ValueError(f"values = {values!r} is not allowed; allowed: {', '.join(allowed)}")
        import matplotlib.pyplot as plt

        drawn = np.asarray(getattr(self, values), dtype=float).ravel()
        nodes, bodies = self.contact_nodes.ravel(), self.contact_bodies.ravel()
        known = np.isfinite(drawn) & (nodes >= 0)
        every = list(self.bodies.values())
        places = np.array([every[body]["positions"][node] for body, node in zip(bodies[known], nodes[known])])
        normal = np.nansum(self.normals.reshape(-1, 3)[known], axis=0)
        axes = sorted(np.argsort(abs(normal))[:2])
        ax = plt.subplots()[1] if ax is None else ax
        points = ax.scatter(places[:, axes[0]], places[:, axes[1]], c=drawn[known], s=18)
        unit = {"pressures": ", MPa", "gaps": ", mm", "areas": ", mm²", "status": " (0 open, 1 stick, 2 slip)"}[values]
        ax.figure.colorbar(points, ax=ax, label=values + unit)
        ax.set(xlabel=f"x{axes[0] + 1}, mm", ylabel=f"x{axes[1] + 1}, mm", aspect="equal")
        return ax


class Page:
    """A page of HTML that needs nothing else: notebooks show it, `save` writes it.

    Attributes
    ----------
    html : str
        The whole page.
    """

    def __init__(self, page):
        self.html = page

    def _repr_html_(self):
        return f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="900" style="border:0"></iframe>'

    def save(self, path):
        """Write the page to a file, for a browser."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.html)


def new_scene(mesh):
    """Write a first scene for a mesh beside it, from the names of its faces, as ``contact3d new`` does.

    Parameters
    ----------
    mesh : path
        A Gmsh file, ``part.msh``.

    Returns
    -------
    str
        The path of the scene, ``part.toml``: a commented file to be changed. One that exists is not overwritten.
    """
    return str(_new_scene(os.fspath(mesh)))


class Scene:
    """A contact shape optimization problem.

    Parameters
    ----------
    **fields
        The fields of a scene file, tables as dicts: ``Scene(name="punch", friction=0.3, body=[{...}], contact=[{...}],
        ...)``. The page docs/fields.md of the repository lists them; a bad one is named with what is
        allowed. Mandatory are those that have no default there.

    Examples
    --------
    >>> scene = Scene(
    ...     name="block", friction=0.2,
    ...     body=[{"block": {"size": [10.0, 10.0], "bricks": [2, 2, 2], "subdomains": [1, 1, 1]},
    ...            "material": {"young_modulus": 1e5, "poisson_ratio": 0.3},
    ...            "loads": [{"face": "bottom", "traction": [0.0, 0.0, 100.0]}],
    ...            "supports": [{"face": "x1-min", "held": ["u1", "u2"]}],
    ...            "lattice": {"heights": "top", "control_points": [4, 4], "start": {"form": "plane", "height": 10.0},
    ...                        "thickness": 5.0, "slope": 1.0, "volume": [500.0, 1500.0]}}],
    ...     contact=[{"slave": {"face": "top"}, "obstacle": {"form": "plane", "height": 10.5}}])
    >>> round(scene.evaluate().total_force)  # 100 MPa on 10 mm x 10 mm
    10000
    """

    def __init__(self, **fields):
        self._open(None, fields)

    def _open(self, path, fields, mesh=None):
        """The engine's scene, and what it is made of, for copies in other processes."""
        self._made_of, self._last = (path, json.dumps(_fields(fields)), mesh), None
        self._scene = _ContactScene(*self._made_of)

    def __reduce__(self):
        return _again, self._made_of

    @classmethod
    def from_toml(cls, path, **fields):
        """The scene of a file, with fields changed: ``Scene.from_toml("hertz.toml", friction=0.5)``.

        A field replaces that of the file as a whole, nested tables included, as the option ``--set`` does; ``None`` removes it. Paths
        name fields of bodies and contacts: ``Scene.from_toml("signorini.toml", **{"body[0].block.bricks": [6, 6, 6]})``.

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
        scene = cls.__new__(cls)
        scene._open(_existing(path), fields)
        return scene

    @classmethod
    def from_mesh(cls, nodes, cells, faces, path=None, **fields):
        """The scene of a body given as arrays: hexahedra, or tetrahedra with nodes in the middles of their edges.

        Parameters
        ----------
        nodes : array_like, (n, 3)
            Positions of the nodes, mm, or in ``unit`` of the body. Each belongs to a cell.
        cells : array_like of int, (m, 8) or (m, 10)
            Numbers of the nodes of the cells, from 0, in the order of Gmsh; tetrahedra of four nodes (m, 4) get those in the middles of
            their edges. `from_meshio` makes these arrays of a mesh of another program.
        faces : dict of str to array_like of int, (k, 4) or (k, 3)
            Named faces of the body, each as the corners of its facets: what the scene calls a face of supports, loads and contact.
        path : path, optional
            A scene file of another mesh, whose place this one takes.
        **fields
            Fields of the scene, as for `Scene`; its only body has no ``mesh``.

        Returns
        -------
        Scene
            The scene.

        Examples
        --------
        >>> corners = [[x, y, z] for z in (0, 10) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
        >>> scene = Scene.from_mesh(
        ...     corners, [range(8)], {"foot": [[0, 1, 2, 3]], "head": [[4, 5, 6, 7]], "side": [[0, 3, 7, 4]]},
        ...     name="one cell", friction=0.2,
        ...     body=[{"material": {"young_modulus": 1e5, "poisson_ratio": 0.3},
        ...            "loads": [{"face": "foot", "force": [0.0, 0.0, 500.0]}],
        ...            "supports": [{"face": "side", "held": ["u1", "u2"]}],
        ...            "lattice": {"control_points": [2, 2, 2], "displacement": [-1.0, 1.0]}}],
        ...     contact=[{"slave": {"face": "head"}, "obstacle": {"form": "plane", "height": 10.5}}])
        >>> state = scene.evaluate()
        >>> (state.areas[:, None] * state.tractions).sum(axis=0).round(6).tolist()[2]
        500.0
        """
        named = [(str(name), _numbers_of_nodes(facets, f"faces[{name!r}]")) for name, facets in faces.items()]
        mesh = _rows(real(nodes, "nodes"), "nodes"), _numbers_of_nodes(cells, "cells"), named
        scene = cls.__new__(cls)
        scene._open(None if path is None else _existing(path), fields, mesh)
        return scene

    @property
    def name(self):
        """Name of the scene."""
        return self._scene.name

    @property
    def notes(self):
        """What the command line says of the meshes of the scene before any work: their size in mm, cells of poor shape, surfaces between
        cells, facets and cells that are listed more than once and count once."""
        return self._scene.notes

    @property
    def start(self):
        """Controls at the start, mm: heights in the shape of the control points of a block, displacements of those of a lattice."""
        return self._scene.start

    @property
    def constraints(self):
        """All that the scene limits, as scipy's objects: ``(bounds, constraints)`` for `nonsmooth.minimize` and others.

        ``constraints`` is a list: the rows of the admissible set as a ``LinearConstraint`` and, where the scene has limits, a
        ``NonlinearConstraint`` with a component per limit and load case. A component is the quantity minus ``at_most``, or
        ``at_least`` minus the quantity, in the unit of the quantity: at most 0. `fun` and the constraint share the last state.
        """
        from scipy.optimize import Bounds, LinearConstraint, NonlinearConstraint

        _check_process()
        arrays = self._scene.constraints()
        constraints = [LinearConstraint(arrays["rows"], arrays["row_lower"], arrays["row_upper"])]
        if arrays["limits"]:
            least = np.where(arrays["limits"], 0.0, -np.inf)
            values = lambda controls: self._with_limits(controls)["limit_values"].copy()
            slopes = lambda controls: self._with_limits(controls)["limits"].copy()
            constraints.append(NonlinearConstraint(values, least, np.zeros(least.size), jac=slopes))
        return Bounds(arrays["lower"], arrays["upper"]), constraints

    def to_toml(self):
        """The scene as a complete commented file. A mesh given as arrays is not part of it: the file names ``body.mesh``."""
        return self._scene.toml()

    def show(self, controls=None):
        """The scene as a page in three dimensions, which a notebook shows.

        Parameters
        ----------
        controls : array_like, optional
            Controls, mm. Without them, the page shows the scene before any solve: bodies, names, supports, loads and gaps. With
            them, it shows the start and their shape, both solved: pressures, stresses, displacements.

        Returns
        -------
        Page
            The page; ``scene.show().save("scene.html")`` writes it for a browser.
        """
        _check_process()
        if controls is None:
            return Page(self._scene.look())
        return Page(self._scene.solved_page(self._flat(controls, "heights" if self._scene.has_heights else "controls")))

    def evaluate(self, controls=None):
        """Solve the contact problem of a shape, and check what it means. An interrupt takes effect between its steps.

        Parameters
        ----------
        controls : array_like, optional
            Controls, mm, in the shape of the start or flattened; by default the start.

        Returns
        -------
        Evaluation
            Objective and contact state.

        Raises
        ------
        OutsideDomain
            Controls or slopes outside the admissible set, which the commands refuse too, and bodies that are inverted. The volume
            may be any.
        """
        found = self._solved(controls, True)
        for case in found["cases"].values():
            case["weakly_active"] = json.loads(case["weakly_active"])
        return Evaluation(theta=found.pop("value"), weakly_active=json.loads(found.pop("weakly_active")), **found)

    def fun(self, controls):
        """Theta and one subgradient, flattened: a function for `nonsmooth.minimize`.

        A shape without a solution raises `nonsmooth.OutsideDomain`, which shortens the step.

        Parameters
        ----------
        controls : array_like
            Controls, mm, flattened or in the shape of the start.

        Returns
        -------
        tuple of float and ndarray
            Theta and its subgradient.
        """
        found = self._with_limits(controls)
        return found["value"], found["gradient"].ravel()

    def _with_limits(self, controls):
        """Theta and all limits with their gradients, of the last shape without another solve."""
        shape = np.array(controls, dtype=float).tobytes()
        if self._last is None or self._last[0] != shape:
            try:
                self._last = shape, self._solved(controls, False)
            except RuntimeError as error:
                raise OutsideDomain(str(error)) from error
        return self._last[1]

    def _solved(self, controls, checks):
        """The engine's answer at a shape."""
        _check_process()
        return self._scene.evaluate(self._flat(controls, "heights" if self._scene.has_heights else "controls"), checks)

    def optimize(self, start=None, options=None, callback=None, *, journal=None, resume=None):
        """Minimise theta over the admissible controls, as the command ``contact3d optimize`` does: to the same controls, bit for bit.

        The runs are those of the command too: attempts with all controls and with a coarse net of them, a run from the best of
        them and one from a fairer shape; one per start, or per mesh of ``optimizer.continuation``. The scene's fields ``optimizer``
        say which, ``optimizer={"single": True}`` asks for one run.

        Parameters
        ----------
        start : array_like, optional
            Controls to begin with; by default those of the scene.
        options, callback, journal, resume : optional
            As for `nonsmooth.minimize`; by default, the options are those of the scene. ``max_evaluations`` holds for every run,
            ``max_seconds`` for all of them together, ``scaling`` for those with all controls. The callback sees every run, and ends
            them all; a journal has a folder for each.

        Returns
        -------
        Result
            ``x`` holds the controls in row-major order, flattened, ``runs`` what each run has found. ``warnings`` holds those of the optimizer and those about
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
            "journal": journal_of(journal, resume, self._identity(), has_runs=True),
        }
        return drive(self._scene.optimize, setup)

    def _identity(self):
        """What a journal of the scene is recognised by: its file, and the mesh if it was given as arrays."""
        mesh = self._made_of[2]
        if mesh is None:
            return self.to_toml()
        nodes, cells, faces = mesh
        digest = hashlib.sha256(nodes.tobytes() + cells.tobytes())
        for name, facets in faces:
            digest.update(name.encode() + facets.tobytes())
        return f"{self.to_toml()}# mesh {digest.hexdigest()}\n"

    def _flat(self, controls, what):
        """Controls in row-major order; by default those of the start."""
        if controls is None:
            return self.start.ravel()
        controls = real(controls, what)
        shape = tuple(self._scene.control_shape)
        count = math.prod(shape)
        if controls.shape not in (shape, (count,)):
            raise ValueError(
                f"{what} has {controls.size} entries, expected {count}"
                if controls.ndim == 1
                else f"{what} has shape {controls.shape}, expected {shape}" + (f" or flattened ({count},)" if len(shape) > 1 else "")
            )
        return controls.ravel()

    def __repr__(self):
        return f"<Scene {self.name!r}>"


def _again(path, fields, mesh):
    """A scene in another process."""
    scene = Scene.__new__(Scene)
    scene._open(path, json.loads(fields), mesh)
    return scene


def _existing(path):
    """The absolute path of a file."""
    path = os.path.abspath(os.fsdecode(path))
    os.stat(path)  # FileNotFoundError
    return path


def _rows(array, what):
    """An array with rows, as the engine takes it."""
    if array.ndim != 2:
        raise ValueError(f"{what} has shape {array.shape}, expected rows of numbers")
    return np.ascontiguousarray(array)


def _numbers_of_nodes(value, what):
    """Rows of whole numbers."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{what} has numbers of {array.dtype}, expected whole numbers of nodes")
    return _rows(array.astype(np.int64), what)


def _fields(fields):
    """The fields of a scene as JSON has them; None removes one of the file."""
    return {name: None if value is None else _plain(value, name) for name, value in fields.items()}


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
